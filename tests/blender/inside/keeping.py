# SPDX-License-Identifier: GPL-3.0-or-later
"""Cases of what is kept: library overrides, looks of older files, presets, copied settings."""

import json
import os

import bpy
from studio import cube, fact, material, register, shoot, stage


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


def opened(out):
    """Files of version 0.1.0, of this one, and one in which nobody has chosen Encre."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    register()
    from encre.blender import migration

    paths = {name: os.path.join(out, f"{name}.blend") for name in ("foreign", "new", "old")}
    scene = bpy.context.scene
    bpy.ops.wm.save_as_mainfile(filepath=paths["foreign"])
    scene.render.engine, scene.encre.line_thickness = "ENCRE", 5
    bpy.ops.wm.save_as_mainfile(filepath=paths["new"])
    bpy.app.handlers.save_pre.remove(migration._saving)  # version 0.1.0 wrote none
    scene.encre.version = 0
    bpy.ops.wm.save_as_mainfile(filepath=paths["old"])
    for name, path in paths.items():
        bpy.ops.wm.open_mainfile(filepath=path)
        settings = bpy.context.scene.encre
        fact(name, [settings.version, settings.crease_source, settings.line_far_unit, settings.crease_angle,
                    settings.line_shortest, round(settings.line_thickness, 3),
                    bpy.context.view_layer.encre.use_pass_lines, settings.samples])


def _value(own, number):
    """What a setting is given: nothing that it is by itself, each its own."""
    share = 0.5 + number / 64
    return {"control": share, "share": share, "degrees": 8.0 + number, "bool": True}.get(own.kind, f"Name {number}")


def presets(out):
    """The user's presets, in the folder that BLENDER_USER_CONFIG names: saved, applied, shared, deleted."""
    scene = stage(300, 200, 1)
    from encre.blender.panels import presets as panel

    def listed():
        every, wrong = panel.every()
        return [[[preset.id, preset.own, preset.picture.is_file()] for preset in every], wrong]

    def call(operator, **more):
        try:
            return [list(getattr(bpy.ops.encre, operator)(**more)), scene.encre.preset]
        except RuntimeError as error:
            return str(error)

    mine, folder = scene.encre, panel.folder()
    fact("folder", str(folder))
    mine.line_thickness, mine.ink_color, mine.supersample, mine.paper_source = 7.3, (0.1, 0.2, 0.3), 2, "IMAGE"
    mine.shade_levels.add().intensity = 0.4
    mine.shade_levels.add().threshold = 0.6
    fact("save", call("preset_save", name="My Look", description="As I like it"))
    fact("without a render", listed())
    mine.supersample, mine.paper_source = 1, "NONE"
    fact("render", shoot(out, "shot"))
    fact("save", call("preset_save", name="My Look", description="As I like it"))
    fact("saved", listed())
    fact("file", json.loads((folder / "my_look.json").read_text(encoding="utf-8")))
    fact("picture", _size(folder / "my_look.png"))
    fact("left", [len(bpy.data.scenes), sorted(image.name for image in bpy.data.images)])
    settings = scene.render.image_settings
    fact("format", [settings.file_format, settings.color_depth])
    for name in ("Ink Only", "...", "my look"):
        fact("name", call("preset_save", name=name))
    call("preset", preset="ink_only")
    fact("other", [mine.line_thickness, mine.preset])
    call("preset", preset="my_look")
    fact("applied", [mine.line_thickness, list(mine.ink_color), [v.intensity for v in mine.shade_levels], mine.preset])
    shared = os.path.join(out, "shared.json")
    fact("export", call("preset_export", preset="my_look", filepath=shared))
    fact("twice", call("preset_import", filepath=shared))
    fact("remove", call("preset_remove", preset="my_look"))
    fact("remove", call("preset_remove", preset="ink_only"))
    fact("removed", listed())
    fact("import", call("preset_import", filepath=shared))
    fact("imported", listed())
    fact("reset without it", call("reset", param="line_thickness") and mine.line_thickness)
    (folder / "broken.json").write_text("[" * 100000)
    (folder / "images.json").write_text('{"name": "x", "description": "", "values": {"paper_image": "/etc/passwd"}}')
    fact("broken", listed())


def _size(path):
    image = bpy.data.images.load(str(path))
    size, pixels = list(image.size), image.pixels[:]
    bpy.data.images.remove(image)
    return [size, max(pixels[:3]) - min(pixels[:3]), min(pixels), max(pixels)]


def levels_by_ramp():
    """Levels as a color ramp has them, untouched, with a stop more, and what the dialog leaves of both."""
    from encre.blender.panels import levels
    from encre.pen import library

    group, holder = bpy.context.scene.encre, bpy.data.textures.new("Encre Levels", "BLEND")
    before, made = [(0.5, 0, 0, 1, 1, 1), (0.7, 0.5, 0.1, 1, 0.5, 0.25), (1.1, 0.9, 0.02, 1, 1, 1)], []
    kept = [(v.intensity, v.threshold, v.transition, *v.color) for v in group.shade_levels]
    holder.use_color_ramp = True
    levels.fill_ramp(holder.color_ramp, before, 1.5)
    made.append(levels.read_ramp(holder.color_ramp, before, 1.5))
    holder.color_ramp.elements.new(0.61).color = (0.9, 0.9, 1, 1)
    made.append(levels.read_ramp(holder.color_ramp, before, 1.5))
    library.check({"shade_levels": made[1]})
    bpy.ops.encre.level_ramp(held=holder.name)
    made.append([v.intensity for v in group.shade_levels])
    group.shade_levels.clear()
    for values in kept:
        row = group.shade_levels.add()
        row.intensity, row.threshold, row.transition, row.color = *values[:3], values[3:]
    return before, made, "Encre Levels" in bpy.data.textures


def settings(_out):
    """Settings copied from scene and style to scene and style, and rows reset."""
    scene = stage(16, 16, 1)
    from encre.blender import properties
    from encre.pen import library, presets

    def of(group):
        return {id_: list(value) if isinstance(value, tuple) else value
                for id_, value in properties.stored(group).items()}

    mine = scene.encre
    mine.ink_color, mine.edge_detector, mine.paper_image = (0.1, 0.2, 0.3), "DOG", bpy.data.images.new("Sheet", 4, 4)
    bpy.ops.encre.level_add()
    fact("offered without a style", bpy.ops.encre.style_store.poll())
    bpy.ops.encre.style_add()
    bpy.ops.encre.style_store(param="hatch_amount")
    mine.styles[0].hatch_amount = 0.25
    fact("first", [of(mine), of(mine.styles[0])])
    fact("ramp", levels_by_ramp())
    bpy.ops.encre.settings_copy(path="scene")

    other = bpy.data.scenes.new("Other")
    bpy.context.window.scene = other
    other.render.engine = "ENCRE"
    other.encre.pen_1_taper = 5  # not set in the first: the default again
    for name in ("Style", "Mine"):
        other.encre.styles.add().name = name
    other.encre.styles["Style"].pen_1_taper = 3
    fact("paste", list(bpy.ops.encre.settings_paste(path="scene")))
    fact("second", [of(other.encre), of(other.encre.styles["Style"]), [style.name for style in other.encre.styles]])

    other.encre.line_thickness = 11  # and now it is neither the copied scene's nor the default
    other.encre.active_style = 1
    bpy.ops.encre.settings_paste(path="style")
    fact("scene to style", of(other.encre.styles["Mine"]))
    other.encre.active_style = 0
    bpy.ops.encre.settings_copy(path="style")
    other.encre.active_style = 1
    bpy.ops.encre.settings_paste(path="style")
    fact("style to style", of(other.encre.styles["Mine"]))
    bpy.ops.encre.settings_paste(path="scene")
    fact("style to scene", [other.encre.hatch_amount, other.encre.line_thickness, other.encre.edge_detector])

    user, nobodys = bpy.data.materials.new("User"), bpy.data.objects.new("Nobody's", None)
    user.encre.style, nobodys.encre.style = "Mine", "Lost"
    other.encre.styles["Mine"].name = "Skin"
    other.encre.styles["Skin"].name = "  "  # is none
    other.encre.styles["Skin"].name = "Style"  # which there is
    bpy.ops.encre.style_add()
    fact("renamed", [[style.name for style in other.encre.styles], user.encre.style, nobodys.encre.style])
    fact("renamed", [mine.styles[0].name])
    while len(other.encre.styles) > 2:
        bpy.ops.encre.style_remove()

    bpy.ops.encre.preset(preset="ink_only")
    params = library.params()
    differs = {id_: 1.5 for id_ in ("line_thickness", "ink_tint")}
    for id_, value in differs.items():
        setattr(other.encre, id_, value)
        bpy.ops.encre.reset(param=id_)
    fact("reset", [[round(getattr(other.encre, id_), 5), params[id_].default] for id_ in differs])
    other.encre.shade_levels.add()
    fact("levels", len(other.encre.shade_levels))
    bpy.ops.encre.reset(param="shade_levels")
    fact("levels", len(other.encre.shade_levels))
    bpy.ops.encre.reset(param="")
    fact("all", [properties.scene_values(other)[id_] for id_ in ("edge_detector", "line_thickness", "paper_image")])
    fact("differ", [p.id for p in params.values()
                    if not properties.has(other.encre, p, presets.find("ink_only").values.get(p.id, p.default))])


def registered(_out):
    """What Blender holds of ours after many times of enabling and disabling."""
    import gc

    package = register()
    states = []
    for _ in range(20):
        package.unregister()
        gc.collect()
        states.append(_state())
        package.register()
    fact("on", sorted(name for name in dir(bpy.types) if name.startswith(("ENCRE_", "Encre"))))
    package.unregister()
    fact("left", states[0])
    fact("more", [[was, now] for was, now in zip(states[0].items(), states[-1].items(), strict=True) if was != now])


def _state():
    classes = [cls for base in (bpy.types.Panel, bpy.types.Operator, bpy.types.Menu, bpy.types.UIList,
                                bpy.types.PropertyGroup, bpy.types.RenderEngine) for cls in _below(base)]
    ours = [cls for cls in classes if cls.__name__.startswith(("ENCRE_", "Encre"))]
    handlers = [handler for name in dir(bpy.app.handlers) if isinstance(getattr(bpy.app.handlers, name), list)
                for handler in getattr(bpy.app.handlers, name)]
    drawn = [function for cls in classes for function in getattr(vars(cls).get("draw"), "_draw_funcs", ())]
    return {
        "registered": sorted(name for name in dir(bpy.types) if name.startswith(("ENCRE_", "Encre"))),
        "classes": sorted(cls.__name__ for cls in ours if cls.is_registered),
        "every class": len(ours),
        "handlers": [handler.__module__ for handler in handlers if handler.__module__.startswith("encre")],
        "drawn": [function.__module__ for function in drawn if function.__module__.startswith("encre")],
        "engines": [cls.__name__ for cls in classes if "ENCRE" in getattr(cls, "COMPAT_ENGINES", ())
                    and cls not in ours],
        "properties": [owner for owner in ("Scene", "ViewLayer", "Object", "Material")
                       if hasattr(getattr(bpy.types, owner), "encre")],
    }


def _below(cls):
    for sub in cls.__subclasses__():
        yield sub
        yield from _below(sub)


def inked_file(out):
    """Layers of a file that holds no picture without ink, as the image editor saves them."""
    from encre.blender import memory, opened

    scene = stage(16, 16, 1)
    scene.encre.layer_source, scene.encre.save_layers = "ENCRE", "OFF"
    fact("shot", shoot(out, "inked"))
    name = next(name for name in sorted(os.listdir(out)) if name.startswith("inked"))
    fact("lacks", opened.load(scene, os.path.join(out, name)))
    memory.forget()
