# SPDX-License-Identifier: GPL-3.0-or-later
"""The study: two looks of one scene side by side, and people who say which they prefer (docs/study.md).

In: a scene whose camera moves, two looks, and what is asked (pen/session.py, which needs no Blender). Out: a window of
four quadrants, and a text file of each person.

operators begins it, and hands what is pressed to stage, which has one person after the other go through the phases.
quadrants is the View that draws both looks and the plain picture of one moment, of layers that are drawn once; baked
has textures with lines in them. flight is the camera's way and how it is moved by hand, between walls; panel the
quadrant with words and buttons; film keeps flights that were drawn beforehand.

To add: a phase to stage and pen/session.py; what people can set to panel, with its row.
"""

from . import operators


def register():
    operators.register()


def unregister():
    operators.unregister()
