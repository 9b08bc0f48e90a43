# SPDX-License-Identifier: GPL-3.0-or-later
"""What tones are drawn on, layers of things at every slant and a picture that tiles; and their twin."""

import numpy as np
import sticks
from encre.pen import library
from encre.pen.job import Frame
from reference import render as reference

CONTROLS = len(library.controls())
ALONE = dict(use_lines=False, use_shading=False, use_smudging=False, use_hatching=False, use_tones=True,
             length_unit="PIXELS")
LEVELS = [(0.15,), (0.5, 0.3, 0.2), (0.8, 0.7, 0.0), (1.1, 1.0, 0.1)]
MORE_LEVELS = [(0.1,), (0.3, 0.2, 0.1), (0.4, 0.35, 0.0), (0.6, 0.5, 0.1), (0.7, 0.8, 0.1), (0.95, 1.0, 0.0)]
RAMP = (0.05, 0.1, 0.25, 0.4, 0.5, 0.6, 0.75, 0.9, 0.95)


def there(maps):
    """1 where something is. Light where nothing is would be a shadow that is caught, which has its own test."""
    depth = maps["depth"].reshape(*maps["depth"].shape[:2], 1)
    return np.float32((depth > 0) & (depth < 1e9))


def stuck(width, height, seed=0):
    """Layers of the scene that `sticks` draws, with noise in what tones read besides."""
    rng = np.random.default_rng(seed)
    meshes, view, projection = sticks.posed(turn=0.3)
    maps = library.raster(meshes, view, projection, Frame(width, height), (width, height), 0.1,
                          outputs=("depth", "object", "shading", "anchor", "tangent", "card"))
    color, diffuse = rng.uniform(0, 1, (height, width, 3)), rng.uniform(0, 1.3, (height, width, 3))
    alpha, diffuse = rng.uniform(0.2, 1, (height, width, 1)), diffuse * there(maps)
    combined = np.concatenate([color * diffuse + rng.uniform(-0.1, 0.2, color.shape), alpha], 2)
    layers = dict(combined=combined, color=color, diffuse=diffuse, depth=maps["depth"], normal=maps["shading"],
                  object=maps["object"], anchor=maps["anchor"], tangent=maps["tangent"], card=maps["card"],
                  style=rng.integers(0, 4, (height, width)), specular=rng.uniform(0, 0.4, color.shape))
    # of each control its own numbers, so that one more changes nothing else
    layers["controls"] = np.stack([np.random.default_rng((seed, 1, k)).uniform(-0.5, 0.5, (height, width))
                                   for k in range(CONTROLS)], -1)
    return {name: np.ascontiguousarray(a, np.float32) for name, a in layers.items()}


def tile(height=24, width=36):
    """Waves in 8 bits that repeat themselves, darkest in streaks; and texels that are hardly black, hardly white,
    beyond both, and no number."""
    y, x = np.mgrid[:height, :width]
    waves = np.sin(2 * np.pi * (2 * x / width + y / height)) + 0.5 * np.cos(2 * np.pi * (x / width - 3 * y / height))
    tile = np.round((waves - waves.min()) / np.ptp(waves) * 255) / 255
    tile[3::8, ::3], tile[5::8, ::3] = 1 / 65535, 65534 / 65535
    tile[1::8, ::3], tile[2::8, ::3], tile[7::8, 1::9] = 1.7, -0.6, np.nan
    return np.float32(tile)[..., None]


def steep(width, height, seed=0):
    """Layers of a surface that is seen ever closer to its edge from the right to the left, from places where a pixel is
    ever more of it."""
    layers = stuck(width, height, seed)
    rng = np.random.default_rng(seed)
    sine = np.geomspace(4e-4, 1, width)[None]
    turn, size = rng.uniform(0, 6, (height, width)), np.geomspace(2e-3, 0.1, height)[:, None]
    right = np.stack([np.cos(turn), np.sin(turn), 0 * turn], -1)
    down = np.sqrt(1 - sine**2)[..., None] * right + sine[..., None] * np.stack([-right[..., 1], right[..., 0],
                                                                                0 * turn], -1)
    axes = rng.permuted(np.tile([0, 1, 2], (height, width, 1)), axis=2)
    normal = np.broadcast_to((0.2, 0.1, 0.97), right.shape)
    parts = [rng.uniform(-2, 2, right.shape), normal, right * size[..., None], down * size[..., None], normal]
    parts = [np.take_along_axis(part, axes, 2) for part in parts]
    known = rng.uniform(0, 1, (height, width, 1)) > 0.1
    layers["anchor"] = np.float32(np.concatenate([*parts[:2], known * size[..., None], *parts[2:]], 2))
    del layers["style"]
    return layers


def ramped(width, height, seed=0):
    layers = stuck(width, height, seed)
    light = np.linspace(0, 1.2, width, dtype=np.float32)[None, :, None]
    layers["diffuse"] = np.ascontiguousarray(np.broadcast_to(light, layers["color"].shape)) * there(layers)
    layers["combined"][..., :3] = layers["color"] * layers["diffuse"]
    del layers["controls"], layers["style"]
    return layers


def wall(width, height):
    """Layers of a wall with a step in it, up to all borders, lighter to the right and in places."""
    y, x = np.mgrid[:height, :width]
    light = 0.1 + x / width + 0.3 * np.sin(x / 3) * np.sin(y / 2)
    one = np.ones((height, width, 3))
    layers = dict(combined=np.concatenate([one * light[..., None], one[..., :1]], 2), color=one,
                  diffuse=one * light[..., None], depth=np.where(y < height // 2, 5, 5.2 + 0.2 * (x > width // 2)),
                  normal=one, object=(x > width // 3) * 1.0)
    return {name: np.ascontiguousarray(a, np.float32) for name, a in layers.items()}


def slanted(size, down, scale=1.0, wall=False):
    """The anchor of a plane that is slanted both ways, so that its rows do not meet at right angles."""
    y, x = np.mgrid[:size[0], :size[1]]
    anchor = np.zeros((*size, 16), np.float32)
    right, down = np.array((0.01, 0.002, 0)) * scale, np.array((*down, 0.0)) * scale
    anchor[..., :3] = x[..., None] * right + y[..., None] * down
    anchor[..., 3:7] = 0, 0, 1, 0.01
    anchor[..., 7:10], anchor[..., 10:13] = right, down
    return anchor[..., (2, 0, 1, 5, 3, 4, 6, 9, 7, 8, 12, 10, 11, 13, 14, 15)].copy() if wall else anchor


TILE = tile()


def twins(layers, scene, styles=(), frame=None, few=5e-4, rounding=2e-5, wrong=5e-4):
    """The pictures, held to the reference: but for a few pixels to what rounding does, and these nearly."""
    names = ("Combined", "Encre Tones")
    got = library.render(layers, scene, styles, frame=frame, outputs=names, image=lambda _: TILE).images
    pictures = {id_: TILE for id_ in scene if id_.endswith("_image")}
    want = reference(layers, scene | pictures, styles, frame=frame and vars(frame))
    for name in names:
        off = np.abs(got[name] - want[name]).max(-1)
        assert (off > rounding).mean() < few and (off > 4e-3).mean() < wrong, (
            name, off.max(), (off > rounding).mean(), (off > 4e-3).mean())
    return got


def without_some(rng, layers, *names):
    return {name: a for name, a in layers.items() if name not in names or rng.random() < 0.7}


def flat(dark, size=(444, 444), anchor=None, tile=TILE, card=None, **scene):
    """Share of ink on a surface that is as dark everywhere."""
    height, width = size
    one = np.ones((height, width, 3), np.float32)
    layers = dict(combined=np.ones((height, width, 4), np.float32), color=one, diffuse=one, depth=5 * one[..., :1],
                  normal=one * np.float32((0, 0, 1)))
    if anchor is not None:
        layers["anchor"] = anchor
    if card is not None:
        layers["card"] = card
    ink = library.render(layers, dict(ALONE, shade_levels=[(1 - dark,)], **scene), image=lambda _: tile,
                         outputs=["Encre Tones"])
    return ink.images["Encre Tones"][..., 3]


def shaded(height, width, light=0.4, color=0.8):
    """Layers of a wall of one colour in one light; a test draws on them."""
    one = np.ones((height, width, 3))
    return dict(combined=np.ones((height, width, 4)), color=one * color, diffuse=one * light, normal=one,
                depth=np.full((height, width), 5.0))


def whole(layers):
    layers["combined"][..., :3] = layers["color"] * layers["diffuse"]
    return {name: np.ascontiguousarray(a, np.float32) for name, a in layers.items()}


def crowded(seed, height=70, width=110):
    """Bars and crumbs of many sizes and colours, on and before a wall, in shadows of many widths."""
    rng = np.random.default_rng(seed)
    layers = shaded(height, width)
    layers["object"] = np.zeros((height, width))
    for name, count, choices in (("color", 50, (0.01, 0.05, 0.3, 0.9)), ("diffuse", 40, (0.1, 0.4, 0.4, 0.9))):
        for number in range(count):
            y, x, (h, w) = rng.integers(height), rng.integers(width), rng.integers(1, [12, 40])[rng.permutation(2)]
            layers[name][y:y + h, x:x + w] = rng.choice(choices)
            if name == "color" and rng.random() < 0.3:
                layers["depth"][y:y + h, x:x + w] = rng.choice([4.8, 4.99])
                layers["object"][y:y + h, x:x + w] = number % 3
    layers["depth"][:6, -30:] = layers["diffuse"][:6, -30:] = 0
    layers["style"] = (np.arange(width) > 80) * np.ones((height, 1))
    return whole(layers)
