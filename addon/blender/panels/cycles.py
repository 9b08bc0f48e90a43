# SPDX-License-Identifier: GPL-3.0-or-later
"""Cycles' own panels and shader nodes, for everything that Cycles does for Encre."""

import sys

import bpy

from .. import ENGINE


def _panels(cls=bpy.types.Panel):
    for sub in cls.__subclasses__():
        yield sub
        yield from _panels(sub)


def _adopt_panels(adopt):
    """Shows every panel that Cycles shows with Encre chosen as well, or takes that back."""
    for panel in _panels():
        engines = getattr(panel, "COMPAT_ENGINES", ())
        if "CYCLES" in engines:
            (engines.add if adopt else engines.discard)(ENGINE)
    for name, condition in _ASKED.items():
        if panel := getattr(bpy.types, name, None):
            panel.poll = _poll(panel.poll, condition) if adopt else getattr(panel.poll, "original", panel.poll)


def _experimental(context):
    """Blender 5 has one feature set."""
    return getattr(context.scene.cycles, "feature_set", "EXPERIMENTAL") == "EXPERIMENTAL"


def _of_cycles(context):
    """Encre's own view has neither passes nor a light of its own that could be chosen."""
    shading = context.space_data.shading
    return shading.type == "RENDERED" and shading.encre.source == "CYCLES"


# What panels ask under Encre. Before 5.0 Subdivision asks for Cycles' name.
_ASKED = {"CYCLES_RENDER_PT_subdivision": _experimental, "CYCLES_VIEW3D_PT_shading_render_pass": _of_cycles,
          "CYCLES_VIEW3D_PT_shading_lighting": _of_cycles}


def _poll(original, condition):
    def poll(_cls, context):
        return condition(context) if context.engine == ENGINE else original(context)

    poll.original = original
    return classmethod(poll)  # Blender crashes if it is any other kind of function


def _draw_device(self, context):
    """Cycles' own Device selector asks for its engine's name. Fast has no use for it."""
    if context.engine == ENGINE and context.scene.encre.layer_source == "CYCLES":
        layout = self.layout
        layout.use_property_split = True
        layout.use_property_decorate = False
        column = layout.column()
        for name in ("feature_set", "device", "shading_system"):
            if hasattr(context.scene.cycles, name):  # Blender 5 has one feature set
                column.prop(context.scene.cycles, name)


def _shader_menus():
    """Modules whose shader node menus ask whether the engine is Cycles; their files differ between versions."""
    for name in ("nodeitems_builtins", "bl_ui.node_add_menu_shader"):
        module = sys.modules.get(name)
        if hasattr(module, "cycles_shader_nodes_poll"):
            yield module


def _shader_nodes_poll(original):
    def cycles_shader_nodes_poll(context):
        return context.engine == ENGINE or original(context)

    cycles_shader_nodes_poll.original = original
    return cycles_shader_nodes_poll


def _adopt_nodes(adopt):
    """Lets the Add menu of shader nodes offer Cycles' nodes: they are Encre's too."""
    for module in _shader_menus():
        poll = module.cycles_shader_nodes_poll
        module.cycles_shader_nodes_poll = _shader_nodes_poll(poll) if adopt else getattr(poll, "original", poll)


def register():
    _adopt_panels(True)
    _adopt_nodes(True)
    bpy.types.RENDER_PT_context.append(_draw_device)


def unregister():
    bpy.types.RENDER_PT_context.remove(_draw_device)
    _adopt_nodes(False)
    _adopt_panels(False)
