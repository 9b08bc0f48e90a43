# SPDX-License-Identifier: GPL-3.0-or-later
"""The passes of a view layer, below Cycles' own in its tab."""

import bpy

from .. import properties
from .base import EncrePanel


class ENCRE_PT_passes(EncrePanel, bpy.types.Panel):
    bl_label = "Encre Passes"
    bl_idname = "ENCRE_PT_passes"
    bl_context = "view_layer"

    def draw(self, context):
        self.layout.use_property_split = True
        column = self.layout.column(heading="Include")
        for switch in properties.PASSES:
            column.prop(context.view_layer.encre, switch)


CLASSES = (ENCRE_PT_passes,)
