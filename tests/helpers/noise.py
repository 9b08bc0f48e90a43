# SPDX-License-Identifier: GPL-3.0-or-later
"""Pictures of white noise: the worst that layers can hold; and the noise of rendered light."""

import bench
import numpy as np


def everywhere(width, height, seed=0):
    """Each layer is noise: depth, index and what mirrors show too."""
    rng = np.random.default_rng(seed)

    def noise(*channels):
        return rng.random((height, width, *channels), np.float32)

    layers = dict(combined=np.concatenate([noise(3), np.ones((height, width, 1), np.float32)], -1), color=noise(3),
                  albedo=noise(3), diffuse=noise(3), normal=2 * noise(3) - 1, depth=1 + 10 * noise(),
                  object=np.floor(9 * noise()), material=np.floor(9 * noise()))
    layers |= dict(seen_color=noise(3), seen_normal=2 * noise(3) - 1, seen_depth=20 * noise())
    return layers


def textures(width, height, seed=0):
    """A flat wall with noise for its colours and its light: nothing but these two makes edges."""
    rng, layers = np.random.default_rng(seed), bench.balls(width, height, 0)
    layers["color"] = layers["albedo"] = rng.random((height, width, 3), np.float32)
    layers["diffuse"] = 1.5 * rng.random((height, width, 3), np.float32)
    layers["combined"][..., :3] = layers["albedo"] * layers["diffuse"]
    return layers


def of_light(shape, seed=1, left=0.01, amount=0.08, steps=(1, 2)):
    """By what light is multiplied: (where a denoiser leaves clouds, the wider the more steps, as it is rendered)."""
    rng = np.random.default_rng(seed)
    cloud = rng.standard_normal(shape)
    for axis in (0, 1):
        for step in steps:
            cloud = (np.roll(cloud, step, axis) + 2 * cloud + np.roll(cloud, -step, axis)) / 4
    return 1 + left * cloud / cloud.std(), 1 + amount * rng.standard_normal(shape)
