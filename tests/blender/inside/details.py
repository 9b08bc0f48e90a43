# SPDX-License-Identifier: GPL-3.0-or-later
"""Cases that render next to nothing: what is read of a scene, what panels show, what operators do."""

import bpy
from studio import cube, fact, link, shoot, stage


def details(out):
    scene = stage(32, 18, 1)
    _groups()
    _edges()
    _threads(scene, out)
    _rules(scene)
    _blots(scene)
    _updates()
    _operators()


def _groups():
    """The object numbers of instances, by the name of what they show; those of a line group share one."""
    from encre.blender import meshes

    for group in ("", "pair"):
        inside = bpy.data.collections.new(f"Inside {group}")
        cube(f"Inner {group}", (0, 0, 0), 0.2, collection=inside).encre.line_group = group
        for k in range(3):
            empty = link(f"Copy {group} {k}", None, (k, 1, 0))
            empty.instance_type, empty.instance_collection = "COLLECTION", inside
    bpy.data.objects["Cube"].encre.line_group = "pair"
    depsgraph = bpy.context.evaluated_depsgraph_get()
    names = [i.object.name for i in depsgraph.object_instances if i.object.type == "MESH"]
    numbers = meshes.extract(depsgraph, True, None).numbers[1:]
    fact("numbers", [[name, float(number)] for name, number in zip(names, numbers, strict=True)])


def _edges():
    """How many edges of a cube's triangles are never lines, with an attribute of this name, domain and type on one."""
    from encre.blender import meshes
    from encre.pen.job import EDGES

    def never(name, domain="EDGE", kind="BOOLEAN"):
        made = cube("Told", (0, 0, 0))
        attribute = made.data.attributes.new(name, kind, domain)
        attribute.data[0].value = True
        found = meshes.extract(bpy.context.evaluated_depsgraph_get(), True, None)
        bpy.data.objects.remove(made)
        return max(int(sum(((m.edges >> shift) & 3 == EDGES["none"]).sum() for shift in (0, 2, 4)))
                   for m in found.meshes if len(m.points) == 8)  # there are other cubes

    fact("never lines", [never("encre_no_line"), never("other"), never("encre_no_line", "POINT"),
                         never("encre_no_line", "EDGE", "INT")])


def _threads(scene, out):
    """How many threads the library is asked for."""
    from encre.pen import library

    asked, own = [], (library.draw, library.raster)

    def watch(call):
        def watched(*args, **more):
            asked.append(more["threads"] if "threads" in more else args[9])
            return call(*args, **more)
        return watched

    library.draw, library.raster = map(watch, own)
    for mode in ("FIXED", "AUTO"):
        scene.render.threads_mode, scene.render.threads = mode, 3
        shoot(out, mode)
        fact(mode, asked[:])
        asked.clear()
    library.draw, library.raster = own


def _rules(scene):
    """Whether Full Contrast can be set: where Local Contrast is off."""
    from encre.blender.panels import rows
    from encre.pen import library

    rule = library.params()["contrast_full"].enabled_if
    settings = scene.encre
    for detector, auto in (("CONTRAST", False), ("CONTRAST", True), ("DOG", False)):
        settings.color_detector, settings.contrast_local = detector, auto
        fact("enabled", [rule, detector, auto, rows.enabled(settings, rule)])


def _blots(scene):
    """What the panel says of lines in pixels, in frames of three sizes."""
    from encre.blender.panels import front as panel

    settings, render = scene.encre, scene.render
    settings.length_unit, settings.line_thickness = "PIXELS", 22
    for height, percent in ((1080, 100), (1080, 50), (200, 100)):
        render.resolution_y, render.resolution_percentage = height, percent
        fact("blots", panel.blots(scene))
    settings.length_unit = "RELATIVE"
    fact("blots", panel.blots(scene))


def _updates():
    """Which of our properties have no update, without which a script's change is not seen. Collections can't have one,
    and what is computed changes with what it is of."""
    from encre.blender import properties

    every = [(cls.__name__, name, made) for cls in properties._classes().values()
             for name, made in cls.__annotations__.items()]
    fact("without update", [[owner, name] for owner, name, made in every if made.keywords.get("update") is None
                            and "get" not in made.keywords and made.function is not bpy.props.CollectionProperty])
    fact("properties", len(every))


def _operators():
    """The options of all operators."""
    operators = [cls for cls in bpy.types.Operator.__subclasses__() if cls.__name__.startswith("ENCRE_OT_")]
    fact("options", {cls.__name__: sorted(cls.bl_options) for cls in operators})
