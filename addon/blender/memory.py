# SPDX-License-Identifier: GPL-3.0-or-later
"""The last render's layers stay in memory, so that another setting is drawn at once, without Cycles (redraw.py).

Only where there is a window. What the layers can't show, as they were rendered without it, is refused with a sentence.
"""

import hashlib
from dataclasses import dataclass, field

import bpy
import numpy as np

from ..pen import layers, saved
from ..pen.errors import EncreError
from ..pen.settings import Settings
from . import cameras, properties, versions

_MOST_FOUND = 6  # pictures of a view that are kept besides its passes

_kept = {}  # scene's name -> Picture


@dataclass
class View:
    """What is kept of a view of a view layer. Pictures have row 0 at the top."""

    passes: dict  # what the stages read, by classic names
    shown: dict   # what the render result has, by the names in this Blender
    maps: dict    # what the rasteriser drew
    found: dict = field(default_factory=dict)  # what was denoised, and light that was drawn, by what it was made of

    def again(self, changing):
        """The passes, to be popped. changing: whether their pixels will be changed."""
        return {name: picture.copy() if changing else picture for name, picture in self.passes.items()}

    def noting(self, write):
        """write(), which is noted."""
        def note(name, picture):
            self.shown[name] = picture
            write(name, picture)
        return note

    def once(self, kind, make, *given):
        """make(*given), a picture, made once of the same. given: pictures, which count by their pixels."""
        key = kind, *(hashlib.blake2b(np.ascontiguousarray(picture), digest_size=16).digest() for picture in given)
        if key not in self.found:
            while len(self.found) >= _MOST_FOUND:
                del self.found[next(iter(self.found))]
            self.found[key] = make(*given)
        return self.found[key]

    def nearest(self, picture, *guides):
        """The picture without its noise as it was last cleaned, by whatever scale; itself if it never was."""
        key = tuple(hashlib.blake2b(np.ascontiguousarray(one), digest_size=16).digest() for one in (picture, *guides))
        return next((found for of, found in reversed(self.found.items()) if of[1:] == key), picture)


@dataclass
class Layer:
    """What is kept of a view layer."""

    before: object  # what was known of it before Cycles rendered: frame.py
    denoised: bool  # whether Cycles' denoiser is on where light is not cut into levels
    opened: bool = False  # whether a file has told it, whose settings are in it as they were
    views: dict = field(default_factory=dict)  # view id -> View

    def lacks(self, new: Settings):
        """What must be rendered before the picture can be drawn with other settings; None: nothing."""
        old = self.before.settings
        changed = {
            "Render": new.fast != old.fast,
            "Supersample": old.factor != new.factor,
            "Light": old.draws_light != new.draws_light and not new.fast,
            "World Shadows": (new.draws_light or new.fast) and old.shadows_world != new.shadows_world,
            "Planes": (new.draws_light or new.fast) and old.planes != new.planes,
            "Flat Colors": new.fast and old.flat != new.flat,
            "Smooth Facets": old.facets != new.facets,
            "Sky Colors": old.sky_colors != new.sky_colors,
            "Object Index": old.every[0]["object_index"] != new.every[0]["object_index"],
            "what sticks to surfaces": new.wants_anchor and not old.wants_anchor,
            "Colors": new.fast and new.color_lines is not None and old.color_lines != new.color_lines,
            "flat tones": new.wants_card and not old.wants_card,
            "strokes along UV": new.wants_tangent and not old.wants_tangent,
        } if not self.opened else {}  # what a file lacks is said as it is opened
        changed |= {
            "the list of styles": [name for name, _ in old.styles] != [name for name, _ in new.styles],
            "Lines": new.wants_edges and not old.wants_edges,
            "Hidden Lines": new.hidden > old.hidden,
            "what mirrors show": new.wants_seen and not old.wants_seen,
            "Shading": self.denoised and old.shaded != new.shaded,
        }
        return next((name for name, differs in changed.items() if differs), None)


@dataclass
class Picture:
    """What is kept of a scene's render."""

    frame: int
    size: tuple
    values: tuple  # settings that were drawn last, of the scene as the user has it
    layers: dict = field(default_factory=dict)  # view layer's name -> Layer

    @property
    def fast(self):
        """Whether views hold the layers themselves, as Encre drew them or a file had them, and not Cycles' passes."""
        return any(layer.opened or layer.before.settings.fast for layer in self.layers.values())

    def layer(self, name, settings: Settings):
        """The Layer of a view layer's name, to be drawn with these settings. EncreError: it can't be."""
        kept = self.layers.get(name)
        if lack := kept.lacks(settings) if kept else f"view layer {name}":
            raise EncreError(f"{lack} needs layers that are not in memory; render the picture")
        return kept

    @property
    def bytes(self):
        pictures = {}
        for layer in list(self.layers.values()):  # lists, because a render's thread may add to them
            for view in list(layer.views.values()):
                for some in (view.passes, view.shown, view.maps, view.found):
                    arrays = [a for a in list(some.values()) if isinstance(a, np.ndarray)]
                    pictures.update((id(a), a.nbytes) for a in (a if a.base is None else a.base for a in arrays))
        return sum(pictures.values())


def ours(name):
    """Whether the stages fill a pass."""
    return name in layers.DRAWN or name in saved.passes()


def _size(scene):
    return *cameras.border(scene.render), scene.render.use_border and not scene.render.use_crop_to_border


def values(scene):
    """What is drawn by, of a scene as the user has it; two that are equal are drawn alike."""
    return properties.scene_values(scene), properties.styles(scene)


def wanted(engine, scene):
    """Whether what is rendered is to be kept. scene: as the user has it."""
    return (not bpy.app.background and not engine.is_preview and not engine.is_animation
            and scene.encre.keep_layers)


def begin(scene, layer):
    """Keeps a Layer of a scene, which gets its views when they are drawn."""
    if scene.name not in _kept:
        _kept[scene.name] = Picture(scene.frame_current, _size(scene), values(scene))
    _kept[scene.name].layers[layer.before.name] = layer


def picture(scene):
    """The Picture that is kept of a scene; None: none is."""
    return _kept.get(scene.name)


def size(scene):
    """How many bytes are kept of a scene; 0 = nothing is."""
    return _kept[scene.name].bytes if scene.name in _kept else 0


def any_kept():
    return bool(_kept)


def forget():
    _kept.clear()


def refusal(scene, names):
    """Why a scene's picture can't be drawn again; None: it can. names(view layer): the passes that it would have."""
    picture = _kept.get(scene.name)
    if not picture or not picture.layers:
        return "no layers are in memory: render the picture"
    if picture.frame != scene.frame_current:
        return f"the layers in memory are of frame {picture.frame}: go there, or render this one"
    if picture.size != _size(scene):
        return "the size has changed: render the picture"
    if _renders_others(scene):
        return "the compositor or the sequencer takes other scenes too: render the picture"
    try:
        settings = properties.settings(scene)
    except EncreError as error:
        return str(error)
    rendered = [layer for layer in scene.view_layers if layer.use]
    if scene.render.use_single_layer:
        rendered = [window.view_layer for window in bpy.context.window_manager.windows if window.scene == scene]
    for layer in rendered:
        kept = picture.layers.get(layer.name)
        if not kept or not kept.views:
            return f"view layer {layer.name} is not in memory: render the picture"
        shown = next(iter(kept.views.values())).shown
        # Of passes that Encre does not draw itself there is nothing in a fast picture, asked for or not.
        if not picture.fast and any(name not in shown and not ours(name) for name in names(layer)):
            return f"view layer {layer.name} has other passes now: render the picture"
        if lack := kept.lacks(settings):
            return f"{lack} has changed and needs other layers: render the picture"
    return None


def _renders_others(scene):
    if scene.render.use_sequencer and scene.sequence_editor and versions.strips(scene.sequence_editor):
        return True
    tree = versions.compositor(scene)
    return bool(tree) and any(node.bl_idname == "CompositorNodeRLayers" and node.scene not in (None, scene)
                              for node in tree.nodes)
