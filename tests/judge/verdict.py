# SPDX-License-Identifier: GPL-3.0-or-later
"""The whole judgement of a detector: every promise on every scene given, worst first.

`draw(layers, camera, **params)` must give T (rows, columns) for the parameters below and those it is called with."""

import functools
from dataclasses import dataclass

import numpy as np

from . import measure, thin
from .scenes import sphere

PARAMS = {
    "edge_threshold": 0.3, "line_color_strength": 3.0, "line_shadow_strength": 4.0, "line_material_strength": 0.0,
    "crease_angle": 20.0,
    "pen_1_softness": 0.0, "pen_1_steepness": 0.5, "pen_1_intensity": 2.0,
    "line_thickness": 1.0, "line_contrast": 0.0, "pen_1_grain": 0.0, "line_occlude": False,
    "length_unit": "PIXELS", "use_shading": False, "use_smudging": False, "use_hatching": False,
    **{f"line_{kind}_width": 1.0 for kind in ("outline", "material", "inner", "crease", "color", "shadow")},
}
# promise: (least, most)
LIMITS = {
    "place p95": (None, 0.25), "place max": (None, 0.8), "evenness": (0.98, None), "once": (0.995, None),
    "steady": (0.95, None), "whole outline": (0.999, None), "whole crease": (0.995, None),
    "whole color": (0.995, None), "whole light": (0.995, None),
    "stray": (None, 0.0002), "alike": (None, 0.15),
    "width 1": (0.9, 1.1), "width 2": (1.9, 2.1), "width 4": (3.9, 4.1), "width 8": (7.9, 8.1),
    "still": (None, 1.1), "fair": (None, 0.002), "calm": (None, 0.0005),
}


def kept(promise, value):
    least, most = LIMITS[promise]
    return bool(np.isnan(value) or ((least is None or value >= least) and (most is None or value <= most)))


def lines(t, truth):
    """Promises about one hairline drawing: {promise: value}."""
    return {promise: value for promise, (value, _) in _lines(t, truth).items()}


def _lines(t, truth):
    """{promise: (value, contour points that it is about)}."""
    place, whole = measure.place(t, truth), measure.whole(t, truth)
    found = {"place p95": place["p95"], "place max": place["max"], "evenness": measure.evenness(t, truth),
             "once": measure.once(t, truth), "steady": measure.steady(t, truth), "stray": measure.stray(t, truth)}
    found = {promise: (value, 1) for promise, value in found.items()}
    return found | {"whole " + kind: share for kind, share in whole.items()}


def _widest(scene, points, asked):
    """As thin.widest(), once for all detectors: the points of a width are the same."""
    found = scene.truth.clear
    key = "widest", asked
    if key not in found:
        found[key] = thin.widest(scene, points, asked)
    return found[key]


def widths(draw, scene, layers):
    found = {}
    for asked in (1, 2, 4, 8):
        t = draw(layers, scene.camera_settings, **PARAMS | {"line_thickness": float(asked)})
        found[f"width {asked}"] = measure.width(t, scene.truth, asked, functools.partial(_widest, scene))
    return found


def is_told(layers):
    """Whether there are layers that only our rasteriser gives."""
    return bool("chains" in layers)


def fair(draw, scene, layers):
    """The largest share of pixels that another way up, or negated normals, changes. What a rasteriser told is not
    turned."""
    camera = scene.camera_settings
    still = draw(layers, camera, **PARAMS)
    worst = measure.differs(draw(layers | {"normal": -layers["normal"]}, camera, **PARAMS), still)
    for symmetry in () if is_told(layers) else measure.SYMMETRIES[1:]:
        turned = {name: measure.moved(a, symmetry) for name, a in layers.items()}
        worst = max(worst, measure.differs(draw(turned, camera, **PARAMS), measure.moved(still, symmetry)))
    return {"fair": worst}


def calm(draw, scene, filter="box"):
    """Stray ink under noise, the light's boundaries off: those need clean light."""
    layers = scene.layers(filter, noise=1.0)
    t = draw(layers, scene.camera_settings, **PARAMS | {"line_shadow_strength": 0.0})
    return {"calm": measure.stray(t, scene.truth)}


@functools.cache
def moving():
    """A ball that moves by an eighth of a pixel from scene to scene."""
    return [sphere(shift=k / 8, size=(150, 200)) for k in range(9)]


def panned(make, size=(150, 200), steps=5):
    """The scene of make(shift=…) as the camera moves by an eighth of a pixel aside and an eleventh up from frame to
    frame, in a small frame: for still()."""
    scenes = [make(shift=(k / 8, k / 11)) for k in range(steps)]
    for scene in scenes:
        scene.size = size
    return scenes


def still(draw, filter="box", scenes=None):
    """`scenes`: those of a pan, by default moving()."""
    scenes = scenes or moving()
    frames = [draw(scene.layers(filter), scene.camera_settings, **PARAMS) for scene in scenes]
    return {"still": measure.stillness(frames, [scene.truth for scene in scenes])}


@dataclass
class Result:
    where: str
    promise: str
    value: float
    points: int = 1


def judge(draw, scenes, filters=("box", "blackman"), full=True, moves=True):
    """Yield Results. scenes: {name: Scene}; full: also the promises that need many drawings; moves: that of stillness
    too, on a scene of its own."""
    for name, scene in scenes.items():
        for filter in filters:
            layers = scene.layers(filter)
            t = draw(layers, scene.camera_settings, **PARAMS)
            found = _lines(t, scene.truth)
            if scene.spots:
                found["alike"] = measure.alike(t, scene.spots), 1
            if full:
                more = widths(draw, scene, layers) | fair(draw, scene, layers) | calm(draw, scene, filter)
                found |= {promise: (value, 1) for promise, value in more.items()}
            yield from (Result(f"{name} {filter}", promise, *value) for promise, value in found.items())
        if is_told(layers):
            continue
        alike = scene.layers(filters[0], one_index=True)
        found = _lines(draw(alike, scene.camera_settings, **PARAMS), scene.truth.one_index())
        yield from (Result(f"{name} one index", promise, *value) for promise, value in found.items())
    if full and moves:
        for filter in filters:
            yield from (Result(f"moving sphere {filter}", *item) for item in still(draw, filter).items())


def summary(results):
    """{promise: (value, worst Result)}. The value is the worst, but of what must be inked the share of all contours."""
    results, found = list(results), {}
    for promise, (least, most) in LIMITS.items():
        own = [r for r in results if r.promise == promise and not np.isnan(r.value)]
        if not own:
            continue
        middle = None if least is None or most is None else (least + most) / 2
        badness = [abs(r.value - middle) if middle is not None else r.value if least is None else -r.value for r in own]
        worst = own[int(np.argmax(badness))]
        value = worst.value
        if promise.startswith("whole"):
            points = sum(r.points for r in own)
            value = sum(r.value * r.points for r in own) / points if points else 1.0
        found[promise] = value, worst
    return found


def broken(results):
    """{promise: a word on it} of the promises that are not kept."""
    return {promise: f"{value:.4f}, worst {worst.value:.4f} in {worst.where}"
            for promise, (value, worst) in summary(results).items() if not kept(promise, value)}


def table(columns):
    """Markdown. columns: {detector: its Results}; what breaks a promise is bold."""
    found = {name: summary(results) for name, results in columns.items()}
    rows = ["| promise | limit | " + " | ".join(columns) + " |", "|---|---|" + "---|" * len(columns)]
    for promise, (least, most) in LIMITS.items():
        if not all(promise in own for own in found.values()):
            continue
        limit = f"≤ {most}" if least is None else f"≥ {least}" if most is None else f"{least}–{most}"
        cells = [f"{value:.4f}" if kept(promise, value) else f"**{value:.4f}**"
                 for value, _ in (own[promise] for own in found.values())]
        rows.append(f"| {promise} | {limit} | " + " | ".join(cells) + " |")
    return "\n".join(rows) + "\n"
