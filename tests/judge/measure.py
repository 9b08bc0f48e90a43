# SPDX-License-Identifier: GPL-3.0-or-later
"""What ink T (rows, columns), 0…1, is worth beside the true contours: one function a promise.

All give plain numbers. Ink is read between pixel centres bilinearly, on straight lines across the contour."""

import numpy as np
from reference import near

INKED = 0.3  # a hairline between two rows of pixels still has a half there; a gap of 1.4 pixels has less
STRAY = 0.1


def _sample(t, x, y):
    h, w = t.shape
    x, y = np.clip(x, 0, w - 1), np.clip(y, 0, h - 1)
    c, r = np.minimum(x.astype(int), max(w - 2, 0)), np.minimum(y.astype(int), max(h - 2, 0))
    fx, fy = x - c, y - r
    c1, r1 = np.minimum(c + 1, w - 1), np.minimum(r + 1, h - 1)
    return (t[r, c] * (1 - fx) + t[r, c1] * fx) * (1 - fy) + (t[r1, c] * (1 - fx) + t[r1, c1] * fx) * fy


def _profiles(t, truth, reach, step=0.125, along=(0.0,)):
    """(s, T): ink at offsets s = -reach…reach across each contour point, averaged over shifts along it."""
    s = np.arange(-reach, reach + step / 2, step)
    ink = sum(_sample(t, truth.x[:, None] + truth.nx[:, None] * s - truth.ny[:, None] * a,
                      truth.y[:, None] + truth.ny[:, None] * s + truth.nx[:, None] * a) for a in along)
    return s, ink / len(along)


def _every(truth):
    """x, y of all that may be inked."""
    every = np.stack([truth.x, truth.y], 1)
    return np.concatenate([every, every[:0] if truth.faint is None else truth.faint])[::2]


def _alone(truth, points, reach):
    """Which of `points` have no other contour, not even a faint one, within `reach` across or 3 pixels along, nor the
    frame's border."""
    h, w = truth.size
    border = reach + 1
    inside = (points.x > border) & (points.x < w - 1 - border) & (points.y > border) & (points.y < h - 1 - border)
    every = _every(truth)
    i, j = near.pairs(np.stack([points.x, points.y], 1), every, np.hypot(reach, 3))
    dx, dy = every[j, 0] - points.x[i], every[j, 1] - points.y[i]
    across = np.abs(dx * points.nx[i] + dy * points.ny[i])
    along = np.abs(dy * points.nx[i] - dx * points.ny[i])
    # a circle of 5 pixels' radius stays within 0.1 + along²/10 of its tangent
    other = (along <= 3) & (across <= reach) & (across > 0.1 + along**2 / 10)
    alone = inside
    alone[i[other]] = False
    return alone


def _drawn(truth, every=4):
    """Points that must be inked, every half pixel."""
    points = truth.take(truth.required("all"))
    return points.take(np.arange(0, points.x.size, every))


def _clear(truth, reach):
    """Of the points that must be inked those that are alone: the same for every drawing."""
    if reach not in truth.clear:
        points = _drawn(truth)
        truth.clear[reach] = points.take(_alone(truth, points, reach))
    return truth.clear[reach]


def place(t, truth):
    """Hairline: how far the ink's centre is from the contour, in pixels, and the `count` of points looked at."""
    points = _clear(truth, 3.5)
    s, ink = _profiles(t, points, 2.5, along=(-0.5, -0.25, 0, 0.25, 0.5))
    total = ink.sum(1)
    seen = total > 0.3 / 0.125
    off = np.abs((ink[seen] * s).sum(1) / total[seen])
    return {"p95": float(np.percentile(off, 95)), "max": float(off.max()), "count": int(seen.sum())} \
        if seen.any() else {"p95": 0.0, "max": 0.0, "count": 0}


def width(t, truth, asked, widest=None):
    """The median of the ink across the contour, pixels, for lines of the asked width; nan where none is alone. Where
    `widest`, of points, is less than `asked`, what is missing there is added."""
    points = _clear(truth, asked + 2.5)
    s, ink = _profiles(t, points, asked / 2 + 2)
    missing = asked - widest(points, asked) if widest else 0
    return float(np.median(ink.sum(1) * 0.125 + missing)) if len(ink) else float("nan")


def evenness(t, truth):
    """Hairline: the share of its length where the ink across it, averaged over 2 pixels along, is 0.75…1.25."""
    points = _clear(truth, 3.5)
    _, ink = _profiles(t, points, 2.5, along=(-1, -0.5, 0, 0.5, 1))
    ink = ink.sum(1) * 0.125
    ink = ink[ink > 0.3]
    return float(((ink >= 0.75) & (ink <= 1.25)).mean()) if len(ink) else 1.0


def once(t, truth):
    """Hairline: the share of the contour along which no second line runs within 6 pixels."""
    points = _clear(truth, 8)
    s, ink = _profiles(t, points, 6)
    second = (ink[:, np.abs(s) >= 1.9] > 0.25).any(1)
    return float(1 - second.mean()) if len(ink) else 1.0


def _among_parallels(truth, reach):
    """Points, half a pixel apart, of straight contours that have no others within `reach` but such as run along it."""
    if "parallels" not in truth.clear:
        points = truth.take(np.arange(0, truth.x.size, 4))
        h, w = truth.size
        inside = (np.minimum(points.x, points.y) > reach) & (points.x < w - 1 - reach) & (points.y < h - 1 - reach)
        i, j = near.pairs(*2 * (np.stack([points.x, points.y], 1),), reach)
        inside[i[np.abs(points.nx[i] * points.ny[j] - points.ny[i] * points.nx[j]) > 0.15]] = False
        truth.clear["parallels"] = points.take(inside)
    return truth.clear["parallels"]


def steady(t, truth):
    """Hairline: the share of straight contours with ink about them where it goes on along them, at least one way: no
    rung from one to the next, no knot, no gap."""
    points = _among_parallels(truth, 4)
    if not points.x.size:
        return 1.0
    before, here, after = (sum(_profiles(t, points, 2.5, step=0.25, along=(at,))[1][:, k:k + 17] for k in range(5)) / 4
                           for at in (-3, 0, 3))
    alone, gap = here - np.maximum(before, after), np.minimum(before, after) - here
    drawn = np.max([before, here, after], axis=(0, 2)) > INKED
    return float(1 - (np.maximum(alone, gap).max(1) > 0.3)[drawn].mean()) if drawn.any() else 1.0


def inked(t, truth):
    """Hairline: which contour points have ink within 0.8 pixel."""
    _, ink = _profiles(t, truth, 0.8, step=0.2)
    return ink.max(1) >= INKED


def whole(t, truth):
    """Hairline: share of the contour that is inked, by kind, and the count of points: {kind: (share, count)}.

    What runs within a pixel and a half of the frame's edge has too little on one side to be told from it."""
    h, w = truth.size
    shares = {}
    for kind in ("outline", "crease", "color", "light"):
        inside = (truth.x >= 1) & (truth.x <= w - 2) & (truth.y >= 1) & (truth.y <= h - 2)
        points = truth.take(truth.required(kind) & inside)
        found = inked(t, points)
        shares[kind] = (float(found.mean()) if found.size else 1.0, int(found.size))
    return shares


def stray(t, truth, asked=1.0, slack=0.25):
    """The share of pixels that have ink, and no contour (not even a faint one) within the line's reach plus `slack`."""
    h, w = truth.size
    spots = np.argwhere(t > STRAY)
    i, _ = near.pairs(spots, _every(truth)[:, ::-1], max(asked / 2 + 0.5, 1) + slack)
    return float((len(spots) - len(np.unique(i))) / (h * w))


def ideal(truth, asked=1.0, kind="all", drawn=False):
    """The ink of a perfect detector: T of a line of the asked width along the contours that must be inked, and such as
    are `drawn`, by point."""
    points = truth.take(truth.required(kind) | drawn)
    h, w = truth.size
    r = asked / 2
    reach = max(r, 0.5) + 0.5
    k = int(np.ceil(reach)) + 1
    best = np.full((h + 2 * k, w + 2 * k), np.inf)
    row, column = np.rint(points.y).astype(int), np.rint(points.x).astype(int)
    for dy in range(-k, k + 1):
        for dx in range(-k, k + 1):
            ry, rx = row + dy - points.y, column + dx - points.x
            across, along = rx * points.nx + ry * points.ny, ry * points.nx - rx * points.ny
            distance = np.hypot(across, np.maximum(np.abs(along) - 0.08, 0))
            np.minimum.at(best, (row + dy + k, column + dx + k), distance)
    return np.clip(reach - best[k:-k, k:-k], 0, 1)


def stillness(frames, truths):
    """Root mean square of T_t − T_{t−1} over the frames, over that of the ideal ink's. A contour that need not be inked
    but is, in any frame, moves like others: the ideal has it in all."""
    def flicker(sequence):
        return np.sqrt(np.mean(np.diff(np.array(sequence), axis=0) ** 2))
    ever = np.max(frames, axis=0)
    return float(flicker(frames) / flicker([ideal(truth, drawn=inked(ever, truth)) for truth in truths]))


def alike(t, spots):
    """How much the ink of equal spots differs, of its mean: the most of all groups (places in pixels, radius)."""
    rows, columns = np.indices(t.shape)
    worst = 0.0
    for places, radius in spots:
        ink = [t[np.hypot(columns - x, rows - y) < radius + 4].sum() for x, y in places]
        worst = max(worst, float((np.max(ink) - np.min(ink)) / max(np.mean(ink), 1e-9)))
    return worst


# The eight ways to rotate and mirror a frame
SYMMETRIES = [(turn, mirror) for turn in range(4) for mirror in (False, True)]


def moved(a, symmetry):
    """An array (rows, columns, …) turned by quarter turns and mirrored."""
    turn, mirror = symmetry
    a = np.rot90(a, turn)
    return np.ascontiguousarray(a[:, ::-1] if mirror else a)


def differs(one, two):
    """The share of pixels in which two inks differ."""
    return float((np.abs(one - two) > 0.05).mean())
