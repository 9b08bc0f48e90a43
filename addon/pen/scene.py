# SPDX-License-Identifier: GPL-3.0-or-later
"""What light falls on, as the library keeps it, and the light that it draws (csrc/light)."""

from collections.abc import Callable, Sequence

import numpy as np

from . import abi
from .errors import EncreError
from .job import EVERY_SET, LAMPS, Bend, Frame, Lamp, Work, entries, filled
from .library import Library, load

EXTENSIONS = ("REPEAT", "EXTEND", "CLIP")


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
        self._library.call(function, self._handle, key, value)

    def geometry(self, key: int, points: np.ndarray | None, corners: np.ndarray | None = None,
                 normals: np.ndarray | None = None, uvs: np.ndarray | None = None,
                 textures: np.ndarray | None = None) -> None:
        """points (n, 3) in object space, corners (t, 3); where it is smooth, unit normals (t, 3, 3); where it has
        holes, uvs (t, 3, 2) and keys of textures (t,), negative: none."""
        function = self._library.lib.encre_scene_geometry
        if points is None:
            return self._set(function, key, None)
        points = np.ascontiguousarray(points, np.float32).reshape(-1, 3)
        corners = np.ascontiguousarray(corners, np.int32).reshape(-1, 3)
        if normals is not None:
            normals = entries("normals", normals, np.float32, (len(corners), 3, 3))
        if uvs is not None and textures is not None:
            uvs = entries("uvs", uvs, np.float32, (len(corners), 3, 2))
            textures = entries("textures", textures, np.int32, (len(corners),))
        value = abi.Geometry(len(points), len(corners), points.ctypes.data, corners.ctypes.data)
        for name, array in (("normals", normals), ("uvs", uvs), ("textures", textures)):
            setattr(value, name, None if array is None else array.ctypes.data)
        return self._set(function, key, value)

    def texture(self, key: int, alpha: np.ndarray | None, extension: str = "REPEAT", closest: bool = False) -> None:
        """Where surfaces are solid: alpha (H, W) of bytes, the row of v = 0 first, solid from 128 on; extension: what
        lies beyond 0..1, one of EXTENSIONS."""
        function = self._library.lib.encre_scene_texture
        if alpha is None:
            return self._set(function, key, None)
        alpha = np.ascontiguousarray(alpha, np.uint8)
        height, width = alpha.shape
        return self._set(function, key, abi.Texture(width, height, EXTENSIONS.index(extension), closest,
                                                    alpha.ctypes.data))

    def instance(self, key: int, geometry: int | None, model: np.ndarray | None = None, camera: bool = True,
                 light_sets: int = EVERY_SET, shadow_sets: int = EVERY_SET) -> None:
        """Places a geometry by a matrix (4, 4); camera: whether it is seen, or only throws shadows. Bits of the sets:
        which lamps light it, and in the light of which it throws shadows."""
        function = self._library.lib.encre_scene_instance
        if geometry is None:
            return self._set(function, key, None)
        value = abi.Instance(geometry, light_sets=light_sets, shadow_sets=shadow_sets, camera=camera)
        value.model[:] = np.eye(4).ravel() if model is None else np.asarray(model, np.float64).ravel()
        return self._set(function, key, value)

    def lamp(self, key: int, lamp: Lamp | None) -> None:
        function = self._library.lib.encre_scene_lamp
        if lamp is None:
            return self._set(function, key, None)
        value = abi.Lamp(LAMPS.index(lamp.kind), lamp.shadows, lamp.light_set, lamp.shadow_set, tuple(lamp.color),
                      lamp.width, lamp.height, lamp.spot_angle, lamp.spot_blend, lamp.spread, lamp.flat, lamp.matt)
        value.model[:] = np.asarray(lamp.model, np.float64).ravel()
        return self._set(function, key, value)

    def reached(self, places: np.ndarray, ways: np.ndarray, shadow_set: int = 0) -> np.ndarray:
        """(n,) of bool: whether nothing throws a shadow on the whole of ways (n, 3) that begin at places (n, 3), in the
        light of a lamp with this shadow_set."""
        places, ways = (np.ascontiguousarray(a, np.float32).reshape(-1, 3) for a in (places, ways))
        if len(places) != len(ways):
            raise EncreError(f"reach: {len(places)} places, but {len(ways)} ways; give as many")
        out = np.zeros(len(places), bool)
        self._library.call(self._library.lib.encre_scene_reach, self._handle, len(places), places.ctypes.data,
                           ways.ctypes.data, shadow_set, out.ctypes.data)
        return out

    def light(self, depth: np.ndarray, normal: np.ndarray | None, view: np.ndarray, projection: np.ndarray,
              frame: Frame, clip_start: float, clip_end: float = 0.0, world: np.ndarray | None = None,
              threads: int = 0, simd: int = 1, progress: Callable[[float], bool] | None = None,
              bends: Sequence[Bend] = (), sharp: bool = False, rims: bool = False,
              unshadowed: bool = False) -> np.ndarray:
        """The layer `diffuse` (H, W, 3) of direct light, from the layers depth (H, W) and normal (H, W, 3).

        view, projection: 4 x 4, as raster() takes them; world: (9, 3), colours by the functions of the normal that
        encre_light_job names; sharp: whether shadows are those of lamps without a size, which takes a half to a third
        of the time; rims: whether no pixel beside another thing is to be brighter, or darker, than all of its own about
        it; unshadowed: whether nothing is in the light's way.
        """
        work = self.light_work(depth, normal, view, projection, frame, clip_start, clip_end, world, bends, sharp,
                               rims=rims, unshadowed=unshadowed)
        return self._library.run(work, threads, simd, progress)

    def light_work(self, depth: np.ndarray, normal: np.ndarray | None, view: np.ndarray, projection: np.ndarray,
                   frame: Frame, clip_start: float, clip_end: float = 0.0, world: np.ndarray | None = None,
                   bends: Sequence[Bend] = (), sharp: bool = False, shine: np.ndarray | None = None,
                   specular: np.ndarray | None = None, turned: np.ndarray | None = None, rims: bool = False,
                   unshadowed: bool = False) -> Work:
        """The Work of light(). The scene must stay as it is until it has ended. shine (H, W, 6): as material() draws
        it; specular (H, W, 3): filled with the highlights that the lamps make on that; turned (H, W, 3): as
        material() draws them, normals by which light falls, where they are not 0; unshadowed: whether nothing is in
        its way."""
        job = abi.LightJob(scene=self._handle, clip_start=clip_start, clip_end=clip_end, sharp=sharp, rims=rims,
                           unshadowed=unshadowed)
        job.view[:] = np.asarray(view, np.float64).ravel()
        job.projection[:] = np.asarray(projection, np.float64).ravel()
        job.frame = abi.frame(frame)
        depth, job.depth = abi.given("depth", depth, 1)
        if normal is not None:
            normal, job.normal = abi.given("normal", normal, 3)
        if shine is not None and specular is not None:
            shine, job.shine = abi.given("shine", shine, 6)
            job.specular = abi.image(filled("specular", specular, (*depth.shape[:2], 3)))
        if turned is not None:
            turned, job.turned = abi.given("turned", turned, 3)
        diffuse = np.empty((*depth.shape[:2], 3), np.float32)
        job.diffuse = abi.image(diffuse)
        if world is not None:
            job.world[:] = np.asarray(world, np.float32).ravel()
        ellipsoids = (abi.Bend * max(1, len(bends)))()
        for to, bend in zip(ellipsoids, bends, strict=False):
            to.model[:] = np.asarray(bend.model, np.float64).ravel()
            to.amount, to.fade = bend.amount, bend.fade
        job.n_bends, job.bends = len(bends), abi.c.addressof(ellipsoids)
        return Work("light", job, [self, depth, normal, shine, specular, turned, ellipsoids], lambda: diffuse)
