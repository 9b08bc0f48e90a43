# SPDX-License-Identifier: GPL-3.0-or-later
"""The judge's scenes: a few by name, and as many fresh ones as there are seeds."""

import numpy as np

from .camera import look
from .scene import Light, Scene
from .shapes import across, ball, band, box, cap, cone, disc, ground, polygon, prism, unit

SUN = unit([0.45, 0.75, 0.5])
COLORS = (0.5, 0.5, 0.45), (0.7, 0.3, 0.25), (0.3, 0.45, 0.6), (0.6, 0.55, 0.3)


def turned(yaw, pitch=0.0, roll=0.0):
    """A rotation whose columns are the turned axes."""
    (cy, sy), (cp, sp), (cr, sr) = ((np.cos(a), np.sin(a)) for a in (yaw, pitch, roll))
    about_y = np.array([[cy, 0, sy], [0, 1, 0], [-sy, 0, cy]])
    about_x = np.array([[1, 0, 0], [0, cp, -sp], [0, sp, cp]])
    about_z = np.array([[cr, -sr, 0], [sr, cr, 0], [0, 0, 1]])
    return about_y @ about_x @ about_z


def sphere(shift=0.0, **more):
    """One ball before nothing; `shift` moves it, in pixels, mostly along x."""
    size = more.setdefault("size", (300, 400))
    pixel = 5.0 / (1.2 * size[0])
    solid = ball([0.31 + 0.96 * shift * pixel, 0.05 + 0.28 * shift * pixel, 0], 1.3)
    solid.color = np.array([0.6, 0.4, 0.3])
    return Scene(look([0, 0, 5], [0, 0, 0]), [solid], Light(SUN, sun=0.0, ambient=0.7), **more)


def boxes(**more):
    """Two boxes on a floor to the horizon, one behind the other."""
    solids = [ground(0.0), box((1.6, 1.2, 1.1), (-0.9, 0.6, 0.2), turned(0.5)),
              box((1.0, 2.1, 1.0), (0.7, 1.05, -0.9), turned(-0.35)),
              box((0.8, 0.7, 0.8), (1.7, 0.9, 0.6), turned(0.3, 0.6, 0.4))]
    for solid, color in zip(solids, COLORS, strict=True):
        solid.color = np.array(color)
    return Scene(look([0.4, 2.3, 6.0], [0.2, 0.8, 0]), solids, Light(SUN, sun=0.9, ambient=0.25), **more)


def roof(**more):
    """A house with a low roof (its ridge bends by 48°) and a column of twelve sides."""
    outline = [(-1.2, -0.7), (1.2, -0.7), (1.2, 0.3), (0, 0.834), (-1.2, 0.3)]
    turns = np.arange(12) * np.pi / 6
    circle = 0.5 * np.stack([np.cos(turns), np.sin(turns)], 1)
    column = prism(circle, 1.8, (1.7, 0.9, 0.9), turned(0.2, np.pi / 2))
    house = prism(outline, 2.0, (-0.5, 0.7, 0), turned(0.6))
    house.color, column.color = np.array([0.65, 0.6, 0.5]), np.array([0.35, 0.5, 0.4])
    return Scene(look([1.2, 3.0, 6.0], [0.2, 0.7, 0]), [ground(0.0), house, column], Light(SUN), **more)


def horizon(**more):
    """A floor and a table top at a grazing angle, nearly to the horizon, with the camera rolled."""
    table = box((30, 0.2, 60), (9, -0.6, -34), turned(0.05))
    table.color = np.array([0.62, 0.5, 0.4])
    light = Light(SUN, sun=0.0, ambient=0.7)
    return Scene(look([0, 0.5, 4], [0, 0.2, 0], roll=0.07), [ground(-1.0), table], light, **more)


def patches(**more):
    """Coloured spots, polygons, caps and bands."""
    floor, block = ground(0.0), box((1.6, 1.4, 1.2), (-1.2, 0.7, 0), turned(0.45))
    floor.color, block.color = np.array([0.55, 0.5, 0.45]), np.array([0.7, 0.65, 0.6])
    polygon(floor, 0, [(0.2, 0, 1.2), (2.0, 0, 1.5), (1.4, 0, 2.3), (0.3, 0, 2.1)], np.array([0.1, 0.15, 0.4]))
    disc(floor, 0, np.array([-1.6, 0, 1.9]), 0.5, np.array([0.2, 0.45, 0.1]))
    face = block.parts[5]
    one, two = across(face.n)
    middle = face.n * (face.k - face.n @ block.reach[0]) + block.reach[0]
    polygon(block, 5, [middle + 0.4 * (a * one + b * two) for a, b in ((-1, -1), (1, -0.8), (0.9, 1), (-1, 0.7))],
            np.array([0.15, 0.3, 0.5]))
    globe = ball((0.9, 0.8, 0.1), 0.8)
    globe.color = np.array([0.75, 0.7, 0.3])
    cap(globe, (0.2, 0.9, 0.4), 0.75, np.array([0.5, 0.1, 0.1]))
    cap(globe, (-0.5, -0.2, 0.9), 0.9, np.array([0.1, 0.2, 0.35]))
    tube = cone((2.3, 0, -0.4), (0, 1, 0), 0.45, 0.45, 1.7)
    tube.color = np.array([0.5, 0.6, 0.7])
    band(tube, 0.6, 0.95, np.array([0.6, 0.15, 0.1]))
    return Scene(look([0.3, 2.0, 6.2], [0.3, 0.75, 0]), [floor, block, globe, tube],
                 Light(SUN, sun=0.0, ambient=0.7), **more)


def terminators(**more):
    """Light levels on balls, a tube and a cone, cast shadows and a pool of light on the floor."""
    solids = [ground(0.0), ball((-1.3, 0.9, 0), 0.9), cone((0.5, 0, 0), (0, 1, 0), 0.6, 0.6, 1.6),
              cone((2.0, 0, 0.2), (0, 1, 0), 0.7, 0.0, 1.7)]
    for solid in solids:
        solid.color = np.array([0.6, 0.6, 0.6])
    light = Light(unit([0.7, 0.65, 0.55]), sun=0.9, ambient=0.2, pool=((0.2, 0.3, 2.0), 0.5, 0.9))
    return Scene(look([0.3, 2.2, 6.0], [0.3, 0.7, 0]), solids, light, **more)


def parallel(**more):
    """The boxes' kind of scene under an orthographic camera."""
    solids = [ground(0.0), box((1.5, 1.2, 1.1), (-1.0, 0.6, 0.2), turned(0.4)), ball((0.8, 0.7, 0), 0.7),
              cone((2.0, 0, -0.5), (0, 1, 0), 0.5, 0.2, 1.9)]
    for solid, color in zip(solids, COLORS, strict=True):
        solid.color = np.array(color)
    return Scene(look([1, 3, 6], [0.3, 0.7, 0], height=4.5), solids, Light(SUN, sun=0.9, ambient=0.25), **more)


NAMED = {f.__name__: f for f in (sphere, boxes, roof, horizon, patches, terminators, parallel)}


def _color(rng, other=None):
    """A colour, plainly another than `other`."""
    while True:
        color = rng.uniform(0.05, 0.85, 3)
        if other is None or np.abs(np.sqrt(color) - np.sqrt(other)).max() > 0.35:
            return color


def _solid(rng, place):
    """A random solid that stands on the floor at `place` (x, z), or lies across it."""
    x, z = place
    kind = rng.integers(5)
    r = rng.uniform(0.45, 0.85)
    color = _color(rng)
    if kind == 0:
        solid = ball((x, r * rng.uniform(0.7, 1.6), z), r)
        solid.color = color
        for _ in range(rng.integers(3)):
            cap(solid, rng.normal(size=3) + (0, 0.3, 0.8), rng.uniform(0.3, 0.85), _color(rng, color))
            if len(solid.patches) == 2:  # two caps that overlap make slivers: keep them apart
                solid.patches.pop()
        return solid
    if kind == 1:
        height = rng.uniform(0.8, 2.2)
        solid = cone((x, 0, z), (0, 1, 0), r * 0.8, r * 0.8 * rng.choice([0, 0.5, 1]), height)
        solid.color = color
        if rng.random() < 0.5:
            low = rng.uniform(0.2, 0.45)
            band(solid, low * height, (low + rng.uniform(0.2, 0.3)) * height, _color(rng, color))
        return solid
    if kind == 2:
        pitch = rng.uniform(0.45, 1.0)
        wide, tall = r, rng.uniform(0.3, 1.0)
        outline = [(-wide, -tall), (wide, -tall), (wide, 0), (0, wide * pitch), (-wide, 0)]
        solid = prism(outline, rng.uniform(0.8, 1.8), (x, tall, z), turned(rng.uniform(-1.5, 1.5)))
    elif kind == 3:
        n = rng.integers(3, 9)
        turns = np.arange(n) * 2 * np.pi / n
        height = rng.uniform(0.6, 2.0)
        solid = prism(r * np.stack([np.cos(turns), np.sin(turns)], 1), height, (x, height / 2, z),
                      turned(rng.uniform(0, 1), np.pi / 2))
    else:
        size = rng.uniform(0.5, 1.7, 3)
        flying = rng.random() < 0.4
        turn = turned(rng.uniform(-0.8, 0.8), *(rng.uniform(-0.6, 0.6, 2) if flying else ()))
        solid = box(size, (x, size[1] / 2 + flying * rng.uniform(-0.2, 0.7), z), turn)
    solid.color = color
    if kind == 4 and rng.random() < 0.6:
        part = rng.choice([k for k, p in enumerate(solid.parts) if p.n[2] > 0.3] or [0])
        face = solid.parts[part]
        middle = solid.reach[0] + face.n * (face.k - face.n @ solid.reach[0])
        disc(solid, part, middle, rng.uniform(0.15, 0.5) * size.min(), _color(rng, color))
    return solid


def draw(seed, **more):
    """A floor and up to six solids, some cut into it, overlapping on screen; light and camera are random too."""
    rng = np.random.default_rng(seed)
    floor = ground(0.0)
    floor.color = _color(rng)
    if rng.random() < 0.5:
        turns = np.arange(4) * np.pi / 2 + rng.uniform(0, 1)
        spot = rng.uniform(-1, 1, 2) * (1.5, 0.4) + (0, 2.0)
        polygon(floor, 0, [(spot[0] + 0.8 * np.cos(t), 0, spot[1] + 0.5 * np.sin(t)) for t in turns[::-1]],
                _color(rng, floor.color))
    columns = np.linspace(-2.2, 2.2, rng.integers(4, 7))
    solids = []
    for x in columns:
        solid = _solid(rng, (x + rng.uniform(-0.2, 0.2), rng.uniform(-2.2, 1.2)))
        gaps = [np.linalg.norm(solid.reach[0] - other.reach[0]) - solid.reach[1] - other.reach[1] for other in solids]
        if min(gaps, default=1.0) > 0:  # there is no formula for how all pairs of kinds cut into each other
            solids.append(solid)
    way = unit(rng.normal(size=3) * (0.6, 0.2, 0.5) + (0, 0.8, 0.4))
    light = Light(way, sun=rng.uniform(0.6, 1.0), ambient=rng.uniform(0.15, 0.4))
    eye = np.array([rng.uniform(-2, 2), rng.uniform(0.9, 3.2), rng.uniform(5.0, 6.5)])
    camera = look(eye, (0, 0.7, 0), roll=rng.uniform(-0.1, 0.1))
    if rng.random() < 0.2:
        camera.height = rng.uniform(3.5, 5)
        camera.eye = camera.eye + 200 * camera.view[2]  # its plane is clear of the floor
    return Scene(camera, [floor, *solids], light, **more)
