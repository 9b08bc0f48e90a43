# SPDX-License-Identifier: GPL-3.0-or-later
"""Strokes out of the library: where the ink is, as wide, of which thing, in which order."""

import drawn
import numpy as np
import pytest
from encre.pen import abi, library
from encre.pen.errors import EncreError
from encre.pen.job import Chains, Frame
from known import END, FAR, LOOK, flat, line

KINDS = list(library.load().lines)


def told(layers, threads=1, chains=None, frame=None, styles=(), **values):
    """(the lines that are drawn (height, width, 4), strokes: an array each)."""
    every = library.complete(library.check(LOOK | values), styles)
    made = library.draw(layers, every, frame=frame, outputs=["Encre Lines"], threads=threads, chains=chains,
                        strokes=True)
    cuts = np.flatnonzero(np.diff(made.strokes["stroke"])) + 1
    return made.images["Encre Lines"], np.split(made.strokes, cuts) if len(made.strokes) else []


def reached(strokes, size, more=0.0):
    """Where (rows, columns) a pixel's centre lies within the strokes, grown by so many pixels."""
    y, x = np.mgrid[:size[0], :size[1]]
    where = np.zeros(size, bool)
    for stroke in strokes:
        for a, b in zip(stroke, stroke[1:] if len(stroke) > 1 else stroke, strict=False):
            dx, dy = b["x"] - a["x"], b["y"] - a["y"]
            t = np.clip(((x - a["x"]) * dx + (y - a["y"]) * dy) / max(dx * dx + dy * dy, 1e-9), 0, 1)
            far = np.hypot(x - a["x"] - t * dx, y - a["y"] - t * dy)
            where |= far <= np.maximum((a["width"] + t * (b["width"] - a["width"])) / 2, 0.5) + more
    return where


@pytest.mark.parametrize("values", [dict(line_thickness=4.0), dict(line_thickness=1.5),
                                    dict(line_thickness=3.0, pen_1_wobble=3.0, pen_1_strokes=2, pen_1_dash=12.0),
                                    dict(line_thickness=3.0, pen_1_overshoot=20.0, pen_1_taper=10.0)])
def test_ink_has_strokes_and_strokes_have_ink(values):
    layers = drawn.scene(160, 90, n=12)
    ink, strokes = told(layers, line_color_strength=1.0, **values)
    assert len(strokes) > 20
    dark = ink[..., 3]
    assert not (dark[~reached(strokes, dark.shape, 1.0)] > 0.02).any()
    near = np.pad(dark, 1)
    near = np.max([near[y:y + 90, x:x + 160] for y in range(3) for x in range(3)], 0)
    inside = reached([stroke for stroke in strokes if stroke["width"].max() > 0.5], dark.shape, -0.5)
    assert (near[inside] > 0.02).mean() > 0.998


def test_a_line_of_a_mesh():
    """Of its edges, its object and its width, and what lies before its ends."""
    layers = flat()
    layers["object"][20:40, 60:], layers["depth"][20:40, 60:] = 2, 3.0
    at = line([(10, 30), (40, 30), (59.5, 30)], "crease", gap=0, mesh=7)
    at["end"][0], at["end"][-1] = END["none"], END["hidden"]
    ink, strokes = told(layers, chains=Chains(at, np.ones(4, np.uint8)))
    (stroke,) = [one for one in strokes if one["kind"][0] == KINDS.index("crease")]
    assert set(stroke["object"]) == {1} and set(stroke["mesh"]) == {7} and set(stroke["edge"]) == {0, 1}
    inner = stroke[2:-2]
    assert np.allclose(inner["y"], 30, atol=0.01) and np.allclose(inner["width"], 2, atol=0.3)
    ends = stroke[[0, -1]] if stroke["x"][0] < stroke["x"][-1] else stroke[[-1, 0]]
    assert ends["x"][0] == pytest.approx(10, abs=1) and ends["x"][1] == pytest.approx(59.5, abs=1)
    assert ends["end"].tolist() == [END["none"], END["hidden"]] and ends["hider"].tolist() == [0, 2]
    assert not stroke["end"][1:-1].any() and np.allclose(stroke["ink"], (0, 0, 0, 1)) and ink[30, 20, 3] > 0.9


def test_dashes_are_strokes_of_their_own():
    layers, at = flat(), line([(5, 30), (90, 30)], "crease", gap=0)
    _, whole = told(layers, chains=Chains(at, np.ones(4, np.uint8)))
    _, dashed = told(layers, chains=Chains(at, np.ones(4, np.uint8)), pen_1_dash=8.0, pen_1_dash_space=6.0)
    assert len(whole) == 1 and 4 <= len(dashed) <= 9
    gaps = sorted((one["x"].min(), one["x"].max()) for one in dashed)
    assert all(b[0] - a[1] > 2 for a, b in zip(gaps, gaps[1:], strict=False))


def test_strokes_go_on_beyond_corners():
    """Of a closed square there is one stroke, of one with overshoot four, each longer than its side."""
    corners = [(40, 12), (76, 12), (76, 42), (40, 42), (40, 12)]
    at = line(corners, "border", gap=FAR)
    at["end"][[0, -1]] = END["loop"]
    chains = Chains(at, np.ones(4, np.uint8))
    _, (one,) = told(flat(), chains=chains)
    assert one["end"][[0, -1]].tolist() == [END["loop"]] * 2
    assert one[["x", "y"]][0] == one[["x", "y"]][-1]
    ink, four = told(flat(), chains=chains, pen_1_overshoot=5.0)
    assert len(four) == 4
    longer = np.sort([max(np.ptp(stroke["x"]), np.ptp(stroke["y"])) for stroke in four]) - (30, 30, 36, 36)
    assert (longer > 3).all() and (longer < 20).all()
    assert all(set(stroke["end"][[0, -1]]) == {END["node"]} for stroke in four)
    assert max(ink[12, 79, 3], ink[9, 76, 3]) > 0.2


def test_wider_strokes_lie_over_thinner_ones():
    layers = drawn.scene(160, 90, n=20)
    values = dict(line_thickness=3.0, line_color_strength=1.0, ink_by_kind=True, line_outline_ink=(1.0, 0, 0),
                  line_color_ink=(0, 0, 1.0), line_inner_ink=(0, 1.0, 0), line_color_width=0.3)
    ink, strokes = told(layers, **values)
    widths = [stroke["width"].mean() for stroke in strokes]
    assert all(a <= b + 1e-4 for a, b in zip(widths, widths[1:], strict=False))
    shown = np.zeros((90, 160, 3))
    for stroke in strokes:
        shown[reached([stroke], shown.shape[:2], -0.25)] = stroke["ink"][len(stroke) // 2, :3]
    dark = (ink[..., 3] > 0.6) & shown.any(2)
    same = np.abs(shown - ink[..., :3] / np.maximum(ink[..., 3:], 1e-6)).max(2) < 0.1
    assert dark.sum() > 500 and same[dark].mean() > 0.92


def test_kinds_and_objects_are_whole():
    """A stroke has one of each, and none is a scrap."""
    _, strokes = told(drawn.scene(160, 90, n=20), line_color_strength=2.0, contrast_threshold=0.05, line_thickness=2.0)
    for stroke in strokes:
        assert len(set(stroke["kind"])) == len(set(stroke["object"])) == 1 and len(set(stroke["pass"])) == 1
    assert {KINDS[stroke["kind"][0]] for stroke in strokes} >= {"outline", "color"}


def test_the_same_on_any_number_of_threads_and_beside_the_same_picture():
    layers = drawn.scene(96, 64, n=12)
    values = dict(line_color_strength=1.0, pen_1_overshoot=9.0, pen_1_wobble=2.0)
    one, three = (told(layers, threads, **values) for threads in (1, 3))
    assert all(a.tobytes() == b.tobytes() for a, b in zip(one[1], three[1], strict=True))
    alone = library.strokes(layers, library.complete(library.check(LOOK | values)))
    assert alone.tobytes() == np.concatenate(one[1]).tobytes(), "without any picture"
    plain = library.render(layers, LOOK | values, outputs=["Encre Lines"]).images["Encre Lines"]
    assert plain.tobytes() == one[0].tobytes() == three[0].tobytes()


def test_places_are_of_the_full_frame():
    layers = drawn.scene(96, 64, n=12)
    _, here = told(layers)
    _, there = told(layers, frame=Frame(200, 64, 40, 0))
    found = [np.concatenate(strokes) for strokes in (here, there)]
    assert np.allclose(found[1]["x"] - found[0]["x"], 40) and np.array_equal(found[0]["y"], found[1]["y"])


def test_without_lines_and_without_fine():
    layers = drawn.scene(48, 32, n=3)
    assert not told(layers, use_lines=False)[1] and not told(layers, line_thickness=0.0)[1]
    with pytest.raises(EncreError, match="edge_detector: only FINE has strokes; choose it, or ask for none"):
        told(layers, edge_detector="DOG")
    assert library.draw(layers, library.complete({})).strokes is None
    assert library.strokes(layers, library.complete(library.check(LOOK))).dtype == abi.STROKE_POINT
