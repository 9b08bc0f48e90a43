# SPDX-License-Identifier: GPL-3.0-or-later
"""Where smoke and fog are seen, whose light is noisy and of which no pass of surfaces tells."""

from dataclasses import dataclass

import numpy as np

from ..pen.around import Window
from . import filters, trees, worlds
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


@dataclass
class Fog:
    """What is evenly foggy: how much of the light goes in a unit of length, the colour of what comes instead, and
    where: a box in its own space (low, high) and the matrix from the world to it; None: everywhere."""

    density: float
    color: np.ndarray
    box: np.ndarray | None = None
    into: np.ndarray | None = None

    def length(self, eye, rays, depths):
        """How much of the ways (n,) from the eye, or from as many (n, 3), along unit rays (n, 3) is in it."""
        if self.box is None:
            return depths
        start, way = eye @ self.into[:3, :3].T + self.into[:3, 3], rays @ self.into[:3, :3].T
        with np.errstate(divide="ignore", invalid="ignore"):
            ends = (self.box[:, None] - start) / way
        near, far = np.nanmax(ends.min(0), 1), np.nanmin(ends.max(0), 1)
        return np.maximum(np.minimum(far, depths) - np.maximum(near, 0), 0)


def fogs(depsgraph, light):
    """The Fogs of a scene, and the names of materials and worlds whose volumes are none. light: the colour (3,) of what
    shines on it from all sides."""
    found, unread = [], []
    world, override = filters.world(depsgraph), filters.override(depsgraph)
    things = [(world, None, None)] if _scatters(world) else []
    for instance in depsgraph.object_instances:
        obj = instance.object
        if not instance.show_self or obj.type not in MESHABLE or not obj.visible_camera:
            continue
        for block in filter(_scatters, filters.materials(obj, override)):
            box, into = np.array(obj.bound_box, np.float64)[[0, 6]], np.array(instance.matrix_world.inverted_safe())
            things.append((block, box, into))
    for block, box, into in things:
        try:
            out = block.node_tree.get_output_node("CYCLES")
            if box is not None and not trees.fills_only(out):
                raise trees.Unknown("a volume in a surface")
            density, color = _even(out.inputs["Volume"])
            found.append(Fog(density, color * light, box, into))
        except Exception:  # of whatever kind: it is not shown
            if block.name not in unread:
                unread.append(block.name)
    return found, unread


def _even(socket):
    """(density, colour of what scatters) of a volume that is the same everywhere. Unknown: it is not."""
    source = trees.source_of(socket)
    if source is None or trees.is_nothing(source[0]):
        return 0.0, np.zeros(3)
    node = source[0]
    kind = node.bl_idname.removeprefix("ShaderNode")
    if kind == "AddShader":
        parts = [_even(node.inputs[k]) for k in (0, 1)]
        density = sum(part[0] for part in parts)
        return density, sum(share * color for share, color in parts) / max(density, 1e-12)
    if kind not in ("VolumeScatter", "VolumeAbsorption", "VolumePrincipled"):
        raise trees.Unknown(node.name)
    density, color = worlds.value(node.inputs["Density"], worlds.SEEN), worlds.color(node.inputs["Color"])
    return max(density, 0.0), np.zeros(3) if kind == "VolumeAbsorption" else color


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
