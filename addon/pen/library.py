# SPDX-License-Identifier: GPL-3.0-or-later
"""The C library from Python: parameters by introspection, rendering and rasterising of numpy arrays.

Nothing here knows Blender. Errors are EncreError, whose text is one sentence for the user.
"""

import contextlib
import ctypes as c
import functools
import os
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from types import MappingProxyType
from typing import Any

import numpy as np

from . import abi, installed
from .errors import Cancelled, EncreError, unknown
from .job import (
    Baked,
    Camera,
    Chains,
    Colors,
    Frame,
    Materials,
    Mesh,
    Picture,
    Result,
    Work,
    filled,
    filled_bytes,
    whole,
)
from .params import Chosen, Control, Param, Stage, chosen, control, normal, read, stage, text_of

API_VERSION = 25
_ALL = "; `encre params` lists all"


class Library:
    """One loaded libencre. `path` None: the package's own."""

    def __init__(self, path=None):
        path = path or installed.path()
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
        abi.declare(lib)
        self.path, self.lib = path, lib
        self.layers = {text_of(x.name): x.channels for x in _each(lib.encre_layer_info)}
        self.outputs = {text_of(x.name): x.channels for x in _each(lib.encre_output_info)}
        self.output_help = {text_of(x.name): text_of(x.help) for x in _each(lib.encre_output_info)}
        self.controls = {x.name: x for x in map(control, _each(lib.encre_control_info))}
        self.stages = tuple(map(stage, _each(lib.encre_stage_info)))
        self.lines = {text_of(x.id): text_of(x.label) for x in _each(lib.encre_line_info)}
        self.operations = {text_of(x.name): (k, x.inputs, x.outputs)
                           for k, x in enumerate(_each(lib.encre_operation_info))}
        self.params = {p.id: p for s in self.stages for p in s.params}
        self._job = abi.render_job(len(self.layers), len(self.outputs))
        self._resting: list[tuple[tuple[int, int], Any]] = []

    # -- values

    def pack(self, values: Mapping[str, Any],
             images: Mapping[str, np.ndarray] = MappingProxyType({})) -> tuple[c.Array, list]:
        """A parameter block of checked values; images: {id: pixels} of parameters that are images. Returns (bytearray,
        things to keep)."""
        block = (c.c_char * self.lib.encre_params_size())()
        self.lib.encre_params_init(block)
        for id_, value in values.items():
            if value != self.params[id_].default:  # which is there: most values of most frames
                abi.put(self.params[id_], c.addressof(block), value)
        return block, [abi.put_image(self.params[id_], c.addressof(block), pixels) for id_, pixels in images.items()]

    def check(self, values: Mapping[str, Any],
              images: Mapping[str, np.ndarray] = MappingProxyType({})) -> dict[str, Any]:
        """Normalises parameter values; EncreError for an unknown id, a wrong type, a value out of range, and for images
        {id: pixels} that can't be used."""
        out = {}
        for id_, value in values.items():
            if id_ not in self.params:
                raise EncreError(unknown("parameter", id_, self.params, _ALL))
            out[id_] = normal(self.params[id_], value)
        text = c.create_string_buffer(512)
        block, _keep = self.pack(out, images)
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

    def images(self, every: Sequence[Mapping]) -> list[list[Chosen]]:
        """For each style the images that are read when these complete() values draw. EncreError: one should be read,
        and none is given."""
        return chosen(self.stages, every)

    # -- work

    def context(self, threads: int = 0, simd: int = 1) -> Any:
        """A new encre_context, for the caller to destroy. EncreError: it can't be made."""
        context = self.lib.encre_create(API_VERSION)
        if not context:
            raise EncreError("memory: there is none left for rendering; close other programs")
        for setting, number in ((self.lib.encre_set_threads, whole("threads", threads)),
                                (self.lib.encre_set_simd, whole("simd", simd))):
            if setting(context, number):
                sentence = text_of(self.lib.encre_error(context))
                self.lib.encre_destroy(context)
                raise EncreError(sentence)
        return context

    def _rested(self, threads, simd):
        """The context of an earlier call, which has threads, memory and paper already, if it is one as asked. Two
        threads of the caller's never get the same."""
        try:
            kind, context = self._resting.pop()
        except IndexError:
            return self.context(threads, simd)
        if kind == (threads, simd):
            return context
        self.lib.encre_destroy(context)
        return self.context(threads, simd)

    def forget(self) -> None:
        """Frees what calls have kept for the next."""
        with contextlib.suppress(IndexError):  # another thread may take the last one
            while True:
                self.lib.encre_destroy(self._resting.pop()[1])

    def _call(self, function, job, threads, simd, progress):
        failure: list[BaseException] = []

        def forward(_user, fraction):
            try:
                go_on = progress(fraction)
                return go_on is None or bool(go_on)
            except BaseException as e:  # noqa: BLE001 - it must not be lost in C: raised again below
                failure.append(e)
                return False

        job.progress = abi.Progress(forward) if progress else abi.Progress()
        self.call(function, job, threads=threads, simd=simd, failure=failure)

    def run(self, work: Work, threads: int = 0, simd: int = 1, progress: Callable[[float], bool] | None = None) -> Any:
        """Runs a work and returns its result."""
        self._call(getattr(self.lib, f"encre_{work.kind}"), work.job, threads, simd, progress)
        return work.result()

    def call(self, function: Any, *arguments: Any, threads: int = 0, simd: int = 1,
             failure: Sequence[BaseException] = ()) -> None:
        """function(a context that nobody uses, *arguments), structures by reference. EncreError: the library refuses;
        failure: what was raised meanwhile in Python, which goes first."""
        context = self._rested(threads, simd)
        try:
            code = function(context, *(c.byref(a) if isinstance(a, c.Structure) else a for a in arguments))
            sentence = text_of(self.lib.encre_error(context))
        finally:
            self._resting.append(((threads, simd), context))
        if failure:
            raise failure[0]
        if code:
            raise (Cancelled if code == 3 else EncreError)(sentence)

    def render(self, layers: Mapping[str, np.ndarray], scene: Mapping | None = None, styles: Sequence[Mapping] = (),
               camera: Camera | None = None, frame: Frame | None = None, outputs: Sequence[str] = ("Combined",),
               threads: int = 0, simd: int = 1, progress: Callable[[float], bool] | None = None,
               image: Callable[[Chosen], np.ndarray] | None = None, chains: Chains | None = None) -> Result:
        """Runs the stages on layers of shape (H, W, channels) or (H, W), float32, row 0 at the top, any strides.

        scene: values that differ from the defaults; styles[k]: what style number k + 1 changes, of which values of
        frame scope are ignored. image(chosen): the pixels of one of the images() that are read, if any are. chains: the
        lines that the meshes tell of.
        Result.images has an array (H, W, channels) for each of `outputs`.
        """
        every = self.complete(self.check(scene or {}), [self.check(s) for s in styles])
        return self.draw(layers, every, camera, frame, outputs, threads, simd, progress, image, chains=chains)

    def draw(self, layers: Mapping[str, np.ndarray], every: Sequence[Mapping], camera: Camera | None = None,
             frame: Frame | None = None, outputs: Sequence[str] = ("Combined",), threads: int = 0, simd: int = 1,
             progress: Callable[[float], bool] | None = None,
             image: Callable[[Chosen], np.ndarray] | None = None,
             empty: Callable[[tuple[int, ...]], np.ndarray] | None = None, chains: Chains | None = None,
             strokes: bool = False) -> Result:
        """As render(); every[k]: the checked values of style number k, as complete() gives them; empty(shape) makes the
        arrays of what is drawn; strokes: whether its lines are told as strokes, too."""
        work = self.draw_work(layers, every, camera, frame, outputs, image, empty, chains=chains, strokes=strokes)
        return self.run(work, threads, simd, progress)

    def draw_work(self, layers: Mapping[str, np.ndarray], every: Sequence[Mapping], camera: Camera | None = None,
                  frame: Frame | None = None, outputs: Sequence[str] = ("Combined",),
                  image: Callable[[Chosen], np.ndarray] | None = None,
                  empty: Callable[[tuple[int, ...]], np.ndarray] | None = None, same: int = 0,
                  chains: Chains | None = None, strokes: bool = False) -> Work:
        """The Work of draw(). strokes: whether these are told, too.
        same: 0, or a number that other works of these layers, and no others, have too: where
        one context draws several one after the other, it finds their edges once. The lines of meshes may lie among the
        layers, too, as `chains`."""
        job, keep = self._job(same=same, tell_strokes=strokes), list[Any]()
        told: Any = layers.get("chains", chains)
        layers = {name: picture for name, picture in layers.items() if name != "chains"}
        for i, (name, channels) in enumerate(self.layers.items()):
            a = layers.get(name)
            if a is not None:
                a, job.layers[i] = abi.given(name, a, channels)
                keep.append(a)
        for name in sorted(layers.keys() - self.layers.keys()):
            raise EncreError(unknown("layer", name, self.layers))
        if layers.get("combined") is None:
            raise EncreError("combined: this layer is missing and required; render it or name the file that has it")
        height, width = layers["combined"].shape[:2]
        images = {}
        for i, (name, channels) in enumerate(self.outputs.items()):
            if name in outputs:
                shape = height, width, channels
                images[name] = filled(name, empty(shape), shape) if empty else np.empty(shape, np.float32)
                job.outputs[i] = abi.image(images[name])
        for name in sorted(set(outputs) - self.outputs.keys()):
            raise EncreError(unknown("output", name, self.outputs))
        wanted, read = self.images(every), dict[Chosen, np.ndarray]()
        for one in dict.fromkeys(each for style in wanted for each in style):
            if not image:
                raise EncreError(f"{one.id}: {one.name} is to be read, and nothing that can read it is given; "
                                 "pass `image`")
            pixels = np.ascontiguousarray(image(one), np.float32)
            # Tones that look alike flow into each other, and where their images lie is by what the library tells.
            read[one] = next((known for known in read.values() if np.array_equal(known, pixels, True)), pixels)
        blocks = [self.pack(v, {each.id: read[each] for each in style})
                  for v, style in zip(every, wanted, strict=True)]
        block = b"".join(bytes(b) for b, _ in blocks)
        keep += [b for _, b in blocks] + [block]
        job.params = c.cast(c.c_char_p(block), c.c_void_p)
        job.n_styles = len(every)
        camera = camera or Camera()
        job.camera = abi.Camera((c.c_float * 9)(*camera.view), bool(camera.orthographic), camera.height,
                             camera.distance, camera.light, camera.shade)
        frame = frame or Frame(width, height)
        job.frame = abi.frame(frame)
        if told:
            points = np.ascontiguousarray(told.points, abi.CHAIN_POINT)
            chained = np.ascontiguousarray(told.chained, np.uint8)
            job.chains, job.n_chains = points.ctypes.data, points.size
            job.chained, job.n_chained = chained.ctypes.data, chained.size
            keep += [points, chained]
        return Work("render", job, keep, lambda: Result(images, job.nonfinite,
                                                        abi.stroke_points(job) if strokes else None))

    def strokes(self, layers: Mapping[str, np.ndarray], every: Sequence[Mapping], camera: Camera | None = None,
                frame: Frame | None = None, threads: int = 0, progress: Callable[[float], bool] | None = None,
                image: Callable[[Chosen], np.ndarray] | None = None) -> np.ndarray:
        """The strokes of the lines that draw() would draw, as an array of abi.STROKE_POINT: polylines, those that lie
        over others after these. EncreError: as of draw(), and of another edge_detector than FINE."""
        work = self.draw_work(layers, every, camera, frame, (), image, strokes=True)
        return self.run(work, threads, 1, progress).strokes

    def raster(self, meshes: Sequence[Mesh], view: np.ndarray, projection: np.ndarray, frame: Frame,
               size: tuple[int, int], clip_start: float, clip_end: float = 0.0, channels: int = 0,
               outputs: Sequence[str] = abi.RASTER_OUTPUTS, threads: int = 0,
               progress: Callable[[float], bool] | None = None,
               beyond: np.ndarray | None = None) -> dict[str, np.ndarray]:
        """Draws meshes into images of `size` (width, height); view and projection are 4 x 4 (OpenGL conventions).

        Returns float32 arrays (H, W), `normal` (H, W, 3), `attributes` (H, W, channels) and, if asked for,
        `coincident`, `shading` (H, W, 3), `anchor` (H, W, 16), `tangent` (H, W, 3) and `card` (H, W, 4).
        beyond (H, W): only what lies farther than this is drawn; at 1e10 nothing is.
        """
        work = self.raster_work(meshes, view, projection, frame, size, clip_start, clip_end, channels, outputs, beyond)
        return self.run(work, threads, 1, progress)

    def raster_work(self, meshes: Sequence[Mesh], view: np.ndarray, projection: np.ndarray, frame: Frame,
                    size: tuple[int, int], clip_start: float, clip_end: float = 0.0, channels: int = 0,
                    outputs: Sequence[str] = abi.RASTER_OUTPUTS, beyond: np.ndarray | None = None,
                    into: Mapping[str, np.ndarray] = MappingProxyType({})) -> Work:
        """The Work of raster(). into: arrays of zeros that it fills, by output; others are made."""
        job, keep = abi.RasterJob(), []
        array = (abi.Mesh * max(1, len(meshes)))()
        for m, mesh in zip(array, meshes, strict=False):
            keep.append(abi.fill_mesh(m, mesh))
        job.meshes, job.n_meshes, job.n_channels = array, len(meshes), channels
        job.view[:] = np.asarray(view, np.float64).ravel()
        job.projection[:] = np.asarray(projection, np.float64).ravel()
        job.clip_start, job.clip_end = clip_start, clip_end
        job.frame = abi.frame(frame)
        if beyond is not None:
            beyond, job.beyond = abi.given("beyond", beyond, 1)
        width, height = size
        images = {}
        single = dict.fromkeys(("depth", "object", "material", "style", "coincident"), ())
        deep = {**single, "normal": (3,), "attributes": (channels,), "shading": (3,),
                "anchor": (self.layers["anchor"],), "tangent": (3,), "card": (4,)}
        for name in outputs:
            if name not in deep:
                raise EncreError("raster: " + unknown("output", name, deep))
            shape = height, width, *deep[name]
            images[name] = filled(name, into[name], shape) if name in into else np.zeros(shape, np.float32)
            if images[name].size:
                setattr(job, name, abi.image(images[name]))
        return Work("raster", job, [keep, array, beyond], lambda: images)

    def chains(self, meshes: Sequence[Mesh], view: np.ndarray, projection: np.ndarray, frame: Frame,
               size: tuple[int, int], clip_start: float, clip_end: float = 0.0, least_bend: float = 5.0,
               threads: int = 0, simd: int = 1, progress: Callable[[float], bool] | None = None,
               most_before: int = 0, colors: Colors | None = None) -> np.ndarray:
        """The lines that meshes know, as an array of abi.CHAIN_POINT: runs along their edges, as far as they can be
        seen in images of `size` (width, height), and where `colors` part. least_bend: degrees from which on an edge is
        a crease. most_before: also what is hidden by so many meshes at most."""
        work = self.chains_work(meshes, view, projection, frame, size, clip_start, clip_end, least_bend, most_before,
                                colors)
        return self.run(work, threads, simd, progress)

    def chains_work(self, meshes: Sequence[Mesh], view: np.ndarray, projection: np.ndarray, frame: Frame,
                    size: tuple[int, int], clip_start: float, clip_end: float = 0.0, least_bend: float = 5.0,
                    most_before: int = 0, colors: Colors | None = None) -> Work:
        """The Work of chains()."""
        job, keep = abi.ChainJob(least_bend=least_bend, most_before=most_before), list[Any]()
        array = (abi.Mesh * max(1, len(meshes)))()
        for m, mesh in zip(array, meshes, strict=False):
            keep.append(abi.fill_mesh(m, mesh))
        job.meshes, job.n_meshes = array, len(meshes)
        job.view[:] = np.asarray(view, np.float64).ravel()
        job.projection[:] = np.asarray(projection, np.float64).ravel()
        job.clip_start, job.clip_end = clip_start, clip_end
        job.frame, (job.width, job.height) = abi.frame(frame), size
        if colors and len(colors.images):
            keep += abi.fill_colors(job, colors)
            block = b"".join(bytes(self.pack(values, {})[0]) for values in colors.every)
            keep += [block]
            job.params, job.n_styles = c.cast(c.c_char_p(block), c.c_void_p), len(colors.every)
        return Work("chains", job, [keep, array], lambda: abi.chain_points(job))

    def material(self, materials: Materials, maps: Mapping[str, np.ndarray], view: np.ndarray, projection: np.ndarray,
                 frame: Frame, threads: int = 0, simd: int = 1,
                 progress: Callable[[float], bool] | None = None) -> dict[str, np.ndarray]:
        """What surfaces look like without light: `color`, `gloss` and `emission` (H, W, 3), `surface` (H, W, 2), alpha
        and roughness, `shine` (H, W, 6), what makes highlights, `turned` (H, W, 3), normals of normal maps, and
        `holdout` (H, W, 1), how far it is a hole. maps: object, material and depth (H, W), normal (H, W, 3) and perhaps
        attributes (H, W, n), as raster() gives them.
        """
        return self.run(self.material_work(materials, maps, view, projection, frame), threads, simd, progress)

    def material_work(self, materials: Materials, maps: Mapping[str, np.ndarray], view: np.ndarray,
                      projection: np.ndarray, frame: Frame,
                      outputs: Sequence[str] = tuple(abi.MATERIAL_OUTPUTS)) -> Work:
        """The Work of material()."""
        job = abi.MaterialJob()
        block, keep = abi.materials(materials)
        job.materials = c.pointer(block)
        job.view[:] = np.asarray(view, np.float64).ravel()
        job.projection[:] = np.asarray(projection, np.float64).ravel()
        job.frame = abi.frame(frame)
        given = {**abi.MATERIAL_INPUTS, "attributes": maps["attributes"].shape[-1] if "attributes" in maps else 0}
        for name in given.keys() & maps.keys():
            if maps[name].size:
                a, image = abi.given(name, maps[name], given[name])
                setattr(job, name, image)
                keep.append(a)
        images = {}
        for name in outputs:
            images[name] = np.empty((*maps["object"].shape[:2], abi.MATERIAL_OUTPUTS[name]), np.float32)
            setattr(job, name, abi.image(images[name]))
        return Work("material", job, [keep, block], lambda: images)

    def picture_levels(self, picture: Picture) -> None:
        """Fills the levels of detail of a picture of bytes behind its first one, in place."""
        keep: list = []
        given = abi.Picture()
        abi.fill_picture(given, replace(picture, texels=filled_bytes(picture.texels)), keep)
        context = self.context()
        try:
            if self.lib.encre_picture_levels(context, c.byref(given), given.bytes):
                raise EncreError(text_of(self.lib.encre_error(context)))
        finally:
            self.lib.encre_destroy(context)

    def smooth(self, points: np.ndarray, corners: np.ndarray, normals: np.ndarray | None, angle: float) -> np.ndarray:
        """Unit normals (t, 3, 3) at the corners of triangles: of facets as of one smooth surface where they bend by
        less than `angle` degrees. points (n, 3), corners (t, 3); normals (t, 3, 3), None: all are flat."""
        mesh = abi.Mesh()
        keep = abi.fill_mesh(mesh, Mesh(points, corners, normals=normals))
        out = np.empty((len(corners), 3, 3), np.float32)
        self.call(self.lib.encre_smooth, mesh, float(np.radians(angle)), out.ctypes.data)
        del keep
        return out

    def flatten(self, picture: Picture, most: int, threads: int = 0) -> None:
        """Gives a picture flat colors, `most` at most, in place: its first level; the others are to be made anew."""
        keep: list = []
        given = abi.Picture()
        abi.fill_picture(given, picture, keep)
        at = given.bytes or given.texels
        if at != picture.texels.ctypes.data or not picture.texels.flags.writeable:
            raise EncreError("texels: the array can't be filled; give a writeable one in one piece")
        self.call(self.lib.encre_flatten, given, most, at, threads=threads)

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
        job, out = abi.BakeJob(linear=linear, wrap_x=wrap[0], wrap_y=wrap[1]), None
        texture, job.texture = abi.given("texture", texture, texture.shape[2])
        if form is not None:
            form, job.form = abi.given("form", form, 3)
        if draw:
            out = np.empty(texture.shape, np.float32)
            job.output = abi.image(out)
        block, _ = self.pack(self.check(scene or {}))
        job.params = c.addressof(block)
        work = Work("bake", job, [texture, form, block], lambda: Baked(out, job.nonfinite, job.greatest))
        return self.run(work, threads, simd, progress)


def _each(info):
    """What a function of encre.h tells about 0, 1 and so on, until it knows no more."""
    i = 0
    while p := info(i):
        yield p.contents
        i += 1


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
        raise EncreError(unknown("parameter", id_, params(), _ALL))
    return normal(params()[id_], read(params()[id_], text))


def check(values: Mapping[str, Any], images: Mapping[str, np.ndarray] = MappingProxyType({})) -> dict[str, Any]:
    return load().check(values, images)


def images(every: Sequence[Mapping]) -> list[list[Chosen]]:
    return load().images(every)


def render(*args: Any, **kwargs: Any) -> Result:
    return load().render(*args, **kwargs)


def draw(*args: Any, **kwargs: Any) -> Result:
    return load().draw(*args, **kwargs)


def strokes(*args: Any, **kwargs: Any) -> np.ndarray:
    return load().strokes(*args, **kwargs)


def raster(*args: Any, **kwargs: Any) -> dict[str, np.ndarray]:
    return load().raster(*args, **kwargs)


def chains(*args: Any, **kwargs: Any) -> np.ndarray:
    return load().chains(*args, **kwargs)


def bake(*args: Any, **kwargs: Any) -> Baked:
    return load().bake(*args, **kwargs)


def __getattr__(name):
    if name == "LAYERS":
        return load().layers
    if name == "OUTPUTS":
        return load().outputs
    raise AttributeError(name)
