# SPDX-License-Identifier: GPL-3.0-or-later
"""Scenes of which chains of mesh edges tell where meshes end, bend and pass through each other; and meshes for them."""

from dataclasses import replace
from functools import cached_property
from itertools import combinations, pairwise

import chained
import numpy as np
from encre.pen import job, library, overlay
from reference import near

from .meshes import Mesh, MeshScene
from .scene import CREASE, SIDE, STEP, Scene, Truth
from .shapes import across, segment, unit

FULL = 4  # degrees over which a crease gets its full width
ONE = 2.5  # pixels: what bends within them is one bend
APART = 3.5  # from which on two edges are two for certain
BESIDE = 2.0  # pixels: of a crease and an outline closer than this the crease may be left out, of a slit's sides one
FOLD = 3.4  # likewise, where a thing goes on behind its own contour: from 3 on it is thin, here half a hairline is seen


def matrices_of(camera, size):
    """World to camera, and camera to clip, as library.raster() takes them; not of an orthographic one."""
    h, w = size
    view = np.eye(4)
    view[:3, :3], view[:3, 3] = camera.view, -camera.view @ camera.eye
    return view, np.array([[2 * camera.focal * h / w, 0, -2 * camera.shift[0] / w, 0],
                           [0, 2 * camera.focal, 2 * camera.shift[1] / h, 0],
                           [0, 0, -1, -0.02], [0, 0, -1, 0]])


def rasters(meshes):
    """As the rasteriser takes them, numbered from 1 on; those of one color have one material."""
    colors = [tuple(mesh.color) for mesh in meshes]
    return [job.Mesh(mesh.points.astype(np.float32), mesh.triangles, object_index=k,
                     material_index=1 + colors.index(color))
            for k, (mesh, color) in enumerate(zip(meshes, colors, strict=True), 1)]


def tell(layers, meshes, matrices, seed=0, cards=0):
    """Layers, and what rasterised meshes tell, put together as the engine does. The last `cards` meshes are cut out by
    alpha: the picture tells their lines."""
    h, w = layers["depth"].shape[:2]
    maps = library.raster(rasters(meshes), *matrices, job.Frame(w, h), (w, h), 0.01, outputs=(
        "object", "material", "style", "coincident"))
    index, other = layers["object"][..., 0].astype(np.int64), maps["coincident"].astype(np.int64)
    either = (other > 0) & (maps["object"] == index) & (np.random.default_rng(seed).random((h, w)) < 0.5)
    index = np.where(either, other, index)  # a renderer shows now this, now that
    numbers = np.arange(len(meshes) + 1)
    told = overlay.rasterised(index, overlay.compact(maps), numbers, numbers, lambda lost: lost)
    lines = chained.lines(rasters(meshes), *matrices, job.Frame(w, h), (w, h), 0.01, cards)
    return layers | {"object": np.ascontiguousarray(told["object"], np.float32), "chains": lines}


class _Telling:
    """Layers with what rasterised meshes tell, put together as the engine does."""
    drawn = ()  # meshes that are rasterised, one for each solid
    cards = 0   # the last of them that are cut out by alpha

    def layers(self, filter="box", noise=0.0, seed=0, one_index=False):
        matrices = matrices_of(self.camera, self.size)
        return tell(super().layers(filter, noise, seed), self.drawn or self.solids, matrices, seed, self.cards)


class ToldSolids(_Telling, Scene):
    """Solids by formula, cut out of meshes by alpha."""

    def __init__(self, camera, solids, light, drawn, cards, **more):
        super().__init__(camera, solids, light, **more)
        self.drawn, self.cards = [*drawn, *cards], len(cards)


class ToldMeshes(_Telling, MeshScene):
    """Meshes, which may stand in each other."""

    def __init__(self, camera, meshes, size=(300, 400)):
        super().__init__(camera, meshes, size)

    @cached_property
    def _edges(self):
        """[(ends, mesh, its faces there)] of all curves."""
        found = []
        for mesh in self.solids:
            front = mesh.facing(self.camera.homogeneous)
            found += [(mesh.points[list(ends)], mesh, faces) for ends, faces in mesh.edges.items()
                      if front[faces].any()]
        for one, two in combinations([(mesh, piece) for mesh in self.solids for piece in range(max(mesh.piece) + 1)],
                                     2):
            found += [(ends, None, []) for ends in meet(*one, *two)]
        return found

    def _curves(self):
        return [segment(*ends) for ends, _, _ in self._edges]

    @cached_property
    def truth(self):
        """As of any scene; what bends within a few pixels is one bend, in its middle."""
        truth = super().truth
        truth.narrow |= truth.angle < CREASE + FULL
        outline = truth.take(truth.outline)
        crease = np.flatnonzero(~truth.outline)
        i, j = near.pairs(np.stack([truth.x[crease], truth.y[crease]], 1), np.stack([outline.x, outline.y], 1), BESIDE)
        level = np.abs(truth.nx[crease[i]] * outline.nx[j] + truth.ny[crease[i]] * outline.ny[j]) > 0.95
        dropped = np.zeros(truth.x.size, bool)
        dropped[crease[i[level]]] = truth.narrow[crease[i[level]]]
        dropped[np.flatnonzero(truth.outline)[self._gives_way(outline)]] = True
        middles = [self._strip(truth, dropped, mesh, strip) for mesh in self.solids for strip in mesh.strips]
        arrays = [truth.take(~dropped), *(m for m in middles if m is not None)]
        found = Truth(size=self.size, **{name: np.concatenate([getattr(a, name) for a in arrays])
                                         for name in vars(truth) if name not in ("size", "clear", "faint")})
        found.faint = np.stack([truth.x, truth.y], 1)[dropped]
        return found

    def _gives_way(self, outline):
        """Which points may be left out, as another contour runs close along them: a fold, behind which the same thing
        goes on, beside a contour of that thing that is none or lies before it; of a slit's sides that of the later
        thing, or the right or lower one. The sides of a thin thing are neither."""
        points = np.stack([outline.x, outline.y], 1)
        i, j = near.pairs(points, points, FOLD)
        dx, dy = (points[j] - points[i]).T
        nx, ny = outline.nx[i], outline.ny[i]
        across, along = dx * nx + dy * ny, np.abs(dy * nx - dx * ny)
        beside = (along < STEP) & (np.abs(across) > 4 * STEP)
        beside &= np.abs(nx * outline.nx[j] + ny * outline.ny[j]) > 0.95
        i, j, across = i[beside], j[beside], across[beside]
        sides = [self.trace(outline.x + side * outline.nx, outline.y + side * outline.ny) for side in (-SIDE, SIDE)]
        solid, depth = (np.stack([side[name] for side in sides]) for name in ("solid", "depth"))
        front = (depth[1] < depth[0]).astype(int)  # on which side the nearer surface lies
        every = np.arange(points.shape[0])
        own, behind, before = solid[front, every], solid[1 - front, every], depth[front, every]
        folds = (own == behind)[i] & ((own[i] == own[j]) | (own[i] == behind[j]))
        folds &= outline.index[j] | (before[j] < before[i])
        there = np.sign(across)  # of j from i, and of i from j, along the normal of each
        turned = np.sign(outline.nx[i] * outline.nx[j] + outline.ny[i] * outline.ny[j])
        slits = outline.index[i] & outline.index[j] & (np.abs(across) < BESIDE) & (behind[i] == behind[j])
        slits &= (there == 1 - 2 * front[i]) & (-there * turned == 1 - 2 * front[j])
        later = np.where(outline.nx[i] + outline.ny[i] > 0, there, -there) < 0
        slits &= (own[i] > own[j]) | ((own[i] == own[j]) & later)
        found = np.zeros(len(points), bool)
        found[i[folds | slits]] = True
        return found

    def _strip(self, truth, dropped, mesh, strip):
        """Marks points of a bevel's edges that are no lines by themselves; gives its middle if it is one itself."""
        one, two, faces = strip
        front = mesh.facing(self.camera.homogeneous)
        own = np.array([m is mesh and bool(set(faces) & set(at)) for _, m, at in self._edges])[truth.curve]
        own &= ~truth.outline
        rims = [np.array([mesh.points[list(ends)] for ends, at in mesh.edges.items()
                          if face in at and set(at) & set(faces)][0]) for face in (one, two)]
        if np.linalg.norm(rims[0][0] - rims[1][0]) > np.linalg.norm(rims[0][0] - rims[1][1]):
            rims[1] = rims[1][::-1]
        (ax, ay, _), (bx, by, _) = (self.camera.project(rim, self.size) for rim in rims)
        way = np.array([ax[1] - ax[0], ay[1] - ay[0]])
        wide = abs((bx - ax).mean() * way[1] - (by - ay).mean() * way[0]) / max(np.hypot(*way), 1e-9)
        if wide >= APART:
            return None
        truth.narrow |= own
        if wide >= ONE or not front[[one, two]].all():
            return None
        dropped |= own
        middle = segment(*(rims[0] + rims[1]) / 2)
        x, y, nx, ny = self._points(middle)
        ends = self.camera.project(middle(np.array([0.0, 1.0])), self.size)[2]
        seen = self.trace(x, y)
        shown = (seen["solid"] == mesh.index) & (np.abs(seen["depth"] - ends.mean()) < 2 * np.ptp(ends) + 0.03)
        x, y, nx, ny = (v[shown] for v in (x, y, nx, ny))
        none = np.zeros(x.size)
        bend = np.degrees(np.arccos(np.clip(mesh.normals[one] @ mesh.normals[two], -1, 1)))
        return Truth(x, y, nx, ny, none - 1, none, none > 0, none + bend, none, none, none > 0, self.size)


def Told(camera, solids, light, drawn=None, cards=(), **more):  # noqa: N802 - either class
    if drawn:
        return ToldSolids(camera, solids, light, drawn, cards, **more)
    return ToldMeshes(camera, solids, **more)


# ---- where meshes cross --------------------------------------------------------------------------------------------


def _through(corners, n, k):
    """The ends of the stretch of a convex polygon that lies in the plane n·p = k, or None."""
    off = corners @ n - k
    around = [*zip(corners, off, strict=True), (corners[0], off[0])]
    found = [a + (b - a) * (u / (u - v)) for (a, u), (b, v) in pairwise(around) if (u < 0) != (v < 0)]
    return found if len(found) == 2 else None


def meet(one, piece, two, other):
    """The straight stretches in which a piece of a mesh cuts another."""
    found = []
    faces = [[(mesh.points[face], n) for face, n, p in zip(mesh.faces, mesh.normals, mesh.piece, strict=True)
              if p == number] for mesh, number in ((one, piece), (two, other))]
    least, most = ([np.array([end(corners, 0) for corners, _ in own]) for own in faces] for end in (np.min, np.max))
    near_by = ((least[0][:, None] <= most[1]) & (least[1] <= most[0][:, None])).all(-1)
    for i, j in np.argwhere(near_by):
        (a, n), (b, m) = faces[0][i], faces[1][j]
        along = np.cross(n, m)
        if along @ along < 1e-6:
            continue
        ends = _through(a, m, m @ b[0]), _through(b, n, n @ a[0])
        if None in ends:
            continue
        (s0, s1), (t0, t1) = (sorted(p @ along for p in pair) for pair in ends)
        low, high = max(s0, t0), min(s1, t1)
        if low < high:
            p, q = ends[0]
            share = [(at - p @ along) / ((q - p) @ along) for at in (low, high)]
            found.append(np.array([p + (q - p) * s for s in share]))
    return found


# ---- meshes --------------------------------------------------------------------------------------------------------


def joined(*meshes):
    """One mesh of several pieces."""
    starts = np.cumsum([0, *(len(mesh.points) for mesh in meshes)])
    faces = [[int(k + start) for k in face] for mesh, start in zip(meshes, starts, strict=False) for face in mesh.faces]
    return Mesh(np.concatenate([mesh.points for mesh in meshes]), faces,
                piece=[k for k, mesh in enumerate(meshes) for _ in mesh.faces])


def convex(normals, offsets, turn, centre):
    """What lies behind all the planes; also the number of the face of each plane, or None."""
    points, faces, number = [], [], []
    for k, n in enumerate(normals):
        one, two = across(n)
        corners = [n * offsets[k] + 50 * (a * one + b * two) for a, b in ((-1, -1), (1, -1), (1, 1), (-1, 1))]
        for m, offset in zip(np.delete(normals, k, 0), np.delete(offsets, k), strict=True):
            clipped = []
            for p, q in pairwise([*corners, corners[0]] if corners else []):
                u, v = p @ m - offset, q @ m - offset
                clipped += [p] if u <= 0 else []
                if u < 0 < v or v < 0 < u:
                    clipped.append(p + (q - p) * (u / (u - v)))
            corners = clipped
        face = []
        for p in corners:
            same = [i for i, other in enumerate(points) if np.abs(other - p).max() < 1e-7]
            points += [] if same else [p]
            face += [i for i in (same or [len(points) - 1]) if i not in face]
        number.append(len(faces) if len(face) > 2 else None)
        faces += [face] * (len(face) > 2)
    return Mesh(np.asarray(centre, float) + np.array(points) @ turn.T, faces), number


def bevelled(size, centre, turn, radius, segments):
    """A box whose edges are rounded off by so many faces each."""
    half = np.asarray(size, float) / 2
    normals = [sign * axis for axis in np.eye(3) for sign in (-1, 1)]
    offsets, strips = [half[k // 2] for k in range(6)], []
    for a, b in combinations(range(6), 2):
        if a // 2 == b // 2:
            continue
        strips.append((a, b, range(len(normals), len(normals) + segments)))
        for k in range(segments):
            turned = (k + 0.5) / segments * np.pi / 2
            n = np.cos(turned) * normals[a] + np.sin(turned) * normals[b]
            normals.append(n)
            offsets.append(n @ (normals[a] * (half[a // 2] - radius) + normals[b] * (half[b // 2] - radius)) + radius)
    mesh, number = convex(np.array(normals), np.array(offsets), turn, centre)
    mesh.strips = [(number[a], number[b], [number[k] for k in planes]) for a, b, planes in strips]
    return mesh


def rock(centre, radius, seed, rough=0.1, planes=26):
    """A ball cut by planes from all sides."""
    rng = np.random.default_rng(seed)
    up = 1 - 2 * (np.arange(planes) + 0.5) / planes
    around = np.arange(planes) * 2.399963
    normals = np.stack([np.sqrt(1 - up**2) * np.cos(around), up, np.sqrt(1 - up**2) * np.sin(around)], 1)
    normals += 0.12 * rng.standard_normal(normals.shape)
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    return convex(normals, radius * (1 + rough * rng.uniform(-1, 1, planes)), np.eye(3), centre)[0]


def tube(path, radius, bends, length, sides=8):
    """A pipe in a plane that faces the eye: straight pieces, each turned by so many degrees from the one before."""
    points = [np.asarray(p, float) for p in path]
    ways, out = [unit(points[1] - points[0])], np.array([0.0, 0.0, 1.0])
    out = unit(out - (out @ ways[0]) * ways[0])
    for bend in bends:
        a = np.radians(bend)
        ways.append(np.cos(a) * ways[-1] + np.sin(a) * np.cross(out, ways[-1]))
        points.append(points[-1] + length * ways[-1])
    turns = (np.arange(sides) + 0.5) * 2 * np.pi / sides
    rings = []
    for k, p in enumerate(points):
        way = ways[max(k - 1, 0)]
        middle = way + ways[min(k, len(ways) - 1)]
        off = radius * (np.cos(turns)[:, None] * np.cross(way, out) + np.sin(turns)[:, None] * out)
        rings.append(p + off - way * ((off @ middle) / (way @ middle))[:, None])
    faces = [[sides * k + j, sides * k + (j + 1) % sides, sides * (k + 1) + (j + 1) % sides, sides * (k + 1) + j]
             for k in range(len(rings) - 1) for j in range(sides)]
    last = sides * (len(rings) - 1)
    faces += [list(range(sides))[::-1], list(range(last, last + sides))]
    return outward(Mesh(np.concatenate(rings), faces))


def prism(sides, radius, height, foot, turn):
    """An upright column."""
    turns = np.arange(sides) * 2 * np.pi / sides + turn
    ring = radius * np.stack([np.cos(turns), 0 * turns, np.sin(turns)], 1) + foot
    faces = [[k, (k + 1) % sides, sides + (k + 1) % sides, sides + k] for k in range(sides)]
    faces += [list(range(sides))[::-1], list(range(sides, 2 * sides))]
    return outward(Mesh(np.concatenate([ring, ring + (0, height, 0)]), faces))


def grown(sides, radius, inner, height, foot):
    """An upright ring with a hole."""
    turns = np.arange(sides) * 2 * np.pi / sides
    rings = [r * np.stack([np.cos(turns), 0 * turns, np.sin(turns)], 1) + foot + np.array([0, y, 0])
             for r, y in ((radius, 0), (radius, height), (inner, height), (inner, 0))]
    faces = [[sides * a + k, sides * a + (k + 1) % sides, sides * b + (k + 1) % sides, sides * b + k]
             for a, b in ((0, 1), (1, 2), (2, 3), (3, 0)) for k in range(sides)]
    return outward(Mesh(np.concatenate(rings), faces))


def wheel(teeth, radius, depth, thick, centre, turn, phase=0.0, hole=0.3):
    """A toothed wheel with a hole of as many sides."""
    corners = [(phase + 2 * np.pi * (k + at) / teeth, radius - short) for k in range(teeth)
               for at, short in ((-0.3, depth), (-0.17, 0), (0.17, 0), (0.3, depth))]
    angle, out = np.array(corners).T
    m = len(angle)
    rings = [np.stack([r * np.cos(angle), r * np.sin(angle), 0 * angle + z], 1)
             for z in (thick / 2, -thick / 2) for r in (out, np.full(m, hole * radius))]
    faces = [face for k in range(m) for p in [(k + 1) % m] for face in
             ([k, p, m + p, m + k], [2 * m + k, 3 * m + k, 3 * m + p, 2 * m + p], [k, 2 * m + k, 2 * m + p, p],
              [m + k, m + p, 3 * m + p, 3 * m + k])]
    return outward(Mesh(np.asarray(centre, float) + np.concatenate(rings) @ turn.T, faces))


def grid(wide, tall, columns, rows, bar, centre, turn, thick=0.05):
    """A plate with so many square holes."""
    xs, ys = (np.sort([k * (size - bar) / n + o for k in range(n + 1) for o in (0, bar)]) - size / 2
              for size, n in ((wide, columns), (tall, rows)))
    w, h = len(xs), len(ys)
    points = np.array([(x, y, z) for z in (thick / 2, -thick / 2) for y in ys for x in xs])

    def full(i, j):
        return 0 <= i < w - 1 and 0 <= j < h - 1 and (i % 2 == 0 or j % 2 == 0)

    faces, below = [], w * h
    for i, j in ((i, j) for i in range(w - 1) for j in range(h - 1) if full(i, j)):
        a, b, c, d = j * w + i, j * w + i + 1, (j + 1) * w + i + 1, (j + 1) * w + i
        faces += [[a, b, c, d], [below + a, below + d, below + c, below + b]]
        faces += [[p, below + p, below + q, q] for p, q, other in ((a, b, (i, j - 1)), (b, c, (i + 1, j)),
                                                                   (c, d, (i, j + 1)), (d, a, (i - 1, j)))
                  if not full(*other)]
    return Mesh(np.asarray(centre, float) + points @ turn.T, faces)


def zigzag(folds, period, bend, tall, centre, turn, thick=0.15):
    """A sheet folded to and fro by so many degrees."""
    x = (np.arange(folds + 1) - folds / 2) * period / 2
    z = np.where(np.arange(folds + 1) % 2, period / 2 * np.tan(np.radians(bend / 2)), 0)
    return hung(x, z, tall, centre, turn, thick)


def hung(x, z, tall, centre, turn, thick):
    """A cloth of upright strips between the places x, z."""
    m = len(x)
    folds = m - 1
    points = np.array([(x[k], y, z[k] - o) for o in (0, thick) for y in (-tall / 2, tall / 2) for k in range(m)])
    faces = [[0, m, 3 * m, 2 * m], [folds, 2 * m + folds, 3 * m + folds, m + folds]]
    for a in range(folds):
        b, c, d = a + 1, m + a + 1, m + a
        faces += [[a, b, c, d], [2 * m + a, 2 * m + d, 2 * m + c, 2 * m + b], [a, 2 * m + a, 2 * m + b, b],
                  [d, c, 2 * m + c, 2 * m + d]]
    return Mesh(np.asarray(centre, float) + points @ turn.T, faces)


def outward(mesh):
    """With all faces the other way round if the mesh is inside out."""
    first = np.array([mesh.points[face[0]] for face in mesh.faces])
    area = np.array([sum(np.linalg.norm(np.cross(mesh.points[b] - mesh.points[face[0]],
                                                 mesh.points[c] - mesh.points[face[0]]))
                         for b, c in pairwise(face[1:])) for face in mesh.faces])
    if (area * (mesh.normals * (first - mesh.points.mean(0))).sum(1)).sum() < 0:
        return replace(mesh, faces=[face[::-1] for face in mesh.faces])
    return mesh
