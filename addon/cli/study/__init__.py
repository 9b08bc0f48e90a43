# SPDX-License-Identifier: GPL-3.0-or-later
"""`encre study`: people compare two looks.

In: a scene, or a folder of sessions. Out: a file a person, what came of them as text. sessions has a Blender opened
with a window, which runs windowed, and tells what came of sessions, by proportions, which alone needs scipy.
"""
