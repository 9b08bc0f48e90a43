# SPDX-License-Identifier: GPL-3.0-or-later
"""The last render's layers stay in memory, so that another setting is drawn at once, without Cycles.

Only where there is a window. A redraw is a render like any other for Blender, which composites its result: started by
an operator, marked here, and for the engine nothing but passes that are there already. What the layers can't show, as
they were rendered without it, is refused with a sentence. Settings that change redraw by themselves while the result is
seen in an image editor: a timer waits until they rest.
"""

import contextlib
import hashlib
from dataclasses import dataclass, field

import bpy
import numpy as np
from bpy.app.handlers import persistent

from ..pen import layers, saved
from ..pen.errors import EncreError
from ..pen.settings import Settings
from . import cameras, handlers, properties, versions

_MOST_FOUND = 4  # pictures of a view that are kept besides its passes
_REST = 0.12  # seconds without a change before a redraw

_kept = {}       # scene's name -> Picture
_asked = False   # whether the next render that begins is a redraw
_drawing = False  # whether the one that runs is


@dataclass
class View:
    """What is kept of a view of a view layer. Pictures have row 0 at the top."""

    passes: dict  # what the stages read, by classic names
    shown: dict   # what the render result has, by the names in this Blender
    maps: dict    # what the rasteriser drew
    found: dict = field(default_factory=dict)  # light that was denoised or drawn, by what it was made of

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


@dataclass
class Layer:
    """What is kept of a view layer."""

    before: object  # what was known of it before Cycles rendered: frame.py
    denoised: bool  # whether Cycles' denoiser is on where light is not cut into levels
    views: dict = field(default_factory=dict)  # view id -> View

    def lacks(self, new: Settings):
        """What must be rendered before the picture can be drawn with other settings; None: nothing."""
        old = self.before.settings
        changed = {
            "Layers": new.fast != old.fast,
            "Supersample": old.factor != new.factor,
            "Light": old.draws_light != new.draws_light and not new.fast,
            "Object Index": old.scene["object_index"] != new.scene["object_index"],
            "the list of styles": [name for name, _ in old.styles] != [name for name, _ in new.styles],
            "Lines": new.wants_edges and not old.wants_edges,
            "what sticks to surfaces": new.wants_anchor and not old.wants_anchor,
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
        """Whether Encre drew the layers itself."""
        return any(layer.before.settings.fast for layer in self.layers.values())

    def layer(self, name, settings: Settings):
        """The Layer of a view layer's name, to be drawn with these settings. EncreError: it can't be."""
        kept = self.layers.get(name)
        if lack := kept.lacks(settings) if kept else f"view layer {name}":
            raise EncreError(f"{lack} needs layers that are not in memory: render the picture")
        return kept

    @property
    def bytes(self):
        pictures = {}
        for layer in list(self.layers.values()):  # lists, because a render's thread may add to them
            for view in list(layer.views.values()):
                for some in (view.passes, view.shown, view.maps, view.found):
                    pictures.update((id(a), a.nbytes) for a in list(some.values()) if isinstance(a, np.ndarray))
        return sum(pictures.values())


def ours(name):
    """Whether the stages fill a pass."""
    return name in layers.DRAWN or name in saved.passes(True, True)


def _size(scene):
    return *cameras.border(scene.render), scene.render.use_border and not scene.render.use_crop_to_border


def _values(scene):
    return properties.scene_values(scene), properties.styles(scene)


def wanted(engine, scene):
    """Whether what is rendered is to be kept. scene: as the user has it."""
    return (not bpy.app.background and not engine.is_preview and not engine.is_animation
            and scene.encre.keep_layers)


def begin(scene, layer):
    """Keeps a Layer of a scene, which gets its views when they are drawn."""
    if scene.name not in _kept:
        _kept[scene.name] = Picture(scene.frame_current, _size(scene), _values(scene))
    _kept[scene.name].layers[layer.before.name] = layer


def again(scene):
    """The Picture that the render which runs draws again of a scene; None: it is to be rendered."""
    return _kept.get(scene.name) if _drawing else None


def size(scene):
    """How many bytes are kept of a scene; 0 = nothing is."""
    return _kept[scene.name].bytes if scene.name in _kept else 0


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


def start(window, quiet):
    """Has Blender render a window's scene anew, from what is kept. quiet: where the result is seen already, no editor
    is opened."""
    global _asked
    preferences, scene = bpy.context.preferences.view, window.scene
    before, done = preferences.render_display_type, ()
    _asked, _kept[scene.name].values = True, _values(scene)
    try:
        if quiet:
            preferences.render_display_type = "NONE"
        with bpy.context.temp_override(window=window):
            done = bpy.ops.render.render("INVOKE_DEFAULT")
    finally:
        if quiet:
            preferences.render_display_type = before
        if "RUNNING_MODAL" not in done:  # else the render's thread may have read it already
            _asked = False


def _seen():
    """Whether an image editor shows the render result."""
    return any(area.type == "IMAGE_EDITOR" and area.spaces.active.image
               and area.spaces.active.image.type == "RENDER_RESULT"
               for window in bpy.context.window_manager.windows for area in window.screen.areas)


class _Watch:
    """Redraws a scene as its settings change and then rest."""

    def __init__(self):
        self.values = None  # that were seen last

    def __call__(self):
        from .engine import pass_names

        window = next((w for w in bpy.context.window_manager.windows if w.scene.name in _kept), None)
        scene = window and window.scene
        if not scene or not scene.encre.auto_redraw or not _seen():
            return None
        if bpy.app.is_job_running("RENDER"):
            return _REST
        values, before = _values(scene), self.values
        self.values = values
        if values == _kept[scene.name].values:
            return None
        if values != before:
            return _REST
        if not refusal(scene, pass_names):
            start(window, quiet=True)
        return None


_watch = _Watch()


@persistent
def _changed(*_):
    if _kept and not bpy.app.timers.is_registered(_watch):
        bpy.app.timers.register(_watch, first_interval=_REST)


@persistent
def _begins(*_):
    global _asked, _drawing
    _drawing, _asked = _asked, False
    if not _drawing:
        forget()


@persistent
def _ends(*_):
    global _drawing
    _drawing = False


@persistent
def _loads(*_):
    global _asked
    _asked = False
    forget()


class ENCRE_OT_redraw(bpy.types.Operator):
    """Draw the last render again with the settings as they are now, without rendering it"""

    bl_idname = "encre.redraw"
    bl_label = "Redraw"
    bl_options = {"REGISTER"}

    @classmethod
    def poll(cls, context):
        return context.scene.name in _kept and not bpy.app.is_job_running("RENDER")

    def execute(self, context):
        from .engine import pass_names

        if why := refusal(context.scene, pass_names):
            self.report({"ERROR"}, why)
            return {"CANCELLED"}
        start(context.window, _seen())
        return {"FINISHED"}


_listen, _hear_no_more = handlers.pair(("render_init", _begins), ("render_complete", _ends), ("render_cancel", _ends),
                                       ("load_pre", _loads), ("depsgraph_update_post", _changed))


def register():
    bpy.utils.register_class(ENCRE_OT_redraw)
    _listen()


def unregister():
    _hear_no_more()
    with contextlib.suppress(ValueError):
        bpy.app.timers.unregister(_watch)
    bpy.utils.unregister_class(ENCRE_OT_redraw)
    forget()
