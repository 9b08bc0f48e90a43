# SPDX-License-Identifier: GPL-3.0-or-later
"""What the library makes of few or many samples: denoised light without what was left of its noise, and means."""

import numpy as np

from . import abi
from .errors import EncreError
from .job import Work, filled
from .library import load

REACH = abi.EVEN_REACH  # pixels around a part of a frame, from which on it is evened out as in the whole


def even(light: np.ndarray, rendered: np.ndarray, normal: np.ndarray, depth: np.ndarray,
         number: np.ndarray | None = None, threads: int = 0, simd: int = 1) -> np.ndarray:
    """Takes from `light` (height, width, 3) what the denoiser left of the noise in `rendered`, in place; returns it.
    normal: finite; depth and number, of the object: (height, width, 1). What lies on both sides of an outline or a fold
    is never mixed."""
    return load().run(even_work(light, rendered, normal, depth, number), threads, simd)


def even_work(light: np.ndarray, rendered: np.ndarray, normal: np.ndarray, depth: np.ndarray,
              number: np.ndarray | None = None) -> Work:
    """The Work of even()."""
    job = abi.EvenJob(light=abi.image(filled("light", light, (*light.shape[:2], 3))))
    keep = [light]
    for name, a in dict(rendered=rendered, normal=normal, depth=depth, object=number).items():
        if a is not None:
            a, image = abi.given(name, a, abi.EVEN_INPUTS[name])
            setattr(job, name, image)
            keep.append(a)
    return Work("even", job, keep, lambda: light)


def average(large: np.ndarray, factor: int, threads: int = 0, simd: int = 1) -> np.ndarray:
    """The mean of each factor x factor pixels of a picture (height, width, channels), or (height, width)."""
    height, width = large.shape[:2]
    if factor < 1 or height % factor or width % factor:
        raise EncreError(f"large: is {width} x {height} pixels; give a multiple of {factor} each way")
    out = np.empty((height // factor, width // factor, *large.shape[2:]), np.float32)
    job = abi.AverageJob(output=abi.image(out), factor=factor)
    large, job.large = abi.given("large", large, large.shape[2] if large.ndim == 3 else 1)
    return load().run(Work("average", job, [large, out], lambda: out), threads, simd)
