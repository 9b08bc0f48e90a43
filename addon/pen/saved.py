# SPDX-License-Identifier: GPL-3.0-or-later
"""What a file keeps beside Cycles' passes, so that its picture can be drawn again: layers packed into passes of one,
three or four channels, which Blender's compositor can show. Only files have these passes; all else has layers.
"""

from collections.abc import Container

import numpy as np

from . import library
from .settings import Settings

PARTS = "seen_depth", "anchor", "tangent", "card"  # layers that a frame has only where something reads them
_WHOLE = {"Encre Source": "combined", "Encre Diffuse": "diffuse", "Encre Seen Depth": "seen_depth",
          "Encre Tangent": "tangent", "Encre Card": "card"}
_INDEX = "Encre Index"
_NUMBERS = ("object", "material", "style")
ANCHOR = {"Encre Anchor": slice(0, 3), "Encre Anchor Normal": slice(3, 7), "Encre Anchor X": slice(7, 10),
          "Encre Anchor Y": slice(10, 13), "Encre Anchor Form": slice(13, 16)}  # channels of the layer `anchor`


def passes(parts: Container[str] = PARTS) -> dict[str, str]:
    """{pass: channel letters}. parts: names of layers that are there, of which those in PARTS count."""
    controls = {name: _letters(places) for name, places in control_passes().items()}
    out = {"Encre Source": "RGBA", "Encre Diffuse": "RGB", _INDEX: "XYZ", **controls}
    if "seen_depth" in parts:
        out["Encre Seen Depth"] = "X"
    if "anchor" in parts:
        out.update((name, "XYZ" if at.stop - at.start == 3 else "RGBA") for name, at in ANCHOR.items())
    if "tangent" in parts:
        out["Encre Tangent"] = "XYZ"
    if "card" in parts:
        out["Encre Card"] = "RGBA"
    return out


def control_passes() -> dict[str, list[tuple[int, int]]]:
    """{pass: [(its channel, that of the layer `controls`)]}."""
    out: dict[str, list[tuple[int, int]]] = {}
    for k, control in enumerate(library.controls().values()):
        out.setdefault(control.saved, []).append((control.channel, k))
    return out


def _letters(places: list[tuple[int, int]]) -> str:
    return "XYZ" if any(channel for channel, _ in places) else "X"


def pack(name: str, layers: dict[str, np.ndarray]) -> np.ndarray | None:
    """The pass `name` of passes(), (height, width, channels), from the layers of a picture; None: it has none of it."""
    if name in _WHOLE:
        return layers.get(_WHOLE[name])
    if name in ANCHOR:
        return layers["anchor"][..., ANCHOR[name]] if "anchor" in layers else None
    if name == _INDEX:
        channels, places = 3, [(channel, layers.get(layer), 0) for channel, layer in enumerate(_NUMBERS)]
    else:
        channels = len(_letters(control_passes()[name]))
        places = [(channel, layers.get("controls"), k) for channel, k in control_passes()[name]]
    # From below to above, as Blender stores it: writing it copies nothing.
    out = np.zeros((*layers["combined"].shape[:2], channels), np.float32)[::-1]
    for channel, layer, k in places:
        if layer is not None:
            out[..., channel] = layer[..., k]
    return out


def missing(names: Container[str], settings: Settings) -> list[str]:
    """What is not drawn as it was asked for without those of the passes() that are not among `names`: sentences."""
    said = []
    if settings.sticks and "Encre Anchor" not in names:
        said.append("no rest positions, which save_rest=ON renders: tones, the paint of balls and the hand of lines "
                    "stick to the picture")
    elif settings.follows_uv and "Encre Tangent" not in names:
        said.append("no directions of UV maps, which save_rest=ON renders: strokes go along the form")
    if settings.lies_flat and "Encre Card" not in names:
        said.append("no sheets of things, which save_rest=ON renders: flat tones stick to the picture")
    return said


def tells_no_lines(names: Container[str], chains: bool, settings: Settings) -> str | None:
    """What is drawn otherwise of a file that holds the lines of meshes as older versions did; None: nothing is."""
    if chains or "Encre Marks" not in names or not settings.wants_edges or \
            settings.every[0]["edge_detector"] != "FINE":
        return None
    return "its outlines and creases from depth and normals; render again for the lines of the meshes"


def unpack(found: dict[str, np.ndarray]) -> dict[str, np.ndarray]:
    """{layer: picture (height, width, channels)} of those of the passes() that are there; older files have fewer."""
    out = {layer: found[name] for name, layer in _WHOLE.items() if name in found}
    if _INDEX in found:
        out.update((layer, found[_INDEX][..., k:k + 1]) for k, layer in enumerate(_NUMBERS))
    if found.keys() >= ANCHOR.keys():
        out["anchor"] = np.concatenate([found[name] for name in ANCHOR], 2)
    controls = [(found[name], places) for name, places in control_passes().items() if name in found]
    if controls:
        out["controls"] = np.zeros((*controls[0][0].shape[:2], len(library.controls())), np.float32)
    for picture, places in controls:
        for channel, k in places:
            out["controls"][..., k] = picture[..., channel]
    return out
