# SPDX-License-Identifier: GPL-3.0-or-later
"""What drawn light costs beside a render of the same scene by Cycles at 16 samples.

    python tests/helpers/bench_light.py [--size WxH] [--rounds N]

Twenty balls of 10,000 triangles each over a plane, by three lamps without a size and by three with one. Processor
seconds of all threads: drawn light with its trees and the depth that it reads, Cycles' whole render without a denoiser.
"""

import argparse
import os
import sys
import time
from math import pi

import bench
import bpy
import numpy as np
from encre.pen import library
from encre.pen.job import Frame, Lamp, Mesh
from encre.pen.scene import Scene
from mathutils import Euler, Matrix

SAMPLES = 16
ASKED = {"hard lamps": 25, "soft lamps": 3}  # how much longer Cycles takes
CLIP = 0.1


def link(name, data, matrix):
    thing = bpy.data.objects.new(name, data)
    thing.matrix_world = matrix
    bpy.context.scene.collection.objects.link(thing)
    return thing


def build():
    bpy.ops.wm.read_factory_settings(use_empty=True)
    bpy.ops.mesh.primitive_plane_add(size=40)
    bpy.ops.mesh.primitive_uv_sphere_add(segments=100, ring_count=51)
    bpy.ops.object.shade_smooth()
    ball, rng = bpy.context.object, np.random.default_rng(3)
    for _ in range(20):
        thing = link("Ball", ball.data.copy(), Matrix())
        at = (*(rng.random(2) * 12 - 6), 0.3 + rng.random())
        thing.matrix_world = Matrix.Translation(at) @ Matrix.Scale(0.3 + 0.4 * rng.random(), 4)
    bpy.data.objects.remove(ball)
    camera = link("Camera", bpy.data.cameras.new("Camera"), Matrix.Translation((8, -11, 7)) @ Euler(
        (1.06, 0, 0.63)).to_matrix().to_4x4())
    bpy.context.scene.camera = camera


def lamps(soft):
    """The lamps of the scene, as Blender has them and as the library takes them."""
    found = []
    for kind, size, at in (("SUN", 0.05, (3, 1, 5)), ("POINT", 0.3, (4, -5, 5)),
                           ("AREA" if soft else "SPOT", 1.0, (-5, -5, 6))):
        lamp = bpy.data.lights.new(kind, kind)
        lamp.energy = 3 if kind == "SUN" else 800
        if kind == "SUN":
            lamp.angle = size * soft
        elif kind == "AREA":
            lamp.size = size
        else:
            lamp.shadow_soft_size = size * soft
        thing = link(kind, lamp, Matrix.Translation(at) @ Euler(
            (np.arctan2(np.hypot(at[0], at[1]), at[2]), 0, np.arctan2(at[1], at[0]) + pi / 2)).to_matrix().to_4x4())
        name = {"SUN": "sun", "POINT": "point", "SPOT": "spot", "AREA": "rectangle"}[kind]
        found.append((thing, Lamp(name, (lamp.energy,) * 3, width=size * (soft or kind == "AREA"),
                                  height=size, spot_angle=0.8, spot_blend=0.15, model=np.array(thing.matrix_world))))
    return found


def triangles(thing):
    mesh = thing.data
    mesh.calc_loop_triangles()
    points = np.empty((len(mesh.vertices), 3), np.float32)
    corners = np.empty((len(mesh.loop_triangles), 3), np.int32)
    normals = np.empty((len(mesh.loop_triangles), 3, 3), np.float32)
    mesh.vertices.foreach_get("co", points.ravel())
    mesh.loop_triangles.foreach_get("vertices", corners.ravel())
    mesh.loop_triangles.foreach_get("split_normals", normals.ravel())
    return points, corners, normals, np.array(thing.matrix_world)


def seconds(work):
    begin = time.process_time()
    work()
    return time.process_time() - begin


def drawn(things, lit, width, height):
    """Light of a scene that nobody has seen before."""
    camera, depsgraph = bpy.context.scene.camera, bpy.context.evaluated_depsgraph_get()
    view = np.linalg.inv(np.array(camera.matrix_world))
    projection = np.array(camera.calc_matrix_camera(depsgraph, x=width, y=height))
    scene, meshes = Scene(), []
    for k, (points, corners, normals, model) in enumerate(things):
        scene.geometry(k, points, corners, normals)
        scene.instance(k, k, model)
        meshes.append(Mesh(points, corners, model=model, object_index=k + 1))
    for k, (_, lamp) in enumerate(lit):
        scene.lamp(k, lamp)
    size = width, height
    depth = library.raster(meshes, view, projection, Frame(*size), size, CLIP, outputs=("depth",))["depth"]
    scene.light(depth, None, view, projection, Frame(*size), CLIP)


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--size", default="1920x1080")
    parser.add_argument("--rounds", type=int, default=3)
    args = parser.parse_args()
    width, height = map(int, args.size.split("x"))
    build()
    scene = bpy.context.scene
    scene.render.engine, scene.cycles.samples = "CYCLES", SAMPLES
    scene.cycles.use_denoising = scene.cycles.use_adaptive_sampling = False
    scene.render.resolution_x, scene.render.resolution_y = width, height
    things = [triangles(thing) for thing in scene.objects if thing.type == "MESH"]
    count = sum(len(corners) for _, corners, _, _ in things)
    print(f"drawn light and Cycles, {SAMPLES} samples, {width} x {height}, {count} triangles; processor seconds")
    for case, asked in ASKED.items():
        lit = lamps(case == "soft lamps")
        own = min(seconds(lambda lit=lit: drawn(things, lit, width, height)) for _ in range(args.rounds))
        other = seconds(bpy.ops.render.render)
        print(f"{case:12}{own:8.2f}{other:8.2f}: {other / own:.1f} times as long, asked {asked}", flush=True)
        told = f"Cycles at {SAMPLES} samples takes {other / own:.1f} times as long"
        bench.add("costs", {f"drawn light, {case}": (told, f"{asked} times")})
        for thing, _ in lit:
            bpy.data.objects.remove(thing)
    sys.stdout.flush()
    os._exit(0)  # Blender may hang where it ends


if __name__ == "__main__":
    main()
