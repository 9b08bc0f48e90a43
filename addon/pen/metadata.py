# SPDX-License-Identifier: GPL-3.0-or-later
"""The settings of a picture in its file's metadata, as JSON, so that it can be drawn again without Blender."""

import base64
import json
import lzma
import zlib
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, field
from types import MappingProxyType
from typing import Any

import numpy as np

from . import chains, library, settings
from .errors import EncreError
from .job import Camera, Chains, Frame
from .params import Chosen

PARAMS, FRAME, CAMERA, BORDER = "encre.params", "encre.frame", "encre.camera", "encre.border"
VIEW, IMAGES, LOST = "encre.view", "encre.paper", "encre.lost"  # once, the paper's was the only image
CHAINS = "encre.chains"
_MOST_IMAGES = 1 << 26  # values of all images in a file
_PAPER = "paper_image"
MARK = "encre.mark"  # from what a frame of a sequence was made: sequence.py
VERSION = 1
_BORDER = ("x", "y", "width", "height")


@dataclass
class View:
    """How the scene is shown: the name of Blender's view transform, exposure in stops, display gamma, look or "", the
    display, and words for what else is done to it."""

    transform: str = "Standard"
    exposure: float = 0.0
    gamma: float = 1.0
    look: str = ""
    display: str = "sRGB"
    beside: list = field(default_factory=list)


@dataclass
class Stored:
    """What a file's metadata say. None: the file does not say it.

    styles: (name, values) pairs; border: (x, y, width, height) of what was rendered of the file's pixels, if not all.
    """

    scene: dict | None = None
    styles: list = field(default_factory=list)
    camera: Camera | None = None
    frame: Frame | None = None
    border: tuple | None = None
    view: View | None = None
    images: dict = field(default_factory=dict)  # {Chosen: pixels} of those that are no files
    lost: list = field(default_factory=list)  # what is in Combined and can't be drawn again
    chains: dict = field(default_factory=dict)  # {(view layer, view): Chains}, lines that the meshes told
    warnings: list = field(default_factory=list)
    unknown: dict = field(default_factory=dict)


def write(scene: dict[str, Any], styles: Sequence[tuple[str, dict[str, Any]]], camera: Camera, frame: Frame,
          border: Sequence[int] | None = None, view: View | None = None,
          images: Mapping[Chosen, np.ndarray] = MappingProxyType({}), lost: Sequence[str] = ()) -> dict[str, str]:
    """{key: JSON text} to store in a file, of what Stored says; `styles` in the order of their numbers."""
    said: dict[str, Any] = {
        PARAMS: {"version": VERSION, "settings": settings.VERSION, "scene": scene,
                 "styles": [{"name": name, "values": values} for name, values in styles]},
        FRAME: asdict(frame),
        CAMERA: {"orthographic": bool(camera.orthographic), "height": float(camera.height),
                 "distance": float(camera.distance), "light": float(camera.light), "shade": float(camera.shade),
                 "view": [float(v) for v in np.ravel(camera.view)]},
    }
    if view:
        said[VIEW] = asdict(view)
    if packed := [_packed(chosen, images[chosen]) for chosen in fitting(images)]:
        # One alone, of the paper, as files had it before there were others.
        said[IMAGES] = packed[0] if len(packed) == 1 else packed
    if lost:
        said[LOST] = list(lost)
    if border:
        said[BORDER] = dict(zip(_BORDER, border, strict=True))
    return {key: json.dumps(value, allow_nan=False) for key, value in said.items()}


def write_chains(told: Mapping[tuple[str, str], Chains]) -> dict[str, str]:
    """Likewise, of Stored.chains."""
    return {CHAINS: json.dumps([[*key, chains.pack(of)] for key, of in told.items()])} if told else {}


def read(texts: Mapping[str, str]) -> Stored:
    """The Stored in {key: text}; keys that are not ours are ignored.

    A parameter that this version does not know is a warning. EncreError: metadata that can't be understood, the
    sentence names them.
    """
    stored = Stored()
    for key, understand in ((PARAMS, _read_params), (FRAME, _read_frame), (CAMERA, _read_camera),
                            (BORDER, _read_border), (VIEW, _read_view), (IMAGES, _read_images), (LOST, _read_lost),
                            (CHAINS, _read_chains)):
        if key not in texts:
            continue
        try:
            understand(json.loads(texts[key]), stored)
        except EncreError as error:
            raise EncreError(f"the metadata {key} can't be used: {error}") from None
        except (ValueError, TypeError, KeyError, AttributeError, OverflowError, RecursionError, zlib.error,
                lzma.LZMAError):
            raise EncreError(f"the metadata {key} can't be read: render the picture again, or remove them "
                                  "from the file") from None
    return stored


def _known(values, stored):
    if not isinstance(values, dict):
        raise TypeError
    stored.unknown.update(dict.fromkeys(name for name in values if name not in library.params()))
    return library.check({name: value for name, value in values.items() if name in library.params()})


def _read_params(said, stored):
    if said["version"] != VERSION:
        raise EncreError(f"they have version {said['version']}, and this Encre reads {VERSION}")
    # A file lists all that its version knew; what it does not is as that version did it.
    before = settings.since(int(said.get("settings", 0)))
    stored.scene = {**before, **_known(said.get("scene", {}), stored)}
    stored.styles = [(str(style["name"]), _known(style.get("values", {}), stored))
                       for style in said.get("styles", [])]
    if count := len(stored.unknown):
        some = ", ".join(name[:40] for name in list(stored.unknown)[:5]) + (", ..." if count > 5 else "")
        stored.warnings.append(f"the metadata {PARAMS} hold {count} unknown parameter{'s' * (count > 1)}, which "
                                 f"{'are' if count > 1 else 'is'} ignored: {some}")


def _read_frame(said, stored):
    width, height, x, y = sizes = [said[key] for key in ("width", "height", "x", "y")]
    if any(type(size) is not int for size in sizes) or width < 1 or height < 1:
        raise ValueError
    number = said.get("number", 0)  # files of older versions
    stored.frame = Frame(width, height, x, y, number if type(number) is int and abs(number) < 2**31 else 0)


def _read_camera(said, stored):
    view = np.array(said["view"], np.float64)
    orthographic, height, distance = said["orthographic"], float(said["height"]), float(said.get("distance", 0))
    light, shade = float(said.get("light", 0)), float(said.get("shade", 0))
    if view.shape != (9,) or not np.isfinite(view).all() or type(orthographic) is not bool or not height > 0 \
            or not 0 <= distance < np.inf or not 0 <= light < np.inf or not (0 <= shade < light or shade == 0):
        raise ValueError
    stored.camera = Camera(tuple(view), orthographic, height, distance, light, shade)


def _read_border(said, stored):
    border = tuple(said[key] for key in _BORDER)
    if any(type(number) is not int for number in border) or min(border) < 0 or min(border[2:]) < 1:
        raise ValueError
    stored.border = border


def _read_view(said, stored):
    exposure, gamma = float(said["exposure"]), float(said["gamma"])
    if not (abs(exposure) <= 64 and 0.01 <= gamma <= 100):
        raise ValueError
    stored.view = View(str(said["transform"]), exposure, gamma, str(said["look"]), str(said.get("display", "sRGB")),
                       [str(what) for what in said.get("beside", ())][:16])


def fitting(images: Mapping[Chosen, np.ndarray]) -> list[Chosen]:
    """Those of the images that a file has room for: with more it could not be read again."""
    room, found = _MOST_IMAGES, []
    for chosen, pixels in images.items():
        if pixels.size <= room:
            room -= pixels.size
            found.append(chosen)
    return found


def _packed(chosen, pixels):
    """An image (H, W, channels) of floats as JSON takes it; those of 8 bits take no more room than that."""
    data, bits = np.ascontiguousarray(pixels, "<f4"), 32
    if (abs(pixels - 0.5) <= 0.5).all():
        rounded = np.round(pixels * np.float32(255)).astype(np.uint8)
        if np.array_equal(rounded.astype(np.float32) / np.float32(255), pixels):
            data, bits = rounded, 8
    of = {} if chosen.id == _PAPER else {"param": chosen.id}
    return {"name": chosen.name, **of, "shape": pixels.shape, "bits": bits,
            "data": base64.b64encode(zlib.compress(data.tobytes())).decode()}


def _read_images(said, stored):
    room = _MOST_IMAGES
    for one in said if isinstance(said, list) else [said]:
        chosen, pixels = _unpacked(one, room)
        stored.images[chosen] = pixels
        room -= pixels.size


def _unpacked(said, room):
    """(Chosen, pixels) of an image of at most `room` values."""
    shape, bits = tuple(said["shape"]), said["bits"]
    if len(shape) != 3 or any(type(n) is not int or n < 1 for n in shape) or bits not in (8, 32) \
            or shape[2] > 4 or np.prod(shape, dtype=float) > room:
        raise ValueError
    size = shape[0] * shape[1] * shape[2] * bits // 8
    data = zlib.decompressobj().decompress(base64.b64decode(said["data"]), size)
    pixels = np.frombuffer(data, np.uint8 if bits == 8 else "<f4").reshape(shape)
    return (Chosen(str(said.get("param", _PAPER)), str(said["name"])),
            pixels / np.float32(255) if bits == 8 else pixels.astype(np.float32))


def _read_lost(said, stored):
    stored.lost = [str(what) for what in said][:16]


def _read_chains(said, stored):
    for layer, view, text in said:
        stored.chains[str(layer), str(view)] = chains.unpack(text)
