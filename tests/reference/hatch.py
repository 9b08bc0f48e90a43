# SPDX-License-Identifier: GPL-3.0-or-later
"""Hatching through the paper's grain where it is dark (Vainumäe 2020, 4.3)."""

import numpy as np

from .metric import clamp01, mix, value
from .shade import other


def hatch(layers, params, surface, paper):
    """The surface (H, W, 4) with its hatching; paper (H, W) is the height there, 0…1."""
    style = layers.style

    def lit(v, name):
        threshold = params.at(name, style)
        return np.where(threshold > 0, v / np.where(threshold > 0, threshold, 1.0), 1.0)

    shine = value(other(layers))
    tone = np.maximum(value(layers.color), shine)
    light = np.maximum(value(layers.diffuse) * params.at("shade_exposure", style), shine)
    bright = np.minimum(lit(tone, "hatch_color_threshold"), lit(light, "hatch_light_threshold")).clip(max=1.0)
    strength = paper * (1 + layers.controls["hatching"]) * params.at("hatch_amount", style) - bright
    ink = clamp01((1 - clamp01(value(layers.specular))) * 2.5 * strength)
    ink = np.where(layers.there & params.at("use_hatching", style), ink, 0.0)[..., None]
    rgb, alpha = surface[..., :3], surface[..., 3:]
    return np.concatenate([mix(rgb, params.at("hatch_color", style) * alpha, ink), alpha], axis=-1)
