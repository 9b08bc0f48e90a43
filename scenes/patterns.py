# SPDX-License-Identifier: GPL-3.0-or-later
"""Patterns for textiles, paper and paint: areas of one colour with sharp edges.

A pattern is a function of nothing or of colours and counts that gives a picture: an array (n, n, 3), sRGB from 0 to 1,
row 0 at the bottom as in Blender. Every texel has a colour of its palette and no mixture: an edge between two areas is
a step from one texel to the next. Unless said otherwise a picture tiles in both directions.
"""

import numpy as np

CREAM, WHITE, SAND, MUSTARD, ORANGE = "#f3e4c2", "#fbf5e6", "#e2c48f", "#e3a52b", "#dd7630"
RED, WINE, PINK, BROWN, OAK = "#c63d2f", "#7d2333", "#eba79c", "#6f4326", "#c08a52"
NAVY, BLUE, SKY, TEAL, PALE = "#1d2d50", "#2f62a3", "#9ccbd9", "#1f7078", "#dfe6d2"
LEAF, SAGE, MOSS, INK, GREY = "#3f7d46", "#a9bd95", "#2f4f36", "#2b2430", "#8d8a92"


def rgb(color):
    return np.array([int(color[i:i + 2], 16) / 255 for i in (1, 3, 5)], np.float32)


def plane(n=512):
    """x and y of the texels' centres, each (n, n), from 0 to 1."""
    line = (np.arange(n, dtype=np.float32) + 0.5) / n
    return tuple(np.meshgrid(line, line))


def blank(color, n=512):
    return np.tile(rgb(color), (n, n, 1))


def pick(index, *colors):
    """The picture in which area number k has the k-th colour."""
    return np.array([rgb(color) for color in colors])[np.asarray(index).astype(int) % len(colors)]


def over(picture, where, color):
    """Paints over the picture, in place, where the mask says so."""
    picture[where] = rgb(color)
    return picture


def cells(x, y, columns, rows, brick=False):
    """Where in a grid of cells: u and v from -0.5 to 0.5, and the cell's column and row. Every second row of a brick
    grid is shifted by half a cell."""
    v = y * rows
    u = x * columns + (0.5 * (np.floor(v) % 2) if brick else 0)
    return u % 1 - 0.5, v % 1 - 0.5, np.floor(u).astype(int) % columns, np.floor(v).astype(int)


def chance(a, b, seed=0):
    """A whole number from 0 to 1023 for a pair of whole numbers, always the same."""
    n = (np.asarray(a) * 374761393 + np.asarray(b) * 668265263 + seed * 974634777) & 0xFFFFFFFF
    n = ((n ^ (n >> 13)) * 1274126177) & 0xFFFFFFFF
    return (n ^ (n >> 16)) & 1023


def turned(x, y, angle):
    c, s = np.cos(angle), np.sin(angle)
    return c * x + s * y, c * y - s * x


def almond(u, v, length, width):
    """Inside of a leaf along v: two arcs."""
    return np.abs(u) < width * (1 - (v / length) ** 2)


def flower(u, v, radius, petals, notch=0.3, turn=0.0):
    return np.hypot(u, v) < radius * (1 - notch + notch * np.cos(petals * (np.arctan2(v, u) + turn)))


def polygon(x, y, points):
    """Inside of a closed outline, by the even-odd rule."""
    inside = np.zeros(x.shape, bool)
    for (x0, y0), (x1, y1) in zip(points, points[1:] + points[:1], strict=True):
        if y0 != y1:
            inside ^= ((y < y0) != (y < y1)) & (x < x0 + (y - y0) * (x1 - x0) / (y1 - y0))
    return inside


# Textiles and papers


def bands(position, *widths_and_colors):
    """Number of the band that `position` (0…1) falls in; the widths are shares of their sum."""
    widths = np.array(widths_and_colors, float)
    return np.searchsorted(np.cumsum(widths / widths.sum())[:-1], position, side="right")


def stripes(*pairs, n=512, level=False):
    """Upright stripes from pairs (width, colour)."""
    x, y = plane(n)
    return pick(bands(y if level else x, *[width for width, _ in pairs]), *[color for _, color in pairs])


def tartan(*pairs, n=512):
    """Bands of both directions; where they cross, the mean of their colours, as twill looks from afar."""
    level, upright = stripes(*pairs, n=n, level=True), stripes(*pairs, n=n)
    return (level + upright) / 2


def checks(one, other, count=2, n=256):
    x, y = plane(n)
    return pick(np.floor(x * count) + np.floor(y * count), one, other)


def dots(ground, *colors, count=4, radius=0.3):
    u, v, i, j = cells(*plane(), count, count, brick=True)
    return np.where((np.hypot(u, v) < radius)[..., None], pick(chance(i, j, 3), *colors), rgb(ground))


def chevrons(*colors, count=2, rows=2):
    x, y = plane()
    slope = np.abs((x * count) % 1 - 0.5)
    return pick(np.floor((y * rows - slope * 0.8) * len(colors)) % len(colors), *colors)


def scallops(*colors, count=4):
    """Fish scales, each of rings."""
    x, y = plane()
    picture = blank(colors[0])
    for row in range(2 * count + 2, -4, -1):  # lower rows lie over higher ones
        u = (x * count + 0.5 * (row % 2)) % 1 - 0.5
        r = np.hypot(u, (y * 2 * count - row) / 2) / 0.5
        scale = r < 1
        picture[scale] = pick(np.floor((1 - r) * len(colors) * 0.999), *colors)[scale]
    return picture


def argyle(ground, one, other, line, count=2):
    u, v, i, j = cells(*plane(), count, count)
    picture = pick((np.abs(u) + np.abs(v) < 0.5) * (1 + (i + j) % 2), ground, one, other)
    return over(picture, np.abs(np.abs(u - v) - 0.5) < 0.03, line)


def trellis(ground, leaf, bloom, heart, count=2):
    """Wallpaper: leaves in pairs on a wavy stem, a flower in each bay."""
    x, y = plane(1024)
    u, v, i, j = cells(x, y, count, count)
    picture = blank(ground, 1024)
    for side in (-1, 1):
        stem = side * (np.abs(0.22 * np.sin(2 * np.pi * v)) + 0.06)
        over(picture, np.abs(u - stem) < 0.018, leaf)
        for at in (-0.38, -0.12, 0.12, 0.38):
            base = side * (np.abs(0.22 * np.sin(2 * np.pi * at)) + 0.06)
            for lean in (-1, 1):
                a, b = turned(u - base, v - at, lean * 0.9 - 0.25 * side)
                over(picture, almond(a, b - 0.075, 0.075, 0.028) & (b > 0), leaf)
    for at_u, at_v, size in ((0, 0.25, 0.1), (0, -0.25, 0.1), (0.5, 0, 0.13)):
        a, b = (u - at_u + 0.5) % 1 - 0.5, (v - at_v + 0.5) % 1 - 0.5
        over(picture, flower(a, b, size, 6), bloom)
        over(picture, np.hypot(a, b) < 0.3 * size, heart)
    return picture


def foliage(ground, leaf, other, rib, count=3):
    """Large leaves that lean left and right in turn."""
    u, v, i, j = cells(*plane(), count, count, brick=True)
    lean = np.where(j % 2, 0.6, -0.6)
    a, b = turned(u, v, lean)
    picture = np.where(almond(a, b, 0.46, 0.21)[..., None], pick(chance(i, j, 1), leaf, other), rgb(ground))
    veins = np.abs((b * 8 - np.abs(a) * 6) % 1 - 0.5) < 0.1
    return over(picture, almond(a, b, 0.44, 0.19) & ((np.abs(a) < 0.022) | veins), rib)


def blossoms(ground, petal, other, heart, leaf, count=3):
    u, v, i, j = cells(*plane(), count, count, brick=True)
    picture = blank(ground)
    for angle in (0.5, 2.6, 4.7):
        a, b = turned(u, v, angle)
        over(picture, almond(a, b - 0.3, 0.17, 0.075), leaf)
    kind = chance(i, j, 5) % 2 == 0
    inside = flower(u, v, 0.34, 5, 0.22)
    over(picture, inside & kind, petal)
    over(picture, inside & ~kind, other)
    over(picture, flower(u, v, 0.2, 5, 0.22, 0.6) & ~kind, petal)
    return over(picture, np.hypot(u, v) < 0.09, heart)


def houndstooth(one, other, count=4):
    x, y = plane()
    i, j = np.floor(x * count * 4).astype(int) % 4, np.floor(y * count * 4).astype(int) % 4
    twill = (np.floor(x * count * 8) + np.floor(y * count * 8)).astype(int) // 2 % 2
    return pick(np.where((i < 2) == (j < 2), i < 2, twill), one, other)


def stars(ground, star, heart, cross, count=3):
    """Eight-pointed stars, each of two squares, and crosses between them."""
    u, v, _, _ = cells(*plane(), count, count)
    square, diamond = np.maximum(np.abs(u), np.abs(v)), (np.abs(u) + np.abs(v)) / np.sqrt(2)
    a, b = 0.5 - np.abs(u), 0.5 - np.abs(v)
    picture = over(blank(ground), np.maximum(a, b) < 0.13, cross)
    over(picture, np.minimum(square, diamond) < 0.32, star)
    return over(picture, flower(u, v, 0.2, 8, 0.25), heart)


def tiles(ground, one, other, count=4):
    """Glazed tiles: quarter rings that meet across the joints, a diamond in the middle."""
    u, v, _, _ = cells(*plane(), count, count)
    r = np.hypot(0.5 - np.abs(u), 0.5 - np.abs(v))
    picture = over(blank(ground), (r > 0.24) & (r < 0.36), one)
    over(picture, r < 0.14, other)
    over(picture, np.abs(u) + np.abs(v) < 0.2, other)
    return over(picture, np.abs(u) + np.abs(v) < 0.1, ground)


def patches(*colors, count=5, seed=1):
    """Crooked patches: every texel belongs to the nearest of scattered points."""
    x, y = plane()
    i, j = np.mgrid[:count, :count]
    px = (i + 0.15 + 0.7 * chance(i, j, seed) / 1024) / count
    py = (j + 0.15 + 0.7 * chance(j, i, seed + 7) / 1024) / count
    nearest, index = np.full(x.shape, 9.0), np.zeros(x.shape, int)
    for k, (a, b) in enumerate(zip(px.ravel(), py.ravel(), strict=True)):
        d = np.hypot((x - a + 0.5) % 1 - 0.5, (y - b + 0.5) % 1 - 0.5)
        index, nearest = np.where(d < nearest, k, index), np.minimum(d, nearest)
    return pick(chance(index, index // 3, seed), *colors)


def hide(ground, *spots, seed=0.0):
    """Soft-edged shapes as on a cow's hide: heights of a few waves, cut at levels."""
    x, y = 2 * np.pi * np.array(plane())
    h = (np.sin(x + seed) + np.sin(y + 1.3 * seed) + 0.9 * np.sin(2 * x + y + 2 + seed)
         + 0.8 * np.sin(2 * y - x + 4 + seed) + 0.5 * np.sin(3 * x + 2 * y + 1))
    return pick(np.clip(np.floor((h + 0.2) / 0.9) + 1, 0, len(spots)), ground, *spots)


def meander(ground, line):
    """A Greek key: one period, to be repeated along x."""
    return bitmap(["..........", "##########", ".........#", "#######..#", "#.....#..#", "#..####..#", "#........#",
                   "##########", ".........."], ground, line, n=360)


def bitmap(rows, ground, *colors, n=256):
    """A picture from lines of text, `.` the ground, `#` the first colour, `o` the second, `x` the third."""
    x, y = plane(n)
    letters = np.array([[".#ox".index(letter) for letter in row] for row in rows[::-1]])
    return pick(letters[(y * letters.shape[0]).astype(int), (x * letters.shape[1]).astype(int)], ground, *colors)


def herringbone(*colors, length=4, count=16):
    """Parquet; each block has one of the colours."""
    x, y = plane(1024)
    i, j = np.floor(x * count).astype(int), np.floor(y * count).astype(int)
    k = (i - j) % (2 * length)
    flat = k < length
    a, b = np.where(flat, i - k, i) % count, np.where(flat, j, j + k - length) % count
    return pick(chance(a * 2 + flat, b, 2), *colors)


def wood(*colors, boards=4, seed=0):
    """Planks along x with a few long flames of grain."""
    x, y = plane()
    j = np.floor(y * boards)
    v = y * boards % 1 - 0.5
    grain = np.abs(v + 0.12 * np.sin(2 * np.pi * x + 2 * j + seed) + 0.08 * np.sin(4 * np.pi * x + 5 * j))
    return pick(np.where(np.abs(grain - 0.24) < 0.05, 1, 0) + 2 * (chance(j.astype(int), 0, seed) % 2), *colors)
