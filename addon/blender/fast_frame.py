# SPDX-License-Identifier: GPL-3.0-or-later
"""One frame whose layers Encre draws itself: read, drawn and written into Blender's result, without Cycles."""

from dataclasses import dataclass, field, replace

import bpy
import numpy as np

from ..pen import chains, library, metadata, saved, supersample
from ..pen import layers as layering
from ..pen.around import Window
from ..pen.errors import Cancelled, EncreError
from ..pen.job import Camera, Frame
from ..pen.settings import Settings
from . import cameras, fast, images, lamps, memory, overrides, unseen, versions, wanted

# What Cycles would have written: pass -> picture of fast_scene.Scene.pictures().
_PASSES = {"Depth": "depth", "Normal": "normal", "DiffDir": "diffuse", "DiffCol": "color", "GlossCol": "gloss",
           "Emit": "emission", "IndexOB": "index", "IndexMA": "material"}


@dataclass
class Place:
    """What is drawn of a view: the frame in which it lies, of `factor` times the size that is written."""

    camera: Camera
    frame: Frame    # of the size that is written
    large: Frame
    own: Window     # what is written
    inside: tuple   # that in what is drawn: slices
    factor: int
    view: np.ndarray | None = None  # world -> camera, and camera -> clip; None: a file has told the layers
    projection: np.ndarray | None = None
    called: dict = field(default_factory=dict)  # number of the layer `object` -> name of the object

    def write(self, out, name, picture):
        if picture is not None:
            picture = picture if picture.ndim == 3 else picture[..., None]
            out[versions.pass_name(name)] = supersample.shrink(name, picture[self.inside], self.factor)


class Straight:
    """The passes of a view in Blender's result, which pictures are written into at once: a result that is begun and
    ended has each pass a second time for a moment. Where nobody watches, for no window is told of it."""

    def __init__(self, engine, layer, view):
        engine.end_result(engine.begin_result(0, 0, 1, 1, layer=layer, view=view))  # or the passes have no memory yet
        result = engine.get_result()
        number = [each.name for each in result.views].index(view) if view else 0
        self.passes = {each.name: each for each in result.layers[layer].passes if each.view_id == number}

    def __setitem__(self, name, picture):
        # New passes are 0, but for depths and movements: where nobody writes they take no memory.
        if name in self.passes and (name in ("Depth", "Vector") or picture.any()):
            versions.write_pass(self.passes[name], picture)


@dataclass
class Kept:
    """What memory keeps of a view layer beside its pictures."""

    name: str
    settings: Settings
    places: dict = field(default_factory=dict)  # view's name -> Place


def _seen(layers, view):
    """The layers of what mirrors show, which files have of all pixels: each shows itself where there is no mirror."""
    if "seen_depth" in layers:
        return {name: layers[name] for name in ("seen_color", "seen_depth", "seen_normal")}
    return layering.unmirrored(layers, view)


class FastFrames:
    """The frames of one render, by the hooks of its engine. again: the memory.Picture that is drawn again."""

    def __init__(self, engine, go_on, again=None):
        self.engine, self.go_on, self.again = engine, go_on, again
        self.stamps = {}  # view layer's name -> what its file is to say
        self.lines = {}   # (view layer's name, view's) -> Chains that the file is to keep

    def render(self, depsgraph, camera, settings):
        """Renders a view layer. EncreError: the camera can't be used, or a stage fails; Cancelled."""
        if camera.data.type not in {"PERSP", "ORTHO"}:
            raise EncreError(f"camera {camera.name}: it is panoramic, and Encre draws only what perspective and "
                             "orthographic cameras see; make it one of them")
        name = depsgraph.view_layer.name
        kept = self.again and self.again.layer(name, settings)
        read = images.load(settings, self.go_on)
        if kept:
            for view, pictures in kept.views.items():
                place = kept.before.places[view]
                self._write(pictures.shown, place.own, name, view)  # which stays if it is given up
                pictures.shown = self._ink(depsgraph, settings, read, view, place, pictures.passes, pictures.maps)
            return
        self.engine.update_stats("Encre", "reading the scene")
        scene = fast.read(depsgraph, settings, (camera.data.clip_start, camera.data.clip_end),
                          fast.Kept(lamps.between(self.engine, depsgraph)), camera)
        blurred = overrides.blurred(depsgraph)
        for note in (*scene.notes, *([overrides.without(blurred)] if blurred else [])):
            self.engine.say("WARNING", note)
        if settings.active and memory.wanted(self.engine, depsgraph.scene):
            kept = memory.Layer(Kept(name, settings), False)
            memory.begin(depsgraph.scene, kept)
        width, height, _ = cameras.border(depsgraph.scene_eval.render)
        for view, matrices in cameras.views(self.engine, depsgraph, camera, width, height).items():
            if not self.go_on():
                raise Cancelled("rendering was cancelled")
            self.engine.update_stats("Encre", f"{name} {view}".strip())
            for note in unseen.far_away(*matrices, scene.subject.distance(*matrices), height):
                self.engine.say("WARNING", note)
            place, layers, plain = self._draw(scene, depsgraph, settings, matrices)
            out = self._ink(depsgraph, settings, read, view, place, layers, plain)
            if kept:
                kept.before.places[view], kept.views[view] = place, memory.View(layers, out, plain)

    def _draw(self, scene, depsgraph, settings, matrices):
        """(the Place, layers as library.draw() takes them, {pass: picture that no stage draws})."""
        width, height, own = cameras.border(depsgraph.scene_eval.render)
        around, factor, plain = own.grown(settings.reach(height), width, height), settings.factor, {}
        frame = Frame(width, height, around.x, around.y, depsgraph.scene_eval.frame_current)
        large = supersample.frame(frame, factor)
        top, left = (factor * start for start in (own.y - around.y, own.x - around.x))
        place = Place(scene.camera(*matrices), frame, large, own,
                       np.s_[top:top + factor * own.height, left:left + factor * own.width], factor, *matrices,
                       scene.objects.called())
        pictures = scene.pictures(*matrices, large, (factor * around.width, factor * around.height), settings,
                                  _threads(depsgraph), self.go_on)
        for name, layer in _PASSES.items():
            place.write(plain, name, pictures[layer])
        if "specular" in pictures:
            gloss, lamps = pictures["gloss"], pictures.get("highlights", np.float32(0))
            for name, part in (("GlossInd", pictures["specular"] - lamps), ("GlossDir", lamps)):
                light = np.divide(part, gloss, out=np.zeros_like(gloss), where=gloss > 0)
                place.write(plain, name, light)
        place.write(plain, "Combined", pictures["combined"])
        known = {*library.load().layers, "chains"}
        return place, {name: picture for name, picture in pictures.items() if name in known}, plain

    def _ink(self, depsgraph, settings, read, view, place, layers, plain):
        """Draws what a view layer is asked for and writes it: {pass: picture}, or Straight."""
        layer, straight = depsgraph.view_layer.name, bpy.app.background
        out = Straight(self.engine, layer, view) if straight else dict(plain)
        while straight and plain:  # none of which is kept
            name, picture = plain.popitem()
            out[name] = picture
            del picture
        if wanted.keeps(depsgraph.scene):
            seen = _seen(layers, place.camera.view) if settings.wants_seen else {}
            drawn = layers | seen
            for name in saved.passes(drawn):
                place.write(out, name, saved.pack(name, drawn))
            for name, picture in layering.seen_passes(seen):
                place.write(out, name, picture)
                del picture
            del seen, drawn
        asked = [*(["Combined"] if settings.active else []), *wanted.asked(depsgraph.view_layer)]
        if asked:
            drawn = library.draw(layers, settings.every, place.camera, place.large, outputs=asked,
                                 threads=_threads(depsgraph), progress=self.go_on, image=read.__getitem__,
                                 empty=versions.empty_pass, strokes=wanted.strokes is not None)
            wanted.tell(drawn.strokes, place.view, place.projection, place.large, place.called)
            for name in asked:
                place.write(out, name, drawn.images.pop(name))
        render = depsgraph.scene_eval.render
        if layer not in self.stamps:  # of the first view
            own, frame = place.own, place.frame
            border = own if render.use_border and not render.use_crop_to_border else None
            where = replace(frame, x=0, y=0) if border else replace(frame, x=own.x, y=own.y)
            self.stamps[layer] = metadata.write(settings.scene, settings.styles, place.camera, where, border,
                                                **wanted.beside(depsgraph.scene_eval, read, False))
        if "chains" in layers and wanted.keeps(depsgraph.scene):
            self.lines[layer, view] = chains.shrunk(layers["chains"], place.factor)
        if not straight:
            self._write(out, place.own, layer, view)
        return out

    def _write(self, drawn, own, layer, view):
        result = self.engine.begin_result(0, 0, own.width, own.height, layer=layer, view=view)
        for render_pass in result.layers[0].passes:
            if render_pass.name in drawn:
                versions.write_pass(render_pass, drawn[render_pass.name])
        self.engine.end_result(result)

    def after(self):
        """Says in the file what it was drawn by."""
        stamps, self.stamps, lines, self.lines = self.stamps, {}, self.lines, {}
        result = self.engine.get_result()
        for fields in (*stamps.values(), metadata.write_chains(lines)):
            for key, text in {**wanted.stamped, **fields}.items():
                result.stamp_data_add_field(key, text)


def _threads(depsgraph):
    render = depsgraph.scene_eval.render
    return render.threads if render.threads_mode == "FIXED" else 0
