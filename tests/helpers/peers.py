# SPDX-License-Identifier: GPL-3.0-or-later
"""Lines of scenes that no setting was chosen on, Encre's beside Freestyle's and Line Art's: writes docs/peers.md.

    python tests/helpers/peers.py FOLDER [SCENE ...]      renders the scenes of strangers.py into FOLDER, or takes
                                                          what is there; needs bpy

The truth comes from meshes and camera alone: edges that bend by BEND or more, ends of surfaces, and outlines, wherever
a ray from the eye reaches them. Points on them are sought in each picture's ink.
"""

import contextlib
import os
import sys
from collections import defaultdict
from pathlib import Path

import bpy
import exr
import numpy as np
import strangers
import turn
from encre.cli import images, inside, tools
from encre.pen import colour
from mathutils import Vector
from mathutils.bvhtree import BVHTree

ROOT = Path(__file__).parents[2]
sys.path.append(str(ROOT / "tests"))
from reference import near  # noqa: E402 - found only now

WIDTH, HEIGHT, SAMPLES = 960, 540, 16
BEND = 50      # degrees: what Freestyle, Line Art and FINE all take for a crease as they come
SMOOTH = 60    # degrees: and where faces are shaded smooth
EVERY = 1.5    # pixels between points on an edge, at most
REACH = 1.5    # pixels from a point in which its ink is sought
INKED = 0.25   # ink that counts as a line
SCRAP = 12     # pixels: a piece of ink that spans less is one
ALONE = 8      # pixels to both sides of a point in which lines are counted: two where nothing else is are one too many
APART = 1e-4   # share of its distance by which a point is lifted off its surface before the eye looks for it

PAGE = """# Beside Freestyle and Line Art

Five scenes on which no setting was chosen (`tests/helpers/strangers.py`), {size}, {samples} samples, each drawn by
Encre with its own detector from [layers of its own](layers.md), by Freestyle and by Line Art, all with lines {wide}
pixels wide from the shapes alone.
`python tests/helpers/peers.py FOLDER` renders them and writes this page.

Which lines there are comes from the meshes and the camera: outlines, ends of surfaces, and edges that bend by {bend}°
or more, {smooth}° where faces are shaded smooth, wherever a ray from the eye reaches them. *Un-inked*: the share of
their points with ink of less than {inked} within {reach} px. *Scraps*: pieces of ink that span less than {scrap} px.
*Doubles*: the share of points with no other edge within {far} px, seen or flush with what a thing stands on, and no
place where bodies stand in each other, beside which two lines run. Places of the latter kind are not asked for as
lines: Encre alone draws them all. A line that is left out makes no double: Line Art has no inner ring on the machine's
flange, Freestyle no edges of books that stand beside each other. Of an eyelid's two contours within 3.4 px Encre draws
one: that is half of what the head lacks.

| scene | lines | un-inked | scraps | doubles |
|---|---|---|---|---|
{rows}

![Each scene by Encre, by Freestyle and by Line Art](peers.jpg)

Lines from chains of mesh edges have more scraps than those that were found in pixels (city 1, bookshelf and vessel 0),
and the vessel lacked nothing. The scraps of bookshelf and vessel are no dots: a crease that gives way to another one
leaves a pale line, here and there just a quarter black. Where the second edge of a bevel fades as its one line comes,
bookshelf has none, but bevels up to 5 px wide lose an edge that is drawn as things are. The measure of doubles did not
know an edge on which a box stands, and took the line of contact for one too many: so measured, city has 6.0% (38
points of 636) and bookshelf 1.2%.

With presets as they come, which draw colours and light as well, scraps were counted on seven other scenes (a bicycle, a
bookshelf, stacked chairs, a sewing machine, a village, a smithy, a café; fast layers), as pieces of ink down to 0.05:
*Water Memory* has 0, 0, 0, 2, 0, 6 and 24, *Ink only*, its dots of light drawn as lines, 0, 0, 0, 2, 0, 6 and 25,
*Inter-color* 0, 0, 0, 2, 0, 7 and 30, Freestyle 3, 26, 1, 4, 6, 8 and 14. What is left are things so small, almost all
of them windows of a far town, eyes, nails and the holes of reels. Counted down to 0.25, as in the table, thin lines of
pale ink fall into pieces: up to 306 of *Water Memory*'s pencil, and 330 of *Inter-color*'s faintest colours.
"""


class Edges:
    """All edges of what the render shows, in world space."""

    def __init__(self, depsgraph, eye):
        ends, facing, bend, smooth, away = [], [], [], [], []
        corners, owner = [], []
        for instance in depsgraph.object_instances:
            obj = instance.object
            if obj.type not in {"MESH", "CURVE"} or not instance.show_self:
                continue
            mesh, world = obj.to_mesh(), np.array(instance.matrix_world)
            points = np.array([v.co for v in mesh.vertices]) @ world[:3, :3].T + world[:3, 3]
            turned = np.linalg.inv(world[:3, :3]).T
            normals = np.array([p.normal for p in mesh.polygons]) @ turned.T
            normals /= np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-20)
            middle = np.array([points[list(p.vertices)].mean(0) for p in mesh.polygons])
            front = (normals * (eye - middle)).sum(1) > 0
            beside = defaultdict(list)
            for polygon in mesh.polygons:
                for key in polygon.edge_keys:
                    beside[key].append(polygon.index)
            for key, (one, *others) in beside.items():
                two = others[0] if others else one
                ends.append(points[list(key)])
                facing.append((front[one], front[two]))
                smooth.append(mesh.polygons[one].use_smooth and bool(others) and mesh.polygons[two].use_smooth)
                bend.append(np.degrees(np.arccos(np.clip(normals[one] @ normals[two], -1, 1))) if others else 180)
                away.append(normals[one] + (normals[two] if others else 0))
            mesh.calc_loop_triangles()
            corners += [points[list(t.vertices)] for t in mesh.loop_triangles]
            owner += [len(set(owner))] * len(mesh.loop_triangles)
            obj.to_mesh_clear()
        self.ends, self.facing, self.bend = np.array(ends), np.array(facing), np.array(bend)
        self.away, self.smooth = np.array(away), np.array(smooth)
        self.meets = np.zeros(len(ends), bool)
        self.add_meets(np.array(corners), np.array(owner))
        self.away /= np.maximum(np.linalg.norm(self.away, axis=1, keepdims=True), 1e-20)

    def add_meets(self, corners, owner):
        """Where triangles of two objects pass through each other."""
        tree = BVHTree.FromPolygons(corners.reshape(-1, 3).tolist(),
                                    np.arange(3 * len(corners)).reshape(-1, 3).tolist(), all_triangles=True)
        pairs = np.array(tree.overlap(tree)).reshape(-1, 2)
        one, two = (corners[k] for k in pairs[owner[pairs[:, 0]] < owner[pairs[:, 1]]].T)
        across = [np.cross(t[:, 1] - t[:, 0], t[:, 2] - t[:, 0]) for t in (one, two)]
        along = np.cross(*across)
        along /= np.maximum(np.linalg.norm(along, axis=1, keepdims=True), 1e-20)
        spans = []
        for t, other, normal in ((one, two, across[1]), (two, one, across[0])):
            height = ((t - other[:, :1]) * normal[:, None]).sum(2)
            place = (t * along[:, None]).sum(2)
            cut = np.full((len(t), 3), np.nan)  # places on the common line at which the sides pass the other's plane
            for k, m in ((0, 1), (1, 2), (2, 0)):
                passes = height[:, k] * height[:, m] < 0
                share = height[passes, k] / (height[passes, k] - height[passes, m])
                cut[passes, k] = place[passes, k] * (1 - share) + place[passes, m] * share
            spans.append((np.fmin.reduce(cut, 1), np.fmax.reduce(cut, 1)))
        start, end = np.maximum(spans[0][0], spans[1][0]), np.minimum(spans[0][1], spans[1][1])
        real = np.flatnonzero(end > start)
        base = np.array([np.linalg.lstsq([across[0][k], across[1][k], along[k]],
                                         [across[0][k] @ one[k, 0], across[1][k] @ two[k, 0], 0], rcond=None)[0]
                         for k in real]).reshape(-1, 3)
        away = sum(n[real] / np.linalg.norm(n[real], axis=1, keepdims=True) for n in across)
        self.ends = np.concatenate([self.ends, np.stack([base + along[real] * s[real, None] for s in (start, end)], 1)])
        self.away = np.concatenate([self.away, away / np.maximum(np.linalg.norm(away, axis=1, keepdims=True), 1e-20)])
        self.facing = np.concatenate([self.facing, np.ones((len(real), 2), bool)])
        self.bend = np.concatenate([self.bend, np.zeros(len(real))])
        self.meets = np.concatenate([self.meets, np.ones(len(real), bool)])
        self.smooth = np.concatenate([self.smooth, np.zeros(len(real), bool)])

    def lines(self, bend, smooth):
        """Which are lines where they can be seen: ends, outlines, and bends of an outside by so many degrees, where
        faces are shaded smooth by so many."""
        open_ = self.bend == 180
        return open_ | (self.facing[:, 0] != self.facing[:, 1]) | (
            self.facing.any(1) & (self.bend >= np.where(self.smooth, smooth, bend)))


def visible(scene, depsgraph, view, edges, which, off=True):
    """Points of the edges `which` on the frame that the eye sees: (x, y), the way along the edge on the frame. Those on
    which a thing stands count as seen where it is not asked for what lies `off` surfaces."""
    a, b = (view.project(edges.ends[which, k])[0] for k in (0, 1))
    depth = np.stack([view.project(edges.ends[which, k])[1] for k in (0, 1)])
    fine = (depth > 0).all(0)
    edge, a, b = np.flatnonzero(which)[fine], a[fine], b[fine]
    count = np.clip(np.ceil(np.linalg.norm(b - a, axis=1) / EVERY), 1, 4000).astype(int)
    own = np.repeat(np.arange(len(edge)), count)
    share = (np.arange(len(own)) - np.repeat(np.cumsum(count) - count, count) + 0.5) / count[own]
    points = edges.ends[edge[own], 0] * (1 - share[:, None]) + edges.ends[edge[own], 1] * share[:, None]
    at, far = view.project(points)
    inside = np.all((at > 4) & (at < (WIDTH - 5, HEIGHT - 5)), 1) & (far > 0)
    kept = []
    for k in np.flatnonzero(inside):
        lift = APART * far[k]
        eye = view.eye - points[k]
        reach = np.linalg.norm(eye)
        way = eye / reach
        start = points[k] + way * lift + edges.away[edge[own[k]]] * lift * off
        if not scene.ray_cast(depsgraph, Vector(start), Vector(way), distance=float(reach))[0]:
            kept.append(k)
    along = (b - a)[own[kept]]
    return at[kept], along / np.maximum(np.linalg.norm(along, axis=1, keepdims=True), 1e-9)


def measure(t, at, along, around):
    """Share un-inked, number of scraps, share doubled."""
    across = along[:, ::-1] * (-1, 1)
    s = np.arange(-ALONE, ALONE + 0.125, 0.25)
    profiles = turn.sample(t, at[:, None] + across[:, None] * s[:, None])
    bare = profiles[:, np.abs(s) <= REACH].max(1) < INKED
    i, j = near.pairs(at, around, ALONE + REACH)  # the ink of one farther off comes into the profile
    off = around[j] - at[i]
    crowded = np.zeros(len(at), bool)
    crowded[i[np.abs((off * across[i]).sum(1)) > 1]] = True
    alone = profiles[~crowded]
    twice = [peaks(profile) > 1 for profile in alone]
    return float(bare.mean()), scraps(t), float(np.mean(twice)) if twice else 0.0


def peaks(profile):
    """How many lines a profile crosses: runs of ink, parted by a gap in which it falls under half of INKED."""
    count, inside = 0, False
    for value in profile:
        if not inside and value >= INKED:
            count, inside = count + 1, True
        elif inside and value < INKED / 2:
            inside = False
    return count


def scraps(t):
    """Pieces of ink, eight neighbours, that span less than SCRAP and do not touch the border."""
    ink, found = t >= INKED, 0
    left = set(zip(*np.nonzero(ink), strict=True))
    while left:
        stack = [left.pop()]
        rows, columns = [stack[0][0]], [stack[0][1]]
        while stack:
            y, x = stack.pop()
            for near_by in ((y + j, x + i) for j in (-1, 0, 1) for i in (-1, 0, 1)):
                if near_by in left:
                    left.remove(near_by)
                    stack.append(near_by)
                    rows.append(near_by[0])
                    columns.append(near_by[1])
        whole = min(rows) > 0 and min(columns) > 0 and max(rows) < HEIGHT - 1 and max(columns) < WIDTH - 1
        if whole and np.hypot(max(rows) - min(rows) + 1, max(columns) - min(columns) + 1) < SCRAP:
            found += 1
    return found


@contextlib.contextmanager
def own_layers(scene):
    scene.encre.layer_source = "ENCRE"
    yield


def shoot(folder, name, techniques):
    """{technique: T}, and the edges seen: points and ways of the lines, points of all that may be one."""
    bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)
    strangers.SCENES[name]()
    scene = bpy.context.scene
    scene.render.resolution_x, scene.render.resolution_y, scene.cycles.samples = WIDTH, HEIGHT, SAMPLES
    scene.render.image_settings.file_format = "OPEN_EXR_MULTILAYER"
    scene.view_layers[0].encre.use_pass_lines = True
    for key, value in turn.INK.items():
        setattr(scene.encre, key, value)
    kinds = {"fine": (turn.encre("FINE"), own_layers, techniques.dynamic),
             "freestyle": (turn.white, techniques.freestyle), "line_art": (turn.white, techniques.line_art)}
    ink = {}
    for kind, contexts in kinds.items():
        path = folder / f"{name}_{kind}.exr"
        if not path.exists():
            turn.shoot(scene, 1, path, contexts)
        ink[kind] = (exr.part(path, "ViewLayer.Encre Lines")[..., 3] if kind == "fine" else
                     1 - exr.part(path, "ViewLayer.Combined")[..., :3].mean(2).clip(0, 1))
    depsgraph = bpy.context.evaluated_depsgraph_get()
    view = turn.View(scene, 1, (WIDTH, HEIGHT))
    edges = Edges(depsgraph, view.eye)
    at, along = visible(scene, depsgraph, view, edges, edges.lines(BEND, SMOOTH))
    beside = edges.lines(10, 10) | edges.meets
    around = [visible(scene, depsgraph, view, edges, beside, off)[0] for off in (True, False)]
    return ink, at, along, np.concatenate(around)


def main():
    folder = Path(sys.argv[1])
    folder.mkdir(parents=True, exist_ok=True)
    inside.register()
    techniques = tools.load("compare", "techniques")
    names, rows, pictures = sys.argv[2:] or list(strangers.SCENES), [], []
    for name in names:
        ink, at, along, around = shoot(folder, name, techniques)
        for kind, t in ink.items():
            bare, pieces, twice = measure(t, at, along, around)
            rows.append(f"| {name} | {turn.NAMES[kind]} | {bare:.1%} | {pieces} | {twice:.1%} |")
            print(rows[-1], flush=True)
        pictures.append(np.concatenate([np.repeat(1 - t[..., None], 3, 2) for t in ink.values()], 1))
        images.write_textures({str(folder / f"{name}.png"):
                               images.Texture(pictures[-1].astype(np.float32), "uint8", False, False)})
    if names == list(strangers.SCENES):
        page = PAGE.format(size=f"{WIDTH}×{HEIGHT}", samples=SAMPLES, wide="1.5", bend=BEND, smooth=SMOOTH, inked=INKED,
                           reach=REACH, scrap=SCRAP, far=ALONE + REACH, rows="\n".join(rows))
        (ROOT / "docs" / "peers.md").write_text(page, encoding="utf-8")
        turn.jpeg(colour.halved(np.concatenate(pictures).astype(np.float32), True), ROOT / "docs" / "peers.jpg")
    sys.stdout.flush()
    os._exit(0)  # Blender's own threads may wait for each other at the end


if __name__ == "__main__":
    main()
