# SPDX-License-Identifier: GPL-3.0-or-later
"""Small layers of random shapes, averaged over the pixel as a renderer does, for what looks at more than noise."""

import numpy as np
from encre.pen import library

CONTROLS = len(library.controls())

FINER = 6  # samples a pixel, each way


def _cover(rng, y, x, kind, size):
    """Where a shape is: a half plane, a stripe or a disc."""
    height, width = size
    turn = rng.uniform(0, 2 * np.pi)
    off = (x - rng.uniform(0.2, 0.8) * width) * np.cos(turn) + (y - rng.uniform(0.2, 0.8) * height) * np.sin(turn)
    if kind == "half":
        return off > 0
    if kind == "disc":
        middle = rng.uniform(0.1, 0.9, 2) * size
        return np.hypot(y - middle[0], x - middle[1]) < rng.uniform(2, max(2, 0.4 * height))
    return np.abs(off) < rng.uniform(0.2, 1.6)


def _patches(rng, size, kinds, values):
    """(H, W, C): a value for each shape, averaged; and the same at pixel centres."""
    height, width = size
    y, x = (np.mgrid[:height * FINER, :width * FINER] + 0.5) / FINER - 0.5
    fine = np.tile(values(), (*y.shape, 1))
    for kind in kinds:
        fine[_cover(rng, y, x, kind, size)] = values()
    mean = fine.reshape(height, FINER, width, FINER, -1).mean((1, 3))
    return mean


def shapes(seed, size=(30, 44), things=0, wires=0, noise=0.0, mirror=False, painted=False, styles=0, busy=True,
           strong=1.0, light=1.0, inlaid=0, specks=0, joints=False, without=(), cut=(0, 0)):
    """Faces, colours and shadows; things before them that depth and index tell; wires thinner than a pixel or so.
    cut: pixels that are cut off, of the rows above and below and of the columns left and right."""
    rng = np.random.default_rng(seed)
    height, width = size
    y, x = np.mgrid[:height, :width].astype(float)

    def normal():
        v = rng.standard_normal(3) if strong == 1 else (0, 0, 1) + strong * rng.standard_normal(3)
        return v / np.linalg.norm(v)

    def color():
        return 0.4 + strong * (rng.uniform(0, 1, 3) - 0.4)

    kinds = ("half", "half", "stripe", "disc", "stripe") if busy else ()
    layers = {"normal": _patches(rng, size, kinds[1:], normal),
              "albedo": _patches(rng, size, kinds, color),
              "diffuse": _patches(rng, size, ("half", "stripe")[:2 * busy],
                                  lambda: np.full(3, 0.8 + strong * rng.uniform(-0.7, 0.6)))}
    wave = np.sin(rng.uniform(0.05, 0.2) * x + rng.uniform(0.05, 0.2) * y)
    layers["diffuse"] *= light * (1 + strong * (0.5 * wave - 0.3))[..., None]
    layers["depth"] = 6 + 0.02 * x + 0.03 * y + rng.uniform(0, 0.002) * x * y
    layers["object"], layers["material"] = np.zeros(size), np.zeros(size)
    fy, fx = (np.mgrid[:height * FINER, :width * FINER] + 0.5) / FINER - 0.5
    for k in range(things + wires):
        state = rng.bit_generator.state
        part = _cover(rng, fy, fx, "disc" if k < things else "stripe", size)
        rng.bit_generator.state = state
        hit = _cover(rng, y, x, "disc" if k < things else "stripe", size)
        share = part.reshape(height, FINER, width, FINER).mean((1, 3))[..., None]
        z = rng.uniform(2, 5.9)
        if strong < 1:  # nothing but depth tells, and hardly
            layers["depth"] = np.where(hit, layers["depth"] * (1 - 0.02 * z * strong), layers["depth"])
        else:
            layers["depth"] = np.where(hit, z + 0.01 * x, layers["depth"])
            layers["object"] = np.where(hit, k + 1 if rng.random() < 0.7 else 0, layers["object"])
            layers["material"] = np.where(hit, k % 2, layers["material"])
        layers["normal"] = share * normal() + (1 - share) * layers["normal"]
        layers["albedo"] = share * rng.uniform(0, 1, 3) + (1 - share) * layers["albedo"]
    if joints:  # between bricks that lean: of two pixels and of six
        lean = rng.uniform(0, 0.4)
        across, up = np.cos(lean) * fx + np.sin(lean) * fy, np.cos(lean) * fy - np.sin(lean) * fx
        part = (up % 9.3 < 1.7) | ((across + 8.5 * (np.floor(up / 9.3) % 2)) % 17 < 6)
        layers["albedo"][:] = 0.5 - 0.1 * part.reshape(height, FINER, width, FINER).mean((1, 3))[..., None]
    if things and strong == 1 and rng.random() < 0.5:
        sky = _cover(rng, y, x, "disc", size)
        layers["depth"] = np.where(sky, 1e10, layers["depth"])
        layers["normal"] = np.where(sky[..., None], 0, layers["normal"])
    layers["combined"] = np.concatenate([layers["albedo"] * layers["diffuse"], np.ones((*size, 1))], -1)
    layers["color"] = layers["albedo"]
    if mirror:
        glass = _cover(rng, y, x, "half", size)[..., None]
        layers["seen_normal"] = np.where(glass, _patches(rng, size, kinds, normal), layers["normal"])
        layers["seen_color"] = np.where(glass, _patches(rng, size, kinds, color), layers["albedo"])
        far = _patches(rng, size, ("half", "stripe"), lambda: np.array([rng.uniform(7, 30)]))
        if strong < 1:  # next to the surface itself
            far = layers["depth"][..., None] * (1 + 0.02 * strong * far)
        layers["seen_depth"] = np.where(glass[..., 0], far[..., 0], layers["depth"])
    if noise:
        for name in ("normal", "albedo", "diffuse", *(("seen_normal", "seen_color") if mirror else ())):
            layers[name] = layers[name] * (1 + noise * rng.standard_normal(layers[name].shape))
    for _ in range(inlaid):  # of another material, or another object, and nothing else tells it
        layers[rng.choice(("material", "object"))][_cover(rng, y, x, "disc", size)] = rng.integers(5, 9)
    for k in range(specks):  # of other objects, a few pixels large
        y, x = rng.integers((0, 0), size)
        high, wide = rng.integers(1, 4, 2)
        layers["object"][y:y + high, x:x + wide] = 10 + k
        layers["object"][y, x:x + wide + rng.integers(0, 2)] = 10 + k
    if painted:
        layers["controls"] = np.where(rng.random((*size, 1)) < 0.7, 0, rng.uniform(-0.3, 0.3, (*size, CONTROLS)))
        if painted < 0:
            layers["controls"][:] = 0.3
        layers["controls"][np.arange(height) % int(painted) != 0] = 0  # in every so many rows
    if styles:
        layers["style"] = np.minimum(_patches(rng, size, ("half", "disc"), lambda: rng.integers(0, styles + 1, 1)),
                                     styles).round()[..., 0]
    inner = tuple(slice(n, size[k] - n) for k, n in enumerate(cut))
    return {name: np.ascontiguousarray(a[inner], np.float32) for name, a in layers.items() if name not in without}


def forms(seed, size=(30, 44), steep=1.0, bumps=6, rough=0.0, cut=(0, 0), without=(), **how):
    """Smooth hills and dents all over, from the front; what shapes() has no faces for, with these before it."""
    rng = np.random.default_rng(seed)
    layers = shapes(seed, size, busy=False, **how)
    y, x = np.mgrid[:size[0], :size[1]].astype(float)
    tilt = np.zeros((2, *size))
    for _ in range(bumps):
        turn, wide, long = rng.uniform(0, np.pi), rng.uniform(1.5, 6), rng.uniform(4, 60)
        middle = rng.uniform(0, 1, 2) * size
        off = (x - middle[1]) * np.cos(turn) + (y - middle[0]) * np.sin(turn)
        by = (y - middle[0]) * np.cos(turn) - (x - middle[1]) * np.sin(turn)
        much = rng.choice((-1, 1)) * steep * rng.uniform(0.2, 1.5) * np.exp(-(off / wide)**2 - (by / long)**2)
        tilt += much * np.array([np.cos(turn), np.sin(turn)])[:, None, None]
    tilt += rough * rng.standard_normal(tilt.shape)
    normal = np.stack([-tilt[0], tilt[1], np.ones(size)], -1)
    bare = np.linalg.norm(layers["normal"], axis=-1, keepdims=True) > 0
    layers["normal"] = bare * normal / np.linalg.norm(normal, axis=-1, keepdims=True)
    inner = tuple(slice(n, size[k] - n) for k, n in enumerate(cut))
    return {name: np.ascontiguousarray(a[inner], np.float32) for name, a in layers.items() if name not in without}


def sweeps(seed, size=(20, 60)):
    """Stripes and steps side by side, of all averaged layers but light, that grow from row to row from what is none to
    three times as much; what stands for a mirror shows them, too."""
    rng = np.random.default_rng(seed)
    height, width = size
    x = np.tile((np.arange(width * FINER) + 0.5) / FINER - 0.5, (height, 1)) + 0.02 * np.arange(height)[:, None]

    def profile():
        """(H, W): of cells of 10 pixels, by turns a stripe and a step."""
        at, cell = x % 10 - 5, (x // 10).astype(int) % 8
        broad, off = rng.uniform(0.5, 2.2, 8)[cell], rng.uniform(-0.5, 0.5, 8)[cell]
        soft = np.where(cell % 2, np.abs(at - off) < broad / 2, np.clip((at - off) / broad + 0.5, 0, 1) - at / 10 - 0.5)
        return soft.reshape(height, width, FINER).mean(2)[..., None]

    grown = np.geomspace(0.25, 0.8, height)[:, None, None]
    ones = np.ones((height, width, 3))
    way = (0.6, 0.8, 0)
    layers = dict(normal=ones * (0, 0, 1) + 0.35 * grown * profile() * way,
                  diffuse=ones,
                  albedo=0.4 * ones + 0.03 * grown * profile() * (1, -0.5, 0.3), depth=4 * ones[..., 0],
                  seen_normal=ones * (0, 0, -1) + 0.6 * grown * profile() * way,
                  seen_color=0.4 * ones + 0.03 * grown * profile() * (1, -0.5, 0.3), seen_depth=9 * ones[..., 0],
                  combined=np.ones((height, width, 4)))
    layers["color"] = layers["albedo"]
    return {name: np.ascontiguousarray(a, np.float32) for name, a in layers.items()}


def wires(seed, size=(40, 52), count=4, without=(), noise=0.0):
    """Wires of every width and contrast before a wall that a step divides, some of them just before it."""
    rng = np.random.default_rng(seed)
    height, width = size
    fy, fx = (np.mgrid[:height * FINER, :width * FINER] + 0.5) / FINER - 0.5
    y, x = np.mgrid[:height, :width].astype(float)
    depth = np.where(_cover(rng, y, x, "half", size), 5.0, 5.0 * (1 + rng.choice([0, 0.002, 0.1, 0.3, 0.6])))
    object_ = np.zeros(size)
    value = np.tile(np.r_[np.full(3, 0.5), 0, 0, 0.9], (*size, 1))
    for k in range(count):
        turn, broad = rng.uniform(0, np.pi), rng.uniform(0.3, 3.6)
        at = rng.uniform(0.15, 0.85, 2) * size

        def off(y, x, turn=turn, at=at):
            return np.abs((x - at[1]) * np.cos(turn) + (y - at[0]) * np.sin(turn))

        share = (off(fy, fx) < broad / 2).reshape(height, FINER, width, FINER).mean((1, 3))[..., None]
        own = value.mean((0, 1)) + rng.standard_normal(6) * np.repeat(rng.choice([0.03, 0.08, 0.3], 2), 3)
        value = share * own + (1 - share) * value
        hit = off(y, x) < broad / 2
        object_ = np.where(hit & (rng.random() < 0.7), k + 1, object_)
        depth = np.where(hit, np.minimum(depth, 5 * rng.choice([0.5, 0.9, rng.uniform(0.985, 0.993)])), depth)
    value = value + noise * rng.standard_normal(value.shape)
    layers = dict(combined=np.ones((*size, 4)), color=value[..., :3], diffuse=np.ones((*size, 3)), depth=depth,
                  object=object_, normal=value[..., 3:])
    return {name: np.ascontiguousarray(a, np.float32) for name, a in layers.items() if name not in without}


def dapples(seed, size):
    """Nothing but light, that drifts, jumps and has noise, much of it about the thresholds of levels."""
    rng = np.random.default_rng(seed)
    y, x = np.mgrid[:size[0], :size[1]].astype(float)
    light = 0.45 + rng.uniform(0.01, 0.3) * np.sin(rng.uniform(0.02, 0.3) * x + rng.uniform(0.02, 0.6) * y)
    light *= np.where(_cover(rng, y, x, "half", size), 1, rng.choice((1, 1.02, 1.5)))
    light *= 1 + rng.choice((0.003, 0.02, 0.1)) * rng.standard_normal(size)
    flat = np.ones((*size, 3))
    layers = dict(combined=np.ones((*size, 4)), color=0.5 * flat, albedo=0.5 * flat, normal=flat * (0, 0, 1),
                  depth=4 * np.ones(size), diffuse=light[..., None] * rng.uniform(0.8, 1, (*size, 3)))
    return {name: np.ascontiguousarray(a, np.float32) for name, a in layers.items()}
