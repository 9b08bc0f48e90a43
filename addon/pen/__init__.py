# SPDX-License-Identifier: GPL-3.0-or-later
"""The library from Python, and all that needs no Blender."""
