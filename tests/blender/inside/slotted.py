# SPDX-License-Identifier: GPL-3.0-or-later
"""Cases of pens and tones in lists: names, what they are saved in, what is copied from one to another."""

import json
import os

import bpy
from studio import fact, stage


def _pens(scene):
    """What is shown and what is kept of pens."""
    settings = scene.encre
    return [[settings.pen_1_called, settings.pen_2_called, settings.pen_3_called], settings.line_crease_pen,
            settings.is_property_set("line_crease_pen")]


def pens(out):
    """Pens are named, saved, opened and undone."""
    from encre.blender import pens as named
    from encre.blender import properties
    from encre.pen import library

    scene, path = stage(16, 16, 1), os.path.join(out, "pens.blend")
    row = library.params()["line_crease_pen"]
    fact("first", _pens(scene))
    scene.encre.pen_2_called, scene.encre.line_crease_pen = " Sketch ", "PEN_2"
    fact("offered", [list(item) for item in named.items(row)(scene.encre, None)])
    scene.encre.styles.add().line_mark_pen = "PEN_3"
    bpy.ops.wm.save_as_mainfile(filepath=path)
    bpy.ops.wm.open_mainfile(filepath=path)
    scene = bpy.context.scene
    fact("opened", _pens(scene))
    fact("values", [properties.scene_values(scene)["line_crease_pen"], properties.styles(scene)])
    depsgraph = bpy.context.evaluated_depsgraph_get()
    fact("evaluated", _pens(depsgraph.scene_eval))
    scene.encre.pen_2_called = ""
    fact("unnamed", _pens(scene)[0])
    found = []
    for pen, text in (("pen_2", "Pen 1"), ("pen_3", "Pen 1"), ("pen_1", "Pen 1.001"), ("pen_2", "Very" * 30),
                      ("pen_3", "Very" * 30), ("pen_1", "Pen 1"), ("pen_2", ""), ("pen_3", "")):
        setattr(scene.encre, f"{pen}_called", text)
        found.append(_pens(scene)[0])
    fact("unique", found)
    scene.encre.line_crease_pen = "PEN_1"
    bpy.ops.encre.reset(param="line_crease_pen")
    fact("reset", _pens(scene)[2])


def pens_in_presets(_out):
    """A preset names the pens that it sets."""
    from encre.blender.panels import presets

    scene = stage(16, 16, 1)
    scene.encre.pen_2_called = "Mine"
    bpy.ops.encre.preset(preset="brush_ink")
    fact("brush", _pens(scene)[0])
    scene.encre.pen_2_called = "Mine"
    bpy.ops.encre.preset_save(name="Named", description="")
    fact("file", json.loads((presets.folder() / "named.json").read_text(encoding="utf-8"))["pens"])
    scene.encre.pen_2_called = "Other"
    bpy.ops.encre.preset(preset="ink_only")
    fact("ink only", _pens(scene)[0])
    bpy.ops.encre.preset(preset="named")
    fact("named", _pens(scene)[0])
    scene.encre.pen_1_called, scene.encre.pen_2_called = "Else", "Brush"
    bpy.ops.encre.preset(preset="named")
    fact("swapped", _pens(scene)[0])
    bpy.ops.encre.settings_copy(path="scene")
    other = bpy.data.scenes.new("Other")
    other.render.engine, bpy.context.window.scene = "ENCRE", other
    bpy.ops.encre.settings_paste(path="scene")
    fact("pasted", _pens(other)[0])
    for name, called in (("pen_2", "X"), ("pen_1", "Pen 2"), ("pen_2", "Pen 1")):
        setattr(other.encre, f"{name}_called", called)
    fact("each other's", _pens(other)[0])
    bpy.ops.encre.settings_copy(path="scene")
    bpy.ops.encre.settings_paste(path="scene")
    fact("pasted again", _pens(other)[0])


def slots(_out):
    """A pen and a tone take all that another has."""
    scene = stage(16, 16, 1)
    settings = scene.encre
    settings.pen_1_softness, settings.pen_1_wobble, settings.pen_2_width, settings.active_pen = 0.25, 3, 0.5, 1
    bpy.ops.encre.slot_copy(source="pen_1")
    fact("pen_1", [settings.pen_2_softness, settings.pen_2_wobble, settings.pen_2_width])
    settings.pen_3_grain, settings.pen_3_seed, settings.active_pen = 0.125, 7, 0
    bpy.ops.encre.slot_copy(source="pen_3")
    fact("first pen", [settings.pen_1_grain, settings.pen_1_seed, settings.line_thickness])
    for _ in range(3):
        bpy.ops.encre.level_add()  # the six of six tones
    image = bpy.data.images.new("Tile", 4, 4)
    settings.tone_4, settings.tone_4_pitch, settings.tone_4_image, settings.active_tone = "IMAGE", 150, image, 1
    bpy.ops.encre.slot_copy(source="tone_6")  # which is as the fourth
    fact("tone", [settings.tone_2, settings.tone_2_pitch, settings.tone_2_image == image])
    try:
        bpy.ops.encre.slot_copy(source="pen_4")
    except RuntimeError as error:  # as Blender raises what an operator reports
        fact("unknown", str(error))


def front(_out):
    """What the front panel says of several parameters: as looks set it, and as it is set."""
    from encre.blender import front as own
    from encre.pen import presets

    scene = stage(16, 16, 1)
    settings, said = scene.encre, ("small_lines", "hand", "far_lines", "shade_steps", "shade_edge", "fill", "rim_side",
                                   "paper_source")
    toggles = [f"draw_{name}" for name in own.TOGGLES]

    def now():
        return [getattr(settings, name) for name in said]

    settings.use_rim = True
    for look in ("pencil", "manga", "water_memory"):
        settings.look = look
        fact("look", [look, settings.preset, settings.layer_source, settings.use_rim,
                      [round(x, 3) if isinstance(x, float) else x for x in now()],
                      [getattr(settings, name) for name in toggles]])
    settings.look = "manga"
    values = {id_: getattr(settings, id_) for id_ in presets.find("manga").listed if id_ != "shade_levels"}
    for name in toggles:
        was = getattr(settings, name)
        setattr(settings, name, not was)
        fact("toggled", [name, was, getattr(settings, name)])
        setattr(settings, name, was)
    for name in ("small_lines", "hand", "far_lines"):
        was = getattr(settings, name)
        for share in (0.0, 0.25, 1.0):
            setattr(settings, name, share)
            fact("share", [name, share, getattr(settings, name)])
        setattr(settings, name, was)
    kept = {id_: getattr(settings, id_) for id_ in values}
    fact("changed by going there and back", [id_ for id_ in values if values[id_] != kept[id_]
                                             and not (isinstance(kept[id_], float)
                                                      and abs(kept[id_] - values[id_]) < 1e-3 * abs(kept[id_]))])
    for count in "1234":
        settings.shade_steps = count
        fact("steps", [settings.shade_steps, [[round(x, 3) for x in (level.intensity, level.threshold)]
                                              for level in settings.shade_levels]])
    settings.shade_edge = 0.5
    fact("edge", [settings.shade_edge, [round(level.transition, 3) for level in settings.shade_levels]])
    settings.shade_steps = "2"
    for name, *_ in own.FILLS:
        settings.fill = name
        fact("fill", [name, settings.fill, settings.use_tones, settings.tone_1, settings.tone_2])
    settings.tone_1_fill, settings.shade_levels[0].intensity = "SOLID", 0.0
    settings.tone_1_fill = "DOTS"
    fact("dots", [settings.tone_1, settings.shade_levels[0].intensity])
    for side in (*own.SIDES, "WORLD"):
        settings.rim_side = side
        fact("side", [side, settings.rim_side, settings.rim_spread, settings.rim_angle])
