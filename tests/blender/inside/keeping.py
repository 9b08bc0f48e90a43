# SPDX-License-Identifier: GPL-3.0-or-later
"""Cases of what files keep: library overrides."""

import os

import bpy
from studio import cube, fact, material, register


def overridden(out):
    """A prop is linked from a library, overridden, saved and opened again."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    register()
    from encre.blender import properties

    owners = {"object": "objects", "material": "materials"}
    library, shot = (os.path.join(out, f"{name}.blend") for name in ("library", "shot"))
    cube("Prop", mat=material("Paint", (0.8, 0.1, 0.1)))
    bpy.ops.wm.save_as_mainfile(filepath=library)
    bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)
    register()
    with bpy.data.libraries.load(library, link=True) as (_, found):
        found.objects, found.materials = ["Prop"], ["Paint"]
    for owner, blocks in owners.items():
        [block] = getattr(bpy.data, blocks)
        local = block.override_create()
        for number, own in enumerate(properties.own_settings(owner)):
            setattr(local.encre, own.id, _value(own, number))
        if owner == "object":
            bpy.context.scene.collection.objects.link(local)
        local.use_fake_user = True
    bpy.ops.wm.save_as_mainfile(filepath=shot)
    bpy.ops.wm.open_mainfile(filepath=shot)
    for owner, blocks in owners.items():
        local = next(block for block in getattr(bpy.data, blocks) if block.override_library)
        fact(owner, {own.id: [_value(own, number), getattr(local.encre, own.id)]
                     for number, own in enumerate(properties.own_settings(owner))})


def _value(own, number):
    """What a setting is given: nothing that it is by itself, each its own."""
    return {"control": 0.5 + number / 64, "degrees": 8.0 + number, "bool": True}.get(own.kind, f"Name {number}")
