# SPDX-License-Identifier: GPL-3.0-or-later
"""What is kept of meshes from one job of chains to the next shows in none of them."""

from pathlib import Path

import numpy as np
import pytest
from encre.pen import library
from encre.pen.job import EDGES, Frame, Mesh, edge_kinds
from views import crumpled, looking, perspective, rotation, same, soup


def picture(meshes, camera, threads=1):
    points = library.chains(meshes, *camera, Frame(50, 40), (50, 40), 0.1, threads=threads)
    return {"points": points.view(np.uint8)}


def anew(meshes, camera, threads=1):
    """What nothing was kept for."""
    library.load().forget()
    return picture(meshes, camera, threads)


def bent(mesh, rng):
    """Its points elsewhere, in an array of their own."""
    mesh.points = mesh.points + rng.normal(0, 0.1, mesh.points.shape).astype(np.float32)


def pointed(mesh, rng, triangle=None):
    """Three of its points at one place, as at a tip; or no longer."""
    mesh.points = mesh.points.copy()
    of = mesh.corners[len(mesh.corners) // 2 if triangle is None else triangle]
    points = mesh.points[of]
    tip = (points[0] == points[1]).all()
    mesh.points[of] = points + rng.normal(0, 0.2, (3, 3)) if tip else points[0]


def rejoined(mesh, rng):
    mesh.corners = mesh.corners.copy()
    mesh.corners[rng.integers(len(mesh.corners))] = mesh.corners[0, ::-1]


def named(mesh, rng):
    kinds = rng.choice(list(EDGES.values()), (len(mesh.corners), 3))
    mesh.edges = edge_kinds(kinds) if mesh.edges is None else None


def turned(mesh, rng):
    mesh.model = mesh.model.copy()
    mesh.model[:3, :3] = rotation(rng) * rng.uniform(0.5, 1.5, 3)


def offset(mesh, rng):
    mesh.crease_offset = float(rng.uniform(-20, 20))


def numbered(mesh, rng):
    mesh.material = rng.integers(0, 3, len(mesh.corners)).astype(np.int32)


CHANGES = (bent, pointed, rejoined, named, turned, offset, numbered)


@pytest.mark.parametrize("threads", [1, 3])
@pytest.mark.parametrize("change", CHANGES)
def test_a_change_of_one_mesh_shows(change, threads):
    rng = np.random.default_rng(CHANGES.index(change))
    meshes, camera = [crumpled(rng), crumpled(rng), soup(rng, 20)], (looking(rng), perspective(50, 40))
    before = picture(meshes, camera, threads)
    change(meshes[1], rng)
    got, want = picture(meshes, camera, threads), anew(meshes, camera, threads)
    same(got, want)
    assert not np.array_equal(got["points"], before["points"])


@pytest.mark.parametrize("triangle", [0, 1, -1])
def test_a_tip_that_opens_shows(triangle):
    rng = np.random.default_rng(23)
    mesh, camera = crumpled(rng), (looking(rng), perspective(50, 40))
    for _ in range(12):
        pointed(mesh, rng, triangle)
        same(picture([mesh], camera), anew([mesh], camera))


@pytest.mark.parametrize("closing", [0, 1, 2])
def test_one_triangle_that_closes_joins_its_neighbours(closing):
    """The edge that it has alone becomes a point, and both its others one."""
    outer = np.array([(-1.5, 0.5, 0), (-0.6, 1.4, 0), (0.6, 1.2, 0), (1.4, 0.4, 0)], np.float32)
    mesh = Mesh(np.concatenate([outer, [(0, -1, 0.8)]]).astype(np.float32), np.array([(0, 1, 4), (1, 2, 4), (2, 3, 4)]))
    mesh.corners = np.roll(mesh.corners, -closing, 0).astype(np.int32)  # a triangle in the middle comes first, or last
    camera = looking(np.random.default_rng(7)), perspective(50, 40)
    before = picture([mesh], camera)
    mesh.points = mesh.points.copy()
    mesh.points[2] = mesh.points[1]
    got = picture([mesh], camera)
    same(got, anew([mesh], camera))
    assert not np.array_equal(got["points"], before["points"])


def test_a_mesh_that_is_written_over_shows():
    rng = np.random.default_rng(20)
    meshes, camera = [crumpled(rng)], (looking(rng), perspective(50, 40))
    picture(meshes, camera)
    for array in (meshes[0].points, meshes[0].corners):
        array[:] = array[::-1].copy()
        same(picture(meshes, camera), anew(meshes, camera))


def test_meshes_come_go_and_change_at_random():
    rng = np.random.default_rng(21)
    meshes = [crumpled(rng) for _ in range(4)]
    meshes += [Mesh(meshes[0].points, meshes[0].corners, model=rotated(rng)) for _ in range(2)]  # instances
    meshes += [soup(rng, 9), Mesh(meshes[1].points, meshes[1].corners[:, :2], kind="lines")]
    pictures = []
    for _ in range(40):
        shown = [meshes[k] for k in rng.permutation(len(meshes))[:rng.integers(1, len(meshes) + 1)]]
        if rng.random() < 0.7:
            rng.choice(CHANGES)(meshes[rng.integers(6)], rng)
        camera = looking(rng), perspective(50, 40)
        pictures.append((shown := [Mesh(**vars(mesh)) for mesh in shown], camera, picture(shown, camera)))
    for shown, camera, got in pictures:
        library.load().forget()
        same(got, picture(shown, camera))


def rotated(rng):
    model = np.eye(4)
    model[:3, :3] = rotation(rng)
    return model


def held():
    """Bytes that the process holds."""
    return int(Path("/proc/self/statm").read_text().split()[1]) * 4096


@pytest.mark.slow
@pytest.mark.skipif(not Path("/proc/self/statm").exists(), reason="needs Linux's /proc")
def test_only_the_last_meshes_are_kept():
    rng = np.random.default_rng(22)
    camera, corners = (looking(rng), perspective(50, 40)), np.arange(60000, dtype=np.int32).reshape(-1, 3)
    after = []
    for k in range(60):  # of which each would keep a million bytes
        points = rng.uniform(-1, 1, (20000, 1, 3)) + 0.002 * rng.normal(0, 1, (20000, 3, 3))
        picture([Mesh(points.reshape(-1, 3).astype(np.float32), np.roll(corners, k, 0))], camera)
        after.append(held())
    assert max(after[20:]) - max(after[:20]) < 10e6
