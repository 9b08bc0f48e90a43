# SPDX-License-Identifier: GPL-3.0-or-later
"""Which triangle is in front at each pixel's centre, one triangle after the other, in float64 and whole numbers."""

from types import SimpleNamespace

import numpy as np

from .example import WORD, scramble

STEPS = 4096  # of the sub-pixel grid, to a pixel
NOTHING = 1e10


def covered(x, y, columns, rows):
    """Bool (rows, columns): which pixel centres lie in a triangle of corners x, y in whole steps, int64.

    A centre on an edge belongs to the triangle when the edge is its left one or its horizontal top one.
    """
    x, y = np.asarray(x, np.int64), np.asarray(y, np.int64)
    area = (x[1] - x[0]) * (y[2] - y[0]) - (y[1] - y[0]) * (x[2] - x[0])
    if area == 0:
        return np.zeros((len(rows), len(columns)), bool)
    order = (0, 1, 2) if area > 0 else (0, 2, 1)
    cx, cy = columns[None, :] * STEPS + STEPS // 2, rows[:, None] * STEPS + STEPS // 2
    inside = np.ones((len(rows), len(columns)), bool)
    for i in range(3):
        a, b = order[i], order[(i + 1) % 3]
        e = (x[b] - x[a]) * (cy - y[a]) - (y[b] - y[a]) * (cx - x[a])
        left, top = y[b] < y[a], y[b] == y[a] and x[b] > x[a]
        inside &= e >= 0 if left or top else e > 0
    return inside


def _clip(polygon, distance):
    """Corners (n, 4) of a polygon where distance(corner) >= 0."""
    out = []
    for p, q in zip(polygon, np.roll(polygon, -1, axis=0), strict=True):
        s, t = distance(p), distance(q)
        if s >= 0:
            out.append(p)
        if (s >= 0) != (t >= 0):
            out.append(p + (q - p) * (s / (s - t)))
    return np.array(out).reshape(-1, 4)


def on_screen(clip, camera, frame):
    """(n, 4): x and y times w in pixels of the frame, w, depth."""
    return np.c_[(clip[:, 0] + clip[:, 3]) / 2 * frame.width, (clip[:, 3] - clip[:, 1]) / 2 * frame.height,
                 clip[:, 3], -camera[:, 2]]


def draw(meshes, view, projection, frame, size, clip_start, clip_end=0.0, channels=0):
    """What library.raster() draws, float64, and `unsure`: pixels where two surfaces are within 1e-6 of equally deep,
    and `front`: numbers of mesh and triangle, -1 where nothing is."""
    width, height = size
    columns, rows = np.arange(width) + frame.x, np.arange(height) + frame.y
    view, projection = np.asarray(view, float), np.asarray(projection, float)
    out = SimpleNamespace(depth=np.full((height, width), NOTHING), normal=np.zeros((height, width, 3)),
                          shading=np.zeros((height, width, 3)),
                          object=np.zeros((height, width)), material=np.zeros((height, width)),
                          style=np.zeros((height, width)), anchor=np.zeros((height, width, 16)),
                          tangent=np.zeros((height, width, 3)), card=np.zeros((height, width, 4)),
                          attributes=np.zeros((height, width, channels)),
                          unsure=np.zeros((height, width), bool), front=np.full((height, width, 2), -1))
    nearest = np.full((height, width), np.inf)
    for number, mesh in enumerate(meshes):
        points = np.asarray(mesh.points, np.float32).astype(float)
        corners = np.arange(len(points)).reshape(-1, 3) if mesh.corners is None else mesh.corners
        for t, corner in enumerate(corners):
            world = points[corner] @ mesh.model[:3, :3].T + mesh.model[:3, 3]
            camera = world @ view[:3, :3].T + view[:3, 3]
            if not np.isfinite(camera).all():
                continue
            clip = np.c_[camera, np.ones(3)] @ projection.T
            screen = on_screen(clip, camera, frame)
            seen = _clip(screen, lambda c: c[3] - clip_start)
            if clip_end > clip_start:
                seen = _clip(seen, lambda c: clip_end - c[3])
            if len(seen) < 3:
                continue
            x, y = (np.floor(seen[:, k] / seen[:, 2] * STEPS + 0.5).astype(np.int64) for k in (0, 1))
            inside = np.zeros((height, width), bool)
            for j in range(1, len(seen) - 1):
                inside |= covered(x[[0, j, j + 1]], y[[0, j, j + 1]], columns, rows)
            py, px = np.nonzero(inside)
            if len(py) == 0:
                continue
            # shares of the corners: the point of the triangle's plane on the line of sight
            cx, cy = columns[px] + 0.5, rows[py] + 0.5
            share = _shares(screen, cx, cy)
            depth = np.clip(share @ screen[:, 3], seen[:, 3].min(), seen[:, 3].max())
            growth = [(_shares(screen, cx + dx, cy + dy) - _shares(screen, cx - dx, cy - dy)) / 2e-4
                      for dx, dy in ((1e-4, 0), (0, 1e-4))]
            share = np.maximum(share, 0)
            share /= share.sum(1, keepdims=True)
            before = nearest[py, px]
            out.unsure[py, px] |= np.abs(depth - before) < 1e-6 * np.abs(depth)
            front = depth.astype(np.float32) < before.astype(np.float32)
            py, px, depth, share = py[front], px[front], depth[front], share[front]
            growth = [each[front] for each in growth]
            normal = np.cross(world[1] - world[0], world[2] - world[0])
            towards = view[2, :3] if projection[3, 2] == 0 else -view[:3, :3].T @ view[:3, 3] - world[0]
            side = 1 if normal @ towards >= 0 else -1
            normal *= side / np.linalg.norm(normal)
            nearest[py, px] = out.depth[py, px] = depth
            out.normal[py, px] = out.shading[py, px] = normal
            if mesh.normals is not None:
                turned = _shading(share @ mesh.normals[t].astype(float), mesh.model, side)
                out.shading[py, px] = np.where(turned.any(1, keepdims=True), turned, normal)
            out.front[py, px] = number, t
            out.anchor[py, px] = _anchor(mesh, t, corner, share, growth, share @ screen[:, 2], projection, frame)
            out.tangent[py, px] = _tangent(mesh, t, points[corner])
            out.card[py, px] = _card(view @ mesh.model, projection, frame, columns[px] + 0.5, rows[py] + 0.5)
            out.object[py, px] = mesh.object_index if mesh.object is None else mesh.object[t]
            out.material[py, px] = mesh.material_index if mesh.material is None else mesh.material[t]
            out.style[py, px] = mesh.style_index if mesh.style is None else mesh.style[t]
            out.attributes[py, px] = 0
            if mesh.attributes is not None:
                n = min(channels, mesh.attributes.shape[-1])
                out.attributes[py, px, :n] = share @ mesh.attributes[t, :, :n].astype(float)
    return vars(out)


def _shading(normals, model, side):
    """Normals (n, 3) in world space, of length 1, on the side that is seen. The inverse's transpose turns them; where
    the model mirrors, corners go round the other way, and the normal of a face with them."""
    turned = side * np.sign(np.linalg.det(model[:3, :3])) * normals @ np.linalg.inv(model[:3, :3])
    return turned / np.maximum(np.linalg.norm(turned, axis=1, keepdims=True), 1e-300)


def _shares(screen, x, y):
    """(n, 3) of the corners: the point of the triangle's plane on the line of sight through places in pixels."""
    system = np.stack([screen[:, 0] - x[:, None] * screen[:, 2], screen[:, 1] - y[:, None] * screen[:, 2],
                       np.ones((len(x), 3))], axis=1)
    return np.linalg.solve(system, np.broadcast_to([0.0, 0.0, 1.0], (len(x), 3))[:, :, None])[:, :, 0]


def _area(triangles):
    """Of triangles (n, 3, 3) together, twice, without what is not finite."""
    each = np.linalg.norm(np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0]), axis=1)
    return each[np.isfinite(each)].sum()


def _anchor(mesh, t, corner, share, growth, w, projection, frame):
    """The layer `anchor` (n, 16) at places on triangle t, of points `corner`; w: clip space's."""
    points = np.asarray(mesh.points, np.float32).astype(float)
    faces = points[np.arange(len(points)).reshape(-1, 3) if mesh.corners is None else mesh.corners]
    stretch, normals = _stretch(mesh.model), mesh.rest_normals
    rest = stretch * (faces if mesh.rest is None else np.asarray(mesh.rest, float))
    scale = np.sqrt(_area(rest) / _area(faces @ mesh.model[:3, :3].T))
    # how many pixels a unit across is where w is 1: the mean of both ways
    pixel = w * scale * 2 / np.sqrt(abs(projection[0, 0]) * frame.width * abs(projection[1, 1]) * frame.height)
    normal = np.broadcast_to(np.cross(rest[t, 1] - rest[t, 0], rest[t, 2] - rest[t, 0]), (len(share), 3))
    if normals is not None:
        normals = normals[t].astype(float)
        if (stretch != 1).any():
            normals *= np.roll(stretch, 1) * np.roll(stretch, 2)
            normals /= np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-300)
        smooth = share @ normals
        normal = np.where(smooth.any(1, keepdims=True), smooth, normal)
    normal = normal / np.linalg.norm(normal, axis=1, keepdims=True)
    grown = [each @ rest[t] for each in growth]
    length = [np.linalg.norm(each, axis=1) for each in grown]
    grown = [each * np.minimum(1, 64 * pixel / np.maximum(n, 1e-300))[:, None]
             for each, n in zip(grown, length, strict=True)]
    form = np.broadcast_to(_form(rest[t], normals), normal.shape)
    return np.concatenate([share @ rest[t] + _shift(mesh.seed, _area(rest)), normal, pixel[:, None], *grown, form], 1)


def _shift(seed, area):
    """How far a copy's rest positions are moved: half its size, as a power of two, along each axis at most."""
    if not seed:
        return np.zeros(3)
    size = 2.0 ** (np.floor(np.log2(np.sqrt(area))) + 1)
    return np.array([size * (scramble(scramble(seed & WORD) + c & WORD) / 2 ** 31 - 1) / 2 for c in range(3)])


def _stretch(model):
    """By how much more each axis of object space is scaled than all are on average."""
    length = np.linalg.norm(model[:3, :3], axis=0)
    mean = np.sqrt((length**2).mean())
    return length / mean if np.abs(length - mean).max() > 1e-4 * mean else np.ones(3)


def _tangent(mesh, t, corners):
    """The direction on a resting triangle in which U grows, and V does not."""
    rest = _stretch(mesh.model) * (corners if mesh.rest is None else mesh.rest[t].astype(float))
    grown = np.zeros((2, 2)) if mesh.uv is None else mesh.uv[t, 1:].astype(float) - mesh.uv[t, 0].astype(float)
    if grown[0, 0] * grown[1, 1] == grown[0, 1] * grown[1, 0]:
        return np.zeros(3)
    along = np.linalg.solve(grown, rest[1:] - rest[0])[0]
    return along / max(np.linalg.norm(along), 1e-300)


def _card(to_eye, projection, frame, x, y):
    """Where on the sheet of an object places of the full frame are: it stands at the object's origin, upright as that
    is."""
    eye, up = to_eye[:, 3], to_eye[:2, 2]
    clip = projection @ eye
    far = max(clip[3], np.linalg.norm(eye[:3]) / 4) if projection[3, 2] else clip[3]
    size = 2 * far / np.sqrt(abs(projection[0, 0] * projection[1, 1]) * frame.width * frame.height)
    across = size * (np.array((up[1], -up[0])) / np.hypot(*up) if up.any() else np.array((1.0, 0.0)))  # of the screen
    above = np.array((-across[1], across[0]))
    away = np.stack([x - (clip[0] / far + 1) / 2 * frame.width, (1 - clip[1] / far) / 2 * frame.height - y], -1)
    return np.c_[away @ across, away @ above, np.full((len(x), 2), (across[0], above[0]))]


def _form(rest, normals):
    """Where a triangle bends most, as long as it bends that way alone: from the linear map of its plane that takes
    edges to the differences of the corners' normals, made symmetric."""
    edges = rest[1:] - rest[0]
    up = np.cross(*edges)
    area = np.linalg.norm(up)
    if normals is None or not area > 1e-12 * (edges[0] ** 2).sum():
        return np.zeros(3)
    normals = normals.astype(float)
    normals /= np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-300)
    basis = np.linalg.svd(edges)[2][:2]
    bend = np.linalg.solve(edges @ basis.T, (normals[1:] - normals[0]) @ basis.T)
    values, ways = np.linalg.eigh((bend + bend.T) / 2)
    small, large = sorted(np.abs(values))
    most = np.argmax(np.abs(values))
    sure = np.clip(((small + large) * np.sqrt(area) - 2e-4) / 8e-4, 0, 1)
    return ways[:, most] @ basis * (large - small) / max(large + small, 1e-300) * sure
