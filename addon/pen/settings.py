# SPDX-License-Identifier: GPL-3.0-or-later
"""The settings of a scene and its styles, read and checked once, and what they ask for."""

from collections.abc import Callable, Iterable, Mapping
from functools import cached_property
from typing import Any

import numpy as np

from . import colour, library
from .params import (
    LINES,
    Chosen,
    fills_sheets,
    fills_surfaces,
    leaves_out_lines,
    pens,
    screens_pitches,
    sticking_pens,
    strokes_along_uv,
    strokes_pitches,
    terms,
)

_MOST_OF_HEIGHT = 0.03  # looked at: up to a fiftieth things keep their forms, at a twenty-fifth they are blots
_STROKE = 4.5  # pitches from a stroke's place to its end, at most
_PLANE = 6  # steps to each side of a stroke's place: is the surface there a plane? (csrc/tones/ways.c: plane_at)
_WIDEST = 40  # px that strokes lie apart at most whose distance grows with the thing
_POOL = 22  # units of length that the darker border of a wash reaches into it
_WINDOW = 24  # px about an edge at which its detector looks, whatever the settings are; no fewer pixels

# Versions of the settings, which files store: {version: {id: the default before it}}. Ids are for ever. To change a
# default: add a version and what it was before.
BEFORE: dict[int, dict[str, Any]] = {
    1: {"crease_source": "LAYERS"},
    2: {"line_far_unit": "SCENE", "crease_angle": 20.0, "line_shortest": 0.0},
    3: {"hatch_color_light": 0.0},
    4: {},  # Encre has a number of samples of its own (blender/migration.py)
}
VERSION = max(BEFORE)


def _widest(values):
    """How wide a line may be, in units of length: where thickness is painted, near the camera, in the dark, of the
    widest source and kind, by a pen that is pressed."""
    source = max(values[f"line_{kind}_width"] for kind in LINES)
    kind = max(values["line_contact_width"], values["line_intersection_width"], values["line_outer_width"], 1)
    near = max(values["line_far_thickest"], 1) if values["line_far_distance"] else 1
    pen = max(max(values[f"{pen}_width"], 1) * (3 if values[f"{pen}_pressure"] else 1)
              * (1 + values[f"{pen}_pool"]) for pen in pens(values))
    return 9 * values["line_thickness"] * source * kind * near * (1 + abs(values["ink_in_shade"])) * pen


def since(version: int) -> dict[str, Any]:
    """{id: the default that settings of this version had} of those that have changed after it."""
    before: dict[str, Any] = {}
    for later in range(version + 1, VERSION + 1):
        before = {**BEFORE[later], **before}
    return before


def switches() -> list[str]:
    """Ids of the parameters that turn a stage off."""
    return [stage.switch.id for stage in library.stages() if stage.switch]


def _wish(term):
    """A term of an `enabled_if` as --set takes it."""
    id_, _, items = term.lstrip("!").partition("=")
    if items:
        return f"{id_}={' or '.join(items.split('|'))}"
    if library.params()[id_].type == "bool":
        return f"{id_}={'off' if term.startswith('!') else 'on'}"
    return f"{id_} above 0"


def pixels_wide(values: Mapping[str, Any]) -> float:
    """How wide lines are that are given in pixels of the frame; 0: there are none."""
    if not values["use_lines"] or values["length_unit"] != "PIXELS":
        return 0.0
    return min(values["line_thickness"], values["line_thickest"])


def crowded(width: float, height: int) -> bool:
    """Whether lines so wide run together in a picture of this height."""
    return width > _MOST_OF_HEIGHT * height


_COLOR_LINES = ("color_smooth", "contrast_metric", "contrast_hue", "contrast_saturation", "contrast_lightness")
_COLOR_LEAST = ("contrast_threshold", "contrast_full", "contrast_local", "edge_threshold")


class Settings:
    """scene: the scene's values; styles: [(name, what it changes)], in the order of their numbers, which begin at 1;
    every: the complete values of each style, number 0 (the scene's) first, with colours in the space of the pictures;
    settings have them in linear Rec. 709."""

    def __init__(self, scene: Mapping[str, Any] | None = None,
                 styles: Iterable[tuple[str, Mapping[str, Any]]] = (), space: str = "") -> None:
        """Of values that may be incomplete; space: the pictures' colorInteropID. EncreError: they can't be used."""
        self.space = space
        self.scene = library.check(scene or {})
        self.styles = [(name, library.check(changed)) for name, changed in styles]
        self.every = library.complete(self.scene, [changed for _, changed in self.styles])
        if colour.to_rec709(space) is not None:
            self.every = [{id_: self._placed(library.params()[id_].type, value) for id_, value in values.items()}
                          for values in self.every]

    def _placed(self, kind: str, value: Any) -> Any:
        """A value with its colours in the space of the pictures."""
        if kind == "color":
            return colour.from_rec709(value, self.space)
        if kind == "levels":  # (intensity, threshold, transition), which a colour may follow
            return [(*level[:3], *colour.from_rec709(level[3:], self.space)) if level[3:] else level for level in value]
        return value

    def any(self, *names: str) -> bool:
        """Whether any of these switches and weights is on anywhere."""
        return any(values[name] > 0 for values in self.every for name in names)

    def in_vain(self, ids: Iterable[str]) -> str | None:
        """Which of these parameters change nothing, in one sentence, because no style has what their rows ask for;
        None: all do something."""
        found = {}
        for p in (library.params()[id_] for id_ in ids):
            judged = [terms(p.enabled_if, values.__getitem__) for values in self.every]
            if not any(all(each.values()) for each in judged):
                found[p.id] = " and ".join(_wish(term) for term, true in judged[0].items() if not true)
        some = ", ".join(f"{id_} (it needs {wish})" for id_, wish in found.items())
        return f"what was set changes nothing here: {some}" if found else None

    def blots(self, height: int) -> str | None:
        """That lines in pixels are too wide for a picture of this height, in one sentence; None: they are not."""
        most = max(map(pixels_wide, self.every))
        if not crowded(most, height):
            return None
        return (f"lines of {most:g} px run together in a picture {height} px high; make it larger than "
                f"{int(most / _MOST_OF_HEIGHT)}, or set length_unit=RELATIVE and they shrink with it")

    @cached_property
    def active(self) -> bool:
        """Whether any stage draws anything: with all switches off the picture stays as it was rendered."""
        return self.any(*switches())

    @cached_property
    def shaded(self) -> bool:
        """Whether light is cut into levels anywhere."""
        return self.any("use_shading")

    @cached_property
    def wants_light(self) -> bool:
        """Whether anything compares light with a threshold, so that its noise would show as speckle."""
        return self.active and self.any("use_shading", "use_example", "use_hatching", "use_tones",
                                        "line_shadow_strength",
                                        "ink_in_shade")

    @cached_property
    def unread(self) -> set[str]:
        """Those of Cycles' passes that nothing looks at, by their classic names."""
        return {*(() if self.wants_specular else ("GlossDir", "GlossInd")),
                *(() if self.wants_light or not self.active else ("DiffInd",))}

    @cached_property
    def hidden(self) -> int:
        """Behind how many things lines are drawn, at most."""
        return self.every[0]["hidden_most"] if self.wants_edges and self.any("line_hidden_strength") else 0

    @cached_property
    def fast(self) -> bool:
        """Whether the layers are drawn from the scene, without a renderer."""
        return self.every[0]["layer_source"] == "ENCRE"

    @cached_property
    def flat(self) -> tuple[int, ...]:
        """By number of style, in how many flat colors at most images on surfaces are; 0: as they are."""
        return tuple(values["flat_colors"] for values in self.every)

    @cached_property
    def sky_colors(self) -> int:
        """In how many flat colors at most a picture of the sky is seen; 0: as it is."""
        return self.every[0]["sky_colors"]

    @cached_property
    def draws_light(self) -> bool:
        """Whether light is to be drawn where there is a scene to draw it from."""
        return self.every[0]["light_source"] == "DRAWN" and self.active

    @cached_property
    def shadows_world(self) -> bool:
        """Whether things keep the world's light from each other, where light is drawn."""
        return bool(self.every[0]["world_shadows"])

    @cached_property
    def planes(self) -> float:
        """How much the world's light tells sides apart, where light is drawn."""
        return float(self.every[0]["world_planes"])

    @cached_property
    def facets(self) -> float:
        """Below how many degrees facets are lit as one smooth surface, where light is drawn."""
        return float(self.every[0]["facet_angle"]) if self.draws_light or self.fast else 0.0

    @cached_property
    def denoises(self) -> bool:
        """Whether the light is to be denoised, where it is rendered."""
        return self.every[0]["light_denoise"] == "OIDN" and self.wants_light

    @cached_property
    def denoises_other(self) -> bool:
        """Whether gloss, glass and glow are seen beside flat light, so that their noise must go as that of light."""
        return self.every[0]["light_denoise"] == "OIDN" and any(
            values["use_shading"] and (values["other_light"] > 0 or values["use_tones"] and values["tone_mirrors"])
            for values in self.every)

    @cached_property
    def light_scale(self) -> float:
        """What brings light to about 1 where thresholds compare it. It must not depend on what presets and styles
        change, else a restyled frame would not be the frame rendered so."""
        return self.every[0]["shade_exposure"] or 1.0

    @cached_property
    def of_layers(self) -> tuple:
        """Equal for settings by which layers.assemble() makes the same of the same passes, but for noise."""
        return (self.denoises, self.cleans_seen, self.wants_parts, self.wants_specular, self.wants_gloss,
                [(values["use_shading"], values["shade_light"]) for values in self.every])

    @cached_property
    def factor(self) -> int:
        """Of how many times the frame's size the layers are."""
        return self.every[0]["supersample"] if self.active or self.fast else 1

    def reach(self, height: int) -> int:
        """How far in a frame of this height, in pixels, what is drawn at a pixel depends on others; light that is
        denoised and tapers, which follow whole chains, apart."""
        scene, most = self.every[0], 0.0
        for values in self.every:
            if values["use_lines"]:
                strays = max(4 * (values[f"{pen}_wobble"] + values[f"{pen}_rough"]) + 3 * values[f"{pen}_overshoot"]
                             for pen in pens(values))
                weighed = 60 if values["line_density"] < 1 else 0  # three nodes of its grid
                kept = max(values["line_gap"], values["line_halo"])
                most = max(most, min(scene["line_thickest"], _widest(values)) / 2 + strays + weighed, kept + 3)
            if values["use_smudging"]:
                most = max(most, 2 * values["smudge_range"] + values["smudge_pick"])
            if values["use_gouache"]:
                most = max(most, 2 * scene["gouache_size"])
            if values["use_wash"]:
                most = max(most, _POOL + 4)
            if values["use_rim"]:
                most = max(most, values["rim_width"] + 2)
            if values["use_tones"]:
                most = max(most, 4 * max(scene["tone_detail"], scene["tone_crumbs"]))
        if scene["contrast_local"] and self.any("line_color_strength"):
            most += scene["contrast_window"] / 2
        if self.any("line_suggestive_strength"):  # blurred light, the room beside a valley, and all of what is short
            most += 5 * scene["suggestive_size"] + max(values["line_suggestive_shortest"] for values in self.every)
        most += max((values[f"line_{kind}_shortest"] for kind in ("color", "mirror", "shadow")
                     if self.any(f"line_{kind}_strength") for values in self.every), default=0)
        scale = {"RELATIVE": height / 1080, "MM": height / scene["page_height"], "PIXELS": 1}[scene["length_unit"]]
        counted = scene["tone_pitch_unit"] == "LPI"
        inch = 25.4 * height / scene["page_height"]
        strokes = [_WIDEST * scale if pitch is None else inch / pitch if counted else pitch * scale
                   for values in self.every for pitch in strokes_pitches(values)]
        screens = [inch / pitch if counted else pitch * scale for values in self.every
                   for pitch in screens_pitches(values)]
        most = most * scale + scene["tone_least"] * max(screens, default=0)
        along = any(values["tone_strokes"] == "LIGHT" for values in self.every)
        aside = _PLANE * max(8 * scale + 0.5, 2) if along else 0
        far = max(most, *(_STROKE * max(pitch, 3) + aside for pitch in strokes), 0)
        return int(np.ceil(far) + np.ceil(_WINDOW * max(1, scale))) if self.active else 0

    @cached_property
    def images(self) -> list[Chosen]:
        """The images that are read, each once. EncreError: one should be, and none is given."""
        return list(dict.fromkeys(chosen for style in library.images(self.every) for chosen in style))

    def load(self, read: Callable[[Chosen], np.ndarray]) -> dict[Chosen, np.ndarray]:
        """The pixels of the images, each from read(). EncreError: one can't be used."""
        pixels = {}
        for chosen in self.images:
            pixels[chosen] = read(chosen)
            library.check({}, {chosen.id: pixels[chosen]})
        return pixels

    @cached_property
    def wants_edges(self) -> bool:
        """Whether anything follows edges."""
        return self.any("use_lines", "use_smudging")

    @cached_property
    def tells_colors(self) -> bool:
        """Whether lines that images tell of may be drawn where colors part, if only where that is painted."""
        return (self.every[0]["edge_detector"] == "FINE" and self.every[0]["color_layer"] == "ALBEDO"
                and self.wants_edges)

    @cached_property
    def wants_color_lines(self) -> bool:
        """Whether they are drawn wherever colors part."""
        return self.tells_colors and self.any("line_color_strength")

    @cached_property
    def color_lines(self) -> tuple | None:
        """What tells how images part into colors; None: nobody asks. Equal ones find the same lines, but for faint
        ones, which color_least decides."""
        return tuple(self.every[0][id_] for id_ in _COLOR_LINES) if self.wants_color_lines else None

    @cached_property
    def color_least(self) -> tuple:
        """What tells which contrast is the least that is looked for."""
        return (*(self.every[0][id_] for id_ in _COLOR_LEAST),
                *(values["line_color_strength"] for values in self.every))

    @cached_property
    def layers_key(self) -> tuple:
        """Equal ones draw the same from the same fast layers of a scene."""
        return self.rastered, self.wants_seen, self.hidden, self.color_lines, self.color_least

    @cached_property
    def wants_specular(self) -> bool:
        """Whether anything looks at highlights."""
        return self.any("use_hatching") or self.wants_parts

    @cached_property
    def wants_gloss(self) -> bool:
        """Whether metals and what is glazed are treated apart."""
        return any((values["use_shading"] and (values["reflection_tones"] or values["highlight_shape"]))
                   or (values["use_tones"] and max(values["tone_black"], values["tone_dark"])) for values in self.every)

    @cached_property
    def wants_parts(self) -> bool:
        """Whether parts of what is not diffuse light are to be other than they were rendered."""
        if not self.every[0]["other_light"]:
            return False
        weights = "other_background", "other_highlights", "other_reflections", "other_glow"
        return any(values["use_shading"] and (values["highlight_shape"] or any(values[id_] != 1 for id_ in weights))
                   for values in self.every)

    @cached_property
    def sticks(self) -> bool:
        """Whether anything that is drawn sticks to surfaces."""
        fine = self.every[0]["edge_detector"] == "FINE"
        return any(fills_surfaces(values) or values["use_example"] or values["use_wash"]
                   or values["use_gouache"]
                   or (fine and sticking_pens(values)) for values in self.every)

    @cached_property
    def wants_anchor(self) -> bool:
        """Whether anything sticks to surfaces, if only which lines are left out, or is to be able to."""
        fine = self.every[0]["edge_detector"] == "FINE"
        return (self.every[0]["save_rest"] == "ON" or self.sticks
                or (fine and any(leaves_out_lines(values) for values in self.every)))

    @cached_property
    def lies_flat(self) -> bool:
        """Whether tones that are drawn lie on things' sheets."""
        return any(fills_sheets(values) for values in self.every)

    @cached_property
    def wants_card(self) -> bool:
        """Whether tones lie on things' sheets, or are to be able to."""
        return self.every[0]["save_rest"] == "ON" or self.lies_flat

    @cached_property
    def follows_uv(self) -> bool:
        """Whether strokes that are drawn follow UV maps."""
        return any(strokes_along_uv(values) for values in self.every)

    @cached_property
    def wants_tangent(self) -> bool:
        """Whether strokes follow UV maps, or are to be able to."""
        return self.every[0]["save_rest"] == "ON" or self.follows_uv

    @cached_property
    def rastered(self) -> tuple[str, ...]:
        """Names of the pictures of meshes that are drawn only where something wants them."""
        wanted = {"anchor": self.wants_anchor, "tangent": self.wants_tangent, "card": self.wants_card}
        return tuple(name for name, there in wanted.items() if there)

    def turns(self, frame: int) -> frozenset[tuple[int, int]]:
        """Which drawing of theirs pens have come to that draw lines anew while an animation runs: equal for frames
        that differ by nothing else and are drawn alike."""
        holds = {values[f"{pen}_hold"] for values in self.every if values["use_lines"] for pen in pens(values)}
        return frozenset((hold, frame // hold) for hold in holds if hold)

    @cached_property
    def wants_seen(self) -> bool:
        """Whether lines are drawn in what mirrors and glass show."""
        return self.every[0]["edge_detector"] == "FINE" and self.any("line_mirror_strength") and self.wants_edges

    @cached_property
    def cleans_seen(self) -> bool:
        """Whether what mirrors and glass show is to be denoised, where it is rendered."""
        return self.every[0]["light_denoise"] == "OIDN" and self.wants_seen

    def idle(self, pictures: Mapping[str, np.ndarray]) -> dict[str, str]:
        """{weight: why} of the sources of edges that are asked for and find nothing in the layers of a picture."""
        if not self.wants_edges:
            return {}

        def alike(layer):
            picture = pictures.get(layer)
            return picture is None or bool((picture == picture[0, 0]).all())

        colors = "combined" if self.every[0]["color_layer"] == "LIT" else "albedo"
        reasons = {
            "line_outline_strength": alike("object") and "one index everywhere",
            "line_material_strength": alike("material") and "one index everywhere",
            "line_inner_strength": alike("depth") and "one depth everywhere",
            "line_crease_strength": alike("normal") and "one normal everywhere",
            "line_color_strength": alike(colors) and "one color everywhere",
            "line_shadow_strength": alike("diffuse") and "the same light everywhere",
            "line_mirror_strength": self.wants_seen and "seen_normal" not in pictures
            and "no passes that see into mirrors",
        }
        return {name: why for name, why in reasons.items() if why and self.any(name)}
