# SPDX-License-Identifier: GPL-3.0-or-later
"""What a file says of a scene besides its settings."""

from ..pen import metadata
from . import papers


def _view(scene):
    """How Blender shows what it saves of the scene."""
    given = scene.render.image_settings if scene.render.image_settings.color_management == "OVERRIDE" else scene
    view = given.view_settings
    beside = {"curves": view.use_curve_mapping, "white balance": getattr(view, "use_white_balance", False)}
    return metadata.View(view.view_transform, view.exposure, view.gamma, "" if view.look == "None" else view.look,
                         given.display_settings.display_device, [name for name, used in beside.items() if used])


def of(scene, settings, cut):
    """What metadata.write() stores besides the settings: how the scene is shown, a paper that is no file, and what a
    restyled picture will lack."""
    paper = settings.paper and papers.stored(settings.paper)
    return {"view": _view(scene),
            "paper": paper,
            "lost": [*(["Freestyle's strokes"] if scene.render.use_freestyle else []),
                     *(["the ends of lines at the border"] if cut else [])]}
