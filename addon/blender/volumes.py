# SPDX-License-Identifier: GPL-3.0-or-later
"""Where smoke and fog are seen, whose light is noisy and of which no pass of surfaces tells."""

import numpy as np

from ..pen.around import Window
from . import filters
from .triangles import MESHABLE


def corners(depsgraph):
    """The corners of the boxes about what has a volume, (n, 8, 3) in the world; infinite where the world has one."""
    if _scatters(filters.world(depsgraph)):
        return np.full((1, 8, 3), np.inf)
    override = filters.override(depsgraph)
    found = [(np.array(instance.matrix_world), np.array(instance.object.bound_box))
             for instance in depsgraph.object_instances if instance.show_self
             and _fills(instance.object, override)]
    return np.array([box @ matrix[:3, :3].T + matrix[:3, 3] for matrix, box in found]).reshape(-1, 8, 3)


def _fills(obj, override):
    """Whether an evaluated object fills space. Blender 3.4 crashes when it is asked for the slots of an empty."""
    if obj.type not in MESHABLE:
        return obj.type == "VOLUME"
    return any(map(_scatters, filters.materials(obj, override)))


def _scatters(block):
    """Whether a material or a world fills space."""
    if not block or not block.node_tree:
        return False
    return any(node.type in ("OUTPUT_MATERIAL", "OUTPUT_WORLD") and node.inputs["Volume"].is_linked
               for node in block.node_tree.nodes)


def window(boxes, view, projection, frame, size):
    """The Window of a picture of `size` (width, height) in a frame that shows the boxes; None: it shows none."""
    if not len(boxes):
        return None
    width, height = size
    seen = boxes.reshape(-1, 3) @ view[:3, :3].T + view[:3, 3] if np.isfinite(boxes).all() else None
    if seen is None or (projection[3, 3] != 1 and seen[:, 2].max() > -1e-3):  # about the eye or behind it
        return Window(0, 0, width, height)
    clip = np.concatenate([seen, np.ones((len(seen), 1))], 1) @ projection.T
    x = (clip[:, 0] / clip[:, 3] + 1) / 2 * frame.width - frame.x
    y = (1 - clip[:, 1] / clip[:, 3]) / 2 * frame.height - frame.y
    left, right = (int(v) for v in np.clip((np.floor(x.min()), np.ceil(x.max())), 0, width))
    top, bottom = (int(v) for v in np.clip((np.floor(y.min()), np.ceil(y.max())), 0, height))
    return Window(left, top, right - left, bottom - top) if right > left and bottom > top else None
