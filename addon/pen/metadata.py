# SPDX-License-Identifier: GPL-3.0-or-later
"""The settings of a picture in its file's metadata, as JSON, so that it can be drawn again without Blender."""

import json
from dataclasses import dataclass, field

import numpy as np

from . import library
from .errors import EncreError
from .job import Camera, Frame

PARAMS, FRAME, CAMERA, BORDER = "encre.params", "encre.frame", "encre.camera", "encre.border"
VERSION = 1
_BORDER = ("x", "y", "width", "height")


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
    warnings: list = field(default_factory=list)


def write(scene, styles, camera, frame, border=None):
    """{key: JSON text} to store in a file, of what Stored says; `styles` in the order of their numbers."""
    said = {
        PARAMS: {"version": VERSION, "scene": scene,
                 "styles": [{"name": name, "values": values} for name, values in styles]},
        FRAME: {"width": frame.width, "height": frame.height, "x": frame.x, "y": frame.y},
        CAMERA: {"orthographic": bool(camera.orthographic), "height": float(camera.height),
                 "view": [float(v) for v in np.ravel(camera.view)]},
    }
    if border:
        said[BORDER] = dict(zip(_BORDER, border, strict=True))
    return {key: json.dumps(value, allow_nan=False) for key, value in said.items()}


def read(texts):
    """The Stored in {key: text}; keys that are not ours are ignored.

    A parameter that this version does not know is a warning. EncreError: metadata that can't be understood, the
    sentence names them.
    """
    stored = Stored()
    for key, understand in ((PARAMS, _read_params), (FRAME, _read_frame), (CAMERA, _read_camera),
                            (BORDER, _read_border)):
        if key not in texts:
            continue
        try:
            understand(json.loads(texts[key]), stored)
        except EncreError as error:
            raise EncreError(f"the metadata {key} can't be used: {error}") from None
        except (ValueError, TypeError, KeyError, AttributeError, OverflowError, RecursionError):
            raise EncreError(f"the metadata {key} can't be read: render the picture again, or remove them "
                                  "from the file") from None
    return stored


def _known(values, stored):
    if not isinstance(values, dict):
        raise TypeError
    for name in values.keys() - library.params().keys():
        stored.warnings.append(f"the metadata {PARAMS} hold the unknown parameter {name}: it is ignored")
    return library.check({name: value for name, value in values.items() if name in library.params()})


def _read_params(said, stored):
    if said["version"] != VERSION:
        raise EncreError(f"they have version {said['version']}, and this Encre reads {VERSION}")
    stored.scene = _known(said.get("scene", {}), stored)
    stored.styles = [(str(style["name"]), _known(style.get("values", {}), stored))
                       for style in said.get("styles", [])]


def _read_frame(said, stored):
    sizes = [said[key] for key in ("width", "height", "x", "y")]
    if any(type(size) is not int for size in sizes) or sizes[0] < 1 or sizes[1] < 1:
        raise ValueError
    stored.frame = Frame(*sizes)


def _read_camera(said, stored):
    view = np.array(said["view"], np.float64)
    orthographic, height = said["orthographic"], float(said["height"])
    if view.shape != (9,) or not np.isfinite(view).all() or type(orthographic) is not bool or not height > 0:
        raise ValueError
    stored.camera = Camera(tuple(view), orthographic, height)


def _read_border(said, stored):
    border = tuple(said[key] for key in _BORDER)
    if any(type(number) is not int for number in border) or min(border) < 0 or min(border[2:]) < 1:
        raise ValueError
    stored.border = border
