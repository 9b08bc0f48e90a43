# SPDX-License-Identifier: GPL-3.0-or-later
"""The stages in slow, obvious float64, and where float32 may decide otherwise."""

from .edges import SOURCES
from .frame import CONTROLS, render
from .params import DEFAULTS, ENGINE, is_surface

__all__ = ["CONTROLS", "DEFAULTS", "ENGINE", "SOURCES", "is_surface", "render"]
