# SPDX-License-Identifier: GPL-3.0-or-later
"""What is known of a view layer before it is rendered, and the passes that Cycles then wrote."""

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from ..pen import chains, layers, supersample
from ..pen.around import Window
from ..pen.backdrop import Backdrop, Once
from ..pen.job import Frame
from ..pen.settings import Settings
from ..pen.sky import Sky
from . import lamps, memory, meshes, versions


@dataclass
class ViewLayer:
    """What is known of a view layer before Cycles renders it."""

    name: str
    settings: Settings
    denoise_other: bool
    user_indices: np.ndarray | None  # by Cycles' index, to write into the pass that the user asked for
    objects: meshes.Objects | None   # None: nothing is drawn, nor kept in the file
    views: dict                      # view name -> (camera, rasterised pictures of `factor` times the frame's size,
                                     #               world -> camera, camera -> clip)
    light: lamps.Light | None        # None: the light is Cycles'
    sky: Sky | Backdrop | Once | None  # what is put behind what Cycles renders; None: it shows the world itself
    volumes: np.ndarray              # volumes.corners(), if light besides the diffuse is denoised
    clip_start: float
    frame: Frame                     # with the place of what is drawn in it
    own: Window                      # what is rendered for the file
    place: Window                    # that, and so much around it as it depends on
    border: tuple | None             # what was rendered where the file shows all of the frame: x, y, width, height
    threads: int
    samples: int                     # of a pixel, at most
    asked: list                      # names of the pictures to draw besides Combined
    keeps: bool                      # whether the file keeps what drawing again needs
    images: dict                     # {Chosen: pixels} that the settings read
    beside: dict                     # what else the file says of the scene: wanted.beside()
    spare: list                      # names of passes that are emptied in the end: wanted.spare()
    kept: memory.Layer | None = None  # what is kept of it, or drawn again
    early: str | None = None         # the only picture that is drawn, to be seen for a while
    drawn: dict | None = None        # view id -> passes to write, if that is already done

    @property
    def factor(self):
        return self.settings.factor

    @property
    def outputs(self):
        """Names of the pictures to draw."""
        if self.early:
            return [self.early]
        return [*(["Combined"] if self.settings.active else []), *self.asked]

    @property
    def chains(self):
        """{(view layer, view): Chains} as the file has them."""
        kept = [view.maps for view in self.kept.views.values()] if self.kept else []
        maps = dict(zip(self.views, kept, strict=False)) or {name: view[1] for name, view in self.views.items()}
        return {(self.name, name): chains.shrunk(of["chains"], self.factor)
                for name, of in maps.items() if of and "chains" in of}

    def again(self, settings, images):
        """This view layer, to be drawn from memory with other settings."""
        views = {name: (eye, None, view, projection) for name, (eye, _, view, projection) in self.views.items()}
        return replace(self, drawn=None, settings=settings, images=images, views=views)

    def shrinking(self, write):
        """write(), of what is drawn at `factor` times the frame's size and with what lies around."""
        if self.factor == 1 and self.own == self.place:
            return write
        return lambda name, picture: write(name, supersample.shrink(name, picture[self.inside], self.factor))

    @property
    def inside(self):
        """What is written in what is drawn: slices."""
        top, left = (self.factor * start for start in (self.own.y - self.place.y, self.own.x - self.place.x))
        return np.s_[top:top + self.factor * self.own.height, left:left + self.factor * self.own.width]


class Passes(Mapping):
    """What Cycles wrote of one view, by its classic names: read from Blender each time, so that nothing is kept."""

    def __init__(self, there, size, seen):
        """there: render passes by their names in this Blender; size: (width, height); seen: whether to read SEEN."""
        self.size = size
        names = {name: versions.pass_name(name)
                 for name in (*layers.CYCLES, *layers.BEHIND, *(layers.SEEN if seen else ()))}
        self.there = {name: there[own] for name, own in names.items() if own in there}

    def __getitem__(self, name):
        return versions.read_pass(self.there[name], *self.size)

    pop = __getitem__

    def __contains__(self, name):  # a Mapping would read the pass to say so
        return name in self.there

    def __iter__(self):
        return iter(self.there)

    def __len__(self):
        return len(self.there)
