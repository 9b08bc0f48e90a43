# SPDX-License-Identifier: GPL-3.0-or-later
"""Lines between the colors of images, at any size of their texels: whole, as wide as asked, and nowhere else."""

import imaged
import numpy as np
import pages
import pytest
from encre.pen import abi, library
from encre.pen.job import Colored, Colors, Frame, Mesh
from imaged import DARK, LIGHT, LOOK, SIZE, disc, ink, plane

COLOR = 1 << abi.CHAIN_KINDS.index("color")


def measured(picture, truth, miss=1):
    """(share of the outline with ink at most `miss` pixels away, ink elsewhere by all pixels, mean width) of ink along
    a polyline (n, 2) whose points are less than a pixel apart."""
    height, width = picture.shape
    inside = (truth > 3).all(1) & (truth[:, 0] < width - 4) & (truth[:, 1] < height - 4)
    at = np.round(truth[inside]).astype(int)
    whole = np.mean([picture[y - miss:y + miss + 1, x - miss:x + miss + 1].max() > 0.5 for x, y in at])
    near = np.zeros(picture.shape, bool)
    for x, y in np.round(truth).astype(int):
        near[max(y - 4, 0):y + 5, max(x - 4, 0):x + 5] = True
    step = np.hypot(*np.diff(truth, axis=0).T).sum()
    return whole, picture[~near].sum() / picture.size, picture[near].sum() / step


def circle(size, texel, turn=0.0):
    t, radius = np.linspace(0, 2 * np.pi, 8000), 0.35 * size * texel
    return np.stack([(SIZE[0] - 1) / 2 + radius * np.cos(t),
                     (SIZE[1] - 1) / 2 + radius * np.sin(t) * np.cos(np.radians(turn))], 1)


@pytest.mark.parametrize("turn", [0.0, 60.0])
@pytest.mark.parametrize(("size", "texel"), [(512, 0.25), (256, 0.5), (128, 1.0), (64, 2.0), (48, 4.0), (24, 8.0),
                                             (14, 16.0)])
def test_a_disc_is_outlined_at_any_magnification(size, texel, turn):
    picture = ink(*plane(disc(size), texel, turn))
    whole, stray, wide = measured(picture, circle(size, texel, turn), max(1, int(texel / 8)))
    assert whole >= 0.99 and stray <= 0.0005 and abs(wide / 3 - 1) <= 0.05, (whole, stray, wide / 3)


def islands(first, second, back=False):
    """The points of color chains where two squares meet that show an image's left half, light, or right half, dark."""
    image = np.repeat(np.stack([np.tile(LIGHT, (16, 1)), np.tile(DARK, (16, 1))]).reshape(1, 32, 3), 32, 0)
    points = np.float32([[x, y, 0] for y in (-1, 1) for x in (-1, 0, 1)])
    faces = np.int32([[0, 1, 4], [0, 4, 3], [1, 2, 5], [1, 5, 4]])
    uv = points[faces][..., :2] * 0.1 + 0.5
    for k, at in enumerate((first, second)):
        uv[2 * k:2 * k + 2, :, 0] += at
    if back:
        faces, uv = faces[:, ::-1].copy(), uv[:, ::-1].copy()
    view, projection = np.eye(4), np.diag([200 / SIZE[0], 200 / SIZE[1], -0.02, 1])
    view[2, 3] = -20
    mesh = Mesh(points, faces, object_index=1, material_index=1, uv=uv)
    every = library.load().complete(library.load().check(LOOK), [])
    colors = Colors([Colored(np.ascontiguousarray(image), 5)], np.int32([-1, 0]), every)
    found = library.chains([mesh], view, projection, Frame(*SIZE), SIZE, 0.1, 100, colors=colors)
    return found[found["kind"] & COLOR != 0]


def test_colors_part_where_one_island_of_an_image_meets_another():
    """Along the edge of the mesh; not where both show one color, or the image goes on."""
    for first, second, back in ((-0.25, 0.25, False), (0.25, -0.25, False), (-0.25, 0.25, True)):
        found = islands(first, second, back)
        assert len(found) and np.ptp(found["x"]) < 0.01 and abs(found["x"][0] - SIZE[0] / 2) < 0.51
        assert np.ptp(found["y"]) == pytest.approx(200, abs=0.01)
        left = found["color"][:, int(found["y"][-1] > found["y"][0])] >> 8 & 255  # green
        assert (left > 200).all() if first < 0 else (left < 120).all()
    assert not len(islands(-0.25, -0.2)) and not len(islands(0.25, 0.25))


def test_pixels_alone_lose_what_is_magnified():
    layers, chains = plane(disc(24), 8.0)
    chains.points = chains.points[chains.points["kind"] & COLOR == 0]
    chains.chained[:] = 1
    assert measured(ink(layers, chains), circle(24, 8.0))[0] < 0.5


def stair(image, texel):
    """(places on the sides of texels whose colors differ, and around the image)."""
    size = image.shape[0]
    left, top = ((n - 1) / 2 - size * texel / 2 + 0.0 for n in SIZE)
    across = np.argwhere((image[:, 1:] != image[:, :-1]).any(2))
    along = np.argwhere((image[1:] != image[:-1]).any(2))
    steps = np.linspace(0, 1, int(2 * texel) + 2)[:, None]
    down = [np.stack([left + (x + 1) * texel + 0 * steps[:, 0], top + (size - y - steps[:, 0]) * texel], 1)
            for y, x in across]
    right = [np.stack([left + (x + steps[:, 0]) * texel, top + (size - 1 - y) * texel + 0 * steps[:, 0]], 1)
             for y, x in along]
    edge = np.linspace(0, size * texel, int(2 * size * texel))
    around = [np.stack([left + edge, top + far + 0 * edge], 1) for far in (0, size * texel)] + [
        np.stack([left + far + 0 * edge, top + edge], 1) for far in (0, size * texel)]  # which others draw, or nobody
    return np.concatenate(down + right), np.concatenate(around)


@pytest.mark.parametrize("texel", [10.0, 13.0, 16.0])
def test_what_is_shown_texel_by_texel_keeps_its_steps(texel):
    rng = np.random.default_rng(4)
    image = np.float32([LIGHT, DARK, [0.6, 0.1, 0.05]])[rng.integers(0, 3, (16, 16))]
    picture = ink(*plane(image, texel, closest=True))
    inside, around = stair(image, texel)
    whole, _, _ = measured(picture, inside)
    _, stray, _ = measured(picture, np.concatenate([inside, around]))
    assert whole >= 0.99 and stray <= 0.0005, (whole, stray)


@pytest.mark.parametrize("key", [11, 12])
def test_gradients_and_noise_give_no_lines(key):
    ramp = np.linspace(0.1, 0.9, 96, dtype=np.float32)[None, :, None].repeat(96, 0).repeat(3, 2)
    ramp = np.minimum(ramp, ramp[:, ::-1])  # it repeats without a step
    if key == 12:
        ramp = np.full_like(ramp, 0.4) + np.random.default_rng(1).normal(0, 0.012, ramp.shape).astype(np.float32)
    _, chains = plane(ramp, 2.0, key=key)
    assert not (chains.points["kind"] & COLOR).any()


def test_a_minified_checker_thins_out():
    checker = np.where(np.indices((16, 16)).sum(0)[..., None] % 2, LIGHT, DARK).astype(np.float32)
    near, far = (ink(*plane(checker, texel, closest=True, repeats=count)) for texel, count in ((12, 1), (0.75, 16)))
    assert near.max() == 1 and far.sum() < 0.05 * near.sum()


def test_lines_stand_still_as_the_image_does():
    """The same curve, wherever it lies between pixels."""
    layers, chains = plane(disc(24), 8.0)
    points = chains.points[chains.points["kind"] & COLOR > 0]
    radius = np.hypot(points["x"] - (SIZE[0] - 1) / 2, points["y"] - (SIZE[1] - 1) / 2) / 8
    assert abs(radius - 0.35 * 24).max() < 0.12 and len({*points["run"]}) == 1


@pytest.mark.slow
@pytest.mark.parametrize("turn", imaged.TURNS)
@pytest.mark.parametrize("texel", imaged.TEXELS)
@pytest.mark.parametrize("name", [*imaged.FIGURES, "sprite"])
def test_figures_are_outlined_at_any_magnification(name, texel, turn):
    """Where no other boundary is within 10 pixels. No case is worse than what the page says of all."""
    whole, wide, stray, still, own = imaged.measured(name, texel, turn)
    crowded = name == "sprite" and (texel, turn) in [(2.0, 0.0), (4.0, 60.0)]  # as the page says
    assert stray <= 0.0005 and (own if crowded else still) <= 1.1, (stray, still, own)
    assert np.isnan(whole) or (whole >= 0.99 and abs(wide - 1) <= 0.05), (whole, wide)
    said = pages.table((pages.DOCS / "lines.md").read_text(encoding="utf-8"), 5)[name]
    least, most = map(float, said["width 0.95–1.05"].split("–"))
    assert np.isnan(whole) or (whole >= float(said["whole ≥ 0.99"]) - 1e-3 and least - 2e-3 <= wide <= most + 2e-3)
    assert still <= float(said["still ≤ 1.1"]) + 2e-3 and own <= float(said["own"]) + 2e-3
    assert stray <= float(said["stray ≤ 0.0005"]) + 1e-4


@pytest.mark.parametrize("texel", [8.0, 16.0])
def test_corners_between_texels_are_sharp(texel):
    """Those of a letter: on its outline to a twentieth of a texel."""
    _, chains = plane(imaged.FIGURES["letter"][0](32), texel, key=31)
    points = chains.points[chains.points["kind"] & COLOR > 0]
    places, _, _ = imaged.on_screen(imaged.LETTER, 32 * texel, 0.0)
    corner = [np.hypot(points["x"] - x, points["y"] - y).min() for x, y in
              imaged.on_screen([corner[None].repeat(2, 0) for corner in imaged.LETTER[0]], 32 * texel, 0.0)[0]
              if 0 < x < SIZE[0] and 0 < y < SIZE[1]]
    away = [np.hypot(*(places - (p["x"], p["y"])).T).min() for p in points]
    assert max(corner) < 0.05 * texel and max(away) < 0.05 * texel + 0.7


def seen_through(holed=True, closest=False):
    """Points of color chains of a card, light above dark, with a hole in its middle, and of a wall behind it, light
    left of dark, in texels of the card from its middle."""
    size, y, x = 32, *(np.mgrid[:32, :32] + 0.5)
    card = np.where((y < 16)[..., None], DARK, LIGHT).astype(np.float32)
    hole = np.hypot(x - 16, y - 16) < 8
    card[hole & (x < 16)] = [1, 0, 0]  # which nobody sees
    wall = np.repeat(np.stack([np.tile(LIGHT, (16, 1)), np.tile(DARK, (16, 1))]).reshape(1, 32, 3), 32, 0)
    corners = np.float32([[-1, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0]])
    faces, uv = np.int32([[0, 1, 2], [0, 2, 3]]), np.float32([[0, 0], [1, 0], [1, 1], [0, 1]])
    back = np.eye(4)
    back[2, 3] = -1
    meshes = [Mesh(corners, faces, object_index=1, material_index=1, uv=uv[faces], open=holed),
              Mesh(corners, faces, object_index=2, material_index=2, uv=uv[faces], model=back)]
    view, projection = np.eye(4), np.diag([200 / SIZE[0], 200 / SIZE[1], -0.02, 1])
    view[2, 3] = -20
    every = library.load().complete(library.load().check(LOOK), [])
    alpha = np.where(hole, 0, 255).astype(np.uint8) if holed else None
    colors = Colors([Colored(card, 6, closest=closest, alpha=alpha), Colored(np.ascontiguousarray(wall), 7)],
                    np.int32([-1, 0, 1]), every)
    found = library.chains(meshes, view, projection, Frame(*SIZE), SIZE, 0.1, 100, colors=colors)
    texel, found = 200 / size, found[found["kind"] & COLOR != 0]
    at = np.stack([found["x"] + 0.5 - SIZE[0] / 2, SIZE[1] / 2 - found["y"] - 0.5], 1) / texel
    return at[found["object"] == 1], at[found["object"] == 2]


@pytest.mark.parametrize("closest", [False, True])
def test_a_hole_in_an_image_has_no_lines_and_hides_none(closest):
    card, wall = seen_through(closest=closest)
    reach = 8.5 if closest else 8.1
    assert len(card) and 7.4 < abs(card[:, 0]).min() < reach and abs(card[:, 0]).max() > 15.9
    assert abs(card[:, 1]).max() < 0.05
    assert len(wall) and abs(wall[:, 0]).max() < 0.05 and np.ptp(wall[:, 1]) > 31.9
    card, wall = seen_through(holed=False, closest=closest)
    assert len(card) and not len(wall)


def test_levels_of_detail_are_made_as_they_are_seen():
    """A context that has seen an image from afar draws it near as one that has not, and the other way round."""
    image, every = disc(64), library.load().complete(library.load().check(LOOK), [])
    corners = np.float32([[-1, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0]])
    faces, uv = np.int32([[0, 1, 2], [0, 2, 3]]), np.float32([[0, 0], [1, 0], [1, 1], [0, 1]])
    mesh, view = Mesh(corners, faces, object_index=1, material_index=1, uv=uv[faces]), np.eye(4)
    view[2, 3] = -20

    def found(size, key):
        projection = np.diag([2 * size / SIZE[0], 2 * size / SIZE[1], -0.02, 1])
        colors = Colors([Colored(image, key)], np.int32([-1, 0]), every)
        return library.chains([mesh], view, projection, Frame(*SIZE), SIZE, 0.1, 100, colors=colors).tobytes()

    near, far = found(120, 41), found(12, 42)
    assert near != far and [found(12, 41), found(120, 42)] == [far, near]
