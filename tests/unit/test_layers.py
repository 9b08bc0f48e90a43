# SPDX-License-Identifier: GPL-3.0-or-later
"""Passes to layers, and the rasteriser's pictures to passes, without any Blender."""

import re
from pathlib import Path

import numpy as np
import pytest
from encre.pen import layers, library, overlay, saved
from encre.pen.errors import EncreError
from encre.pen.job import Camera, Frame
from encre.pen.settings import Settings, switches

SHAPE = (7, 9)


@pytest.fixture
def passes():
    random = np.random.default_rng(4)
    made = {name: random.random((*SHAPE, len(channels)), np.float32) for name, channels in layers.CYCLES.items()}
    made["IndexOB"] = np.floor(4 * made["IndexOB"])
    return made


def assemble(passes, scene=None, styles=(), *args):
    settings = Settings(scene, [("", values) for values in styles])
    return layers.assemble(dict(passes), settings, saved.unpack(passes), *args)


def close(a, b, tolerance=2e-6):
    assert a.shape == b.shape and np.abs(np.asarray(a, np.float64) - b).max() <= tolerance


@pytest.mark.parametrize(("values", "seen"), [
    ({}, True), (dict(other_light=0), False), (dict(other_light=0, use_tones=True, tone_mirrors=True), True),
    (dict(other_light=0, use_tones=True), False), (dict(other_light=0, tone_mirrors=True), False),
    (dict(light_denoise="NONE"), False), (dict(use_shading=False), False)])
def test_gloss_loses_its_noise_where_it_is_seen_beside_flat_light(values, seen):
    assert Settings(values).denoises_other is seen
    scene = {id_: values.pop(id_) for id_ in ("other_light", "light_denoise", "use_shading") if id_ in values}
    assert Settings(scene, [("one", values)]).denoises_other is seen


def test_layers_of_a_picture(passes):
    made, nonfinite = assemble(passes, {})
    assert nonfinite == 0 and made.keys() <= library.LAYERS.keys()
    close(made["albedo"], np.minimum(1, passes["DiffCol"] + passes["GlossCol"] + passes["TransCol"] + passes["Emit"]))
    close(made["specular"], (passes["GlossDir"] + passes["GlossInd"]) * passes["GlossCol"])
    close(made["diffuse"], passes["DiffDir"] + passes["DiffInd"])
    for layer, name in (("combined", "Combined"), ("color", "DiffCol"), ("depth", "Depth"), ("normal", "Normal"),
                        ("object", "IndexOB")):
        assert np.array_equal(made[layer], passes[name])


def test_parts_of_what_is_not_diffuse_are_taken_where_one_is_changed(passes):
    sky = np.random.default_rng(2).random((*SHAPE, 3), np.float32)
    assert not assemble({**passes, "Env": sky}, {})[0].keys() & {"highlights", "background"}
    assert "highlights" not in assemble(passes, {"other_highlights": 0, "use_shading": False})[0]
    made, _ = assemble({**passes, "Env": sky}, {"use_hatching": False}, [{"other_highlights": 0.5}])
    assert np.array_equal(made["background"], sky)
    close(made["highlights"], passes["GlossDir"] * passes["GlossCol"])
    close(made["specular"], (passes["GlossDir"] + passes["GlossInd"]) * passes["GlossCol"])
    del passes["GlossDir"]
    assert "highlights" not in assemble(passes, {"highlight_shape": 1.0})[0]


def test_what_is_seen(passes):
    assert not assemble(passes, {})[0].keys() & {"seen_color", "seen_normal", "seen_depth"}
    normal = np.random.default_rng(1).random((*SHAPE, 3), np.float32)
    more = {"Denoising Albedo": normal / 2, "Denoising Normal": normal, "Encre Seen Depth": normal[..., :1]}
    made, _ = assemble({**passes, **more}, {})
    assert np.array_equal(made["seen_normal"], normal * np.float32((1, 1, -1)))
    assert np.array_equal(made["seen_color"], more["Denoising Albedo"])
    assert np.array_equal(made["seen_depth"], more["Encre Seen Depth"])


def test_where_something_else_is_seen():
    view = (1, 0, 0, 0, 0, 1, 0, -1, 0)  # world -> camera
    flat = {"color": np.full((40, 50, 3), 0.5, np.float32), "depth": np.full((40, 50, 1), 4, np.float32),
            "normal": np.tile(np.float32((0, -1, 0)), (40, 50, 1))}
    own = {name: np.array(picture) for name, picture in layers.unmirrored(flat, view).items()}
    own["seen_color"][:, :40] += 0.01  # all but the last columns show a little else

    def seen(**changed):
        pictures = {name: np.array(picture) for name, picture in own.items()}
        for name, (place, value) in changed.items():
            pictures[name][place] = value
        return layers.sees_through({**flat, **pictures}, view)

    block = np.s_[20:24, 10:13]
    grown = np.zeros((40, 50), bool)
    grown[14:30, 4:19] = True
    assert not seen().any()
    assert np.array_equal(seen(seen_normal=(block, (0.6, 0, 0.8))), grown)
    assert seen(seen_normal=(np.s_[20:24, 33:36], (0.6, 0, 0.8)))[:, 27:].sum(1).max() == 40 - 27, "but no bare surface"
    grown[[14, 29]] = grown[:, [4, 18]] = False
    assert np.array_equal(seen(seen_depth=(block, 4.2)), grown), "in all of a 3x3"
    assert not seen(seen_depth=(block, 4.05)).any() and not seen(seen_depth=(np.s_[20:22], 8)).any(), "outlines"
    assert not seen(seen_normal=(block, 0)).any(), "a lamp"
    assert seen(seen_normal=(block, 0), seen_color=(block, 1)).any(), "a mirrored sky"
    flat["depth"][:] = 1e10
    assert not seen(seen_normal=(block, (0.6, 0, 0.8))).any()


@pytest.mark.parametrize("orthographic", [False, True])
def test_depth_of_what_is_seen(orthographic):
    """A wall across the view axis, through a shifted lens, in a border of the frame."""
    wall, near, frame = 7.0, 0.25, Frame(30, 20, 4, 5)
    scale, shift = np.array([1.6, 2.4]), np.array([0.3, -0.2])
    projection = np.diag([*scale, -1, float(orthographic)])
    projection[:2, 3 if orthographic else 2] = -shift if orthographic else shift
    y, x = np.mgrid[:SHAPE[0], :SHAPE[1]]
    ndc = np.stack([2 * (x + 4.5) / 30 - 1, 1 - 2 * (y + 5.5) / 20], -1)
    ray = np.concatenate([0 * ndc if orthographic else (ndc + shift) / scale, np.ones((*SHAPE, 1))], -1)
    length = np.linalg.norm(ray, axis=-1, keepdims=True) * (wall - near)
    length[2, 3] = 0
    depth = layers.seen_depth(length.astype(np.float32), projection, frame, near)
    assert depth[2, 3] == 0
    depth[2, 3] = wall
    close(depth, np.full((*SHAPE, 1), wall), 1e-5)


def test_seen_lines_are_wanted_only_where_they_are_drawn():
    for scene, styles, wanted in (({}, [], True), ({"line_mirror_strength": 0.0}, [], False),
                                  ({"line_mirror_strength": 0.0}, [{"line_mirror_strength": 1.0}], True),
                                  ({"edge_detector": "DOG"}, [], False),
                                  ({"use_lines": False}, [], True),
                                  ({"use_lines": False, "use_smudging": False}, [], False)):
        assert Settings(scene, [("", values) for values in styles]).wants_seen == wanted, scene


def test_what_tells_how_images_part_into_colors():
    """By it the live view and a redraw from memory know that lines must be found anew."""
    look = {"edge_detector": "FINE", "line_color_strength": 1.0, "use_lines": True}
    plain = Settings(look)
    assert plain.color_lines == Settings(look | {"shade_strength": 0.5, "line_thickness": 9.0}).color_lines
    for other in {"color_smooth": False}, {"contrast_metric": "HSL"}, {"contrast_hue": 0.3}:
        assert plain.color_lines != Settings(look | other).color_lines, other
        assert plain.layers_key != Settings(look | other).layers_key, other
    for other in {"contrast_threshold": 0.2}, {"edge_threshold": 0.9}, {"line_color_strength": 2.0}:
        assert plain.color_lines == Settings(look | other).color_lines, other
        assert plain.color_least != Settings(look | other).color_least, other
        assert plain.layers_key != Settings(look | other).layers_key, other
    assert Settings(look | {"line_color_strength": 0.0}).color_lines is None


def test_pictures_of_any_strides(passes):
    flipped = {name: np.ascontiguousarray(picture[::-1])[::-1] for name, picture in passes.items()}
    flat = {**passes, "Depth": passes["Depth"][..., 0], "IndexOB": passes["IndexOB"][..., 0]}
    for other in (flipped, flat):
        for layer, picture in assemble(other, {})[0].items():
            assert np.array_equal(picture, assemble(passes, {})[0][layer])


def test_missing_passes(passes):
    for name in ("Combined", "DiffDir", "DiffCol", "Depth", "Normal"):
        with pytest.raises(EncreError, match=f"pass {name} is missing.*GlossCol"):
            assemble({k: v for k, v in passes.items() if k != name}, {})
    few = {k: passes[k] for k in ("Combined", "DiffDir", "DiffCol", "Depth", "Normal")}
    made, _ = assemble(few, {})
    assert made.keys() == {"combined", "diffuse", "color", "albedo", "depth", "normal"}
    assert np.array_equal(made["diffuse"], passes["DiffDir"])


def test_direct_light(passes):
    made, _ = assemble(passes, {"shade_light": "DIRECT"})
    assert np.array_equal(made["diffuse"], passes["DiffDir"])
    close(made["combined"][..., :3], passes["Combined"][..., :3] - passes["DiffCol"] * passes["DiffInd"])
    assert np.array_equal(made["combined"][..., 3], passes["Combined"][..., 3])
    made, _ = assemble(passes, {"shade_light": "DIRECT", "use_shading": False})
    assert np.array_equal(made["combined"], passes["Combined"])


def test_light_by_style(passes):
    index = np.zeros((*SHAPE, 3), np.float32)
    index[:, 3:6, 2], index[:, 6:, 2], index[0, 0, 2], index[1, 0, 2] = 1, 2, 7, -1  # 7 and -1 are no styles: 0
    passes["Encre Index"] = index
    made, _ = assemble(passes, {}, [{"shade_light": "DIRECT"}, {"shade_light": "DIRECT", "use_shading": False}])
    everything = passes["DiffDir"] + passes["DiffInd"]
    close(made["diffuse"][:, :3], everything[:, :3])
    assert np.array_equal(made["diffuse"][:, 3:], passes["DiffDir"][:, 3:])
    close(made["combined"][:, :3], passes["Combined"][:, :3])
    close(made["combined"][:, 3:6, :3], (passes["Combined"][..., :3] - passes["DiffCol"] * passes["DiffInd"])[:, 3:6])
    assert np.array_equal(made["combined"][:, 6:], passes["Combined"][:, 6:])


def half(picture, albedo, normal, *surface):
    assert albedo.shape == normal.shape == picture.shape and picture.min() >= 0
    return picture / 2


def test_nothing_is_where_only_shadows_are_caught():
    shape = 4, 6
    layers = {"combined": np.ones((*shape, 4), np.float32), "depth": np.full((*shape, 1), 1e10, np.float32),
              "color": np.ones((*shape, 3), np.float32), "normal": np.ones((*shape, 3), np.float32),
              "object": np.zeros((*shape, 1), np.float32)}
    hidden = np.zeros(shape, bool)
    layers["object"][1:, 2:], layers["depth"][1:, 2:] = 3, 5
    hidden[1:, 2:5] = True  # in the last column something stands before it
    overlay.hide(layers, hidden)
    assert layers["combined"].all()
    assert np.array_equal(layers["object"][..., 0] != 0, np.indices(shape)[1] * (np.indices(shape)[0] > 0) == 5)
    assert not layers["color"][:, 1:5].any(), "beside it too, where colours are averaged"
    assert layers["color"][:, 0].all() and layers["color"][1:, 5].all()


def test_light_is_denoised_without_a_word_of_textures(passes):
    told = []
    passes["DiffCol"][1] = 0
    assemble(passes, {}, (), lambda *pictures: told.append([np.array(p) for p in pictures]) or pictures[0] / 2, True)
    (light, lit, _, depth, *_), (_, albedo, _) = told
    assert np.array_equal(depth, passes["Depth"])
    assert np.array_equal(light, passes["DiffDir"] + passes["DiffInd"])
    assert (lit == passes["DiffCol"].any(2, keepdims=True)).all() and lit[0].all() and not lit[1].any()
    assert len(np.unique(albedo)) > 2, "what is not light is guided by colours"


def test_denoised_light_is_put_back(passes):
    light, color = passes["DiffDir"] + passes["DiffInd"], passes["DiffCol"]
    rest = passes["Combined"][..., :3] - color * light
    made, _ = assemble(passes, {}, (), half)
    close(made["diffuse"], light / 2)
    close(made["combined"][..., :3], color * light / 2 + rest)
    made, _ = assemble(passes, {}, (), half, True)
    close(made["combined"][..., :3], color * light / 2 + np.maximum(rest, 0) / 2 + np.minimum(rest, 0))
    made, _ = assemble(passes, {"use_shading": False}, (), half)
    assert np.array_equal(made["combined"], passes["Combined"])
    # A style without shading keeps what was rendered, or has it denoised as Cycles would have done.
    passes["Encre Index"] = np.zeros((*SHAPE, 3), np.float32)
    passes["Encre Index"][:, 4:, 2] = 1
    styles = [{"use_shading": False, "shade_light": "DIRECT"}]
    made, _ = assemble(passes, {}, styles, half)
    assert np.array_equal(made["combined"][:, 4:], passes["Combined"][:, 4:])
    made, _ = assemble(passes, {}, styles, half, True)
    close(made["combined"][..., :3], color * light / 2 + np.maximum(rest, 0) / 2 + np.minimum(rest, 0))


def test_saved_layers_are_preferred(passes):
    for name, channels in saved.passes().items():
        passes[name] = np.full((*SHAPE, len(channels)), 0.25, np.float32)
    passes["Encre Index"] += np.arange(3, dtype=np.float32)
    made, _ = assemble(passes, {"shade_light": "DIRECT"}, (), half)
    assert np.array_equal(made["combined"], passes["Encre Source"])
    assert np.array_equal(made["diffuse"], passes["Encre Diffuse"])
    assert [made[k].mean() for k in ("object", "material", "style")] == [0.25, 1.25, 2.25]
    assert made["controls"].shape == (*SHAPE, len(library.controls()))
    del passes["Combined"], passes["DiffDir"], passes["DiffInd"]
    assert assemble(passes, {})[0]["object"].mean() == 0.25


def test_values_that_are_no_numbers(passes):
    passes["DiffDir"][1, 2] = np.nan, np.inf, 1
    passes["DiffInd"][1, 2] = 2
    passes["Combined"][3, 3, 1] = -np.inf
    passes["Depth"][0, 0] = np.nan
    made, found = assemble(passes, {"shade_light": "DIRECT"})
    assert found == 3
    assert made["diffuse"][1, 2].tolist() == [0, 0, 1]
    assert np.isfinite(made["combined"]).all()
    drawn = library.render(made, {}, camera=Camera(), frame=Frame(*SHAPE[::-1]))
    assert found + drawn.nonfinite == 4
    made, found = assemble(passes, {"use_shading": False})
    assert found + library.render(made, {"use_shading": False}).nonfinite == 4


def test_own_pixels():
    random = np.random.default_rng(1)
    for _ in range(20):
        height, width = random.integers(1, 9, 2)
        index, drawn = (random.integers(0, 4, (height, width)).astype(np.float32) for _ in range(2))
        pixels, sources = overlay.own_pixels(index, drawn)
        assert np.array_equal(pixels, np.flatnonzero(index != drawn))
        for pixel, source in zip(pixels, sources, strict=True):
            y, x = divmod(int(pixel), int(width))
            near = [((j - y) ** 2 + (i - x) ** 2, j, i) for j in range(max(0, y - 2), min(height, y + 3))
                    for i in range(max(0, x - 2), min(width, x + 3)) if drawn[j, i] == index[y, x]]
            assert source == (min(near)[1] * width + min(near)[2] if near else -1)


def test_rasterised_layers():
    index = np.array([[0, 5, 5, 7, 9]], np.float32)
    maps = {"object": np.array([[0, 1, 2, 2, 2]], np.float32), "material": np.array([[0, 3, 4, 4, 4]], np.float32),
            "style": np.array([[0, 0, 1, 1, 1]], np.float32), "attributes": np.zeros((1, 5, 6), np.float32)}
    maps["attributes"][0, :, 0], maps["attributes"][0, :, 5] = [0, 0.1, 0.2, 0.2, 0.2], [0, 1, 2, 2, 2]
    owners, numbers = np.array([0, 5, 5], np.float32), np.array([0, 50, 51], np.float32)
    maps = overlay.compact(maps)
    assert [maps[name].dtype for name in ("object", "material", "style")] == 3 * [np.uint8]
    made = overlay.rasterised(index, maps, owners, numbers, lambda stray: 100 + stray)
    assert not maps and all(picture.dtype == np.float32 for picture in made.values())
    assert [made[name].tolist() for name in ("object", "material", "style")] == [
        [[[0], [50], [51], [107], [109]]], [[[0], [3], [4], [0], [0]]], [[[0], [0], [1], [0], [0]]]]
    close(made["controls"][0, :, 0], np.array([0, 0.1, 0.2, 0, 0]))
    close(made["controls"][0, :, 5], np.array([0, 1, 2, 0, 0]))


def test_what_a_clear_part_hides_is_of_its_thing_s_usual_material():
    """Ground, 1, of materials 3, 4 and 4, and a card, 2, of material 9 and style 1, that is clear where it hides it."""
    index = np.array([[5, 5, 5, 5, 5, 5, 5, 6, 8]], np.float32)
    card = np.array([[1, 1, 1, 2, 2, 2, 2, 2, 2]], np.float32)
    maps = {"object": card, "material": np.array([[4, 4, 3, 9, 9, 9, 9, 9, 9]], np.float32), "style": card - 1}
    made = overlay.rasterised(index, overlay.compact(maps), np.array([0, 5, 6]), np.array([0, 50, 60]), np.negative)
    assert made["material"][0, :, 0].tolist() == [4, 4, 3, 3, 3, 4, 4, 9, 0]  # within two pixels the nearest
    assert made["style"][0, :, 0].tolist() == [0, 0, 0, 0, 0, 0, 0, 1, 0]


def test_where_objects_coincide_the_rasteriser_says_which_is_there():
    """Objects 1 and 2 coincide at the second to fourth pixel, 3 lies before them at the third: hair, say."""
    index = np.array([[5, 6, 7, 6, 6, 5]], np.float32)
    one = np.array([[1, 1, 1, 1, 2, 2]], np.float32)
    maps = overlay.compact({"object": one, "material": one * 0, "style": one * 0,
                            "coincident": np.array([[0, 2, 2, 2, 0, 0]], np.float32)})
    assert maps["coincident"].itemsize == 1 and maps["pairs"].tolist() == [[1, 2]]
    made = overlay.rasterised(index, maps, np.array([0, 5, 6]), np.array([0, 50, 60]), lambda stray: 10 * stray)
    assert made["object"][..., 0].tolist() == [[50, 50, 70, 50, 60, 50]], "the last is not close to where they coincide"
    assert not maps


def test_only_what_is_not_0_is_kept_of_what_was_rasterised():
    none = np.zeros((2, 3), np.float32)
    maps = {"object": none + 300, "material": none, "style": none, "attributes": np.zeros((2, 3, 6), np.float32)}
    made = overlay.compact(maps)
    assert made.keys() == {"object", "material", "style"} and made["object"].dtype == np.uint16
    assert overlay.rasterised(none, made, np.zeros(301), np.zeros(301), np.negative).keys() == {
        "object", "material", "style"}


def test_files_keep_the_layers():
    random = np.random.default_rng(3)
    names = ("combined", "diffuse", "object", "material", "style", "controls", "seen_depth", "anchor", "tangent",
             "card")
    made = {name: random.uniform(-1, 1, (*SHAPE, library.LAYERS[name])).astype(np.float32) for name in names}
    packed = {name: saved.pack(name, made) for name in saved.passes()}
    assert {name: picture.shape[2] for name, picture in packed.items()} == {
        name: len(letters) for name, letters in saved.passes().items()}
    again = saved.unpack(packed)
    assert again.keys() == made.keys() and all(np.array_equal(again[name], made[name]) for name in names)
    few = {name: made[name] for name in ("combined", "diffuse", "object", "material")}
    again = saved.unpack({name: saved.pack(name, few) for name in saved.passes(())})
    assert all(np.array_equal(again.pop(name), few[name]) for name in few)
    assert again.keys() == {"style", "controls"} and not any(picture.any() for picture in again.values())


def test_a_picture_from_its_bands(passes):
    for name, letters in saved.passes(()).items():
        passes[name] = np.zeros((*SHAPE, len(letters)), np.float32)
    passes["Encre Index"][4:, :, 2] = 1
    del passes["Encre Source"], passes["Encre Diffuse"]
    scene, styles = {"shade_light": "DIRECT", "use_hatching": True}, [{"shade_light": "ALL"}]
    at_once, _ = assemble(passes, scene, styles)
    whole = layers.Whole(*SHAPE)
    for row in range(0, SHAPE[0], 3):
        whole.add(row, assemble({name: picture[row:row + 3] for name, picture in passes.items()}, scene, styles)[0])
    assert whole.layers.keys() == at_once.keys() and "controls" not in at_once and "style" in at_once
    for name in at_once:
        assert whole.layers[name].tobytes() == np.ascontiguousarray(at_once[name]).tobytes(), name


def test_passes_are_free_after_their_last_reader(passes):
    layers.assemble(passes, Settings({"use_hatching": True}), {"object": passes.pop("IndexOB")})
    assert not passes


def test_what_is_active():
    off = dict.fromkeys(switches(), False)

    def asked(scene, style=None):
        return Settings(scene, [("", style or {})])

    assert asked({}).active and not asked(off).active and asked(off, {"use_hatching": True}).active
    assert asked({}, {"use_shading": False}).shaded and not asked(off).shaded
    assert asked({}).wants_light and not asked(off).wants_light
    assert asked({}).denoises and not asked({"light_denoise": "NONE"}).denoises
    assert not asked({**off, "use_lines": True}).wants_light
    assert asked({**off, "use_lines": True}, {"line_shadow_strength": 1.0}).wants_light
    assert asked({"supersample": 2}).factor == 2 and asked({**off, "supersample": 2}).factor == 1
    assert asked({**off, "supersample": 2, "layer_source": "ENCRE"}).factor == 2


def test_the_stages_that_are_told_are_those_that_have_rows():
    csrc = Path(__file__).parents[2] / "csrc"
    rows = re.findall(r'^#include "(.*)"', (csrc / "base" / "all.rows.h").read_text(), re.MULTILINE)
    declared = [id_ for name in rows for id_ in re.findall(r"^STAGE\((\w+),", (csrc / name).read_text(), re.MULTILINE)]
    assert declared == [stage.id for stage in library.stages()] and len(declared) > 9


def test_settings_are_checked_and_complete():
    made = Settings({"line_thickness": 3}, [("Ink", {"line_thickness": 4.0, "edge_detector": "DOG"})])
    assert [len(values) for values in made.every] == 2 * [len(library.params())]
    assert [values["line_thickness"] for values in made.every] == [3, 4]
    assert {values["edge_detector"] for values in made.every} == {library.defaults()["edge_detector"]}, "is the frame's"
    assert made.scene == {"line_thickness": 3.0}
    for scene, style in (({"line_thickness": -1}, {}), ({}, {"line_thickness": -1}), ({"line": 1}, {})):
        with pytest.raises(EncreError):
            Settings(scene, [("", style)])


def test_settings_say_when_they_ask_for_other_layers(passes):
    """Of all that can be changed, what `of_layers` leaves out changes none."""
    before, same = Settings({}), 0
    first, _ = assemble({**passes, "Env": passes["Emit"]}, {})
    for p in library.params().values():
        values = {"bool": [True, False], "enum": [item.id for item in p.items], "float": [p.soft_min, p.soft_max],
                  "int": [int(p.soft_min), int(p.soft_max)]}.get(p.type, [])
        for value in values:
            try:
                settings = Settings({p.id: value})
            except EncreError:
                continue
            if settings.of_layers != before.of_layers:
                continue
            made, _ = assemble({**passes, "Env": passes["Emit"]}, {p.id: value})
            assert made.keys() == first.keys() and all(np.array_equal(made[k], first[k]) for k in first), p.id
            same += 1
    assert same > 100
    assert Settings({"use_shading": False}).of_layers != before.of_layers


def test_one_of_those_that_coincide_may_never_lie_in_front():
    """It has a number that no pixel of the picture has."""
    index, drawn = np.array([[3, 4], [4, 3]]), np.array([[3, 3], [3, 3]])
    got = overlay.settled(index, drawn, np.ones((2, 2), bool), np.array([(3, 11), (11, 4)]))
    assert (got == 3).all()
