# SPDX-License-Identifier: GPL-3.0-or-later
"""Where lines pass between pixel centres, one crossing after the other, in float64."""

import numpy as np

from . import raster

ASIDE = 1 / 256  # of a pixel: how far beside an edge it is looked what another piece of its mesh shows
COVER = 0.25  # of a pixel: an edge so far below what other meshes show at both pixels is not seen

def _corners(mesh, corner, view, projection, frame):
    """Corners of a primitive on the screen, (n, 4) as raster.on_screen() has them."""
    world = np.asarray(mesh.points, np.float32).astype(float)[corner] @ mesh.model[:3, :3].T + mesh.model[:3, 3]
    camera = world @ view[:3, :3].T + view[:3, 3]
    return raster.on_screen(np.c_[camera, np.ones(len(camera))] @ projection.T, camera, frame)


def _turn(screen):
    """Which way round the corners of a triangle go, by sign."""
    return np.linalg.det(screen[:, :3])


def _plane(screen, x, y):
    """Depth of a triangle's plane at a place on the screen."""
    system = np.stack([screen[:, 0] - x * screen[:, 2], screen[:, 1] - y * screen[:, 2], np.ones(3)])
    return np.linalg.solve(system, [0.0, 0.0, 1.0]) @ screen[:, 3]


def _look(screen, x, y, z, pixel):
    """How far a line lies behind a triangle, how far it may and still be on it, and how much its depth changes from
    pixel to pixel."""
    nearest, farthest = screen[:, 3].min(), screen[:, 3].max()
    h = 1e-4
    slope = sum(abs(_plane(screen, x + a, y + b) - _plane(screen, x - a, y - b)) / (2 * h) for a, b in ((h, 0), (0, h)))
    slope = min(slope, farthest - nearest)
    return z - np.clip(_plane(screen, x, y), nearest, farthest), 0.5 * (slope + pixel), slope


def crossings(screen):
    """(column, row, axis, share, x, y, z) of a line, pixel centres at whole numbers; axis 0: to the right."""
    at = screen[:, :2] / screen[:, 2:3] - 0.5
    for axis in (0, 1):
        across, along = 1 - axis, axis  # rows are crossed between two columns
        a, b = at[:, across]
        for line in range(int(np.floor(min(a, b))) + 1, int(np.floor(max(a, b))) + 1):
            t = (line - a) / (b - a)
            x, y = at[0] + t * (at[1] - at[0])
            z = ((screen[:, 3] / screen[:, 2]) @ (1 - t, t)) / ((1 / screen[:, 2]) @ (1 - t, t))
            place = (x, y)[along]
            cell = int(np.floor(place))
            yield (line if axis else cell), (cell if axis else line), axis, place - cell, x, y, z


def contours(mesh, view, projection, frame):
    """(corners, right, left, fold, cut) of each edge that can be a contour: on which sides of it surfaces are, both:
    where numbers change; whether its surface goes on behind; whether a triangle ends there that does so elsewhere."""
    corners = triangles(mesh)
    number = np.stack([np.zeros(len(corners)) if n is None else n for n in (mesh.object, mesh.material)], 1)
    volume = [_turn(_corners(mesh, corner, view, projection, frame)) for corner in corners]
    told, ends = [], np.zeros(len(corners), int)
    for edge, shared in _edges(mesh).items():
        found = [(t, volume[t] * (1 if rises else -1)) for t, _, rises in shared]
        found = [(t, turn > 0, turn < 0) for t, turn in found]
        right, left = any(f[1] for f in found), any(f[2] for f in found)
        both = len({tuple(number[f[0]]) for f in found}) > 1
        if both or right != left:
            told.append((edge, right or both, left or both, len(found) > 1 and not both, found[0][0]))
            ends[found[0][0]] += not told[-1][3]
    for edge, right, left, fold, triangle in told:
        yield np.array(edge), right, left, fold, ends[triangle] > 1 and not fold


def _same(mesh, corners):
    """The first of the points that triangles without an area have at one place, by point."""
    same = np.arange(len(mesh.points))
    for corner in corners:
        for a, b in zip(corner, np.roll(corner, -1), strict=True):
            if (mesh.points[a] == mesh.points[b]).all():
                same[same == same[max(a, b)]] = same[min(a, b)]
    return np.array([np.flatnonzero(same == k)[0] for k in same], int)


def _edges(mesh):
    """{(from, to): [(triangle, corner, whether it goes that way)]}: by points, of which those stand for each other that
    a triangle has at one place; and two edges that one triangle each has are one if no third lies at their place."""
    corners, points = triangles(mesh), np.asarray(mesh.points, np.float32)
    edges, same, alone = {}, _same(mesh, corners), {}
    for t, corner in enumerate(corners):
        if len(np.unique(points[corner], axis=0)) < 3:  # it parts nothing
            continue
        for k, (a, b) in enumerate(zip(same[corner], same[np.roll(corner, -1)], strict=True)):
            if a != b:
                edges.setdefault((min(a, b), max(a, b)), []).append((t, k, a < b))
    for (a, b), found in edges.items():
        if len(found) == 1:
            ends = tuple((points[a] + 0).tolist()), tuple((points[b] + 0).tolist())
            alone.setdefault(tuple(sorted(ends)), []).append(((a, b), ends[0] <= ends[1]))
    for found in alone.values():
        if len(found) == 2:
            (one, way), (other, turned) = found
            t, k, rises = edges.pop(other)[0]
            edges[one].append((t, k, rises == (way == turned)))
    return edges


def triangles(mesh):
    return np.arange(len(mesh.points)).reshape(-1, 3) if mesh.corners is None else mesh.corners


def bends(mesh):
    """(corners, degrees, smooth, the first of its triangles) of each edge that two or more share and that may be a
    crease."""
    corners = triangles(mesh)
    world = np.asarray(mesh.points, np.float32).astype(float) @ mesh.model[:3, :3].T + mesh.model[:3, 3]
    across = np.cross(world[corners[:, 1]] - world[corners[:, 0]], world[corners[:, 2]] - world[corners[:, 0]])
    for edge, shared in _edges(mesh).items():
        found = [(t, rises, 0 if mesh.edges is None else mesh.edges[t] >> 2 * k & 3) for t, k, rises in shared]
        first, most, smooth = found[0], 0, False
        for other in found[1:]:
            one, two = across[first[0]], across[other[0]] * (1 if first[1] != other[1] else -1)
            if max(first[2], other[2]) > 1 or not (np.any(one) and np.any(two)):
                continue
            degrees = np.degrees(np.arctan2(np.linalg.norm(np.cross(one, two)), one @ two)) + mesh.crease_offset
            if degrees > most:
                most, smooth = min(degrees, 180), min(first[2], other[2]) == 1
        if most >= 5:
            yield np.array(edge), most, smooth, first[0]


def _walk(meshes, view, projection, frame, size, clip_start):
    """The function that follows a line on the screen over the surfaces of `meshes`."""
    width, height = size
    front = raster.draw(meshes, view, projection, frame, size, clip_start)["front"]
    scale = 2 / (abs(projection[1, 1]) * frame.height)

    def crossed(screen):
        """(way, whether close to another, share, (number, behind, allowed, slope, triangle on the screen, its number)
        at both its pixels, the size of a pixel there, (x, y, z) where the line is)"""
        for column, row, axis, share, x, y, z in crossings(screen):
            p, q = (row - frame.y, column - frame.x), (row - frame.y + axis, column - frame.x + 1 - axis)
            if min(*p) < 0 or q[0] >= height or q[1] >= width:
                continue
            pixel = scale * (z if projection[3, 2] else 1)
            there = []
            for number, t in (front[p], front[q]):
                triangle = None if number < 0 else _corners(meshes[number], triangles(meshes[number])[t], view,
                                                            projection, frame)
                looked = (-np.inf, 0, 0) if number < 0 else _look(triangle, x + 0.5, y + 0.5, z, pixel)
                there.append((number, *looked, triangle, t))
            close = min(share, 1 - share) < 1e-6 or min(
                abs(abs(behind) - allowed) for _, behind, allowed, *_ in there) < 1e-4 * z
            yield (*p, axis), close, max(share, 1 / 1024), there, pixel, (x + 0.5, y + 0.5, z)

    return crossed


def told(mark):
    """What the layer says of contours and lines by hand: from -16 down, it is of what passes between both centres."""
    return np.where(np.asarray(mark) > -16, mark, 0)


def place_of(mark):
    """The place 0..1 of a contour in the layer, which also says in steps how far before what is behind it it lies."""
    return np.clip(-told(mark) - 2 * steps_of(mark), 0, 1)


def steps_of(mark):
    return np.where(told(mark) < 0, np.minimum(np.floor(-told(mark) / 2), 7), 0)


def between_of(mark):
    """The middle of what passes between both centres; NaN where nothing does."""
    return np.where((mark <= -18) & (mark >= -19), -18 - np.asarray(mark, float), np.nan)


def _ends_at(way, share, first, own, other, place, frame, perspective):
    """The share, and whether that is not sure, at which a surface ends whose contour lies a little below the other."""
    x, y, z = place
    beyond = 0 if first else 1
    own_x, own_y = way[1] + frame.x + 0.5 + beyond * (way[2] == 0), way[0] + frame.y + 0.5 + beyond * (way[2] == 1)
    one = np.array((_plane(own[4], own_x, own_y), z))
    two = np.array((_plane(other[4], own_x, own_y), _plane(other[4], x, y)))
    apart = two - one
    if not (apart[0] > 0 > apart[1] and apart[0] - apart[1] > 4e-6 * z):
        return share, min(abs(apart)) < 1e-6 * z or abs(apart[0] - apart[1] - 4e-6 * z) < 1e-6 * z
    a, b = np.abs(apart / (one * two) if perspective else apart)
    part = a / (a + b)
    return max(share * part if first else 1 - (1 - share) * part, 1 / 1024), min(a, b) < 1e-4 * (a + b)


def marks(lines, meshes, view, projection, frame, size, clip_start):
    """The output `marks`, and where it is not sure: lines within rounding of a centre, or of where they are hidden,
    contours as far before what is behind them as one step more.

    lines: (mesh of kind lines), all of whose points lie beyond clip_start, as those of the `meshes` do.
    """
    width, height = size
    out, unsure = np.zeros((height, width, 2)), np.zeros((height, width, 2), bool)
    crossed = _walk(meshes, view, projection, frame, size, clip_start)
    for mesh in lines:
        for corner in mesh.corners:
            for way, close, share, there, *_ in crossed(_corners(mesh, corner, view, projection, frame)):
                unsure[way] |= close
                if out[way] == 0 and any(behind <= allowed for _, behind, allowed, *_ in there):
                    out[way] = share
    _, piece = hanging(meshes)
    for number, mesh in enumerate(meshes):
        at_point = _piece_at_points(number, mesh, piece)
        for corner, right, left, fold, cut in contours(mesh, view, projection, frame):
            screen = _corners(mesh, corner, view, projection, frame)
            along = np.diff(screen[:, :2] / screen[:, 2:3], axis=0)[0]
            for way, close, share, there, pixel, place in crossed(screen):
                unsure[way] |= close
                first = right == (along[0] < 0 if way[2] else along[1] > 0)  # whether it bounds what is at p
                own, other = there if first else there[::-1]
                if out[way] > 0:
                    continue
                if right != left and all(n != number and behind <= allowed for n, behind, allowed, *_ in there):
                    if out[way] == 0:
                        out[way] = -16 - share
                    elif -18 < out[way] <= -16:
                        out[way] = -18 - (-16 - out[way] + share) / 2
                    else:
                        unsure[way] |= out[way] <= -18  # of three, the order tells
                    continue
                if own[0] != number or other[1] > other[2]:
                    continue
                if right != left and not cut and piece[number, own[5]] != at_point[corner[0]]:
                    continue
                known, nothing = place_of(out[way]), told(out[way]) == 0
                if right != left and other[1] > 0:
                    share, doubt = _ends_at(way, share, first, own, other, place, frame, bool(projection[3, 2]))
                    unsure[way] |= doubt
                if right and left:
                    if other[0] == number and own[1] <= own[2] and nothing:
                        out[way] = -share
                elif own[1] >= -own[2] and (nothing or (share > known if first else share < known)):
                    before = (-other[1] - (other[3] / 2 if cut else 0)) / (pixel * frame.height / 1080)
                    least = 0.25 * 2.0 ** np.arange(fold, 7)
                    unsure[way] |= np.any(np.abs(before - least) < 1e-2 * (1 + least))
                    out[way] = -share - 2 * (fold + np.count_nonzero(before >= least))
    return out, unsure


def pieces(mesh):
    """Numbers of the triangles of each part that hangs together by points or edges."""
    left, found = {t: set(corner) for t, corner in enumerate(triangles(mesh).tolist())}, []
    for shared in _edges(mesh).values():
        for (t, *_), (u, *_) in zip(shared, shared[1:], strict=False):
            left[t].add((t, u))
            left[u].add((t, u))
    while left:
        first = min(left)
        own, points = [first], left.pop(first)
        while joined := [t for t, corner in left.items() if corner & points]:
            for t in joined:
                points |= left.pop(t)
            own += joined
        found.append(sorted(own))
    return found


def hanging(meshes):
    """[(mesh, its triangles)] of the pieces of all meshes, and {(mesh, triangle): its piece}"""
    found = [(number, own) for number, mesh in enumerate(meshes) for own in pieces(mesh)]
    return found, {(number, t): k for k, (number, own) in enumerate(found) for t in own}


def _piece_at_points(number, mesh, piece):
    return {point: piece[number, t] for t, corner in enumerate(triangles(mesh).tolist()) for point in corner}


def meets(meshes, view, projection, frame, size, clip_start):
    """{way: share} where pieces pass through each other, and the ways that are not sure: each piece is drawn alone."""
    width, height = size
    front = raster.draw(meshes, view, projection, frame, size, clip_start)["front"]
    found, piece = hanging(meshes)
    alone = []
    for number, own in found:
        part = type(meshes[number])(meshes[number].points, triangles(meshes[number])[own], model=meshes[number].model)
        drawn = raster.draw([part], view, projection, frame, size, clip_start)["front"][..., 1]
        alone.append(np.where(drawn < 0, -1, np.array(own)[drawn]))

    def plane(triangle, at):
        mesh = meshes[triangle[0]]
        corners = _corners(mesh, triangles(mesh)[triangle[1]], view, projection, frame)
        return _plane(corners, at[1] + frame.x + 0.5, at[0] + frame.y + 0.5)

    found, unsure = {}, set()
    scale = 2 / (abs(projection[1, 1]) * frame.height)
    for y, x, axis in np.ndindex(height, width, 2):
        p, q = (y, x), (y + axis, x + 1 - axis)
        if q[0] >= height or q[1] >= width or min(front[p][0], front[q][0]) < 0:
            continue
        one, other = tuple(front[p].tolist()), tuple(front[q].tolist())
        if piece[one] == piece[other]:
            continue
        a_p, a_q, b_p, b_q = plane(one, p), plane(one, q), plane(other, p), plane(other, q)
        slack = (abs(a_q - a_p) + abs(b_q - b_p)) / 4
        if min(b_p - a_p, a_q - b_q) < -slack:  # one plane lies before the other all the way
            continue
        one_behind = one[0], int(alone[piece[one]][q])
        other_behind = other[0], int(alone[piece[other]][p])
        if min(one_behind[1], other_behind[1]) < 0:
            continue
        margin, depths = [], []
        for first, last in ((one, one_behind), (other_behind, other)):
            depths += [plane(first, p), plane(last, q)]
            explained = max(abs(plane(first, q) - depths[-2]), abs(plane(last, p) - depths[-1]))
            pixel = scale * (plane(one, p) if projection[3, 2] else 1)
            margin.append(explained + pixel - abs(depths[-1] - depths[-2]))
        one_p, one_q, other_p, other_q = depths
        if min(map(abs, margin)) < 1e-4 * abs(one_p):
            unsure.add((y, x, axis))
        if min(margin) < 0 or (other_p - one_p) + (one_q - other_q) < 4e-6 * abs(one_p):
            continue
        u = (lambda z: -1 / z) if projection[3, 2] else (lambda z: z)
        a, b = max(u(other_p) - u(one_p), 0), max(u(one_q) - u(other_q), 0)
        found[y, x, axis] = max(a / (a + b), 1 / 1024)
    return found, unsure


def _beside(drawn, edge, x, y, z):
    """[(triangle, how far its surface lies before the edge: 0 goes through it)] of what is in front on both sides of an
    edge, among the triangles of its mesh that are `drawn` on the screen."""
    along = np.diff(edge[:, :2] / edge[:, 2:3], axis=0)[0]
    across, found = ASIDE * np.array((-along[1], along[0])) / np.hypot(*along), []
    for px, py in ((x, y) + across, (x, y) - across):
        nearest, which = np.inf, None
        for t, screen in enumerate(drawn):
            share = np.linalg.lstsq(screen[:, :3].T, (px, py, 1), rcond=None)[0]
            if (share >= 0).all() and share @ screen[:, 3] / share.sum() < nearest:
                nearest, which = share @ screen[:, 3] / share.sum(), t
        if which is None:
            found.append((None, -np.inf))
            continue
        behind, _, slope = _look(drawn[which], x, y, z, 0)
        found.append((which, behind if abs(behind) > 2 * (ASIDE * slope + 1e-6 * z) else 0))
    return found


def _bend_seen(mesh, one, two, view, projection):
    """Degrees between two triangles, by their sides that the eye sees."""
    world = np.asarray(mesh.points, np.float32).astype(float) @ mesh.model[:3, :3].T + mesh.model[:3, 3]
    eye, normals = np.linalg.inv(view), []
    for t in (one, two):
        a, b, c = world[triangles(mesh)[t]]
        n = np.cross(b - a, c - a)
        to = eye[:3, 3] - a if projection[3, 2] else eye[:3, 2]
        normals.append(n * np.sign(n @ to) / np.linalg.norm(n))
    return np.degrees(np.arccos(np.clip(normals[0] @ normals[1], -1, 1))) + mesh.crease_offset


def creases(meshes, view, projection, frame, size, clip_start):
    """The output `creases`, and where it is not sure, as marks(); also where two edges bend almost alike."""
    width, height = size
    out, unsure = np.zeros((height, width, 2, 2)), np.zeros((height, width, 2), bool)
    crossed = _walk(meshes, view, projection, frame, size, clip_start)
    _, piece = hanging(meshes)
    for own, mesh in enumerate(meshes):
        at_point = _piece_at_points(own, mesh, piece)
        ends = {tuple(edge) for edge, *_ in contours(mesh, view, projection, frame)}
        drawn = [_corners(mesh, t, view, projection, frame) for t in triangles(mesh)]
        for corner, degrees, smooth, first in bends(mesh):
            turn = _turn(_corners(mesh, triangles(mesh)[first], view, projection, frame))
            turn *= tuple(corner) not in ends  # what lies on both sides of a contour is turned either way
            edge = _corners(mesh, corner, view, projection, frame)
            for way, close, share, there, pixel, place in crossed(edge):
                if any(number == own and piece[number, t] != at_point[corner[0]] and abs(behind) <= allowed
                       for number, behind, allowed, _, _, t in there):
                    (one, before), (two, other) = _beside(drawn, edge, *place)
                    unsure[way] |= close
                    if min(before, other) > 0:
                        continue
                    if before == other == 0:
                        seen = _bend_seen(mesh, one, two, view, projection)
                        if seen >= max(5, abs(out[way][1])):
                            out[way] = share, -seen if smooth else seen
                        continue
                covers = [behind - COVER * pixel for number, behind, *_, screen, t in there if number >= 0 and (
                    piece[number, t] != at_point[corner[0]] or _turn(screen) * turn < 0)]
                covered = len(covers) == 2 and min(covers) > 0
                unsure[way] |= close or any(abs(cover) < 1e-4 * pixel for cover in covers) or (
                    out[way][0] > 0 and abs(degrees - abs(out[way][1])) < 0.02)
                if degrees > abs(out[way][1]) and not covered and any(
                        behind <= allowed for _, behind, allowed, *_ in there):
                    out[way] = share, -degrees if smooth else degrees
    found, doubtful = meets(meshes, view, projection, frame, size, clip_start)
    for way, share in found.items():
        out[way] = share, 180
    for way in doubtful:
        unsure[way] = True
    return out.reshape(height, width, 4), unsure.repeat(2, 2)
