# SPDX-License-Identifier: GPL-3.0-or-later
"""The picture that image editors show while a setting is dragged, drawn from the layers in memory by the library's own
threads: an image of ours in the place of the render result, which follows when the setting rests (redraw.py).

Blender gives the result's pixels to nobody but a render, whose start alone takes longer than drawing. The compositor is
left out, and light that would have to be cleaned anew stays as clean as it was.
"""

import bpy
import numpy as np

from ..pen import supersample
from ..pen.background import Background, Course
from ..pen.errors import Cancelled, EncreError
from ..pen.shown import Drawing, Wish, picture
from . import drawing, images

_NAME, _OURS = "Encre", "encre_instant"  # the image's, and the property that tells it from a user's


def result():
    """Blender's image of the render result; None: nothing was rendered yet."""
    return next((image for image in bpy.data.images if image.type == "RENDER_RESULT"), None)


def editors():
    """The spaces of image editors that show the render result, or the picture in its place."""
    for window in bpy.context.window_manager.windows:
        for area in window.screen.areas:
            image = area.spaces.active.image if area.type == "IMAGE_EDITOR" else None
            if image and (image.type == "RENDER_RESULT" or _OURS in image):
                yield area.spaces.active


class Instant:
    """Pictures of the view layer `name` of a memory.Picture."""

    def __init__(self, kept, name, threads=0):
        self.kept, self.layer, self.behind = kept, kept.layers[name], Background(threads)
        self.layers = self.of = None  # those of a Cycles picture, as they were assembled for settings
        self.same = 1                 # number of the layers
        self.course = None

    def begin(self, settings):
        """Begins a picture with other settings, if they can be drawn. EncreError: they can't."""
        if self.layer.lacks(settings) or not self.layer.views:
            raise EncreError("these settings need other layers")
        self.course = Course(self.behind, self._steps(settings, images.load(settings)))

    def _steps(self, settings, read):
        before, view = self.layer.before, next(iter(self.layer.views.values()))
        if self.kept.fast:
            place = next(iter(before.places.values()))
            layers, camera, frame, factor, inside, own = (
                view.passes, place.camera, place.large, place.factor, place.inside, place.own)
        else:
            again = before.again(settings, read)
            if self.of != settings.of_layers:
                self.layers, self.of = drawing.remembered(again), settings.of_layers
                self.same += 1
            layers, camera, frame = self.layers, next(iter(before.views.values()))[0], drawing.frame_of(again)
            factor, inside, own = before.factor, before.inside, before.own
        drawn = yield from picture(Drawing(layers, camera, frame, settings, read, self.same), Wish())
        return supersample.shrink("Combined", drawn[inside], factor), own

    def go_on(self):
        """Shows the picture that was begun, once it is drawn. Whether one is still drawn."""
        try:
            if not self.course or self.course.go_on():
                return self.course is not None
            self._show(*self.course.value)
        except (Cancelled, EncreError):  # the redraw says it
            pass
        self.course = None
        return False

    def _show(self, drawn, own):
        width, height, bordered = self.kept.size[0], self.kept.size[1], self.kept.size[-1]
        if bordered:
            whole = np.zeros((height, width, 4), np.float32)
            whole[own.y:own.y + own.height, own.x:own.x + own.width] = drawn
            drawn = whole
        show(drawn)


def show(drawn):
    """Shows a picture (height, width, 4) in the place of the render result; row 0 at the top, scene-linear."""
    height, width, _ = drawn.shape
    image = next((image for image in bpy.data.images if _OURS in image), None)
    if image and tuple(image.size) != (width, height):
        bpy.data.images.remove(image)
        image = None
    if not image:
        image = bpy.data.images.new(_NAME, width, height, alpha=True, float_buffer=True)
        image[_OURS], image.use_view_as_render, image.alpha_mode = True, True, "PREMUL"
    image.pixels.foreach_set(np.ascontiguousarray(drawn[::-1]).reshape(-1))
    image.update()
    for space in editors():
        if space.image != image:
            space.image = image


def hide():
    """Shows the render result again, and leaves nothing of ours in the file."""
    mine = [image for image in bpy.data.images if _OURS in image]
    if not mine:
        return
    for space in list(editors()):
        if _OURS in space.image:
            space.image = result()
    for image in mine:  # undo may have brought back another
        bpy.data.images.remove(image)
