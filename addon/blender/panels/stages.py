# SPDX-License-Identifier: GPL-3.0-or-later
"""The closed panels below the front: every row of the parameter table has a place in one of them.

A panel shows its first rows, and what is turned less often in folds below. Rows that no panel names, as new ones, are
in the fold "More" of the panel that has their stage, and a stage that none has gets a panel. Rows of pens and tones are
in lists (lists.py).
"""

import functools
from dataclasses import dataclass

import bpy

from ...pen import library, slots
from ..languages import n_
from . import kinds, layers, lists, meter, papers
from .base import EncrePanel
from .rows import draw_params


@dataclass(frozen=True)
class Fold:
    """`rows`: ids; `stage`: also all rows of this stage that nobody names, whose switch is then the check box."""

    id: str
    label: str
    rows: tuple[str, ...] = ()
    stage: str = ""
    draw: object = None  # what else draws, after the rows


@dataclass(frozen=True)
class Group:
    """A panel; `stages`: those whose rows that nobody names are in its fold "More"."""

    id: str
    label: str
    stages: tuple[str, ...]
    rows: tuple[str, ...] = ()
    folds: tuple[Fold, ...] = ()
    switch: str = ""
    draw: object = None  # what else draws, after the rows


def _rim_lamp(layout, scene):
    layout.prop(scene, "rim_lamp")


GROUPS = (
    Group("lines", n_("Lines"), ("edges", "lines", "kinds"),
          ("line_thickness", "length_unit", "page_height", "ink_color", "crease_angle", "crease_angle_smooth"), (
              Fold("strength", n_("Strength of Lines"), (
                  "line_outline_strength", "line_inner_strength", "line_crease_strength", "crease_bumps",
                  "line_material_strength", "line_color_strength", "line_shadow_strength",
                  "line_suggestive_strength", "line_mirror_strength", "line_mark_strength", "line_hidden_strength",
                  "hidden_most")),
              Fold("small", n_("Small and Crowded Lines"), (
                  "line_shortest", "line_color_shortest", "line_shadow_shortest", "line_mirror_shortest",
                  "line_suggestive_shortest",
                  "suggestive_size", "line_density", "line_fewer")),
              Fold("outlines", n_("Outlines and Gaps"), (
                  "line_smooth", "line_outer_width", "line_gap", "line_halo", "line_halo_color")),
              Fold("far", n_("Near and Far"), (
                  "line_far_distance", "line_far_unit", "line_far_thickest", "line_far_thinnest",
                  "line_thickest")),
              Fold("ink", n_("Ink by Light"), (
                  "ink_in_shade", "ink_tint", "ink_tint_value", "ink_on_dark", "ink_dark_color", "ink_dark_threshold",
                  "ink_dark_width", "ink_dark_colors", "ink_in_light", "ink_light_color", "surface_fade"))),
          "use_lines", kinds.draw),
    Group("pens", n_("Pens"), ("pen_1", "pen_2", "pen_3"), draw=lists.draw_pens),
    Group("shade", n_("Shade and Light"), ("shade",),
          ("shade_levels", "shade_tint", "shade_tint_weight", "shade_saturation", "shade_beyond", "shade_strength",
           "shade_exposure",
           "shade_meter", "meter_light", "meter_shade"), (
              Fold("rim", n_("Rim Light"), stage="rim", draw=_rim_lamp),
              Fold("highlights", n_("Highlights and Reflections"), (
                  "other_light", "other_background", "other_highlights", "highlight_shape", "highlight_threshold",
                  "highlight_color", "other_reflections", "reflection_tones", "other_glow"))),
          "use_shading", meter.draw),
    Group("tones", n_("Tones (Screentone)"), (), (), (
        Fold("all_tones", n_("All Tones"), stage="tones"), Fold("specks", n_("Fill Specks"), stage="specks")),
        "use_tones", lists.draw_tones),
    Group("colors", n_("Color and Paint"), (), ("surface", "paper_color", "flat_colors", "sky_colors"), (
        Fold("gouache", n_("Gouache"), stage="gouache"), Fold("wash", n_("Watercolor"), stage="wash"),
        Fold("example", n_("By Example"), stage="example"),
        Fold("print", n_("Print"), stage="print"), Fold("smudge", n_("Smudging"), stage="smudge"))),
    Group("paper", n_("Paper"), ("paper",), (
        "paper_source", "paper_image", "paper_scale", "paper_roughness", "paper_seed"), (
        Fold("hatch", n_("Pencil Hatching"), stage="hatch"), Fold("relief", n_("Sheet"), stage="relief")),
          draw=papers.draw),
    Group("layers", n_("Layers and Quality"), ("layers",),
          ("layer_source", "light_source", "supersample", "world_shadows", "world_planes", "facet_angle"),
          draw=layers.draw),
    Group("detectors", n_("Detectors of the Theses"), (), (
        "edge_detector", "edge_threshold", "edge_blur", "depth_space", "depth_near", "depth_far",
        "sobel_crease_threshold", "color_layer", "color_detector", "contrast_metric",
        "contrast_hue", "contrast_saturation", "contrast_lightness", "contrast_threshold",
        "contrast_full", "contrast_local", "contrast_window", "line_search", "line_occlude", "crease_source")),
)
# What is drawn by other means than a row: the switches, which are check boxes, and what kinds.draw() shows.
_ELSEWHERE = {*kinds.IDS}


def _panel(id_, parent, label, draw, switch=""):
    def draw_header(self, context):
        self.layout.prop(context.scene.encre, switch, text="")

    members = {"bl_label": label, "bl_idname": f"ENCRE_PT_{id_}", "bl_options": {"DEFAULT_CLOSED"},
               "bl_parent_id": f"ENCRE_PT_{parent}", "draw": draw, **({"draw_header": draw_header} if switch else {})}
    return type(f"ENCRE_PT_{id_}", (EncrePanel, bpy.types.Panel), members)


def _drawing(rows, more=None):
    def draw(self, context):
        draw_params(self.layout, context.scene.encre, rows, "scene")
        if more:
            more(self.layout, context.scene.encre)

    return draw


@functools.cache
def groups():
    """GROUPS, and a panel of its own for each stage that they know nothing of."""
    known = {stage for group in GROUPS for stage in (*group.stages, *(fold.stage for fold in group.folds))}
    known |= {library.params()[group.switch].stage for group in GROUPS if group.switch}
    return (*GROUPS, *(
        Group(stage.id, stage.label, (stage.id,), tuple(p.id for p in stage.params if not p.switch),
              switch=stage.switch.id if stage.switch else "")
        for stage in library.stages() if stage.id not in known))


@functools.cache
def places():
    """{id of a panel: the rows that it shows}, of every panel below the front."""
    params = library.params()
    named = {id_ for group in groups() for id_ in (*group.rows, *(row for fold in group.folds for row in fold.rows))}
    found = {}
    for group in groups():
        found[group.id] = [params[id_] for id_ in group.rows]
        taken = {fold.stage for fold in group.folds}
        for fold in group.folds:
            found[fold.id] = [params[id_] for id_ in fold.rows] + _left(fold.stage, named)
        more = [p for stage in group.stages if stage not in taken for p in _left(stage, named)]
        if more:
            found[f"{group.id}_more"] = more
    return found


def _left(stage, named):
    """Rows of a stage that no panel names."""
    return [p for one in library.stages() if one.id == stage for p in one.params
            if p.id not in named and not p.switch and not slots.of(p.id) and p.id not in _ELSEWHERE]


@functools.cache
def classes():
    """The panel classes, in the order in which they are shown."""
    switches, made = {stage.id: stage.switch for stage in library.stages()}, []
    for group in groups():
        made.append(_panel(group.id, "encre", group.label, _drawing(places()[group.id], group.draw), group.switch))
        for fold in group.folds:
            switch = switches.get(fold.stage)
            switch = switch.id if switch and switch.id != group.switch else ""
            made.append(_panel(fold.id, group.id, fold.label, _drawing(places()[fold.id], fold.draw), switch))
        if more := places().get(f"{group.id}_more"):
            made.append(_panel(f"{group.id}_more", group.id, n_("More"), _drawing(more)))
    return made
