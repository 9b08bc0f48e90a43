# SPDX-License-Identifier: GPL-3.0-or-later
"""Hatching through the paper's grain where it is dark (Vainumäe 2020, 4.3)."""

import numpy as np

from .metric import clamp01, mix, value
from .shade import exposed, levels, other


def cover(layers, of, bright, paper):
    """(H, W) how much pencil is on surfaces of a brightness; of(name): the parameter of each pixel."""
    strength = paper * (1 + layers.controls["hatching"]) * of("hatch_amount") - bright
    return np.where(layers.there, clamp01((1 - clamp01(value(layers.specular))) * 2.5 * strength), 0.0)


def hatch(layers, params, surface, paper):
    """The surface (H, W, 4) with its hatching; and where float32 may be on the other side of a level's step. paper
    (H, W) is the height there, 0…1."""
    style = layers.style

    def lit(v, name):
        threshold = params.at(name, style)
        return np.where(threshold > 0, v / np.where(threshold > 0, threshold, 1.0), 1.0)

    shine = value(other(layers))
    tone = np.maximum(value(layers.color), shine)
    light = np.maximum(exposed(layers, params), shine)
    level, _, doubtful = levels(layers, params)
    rise = np.zeros_like(level)
    for k, steps in params.levels():
        low, high = steps[0][0], steps[-1][0]
        own = style == k
        if high > low:
            rise[own] = clamp01((level[own] - low) / (high - low))
    colored = lit(tone, "hatch_color_threshold").clip(max=1.0)
    colored = 1 - (1 - colored) * (1 - params.at("hatch_color_light", style) * rise)
    bright = np.minimum(colored, lit(light, "hatch_light_threshold")).clip(0.0, 1.0)
    ink = cover(layers, lambda name: params.at(name, style), bright, paper)
    ink = np.where(params.at("use_hatching", style), ink, 0.0)[..., None]
    rgb, alpha = surface[..., :3], surface[..., 3:]
    drawn = np.concatenate([mix(rgb, params.at("hatch_color", style) * alpha, ink), alpha], axis=-1)
    return drawn, doubtful & params.at("use_hatching", style) & (params.at("hatch_color_light", style) > 0)
