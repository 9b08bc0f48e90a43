# SPDX-License-Identifier: GPL-3.0-or-later
"""One frame whose layers Encre draws itself: read, drawn and written into Blender's result, without Cycles."""

import numpy as np

from ..pen import library, metadata, saved, supersample
from ..pen.errors import Cancelled, EncreError
from ..pen.job import Frame
from . import cameras, fast, papers, versions, wanted

# What Cycles would have written: pass -> picture of fast.Scene.pictures().
_PASSES = {"Depth": "depth", "Normal": "normal", "DiffDir": "diffuse", "DiffCol": "color", "GlossCol": "gloss",
           "Emit": "emission", "IndexOB": "index", "IndexMA": "material"}


class FastFrames:
    """The frames of one render, by the hooks of its engine."""

    def __init__(self, engine, go_on):
        self.engine, self.go_on = engine, go_on
        self.stamps = {}  # view layer's name -> what its file is to say

    def render(self, depsgraph, camera, settings):
        """Renders a view layer. EncreError: the camera can't be used, or a stage fails; Cancelled."""
        if camera.data.type not in {"PERSP", "ORTHO"}:
            raise EncreError(f"camera {camera.name}: it is panoramic, and Encre draws only what perspective and "
                             "orthographic cameras see; make it one of them")
        paper = papers.load(settings.paper, self.go_on) if settings.paper else None
        if paper is not None:
            library.check(settings.scene, lambda _name: paper)
        self.engine.update_stats("Encre", "reading the scene")
        scene = fast.read(depsgraph, settings, (camera.data.clip_start, camera.data.clip_end), camera=camera)
        for note in scene.notes:
            self.engine.say("WARNING", note)
        render = depsgraph.scene_eval.render
        width, height, own = cameras.border(render)
        place = own.grown(settings.reach(height), width, height)
        for name, (view, projection) in cameras.views(self.engine, depsgraph, camera, width, height).items():
            if not self.go_on():
                raise Cancelled("rendering was cancelled")
            self.engine.update_stats("Encre", f"{depsgraph.view_layer.name} {name}".strip())
            drawn = self._draw(scene, depsgraph, settings, (view, projection), Frame(width, height, place.x, place.y),
                               place, own, paper)
            self._write(drawn, own, depsgraph.view_layer.name, name)

    def _draw(self, scene, depsgraph, settings, matrices, frame, place, own, paper):
        """{pass: picture} of the window `own`."""
        factor, render = settings.factor, depsgraph.scene_eval.render
        threads = render.threads if render.threads_mode == "FIXED" else 0
        large, size = supersample.frame(frame, factor), (factor * place.width, factor * place.height)
        pictures = scene.pictures(*matrices, large, size, settings, threads, self.go_on)
        top, left = (factor * start for start in (own.y - place.y, own.x - place.x))
        kept, out = np.s_[top:top + factor * own.height, left:left + factor * own.width], {}

        def write(name, picture):
            if picture is not None:
                picture = picture if picture.ndim == 3 else picture[..., None]
                out[versions.pass_name(name)] = supersample.shrink(name, picture[kept], factor)

        for name, layer in _PASSES.items():
            write(name, pictures[layer])
        layers = {name: pictures.pop(name) for name in list(pictures) if name in library.load().layers}
        write("Combined", layers["combined"])
        if wanted.keeps(depsgraph.scene):
            for name in saved.passes(False, "anchor" in layers):
                write(name, saved.pack(name, layers))
        asked = [*(["Combined"] if settings.active else []), *wanted.asked(depsgraph.view_layer)]
        camera = scene.camera(*matrices)
        if asked:
            drawn = library.draw(layers, settings.every, camera, large, outputs=asked, threads=threads,
                                 progress=self.go_on, image=lambda _name: paper)
            for name in asked:
                write(name, drawn.images.pop(name))
        if depsgraph.view_layer.name not in self.stamps:  # of the first view
            border = own if render.use_border and not render.use_crop_to_border else None
            where = Frame(frame.width, frame.height) if border else Frame(frame.width, frame.height, own.x, own.y)
            self.stamps[depsgraph.view_layer.name] = metadata.write(
                settings.scene, settings.styles, camera, where, border,
                **wanted.beside(depsgraph.scene_eval, settings, False))
        return out

    def _write(self, drawn, own, layer, view):
        result = self.engine.begin_result(0, 0, own.width, own.height, layer=layer, view=view)
        for render_pass in result.layers[0].passes:
            if render_pass.name in drawn:
                versions.write_pass(render_pass, drawn[render_pass.name])
        self.engine.end_result(result)

    def after(self):
        """Says in the file what it was drawn by."""
        stamps, self.stamps = self.stamps, {}
        result = self.engine.get_result()
        for fields in stamps.values():
            for key, text in {**wanted.stamped, **fields}.items():
                result.stamp_data_add_field(key, text)
