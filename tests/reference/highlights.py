# SPDX-License-Identifier: GPL-3.0-or-later
"""Highlights of lamps: microfacets by GGX (Walter 2007), summed over thousands of points of each lamp."""

import numpy as np

from .lamps import Lit, asked, dot, unit
from .light import surfaces


def draw(world, lamp, look, view, projection, width, height, points=4096):
    """(light (height, width, 3), where something is seen) of a lamp that nothing stands before; look: colour,
    roughness, a coat's brightness and roughness, by what mirrors."""
    triangle, at, normal, _ = surfaces(world, view, projection, width, height)
    eye, lit, total = unit(np.linalg.inv(view)[:3, 3] - at), Lit(lamp), 0
    q = asked(points)
    for k in range(points):
        _, way = lit(at, normal, q[[k]])
        way = unit(way)
        # What falls, as matt surfaces of colour 1 show it, by the cosine: light on what faces the point.
        faced, _ = lit(at, way, q[[k]])
        total = total + (faced * np.pi)[:, None] * lamp.color * (
            facets(way, eye, normal, look[3])[:, None] * fresnel(way, eye, np.array(look[:3]))
            + facets(way, eye, normal, look[5])[:, None] * fresnel(way, eye, np.full(3, look[4])))
    there = triangle >= 0
    total = np.where((there & (dot(eye, normal) > 0))[:, None], total / points, 0)
    return total.reshape(height, width, 3), there.reshape(height, width)


def facets(way, eye, normal, roughness):
    """D G / (4 cos): of light that falls where it is faced."""
    alpha = max(roughness ** 2, 1e-3)
    half = unit(way + eye)
    falls, front, high = (np.maximum(dot(a, normal), 1e-6) for a in (way, eye, half))
    tilt = 1 / high ** 2 - 1
    facing = alpha ** 2 / (np.pi * high ** 4 * (alpha ** 2 + tilt) ** 2)
    hidden = sum(0.5 * (np.sqrt(1 + alpha ** 2 * (1 / c ** 2 - 1)) - 1) for c in (falls, front))
    return np.where(dot(way, normal) > 0, facing / (1 + hidden) / (4 * front), 0)


def fresnel(way, eye, color):
    """Schlick's; what mirrors less than a twenty-fifth does not turn white."""
    edge = (1 - np.clip(dot(unit(way + eye), eye), 0, 1)) ** 5 * min(1, 25 * color.max())
    return color + edge[:, None] * (1 - np.minimum(color, 1))
