# SPDX-License-Identifier: GPL-3.0-or-later
"""The library's parameter table as Blender properties: scene.encre, and encre on objects, materials and view layers.

Every reading function takes evaluated data, so that keyframes and drivers count.
"""

import functools
from dataclasses import dataclass

import bpy
import numpy as np

from ..pen import layers, library, slots
from ..pen.params import PENS
from ..pen.settings import Settings, switches
from . import overrides, pens, versions
from .languages import OURS

LENGTHS = {"factor": "FACTOR", "length": "DISTANCE"}
_STEPS = {"px": 50, "angle": 100, "degrees": 100}  # hundredths: what a click on a number's arrow adds
# Linked objects and materials keep it in overrides; scenes can't be overridden. A group counts with its pointer only.
_OVERRIDABLE = {"LIBRARY_OVERRIDABLE"}


def _changed(_self, _context):
    """Blender tells views that a script has set a property only of those that have an update, be it empty."""


def _common(p):
    return {"name": p.label, "description": tooltip(p), "update": _changed, **OURS}


def tooltip(p, words=str):
    """What a parameter does, and what must be on for it to do anything; words(text): in another language."""
    needs = []
    for term in filter(None, p.enabled_if.split("&")):
        id_, _, items = term.lstrip("!").partition("=")
        other = library.params()[id_]
        label, names = words(other.label), {item.id: item.label for item in other.items}
        of = " / ".join(words(names[item]) for item in items.split("|")) if items else ""
        needs.append(f"{label}: {of}" if items else f"{words('no')} {label}" if term.startswith("!") else label)
    return f"{words(p.help)}. {words('Needs')} {', '.join(needs)}" if needs else words(p.help)


def _limits(p):
    out = {"min": p.hard_min, "soft_min": p.soft_min, "soft_max": p.soft_max}
    return out if p.hard_max is None else {**out, "max": p.hard_max}


def _property(p):
    """The bpy.props definition of a parameter."""
    if p.type == "bool":
        return bpy.props.BoolProperty(default=p.default, **_common(p))
    if p.type == "int":
        limits = {k: int(v) for k, v in _limits(p).items()}
        return bpy.props.IntProperty(default=p.default, **limits, **_common(p))
    if p.type == "float":
        return bpy.props.FloatProperty(default=p.default, subtype=LENGTHS.get(p.unit, "NONE"),
                                       precision=2 if p.unit in _STEPS else 3, step=_STEPS.get(p.unit, 3),
                                       **_limits(p), **_common(p))
    if p.type == "enum":
        if p.items and p.items[0].id in PENS:  # items that change want a number
            return bpy.props.EnumProperty(items=pens.items(p), default=p.number[p.default], **_common(p))
        items = [(x.id, x.label, x.help, x.number) for x in p.items]
        return bpy.props.EnumProperty(items=items, default=p.default, **_common(p))
    if p.type == "color":
        return bpy.props.FloatVectorProperty(size=3, subtype="COLOR", default=p.default, min=0.0, soft_max=1.0,
                                             **_common(p))
    if p.type == "image":
        return bpy.props.PointerProperty(type=bpy.types.Image, **_common(p))
    return bpy.props.CollectionProperty(type=_level_class(), name=p.label, description=p.help, **OURS)


def _class(name, annotations):
    return type(name, (bpy.types.PropertyGroup,), {"__annotations__": annotations})


def _tone(level):
    return [min(1.0, level.intensity * c) for c in level.color]


@functools.cache
def _level_class():
    """One level of discrete light; `tone` shows what it looks like."""
    number = functools.partial(bpy.props.FloatProperty, update=_changed)
    return _class("EncreLevel", {
        "intensity": number(name="Intensity", description="Brightness of this level", default=1.0,
                            min=0.0, soft_max=2.0),
        "threshold": number(name="Threshold", description="Light at which this level begins",
                            default=0.5, min=0.0, soft_max=2.0),
        "transition": number(name="Transition", description="Width over which this level blends with the one below",
                             default=0.025, min=0.0, soft_max=1.0),
        "color": bpy.props.FloatVectorProperty(name="Color", description="Color of this level's light", size=3,
                                               subtype="COLOR", default=(1, 1, 1), min=0.0, soft_max=1.0,
                                               update=_changed),
        "tone": bpy.props.FloatVectorProperty(name="Tone", description="A white surface at this level", size=3,
                                              subtype="COLOR", min=0.0, max=1.0, get=_tone),
    })


@dataclass(frozen=True)
class Own:
    """A setting that an object or a material has for itself: one row below makes its property and its place in the
    panels. Whoever needs it reads block.encre.<id>."""

    id: str
    # "control" -1..1, "degrees" -180..180, "share" 0..1, "style" the name of one of the scene's, "text", "bool"
    kind: str
    label: str
    help: str
    owners: tuple[str, ...] = ("object", "material")
    default: float = 0.0
    of: str = ""  # the kind of empty that alone has it

    def property(self):
        about = {"name": self.label, "description": self.help, "override": _OVERRIDABLE, "update": _changed, **OURS}
        if self.kind == "control":
            return bpy.props.FloatProperty(default=0.0, min=-1.0, max=1.0, **about)
        if self.kind == "degrees":
            return bpy.props.FloatProperty(default=0.0, min=-180.0, max=180.0, soft_min=-90.0, soft_max=90.0, **about)
        if self.kind == "share":
            return bpy.props.FloatProperty(default=self.default, min=0.0, max=1.0, subtype="FACTOR", **about)
        return bpy.props.BoolProperty(**about) if self.kind == "bool" else bpy.props.StringProperty(**about)


def own_settings(owner):
    """The Own of an "object" or a "material", in the order in which panels show them."""
    rows = [
        Own("style", "style", "Style",
            "Style that this surface uses. The style of the object counts more than that of the material"),
        *(Own(control.name, "control", control.label, "Added to the painted control of the same name")
          for control in library.controls().values()),
        Own("line_group", "text", "Line Group", "Objects of the same group have no outlines between them",
            ("object",)),
        Own("mark", "bool", "Line Marks", "The edges of this curve, or of this mesh without faces, are drawn as lines "
            "by hand where no surface hides them", ("object",)),
        Own("separate_parts", "bool", "Separate Parts", "Parts of the mesh that no face joins have outlines between "
            "them, as objects have: also where they pass through each other", ("object",)),
        Own("crease_offset", "degrees", "Crease Offset", "Degrees that are added to the bend of every edge of this "
            "mesh: above 0 it has more creases, below 0 fewer", ("object",)),
        Own("bend_light", "share", "Bend Light", "How much drawn light falls on what is inside this empty as on the "
            "empty's own sphere. Nothing inside throws shadows there", ("object",), of="SPHERE"),
        Own("bend_fade", "share", "Fade", "Over which share of the radius this begins, from the surface inward",
            ("object",), 0.2, "SPHERE"),
    ]
    return [own for own in rows if owner in own.owners]


# What switches a pass of ours on, as a view layer's use_pass_z does Cycles'.
PASSES = {f"use_pass_{name.split()[-1].lower()}": name for name in layers.DRAWN}


def _pass_switch(name):
    def requery(self, _context):
        for layer in self.id_data.view_layers:  # the compositor's Render Layers nodes get or lose a socket
            layer.update_render_passes()

    help_ = library.load().output_help[name]
    return bpy.props.BoolProperty(name=name.split()[-1], description=f"{help_[0].upper()}{help_[1:]}", update=requery,
                                  **OURS)


def _shines_one_way(_self, obj):
    return obj.type == "LIGHT" and obj.data.type != "POINT"


def _keep(self, _context):
    from . import memory

    if not self.keep_layers:
        memory.forget()


def _lists():
    """What the lists of pens and tones have of a scene. A list wants a collection, and that of an enum's items is there
    in every scene, touched or not; nobody sets the enum."""
    found = {}
    for kind, every in slots.KINDS.items():
        items = [(slot.id, slot.label, "") for slot in every()]
        found[f"{kind}_slots"] = bpy.props.EnumProperty(items=items, options={"HIDDEN"}, update=_changed)
        found[f"active_{kind}"] = bpy.props.IntProperty(options={"HIDDEN"}, update=_changed, min=0)
    return found


def _style_renamed(style, _context):
    """No two styles have one name, none has an empty one, and what used a style goes on doing so, as with Blender's
    vertex groups."""
    free = pens.free(style.name.strip() or style.called or "Style",
                     {other.name for other in style.id_data.encre.styles if other != style})
    if free != style.name:
        style.name = free  # which calls this again
        return
    was, style.called = style.called, style.name
    if was and not any(was in scene.encre.styles for scene in bpy.data.scenes):
        for block in (*bpy.data.objects, *bpy.data.materials):
            if block.encre.style == was and not block.library:
                block.encre.style = style.name


@functools.cache  # 3.4 never lets go of a class that was registered: the same ones, then, each time
def _classes():
    """{owner: its class}, and what these are made of before them, in the order in which they register."""
    from . import front  # which reads and sets what is defined here

    params = library.params().values()
    style = _class("EncreStyle", {
        "name": bpy.props.StringProperty(name="Name", default="Style", update=_style_renamed),
        "called": bpy.props.StringProperty(options={"HIDDEN"}, update=_changed),  # what its users know
        **{p.id: _property(p) for p in params if p.scope == "surface"},
        "active_level": bpy.props.IntProperty(options={"HIDDEN"}, update=_changed),
    })
    scene = _class("EncreScene", {
        **{p.id: _property(p) for p in params},
        "styles": bpy.props.CollectionProperty(type=style, name="Styles"),
        "active_style": bpy.props.IntProperty(options={"HIDDEN"}, update=_changed),
        **pens.definitions(_changed),
        **_lists(),
        **front.definitions(),
        "ink_early": bpy.props.BoolProperty(
            name="Ink While Rendering", default=True, update=_changed, **OURS,
            description="While Full renders in a window, show the picture inked as it grows, every few seconds"),
        "samples": bpy.props.IntProperty(
            name="Samples", default=overrides.SAMPLES, min=0, soft_max=256, update=_changed, **OURS,
            description="Most samples that Full takes for each pixel: flat light and lines need few. Cycles' own "
            "number counts if it is lower. 0: as many as in Cycles' settings"),
        "keep_layers": bpy.props.BoolProperty(
            name="Keep Layers", default=True, update=_keep, **OURS,
            description="Keep what F12 has rendered in memory, so that changes are drawn without another render"),
        "auto_redraw": bpy.props.BoolProperty(
            name="Redraw Automatically", default=True, update=_changed, **OURS,
            description="Draw the last render again whenever a setting changes, while an image editor shows it"),
        "rim_lamp": bpy.props.PointerProperty(
            name="From Lamp", type=bpy.types.Object, poll=_shines_one_way, update=_changed, **OURS,
            description="Sun, spot or area lamp from which the rim light comes, instead of from the angle above"),
        # Id of the last one: rows are reset to its values.
        "preset": bpy.props.StringProperty(options={"HIDDEN"}, update=_changed),
        # Of the settings in a file: migration.py.
        "version": bpy.props.IntProperty(options={"HIDDEN"}, update=_changed),
        "active_level": bpy.props.IntProperty(options={"HIDDEN"}, update=_changed),
        "viewport_scale": bpy.props.IntProperty(
            name="Viewport Scale", description="Resolution of the picture in rendered 3D views, as a share of the "
            "view. While something moves it may be lower", subtype="PERCENTAGE",
            default=100, min=10, max=100, soft_min=25, update=_changed, **OURS),
    })
    material = _class("EncreMaterial", {own.id: own.property() for own in own_settings("material")})
    obj = _class("EncreObject", {own.id: own.property() for own in own_settings("object")})
    layer = _class("EncreViewLayer", {id_: _pass_switch(name) for id_, name in PASSES.items()})
    return {"level": _level_class(), "style": style, "Scene": scene, "Material": material, "Object": obj,
            "ViewLayer": layer, "View3DShading": _view_class()}


def _view_class():
    """What a rendered 3D view shows."""
    from . import looks

    def redraw(_self, context):
        for window in context.window_manager.windows:
            for area in window.screen.areas:
                if area.type == "VIEW_3D":
                    area.tag_redraw()

    return _class("EncreView", {
        "source": bpy.props.EnumProperty(name="View", description="What draws the rendered view", update=redraw, items=[
            ("ENCRE", "Encre", "Encre's own fast view, with ink"),
            ("CYCLES", "Cycles", "Cycles' own view, without ink")], **OURS),
        "show": bpy.props.EnumProperty(name="Show", description="What the view shows", update=redraw, items=[
            ("FINAL", "Final", "The finished picture"),
            ("INK", "Ink", "The lines alone, on white"),
            ("EDGES", "Sources", "Each kind of line in a color of its own"),
            ("LEVELS", "Levels", "The levels of light, on white surfaces"),
            ("STYLES", "Styles", "A color for each style, gray for the scene's own"),
            ("CONTROL", "Control", "A control: red where it is most, blue where least, gray where neutral")], **OURS),
        "look": bpy.props.EnumProperty(
            name="Look", description="The look in which this view shows the scene. The scene stays as it is, and other "
            "views may show other looks", update=redraw, items=[
                ("SCENE", "Scene", "The scene's own settings"),
                ("PLAIN", "Plain", "The plain picture, with nothing drawn"),
                *looks.named()], **OURS),
        "control": bpy.props.EnumProperty(
            name="Control", description="The control that is shown", update=redraw,
            items=[(control.name, control.label, "") for control in library.controls().values()], **OURS),
    })


_OWNERS = {"View3DShading": {}, "Scene": {}, "ViewLayer": {}, "Material": {"override": _OVERRIDABLE},
           "Object": {"override": _OVERRIDABLE}}


def register():
    classes = _classes()
    for cls in classes.values():
        bpy.utils.register_class(cls)
    for owner, more in _OWNERS.items():
        getattr(bpy.types, owner).encre = bpy.props.PointerProperty(type=classes[owner], **more)


def unregister():
    for owner in _OWNERS:
        del getattr(bpy.types, owner).encre
    for cls in reversed(_classes().values()):
        bpy.utils.unregister_class(cls)


# ---- reading -----------------------------------------------------------------------------------------------------


def levels(group):
    """The levels of a scene or style as library.check takes them; an untouched list is the default."""
    rows = [(v.intensity, v.threshold, v.transition, *v.color) for v in group.shade_levels]
    return [(rows[0][0], 0.0, 0.0, *rows[0][3:]), *rows[1:]] if rows else library.params()["shade_levels"].default


def level_count(group):
    """How many levels of light a scene or style has."""
    return len(group.shade_levels) or len(library.params()["shade_levels"].default)


def tones_of_blacks(group):
    """How many tones are not of levels of light: one, where only small blacks are spotted."""
    return int(getattr(group, "tone_black_widest", 0) > 0)


def tone_count(group):
    return tones_of_blacks(group) + level_count(group)


def image_key(image):
    """How settings name a Blender image: its file, or its name where it has none."""
    return bpy.path.abspath(image.filepath, library=image.library) if image.filepath else image.name


def value_of(group, p):
    """The value of one parameter of a scene's or a style's group."""
    value = getattr(group, p.id)
    if p.type == "color":
        return tuple(value)
    if p.type == "image":
        return image_key(value) if value else None
    return levels(group) if p.type == "levels" else value


def scene_values(scene):
    """{id: value} of every parameter of the scene."""
    values = {p.id: value_of(scene.encre, p) for p in library.params().values()}
    lamp = scene.encre.rim_lamp
    if lamp and _shines_one_way(None, lamp):
        x, y, z = lamp.matrix_world.to_3x3().col[2].normalized()  # it shines along -z
        values |= {"rim_space": "WORLD", "rim_angle": float(np.degrees(np.arctan2(y, x))),
                   "rim_elevation": float(np.degrees(np.arcsin(np.clip(z, -1, 1))))}
    return values


def stores(group, p):
    """Whether a style changes this parameter, or a scene has had it set."""
    if p.type in ("levels", "image"):  # a pointer counts as set once it was looked at
        return bool(getattr(group, p.id))
    return group.is_property_set(p.id)


def _own_params(group):
    """The parameters that a scene's or a style's group has."""
    return [p for p in library.params().values() if hasattr(group, p.id)]


def stored(group):
    """{id: value} of what a style changes or a scene has had set."""
    return {p.id: value_of(group, p) for p in _own_params(group) if stores(group, p)}


def has(group, p, value):
    """Whether a parameter has this value, as the single floats that are kept."""
    mine = value_of(group, p)
    if p.type not in ("float", "color", "levels"):
        return mine == value
    if p.type == "levels":  # all numbers of each, of the first no threshold and transition
        mine, value = ([x for k, v in enumerate(rows) for x in (v[0], *(v[1:3] if k else ()), *(v[3:] or (1, 1, 1)))]
                       for rows in (mine, value))
    return np.array_equal(np.float32(mine), np.float32(value))


def styles(scene):
    """[(name, {id: value} that it changes)]; style number k is the k-th, 0 the scene's own parameters."""
    return [(s.name, stored(s)) for s in scene.encre.styles]


def unknown(scene):
    """Names of what a scene and its styles keep that no setting is called, as by another version of Encre."""
    return sorted({name for group in (scene.encre, *scene.encre.styles) for name in group.keys()  # noqa: SIM118 - no dict
                   if name not in group.bl_rna.properties})


def active(scene):
    """Settings.active without all the others, which are many to read."""
    return any(getattr(group, switch) for switch in switches() for group in (scene.encre, *scene.encre.styles)
               if group == scene.encre or group.is_property_set(switch))


def settings(scene):
    """The Settings of a scene. EncreError: they can't be used."""
    return Settings(scene_values(scene), styles(scene), versions.working_space())


def style_number(block, scene):
    """Number of the style that an object or a material names, 0 if it names none of the scene's."""
    return scene.encre.styles.find(block.encre.style) + 1 if block and block.encre.style else 0


def controls(block):
    """The controls of an object or a material, each -1..1; None counts as neutral."""
    return tuple(getattr(block.encre, name) if block else 0.0 for name in library.controls())


# ---- writing -----------------------------------------------------------------------------------------------------


def set_value(group, id_, value):
    """Sets a parameter of a scene's or style's group to a checked value."""
    p = library.params()[id_]
    if p.type == "image":
        found = bpy.data.images.get(value) or bpy.data.images.load(value, check_existing=True) if value else None
        setattr(group, id_, found)
    elif p.type == "levels":
        group.shade_levels.clear()
        for k, level in enumerate(value):
            row = group.shade_levels.add()
            row.intensity = level[0]
            if len(level) > 1 and k:
                row.threshold, row.transition = level[1:3]
            row.color = level[3:] if len(level) == 6 else (1, 1, 1)
    else:
        setattr(group, id_, value)


def unset_value(group, id_):
    """Gives a scene's parameter its default again, a style's the scene's value."""
    if library.params()[id_].type == "levels":
        group.shade_levels.clear()
    group.property_unset(id_)


def set_values(group, values):
    """Sets what a group has of checked values. Returns the names of images that are not there."""
    missing = []
    for id_, value in values.items():
        if hasattr(group, id_):
            try:
                set_value(group, id_, value)
            except RuntimeError:
                missing.append(value)
    return missing


def replace(group, values):
    """Gives a group these values and no others. Returns the names of images that are not there."""
    for p in _own_params(group):
        if p.id not in values:
            unset_value(group, p.id)
    return set_values(group, values)
