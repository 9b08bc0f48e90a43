# SPDX-License-Identifier: GPL-3.0-or-later
"""The engine in Blender: each case of blender/cases.py is rendered in a process of its own and its pixels looked at."""

import json
import shutil
import subprocess
from pathlib import Path

import exr
import numpy as np
import pytest
from encre.cli import multilayer
from encre.cli.composite import composite
from encre.pen import layers, library, metadata, saved
from encre.pen.settings import Settings
from known import KIND


def over(lines, surface):
    return np.concatenate([surface[..., :3] * (1 - lines[..., 3:]) + lines[..., :3],
                           surface[..., 3:] + lines[..., 3:] * (1 - surface[..., 3:])], 2)


def test_passes_that_nobody_looks_at_are_not_rendered(render):
    facts = render("drawn_once").facts
    (once, picture), (every, same) = facts["once"][0], facts["all"][0]
    assert {layers.classic(name) for name in every} - {layers.classic(name) for name in once} == {
        "GlossDir", "GlossInd", "DiffInd"}
    assert picture == same


def test_picture(render):
    shot = render("picture")
    found = shot.passes("picture")
    assert found.keys() >= layers.CYCLES.keys() | layers.DRAWN.keys() | saved.passes(()).keys()
    assert "Unknown pass" not in shot.output and shot.facts["aovs"] == [0]
    (read,) = shot.facts["read"]
    assert read and len(set(read)) == len(read), f"passes are read more than once: {read}"
    assert found["Encre Lines"][..., 3].max() > 0.9  # there is ink
    assert np.abs(over(found["Encre Lines"], found["Encre Surface"]) - found["Combined"]).max() < 1e-6
    assert np.abs(found["Combined"] - found["Encre Source"]).max() > 0.1
    # The user's numbers are in the pass that the user asked for; automatic ones in ours.
    assert set(np.unique(found["IndexOB"])) == {0, 7}
    assert len(np.unique(found["Encre Index"][..., 0])) == 4
    assert shot.facts["pass_index"][0].count(7) == 1
    # The same from what the file holds.
    settings = metadata.read(shot.metadata("picture"))
    images, nonfinite = layers.assemble(dict(found), Settings(settings.scene, settings.styles), saved.unpack(found))
    (lines,) = settings.chains.values()
    again = library.render(images, settings.scene, camera=settings.camera, frame=settings.frame, chains=lines,
                           outputs=("Combined", *layers.DRAWN))
    assert nonfinite + again.nonfinite == 0
    for name, picture in again.images.items():
        assert np.abs(picture - found[name]).max() <= 1e-5, name


def test_all_off_is_cycles(render):
    for case in ("factory", "cycles"):
        shot = render(case)
        cycles, off = shot.passes("cycles"), shot.passes("off")
        assert cycles["Combined"].tobytes() == off["Combined"].tobytes()
        assert shot.facts["done"] == [[]] and not [name for name in off if name.startswith("Encre")]
    asked, kept = shot.passes("asked"), shot.passes("kept")
    for found in (asked, kept):
        assert found["Combined"].tobytes() == cycles["Combined"].tobytes()
    assert asked["Encre Surface"].tobytes() == asked["Combined"].tobytes() and asked["Encre Lines"].max() == 0
    assert kept.keys() >= saved.passes(()).keys() and not kept.keys() & layers.DRAWN.keys()
    assert len(np.unique(kept["Encre Index"][..., 0])) == 4


def test_view_layers(render):
    shot = render("view_layers")
    for layer in ("First", "Second"):
        both, alone = shot.passes("both", layer), shot.passes(layer.lower(), layer)
        for name in ("Combined", "Encre Lines", "Depth"):
            assert np.array_equal(both[name], alone[name]), name
    assert not np.array_equal(shot.passes("both", "First")["Combined"], shot.passes("both", "Second")["Combined"])


def test_border(render):
    shot = render("border")
    full, crop, border = (shot.passes(name)["Combined"] for name in ("full", "crop", "border"))
    frame = metadata.read(shot.metadata("crop")).frame
    assert (frame.width, frame.height) == (320, 240) and frame.x == 35
    height, width = crop.shape[:2]
    assert height < 240 and width < 320
    same = full[frame.y:frame.y + height, frame.x:frame.x + width]
    assert same.std() > 0.05
    assert (np.abs(crop - same).max(2) < 1 / 255).mean() >= 0.999, "up to its own edge"
    for denoiser, most, least in (("NONE", 1 / 255, 0.999), ("OIDN", 1 / 255, 0.999)):
        left, right, whole = (shot.passes(f"{name}-{denoiser}")["Combined"] for name in ("left", "right", "frame"))
        assert left.shape[1] == int(0.47 * 320) and whole.shape == full.shape
        different = np.abs(np.concatenate([left, right], 1) - whole).max(2)
        assert (different < most).mean() >= least, denoiser
    assert shot.facts["kept"] == [False]
    assert border.shape == full.shape
    assert np.array_equal(border[frame.y:frame.y + height, frame.x:frame.x + width], crop)
    placed = metadata.read(shot.metadata("border")).frame
    assert (placed.width, placed.height, placed.x, placed.y) == (320, 240, 0, 0)
    for name in "border", "crop":
        again = shot.folder / f"{name}_again.exr"
        composite(str(shot.folder / f"{name}.exr"), str(again), {})
        different = np.abs(shot.passes(f"{name}_again")["Combined"] - shot.passes(name)["Combined"]).max(2)
        if name == "border":
            different = different[frame.y:frame.y + height, frame.x:frame.x + width]
        # The file does not hold what lies around, on which its edge depends.
        assert different[64:-64, 64:-64].max() <= 1e-5 and (different > 1 / 255).mean() < 0.01


def test_resolution_percentage(render):
    shot = render("percentage")
    assert np.array_equal(shot.passes("whole")["Combined"], shot.passes("half")["Combined"])


def test_transparent_film(render):
    found = render("film").passes("film")
    alpha, ink = found["Combined"][..., 3], found["Encre Lines"][..., 3]
    nothing = found["Depth"][..., 0] > 1e9
    assert found["Encre Source"][..., 3][nothing].min() == 0
    assert alpha.min() == 0 and alpha.max() == 1
    assert ((ink > 0.5) & nothing).any(), "outlines reach over the transparent background"
    assert np.array_equal(found["Encre Surface"][..., 3] == 0, found["Encre Source"][..., 3] == 0)


def test_tiles(render):
    shot = render("tiles")
    assert np.abs(shot.passes("whole")["Combined"] - shot.passes("tiles")["Combined"]).max() < 1e-4


def test_animation(render):
    shot = render("animation")
    for name in ("once", "persistent"):
        ink = [shot.passes(f"{name}-{frame:04}")["Encre Lines"][..., 3] for frame in (1, 2, 3)]
        assert ink[1].max() == 0 and ink[0].max() > 0.9 and ink[2].max() > 0.9
        assert np.abs(ink[0] - ink[2]).max() > 0.5
    still = shot.passes("second")["Combined"]
    assert np.array_equal(still, shot.passes("once-0002")["Combined"])
    assert np.array_equal(still, shot.passes("persistent-0002")["Combined"])
    assert shot.output.count("Warning: depth of field") <= 3  # two animations and a still


def test_overrides_do_not_stay(render):
    shot = render("switches_animated")
    cycles = shot.passes("cycles")
    for name in ("once", "persistent"):
        second = shot.passes(f"{name}-0002")
        assert np.array_equal(second["Combined"], cycles["Combined"]), name
        assert set(np.unique(second["IndexOB"])) == {0, 7}


def test_blur_is_off(render):
    shot = render("blur")
    assert np.array_equal(shot.passes("sharp")["Combined"], shot.passes("blurred")["Combined"])
    assert shot.output.count("depth of field and motion blur: rendered without") == 2, "by Cycles and by Encre alone"
    assert shot.facts["kept"] == [[True, True]]


def test_settings_are_read_once(render):
    # The user's say which passes there are, before anything is evaluated; the evaluated ones all else.
    assert render("read_once").facts["evaluated"] == [[False, True]]


@pytest.mark.slow
def test_memory_of_a_frame(render):
    """numpy counts its pictures with Python's memory. At most there are the 16 layers and what they are put together
    from; pictures that nobody asked for are not made. (In one so low the strips of even() are nearly all of it.)"""
    facts = render("memory").facts
    assert all(held < 23 + 4 * len(library.controls()) * painted for painted, held in enumerate(facts["held"]))
    plain, painted = facts["peak"]
    assert plain <= 177 and painted <= 205, facts
    assert max(facts["left"]) < 1


def test_cameras(render):
    facts = render("cameras").facts
    assert len(facts) >= 14
    pixels, wrong = (sum(fact[0][k] for fact in facts.values()) for k in (0, 1))
    assert wrong < 0.0005 * pixels, facts
    assert all(fact[0][3] > 1000 and fact[0][1] < 0.002 * fact[0][0] for fact in facts.values()), facts
    assert all(fact[0][2] < 2e-3 for fact in facts.values()), facts


def test_kinds_of_objects(render):
    facts = render("kinds").facts
    # Nothing, cube, ball and ground, and then what each case adds.
    wanted = {"particles": 30, "instanced texts": 8, "nodes: geometry": 17, "nodes: objects": 17, "nodes: realized": 5,
              "curve, metaball, heptagon, subdivision": 7, "not for the camera": 5}
    assert facts.keys() == wanted.keys()
    for name, ((mismatch, numbers),) in facts.items():
        assert mismatch <= 0.0005 * 200 * 106, name
        assert numbers >= wanted[name] if name == "particles" else numbers == wanted[name], name


def test_stereo(render):
    shot = render("stereo")
    assert shot.facts["error"] == [None]
    assert len(shot.facts["mismatch"]) == 2 and max(shot.facts["mismatch"]) < 0.002
    written = sorted(path.name for path in shot.folder.glob("stereo*.exr"))
    assert written


def test_object_numbers(render):
    shot = render("numbers")

    def objects(name):
        found = shot.passes(name)
        return found["Encre Index"][..., 0], found["IndexOB"][..., 0]

    index, user = objects("automatic")
    assert len(np.unique(index)) == 6, "nothing, cube, ball, ground and two instances of one cube"
    assert set(np.unique(user)) == {0, 7}
    cube = user == 7
    assert len(np.unique(index[cube])) == 1
    index, user = objects("group")
    assert len(np.unique(index)) == 5 and np.array_equal(user == 7, cube)
    index, user = objects("pass")
    assert np.array_equal(index, user) and np.array_equal(user == 7, cube)
    # The cube's strength is its own index, which therefore is not ours.
    index, user = objects("reads")
    assert set(np.unique(user)) == {0, 7}
    assert len(np.unique(index)) == 5
    assert abs(np.median(shot.passes("reads")["Emit"][cube]) - 7) < 0.1


def test_lines_by_hand(render):
    shot = render("by_hand")
    found = shot.passes("marked")
    points = shot.chains("marked")
    hands = points[points["kind"] == KIND["mark"]]
    # 35 mm on 36: a point at x stands at 80 + 160 * 50 / 36 * x / depth.
    column = [80 - 0.5 + 160 * 50 / 36 * x / 6.5 for x in (-0.8, 0.8)]
    for x, rows in zip(column, (np.s_[56:80], np.s_[10:80]), strict=True):
        own = hands[np.abs(hands["x"] - x) < 0.01]
        assert own["y"].min() < rows.start and own["y"].max() > rows.stop, x
        ink = found["Encre Lines"][rows, int(x) - 5:int(x) + 7, 3].astype(float)
        assert np.allclose((ink * np.arange(-5, 7)).sum(1) / ink.sum(1), x - int(x), atol=0.15)
    left = hands[np.abs(hands["x"] - column[0]) < 0.01]
    assert not ((left["y"] > 25) & (left["y"] < 40)).any(), "behind the cube"
    assert len(hands) == len(left) + (np.abs(hands["x"] - column[1]) < 0.01).sum()
    thin = shot.passes("thin")["Encre Lines"][..., 3]
    for x in column:
        assert thin[60, int(x) - 5:int(x) + 7].sum() < 0.6 * found["Encre Lines"][60, int(x) - 5:int(x) + 7, 3].sum()
    for change, most in (({}, 1e-5), ({"line_mark_strength": 0.0}, 1)):
        again = shot.folder / "again.exr"
        composite(str(shot.folder / "marked.exr"), str(again), change)
        other = shot.passes("again")["Encre Lines"][..., 3]
        assert np.abs(other - found["Encre Lines"][..., 3]).max() <= most
    assert not other[60, int(column[1]) - 3:int(column[1]) + 5].any()

    numbers = {name: shot.passes(name)["Encre Index"][..., 0] for name in
               ("whole", "parts", "parts-pass", "attribute", "pieces", "separate")}
    count = {name: len(np.unique(index)) for name, index in numbers.items()}
    assert count == {"whole": 4, "parts": 6, "parts-pass": 3, "attribute": 5, "pieces": 4, "separate": 5}
    finished, cancelled = ["FINISHED"], ["CANCELLED"]  # without a selected face
    assert shot.facts["mark"] == [finished, finished, cancelled, finished, finished]
    assert shot.facts["parts"] == [[0, 1, 2]] and shot.facts["next"] == [3]
    assert shot.facts["refused"][0].startswith("Error: Ball: its attribute encre_part holds no whole numbers of faces;")
    ink = {name: shot.passes(name)["Encre Lines"][..., 3].sum() for name in numbers}
    for more, less in (("parts", "whole"), ("attribute", "whole"), ("separate", "pieces")):
        assert ink[more] > ink[less] + 40, more


def test_clipped_leaves(render):
    found = render("leaves").passes("leaves")
    index, thickness = found["Encre Index"][..., 0], found["Encre Line Controls"][..., 0]
    assert set(np.unique(thickness)) == {-0.5, 0, 0.5}
    leaf = thickness == 0.5
    assert leaf.sum() > 500 and len(np.unique(index[leaf])) == 1
    assert (index == index[leaf][0]).sum() == leaf.sum()
    # Through a hole the cube is seen, without the leaf's control; beside the leaf it has its own.
    cube = index == index[thickness == -0.5][0]
    assert (cube & (thickness == 0)).any()
    assert len(np.unique(index)) == 4


def test_painted_controls(render):
    found = render("controls").passes("controls")
    thickness, hatching = found["Encre Line Controls"][..., 0], found["Encre Surface Controls"][..., 2]
    index = found["Encre Index"][..., 0]
    order = list(dict.fromkeys(index[index.shape[0] // 2][index[index.shape[0] // 2] > 0]))
    assert len(order) == 6
    for number, value, k in zip(order, (1, 0, -1, 0.25, -0.5, 3), range(6), strict=True):
        here = index == number
        assert np.abs(thickness[here] - value).max() < 1e-5
        assert np.abs(hatching[here] - (0.5 + 0.125 * k)).max() < 1e-6
    assert not thickness[index == 0].any()


def test_denoised_light(render):
    shot = render("denoised")
    if not shot.facts["available"][0]:
        assert shot.output.count("Open Image Denoise is not there") >= 1
        return
    clean, noisy = shot.passes("denoised"), shot.passes("noisy")

    def speckle(picture):
        return np.abs(np.diff(picture, axis=1)).mean()

    assert speckle(clean["Encre Diffuse"]) < 0.5 * speckle(noisy["Encre Diffuse"])
    assert speckle(clean["Encre Source"]) < 0.5 * speckle(noisy["Encre Source"])
    assert abs(clean["Encre Diffuse"].mean() / noisy["Encre Diffuse"].mean() - 1) < 0.05
    assert shot.facts["kept"] == [True]


def test_no_stripes_along_the_frame(render):
    """Light that is just above a level's threshold everywhere: what noise the denoiser leaves is inked."""
    shot = render("stripes")
    if "Open Image Denoise is not there" in shot.output:
        return
    small, large = (shot.passes(name)["Encre Lines"][..., 3] for name in ("small", "large"))
    middle = large[90:180, 80:240]
    ring = np.ones(small.shape, bool)
    ring[3:-3, 3:-3] = False
    assert middle.shape == small.shape and small[ring].sum() <= middle[ring].sum() + 0.5
    assert small[~ring].sum() <= middle[~ring].sum() + 0.5


def test_shadow_catchers_have_no_lines(render):
    shot = render("catcher")
    caught, without = (shot.passes(name) for name in ("caught", "without"))
    assert np.abs(caught["Combined"][..., 3] - without["Combined"][..., 3]).max() > 0.3, "there is a shadow"
    assert np.abs(caught["Encre Lines"] - without["Encre Lines"]).max() < 1e-3
    composite(str(shot.folder / "caught.exr"), str(shot.folder / "again.exr"), {})
    assert np.abs(shot.passes("again")["Combined"] - caught["Combined"]).max() <= 1e-5


def test_mirrors_show_lines_whatever_the_user_switched_off(render):
    shot = render("reflections")
    on = shot.passes("on")
    seen = np.abs(on["Encre Seen Depth"] - on["Depth"])[on["Depth"] < 1e9]
    assert (seen > 1).mean() > 0.05, "there is something in the mirror"
    if shot.wrote("off"):  # 5.2 and later
        assert np.array_equal(shot.passes("off")["Combined"], on["Combined"])
        assert shot.facts["kept"] == [False]


def test_direct_light(render):
    found = render("direct").passes("direct")
    assert np.array_equal(found["Encre Diffuse"], found["DiffDir"])
    assert found["DiffInd"].max() > 0.01
    color = found["DiffCol"]
    other = found["Encre Source"][..., :3] - color * found["DiffDir"]
    assert np.percentile(np.abs(other - found["GlossCol"] * (found["GlossDir"] + found["GlossInd"])), 99) < 0.06


def test_styles(render):
    shot = render("styled")
    found = shot.passes("styled")
    style = found["Encre Index"][..., 2]
    assert set(np.unique(style)) == {0, 1, 2}
    ball = (style == 2) & (found["Encre Lines"][..., 3] == 0) & (found["Encre Light"][..., 0] >= 0)
    assert ball.sum() > 100
    settings = metadata.read(shot.metadata("styled"))
    assert settings.styles == [("Bare", {"use_lines": False}), ("Flat", {"use_shading": False})]


def test_compositor(render):
    shot = render("compositor")
    plain = shot.passes("plain")
    with multilayer.Exr(shot.folder / "composite-combined.exr") as file:
        assert any(name.startswith("Composite") for name in file.channels), list(file.channels)
    for name, wanted in (("combined", plain["Combined"]), ("light", plain["Encre Light"])):
        composite = shot.passes(f"composite-{name}", "Composite")["Combined"]
        assert np.abs(composite[..., :3] - wanted[..., :3]).max() < 1e-5, name


def test_save_layers(render):
    shot = render("saved")
    assert shot.passes("on").keys() >= saved.passes(()).keys()
    assert shot.passes("auto").keys() >= saved.passes(()).keys()
    assert not shot.passes("off").keys() & saved.passes(()).keys()
    assert json.loads(shot.metadata("off")["encre.params"])["scene"]["save_layers"] == "OFF"


def test_slim_files_of_a_window_have_no_noise_that_nobody_reads(render, tmp_path):
    shot = render("saved")
    whole, slim, asked = (shot.passes(name) for name in ("on", "slim", "asked"))
    for name in ("DiffDir", "DiffInd", "Denoising Depth"):
        assert whole[name].any() and not slim[name].any()
    assert np.array_equal(asked["DiffDir"], whole["DiffDir"]) and not asked["DiffInd"].any()
    assert np.array_equal(slim["Combined"], whole["Combined"])
    sizes = [(shot.folder / f"{name}.exr").stat().st_size for name in ("slim", "on")]
    assert sizes[0] < 0.9 * sizes[1], sizes
    composite(str(shot.folder / "slim.exr"), str(tmp_path / "again.exr"), {})
    assert np.abs(exr.part(tmp_path / "again.exr", "ViewLayer.Combined") - slim["Combined"]).max() < 1e-5


def test_scene_is_untouched(render):
    assert render("untouched").facts["changed"] == [[]]


def test_memory_is_freed(render):
    shot = render("sessions")
    assert shot.facts["made"][0] >= 3 and shot.facts["freed"] == shot.facts["made"]


def test_not_finite(render):
    shot = render("nonfinite")
    assert shot.facts["error"] == [None]
    assert shot.output.count("were not finite") == 1
    assert np.isfinite(shot.passes("nonfinite")["Combined"]).all()


def test_freestyle_and_bake(render):
    shot = render("freestyle")  # without a line style it says so itself, with a traceback
    assert shot.facts["error"] == [None, None] and "engine.py" not in shot.output
    for name in "freestyle", "named":
        assert shot.passes(name)["Encre Lines"].max() > 0.9, name
    assert shot.facts["drawn"] == [2], "not on the strokes' own scene"
    shot = render("bake")
    assert shot.facts["baked"][0] > 0.5
    assert np.array_equal(shot.passes("before")["Combined"], shot.passes("after")["Combined"])


@pytest.mark.slow
@pytest.mark.skipif(not shutil.which("blender"), reason="needs the program blender")
def test_nothing_is_left_of_what_passes_for_meshes():
    script = Path(__file__).parent / "inside" / "left.py"
    done = subprocess.run(["blender", "-b", "--factory-startup", "--debug-memory", "-P", script], capture_output=True,
                          text=True, errors="replace", timeout=300, stdin=subprocess.DEVNULL)
    assert "drawn" in done.stdout and "Not freed" not in done.stdout + done.stderr, done.stdout[-2000:]
