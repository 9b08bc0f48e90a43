# SPDX-License-Identifier: GPL-3.0-or-later
"""Contours within a thing that run beside each other: the rim of an eyelid, a gap between lips, a finger."""

import numpy as np
import pytest
from encre.pen import library

LINE = dict(edge_detector="FINE", line_color_strength=0.0, line_shadow_strength=0.0, line_thickness=1.2,
            length_unit="PIXELS")
NEAR, RIM, FAR = 4.0, 4.3, 6.0


def forms(width, slant, depths, behind=1.0, size=(60, 60)):
    """Layers of a strip so many pixels wide between two others, and how far off its middle a pixel lies. behind:
    number of what is beyond it."""
    y, x = np.mgrid[:size[0], :size[1]].astype(np.float64)
    off = (x - 29.3) * np.cos(slant) + (y - 29.6) * np.sin(slant)
    strip = np.abs(off) < width / 2
    depth = np.where(strip, depths[1], np.where(off < 0, depths[0], depths[2]))
    flat = np.ones((*size, 3))
    layers = dict(combined=np.ones((*size, 4)), color=0.5 * flat, diffuse=flat, normal=flat * (0, 0, 1), depth=depth,
                  creases=np.zeros((*size, 5)), marks=np.zeros((*size, 2)),
                  object=np.where((off > 0) & ~strip, behind, 1.0))
    return {name: np.ascontiguousarray(a, np.float32) for name, a in layers.items()}, off


def inked(width, slant, depths, **how):
    """Ink about the strip, and how far off its middle it lies in the mean."""
    layers, off = forms(width, slant, depths, **how)
    drawn = library.render(layers, LINE, outputs=["Encre Lines"]).images["Encre Lines"][..., 3].astype(float)
    about = (drawn * (np.abs(off) < 9))[15:45, 15:45]
    return about.sum(), (about * off[15:45, 15:45]).sum() / about.sum()


@pytest.mark.parametrize(("width", "slant"), [(3.0, 0.0), (2.5, 0.4), (2.8, 0.4), (2.5, 1.2), (2.8, 1.2)])
def test_steps_close_together_are_one_line(width, slant):
    """It stays on the nearer one, of a gap on the left."""
    for depths, side in (((NEAR, RIM, FAR), -1), ((FAR, RIM, NEAR), 1), ((NEAR, FAR, NEAR), -1)):
        (ink, off), (two, middle) = inked(width, slant, depths), inked(9, slant, depths)
        assert 0.45 * two < ink < 0.57 * two
        assert off * side == pytest.approx(width / 2, abs=0.4) and abs(middle) < 0.4


@pytest.mark.parametrize(("width", "slant"), [(3.0, 0.0), (2.5, 0.4), (2.8, 1.2)])
def test_a_thin_thing_keeps_both_its_sides(width, slant):
    (ink, off), (two, _) = inked(width, slant, (FAR, NEAR, FAR)), inked(9, slant, (FAR, NEAR, FAR))
    assert ink > 0.85 * two and abs(off) < 0.4
    for far in (FAR, np.inf):  # and an outline stays beside a fold
        assert inked(width, slant, (NEAR, RIM, far), behind=2.0)[1] == pytest.approx(width / 2, abs=0.4)


@pytest.mark.parametrize(("width", "slant"), [(3.0, 0.0), (2.6, 0.2)])
def test_no_rungs_stay_of_a_ladder(width, slant):
    """What crosses a strip whose farther side gives way, every 8 pixels."""
    plain, off = forms(width, slant, (NEAR, RIM, FAR))
    y, x = np.mgrid[:60, :60]
    behind = ((y - 29.6) * np.cos(slant) - (x - 29.3) * np.sin(slant)) % 16 < 8
    rungs = dict(plain, depth=plain["depth"] + np.float32(0.7) * ((np.abs(off) < width / 2) & behind))
    ink = [library.render(layers, LINE, outputs=["Encre Lines"]).images["Encre Lines"][10:50, 10:50, 3].sum()
           for layers in (plain, rungs)]
    assert ink[1] < 1.05 * ink[0]


def test_a_fold_thins_out_as_it_comes_nearer():
    inks = [inked(width, 0.4, (NEAR, RIM, FAR))[0] for width in np.arange(2.6, 6.4, 0.2)]
    steps = np.diff(inks)
    assert steps.min() > -0.03 * inks[-1] and steps.max() < 0.25 * inks[-1] and inks[0] < 0.57 * inks[-1]
