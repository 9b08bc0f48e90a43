# SPDX-License-Identifier: GPL-3.0-or-later
"""What stands in for passes that a file lacks: another renderer's, Cryptomatte, or nothing, and what that switches off.

Only Combined can't be replaced. To know another pass by a word of --layer, add it to GIVEN.
"""

import os
import re

import numpy as np

from ...pen import saved, slim
from ...pen.colour import LUMINANCE
from ...pen.errors import EncreError, unknown
from ...pen.settings import Settings
from ...pen.stored import view_layers, wanted
from .. import sequence
from . import mattes, renderers

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
    "DiffCol": ("Light > Diffuse > Color", "flat light, hatching and lines between colors apart from light"),
    "GlossDir": ("Light > Glossy > Direct", "highlights on flat light"),
    "GlossInd": ("Light > Glossy > Indirect", "reflections on flat light"),
    "GlossCol": ("Light > Glossy > Color", "lines between colors of metal"),
    "TransCol": ("Light > Transmission > Color", "lines between colors of glass"),
    "Emit": ("Light > Other > Emission", "lines between colors of what glows"),
    "IndexOB": ("Data > Indexes > Object Index, or Cryptomatte > Object", "outlines of objects"),
    "IndexMA": ("Data > Indexes > Material Index, or Cryptomatte > Material", "lines between materials"),
}
_DARK, _MOST = 0.02, 4  # a colour so dark tells nothing of the light; more light than that is as good as that
_BLACK = 1e-4  # in colours as dark as this light can't be told
_INDICES = "IndexOB", "IndexMA"


def given(texts):
    """{classic pass name: name in the file, or FILE.exr, FILE.exr:NAME} of the words WORD=NAME of --layer. EncreError.
    """
    found = {}
    for text in texts:
        word, equals, name = text.partition("=")
        if not equals or not name:
            raise EncreError(f"--layer {text}: has no name; write --layer WORD=NAME, as depth=Z")
        if word not in GIVEN:
            raise EncreError("--layer: " + unknown("layer", word, GIVEN))
        found[GIVEN[word]] = name
    return found


def of_frame(asked, source, number):
    """`asked` with the files of a frame in the place of patterns with #. EncreError: the frame has no number."""
    found = {}
    for classic, name in asked.items():
        path, channel = in_file(name)
        if path and "#" in os.path.basename(path) and number is None:
            raise EncreError(f"{path}: has # for a frame's number, but {source} is one file; take it out")
        found[classic] = sequence.path(path, number) + (f":{channel}" if channel else "") if path else name
    return found


def in_file(name):
    """(path, name in it or "") of what --layer names in a file of its own; ("", name) of a layer."""
    match = re.fullmatch(r"(.+\.exr)(?::(.+))?", name, re.IGNORECASE | re.DOTALL)
    return (match[1], match[2] or "") if match else ("", name)


class Names:
    """What stands for which pass of a view: `passes` {classic name: channels}, `mattes` {IndexOB, IndexMA: Matte},
    `called` {classic name: what it is called in the file}, of those that are not called so, and `renderer`.

    passes: of stored.view_layers(), of the view layer `layer` and the `view`; asked: as of_frame() gives it; renderer:
    whose names are taken, None: whose is clear. EncreError: what is asked for is not there.
    """

    def __init__(self, exr, passes, layer, view, asked, renderer):
        self.passes, self.called, self.renderer = dict(passes), {}, renderer
        for classic, name in asked.items():
            self._ask(exr, classic, name)
        near = self._near(exr, layer, view)
        if "Encre Source" not in passes:
            self.renderer = renderer or renderers.recognized(near, exr.metadata)
            for name, fulls in renderers.named(self.renderer, near, self.passes, view).items():
                self.passes[name] = fulls
                self.called[name.removeprefix("Tinted ")] = fulls[0].rpartition(".")[0]
        self.mattes = {} if "Encre Index" in passes else self._mattes(exr, near, view, asked)

    def _near(self, exr, layer, view):
        """The file's channels that may be this view's: not another view layer's that has a picture, or another eye's.
        """
        others = [f"{name}." for name, eyes in view_layers(exr.own, exr.views).items()
                  if name not in ("", layer) and any({"Combined", "Encre Source"} & set(own) for own in eyes.values())]
        eyes = {*exr.views} - {view}
        return [full for full in exr.own if not full.startswith(tuple(others)) and not eyes & {*full.split(".")[:-1]}]

    def _ask(self, exr, classic, name):
        path, channel = in_file(name)
        if path:
            exr.beside(path)
            names = {full[len(path) + 1:]: full for full in exr.channels if full.startswith(f"{path}:")}
            layers = dict.fromkeys(short.rpartition(".")[0] for short in names)
            channel = channel or next(one for one in ("", *layers) if one in layers)
        else:
            names = {full: full for full in exr.own}
        found = [full for short, full in names.items() if short == channel or short.rpartition(".")[0] == channel]
        if not found and not (classic in _INDICES and any(full.startswith(f"{channel}00.") for full in exr.own)):
            raise EncreError(f"{path or exr.path}: " + unknown("layer", channel, dict.fromkeys(
                short.rpartition(".")[0] or short for short in names)))
        found.sort(key=renderers.letter)
        self.passes.pop(classic, None)
        if found:
            self.passes[classic] = renderers.one_of(found) if classic in renderers.SINGLE else found
            self.called[classic] = name

    def _mattes(self, exr, near, view, asked):
        there = mattes.found(near, exr.metadata, view)
        for index in _INDICES:
            if index in asked and index not in self.passes:
                chosen = [full for full in exr.own if re.match(re.escape(asked[index]) + r"\d\d\.", full)]
                there[index] = next(iter(mattes.found(chosen, {**exr.metadata, "cryptomatte/asked/name": asked[index]},
                                                      view).values()))
        found = {index: matte for index, matte in there.items() if index not in self.passes}
        for index, matte in found.items():
            names = f" ({len(matte.names)} names)" if matte.names else ""
            self.called[index] = f"Cryptomatte {matte.name}{names}"
        return found

    def words(self, where, asked):
        """What was taken for what by itself, in one sentence; None: nothing."""
        by_itself = {name: called for name, called in self.called.items() if name not in asked}
        if not by_itself:
            return None
        whose = f" as {self.renderer} calls them" if self.renderer else ""
        return f"{where} has passes{whose} ({', '.join(f'{name}: {called}' for name, called in by_itself.items())}); " \
            "name others by --layer, another renderer by --from"

    def read(self, path, seen):
        """{pass: channels} of what has to be read."""
        more = {name: fulls for name, fulls in self.passes.items() if name.startswith("Tinted ")}
        return {**wanted(self.passes, path, seen), **more,
                **{f"Matte {index}": list(matte.channels) for index, matte in self.mattes.items()}}


class Mattes:
    """Numbers for what Cryptomatte tells, the same in all bands of a picture."""

    def __init__(self, found):
        self.numbers = {index: mattes.Numbers(matte) for index, matte in found.items()}

    def number(self, pictures):
        for index, numbers in self.numbers.items():
            pictures[index] = numbers.of(pictures.pop(f"Matte {index}"))


def lit(names):
    """Whether passes of these names tell light and colour apart."""
    return "DiffCol" in names and not {"Encre Diffuse", "DiffDir", "Tinted DiffDir"}.isdisjoint(names)


def switch_off(names, settings):
    """(settings, sentences): without what passes that are not among `names` would be needed for."""
    said = []
    if "Combined" not in names and "Encre Source" not in names:
        return settings, said
    if not lit(names):
        bare = _bare(settings)
        off = {"use_hatching": False, "line_shadow_strength": 0.0, "ink_in_shade": 0.0,
               **({"other_light": 0.0} if bare else {"use_shading": False})}
        styles = [(name, {**values, **{id_: value for id_, value in off.items() if id_ in values}})
                  for name, values in settings.styles]
        settings = Settings({**settings.scene, **off}, styles, settings.space)
        said.append("no diffuse light and color: " + (
            "tones follow how bright the picture is, nothing is hatched" if bare else
            "under the lines the picture stays as it is, nothing is shaded flat or hatched")
            + ", and no line follows a shadow")
    for name, sentence in (("DiffCol", "no diffuse color: lines between colors follow the picture's"),
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
    for name, tinted in renderers.TINTED.items():
        if tinted in pictures:
            light = pictures.pop(tinted)
            if "DiffCol" in pictures:
                color = pictures["DiffCol"]
                pictures[name] = np.where(color > _BLACK, light / np.maximum(color, _BLACK), 0).astype(np.float32)
    if shown == "Combined" and "Depth" in pictures and not (pictures["Depth"] > 0).any():
        pictures["Depth"] = -pictures["Depth"]  # along the axis on which the camera looks towards less
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


def listed(names):
    """Lines of text: which passes of Names are there, and what each that is missing switches off."""
    lines, passes = [], names.passes
    own = {"Encre Source": ("Combined",), "Encre Diffuse": ("DiffDir", "DiffInd"),
           "Encre Index": ("IndexOB", "IndexMA")}
    stands = {name: by for by, names in own.items() if by in passes for name in names}
    stands.update({name: by for by, name in slim.STANDS.items() if by in passes})
    stands.update(names.called)
    for name, (box, without) in BOXES.items():
        if name in passes or name in stands:
            lines.append(f"  {name}: there" + (f", as {stands[name]}" if name in stands else ""))
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
