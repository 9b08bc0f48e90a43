# SPDX-License-Identifier: GPL-3.0-or-later
"""The rendered 3D view in a window (blender/inside/view_window.py works in it)."""

from pathlib import Path

import blenders
import numpy as np
import OpenImageIO as oiio
import pytest
from encre.pen import colour

pytestmark = pytest.mark.slow

WINDOW = Path(__file__).parent / "inside" / "view_window.py"


def look(folder, **environment):
    return blenders.window(WINDOW, "view", folder, (800, 600), "--enable-event-simulate",
                           limit=1600 * (10 if environment else 1), **environment)


@pytest.fixture(scope="module")
def shot(tmp_path_factory):
    return look(tmp_path_factory.mktemp("view"))


def fact(shot, name):
    return shot.facts[name][0]


def picture(shot, name):
    return np.load(shot.folder / f"{name}.npy")


def apart(one, other):
    """(height, width): which pixels can be told apart."""
    return np.abs(one - other).max(-1) > 0.01


def test_nothing_fails(shot):
    assert fact(shot, "finished") and "Traceback" not in shot.output, shot.output[-3000:]


def test_the_view_of_the_camera_is_the_final_frame(shot):
    view, final = picture(shot, "camera"), shot.passes("f12")["Combined"]
    assert view.shape == final.shape and (view[..., :3].max(-1) < 0.05).mean() > 0.02
    assert np.abs(view - final).max() < 1e-5
    small = picture(shot, "half")
    assert small.shape[:2] == (view.shape[0] // 2, view.shape[1] // 2) and fact(shot, "back")
    assert np.abs(view[:small.shape[0] * 2].reshape(small.shape[0], 2, -1, 2, 4).mean((1, 3)) - small).mean() < 0.01


def screenshot(shot, name):
    return oiio.ImageBuf(str(shot.folder / f"{name}.png")).get_pixels(oiio.FLOAT)[..., :3]


def test_the_screen_shows_the_picture_in_the_scene_s_colours(shot):
    """And overlays above it."""
    rows, columns = (slice(*pair) for pair in np.reshape(fact(shot, "frame on screen"), (2, 2)))
    shown, over, darker = (screenshot(shot, name)[rows, columns] for name in ("camera", "overlays", "exposure"))
    view = picture(shot, "camera")[..., :3]
    assert abs(shown.shape[0] - view.shape[0]) <= 1 and abs(shown.shape[1] - view.shape[1]) <= 1
    height, width = (min(sizes) for sizes in zip(shown.shape[:2], view.shape[:2], strict=True))
    for seen, gain in ((shown, 1), (darker, 0.5)):
        wanted = colour.encode_srgb(np.clip(view[:height, :width] * gain, 0, 1))
        away = np.abs(seen[:height, :width] - wanted).max(-1)
        assert np.median(away) < 2 / 255 and (away > 6 / 255).mean() < 0.05, gain
    drawn_over = (np.abs(over - shown).max(-1) > 0.05).mean()
    assert 0.001 < drawn_over < 0.3


def test_a_border_is_its_part_of_the_frame(shot):
    view, border = picture(shot, "camera"), picture(shot, "border")
    height, width = view.shape[:2]
    left = round(width * 0.25)
    assert border.shape[0] == height // 2
    assert apart(view[:height // 2, left:left + border.shape[1]], border)[:-8, 8:-8].mean() < 0.002


def test_a_view_that_turns_reads_nothing(shot):
    pictures, nothing_read = fact(shot, "orbit")
    assert pictures > 2 and nothing_read and fact(shot, "ortho read")
    ortho = picture(shot, "ortho")
    assert len(np.unique(ortho.reshape(-1, 4)[:, :3].round(1), axis=0)) > 3  # the cube, the ball, the ground


def test_what_takes_too_long_is_smaller_while_it_moves(shot):
    heights, at_rest = fact(shot, "smaller")
    assert heights and heights[0] <= at_rest / 4 + 1 and at_rest == picture(shot, "ortho").shape[0]


def test_a_slider_draws_and_reads_nothing(shot):
    ink = [(picture(shot, name)[..., :3].max(-1) < 0.05).sum() for name in ("thick", "thin", "style")]
    assert fact(shot, "slider read") and ink[1] < ink[0] - 1000 and ink[2] < ink[1] - 100


def test_ink_grows_under_the_brush_and_nowhere_else(shot):
    """Ink changes within the brush's circles and the reach of the thickest line, paint within them and a face."""
    before, after, red = (picture(shot, name) for name in ("unpainted", "painted", "control"))
    left, right, y, radius = fact(shot, "stroke")
    rows, columns = np.indices(before.shape[:2])
    far = np.hypot(np.maximum(np.maximum(left - columns, columns - right), 0), rows - y) - radius
    changed, face = apart(before, after), before.shape[0] / 48
    assert changed.sum() > 50 and fact(shot, "while painting") > 0
    assert fact(shot, "read for a stroke") == ["Cube"]
    assert far[changed].max() < face + 128 / 1080 * before.shape[0] / 2  # Maximum Thickness
    assert (after[changed][:, :3].max(-1) < 0.05).mean() > 0.3 > (before[changed][:, :3].max(-1) < 0.05).mean()
    painted = red[..., 0] > 2 * red[..., 1]
    assert painted.sum() > 50 and far[painted].max() < face


def test_what_else_is_shown(shot):
    ink, sources, levels, styles = (picture(shot, name)[..., :3] for name in ("ink", "edges", "levels", "styles"))
    assert (ink.min(-1) == 1).mean() > 0.7 and 0.01 < (ink.max(-1) < 0.1).mean() < 0.2
    red, blue = (sources[..., 0] > 2 * sources[..., 2]), (sources[..., 2] > 2 * sources[..., 0])
    assert red.sum() > 200 and blue.sum() > 200  # outlines, creases
    _, pixels = np.unique(levels.reshape(-1, 3).round(3), axis=0, return_counts=True)
    assert 2 < (pixels > 300).sum() < 8 and np.sort(pixels)[-4:].sum() > 0.8 * pixels.sum()  # flat tones
    assert np.ptp(styles, axis=-1).max() < 1e-6  # grey: all have the scene's


def test_undo_is_seen(shot):
    assert apart(picture(shot, "moved"), picture(shot, "undone")).sum() > 200
    assert (picture(shot, "undone") == picture(shot, "painted")).all()


def test_what_is_wrong_is_said(shot):
    assert fact(shot, "sentence").startswith("paper_image: ") and fact(shot, "mended") is None
    below = screenshot(shot, "broken")[450:]  # the frame, which has red in it
    red = (below[..., 0] > 0.6) & (below[..., 1] < 0.55) & (below[..., 2] < 0.55)
    around = below[tuple(slice(at.min(), at.max()) for at in np.nonzero(red))]
    assert red.sum() > 500 and np.median(around.max(-1)) < 0.1  # Blender's own ground there is 0.16


def test_playback_draws(shot):
    assert fact(shot, "played") > 1
    assert apart(picture(shot, "first"), picture(shot, "last")).sum() > 500


def test_memory_stays_flat(shot):
    pictures, before, after = fact(shot, "memory")
    assert pictures >= 1000 and after < 1.02 * before


def test_what_is_hidden_is_not_there(shot):
    assert apart(picture(shot, "all"), picture(shot, "without ball")).sum() > 500
    clear = picture(shot, "transparent")[..., 3] < 0.5
    assert 0.1 < clear.mean() < 0.9 and (picture(shot, "all")[..., 3] > 0.99).all()


def test_a_window_of_another_size(shot):
    large, small, again = (picture(shot, name) for name in ("large window", "small window", "large again"))
    for name, shown in ("small window", small), ("large again", again):
        assert list(shown.shape[1::-1]) == fact(shot, name)
        assert len(np.unique(shown.reshape(-1, 4)[:, :3].round(1), axis=0)) > 3  # the cube, the ball, the ground
    assert small.shape[1] < large.shape[1] and np.array_equal(large, again)


def test_edit_mode_is_seen(shot):
    before, entered, edited, left = (picture(shot, name) for name in
                                     ("not edited", "edit mode", "edited", "edit mode left"))
    assert (before == entered).all() and (edited == left).all()
    assert apart(entered, edited).sum() > 200


def test_two_views_at_once(shot):
    camera, free, regions = fact(shot, "views")
    assert len(regions) == 2 and free in regions and regions[0] != regions[1]
    assert camera[1] < min(height for _, height in regions)  # the frame lies within its region
    assert fact(shot, "views left") == 1


def test_a_pinned_pattern_stays_in_the_view(shot):
    """At rest it changes nothing; of a mesh that is bent then, letting go moves it."""
    assert fact(shot, "pin") == ["FINISHED"] and fact(shot, "pinned") == [None]
    assert (picture(shot, "unpinned") == picture(shot, "pinned")).all()
    assert apart(picture(shot, "pinned"), picture(shot, "bent")).sum() > 2000
    assert 200 < apart(picture(shot, "bent"), picture(shot, "let go")).sum() < 5000


def test_two_windows_and_a_render_at_once(shot):
    views, failures, beside = fact(shot, "together")
    assert views == 2 and failures == [None, None] and beside > 0
    alone, together = (oiio.ImageBuf(str(shot.folder / f"{name}.png")).get_pixels() for name in ("alone", "together"))
    assert np.array_equal(alone, together) and alone.std() > 0.1


@pytest.mark.long
def test_memory_stays_flat_for_long(tmp_path):
    shot = look(tmp_path, ENCRE_REDRAWS="10000")
    pictures, before, after = fact(shot, "memory")
    assert fact(shot, "finished") and pictures >= 10000 and after < 1.02 * before


def test_cycles_shows_its_own_view(shot):
    assert fact(shot, "with Cycles") == [0] and fact(shot, "without Cycles") == 1
