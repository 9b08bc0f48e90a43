# SPDX-License-Identifier: GPL-3.0-or-later
"""Chains of mesh edges: where they lie and what can be seen of them against formulas, and against themselves cut up in
other ways."""

import numpy as np
import pytest
from encre.pen import abi, chains, library
from encre.pen.errors import Cancelled, EncreError
from encre.pen.job import Frame, Mesh
from views import orthographic, perspective, soup

SIZE = 96, 64
KIND = {name: 1 << k for k, name in enumerate(abi.CHAIN_KINDS)}
END = {name: k for k, name in enumerate(abi.CHAIN_ENDS)}
QUADS = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]


def box(low, high, number=1, **more):
    corners = np.array([[x, y, z] for x in (low[0], high[0]) for y in (low[1], high[1]) for z in (low[2], high[2])],
                       np.float32)
    faces = np.array([f for a, b, c, d in QUADS for f in ((a, b, c), (a, c, d))], np.int32)
    # the second edge of the first triangle, c to a, and the first of the second lie inside a face
    edges = np.tile(np.array([2 << 4, 2], np.uint8), 6)
    return Mesh(corners, faces, object_index=number, edges=edges, **more)


def from_above(height=10.0):
    view = np.eye(4)
    view[2, 3] = -height
    return view


def find(meshes, view, projection=None, frame=None, size=SIZE, clip=(0.1, 0.0), **more):
    projection = perspective(*SIZE) if projection is None else projection
    return library.chains(meshes, view, projection, frame or Frame(*SIZE), size, *clip, **more)


def segments(points):
    """(first, last) points of each part of a run."""
    goes_on = points["run"][1:] == points["run"][:-1]
    return points[:-1][goes_on], points[1:][goes_on]


def length(points, kind=None):
    one, other = segments(points)
    along = np.hypot(other["x"] - one["x"], other["y"] - one["y"])
    return along[(other["kind"] & KIND[kind]) > 0].sum() if kind else along.sum()


def pixel(place, view, projection):
    clip = projection @ view @ np.append(place, 1)
    return ((clip[0] / clip[3] + 1) * SIZE[0] - 1) / 2, ((1 - clip[1] / clip[3]) * SIZE[1] - 1) / 2


def turned(x, y):
    """A rotation about X after one about Y, degrees."""
    a, b = np.radians((x, y))
    about_x = np.array([[1, 0, 0], [0, np.cos(a), -np.sin(a)], [0, np.sin(a), np.cos(a)]])
    about_y = np.array([[np.cos(b), 0, np.sin(b)], [0, 1, 0], [-np.sin(b), 0, np.cos(b)]])
    out = np.eye(4)
    out[:3, :3] = about_x @ about_y
    return out


@pytest.mark.parametrize("projection", [perspective(*SIZE), orthographic(*SIZE)])
def test_a_box_shows_nine_edges_where_they_are(projection):
    view = from_above() @ turned(30, 40)
    points = find([box((-1, -1, -1), (1, 1, 1))], view, projection)
    one, other = segments(points)
    assert len(one) == 9 and {*other["object"]} == {1}
    assert (other["kind"] & KIND["contour"] > 0).sum() == 6
    np.testing.assert_allclose(other["bend"], 90, atol=0.01)
    corners = [pixel(c, view, projection) for c in box((-1, -1, -1), (1, 1, 1)).points]
    for points_ in one, other:
        apart = [min(np.hypot(p["x"] - x, p["y"] - y) for x, y in corners) for p in points_]
        assert max(apart) < 1e-3
    contours = other[other["kind"] & KIND["contour"] > 0]
    assert (contours["behind"] == 0).all() and (contours["gap"] == np.float32(1e9)).all()
    assert (contours["side"] != 0).all() and {*points["end"]} <= {END[n] for n in ("none", "node", "loop")}


def test_what_is_hidden_ends_at_what_hides_it():
    line = Mesh(np.float32([[-3, 0, 0], [3, 0, 0]]), np.int32([[0, 1]]), kind="lines", object_index=7)
    view, projection = from_above(), perspective(*SIZE)
    points = find([box((-0.5, -1, 1), (0.5, 1, 2)), line], view, projection)
    marks = points[points["kind"] & KIND["mark"] > 0]
    left, right = (pixel((x, 0, 2), view, projection)[0] for x in (-0.5, 0.5))
    assert len({*marks["run"]}) == 2 and (marks["object"] == 7).all()
    np.testing.assert_allclose(sorted(marks["x"])[1:3], [left, right], atol=0.05)
    assert sorted(marks["end"])[-2:] == [END["hidden"]] * 2 or (marks["end"] == END["hidden"]).sum() == 2


@pytest.mark.parametrize("angle", [4.5, 5.5, 30.0, 120.0])
def test_a_fold_bends_by_its_angle(angle):
    half = np.radians(angle) / 2
    points = np.float32([[0, -1, 0], [0, 1, 0], [-np.cos(half), -1, -np.sin(half)], [-np.cos(half), 1, -np.sin(half)],
                         [np.cos(half), -1, -np.sin(half)], [np.cos(half), 1, -np.sin(half)]])
    faces = np.int32([[0, 1, 3], [0, 3, 2], [1, 0, 4], [1, 4, 5]])
    found = find([Mesh(points, faces, object_index=1)], from_above(6))
    creases = found[found["kind"] & KIND["crease"] > 0]
    assert bool(len(creases)) == (angle > 5)
    np.testing.assert_allclose(creases["bend"], angle, atol=0.01)


def test_boxes_that_pass_through_each_other_meet():
    view, projection = from_above(), perspective(*SIZE)
    one, other = box((-2, -2, -1), (2, 2, 0)), box((-1, -1, -0.5), (1, 1, 0.5), 2)
    found = find([one, other], view, projection)
    meets = found[found["kind"] & KIND["meet"] > 0]
    expected = np.abs(np.array([pixel((x, y, 0), view, projection) for x in (-1, 1) for y in (-1, 1)]))
    assert length(found, "meet") == 0 or (meets["kind"] & KIND["other"] > 0).all()
    # seen from straight above, the upper rim hides where they meet; from aside it shows on two sides
    aside = from_above(8) @ turned(-50, 0)
    found = find([one, other], aside, projection)
    meets = found[found["kind"] & KIND["meet"] > 0]
    ends = [pixel((x, -1, 0), aside, projection) for x in (-1, 1)]
    assert len(meets) and (meets["kind"] & KIND["other"] > 0).all() and len(expected) == 4
    for x, y in ends:
        assert np.hypot(meets["x"] - x, meets["y"] - y).min() < 0.05


def test_what_lies_flush_is_told_apart():
    # Two boxes side by side, of one object: no line by itself; of two objects of two materials: one.
    pair = [box((-1, -1, -1), (0, 1, 0)), box((0, -1, -1), (1, 1, 0))]

    def middle():
        one, other = segments(find(pair, from_above()))
        return other[(np.abs(one["x"] - 47.5) < 0.01) & (np.abs(other["x"] - 47.5) < 0.01)]

    found = middle()
    assert len(found) and (found["kind"] & KIND["flush"] > 0).all() and not found["bend"].any()
    pair[1].object_index = 2  # objects that touch in one plane and have one material, too
    assert (middle()["kind"] & KIND["flush"] > 0).all()
    pair[1].material_index = 3
    assert (middle()["kind"] & KIND["flush"] == 0).any()


def test_what_touches_an_edge_at_one_place_is_no_step_along_all_of_it():
    ridge = np.array([(x, y, -abs(x) / 5) for y in (-3, 3) for x in (-1, 0, 1)], np.float32)
    roof = Mesh(ridge, np.array([(0, 1, 4), (0, 4, 3), (1, 2, 5), (1, 5, 4)], np.int32), object_index=1)
    for side in (1, -1):  # seen from both ends of the edge it ends what is seen
        touching = box((0, min(side, 1.2 * side), -1), (0.4, max(side, 1.2 * side), 0), 2)
        hiding = box((-0.4, min(1.2 * side, 1.6 * side), -1), (0.4, max(1.2 * side, 1.6 * side), 0.5), 3)
        one, other = segments(find([roof, touching, hiding], from_above()))
        long_ = (other["object"] == 1) & (other["kind"] == KIND["crease"]) & (np.abs(one["y"] - other["y"]) > 3)
        assert long_.sum() >= 2 and (other["bend"][long_] < 30).all()


def scene(seed=3):
    rng = np.random.default_rng(seed)
    meshes = [soup(rng, 40, object_index=1), box((-1, -1, -1), (1, 1, 1), 2), box((-0.5, -2, 0), (0.5, 2, 0.3), 3)]
    for k, mesh in enumerate(meshes[1:]):
        mesh.model = turned(20 + 30 * k, 50)
        mesh.model[2, 3] = -4 + k
    return meshes


@pytest.mark.parametrize("projection", [perspective(*SIZE), orthographic(*SIZE)])
def test_the_same_on_any_number_of_threads_and_by_any_instructions(projection):
    found = [find(scene(), np.eye(4), projection, threads=threads, simd=simd)
             for threads, simd in ((1, 1), (3, 1), (8, 1), (2, 0))]
    assert len(found[0]) > 50
    assert all(one.tobytes() == found[0].tobytes() for one in found)


def inside(points, x, y, width, height):
    """What all parts of runs that lie in a border are."""
    one, other = segments(points)
    low = np.minimum(one["x"], other["x"]) >= x, np.minimum(one["y"], other["y"]) >= y
    high = np.maximum(one["x"], other["x"]) < x + width, np.maximum(one["y"], other["y"]) < y + height
    kept = np.all([*low, *high], axis=0)
    names = ("kind", "object", "behind", "gap", "bend")
    ends = np.sort(np.stack([one[kept][["x", "y"]], other[kept][["x", "y"]]], 1), axis=1)
    return {(ends[i].tobytes(), *(other[kept][name][i] for name in names)) for i in range(kept.sum())}


def test_a_border_has_the_points_of_the_whole():
    border = 20, 10, 40, 30
    meshes = scene()
    whole, part = find(meshes, np.eye(4)), find(meshes, np.eye(4), None, Frame(*SIZE, *border[:2]), border[2:])
    assert len(inside(whole, *border)) > 20 and inside(whole, *border) == inside(part, *border)


def test_a_long_edge_that_leaves_its_ground_has_the_points_of_the_whole_in_a_border():
    size, border = (960, 320), (300, 0, 400, 320)
    slope = np.eye(4)
    slope[2, 0], slope[2, 3] = 0.004, 0.016
    meshes = [box((-8, -8, -0.1), (8, 8, 0)), box((-14, -0.6, 0), (14, 0.6, 0.002), 2, model=slope)]
    projection = perspective(*size)
    whole = find(meshes, from_above(4), projection, Frame(*size), size)
    part = find(meshes, from_above(4), projection, Frame(*size, *border[:2]), border[2:])
    found = inside(whole, *border)
    assert len(found) > 10 and len({each[4] for each in found}) > 3  # `gap` grows along it
    assert found == inside(part, *border)


def test_a_thin_thing_before_a_rail_parts_it_in_a_border_as_in_the_whole():
    """How wide it is on the screen was told by the mean of as much of the rail as lay in the frame."""
    size, border = (960, 600), (60, 330, 200, 200)
    rail = box((-1.25, -1.25, -40), (-1.2, -1.2, -2), 1)
    pixel = 2 / perspective(*size)[0, 0] / size[0]  # at depth 1
    posts = []
    for k, z in enumerate(np.geomspace(2.5, 9, 40)):
        x, wide = -1.225 * 0.95, 0.95 * z * pixel * (0.5 + 0.1 * (k % 12))
        posts.append(box((x - wide / 2, -1.6, -0.95 * z - 0.001), (x + wide / 2, -0.9, -0.95 * z), 2 + k))
    meshes, projection = [rail, *posts], perspective(*size)
    whole = find(meshes, np.eye(4), projection, Frame(*size), size)
    part = find(meshes, np.eye(4), projection, Frame(*size, *border[:2]), border[2:])
    assert len(inside(whole, *border)) > 20 and inside(whole, *border) == inside(part, *border)
    assert ways(whole, *border) == ways(part, *border)


def test_what_an_outline_bounds_lies_to_its_right():
    """Else a part of a frame has its runs the other way, and stations elsewhere."""
    for seed in range(4):
        turn = np.arange(7 + seed) * 2 * np.pi / (7 + seed) + seed
        ring = np.stack([np.cos(turn), np.sin(turn), -6 + 0 * turn], 1)
        points = np.float32([*ring, (0, 0, -5)])
        faces = [(k, (k + 1) % len(ring), len(ring)) for k in np.random.default_rng(seed).permutation(len(ring))]
        for whole in (faces, faces[1:]):
            sides = find([Mesh(points, np.int32(whole))], np.eye(4))["side"]
            assert (sides[sides != 0] > 0).mean() == 1 and sides.any()


def ways(points, x, y, width, height):
    """Runs about a border by what lies well inside it, in the order in which they go along it."""
    runs = {}
    for one, other in zip(*segments(points), strict=True):
        middle = (one["x"] + other["x"]) / 2, (one["y"] + other["y"]) / 2
        if x + 2 < middle[0] < x + width - 2 and y + 2 < middle[1] < y + height - 2:
            runs.setdefault(one["run"], []).append((other["mesh"], other["edge"], one["x"], one["y"]))
    return {tuple(each) for each in runs.values()}


def lies_at(points, depth):
    one, other = segments(points)
    return (np.abs(one["depth"] - depth) < 1e-4) & (np.abs(other["depth"] - depth) < 1e-4)


@pytest.mark.parametrize("frame, size", [(None, SIZE), (Frame(*SIZE, 20, 10), (50, 40))])
def test_a_surface_ends_where_a_clip_plane_cuts_it(frame, size):
    """Nothing was drawn there: a ball that was cut had no outline at all."""
    near, far = 8.0, 11.0
    meshes = [box((-2, -1, -3), (2, 1, 5)), box((-30, -0.1, -40), (30, 0, 40), 2, model=turned(-60, 0))]
    cut = find(meshes, from_above(10), None, frame, size, clip=(near, far))
    one, other = segments(cut)
    pixel = 2 / perspective(*SIZE)[0, 0] / SIZE[0]
    for depth, number in ((near, 1), (far, 2)):
        here = lies_at(cut, depth) & (other["object"] == number)
        assert (other["kind"][here] & KIND["border"]).all() and (other["side"][here] > 0).all()
        if frame is None and number == 1:  # all round the box, as far as nothing lies before it
            long = np.hypot(other["x"] - one["x"], other["y"] - one["y"])[here].sum()
            assert long == pytest.approx(2 * (4 + 2) / (near * pixel), rel=0.01)
        assert here.any()
    assert lies_at(find(meshes, from_above(10), clip=(0.1, 0.0)), near).sum() == 0


def test_a_cut_has_the_points_of_the_whole_in_a_border_and_goes_on_round():
    border = 20, 10, 40, 30
    ring = np.linspace(0, 2 * np.pi, 24, endpoint=False)
    tube = np.float32([(np.cos(a) * r, np.sin(a) * r, z) for z, r in ((-1, 2.0), (4, 1.0)) for a in ring])
    k = np.arange(24)
    faces = np.concatenate([np.c_[k, (k + 1) % 24, k + 24], np.c_[(k + 1) % 24, (k + 1) % 24 + 24, k + 24]])
    mesh = Mesh(tube, np.int32(faces), object_index=1)
    whole = find([mesh], from_above(10), clip=(8.0, 0.0))
    part = find([mesh], from_above(10), None, Frame(*SIZE, *border[:2]), border[2:], clip=(8.0, 0.0))
    assert inside(whole, *border) == inside(part, *border)
    cut = lies_at(whole, 8.0)
    assert len(set(segments(whole)[1]["run"][cut])) == 1, "one run goes round"


def test_what_is_kept_is_as_what_is_found_anew():
    moved, still = scene(), scene()
    for step in range(3):
        moved[1].model[0, 3] = 0.2 * step
        if step == 2:
            moved[2].points = moved[2].points * np.float32(1.1)
        again = find(moved, np.eye(4), threads=1)
        library.load().forget()
        assert again.tobytes() == find(moved, np.eye(4), threads=1).tobytes()
    assert again.tobytes() != find(still, np.eye(4)).tobytes()


@pytest.mark.parametrize("spoil", [
    lambda m: m.points.__setitem__((0, 0), np.nan), lambda m: m.points.__setitem__((1, 1), np.inf),
    lambda m: m.points.__imul__(np.float32(1e30)), lambda m: m.model.__setitem__(np.s_[:3, :3], 0),
    lambda m: m.model.__setitem__((0, 3), 1e300), lambda m: m.points.__setitem__(np.s_[:], 0)])
def test_meshes_that_are_none_spoil_nothing(spoil):
    meshes = scene()
    meshes[1].points, meshes[1].model = meshes[1].points.copy(), np.array(meshes[1].model)
    spoil(meshes[1])
    found = find(meshes, np.eye(4))
    assert all(np.isfinite(found[name]).all() for name in found.dtype.names)
    assert (found["object"] == 3).any()


def test_nothing_has_no_lines():
    empty = Mesh(np.zeros((0, 3), np.float32), np.zeros((0, 3), np.int32))
    assert len(find([], np.eye(4))) == len(find([empty], np.eye(4))) == 0
    assert len(find([box((-1, -1, 5), (1, 1, 6))], np.eye(4))) == 0  # behind the eye


def test_refused_and_cancelled():
    with pytest.raises(EncreError, match="least_bend"):
        find(scene(), np.eye(4), least_bend=200)
    with pytest.raises(EncreError, match="corner at point"):
        find([Mesh(np.zeros((3, 3), np.float32), np.int32([[0, 1, 7]]))], np.eye(4))
    with pytest.raises(Cancelled):
        find(scene(), np.eye(4), progress=lambda _fraction: False)
    assert len(find(scene(), np.eye(4)))


def test_files_keep_them():
    points = find(scene(), np.eye(4))
    whole = np.array([True, True, False, True])
    told = chains.told(points, np.array([0, 5, 6, 9], np.float32), whole)
    assert {*told.points["object"]} <= {0, 5, 9} and list(np.flatnonzero(told.chained)) == [0, 5, 9]
    again = chains.unpack(chains.pack(told))
    assert again.points.tobytes() == told.points.tobytes() and (again.chained == told.chained).all()
    kept = points[points["object"] != 2]
    np.testing.assert_allclose(told.points["x"], kept["x"], atol=1 / 500)
    with pytest.raises(ValueError):
        chains.unpack("no such text")
