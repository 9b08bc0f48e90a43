# SPDX-License-Identifier: GPL-3.0-or-later
"""Colour pulled across an edge, from behind or from in front (Vainumäe 2020, 4.2)."""

import numpy as np

from . import grid, lines
from .metric import mix


def smudge(layers, params, edges, surface, surface_doubtful):
    """The surface (H, W, 4) after smudging, and where float32 may decide otherwise."""
    controls, style = layers.controls, layers.style
    unit = params.pixels(layers.full_height)
    reach = params.at("smudge_range", style) * unit * controls["smudge_range"]
    far = np.abs(reach)
    y, x = grid.positions(far.shape)
    ey, ex, d = grid.nearest(edges.mask)
    found = lines.held(params, edges)
    if found:
        ey, ex, d = found[0], found[1], np.where(found[0] >= 0, np.hypot(found[0] - y, found[1] - x), np.inf)

    step = np.where(np.isfinite(d) & (d > 0), d, 1.0)
    pick = params.at("smudge_pick", style) * unit
    qy, qx = ey + pick * (ey - y) / step, ex + pick * (ex - x) / step
    q = tuple(np.clip(grid.round_half_up(at), 0, n - 1) for at, n in zip((qy, qx), far.shape, strict=True))

    z, zq = np.where(layers.there, layers.depth, 1e30), np.where(layers.there, layers.depth, 1e30)[q]
    least = params.at("smudge_depth", style) * (layers.height if layers.orthographic else z)
    differs = (layers.there != layers.there[q]) | (np.abs(zq - z) > least)
    side = np.where(reach > 0, zq > z, zq < z)
    asked = params.at("use_smudging", style) & (far > 0.1) & (d > 0) & (d <= far)
    applies = asked & side & differs & (surface[q][..., 3] > 0)

    near = params.at("smudge_falloff", style) * np.maximum(0.0, controls["smudge_falloff"]) * (1 + far)
    whole = (d < near) | (near >= far)
    ramp = np.maximum(0.0, (far - np.minimum(d, far)) / np.where(whole, 1.0, far - near))
    ramp = np.where(whole, 1.0, ramp)
    speed = params.at("smudge_curve", style)
    share = np.where(applies, ramp**speed, 0.0)
    smudged = np.where(applies[..., None], mix(surface, surface[q], share[..., None]), surface)

    # What float32 may see otherwise: another edge, another q, another side of a threshold.
    wanted = params.at("use_smudging", style) & (far > 0.1) & (d <= far + 1e-4)
    doubtful = wanted & (d > 0) & (
        (layers.there & layers.there[q] & (np.abs(np.abs(zq - z) - least) < 1e-4 * z))
        | ((np.abs(d - far) < 1e-4) & (near >= far - 1e-4))
        | ((np.abs(near - far) < 1e-4) & (d > near - 1e-4))
        | ((ramp < 1e-4) & (speed < 1))
        | grid.rounds_doubtfully(qy, 1e-4) | grid.rounds_doubtfully(qx, 1e-4)
    )
    *_, other = grid.nearest(edges.mask_doubtful)
    sure = grid.nearest(edges.mask & ~edges.mask_doubtful)[2]
    doubtful |= params.at("use_smudging", style) & (far > 0.1) & (found[2] if found else
                                                                  other <= np.minimum(sure, far + 1e-4))
    return smudged, doubtful | (applies & surface_doubtful[q])
