# SPDX-License-Identifier: GPL-3.0-or-later
"""Pictures that a view may show: the finished one, and others that tell how it comes about."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from . import library
from .background import Steps
from .job import Camera, Frame, Work
from .params import Chosen
from .settings import Settings

# What draws lines: (weight, the colour by which it is known here).
SOURCES = (("line_outline_strength", (0.8, 0.05, 0.03)), ("line_inner_strength", (0.9, 0.4, 0.0)),
           ("line_crease_strength", (0.05, 0.25, 0.9)),
           ("line_material_strength", (0.05, 0.45, 0.08)), ("line_color_strength", (0.65, 0.05, 0.6)),
           ("line_shadow_strength", (0.0, 0.45, 0.5)),
           ("line_mark_strength", (0.4, 0.2, 0.05)), ("line_mirror_strength", (0.3, 0.3, 0.3)),
           ("line_suggestive_strength", (0.45, 0.65, 0.05)), ("line_hidden_strength", (0.55, 0.5, 0.4)))
_COLD, _NEUTRAL, _HOT = np.array([(0.02, 0.12, 0.8), (0.3, 0.3, 0.3), (0.85, 0.08, 0.02)], np.float32)
_STYLES = np.array([(0.3, 0.3, 0.3), (0.8, 0.15, 0.1), (0.1, 0.35, 0.8), (0.1, 0.55, 0.15), (0.8, 0.6, 0.05),
                    (0.5, 0.15, 0.6), (0.05, 0.6, 0.6), (0.8, 0.35, 0.5)], np.float32)


@dataclass
class Wish:
    """What is to be shown."""

    show: str = "FINAL"  # a key of SHOWS
    control: str = ""    # whose heat map CONTROL is


@dataclass
class Drawing:
    """What a picture is drawn from: layers as library.draw() takes them."""

    layers: Mapping[str, np.ndarray]
    camera: Camera
    frame: Frame
    settings: Settings
    images: Mapping[Chosen, np.ndarray]  # that the settings name
    same: int = 0                        # as in library.draw_work()

    def work(self, outputs: Sequence[str], every: Sequence[Mapping] | None = None) -> Work:
        return library.load().draw_work(self.layers, every or self.settings.every, self.camera, self.frame, outputs,
                                        self.images.__getitem__, same=self.same)

    def form(self) -> np.ndarray:
        """(height, width, 1): how bright surfaces are that are lit from the camera."""
        towards = np.einsum("yxc,c->yx", self.layers["normal"], np.array(self.camera.view[6:9], np.float32))
        return np.float32(0.5) + np.float32(0.5) * np.abs(towards[..., None])


def _solid(color: np.ndarray) -> np.ndarray:
    picture = np.ones((*color.shape[:2], 4), np.float32)
    picture[..., :3] = color
    return picture


def _final(drawing: Drawing, _wish: Wish) -> Steps:
    (result,) = yield [drawing.work(["Combined"])]
    return result.images["Combined"]


def _ink(drawing: Drawing, _wish: Wish) -> Steps:
    """The lines on white."""
    (result,) = yield [drawing.work(["Encre Lines"])]
    lines = result.images["Encre Lines"]
    lines[..., :3] += 1 - lines[..., 3:]
    lines[..., 3] = 1
    return lines


def drawing_sources(settings: Settings) -> list[str]:
    """Weights of the sources that may draw lines."""
    return [weight for weight, _ in SOURCES if settings.any(weight)]


def _edges(drawing: Drawing, _wish: Wish) -> Steps:
    """The lines that each source would draw alone, in its colour; those of the first of SOURCES lie on top."""
    weights, works = drawing_sources(drawing.settings), []
    for own in weights:
        every = [{**values, **{weight: 0.0 for weight, _ in SOURCES if weight != own}}
                 for values in drawing.settings.every]
        works.append(drawing.work(["Encre Lines"], every))
    out = np.ones((*drawing.layers["combined"].shape[:2], 4), np.float32)
    results = (yield works) if works else []
    for weight, result in reversed([*zip(weights, results, strict=True)]):
        share = result.images["Encre Lines"][..., 3:]
        out[..., :3] = out[..., :3] * (1 - share) + np.array(dict(SOURCES)[weight], np.float32) * share
    return out


def _levels(drawing: Drawing, _wish: Wish) -> Steps:
    """The discrete light on white surfaces."""
    (result,) = yield [drawing.work(["Encre Light"])]
    return _solid(result.images["Encre Light"])


def _styles(drawing: Drawing, _wish: Wish) -> Steps:
    yield []  # no work
    style = drawing.layers.get("style", drawing.layers["object"])[..., 0].astype(np.intp)
    style[(style < 0) | (style >= len(drawing.settings.every))] = 0
    color = _STYLES[np.where(style, (style - 1) % (len(_STYLES) - 1) + 1, 0)]
    return _solid(color * drawing.form())


def _control(drawing: Drawing, wish: Wish) -> Steps:
    """A control: blue where it is least, grey where neutral, red where most."""
    yield []
    values = np.zeros((*drawing.layers["combined"].shape[:2], 1), np.float32)
    if "controls" in drawing.layers:
        k = list(library.controls()).index(wish.control)
        values = np.clip(drawing.layers["controls"][..., k, None], -1, 1)
    color = _NEUTRAL + np.maximum(values, 0) * (_HOT - _NEUTRAL) + np.maximum(-values, 0) * (_COLD - _NEUTRAL)
    return _solid(color * drawing.form())


SHOWS: dict[str, Callable[[Drawing, Wish], Steps]] = {
    "FINAL": _final, "INK": _ink, "EDGES": _edges, "LEVELS": _levels, "STYLES": _styles, "CONTROL": _control}


def picture(drawing: Drawing, wish: Wish) -> Steps:
    """Steps to the picture (height, width, 4) of a wish, scene-linear, premultiplied."""
    return SHOWS[wish.show](drawing, wish)
