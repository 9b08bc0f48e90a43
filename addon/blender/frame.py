# SPDX-License-Identifier: GPL-3.0-or-later
"""One rendered frame: settings and overrides before Cycles, triangles, and the stages on Cycles' passes after."""

import contextlib
import weakref
from dataclasses import replace

import bpy

from ..pen import around, background, chains, denoise, layers, library, metadata, overlay, saved, supersample, through
from ..pen.errors import Cancelled, EncreError
from ..pen.job import Camera, Frame
from . import (
    cameras,
    drawing,
    early,
    escape,
    fast_frame,
    images,
    lamps,
    memory,
    meshes,
    overrides,
    properties,
    redraw,
    rendered,
    subframes,
    subject,
    unseen,
    versions,
    volumes,
    wanted,
)
from .known import Passes, ViewLayer


class Frames:
    """The frames of one render, by the hooks of its engine."""

    def __init__(self, engine):
        # Weakly: Blender frees an engine when the last reference goes, and Cycles' memory with it, but takes away
        # the engine's own before Python would find a circle of references.
        self.engine = weakref.proxy(engine)
        self.known = {}        # view layer's name -> ViewLayer
        self.settings = None   # of the evaluated scene; None: they can't be used
        self.numbers = None    # of objects: what overrides.pass_indices() gave
        self.fast = None       # the FastFrames, where Cycles has nothing to do
        self.overrode = False  # with persistent data, what one frame overrode is there in the next
        self.nonfinite = 0     # values that were read as 0
        self.esc = None        # the escape.Esc after which it draws
        self.ink = None        # the early.Early to be shown over what Cycles renders
        self.growth = None     # the early.Growth that draws it anew
        self.again = None      # the memory.Picture that it draws, and nothing is rendered
        self.lines = {}        # (view layer, view) -> Chains that the frame's file keeps

    @property
    def by_cycles(self):
        """Whether Cycles has anything to do."""
        return not self.again and not self.fast

    # Before Cycles

    def begin(self, depsgraph):
        """Reads the settings and numbers the objects, before Cycles looks for what changed in the evaluated scene."""
        self.settings = self.numbers = self.ink = None
        self.again = redraw.picture(depsgraph.scene)
        with contextlib.suppress(EncreError):  # said when it comes to rendering: baking comes by here too
            self.settings = properties.settings(depsgraph.scene_eval)
        self.fast = None
        if self.again:
            if self.again.fast:
                self.fast = fast_frame.FastFrames(self.engine, self._go_on, self.again)
        elif self.settings and self.settings.fast:
            self.fast = fast_frame.FastFrames(self.engine, self._go_on)
        elif self.settings and (self.settings.active or self.overrode):
            overrides.fewer_samples(depsgraph, self.settings.active)
            automatic = self.settings.active and self.settings.scene["object_index"] == "AUTO"
            self.numbers = overrides.pass_indices(depsgraph, automatic)

    def render(self, cycles, depsgraph):
        """Has `cycles` (cycles.engine) render a view layer. EncreError: the settings or the camera can't be used, or
        a stage fails; Cancelled."""
        wanted.refuse_long_names(depsgraph.scene)
        if self.settings and (lost := properties.unknown(depsgraph.scene)):
            self.engine.say("WARNING", "this version of Encre does not know these settings of the file, which change "
                                       f"nothing: {', '.join(lost)}; the list of changes names those in their place")
        if self.fast:
            settings = self.settings or properties.settings(depsgraph.scene_eval)
            self.fast.render(depsgraph, self._camera(depsgraph), settings)
            return
        if self.again:
            self._remember(depsgraph)
        else:
            self._by_cycles(cycles, depsgraph)
        if self._go_on():  # now, because Blender then puts Grease Pencil over what is in the result
            self._finish()

    def _by_cycles(self, cycles, depsgraph):
        self._before(depsgraph)
        layer = self.known.get(depsgraph.view_layer.name)
        if layer and (layer.factor > 1 or layer.own != layer.place):
            layer.drawn = self._in_parts(cycles, depsgraph, layer)
            return
        if layer and early.output(layer) and early.possible(self.engine, depsgraph.scene_eval):
            early.sample(self.engine, cycles, depsgraph)
            if self._go_on():
                self.ink = early.picture(self.engine.get_result(), layer, self._draw)
                self.growth = early.Growth(self.engine, layer, self._show)
        if self._go_on():  # else what the sample left is drawn
            cycles.render(self.engine, depsgraph)
            cycles.render_frame_finish(self.engine)  # a tiled picture is on the disk until now
        if self.growth:
            self.growth.end()
            self.growth = None

    def _show(self, ink):
        self.ink = ink

    def _before(self, depsgraph):
        """Overrides on the evaluated scene what the stages can't do with, and rasterises what they need from it.

        Must run before Cycles renders, which frees the depsgraph. The user's scene stays as it is; with all switches
        off nothing is overridden, nor rasterised but for what the file is to keep. EncreError: the settings or the
        camera can't be used. Cancelled.
        """
        self.known.pop(depsgraph.view_layer.name, None)
        settings, camera = self.settings or properties.settings(depsgraph.scene_eval), self._camera(depsgraph)
        pictures = images.load(settings, self._go_on)
        flat = camera.data.type in {"PERSP", "ORTHO"}
        light = self._light(depsgraph, camera, settings) if flat else None
        kept = light.kept if light else lamps.between(self.engine, depsgraph) or lamps.Kept()
        sky, note = rendered.sky(depsgraph, settings, kept)
        if note:
            self.engine.say("INFO", note)
        if settings.denoises and not light and not denoise.available(versions.home()):
            self.engine.say("INFO", "Open Image Denoise is not there, so the light stays noisy; choose Fast, or "
                                    "set Light to Drawn (light_source=DRAWN)")
        if settings.active and not flat:
            raise EncreError(f"camera {camera.name}: it is panoramic, and Encre draws only what perspective and "
                                  "orthographic cameras see; make it one of them")
        denoise_other, missing = overrides.denoiser(depsgraph, settings.shaded, self.overrode)
        denoise_other = denoise_other or settings.denoises_other
        if missing:
            self.engine.say("INFO", "this build of Blender has no Open Image Denoise: Cycles' denoiser is off")
        blurred = overrides.blur(depsgraph, settings.active) if settings.active or self.overrode else ()
        if settings.active or self.overrode:
            overrides.film(depsgraph, sky is not None)
        if blurred:
            self.engine.say("WARNING", overrides.without(blurred))
        for note in unseen.by_cycles(depsgraph) if settings.active else ():
            self.engine.say("WARNING", note)
        if settings.wants_seen:
            overrides.follow_reflections(depsgraph)
        overrides.expect(depsgraph, wanted.own(depsgraph.scene, depsgraph.view_layer))
        self.overrode = settings.active
        if flat:
            self.known[depsgraph.view_layer.name] = self._rasterise(depsgraph, camera, settings, denoise_other,
                                                                    pictures, light, kept, sky)

    def _remember(self, depsgraph):
        """Puts the passes of a view layer that is in memory into the result, to be drawn again. EncreError: it is not,
        or the settings can't be used; Cancelled."""
        settings = self.settings or properties.settings(depsgraph.scene_eval)
        kept = self.again.layer(depsgraph.view_layer.name, settings)
        before = kept.before
        cut = before.own != before.place
        loaded = images.load(settings, self._go_on)
        self.known[before.name] = replace(
            before.again(settings, loaded), asked=wanted.asked(depsgraph.view_layer),
            keeps=wanted.keeps(depsgraph.scene), beside=wanted.beside(depsgraph.scene_eval, loaded, cut))
        whole = self.engine.get_result()
        width, height, names = whole.resolution_x, whole.resolution_y, [view.name for view in whole.views]
        for number, view in kept.views.items():
            name = names[number] if len(kept.views) > 1 else ""
            result = self.engine.begin_result(0, 0, width, height, layer=before.name, view=name)
            for render_pass in result.layers[0].passes:
                picture = view.shown.get(render_pass.name)
                if picture is not None and render_pass.view_id == number:
                    versions.write_pass(render_pass, picture)
            self.engine.end_result(result)

    def _camera(self, depsgraph):
        camera = self.engine.camera_override or depsgraph.scene.camera
        if camera is None or camera.type != "CAMERA":
            raise EncreError("the scene has no camera: add one and make it the scene's")
        return camera.evaluated_get(depsgraph)

    def _light(self, depsgraph, camera, settings):
        """The lamps.Light to be drawn; None: Cycles' light is taken."""
        if not settings.draws_light:
            return None
        light = lamps.Light(depsgraph, (camera.data.clip_start, camera.data.clip_end),
                            lamps.between(self.engine, depsgraph), shadowed=settings.shadows_world,
                            planes=settings.planes)
        if light.unknown:
            self.engine.say("WARNING", f"drawn light leaves out {', '.join(light.unknown)}: only Cycles can read it")
        if not light.dark:
            return light
        self.engine.say("WARNING", "there is no lamp, and no world that Encre can read: the light is Cycles'")
        return None

    def _rasterise(self, depsgraph, camera, settings, denoise_other, pictures, light, kept, sky):
        render = depsgraph.scene_eval.render
        width, height, own = cameras.border(render)
        place, factor = own.grown(self._reach(settings, denoise_other, height), width, height), settings.factor
        frame = Frame(width, height, place.x, place.y, depsgraph.scene_eval.frame_current)
        threads = render.threads if render.threads_mode == "FIXED" else 0
        line_numbers, user_indices = self.numbers or (None, None)
        asked, keeps = wanted.asked(depsgraph.view_layer), wanted.keeps(depsgraph.scene)
        objects, drawn, views, colors = None, [], {}, None
        if settings.active or asked or keeps:
            colors = rendered.read(depsgraph, settings, kept)
            objects = meshes.extract(depsgraph, settings.scene["object_index"] == "AUTO", line_numbers, light,
                                     anchored=settings.wants_anchor, unwrapped=settings.wants_tangent,
                                     laid=colors and colors.laid, facets=settings.facets)
            if light:
                light.tidy()
            drawn = ["object", "material", "style", "coincident", *settings.rastered]
            if any(mesh.attributes is not None for mesh in objects.meshes):
                drawn.append("attributes")
        solid = objects.solid() if objects and settings.wants_edges else None
        boxes = volumes.corners(depsgraph) if denoise_other or (objects and settings.wants_edges) else ()
        known = whole = shown = None
        if objects and settings.wants_edges:
            told = colors and colors.told(objects.materials)
            shown = told and background.run(colors.colors(told, objects.materials, settings.every), threads,
                                            self._go_on)
            known, whole = objects.chained(told, told)
        about = subject.read(depsgraph, camera, light)
        for name, (view, projection) in cameras.views(self.engine, depsgraph, camera, width, height).items():
            orthographic = camera.data.type == "ORTHO"
            eye = Camera(cameras.rotation(view).ravel(), orthographic, 2 / projection[1, 1],
                         0 if orthographic else about.distance(view, projection), about.light,
                         about.shade)

            for note in unseen.far_away(view, projection, about.distance(view, projection), height) if objects else ():
                self.engine.say("WARNING", note)

            def raster(those, wanted, view=view, projection=projection):
                return library.raster(
                    those, view, projection, supersample.frame(frame, factor),
                    (factor * place.width, factor * place.height), camera.data.clip_start, camera.data.clip_end,
                    len(library.controls()), wanted, threads, self._go_on)

            maps = objects and raster(objects.meshes, drawn if solid is None else [*drawn, "depth"])
            lines = known and library.chains(
                known, view, projection, supersample.frame(frame, factor),
                (factor * place.width, factor * place.height), camera.data.clip_start, camera.data.clip_end,
                threads=threads, progress=self._go_on, most_before=settings.hidden, colors=shown)
            clear = None if solid is None else through.find(maps, raster(solid, ["object", "depth"]), objects.clear)
            if objects:
                maps.pop("depth", None)
                maps = overlay.compact(maps)
            if clear:
                maps["through"] = clear
            if len(boxes) and objects and settings.wants_edges:
                maps["haze"] = raster(objects.meshes if solid is None else solid, ["object", "depth", "shading"])
            if known:
                maps["chains"] = chains.told(lines, objects.numbers, whole)
            views[name] = eye, maps, view, projection
        if objects:
            objects.meshes.clear()
        if not depsgraph.view_layer.use_pass_object_index:
            user_indices = None
        samples = depsgraph.view_layer.samples or depsgraph.scene_eval.cycles.samples
        layer = ViewLayer(depsgraph.view_layer.name, settings, denoise_other, user_indices, objects, views, light, sky,
                          boxes, camera.data.clip_start, frame,
                          own, place, own if render.use_border and not render.use_crop_to_border else None,
                          threads, samples, asked, keeps, pictures,
                          wanted.beside(depsgraph.scene_eval, pictures, own != place),
                          wanted.spare(depsgraph.scene, depsgraph.view_layer))
        if settings.active and memory.wanted(self.engine, depsgraph.scene):
            layer.kept = memory.Layer(layer, overrides.denoises(depsgraph))
            memory.begin(depsgraph.scene, layer.kept)
        return layer

    def _reach(self, settings, denoise_other, height):
        """How many pixels around a border are rendered too."""
        if not subframes.possible(self.engine):
            return 0
        if not denoise.available(versions.home()):
            return settings.reach(height)
        denoises = settings.denoises or denoise_other
        return settings.reach(height) + (denoise.REACH if denoises else denoise.OVERLAP if settings.cleans_seen else 0)

    def _go_on(self, _fraction=0):
        if self.again and redraw.gives_way():
            return False
        return not (self.esc.again if self.esc else self.engine.test_break())

    def _in_parts(self, cycles, depsgraph, layer):
        """Renders and draws a view layer at `factor` times the frame's size, and with what lies around a border; what
        is to be written, by view id.

        Drawn at once, because the large layers of all view layers together would not find room.
        """
        gathered, own, place = {}, layer.own, layer.place

        def take(window, column, row):
            result = self.engine.get_result()
            for render_pass in result.layers[depsgraph.view_layer.name].passes:
                if render_pass.name in {**layers.DRAWN, **saved.passes()}:
                    continue
                picture = versions.read_pass(render_pass, result.resolution_x, result.resolution_y)
                picture = picture[result.resolution_y - window.height:, :window.width]
                view = gathered.setdefault(render_pass.view_id, supersample.Gathered(layer.factor, place))
                view.take(render_pass.name, picture, column, row, window, window == own)

        subframes.render(self.engine, cycles, depsgraph, self._camera(depsgraph), layer.factor,
                         [*around.pieces(own, place), own], take, self._go_on)
        drawn = {}
        for view_id in list(gathered):
            view = gathered.pop(view_id)
            small = drawn[view_id] = view.small
            write = layer.shrinking(small.__setitem__)
            for name, picture in view.large.items():
                write(name, picture)
            large = {layers.classic(name): view.large.pop(name) for name in list(view.large)}
            del picture
            self._draw(layer, view_id, large, small.__setitem__, dict(small))
        return drawn

    # After Cycles

    def after(self):
        """Ends the frame. A still that a window's user has stopped is drawn as far as it has come. EncreError: it
        can't be; Cancelled."""
        if self.fast:
            self.fast.after()
        elif self.again and redraw.gives_way():
            raise Cancelled("the redraw gave way")
        elif self.known and not bpy.app.background and not self.engine.is_animation:
            with escape.Esc() as self.esc:
                self._finish()
        self.lines = {}

    def _finish(self):
        """Runs the stages on every view and view layer that was rendered and is not drawn yet."""
        known, self.known = self.known, {}
        for key, text in wanted.stamped.items():
            self.engine.get_result().stamp_data_add_field(key, text)
        if not known:
            return
        result = self.engine.get_result()
        for layer in result.layers:
            if layer.name not in known:  # a picture without stages
                continue
            mine, by_view = known[layer.name], {}
            if mine.keeps:
                self.lines.update(mine.chains)
            for render_pass in layer.passes:
                by_view.setdefault(render_pass.view_id, {})[render_pass.name] = render_pass
            for view_id, there in by_view.items():
                def write(name, picture, there=there):
                    if name in there:
                        versions.write_pass(there[name], picture)

                if mine.drawn:
                    for name, picture in mine.drawn.pop(view_id).items():
                        write(name, picture)
                elif self.again:
                    self._draw(mine, view_id, None, write)
                elif mine.objects:
                    size = result.resolution_x, result.resolution_y
                    passes, shown = Passes(there, size, mine.settings.wants_seen), None
                    if self.esc and not passes["Depth"].any():  # it was stopped before the first sample
                        continue
                    if mine.kept:
                        shown = {name: versions.read_pass(one, *size) for name, one in there.items()
                                 if not memory.ours(name)}
                        passes = {name: shown[versions.pass_name(name)] for name in passes}
                    self._draw(mine, view_id, passes, write, shown)
            for there in by_view.values():
                for name in set(mine.spare) & there.keys():
                    versions.clear_pass(there[name], result.resolution_x, result.resolution_y)
            self._stamp(result, mine)
        for key, text in metadata.write_chains(self.lines).items():  # of all view layers so far
            result.stamp_data_add_field(key, text)
        if self.nonfinite:
            self.engine.say("WARNING", f"{self.nonfinite} values of the layers were not finite and were read as 0")
            self.nonfinite = 0

    def _draw(self, layer, view_id, passes, write, shown=None):
        self.nonfinite += drawing.draw(self.engine, layer, view_id, passes, write, self._go_on, shown, bool(self.esc))

    def _stamp(self, result, layer):
        """The settings go into the saved file, so that it can be drawn again without Blender."""
        frame = replace(layer.frame, x=layer.own.x, y=layer.own.y)
        if layer.border:
            frame = replace(frame, x=0, y=0)
        camera = next(iter(layer.views.values()))[0]
        for key, text in metadata.write(layer.settings.scene, layer.settings.styles, camera, frame,
                                        layer.border, **layer.beside).items():
            result.stamp_data_add_field(key, text)
