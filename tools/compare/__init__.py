# SPDX-License-Identifier: GPL-3.0-or-later
"""`encre compare`: a benchmark of ways to draw lines, which artists need not install.

In: a scene, frames, and the settings of the command line. Out: a picture with a quadrant for each way (no lines between
colours, lines baked into textures, lines drawn in the frame, a caption), details, and Blender's own lines; timings.

compare runs where the command is given and puts the pictures together; techniques runs in the Blender that it starts
and renders one frame by each way; grease is Line Art, whatever Grease Pencil that Blender has.

To add: a way of drawing to techniques, and its place in the picture to compare. addon/cli/tools.py loads this folder
from a checkout, and says how to get it where it is not there. What was found is docs/compare.md.
"""
