# SPDX-License-Identifier: GPL-3.0-or-later
"""Drawn light: where shadows end against geometry, and that soft light is clean."""

from dataclasses import replace

import numpy as np
import pytest
from encre.pen import library
from encre.pen.job import Frame, Lamp, Mesh
from lamps import CUBE, CUBE_CORNERS, PLANE_CORNERS, Stage, look, moved, ways
from reference import light as reference


def shadow_outline(stage, way):
    """The corners on the screen, in pixels, of the shadow that the cube throws on the plane."""
    corners = CUBE @ np.eye(3) + (0, 0, 1.001)
    shadow = corners - corners[:, 2:] / way[2] * way
    p = np.concatenate([shadow, np.ones((8, 1))], 1) @ (stage.projection @ stage.view).T
    p = (p[:, :2] / p[:, 3:] * (0.5, -0.5) + 0.5) * (stage.width, stage.height)
    hull, start = [], p[:, 0].argmin()  # wrapped as a gift
    while not hull or start != hull[0]:
        hull.append(start)
        to = p - p[start]
        following = (start + 1) % 8
        for k in range(8):
            if to[following, 0] * to[k, 1] - to[following, 1] * to[k, 0] > 1e-9:
                following = k
        start = following
    return p[hull]


def crossings(share, inside):
    """Places (x, y) at which half the light lies between neighbouring pixels of the plane."""
    out = []
    for axis in (0, 1):
        a, b = (share[:-1], share[1:]) if axis == 0 else (share[:, :-1], share[:, 1:])
        both = (inside[:-1] & inside[1:]) if axis == 0 else (inside[:, :-1] & inside[:, 1:])
        y, x = np.nonzero(((a < 0.5) != (b < 0.5)) & both)
        t = (0.5 - a[y, x]) / (b[y, x] - a[y, x])
        out.append(np.stack([x + 0.5 + (t if axis else 0), y + 0.5 + (0 if axis else t)], 1))
    return np.concatenate(out)


def distances(points, outline):
    """From points to the nearest of an outline's lines, where that is not near a corner; else NaN."""
    best, corner = np.full(len(points), np.inf), np.full(len(points), np.inf)
    for a, b in zip(outline, np.roll(outline, -1, 0), strict=True):
        along = b - a
        t = np.clip(((points - a) @ along) / (along @ along), 0, 1)
        best = np.minimum(best, np.linalg.norm(points - a - t[:, None] * along, axis=1))
        corner = np.minimum(corner, np.linalg.norm(points - a, axis=1))
    return np.where(corner > 4, best, np.nan)


@pytest.mark.parametrize("width, most", [(0, 0.03), (0.00925, 0.03), (0.02, 0.07)])
def test_a_cubes_shadow_ends_where_geometry_says(width, most):
    found = []
    for seed in range(6):
        stage = Stage(320, 180)
        rng = np.random.default_rng(seed)
        from_ = np.array([*rng.uniform(-4, 4, 2), rng.uniform(3, 6)])
        lamp = Lamp("sun", width=width, model=look(from_, (0, 0, 0)))
        light = stage.light(lamp)[..., 0]
        plane = stage.objects() == 1
        share = light / light[plane].max()
        found.append(distances(crossings(share, plane), shadow_outline(stage, from_)))
    found = np.concatenate(found)
    found = found[~np.isnan(found)]
    assert (found < 1).all(), "one edge"
    assert len(found) > 800
    assert np.percentile(found, 95) <= most


def seen_share(lamp, places):
    """What of a lamp that is high above the plane is seen from places on it, past the cube: by very many points."""
    n = 96
    i, m = np.arange(n * n), np.asarray(lamp.model)
    r, turn = np.sqrt((i + 0.5) / n**2), i * 2.39996323
    disc = np.stack([r * np.cos(turn), r * np.sin(turn)], 1)
    square = np.stack([i % n, i // n], 1) / n + 0.5 / n - 0.5
    out = []
    for place in places:
        to = m[:3, 3] - place
        if lamp.kind == "rectangle":
            way = to + square @ (m[:3, :2] * (lamp.width, lamp.height)).T
            weight = way[:, 2] * (way @ m[:3, 2]) / np.linalg.norm(way, axis=1)**4
        else:
            axis = m[:3, 2] if lamp.kind == "sun" else reference.unit(to)
            half = lamp.width / 2 if lamp.kind == "sun" else np.arcsin(lamp.width / np.linalg.norm(to))
            down = 1 - (1 - np.cos(half)) * r**2
            u = reference.unit(np.cross(axis, (0, 0, 1)))
            rise = np.sqrt(1 - down**2)[:, None] * disc / r[:, None]
            way = down[:, None] * axis + rise @ np.stack([u, np.cross(axis, u)])
            weight = way[:, 2]
        ends = (np.stack([(-1, -1, 0.001), (1, 1, 2.001)])[:, None] - place) / way
        free = ends.min(0).max(1) > ends.max(0).min(1)
        out.append((weight * free).sum() / weight.sum())
    return np.array(out)


def share_off(lamp, eye, about, steepest, n):
    """By how much drawn shares of a lamp's light, within `about` of a half, differ from an integral, at n places."""
    stage = Stage(320, 180, eye=eye)
    light, plain = (stage.light(replace(lamp, shadows=k))[..., 0] for k in (True, False))
    share = light / np.maximum(plain, 1e-9)
    wide = np.hypot(*np.gradient(share)) < steepest  # what is narrower has a ramp of two pixels
    y, x = np.nonzero((abs(share - 0.5) < about) & (stage.objects() == 1) & wide)
    chosen = np.random.default_rng(0).permutation(len(x))[:n]
    y, x = y[chosen], x[chosen]
    ends = [np.stack([x / 160 - 1 + 1 / 320, 1 - y / 90 - 1 / 180, 0 * x + z, 0 * x + 1], 1)
            @ np.linalg.inv(stage.projection @ stage.view).T for z in (-1.0, 1.0)]
    a, b = (end[:, :3] / end[:, 3:] for end in ends)
    places = a - (b - a) * (a[:, 2:] / (b[:, 2:] - a[:, 2:]))
    return abs(share[y, x] - seen_share(lamp, places))


@pytest.mark.parametrize("lamp, most", [
    (Lamp("sun", width=0.12, model=look((3, 1.2, 5), (0, 0, 0.3))), (0.004, 0.03)),
    (Lamp("point", width=0.5, model=look((-4, -2, 3), (0, 0, 0.3))), (0.0024, 0.006)),
    (Lamp("rectangle", width=1, height=1, model=look((-4, -2, 3), (0, 0, 0.3))), (0.003, 0.012))],
    ids=["sun", "ball", "rectangle"])
def test_half_of_a_wide_lamps_light_is_where_an_integral_says(lamp, most):
    off = share_off(lamp, (-7, -6, 8), 0.2, 0.15, 150)
    # where one edge parts the lamp, and also round corners
    assert (np.percentile(off, (75, 95)) <= most).all()


def test_where_a_corner_parts_the_lamp_shares_are_an_integrals():
    """Seen from low: a penumbra of three pixels whose middle is not where the lamp's middle goes. Taken for it."""
    lamp = Lamp("rectangle", width=1, height=1, model=look((-2, 3.5, 4), (0, 0, 0.3)))
    assert (np.percentile(share_off(lamp, (-9, -3, 1.0), 0.3, 0.4, 200), (75, 90)) <= (0.015, 0.08)).all()


def windows(picture):
    """(9, height - 2, width - 2): of each pixel that is not at the border the 3 x 3 about it."""
    height, width = picture.shape
    return np.stack([picture[y:y + height - 2, x:x + width - 2] for y in range(3) for x in range(3)])


def specks(light, surface):
    """By how much a pixel of one surface is brighter, or darker, than all eight neighbours, of the brightest."""
    own = windows(light / light.max())
    beside = np.delete(own, 4, 0)
    same = (windows(surface) == surface[1:-1, 1:-1]).all(0)
    return np.maximum(own[4] - beside.max(0), beside.min(0) - own[4])[same]


def singles(light, surface):
    """How many pixels of one surface are in a lighter or a darker tone than all neighbours; of twenty times four tones.
    """
    found, same = 0, (windows(surface) == surface[1:-1, 1:-1]).all(0)
    for first in np.linspace(0.02, 0.3, 20) * light.max():
        own = windows(np.digitize(light, first * np.arange(1, 4)))
        beside = np.delete(own, 4, 0)
        found += (same & ((own[4] > beside.max(0)) | (own[4] < beside.min(0)))).sum()
    return found


@pytest.mark.parametrize("lamp, most", [(Lamp("sun", width=0.00925, model=ways()), 0),
                                        (Lamp("rectangle", width=1, height=1, model=ways()), 4),
                                        (Lamp("point", width=0.5, model=ways()), 3)], ids=["sun", "rectangle", "ball"])
def test_soft_light_is_clean(lamp, most):
    stage = Stage(480, 270, smooth=True)
    for k in range(6):  # bars that throw narrow shadows
        model = np.diag([0.03, 0.03, 0.9, 1.0])
        model[:3, 3] = -2.2 - 0.25 * k, -1.5 + 0.4 * k, 0.9
        stage.add(CUBE, CUBE_CORNERS, model)
    light, objects = stage.light(lamp)[..., 0], stage.objects()
    assert singles(light, objects) <= most
    assert specks(light, objects).max() < 0.01


@pytest.mark.parametrize("width", [0.00925, 0.035])
def test_light_through_a_fence_is_clean(width):
    """Gaps of light thinner than a pixel, of a centre in which an edge parts the sun; tops of bars of a pixel's height.
    """
    stage = Stage(480, 270, eye=(5, -7, 2.4), at=(0, 0, 0.7))
    bars = [((-3 + 0.4 * k, -1.6, 0.5), (0.07, 0.02, 0.5)) for k in range(16)]
    bars += [((0, -1.65, z), (3.2, 0.02, 0.05)) for z in (0.3, 0.8)]
    for at, size in bars:
        model = np.diag([*size, 1.0])
        model[:3, 3] = at
        stage.add(CUBE, CUBE_CORNERS, model)
    light = stage.light(Lamp("sun", width=width, model=ways()), rims=True)[..., 0]
    assert specks(light, stage.objects()).max() < 0.1


def tube(stage, a, b, radius, n):
    a, b = np.array(a), np.array(b)
    way, turn, k = reference.unit(b - a), np.arange(n) * 2 * np.pi / n, np.arange(n)
    u = reference.unit(np.cross(way, (0.3, 0.5, 0.8)))
    ring = np.cos(turn)[:, None] * u + np.sin(turn)[:, None] * np.cross(way, u)
    corners = np.concatenate([np.stack([k, (k + 1) % n, (k + 1) % n + n], 1), np.stack([k, (k + 1) % n + n, k + n], 1)])
    points = np.concatenate([a + radius * ring, b + radius * ring]).astype(np.float32)
    stage.add(points, corners.astype(np.int32), np.eye(4), np.concatenate([ring, ring])[corners].astype(np.float32))


def test_a_pixel_that_no_edge_parts_is_not_half_lit():
    """Rails of a ladder, of which rungs shade one side: an edge two pixels away gave what is lit a half."""
    stage = Stage(480, 270, eye=(3, -6, 1.5), at=(-0.5, -1, 0.9))
    for x in (-1.2, -0.7):
        tube(stage, (x, -2.2, 0), (x, -1.02, 2.1), 0.035, 12)
    for k in range(8):
        y, z = (k + 0.7) / 8.5 * 1.18 - 2.2, (k + 0.7) / 8.5 * 2.1
        tube(stage, (-1.2, y, z), (-0.7, y, z), 0.02, 10)
    light, things = stage.light(Lamp("sun", width=0.035, model=ways()), rims=True)[..., 0], stage.objects()
    assert specks(light, np.where(things > 2, things, np.arange(things.size).reshape(things.shape) + 99)).max() < 0.1


@pytest.mark.parametrize("thick, shown", [(0.025, 0), (0.055, 1)])
def test_a_face_narrower_than_a_pixel_is_lit_from_end_to_end_or_not_at_all(thick, shown):
    """The top of a board that leans to one side, brighter than its front."""
    stage = Stage(320, 180, eye=(0, -9, 4.4), at=(0, 0, 2.6))
    turn = look((0, 0, 0), (0, 1, 0))[:3, :3] @ np.array([[1, 0.06, 0], [-0.06, 1, 0], [0, 0, 1]])
    board = moved(0, 0, 2.6)
    board[:3, :3] = turn * (2.0, 0.4, thick)
    stage.add(CUBE, CUBE_CORNERS, board)
    lamp = Lamp("sun", width=0.00925, model=ways(0, -2))
    board, tops = stage.objects() == 3, []
    columns = np.flatnonzero(board.any(0))[8:-8]
    for rims in (False, True):
        light = stage.light(lamp, rims=rims)[..., 0]
        top = light[board.argmax(0)[columns], columns]
        tops.append((top > 1.2 * np.median(light[board])).mean())
    assert 0.1 < tops[0] < 0.9
    assert tops[1] == shown


@pytest.mark.parametrize("frame", [Frame(160, 90), Frame(160, 90, 70, 31)], ids=["whole", "part"])
def test_at_rims_light_is_within_that_of_the_same_thing_about(frame):
    stage = Stage(160, 90, smooth=True)
    lamp, part = Lamp("sun", (1.0, 0.5, 0.25), model=look((1, 5, 1.5), (0, 0, 0))), np.s_[frame.y:, frame.x:]
    light = stage.light(lamp, depth=stage.depth()[part], frame=frame, rims=True)
    level, thing = (np.pad(a, 1, constant_values=np.nan) for a in (light.max(2), stage.objects()[part]))
    held, rims = 0, 0
    for y, x in np.argwhere(thing > 0):
        same = thing[y - 1:y + 2, x - 1:x + 2] == thing[y, x]
        same[1, 1] = False
        if np.isnan(thing[y - 1:y + 2, x - 1:x + 2]).any() or same[::2, 1].all() & same[1, ::2].all() or not same.any():
            continue
        about = level[y - 1:y + 2, x - 1:x + 2][same]
        assert about.min() * 0.9999 <= level[y, x] <= about.max() * 1.0001
        rims, held = rims + 1, held + (level[y, x] in about)
    assert rims > 100 and held > 5
    assert (light == stage.light(lamp, rims=True)[part]).all() and (light != stage.light(lamp)[part]).any()
    lit = light.max(2) > 0
    np.testing.assert_allclose(light[lit] / light.max(2)[lit][:, None], [(1, 0.5, 0.25)] * lit.sum(), rtol=1e-5)


@pytest.mark.parametrize("shift", [0.2, 0.5, 0.8])
def test_the_shadow_of_a_bar_on_what_holds_it_throws_none_on_the_bar(shift):
    """Posts whose fronts lie a little behind that of a bar across them."""
    stage = Stage(640, 360, eye=(2.2, -6.0, 2.6), at=(-0.2, 0.6, 0.8))
    for key in range(2):
        stage.scene.instance(key, None)
    stage.meshes.clear()
    for k in range(8):
        size, at = (0.02, 0.02, 0.75), (-2.4 + 0.13 * k, 1.8, 0.75)
        if k == 7:
            size, at = (0.5, 0.03, 0.03), (-2.0, 1.8, 1.5)
        model = np.diag([*size, 1.0])
        model[:3, 3] = at
        stage.add(CUBE, CUBE_CORNERS, model)
    stage.projection[:2] *= 2 / 2.6
    part, found = Frame(640, 360, 180, 80), []
    for k in range(4):
        stage.projection[:2, 2] = (shift + k / 4) / 320, (shift + k / 4) / 180
        depth, bar = stage.depth(part, (100, 30)), stage.objects()[80:110, 180:280]
        light = stage.light(Lamp("point", width=0.5, model=moved(1.2, -2.2, 3.4)), depth=depth, frame=part)[..., 0]
        others = 9 + np.arange(bar.size).reshape(bar.shape)
        found.append(specks(light, np.where(bar == 8, 8, others)).max())
    assert max(found) < 0.1


def waves(n=40):
    """(points, corners, normals) of a smooth surface with hollows."""
    x, y = np.meshgrid(np.linspace(-1, 1, n), np.linspace(-1, 1, n))
    points = np.stack([2 * x, 2 * y, 0.12 * np.cos(4.5 * x) * np.cos(3.7 * y)], -1).reshape(-1, 3)
    normals = np.stack([0.27 * np.sin(4.5 * x) * np.cos(3.7 * y), 0.222 * np.cos(4.5 * x) * np.sin(3.7 * y),
                        np.ones_like(x)], -1).reshape(-1, 3)
    k = (np.arange(n - 1)[:, None] * n + np.arange(n - 1)).ravel()
    corners = np.concatenate([np.stack([k, k + 1, k + n + 1], 1), np.stack([k, k + n + 1, k + n], 1)])
    return points.astype(np.float32), corners.astype(np.int32), reference.unit(normals)[corners].astype(np.float32)


@pytest.mark.parametrize("lamp", [Lamp("rectangle", width=1, height=1, model=look((3, 1.5, 0.6), (0, 0, 0))),
                                  Lamp("point", width=0.4, model=look((3, 1.5, 0.6), (0, 0, 0)))],
                         ids=["rectangle", "ball"])
def test_hollows_of_a_smooth_surface_have_no_specks(lamp):
    stage = Stage(320, 180, eye=(1, -4, 3), at=(0, 0, 0))
    for key in (0, 1):
        stage.scene.instance(key, None)
    points, corners, normals = waves()
    stage.scene.geometry(2, points, corners, normals)
    stage.scene.instance(2, 2)
    depth = library.raster([Mesh(points, corners)], stage.view, stage.projection, Frame(320, 180), (320, 180), 0.1,
                           outputs=("depth",))["depth"]
    light = stage.light(lamp, depth=depth)[..., 0]
    assert specks(light, np.ones_like(light)).max() < 0.005


def test_a_tall_lift_passes_by_no_shadow():
    """A lid whose corners are shaded as if it were round: rays that graze nothing begin on it, below what stands
    there."""
    turn = np.arange(16) * np.pi / 8
    points = np.append(np.stack([np.cos(turn), np.sin(turn), 0 * turn], 1), [[0, 0, 0]], 0).astype(np.float32)
    corners = np.array([(k, (k + 1) % 16, 16) for k in range(16)], np.int32)
    normals = reference.unit(points + (0, 0, 0.6))[corners].astype(np.float32)
    stage = Stage(96, 64, eye=(0.5, -3, 5), at=(0, 0, 1.5))
    stage.meshes.pop()  # what follows takes the cube's place
    stage.add(points, corners, moved(0, 0, 1.5, 1.0), normals)
    stage.add(CUBE, CUBE_CORNERS, moved(0, 0, 1.61, 0.1))
    light = stage.light(Lamp("sun", model=look((1, 0, 1), (0, 0, 0))))[..., 0]
    # The cube's shadow, which lies at its foot on the lid.
    p = stage.projection @ stage.view @ (-0.18, 0, 1.5, 1)
    x, y = (p[:2] / p[3] * (0.5, -0.5) + 0.5) * (96, 64)
    assert light[int(y), int(x)] == 0


def parts(lamp, n):
    """n * n rectangles that make one."""
    k = (np.arange(n) + 0.5) / n - 0.5
    return [Lamp("rectangle", tuple(c / n**2 for c in lamp.color), width=lamp.width / n, height=lamp.height / n,
                 model=lamp.model @ moved(a * lamp.width, b * lamp.height, 0)) for a in k for b in k]


def test_a_wide_penumbra_has_no_bands():
    stage = Stage(960, 8, eye=(0.3, -6, 3), at=(0.3, 0, 3))
    wall = np.array([[-30, 3, -30], [30, 3, -30], [30, 3, 30], [-30, 3, 30]], np.float32)
    stage.add(wall, PLANE_CORNERS, np.eye(4))
    for k in range(3):  # bars whose shadows are nowhere whole
        model = np.diag([0.04, 0.04, 2.5, 1.0])
        model[:3, 3] = -0.6 + 0.7 * k, -0.5 + 0.3 * k, 7
        stage.add(CUBE, CUBE_CORNERS, model)
    lamp = Lamp("rectangle", width=2, height=2, model=look((0.8, -6, 9.0), (0, 3, 3.2)))
    found = stage.light(lamp)[..., 0]
    expected = stage.light(*parts(lamp, 6))[..., 0]
    assert np.percentile(abs(found - expected), 99) < 0.012 * expected.max()


def test_an_edge_within_half_a_shadow_leaves_no_more_than_comes_beside_it():
    """The sharp foot of a shadow where two bars cover part of the lamp: its ramp went up to all of the light."""
    stage = Stage(478, 180, eye=(0.3, -6, 3), at=(0.3, 0.6, 0.1))
    tube(stage, (-2.4, 0.9, 0.3), (2.4, 0.9, 0.3), 0.3, 48)
    for y in (-0.3, 0.3):
        tube(stage, (-2.6, y, 1.7), (2.6, y, 1.7), 0.1, 12)
    lamp = Lamp("rectangle", width=1, height=1, model=look((2.2, -2.4, 4.0), (0, 0, 0.3)))
    found, expected = stage.light(lamp)[..., 0], stage.light(*parts(lamp, 6))[..., 0]
    off = (found - expected)[stage.objects() == 1] / expected.max()
    assert (off > 0.05).sum() < 20
