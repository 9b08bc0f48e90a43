# SPDX-License-Identifier: GPL-3.0-or-later
"""Lines where pieces pass through each other: the rasteriser finds them by the surfaces themselves. Against the slow
reference with soups of triangles in test_creases."""

import numpy as np
import pytest
from encre.pen import library
from encre.pen.job import Frame, Mesh
from views import joined, orthographic, perspective, pixels

SIZE = 96, 72
THROUGH = 180


def box(at, size):
    points = np.array([(x, y, z) for z in (-1, 1) for y in (-1, 1) for x in (-1, 1)]) * np.array(size) / 2 + at
    faces = [(0, 2, 3, 1), (4, 5, 7, 6), (0, 1, 5, 4), (2, 6, 7, 3), (0, 4, 6, 2), (1, 3, 7, 5)]
    return Mesh(points.astype(np.float32), np.int32([(f[0], f[k], f[k + 1]) for f in faces for k in (1, 2)]))


def ball(n, at=(0, 0, 0), radius=1.0):
    around, up = np.meshgrid(np.arange(n) * 2 * np.pi / n, np.linspace(0.01, np.pi - 0.01, n // 2))
    points = np.stack([np.cos(around) * np.sin(up), np.sin(around) * np.sin(up), np.cos(up)], -1).reshape(-1, 3)
    a = np.arange(len(points) - n)
    b = a // n * n + (a + 1) % n
    return Mesh((points * radius + at).astype(np.float32),
                np.concatenate([np.c_[a, b, b + n], np.c_[a, b + n, a + n]]).astype(np.int32))


def found(meshes, view, projection, size=SIZE, outputs=("object", "creases", "marks"), **how):
    """(place of pieces that pass through each other (height, width, 2), 0 where none do, and all pictures)."""
    maps = library.raster(meshes, view, projection, Frame(*size), size, 0.1, outputs=outputs, **how)
    creases = maps["creases"]
    return np.where(creases[..., 1::2] == THROUGH, creases[..., ::2], 0), maps


def looking(down, distance=5.0):
    """From so many degrees above the ground, at the origin; z is up."""
    a, view = np.radians(90 - down), np.eye(4)
    view[1:3, 1:3] = [[np.cos(a), np.sin(a)], [-np.sin(a), np.cos(a)]]
    view[2, 3] = -distance
    return view


def sheets(degrees, one_mesh):
    """A level one, and one that crosses it at an angle."""
    s, c = np.sin(np.radians(degrees)), np.cos(np.radians(degrees))
    square = np.float32([(-40, -30), (40, -30), (40, 30), (-40, 30)])
    level = Mesh(np.c_[square, 0 * square[:, :1]] + np.float32((48, 36, -50)), np.int32([(0, 1, 2), (0, 2, 3)]))
    x, y = square[:, :1], square[:, 1:]
    tilted = Mesh(np.c_[c * x + 48.3 + 0.02 * y, y + 36, -s * x - 50].astype(np.float32),
                  np.int32([(1, 2, 3), (1, 3, 0)]))
    return [joined(level, tilted)] if one_mesh else [level, tilted]


@pytest.mark.parametrize("one_mesh", [True, False])
def test_two_sheets_that_all_but_coincide_have_none(one_mesh):
    assert not any(found(sheets(angle, one_mesh), *pixels(*SIZE))[0].any() for angle in (2e-4, 8e-3))
    assert found(sheets(2e-2, one_mesh), *pixels(*SIZE))[0].any()


@pytest.mark.parametrize("degrees", [1, 8, 45, 80])
@pytest.mark.parametrize("one_mesh", [True, False])
def test_two_sheets_cross_in_a_line_at_any_angle(degrees, one_mesh):
    """From the upper end to the lower one, to a thousandth of a pixel, whatever the angle."""
    place, maps = found(sheets(degrees, one_mesh), *pixels(*SIZE))
    rows = np.arange(8, 64)
    column = place[rows, :, 0].argmax(1)
    assert ((place[rows, :, 0] > 0).sum(1) == 1).all() and (place[rows][..., 1] > 0).sum() <= 2
    exact = 48.3 + 0.02 * (rows + 0.5 - 36) - 0.5
    np.testing.assert_allclose(column + place[rows, column, 0], exact, atol=0.05 if degrees == 1 else 2e-3)
    np.testing.assert_array_equal(maps["marks"][rows, column, 0], -place[rows, column, 0])


@pytest.mark.parametrize("at", [0, 4])
def test_what_one_triangle_holds_together_is_one_piece(at):
    """Two sheets cross; a triangle anywhere among the others joins them, and they are one thing that is folded."""
    square = np.float32([(-40, -30), (40, -30), (40, 30), (-40, 30)])
    x, y = square[:, :1], square[:, 1:]
    points = np.concatenate([np.c_[x + 48, y + 36, 0 * x - 50], np.c_[0.9 * x + 48, y + 36, -0.4 * x - 50]])
    sheets = np.int32([(0, 1, 2), (0, 2, 3), (4, 5, 6), (4, 6, 7)])
    assert found([Mesh(points.astype(np.float32), sheets)], *pixels(*SIZE))[0].any()
    bridge = np.insert(sheets, at, (0, 4, 3), 0)
    assert not found([Mesh(points.astype(np.float32), bridge)], *pixels(*SIZE))[0].any()


@pytest.mark.parametrize("projection", [perspective, orthographic])
@pytest.mark.parametrize("n", [24, 400])
def test_a_ball_sunk_into_the_ground_has_one_ring(projection, n):
    """Of large faces and of such as are smaller than a pixel: the line is whole, and where the ball and the ground are
    the boundary of what is seen of both."""
    ground = Mesh(np.float32([(-9, -9, 0), (9, -9, 0), (9, 9, 0), (-9, 9, 0)]), np.int32([(0, 1, 2), (0, 2, 3)]))
    sunk = ball(n, (0, 0, 0.35))
    camera = looking(35), projection(*SIZE, 3 if projection is perspective else 0.6)
    place, _ = found([joined(ground, sunk)], *camera)
    apart = library.raster([ground, Mesh(sunk.points, sunk.corners, object_index=1)], *camera, Frame(*SIZE), SIZE, 0.1,
                           outputs=("object", "depth"))
    changes = np.diff(apart["object"], axis=1) != 0, np.diff(apart["object"], axis=0) != 0
    ways = place[:, :-1, 0] > 0, place[:-1, :, 1] > 0
    jumps = [np.abs(np.diff(apart["depth"], axis=1 - k)) > 0.15 for k in (0, 1)]  # the ball before the ground
    for way, change, jump in zip(ways, changes, jumps, strict=True):
        assert not (way & ~change).any()
        assert (way | jump)[change].mean() > 0.9 and way.sum() > 10
    columns = np.flatnonzero(ways[1].any(0))
    assert (np.diff(columns[3:-3]) == 1).all() and len(columns) > 25, "but where it turns behind the ball"


@pytest.mark.parametrize("lift", [0, 0.002, 0.05])
def test_boxes_that_stand_on_each_other_or_hover_do_not_pass_through(lift):
    low, high = box((0, 0, -0.5), (2, 2, 1)), box((0.1, 0.2, 0.3 + lift), (0.8, 0.8, 0.6))
    for view in (looking(25), looking(60)):
        place, maps = found([joined(low, high)], view, perspective(*SIZE, 2.4))
        assert not place.any() and np.isfinite(maps["marks"]).all()
    place, _ = found([joined(low, box((0.1, 0.2, 0.2), (0.8, 0.8, 0.6)))], looking(25), perspective(*SIZE, 2.4))
    assert (place > 0).sum() > 15


@pytest.mark.parametrize("loose", [False, True])
def test_smooth_surfaces_of_tiny_triangles_have_none(loose):
    """A bowl and a ball from outside, also where no triangle shares a point with its neighbours, as in files for
    printers; and two that are the same."""
    bowl, outer = ball(300, radius=1.6), ball(300, (0, 0, 0.2), 0.9)
    bowl.corners = bowl.corners[bowl.points[bowl.corners][..., 2].max(1) < 0]
    bowl, outer = ([Mesh(m.points[m.corners].reshape(-1, 3)) for m in (bowl, outer)] if loose else (bowl, outer))
    for meshes in ([bowl], [outer], [outer, Mesh(outer.points, outer.corners)]):
        place, maps = found(meshes, looking(50), perspective(*SIZE, 2.4))
        assert not place.any() and np.isfinite(maps["creases"]).all()


def test_what_lies_before_another_piece_does_not_pass_through_it():
    """A ring, half before and half behind a board that stands in it: the line is where it goes through, not along its
    outline before the board."""
    around, up = np.meshgrid(np.arange(90) * np.pi / 45, np.arange(30) * np.pi / 15)
    r = 1 + 0.2 * np.cos(up)
    points = np.stack([r * np.cos(around), r * np.sin(around), 0.2 * np.sin(up)], -1).reshape(-1, 3)
    a = np.arange(2700)
    right, below = a // 90 * 90 + (a + 1) % 90, (a + 90) % 2700
    corners = np.concatenate([np.c_[a, right, below], np.c_[right, (right + 90) % 2700, below]])
    ring, board = Mesh(points.astype(np.float32), corners.astype(np.int32)), box((0, 0, 0), (4, 0.1, 3))
    place, _ = found([joined(ring, board)], looking(30), perspective(*SIZE, 2.4))
    y, x = np.nonzero(place.any(2))
    assert len(y) > 15
    assert (np.abs(np.abs(x - 47.5) - 24) < 9).all() and {*np.sign(x - 47.5)} == {-1, 1}


@pytest.mark.parametrize("threads", [1, 3])
def test_borders_and_threads_give_the_same_bytes(threads):
    camera = looking(35), perspective(*SIZE, 2.4)
    meshes = [joined(box((0, 0, 0), (1.5, 1, 1)), ball(60, (0.4, -0.2, 0.3), 0.8), box((0, 0, 0.1), (3, 3, 0.1)))]
    place, whole = found(meshes, *camera, threads=threads)
    assert (place > 0).sum() > 50
    part = library.raster(meshes, *camera, Frame(*SIZE, 17, 23), (50, 40), 0.1, outputs=("creases", "marks"), threads=1)
    for name in part:
        np.testing.assert_array_equal(part[name][:-1, :-1], whole[name][23:62, 17:66])


def standing(sunk, down):
    """(meshes, view, projection, where its front face meets the ground in pixels) of a box that is sunk into the ground
    by so much, seen from so many degrees above."""
    ground = Mesh(np.float32([(-9, -9, 0), (9, -9, 0), (9, 9, 0), (-9, 9, 0)]), np.int32([(0, 1, 2), (0, 2, 3)]))
    block, view, projection = box((0, 0, 0.3 - sunk), (1.5, 1.1, 0.6)), looking(down), perspective(*SIZE, 2.2)
    turn = np.array([(np.cos(0.35), -np.sin(0.35), 0), (np.sin(0.35), np.cos(0.35), 0), (0, 0, 1)])
    block = Mesh((block.points @ turn.T).astype(np.float32), block.corners, object_index=1)
    ends = []
    for corner in (-0.75, 0.75):
        x, y, z = view[:3, :3] @ turn @ (corner, -0.55, 0) + view[:3, 3]
        ends.append((SIZE[0] * (1 - projection[0, 0] * x / z) / 2, SIZE[1] * (1 + projection[1, 1] * y / z) / 2))
    return [ground, block], view, projection, np.array(ends) - 0.5


def at_the_foot(sunk, down, one_mesh=False):
    """(bend, place told, exact) of the ways down on which the box ends."""
    meshes, view, projection, ((x0, y0), (x1, y1)) = standing(sunk, down)
    meshes = [joined(*meshes)] if one_mesh else meshes
    _, maps = found(meshes, view, projection, outputs=("object", "creases", "marks"))
    told = []
    for column in range(int(x0) + 2, int(x1) - 1):
        exact = y0 + (y1 - y0) * (column - x0) / (x1 - x0)
        row = int(np.floor(exact))
        if 0.02 < exact - row < 0.98:
            place, bend = maps["creases"][row, column, 2:]
            if not one_mesh:
                assert maps["object"][row, column] != maps["object"][row + 1, column]
                place = -maps["marks"][row, column, 1] % 2
            told.append((bend, place, exact - row))
    return np.array(told)


@pytest.mark.parametrize("sunk", [0.0, 1e-3, 4e-3, 0.01, 0.03])
@pytest.mark.parametrize("down", [12, 30, 55])
def test_what_is_sunk_a_little_ends_where_it_meets_the_ground(sunk, down):
    """Also where its own edge lies less than a pixel below it."""
    told = at_the_foot(sunk, down)
    assert len(told) > 20
    assert np.abs(told[:, 1] - told[:, 2]).max() < 2e-3


@pytest.mark.parametrize("sunk", [1e-3, 4e-3, 0.01, 0.03])
@pytest.mark.parametrize("down", [12, 30, 55])
def test_what_is_sunk_a_little_into_another_piece_of_its_mesh_has_a_foot(sunk, down):
    """A stud of a brick, by its edge less than a pixel below the face that it stands on."""
    bend, told, exact = at_the_foot(sunk, down, one_mesh=True).T
    assert len(told) > 20 and np.isin(np.round(bend), [90, THROUGH]).all()
    assert np.abs(told - exact).max() < 2e-3


def test_a_wall_seen_at_a_grazing_angle_ends_where_it_meets_the_ground():
    """A pixel farther on it would be deep below the ground, where it has ended."""
    ground = Mesh(np.float32([(-9, -9, 0), (9, -9, 0), (9, 9, 0), (-9, 9, 0)]), np.int32([(0, 1, 2), (0, 2, 3)]))
    block = Mesh(box((0, 0, 0.25), (1.4, 1, 0.6)).points, box((0, 0, 0), (1, 1, 1)).corners, object_index=1)
    _, maps = found([ground, block], looking(78), perspective(*SIZE, 2.2))
    for axis, change in ((0, maps["object"][:, 1:] != maps["object"][:, :-1]),
                         (1, maps["object"][1:] != maps["object"][:-1])):
        told = maps["marks"][:, :-1, 0] if axis == 0 else maps["marks"][:-1, :, 1]
        assert (told[change] < 0).all()


def rod(turn, sunk, sides):
    """A rod of radius 4 that leans, sunk into a plane that is turned by `turn` radians; two meshes, in pixels."""
    angle, k = np.arange(sides) * 2 * np.pi / sides, np.arange(sides)
    ring = np.stack([4 * np.cos(angle), 0 * angle, 4 * np.sin(angle) + 4 - sunk], 1)
    points, plane = np.concatenate([ring - (0, 200, 0), ring + (0, 200, 0)]), 300 * np.array(
        [(-1, -1, 0), (1, -1, 0), (1, 1, 0), (-1, 1, 0)], float)
    points[:, 0] += 0.15 * points[:, 1]
    turned = np.array([(np.cos(turn), 0, -np.sin(turn)), (0, 1, 0), (np.sin(turn), 0, np.cos(turn))])
    points, plane = (np.float32(a @ turned + (20, 30, -200)) for a in (points, plane))
    sides_of = np.stack([k, (k + 1) % sides, (k + 1) % sides + sides], 1), np.stack(
        [k, (k + 1) % sides + sides, k + sides], 1)
    return [Mesh(points, np.concatenate(sides_of).astype(np.int32), object_index=1),
            Mesh(plane, np.int32([(0, 1, 2), (0, 2, 3)]), object_index=2)]


@pytest.mark.parametrize("sides", [8, 24])
@pytest.mark.parametrize("turn", [0.2, 0.4, 0.5, 0.6, 0.8, -0.5])
@pytest.mark.parametrize("sunk", [0.5, 2.3, 3.9])
def test_a_rod_on_a_board_ends_between_pixels_where_it_does(turn, sunk, sides):
    """Be that where it turns away or where it goes into the board, on a face that no pixel shows. Beside the objects of
    64 pixels for each."""
    fine, (width, height) = 64, (48, 24)
    own, large = rod(turn, sunk, sides), rod(turn, sunk, sides)
    for mesh in large:
        mesh.points[:, 0] *= fine
    maps = library.raster(own, *pixels(640, 720), Frame(640, 720), (width, height), 0.1,
                          outputs=("object", "marks", "creases"))
    true = library.raster(large, *pixels(640 * fine, 720), Frame(640 * fine, 720), (width * fine, height), 0.1,
                          outputs=("object",))["object"].reshape(height, -1)
    number = maps["object"].reshape(height, width)
    rows, columns = np.nonzero(number[:, :-1] != number[:, 1:])
    assert len(rows) == 2 * height
    place = -maps["marks"][rows, columns, 0] % 2
    off = []
    for row, column, share in zip(rows, columns, place, strict=True):
        assert 0 < share <= 1
        passed = true[row, column * fine + fine // 2:(column + 1) * fine + fine // 2]
        ends = np.argmax(passed != passed[0]) / fine if (passed != passed[0]).any() else 1.0
        off.append(min(abs(share - ends), 1 - abs(share - ends)))  # at a pixel's centre it is the one way's or the next
    assert max(off) < (0.1 if sides == 24 else 0.03)  # an edge that tells where it turns away may lie below the board
