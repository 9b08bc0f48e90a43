# SPDX-License-Identifier: GPL-3.0-or-later
"""Files of other renderers: what is in them by whatever names and windows, and that --check and composite agree."""

import json

import exr
import numpy as np
import OpenImageIO as oiio
import pytest
from command import SIZE, expected, fails
from encre.cli import multilayer
from encre.cli.passes import mattes, renderers

WIDTH, HEIGHT = SIZE
ROLES = ("Combined", "Depth", "Normal", "DiffCol", "DiffDir", "DiffInd", "IndexOB", "IndexMA")
# How each calls them; light with the surface's colour in it is marked by a star.
CALLED = {
    "renderman": ["Ci.rgba", "z_filtered.Z", "__Nworld.rgb", "albedo.rgb", "directDiffuse*.rgb",
                  "indirectDiffuse*.rgb"],
    "arnold": ["RGBA", "Z", "N.XYZ", "diffuse_albedo.RGB", "diffuse_direct*.RGB", "diffuse_indirect*.RGB", "ID.Z"],
    "vray": ["RGBA", "z_depth.Z", "normals.XYZ", "diffuse_filter.RGB", "lighting_raw.RGB", "gi_raw.RGB", "object_id.Z",
             "material_id.Z"],
    "redshift": ["RGBA", "Z", "BumpNormals.RGB", "DiffuseFilter.RGB", "DiffuseLightingRaw.RGB",
                 "GlobalIlluminationRaw.RGB", "ObjectID.R", "MaterialID.R"],
    "karma": ["C.RGBA", "Pz.Z", "N.XYZ", "albedo.RGB", "directdiffuse*.RGB", "indirectdiffuse*.RGB", "primid.R"],
    "octane": ["RGBA", "Z-Depth.R", "ShadingNormal.RGB", "DiffuseFilter(info).RGB", "DiffuseDirect*.RGB",
               "DiffuseIndirect*.RGB", "ObjectLayerMap.R", "MaterialID.R"],
    "eevee": ["ViewLayer.Combined.RGBA", "ViewLayer.Depth.Z", "ViewLayer.Normal.XYZ", "ViewLayer.DiffCol.RGB",
              "ViewLayer.DiffDir.RGB"],
    "compositor": ["Image.RGBA", "Depth.V", "Normal.XYZ", "Diffuse Color.RGB", "Diffuse Direct.RGB",
                   "Diffuse Indirect.RGB", "Object Index.V", "Material Index.V"],
}


def store(path, pictures, window=None, **more):
    """Writes {"NAME.LETTERS": picture} as one part."""
    channels = {}
    for name, picture in pictures.items():
        layer, _, letters = name.replace("*", "").rpartition(".")
        letters = letters if layer or len(letters) > 1 else letters[:1]
        for letter, channel in zip(letters, np.atleast_3d(picture).transpose(2, 0, 1), strict=True):
            channels[f"{layer}.{letter}".removeprefix(".")] = channel
    multilayer.write(path, channels, window or multilayer.Window(*SIZE, 0, 0, *SIZE), **more)
    return path


def combined(path):
    with multilayer.Exr(path) as file:
        name = next(full.rpartition(".")[0] for full in file.own if full[-1] in "rR" and "Encre" not in full)
        letters = [next(full for full in file.own if full.rpartition(".")[0] == name and full[-1].upper() == letter)
                   for letter in "RGBA"]
        return file.read({"Combined": letters})["Combined"]


@pytest.mark.parametrize("renderer", CALLED)
def test_the_names_of_renderers(run, tmp_path, scene, renderer):
    pictures = exr.passes(scene)
    given = {}
    for role, name in zip(ROLES, CALLED[renderer], strict=False):
        tinted = "*" in name
        given[name] = pictures[role] * pictures["DiffCol"] if tinted else pictures[role]
    path = store(tmp_path / "in.exr", given)
    roles = ROLES[:len(given)]
    want = expected({role: pictures[role] for role in roles})["Combined"]
    # A picture called Image may be anybody's.
    for option in [["--from", renderer]] if renderer == "compositor" else [[], ["--from", renderer]]:
        status, _, err = run("composite", path, "-o", tmp_path / "out.exr", *option)
        assert status == 0 and (renderer == "eevee" or f"as {renderer} calls them" in err), err
        assert np.abs(combined(tmp_path / "out.exr") - want).max() < 1e-4
    status, out, err = run("composite", path, "--check", "--from", renderer)
    assert status == 0 and all(f"  {role}: there" in out for role in roles), out


def test_a_renderer_is_known_where_that_is_clear():
    assert renderers.recognized(["R", "G", "B", "diffuse_albedo.R", "diffuse_direct.R"], {}) == "arnold"
    assert renderers.recognized(["R", "G", "B", "N.X", "Z"], {}) is None
    assert renderers.recognized(["R", "N.X"], {"software": "Redshift 3.5"}) == "redshift"
    assert renderers.recognized(["R", "N.X"], {"Software": "Redshift by way of Arnold"}) is None
    assert renderers.recognized(["R", "diffuse.red"], {"renderer": "V-Ray 6"}) == "vray"
    found = renderers.named("vray", ["diffuse.red", "diffuse.blue", "diffuse.green", "diffuse.alpha"], {"Combined": []})
    assert found == {"DiffCol": ["diffuse.red", "diffuse.green", "diffuse.blue"]}


def identity(number):
    return np.uint32(0x3f000000 + 977 * number).view(np.float32)


@pytest.mark.parametrize(("name", "role"), [("crypto_object", "IndexOB"), ("ViewLayer.CryptoObject", "IndexOB"),
                                            ("VRayCryptomatte_MtlID", "IndexMA"), ("CryptoAsset", "IndexOB")])
def test_cryptomatte_of_any_renderer(run, tmp_path, scene, name, role):
    """By its metadata: who covers most of a pixel, whatever the order of ranks; empty ones and the rest are nothing."""
    pictures = exr.passes(scene)
    numbers = np.squeeze(pictures.pop(role)).astype(int)
    first, second = (np.zeros((HEIGHT, WIDTH, 4), np.float32) for _ in range(2))
    first[..., 0], first[..., 1] = identity(99), 0.2
    first[..., 2], first[..., 3] = np.vectorize(identity)(numbers), np.where(numbers > 0, 0.7, 0)
    second[..., 2] = identity(50)  # covers nothing
    manifest = {f"thing {k}": f"{int(identity(k).view(np.uint32)):08x}" for k in range(60)}
    key = f"cryptomatte/{name[:3]}1"
    texts = {f"{key}/name": name, f"{key}/hash": "MurmurHash3_32", f"{key}/conversion": "uint32_to_float32",
             f"{key}/manifest": json.dumps(manifest)}
    layer = "ViewLayer." if name.startswith("ViewLayer") else ""
    path = store(tmp_path / "in.exr", {
        **{f"{layer}{pass_}.{exr.LETTERS[pass_]}": picture for pass_, picture in pictures.items()},
        f"{name}00.RGBA": first, f"{name}01.RGBA": second}, texts=texts)
    with multilayer.Exr(path) as file:
        [(kind, matte)] = mattes.found(file.own, file.metadata).items()
        assert (kind, matte.name, len(matte.channels), len(matte.names)) == (role, name, 8, 60)
        made = mattes.Numbers(matte).of(file.read({"": matte.channels})[""])[..., 0]
    names = sorted(manifest)
    assert all(made[numbers == k].tolist() == [names.index(f"thing {k}") + 1 if k else 0] * (numbers == k).sum()
               for k in np.unique(numbers)), "by name, and so the same in all frames"
    assert run("composite", path, "-o", tmp_path / "out.exr")[0] == 0
    want = expected({**pictures, role: np.float32(made)[..., None]})["Combined"]
    assert np.array_equal(combined(tmp_path / "out.exr"), want)
    assert f"{role}: there, as Cryptomatte {name} (60 names)" in run("composite", path, "--check")[1]


def test_identities_without_names_have_numbers_of_their_own():
    numbers = mattes.Numbers(mattes.Matte("", ("a.R",)))
    words = np.array([[0x3f000001, 0x40000000, 0x3f000001, 0]], np.uint32).view(np.float32)[..., None]
    first = numbers.of(words)
    again = mattes.Numbers(mattes.Matte("", ("a.R",))).of(words[:, ::-1])[:, ::-1]
    assert np.array_equal(first, again) and first[0, 3] == 0 and len(np.unique(first)) == 3 and first.max() < 1 << 24
    twins = np.array([[5, 5 + (1 << 24) - 1]], np.uint32).view(np.float32)[..., None]
    assert len(np.unique(numbers.of(twins))) == 2


def test_layers_in_files_of_their_own(run, tmp_path, scene, monkeypatch):
    pictures = exr.passes(scene)
    monkeypatch.chdir(tmp_path)
    for frame in (1, 2):
        store(f"beauty.{frame:04}.exr", {"RGBA": pictures["Combined"]})
        store(f"depth.{frame:04}.exr", {"RGB": np.repeat(np.atleast_3d(pictures["Depth"]), 3, 2)})
        store(f"all.{frame:04}.exr", {"first.RGB": pictures["DiffDir"], "normals.RGB": pictures["Normal"]})
    layers = ["--layer", "depth=depth.####.exr", "--layer", "normal=all.####.exr:normals"]
    command = ["composite", "beauty.####.exr", "-o", "out.####.exr", *layers]
    assert run(*command)[0] == 0
    want = run("composite", store("one.exr", {"RGBA": pictures["Combined"], "Z": pictures["Depth"],
                                              "N.XYZ": pictures["Normal"]}), "-o", "want.exr")
    assert want[0] == 0
    for frame in (1, 2):
        assert np.array_equal(combined(f"out.{frame:04}.exr"), combined("want.exr"))
    assert run(*command, "--resume")[2].count("finished") == 1
    store("depth.0002.exr", {"RGB": np.repeat(2 * np.atleast_3d(pictures["Depth"]), 3, 2)})
    assert "1 of 2 frames are finished" in run(*command, "--resume")[2]
    status, out, _ = run("composite", "beauty.####.exr", "--check", *layers)
    assert status == 0 and "Depth: there, as depth.0001.exr" in out and "Normal: there, as all.0001.exr:normals" in out
    fails(run("composite", "beauty.0001.exr", "-o", "x.exr", *layers), "depth.####.exr", "one file")
    fails(run("composite", "beauty.0001.exr", "-o", "x.exr", "--layer", "depth=none.exr"), "none.exr", "no such file")
    store("small.exr", {"Z": np.ones((4, 8))}, multilayer.Window(8, 4, 0, 0, 8, 4))
    fails(run("composite", "beauty.0001.exr", "-o", "x.exr", "--layer", "depth=small.exr"), "small.exr: is 8 x 4",
          "96 x 64", "render both in one size")


def parts(path, *given, tile=0, deep=False):
    """Parts (x, y, names, picture) of one display window, SIZE."""
    specs = []
    for x, y, names, picture in given:
        spec = oiio.ImageSpec(picture.shape[1], picture.shape[0], picture.shape[2], "float")
        spec.x, spec.y, spec.full_width, spec.full_height = x, y, WIDTH, HEIGHT
        spec.channelnames, spec["oiio:subimagename"] = tuple(names), names[0]
        spec.tile_width = spec.tile_height = tile
        specs.append(spec)
    out = oiio.ImageOutput.create(str(path))
    if deep:
        specs[0].deep = True
        data = oiio.DeepData()
        data.init(WIDTH * HEIGHT, 5, [oiio.TypeDesc("float")] * 5, specs[0].channelnames)
        assert out.open(str(path), specs[0]) and out.write_deep_image(data) and out.close()
        return path
    assert out.open(str(path), specs) if len(specs) > 1 else out.open(str(path), specs[0]), out.geterror()
    for k, (_, _, _, picture) in enumerate(given):
        assert not k or out.open(str(path), specs[k], "AppendSubimage"), out.geterror()
        assert out.write_image(np.ascontiguousarray(picture, np.float32)), out.geterror()
    assert out.close()
    return path


def test_parts_of_different_windows(run, tmp_path, scene):
    pictures = exr.passes(scene)
    depth = np.zeros((HEIGHT, WIDTH, 1), np.float32)
    depth[10:40, 20:70] = np.atleast_3d(pictures["Depth"])[10:40, 20:70]
    path = parts(tmp_path / "in.exr", (0, 0, "RGBA", pictures["Combined"]), (20, 10, "Z", depth[10:40, 20:70]))
    assert run("composite", path, "-o", tmp_path / "out.exr")[0] == 0
    whole = store(tmp_path / "whole.exr", {"RGBA": pictures["Combined"], "Z": depth})
    assert run("composite", whole, "-o", tmp_path / "want.exr")[0] == 0
    assert np.array_equal(combined(tmp_path / "out.exr"), combined(tmp_path / "want.exr"))
    wide = parts(tmp_path / "wide.exr", (-8, 0, "RGBA", np.ones((HEIGHT, WIDTH + 16, 4))), (0, 4, "Z", depth[4:]))
    with multilayer.Exr(wide) as file:
        assert file.window == multilayer.Window(WIDTH + 16, HEIGHT, -8, 0, WIDTH, HEIGHT)
        assert np.array_equal(file.read({"": ["Z"]})[""][4:, 8:-8], depth[4:])


def test_numbers_of_32_bits_are_not_shares_of_the_largest(tmp_path):
    numbers = np.arange(WIDTH * HEIGHT, dtype=np.uint32).reshape(HEIGHT, WIDTH, 1)
    spec = oiio.ImageSpec(WIDTH, HEIGHT, 1, "uint")
    spec.channelnames = ("id.R",)
    out = oiio.ImageOutput.create(str(tmp_path / "in.exr"))
    assert out.open(str(tmp_path / "in.exr"), spec) and out.write_image(numbers) and out.close()
    with multilayer.Exr(tmp_path / "in.exr") as file:
        assert file.kinds == {"id.R": "uint"}
        assert np.array_equal(file.read({"": ["id.R"]})[""], numbers)


def broken(path, at):
    data = bytearray(path.read_bytes())
    data[int(len(data) * at):int(len(data) * at) + 64] = bytes(64)
    path.write_bytes(data)
    return path


def test_check_and_composite_agree(run, tmp_path, scene):
    """Tiles ended --check with an error of ours, what only unread channels lack counted as damage, and damage above the
    last row as none."""
    pictures = exr.passes(scene)
    rgbaz = np.concatenate([pictures["Combined"], np.atleast_3d(pictures["Depth"])], 2)
    files = {"tiled": parts(tmp_path / "tiled.exr", (0, 0, ["R", "G", "B", "A", "Z"], rgbaz), tile=32),
             "halves": parts(tmp_path / "halves.exr", (0, 0, ["left.R", "left.G", "left.B"], rgbaz[..., :3]),
                             (0, 0, ["R", "G", "B"], rgbaz[..., :3])),
             "middle": broken(parts(tmp_path / "middle.exr", (0, 0, ["R", "G", "B", "A", "Z"], rgbaz)), 0.4),
             "deep": parts(tmp_path / "deep.exr", (0, 0, ["R", "G", "B", "A", "Z"], rgbaz), deep=True)}
    for name, path in files.items():
        draws, good = run("composite", path, "-o", tmp_path / "out.exr"), run("composite", path, "--check")
        assert draws[0] == good[0] == (2 if name in ("middle", "deep") else 0), (name, draws, good)
        assert "should not happen" not in draws[2] + good[2]
    for command in ["-o", tmp_path / "out.exr"], ["--check"]:
        code, _, err = run("composite", files["deep"], *command)
        assert code == 2 and "deep.exr: holds deep pixels" in err and "flatten it" in err
        code, _, err = run("composite", files["middle"], *command)
        assert code == 2 and "can't be read to its end" in err
