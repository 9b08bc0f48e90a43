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
    # Before 5.0 this one asks for Cycles' name instead.
    panel = getattr(bpy.types, "CYCLES_RENDER_PT_subdivision", None)
    if panel and "poll" in vars(panel):
        panel.poll = _subdivision_poll(panel.poll) if adopt else getattr(panel.poll, "original", panel.poll)


def _subdivision_poll(original):
    def poll(_cls, context):
        return original(context) or (context.engine == ENGINE and context.scene.cycles.feature_set == "EXPERIMENTAL")

    poll.original = original
    return classmethod(poll)  # Blender crashes if it is any other kind of function


def _draw_device(self, context):
    """Cycles' own Device selector asks for its engine's name."""
    if context.engine == ENGINE:
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
