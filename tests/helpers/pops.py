# SPDX-License-Identifier: GPL-3.0-or-later
"""Ink that appears or vanishes from one frame to the next beside what motion explains: a table for docs/animation.md.

    python tests/helpers/pops.py FOLDER [FILM [LOOK]]  renders 24 frames each of a pan, a turn and a walk into FOLDER,
                                                     or takes those there; needs bpy

A pixel of ink is moved as the surfaces do that its ray meets and those about it, up to half a thick line away: each may
be the one that the line lies on. It is explained if ink is near any of these places in the other frame, or if one lies
out of the frame, or if the nearest of them is hidden there. Both ways: what is not explained has vanished, or appeared.
"""

import os
import sys
import traceback
from math import radians, sin
from pathlib import Path

import bpy
import exr
import numpy as np
import turn
from encre.cli import images, inside
from mathutils import Vector
from mathutils.bvhtree import BVHTree

SCENES = Path(__file__).parents[2] / "scenes"
WIDTH, HEIGHT, FRAMES = 960, 540, 24
MESHES = {"flat_colors": 0, "line_color_strength": 0, "line_shadow_strength": 0, "line_mirror_strength": 0,
          "line_suggestive_strength": 0}
LOOKS = {"Ink only, lines of meshes": ("ink_only", MESHES), "Brush ink, lines of meshes": ("brush_ink", MESHES),
         "Ink only": ("ink_only", {}), "Brush ink": ("brush_ink", {})}
INKED = 0.25   # ink of a pixel that is looked for
GONE = 0.125   # where no pixel near has as much, there is no ink
REACH = 1.5    # pixels
AROUND = [far * np.array(way) for far in (0, 1, 2.5, 5) for way in (((0, 0),) if not far else (
    (1, 1), (1, -1), (-1, 1), (-1, -1), (1.4, 0), (-1.4, 0), (0, 1.4), (0, -1.4)))]  # pixels
APART = 1e-4   # share of its distance by which a point may lie behind what the eye meets there and still be seen


# ---- three films ---------------------------------------------------------------------------------------------------

def pan():
    """The street: the camera goes aside and up by about a pixel a frame."""
    import street
    street.build()
    eye = bpy.context.scene.camera
    aside, up = (eye.matrix_world.to_3x3() @ Vector(way) for way in ((1, 0, 0), (0, 1, 0)))
    start = eye.location.copy()
    return lambda k: setattr(eye, "location", start + k * (0.007 * aside + 0.004 * up))


def around():
    """The living room: the camera stands in its flight's middle and turns by a quarter of a degree a frame."""
    import living_room
    living_room.build()
    scene = bpy.context.scene
    scene.frame_set(70)
    eye = scene.camera
    world = eye.matrix_world.copy()
    eye.animation_data_clear()
    eye.constraints.clear()
    eye.matrix_world = world
    turned = eye.rotation_euler.copy()
    return lambda k: setattr(eye, "rotation_euler", (turned.x, turned.y, turned.z + radians(0.25 * k)))


def walk():
    """The dancer, whose legs, skirt and arms follow bones."""
    import dancer
    dancer.build()
    scene = bpy.context.scene
    bones = {"leg left": (0.08, 0, 0.95), "leg right": (-0.08, 0, 0.95), "arm left": (0.2, 0, 1.38),
             "arm right": (-0.2, 0, 1.38)}
    rig = bpy.data.objects.new("Rig", bpy.data.armatures.new("Rig"))
    scene.collection.objects.link(rig)
    rig.matrix_world = bpy.data.objects["Dancer"].matrix_world
    bpy.context.view_layer.objects.active = rig
    bpy.ops.object.mode_set(mode="EDIT")
    for name, at in bones.items():
        bone = rig.data.edit_bones.new(name)
        bone.head, bone.tail = at, Vector(at) + Vector((0, 0.2, 0))
    bpy.ops.object.mode_set(mode="OBJECT")
    for obj in [obj for obj in scene.objects if obj.type == "MESH"]:
        names = named(obj)
        if names:
            skin(obj, rig, names)
    turns = [rig.pose.bones[name] for name in bones]
    for bone in turns:
        bone.rotation_mode = "XYZ"

    def step(k):
        swing = 0.25 * sin(2 * np.pi * k / 48)
        for bone, share in zip(turns, (1, 0.7, -0.5, 0.5), strict=True):
            bone.rotation_euler = (share * swing, 0, 0)
    return step


def named(obj):
    """The bones that a thing follows, and over which heights it comes to follow them; None: none."""
    name = obj.name
    for side in ("left", "right"):
        for limb, parts in (("leg", ("Leg", "Shoe body", "Heel")), ("arm", ("Arm", "Hand"))):
            if name in [f"{part} {side}" for part in parts]:
                return {f"{limb} {side}": (0.95, 0.8) if limb == "leg" else None}
    if name in ("Skirt", "Sash fringe"):
        return {"leg left": (1.0, 0.4), "leg right": (1.0, 0.4)}
    if name.startswith("Fan"):
        return {"arm left": None}
    return None


def skin(obj, rig, names):
    """Weights of bones by height in the figure's own space."""
    into = rig.matrix_world.inverted() @ obj.matrix_world
    for name, ramp in names.items():
        group = obj.vertex_groups.new(name=name)
        for vertex in obj.data.vertices:
            at = into @ vertex.co
            weight = 1.0 if not ramp else min(max((ramp[0] - at.z) / (ramp[0] - ramp[1]), 0), 1)
            if name.startswith("leg") and len(names) > 1:  # the skirt: by sides
                weight *= 0.5 * min(max(0.5 + (at.x if "left" in name else -at.x) / 0.3, 0), 1)
            if weight > 0:
                group.add([vertex.index], weight, "REPLACE")
    modifier = obj.modifiers.new("Armature", "ARMATURE")
    modifier.object = rig
    while obj.modifiers[0] != modifier:
        bpy.context.view_layer.objects.active = obj
        bpy.ops.object.modifier_move_up(modifier="Armature")


FILMS = {"street, a pan": pan, "living room, a turn": around, "dancer, a walk": walk}


# ---- frames --------------------------------------------------------------------------------------------------------

class Moment:
    """Where all surfaces are in a frame."""

    def __init__(self, scene):
        self.view = turn.View(scene, scene.frame_current, (WIDTH, HEIGHT))
        points, corners, first = [], [], 0
        for instance in bpy.context.evaluated_depsgraph_get().object_instances:
            obj = instance.object
            if obj.type not in {"MESH", "CURVE", "FONT"} or not instance.show_self or obj.hide_render:
                continue
            mesh, world = obj.to_mesh(), np.array(instance.matrix_world)
            mesh.calc_loop_triangles()
            co = np.empty(3 * len(mesh.vertices), np.float32)
            mesh.vertices.foreach_get("co", co)
            tri = np.empty(3 * len(mesh.loop_triangles), np.int32)
            mesh.loop_triangles.foreach_get("vertices", tri)
            points.append(co.reshape(-1, 3) @ world[:3, :3].T + world[:3, 3])
            corners.append(tri.reshape(-1, 3) + first)
            first += len(points[-1])
            obj.to_mesh_clear()
        self.points, self.corners = np.concatenate(points), np.concatenate(corners)
        self.tree = BVHTree.FromPolygons(self.points.tolist(), self.corners.tolist(), all_triangles=True)
        self.back = np.linalg.inv(self.view.matrix)

    def rays(self, at):
        """Unit ways from the eye through places (n, 2)."""
        clip = np.stack([(at[:, 0] + 0.5) / WIDTH * 2 - 1, 1 - (at[:, 1] + 0.5) / HEIGHT * 2,
                         np.ones(len(at)), np.ones(len(at))], 1)
        far = clip @ self.back.T
        way = far[:, :3] / far[:, 3:] - self.view.eye
        return way / np.linalg.norm(way, axis=1, keepdims=True)

    def hits(self, at):
        """Faces that rays through places meet (-1: none), how far away, and where in them (n, 3)."""
        ways, eye = self.rays(at), Vector(self.view.eye)
        face, far = np.full(len(at), -1), np.full(len(at), np.inf)
        place = np.zeros((len(at), 3))
        for k, way in enumerate(ways):
            where, _, index, reach = self.tree.ray_cast(eye, Vector(way))
            if where is not None:
                face[k], far[k], place[k] = index, reach, where
        return face, far, place, ways

    def weights(self, face, place):
        """Of the corners of faces, at places in them."""
        a, b, c = (self.points[self.corners[face, k]] for k in range(3))
        u, v, w = b - a, c - a, place - a
        uu, uv, vv, wu, wv = ((p * q).sum(1) for p, q in ((u, u), (u, v), (v, v), (w, u), (w, v)))
        d = np.maximum(uu * vv - uv * uv, 1e-30)
        s, t = (vv * wu - uv * wv) / d, (uu * wv - uv * wu) / d
        return np.stack([1 - s - t, s, t], 1)

    def seen(self, points):
        """Which points nothing hides."""
        eye, found = Vector(self.view.eye), np.zeros(len(points), bool)
        for k, point in enumerate(points):
            way = Vector(point) - eye
            *_, reach = self.tree.ray_cast(eye, way.normalized())
            found[k] = reach is None or reach > (1 - APART) * way.length
        return found


def unexplained(ink, moment, ink_then, then):
    """(x, y) of pixels of ink of a frame that have none in the other."""
    y, x = np.nonzero(ink >= INKED)
    at = np.stack([x, y], 1).astype(float)
    near_then = spread(ink_then >= GONE)
    nearest, hidden = np.full(len(at), np.inf), np.zeros(len(at), bool)
    explained = np.zeros(len(at), bool)
    places = np.zeros((len(at), 3))
    for aside in AROUND:
        left = np.flatnonzero(~explained)
        if not len(left):
            break
        face, far, place, ways = moment.hits(at[left] + aside)
        moved = then.view.eye + ways * 1e6  # nothing there: it is infinitely far
        met = face >= 0
        if met.any():
            w = moment.weights(face[met], place[met])
            moved[met] = (then.points[then.corners[face[met]]] * w[..., None]).sum(1)
        to, z = then.view.project(moved)
        to -= aside
        px = np.rint(to).astype(int)
        inside = (z > 0) & np.all((px >= 2) & (px < (WIDTH - 2, HEIGHT - 2)), 1)
        fine = ~inside
        fine[inside] = near_then[px[inside, 1], px[inside, 0]]
        explained[left] |= fine
        closer = far < nearest[left]
        nearest[left[closer]] = far[closer]
        places[left[closer]] = moved[closer]
    left = np.flatnonzero(~explained & np.isfinite(nearest))
    hidden[left] = ~then.seen(places[left])
    return np.stack([x, y], 1)[~explained & ~hidden]


def spread(mask):
    """All pixels with one of the mask within REACH."""
    out, reach = mask.copy(), int(REACH)
    high, wide = mask.shape
    for dy in range(-reach, reach + 1):
        for dx in range(-reach, reach + 1):
            if dx * dx + dy * dy <= REACH * REACH:
                out[max(dy, 0):high + min(dy, 0), max(dx, 0):wide + min(dx, 0)] |= \
                    mask[max(-dy, 0):high + min(-dy, 0), max(-dx, 0):wide + min(-dx, 0)]
    return out


def named_file(film, look):
    return f"{film}_{look}".replace(", ", "_").replace(" ", "_").lower()


def shoot(folder, film, look, start):
    """Ink of all frames, and where surfaces are."""
    bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)
    move = FILMS[film]()
    scene = bpy.context.scene
    scene.render.resolution_x, scene.render.resolution_y = WIDTH, HEIGHT
    scene.render.resolution_percentage = 100
    scene.render.engine = "ENCRE"
    scene.render.use_persistent_data = True
    scene.render.image_settings.file_format = "OPEN_EXR_MULTILAYER"
    scene.view_layers[0].encre.use_pass_lines = True
    preset, values = LOOKS[look]
    bpy.ops.encre.preset(preset=preset)
    for id_, value in values.items():
        setattr(scene.encre, id_, value)
    scene.encre.save_layers = "OFF"
    ink, moments = [], []
    for k in range(FRAMES):
        move(k)
        path = folder / f"{named_file(film, look)}{k:02}.exr"
        if not path.exists():
            scene.render.filepath = str(path.with_suffix(".part.exr"))
            bpy.ops.render.render(write_still=True)
            Path(scene.render.filepath).rename(path)
        ink.append(exr.part(path, "ViewLayer.Encre Lines")[..., 3])
        bpy.context.view_layer.update()
        moments.append(start[k] if start else Moment(scene))
    return ink, moments


def main():
    folder = Path(sys.argv[1])
    folder.mkdir(parents=True, exist_ok=True)
    sys.path.insert(0, str(SCENES))
    inside.register()
    print("| film | look | ink, pixels a frame | appears | vanishes | share |\n|---|---|---|---|---|---|", flush=True)
    for film in FILMS:
        if sys.argv[2:] and film.split(",")[0] not in sys.argv[2:]:
            continue
        moments = None
        for look in LOOKS:
            if sys.argv[3:] and look not in sys.argv[3:]:
                continue
            ink, moments = shoot(folder, film, look, moments)
            counts, total = np.zeros(2, int), 0
            for k in range(1, FRAMES):
                total += (ink[k] >= INKED).sum()
                for way, (a, b) in enumerate(((k, k - 1), (k - 1, k))):
                    off = unexplained(ink[a], moments[a], ink[b], moments[b])
                    counts[way] += len(off)
                    if len(off):
                        mark(folder / f"pops_{named_file(film, look)}{a:02}_{b:02}.png", ink[a], ink[b], off)
            print(f"| {film} | {look} | {total // (FRAMES - 1)} | {counts[0]} | {counts[1]} | "
                  f"{counts.sum() / (2 * total):.4%} |", flush=True)


def mark(path, ink, then, off):
    """Both frames over each other, blue the other one, and what has popped red."""
    picture = np.stack([1 - np.maximum(0.3 * ink, then), 1 - 0.9 * np.maximum(ink * 0.6, then * 0.5), 1 - ink], 2)
    for x, y in off:
        picture[y, x] = 1, 0, 0
    images.write_textures({str(path): images.Texture(picture.astype(np.float32), "uint8", False, False)})


if __name__ == "__main__":
    try:
        main()
        status = 0
    except Exception:
        traceback.print_exc()
        status = 1
    sys.stdout.flush()
    os._exit(status)  # Blender's own threads may wait for each other at the end
