# SPDX-License-Identifier: GPL-3.0-or-later
"""One rendered frame: settings and overrides before Cycles, triangles, and the stages on Cycles' passes after."""

from dataclasses import dataclass

import bpy
import numpy as np

from . import compat, core, denoise, layers, meshes, papers, properties


@dataclass
class _ViewLayer:
    """What is known of a view layer before Cycles renders it."""

    scene: dict
    styles: list          # (name, what it changes)
    user_indices: np.ndarray | None   # by the index that Cycles writes: the user's own; None: it is the user's
    restore: bool         # whether the user asked for the pass of object indices
    denoise_other: bool
    objects: meshes.Objects | None = None
    views: dict | None = None     # view name -> (camera, rasterised pictures)
    frame: core.Frame | None = None
    cropped: bool = False         # a part of the frame was rendered, the file shows all of it
    threads: int = 0

    @property
    def overrides(self):
        return [values for _, values in self.styles]


def passes(scene):
    """What Cycles and the stages must have a place for: (name, channel names, kind), as register_pass() takes."""
    mode = scene.encre.save_layers
    multilayer = scene.render.image_settings.file_format == "OPEN_EXR_MULTILAYER"
    saved = layers.SAVED if mode == "ON" or (mode == "AUTO" and multilayer) else {}
    for name, channels in {**layers.CYCLES, **layers.DRAWN, **saved}.items():
        kind = {"X": "VALUE", "Z": "VALUE", "XYZ": "VECTOR"}.get(channels, "COLOR")
        yield compat.pass_name(name), channels, kind


class Frames:
    """The frames of one render, by the hooks of its engine."""

    def __init__(self, engine):
        self.engine = engine
        self.prepared, self.extracted = None, {}
        self.line_numbers = None
        self.overrode = False  # with persistent data, what a frame overrode is there in the next

    # Before Cycles reads the scene

    def prepare(self, depsgraph):
        """Reads and checks the settings, and overrides on the evaluated scene what the stages can't do with.

        The user's scene stays as it is. With all switches off nothing is overridden. EncreError: the settings,
        the camera or the paper can't be used.
        """
        self.prepared = None
        scene = depsgraph.scene_eval
        camera = self._camera(depsgraph)
        values = core.check(properties.scene_values(scene))
        styles = [(name, core.check(changed)) for name, changed in properties.styles(scene)]
        overrides = [changed for _, changed in styles]
        if values["paper_source"] == "IMAGE":
            papers.load(values["paper_image"])  # that it can't be read is said before Cycles starts
        if not compat.has_cycles_denoiser() and scene.cycles.use_denoising:
            scene.cycles.use_denoising = False
            self.engine.say("INFO", "this build of Blender has no Open Image Denoise: Cycles' denoiser is off")
        active, shaded = layers.active(values, overrides), layers.shaded(values, overrides)
        if camera.data.type == "PANO":
            if active:
                raise core.EncreError(f"camera {camera.name}: a panoramic camera has no straight lines that Encre "
                                      "could draw; make it perspective or orthographic")
            return
        user = depsgraph.scene.cycles.use_denoising and depsgraph.view_layer.cycles.use_denoising
        numbers = None
        if active or self.overrode:
            self._switch_blur(depsgraph, active)
            numbers = meshes.renumber(depsgraph, active and values["object_index"] == "AUTO")
        if shaded or self.overrode:
            scene.cycles.use_denoising = depsgraph.scene.cycles.use_denoising and not shaded
        self.overrode = active
        if values["light_denoise"] == "OIDN" and not denoise.available() and layers.wants_light(values, overrides):
            self.engine.say("INFO", "Open Image Denoise is not there: the light keeps its noise")
        self.line_numbers, indices = numbers or (None, None)
        self.prepared = _ViewLayer(values, styles, indices, depsgraph.view_layer.use_pass_object_index,
                                   user and shaded)

    def _camera(self, depsgraph):
        camera = self.engine.camera_override or depsgraph.scene.camera
        if camera is None or camera.type != "CAMERA":
            raise core.EncreError("the scene has no camera: add one and make it the scene's")
        return camera.evaluated_get(depsgraph)

    def _switch_blur(self, depsgraph, off):
        """Lines need layers in which a pixel shows one thing."""
        render, found = depsgraph.scene_eval.render, []
        if depsgraph.scene.render.use_motion_blur:
            render.use_motion_blur = not off
            found.append("motion blur")
        for block in depsgraph.ids:
            if isinstance(block, bpy.types.Camera) and block.original.dof.use_dof:
                block.dof.use_dof = not off
                found.append("depth of field")
        if found and off:
            names = " and ".join(sorted(set(found)))
            self.engine.say("WARNING", f"{names}: rendered without, because lines need sharp layers")

    # Before Cycles frees the scene

    def extract(self, depsgraph):
        """Rasterises what the stages need from the scene itself. EncreError: it can't; Cancelled."""
        self.extracted.pop(depsgraph.view_layer.name, None)
        layer, self.prepared = self.prepared, None
        if layer is None:
            return
        camera, render = self._camera(depsgraph), depsgraph.scene_eval.render
        width, height, x, y, columns, rows = meshes.border(render)
        frame = core.Frame(width, height, x, y)
        automatic = layer.scene["object_index"] == "AUTO"
        layer.objects = meshes.extract(depsgraph, automatic, self.line_numbers)
        layer.frame, layer.cropped = frame, render.use_border and not render.use_crop_to_border
        layer.threads = render.threads if render.threads_mode == "FIXED" else 0
        layer.views = {}
        for name, (view, projection) in meshes.views(self.engine, depsgraph, camera, width, height).items():
            orthographic = camera.data.type == "ORTHO"
            seen = core.Camera(tuple(view[:3, :3].ravel()), orthographic, 2 / projection[1, 1] if orthographic else 1)
            maps = core.raster(
                layer.objects.meshes, view, projection, frame, (columns, rows), camera.data.clip_start,
                camera.data.clip_end, len(core.CONTROLS), ("object", "material", "style", "attributes"),
                layer.threads, self._go_on)
            layer.views[name] = seen, maps
        layer.objects.meshes.clear()
        self.extracted[depsgraph.view_layer.name] = layer

    def _go_on(self, _fraction=0):
        return not self.engine.test_break()

    # After Cycles

    def draw(self, result):
        """Runs the stages on every view layer and view of a render result. EncreError: they can't; Cancelled."""
        extracted, self.extracted = self.extracted, {}
        nonfinite = 0
        for layer in result.layers:
            known = extracted.get(layer.name)
            if known is None:  # a picture without stages
                continue
            by_view = {}
            for render_pass in layer.passes:
                by_view.setdefault(render_pass.view_id, {})[render_pass.name] = render_pass
            for view_id, there in by_view.items():
                name = result.views[view_id].name if len(known.views) > 1 else ""
                self.engine.update_stats("Encre", f"{layer.name} {name}: drawing")
                nonfinite += self._draw(known, *known.views[name], there, result)
            self._stamp(result, known)
        if nonfinite:
            self.engine.say("WARNING", f"{nonfinite} values of the layers were not finite and were read as 0")

    def _draw(self, layer, camera, maps, there, result):
        width, height = result.resolution_x, result.resolution_y
        pictures = {}
        for name in layers.CYCLES:
            if compat.pass_name(name) in there:
                pictures[name] = compat.read_pass(there[compat.pass_name(name)], width, height)
        index = pictures["IndexOB"][..., 0]
        objects = layer.objects
        pictures.update(layers.rasterised(index, maps, objects.owners, objects.numbers, objects.strays))
        images, nonfinite = layers.assemble(pictures, layer.scene, layer.overrides, self._denoiser(layer),
                                            layer.denoise_other)
        drawn = core.render(images, layer.scene, layer.overrides, camera, layer.frame,
                            outputs=("Combined", *layers.DRAWN), threads=layer.threads, progress=self._go_on,
                            image=papers.load)
        out = dict(drawn.images)
        out.update({name: pictures[name] for name in layers.SAVED if name in pictures})
        out["Encre Source"], out["Encre Diffuse"] = images["combined"], images["diffuse"]
        if layer.user_indices is not None and layer.restore:
            known = np.clip(index, 0, len(layer.user_indices) - 1).astype(np.intp)
            out[compat.pass_name("IndexOB")] = layer.user_indices[known][..., None]
        for name, picture in out.items():
            if name in there:
                compat.write_pass(there[name], picture)
        return nonfinite + drawn.nonfinite

    def _denoiser(self, layer):
        wanted = layer.scene["light_denoise"] == "OIDN" and layers.wants_light(layer.scene, layer.overrides)
        if not wanted or not denoise.available():
            return None
        return lambda picture, albedo, normal: denoise.denoise(picture, albedo, normal, self._go_on)

    def _stamp(self, result, layer):
        """The settings go into the saved file, so that it can be drawn again without Blender."""
        frame = layer.frame
        if layer.cropped:  # the file shows the full frame, of which only a part was rendered
            frame = core.Frame(frame.width, frame.height)
        camera = next(iter(layer.views.values()))[0]
        for key, text in layers.metadata(layer.scene, layer.styles, camera, frame).items():
            result.stamp_data_add_field(key, text)
