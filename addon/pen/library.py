# SPDX-License-Identifier: GPL-3.0-or-later
"""The C library from Python: parameters by introspection, rendering and rasterising of numpy arrays.

Nothing here knows Blender. Errors are EncreError, whose text is one sentence for the user.
"""

import ctypes as c
import functools
import glob
import os
import sys
from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np

from .errors import Cancelled, EncreError, unknown
from .job import EVERY_SET, LAMPS, Baked, Camera, Frame, Lamp, Mesh, Result, entries, picture
from .params import MAX_LEVELS, Control, Param, Stage, control, normal, read, stage, text_of

API_VERSION = 7
LIBRARY = {"darwin": "libencre.dylib", "win32": "libencre.dll"}.get(sys.platform, "libencre.so")


# ---- csrc/encre.h ----------------------------------------------------------------------------------------------


class _Image(c.Structure):
    _fields_ = [("data", c.c_void_p), ("width", c.c_int32), ("height", c.c_int32), ("channels", c.c_int32),
                ("reserved", c.c_int32), ("pixel_stride", c.c_int64), ("row_stride", c.c_int64)]


class _LayerInfo(c.Structure):
    _fields_ = [("name", c.c_char_p), ("help", c.c_char_p), ("channels", c.c_int32), ("required", c.c_int32)]


class _ControlInfo(c.Structure):
    _fields_ = [("name", c.c_char_p), ("label", c.c_char_p), ("white", c.c_char_p), ("black", c.c_char_p),
                ("saved", c.c_char_p), ("channel", c.c_int32), ("reserved", c.c_int32)]


class _Level(c.Structure):
    _fields_ = [("intensity", c.c_float), ("threshold", c.c_float), ("transition", c.c_float), ("color", c.c_float * 3)]


class _Levels(c.Structure):
    _fields_ = [("count", c.c_int32), ("level", _Level * MAX_LEVELS)]


class _Item(c.Structure):
    _fields_ = [("id", c.c_char_p), ("label", c.c_char_p), ("help", c.c_char_p), ("number", c.c_int64)]


class _ParamInfo(c.Structure):
    _fields_ = [("id", c.c_char_p), ("label", c.c_char_p), ("help", c.c_char_p), ("unit", c.c_char_p),
                ("enabled_if", c.c_char_p), ("items", c.POINTER(_Item)), ("n_items", c.c_int32), ("type", c.c_int32),
                ("scope", c.c_int32), ("offset", c.c_int32), ("value", c.c_double * 3), ("hard_min", c.c_double),
                ("hard_max", c.c_double), ("soft_min", c.c_double), ("soft_max", c.c_double),
                ("levels", c.POINTER(_Levels)), ("is_switch", c.c_int32), ("reserved", c.c_int32)]


class _StageInfo(c.Structure):
    _fields_ = [("id", c.c_char_p), ("label", c.c_char_p), ("help", c.c_char_p), ("params", c.POINTER(_ParamInfo)),
                ("n_params", c.c_int32), ("reserved", c.c_int32)]


class _Camera(c.Structure):
    _fields_ = [("view", c.c_float * 9), ("orthographic", c.c_int32), ("height", c.c_float), ("distance", c.c_float)]


class _Frame(c.Structure):
    _fields_ = [("width", c.c_int32), ("height", c.c_int32), ("x", c.c_int32), ("y", c.c_int32)]


_Progress = c.CFUNCTYPE(c.c_bool, c.c_void_p, c.c_double)


class _Mesh(c.Structure):
    _fields_ = [("kind", c.c_int32), ("n_primitives", c.c_int32), ("n_points", c.c_int32), ("n_channels", c.c_int32),
                ("points", c.c_void_p), ("corners", c.c_void_p), ("attributes", c.c_void_p),
                ("material", c.c_void_p), ("style", c.c_void_p), ("model", c.c_double * 16),
                ("object_index", c.c_int32), ("material_index", c.c_int32), ("style_index", c.c_int32),
                ("reserved", c.c_int32), ("object", c.c_void_p), ("edges", c.c_void_p), ("crease_offset", c.c_float),
                ("reserved2", c.c_int32)]


_KINDS = {"triangles": 3, "lines": 2}  # corners of a primitive, in the order of enum encre_primitive
_RASTER_OUTPUTS = ("depth", "normal", "object", "material", "style", "attributes")


class _RasterJob(c.Structure):
    _fields_ = [("meshes", c.POINTER(_Mesh)), ("n_meshes", c.c_int32), ("n_channels", c.c_int32),
                ("view", c.c_double * 16), ("projection", c.c_double * 16), ("clip_start", c.c_double),
                ("clip_end", c.c_double), ("frame", _Frame), *((n, _Image) for n in _RASTER_OUTPUTS),
                ("progress", _Progress), ("user", c.c_void_p), ("marks", _Image),
                ("creases", _Image), ("coincident", _Image)]


class _BakeJob(c.Structure):
    _fields_ = [("texture", _Image), ("form", _Image), ("output", _Image), ("params", c.c_void_p),
                ("linear", c.c_int32), ("wrap_x", c.c_int32), ("wrap_y", c.c_int32), ("reserved", c.c_int32),
                ("progress", _Progress), ("user", c.c_void_p), ("nonfinite", c.c_int64), ("greatest", c.c_double)]


def _path():
    """The library in the package's folder; in an extension, what the wheel that came with it put where Python looks for
    modules, under the name of its build."""
    package = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))
    wheels = glob.glob(os.path.join(glob.escape(package), "wheels", "encre_library-*.whl"))
    if not wheels:
        return os.path.join(package, LIBRARY)
    stem, ending = os.path.splitext(LIBRARY)
    name = f"{stem}-{os.path.basename(wheels[0]).split('-')[1]}{ending}"
    places = [os.path.join(folder, name) for folder in sys.path]
    return next(filter(os.path.exists, places), os.path.join(package, name))


class _Geometry(c.Structure):
    _fields_ = [("n_points", c.c_int32), ("n_triangles", c.c_int32), ("points", c.c_void_p), ("corners", c.c_void_p),
                ("normals", c.c_void_p)]


class _Instance(c.Structure):
    _fields_ = [("geometry", c.c_int64), ("model", c.c_double * 16), ("light_sets", c.c_uint64),
                ("shadow_sets", c.c_uint64), ("camera", c.c_int32), ("reserved", c.c_int32)]


class _Lamp(c.Structure):
    _fields_ = [("type", c.c_int32), ("shadows", c.c_int32), ("light_set", c.c_int32), ("shadow_set", c.c_int32),
                ("color", c.c_float * 3), ("width", c.c_float), ("height", c.c_float), ("spot_angle", c.c_float),
                ("spot_blend", c.c_float), ("spread", c.c_float), ("flat", c.c_int32), ("reserved", c.c_int32),
                ("model", c.c_double * 16)]


class _LightJob(c.Structure):
    _fields_ = [("scene", c.c_void_p), ("view", c.c_double * 16), ("projection", c.c_double * 16),
                ("clip_start", c.c_double), ("clip_end", c.c_double), ("frame", _Frame), ("depth", _Image),
                ("normal", _Image), ("diffuse", _Image), ("world", c.c_float * 27), ("reserved", c.c_int32),
                ("progress", _Progress), ("user", c.c_void_p)]


class Library:
    """One loaded libencre. `path` None: the package's own."""

    def __init__(self, path=None):
        path = path or _path()
        if not os.path.exists(path):
            raise EncreError(f"{path}: the Encre library is missing; install Encre again for this platform")
        try:
            lib = c.CDLL(path)
            lib.encre_create.restype, lib.encre_error.restype = c.c_void_p, c.c_char_p
            lib.encre_create.argtypes = [c.c_int32]
        except (OSError, AttributeError) as e:
            raise EncreError(f"{path}: the Encre library can't be loaded ({e}); install Encre again") from None
        lib.encre_error.argtypes = [c.c_void_p]
        lib.encre_destroy.argtypes = [c.c_void_p]
        lib.encre_destroy.restype = None
        context = lib.encre_create(API_VERSION)
        if not context:
            raise EncreError(f"{path}: the Encre library has another version than its Python code; "
                             "install both from one package")
        lib.encre_destroy(context)
        lib.encre_stage_info.restype = c.POINTER(_StageInfo)
        lib.encre_layer_info.restype = lib.encre_output_info.restype = c.POINTER(_LayerInfo)
        lib.encre_control_info.restype = c.POINTER(_ControlInfo)
        lib.encre_params_size.restype = c.c_int64
        lib.encre_params_check.restype = c.c_char_p
        lib.encre_params_check.argtypes = [c.c_void_p, c.c_char_p, c.c_int64]
        lib.encre_params_init.argtypes = [c.c_void_p]
        for name in ("encre_set_threads", "encre_set_simd"):
            getattr(lib, name).argtypes = [c.c_void_p, c.c_int32]
        lib.encre_scene_create.restype = c.c_void_p
        lib.encre_scene_free.argtypes, lib.encre_scene_free.restype = [c.c_void_p], None
        for name in ("encre_scene_geometry", "encre_scene_instance", "encre_scene_lamp"):
            getattr(lib, name).argtypes = [c.c_void_p, c.c_void_p, c.c_int64, c.c_void_p]
        for name in ("encre_render", "encre_raster", "encre_bake", "encre_light"):
            getattr(lib, name).argtypes = [c.c_void_p, c.c_void_p]
        self.path, self.lib = path, lib
        self.layers = {text_of(x.name): x.channels for x in _each(lib.encre_layer_info)}
        self.outputs = {text_of(x.name): x.channels for x in _each(lib.encre_output_info)}
        self.output_help = {text_of(x.name): text_of(x.help) for x in _each(lib.encre_output_info)}
        self.controls = {x.name: x for x in map(control, _each(lib.encre_control_info))}
        self.stages = tuple(map(stage, _each(lib.encre_stage_info)))
        self.params = {p.id: p for s in self.stages for p in s.params}

        class Job(c.Structure):
            _fields_ = [("layers", _Image * len(self.layers)), ("outputs", _Image * len(self.outputs)),
                        ("camera", _Camera), ("frame", _Frame), ("params", c.c_void_p), ("n_styles", c.c_int32),
                        ("reserved", c.c_int32), ("progress", _Progress), ("user", c.c_void_p),
                        ("nonfinite", c.c_int64)]

        self._job = Job

    # -- values

    def pack(self, values: Mapping[str, Any], image: Callable[[str], np.ndarray] | None = None) -> tuple[c.Array, list]:
        """A parameter block of checked values; `image` loads paper images. Returns (bytearray, things to keep)."""
        block = (c.c_char * self.lib.encre_params_size())()
        self.lib.encre_params_init(block)
        keep = []
        for id_, value in values.items():
            p = self.params[id_]
            at = c.addressof(block) + p.offset
            if p.type in ("bool", "int"):
                c.c_int32.from_address(at).value = int(value)
            elif p.type == "enum":
                c.c_int32.from_address(at).value = p.number[value]
            elif p.type == "float":
                c.c_float.from_address(at).value = value
            elif p.type == "color":
                (c.c_float * 3).from_address(at)[:] = value
            elif p.type == "levels":
                levels = _Levels.from_address(at)
                levels.count = len(value)
                for k, level in enumerate(value):
                    i, t, w, *color = tuple(level) + (0, 0, 0, 1, 1, 1)[len(level):]
                    levels.level[k] = _Level(i, t, w, tuple(color))
            elif value is not None and image:
                a = np.ascontiguousarray(image(value), np.float32)
                keep.append(a)
                _Image.from_buffer((c.c_char * c.sizeof(_Image)).from_address(at))
                c.memmove(at, c.byref(_image(a)), c.sizeof(_Image))
        return block, keep

    def check(self, values: Mapping[str, Any], image: Callable[[str], np.ndarray] | None = None) -> dict[str, Any]:
        """Normalises parameter values; EncreError for an unknown id, a wrong type, a value out of range, and with
        `image`, which loads it, for a paper image that can't be used."""
        out = {}
        for id_, value in values.items():
            if id_ not in self.params:
                raise EncreError(unknown("parameter", id_, self.params))
            out[id_] = normal(self.params[id_], value)
        text = c.create_string_buffer(512)
        block, _keep = self.pack(out, image)
        sentence = self.lib.encre_params_check(block, text, len(text))
        if sentence:
            raise EncreError(text_of(sentence))
        return out

    def complete(self, scene: Mapping[str, Any], styles: Sequence[Mapping[str, Any]] = ()) -> list[dict[str, Any]]:
        """The values of every style, number 0, the scene's, first, from checked ones; of what a style changes those of
        frame scope are ignored."""
        base = {**{p.id: p.default for p in self.params.values()}, **scene}
        return [base] + [{**base, **{id_: value for id_, value in changed.items()
                                     if self.params[id_].scope == "surface"}} for changed in styles]

    def paper(self, every: Sequence[Mapping]) -> str | None:
        """The image from which the paper's heights come when these complete() values draw; None: nothing reads one.
        EncreError: there should be one."""
        drawn = any((values["use_lines"] and values["line_paper"] > 0)
                    or (values["use_hatching"] and values["hatch_amount"] > 0) for values in every)
        if not drawn or every[0]["paper_source"] != "IMAGE":
            return None
        if not every[0]["paper_image"]:
            raise EncreError("paper_image: the paper's source is an image but none is given; choose an image")
        return every[0]["paper_image"]

    # -- work

    def _context(self, threads, simd):
        context = self.lib.encre_create(API_VERSION)
        if not context:
            raise EncreError("memory: there is none left for rendering; close other programs")
        for setting, number in ((self.lib.encre_set_threads, threads), (self.lib.encre_set_simd, simd)):
            if setting(context, number):
                sentence = text_of(self.lib.encre_error(context))
                self.lib.encre_destroy(context)
                raise EncreError(sentence)
        return context

    def _call(self, function, job, threads, simd, progress):
        failure = []

        def forward(_user, fraction):
            try:
                return progress(fraction) is not False
            except BaseException as e:  # noqa: BLE001 - it must not be lost in C: raised again below
                failure.append(e)
                return False

        job.progress = _Progress(forward) if progress else _Progress()
        context = self._context(threads, simd)
        try:
            code = function(context, c.byref(job))
            sentence = text_of(self.lib.encre_error(context))
        finally:
            self.lib.encre_destroy(context)
        if failure:
            raise failure[0]
        if code:
            raise (Cancelled if code == 3 else EncreError)(sentence)

    def render(self, layers: Mapping[str, np.ndarray], scene: Mapping | None = None, styles: Sequence[Mapping] = (),
               camera: Camera | None = None, frame: Frame | None = None, outputs: Sequence[str] = ("Combined",),
               threads: int = 0, simd: int = 1, progress: Callable[[float], bool] | None = None,
               image: Callable[[str], np.ndarray] | None = None) -> Result:
        """Runs the stages on layers of shape (H, W, channels) or (H, W), float32, row 0 at the top, any strides.

        scene: values that differ from the defaults; styles[k]: what style number k + 1 changes, of which values of
        frame scope are ignored. image(name): the pixels of the paper() that is read, if one is. Result.images has an
        array (H, W, channels) for each of `outputs`.
        """
        every = self.complete(self.check(scene or {}), [self.check(s) for s in styles])
        return self.draw(layers, every, camera, frame, outputs, threads, simd, progress, image)

    def draw(self, layers: Mapping[str, np.ndarray], every: Sequence[Mapping], camera: Camera | None = None,
             frame: Frame | None = None, outputs: Sequence[str] = ("Combined",), threads: int = 0, simd: int = 1,
             progress: Callable[[float], bool] | None = None,
             image: Callable[[str], np.ndarray] | None = None,
             empty: Callable[[tuple[int, ...]], np.ndarray] | None = None) -> Result:
        """As render(); every[k]: the checked values of style number k, as complete() gives them; empty(shape) makes the
        arrays of what is drawn."""
        job, keep = self._job(), []
        for i, (name, channels) in enumerate(self.layers.items()):
            a = layers.get(name)
            if a is not None:
                a, job.layers[i] = _input(name, a, channels)
                keep.append(a)
        for name in layers:
            if name not in self.layers:
                raise EncreError(unknown("layer", name, self.layers))
        if layers.get("combined") is None:
            raise EncreError("combined: this layer is missing and required; render it or name the file that has it")
        height, width = layers["combined"].shape[:2]
        images = {}
        for i, (name, channels) in enumerate(self.outputs.items()):
            if name in outputs:
                shape = height, width, channels
                images[name] = empty(shape) if empty else np.empty(shape, np.float32)
                job.outputs[i] = _image(images[name])
        for name in outputs:
            if name not in self.outputs:
                raise EncreError(unknown("output", name, self.outputs))
        paper = self.paper(every)
        if paper and not image:
            raise EncreError(f"paper_image: {paper} is to be read, and nothing that can read it is given; pass `image`")
        blocks = [self.pack(v, image if paper and k == 0 else None) for k, v in enumerate(every)]
        block = b"".join(bytes(b) for b, _ in blocks)
        keep += [b for _, b in blocks] + [block]
        job.params = c.cast(c.c_char_p(block), c.c_void_p)
        job.n_styles = len(every)
        camera = camera or Camera()
        job.camera = _Camera((c.c_float * 9)(*camera.view), bool(camera.orthographic), camera.height,
                             camera.distance)
        frame = frame or Frame(width, height)
        job.frame = _Frame(frame.width, frame.height, frame.x, frame.y)
        self._call(self.lib.encre_render, job, threads, simd, progress)
        return Result(images, job.nonfinite)

    def raster(self, meshes: Sequence[Mesh], view: np.ndarray, projection: np.ndarray, frame: Frame,
               size: tuple[int, int], clip_start: float, clip_end: float = 0.0, channels: int = 0,
               outputs: Sequence[str] = _RASTER_OUTPUTS, threads: int = 0,
               progress: Callable[[float], bool] | None = None) -> dict[str, np.ndarray]:
        """Draws meshes into images of `size` (width, height); view and projection are 4 x 4 (OpenGL conventions).

        Returns float32 arrays (H, W), `normal` (H, W, 3), `attributes` (H, W, channels) and, if asked for, `marks`
        (H, W, 2), `creases` (H, W, 4) and `coincident`.
        """
        job, keep = _RasterJob(), []
        array = (_Mesh * max(1, len(meshes)))()
        for m, mesh in zip(array, meshes, strict=False):
            keep.append(_pack_mesh(m, mesh))
        job.meshes, job.n_meshes, job.n_channels = array, len(meshes), channels
        job.view[:] = np.asarray(view, np.float64).ravel()
        job.projection[:] = np.asarray(projection, np.float64).ravel()
        job.clip_start, job.clip_end = clip_start, clip_end
        job.frame = _Frame(frame.width, frame.height, frame.x, frame.y)
        width, height = size
        images = {}
        for name in outputs:
            depth = {"normal": (3,), "attributes": (channels,), "marks": (2,), "creases": (4,)}.get(name, ())
            shape = height, width, *depth
            images[name] = np.zeros(shape, np.float32)
            if images[name].size:
                setattr(job, name, _image(images[name]))
        self._call(self.lib.encre_raster, job, threads, 1, progress)
        return images

    def bake(self, texture: np.ndarray, scene: Mapping | None = None, form: np.ndarray | None = None,
             linear: bool = False, wrap: tuple[bool, bool] = (True, True), draw: bool = True, threads: int = 0,
             simd: int = 1, progress: Callable[[float], bool] | None = None) -> Baked:
        """Draws inter-color lines into a texture of shape (H, W, 3 or 4), row 0 at the top, any strides.

        linear: whether its values are, or sRGB-encoded; wrap: whether it tiles sideways, up and down; form (H, W, 3):
        E, F, G of E x^2 + 2 F x y + G y^2, the squared length on the surface of a step of x texels to the right and
        y down. Without `draw` it only measures.
        """
        texture = np.asarray(texture)
        if texture.ndim != 3 or texture.shape[2] not in (3, 4):
            raise EncreError(f"texture: the array has shape {texture.shape}; give (height, width, 3 or 4)")
        job, out = _BakeJob(linear=linear, wrap_x=wrap[0], wrap_y=wrap[1]), None
        texture, job.texture = _input("texture", texture, texture.shape[2])
        if form is not None:
            form, job.form = _input("form", form, 3)
        if draw:
            out = np.empty(texture.shape, np.float32)
            job.output = _image(out)
        block, _ = self.pack(self.check(scene or {}))
        job.params = c.addressof(block)
        self._call(self.lib.encre_bake, job, threads, simd, progress)
        return Baked(out, job.nonfinite, job.greatest)


class Scene:
    """What light falls on and what throws shadows, by integer keys (of geometry, instances and lamps, each their own):
    given again a key replaces what was there, None removes it."""

    def __init__(self, library: Library | None = None) -> None:
        self._library = library or load()
        self._handle = self._library.lib.encre_scene_create()
        if not self._handle:
            raise EncreError("memory: there is none left for a scene; close other programs")

    def __del__(self) -> None:
        if getattr(self, "_handle", None):
            self._library.lib.encre_scene_free(self._handle)

    def _set(self, function, key, value):
        context = self._library._context(0, 1)
        try:
            code = function(context, self._handle, key, value if value is None else c.byref(value))
            sentence = text_of(self._library.lib.encre_error(context))
        finally:
            self._library.lib.encre_destroy(context)
        if code:
            raise EncreError(sentence)

    def geometry(self, key: int, points: np.ndarray | None, corners: np.ndarray | None = None,
                 normals: np.ndarray | None = None) -> None:
        """points (n, 3) in object space, corners (t, 3), and, where it is smooth, unit normals (t, 3, 3)."""
        function = self._library.lib.encre_scene_geometry
        if points is None:
            return self._set(function, key, None)
        points = np.ascontiguousarray(points, np.float32).reshape(-1, 3)
        corners = np.ascontiguousarray(corners, np.int32).reshape(-1, 3)
        if normals is not None:
            normals = entries("normals", normals, np.float32, (len(corners), 3, 3))
        return self._set(function, key, _Geometry(len(points), len(corners), points.ctypes.data, corners.ctypes.data,
                                                  None if normals is None else normals.ctypes.data))

    def instance(self, key: int, geometry: int | None, model: np.ndarray | None = None, camera: bool = True,
                 light_sets: int = EVERY_SET, shadow_sets: int = EVERY_SET) -> None:
        """Places a geometry by a matrix (4, 4); camera: whether it is seen, or only throws shadows. Bits of the sets:
        which lamps light it, and in the light of which it throws shadows."""
        function = self._library.lib.encre_scene_instance
        if geometry is None:
            return self._set(function, key, None)
        value = _Instance(geometry, light_sets=light_sets, shadow_sets=shadow_sets, camera=camera)
        value.model[:] = np.eye(4).ravel() if model is None else np.asarray(model, np.float64).ravel()
        return self._set(function, key, value)

    def lamp(self, key: int, lamp: Lamp | None) -> None:
        function = self._library.lib.encre_scene_lamp
        if lamp is None:
            return self._set(function, key, None)
        value = _Lamp(LAMPS.index(lamp.kind), lamp.shadows, lamp.light_set, lamp.shadow_set, tuple(lamp.color),
                      lamp.width, lamp.height, lamp.spot_angle, lamp.spot_blend, lamp.spread, lamp.flat)
        value.model[:] = np.asarray(lamp.model, np.float64).ravel()
        return self._set(function, key, value)

    def light(self, depth: np.ndarray, normal: np.ndarray | None, view: np.ndarray, projection: np.ndarray,
              frame: Frame, clip_start: float, clip_end: float = 0.0, world: np.ndarray | None = None,
              threads: int = 0, simd: int = 1, progress: Callable[[float], bool] | None = None) -> np.ndarray:
        """The layer `diffuse` (H, W, 3) of direct light, from the layers depth (H, W) and normal (H, W, 3).

        view, projection: 4 x 4, as raster() takes them; world: (9, 3), colours by the functions of the normal that
        encre_light_job names.
        """
        job = _LightJob(scene=self._handle, clip_start=clip_start, clip_end=clip_end)
        job.view[:] = np.asarray(view, np.float64).ravel()
        job.projection[:] = np.asarray(projection, np.float64).ravel()
        job.frame = _Frame(frame.width, frame.height, frame.x, frame.y)
        depth, job.depth = _input("depth", depth, 1)
        if normal is not None:
            normal, job.normal = _input("normal", normal, 3)
        diffuse = np.empty((*depth.shape[:2], 3), np.float32)
        job.diffuse = _image(diffuse)
        if world is not None:
            job.world[:] = np.asarray(world, np.float32).ravel()
        self._library._call(self._library.lib.encre_light, job, threads, simd, progress)
        return diffuse


def _each(info):
    """What a function of encre.h tells about 0, 1 and so on, until it knows no more."""
    i = 0
    while p := info(i):
        yield p.contents
        i += 1


def _image(a):
    """encre_image of an array (H, W) or (H, W, C) whose channels are adjacent."""
    channels = a.shape[2] if a.ndim == 3 else 1
    return _Image(a.ctypes.data, a.shape[1], a.shape[0], channels, 0, a.strides[1], a.strides[0])


def _input(name, a, channels):
    a = picture(name, a, channels)
    return a, _image(a)


def _pack_mesh(m, mesh):
    points = np.ascontiguousarray(mesh.points, np.float32).reshape(-1, 3)
    keep = [points]

    def pointer(what, a, dtype, shape):
        if a is None:
            return None
        keep.append(entries(what, a, dtype, shape))
        return keep[-1].ctypes.data

    each = _KINDS[mesh.kind]
    m.kind = list(_KINDS).index(mesh.kind)
    m.n_points = len(points)
    m.n_primitives = len(points) // each if mesh.corners is None else len(mesh.corners)
    m.n_channels = 0 if mesh.attributes is None else mesh.attributes.shape[-1]
    m.points = points.ctypes.data
    count = m.n_primitives
    m.corners = pointer("corners", mesh.corners, np.int32, (count, each))
    m.attributes = pointer("attributes", mesh.attributes, np.float32, (count, 3))
    m.material = pointer("material", mesh.material, np.int32, (count,))
    m.style = pointer("style", mesh.style, np.int32, (count,))
    m.object = pointer("object", mesh.object, np.int32, (count,))
    m.edges = pointer("edges", mesh.edges, np.uint8, (count,))
    m.crease_offset = mesh.crease_offset
    m.model[:] = np.asarray(mesh.model, np.float64).ravel()
    m.object_index, m.material_index, m.style_index = mesh.object_index, mesh.material_index, mesh.style_index
    return keep


@functools.cache
def load() -> Library:
    """The package's own library, loaded once."""
    return Library()


def stages() -> tuple[Stage, ...]:
    return load().stages


def params() -> dict[str, Param]:
    return load().params


def controls() -> dict[str, Control]:
    """By name, in the order of the channels of the layer `controls`."""
    return load().controls


def defaults() -> dict[str, Any]:
    return complete({})[0]


def complete(scene: Mapping[str, Any], styles: Sequence[Mapping[str, Any]] = ()) -> list[dict[str, Any]]:
    return load().complete(scene, styles)


def parse(id_: str, text: str) -> Any:
    """A value from the command line's text, good by itself. EncreError: unknown id, or it can't be read."""
    if id_ not in params():
        raise EncreError(unknown("parameter", id_, params()))
    return normal(params()[id_], read(params()[id_], text))


def check(values: Mapping[str, Any], image: Callable[[str], np.ndarray] | None = None) -> dict[str, Any]:
    return load().check(values, image)


def paper(every: Sequence[Mapping]) -> str | None:
    return load().paper(every)


def render(*args: Any, **kwargs: Any) -> Result:
    return load().render(*args, **kwargs)


def draw(*args: Any, **kwargs: Any) -> Result:
    return load().draw(*args, **kwargs)


def raster(*args: Any, **kwargs: Any) -> dict[str, np.ndarray]:
    return load().raster(*args, **kwargs)


def bake(*args: Any, **kwargs: Any) -> Baked:
    return load().bake(*args, **kwargs)


def __getattr__(name):
    if name == "LAYERS":
        return load().layers
    if name == "OUTPUTS":
        return load().outputs
    raise AttributeError(name)
