# SPDX-License-Identifier: GPL-3.0-or-later
"""The first scene in every Blender: its picture, its file, and what each painted control changes in it."""

from pathlib import Path

import blenders
import exr
import numpy as np
import pytest
from encre.cli import composite, multilayer
from encre.pen import layers, library, metadata, saved
from encre.pen.settings import Settings

pytestmark = pytest.mark.slow

STREET = Path(__file__).parents[2] / "scenes" / "street.py"


@pytest.fixture(params=blenders.params(), scope="module")
def street(request, tmp_path_factory):
    """The scene's EXR, 480 x 270."""
    folder = tmp_path_factory.mktemp("street")
    blenders.encre(request.param, folder, "render", STREET, "-o", folder / "street.exr", "--size", "480x270",
                   "--samples", "2")
    return folder / "street.exr"


@pytest.fixture(scope="module")
def kept(street):
    """(layers, settings) of the file."""
    with multilayer.Exr(str(street)) as file:
        settings = metadata.read(file.metadata)
        passes = file.read(composite.view_layers(file.channels)["ViewLayer"][""])
    return layers.assemble(dict(passes), Settings(settings.scene), saved.unpack(passes))[0], settings


def test_the_file_has_all_passes_and_gives_the_picture_again(street, tmp_path):
    for name in (*layers.DRAWN, *saved.passes(())):
        assert exr.part(street, f"ViewLayer.{name}").shape[:2] == (270, 480)
    blenders.encre("bpy", tmp_path, "composite", street, "-o", tmp_path / "again.exr")
    picture = exr.part(street, "ViewLayer.Combined")
    assert np.abs(exr.part(tmp_path / "again.exr", "ViewLayer.Combined") - picture).max() <= 1e-5
    lines, surface = exr.part(street, "ViewLayer.Encre Lines"), exr.part(street, "ViewLayer.Encre Surface")
    assert np.abs(surface * (1 - lines[..., 3:]) + lines - picture).max() <= 1e-6
    assert 0.03 < (lines[..., 3] > 0.5).mean() < 0.3


def test_much_is_in_it(kept):
    objects = kept[0]["object"]
    assert len(np.unique(objects[objects > 0])) >= 25


@pytest.mark.parametrize(("control", "far"), [
    ("thickness", 12), ("intensity", 12), ("smudge_range", 0), ("hatching", 0)])
def test_each_painted_control_changes_its_region_alone(kept, control, far):
    """No pixel changes farther than `far` pixels from what is painted: lines reach out, surfaces do not."""
    pictures, settings = kept
    k = list(library.controls()).index(control)
    neutral = pictures["controls"].copy()
    neutral[..., k] = 0
    with_it, without = (
        library.render({**pictures, "controls": controls}, settings.scene, [], settings.camera, settings.frame).images
        for controls in (pictures["controls"], neutral))
    changed = np.abs(with_it["Combined"] - without["Combined"]).max(-1) > 1e-3
    reach = np.zeros_like(changed)
    ys, xs = np.nonzero(pictures["controls"][..., k])
    for dy in range(-far, far + 1):
        for dx in range(-far, far + 1):
            reach[np.clip(ys + dy, 0, 269), np.clip(xs + dx, 0, 479)] = True
    assert changed.sum() > 40
    assert not (changed & ~reach).any() and reach.mean() < 0.9


def test_a_strangers_file_renders(data, tmp_path):
    """Its world image is missing and it has no lamp: a black head, and its ink."""
    blenders.encre("bpy", tmp_path, "render", data / "suzanne.blend", "-o", tmp_path / "suzanne.exr",
                   "--size", "640x360", "--samples", "1")
    ink = exr.part(tmp_path / "suzanne.exr", "RenderLayer.Encre Lines")[..., 3]
    assert 0.003 < (ink > 0.5).mean() < 0.1
