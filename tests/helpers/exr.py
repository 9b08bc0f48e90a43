# SPDX-License-Identifier: GPL-3.0-or-later
"""Multilayer EXRs as the Blenders write them, and their pixels back."""

import numpy as np
import OpenImageIO as oiio
from encre.pen import layers
from encre.pen import saved as kept

LETTERS = {**layers.CYCLES, **layers.DRAWN, **kept.passes(), **layers.SEEN, "IndexMA": "X"}
LAYOUTS = ("classic", "parts", "bare")  # Blender 3.4 to 4.x; 5.x; a file without a view layer


def passes(drawn):
    """Cycles' passes whose layers are those of drawn.scene()."""
    none = np.zeros_like(drawn["color"])
    return {"Combined": drawn["combined"], "Depth": drawn["depth"], "Normal": drawn["normal"],
            "DiffCol": drawn["color"], "DiffDir": drawn["diffuse"] * np.float32(0.75),
            "DiffInd": drawn["diffuse"] * np.float32(0.25), "GlossCol": none + 1, "GlossDir": none + drawn["specular"],
            "GlossInd": none, "TransCol": none, "Emit": none, "IndexOB": drawn["object"], "IndexMA": drawn["material"]}


def saved(drawn):
    """What save_layers adds: Encre's own passes, and those that see into mirrors, of which there are none here."""
    index = np.stack([drawn[name] for name in ("object", "material", "style")], axis=-1)
    return {"Encre Source": drawn["combined"], "Encre Diffuse": drawn["diffuse"], "Encre Index": index,
            **{name: kept.pack(name, drawn) for name in kept.control_passes()},
            "Denoising Albedo": drawn["albedo"],
            "Denoising Normal": drawn["normal"] * np.float32((1, 1, -1)), "Encre Seen Depth": drawn["depth"]}


def write(path, pictures, layout="classic", layer="ViewLayer", metadata=None, window=None, half=False,
          compression="zip"):
    """window: (x, y, full width, full height); pictures: {classic pass name: (H, W) or (H, W, channels)}."""
    parts = {}
    for name, picture in pictures.items():
        new = layers.RENAMED.get(name, name) if layout == "parts" else name
        prefix = new if layout == "bare" else f"{layer}.{new}"
        part = parts.setdefault(prefix if layout == "parts" else "", {})
        for letter, channel in zip(LETTERS.get(name, "RGBA"), np.atleast_3d(picture).transpose(2, 0, 1), strict=False):
            part[f"{prefix}.{letter}"] = channel
    size = next(iter(pictures.values())).shape[1::-1]
    specs = []
    for name, part in parts.items():
        height, width = next(iter(part.values())).shape
        spec = oiio.ImageSpec(width, height, len(part), "half" if half else "float")
        spec.channelnames = tuple(part)
        spec["compression"] = compression
        if name:
            spec["oiio:subimagename"] = name
        spec.x, spec.y, spec.full_width, spec.full_height = window or (0, 0, *size)
        for key, text in (metadata or {}).items():
            spec[key] = text
        specs.append(spec)
    out = oiio.ImageOutput.create(str(path))
    assert out.open(str(path), specs), out.geterror()
    for k, part in enumerate(parts.values()):
        if k:
            assert out.open(str(path), specs[k], "AppendSubimage"), out.geterror()
        assert out.write_image(np.stack(list(part.values()), axis=-1).astype(np.float32)), out.geterror()
    assert out.close()
    return path


def read(path):
    """{full channel name: (H, W)} of a one-part file."""
    file = oiio.ImageInput.open(str(path))
    assert file, oiio.geterror()
    pixels = file.read_image("float")
    return dict(zip(file.spec().channelnames, np.atleast_3d(pixels).transpose(2, 0, 1), strict=True))


def picture(path, name="ViewLayer.Combined"):
    """One pass (H, W, channels) of a one-part file."""
    channels = read(path)
    letters = LETTERS[name.rpartition(".")[2]]
    return np.stack([channels[f"{name}.{letter}"] for letter in letters], axis=-1)


def _parts(path):
    file = oiio.ImageInput.open(str(path))
    assert file, oiio.geterror()
    k = 0
    while file.seek_subimage(k, 0):
        yield file, k, file.spec()
        k += 1


def part(path, name):
    """One pass (H, W, channels) of a file of any number of parts."""
    for file, k, spec in _parts(path):
        numbers = [i for i, full in enumerate(spec.channelnames) if full.rpartition(".")[0] == name]
        if numbers:
            return file.read_image(k, 0, numbers[0], numbers[-1] + 1, "float").reshape(spec.height, spec.width, -1)
    raise KeyError(name)


def metadata(path):
    """{key: text} of all parts."""
    return {a.name: a.value for _, _, spec in _parts(path) for a in spec.extra_attribs if isinstance(a.value, str)}


def image(path, value=200):
    """A small grey picture, whatever its name ends in, all of one value of 0 to 255."""
    return texture(path, np.full((8, 8, 1), value, np.uint8))


def texture(path, pixels):
    """An image file of bytes or floats (H, W, channels) as they are, whatever its name ends in."""
    spec = oiio.ImageSpec(*pixels.shape[1::-1], pixels.shape[2], "uint8" if pixels.dtype == np.uint8 else "float")
    out = oiio.ImageOutput.create(str(path))
    assert out.open(str(path), spec) and out.write_image(pixels)
    assert out.close()
    return path
