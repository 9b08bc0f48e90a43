# SPDX-License-Identifier: GPL-3.0-or-later
"""The lists of pens and of tones, with the rows of the chosen one below."""

import bpy

from ...pen import slots
from ...pen.errors import EncreError
from ...pen.params import LINES, PENS, TONES, terms
from .. import ENGINE, pens, properties
from ..languages import CONTEXT, iface_
from .rows import draw_params


class ENCRE_UL_pens(bpy.types.UIList):
    def draw_item(self, _context, layout, _data, item, _icon, scene, _active, index=0, _flag=0):
        layout.active = any(PENS[getattr(scene, f"line_{kind}_pen")] == item.identifier for kind in LINES)
        layout.prop(scene, f"{item.identifier}_called", text="", emboss=False, icon="GREASEPENCIL")


def tone_label(number, levels, blacks=0):
    """What the tone of a level of light is called among so many, before which are so many of blacks."""
    if number <= blacks:
        return iface_("{} Small Blacks", CONTEXT).format(number)
    if number == len(TONES) < levels + blacks:
        return iface_("{} and up", CONTEXT).format(number)
    ends = {1 + blacks: iface_("{} Darkest", CONTEXT), levels + blacks: iface_("{} Brightest", CONTEXT)}
    ends = ends if levels > 1 else {}
    return ends.get(number, "{}").format(number)


class ENCRE_UL_tones(bpy.types.UIList):
    def filter_items(self, context, _data, _property):
        levels = properties.tone_count(context.scene.encre)
        return [self.bitflag_filter_item * (n < levels) for n in range(len(TONES))], []

    def draw_filter(self, _context, _layout):
        """There is nothing to search for."""

    def draw_item(self, _context, layout, _data, item, _icon, scene, _active, index=0, _flag=0):
        split = layout.split(factor=0.55)
        named = split.row(align=True)
        blacks = properties.tones_of_blacks(scene)
        if blacks <= index < blacks + len(scene.shade_levels):
            swatch = named.row()
            swatch.ui_units_x = 0.8
            swatch.prop(scene.shade_levels[index - blacks], "tone", text="")
        named.label(text=tone_label(index + 1, properties.level_count(scene), blacks), translate=False)
        split.prop(scene, f"{item.identifier}_fill", text="", emboss=False)


def chosen(scene, kind):
    """The slot that a list shows."""
    most = len(slots.KINDS[kind]()) if kind == "pen" else min(properties.tone_count(scene), len(TONES))
    return slots.KINDS[kind]()[min(getattr(scene, f"active_{kind}"), most - 1)]


def _name(scene, slot):
    """What a slot is called in menus."""
    return pens.name(scene, slot) if slot.kind == "pen" else iface_(slot.label, CONTEXT)


class ENCRE_OT_slot_copy(bpy.types.Operator):
    """Copy all settings of this one to the chosen one"""

    bl_idname = "encre.slot_copy"
    bl_label = "Copy from Another"
    bl_options = {"REGISTER", "UNDO", "INTERNAL"}

    source: bpy.props.StringProperty(options={"HIDDEN"})

    @classmethod
    def poll(cls, context):
        return context.engine == ENGINE

    def execute(self, context):
        scene = context.scene.encre
        try:
            source = slots.find(self.source)
        except EncreError as error:
            self.report({"ERROR"}, str(error))
            return {"CANCELLED"}
        for id_, value in slots.copied(source, chosen(scene, source.kind),
                                       lambda p: properties.value_of(scene, p)).items():
            properties.set_value(scene, id_, value)
        return {"FINISHED"}


class _CopyMenu:
    bl_label = "Copy from Another"

    def draw(self, context):
        scene = context.scene.encre
        for slot in slots.KINDS[self.kind]()[:len(TONES) if self.kind == "pen" else properties.tone_count(scene)]:
            if slot != chosen(scene, self.kind):
                text = iface_("Copy from {}", CONTEXT).format(_name(scene, slot))
                self.layout.operator("encre.slot_copy", text=text, translate=False, icon="COPYDOWN").source = slot.id


class ENCRE_MT_pen_copy(_CopyMenu, bpy.types.Menu):
    """Copy the settings of another pen"""

    bl_idname = "ENCRE_MT_pen_copy"
    kind = "pen"


class ENCRE_MT_tone_copy(_CopyMenu, bpy.types.Menu):
    """Copy the settings of another tone"""

    bl_idname = "ENCRE_MT_tone_copy"
    kind = "tone"


def _draw(layout, scene, kind, rows):
    row = layout.row()
    row.template_list(f"ENCRE_UL_{kind}s", "", scene.bl_rna.properties[f"{kind}_slots"], "enum_items",
                      scene, f"active_{kind}", rows=rows)
    row.column(align=True).menu(f"ENCRE_MT_{kind}_copy", text="", icon="DOWNARROW_HLT")


def draw_pens(layout, scene):
    """The pens by name, and the chosen one's tool and hand."""
    _draw(layout, scene, "pen", 3)
    pen = chosen(scene, "pen")
    draw_params(layout, scene, pen.rows.values(), "scene")


def draw_tones(layout, scene):
    """What each level of light is filled with, and how that of the chosen one looks."""
    _draw(layout, scene, "tone", min(max(properties.tone_count(scene), 2), len(TONES)))
    tone = chosen(scene, "tone")
    layout.use_property_split = True
    layout.prop(scene, f"{tone.id}_fill", text="Tone")
    draw_params(layout, scene, [p for what, p in tone.rows.items() if what and _has(scene, tone, p)], "scene",
                lambda p: iface_(tone.row_label(p), CONTEXT))


def _has(scene, tone, p):
    """Whether what fills a level has a row at all: dots have no image, and what is none no pitch."""
    return all(of for term, of in terms(p.enabled_if, lambda id_: getattr(scene, id_)).items()
               if term.startswith(f"{tone.id}="))


CLASSES = (ENCRE_UL_pens, ENCRE_UL_tones, ENCRE_OT_slot_copy, ENCRE_MT_pen_copy, ENCRE_MT_tone_copy)
