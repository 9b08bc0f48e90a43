# SPDX-License-Identifier: GPL-3.0-or-later
"""What Blender's search of the properties editor finds: it looks at labels and tooltips."""

import bpy
from studio import fact, stage

ASKED = ("thickness", "ink", "inner lines", "crease angle", "shade steps", "shade color", "screentone size", "paper",
         "far lines", "rim", "outline", "shadow", "hatching", "screentone", "hidden lines", "dot size", "ink color")


def searched(_out):
    """{what is typed: properties of the front panel and of the table of kinds that have it}"""
    from encre.blender import front

    known = {p.identifier: f"{p.name}\n{p.description}".lower() for p in stage(16, 16, 1).encre.bl_rna.properties}
    shown = ["look", "layer_source", "samples", "line_thickness", "length_unit", "ink_color", "crease_angle",
             *(f"draw_{name}" for name in front.TOGGLES), "small_lines", "hand", "far_lines", "shade_steps",
             "shade_edge", "shade_tint", "shade_tint_weight", "fill", "fill_size", "tone_darkness", "use_rim",
             "rim_width", "rim_side", "paper_source"]
    fact("found", {words: [id_ for id_ in shown if words in known[id_]] for words in ASKED})
    fact("version", list(bpy.app.version))
