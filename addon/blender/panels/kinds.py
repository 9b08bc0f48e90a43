# SPDX-License-Identifier: GPL-3.0-or-later
"""The table of kinds of line: which are drawn, how wide, by which pen and in which ink."""

from ...pen.params import LINES
from ..languages import n_

# {kind: toggle of front.py}
KINDS = {"outline": "outlines", "contact": "contacts", "inner": "inner", "crease": "creases",
         "intersection": "intersections", "suggestive": "folds", "material": "materials", "color": "colors",
         "shadow": "shadows", "mirror": "mirrors", "mark": "marks", "hidden": "hidden"}
IDS = {*(f"line_{kind}_{what}" for kind in KINDS for what in ("width", "pen", "ink")), "ink_by_kind"}
assert KINDS.keys() == set(LINES)


def draw(layout, scene):
    """A row for each kind: whether it is drawn, its width as a multiple of the thickness, its pen, its ink."""
    layout.use_property_split = False
    layout.use_property_decorate = False
    column = layout.column(align=True)
    _cells(column, n_("Kind"), n_("Width"), n_("Pen"), n_("Ink") if scene.ink_by_kind else "")
    for kind, toggle in KINDS.items():
        split = column.split(factor=0.47, align=True)
        split.prop(scene, f"draw_{toggle}")
        row = split.row(align=True)
        row.active = getattr(scene, f"draw_{toggle}") and scene.use_lines
        row.prop(scene, f"line_{kind}_width", text="")
        pen = row.row(align=True)
        pen.active = scene.edge_detector == "FINE"
        pen.prop(scene, f"line_{kind}_pen", text="")
        if scene.ink_by_kind:
            ink = row.row(align=True)
            ink.ui_units_x = 2
            ink.prop(scene, f"line_{kind}_ink", text="")
    layout.prop(scene, "ink_by_kind")
    layout.operator("encre.lines_to_grease_pencil", icon="GREASEPENCIL")


def _cells(column, *texts):
    split = column.split(factor=0.47, align=True)
    split.label(text=texts[0])
    row = split.row(align=True)
    for text in filter(None, texts[1:]):
        row.label(text=text)
