# SPDX-License-Identifier: GPL-3.0-or-later
"""Scenes as `encre render` sets them up: what it chooses of them, and what it finds amiss."""

import os
import sys

import bpy
import studio
from studio import fact

JOB = {"scene": "shot.blend", "ending": ".png", "values": {}, "samples": None, "size": None, "scene_name": None,
       "camera": None, "view_layer": None, "threads": None, "device": None, "strict": False, "autoexec": False,
       "passes": (), "named": ()}


def stage():
    """One of which nothing is said."""
    scene = studio.stage()
    scene.view_settings.view_transform = "Standard"
    return scene


def said(name, scene, **job):
    """Tells what preparing the scene says, and what it raises with --strict."""
    from encre.cli import staging
    from encre.pen.errors import EncreError

    words = []
    staging.prepare({**JOB, **job}, lambda kind, text: words.append((kind, text)))
    fact(f"{name} said", words)
    try:
        staging.prepare({**JOB, **job, "strict": True}, lambda kind, text: None)
        fact(f"{name} strict", None)
    except EncreError as error:
        fact(f"{name} strict", str(error))


def camera_of_markers(out):
    from encre.cli import staging

    scene = stage()
    other = bpy.data.objects.new("Other", scene.camera.data)
    scene.collection.objects.link(other)
    for frame, camera in (1, scene.camera), (4, other):
        scene.timeline_markers.new(camera.name, frame=frame).camera = camera
    staging.prepare({**JOB, "camera": "Camera"}, print)
    seen = []
    for frame in (1, 4, 6):
        scene.frame_set(frame)
        seen.append(scene.camera.name)
    fact("cameras", seen)


def _compositor(scene):
    """Its tree, without nodes."""
    from encre.blender import versions

    if hasattr(scene, "compositing_node_group"):
        scene.compositing_node_group = bpy.data.node_groups.new("Compositing", "CompositorNodeTree")
    else:
        scene.use_nodes = True
    tree = versions.compositor(scene)
    tree.nodes.clear()
    return tree


def compositor_of_other_layers(out):
    scene = stage()
    scene.view_layers.new("Other")
    tree = _compositor(scene)
    read, blur = tree.nodes.new("CompositorNodeRLayers"), tree.nodes.new("CompositorNodeBlur")
    read.layer = "ViewLayer"
    tree.links.new(read.outputs["Image"], blur.inputs[0])
    said("compositor", scene, view_layer="Other")
    said("own layer", scene, view_layer="ViewLayer")
    scene.render.use_compositing = False
    said("switched off", scene, view_layer="Other")


def other_outputs(out):
    """A compositor that writes files, and a sequencer."""
    scene = stage()
    scene.sequence_editor_create()
    said("no strips", scene)
    tree = _compositor(scene)
    read, write = tree.nodes.new("CompositorNodeRLayers"), tree.nodes.new("CompositorNodeOutputFile")
    place = os.path.join(out, "taken")
    if hasattr(write, "base_path"):
        write.base_path = place
    else:
        write.directory = place
        write.file_output_items.new("RGBA", "Image")
    tree.links.new(read.outputs["Image"], write.inputs[0])
    said("free", scene)
    open(place, "w").close()
    said("taken", scene)
    write.mute = True
    said("muted", scene)
    editor = scene.sequence_editor
    strips = editor.strips if hasattr(editor, "strips") else editor.sequences
    strips.new_effect("Colour", "COLOR", 1, 1, **({"length": 9} if bpy.app.version >= (5, 0) else {"frame_end": 9}))
    said("strips", scene)


def view_transforms(out):
    """One that makes paper grey, in layers and in a PNG."""
    scene = stage()
    scene.view_settings.view_transform = "Filmic"
    said("layers", scene, ending=".exr")
    said("washed out", scene)
    scene.view_settings.view_transform = "Standard"
    said("standard", scene)
    view = scene.view_settings
    view.view_transform, view.exposure, scene.render.engine = "Filmic", 2, "CYCLES"
    said("another engine", scene)
    fact("another engine", [view.view_transform, view.exposure])


def files_amiss(out):
    """Textures, caches and styles; a sequence's of the frame."""
    from encre.cli import needed

    scene = stage()
    made = bpy.data.images.new("made", 64, 64)
    made.filepath_raw, made.file_format = os.path.join(out, "whole.png"), "PNG"
    made.pixels = [k % 7 / 7 for k in range(64 * 64 * 4)]
    made.save()
    with open(made.filepath_raw, "rb") as file:
        whole = file.read()
    contents = {"empty.png": b"", "cut.png": whole[:len(whole) // 2], "sq.0001.png": whole, "sq.0003.png": whole}
    for name, content in contents.items():
        with open(os.path.join(out, name), "wb") as file:
            file.write(content)
    scene.objects["Cube"].encre.style = "Nope"
    said("style", scene)
    scene.objects["Cube"].encre.style = ""
    for name in ("whole.png", "empty.png", "cut.png"):
        bpy.data.images.load(os.path.join(out, name)).use_fake_user = True
    said("textures", scene)
    for image in [image for image in bpy.data.images if image.use_fake_user]:
        bpy.data.images.remove(image)
    volume = bpy.data.volumes.new("Smoke")
    volume.filepath, volume.use_fake_user = os.path.join(out, "smoke.vdb"), True
    said("volume", scene)
    bpy.data.volumes.remove(volume)
    mat = bpy.data.materials.new("Flip book")
    mat.use_nodes = True
    node = mat.node_tree.nodes.new("ShaderNodeTexImage")
    node.image = bpy.data.images.load(os.path.join(out, "sq.0001.png"))
    node.image.source, node.image_user.frame_duration, node.image_user.use_auto_refresh = "SEQUENCE", 3, True
    scene.objects["Cube"].data.materials.clear()
    scene.objects["Cube"].data.materials.append(mat)
    said("sequence", scene)
    for frame in (1, 2, 3):
        scene.frame_set(frame)
        fact("frames", needed.lost_now(scene, True))


def failing_scripts(out):
    from encre.cli import inside

    def failing(scene, *_):
        if scene.frame_current == 2:
            raise ValueError("the rig is gone")

    scene, words, hook = stage(), [], sys.excepthook
    bpy.app.handlers.frame_change_pre.append(failing)
    for strict in (False, True):
        amiss = inside.Amiss(strict, lambda kind, text: words.append((kind, text)))
        for frame in (1, 2, 2):
            scene.frame_set(frame)
            fact(f"strict {strict}", amiss.found(f"frame {frame}"))
        sys.excepthook = hook
    fact("words", words)
    bpy.app.handlers.frame_change_pre.remove(failing)
