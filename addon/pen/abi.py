# SPDX-License-Identifier: GPL-3.0-or-later
"""The structures and functions of csrc/encre.h, and numpy arrays and values of parameters as the library takes them."""

import ctypes as c
from collections.abc import Sequence
from ctypes import Array
from dataclasses import asdict
from typing import Any

import numpy as np

from . import job
from .params import MAX_LEVELS, Param


class Image(c.Structure):
    _fields_ = [("data", c.c_void_p), ("width", c.c_int32), ("height", c.c_int32), ("channels", c.c_int32),
                ("reserved", c.c_int32), ("pixel_stride", c.c_int64), ("row_stride", c.c_int64)]


class LayerInfo(c.Structure):
    _fields_ = [("name", c.c_char_p), ("help", c.c_char_p), ("channels", c.c_int32), ("required", c.c_int32)]


class ControlInfo(c.Structure):
    _fields_ = [("name", c.c_char_p), ("label", c.c_char_p), ("white", c.c_char_p), ("black", c.c_char_p),
                ("saved", c.c_char_p), ("channel", c.c_int32), ("reserved", c.c_int32)]


class Level(c.Structure):
    _fields_ = [("intensity", c.c_float), ("threshold", c.c_float), ("transition", c.c_float), ("color", c.c_float * 3)]


class Levels(c.Structure):
    _fields_ = [("count", c.c_int32), ("level", Level * MAX_LEVELS)]


class Item(c.Structure):
    _fields_ = [("id", c.c_char_p), ("label", c.c_char_p), ("help", c.c_char_p), ("number", c.c_int64)]


class ParamInfo(c.Structure):
    _fields_ = [("id", c.c_char_p), ("label", c.c_char_p), ("help", c.c_char_p), ("unit", c.c_char_p),
                ("enabled_if", c.c_char_p), ("items", c.POINTER(Item)), ("n_items", c.c_int32), ("type", c.c_int32),
                ("scope", c.c_int32), ("offset", c.c_int32), ("value", c.c_double * 3), ("hard_min", c.c_double),
                ("hard_max", c.c_double), ("soft_min", c.c_double), ("soft_max", c.c_double),
                ("levels", c.POINTER(Levels)), ("is_switch", c.c_int32), ("reserved", c.c_int32)]


class StageInfo(c.Structure):
    _fields_ = [("id", c.c_char_p), ("label", c.c_char_p), ("help", c.c_char_p), ("params", c.POINTER(ParamInfo)),
                ("n_params", c.c_int32), ("reserved", c.c_int32)]


class Camera(c.Structure):
    _fields_ = [("view", c.c_float * 9), ("orthographic", c.c_int32), ("height", c.c_float), ("distance", c.c_float),
                ("light", c.c_float), ("shade", c.c_float)]


class Frame(c.Structure):
    _fields_ = [("width", c.c_int32), ("height", c.c_int32), ("x", c.c_int32), ("y", c.c_int32),
                ("number", c.c_int32)]


Progress = c.CFUNCTYPE(c.c_bool, c.c_void_p, c.c_double)


class Mesh(c.Structure):
    _fields_ = [("kind", c.c_int32), ("n_primitives", c.c_int32), ("n_points", c.c_int32), ("n_channels", c.c_int32),
                ("points", c.c_void_p), ("corners", c.c_void_p), ("attributes", c.c_void_p),
                ("material", c.c_void_p), ("style", c.c_void_p), ("model", c.c_double * 16),
                ("object_index", c.c_int32), ("material_index", c.c_int32), ("style_index", c.c_int32),
                ("open", c.c_int32), ("object", c.c_void_p), ("edges", c.c_void_p), ("crease_offset", c.c_float),
                ("seed", c.c_int32), ("normals", c.c_void_p), ("rest", c.c_void_p), ("rest_normals", c.c_void_p),
                ("uv", c.c_void_p)]


KINDS = {"triangles": 3, "lines": 2}  # corners of a primitive, in the order of enum encre_primitive
RASTER_OUTPUTS = ("depth", "normal", "object", "material", "style", "attributes")


class RasterJob(c.Structure):
    _fields_ = [("meshes", c.POINTER(Mesh)), ("n_meshes", c.c_int32), ("n_channels", c.c_int32),
                ("view", c.c_double * 16), ("projection", c.c_double * 16), ("clip_start", c.c_double),
                ("clip_end", c.c_double), ("frame", Frame), *((n, Image) for n in RASTER_OUTPUTS),
                ("progress", Progress), ("user", c.c_void_p), ("coincident", Image), ("shading", Image),
                ("beyond", Image), ("anchor", Image), ("tangent", Image), ("card", Image)]


class ChainPoint(c.Structure):
    _fields_ = [*((name, c.c_float) for name in ("x", "y", "depth", "bend", "gap")), ("along", c.c_float * 2),
                ("over", c.c_float), ("fade", c.c_float), *((name, c.c_int32) for name in (
                    "mesh", "edge", "kind", "side", "object", "behind", "run", "end")), ("color", c.c_int32 * 2)]


CHAIN_POINT = np.dtype(ChainPoint)
# Its bits of `kind` and values of `end`.
CHAIN_KINDS = ("contour", "border", "number", "crease", "meet", "mark", "bevel", "smooth", "other", "material", "flush",
               "round", "hidden", "color")
CHAIN_ENDS = ("none", "node", "hidden", "frame", "loop")


class LineInfo(c.Structure):
    _fields_ = [("id", c.c_char_p), ("label", c.c_char_p)]


class StrokePoint(c.Structure):
    _fields_ = [*((name, c.c_float) for name in ("x", "y", "width")), ("ink", c.c_float * 4), ("depth", c.c_float),
                *((name, c.c_int32) for name in ("stroke", "kind", "object", "mesh", "edge", "pass", "end", "hider"))]


STROKE_POINT = np.dtype(StrokePoint)


class Colored(c.Structure):
    _fields_ = [("key", c.c_int64), ("width", c.c_int32), ("height", c.c_int32), ("colors", c.c_void_p),
                ("wrap", c.c_int32), ("closest", c.c_int32), ("alpha", c.c_void_p)]


class ChainJob(c.Structure):
    _fields_ = [("meshes", c.POINTER(Mesh)), ("n_meshes", c.c_int32), ("width", c.c_int32), ("height", c.c_int32),
                ("least_bend", c.c_float), ("view", c.c_double * 16), ("projection", c.c_double * 16),
                ("clip_start", c.c_double), ("clip_end", c.c_double), ("frame", Frame), ("progress", Progress),
                ("user", c.c_void_p), ("points", c.c_void_p), ("n_points", c.c_int64),
                ("most_before", c.c_int32), ("reserved", c.c_int32), ("images", c.c_void_p),
                ("n_images", c.c_int32), ("n_image", c.c_int32), ("image", c.c_void_p), ("params", c.c_void_p),
                ("n_styles", c.c_int32), ("spare", c.c_int32)]


def _points(at: int, count: int, what: np.dtype) -> np.ndarray:
    """A copy: the context keeps its own only until the next job."""
    out = np.empty(count, what)
    c.memmove(out.ctypes.data, at, out.nbytes) if len(out) else None
    return out


def chain_points(found: ChainJob) -> np.ndarray:
    """The points that a job has found."""
    return _points(found.points, found.n_points, CHAIN_POINT)


def stroke_points(drawn: Any) -> np.ndarray:
    """The points of strokes that a job has drawn."""
    return _points(drawn.strokes, drawn.n_strokes, STROKE_POINT)


class BakeJob(c.Structure):
    _fields_ = [("texture", Image), ("form", Image), ("output", Image), ("params", c.c_void_p),
                ("linear", c.c_int32), ("wrap_x", c.c_int32), ("wrap_y", c.c_int32), ("reserved", c.c_int32),
                ("progress", Progress), ("user", c.c_void_p), ("nonfinite", c.c_int64), ("greatest", c.c_double)]


EVEN_INPUTS = {"light": 3, "rendered": 3, "normal": 3, "depth": 1, "object": 1}  # channels
EVEN_REACH = 64  # ENCRE_EVEN_REACH


class EvenJob(c.Structure):
    _fields_ = [*((n, Image) for n in EVEN_INPUTS), ("progress", Progress), ("user", c.c_void_p)]


class AverageJob(c.Structure):
    _fields_ = [("large", Image), ("output", Image), ("factor", c.c_int32), ("reserved", c.c_int32),
                ("progress", Progress), ("user", c.c_void_p)]


class Geometry(c.Structure):
    _fields_ = [("n_points", c.c_int32), ("n_triangles", c.c_int32), ("points", c.c_void_p), ("corners", c.c_void_p),
                ("normals", c.c_void_p), ("uvs", c.c_void_p), ("textures", c.c_void_p)]


class Texture(c.Structure):
    _fields_ = [("width", c.c_int32), ("height", c.c_int32), ("extension", c.c_int32), ("closest", c.c_int32),
                ("alpha", c.c_void_p)]


class Instance(c.Structure):
    _fields_ = [("geometry", c.c_int64), ("model", c.c_double * 16), ("light_sets", c.c_uint64),
                ("shadow_sets", c.c_uint64), ("camera", c.c_int32), ("reserved", c.c_int32)]


class Lamp(c.Structure):
    _fields_ = [("type", c.c_int32), ("shadows", c.c_int32), ("light_set", c.c_int32), ("shadow_set", c.c_int32),
                ("color", c.c_float * 3), ("width", c.c_float), ("height", c.c_float), ("spot_angle", c.c_float),
                ("spot_blend", c.c_float), ("spread", c.c_float), ("flat", c.c_int32), ("matt", c.c_int32),
                ("model", c.c_double * 16)]


class Bend(c.Structure):
    _fields_ = [("model", c.c_double * 16), ("amount", c.c_float), ("fade", c.c_float)]


class LightJob(c.Structure):
    _fields_ = [("scene", c.c_void_p), ("view", c.c_double * 16), ("projection", c.c_double * 16),
                ("clip_start", c.c_double), ("clip_end", c.c_double), ("frame", Frame), ("depth", Image),
                ("normal", Image), ("diffuse", Image), ("shine", Image), ("turned", Image),
                ("specular", Image),
                ("world", c.c_float * 27), ("n_bends", c.c_int32), ("bends", c.c_void_p), ("sharp", c.c_bool),
                ("rims", c.c_bool),
                ("unshadowed", c.c_bool),
                ("progress", Progress), ("user", c.c_void_p)]


class OperationInfo(c.Structure):
    _fields_ = [("name", c.c_char_p), ("inputs", c.c_int32), ("outputs", c.c_int32)]


class Operation(c.Structure):
    _fields_ = [("code", c.c_int32), ("out", c.c_int32), ("in", c.c_int32 * 8), ("data", c.c_int32 * 2)]


RESULTS = 21


class Program(c.Structure):
    _fields_ = [("operations", c.c_void_p), ("n_operations", c.c_int32), ("n_registers", c.c_int32),
                ("result", c.c_int32 * RESULTS)]


class Picture(c.Structure):
    _fields_ = [("texels", c.c_void_p), ("bytes", c.c_void_p), ("curve", c.c_void_p), ("width", c.c_int32),
                ("height", c.c_int32), ("levels", c.c_int32), ("wrap", c.c_int32), ("straight", c.c_int32),
                ("reserved", c.c_int32)]


class Materials(c.Structure):
    _fields_ = [("programs", c.POINTER(Program)), ("textures", c.POINTER(Picture)), ("constants", c.c_void_p),
                ("things", c.c_void_p), ("n_programs", c.c_int32), ("n_textures", c.c_int32),
                ("n_constants", c.c_int32), ("n_things", c.c_int32), ("n_values", c.c_int32), ("reserved", c.c_int32)]


MATERIAL_INPUTS = {"object": 1, "material": 1, "depth": 1, "normal": 3}  # channels
MATERIAL_OUTPUTS = {"color": 3, "gloss": 3, "emission": 3, "surface": 2, "shine": 6, "turned": 3,
                    "holdout": 1}


class MaterialJob(c.Structure):
    _fields_ = [("materials", c.POINTER(Materials)), ("view", c.c_double * 16), ("projection", c.c_double * 16),
                ("frame", Frame), *((n, Image) for n in MATERIAL_INPUTS), ("attributes", Image),
                *((n, Image) for n in MATERIAL_OUTPUTS), ("progress", Progress), ("user", c.c_void_p)]


class Step(c.Structure):
    _fields_ = [("kind", c.c_int32), ("reserved", c.c_int32), ("job", c.c_void_p)]


class CallJob(c.Structure):
    _fields_ = [("function", c.c_void_p), ("argument", c.c_void_p), ("progress", Progress), ("user", c.c_void_p)]


MOST_LEVELS = 32  # of a texture: each halves what an int32 counts

WORKS = ("render", "raster", "light", "bake", "material", "call", "chains", "even",
         "average")  # enum encre_kind; so are functions called


def steps(works: Sequence[job.Work]) -> Array[Step]:
    """What encre_start() takes; the works must live until they have ended."""
    return (Step * len(works))(*(Step(WORKS.index(work.kind), 0, c.addressof(work.job)) for work in works))


def image(a: np.ndarray) -> Image:
    """encre_image of an array (H, W) or (H, W, C) whose channels are adjacent."""
    channels = a.shape[2] if a.ndim == 3 else 1
    return Image(a.ctypes.data, a.shape[1], a.shape[0], channels, 0, a.strides[1], a.strides[0])


def frame(given: job.Frame) -> Frame:
    return Frame(*(job.whole(f"frame: {name}", value) for name, value in asdict(given).items()))


def given(name: str, a: np.ndarray, channels: int) -> tuple[np.ndarray, Image]:
    """(the array as the library can read it, its image); job.picture() says what is refused."""
    a = job.picture(name, a, channels)
    return a, image(a)


def fill_picture(to: Picture, texture: job.Picture, keep: list) -> None:
    """Makes `to` the texture, which holds as long as the arrays that `keep` gets live."""
    count, width, height = 0, texture.width, texture.height
    for _ in range(min(texture.levels, MOST_LEVELS)):
        count, width, height = count + width * height, max(1, width // 2), max(1, height // 2)
    kind = np.float32 if texture.curve is None else np.uint8
    keep.append(np.ascontiguousarray(job.entries("texture: texels", texture.texels, kind, (count, 4)), kind))
    at = keep[-1].ctypes.data if keep[-1].size else None
    if texture.curve is None:
        to.texels = at
    else:
        keep.append(np.ascontiguousarray(job.entries("texture: curve", texture.curve, np.float32, (256,)), np.float32))
        to.bytes, to.curve = at, keep[-1].ctypes.data
    to.width, to.height, to.levels = texture.width, texture.height, texture.levels
    to.wrap, to.straight = job.WRAPS.index(texture.wrap), texture.straight


def materials(given: job.Materials) -> tuple[Materials, list]:
    """(encre_materials, arrays as long as which it holds)."""
    keep: list = []

    def pointer(a, dtype):
        keep.append(np.ascontiguousarray(a, dtype))
        return keep[-1].ctypes.data if keep[-1].size else None

    programs, textures = (Program * max(1, len(given.programs)))(), (Picture * max(1, len(given.textures)))()
    for to, program in zip(programs, given.programs, strict=False):
        operations = job.entries("program: operations", program.operations, np.int32, (len(program.operations), 12))
        to.operations, to.n_operations = pointer(operations, np.int32), len(operations)
        to.n_registers = program.registers
        to.result[:] = list(program.result)
    for to, texture in zip(textures, given.textures, strict=False):
        fill_picture(to, texture, keep)
    things = np.asarray(given.things, np.float32)
    return Materials(programs, textures, pointer(given.constants, np.float32), pointer(things, np.float32),
                     len(given.programs), len(given.textures), len(given.constants), *things.shape, 0), keep


def fill_colors(found: ChainJob, colors: job.Colors) -> list:
    """Makes them the job's, which holds as long as the returned arrays live."""
    images, keep = (Colored * max(1, len(colors.images)))(), list[Any]()
    for to, image in zip(images, colors.images, strict=False):
        keep.append(np.ascontiguousarray(image.colors, np.float32))
        height, width, _ = keep[-1].shape
        to.key, to.width, to.height, to.colors = image.key, width, height, keep[-1].ctypes.data
        to.wrap, to.closest = (*job.WRAPS, "mirror").index(image.wrap), bool(image.closest)
        if image.alpha is not None:
            keep.append(job.entries("colored: alpha", image.alpha, np.uint8, (height, width)))
            to.alpha = keep[-1].ctypes.data
    of = np.ascontiguousarray(colors.image, np.int32)
    found.images, found.n_images = c.addressof(images), len(colors.images)
    found.image, found.n_image = of.ctypes.data, len(of)
    return [*keep, images, of]


def fill_mesh(m: Mesh, mesh: job.Mesh) -> list:
    """Makes m the mesh, which holds as long as the returned arrays live."""
    points = np.ascontiguousarray(mesh.points, np.float32).reshape(-1, 3)
    keep = [points]

    def pointer(what, a, dtype, shape):
        if a is None:
            return None
        keep.append(job.entries(f"mesh: {what}", a, dtype, shape))
        return keep[-1].ctypes.data

    each = KINDS[mesh.kind]
    m.kind = list(KINDS).index(mesh.kind)
    m.n_points = len(points)
    m.n_primitives = len(points) // each if mesh.corners is None else len(mesh.corners)
    m.n_channels = 0 if mesh.attributes is None else np.shape(mesh.attributes)[-1]
    m.points = points.ctypes.data
    count = m.n_primitives
    m.corners = pointer("corners", mesh.corners, np.int32, (count, each))
    m.attributes = pointer("attributes", mesh.attributes, np.float32, (count, 3, m.n_channels))
    m.material = pointer("material", mesh.material, np.int32, (count,))
    m.style = pointer("style", mesh.style, np.int32, (count,))
    m.object = pointer("object", mesh.object, np.int32, (count,))
    m.edges = pointer("edges", mesh.edges, np.uint8, (count,))
    m.crease_offset, m.seed, m.open = mesh.crease_offset, mesh.seed, mesh.open
    m.normals = pointer("normals", mesh.normals, np.float32, (count, 3, 3))
    m.rest = pointer("rest", mesh.rest, np.float32, (count, 3, 3))
    m.rest_normals = pointer("rest_normals", mesh.rest_normals, np.float32, (count, 3, 3))
    m.uv = pointer("uv", mesh.uv, np.float32, (count, 3, 2))
    m.model[:] = np.asarray(mesh.model, np.float64).ravel()
    for name in ("object_index", "material_index", "style_index"):
        setattr(m, name, job.whole(f"mesh: {name}", getattr(mesh, name)))
    return keep


def declare(lib: c.CDLL) -> None:
    """Tells ctypes what the functions of encre.h take and give."""
    lib.encre_stage_info.restype = c.POINTER(StageInfo)
    lib.encre_layer_info.restype = lib.encre_output_info.restype = c.POINTER(LayerInfo)
    lib.encre_control_info.restype = c.POINTER(ControlInfo)
    lib.encre_line_info.restype = c.POINTER(LineInfo)
    lib.encre_operation_info.restype = c.POINTER(OperationInfo)
    lib.encre_params_size.restype = c.c_int64
    lib.encre_params_check.restype = c.c_char_p
    lib.encre_params_check.argtypes = [c.c_void_p, c.c_char_p, c.c_int64]
    lib.encre_params_init.argtypes = [c.c_void_p]
    for name in ("encre_set_threads", "encre_set_simd"):
        getattr(lib, name).argtypes = [c.c_void_p, c.c_int32]
    lib.encre_scene_create.restype = c.c_void_p
    lib.encre_scene_free.argtypes, lib.encre_scene_free.restype = [c.c_void_p], None
    for name in ("encre_scene_geometry", "encre_scene_instance", "encre_scene_texture", "encre_scene_lamp"):
        getattr(lib, name).argtypes = [c.c_void_p, c.c_void_p, c.c_int64, c.c_void_p]
    lib.encre_scene_reach.argtypes = [c.c_void_p, c.c_void_p, c.c_int32, c.c_void_p, c.c_void_p, c.c_int32, c.c_void_p]
    for name in (*(f"encre_{kind}" for kind in WORKS), "encre_poll"):
        getattr(lib, name).argtypes = [c.c_void_p, c.c_void_p]
    lib.encre_picture_levels.argtypes = [c.c_void_p, c.c_void_p, c.c_void_p]
    lib.encre_flatten.argtypes = [c.c_void_p, c.c_void_p, c.c_int32, c.c_void_p]
    lib.encre_smooth.argtypes = [c.c_void_p, c.c_void_p, c.c_float, c.c_void_p]
    lib.encre_start.argtypes = [c.c_void_p, c.c_void_p, c.c_int32]
    lib.encre_wait.argtypes = lib.encre_cancel.argtypes = [c.c_void_p]
    lib.encre_cancel.restype = None


def render_job(layers: int, outputs: int) -> type[c.Structure]:
    """encre_job, for so many layers and outputs."""
    class Job(c.Structure):
        _fields_ = [("layers", Image * layers), ("outputs", Image * outputs),
                    ("camera", Camera), ("frame", Frame), ("params", c.c_void_p), ("n_styles", c.c_int32),
                    ("reserved", c.c_int32), ("progress", Progress), ("user", c.c_void_p),
                    ("nonfinite", c.c_int64), ("same", c.c_int64), ("chains", c.c_void_p), ("n_chains", c.c_int64),
                    ("chained", c.c_void_p), ("n_chained", c.c_int64), ("tell_strokes", c.c_int32),
                    ("reserved_2", c.c_int32), ("strokes", c.c_void_p), ("n_strokes", c.c_int64)]
    return Job


def put(p: Param, block: int, value: Any) -> None:
    """Writes a checked value to its place in the parameter block at an address; images are put by put_image()."""
    at = block + p.offset
    if p.type in ("bool", "int"):
        c.c_int32.from_address(at).value = int(value)
    elif p.type == "enum":
        c.c_int32.from_address(at).value = p.number[value]
    elif p.type == "float":
        c.c_float.from_address(at).value = value
    elif p.type == "color":
        (c.c_float * 3).from_address(at)[:] = value
    elif p.type == "levels":
        levels = Levels.from_address(at)
        levels.count = len(value)
        for k, level in enumerate(value):
            i, t, w, *color = tuple(level) + (0, 0, 0, 1, 1, 1)[len(level):]
            levels.level[k] = Level(i, t, w, tuple(color))


def put_image(p: Param, block: int, pixels: np.ndarray) -> np.ndarray:
    """Writes where the pixels of an image parameter lie. What must be kept as long as the block."""
    pixels = np.ascontiguousarray(pixels, np.float32)
    c.memmove(block + p.offset, c.byref(image(pixels)), c.sizeof(Image))
    return pixels
