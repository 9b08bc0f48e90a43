# SPDX-License-Identifier: GPL-3.0-or-later
"""What the front panel says of several parameters at once. Each property here reads parameters of the scene and sets
them, and keeps nothing itself: what a look sets is seen here, and what is set here is seen in the panels below.

A slider follows one parameter; the others that it sets keep the proportion to it that the scene's look gives them.
"""

import math

import bpy

from ..pen import library
from ..pen.params import PENS, TONES
from . import looks, properties, thumbnails
from .languages import OURS, n_

# Of lines: (name, tooltip, parameters that are all above 0 where they are drawn, others that go with them).
TOGGLES = {
    "outlines": (n_("Outlines"), "Lines between an object and what is behind or beside it: its contour",
                 ("line_outline_strength", "line_outline_width"), ()),
    "contacts": (n_("Contacts"), "Outlines where an object touches another one; their width is a share of that of "
                 "outlines", ("line_contact_width",), ()),
    "inner": (n_("Inner"), "Inner lines: where one part of a thing hides another, and folds of smooth forms",
              ("line_inner_strength", "line_inner_width"), ("line_suggestive_strength",)),
    "creases": (n_("Creases"), "Lines where a surface bends by Crease Angle or more",
                ("line_crease_strength", "line_crease_width"), ()),
    "intersections": (n_("Intersections"), "Lines where pieces of a mesh pass through each other; their width is a "
                      "share of that of creases", ("line_intersection_width",), ()),
    "folds": (n_("Folds"), "Lines where a smooth form nearly turns away, suggestive contours: a nose, lips, cloth",
              ("line_suggestive_strength", "line_suggestive_width"), ()),
    "materials": (n_("Materials"), "Lines between materials", ("line_material_strength", "line_material_width"), ()),
    "colors": (n_("Colors"), "Lines between colors, as of patterns and letters", ("line_color_strength",
                                                                                  "line_color_width"), ()),
    "shadows": (n_("Shadows"), "Shadow edges: lines between light and shadow", ("line_shadow_strength",
                                                                                "line_shadow_width"), ()),
    "mirrors": (n_("Mirrors"), "Lines in what mirrors and clear glass show", ("line_mirror_strength",
                                                                              "line_mirror_width"), ()),
    "marks": (n_("Marks"), "Edges that you have marked, as Freestyle edges, and strokes by hand",
              ("line_mark_strength", "line_mark_width"), ()),
    "hidden": (n_("Hidden"), "Hidden lines: what lies behind other things, as if these were of glass",
               ("line_hidden_strength", "line_hidden_width"), ())}
SHOWN = "outlines", "inner", "creases", "colors", "shadows", "marks"  # in the front panel
_BY_WIDTH = "outlines", "contacts", "inner", "intersections"  # without the edge itself another would be found there
_SHORT = {"line_shortest": 1.0, "line_color_shortest": 8.0, "line_shadow_shortest": 20.0, "line_mirror_shortest": 4.0}
_SHORTEST = 12.0  # px, in the middle of Small Lines
_HAND = {"wobble": 1.0, "pressure": 0.3, "rough": 0.5}
_LOOSEST = 3.0    # px that a hand strays
_SAME = 0.995     # of Far Away, from where on all is as wide
_SOFTEST = 0.3    # of the light, over which a step is soft
_DARK = 0.85      # levels that are darker have no room between dots
_PATTERNS = ("DOTS", "LINES", "CROSS", "GRAIN", "HATCH", "STIPPLE", "IMAGE")
FILLS = (
    ("FLAT", n_("Flat"), "One flat tone for each step of light"),
    ("PENCIL", n_("Pencil"), "Pencil rubbed over the paper"),
    ("DOTS", n_("Dots"), "Screentone: dots, larger where it is darker"),
    ("LINES", n_("Lines"), "Parallel lines, wider where it is darker"),
    ("HATCH", n_("Hatching"), "Strokes along the form, crossing where it is darker"),
    ("STIPPLE", n_("Stipple"), "Spots set by hand"),
    ("BLACK", n_("Black"), "The darkest step is solid ink, as in brush and ink"))
SIDES = {"ALL": None, "LEFT": 180.0, "TOP_LEFT": 135.0, "TOP": 90.0, "TOP_RIGHT": 45.0, "RIGHT": 0.0}


def _base(settings, id_):
    """What the scene's look has for a parameter, or its default."""
    preset = looks.current(settings.id_data)
    return (preset.values if preset else {}).get(id_, library.params()[id_].default)


# ---- lines -------------------------------------------------------------------------------------------------------


def _toggle(name):
    label, help_, drawn, more = TOGGLES[name]

    def read(self):
        return all(getattr(self, id_) > 0 for id_ in drawn)

    def write(self, on):
        if not on:
            for id_ in more:
                setattr(self, id_, 0.0)
        for id_ in (*drawn, *more):
            if on and id_ in drawn and not getattr(self, id_):
                setattr(self, id_, _base(self, id_) or 1.0)
            elif on and id_ in more:
                setattr(self, id_, _base(self, id_))
            elif not on and id_.endswith("_width") == (name in _BY_WIDTH):
                setattr(self, id_, 0.0)

    return bpy.props.BoolProperty(name=label, description=help_, get=read, set=write, options=set(), **OURS)


def _small_read(self):
    return max(0.0, 1 - math.sqrt(self.line_shortest / _SHORTEST) / 2)


def _small_write(self, share):
    length = _SHORTEST * (2 - 2 * share) ** 2
    base = _base(self, "line_shortest")
    for id_, usual in _SHORT.items():
        setattr(self, id_, length * (_base(self, id_) / base if base else usual))


def _hand_read(self):
    return min(1.0, self.pen_1_wobble / _LOOSEST)


def _hand_write(self, share):
    for pen in PENS.values():
        base = _base(self, f"{pen}_wobble")
        for what, usual in _HAND.items():
            each = _base(self, f"{pen}_{what}") / base if base else usual
            setattr(self, f"{pen}_{what}", _LOOSEST * share * each)


def _far_read(self):
    if not self.line_far_distance:
        return 1.0
    return min(max((math.log2(self.line_far_distance) + 1) / 4, 0.0), _SAME - 0.005)


def _far_write(self, share):
    if share >= _SAME:
        self.line_far_distance = 0.0
        return
    if not self.line_far_distance:
        self.line_far_thickest, self.line_far_thinnest = 1.0, 2.0
    self.line_far_unit, self.line_far_distance = "RELATIVE", 2 ** (4 * share - 1)


# ---- shade -------------------------------------------------------------------------------------------------------


def _own_levels(settings):
    """The scene's levels, of its own if they were the default ones."""
    if not settings.shade_levels:
        properties.set_value(settings, "shade_levels", library.params()["shade_levels"].default)
    return settings.shade_levels


def _steps_read(self):
    count = properties.level_count(self)
    return count if self.use_shading and count <= len(TONES) else 0


def _steps_write(self, count):
    """As many levels, evenly between the darkest and the brightest of the scene, or of its look where it has one."""
    self.use_shading = True
    rows = properties.levels(self)
    if len(rows) == 1:
        look = _base(self, "shade_levels")
        rows = look if len(look) > 1 else library.params()["shade_levels"].default
    first, last = rows[0], rows[-1]
    colors = [row[3:] or (1, 1, 1) for row in (first, last)]
    low, high = (rows[1][1], last[1]) if len(rows) > 1 else (0.5, 0.5)
    if count > 2 and low == high:
        low, high = low * 0.8, low * 1.2
    soft = last[2] if len(last) > 2 else 0.025
    found = []
    for k in range(count):
        t = k / (count - 1) if count > 1 else 1
        color = [a + t * (b - a) for a, b in zip(*colors, strict=True)]
        intensity = first[0] + t * (last[0] - first[0])
        if k == 0:
            found.append((intensity, 0.0, 0.0, *color))
        else:
            s = (k - 1) / (count - 2) if count > 2 else 0.5
            found.append((intensity, low + s * (high - low), soft, *color))
    properties.set_value(self, "shade_levels", found)


def _edge_read(self):
    rows = properties.levels(self)
    soft = max((row[2] for row in rows[1:]), default=0.0)
    return min(1.0, math.sqrt(soft / _SOFTEST))


def _edge_write(self, share):
    for level in list(_own_levels(self))[1:]:
        level.transition = _SOFTEST * share * share


# ---- tones -------------------------------------------------------------------------------------------------------


def _tones(settings):
    """The tone of each level, the darkest first. Where only small blacks are spotted, one before is theirs."""
    return TONES[properties.tones_of_blacks(settings):properties.tone_count(settings)]


def _filled(settings):
    """What fills each level, the darkest first."""
    return [getattr(settings, id_) for id_ in _tones(settings)]


def _fill_read(self):
    names = [name for name, _, _ in FILLS]
    if not self.use_tones:
        return names.index("PENCIL" if self.use_hatching else "FLAT")
    tones = _filled(self)
    pattern = next((tone for tone in tones if tone in _PATTERNS), "")
    if not pattern:
        return names.index("BLACK" if "SOLID" in tones else "FLAT")
    return names.index({"CROSS": "LINES", "GRAIN": "PENCIL", "IMAGE": "DOTS"}.get(pattern, pattern))


def _fill_write(self, number):
    kind = FILLS[number][0]
    self.use_tones, self.use_hatching = kind not in ("FLAT", "PENCIL"), kind == "PENCIL"
    if not self.use_tones:
        if kind == "FLAT" and self.surface == "PAPER":  # flat colors, as bare paper would have no shade at all
            self.surface = "SHADED"
        return
    if properties.level_count(self) == 1:
        _steps_write(self, 2)
    self.use_shading, tones = True, _tones(self)
    solid = len(tones) > 2 and getattr(self, tones[0]) == "SOLID"
    for k, id_ in enumerate(tones):
        if k == len(tones) - 1:
            setattr(self, id_, "NONE")
        elif kind == "BLACK":
            setattr(self, id_, "SOLID" if k == 0 else "NONE")
        elif k or not solid:
            setattr(self, id_, kind)
            lighten(self, k)


def lighten(settings, k):
    """Makes a level so light that what fills it is seen: dots that cover all are black."""
    rows = properties.levels(settings)
    if k < len(rows) and 1 - rows[k][0] + settings.tone_darkness > _DARK:
        _own_levels(settings)[k].intensity = max(0.0, 0.5 + settings.tone_darkness)


def _leading(settings):
    """The tone whose size the front shows."""
    tones = _tones(settings)
    return next((id_ for id_ in tones if getattr(settings, id_) in _PATTERNS), tones[0])


def _size_read(self):
    return getattr(self, f"{_leading(self)}_pitch")


def _size_write(self, size):
    for id_, tone in zip(_tones(self), _filled(self), strict=True):
        if tone in _PATTERNS:
            setattr(self, f"{id_}_pitch", size)


def _choice(id_):
    """What fills a level, as the list of tones has it: a pattern is seen at once."""
    p = library.params()[id_]

    def read(self):
        return p.number[getattr(self, id_)]

    def write(self, number):
        item = next(item.id for item in p.items if item.number == number)
        setattr(self, id_, item)
        if item in _PATTERNS:
            lighten(self, _tones(self).index(id_) if id_ in _tones(self) else len(TONES))

    items = [(x.id, x.label, x.help, x.number) for x in p.items]
    return bpy.props.EnumProperty(name=p.label, description=p.help, items=items, get=read, set=write, options=set(),
                                  **OURS)


# ---- rim light ---------------------------------------------------------------------------------------------------


def _side_read(self):
    if self.rim_spread >= 180:
        return 0
    if self.rim_space == "WORLD" or self.rim_lamp:
        return len(SIDES)
    return min(range(1, len(SIDES)), key=lambda k: abs((self.rim_angle - list(SIDES.values())[k] + 180) % 360 - 180))


def _side_write(self, number):
    if number >= len(SIDES):
        self.rim_space = "WORLD"
        self.rim_spread = min(self.rim_spread, 75.0)
        return
    angle, self.rim_space, self.rim_lamp = list(SIDES.values())[number], "PICTURE", None
    if angle is None:
        self.rim_spread = 180.0
    else:
        self.rim_angle, self.rim_spread = angle, 75.0


# ---- the look ----------------------------------------------------------------------------------------------------


_offered = []  # Blender wants the texts that it shows to be kept


def _looks(self, _context):
    found = looks.every()[0]
    names = [preset.id for preset in found]
    own = getattr(self, "preset", "")
    _offered[:] = [(preset.id, preset.name, preset.description, thumbnails.icon(preset.picture), k + 1)
                   for k, preset in enumerate(found)]
    if own not in names:
        _offered.insert(0, ("", n_("No look yet"), "The settings as they are", thumbnails.icon(None), 0))
    return _offered


def _look_read(self):
    return next((k + 1 for k, preset in enumerate(looks.every()[0]) if preset.id == self.preset), 0)


def _look_write(self, number):
    if number:
        looks.apply(self, looks.every()[0][number - 1])


def definitions():
    """{id: bpy.props definition} of what a scene has of these."""
    share = {"min": 0.0, "max": 1.0, "subtype": "FACTOR", "options": set(), **OURS}
    return {
        "look": bpy.props.EnumProperty(name="Look", description="A look sets everything that the picture's style is "
                                       "made of: lines, shade, tones, paint and paper", items=_looks, get=_look_read,
                                       set=_look_write, options=set(), **OURS),
        **{f"draw_{name}": _toggle(name) for name in TOGGLES},
        "small_lines": bpy.props.FloatProperty(
            name="Small Lines", description="How many short lines are drawn. 0: few, 1: all", get=_small_read,
            set=_small_write, **share),
        "hand": bpy.props.FloatProperty(
            name="Hand", description="How steady or loose the hand is that draws the lines. 0: as with a ruler, 1: a "
            "loose sketch", get=_hand_read, set=_hand_write, **share),
        "far_lines": bpy.props.FloatProperty(
            name="Far Away", description="Far lines: how thick the lines of distant things are. 0: much thinner, 1: as "
            "thick as near ones", get=_far_read, set=_far_write, **share),
        "shade_steps": bpy.props.EnumProperty(
            name="Shade Steps", description="How many steps of light and shadow there are. 1: no shadow",
            items=[(str(n), str(n), "", n) for n in range(1, len(TONES) + 1)], get=_steps_read, set=_steps_write,
            options=set(), **OURS),
        "shade_edge": bpy.props.FloatProperty(
            name="Shade Edge", description="How soft the edge of a shadow is. 0: hard, 1: soft", get=_edge_read,
            set=_edge_write, **share),
        "fill": bpy.props.EnumProperty(
            name="Fill Shade With", description="What fills light and shadow: flat tones, screentone, hatching "
            "or black", items=FILLS, get=_fill_read, set=_fill_write, options=set(), **OURS),
        "fill_size": bpy.props.FloatProperty(
            name="Size", description="Screentone size, dot size or spacing of hatching: from one to the next",
            get=_size_read, set=_size_write, min=0.02, soft_min=3, soft_max=30, max=1000, precision=1, options=set(),
            **OURS),
        **{f"{id_}_fill": _choice(id_) for id_ in TONES},
        "rim_side": bpy.props.EnumProperty(
            name="Side", description="From which side of the picture the rim light comes", get=_side_read,
            set=_side_write, options=set(), items=[
                ("ALL", "All", "All around the silhouette"), ("LEFT", "Left", "From the left"),
                ("TOP_LEFT", "Top Left", "From the top left"), ("TOP", "Top", "From above"),
                ("TOP_RIGHT", "Top Right", "From the top right"), ("RIGHT", "Right", "From the right"),
                ("WORLD", "World", "From a direction in the world or from a lamp: see the panel Rim Light below")],
            **OURS),
    }
