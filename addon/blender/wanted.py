# SPDX-License-Identifier: GPL-3.0-or-later
"""What is asked of a view layer: the passes that it has, what its file keeps, and what the file says."""

import contextlib
from dataclasses import dataclass

import bpy
import numpy as np

from ..pen import layers, metadata, saved
from ..pen.errors import EncreError
from ..pen.job import Frame
from . import images, properties, versions

series = False  # whether `encre render` may render another frame in this process
stamped = {}  # {key: text} that `encre render` has stored in each frame's file besides its settings


@dataclass
class Strokes:
    """The strokes of a view layer's picture: points of abi.STROKE_POINT, in pixels of the frame."""

    points: np.ndarray
    view: np.ndarray        # world -> camera, 4 x 4
    projection: np.ndarray  # camera -> clip
    frame: Frame
    called: dict            # number of an object -> its name


strokes: list[Strokes] | None = None  # of what is drawn from now on; None: nobody asks


def tell(points, *of):
    """Notes the strokes of a picture that was drawn, if they were asked for."""
    if strokes is not None and points is not None:
        strokes.append(Strokes(points, *of))


def keeps(scene):
    """Whether the file keeps what drawing its picture again needs."""
    mode, multilayer = scene.encre.save_layers, scene.render.image_settings.file_format == "OPEN_EXR_MULTILAYER"
    return mode in ("ON", "SLIM") or (mode == "AUTO" and multilayer and properties.active(scene))


def asked(view_layer):
    """Names of the pictures that are to be drawn besides Combined."""
    return [name for switch, name in properties.PASSES.items() if getattr(view_layer.encre, switch)]


def switched_on(view_layer):
    """{classic name: whether the scene's maker wants it} of Cycles' passes for which Encre's own stand in a file."""
    return {"DiffDir": view_layer.use_pass_diffuse_direct, "DiffInd": view_layer.use_pass_diffuse_indirect,
            **dict.fromkeys(layers.SEEN, view_layer.cycles.denoising_store_passes)}


def spare(scene, view_layer):
    """Names of the passes that a slim file of Blender's does without: noise that nobody reads takes much room."""
    if scene.encre.save_layers != "SLIM":
        return []
    return [versions.pass_name(name) for name, wants in switched_on(view_layer).items()
            if not wants and name in ("DiffDir", "DiffInd", "Denoising Depth")]


def _others_read(scene):
    """Whether something may read passes that the user has not switched on: a file of all passes, or nodes."""
    multilayer = scene.render.image_settings.file_format == "OPEN_EXR_MULTILAYER"
    return keeps(scene) or multilayer or versions.compositor(scene) is not None


def _drawn_once(scene, view_layer):
    """Whether nobody gets at what is rendered but the stages, with the settings of now."""
    return bpy.app.background and not _others_read(scene) and "Encre Light" not in asked(view_layer)


def own(scene, view_layer, parts=saved.PARTS):
    """{name: channel names} of the passes that the stages fill; parts: as saved.passes() has them."""
    return {**{name: layers.DRAWN[name] for name in asked(view_layer)},
            **(saved.passes(parts) if keeps(scene) else {})}


def passes(scene, view_layer):
    """What Cycles and the stages must have a place for: (name, channel names, kind), as register_pass() takes."""
    wanted = dict(layers.CYCLES)
    if hasattr(scene, "encre"):  # else the library was missing when Blender started
        with contextlib.suppress(EncreError):  # said when it comes to rendering
            settings = properties.settings(scene)
            seen = settings.wants_seen
            if settings.fast and not _others_read(scene):  # Blender has each pass twice for a moment
                wanted = {"Combined": layers.CYCLES["Combined"]}
            else:
                wanted |= {**(layers.BEHIND if settings.wants_parts else {}), **(layers.SEEN if seen else {})}
                if settings.fast and versions.compositor(scene) is None:
                    wanted = {name: letters for name, letters in wanted.items()
                              if versions.pass_name(name) not in spare(scene, view_layer)}
                if _drawn_once(scene, view_layer):
                    wanted = {name: letters for name, letters in wanted.items() if name not in settings.unread}
            wanted |= own(scene, view_layer, (*settings.rastered, *(["seen_depth"] if seen else [])))
    for name, channels in wanted.items():
        kind = {"X": "VALUE", "Z": "VALUE", "XYZ": "VECTOR"}.get(channels, "COLOR")
        yield versions.pass_name(name), channels, kind


_LONGEST = 63  # bytes of a channel's name in a file of Blender's, who cuts what is longer


def refuse_long_names(scene):
    """EncreError: a view layer's name is too long for the passes that its file is to keep, which nothing could read."""
    if (scene.render.image_settings.file_format != "OPEN_EXR_MULTILAYER" or not hasattr(scene, "encre")
            or not keeps(scene)):  # without the library there are no settings
        return
    eyes = [view.name for view in scene.render.views if view.use] if scene.render.use_multiview else []
    eye = max((len(name.encode()) + 1 for name in eyes), default=0)
    for layer in scene.view_layers:
        room = _LONGEST - eye - max(len(f".{name}.X") for name in own(scene, layer))
        if layer.use and len(layer.name.encode()) > room:
            raise EncreError(f"view layer {layer.name}: its name takes {len(layer.name.encode())} bytes, and a file "
                             f"that keeps layers has room for {room}: give it a shorter name")


def _view(scene):
    """How Blender shows what it saves of the scene."""
    given = scene.render.image_settings if scene.render.image_settings.color_management == "OVERRIDE" else scene
    view = given.view_settings
    beside = {"curves": view.use_curve_mapping, "white balance": getattr(view, "use_white_balance", False)}
    return metadata.View(view.view_transform, view.exposure, view.gamma, "" if view.look == "None" else view.look,
                         given.display_settings.display_device, [name for name, used in beside.items() if used])


def beside(scene, loaded, cut):
    """What metadata.write() stores besides the settings: how the scene is shown, images that are no files, of those
    that images.load() gave, and what a restyled picture will lack."""
    return {"view": _view(scene),
            "images": images.held(loaded),
            "lost": [*(["Freestyle's strokes"] if scene.render.use_freestyle else []),
                     *(["the ends of lines at the border"] if cut else [])]}
