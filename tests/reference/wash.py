# SPDX-License-Identifier: GPL-3.0-or-later
"""Watercolor: paper seen through washes of what colors absorb, thin in the light, and two glazes in the shade."""

import numpy as np

from .metric import clamp01, mix, value
from .paper import _mix as hashed
from .shade import exposed

UNIT, KEPT, MOST_REACH = 16384, 8000, 128
POOL = 22.0  # how far into a wash its darker border reaches
SHADE, DEEP, BODY, BORDER = range(4)
LUMINANCE = np.array((0.2126, 0.7152, 0.0722))
TURNED = np.array([(0.36, 0.48, -0.8), (-0.8, 0.6, 0), (0.48, 0.64, 0.6)])


def smooth(low, high, x):
    t = clamp01((x - low) / (high - low))
    return t * t * (3 - 2 * t)


# ---- noise

def _word(n):
    return np.asarray(n, np.int64).astype(np.uint32)


def _gradient(h, x, y, z):
    """The part of one of the twelve edges of a cube, of which four count twice."""
    h = h & 15
    u = np.where(h < 8, x, y)
    v = np.where(h < 4, y, np.where((h == 12) | (h == 14), x, z))
    return np.where(h & 1, -u, u) + np.where(h & 2, -v, v)


class Places:
    """Where pixels are: on the thing at rest, else in the full frame."""

    def __init__(self, layers, stick=True):
        rows, columns = layers.depth.shape
        y, x = np.mgrid[layers.y:layers.y + rows, layers.x:layers.x + columns].astype(float)
        self.at, self.pixel = np.stack([x, y, 0 * x], -1), np.ones((rows, columns))
        self.key = np.zeros((rows, columns), np.uint32)
        if stick and layers.anchor is not None:
            known = layers.anchor[..., 6] > 0
            self.at = np.where(known[..., None], layers.anchor[..., :3], self.at)
            self.pixel = np.where(known, layers.anchor[..., 6], 1.0)
            self.key = np.where(known, _word(1 + layers.object.astype(np.int64)), 0).astype(np.uint32)

    def noise(self, size, seed):
        """Two noises whose hills are so many pixels apart."""
        mantissa, exponent = np.frexp(np.float32(self.pixel) * np.float32(size))
        octave, rest = exponent.astype(np.int64) - 1, 2.0 * mantissa - 1
        out = np.zeros((2, *self.pixel.shape))
        for k in range(2):
            place = (self.at * 2.0 ** -(octave + k)[..., None]) @ TURNED.T
            key = hashed(_word(seed * 7919) + hashed(_word(octave + k + 77)) + self.key * np.uint32(2654435761))
            out += np.where(k, rest, 1 - rest) * self._lattice(place, key)
        return 1.6 * out / np.hypot(1 - rest, rest)

    @staticmethod
    def _lattice(place, key):
        whole = np.floor(place)
        inside, cell = place - whole, whole.astype(np.int64)
        ease = inside**3 * (inside * (inside * 6 - 15) + 10)
        out = np.zeros((2, *key.shape))
        for corner in np.ndindex(2, 2, 2):
            h = key
            for axis in range(3):
                h = hashed(h + _word(cell[..., axis] + corner[axis]))
            part = np.prod([np.where(c, ease[..., k], 1 - ease[..., k]) for k, c in enumerate(corner)], 0)
            way = [inside[..., k] - c for k, c in enumerate(corner)]
            out += part * np.stack([_gradient(h, *way), _gradient(h >> np.uint32(16), *way)])
        return out


# ---- paint and light

def _painted(layers):
    """Color, how much of it shines, highlights."""
    there, color = layers.there[..., None], np.where(layers.there[..., None], clamp01(layers.color), 0.0)
    high = np.maximum(layers.highlights, 0)
    more = np.where(there, np.maximum(layers.combined[..., :3] - layers.color * layers.diffuse - high, 0),
                    layers.combined[..., :3])
    alpha = layers.combined[..., 3:]
    clear = np.where(alpha > 0, 1 / np.maximum(alpha, 1e-6), 0.0)
    other, own = np.maximum(value(more), 0), value(color)
    return (clamp01((color + more) * np.where(there, 1.0, clear)), clamp01(other / np.maximum(other + own, 1e-6)),
            value(high))


def _darkness(color):
    return 1 - clamp01(np.cbrt(clamp01(color @ LUMINANCE)) / 0.75)


def _borders(layers):
    """Where another thing or a bend begins beside a pixel; and where rounding decides."""
    found, doubtful = (np.zeros(layers.depth.shape, bool) for _ in range(2))
    for axis in (0, 1):
        n = layers.depth.shape[axis]
        one, two = (np.take(np.arange(n), range(a, n - 1 + a)) for a in (0, 1))

        def take(a, at, axis=axis):
            return np.take(a, at, axis)

        near, far = take(layers.depth, one), take(layers.depth, two)
        seen = np.isfinite(near) | np.isfinite(far)
        with np.errstate(invalid="ignore"):
            step, limit = np.abs(near - far), 0.03 * np.minimum(near, far)
            cosine = (take(layers.normal, one) * take(layers.normal, two)).sum(-1)
            parts = seen & ((take(layers.object, one) != take(layers.object, two))
                            | (take(layers.material, one) != take(layers.material, two))
                            | (step > limit) | (cosine < 0.6))
            unsure = seen & ((np.abs(step - limit) < 1e-5 * limit) | (np.abs(cosine - 0.6) < 1e-5))
        for at in (one, two):
            where = [slice(None)] * 2
            where[axis] = at
            found[tuple(where)] |= parts
            doubtful[tuple(where)] |= unsure
    return found, doubtful


def _slope(lit, scale):
    far = int(max(1.5 * scale + 0.5, 1))
    rise = []
    for axis in (0, 1):
        at = np.arange(lit.shape[axis])
        rise.append(np.take(lit, np.minimum(at + far, at[-1]), axis) - np.take(lit, np.maximum(at - far, 0), axis))
    return np.hypot(*rise) / (2 * far)


def _glaze(at, wide, soft, lit):
    half = 0.5 * (wide + 0.5 * soft) + 0.012
    return 1 - smooth(at - half, at + half, lit)


def _blurred(mask, reach):
    """A tent of `reach` pixels to all sides, of whole numbers, rounded between rows and columns."""
    if reach <= 1:
        return mask
    weights = reach - np.abs(np.arange(1 - reach, reach))
    wide = np.pad(np.floor(mask * UNIT + 0.5), [(0, 0), (reach, reach), (0, 0)], mode="edge")
    n = mask.shape[1]
    rows = np.floor(sum(w * wide[:, k + 1:k + 1 + n] for k, w in enumerate(weights)) / reach**2 + 0.5)
    tall = np.pad(rows, [(reach, reach), (0, 0), (0, 0)], mode="edge")
    n = mask.shape[0]
    return sum(w * tall[k + 1:k + 1 + n] for k, w in enumerate(weights)) / reach**2 / UNIT


def paint(layers, params, surface, height):
    """The surface (H, W, 4) as it is painted, and where rounding decides; height: of the paper."""
    on = params.at("use_wash", layers.style)
    if not on.any():
        return surface, np.zeros(layers.depth.shape, bool)
    scale, there = params.pixels(layers.full_height), layers.there

    def of(name):
        return params.at("wash_" + name, layers.style)

    def kept(noise):
        return np.round(np.clip(noise, -4, 4) * KEPT) / KEPT

    size, seed, places = params["wash_size"] * scale, params["wash_seed"] * 16, Places(layers)
    wide, big, mid, fine = (places.noise(share * size, seed + k + 1) for k, share in enumerate((5, 1, 0.4, 0.1)))
    wet = smooth(-0.15, 0.55, big[1]) * of("wet")
    cloud = kept(of("uneven") * (0.053 * big[0] + 0.037 * mid[0] + 0.13 * wide[0]))
    hue, gap = kept(0.55 * of("uneven") * (wide[1] + big[0])), kept(mid[1])

    color, shines, highlight = _painted(layers)
    own = np.clip((exposed(layers, params) - 0.35) / (0.92 - 0.35), -4, 4)
    lit = np.where(there, mix(own, np.maximum(own, 0.75), shines), 0.6)
    steep = scale * _slope(lit, scale)
    strayed = lit + np.minimum(0.1, of("wobble") * steep) * (0.6 * mid[0] + 0.4 * fine[0])
    soft = np.minimum(wet, 80 * steep)
    dark = _darkness(color)
    body = _glaze(of("white"), 0.22, soft, strayed)
    border, doubtful = _borders(layers)
    mask = np.stack([np.where(there, _glaze(0.5, 0.05, soft, strayed), 0),
                     np.where(there, _glaze(0.1, 0.1, soft, strayed), 0),
                     np.where(there, body + (1 - body) * np.minimum(1.6 * dark, 0.8), 1), border], -1)
    mask = np.floor(clamp01(mask) * UNIT + 0.5) / UNIT * on[..., None]
    reach = [min(int(POOL * share * scale + 0.5), MOST_REACH) for share in (1 / 3, 1)]
    reach = [k if k > 1 else 0 for k in reach]
    around = [_blurred(mask, k) for k in reach]

    def pool(k):
        return clamp01(mask[..., k] - around[0][..., k]) + 0.5 * clamp01(mask[..., k] - around[1][..., k])

    # what the color absorbs
    gray = (color @ LUMINANCE)[..., None]
    turn = 1 + 0.05 * hue[..., None] * np.array((1.0, 0.0, -1.0))
    k = gray + of("color")[..., None] * (color - gray)
    k = -np.log(np.clip(k * mix(1, turn, np.minimum(of("color"), 1)[..., None]), 0.012, 0.985))
    mean = 0.5 * (k.max(-1) + k.min(-1)) / 2.9
    k = k * (of("density") / np.sqrt(1 + mean**2))[..., None]

    wet = kept(wet)
    pools = of("pooling") * (1 - wet) * (0.75 + 0.5 * clamp01(0.5 + gap))
    near, far = (np.minimum(0.5 * r * a[..., BORDER], 1) for r, a in zip(reach, around, strict=True))
    rim = 0.55 * near**2 + 0.25 * far**2
    body = mix(0.52, 0.95, 1 - smooth(0.35, 0.95, lit))
    body = body + (1 - body) * clamp01(1.6 * dark)
    body = body * (0.3 + 0.7 * mask[..., BODY]) * (1 + cloud) + pools * (0.55 * rim + 0.5 * pool(BODY))
    down = (layers.y + np.arange(there.shape[0]) + 0.5)[:, None] / layers.full_height
    sky = np.clip(0.95 - 0.9 * down + 0.4 * cloud + 0.02 * gap, 0.04, 1.1) * 0.8 + 0.12 * pools * rim
    body = np.where(there, body, sky)
    shade = mask[..., SHADE] * (1 + 1.2 * cloud) + pools * (1.5 * pool(SHADE) + 0.35 * mask[..., SHADE] * rim)
    deep = mask[..., DEEP] * (1 + 1.2 * cloud) + 1.4 * pools * pool(DEEP)
    more = 0.26 * (mask[..., SHADE] + 0.5 * mask[..., DEEP])
    glazed = -np.log(np.clip(of("glaze"), 0.05, 1)) * of("shade")[..., None]
    density = k * (body[..., None] + more[..., None] * np.exp(-0.8 * k))
    density = np.maximum(density + np.maximum(shade + 1.4 * deep, 0)[..., None] * glazed, 0)

    smooth_paper = (of("granulation") == 0) | (params["paper_source"] == "NONE")
    total, paper = density.mean(-1), 0.5 + 2.5 * (np.where(smooth_paper, 0.8, height) - 0.8)
    sheet = Places(layers, stick=False)
    tooth = 0.35 * (paper - 0.5) + 0.2 * (sheet.noise(5 * scale, 11)[0] + sheet.noise(13 * scale, 12)[0])
    valley = clamp01(0.2 - 3 * tooth)
    grain = of("granulation") * smooth(0.03, 0.35, total) * (1 - smooth(1.2, 2.6, total))
    left = of("gaps") * mask[..., BORDER] * smooth(0.15, 0.45, gap) * smooth(0.3, 0.8, lit) * there
    total = np.maximum(1 + grain * (2.2 * valley - 0.6), 0) * (1 - left)
    sheet = np.array(params["wash_paper"]) * (1 + 0.035 * (paper - 0.5))[..., None]
    bare = (clamp01(1.2 * highlight - 0.12) * there)[..., None]
    alpha = surface[..., 3:]
    rgb = mix(sheet * np.exp(-total[..., None] * density), sheet, bare) * alpha
    return np.where(on[..., None], np.concatenate([rgb, alpha], -1), surface), doubtful & on
