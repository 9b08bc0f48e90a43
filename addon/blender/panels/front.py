# SPDX-License-Identifier: GPL-3.0-or-later
"""The front panel: what an artist turns first, and what is amiss with the picture, each with its cure."""

import bpy

from ...pen import denoise
from ...pen.settings import crowded, pixels_wide
from .. import engine, front, looks, memory, overrides, properties, redraw, versions
from ..languages import CONTEXT, iface_, n_
from .base import EncrePanel

_MANY = 64  # samples: more than flat light and lines need


class ENCRE_OT_standard_view(bpy.types.Operator):
    """Show colors as they are: other view transforms wash ink and flat colors out"""

    bl_idname = "encre.standard_view"
    bl_label = "Use Standard View Transform"
    bl_options = {"UNDO"}

    def execute(self, context):
        context.scene.view_settings.view_transform = "Standard"
        return {"FINISHED"}


class ENCRE_OT_few_samples(bpy.types.Operator):
    """Take 16 samples for each pixel: light that is cut into flat steps needs no more"""

    bl_idname = "encre.few_samples"
    bl_label = "16 Is Enough"
    bl_options = {"UNDO"}

    def execute(self, context):
        context.scene.encre.samples = overrides.SAMPLES
        return {"FINISHED"}


class ENCRE_OT_fast(bpy.types.Operator):
    """Let Encre draw the picture by itself, in seconds and without noise; no reflections and no bounced light"""

    bl_idname = "encre.fast"
    bl_label = "Render Fast"
    bl_options = {"UNDO"}

    def execute(self, context):
        context.scene.encre.layer_source = "ENCRE"
        return {"FINISHED"}


def blots(scene):
    """That lines in pixels are too wide for the frame, in a few words; None: they are not."""
    width = pixels_wide(properties.scene_values(scene))
    if crowded(width, scene.render.resolution_y * scene.render.resolution_percentage // 100):
        return iface_("Lines of {} px run together").format(f"{width:g}")
    return None


def noise(scene):
    """Why the light of a full render will be grainy, in a few words; None: it will not."""
    settings = scene.encre
    if settings.layer_source == "ENCRE" or settings.light_source == "DRAWN" or not settings.use_shading:
        return None
    if settings.light_denoise == "NONE":
        return n_("Grainy shade: render fast")
    return None if denoise.available(versions.home()) else n_("No denoiser: render fast")


def stale(scene):
    """Whether the picture that was rendered is another than the settings of now ask for, and can't be drawn again."""
    return bool(memory.size(scene)) and bool(memory.refusal(scene, engine.pass_names))


def _alerts(layout, scene):
    """What is amiss, each on a button that is its cure."""
    settings, column = scene.encre, layout.column(align=True)
    transform = scene.view_settings.view_transform
    if transform != "Standard":
        words = iface_("{} washes out ink").format(iface_(transform))
        column.operator("encre.standard_view", text=words, translate=False, icon="ERROR")
    if stale(scene):
        column.operator("render.render", text="Old picture: render again", icon="ERROR").use_viewport = True
    if words := noise(scene):
        column.operator("encre.fast", text=words, icon="ERROR")
    if words := blots(scene):
        column.label(text=words, icon="ERROR", translate=False)
    if scene.render.use_freestyle and settings.use_lines:
        column.prop(scene.render, "use_freestyle", text="Freestyle draws lines, too", icon="ERROR")


def _look(layout, scene):
    settings, row = scene.encre, layout.row(align=True)
    picture = row.row(align=True)
    picture.ui_units_x = 4
    picture.template_icon_view(settings, "look", show_labels=True, scale=3.0, scale_popup=5.0)
    column = row.column(align=True)
    line = column.row(align=True)
    line.operator("encre.look_step", text="", icon="TRIA_LEFT").step = -1
    preset = looks.current(scene)
    if preset:
        line.menu("ENCRE_MT_looks", text=preset.name, translate=False)
    else:
        line.menu("ENCRE_MT_looks", text="Choose a Look")
    line.operator("encre.look_step", text="", icon="TRIA_RIGHT").step = 1
    line.menu("ENCRE_MT_scene_settings", text="", icon="DOWNARROW_HLT")
    return column


def _render(column, scene):
    settings = scene.encre
    row = column.row(align=True)
    row.prop_enum(settings, "layer_source", "ENCRE")
    row.prop_enum(settings, "layer_source", "CYCLES")
    row = column.row(align=True)
    if settings.layer_source == "CYCLES":
        row.prop(settings, "samples")
        if overrides.samples(scene) > _MANY:
            row.operator("encre.few_samples")
    else:
        row.label(text="Without Cycles, no noise")
    if seconds := redraw.seconds(scene):
        last = column.row()
        last.active = False
        last.label(text=iface_("Last picture: {} s", CONTEXT).format(f"{seconds:.0f}" if seconds > 9 else
                                                                     f"{seconds:.1f}"), translate=False)


def _named(layout, text):
    """A row with a name of its own on the left."""
    split = layout.split(factor=0.43, align=True)
    label = split.row()
    label.alignment = "RIGHT"
    label.label(text=text)
    return split.row(align=True)


def _lines(layout, settings):
    row = _named(layout, n_("Thickness"))
    row.prop(settings, "line_thickness", text="")
    row.prop(settings, "length_unit", text="")
    _named(layout, n_("Ink")).prop(settings, "ink_color", text="")
    for names in (front.SHOWN[:3], front.SHOWN[3:]):
        row = layout.row(align=True)
        for name in names:
            row.prop(settings, f"draw_{name}", toggle=True)
    row = _named(layout, n_("Crease Angle °"))
    row.prop(settings, "crease_angle", text="")
    for id_, text in (("small_lines", n_("Small Lines")), ("hand", n_("Hand")), ("far_lines", n_("Far Away"))):
        _named(layout, text).prop(settings, id_, text="", slider=True)


def _shade(layout, settings):
    _named(layout, n_("Shade Steps")).prop(settings, "shade_steps", expand=True)
    _named(layout, n_("Soft Edge")).prop(settings, "shade_edge", text="", slider=True)
    row = _named(layout, n_("Shade Color"))
    row.prop(settings, "shade_tint", text="")
    row.prop(settings, "shade_tint_weight", text="")
    _named(layout, n_("Fill Shade")).prop(settings, "fill", text="")
    row = _named(layout, n_("Size, Dark"))
    row.active = settings.use_tones
    row.prop(settings, "fill_size", text="")
    row.prop(settings, "tone_darkness", text="", slider=True)
    row = _named(layout, n_("Rim Light"))
    row.prop(settings, "use_rim", text="")
    rest = row.row(align=True)
    rest.active = settings.use_rim
    rest.prop(settings, "rim_width", text="")
    rest.prop(settings, "rim_side", text="")
    _named(layout, n_("Paper")).prop(settings, "paper_source", text="")


class ENCRE_PT_encre(EncrePanel, bpy.types.Panel):
    bl_label = "Encre"
    bl_idname = "ENCRE_PT_encre"
    # Blender puts panels without a header above all others: under the engine's own row, not below Cycles' panels. An
    # order below 0 counts as 0.
    bl_options = {"HIDE_HEADER"}

    def draw(self, context):
        layout, scene = self.layout, context.scene
        _render(_look(layout, scene), scene)
        _alerts(layout, scene)
        column = layout.column(align=True)
        column.use_property_split = False
        _lines(column, scene.encre)
        column.separator(factor=0.5)
        _shade(column, scene.encre)


CLASSES = (ENCRE_OT_standard_view, ENCRE_OT_few_samples, ENCRE_OT_fast, ENCRE_PT_encre)
