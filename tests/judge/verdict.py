# SPDX-License-Identifier: GPL-3.0-or-later
"""The whole judgement of a detector: every promise on every scene given, worst first.

`draw(layers, camera, **params)` must give T (rows, columns) for the parameters below and those it is called with."""

import numpy as np

from . import measure
from .scenes import sphere

PARAMS = {
    "edge_threshold": 0.3, "edge_color": 3.0, "edge_light": 4.0, "edge_material": 0.0,
    "line_softness": 0.0, "line_gain": 0.5, "line_intensity": 2.0,
    "line_thickness": 1.0, "line_contrast": 0.0, "line_paper": 0.0, "line_occlude": False,
    "length_unit": "PIXELS", "use_shading": False, "use_smudging": False, "use_hatching": False,
    **{"width_" + name: 1.0 for name in ("object", "material", "depth", "normal", "color", "light")},
}
# promise: (least, most)
LIMITS = {
    "place p95": (None, 0.25), "place max": (None, 0.8), "evenness": (0.98, None), "once": (0.995, None),
    "whole outline": (0.999, None), "whole crease": (0.995, None),
    "whole color": (0.995, None), "whole light": (0.995, None),
    "stray": (None, 0.0005), "width 1": (0.9, 1.1), "width 2": (1.9, 2.1), "width 4": (3.9, 4.1), "width 8": (7.9, 8.1),
    "still": (None, 1.1), "fair": (None, 0.002), "calm": (None, 0.0005),
}


def kept(promise, value):
    least, most = LIMITS[promise]
    return bool(np.isnan(value) or ((least is None or value >= least) and (most is None or value <= most)))


def lines(t, truth):
    """Promises about one hairline drawing: {promise: value}."""
    place, whole = measure.place(t, truth), measure.whole(t, truth)
    found = {"place p95": place["p95"], "place max": place["max"], "evenness": measure.evenness(t, truth),
             "once": measure.once(t, truth), "stray": measure.stray(t, truth)}
    return found | {"whole " + kind: share for kind, (share, _) in whole.items()}


def widths(draw, scene, layers):
    found = {}
    for asked in (1, 2, 4, 8):
        t = draw(layers, scene.camera_settings, **PARAMS | {"line_thickness": float(asked)})
        found[f"width {asked}"] = measure.width(t, scene.truth, asked)
    return found


def fair(draw, scene, layers):
    """The largest share of pixels that another way up, or negated normals, changes."""
    camera = scene.camera_settings
    still = draw(layers, camera, **PARAMS)
    worst = measure.differs(draw(layers | {"normal": -layers["normal"]}, camera, **PARAMS), still)
    for symmetry in measure.SYMMETRIES[1:]:
        turned = {name: measure.moved(a, symmetry) for name, a in layers.items()}
        worst = max(worst, measure.differs(draw(turned, camera, **PARAMS), measure.moved(still, symmetry)))
    return {"fair": worst}


def calm(draw, scene, filter="box"):
    """Stray ink under noise, the light's boundaries off: those need clean light."""
    layers = scene.layers(filter, noise=1.0)
    t = draw(layers, scene.camera_settings, **PARAMS | {"edge_light": 0.0})
    return {"calm": measure.stray(t, scene.truth)}


def still(draw, filter="box"):
    moving = [sphere(shift=k / 8, size=(150, 200)) for k in range(9)]
    frames = [draw(scene.layers(filter), scene.camera_settings, **PARAMS) for scene in moving]
    return {"still": measure.stillness(frames, [scene.truth for scene in moving])}


def judge(draw, scenes, filters=("box", "blackman"), full=True):
    """Yield (scene, promise, value, kept). scenes: {name: Scene}; full: also the promises that need many drawings."""
    for name, scene in scenes.items():
        for filter in filters:
            layers = scene.layers(filter)
            found = lines(draw(layers, scene.camera_settings, **PARAMS), scene.truth)
            if full:
                found |= widths(draw, scene, layers) | fair(draw, scene, layers) | calm(draw, scene, filter)
            yield from ((f"{name} {filter}", promise, value, kept(promise, value)) for promise, value in found.items())
        alike = scene.layers(filters[0], one_index=True)
        found = lines(draw(alike, scene.camera_settings, **PARAMS), scene.truth.one_index())
        yield from ((f"{name} one index", promise, value, kept(promise, value)) for promise, value in found.items())
    if full:
        for filter in filters:
            yield from ((f"moving sphere {filter}", promise, value, kept(promise, value))
                        for promise, value in still(draw, filter).items())


def table(results):
    """Markdown: for each promise the worst value, where, and how many of how many drawings keep it."""
    results = list(results)
    rows = ["| promise | limit | worst | where | kept |", "|---|---|---|---|---|"]
    for promise, (least, most) in LIMITS.items():
        own = [(value, place, good) for place, what, value, good in results if what == promise and not np.isnan(value)]
        if not own:
            continue
        middle = ((least or 0) + (most or 0)) / 2 if least is not None and most is not None else None
        worst = max(own, key=lambda r: abs(r[0] - middle) if middle is not None else r[0] if least is None else -r[0])
        limit = f"{least}–{most}" if middle is not None else f"≤ {most}" if least is None else f"≥ {least}"
        rows.append(f"| {promise} | {limit} | {worst[0]:.4f} | {worst[1]} | {sum(g for *_, g in own)} of {len(own)} |")
    return "\n".join(rows) + "\n"
