# SPDX-License-Identifier: GPL-3.0-or-later
"""Slim files: what is packed comes back, as exactly as restyling needs it."""

import drawn
import exr
import numpy as np
import pytest
from cube import encre, script, works
from encre.cli import composite, multilayer, planes
from encre.pen import metadata, saved, slim
from encre.pen.job import Camera, Frame

SIZE = 80, 56


@pytest.fixture
def passes():
    """Lights as bright as suns, rims of normals, a mirror below, and what no camera saw."""
    scene = drawn.scene(*SIZE)
    random = np.random.default_rng(4)
    made = {**exr.passes(scene), **exr.saved(scene)}
    made = {name: np.array(picture, np.float32) for name, picture in made.items()}
    for name in "Encre Source", "Encre Diffuse", "Combined":
        made[name][:8, :, :3] = 2 ** random.uniform(-14, 15.5, (8, SIZE[0], 3))
    made["Encre Diffuse"][8, :4] = np.inf, np.nan, 1e9
    made["Normal"] = random.normal(size=(SIZE[1], SIZE[0], 3)).astype(np.float32)
    made["Normal"] /= np.linalg.norm(made["Normal"], axis=2, keepdims=True)
    made["Normal"][20:30] *= np.float32(random.uniform(0, 0.98, (10, SIZE[0], 1)))
    made["Normal"][0, 0] = 0
    turn = np.reshape(CAMERA.view, (3, 3)).T * (1, 1, -1)
    made["Denoising Normal"] = (made["Normal"] @ turn).astype(np.float32)
    made["Denoising Normal"][40:] = random.normal(size=(16, SIZE[0], 3))
    made["Denoising Normal"][50:] = 0  # the mirror shows the sky
    made["Denoising Albedo"] = np.array(made["DiffCol"])
    made["Denoising Albedo"][40:] = random.uniform(0, 1, (16, SIZE[0], 3))
    return made


ANGLE = 0.7
CAMERA = Camera((1, 0, 0, 0, np.cos(ANGLE), np.sin(ANGLE), 0, -np.sin(ANGLE), np.cos(ANGLE)))


def packed(tmp_path, passes, camera, layout, keep=()):
    stored = metadata.write({}, [], camera or Camera(), Frame(*SIZE))
    if not camera:
        del stored[metadata.CAMERA]
    exr.write(tmp_path / "whole.exr", passes, layout, metadata=stored)
    with multilayer.Exr(tmp_path / "whole.exr") as whole:
        multilayer.rewrite(whole, str(tmp_path / "slim.exr"), composite.packer(whole, keep))
    with multilayer.Exr(tmp_path / "slim.exr") as opened:
        assert opened.metadata[metadata.FRAME] == stored[metadata.FRAME]
        [eyes] = composite.view_layers(opened.channels, opened.views).values()
        pictures = opened.read(eyes[""])
    held = set(pictures)
    slim.unpack(pictures, camera)
    return pictures, held


@pytest.mark.parametrize("layout", exr.LAYOUTS)
@pytest.mark.parametrize("at_once", [1 << 29, 1])
def test_what_is_packed_comes_back(tmp_path, passes, layout, at_once, monkeypatch):
    monkeypatch.setattr(multilayer, "_AT_ONCE", at_once)
    back, held = packed(tmp_path, passes, CAMERA, layout)
    assert not {"Denoising Normal", "Denoising Albedo", "DiffDir", "DiffInd", "Denoising Depth"} & held
    assert set(slim.PASSES) <= held and not set(slim.PASSES) & set(back)

    def off(name):
        return np.abs(back[name] - passes[name].reshape(back[name].shape))

    for name in "DiffCol", "Encre Index":
        assert not off(name).any(), name
    for name in "Encre Source", "Encre Diffuse":
        assert off(name)[:8].max() <= 1 / 255 and (off(name)[:8] <= passes[name][:8] * 2.0 ** -11 + 2.0 ** -25).all()
        assert off(name)[9:].max() <= 2.0 ** -11
    odd = back["Encre Diffuse"][8, :4]
    assert (odd[:, 0] == slim.MOST_HALF).all() and np.isnan(odd[:, 1]).all() and (odd[:, 2] == slim.MOST_HALF).all()
    assert off("Normal")[20:30].max() < 1e-7 and off("Normal").max() <= 2.0 ** -12
    assert off("Denoising Normal")[40:].max() == 0 and off("Denoising Normal").max() < 1e-3
    assert off("Denoising Albedo").max() <= 2.0 ** -12
    for name, bits in ("Depth", 16), ("Encre Seen Depth", 12):
        assert (off(name)[..., 0] <= np.abs(passes[name]) * 2.0 ** -(bits + 1)).all(), name


def test_without_a_camera_or_where_asked_what_mirrors_show_stays(tmp_path, passes):
    for camera, keep in ((None, ()), (CAMERA, ("ViewLayer.Denoising Normal", "ViewLayer.Denoising Albedo"))):
        back, held = packed(tmp_path, passes, camera, "classic", keep)
        assert not {"Encre Seen Normal", "Encre Seen Color"} & held
        for name in "Denoising Normal", "Denoising Albedo":
            assert np.array_equal(back[name], passes[name]), name


def test_of_what_sticks_places_are_floats_and_the_rest_halves():
    full = {name: [f"ViewLayer.{name}.{letter}" for letter in letters] for name, letters in saved.passes().items()}
    made = slim.Packer({"ViewLayer": {"": full}}, lambda passes: passes, {}, CAMERA).parts
    kinds = {name: set(made[f"ViewLayer.{name}"].values()) for name in (*saved.ANCHOR, "Encre Tangent", "Encre Card")}
    assert {name for name, found in kinds.items() if found == {"float"}} == {"Encre Anchor", "Encre Card"}
    assert all(found == {"half"} for name, found in kinds.items() if name not in ("Encre Anchor", "Encre Card"))


@pytest.mark.parametrize("layout", exr.LAYOUTS)
@pytest.mark.parametrize("half", [False, True])
def test_planes_of_a_file_without_compression(tmp_path, passes, layout, half):
    """The same as OpenImageIO reads; a file that lacks its end, or has compression, is told from one that is whole."""
    pictures = {name: np.nan_to_num(picture, posinf=9) for name, picture in passes.items()}
    window = (3, 2, 100, 90)
    path = exr.write(tmp_path / "a.exr", pictures, layout, window=window, half=half, compression="none")
    with multilayer.Exr(path) as opened, planes.Planes(path) as found:
        for name in opened.channels:
            assert np.array_equal(found[name], opened.read({"": [name]})[""][..., 0], equal_nan=True), name
    whole = path.read_bytes()
    path.write_bytes(whole[:-1])
    with pytest.raises(ValueError, match=planes.MISSING):
        planes.Planes(path)
    for end in range(0, 400, 7):
        path.write_bytes(whole[:end] or b"x")
        with pytest.raises(ValueError):
            planes.Planes(path)
    with pytest.raises(ValueError):
        planes.Planes(exr.write(path, pictures, layout))


def test_of_a_file_that_is_mapped_the_same_is_made(tmp_path, passes):
    made = []
    for compression in "none", "zip":
        path = exr.write(tmp_path / f"{compression}.exr", passes, compression=compression)
        with multilayer.Exr(path) as whole:
            packer = composite.packer(whole)
            made.append(list(multilayer._packed(whole, packer, [[name] for name in packer.parts])))
    for one, other in zip(*made, strict=True):
        assert one.dtype == other.dtype and one.tobytes() == other.tobytes()


GLOWS_ONCE = """
cube = bpy.data.objects["Cube"]
cube.data.materials.append(bpy.data.materials.new("Glow"))
cube.data.materials[0].use_nodes = True
shader = cube.data.materials[0].node_tree.nodes["Principled BSDF"]
shader.inputs["Emission Color"].default_value, shader.inputs["Emission Strength"].default_value = (0.3, 0.2, 0.1, 1), 1
for frame, hidden in (3, False), (4, True):
    cube.hide_render = hidden
    cube.keyframe_insert("hide_render", frame=frame)
scene.render.use_persistent_data = True
"""


@pytest.mark.slow
def test_a_pass_that_is_empty_is_not_the_frame_before(tmp_path):
    """Fast layers are written straight into Blender's result, and what is 0 is not written."""
    works(encre("render", script(tmp_path, GLOWS_ONCE), "-o", tmp_path / "#.exr", "-f", "3,4",
                "--set=layer_source=ENCRE"))
    most = []
    for frame in 3, 4:
        with multilayer.Exr(tmp_path / f"{frame}.exr") as opened:
            [eyes] = composite.view_layers(opened.channels, opened.views).values()
            most.append(opened.read({"Emit": eyes[""]["Emit"]})["Emit"].max())
    assert most == [pytest.approx(0.3, abs=1e-3), 0]
