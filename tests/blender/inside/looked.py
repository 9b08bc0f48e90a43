# SPDX-License-Identifier: GPL-3.0-or-later
"""What the study draws and moves, without its window: two looks of one moment, the camera's way, the free camera."""

import bpy
import numpy as np
from studio import fact, material, shoot, stage


def _striped(name, metallic):
    """A material of stripes that shines in their colours."""
    made = material(name, (1, 1, 1))
    texels = np.ones((64, 64, 4), np.float32)
    texels[:, 16:40, :3] = 0.6, 0.1, 0.1
    image = bpy.data.images.new(name, 64, 64)
    image.pixels.foreach_set(texels.ravel())
    image.update()
    node, surface = made.node_tree.nodes.new("ShaderNodeTexImage"), made.node_tree.nodes["Principled BSDF"]
    node.image = image
    made.node_tree.links.new(node.outputs[0], surface.inputs["Base Color"])
    surface.inputs["Metallic"].default_value, surface.inputs["Roughness"].default_value = metallic, 0.3
    return made


def two_looks(_out):
    scene = stage(ground=False)
    bpy.ops.encre.preset(preset="inter_color")
    scene.encre.line_density = 1
    for name, metallic in ("Cube", 0.0), ("Ball", 1.0):
        mesh = bpy.data.objects[name].data
        flat = np.empty(3 * len(mesh.vertices), np.float32)
        mesh.vertices.foreach_get("co", flat)
        points = flat.reshape(-1, 3)[[loop.vertex_index for loop in mesh.loops]]
        mesh.uv_layers.new(name="UVMap").data.foreach_set("uv", (points[:, (0, 2)] + points[:, 1:2]).ravel())
        mesh.materials.clear()
        mesh.materials.append(_striped(name, metallic))
    from encre.blender import bake, fast, pictures
    from encre.blender.study import baked, quadrants
    from encre.pen import background, shown
    from encre.pen.job import Frame

    baked.check(scene)
    looks = [quadrants.named(name) for name in ("dynamic", "baked")]
    settings = quadrants._Both([look.settings(scene, 1.0) for look in looks])
    depsgraph = bpy.context.evaluated_depsgraph_get()
    camera, kept = scene.camera.evaluated_get(depsgraph), fast.Kept()
    clean = fast.read(depsgraph, settings, (0.1, 100), kept, camera)
    drawn = {task.image.name_full: baked.levels(task, scene)[0][::-1] for task in bake.tasks(scene.objects)}
    lined = fast.repainted(clean, depsgraph, pictures.Instead(kept.images, drawn))
    eye = np.array(camera.matrix_world.inverted()), np.array(camera.calc_matrix_camera(depsgraph, x=160, y=90))

    def steps(of):
        return of.steps(*eye, Frame(160, 90), (160, 90), settings)

    def both():
        done = []
        one, view = yield from quadrants._noting(steps(clean), done)
        other, _ = yield from quadrants._again(steps(lined), done)
        panes = []
        for layers, own in zip((one, other), settings.of, strict=True):
            panes.append((yield from shown.picture(shown.Drawing(layers, view, Frame(160, 90), own, {}), shown.Wish())))
        return other, panes

    shared, panes = background.run(both())
    alone, _ = background.run(steps(lined))
    plain, _ = background.run(steps(clean))
    fact("shared", {name: shared[name].points.tobytes() == alone[name].points.tobytes() if name == "chains"
                    else bool(np.array_equal(shared[name], alone[name])) for name in alone})
    fact("shines", bool(plain["highlights"].any()))
    fact("lined", float((np.abs(shared["albedo"] - plain["albedo"]).max(2) > 0.1).mean()))
    fact("looks differ", float((np.abs(panes[0] - panes[1]).max(2) > 0.1).mean()))
    fact("colours in the frame", [settings.of[0].every[0]["line_color_strength"],
                                  settings.of[1].every[0]["line_color_strength"]])


def walks(_out):
    """A camera that is pushed about at random in a box with a post, which is open on one side."""
    scene = stage(ground=False)
    from encre.blender import fast, properties
    from encre.blender.study.flight import Flight, Free, Room
    from encre.pen.errors import EncreError

    for obj in [obj for obj in scene.objects if obj.type == "MESH"]:
        bpy.data.objects.remove(obj)
    mesh = bpy.data.meshes.new("Box")
    corners = [(x, y, z) for x in (-2, 2) for y in (-2, 2) for z in (0, 2.4)]
    mesh.from_pydata(corners, [], [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (0, 2, 6, 4), (1, 5, 7, 3)])  # not y = 2
    scene.collection.objects.link(bpy.data.objects.new("Box", mesh))
    post = bpy.data.objects.new("Post", mesh.copy())
    post.scale, post.location = (0.1, 0.1, 1), (0.5, 0, 0)
    scene.collection.objects.link(post)
    camera = scene.camera

    def flight():
        try:
            return Flight(scene, bpy.context.evaluated_depsgraph_get)
        except EncreError as error:
            return str(error)

    fact("still", flight())
    for frame, at in (1, (-1, -1, 1)), (25, (-1, 1, 1.5)):
        camera.location = at
        camera.keyframe_insert("location", frame=frame)
    scene.frame_end = 25
    way = flight()
    fact("way", [[*way.at(share)[0]] for share in (0, 1)] + [way.seconds])
    depsgraph = bpy.context.evaluated_depsgraph_get()
    read = fast.read(depsgraph, properties.settings(scene), (0.1, 100))
    room = Room.of(read, way.stops(), 0.01)
    fact("room", [[*room.low], [*room.high], room.radius])
    free, chance = Free(room, *way.at(0.5)), np.random.default_rng(1)
    places, nearest = [], []
    for step in range(4000):
        if step % 50 == 0:
            push = chance.uniform(-1, 1, 3)
        free.look(*chance.uniform(-60, 60, 2))
        free.push(*push.tolist(), 1 / 30)
        places.append([*free.place])
        nearest.append(room.walls.find_nearest(free.place)[3])
    fact("walked", [np.min(places, 0).tolist(), np.max(places, 0).tolist(), min(nearest)])


def books(out):
    """Four boxes side by side in one mesh, seen from the front, in looks of ink alone."""
    scene = stage(ground=False)
    for obj in [obj for obj in scene.objects if obj.type == "MESH"]:
        bpy.data.objects.remove(obj)
    mesh, points, faces = bpy.data.meshes.new("Books"), [], []
    for k in range(4):
        points += [(k - 2 + x, y, z) for x in (0, 1) for y in (-1, 1) for z in (-1, 1)]
        faces += [[8 * k + i for i in face] for face in ((0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6),
                                                         (0, 2, 6, 4), (1, 5, 7, 3))]
    mesh.from_pydata(points, [], faces)
    mesh.materials.append(material("Cloth", (0.6, 0.4, 0.2)))
    scene.collection.objects.link(bpy.data.objects.new("Books", mesh))
    scene.camera.location, scene.camera.rotation_euler = (0, -9, 0), (1.5708, 0, 0)
    for name in "ink_only", "brush_ink":
        bpy.ops.encre.preset(preset=name)
        scene.encre.save_layers = "ON"
        fact(name, shoot(out, name))
