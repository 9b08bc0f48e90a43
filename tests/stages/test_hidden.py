# SPDX-License-Identifier: GPL-3.0-or-later
"""Hidden lines: what lies behind, and how much is before it; drawn beside all others, which they leave alone."""

import numpy as np
import pytest
from encre.pen import abi, chains, library
from encre.pen.errors import EncreError
from encre.pen.job import Chains, Frame, Mesh
from known import KIND, drawn, flat, line
from views import perspective

SIZE = 96, 64
QUADS = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]


def box(low, high, number=1, **more):
    corners = np.array([[x, y, z] for x in (low[0], high[0]) for y in (low[1], high[1]) for z in (low[2], high[2])],
                       np.float32)
    faces = np.array([f for a, b, c, d in QUADS for f in ((a, b, c), (a, c, d))], np.int32)
    # the second edge of the first triangle, c to a, and the first of the second lie inside a face
    return Mesh(corners, faces, object_index=number, edges=np.tile(np.array([2 << 4, 2], np.uint8), 6), **more)


def find(meshes, **more):
    """From above."""
    view = np.eye(4)
    view[2, 3] = -10
    return library.chains(meshes, view, perspective(*SIZE), Frame(*SIZE), SIZE, 0.1, 0.0, **more)


def turned():
    a, b = np.radians((30, 40))
    out = np.eye(4)
    out[:3, :3] = np.array([[1, 0, 0], [0, np.cos(a), -np.sin(a)], [0, np.sin(a), np.cos(a)]]) @ np.array(
        [[np.cos(b), 0, np.sin(b)], [0, 1, 0], [-np.sin(b), 0, np.cos(b)]])
    return out


def length(points):
    goes_on = points["run"][1:] == points["run"][:-1]
    return np.hypot(np.diff(points["x"]), np.diff(points["y"]))[goes_on].sum()


HIDDEN = KIND["hidden"]
BOX, PLATE, SHEET = box((-1, -1, -1), (1, 1, 0)), box((-3, -3, 1), (3, 3, 1.1), 2), box((-3, -3, 2), (3, 3, 2.1), 3)


def of_box(points):
    return points[points["mesh"] == 0]


def side(z):
    """Pixels of one of the box's edges at that height, all of which are as long."""
    return 2 / (10 - z) * perspective(*SIZE)[0, 0] * SIZE[0] / 2


def test_nothing_is_told_that_nobody_asks_for():
    seen = find([BOX, PLATE])
    assert not (seen["kind"] & HIDDEN).any() and not len(of_box(seen))
    with_hidden = find([BOX, PLATE], most_before=3)
    assert np.array_equal(with_hidden[(with_hidden["kind"] & HIDDEN) == 0], seen), "what is seen is as before"


def test_what_lies_before_is_counted():
    """Before the upper edges of a box lies a plate; before the lower ones the box itself, too."""
    one, two = (of_box(find([BOX, PLATE], most_before=k)) for k in (1, 2))
    assert (one["kind"] & HIDDEN).all() and set(one["gap"]) == {1} and set(two["gap"]) == {1, 2}
    assert length(one) == pytest.approx(4 * side(0), abs=1)
    assert length(two) > length(one) + 4 * side(-1) - 1
    assert set(of_box(find([BOX, PLATE, SHEET], most_before=2))["gap"]) == {2}
    assert not len(of_box(find([BOX, PLATE, SHEET], most_before=1)))


def test_what_is_seen_and_what_is_hidden_are_the_whole():
    """Of a turned box behind another every edge that is a line is told once: where it is seen, or where it is not."""
    tilted = box((-1, -1, -1), (1, 1, 1), model=turned())
    alone = find([tilted], most_before=5)
    covered = find([tilted, box((0, -3, 2), (3, 3, 2.2), 2)], most_before=5)
    assert length(of_box(covered)) == pytest.approx(length(alone), abs=1.5)
    hidden = of_box(covered)["kind"] & HIDDEN > 0
    assert hidden.any() and not hidden.all()


def test_it_is_the_same_on_any_number_of_threads_and_in_files():
    meshes = [box((-1, -1, -1), (1, 1, 1), model=turned()), PLATE]
    one, four = (find(meshes, most_before=4, threads=k) for k in (1, 4))
    assert one.tobytes() == four.tobytes()
    kept = chains.told(one, np.arange(3, dtype=np.float32), np.ones(3, bool))
    back = chains.unpack(chains.pack(kept)).points
    assert np.array_equal(back, kept.points) and (back["gap"][back["kind"] & HIDDEN > 0] >= 1).all()


@pytest.mark.parametrize("most", [-1, 1001])
def test_counts_out_of_range_are_refused(most):
    with pytest.raises(EncreError, match="chains: most_before is .*; give 0 to 1000"):
        find([BOX], most_before=most)


ACROSS = line([(10, 30), (80, 30)], "crease hidden", gap=1)
LOOKED = dict(line_hidden_strength=1.0, line_hidden_width=1.0)


def test_it_is_drawn_where_it_is_asked_for():
    off, on = drawn(flat(), ACROSS), drawn(flat(), ACROSS, **LOOKED)
    assert not off.any() and on[30, 12:78].min() > 0.9 and not on[[24, 36]].any()
    assert not drawn(flat(), line([(10, 30), (80, 30)], "crease hidden", gap=2), **LOOKED).any(), "two in front"
    assert drawn(flat(), line([(10, 30), (80, 30)], "crease hidden", gap=2), hidden_most=2, **LOOKED)[30, 40] > 0.9
    assert not drawn(flat(), line([(10, 30), (80, 30)], "crease hidden", gap=1, bend=20), **LOOKED).any(), "it is flat"
    half = drawn(flat(), ACROSS, line_hidden_strength=1.0, line_hidden_width=0.5)
    assert half.sum() == pytest.approx(on.sum() / 2, rel=0.1)


def test_other_lines_are_as_without_it():
    """One that runs a pixel beside it, one that crosses, and one in the layers."""
    layers = flat()
    layers["object"][:, 50:], layers["depth"][:, 50:] = 2, 4.0
    others = [line([(10, 31.2), (45, 31.2)], "crease", run=0), line([(20, 10), (20, 50)], "crease", run=1)]
    hidden = line([(10, 30), (80, 30)], "crease hidden", run=2, gap=1)
    plain = drawn(layers, others, (1, 1, 0, 0), **LOOKED)
    both = drawn(layers, [*others, hidden], (1, 1, 0, 0), **LOOKED)
    beside = np.ones(plain.shape, bool)
    beside[28:33, 7:84] = False
    assert np.array_equal(plain[beside], both[beside]) and (both >= plain - 1e-6).all() and both[30, 70] > 0.9


def test_strokes_tell_of_it():
    layers, kinds = flat(), list(library.load().lines)
    every = library.complete(library.check(dict(LOOKED, edge_detector="FINE", line_thickness=8.0)))
    found = library.strokes({**layers, "chains": Chains(ACROSS, np.ones(4, np.uint8))}, every)
    assert len(found) and set(found["kind"]) == {kinds.index("hidden")}
    assert found["x"].min() == pytest.approx(10, abs=1) and found["x"].max() == pytest.approx(80, abs=1)
    assert found.dtype == abi.STROKE_POINT
