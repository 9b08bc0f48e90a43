# SPDX-License-Identifier: GPL-3.0-or-later
"""Encre inside Blender: the engine, what it reads of a scene, and what a user sees of it."""

ENGINE = "ENCRE"  # how files name the engine
