# SPDX-License-Identifier: GPL-3.0-or-later
"""Layers of noise."""

import numpy as np
from encre.pen import library

CONTROLS = len(library.controls())


def random_layers(height, width, seed=0):
    """Noise that takes every branch: holes, sky, dark light, three styles, controls beyond their range."""
    rng = np.random.default_rng(seed)

    def noise(channels, low=0.0, high=1.0):
        return rng.uniform(low, high, (height, width, channels))

    def chance(p):
        return rng.random((height, width, 1)) < p

    color, diffuse = noise(3), noise(3, -0.05, 1.6) * np.where(chance(0.2), 0.02, 1.0)
    alpha = np.where(chance(0.1), 0.0, np.where(chance(0.5), 1.0, noise(1)))
    rgb = color * diffuse + noise(3, -0.2, 0.3)
    controls = noise(CONTROLS, -1.3, 1.3)
    controls[..., 2] = 0
    layers = dict(
        combined=np.concatenate([rgb, alpha], -1), color=color, diffuse=diffuse, specular=noise(3) * chance(0.4),
        highlights=noise(3, 0.0, 0.8) * chance(0.5), background=noise(3) * chance(0.3),
        depth=np.where(chance(0.1), 1e10, rng.integers(2, 6, (height, width, 1)) + 0.01 * noise(1)),
        normal=noise(3, -1), object=chance(0.006), style=rng.integers(0, 3, (height, width, 1)), controls=controls)
    return {name: a.astype(np.float32) for name, a in layers.items()}
