# SPDX-License-Identifier: GPL-3.0-or-later
"""How tones stick to what moves, and keep their ink, over whole motions: no worse than docs/tones.md says of each, and
as was asked for of those that were to stick. test_tones.py has three frames of some."""

import pages
import pytest
import sticks
from encre.cli.images import read_chosen
from toned import tile

pytestmark = pytest.mark.long

MARKS = "hatching", "strokes toward the light", "strokes along UV", "stipple"
# {tone: correlation at least in a pan, a zoom and a turn, pops at most in these and in a walk}
ASKED = {"dots": (0.989, 0.93, 0.98, 0.003), "lines": (0.995, 0.95, 0.97, 0.0005),
         "cross-lines": (0.995, 0.95, 0.97, 0.0005), **dict.fromkeys(MARKS, (0.91, 0.77, 0.87, 0.016))}
INK = dict.fromkeys(MARKS, 0.013) | {"strokes painted on": 0.07}  # of others 0.008: how much it varies at most


def said(name, motion):
    """(correlation, pops) that the page has of a tone."""
    cell = pages.table((pages.DOCS / "tones.md").read_text(encoding="utf-8"), 2)[name][motion]
    corr, pops = cell.split(", ")
    return float(corr), float(pops.removesuffix(" %")) / 100


@pytest.mark.timeout(1800)
@pytest.mark.parametrize("motion", sticks.MOTIONS)
def test_tones_stick_as_well_as_the_page_says(motion):
    screens, wrong = {**sticks.SCREENS, **sticks.PICTURES}, {}
    found = sticks.followed_each(screens, sticks.MOTIONS[motion], lambda _: tile(90, 90))
    for name, (corr, pops, ink) in found.items():
        least, most = said(name, motion)
        if corr < least - 0.001 or pops > most * 1.05 + 0.0001:
            wrong[name] = corr, pops, "page"
        asked = ASKED.get(name)
        if asked and (motion != "walk" and corr < dict(zip(sticks.MOTIONS, asked[:3], strict=False))[motion]
                      or pops > asked[3]):
            wrong[name] = corr, pops, "asked"
        if name not in sticks.PICTURES and ink > INK.get(name, 0.008):
            wrong[name, "ink"] = ink
    assert not wrong


@pytest.mark.timeout(1800)
@pytest.mark.parametrize("motion", sticks.MOTIONS)
def test_brush_work_by_example_sticks_as_well_as_the_page_says(motion):
    corr, pops = sticks.painted(sticks.EXAMPLE, sticks.MOTIONS[motion], read_chosen)
    least, most = said("by example", motion)
    assert corr >= least - 0.001 and pops <= most * 1.05 + 0.0001, (corr, pops)
