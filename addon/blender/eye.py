# SPDX-License-Identifier: GPL-3.0-or-later
"""What a region of the 3D view shows, in pixels."""

from dataclasses import dataclass

import numpy as np

from ..pen.around import Window
from ..pen.errors import EncreError
from ..pen.job import Frame
from . import cameras


@dataclass
class Eye:
    """What looks into the scene. Lengths are in pixels of the region, y from the top."""

    view: np.ndarray        # world -> camera, 4 x 4
    projection: np.ndarray  # camera -> clip, of the full frame
    clip: tuple             # (start, end)
    full: tuple             # (width, height) of the full frame: the camera's, or the region
    part: Window            # of it what is drawn
    place: tuple            # that in the region: left, bottom, right, top from -1 to 1
    through_camera: bool    # or a free view
    number: int             # of the frame of the animation

    @property
    def key(self):
        """Equal for eyes that see the same."""
        part = self.part
        return (self.view.tobytes(), self.projection.tobytes(), self.clip, self.full, part.x, part.y, part.width,
                part.height)

    def frame(self, scale):
        """(the Frame, (width, height) of the picture in it), both drawn at this scale."""
        x, y = (round(v * scale) for v in (self.part.x, self.part.y))
        size = tuple(max(1, round(v * scale)) for v in (self.part.width, self.part.height))
        width, height = (max(round(full * scale), at + side)
                         for full, at, side in zip(self.full, (x, y), size, strict=True))
        return Frame(width, height, x, y, self.number), size


def look(context, depsgraph):
    """(the Eye of the region that is drawn, or None: its camera or border shows nothing of it; the evaluated camera, if
    it looks through one). EncreError: nothing can be drawn from this camera."""
    space, region, seen = context.space_data, context.region, context.region_data
    width, height, render = region.width, region.height, depsgraph.scene_eval.render
    view, projection = np.array(seen.view_matrix, np.float64), np.array(seen.window_matrix, np.float64)
    if camera := _camera(space, seen, depsgraph):
        frame = _camera_frame(camera, depsgraph.scene_eval, projection, width, height)
        view = cameras.view(camera)
        clip = camera.data.clip_start, camera.data.clip_end
        projection = np.array(camera.calc_matrix_camera(depsgraph, x=max(frame.width, 1), y=max(frame.height, 1)))
        border = _border(frame, render, "border") if render.use_border else frame
    else:
        frame, clip = Window(0, 0, width, height), (space.clip_start, space.clip_end)
        if projection[3, 3]:  # orthographic: the eye may stand amid what it sees, and depths are to be above 0
            near = (1 + projection[2, 3]) / projection[2, 2]
            view[2, 3] += near
            clip = 0.0, clip[1] - near
        border = _border(frame, space, "render_border") if space.use_render_border else frame
    left, top = max(border.x, 0), max(border.y, 0)
    right, bottom = min(border.x + border.width, width), min(border.y + border.height, height)
    if left >= right or top >= bottom:
        return None, camera
    place = 2 * left / width - 1, 1 - 2 * bottom / height, 2 * right / width - 1, 1 - 2 * top / height
    return Eye(view, projection, clip, (frame.width, frame.height),
               Window(left - frame.x, top - frame.y, right - left, bottom - top), place, bool(camera),
               depsgraph.scene.frame_current), camera


def _camera(space, seen, depsgraph):
    if seen.view_perspective != "CAMERA":
        return None
    camera = space.camera if space.use_local_camera else depsgraph.scene.camera
    return camera.evaluated_get(depsgraph) if camera and camera.type == "CAMERA" else None


def _camera_frame(camera, scene, projection, width, height):
    """Where the frame of a camera lies in its view, which may be larger or smaller, to whole pixels."""
    if camera.data.type == "PANO":
        raise EncreError(f"camera {camera.name}: it is panoramic, and Encre draws only what perspective and "
                         "orthographic cameras see; make it one of them")
    corners = np.array([(*corner, 1) for corner in camera.data.view_frame(scene=scene)]) @ projection.T
    corners = (corners[:, :2] / corners[:, 3:] * (0.5, -0.5) + 0.5) * (width, height)
    start, end = (np.rint(edge).astype(int).tolist() for edge in (corners.min(0), corners.max(0)))
    return Window(*start, end[0] - start[0], end[1] - start[1])


def _border(frame, owner, name):
    """The part of a frame that lies within the border of a render or a space, shares that count from below."""
    min_x, max_x, min_y, max_y = (getattr(owner, f"{name}_{end}") for end in ("min_x", "max_x", "min_y", "max_y"))
    left, right = (frame.x + round(share * frame.width) for share in (min_x, max_x))
    top, bottom = (frame.y + round((1 - share) * frame.height) for share in (max_y, min_y))
    return Window(left, top, right - left, bottom - top)
