# SPDX-License-Identifier: GPL-3.0-or-later
"""Files of passes that can be drawn again: which of their channels are what."""

from collections.abc import Collection, Iterable, Mapping

import numpy as np

from . import layers, saved, slim
from .errors import EncreError

_LETTERS = "RGBAXYZW"
_BARE = {**dict.fromkeys("RGBA", "Combined"), "Z": "Depth"}


def known() -> dict[str, str]:
    """{classic pass name: channel letters} of all that is read."""
    return {**layers.CYCLES, **layers.BEHIND, "IndexMA": "X", **saved.passes(),
            **layers.SEEN, **slim.PASSES}


def view_layers(channels: Iterable[str], views: Collection[str] = ()) -> dict[str, dict[str, dict[str, list[str]]]]:
    """{view layer: {view: {classic pass name: [full channel name …]}}} in the file's order.

    Blender writes `ViewLayer.Pass.C`, in stereo `ViewLayer.Pass.view.C`; both names may hold dots themselves, so
    known passes are looked for at the end. A picture without view layers or views has the one called "", where
    R, G, B, A alone are Combined and Z is Depth, in small letters too.
    """
    found: dict[str, dict[str, dict[str, list[str]]]] = {}
    names = *known(), *layers.RENAMED.values()
    for full in channels:
        name, _, letter = full.rpartition(".")
        view = next((view for view in views if name.rpartition(".")[2] == view), "")
        name = name.removesuffix(view).removesuffix(".") or _BARE.get(letter.upper(), letter)
        layer, _, last = name.rpartition(".")
        for one in names:
            if name == one or name.endswith("." + one):
                layer, last = name[:-len(one)].removesuffix("."), one
        passes = found.setdefault(layer, {}).setdefault(view, {})
        passes.setdefault(layers.classic(last), []).append(full)
    for eyes in found.values():
        for passes in eyes.values():
            for fulls in passes.values():
                fulls.sort(key=lambda full: _LETTERS.find(full[-1].upper()))
    return found


def wanted(passes: Mapping[str, list[str]], path: str, seen: bool) -> dict[str, list[str]]:
    """{pass: channels} that have to be read: not those that Encre's own passes stand for, what is `seen` if asked."""
    letters = known()
    found = {name: channels for name, channels in passes.items()
             if name in letters and (seen or name not in {*layers.SEEN, *slim.STANDS, "Encre Seen Depth"})}
    if "Encre Seen Depth" in found:
        found.pop("Denoising Depth", None)
    if "Encre Source" in found and "Encre Diffuse" in found:
        for name in ("Combined", "DiffDir", "DiffInd"):
            found.pop(name, None)
    for name, channels in found.items():
        by_letter = {full[-1].upper(): full for full in channels}
        asked = letters[name].removesuffix("A" if "A" not in by_letter else "")
        if set(asked) - set(by_letter) and len(channels) != len(asked):
            raise EncreError(f"{path}: pass {name} has the channels {', '.join(channels)}; "
                                  f"save it with all of {', '.join(letters[name])}")
        found[name] = [by_letter[letter] for letter in asked] if set(asked) <= set(by_letter) else channels
    return found


def opaque(picture: np.ndarray, name: str) -> np.ndarray:
    """A pass that was saved without its alpha covers all."""
    if picture.shape[2] == len(known().get(name, "X")):
        return picture
    return np.concatenate([picture, np.ones_like(picture[..., :1])], axis=2)
