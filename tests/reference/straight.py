# SPDX-License-Identifier: GPL-3.0-or-later
"""What one edge leaves of a lamp, for many pixels at once: for shadows.py."""

import numpy as np

from .lamps import Asked, dot

ROWS = 16


class Views:
    """Lamps as squares, or discs, of half width 1, from places, by coordinates across the edge and along it."""

    def __init__(self, sees, square, points, seen):
        """sees(which places, points of the square or disc) -> whether these are seen; points (n, k, 2) and whether
        they are (n, k): some, but not all."""
        self.sees, self.square = sees, square
        many = seen.sum(1)
        lit = (points * seen[..., None]).sum(1) / many[:, None]
        hidden = (points * ~seen[..., None]).sum(1) / (seen.shape[1] - many)[:, None]
        n = lit - hidden
        length = np.linalg.norm(n, axis=1)
        self.found = length > 1e-3
        n /= np.maximum(length, 1e-3)[:, None]
        ahead = (points * n[:, None]).sum(2)
        nearest, farthest = np.where(seen, ahead, 2).min(1), np.where(seen, -2, ahead).max(1)
        self.found &= farthest - nearest <= 0.3
        flat = abs(n[:, 0]) > abs(n[:, 1])
        sides = np.where(n > 0, 1, -1) * np.stack([flat, ~flat], 1)
        self.across = sides if square else n
        self.along = np.stack([-self.across[:, 1], self.across[:, 0]], 1)
        rise = dot(n, self.across)
        self.slope = -dot(n, self.along) / rise
        self.guess = (nearest + farthest) / 2 / rise
        self.wide = (abs(nearest - farthest) / 2 + 0.08) / rise
        self.few = dot(self.along, np.where((seen.shape[1] - many > many)[:, None], lit, hidden))
        self.points = np.stack([(points * way[:, None]).sum(2) for way in (self.across, self.along)], 2)
        self.cut, self.chord = np.zeros((2, 3, len(points)))
        self._cross_three()

    def half(self, along):
        return np.ones_like(along) if self.square else np.sqrt(np.maximum(1 - along ** 2, 0))

    def _seen(self, i, across, along):
        return self.sees(i, self.across[i] * across[:, None] + self.along[i] * along[:, None])

    def _cross(self, k, i, along, guess, wide):
        """Which of the views i have the edge on a chord; fills where, from a guess, give or take."""
        half = self.half(along)
        low, high = np.maximum(guess - wide, -half), np.minimum(guess + wide, half)
        bad = low >= high
        low, high = np.where(bad, -half, low), np.where(bad, half, high)
        lit, dark = self._seen(i, high, along), ~self._seen(i, low, along)
        below = ~dark & (low > -half)
        above = ~below & ~lit & (high < half)
        low, high = (np.where(below, -half, np.where(above, high, low)),
                     np.where(below, low, np.where(above, half, high)))
        dark = np.where(below, ~self._seen(i, low, along), dark | above)
        lit = np.where(above, self._seen(i, high, along), lit | below)
        found = dark & lit
        while (left := np.flatnonzero(found & (high - low > 0.012))).size:
            middle = (low[left] + high[left]) / 2
            seen = self._seen(i[left], middle, along[left])
            low[left], high[left] = np.where(seen, low[left], middle), np.where(seen, middle, high[left])
        found &= ~self._seen(i, -0.97 * half, along) & self._seen(i, 0.97 * half, along)
        self.chord[k, i[found]], self.cut[k, i[found]] = along[found], (low + high)[found] / 2
        return found

    def _cross_three(self):
        if self.square:
            with np.errstate(all="ignore"):
                ends = np.sort((np.array([[-1], [1]]) - self.guess) / self.slope, 0)
            level = abs(self.slope) <= 1e-3
            low, high = np.where(level, -1, np.maximum(ends[0], -1)), np.where(level, 1, np.minimum(ends[1], 1))
        else:
            high = self.half(self.guess)
            low = -high
        self.found &= high - low > 0.1
        few = np.minimum(np.maximum(self.few, low + 0.05), high - 0.05)
        i = np.flatnonzero(self.found)
        self.found[i] = self._cross(1, i, few[i], (self.guess + self.slope * few)[i], self.wide[i])
        for k, end, turn in ((0, low, 0.15), (2, high, 0.075)):
            i, step = np.flatnonzero(self.found), 0.7 * (end - few)
            slope = self.slope
            if k:
                with np.errstate(all="ignore"):
                    slope = (self.cut[1] - self.cut[0]) / (self.chord[1] - self.chord[0])
            for _ in range(3):
                found = self._cross(k, i, (few + step)[i], (self.cut[1] + slope * step)[i], turn)
                i, step = i[~found], step / 2
            self.found[i] = False

    def line(self, along):
        (x0, x1, x2), (y0, y1, y2) = (a.reshape(3, -1, *[1] * (along.ndim - 1)) for a in (self.cut, self.chord))
        first, last = (x1 - x0) / (y1 - y0), (x2 - x1) / (y2 - y1)
        return x1 + (along - y1) * (first + (last - first) / (y2 - y0) * (along - y0))

    def shares(self, value, seen):
        """(shares, whether there is one line) by what light each point gives."""
        with np.errstate(all="ignore"):
            part = (self.chord[1] - self.chord[0]) / (self.chord[2] - self.chord[0])
            off = abs(self.cut[0] + part * (self.cut[2] - self.cut[0]) - self.cut[1])
            ahead = self.points[..., 0] - self.line(self.points[..., 1])
            found = self.found & (off <= 0.25) & (((ahead > 0) == seen) | (abs(ahead) <= 0.03)).all(1)
            middle = self.points.mean(1)
            off = self.points - middle[:, None]
            grow = (off * value[..., None]).sum(1) / (off ** 2).sum(1)
            along = (2 * np.arange(ROWS) + 1) / ROWS - 1 + 0 * value[:, :1]
            half = self.half(along)
            edge = np.clip(self.line(along), -half, half)
            here = value.mean(1)[:, None] - grow[:, :1] * middle[:, :1] + grow[:, 1:] * (along - middle[:, 1:])
            comes = (half - edge) * (here + grow[:, :1] * (half + edge) / 2)
            return np.clip(comes.sum(1) / (2 * half * here).sum(1), 0, 1), found


def parted(picture, lit, i, points, value, seen):
    """(the shares of light that come to pixels i where one line parts the lamp, where it does), by what light their
    points give, and whether they are seen."""
    square = lit.lamp.kind == "rectangle"
    share, found = np.zeros(len(i)), np.zeros(len(i), bool)
    mixed = np.flatnonzero((value > 0).all(1) & seen.any(1) & ~seen.all(1))
    if not len(mixed):
        return share, found

    def sees(which, at):
        q = Asked(at / 2 + 0.5, at, 0 * at)
        return picture.ask(lit, picture.shown[i[mixed[which]]], q)[1] > 0

    at = np.stack([2 * q.square[mixed] - 1 if square else q.disc[mixed] for q in points], 1)
    views = Views(sees, square, at, seen[mixed])
    share[mixed], found[mixed] = views.shares(value[mixed], seen[mixed])
    return share, found
