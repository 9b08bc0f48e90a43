# SPDX-License-Identifier: GPL-3.0-or-later
"""How pencil lies on the sheet of paper that is chosen."""

import numpy as np

from ...pen import library
from .. import thumbnails

SIDE = 128
_PENCIL = dict(use_lines=False, use_shading=False, use_smudging=False, use_hatching=True, hatch_amount=1.0,
               hatch_light_threshold=1.0, surface="PAPER", length_unit="PIXELS")


def sample(source):
    """(SIDE, SIDE, 4), row 0 at the top: pencil from light on the left to dark on the right, on a built-in sheet."""
    ones = np.ones((SIDE, SIDE, 4), np.float32)
    light = np.linspace(1, 0, SIDE, dtype=np.float32)[None, :, None] * ones
    light[..., 3] = 1
    layers = dict(combined=light, color=ones[..., :3], diffuse=light[..., :3], normal=ones[..., :3],
                  depth=ones[..., :1])
    layers = {name: np.ascontiguousarray(a) for name, a in layers.items()}
    return library.render(layers, _PENCIL | {"paper_source": source}, outputs=["Combined"]).images["Combined"]


def draw(layout, settings):
    """The sample below the rows of paper; what an image or no paper looks like is known."""
    if settings.paper_source not in ("IMAGE", "NONE"):
        icon = thumbnails.made(f"paper {settings.paper_source}", lambda: sample(settings.paper_source))
        layout.template_icon(icon, scale=5)
