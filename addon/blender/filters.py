# SPDX-License-Identifier: GPL-3.0-or-later
"""What a view layer leaves out or has instead, and how the film is exposed, as Cycles takes it."""

import numpy as np


def override(depsgraph):
    """The material that all surfaces of a view layer have, None: each has its own."""
    return depsgraph.view_layer_eval.material_override


def materials(obj, override):
    """The materials of an evaluated object, slot by slot; what has no slot has one material, or none at all (None)."""
    return [override or slot.material for slot in obj.material_slots] or [override]


def surfaces(depsgraph):
    """Whether a view layer shows surfaces, which without it throw no shadows either."""
    return depsgraph.view_layer_eval.use_solid


def hair(depsgraph):
    """Likewise hair."""
    return depsgraph.view_layer_eval.use_strand


def world(depsgraph):
    """The evaluated world that a view layer has, None: nothing is behind it and lights it."""
    layer = depsgraph.view_layer_eval
    if not layer.use_sky:
        return None
    return getattr(layer, "world_override", None) or depsgraph.scene_eval.world  # since 4.3


def exposure(depsgraph):
    """By what the film multiplies all light."""
    return depsgraph.scene_eval.cycles.film_exposure


def culled(depsgraph):
    """A function of (evaluated object, its matrix): whether Cycles leaves it out as it is too far away. What is to be
    left out only where the camera does not see it either throws but shadows then, and stays."""
    scene, camera = depsgraph.scene_eval, depsgraph.scene.camera
    if not (scene.render.use_simplify and scene.cycles.use_distance_cull and camera):
        return lambda _obj, _matrix: False
    eye, most = np.array(camera.evaluated_get(depsgraph).matrix_world)[:3, 3], scene.cycles.distance_cull_margin

    def far(obj, matrix):
        if not obj.cycles.use_distance_cull or (scene.cycles.use_camera_cull and obj.cycles.use_camera_cull):
            return False
        box, matrix = np.array(obj.bound_box), np.array(matrix)
        corners = box @ matrix[:3, :3].T + matrix[:3, 3]
        return bool(np.linalg.norm(eye - np.clip(eye, corners.min(0), corners.max(0))) > most)

    return far


def told(depsgraph):
    """All that is read here; equal where it is the same."""
    scene = depsgraph.scene_eval
    return [surfaces(depsgraph), hair(depsgraph), exposure(depsgraph), scene.render.use_simplify,
            scene.cycles.use_distance_cull, scene.cycles.distance_cull_margin, scene.cycles.use_camera_cull,
            *(block and block.name_full for block in (override(depsgraph), world(depsgraph)))]
