# SPDX-License-Identifier: GPL-3.0-or-later
"""Figures as images on a plane before a camera, at any size of their texels, and how good the lines around them are."""

import functools
import zlib

import numpy as np
from encre.pen import library
from encre.pen.chains import told
from encre.pen.job import Camera, Colored, Colors, Frame, Mesh

SIZE = (480, 270)
LIGHT, DARK = np.float32([0.75, 0.7, 0.5]), np.float32([0.08, 0.12, 0.4])
LOOK = {"edge_detector": "FINE", "edge_threshold": 0.1, "contrast_full": 0.3, "line_color_strength": 1.0,
        "line_outline_strength": 0.0, "line_inner_strength": 0.0, "line_crease_strength": 0.0, "line_thickness": 3.0,
        "line_search": "EXACT", "length_unit": "PIXELS", "use_lines": True, "use_shading": False, "line_contrast": 0.0,
        "line_color_width": 1.0,
        "pen_1_softness": 0.0, "pen_1_steepness": 0.5, "pen_1_intensity": 2.0, "pen_1_grain": 0.0}
SIDE = 224            # pixels that a figure is wide, facing the camera; but it has LEAST texels from side to side
LEAST = 32
TEXELS = 0.25, 0.5, 1.0, 2.0, 4.0, 8.0, 16.0
TURNS = 0.0, 60.0
APART = 10            # pixels: nearer boundaries may thin out
WIDE = LOOK["line_thickness"]


# ---- pictures ------------------------------------------------------------------------------------------------------


def drawn(inside, size, parts=8):
    """An image (size, size, 3) of what inside(x, y) tells, in texels, with edges mixed over a texel."""
    share = np.empty((size, size, 1), np.float32)
    for row in range(size):
        y, x = (np.mgrid[:parts, :size * parts] + 0.5) / parts
        told_ = inside(x, y + row).astype(np.float32)
        share[row] = told_.reshape(1, parts, size, parts).mean((1, 3))[..., None]
    return (LIGHT + (DARK - LIGHT) * share).astype(np.float32)


def plane(image, texel, turn=0.0, key=1, closest=False, repeats=1, shift=(0.0, 0.0)):
    """(layers, chains) of an image on a plane that is turned about X, `texel` pixels a texel, `shift` pixels right and
    down of the middle."""
    width, height = SIZE
    side = image.shape[0] * texel * repeats / 100
    corners = np.float32([[-side, -side, 0], [side, -side, 0], [side, side, 0], [-side, side, 0]]) / 2
    faces, uv = np.int32([[0, 1, 2], [0, 2, 3]]), np.float32([[0, 0], [1, 0], [1, 1], [0, 1]]) * repeats
    a, model, view, projection = np.radians(turn), np.eye(4), np.eye(4), np.diag([200 / width, 200 / height, -0.02, 1])
    model[1:3, 1:3] = [[np.cos(a), -np.sin(a)], [np.sin(a), np.cos(a)]]
    view[:3, 3] = shift[0] / 100, -shift[1] / 100, -20
    mesh = Mesh(corners, faces, object_index=1, material_index=1, uv=uv[faces], model=model,
                edges=np.uint8([2 << 4, 2]))
    every = library.load().complete(library.load().check(LOOK), [])
    colors = Colors([Colored(image, key, closest=closest)], np.int32([-1, 0]), every)
    found = library.chains([mesh], view, projection, Frame(*SIZE), SIZE, 0.1, 100, colors=colors)
    x, y = np.meshgrid((np.arange(width) + 0.5 - width / 2 - shift[0]) / 100 / side + 0.5,
                       0.5 - (np.arange(height) + 0.5 - height / 2 - shift[1]) / 100 / side / np.cos(a))
    there = (x > 0) & (x < 1) & (y > 0) & (y < 1)
    picked = sampled(image, x * repeats, y * repeats, closest)
    layers = {"combined": np.ones((height, width, 4), np.float32),
              "color": np.where(there[..., None], picked, image[0, 0]),
              "diffuse": np.ones((height, width, 3), np.float32),
              "depth": np.where(there, 20 - (y - 0.5) * side * np.sin(a), 1e10).astype(np.float32),
              "normal": np.where(there[..., None], np.float32([0, 0, 1]), np.float32(0)),
              "object": there.astype(np.float32)}
    return layers, told(found, np.float32([0, 1]), np.array([3, 3]))


def sampled(image, u, v, closest):
    size = image.shape[0]
    x, y = u * size, v * size
    if closest:
        return image[np.floor(y).astype(int) % size, np.floor(x).astype(int) % size]
    x, y = x - 0.5, y - 0.5
    i, j = np.floor(x).astype(int), np.floor(y).astype(int)
    s, t = (x - i)[..., None].astype(np.float32), (y - j)[..., None].astype(np.float32)
    a, b, c, d = (image[(j + n) % size, (i + m) % size] for n, m in ((0, 0), (0, 1), (1, 0), (1, 1)))
    return (a * (1 - s) + b * s) * (1 - t) + (c * (1 - s) + d * s) * t


def ink(layers, chains, **more):
    return drawn_by(layers, chains, **more)[0]


def drawn_by(layers, chains, strokes=False, **more):
    """(ink, its strokes or None)."""
    every = library.load().complete(library.load().check(LOOK | more), [])
    made = library.draw(layers, every, Camera((1, 0, 0, 0, 1, 0, 0, 0, 1), True, SIZE[1] / 100),
                        outputs=["Encre Lines"], chains=chains, strokes=strokes)
    return made.images["Encre Lines"][..., 3], made.strokes


def exactly(strokes, shift, parts=4):
    """The ink of strokes moved by `shift` pixels, by what they cover of `parts` x `parts` parts of a pixel."""
    out = np.zeros((SIZE[1] * parts, SIZE[0] * parts), np.float32)
    follows = strokes["stroke"][1:] == strokes["stroke"][:-1]
    ends = np.stack([strokes["x"] + shift[0], strokes["y"] + shift[1]], 1).astype(float)
    for a, b, one, other in zip(ends[:-1][follows], ends[1:][follows], strokes[:-1][follows], strokes[1:][follows],
                                strict=True):
        reach = max(one["width"], other["width"]) / 2 + 1
        (x0, y0), (x1, y1) = (np.clip(np.round(parts * (v + 0.5)), 0, out.shape[::-1]).astype(int)
                              for v in (np.minimum(a, b) - reach, np.maximum(a, b) + reach))
        x, y = (np.arange(x0, x1) + 0.5) / parts - 0.5, (np.arange(y0, y1)[:, None] + 0.5) / parts - 0.5
        way = b - a
        t = np.clip(((x - a[0]) * way[0] + (y - a[1]) * way[1]) / max(way @ way, 1e-9), 0, 1)
        wide = one["width"] + t * (other["width"] - one["width"])
        far = np.hypot(x - a[0] - t * way[0], y - a[1] - t * way[1])
        there = np.clip((wide / 2 - far) * parts + 0.5, 0, 1)
        np.maximum(out[y0:y1, x0:x1], there * one["ink"][3], out=out[y0:y1, x0:x1])
    return out.reshape(SIZE[1], parts, SIZE[0], parts).mean((1, 3))


# ---- figures: of a side of 1, v up ---------------------------------------------------------------------------------


def _round(middle, radius):
    t = np.linspace(0, 2 * np.pi, 4001)
    return np.stack([middle[0] + radius * np.cos(t), middle[1] + radius * np.sin(t)], 1)


def _closed(*corners):
    return np.array([*corners, corners[0]], float)


def _within(outline, x, y):
    """Whether places lie in a closed outline."""
    inside = np.zeros(np.broadcast(x, y).shape, bool)
    for (ax, ay), (bx, by) in zip(outline[:-1], outline[1:], strict=True):
        if ay != by:
            inside ^= ((ay > y) != (by > y)) & (x < ax + (y - ay) / (by - ay) * (bx - ax))
    return inside


DISC = [_round((0.5, 0.5), 0.35)]
LETTER = [_closed((0.25, 0.125), (0.375, 0.125), (0.375, 0.4375), (0.625, 0.4375), (0.625, 0.125), (0.75, 0.125),
                  (0.75, 0.875), (0.625, 0.875), (0.625, 0.5625), (0.375, 0.5625), (0.375, 0.875), (0.25, 0.875))]
SIGN = [_closed(*((0.5 + 0.4 * np.cos(a), 0.5 + 0.4 * np.sin(a)) for a in np.pi / 8 + np.arange(8) * np.pi / 4)),
        _closed((0.25, 0.43), (0.75, 0.43), (0.75, 0.57), (0.25, 0.57))]
CHECKS = 8


def disc(size):
    return drawn(lambda x, y: (x - size / 2) ** 2 + (y - size / 2) ** 2 < (0.35 * size) ** 2, size)


def _checker(size):
    return drawn(lambda x, y: (np.floor(x * CHECKS / size) + np.floor(y * CHECKS / size)) % 2 > 0, size)


def _sign(size):
    """Red with a light bar before leaves out of focus, which change over 60 texels or more; with a sensor's noise."""
    rng, colors = np.random.default_rng(7), np.float32([[0.5, 0.03, 0.03], [0.8, 0.78, 0.7]])
    y, x = (np.mgrid[:size, :size] + 0.5) / size
    image = (np.float32([0.12, 0.2, 0.08]) + 0.06 * np.sin((5 * x + 3 * y) * min(1, size / 64))[..., None]
             * np.float32([1, 0.8, 0.4])).astype(np.float32)
    for outline, color in zip(SIGN, colors, strict=True):
        share = (drawn(functools.partial(_within, outline * size), size)[..., :1] - LIGHT[0]) / (DARK[0] - LIGHT[0])
        image += (color - image) * share
    return np.clip(image * (1 + rng.normal(0, 0.02, image.shape)), 0, 1).astype(np.float32)


def _grid():
    return [np.array(line, float) for k in range(1, CHECKS) for line in
            ([(k / CHECKS, 0), (k / CHECKS, 1)], [(0, k / CHECKS), (1, k / CHECKS)])]


FIGURES = {"disc": (disc, lambda: DISC),
           "letter": (lambda size: drawn(functools.partial(_within, LETTER[0] * size), size), lambda: LETTER),
           "checker": (_checker, _grid),
           "sign": (_sign, lambda: SIGN)}

SPRITE = """\
................
.....######.....
...##oooooo##...
..#oooooooooo#..
..#oooooooooo#..
.#oooooooooooo#.
.#oo###oo###oo#.
.#oo###oo###oo#.
.#oo###oo###oo#.
.#oooooooooooo#.
.#oo#oooooo#oo#.
..#oo######oo#..
..#oooooooooo#..
...##oooooo##...
.....######.....
................
""".splitlines()


def sprite():
    """(16 x 16 texels, their sides where colors part)."""
    colors = {".": (0.6, 0.75, 0.8), "#": (0.1, 0.05, 0.1), "o": (0.85, 0.6, 0.05)}
    image = np.float32([[colors[c] for c in row] for row in SPRITE[::-1]])
    lines = [np.array([(x + 1, y), (x + 1, y + 1)]) / 16
             for y, x in np.argwhere((image[:, 1:] != image[:, :-1]).any(2))]
    return image, lines + [np.array([(x, y + 1), (x + 1, y + 1)]) / 16
                           for y, x in np.argwhere((image[1:] != image[:-1]).any(2))]


# ---- measures ------------------------------------------------------------------------------------------------------


def on_screen(lines, side, turn, shift=(0.0, 0.0)):
    """(places (n, 2) less than a pixel apart along lines of a figure, which line each is of, pixels along it)."""
    places, number, along, tall = [], [], [], np.cos(np.radians(turn))
    for k, line in enumerate(lines):
        at = np.stack([(SIZE[0] - 1) / 2 + shift[0] + (line[:, 0] - 0.5) * side,
                       (SIZE[1] - 1) / 2 + shift[1] + (0.5 - line[:, 1]) * side * tall], 1)
        far = np.concatenate([[0], np.cumsum(np.hypot(*np.diff(at, axis=0).T))])
        s = np.linspace(0, far[-1], int(1.5 * far[-1]) + 2)
        places.append(np.stack([np.interp(s, far, at[:, c]) for c in (0, 1)], 1))
        number.append(np.full(len(s), k))
        along.append(s)
    return np.concatenate(places), np.concatenate(number), np.concatenate(along)


def alone(places, number, along):
    """Which places have no other boundary within APART pixels: no line but their own, and that no second time."""
    out, ends = np.ones(len(places), bool), {k: along[number == k].max() for k in np.unique(number)}
    for i, at in enumerate(places):
        near = np.abs(places - at).max(1) < APART
        far = np.abs(along[near] - along[i])
        far = np.minimum(far, ends[number[i]] - far)
        out[i] = not ((number[near] != number[i]) | (far > 2 * APART)).any()
    return out


def nearest(places, shape, reach=6):
    """(pixels to the nearest place, at most `reach`, which that is) by pixels."""
    far, which = np.full(shape, float(reach)), np.full(shape, -1)
    for i, (x, y) in enumerate(places):
        x0, x1, y0, y1 = (int(np.clip(v, 0, n)) for v, n in (
            (x - reach, shape[1]), (x + reach + 2, shape[1]), (y - reach, shape[0]), (y + reach + 2, shape[0])))
        if x1 > x0 and y1 > y0:
            d = np.hypot(np.arange(x0, x1) - x, np.arange(y0, y1)[:, None] - y)
            less = d < far[y0:y1, x0:x1]
            far[y0:y1, x0:x1][less], which[y0:y1, x0:x1][less] = d[less], i
    return far, which


def ideal(places):
    return np.clip(WIDE / 2 + 0.5 - nearest(places, SIZE[::-1])[0], 0, 1)


def judged(picture, places, own, miss):
    """(share of the places that are asked, `own`, with ink `miss` pixels away at most, mean width there in that of the
    pen, ink elsewhere by all pixels). NaN: none is asked."""
    far, which = nearest(places, picture.shape)
    stray = picture[far > WIDE / 2 + 2.5].sum() / picture.size
    if not own.any():
        return np.nan, np.nan, stray
    inky = np.argwhere(picture > 0.5)[:, ::-1]
    whole = np.mean([(np.hypot(*(inky - at).T) < miss + WIDE / 2).any() for at in places[own]])
    steps = np.hypot(*np.diff(places, axis=0).T)
    steps = np.pad(steps * (steps < 1), 1)  # none from one line to the next
    length = (own * (steps[1:] + steps[:-1])).sum() / 2
    there = which >= 0
    there[there] = own[which[there]]
    return float(whole), float(picture[there].sum() / length / WIDE), float(stray)


RIM = [np.array(edge, float) for edge in ([(0, 0), (1, 0)], [(1, 0), (1, 1)], [(1, 1), (0, 1)], [(0, 1), (0, 0)])]


def measured(name, texel, turn):
    """(whole, width, stray, still, own) of a figure; the rim of its image, where others may draw, apart. still: how
    much ink changes in a pan, in that of lines of one width, however close; own: in that of the lines that it draws,
    moved as the image is."""
    closest = name == "sprite"
    if closest:
        (image, lines), side = sprite(), 16 * texel
    else:
        make, outline = FIGURES[name]
        size = max(LEAST, int(SIDE / texel))
        image, lines, side = make(size), outline(), size * texel
    key = zlib.crc32(name.encode()) << 16 | image.shape[0]
    frames, truths, own, strokes = [], [], [], None
    for k in range(4):
        shift = k / 8, -k / 11
        rim = nearest(on_screen(RIM, side, turn, shift)[0], SIZE[::-1], APART)[0]
        shown = plane(image, texel, turn, key=key, closest=closest, shift=shift)
        picture, of = drawn_by(*shown, strokes=not k)
        picture *= rim >= 4
        strokes = strokes if k else of
        own.append(exactly(strokes, shift) * (rim >= 4))
        places, number, along = on_screen(lines, side, turn, shift)
        frames.append(picture)
        truths.append(ideal(places) * (rim >= 4))
        if not k:
            x, y = (np.clip(np.round(places[:, c]).astype(int), 0, SIZE[c] - 1) for c in (0, 1))
            inside = (places > 3).all(1) & (places < np.array(SIZE) - 4).all(1) & (rim[y, x] >= APART)
            if closest:  # its sides lie a texel apart at least
                inside &= texel * np.cos(np.radians(turn)) >= APART
            else:
                inside &= alone(places, number, along)
            found = judged(picture, places, inside, max(1, texel / 8))
    moves = [np.sqrt(np.mean(np.diff(np.array(all_), axis=0) ** 2)) for all_ in (frames, truths, own)]
    return *found, *(float(moves[0] / max(move, 1e-6)) for move in moves[1:])
