# SPDX-License-Identifier: GPL-3.0-or-later
"""The sky of a clear day by formula: what Blender's Sky Texture shows, and the sun in it.

The atmosphere is that of Nishita, Sirai, Tadamura and Nakamae (Display of the Earth Taking into Account Atmospheric
Scattering, 1993), of light that is scattered once, at wavelengths through the spectrum. Constants are those of the
air itself: Rayleigh scattering by its refractive index, the Chappuis band of ozone, sunlight as that of a black body.
The analytic sky is that of Preetham, Shirley and Smits (A Practical Analytic Model for Daylight, 1999)."""

from __future__ import annotations

import functools
import math

import numpy as np

from .suns import Sun

_EARTH, _TOP = 6360e3, 6420e3  # radii of the ground and of the end of the air, meters
_RAYLEIGH, _MIE = 8e3, 1.2e3   # heights over which air and dust thin to 1/e
_FORWARD = 0.76                # asymmetry of what dust scatters
_STEPS, _STEPS_TO_SUN = 32, 16
_WAVES = np.arange(380, 781, 20) * 1.0  # nanometers
# Cross sections of ozone at these, of 1e-25 m2.
_CHAPPUIS = np.array([0.0, 0.01, 0.04, 0.14, 0.37, 0.71, 1.2, 1.75, 2.7, 3.8, 4.7, 5.1, 4.0, 2.9, 2.1, 1.4, 0.9, 0.6,
                      0.4, 0.3, 0.2])
_ROWS, _COLUMNS = 48, 33       # of what is computed: from the horizon up, and half around from the sun


def toward(elevation: float, rotation: float) -> np.ndarray:
    """(3,) of length 1: where a sun stands, turned clockwise from +y."""
    level = math.cos(elevation)
    return np.array([level * math.sin(rotation), level * math.cos(rotation), math.sin(elevation)])


# Spectra

def _rgb(spectra):
    """(..., 3) linear Rec. 709 of spectra (..., waves): the CIE's matching functions by sums of lobes (Wyman, Sloan
    and Shirley 2013)."""
    def lobe(middle, below, above):
        return np.exp(-0.5 * ((_WAVES - middle) / np.where(middle > _WAVES, below, above)) ** 2)

    x = 1.056 * lobe(599.8, 37.9, 31.0) + 0.362 * lobe(442.0, 16.0, 26.7) - 0.065 * lobe(501.1, 20.4, 26.2)
    y = 0.821 * lobe(568.8, 46.9, 40.5) + 0.286 * lobe(530.9, 16.3, 31.1)
    z = 1.217 * lobe(437.0, 11.8, 36.0) + 0.681 * lobe(459.0, 26.0, 13.8)
    return spectra @ (_FROM_XYZ @ np.array([x, y, z])).T * (_WAVES[1] - _WAVES[0])


_FROM_XYZ = np.array([[3.2404542, -1.5371385, -0.4985314], [-0.9692660, 1.8760108, 0.0415560],
                      [0.0556434, -0.2040259, 1.0572252]])


def _sunlight():
    """W/m2 a nanometer above the air."""
    waves = _WAVES * 1e-9
    black = 1 / (waves ** 5 * np.expm1(0.014387769 / (waves * 5778)))
    return 1.7826 * black / black[5]


def _rayleigh():
    """What air at sea level scatters out of a meter."""
    micro = _WAVES * 1e-3  # refraction: Peck and Reeder 1972, without its constant
    bends = 0.05792105 / (238.0185 - micro ** -2) + 0.00167917 / (57.362 - micro ** -2)
    return 5.4248e-5 * (380 / _WAVES) ** 4 * (bends / bends[0]) ** 2


# The atmosphere

def _densities(height):
    """Of air, dust and ozone, of what is greatest of each."""
    ozone = np.clip(np.minimum((height - 10e3) / 15e3, (40e3 - height) / 15e3), 0, 1)
    return np.exp(-height / _RAYLEIGH), np.exp(-height / _MIE), ozone


def _to_end(place, way):
    """How far the air goes."""
    b = place @ way if way.ndim == 1 else np.sum(place * way, -1)
    return -b + np.sqrt(np.maximum(b * b - np.sum(place * place, -1) + _TOP ** 2, 0))


def _thickness(place, way):
    """(..., 3) of the way to the end of the air: how much air, dust and ozone is on it, in meters of the densest."""
    far = _to_end(place, way)
    share = (np.arange(_STEPS_TO_SUN) + 0.5) / _STEPS_TO_SUN  # squared: closer where the air is dense
    points = place[..., None, :] + (far[..., None] * share ** 2)[..., None] * way
    found = _densities(np.linalg.norm(points, axis=-1) - _EARTH)
    return np.stack([(2 * share * d).mean(-1) * far for d in found], -1)


def _extinction(air, dust, ozone):
    """(3, waves): what a meter of the densest air, dust and ozone takes away."""
    return np.array([air * _rayleigh(), np.full(len(_WAVES), dust * 2e-5 * 1.11), ozone * 5.37e-7 * _CHAPPUIS])


def _blocked(place, way):
    """Whether the ground is in the way."""
    b = np.sum(place * way, -1)
    return (b < 0) & (np.sum(place * place, -1) - b * b < _EARTH ** 2)


def _scattered(ways, sun, altitude, air, dust, ozone):
    """(..., 3) of light that comes along ways (..., 3) through the air of a clear day, z up."""
    eye = np.array([0.0, 0.0, _EARTH + altitude])
    far = _to_end(np.broadcast_to(eye, ways.shape), ways)
    step = far / _STEPS
    extinct = _extinction(air, dust, ozone)
    cosine = ways @ sun
    of_air = 3 / (16 * np.pi) * (1 + cosine ** 2)
    g = _FORWARD ** 2
    of_dust = (3 * (1 - g) * (1 + cosine ** 2)
               / (8 * np.pi * (2 + g) * (1 + g - 2 * _FORWARD * cosine) ** 1.5))
    before, sums = np.zeros((*ways.shape[:-1], len(_WAVES))), 0.0
    for k in range(_STEPS):
        place = eye + ((k + 0.5) * step)[..., None] * ways
        density = np.stack(_densities(np.linalg.norm(place, axis=-1) - _EARTH), -1)
        before = before + (density * step[..., None]) @ extinct  # all of the step: so Cycles has it
        lit = np.exp(-(before + _thickness(place, sun) @ extinct)) * ~_blocked(place, sun)[..., None]
        scattered = (of_air * density[..., 0])[..., None] * extinct[0] + (
            of_dust * density[..., 1])[..., None] * (extinct[1] / 1.11)
        sums = sums + lit * scattered * step[..., None]
    return _rgb(sums * _sunlight())


@functools.lru_cache(maxsize=16)
def atmosphere(elevation: float, rotation: float, altitude: float, air: float, dust: float, ozone: float,
               height: int = 128) -> np.ndarray:
    """An equirectangular picture (height, 2 height, 3) of float32, row 0 at the top, whose middle is seen towards +x: a
    clear sky, over a ground that is black. altitude: meters; air, dust, ozone: factors on what they are."""
    sun = toward(elevation, 0.0)
    # Rows are closer near the horizon, where most changes.
    rise = np.linspace(0, 1, _ROWS) ** 2 * np.pi / 2
    turn = np.linspace(0, np.pi, _COLUMNS)
    ways = np.stack([np.cos(rise)[:, None] * np.sin(turn), np.cos(rise)[:, None] * np.cos(turn),
                     np.repeat(np.sin(rise)[:, None], _COLUMNS, 1)], -1)
    altitude = min(max(altitude, 1.0), _TOP - _EARTH - 1)
    table = np.maximum(_scattered(ways, sun, altitude, air, dust, ozone), 0)
    up = np.pi * (0.5 - (np.arange(height) + 0.5) / height)
    around = np.pi - 2 * np.pi * (np.arange(2 * height) + 0.5) / (2 * height)  # from +x, left
    apart = np.abs((np.pi / 2 - rotation - around + np.pi) % (2 * np.pi) - np.pi)
    row, column = np.sqrt(np.maximum(up, 0) / (np.pi / 2)) * (_ROWS - 1), apart / np.pi * (_COLUMNS - 1)
    fade = np.where(up < 0, np.maximum(1 + 2.5 * np.sin(up), 0) ** 3, 1)
    y, x = np.minimum(row.astype(int), _ROWS - 2), np.minimum(column.astype(int), _COLUMNS - 2)
    v, u = (row - y)[:, None, None], (column - x)[None, :, None]
    upper = table[y + 1][:, x] * (1 - u) + table[y + 1][:, x + 1] * u
    lower = table[y][:, x] * (1 - u) + table[y][:, x + 1] * u
    return ((lower * (1 - v) + upper * v) * fade[:, None, None]).astype(np.float32)


def sun_of(elevation: float, rotation: float, altitude: float, air: float, dust: float, width: float,
           intensity: float) -> Sun | None:
    """The sun of such a sky, which ozone does not dim in Cycles; None: it is below the ground."""
    altitude = min(max(altitude, 1.0), _TOP - _EARTH - 1)
    eye = np.array([0.0, 0.0, _EARTH + altitude])
    if elevation <= -width / 2 or _blocked(eye, toward(max(elevation, width / 4), 0.0)):
        return None
    thick = _thickness(eye, toward(max(elevation, width / 4), 0.0))
    light = _rgb(_sunlight() * np.exp(-thick @ _extinction(air, dust, 0.0)))
    seen = min(1.0, 0.5 + elevation / width)
    return Sun(toward(elevation, rotation), _LIMB * intensity * seen * np.maximum(light, 0), width)


_LIMB = 0.8  # what the darkening of its rim leaves of a disc's light: 1 - 0.6 / 3


# The analytic sky

_PEREZ = np.array([  # A to E of x, y and luminance, each a factor on turbidity and a number
    [[-0.0193, -0.2592], [-0.0665, 0.0008], [-0.0004, 0.2125], [-0.0641, -0.8989], [-0.0033, 0.0452]],
    [[-0.0167, -0.2608], [-0.0950, 0.0092], [-0.0079, 0.2102], [-0.0441, -1.6537], [-0.0109, 0.0529]],
    [[0.1787, -1.4630], [-0.3554, 0.4275], [-0.0227, 5.3251], [0.1206, -2.5771], [-0.0670, 0.3703]]])
_ZENITH = np.array([  # of x and y: rows by turbidity squared, turbidity and 1; columns by powers of the sun's angle
    [[0.00166, -0.00375, 0.00209, 0], [-0.02903, 0.06377, -0.03202, 0.00394], [0.11693, -0.21196, 0.06052, 0.25886]],
    [[0.00275, -0.00610, 0.00317, 0], [-0.04214, 0.08970, -0.04153, 0.00516], [0.15346, -0.26756, 0.06670, 0.26688]]])


def _perez(c, cosine, gamma):
    a, b, c, d, e = c[..., None, None]
    return (1 + a * np.exp(b / cosine)) * (1 + c * np.exp(d * gamma) + e * np.cos(gamma) ** 2)


@functools.lru_cache(maxsize=16)
def analytic(sun: tuple[float, float, float], turbidity: float, height: int = 64) -> np.ndarray:
    """As atmosphere(), by Preetham: sun is where that stands, of length 1."""
    up = np.pi * (0.5 - (np.arange(height) + 0.5) / height)[:, None]
    around = np.pi - 2 * np.pi * (np.arange(2 * height) + 0.5) / (2 * height)
    ways = np.stack([np.cos(up) * np.cos(around), np.cos(up) * np.sin(around), np.sin(up) + 0 * around], -1)
    turbidity = min(max(turbidity, 1.7), 30.0)  # of cleaner air the formula knows nothing
    angle = min(math.acos(min(max(sun[2], -1.0), 1.0)), math.pi / 2 - 0.001)
    chi = (4 / 9 - turbidity / 120) * (np.pi - 2 * angle)
    luminance = 0.06 * ((4.0453 * turbidity - 4.9710) * math.tan(chi) - 0.2155 * turbidity + 2.4192)
    powers = np.array([angle ** 3, angle ** 2, angle, 1])
    middle = [*(np.array([turbidity ** 2, turbidity, 1]) @ _ZENITH @ powers), luminance]
    gamma = np.arccos(np.clip(ways @ np.array(sun), -1, 1))
    cosine = np.cos(np.minimum(np.arccos(np.clip(ways[..., 2], -1, 1)), np.pi / 2 - 0.001))
    x, y, bright = (
        m * _perez(c, cosine, gamma) / _perez(c, np.ones((1, 1)), np.full((1, 1), angle))
        for m, c in zip(middle, _PEREZ @ np.array([turbidity, 1]), strict=True))
    xyz = np.stack([x / y * bright, bright, (1 - x - y) / y * bright], -1)
    return np.maximum(xyz @ _FROM_XYZ.T, 0).astype(np.float32)


def hosek(sun: tuple[float, float, float], turbidity: float, albedo: float) -> np.ndarray:
    """(3,) by which analytic() is to be multiplied to be about as bright as the sky of Hosek and Wilkie (An Analytic
    Model for Full Spectral Sky-Dome Radiance, 2012) is in Cycles. Its tables are not here: what falls on a level place
    is about a tenth off, and colors are Preetham's."""
    elevation = math.degrees(math.asin(min(max(sun[2], -1.0), 1.0)))
    low = 1 - math.exp(-max(elevation + 5, 0.5) / 9)
    return np.array([0.126, 0.144, 0.14]) * low * (1 + 0.03 * (turbidity - 2.2)) * (0.85 + 0.49 * albedo)
