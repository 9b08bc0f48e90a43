# SPDX-License-Identifier: GPL-3.0-or-later
"""The painted control *Color Edge*: white draws every boundary that is to be seen, by every look; black none."""

import numpy as np
import pytest
from encre.pen import library, presets
from reference import metric

HEIGHT, WIDTH = 1080, 96
AT = list(library.controls()).index("color_edge")
LOOKS = [preset.name for preset in presets.presets()]
PAIRS = {  # sRGB, as a painter picks them
    "red and yellow": ("c8281e", "e6c832"), "skin and lips": ("e0ac8c", "c97f74"),
    "green and red": ("3c7832", "b43c28"), "blue and teal": ("2850a0", "1e7884"),
    "skin and hair": ("d9a07e", "6b4a34"), "light greys": ("c8c8c8", "b4b4b4"),
    "middle greys": ("808080", "737373"), "black and coal": ("0c0c0c", "222222"),
    "orange and pink": ("e08c46", "e08282"),
}


def linear(text):
    return metric.decode(np.array([int(text[k:k + 2], 16) for k in (0, 2, 4)]) / 255)


def drawn(look, one, other, control):
    """The ink of a look's lines where two colours meet on a wall that is painted so, by row."""
    halves = np.where((np.arange(WIDTH) < WIDTH // 2)[:, None], linear(one), linear(other))
    color = np.broadcast_to(halves, (HEIGHT, WIDTH, 3)).astype(np.float32)
    plain = np.ones((HEIGHT, WIDTH, 3), np.float32)
    controls = np.zeros((HEIGHT, WIDTH, len(library.controls())), np.float32)
    controls[..., AT] = control
    layers = dict(combined=np.concatenate([color, plain[..., :1]], -1), color=color, albedo=color, diffuse=plain,
                  normal=plain * np.float32((0, 0, 1)), depth=5 * plain[..., 0], object=plain[..., 0],
                  controls=controls)
    values = presets.find(look).values | dict(use_tones=False, use_example=False)
    return library.render(layers, values, outputs=["Encre Lines"]).images["Encre Lines"][..., 3].sum(1)


@pytest.mark.parametrize("pair", PAIRS)
def test_the_pairs_differ_as_little_as_the_promise(pair):
    one, other = (metric.lab(metric.encode(linear(text))) for text in PAIRS[pair])
    assert metric.ciede2000(one, other) >= 5


@pytest.mark.parametrize("look", LOOKS)
def test_white_draws_every_boundary_and_black_none(look):
    ink = {pair: drawn(look, *colors, 1)[20:-20] for pair, colors in PAIRS.items()}
    poor = {pair: (float(a.mean()), float((a > 0.1).mean())) for pair, a in ink.items()
            if a.mean() < 0.25 or (a > 0.1).mean() < 0.75}
    assert not poor
    assert not any(drawn(look, *colors, -1).any() for colors in PAIRS.values())
