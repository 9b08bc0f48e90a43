# SPDX-License-Identifier: GPL-3.0-or-later
"""What stands in for passes that a file lacks: another renderer's, Cryptomatte, or nothing, and what that switches off.

Only Combined can't be replaced. To know another pass by a word of --layer, add it to GIVEN.
"""

import numpy as np

from ..pen.errors import EncreError, unknown

# What --layer may name: word -> classic pass name.
GIVEN = {"combined": "Combined", "depth": "Depth", "normal": "Normal", "color": "DiffCol", "light": "DiffDir",
         "object": "IndexOB", "material": "IndexMA"}
# Passes: their boxes in Blender (view layer, Passes), and what is not drawn without them.
BOXES = {
    "Combined": ("Combined", "anything"),
    "Depth": ("Data > Z", "lines between depths, smudging behind and in front"),
    "Normal": ("Data > Normal", "lines at creases"),
    "DiffDir": ("Light > Diffuse > Direct", "flat light, hatching and lines at shadows"),
    "DiffInd": ("Light > Diffuse > Indirect", "bounced light in levels and hatching"),
    "DiffCol": ("Light > Diffuse > Color", "flat light, hatching and lines between colours apart from light"),
    "GlossDir": ("Light > Glossy > Direct", "highlights on flat light"),
    "GlossInd": ("Light > Glossy > Indirect", "reflections on flat light"),
    "GlossCol": ("Light > Glossy > Color", "lines between colours of metal"),
    "TransCol": ("Light > Transmission > Color", "lines between colours of glass"),
    "Emit": ("Light > Other > Emission", "lines between colours of what glows"),
    "IndexOB": ("Data > Indexes > Object Index, or Cryptomatte > Object", "outlines of objects"),
    "IndexMA": ("Data > Indexes > Material Index, or Cryptomatte > Material", "lines between materials"),
}
_CRYPTO = {"IndexOB": "CryptoObject00", "IndexMA": "CryptoMaterial00"}


def given(texts):
    """{classic pass name: name in the file} of the words WORD=NAME of --layer. EncreError."""
    found = {}
    for text in texts:
        word, equals, name = text.partition("=")
        if not equals or not name:
            raise EncreError(f"--layer {text}: has no name; write --layer WORD=NAME, as depth=Z")
        if word not in GIVEN:
            raise EncreError("--layer: " + unknown("layer", word, GIVEN))
        found[GIVEN[word]] = name
    return found


def rename(passes, asked, channels, path):
    """`passes` {classic name: channels} with those that `asked` names from anywhere among the file's `channels`."""
    found = dict(passes)
    for classic, name in asked.items():
        named = [full for full in channels if full == name or full.rpartition(".")[0] == name]
        if not named:
            raise EncreError(f"{path}: " + unknown("layer", name, dict.fromkeys(
                full.rpartition(".")[0] or full for full in channels)))
        found[classic] = sorted(named, key=lambda full: "RGBAXYZ".find(full[-1].upper()))
    return found


def cryptomatte(passes):
    """{pass: channels} of Cryptomatte's that tell what no index does: the first of ids, which cover most of a pixel."""
    if "Encre Index" in passes:
        return {}
    return {matte: [next(full for full in passes[matte] if full[-1] in "rR")] for index, matte in _CRYPTO.items()
            if index not in passes and any(full[-1] in "rR" for full in passes.get(matte, ()))}


def _numbered(hashes):
    """0, 1, 2 ... for each of the different bit patterns; 0 for none."""
    words, inverse = np.unique(np.ascontiguousarray(hashes, np.float32).view(np.uint32), return_inverse=True)
    first = 0 if words[0] == 0 else 1
    return (inverse.reshape(hashes.shape) + first).astype(np.float32)


def fill(pictures, scene, styles):
    """(pictures, scene, styles, sentences): what lacks of Cycles' passes put in, and what needs it switched off."""
    pictures, scene, styles, said = dict(pictures), dict(scene), [dict(style) for style in styles], []
    for index, matte in _CRYPTO.items():
        if matte in pictures:
            pictures[index] = _numbered(pictures.pop(matte))
    source = pictures.get("Encre Source", pictures.get("Combined"))
    if source is None:
        return pictures, scene, styles, said
    color, one = source[..., :3], np.ones_like(source[..., :1])
    if "Encre Diffuse" not in pictures and not {"DiffDir", "DiffCol"} <= pictures.keys() or "DiffCol" not in pictures:
        for name in ("DiffDir", "DiffInd", "Encre Diffuse"):
            pictures.pop(name, None)
        pictures["Encre Diffuse"] = np.repeat(one, 3, axis=2)
        off = {"use_shading": False, "use_hatching": False, "edge_light": 0.0, "line_light": 0.0}
        scene.update(off)
        for style in styles:
            style.update({id_: value for id_, value in off.items() if id_ in style})
        said.append("no diffuse light and colour: nothing is shaded flat or hatched, and no line follows a shadow")
    if "DiffCol" not in pictures:
        pictures["DiffCol"] = np.clip(np.nan_to_num(color), 0, 1)
        said.append("no diffuse colour: lines between colours follow the picture's")
    if "Depth" not in pictures:
        pictures["Depth"] = one
        said.append("no depth: no line between depths")
    if "Normal" not in pictures:
        pictures["Normal"] = np.zeros_like(color)
        said.append("no normals: no line at creases")
    return pictures, scene, styles, said


def listed(passes):
    """Lines of text: which passes are there, and what each that is missing switches off."""
    lines = []
    own = {"Encre Source": ("Combined",), "Encre Diffuse": ("DiffDir", "DiffInd"),
           "Encre Index": ("IndexOB", "IndexMA")}
    stands = {name: by for by, names in own.items() if by in passes for name in names}
    stands.update({index: matte for index, matte in _CRYPTO.items() if matte in passes})
    for name, (box, without) in BOXES.items():
        if name in passes or name in stands:
            lines.append(f"  {name}: there" + ("" if name in passes else f", as {stands[name]}"))
        else:
            lines.append(f"  {name}: missing; check {box}; off without it: {without}")
    for name, without in (("Encre Index", "outlines of the parts of meshes, styles"),
                          ("Encre Line Controls", "painted controls"),
                          ("Denoising Normal", "lines in mirrors and glass")):
        if name not in passes:
            lines.append(f"  {name}: missing; render with Encre and Save Layers on; off without it: {without}")
    return lines
