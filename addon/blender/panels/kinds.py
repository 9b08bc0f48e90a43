# SPDX-License-Identifier: GPL-3.0-or-later
"""The table of kinds of line: which are drawn, how wide, by which pen and in which ink."""

from ...pen.params import LINES
from ..languages import n_

# By the words of line_pen_... and line_color_...: (toggle of front.py, parameter of the width).
KINDS = {"outline": ("outlines", "width_object"), "contact": ("contacts", "width_contact"),
         "inner": ("inner", "width_depth"), "crease": ("creases", "width_normal"),
         "intersection": ("intersections", "width_intersection"), "suggestive": ("folds", "width_suggestive"),
         "material": ("materials", "width_material"), "color": ("colors", "width_color"),
         "light": ("shadows", "width_light"), "seen": ("mirrors", "width_seen"), "mark": ("marks", "width_mark")}
IDS = {*(width for _, width in KINDS.values()), *(f"line_pen_{kind}" for kind in KINDS),
       *(f"line_color_{kind}" for kind in KINDS), "line_color_by_kind"}
assert KINDS.keys() >= set(LINES)


def draw(layout, scene):
    """A row for each kind: whether it is drawn, its width as a multiple of the thickness, its pen, its ink."""
    layout.use_property_split = False
    layout.use_property_decorate = False
    column = layout.column(align=True)
    _cells(column, n_("Kind"), n_("Width"), n_("Pen"), n_("Ink") if scene.line_color_by_kind else "")
    for kind, (toggle, width) in KINDS.items():
        split = column.split(factor=0.4, align=True)
        split.prop(scene, f"draw_{toggle}")
        row = split.row(align=True)
        row.active = getattr(scene, f"draw_{toggle}") and scene.use_lines
        row.prop(scene, width, text="")
        pen = row.row(align=True)
        pen.active = scene.edge_detector == "FINE"
        pen.prop(scene, f"line_pen_{kind}", text="")
        if scene.line_color_by_kind:
            ink = row.row(align=True)
            ink.ui_units_x = 2
            ink.prop(scene, f"line_color_{kind}", text="")
    layout.prop(scene, "line_color_by_kind")


def _cells(column, *texts):
    split = column.split(factor=0.4, align=True)
    split.label(text=texts[0])
    row = split.row(align=True)
    for text in filter(None, texts[1:]):
        row.label(text=text)
