# SPDX-License-Identifier: GPL-3.0-or-later
"""Layers drawn by formula: spheres over a checkered floor, for tests and the benchmark that need a picture."""

import numpy as np
from encre.pen import library

CONTROLS = len(library.controls())

LIGHT = np.array([0.48, 0.64, 0.60])


def spheres(n, rng):
    """Centres (camera space, looking along -z) and radii of n spheres in front of the camera."""
    z = -rng.uniform(4, 14, n)
    return np.stack([rng.uniform(-0.85, 0.85, n) * -z * 16 / 9 * 0.5, rng.uniform(-0.35, 0.45, n) * -z, z], 1), \
        rng.uniform(0.3, 1.2, n)


def scene(width, height, n=40, seed=0, noise=0.0, rows=slice(None)):
    """Every layer that encre_render() reads, as float32 arrays (height, width, channels), row 0 at the top.

    noise: standard deviation of white noise on the diffuse light, as from few samples; rows: which are wanted.
    """
    rng = np.random.default_rng(seed)
    x = ((np.arange(width) + 0.5) / width * 2 - 1) * 0.5 * width / height
    y = ((1 - (np.arange(height) + 0.5) / height * 2) * 0.5)[rows]
    height = len(y)
    ray = np.stack(np.broadcast_arrays(x[None, :], y[:, None], -1.0), -1)
    depth = np.full((height, width), 1e10)
    normal = np.zeros((height, width, 3))
    albedo = np.zeros((height, width, 3))
    index = np.zeros((height, width))

    floor = np.divide(-1.2, ray[..., 1], out=np.full((height, width), -1.0), where=ray[..., 1] < 0)
    seen = floor > 0
    depth[seen] = floor[seen]
    normal[seen] = 0, 1, 0
    cell = np.floor(ray[..., 0] * floor) + np.floor(floor)
    albedo[seen] = np.where(cell[seen, None] % 2, (0.7, 0.65, 0.5), (0.25, 0.3, 0.4))
    index[seen] = 1
    for k, (centre, radius) in enumerate(zip(*spheres(n, rng), strict=True)):
        a, b = (ray**2).sum(-1), ray @ centre
        d = b * b - a * (centre @ centre - radius**2)
        t = (b - np.sqrt(np.maximum(d, 0))) / a
        hit = (d > 0) & (t > 0) & (t < depth)
        p = ray[hit] * t[hit, None]
        depth[hit] = t[hit]
        normal[hit] = (p - centre) / radius
        tint = rng.uniform(0.1, 0.9, 3)
        stripe = np.sin(normal[hit][:, 1] * 9) > 0.3
        albedo[hit] = np.where(stripe[:, None], tint, tint[::-1] * 0.5)
        index[hit] = k + 2
    there = (depth < 1e9)[..., None]
    diffuse = np.maximum(normal @ LIGHT, 0)[..., None] * (1.3, 1.25, 1.1) + there * (0.15, 0.15, 0.25)
    diffuse = np.maximum(diffuse * (1 + noise * rng.standard_normal(diffuse.shape)), 0)
    specular = np.maximum(normal @ LIGHT, 0)[..., None] ** 40 * there * (0.6, 0.6, 0.6)
    combined = np.concatenate([albedo * diffuse + specular, there], -1)
    controls = np.zeros((height, width, CONTROLS))
    controls[..., 0] = np.where(index % 7 == 3, 0.3, 0)
    controls[..., 3:5] = np.where(index % 5 == 2, 0.8, 0)[..., None]
    layers = dict(combined=combined, color=albedo, albedo=albedo, diffuse=diffuse, specular=specular, depth=depth,
                  normal=normal, object=index, material=index % 4, style=index * 0, controls=controls)
    return {k: np.ascontiguousarray(v, np.float32) for k, v in layers.items()}
