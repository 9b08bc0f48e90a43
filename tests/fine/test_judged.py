# SPDX-License-Identifier: GPL-3.0-or-later
"""The lines that detectors draw, judged against contours known by formula, and what docs/lines.md says of them."""

import pages
import pytest
from judge import fresh, kinds, measure, scenes, unseen, verdict


@pytest.fixture(scope="module")
def fine():
    """The Results of FINE on the named scenes."""
    return pages.judged("FINE")


def agrees(results, detector, number=0):
    """Whether the page's table says what was found, to a unit of its last but one digit: other machines round
    otherwise."""
    said = pages.table((pages.DOCS / "lines.md").read_text(encoding="utf-8"), number)
    found = {promise: value for promise, (value, _) in verdict.summary(results).items()}
    assert said.keys() == found.keys()
    assert {promise: float(row[detector]) for promise, row in said.items()} == pytest.approx(found, rel=0, abs=1e-3)


@pytest.mark.parametrize("name", ["sphere", "parallel", "patches"])
def test_fine_keeps_its_promises_on(name):
    """By one filter of the two; on the other scenes below."""
    found = verdict.judge(pages.drawer("FINE"), {name: scenes.NAMED[name]()}, ("blackman",), moves=name == "sphere")
    assert verdict.broken(found) == {}


@pytest.mark.slow
def test_fine_keeps_its_promises(fine):
    assert verdict.broken(fine) == {}


@pytest.mark.slow
def test_the_page_tells_of_fine(fine):
    agrees(fine, "FINE")


@pytest.mark.long
@pytest.mark.parametrize("detector", ["DOG", "SOBEL"])
def test_the_page_tells_of_the_others(detector):
    agrees(pages.judged(detector), detector)


@pytest.mark.parametrize("first, count", [pytest.param(2000, 1, marks=pytest.mark.slow),
                                          pytest.param(2001, 5, marks=pytest.mark.long)])
def test_fine_keeps_them_on_scenes_that_it_was_not_tuned_on(first, count):
    fresh = {seed: scenes.draw(seed) for seed in range(first, first + count)}
    assert verdict.broken(verdict.judge(pages.drawer("FINE"), fresh, full=False)) == {}


SHORT = {"facets", "through", "collars", "discs", "spots", "umbrella", "dice"}  # seconds each


def breaks_no_more(name, number):
    """Whether FINE breaks no promise on a scene but what the page says in its table of that number."""
    text = (pages.DOCS / "lines.md").read_text(encoding="utf-8")
    said = pages.table(text, number)[name]["breaks"]
    found = pages.judged_kinds("FINE", (name,), (0,) if name in SHORT else None, full=name not in SHORT)
    assert {promise for promise in verdict.broken(found) if promise not in said} == set()


def quick_ones(names):
    """Those of SHORT, and the others for the long run."""
    return pytest.mark.parametrize("name", [
        pytest.param(name, marks=pytest.mark.slow if name in SHORT else pytest.mark.long) for name in names])


@quick_ones((*kinds.ANALYTIC, *kinds.MESHES))
def test_fine_breaks_no_more_on_scenes_of_other_kinds_than_the_page_says(name):
    breaks_no_more(name, 2)


@quick_ones((*unseen.ANALYTIC, *unseen.MESHES))
def test_fine_breaks_no_more_on_unseen_scenes_than_the_page_says(name):
    breaks_no_more(name, 4)


@pytest.mark.parametrize("name", [pytest.param(name, marks=pytest.mark.slow if name == "curtain" else pytest.mark.long)
                                  for name in fresh.MESHES])
def test_fine_breaks_no_more_on_fresh_scenes_than_the_page_says(name):
    text = (pages.DOCS / "lines.md").read_text(encoding="utf-8")
    said = pages.table(text[text.index(pages.FRESH):], 1)[name]["breaks"]
    found = verdict.broken(pages.judged_fresh((name,)))
    assert {promise for promise in found if promise not in said} == set()


@pytest.mark.long
@pytest.mark.parametrize("detector", pages.DETECTORS)
def test_the_page_tells_of_unseen_scenes(detector):
    agrees(pages.judged_kinds(detector, tuple(pages.UNSEEN)), detector, 3)


@pytest.mark.long
def test_no_rungs_join_the_folds_of_a_cloth():
    """Of its edges all but one of a fold may be left out, so that no promise of whole lines sees knots and ladders."""
    cloth = kinds.MESHES["cloth"]()
    t = pages.drawer("FINE")(cloth.layers("centre"), cloth.camera_settings, **verdict.PARAMS)
    assert measure.steady(t, cloth.truth) > 0.98
