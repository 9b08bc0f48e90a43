# SPDX-License-Identifier: GPL-3.0-or-later
"""Light in flat levels, tinted and desaturated shade (Vainumäe 2020, 4.1)."""

import numpy as np

from .metric import clamp01, mix, value


def exposed(layers, params):
    """The light (H, W) that is compared with thresholds, by the pixel's own style."""
    return metered(layers, value(layers.diffuse)) * params.at("shade_exposure", layers.style) + painted(layers)


def metered(layers, light):
    """Light, full light of which is 1, and shade 0.35 where it is told: straight from 0 to shade, on from there to full
    light and beyond."""
    full, shade = layers.meter
    if not shade:
        return light / full
    return np.where(light < shade, light * 0.35 / shade, 0.35 + 0.65 * (light - shade) / (full - shade))


def painted(layers):
    """What is painted onto exposed light."""
    return 0.5 * layers.controls["light"]


def levels(layers, params):
    """The level I (H, W) and its colour K (H, W, 3) by the pixel's own style; and where a step is near."""
    x = exposed(layers, params)
    level, color, doubtful = np.zeros_like(x), np.zeros((*x.shape, 3)), np.zeros(x.shape, bool)
    for k, steps in params.levels():
        own = layers.style == k
        light = metered(layers, value(layers.diffuse)) * params.at("shade_exposure", np.full(x.shape, k)) + painted(
            layers)
        found = _ramp(light, steepness(np.minimum(light, 1e6)), steps)
        level[own], color[own], doubtful[own] = (out[own] for out in found)
    return level, color, doubtful


def steepness(light):
    """How much it differs from a pixel to the next; the less of both sides."""
    def along(axis):
        n = light.shape[axis]
        before, after = (np.take(light, np.abs(np.arange(n) - 1).clip(0, n - 1), axis),
                         np.take(light, np.where(np.arange(n) < n - 1, np.arange(n) + 1, max(n - 2, 0)), axis))
        return np.minimum(np.abs(light - before), np.abs(after - light))

    return np.hypot(along(0), along(1))


def passed(light, threshold, transition, steep):
    """How far light has come from the level below a threshold to the one above. In one step its edge goes over a
    pixel."""
    if transition > 1e-30:
        return clamp01((light - threshold) / transition + 0.5)
    edge = clamp01((light - threshold) / np.maximum(steep, 1e-30) + 0.5)
    return np.where(steep > 1e-4, edge, light > threshold)


def _ramp(x, steep, steps):
    """The levels' intensity and colour at x: straight from one to the next over each transition."""
    level = np.full(x.shape, float(steps[0][0]))
    color = np.broadcast_to(np.array(steps[0][1:] or (1.0, 1.0, 1.0)), (*x.shape, 3))
    doubtful = np.zeros(x.shape, bool)
    for intensity, threshold, transition, *rgb in steps[1:]:
        t = passed(x, threshold, transition, steep)
        if transition < 1e-3:
            doubtful |= np.abs(x - threshold) < np.maximum(transition / 2 + 1e-4, np.where(steep < 1e-3, steep, 0))
        level = mix(level, intensity, t)
        color = mix(color, np.array(rgb or (1.0, 1.0, 1.0)), t[..., None])
    return level, color, doubtful


def shade_of(level, layers, params):
    """How far it is shade: below 0 it is brighter than full light, where that counts."""
    return np.maximum(np.where(params.at("shade_beyond", layers.style), -0.5, 0.0), 1 - level)


def light(layers, params):
    """D' (H, W, 3): the discrete light with its tint; the level (H, W); and where a step is near."""
    level, color, doubtful = levels(layers, params)
    v = value(layers.diffuse)[..., None]
    hue = np.where(v > 0, mix(1.0, layers.diffuse / np.where(v > 0, v, 1.0), clamp01(v / 0.02)), 1.0)
    hue = mix(1.0, hue, params.at("light_hue", layers.style)[..., None])
    shade = np.maximum(-0.5, shade_of(level, layers, params) * params.at("shade_tint_weight", layers.style))
    tint = params.at("shade_tint", layers.style)
    tinted = (hue * (level[..., None] * color) + shade[..., None] * tint) / (1 + shade[..., None])
    return tinted, level, doubtful


def other(layers):
    """What `color·diffuse` leaves of the image: emission, reflections, glass, sky; signed."""
    return layers.combined[..., :3] - layers.color * layers.diffuse


def weighted(layers, params):
    """`other` with its parts as strong as wanted, and where float32 may be on the other side of a highlight's edge."""
    whole = other(layers)
    there = layers.there[..., None]
    background = np.where(there, 0.0, whole) if layers.background is None else layers.background
    lamps = layers.highlights
    gloss = np.maximum(layers.specular, lamps)
    rest = whole - background - gloss
    threshold, shape = (params.at("highlight_" + name, layers.style) for name in ("threshold", "shape"))
    bright = value(lamps)
    light = max(layers.meter[0], 1)
    bright = bright * clamp01(2 * layers.normal @ layers.view[2]) ** 2
    bright = bright / np.maximum(value(layers.diffuse) / light, 1)
    share = clamp01((bright / light - threshold) / 0.05 + 0.5)
    given = layers.gives_highlights * shape[..., None]
    metal, full = clamp01(8 * (value(layers.gloss) - 0.06)), value(layers.gloss)
    tint = mix(1.0, layers.gloss / np.where(full > 0, full, 1)[..., None], metal[..., None])
    shown = mix(lamps, params.at("highlight_color", layers.style) * tint * share[..., None], given)

    def weight(name):
        return params.at(name, layers.style)[..., None]

    def mirrored(front):
        """What metals mirror, in flat tones, even in square roots; over a tenth of the way from one to the next."""
        tones = params.at("reflection_tones", layers.style)
        share = clamp01(8 * (value(layers.gloss) - 0.06)) * (tones > 0)
        root = np.sqrt(np.maximum(value(front), 0))
        place = root * np.maximum(tones, 1) + 0.5
        tone = (np.floor(place) - 1 + clamp01(10 * (place % 1))) / np.maximum(tones, 1)
        factor = np.where(root > 0, (tone / np.where(root > 0, root, 1)) ** 2, 0)
        near = (share > 0) & (place % 1 > 1 - 1e-4)
        return front * mix(1.0, factor, share)[..., None], near

    world = params["other_background"] * background
    parts = (world + weight("other_highlights") * shown
             + weight("other_reflections") * (gloss - lamps) + weight("other_glow") * rest)
    kept = 0.0 if layers.background is None else world
    flat, near = mirrored(parts - kept)
    return flat + kept, near


def surface(layers, params):
    """(H, W, 4) the shaded surface, (H, W, 3) D', and where float32 may be on the other side of a step."""
    tinted, level, doubtful = light(layers, params)
    alpha = layers.combined[..., 3:]
    saturation = clamp01(params.at("shade_saturation", layers.style))
    grey = shade_of(level, layers, params) * (1 - saturation)
    v = value(layers.color)[..., None]
    pale = v - (v - layers.color) * (1 - grey[..., None])
    strength = params.at("shade_strength", layers.style)[..., None]
    shaded = mix(layers.color * layers.diffuse, pale * tinted, strength)
    paper = params["surface"] == "PAPER"
    if paper:
        shaded = np.array(params["paper_color"]) * alpha
    parts, edges = weighted(layers, params)
    doubtful = (doubtful & (not paper)) | edges
    rgb = np.maximum(0.0, shaded + params["other_light"] * parts)

    on = params.at("use_shading", layers.style)[..., None]
    if not paper:
        on = on & (alpha != 0)
    rgb = np.where(on, rgb, layers.combined[..., :3])
    return np.concatenate([rgb, alpha], axis=-1), tinted, doubtful & on[..., 0]
