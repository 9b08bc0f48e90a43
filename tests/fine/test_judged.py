# SPDX-License-Identifier: GPL-3.0-or-later
"""The lines that detectors draw, judged against contours known by formula; the verdict goes to docs/lines.md."""

from pathlib import Path

import pytest
from encre.pen import library
from encre.pen.job import Camera
from judge import scenes, verdict

PAGE = Path(__file__).parents[2] / "docs" / "lines.md"
HEAD = """# How good the lines are

`tests/judge` draws scenes whose contours are known by formula, with a box filter and with Cycles' 1.5-pixel
Blackman-Harris filter, and judges the ink of each detector: is it where the contour is, as wide as asked, even, single,
whole, and nowhere else; does it stand still when the scene moves by an eighth of a pixel, turn when the frame turns,
and stay calm under noise? `tests/fine/test_judged.py` writes this page. A number is the worst of all
drawings, and of what must be inked the share of all contours; what breaks a promise is bold.

"""


def drawer(detector):
    def draw(layers, camera, **params):
        values = {"edge_detector": detector, **params}
        return library.render(layers, values, camera=Camera(**camera), outputs=["Encre Lines"]).images[
            "Encre Lines"][..., 3]
    return draw


@pytest.fixture(scope="module")
def verdicts():
    """{detector: [Result]} on the named scenes."""
    named = {name: make() for name, make in scenes.NAMED.items()}
    return {detector: list(verdict.judge(drawer(detector), named)) for detector in ("DOG", "SOBEL", "FINE")}


def test_the_page_shows_all_detectors_side_by_side(verdicts):
    text = HEAD + verdict.table(verdicts)
    if not PAGE.exists() or PAGE.read_text(encoding="utf-8") != text:
        PAGE.write_text(text, encoding="utf-8")
    assert all(detector in text for detector in verdicts)


def test_fine_keeps_its_promises(verdicts):
    assert verdict.broken(verdicts["FINE"]) == {}


def test_fine_keeps_them_on_scenes_that_it_was_not_tuned_on():
    fresh = {seed: scenes.draw(seed) for seed in range(2000, 2006)}
    assert verdict.broken(verdict.judge(drawer("FINE"), fresh, full=False)) == {}
