# SPDX-License-Identifier: GPL-3.0-or-later
"""The case of how far away what the picture is about stands."""

import bpy
import numpy as np
from studio import fact, register, world


def distances(_out):
    bpy.ops.wm.read_factory_settings(use_empty=True)
    register()
    from encre.blender import lamps, meshes, subject

    scene = bpy.context.scene

    def cube(place, size=1.0):
        bpy.ops.mesh.primitive_cube_add(size=size, location=place)
        return bpy.context.object

    def read(lens=50.0):
        camera.lens = lens
        graph = bpy.context.evaluated_depsgraph_get()
        there = scene.camera.evaluated_get(graph)
        view = np.array(there.matrix_world.inverted())
        projection = np.array(there.calc_matrix_camera(graph, x=160, y=90))
        about = subject.read(graph, there)
        return about.distance(view, projection), about.light

    def reached():
        """Full light where shadows are known."""
        graph = bpy.context.evaluated_depsgraph_get()
        light = lamps.Light(graph, (0.1, 100))
        meshes.extract(graph, False, None, light)
        return subject.read(graph, None, light).light

    def distance(lens=50.0):
        return read(lens)[0]

    camera = bpy.data.cameras.new("Camera")
    scene.camera = bpy.data.objects.new("Camera", camera)
    scene.collection.objects.link(scene.camera)
    scene.camera.location = 0, 0, 20
    fact("nothing", distance())
    fact("dark", read()[1])
    lamp = bpy.data.lights.new("Lamp", "POINT")
    lamp.energy = 400.0
    lamp = bpy.data.objects.new("Lamp", lamp)
    lamp.location = 0, 0, 12
    for x in (-6, -3, 0, 3, 6):
        cube((x, 0, 0))
    fact("plain", distance())
    scene.collection.objects.link(lamp)
    light = [read()[1]]
    scene.camera.location.x = 40
    light.append(read()[1])
    scene.camera.location.x = 0
    fact("point", light)
    lamp.data.color[0], lamp.data.energy = 1e38, 3e38
    light = lamps.Light(bpy.context.evaluated_depsgraph_get(), (0.1, 100))
    fact("endless", [light.unknown, light.lamps])
    lamp.data.color[0], lamp.data.energy = 1, 400
    night(scene, lamp, cube, reached)
    lamp.data.type, lamp.data.energy = "SUN", 4.0
    fact("sun", read()[1])
    world(scene, (0.25, 0.5, 0.125))
    fact("sun and world", read()[1])
    fact("street", reached())
    roof = cube((0, 0, 9), 30)
    roof.scale.z = 0.1
    world(scene, (0.01, 0.02, 0.02))
    fact("room", [read()[1], reached()])
    bpy.data.objects.remove(roof)
    world(scene, (0.25, 0.5, 0.125))
    bpy.data.objects.remove(lamp)
    fact("world", read()[1])
    cube((0, 0, -5000), 10000)
    fact("ground", distance())
    flies = cube((50, 0, 0))
    flies.keyframe_insert("location", frame=1)
    flies.location = -900, 4, 4
    flies.keyframe_insert("location", frame=10)
    child = cube((1, 0, 0))
    child.parent = flies
    frames = []
    for frame in (1, 5, 10):
        scene.frame_set(frame)
        frames.append(distance())
    fact("frames", frames)
    fact("long lens", distance(100.0) / distance())
    camera.dof.focus_distance = 7
    fact("no focus", distance() != 7)
    camera.dof.use_dof = True
    fact("focus", distance())
    camera.dof.focus_object = bpy.data.objects["Cube.001"]
    fact("focus object", distance(100.0))
    camera.dof.focus_object.location.z = 30  # behind the camera
    fact("behind", distance())
    for obj in scene.objects:
        if obj.type == "MESH":
            obj.constraints.new("COPY_SCALE")
    camera.dof.focus_object = None
    camera.dof.use_dof = False
    fact("all move", distance())


def metered(_out):
    """Full light and shade, however the scene is looked at and built, and whatever moves in it."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    register()
    from encre.blender import fast, properties

    scene = bpy.context.scene
    scene.camera = bpy.data.objects.new("Camera", bpy.data.cameras.new("Camera"))
    scene.collection.objects.link(scene.camera)

    def read():
        graph = bpy.context.evaluated_depsgraph_get()
        camera = scene.camera.evaluated_get(graph)
        about = fast.read(graph, properties.settings(scene), (0.1, 100), None, camera).subject
        return [about.light, about.shade]

    def build(order):
        for obj in [obj for obj in scene.objects if obj.type == "MESH"]:
            bpy.data.objects.remove(obj)
        bpy.ops.mesh.primitive_plane_add(size=60)
        for k in order:
            bpy.ops.mesh.primitive_cube_add(size=1, location=(3 * k - 6, k % 2, 1.5 + 0.2 * k))

    world(scene, (0.5, 0.65, 0.72))
    for name in ("One", "Two"):
        sun = bpy.data.objects.new(name, bpy.data.lights.new(name, "SUN"))
        sun.data.energy = 1
        scene.collection.objects.link(sun)
    build(range(5))
    fact("pale", read())
    scene.camera.location, scene.camera.data.lens = (30, 2, 9), 200
    fact("elsewhere", read())
    build(reversed(range(5)))
    fact("reversed", read())
    bpy.ops.mesh.primitive_cube_add(size=8, location=(0, 0, 6))
    roof = bpy.context.object
    roof.keyframe_insert("location", frame=1)
    roof.location.x = 40
    roof.keyframe_insert("location", frame=9)
    moving = []
    for frame in (1, 4, 9):
        scene.frame_set(frame)
        moving.append(read())
    fact("moving", moving)
    bpy.ops.encre.meter()
    fact("kept", [scene.encre.shade_meter, scene.encre.meter_light, scene.encre.meter_shade])
    world(scene, (0.1, 0.15, 0.15))
    fact("usual", read())
    from encre.blender import lamps

    def sides(amount):
        """Light of the world above, toward +X, -X, +Y, -Y and below."""
        graph = bpy.context.evaluated_depsgraph_get()
        ways = irradiance.polynomials(np.array([(0.0, 0, 1), (1, 0, 0), (-1, 0, 0), (0, 1, 0), (0, -1, 0), (0, 0, -1)]))
        return (ways @ lamps.Light(graph, (0.1, 100), planes=amount).world)[:, 0].tolist()

    from encre.pen import irradiance

    fact("even", sides(0.6))
    bpy.data.objects["One"].rotation_euler = (0, 1.2, 0)  # from +X
    bpy.context.view_layer.update()
    fact("from x", sides(0.6))
    fact("no planes", sides(0.0))
    for name in ("One", "Two"):
        bpy.data.objects.remove(bpy.data.objects[name])
    scene.world.use_nodes = True
    tree = scene.world.node_tree
    sky = tree.nodes.new("ShaderNodeTexSky")
    sky.sky_type = "NISHITA" if bpy.app.version < (5, 0) else "SINGLE_SCATTERING"
    sky.sun_elevation = 1.0
    tree.links.new(sky.outputs[0], tree.nodes["Background"].inputs[0])
    fact("sky", read())
    sky.sun_elevation, sky.air_density = 0.5, 4.0
    fact("low", read())
    from encre.blender import skies

    # What a floor in the shade has of the sky, by the brightest channel.
    up = irradiance.polynomials(np.array([(0.0, 0, 1)])) @ skies.light(scene.world).ambient
    fact("below", float(np.max(up)))
    build([])
    bpy.ops.mesh.primitive_cube_add(size=1, location=(0, 0, 1))
    for frame, turn in (1, 0), (9, 1):
        bpy.context.object.rotation_euler.z = turn
        bpy.context.object.keyframe_insert("rotation_euler", frame=frame)
    window = bpy.data.images.new("Window", 128, 64, float_buffer=True)
    texels = np.full((64, 128, 4), 0.4, np.float32)
    texels[31:33, 60:68] = 200  # at the height of the horizon
    window.pixels.foreach_set(texels.ravel())
    picture = tree.nodes.new("ShaderNodeTexEnvironment")
    picture.image = window
    tree.links.new(picture.outputs[0], tree.nodes["Background"].inputs[0])
    around = skies.light(scene.world)
    sides = irradiance.polynomials(np.array([(0.0, 0, 1), (0, 0, -1)])) @ around.ambient
    fact("window", [read()[0], float(np.max(sides)), float(np.max(around.suns[0].color)) / np.pi])


def night(scene, lamp, cube, reached):
    """Full light of cubes below a lamp; with a town far away; in moonlight; of a sunlit town with a lamp in a room."""
    before = lamp.location.z
    lamp.location.z = 3
    moon = bpy.data.objects.new("Moon", bpy.data.lights.new("Moon", "SUN"))
    moon.data.energy = 0.1
    alone = [reached()]
    town = [cube((x, y, 0), 2) for x in range(150, 250, 5) for y in range(-50, 50, 5)]
    alone.append(reached())
    scene.collection.objects.link(moon)
    alone.append(reached())
    for thing in town[:200]:
        thing.scale = 0.5, 0.5, 0.5
    alone.append(reached())
    fact("night", alone)
    moon.data.energy = 4.0
    lamp.hide_render = lamp.hide_viewport = True
    day = [reached()]
    lamp.hide_render = lamp.hide_viewport = False
    room = [cube((0, 0, 5), 20), cube((0, 0, 4), 20)]
    room[0].scale.z = room[1].scale.z = 0.05
    room[1].location.z = -1.5
    for x, y in (-9, 0), (9, 0), (0, -9), (0, 9):
        room.append(cube((x, y, 2), 20))
        room[-1].scale = (0.05, 1, 0.5) if x else (1, 0.05, 0.5)
    day.append(reached())
    fact("lamp in a room", day)
    for thing in (*town, *room, moon):
        bpy.data.objects.remove(thing)
    lamp.location.z = before
