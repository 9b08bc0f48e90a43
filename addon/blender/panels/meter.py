# SPDX-License-Identifier: GPL-3.0-or-later
"""What the meter has found, and the button that keeps it for a shot."""

import bpy

from .. import lamps, meshes, meter, properties, subject
from ..languages import iface_, n_


def draw(layout, settings):
    """The row of the meter below the rows of shading."""
    if settings.shade_meter == "SCENE":
        return
    found = meter.found.get(settings.id_data.name_full)
    if found and settings.shade_meter == "LAMPS":
        light = iface_(n_("Full light {:.3g}")).format(found.light)
        shade = iface_(n_(", shade {:.3g}")).format(found.shade) if found.shade else ""
        layout.label(text=light + shade, icon="LIGHT_SUN")
    layout.operator("encre.meter", icon="LIGHT_SUN")


class ENCRE_OT_meter(bpy.types.Operator):
    """Measure the light that things receive now, and keep it as full light and shade for the whole shot"""

    bl_idname = "encre.meter"
    bl_label = "Meter"
    bl_options = {"REGISTER", "UNDO"}

    def execute(self, context):
        depsgraph = context.evaluated_depsgraph_get()
        settings = properties.settings(context.scene)
        light = lamps.Light(depsgraph, (0.1, 1000), shadowed=settings.shadows_world, planes=settings.planes)
        meshes.extract(depsgraph, False, None, light)
        found = subject.read(depsgraph, None, light)
        if not found.light > 0:
            self.report({"ERROR"}, "there is no light to measure, neither a lamp nor a world that Encre can read; "
                                   "add a lamp")
            return {"CANCELLED"}
        group = context.scene.encre
        for id_, value in (("meter_light", found.light), ("meter_shade", found.shade), ("shade_meter", "FIXED")):
            properties.set_value(group, id_, value)
        return {"FINISHED"}


CLASSES = (ENCRE_OT_meter,)
