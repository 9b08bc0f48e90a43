# SPDX-License-Identifier: GPL-3.0-or-later
"""Colour: sRGB, CIE L*a*b* and the four colour differences of the inter-color metric (Herring 2016)."""

import numpy as np

# IEC 61966-2-1, linear sRGB to XYZ. White is the sum of each row, so that greys have no chroma.
_XYZ = np.array([[0.4124, 0.3576, 0.1805], [0.2126, 0.7152, 0.0722], [0.0193, 0.1192, 0.9505]])


def value(color):
    """V of HSV: the largest channel."""
    return color.max(axis=-1)


def clamp01(x):
    return np.clip(x, 0.0, 1.0)


def mix(a, b, t):
    return a + (b - a) * t


def encode(linear):
    """Linear light to sRGB, after a clamp to 0…1."""
    x = clamp01(linear)
    return np.where(x <= 0.0031308, 12.92 * x, 1.055 * x ** (1 / 2.4) - 0.055)


def decode(encoded):
    return np.where(encoded <= 0.04045, encoded / 12.92, ((encoded + 0.055) / 1.055) ** 2.4)


def lab(encoded):
    """(…, 3) sRGB-encoded to CIE L*a*b*."""
    t = decode(encoded) @ _XYZ.T / _XYZ.sum(axis=1)
    f = np.where(t > (6 / 29) ** 3, np.cbrt(t), t / (3 * (6 / 29) ** 2) + 4 / 29)
    x, y, z = np.moveaxis(f, -1, 0)
    return np.stack([116 * y - 16, 500 * (x - y), 200 * (y - z)], axis=-1)


def rgb(one, two):
    """Herring 2016, eq. 3.1, on encoded colours; black to white is 1."""
    red, green, blue = np.moveaxis((one - two) ** 2, -1, 0)
    mean = (one[..., 0] + two[..., 0]) / 2
    return np.sqrt((2 + mean) * red + 4 * green + (3 - mean) * blue) / 3


def hsl(encoded):
    """(…, 3) sRGB-encoded to lightness, and hue and chroma as a place in the plane across the greys."""
    r, g, b = np.moveaxis(encoded, -1, 0)
    light = (encoded.max(axis=-1) + encoded.min(axis=-1)) / 2
    return np.stack([light, r - (g + b) / 2, np.sqrt(3) / 2 * (g - b)], axis=-1)


def rgb_of_hsl(value):
    """Back to sRGB-encoded."""
    light, across, aside = np.moveaxis(value, -1, 0)
    g = aside / np.sqrt(3)  # of channels whose mean of green and blue is 0
    channels = np.stack([across, g, -g], axis=-1)
    return channels + (light - (channels.max(-1) + channels.min(-1)) / 2)[..., None]


def by_hsl(one, two, hue=1.0, saturation=1.0, lightness=1.0):
    """On hsl(): how much of them are by hue and by chroma, and by lightness."""
    chroma = np.hypot(one[..., 1], one[..., 2]) - np.hypot(two[..., 1], two[..., 2])
    turn = np.maximum(0, ((one[..., 1:] - two[..., 1:]) ** 2).sum(-1) - chroma**2)
    return np.sqrt((lightness * (one[..., 0] - two[..., 0])) ** 2 + (saturation * chroma) ** 2 + (hue / 2) ** 2 * turn)


def cie76(one, two):
    return np.sqrt(((one - two) ** 2).sum(axis=-1))


def ciede2000(one, two):
    """Sharma, Wu & Dalal 2005, with their treatment of the hue's wrap and of greys."""
    l1, a1, b1 = np.moveaxis(one, -1, 0)
    l2, a2, b2 = np.moveaxis(two, -1, 0)
    c7 = ((np.hypot(a1, b1) + np.hypot(a2, b2)) / 2) ** 7
    stretch = 1.5 - 0.5 * np.sqrt(c7 / (c7 + 25.0**7))
    c1, c2 = np.hypot(a1 * stretch, b1), np.hypot(a2 * stretch, b2)
    h1, h2 = (np.degrees(np.arctan2(b, a * stretch)) % 360 for a, b in ((a1, b1), (a2, b2)))
    grey = c1 * c2 == 0

    turn = h2 - h1
    turn = np.where(grey, 0, np.where(turn > 180, turn - 360, np.where(turn < -180, turn + 360, turn)))
    total, apart = h1 + h2, np.abs(h1 - h2)
    opposite = 180 + 1e-9  # the last bit must not tell whether opposite hues are more than 180 apart
    hue = np.where(apart <= opposite, total / 2, np.where(total < 360, total / 2 + 180, total / 2 - 180))
    hue = np.where(grey, total, hue)
    dl, dc, dh = l2 - l1, c2 - c1, 2 * np.sqrt(c1 * c2) * np.sin(np.radians(turn / 2))
    light, chroma = (l1 + l2) / 2, (c1 + c2) / 2

    def cos(degrees):
        return np.cos(np.radians(degrees))

    t = 1 - 0.17 * cos(hue - 30) + 0.24 * cos(2 * hue) + 0.32 * cos(3 * hue + 6) - 0.20 * cos(4 * hue - 63)
    sl = 1 + 0.015 * (light - 50) ** 2 / np.sqrt(20 + (light - 50) ** 2)
    sc = 1 + 0.045 * chroma
    sh = 1 + 0.015 * chroma * t
    bend = 60 * np.exp(-(((hue - 275) / 25) ** 2))
    rt = -2 * np.sqrt(chroma**7 / (chroma**7 + 25.0**7)) * np.sin(np.radians(bend))
    ul, uc, uh = dl / sl, dc / sc, dh / sh
    return np.sqrt(np.maximum(0, ul * ul + uc * uc + uh * uh + rt * uc * uh))


def cmc(one, two):
    """CMC 2:1, the larger of its two orders (it weighs by its first colour, edges have none)."""
    return np.maximum(_cmc(one, two), _cmc(two, one))


def _cmc(first, second):
    l1, a1, b1 = np.moveaxis(first, -1, 0)
    l2, a2, b2 = np.moveaxis(second, -1, 0)
    c1, c2 = np.hypot(a1, b1), np.hypot(a2, b2)
    h1 = np.degrees(np.arctan2(b1, a1)) % 360
    near = 0.56 + np.abs(0.2 * np.cos(np.radians(h1 + 168)))
    far = 0.36 + np.abs(0.4 * np.cos(np.radians(h1 + 35)))
    t = np.where((h1 >= 164) & (h1 <= 345), near, far)
    f = np.sqrt(c1**4 / (c1**4 + 1900))
    sl = np.where(l1 < 16, 0.511, 0.040975 * l1 / (1 + 0.01765 * l1))
    sc = 0.0638 * c1 / (1 + 0.0131 * c1) + 0.638
    sh = sc * (f * t + 1 - f)
    dh2 = np.maximum(0, (a1 - a2) ** 2 + (b1 - b2) ** 2 - (c1 - c2) ** 2)
    return np.sqrt(((l1 - l2) / (2 * sl)) ** 2 + ((c1 - c2) / sc) ** 2 + dh2 / sh**2)


_LAB = {"CIE76": cie76, "CIEDE2000": ciede2000, "CMC": cmc}


def difference(metric, one, two, weights=(1.0, 1.0, 1.0)):
    """ΔE of two (…, 3) sRGB-encoded colours: 1 is black to white; CIE units are divided by 100. weights: of HSL."""
    if metric == "RGB":
        return rgb(one, two)
    if metric == "HSL":
        return by_hsl(hsl(one), hsl(two), *weights)
    return _LAB[metric](lab(one), lab(two)) / 100


JUMP = {"RGB": 0.0, "HSL": 0.0, "CIE76": 0.0, "CIEDE2000": 0.5, "CMC": 0.01}  # the most of ΔE that a jump changes


def jumps(metric, one, two):
    """Where the metric itself is discontinuous: opposite hues in CIEDE2000, the branches of CMC."""
    if not JUMP[metric]:
        return np.zeros(one.shape[:-1], bool)
    (l1, a1, b1), (l2, a2, b2) = (np.moveaxis(lab(c), -1, 0) for c in (one, two))
    c1, c2 = np.hypot(a1, b1), np.hypot(a2, b2)
    h1, h2 = np.degrees(np.arctan2(b1, a1)) % 360, np.degrees(np.arctan2(b2, a2)) % 360
    if metric == "CMC":
        # a hue weighs with the square of its chroma: nearly grey, the branch makes no difference
        hues = [(c > 1) & (np.abs(h - at) < 0.02) for h, c in ((h1, c1), (h2, c2)) for at in (164, 345)]
        return np.any([*hues, np.abs(l1 - 16) < 1e-3, np.abs(l2 - 16) < 1e-3], axis=0)
    # the red-green stretch moves both hues, though never across 90 or 270 degrees
    mean7 = ((c1 + c2) / 2) ** 7
    stretch = 1.5 - 0.5 * np.sqrt(mean7 / (mean7 + 25.0**7))
    h1, h2 = (np.degrees(np.arctan2(b, a * stretch)) % 360 for a, b in ((a1, b1), (a2, b2)))
    least = np.minimum(c1, c2)
    return (least > 1e-3) & (np.abs(np.abs(h1 - h2) - 180) < 1e-3 + 0.02 / np.maximum(least, 1e-3))
