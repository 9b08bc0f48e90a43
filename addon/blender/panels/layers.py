# SPDX-License-Identifier: GPL-3.0-or-later
"""What a render is made of and what stays of it in memory, below the rows of the table."""

from .. import memory


def draw(layout, scene):
    layout.prop(scene, "samples")
    layout.prop(scene, "ink_early")
    row = layout.row(align=True)
    row.prop(scene, "keep_layers")
    if held := memory.size(scene.id_data):
        row.label(text=f"{held / 1e6:.0f} MB", translate=False)
        row.prop(scene, "auto_redraw", text="", icon="AUTO")
        row.operator("encre.redraw", text="", icon="FILE_REFRESH")
    row.operator("encre.open_layers", text="", icon="FILE_FOLDER")
