# SPDX-License-Identifier: GPL-3.0-or-later
"""The lines that detectors draw, judged against contours that are known by formula; the verdict goes to docs/lines.md."""

from pathlib import Path

import numpy as np
import pytest
from encre import core
from judge import scenes, verdict

PAGE = Path(__file__).parents[1] / "docs" / "lines.md"
HEAD = """# How good the lines are

`tests/judge` draws scenes whose contours are known by formula, with a box filter and with Cycles' 1.5-pixel
Blackman-Harris filter, and judges the ink of each detector: is it where the contour is, as wide as asked, even, single,
whole, and nowhere else; does it stand still when the scene moves by an eighth of a pixel, turn when the frame turns, and
stay calm under noise? This page is written by `tests/test_judged.py`. *Worst* is the worst of all drawings.

"""
# Scenes drawn by chance after FINE was tuned: what is known to be missing on them, and how much at most.
FRESH = {"whole outline": 0.99, "whole crease": 0.97, "whole color": 0.85, "whole light": 0.95}


def drawer(detector):
    def draw(layers, camera, **params):
        camera = core.Camera(**camera) if camera else None
        values = {"edge_detector": detector, **params}
        return core.render(layers, values, camera=camera, outputs=["Encre Lines"]).images["Encre Lines"][..., 3]
    return draw


@pytest.fixture(scope="module")
def verdicts():
    """{detector: [(scene, promise, value, kept)]} on the named scenes."""
    named = {name: make() for name, make in scenes.NAMED.items()}
    return {detector: list(verdict.judge(drawer(detector), named, full=True)) for detector in ("DOG", "SOBEL", "FINE")}


def worst(results, promise):
    values = [value for _, what, value, _ in results if what == promise and not np.isnan(value)]
    least, most = verdict.LIMITS[promise]
    if not values:
        return float("nan"), 0, 0
    good = sum(verdict.kept(promise, value) for value in values)
    middle = None if None in (least, most) else (least + most) / 2
    return max(values, key=lambda v: abs(v - middle) if middle else v if least is None else -v), good, len(values)


def test_the_page_shows_all_detectors_side_by_side(verdicts):
    rows = ["| promise | limit | " + " | ".join(f"{d}: worst | kept" for d in verdicts) + " |",
            "|---|---|" + "---|---|" * len(verdicts)]
    for promise, (least, most) in verdict.LIMITS.items():
        limit = f"≤ {most}" if least is None else f"≥ {least}" if most is None else f"{least} to {most}"
        cells = ""
        for results in verdicts.values():
            value, good, count = worst(results, promise)
            cells += f" {value:.4f} | {good} of {count} |"
        rows.append(f"| {promise} | {limit} |{cells}")
    text = HEAD + "\n".join(rows) + "\n"
    if not PAGE.exists() or PAGE.read_text(encoding="utf-8") != text:
        PAGE.write_text(text, encoding="utf-8")
    assert all(worst(results, promise)[2] for results in verdicts.values() for promise in verdict.LIMITS)


@pytest.mark.parametrize("promise", verdict.LIMITS)
def test_fine_keeps_its_promises(verdicts, promise):
    value, good, count = worst(verdicts["FINE"], promise)
    assert good == count, f"{promise}: {value} in the worst of {count}"


@pytest.mark.parametrize("seed", [101, 102])
def test_fine_holds_on_scenes_it_was_not_tuned_on(seed):
    for place, promise, value, kept in verdict.judge(drawer("FINE"), {seed: scenes.draw(seed)}, full=False):
        assert kept or value >= FRESH.get(promise, np.inf), f"{place}: {promise} is {value}"
