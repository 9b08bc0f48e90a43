# SPDX-License-Identifier: GPL-3.0-or-later
"""Pieces of one mesh that lie flush with each other: what is told is what is seen of them."""

import numpy as np
import pytest
from encre.pen import library
from encre.pen.job import Frame, Mesh
from reference.marks import creases
from views import joined, looking, perspective

SIZE = 96, 72


def box(low, high):
    points = np.array([(x, y, z) for z in (0, 1) for y in (0, 1) for x in (0, 1)]) * np.subtract(high, low) + low
    faces = [(0, 2, 3, 1), (4, 5, 7, 6), (0, 1, 5, 4), (2, 6, 7, 3), (0, 4, 6, 2), (1, 3, 7, 5)]
    return Mesh(points.astype(np.float32), np.int32([(f[0], f[k], f[k + 1]) for f in faces for k in (1, 2)]))


def turned(mesh, around=0.6, over=0.45):
    c, s, d, e = np.cos(around), np.sin(around), np.cos(over), np.sin(over)
    turn = np.array([(1, 0, 0), (0, d, -e), (0, e, d)]) @ np.array([(c, 0, s), (0, 1, 0), (-s, 0, c)])
    return Mesh((mesh.points @ turn.T).astype(np.float32), mesh.corners)


def told(*pieces, seed=3):
    """Creases and marks of a mesh of these pieces."""
    camera = looking(np.random.default_rng(seed)), perspective(*SIZE, 1.6)
    mesh = turned(joined(*pieces))
    maps = library.raster([mesh], *camera, Frame(*SIZE), SIZE, 0.1, outputs=("depth", "creases", "marks"))
    return maps["creases"], maps["marks"], (mesh, camera)


WHOLE = box((-1.5, -1, -1), (1.5, 1, 1))
PARTS = {
    "touching": (box((-1.5, -1, -1), (0.2, 1, 1)), box((0.2, -1, -1), (1.5, 1, 1))),
    "overlapping": (box((-1.5, -1, -1), (0.6, 1, 1)), box((-0.4, -1, -1), (1.5, 1, 1))),
    "inside": (WHOLE, box((-0.5, -0.3, -0.4), (0.5, 1, 1))),
    "under a corner": (WHOLE, box((-1.5, -0.3, 0.2), (0.1, 1, 1))),
    "doubled": (WHOLE, WHOLE),
    "quarters": tuple(box((a, b, -1), (a + w, b + h, 1)) for a, w in ((-1.5, 1.2), (-0.3, 1.8))
                      for b, h in ((-1, 1.3), (0.3, 0.7))),
}


@pytest.mark.parametrize("turn", [1, -1])
@pytest.mark.parametrize("parts", PARTS)
def test_what_makes_a_box_looks_like_one(parts, turn):
    """No line where a piece ends in a face, whichever comes first, and the box's own lines whole."""
    want = told(WHOLE)
    got = told(*PARTS[parts][::turn])
    assert (want[0][..., 1::2] > 0).sum() > 50 and (want[1] < 0).sum() > 150
    for layer, whole in zip(got[:2], want[:2], strict=True):
        np.testing.assert_array_equal(layer != 0, whole != 0)
    off = np.abs(got[0] - want[0]) > 1e-3
    assert off.sum() <= 2, "the place is another one but where a seam meets an edge"


def test_a_slit_of_half_a_pixel_is_seen():
    apart = told(box((-1.5, -1, -1), (0.2, 1, 1)), box((0.22, -1, -1), (1.5, 1, 1)))
    assert (apart[0] != 0).sum() > (told(WHOLE)[0] != 0).sum() + 20


@pytest.mark.parametrize("sides, bend", [(10, 36), (6, 60), (40, 9)])
def test_closed_halves_bend_as_what_they_make(sides, bend):
    """Not by the right angle, or so, at which each half ends inside."""
    def half(sign):
        a = sign * np.pi * 2 * np.arange(sides // 2 + 1) / sides
        ring = np.stack([np.cos(a), 0 * a, np.sin(a)], -1)
        n = len(ring)
        k = np.arange(n)
        side = np.concatenate([np.c_[k, (k + 1) % n, n + (k + 1) % n], np.c_[k, n + (k + 1) % n, n + k]])
        fan = np.array([(0, i, i + 1) for i in range(1, n - 1)])
        return Mesh(np.concatenate([ring - (0, 1, 0), ring + (0, 1, 0)]).astype(np.float32),
                    np.concatenate([side, fan, fan + n]).astype(np.int32))

    creases, marks, _ = told(half(1), half(-1))
    found = np.abs(creases[..., 1::2])[marks == 0]  # but the outline
    found = found[(found > 0) & (np.abs(found - 90) > 1)]  # and the rims
    assert found.size > 30 and np.mean(np.abs(found - bend) < 0.1) > 0.97


def test_a_box_on_another_piece_has_a_foot():
    floor, stands = box((-2, -1.2, -1.6), (2, -1, 1.6)), box((-0.7, -1, -0.6), (0.6, 0.2, 0.7))
    got, _, (mesh, camera) = told(floor, stands)
    alone = told(stands)[0]
    foot = (np.abs(alone[..., 1::2] - 90) < 0.1) & (np.abs(got[..., 1::2] - 90) < 0.1)
    assert foot.sum() > 0.95 * (alone[..., 1::2] > 0).sum() > 40
    want, unsure = creases([mesh], *camera, Frame(*SIZE), SIZE, 0.1)
    np.testing.assert_allclose(got[~unsure], want[~unsure], atol=0.02)
