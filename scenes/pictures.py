# SPDX-License-Identifier: GPL-3.0-or-later
"""Pictures of one thing each: prints for the wall, a rug, covers, a map, a clock's face, the view from the window.

They are made as the patterns are, of areas of one colour, but fill their square once.
"""

import numpy as np
from patterns import (
    BLUE,
    BROWN,
    CREAM,
    GREY,
    INK,
    LEAF,
    MOSS,
    MUSTARD,
    NAVY,
    OAK,
    ORANGE,
    PALE,
    PINK,
    RED,
    SAGE,
    SAND,
    SKY,
    TEAL,
    WHITE,
    WINE,
    almond,
    bitmap,
    blank,
    over,
    pick,
    plane,
    polygon,
    turned,
)


def sheet(color, n=512):
    """x, y and a picture of one colour."""
    return *plane(n), blank(color, n)


def ellipse(x, y, cx, cy, rx, ry=None):
    return np.hypot((x - cx) / rx, (y - cy) / (ry or rx)) < 1


def hills(x, height, *waves):
    """A skyline about `height`, of (amplitude, periods, phase)."""
    return height + sum(a * np.sin(2 * np.pi * f * x + p) for a, f, p in waves)


# The wall


def sunset():
    """A poster of hills under a striped sun."""
    x, y, picture = sheet(CREAM)
    over(picture, ellipse(x, y, 0.6, 0.62, 0.24), ORANGE)
    for k in range(4):
        over(picture, ellipse(x, y, 0.6, 0.62, 0.24) & (np.abs(y - 0.62 + 0.055 * k) < 0.006 + 0.003 * k), CREAM)
    for color, height, *waves in ((PINK, 0.45, (0.05, 1, 0.4), (0.02, 3, 1)),
                                  (RED, 0.36, (0.05, 1.3, 2.6), (0.015, 4, 0)),
                                  (WINE, 0.25, (0.05, 1.1, 4.4), (0.01, 5, 1)), (NAVY, 0.13, (0.04, 1.5, 1.0))):
        over(picture, y < hills(x, height, *waves), color)
    return picture


def cat():
    """A portrait of the cat."""
    x, y, picture = sheet(MUSTARD)
    u = np.abs(x - 0.5)
    over(picture, ellipse(x, y, 0.5, 0.02, 0.36, 0.34), INK)
    over(picture, polygon(u, y, [(0.07, 0.72), (0.27, 0.9), (0.29, 0.5)]), INK)
    over(picture, polygon(u, y, [(0.13, 0.72), (0.24, 0.82), (0.25, 0.64)]), PINK)
    over(picture, ellipse(u, y, 0, 0.5, 0.31, 0.27), INK)
    over(picture, ellipse(u, y, 0.06, 0.38, 0.1, 0.085), CREAM)
    over(picture, ellipse(u, y, 0.14, 0.54, 0.085, 0.065), SAGE)
    over(picture, ellipse(u, y, 0.14, 0.54, 0.022, 0.06), INK)
    over(picture, polygon(u, y, [(0, 0.4), (0, 0.46), (0.05, 0.46)]), RED)
    return over(picture, ellipse(x, y, 0.5, 0.14, 0.2, 0.025), RED)


def squares():
    """Rectangles in the manner of the 1920s."""
    x, y, picture = sheet(WHITE)
    for color, x0, x1, y0, y1 in ((RED, 0.34, 1, 0.42, 1), (BLUE, 0, 0.32, 0, 0.4), (MUSTARD, 0.86, 1, 0, 0.2)):
        over(picture, (x > x0) & (x < x1) & (y > y0) & (y < y1), color)
    for line in ((x > 0.31) & (x < 0.35), (y > 0.385) & (y < 0.425), (x < 0.33) & (np.abs(y - 0.72) < 0.025),
                 (x > 0.84) & (x < 0.87) & (y < 0.4), (x > 0.85) & (np.abs(y - 0.2) < 0.016)):
        over(picture, line, INK)
    return picture


def discs():
    """Rings and half rings in a grid."""
    x, y, picture = sheet(PALE)
    for k, (a, b, side) in enumerate(((TEAL, MUSTARD, 1), (RED, NAVY, -1), (NAVY, PINK, -1), (MUSTARD, RED, 1))):
        cx, cy = 0.27 + 0.46 * (k % 2), 0.27 + 0.46 * (k // 2)
        r = np.hypot(x - cx, y - cy)
        half = side * ((x - cx) if k < 2 else (y - cy)) > 0
        over(picture, r < 0.21, a)
        over(picture, (r < 0.21) & half, b)
        over(picture, (r < 0.13) & ~half, CREAM)
        over(picture, (r < 0.13) & half, a)
        over(picture, r < 0.06, b)
    return picture


def ship():
    """A sailing boat, for the long picture over the sofa."""
    x, y, picture = sheet(SKY)
    over(picture, ellipse(x, y, 0.22, 0.74, 0.08, 0.12), CREAM)
    for cx, cy, rx in ((0.8, 0.82, 0.12), (0.72, 0.78, 0.08), (0.45, 0.9, 0.07)):
        over(picture, ellipse(x, y, cx, cy, rx, 0.045), WHITE)
    over(picture, polygon(x, y, [(0.5, 0.34), (0.5, 0.92), (0.7, 0.36)]), RED)
    over(picture, polygon(x, y, [(0.48, 0.36), (0.48, 0.84), (0.35, 0.38)]), WHITE)
    over(picture, polygon(x, y, [(0.31, 0.34), (0.73, 0.34), (0.66, 0.2), (0.38, 0.2)]), BROWN)
    for k, color in enumerate((TEAL, BLUE, NAVY)):
        wave = 0.25 - 0.085 * k + 0.035 * np.abs(((x * (7 - k) + 0.35 * k) % 1) * 2 - 1) ** 2
        over(picture, y < wave, color)
    return picture


def clock():
    """A clock's face, ten past ten."""
    x, y, picture = sheet(CREAM)
    u, v = x - 0.5, y - 0.5
    r, a = np.hypot(u, v), np.arctan2(u, v)
    over(picture, r > 0.44, TEAL)
    quarter = np.round(a / (np.pi / 6)) % 3 == 0
    near = np.abs((a / (np.pi / 6) + 0.5) % 1 - 0.5) * r * np.pi / 6
    over(picture, (r > 0.3) & (r < 0.4) & quarter & (near < 0.016), NAVY)
    over(picture, (r > 0.35) & (r < 0.4) & ~quarter & (near < 0.009), RED)
    for angle, length, width, color in ((305, 0.22, 0.022, NAVY), (60, 0.33, 0.015, NAVY), (190, 0.3, 0.006, RED)):
        p, q = turned(u, v, -np.radians(angle))
        over(picture, (np.abs(p) < width) & (q > -0.06) & (q < length), color)
    return over(picture, r < 0.035, RED)


def view():
    """What the window looks out on: roofs, a church, hills, sky."""
    x, y, picture = sheet(SKY, 1024)
    for cx, cy, rx in ((0.2, 0.86, 0.14), (0.3, 0.83, 0.1), (0.72, 0.76, 0.12), (0.82, 0.73, 0.1)):
        over(picture, ellipse(x, y, cx, cy, rx, 0.04) & (y > cy - 0.022), WHITE)
    for color, height, *waves in ((SAGE, 0.5, (0.05, 1.4, 0.4), (0.012, 5, 1)), (LEAF, 0.4, (0.04, 2.1, 2.6))):
        over(picture, y < hills(x, height, *waves), color)
    for k in range(11):
        left, top = 0.1 * k - 0.05, 0.24 + 0.05 * ((k * 7) % 5) / 2
        wall, middle = (CREAM, PINK, WHITE, SAND)[k % 4], left + 0.055
        over(picture, (x > left) & (x < left + 0.11) & (y < top), wall)
        over(picture, polygon(x, y, [(left - 0.008, top), (middle, top + 0.07), (left + 0.118, top)]),
                       (RED, WINE, ORANGE)[k % 3])
        panes = (np.abs((x - left) % 0.055 - 0.0275) < 0.01) & (np.abs((y - top + 0.05) % 0.08 - 0.03) < 0.018)
        over(picture, panes & (x > left) & (x < left + 0.11) & (y < top - 0.012), NAVY)
    return over(picture, y < hills(x, 0.06, (0.025, 6, 0), (0.012, 13, 2)), MOSS)


# On the floor and on tables


def rug():
    """A kilim: a border of triangles round stepped diamonds."""
    x, y, picture = sheet(RED, 1024)
    edge_x, edge_y = np.minimum(x, 1 - x) * 1.5, np.minimum(y, 1 - y)
    edge = np.minimum(edge_x, edge_y)
    along = np.where(edge_x < edge_y, y, x * 1.5)
    u, v = x * 1.5 - 0.75, y - 0.5
    stair = lambda value: np.floor(value * 28) / 28  # noqa: E731  the weave's steps
    for cx in (-0.36, 0, 0.36):
        d = stair(np.abs(u - cx)) + stair(np.abs(v)) * 0.62
        for limit, color in ((0.21, NAVY), (0.17, CREAM), (0.13, TEAL), (0.085, MUSTARD), (0.04, RED)):
            over(picture, d < limit, color)
    for cx in (-0.54, -0.18, 0.18, 0.54):
        for cy in (-0.25, 0.25):
            d = stair(np.abs(u - cx)) + stair(np.abs(v - cy))
            for limit, color in ((0.11, MUSTARD), (0.07, WINE), (0.036, CREAM)):
                over(picture, d < limit, color)
    teeth = np.abs((along * 20) % 1 - 0.5)
    for limit, color in ((0.155, CREAM), (0.145, NAVY), (0.05, CREAM), (0.04, WINE)):
        over(picture, edge < limit, color)
    over(picture, (edge > 0.05) & (edge < 0.145) & ((edge - 0.06) / 0.15 < teeth), MUSTARD)
    return over(picture, (edge > 0.075) & (edge < 0.1) & (np.abs(teeth - 0.5) < 0.14), RED)


def round_rug():
    """Rings, the outer one of petals."""
    x, y, picture = sheet(CREAM)
    u, v = x - 0.5, y - 0.5
    r, a = np.hypot(u, v), np.arctan2(v, u)
    for radius, petals, color in ((0.5, 24, TEAL), (0.41, 24, MUSTARD), (0.33, 12, CREAM), (0.25, 12, WINE),
                                  (0.16, 6, PINK), (0.08, 1, CREAM)):
        over(picture, r < radius - 0.03 * np.abs(np.sin(a * petals / 2)) * (petals > 1), color)
    return picture


LANDS = [  # longitude and latitude in degrees, roughly
    [(-168, 66), (-130, 70), (-95, 72), (-80, 63), (-62, 58), (-56, 51), (-70, 43), (-81, 31), (-80, 25), (-90, 29),
     (-97, 26), (-95, 18), (-88, 20), (-83, 10), (-78, 8), (-90, 14), (-105, 20), (-113, 30), (-124, 40), (-130, 54),
     (-150, 60), (-165, 60)],
    [(-78, 8), (-62, 10), (-50, 0), (-35, -6), (-40, -20), (-48, -27), (-58, -38), (-66, -47), (-68, -55), (-74, -50),
     (-71, -30), (-70, -18), (-81, -5)],
    [(-17, 15), (-16, 28), (-6, 35), (10, 37), (20, 32), (33, 31), (43, 12), (51, 11), (40, -5), (40, -16), (33, -27),
     (20, -35), (15, -25), (12, -8), (9, 3), (-7, 5)],
    [(-10, 37), (-9, 43), (-1, 44), (-4, 48), (8, 54), (5, 60), (12, 66), (28, 71), (45, 68), (70, 73), (105, 77),
     (140, 73), (179, 68), (162, 60), (156, 52), (140, 54), (135, 44), (127, 36), (121, 38), (121, 29), (109, 20),
     (106, 10), (100, 14), (103, 2), (97, 16), (89, 22), (80, 8), (73, 20), (62, 25), (57, 25), (58, 20), (45, 13),
     (35, 29), (36, 36), (27, 37), (22, 37), (13, 45), (18, 40), (12, 42), (5, 43)],
    [(114, -22), (122, -18), (131, -12), (137, -16), (142, -11), (149, -21), (153, -28), (147, -38), (138, -34),
     (125, -33), (115, -34)],
    [(-50, 82), (-20, 80), (-24, 70), (-43, 60), (-53, 67), (-68, 77)],
    [(-5, 50), (1, 51), (-3, 58), (-6, 56)], [(131, 32), (141, 37), (145, 44), (136, 36)],
    [(44, -16), (50, -15), (47, -25), (43, -22)], [(96, 5), (106, -6), (118, -9), (118, 4), (109, 2)]]


def world_map():
    """Land and sea, longitude along x and latitude along y."""
    x, y, picture = sheet(BLUE, 1024)
    lon, lat = 360 * x - 180, 180 * y - 90
    for k, land in enumerate(LANDS):
        over(picture, polygon(lon, lat, land),
             (LEAF, MUSTARD, ORANGE, SAND, RED, WHITE, PINK, PINK, LEAF, LEAF)[k])
    over(picture, (lat < -72) | (lat > 84), WHITE)
    return over(picture, np.abs(lat) < 0.8, NAVY)


def ball():
    """Six gores of a beach ball and its caps."""
    x, y = plane()
    picture = pick(np.floor(x * 6), RED, WHITE, MUSTARD, WHITE, BLUE, WHITE)
    return over(picture, np.abs(y - 0.5) > 0.43, NAVY)


def block(letter, ground, frame, ink):
    """The side of a toy block."""
    shapes = {"A": ["..##..", ".#..#.", "#....#", "######", "#....#", "#....#"],
              "B": ["#####.", "#....#", "#####.", "#....#", "#....#", "#####."],
              "C": [".#####", "#.....", "#.....", "#.....", "#.....", ".#####"]}
    x, y, picture = sheet(ground, 256)
    edge = np.minimum(np.minimum(x, 1 - x), np.minimum(y, 1 - y))
    over(picture, edge < 0.1, frame)
    wide = bitmap(shapes[letter], ground, ink)
    k = np.clip(((np.array([y, x]) - 0.22) / 0.56 * 256).astype(int), 0, 255)
    return np.where((edge > 0.22)[..., None], wide[k[0], k[1]], picture)


def cover(cloth, band, ink, kind):
    """A book's cloth, laid flat: back, spine (the middle tenth) and front with one of four ornaments."""
    x, y, picture = sheet(cloth, 512)
    spine = np.abs(x - 0.5) < 0.06
    for height, width in ((0.12, 0.025), (0.82, 0.025), (0.9, 0.012)):
        over(picture, spine & (np.abs(y - height) < width), band)
    over(picture, spine & (np.abs(y - 0.58) < 0.14), band)
    for k in range(3):
        over(picture, (np.abs(x - 0.5) < 0.035) & (np.abs(y - 0.66 + 0.075 * k) < 0.016), ink)
    u, v = (x - 0.78) / 0.22, (y - 0.5) / 0.5
    edge = np.minimum(1 - np.abs(u), (1 - np.abs(v)) * 1.5)
    over(picture, (edge > 0.12) & (edge < 0.2), band)
    r = np.hypot(u, v * 1.4)
    if kind == 0:
        shapes = [(r < 0.6, band), (r < 0.45, ink), (r < 0.2, band)]
    elif kind == 1:
        shapes = [(np.abs(u) + np.abs(v) < 0.6, band), (np.abs(u) + np.abs(v) < 0.35, ink)]
    elif kind == 2:
        shapes = [((np.abs(v - 0.25 * k) < 0.07) & (np.abs(u) < 0.6 - 0.2 * abs(k)), band) for k in (-1, 0, 1)]
    else:
        shapes = [(almond(p, q - 0.3, 0.3, 0.14), band) for p, q in
                  (turned(u, v * 1.4, a) for a in np.arange(6) * np.pi / 3)] + [(r < 0.12, ink)]
    for where, color in shapes:
        over(picture, where & (edge > 0.25), color)
    return picture


def chessboard():
    x, y, picture = sheet(WINE)
    u, v = (x - 0.08) / 0.84, (y - 0.08) / 0.84
    board = (np.abs(u - 0.5) < 0.5) & (np.abs(v - 0.5) < 0.5)
    over(picture, (np.abs(x - 0.5) < 0.445) & (np.abs(y - 0.5) < 0.445), SAND)
    return np.where(board[..., None], pick(np.floor(u * 8) + np.floor(v * 8), BROWN, CREAM), picture)


def table_top():
    """Marquetry: rays round a star."""
    x, y, picture = sheet(OAK)
    u, v = x - 0.5, y - 0.5
    r, a = np.hypot(u, v), np.arctan2(v, u)
    rays = np.floor(a / (np.pi / 8)) % 2 == 0
    over(picture, (r < 0.47), BROWN)
    over(picture, (r < 0.45) & rays, SAND)
    over(picture, (r < 0.45) & ~rays, OAK)
    tip = np.abs((a / (np.pi / 4)) % 1 - 0.5) * 2
    return over(picture, r < 0.1 + 0.16 * tip ** 2, WINE)


def leaf():
    """A leaf's face, its stalk at the bottom: a pale rim and stripes from the midrib."""
    x, y, picture = sheet(LEAF, 256)
    u = np.abs(x - 0.5)
    over(picture, ((y * 7 - u * 6) % 1 < 0.3) & (u < 0.36), SAGE)
    over(picture, u > 0.43, PALE)
    return over(picture, u < 0.035, PALE)


def waves(ground, *colors):
    """Three rows of waves round a bowl, to be repeated along x."""
    x, y, picture = sheet(ground)
    for k, color in enumerate(colors):
        crest = 0.8 - 0.26 * k + 0.08 * np.sin(2 * np.pi * (2 * x + 0.5 * k))
        over(picture, (y < crest) & (y > crest - 0.13), color)
    return picture


def heart(ground, ink, stripe):
    """A mug's side."""
    x, y, picture = sheet(ground, 256)
    u, v = np.abs((x * 2) % 1 - 0.5) * 2, (y - 0.5) * 2
    over(picture, (u ** 2 + (v * 1.2 - 0.75 * np.sqrt(u)) ** 2 < 0.42), ink)
    return over(picture, np.abs(np.abs(v) - 0.86) < 0.07, stripe)


def paper_lantern():
    x, y, picture = sheet(WHITE)
    for k in range(8):
        u = (x * 8 - k + 0.5) % 8 - 0.5
        over(picture, almond(u, (y - 0.5) * 2, 0.92, 0.36), (RED, ORANGE)[k % 2])
    return over(picture, (np.abs(y - 0.5) > 0.46), GREY)
