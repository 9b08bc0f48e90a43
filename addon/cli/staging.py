# SPDX-License-Identifier: GPL-3.0-or-later
"""Sets the scene that Blender has opened up as a job asks: camera, view layers, values, samples, the kind of file.

Runs inside Blender, where inside.py imports it.
"""

import re

import bpy

from ..blender import ENGINE, images, properties, wanted
from ..pen.errors import EncreError, unknown
from . import needed

MOST_PLAIN = 1 << 24  # pixels of a frame of which a file without compression, 5 GB, finds room
_TRUST = "if you trust whoever made the file, give --enable-autoexec"


def mute(scene, path):
    """Keeps keyframes and drivers from overwriting a value that the command line gives."""
    data = scene.animation_data
    if not data:
        return
    curves = list(data.drivers)
    if data.action:
        # Blender 5 has no list of its own for an action of one slot.
        curves += data.action.fcurves if hasattr(data.action, "fcurves") else [
            curve for layer in data.action.layers for strip in layer.strips for bag in strip.channelbags
            for curve in bag.fcurves]
    for curve in curves:
        if curve.data_path == path or curve.data_path.startswith(path + "["):
            curve.mute = True


def chosen(kind, name, known, job):
    if name not in known:
        raise EncreError(f"{job['scene']}: " + unknown(kind, name, known.keys()))
    return known[name]


def use_device(scene, name):
    """Has Cycles render on the processor or on the graphics cards of a kind."""
    scene.cycles.device = "CPU" if name == "cpu" else "GPU"
    if name == "cpu":
        return
    cycles = bpy.context.preferences.addons["cycles"].preferences
    try:
        cycles.compute_device_type = name.upper()
    except TypeError:
        raise EncreError(f"--device {name}: this Blender knows no such devices; give --device cpu") from None
    cycles.get_devices()
    cards = [device for device in cycles.devices if device.type == name.upper()]
    if not cards:
        raise EncreError(f"--device {name}: Blender finds none; give --device cpu, or look after its driver")
    for device in cycles.devices:
        device.use = device in cards


def choose(job):
    """The scene that the job names, its camera and view layers set as it says."""
    scene = bpy.context.scene
    if job["scene_name"] is not None:
        scene = chosen("scene", job["scene_name"], bpy.data.scenes, job)
        if bpy.context.window:
            bpy.context.window.scene = scene
    if job["camera"] is not None:
        cameras = {obj.name: obj for obj in scene.objects if obj.type == "CAMERA"}
        camera = chosen("camera", job["camera"], cameras, job)
        for marker in scene.timeline_markers:  # which change it with the frame, and at once where one loses its own
            marker.camera = None
        scene.camera = camera
    if job["view_layer"] is not None:
        chosen("view layer", job["view_layer"], scene.view_layers, job)
        for layer in scene.view_layers:
            layer.use = layer.name == job["view_layer"]
    for switch, name in properties.PASSES.items():
        for layer in scene.view_layers if name in job["passes"] else ():
            setattr(layer.encre, switch, True)
    if job["threads"] is not None:
        scene.render.threads_mode = "FIXED" if job["threads"] else "AUTO"
        if job["threads"]:
            scene.render.threads = job["threads"]
    if job["device"] is not None:
        use_device(scene, job["device"])
    return scene


def _amiss(job, report, words):
    """What --strict takes for an error."""
    if job["strict"]:
        raise EncreError(f"{job['scene']}: {words}")
    report("warning", text=f"{job['scene']}: {words}")


def heed(job, report):
    """Says what the file asks for and does not get."""
    if bpy.app.autoexec_fail and not job["autoexec"]:
        report("warning", text=f"{job['scene']}: its scripts and drivers in Python were not run; {_TRUST}")
    if words := job.get("untrusted"):
        _amiss(job, report, f"{', '.join(words)}; {_TRUST}")
    if files := needed.lost(job["strict"]):
        _amiss(job, report, f"uses files that can't be used: {', '.join(files)}; bring them back")


def heed_scene(job, scene, report):
    """Likewise of the scene, which has been chosen."""
    for name, style in needed.styles(scene):
        _amiss(job, report, f"{name} has the style {style}, which scene {scene.name} has not, and is drawn as the "
                            "scene is; add such a style or choose another")
    if job["view_layer"] is not None and (layers := needed.unrendered(scene)):
        _amiss(job, report, f"the compositor reads view layer {', '.join(layers)}, which --view-layer leaves out, and "
                            "gets nothing from it; leave --view-layer out, or switch Compositing off in the scene's "
                            "Post Processing")
    if outputs := list(needed.outputs(scene)):
        places = ", ".join(dict.fromkeys(f"{path} (node {node.name})" for path, _, node in outputs))
        report("note", text=f"{job['scene']}: Blender itself writes more files, which --resume does not look at: "
               f"{places}")
    for _, folder, node in outputs:
        if lost := needed.no_folder(folder):
            _amiss(job, report, f"node {node.name} can't write its files: {lost} is no folder; move it away, or mute "
                                "the node")
    if scene.render.use_sequencer and needed.strips(scene):
        report("warning", text=f"{job['scene']}: the strips of scene {scene.name}'s sequencer take the place of the "
               "picture, and an .exr has no passes to draw again; switch Sequencer off in its Post Processing")


def plain(scene):
    """Shows colors as they are. A file for another engine is exposed and graded as a photograph: paper is gray."""
    view = scene.view_settings
    view.view_transform, view.look, view.exposure, view.gamma, view.use_curve_mapping = "Standard", "None", 0, 1, False


def prepare(job, report):
    """Sets the scene up as the job asks. Nothing of it is saved."""
    heed(job, report)
    scene = choose(job)
    heed_scene(job, scene, report)
    if scene.render.engine != ENGINE:
        plain(scene)
    scene.render.engine = ENGINE
    for id_, value in job["values"].items():
        mute(scene, f"encre.{id_}")
        properties.set_value(scene.encre, id_, value)
    if not any(layer.use for layer in scene.view_layers):
        raise EncreError(f"{job['scene']}: scene {scene.name} renders none of its view layers; switch one on or "
                         "give --view-layer")
    camera = scene.camera
    if not camera or camera.type != "CAMERA":
        raise EncreError(f"{job['scene']}: scene {scene.name} has no camera; add one and make it the scene's active "
                         "camera")
    settings = properties.settings(scene)
    if words := settings.in_vain(job["named"]):
        report("note", text=words)
    images.load(settings)
    if camera.data.type not in ("PERSP", "ORTHO") and settings.active:
        kind = "panoramic" if camera.data.type == "PANO" else "one of Open Shading Language"
        raise EncreError(f"{job['scene']}: camera {camera.name} is {kind}; make it perspective or orthographic")
    if job["samples"]:
        mute(scene, "cycles.samples")
        mute(scene, "encre.samples")
        scene.cycles.samples, scene.encre.samples = job["samples"], 0
        if settings.fast:
            report("note", text="--samples changes nothing here: the picture is rendered fast, without Cycles; give "
                   "--full")
    if job["size"]:
        scene.render.resolution_x, scene.render.resolution_y = job["size"]
        scene.render.resolution_percentage = 100
    width, height = (size * scene.render.resolution_percentage // 100
                     for size in (scene.render.resolution_x, scene.render.resolution_y))
    if words := settings.blots(height):
        report("note", text=words)
    picture = scene.render.image_settings
    exr = job["ending"].lower() == ".exr"
    if not exr and settings.active and scene.view_settings.view_transform not in ("Standard", "Raw"):
        report("note", text=f"{job['scene']}: the view transform {scene.view_settings.view_transform} of scene "
               f"{scene.name} makes white paper gray and washes out ink; choose Standard in its Color Management")
    if hasattr(picture, "media_type"):  # Blender 5: the formats on offer depend on it
        picture.media_type = "MULTI_LAYER_IMAGE" if exr else "IMAGE"
    picture.file_format = "OPEN_EXR_MULTILAYER" if exr else "PNG"
    picture.color_mode, picture.color_depth = "RGBA", "32" if exr else "8"
    if exr:
        picture.views_format = "MULTIVIEW"  # both eyes in one file
    elif scene.render.use_multiview:
        for view in scene.render.views:  # their words end the file's name
            if re.search(r"[/\\\0]", view.file_suffix):
                raise EncreError(f"{job['scene']}: view {view.name} has the file suffix {view.file_suffix}, which "
                                 "leads into another folder; change it")
    scene.render.use_file_extension = True
    if exr and "save_layers" not in job["values"] and scene.encre.save_layers == "AUTO" and properties.active(scene):
        scene.encre.save_layers = "SLIM"
    if exr and scene.encre.save_layers == "SLIM":
        mute(scene, "encre.save_layers")
        if width * height <= MOST_PLAIN:  # frames.py packs it, once
            picture.exr_codec = "NONE"
    wanted.refuse_long_names(scene)
    return scene


def asked(scene):
    """`view layer.pass` of what the scene's maker wants in files and slim ones would else do without."""
    for layer in scene.view_layers:
        yield from (f"{layer.name}.{name}" for name, wants in wanted.switched_on(layer).items() if wants)


def suffixes(scene):
    """What Blender puts before the endings of a picture's files."""
    picture = scene.render.image_settings
    if not scene.render.use_multiview or picture.file_format != "PNG" or picture.views_format != "INDIVIDUAL":
        return [""]
    return [view.file_suffix for view in scene.render.views if view.use]
