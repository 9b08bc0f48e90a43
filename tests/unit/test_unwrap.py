# SPDX-License-Identifier: GPL-3.0-or-later
"""How textures lie on meshes, and that uniform lines are as wide everywhere on them."""

import numpy as np
import pages
import pytest
import widths
from encre.pen import unwrap


def plane(uv, points=((0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0))):
    corners = np.array([(0, 1, 2), (0, 2, 3)])
    return unwrap.Unwrapped(np.array(points, float), corners, np.array(uv, float)[corners])


SQUARE = ((0, 0), (1, 0), (1, 1), (0, 1))


def test_a_flat_square_is_neutral():
    form = unwrap.form(plane(SQUARE), 16, 16)
    assert np.abs(form - (1, 0, 1)).max() < 1e-6


def test_stretch_and_shear():
    """A texel is 4 by 1 units of space, or sheared; E, F, G are in texels of mean size, y down."""
    form = unwrap.form(plane(SQUARE, ((0, 0, 0), (4, 0, 0), (4, 1, 0), (0, 1, 0))), 8, 8)
    assert np.abs(form - (4, 0, 0.25)).max() < 1e-5
    form = unwrap.form(plane(SQUARE), 32, 8)
    assert np.abs(form - (0.25, 0, 4)).max() < 1e-5
    form = unwrap.form(plane(SQUARE, ((0, 0, 0), (1, 0, 0), (1.5, 1, 0), (0.5, 1, 0))), 8, 8)
    assert np.abs(form - (1, -0.5, 1.25)).max() < 1e-5


def test_a_corner_has_the_mean_of_its_triangles_by_their_area():
    """Two halves of a texture, of which the right is three times as wide as the left and its surface half as long."""
    uv = np.array([(0, 0), (0.25, 0), (0.25, 1), (0, 1), (1, 0), (1, 1)])
    points = np.array([(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (2.5, 0, 0), (2.5, 1, 0)], float)
    corners = np.array([(0, 1, 2), (0, 2, 3), (1, 4, 5), (1, 5, 2)])
    width = 64
    form = unwrap.form(unwrap.Unwrapped(points, corners, uv[corners]), width, width)
    texel = np.sqrt(2.5) / width  # of mean size
    left, right = 1 / 16 / texel, 1.5 / 48 / texel
    # (1, 0, 0) has one triangle of an eighth of the texture and two of three eighths; (1, 1, 0) two and one
    for row, small, large in ((-1, 1, 2), (0, 2, 1)):
        mean = (small * left + 3 * large * right) / (small + 3 * large)
        assert np.sqrt(form[row, 15:17, 0]).mean() == pytest.approx(mean, rel=0.03)


def test_outside_the_islands():
    """Nothing is known there but near the border, where lines of the island reach."""
    form = unwrap.form(plane([(u / 2, v / 2) for u, v in SQUARE], ((0, 0, 0), (4, 0, 0), (4, 1, 0), (0, 1, 0))), 64, 64)
    assert np.abs(form[32:, :32] - (4, 0, 0.25)).max() < 1e-4
    assert np.abs(form[40, 32:32 + unwrap.MARGIN] - (4, 0, 0.25)).max() < 1e-4
    assert np.array_equal(form[40, 32 + unwrap.MARGIN:], np.tile(np.float32((1, 0, 1)), (32 - unwrap.MARGIN, 1)))


@pytest.mark.parametrize("shift, scale", [((0.3, -0.6), 1), ((-2, 5), 1), ((0.1, 0.2), 7.5), ((0, 0), 500)])
def test_repeated(shift, scale):
    """Coordinates beyond the texture read it again."""
    mesh = plane([(scale * u + shift[0], scale * v + shift[1]) for u, v in SQUARE],
                 ((0, 0, 0), (2, 0, 0), (2, 1, 0), (0, 1, 0)))
    assert np.abs(unwrap.form(mesh, 16, 16) - (2, 0, 0.5)).max() < 1e-4
    assert scale == 1 or unwrap.tiles(mesh) == (True, True)


def test_tiles():
    assert unwrap.tiles(plane(SQUARE)) == (False, False)
    assert unwrap.tiles(plane([(2 * u, v) for u, v in SQUARE])) == (True, False)
    assert unwrap.tiles(plane([(u, v - 0.5) for u, v in SQUARE])) == (False, True)
    assert unwrap.tiles(widths.mesh(widths.Sphere(), 12, 6)) == (True, False)  # goes on over its seam, not its poles


def test_join():
    one, two = plane(SQUARE), plane([(u, v + 1) for u, v in SQUARE])
    both = unwrap.join([one, two])
    assert len(both.points) == 8 and both.corners.max() == 7 and unwrap.tiles(both) == (False, True)


def test_obj(tmp_path):
    """Polygons are cut, negative indices count from the end, normals and names are passed over."""
    (tmp_path / "a.obj").write_text("o Name\nv 0 0 0\nv 4 0 0 1.0\nv 4 1 0\nv 0 1 0\nvt 0 0\nvt 1 0 0\nvt 1 1\nvt 0 1\n"
                                    "vn 0 0 1\ns off\nf 1/1/1 2/2/1 -2/-2/1 4/4/1\n")
    mesh = unwrap.read_obj(tmp_path / "a.obj")
    assert mesh.corners.tolist() == [[0, 1, 2], [0, 2, 3]]
    assert np.abs(unwrap.form(mesh, 8, 8) - (4, 0, 0.25)).max() < 1e-5


@pytest.mark.slow
@pytest.mark.parametrize("surface", [widths.Cylinder(), widths.Sphere()], ids=lambda s: s.name)
def test_uniform_lines_are_as_wide_everywhere(surface):
    texture = widths.spotted(surface)
    plain, uniform = (widths.widths(surface, texture, widths.baked(surface, texture, on)) for on in (False, True))
    assert plain.max() > 2.5 * plain.min()
    assert uniform.max() < 1.06 * uniform.min()
    assert np.median(uniform) == pytest.approx(widths.THICKNESS, rel=0.02)
    page = (pages.DOCS / "baking.md").read_text(encoding="utf-8")
    assert all(widths.told(surface, *row) in page for row in (("plain", plain), ("uniform", uniform)))
