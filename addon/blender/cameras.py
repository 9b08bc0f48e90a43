# SPDX-License-Identifier: GPL-3.0-or-later
"""What is rendered, in pixels, and the camera's matrices."""

import numpy as np

from ..pen.around import Window
from ..pen.errors import EncreError


def border(render):
    """(full width, full height, the Window of it that is rendered)."""
    full_width = render.resolution_x * render.resolution_percentage // 100
    full_height = render.resolution_y * render.resolution_percentage // 100
    if not render.use_border:
        return full_width, full_height, Window(0, 0, full_width, full_height)
    # Blender multiplies in single precision and cuts the decimals off.
    x0, x1 = (int(np.float32(v) * np.float32(full_width)) for v in (render.border_min_x, render.border_max_x))
    y0, y1 = (int(np.float32(v) * np.float32(full_height)) for v in (render.border_min_y, render.border_max_y))
    return full_width, full_height, Window(x0, full_height - y1, x1 - x0, y1 - y0)


def view(camera):
    """World -> camera, 4 x 4, whatever the scale of an evaluated camera. EncreError: it is scaled to nothing."""
    placed = camera.matrix_world.normalized()
    if not placed.determinant():
        raise EncreError(f"camera {camera.name}: it or a parent of it has a scale of 0, or of no number, so that it "
                         "looks nowhere; give them another scale")
    return np.array(placed.inverted())


def views(engine, depsgraph, camera, width, height):
    """{view name: (world -> camera, camera -> clip)}, 4 x 4; the only name is "" unless stereo is on."""
    render = depsgraph.scene_eval.render
    projection = np.array(camera.calc_matrix_camera(
        depsgraph, x=width, y=height, scale_x=render.pixel_aspect_x, scale_y=render.pixel_aspect_y))
    seen = view(camera)
    if not render.use_multiview:
        return {"": (seen, projection)}
    names = (("left", "right") if render.views_format == "STEREO_3D"
             else [one.name for one in render.views if one.use])
    found, before = {}, engine.active_view_get()
    for name in names:
        engine.active_view_set(name)
        sheared = projection.copy()
        sheared[0, 2] += 2 * (engine.camera_shift_x(camera) - camera.data.shift_x)
        placed = engine.camera_model_matrix(camera)
        found[name] = np.linalg.inv(_unscaled(np.array(placed))), sheared
    engine.active_view_set(before or names[0])
    return found


def rotation(view):
    """The rotation in world -> camera, 3 x 3. Below a parent that is turned and scaled unevenly a camera's axes lean:
    then the nearest rotation."""
    turned = view[:3, :3]
    if np.abs(turned @ turned.T - np.eye(3)).max() > 5e-4:
        left, _, right = np.linalg.svd(turned)
        turned = left @ right
    return turned


def _unscaled(matrix):
    matrix = matrix.astype(np.float64)
    matrix[:3, :3] /= np.linalg.norm(matrix[:3, :3], axis=0)
    return matrix
