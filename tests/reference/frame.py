# SPDX-License-Identifier: GPL-3.0-or-later
"""Layers in, cleaned; the stages in their order; passes out."""

import numpy as np

from . import between, example, gouache, hatch, lines, paper, printed, relief, rim, shade, smudge, specks, tones, wash
from . import edges as edge_stage
from .params import SWITCHES, Params

CONTROLS = ("thickness", "intensity", "color_edge", "smudge_range", "smudge_falloff", "hatching", "light")
REQUIRED = {"combined": 4, "color": 3, "diffuse": 3, "depth": 1, "normal": 3}
OPTIONAL = {"albedo": 3, "specular": 3, "object": 1, "material": 1, "style": 1, "controls": len(CONTROLS),
            "highlights": 3, "background": 3, "anchor": 16, "gloss": 3, "tangent": 3,
            "card": 4}
SEEN = {"seen_color": 3, "seen_normal": 3, "seen_depth": 1}
_LARGEST = float(np.finfo(np.float32).max)


class Layers:
    """Cleaned float64 layers; `depth` is inf where nothing is there, `style` always a valid number."""

    def __init__(self, layers, styles, camera, frame):
        missing = [name for name in REQUIRED if name not in layers]
        if missing:
            raise ValueError(f"required layers are missing: {', '.join(missing)}")
        self.nonfinite = 0
        height, width = np.shape(layers["depth"])[:2]

        def clean(name, channels):
            if layers.get(name) is None:
                return np.zeros((height, width, channels))
            data = np.array(layers[name], np.float64).reshape(height, width, channels)
            bad = np.isnan(data) if name == "depth" else ~np.isfinite(data)
            self.nonfinite += int(bad.sum())
            data[bad] = 0.0  # a depth of 0 is nothing there
            return data

        data = {name: clean(name, channels) for name, channels in {**REQUIRED, **OPTIONAL}.items()}
        self.combined, self.color, self.diffuse = data["combined"], data["color"], data["diffuse"]
        there = layers.get("seen_color") is not None and layers.get("seen_normal") is not None
        self.seen_color, self.seen_normal, self.seen_depth = (
            clean(name, channels) if there else None for name, channels in SEEN.items())
        self.seen_depth = self.seen_depth[..., 0] if there else None
        self.normal, self.specular, self.highlights = data["normal"], data["specular"], data["highlights"]
        self.gloss = data["gloss"]
        self.gives_highlights = layers.get("highlights") is not None
        self.background = None if layers.get("background") is None else data["background"]
        self.albedo = self.color if layers.get("albedo") is None else data["albedo"]
        self.object, self.material = data["object"][..., 0], data["material"][..., 0]
        self.anchor = None if layers.get("anchor") is None else data["anchor"]
        self.tangent = data["tangent"]
        self.card = None if layers.get("card") is None else data["card"]
        z = data["depth"][..., 0]
        self.there = (z > 0) & (z < 1e9)
        self.depth = np.where(self.there, z, np.inf)
        number = data["style"][..., 0]
        known = (number == np.floor(number)) & (number >= 1) & (number <= styles)
        self.style = np.where(known, number, 0).astype(int)
        painted = np.clip(data["controls"], -1.0, 1.0)
        self.controls = {name: painted[..., k] for k, name in enumerate(CONTROLS)}

        camera, frame = camera or {}, frame or {}
        self.orthographic = bool(camera.get("orthographic", False))
        self.view = np.reshape(camera.get("view", np.eye(3)), (3, 3))
        self.height = float(camera.get("height", 1.0))
        self.distance = float(camera.get("distance", 0.0))
        self.meter = 1.0, 0.0  # full light and shade
        self.full_width, self.full_height = frame.get("width", width), frame.get("height", height)
        self.x, self.y, self.number = (frame.get(key, 0) for key in ("x", "y", "number"))
        told = layers["chains"].points if layers.get("chains") else []
        passing = between.passages(told, (height, width), (self.y, self.x)) if len(told) else []
        self.marked, self.contours = between.marked(passing, (height, width)), between.contours(passing, self.depth)


def render(layers, scene=None, styles=(), camera=None, frame=None):
    """The picture and its passes, float64, row 0 on top.

    layers: name -> (H, W, C) or (H, W); scene: {parameter: value}; styles[k - 1]: the values of style k;
    camera: {"orthographic", "height" of the frame in scene units}; frame: {"width", "height", "x", "y"}.
    Besides the passes: edge_mask, edge_source (index into SOURCES, -1 = none), sources {name: S}, nonfinite,
    edge_unsure (strengths that float32 may miss by more than the tolerance) and unsure (likewise colours).
    Raises ValueError for an unknown parameter or a missing layer.
    """
    params = Params(scene, styles)
    layers = Layers(layers, len(styles), camera, frame)
    full, dark = (float((camera or {}).get(key, 0.0)) for key in ("light", "shade"))
    if params["shade_meter"] == "FIXED":
        full, dark = params["meter_light"], params["meter_shade"]
    if params["shade_meter"] != "SCENE" and full > 0:
        layers.meter = full, dark
    pen_1_grain, hatch_paper = paper.heights(layers, params)
    edges = edge_stage.find(layers, params)
    surface, light, doubtful = shade.surface(layers, params)
    surface = example.paint(layers, params, surface)
    surface = gouache.paint(layers, params, surface)
    surface, smudge_doubtful = smudge.smudge(layers, params, edges, surface, doubtful)
    surface, wash_doubtful = wash.paint(layers, params, surface, hatch_paper)
    surface, hatch_doubtful = hatch.hatch(layers, params, surface, hatch_paper)
    surface, tone_ink = tones.fill(layers, params, surface, hatch_paper)
    surface, rim_doubtful = rim.light(layers, params, surface)
    surface, _ = specks.fill(layers, params, surface)
    surface, print_doubtful = printed.fill(layers, params, surface)
    surface = relief.shine(layers, params, surface)

    rgb, alpha = surface[..., :3], surface[..., 3:]
    active = np.any([params.at(switch, layers.style) for switch in SWITCHES], axis=0)[..., None]
    fade = np.where(active, params["surface_fade"], 0.0)
    rgb = rgb + (alpha - rgb) * fade
    t, ink, line_doubtful = lines.draw(layers, params, edges, pen_1_grain)
    t = t[..., None]
    drawn = np.concatenate([rgb * (1 - t) + ink * t, alpha + t - alpha * t], axis=-1)
    line_ink = np.concatenate([ink * t, t], axis=-1)
    if any(table["use_lines"] for table in params.tables):
        drawn, line_ink = specks.fill(layers, params, drawn, line_ink)
    passes = {
        "Combined": drawn,
        "Encre Lines": line_ink,
        "Encre Surface": np.concatenate([rgb, alpha], axis=-1),
        "Encre Edges": edges.strength,
        "Encre Light": light,
        "Encre Tones": tone_ink,
    }
    passes = {name: np.clip(image, -_LARGEST, _LARGEST) for name, image in passes.items()}
    return {
        **passes, "edge_mask": edges.mask, "edge_source": edges.source, "sources": edges.sources,
        "nonfinite": layers.nonfinite, "edge_unsure": edges.strength_doubtful,
        "unsure": doubtful | wash_doubtful | hatch_doubtful | smudge_doubtful | rim_doubtful | print_doubtful |
        line_doubtful,
    }
