# SPDX-License-Identifier: GPL-3.0-or-later
"""Rendered lines in a mirror and through a pane, against the same things rendered without them."""

from pathlib import Path

import blenders
import exr
import numpy as np
import pytest
from encre.cli import composite, multilayer
from encre.pen import layers, library, metadata, saved
from encre.pen.settings import Settings

pytestmark = pytest.mark.slow

SCENE = Path(__file__).parents[1] / "blender" / "inside" / "glass.py"
PEN = dict(edge_detector="FINE", edge_threshold=0.3, line_color_strength=1.0, line_thickness=2.0, length_unit="PIXELS",
           line_outline_width=1.0, line_inner_width=1.0, line_crease_width=1.0, line_color_width=1.0,
           pen_1_softness=0.0, pen_1_grain=0.0,
           pen_1_steepness=0.5, pen_1_intensity=2.0, use_shading=False, use_smudging=False, use_hatching=False,
           crease_source="LAYERS",  # no mesh tells of creases in a mirror: the open view has them from the normals too
           line_shortest=0.0)  # of a line behind glass noise may leave pieces that meet no other


def rendered(blender, folder, kind, size="480x270", samples=8):
    """(passes, settings) of the file."""
    script, frame = folder / f"{kind}.py", folder / f"{kind}.exr"
    script.write_text(f"import runpy\nrunpy.run_path({str(SCENE)!r})['build']({kind!r})\n")
    words = blenders.encre(blender, folder, "render", script, "-o", frame, "--size", size, "--samples", samples,
                           "--set", "use_shading=off")
    assert "warning" not in words, words
    with multilayer.Exr(str(frame)) as file:
        return file.read(composite.view_layers(file.channels)["ViewLayer"][""]), metadata.read(file.metadata)


def ink(shot):
    passes, settings = shot
    made, _ = layers.assemble(dict(passes), Settings(PEN), saved.unpack(passes))
    return library.render(made, PEN, (), settings.camera, settings.frame, outputs=("Encre Lines",)).images[
        "Encre Lines"][..., 3] > 0.5


def reach(mask):
    """The pixels at most one away."""
    wide = np.pad(mask, 1)
    return wide[1:-1, 1:-1] | wide[:-2, 1:-1] | wide[2:, 1:-1] | wide[1:-1, :-2] | wide[1:-1, 2:]


def shares(one, two, where):
    """Of one's ink the share that lies within a pixel of the other's, and the other way round."""
    return [(reach(b) & a & where).sum() / (a & where).sum() for a, b in ((one, two), (two, one))]


def inner(mask, rim=4):
    for _ in range(rim):
        mask = ~reach(~mask)
    return mask


@pytest.fixture(scope="module")
def shots(tmp_path_factory):
    folder = tmp_path_factory.mktemp("glass")
    return {kind: rendered("bpy", folder, kind, samples=8 if kind.startswith("MIRROR") else 16)
            for kind in ("MIRROR", "MIRRORED", "PANE", "OPEN")}


def test_a_mirror_shows_what_the_mirrored_camera_sees(shots):
    silver = inner((shots["MIRROR"][0]["GlossCol"] > 0.5).all(-1))
    truth = ink(shots["MIRRORED"])[:, ::-1]
    assert silver.mean() > 0.3 and (truth & silver).sum() > 2000
    assert min(shares(ink(shots["MIRROR"]), truth, silver)) >= 0.95


def test_a_pane_hides_and_adds_little(shots):
    pane = (shots["PANE"][0]["TransCol"] > 0.5).any(-1)
    through, open_ = ink(shots["PANE"]), ink(shots["OPEN"])
    ours, theirs = shares(through, open_, inner(pane))
    assert ours >= 0.95 and theirs >= 0.95
    away = inner(~pane)
    assert np.array_equal(through & away, open_ & away)


@pytest.mark.parametrize("blender", blenders.params())
@pytest.mark.parametrize("kind", ["MIRROR", "ORTHO"])
def test_what_is_seen_in_every_blender(blender, kind, tmp_path):
    """Off the mirror it is the surface itself: its normal in the camera's space, its depth on the view axis."""
    passes, settings = rendered(blender, tmp_path, kind, "240x135", 4)
    made, _ = layers.assemble(dict(passes), Settings(), saved.unpack(passes))
    view = np.reshape(settings.camera.view, (3, 3))
    silver = (passes["GlossCol"] > 0.5).all(-1)
    matt = inner(~silver & (made["depth"][..., 0] < 1e9), 2)
    assert matt.mean() > 0.1 and silver.mean() > 0.2
    assert np.abs(made["seen_normal"] - made["normal"] @ view.T)[matt].max() < 1e-3
    ratio = (made["seen_depth"] / made["depth"])[matt]  # of an average and the pixel's centre
    assert abs(np.median(ratio) - 1) < 1e-3 and np.quantile(np.abs(ratio - 1), 0.75) < 0.02
    assert (made["seen_depth"] > 1.1 * made["depth"])[inner(silver)].mean() > 0.5  # the rest is sky
    assert (np.linalg.norm(made["seen_color"] - made["albedo"], axis=-1)[matt] < 0.02).mean() > 0.95
    edges = exr.part(tmp_path / f"{kind}.exr", "ViewLayer.Encre Edges")[..., 0]
    assert (edges[inner(silver)] > 0.5).mean() > 0.01


def test_passes_are_there_only_where_they_are_needed(tmp_path):
    script = tmp_path / "off.py"
    script.write_text(f"import bpy, runpy\nrunpy.run_path({str(SCENE)!r})['build']('MIRROR')\n"
                      "layer = bpy.context.view_layer\nassert not layer.cycles.denoising_store_passes\n")
    for change in ("line_mirror_strength=0", "edge_detector=SOBEL"):
        blenders.encre("bpy", tmp_path, "render", script, "-o", tmp_path / "off.exr", "--size", "64x36", "--samples", 1,
                       "--set", change)
        with multilayer.Exr(str(tmp_path / "off.exr")) as file:
            found = {name for name in composite.view_layers(file.channels)["ViewLayer"][""]}
        assert not found & {*layers.SEEN, "Encre Seen Depth"} and {*saved.passes(())} <= found


@pytest.mark.parametrize("blender", blenders.params())
@pytest.mark.parametrize("kind, clear", [("SATIN", False), ("LACQUER", True)])
def test_blurred_mirrors_show_themselves(blender, kind, clear, tmp_path):
    """What they mirror is noise, of which no line is worth drawing; a clear coat on them mirrors clearly."""
    passes, settings = rendered(blender, tmp_path, kind, "240x135", 4)
    made, _ = layers.assemble(dict(passes), Settings(), saved.unpack(passes))
    view = np.reshape(settings.camera.view, (3, 3))
    silver = inner((passes["GlossCol"] > 0.5).all(-1), 2)
    assert silver.mean() > 0.2
    apart = (np.abs(made["seen_normal"] - made["normal"] @ view.T).max(-1) > 0.01)[silver].mean()
    far = (np.abs(made["seen_depth"] / made["depth"] - 1) > 0.01)[..., 0][silver].mean()
    assert (apart > 0.1 and far > 0.5) if clear else (apart == 0 and far == 0)
