# SPDX-License-Identifier: GPL-3.0-or-later
"""What the library is given and gives back, as numpy knows it. Shapes are checked here: C can't see them."""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from .errors import EncreError


@dataclass
class Camera:
    """view: rotation world -> camera, 9 floats row by row; height: of the frame in scene units, in perspective at a
    depth of 1; distance: depth of what the picture is about, 0: not known; light, shade: diffuse light that is full
    light to shade_meter LAMPS, and that of the shade, 0: not known."""

    view: Sequence[float] = (1, 0, 0, 0, 1, 0, 0, 0, 1)
    orthographic: bool = False
    height: float = 1.0
    distance: float = 0.0
    light: float = 0.0
    shade: float = 0.0


@dataclass
class Frame:
    """Size of the full frame in pixels, where the images' top left pixel lies in it, and which of its animation it is.
    """

    width: int
    height: int
    x: int = 0
    y: int = 0
    number: int = 0


@dataclass
class Chains:
    """Lines that meshes tell of: points (n,) of abi.CHAIN_POINT, run by run, and by the number of an object whether all
    its lines of shapes are among them (m,)."""

    points: np.ndarray
    chained: np.ndarray


@dataclass
class Mesh:
    """What encre_raster draws: points (n, 3) in object space, corners (t, 3), attributes (t, 3, channels); numbers of
    `object`, `material` and `style` (t,) or one for all; edges (t,) packed by edge_kinds(), and the degrees that are
    added to every bend; the seed by which a copy's pens and tones differ from another's, 0: it is none; normals
    (t, 3, 3) at the corners, in object space, None: flat; rest positions and their normals likewise, None: the points,
    flat; uv (t, 3, 2) at the corners; open: light goes through it, and of its lines chains have those of colors alone.
    Of kind `lines`: points and corners (t, 2) alone.
    """

    points: np.ndarray
    corners: np.ndarray | None = None
    attributes: np.ndarray | None = None
    material: np.ndarray | None = None
    style: np.ndarray | None = None
    object: np.ndarray | None = None
    model: np.ndarray = field(default_factory=lambda: np.eye(4))
    object_index: int = 0
    material_index: int = 0
    style_index: int = 0
    kind: str = "triangles"
    edges: np.ndarray | None = None
    crease_offset: float = 0.0
    seed: int = 0
    normals: np.ndarray | None = None
    rest: np.ndarray | None = None
    rest_normals: np.ndarray | None = None
    uv: np.ndarray | None = None
    open: bool = False


EDGES = {"flat": 0, "smooth": 1, "none": 2}  # enum encre_edge


def edge_kinds(kinds: np.ndarray) -> np.ndarray:
    """(t, 3) numbers of EDGES, of the edges from each corner of triangles, as Mesh.edges has them."""
    return (kinds @ np.array((1, 4, 16), np.uint8)).astype(np.uint8)


LAMPS = ("sun", "point", "spot", "rectangle", "ellipse")  # enum encre_lamp_type
EVERY_SET = 2 ** 64 - 1


@dataclass
class Lamp:
    """A lamp at the origin of its own space, which shines along -z; lengths, angles (radians) and units as in
    encre_lamp: color is W/m2 of a sun, else W."""

    kind: str
    color: Sequence[float] = (1, 1, 1)
    width: float = 0.0
    height: float = 0.0
    spot_angle: float = 0.0
    spot_blend: float = 0.0
    spread: float = math.pi
    flat: bool = False
    matt: bool = False
    shadows: bool = True
    light_set: int = 0
    shadow_set: int = 0
    model: np.ndarray = field(default_factory=lambda: np.eye(4))


@dataclass
class Bend:
    """An ellipsoid in which light falls as on its own surface: a ball of radius 1 -> world; amount, fade: 0..1, as in
    encre_bend."""

    model: np.ndarray
    amount: float = 1.0
    fade: float = 0.0


@dataclass
class Work:
    """A job of the library that is ready to run: at once (Library.run()) or beside others (background.py)."""

    kind: str                   # one of abi.WORKS
    job: Any                    # its structure, and what that points to
    keep: list
    result: Callable[[], Any]   # what has come of it, to be called when it has ended


@dataclass
class Picture:
    """texels: (n, 4) of `levels` levels of detail one after the other, each of half the width and height, row 0 at the
    bottom; float32, scene-linear, or uint8, whose colors `curve` (256) makes so. straight: whether the colors of bytes
    are to be multiplied by alpha; wrap: "repeat", "extend" or "clip"."""

    texels: np.ndarray
    width: int
    height: int
    levels: int = 1
    wrap: str = "repeat"
    curve: np.ndarray | None = None
    straight: bool = False


WRAPS = ("repeat", "extend", "clip")  # enum encre_extension


@dataclass
class Colored:
    """An image on surfaces, as they look without light: colors (height, width, 3), scene-linear, row 0 at the bottom;
    key: a number that no other colors have; wrap: one of WRAPS, or "mirror"; closest: its texels are not mixed; alpha:
    uint8 (height, width), below a half nothing is there, None: all is."""

    colors: np.ndarray
    key: int
    wrap: str = "repeat"
    closest: bool = False
    alpha: np.ndarray | None = None


@dataclass
class Colors:
    """What tells where colors part on meshes. images: Colored; image: by number of material, which of these its colors
    are those of, by the meshes' uv, -1: none tells; every: the values of styles, as Library.complete() gives them."""

    images: Sequence[Colored]
    image: np.ndarray
    every: Sequence[Mapping]


@dataclass
class Program:
    """operations: (n, 12), code, first output, eight inputs and two data of each; result: a register for each of enum
    encre_result."""

    operations: np.ndarray
    registers: int
    result: Sequence[int]


@dataclass
class Materials:
    """What encre_material runs: programs by number of material; things (objects, values): what is the same all over an
    object, by its number."""

    programs: Sequence[Program]
    textures: Sequence[Picture] = ()
    constants: np.ndarray = field(default_factory=lambda: np.zeros(0, np.float32))
    things: np.ndarray = field(default_factory=lambda: np.zeros((0, 0), np.float32))


@dataclass
class Result:
    images: dict[str, np.ndarray]
    nonfinite: int
    strokes: np.ndarray | None = None  # of abi.STROKE_POINT, where they were asked for


@dataclass
class Baked:
    """texture: None where it was only measured; greatest: largest difference of two neighbours, by contrast_metric."""

    texture: np.ndarray | None
    nonfinite: int
    greatest: float


def picture(name: str, a: np.ndarray, channels: int) -> np.ndarray:
    """float32 (height, width, channels) with adjacent channels and rows that don't overlap, as C reads them; a copy
    only where `a` is not like that."""
    a = np.asarray(a)
    if a.ndim not in (2, 3) or (a.shape[2] if a.ndim == 3 else 1) != channels:
        raise EncreError(f"{name}: the array has shape {a.shape}; give (height, width, {channels})")
    if a.shape[0] == 0 or a.shape[1] == 0:
        raise EncreError(f"{name}: is {a.shape[1]} x {a.shape[0]} pixels; give at least one pixel each way")
    apart = a.strides[1] >= 4 * channels and abs(a.strides[0]) >= a.shape[1] * a.strides[1]
    if a.dtype != np.float32 or not a.flags.aligned or (a.ndim == 3 and a.strides[2] != 4) or not apart:
        a = np.ascontiguousarray(a, np.float32)
    return a


def whole(name: str, value: int) -> int:
    """`value`, which ctypes would cut to the 32 bits that C counts by."""
    if not -2 ** 31 <= value < 2 ** 31:
        raise EncreError(f"{name}: {value} is more than can be counted; give a number of 32 bits")
    return int(value)


def entries(what: str, a: np.ndarray, dtype: type, shape: tuple[int, ...]) -> np.ndarray:
    """The array `a` of exactly this shape: one that is too short would be read past its end. Numbers stay what they
    are."""
    given, a = np.asarray(a), np.ascontiguousarray(a, dtype)
    if dtype == np.int32 and given.dtype != dtype and not np.array_equal(given, a):
        raise EncreError(f"{what}: a number in it is not whole, or more than can be counted; give whole numbers of 32 "
                         "bits")
    if a.shape != shape:
        raise EncreError(f"{what}: the array has shape {a.shape}; give {shape}")
    return a


def filled_bytes(a: np.ndarray) -> np.ndarray:
    """`a`, into which C can write as it is."""
    if a.dtype != np.uint8 or not a.flags.writeable or not a.flags.c_contiguous:
        raise EncreError("texels: the array can't be filled; give a writeable one of uint8 in one piece")
    return a


def filled(name: str, a: np.ndarray, shape: tuple[int, ...]) -> np.ndarray:
    """`a`, into which C can write as it is: where picture() would copy, what is written would be lost."""
    if a.shape != shape or not a.flags.writeable or picture(name, a, shape[2] if len(shape) == 3 else 1) is not a:
        raise EncreError(f"{name}: the array can't be filled; give a writeable one of float32, of shape {shape}, whose "
                         "channels are adjacent and whose rows don't overlap")
    return a
