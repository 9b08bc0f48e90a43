# SPDX-License-Identifier: GPL-3.0-or-later
"""Jobs that are right, as ctypes has them, of which tests spoil one thing."""

import ctypes

import numpy as np
import pytest
from encre.pen import abi, scene
from encre.pen.errors import EncreError
from encre.pen.job import Camera, Materials, Mesh, Picture, Program
from encre.pen.library import load

WIDTH, HEIGHT = 12, 8
KINDS = {"render": {}, "raster": dict(depth=1, normal=3, object=1, material=1, style=1, attributes=3,
                                      coincident=1, shading=3, anchor=16, tangent=3, card=4),
         "bake": {"texture": 3, "form": 3, "output": 3},
         "light": {"depth": 1, "normal": 3, "diffuse": 3},
         "material": {**abi.MATERIAL_INPUTS, "attributes": 3, **abi.MATERIAL_OUTPUTS}}
PROJECTION = (1, 0, 0, 0, 0, 1, 0, 0, 0, 0, -1, -0.2, 0, 0, -1, 0)


def array(channels, name=""):
    """An image that may be taken for one of 16 channels without reaching into what lies after it."""
    room = np.full(HEIGHT * WIDTH * max(channels, 16), 0.25, np.float32)
    a = room[:HEIGHT * WIDTH * channels].reshape(HEIGHT, WIDTH, channels)
    if name == "normal":
        a[...] = 0, 0, 1
    return a


class Job:
    """`images` by name, `job` as ctypes has it."""

    def __init__(self, kind):
        self.kind, self.lib, self.keep, self.images = kind, load(), [], {}
        getattr(self, "_" + kind)()
        for name, channels in KINDS[kind].items():
            self.give(name, channels)

    def give(self, name, channels):
        self.keep.append(array(channels, name))
        setattr(self.job, name, abi.image(self.keep[-1]))
        self.images[name] = getattr(self.job, name)

    def _params(self):
        self.block, _ = self.lib.pack({})
        self.job.params = ctypes.addressof(self.block)

    def _camera(self):
        self.job.view[:] = np.eye(4).ravel()
        self.job.projection[:] = PROJECTION
        self.job.frame = abi.Frame(WIDTH, HEIGHT, 0, 0)

    def _render(self):
        self.job = self.lib._job()
        for table, images in ((self.lib.layers, self.job.layers), (self.lib.outputs, self.job.outputs)):
            for i, (name, channels) in enumerate(table.items()):
                self.keep.append(array(channels, name))
                images[i] = abi.image(self.keep[-1])
                self.images[name] = images[i]
        self._params()
        self.job.n_styles = 1
        self.job.camera = abi.Camera((ctypes.c_float * 9)(*Camera().view), 0, 1.0, 0.0, 0.0)
        self.job.frame = abi.Frame(WIDTH, HEIGHT, 0, 0)

    def _raster(self):
        self.job, self.mesh = abi.RasterJob(), abi.Mesh()
        points = np.array([[-1, -1, -2], [1, -1, -2], [0, 1, -2]], np.float32)
        self.keep.append(abi.fill_mesh(self.mesh, Mesh(points, np.array([[0, 1, 2]]))))
        self.job.meshes, self.job.n_meshes, self.job.n_channels = ctypes.pointer(self.mesh), 1, 3
        self.job.clip_start = 0.1
        self._camera()

    def _bake(self):
        self.job = abi.BakeJob()
        self._params()

    def _light(self):
        self.scene = scene.Scene(self.lib)
        self.job = abi.LightJob(scene=self.scene._handle, clip_start=0.1)
        self._camera()

    def _material(self):
        self.job, constant = abi.MaterialJob(), self.lib.operations["constant"][0]
        program = Program(np.array([[constant, *[0] * 11]], np.int32), 1, [0] * abi.RESULTS)
        self.block, keep = abi.materials(Materials([program], [Picture(np.ones((1, 4), np.float32), 1, 1, 1)],
                                                   np.ones(40, np.float32), np.ones((2, 2), np.float32)))
        self.job.materials = ctypes.pointer(self.block)
        self.operation = abi.Operation.from_address(self.block.programs[0].operations)
        self.keep += keep
        self._camera()

    def run(self):
        self.lib._call(getattr(self.lib.lib, "encre_" + self.kind), self.job, 1, 1, None)

    def refused(self, words):
        with pytest.raises(EncreError, match=words) as error:
            self.run()
        told(error)

    def memory(self, size):
        """Bytes, aligned to 8, that live as long as the job."""
        self.keep.append(np.zeros(size // 8 + 1, np.float64))
        return self.keep[-1].ctypes.data


def told(error):
    """A refusal is one sentence: what is wrong, and the cure."""
    text = str(error.value)
    assert ": " in text and "; " in text and "\n" not in text and text.count(".") <= 3
