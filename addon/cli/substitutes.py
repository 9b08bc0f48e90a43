# SPDX-License-Identifier: GPL-3.0-or-later
"""What stands in for passes that a file lacks: another renderer's, Cryptomatte, or nothing, and what that switches off.

Only Combined can't be replaced. To know another pass by a word of --layer, add it to GIVEN.
"""

import numpy as np

from ..pen import saved, slim
from ..pen.colour import LUMINANCE
from ..pen.errors import EncreError, unknown
from ..pen.settings import Settings

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
_DARK, _MOST = 0.02, 4  # a colour so dark tells nothing of the light; more light than that is as good as that
_SINGLE = ("Depth", "IndexOB", "IndexMA")  # some renderers save them as grey in R, G and B
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
        named.sort(key=lambda full: "RGBAXYZ".find(full[-1].upper()))
        found[classic] = named[:1] if classic in _SINGLE else named
    return found


def cryptomatte(passes):
    """{pass: channels} of Cryptomatte's that tell what no index does: the first of ids, which cover most of a pixel."""
    if "Encre Index" in passes:
        return {}
    return {matte: [next(full for full in passes[matte] if full[-1] in "rR")] for index, matte in _CRYPTO.items()
            if index not in passes and any(full[-1] in "rR" for full in passes.get(matte, ()))}


class Mattes:
    """Numbers for Cryptomatte's ids, the same in all bands of a picture; 0 for none."""

    def __init__(self):
        self.numbers = {matte: {0: 0} for matte in _CRYPTO.values()}

    def number(self, pictures):
        for index, matte in _CRYPTO.items():
            if matte in pictures:
                hashes, known = pictures.pop(matte), self.numbers[matte]
                bits = np.ascontiguousarray(hashes, np.float32).view(np.uint32)
                words, inverse = np.unique(bits, return_inverse=True)
                each = np.array([known.setdefault(word, len(known)) for word in words.tolist()], np.float32)
                pictures[index] = each[inverse].reshape(hashes.shape)


def lit(names):
    """Whether passes of these names tell light and colour apart."""
    return "DiffCol" in names and ("Encre Diffuse" in names or "DiffDir" in names)


def switch_off(names, settings):
    """(settings, sentences): without what passes that are not among `names` would be needed for."""
    said = []
    if "Combined" not in names and "Encre Source" not in names:
        return settings, said
    if not lit(names):
        bare = _bare(settings)
        off = {"use_hatching": False, "edge_light": 0.0, "line_light": 0.0,
               **({"other_light": 0.0} if bare else {"use_shading": False})}
        styles = [(name, {**values, **{id_: value for id_, value in off.items() if id_ in values}})
                  for name, values in settings.styles]
        settings = Settings({**settings.scene, **off}, styles, settings.space)
        said.append("no diffuse light and colour: " + (
            "tones follow how bright the picture is, nothing is hatched" if bare else
            "under the lines the picture stays as it is, nothing is shaded flat or hatched")
            + ", and no line follows a shadow")
    for name, sentence in (("DiffCol", "no diffuse colour: lines between colours follow the picture's"),
                           ("Depth", "no depth: no line between depths"),
                           ("Normal", "no normals: no line at creases")):
        if name not in names:
            said.append(sentence)
    return settings, said + saved.missing(names, settings)


def _bare(settings):
    """Whether surfaces are bare paper, on which light shows by tones alone."""
    return settings.shaded and settings.every[0]["surface"] == "PAPER"


def fill(pictures, settings):
    """Puts into `pictures` what lacks of Cycles' passes, such that nothing is seen in it. settings: of switch_off()."""
    shown = "Encre Source" if "Encre Source" in pictures else "Combined"
    if shown not in pictures:
        return
    source = pictures[shown]
    one, light = np.ones_like(source[..., :1]), None
    if not lit(pictures):
        for name in ("DiffDir", "DiffInd"):
            pictures.pop(name, None)
        light = _brightness(source, pictures.get("DiffCol"), pictures.get("Depth")) if _bare(settings) else None
        pictures["Encre Diffuse"] = np.repeat(one if light is None else light, 3, axis=2)
    if "DiffCol" not in pictures:
        pictures["DiffCol"] = np.clip(np.nan_to_num(source[..., :3]), 0, 1)
    if light is not None:  # what is neither light nor colour passes for a mirror
        pictures[shown] = np.concatenate([pictures["DiffCol"] * light, source[..., 3:]], 2)
    if "Depth" not in pictures:
        pictures["Depth"] = one
    if "Normal" not in pictures:
        pictures["Normal"] = np.zeros_like(source[..., :3])


def _brightness(picture, color, depth):
    """What stands for light, (height, width, 1): how bright a picture is, beside its surfaces' colour if that is known;
    the most where nothing is, which is bare paper."""
    light = _grey(picture)
    if color is not None:
        light = np.where(color.any(2, keepdims=True), light / np.maximum(_grey(color), _DARK), light)
    return np.minimum(light if depth is None else np.where(depth < 1e9, light, _MOST), np.float32(_MOST))


def _grey(picture):
    return (np.maximum(np.nan_to_num(picture[..., :3]), 0) @ np.float32(LUMINANCE))[..., None]


def listed(passes):
    """Lines of text: which passes are there, and what each that is missing switches off."""
    lines = []
    own = {"Encre Source": ("Combined",), "Encre Diffuse": ("DiffDir", "DiffInd"),
           "Encre Index": ("IndexOB", "IndexMA")}
    stands = {name: by for by, names in own.items() if by in passes for name in names}
    stands.update({name: by for by, name in slim.STANDS.items() if by in passes})
    stands.update({index: matte for index, matte in _CRYPTO.items() if matte in passes})
    for name, (box, without) in BOXES.items():
        if name in passes or name in stands:
            lines.append(f"  {name}: there" + ("" if name in passes else f", as {stands[name]}"))
        else:
            lines.append(f"  {name}: missing; check {box}; off without it: {without}")
    for name, switch, without in (
            ("Encre Index", "Save Layers", "outlines of the parts of meshes, styles"),
            ("Encre Line Controls", "Save Layers", "painted controls"),
            ("Encre Anchor", "Save Anchor", "tones and the hand of lines that stick to things"),
            ("Denoising Normal", "Save Layers", "lines in mirrors and glass")):
        if name not in passes and name not in stands:
            lines.append(f"  {name}: missing; render with Encre and {switch} on; off without it: {without}")
    return lines
