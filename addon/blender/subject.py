# SPDX-License-Identifier: GPL-3.0-or-later
"""How far away what the picture is about stands: relative distances of lines are multiples of that.

It must not pump while things move, nor change with what the frame happens to show, or tiles and shots would not match.
So it is the focus where the user has set one; else it follows from the size of the scene, of which neither a ground to
the horizon nor what moves counts. A long lens from afar and a short one from near by, which frame the same, have the
same pen: the distance is that at which a size fills the frame, whatever the lens.
"""

from dataclasses import dataclass

import numpy as np

from . import filters, meter
from .attributes import get
from .triangles import MESHABLE

_FILLS = 3.2  # sizes in the height of the frame; by eye, between rooms, streets and single things
_NOWHERE = 1e18  # scene units from which on something is broken: their squares are no numbers in single precision
_SHAPES_MOVE = {"ARMATURE", "CLOTH", "DYNAMIC_PAINT", "EXPLODE", "FLUID", "HOOK", "LATTICE", "MESH_CACHE",
                "MESH_DEFORM", "MESH_SEQUENCE_CACHE", "OCEAN", "SOFT_BODY", "SURFACE_DEFORM", "WAVE"}


@dataclass
class Subject:
    """What of a scene tells the distance, whatever looks at it."""

    place: np.ndarray | None = None  # the focus, in world space
    focus: float = 0.0               # its distance, where it is set as a number
    size: float = 0.0
    light: float = 0.0               # that is full light, and of the shade: meter.py
    shade: float = 0.0

    def distance(self, view, projection):
        """In scene units along the axis of a perspective camera; 0 where there is nothing to tell it from. `view`,
        `projection`: as cameras.views() gives them."""
        if self.place is not None and (ahead := -float((view @ self.place)[2])) > 0:
            return ahead
        return self.focus or 0.5 * _FILLS * self.size * float(projection[1, 1])


def read(depsgraph, camera=None, drawn=None):
    """The Subject of a scene; camera: an evaluated one whose focus counts; drawn: the lamps.Light, all of it placed."""
    things = Things(depsgraph)
    size, metered = things.size(), meter.read(filters.world(depsgraph), things.lamps, things, drawn)
    light, shade = metered.light, metered.shade
    meter.found[depsgraph.scene.name_full] = metered
    focus = camera and camera.data.dof
    if focus and focus.focus_object:
        place = np.append(focus.focus_object.evaluated_get(depsgraph).matrix_world.translation, 1)
        return Subject(place, size=size, light=light, shade=shade)
    if focus and focus.id_data.original.dof.use_dof:  # of the evaluated camera it is switched off
        return Subject(focus=float(focus.focus_distance), light=light, shade=shade)
    return Subject(size=size, light=light, shade=shade)


def _bounds(obj):
    """The two ends of an evaluated object's box in its own coordinates, of one without points far out."""
    if obj.type == obj.original.type and isinstance(obj.data, type(obj.original.data)):
        box = np.array(obj.bound_box, np.float64)
        return box[0], box[6]
    # Blender never frees the box of what passes for a curve; and nodes leave curves, points and volumes beside meshes.
    vertices = getattr(obj.data, "vertices", ())
    points = get(vertices, "co", np.float32, 3) if len(vertices) else ()
    return (points.min(0).astype(np.float64), points.max(0).astype(np.float64)) if len(points) else (2 * _NOWHERE,) * 2


class Things:
    """What stands in a scene. boxes (n, 4, 3): middles and three half axes; places (n, 3), radii (n,); still: whether
    nothing may move it; lamps: (object, matrix) pairs."""

    def __init__(self, depsgraph):
        boxes, still, self._moving, self.lamps = [], [], {}, []
        for instance in depsgraph.object_instances:
            obj = instance.object
            if not instance.show_self or obj.type not in (*MESHABLE, "LIGHT"):
                continue
            matrix = np.array(instance.matrix_world)
            if obj.type == "LIGHT":
                self.lamps.append((obj, matrix))
                continue
            low, high = _bounds(obj)
            if not (np.isfinite(matrix).all() and np.abs([low, high]).max() < _NOWHERE):
                continue
            boxes.append([matrix[:3, :3] @ (low + high) / 2 + matrix[:3, 3], *(matrix[:3, :3] * (high - low) / 2).T])
            owner = (instance.parent if instance.is_instance else obj).original
            still.append(not self.moved((owner, obj.original)))
        self.boxes = np.reshape(boxes, (-1, 4, 3))
        self.places, self.radii = self.boxes[:, 0], np.linalg.norm(self.boxes[:, 1:].sum(1), axis=1)
        self.still = np.array(still, bool)

    def moved(self, originals):
        """Whether something may move or bend any of these objects."""
        for obj in originals:
            if obj.name_full not in self._moving:
                self._moving[obj.name_full] = _moves(obj)
        return any(self._moving[obj.name_full] for obj in originals)

    def size(self):
        """Of the scene: between the radius within which half of what stands still lies and that of its things, because
        a picture shows some things of a scene, seldom all and seldom one. Where all moves, that of the things."""
        if not len(self.places):
            return 0.0
        if not self.still.any():
            return _middle(self.radii)
        places, radii = self.places[self.still], self.radii[self.still]
        away = radii + np.linalg.norm(places - np.median(places, 0), axis=1)
        return float(np.sqrt(_middle(radii) * _middle(away)))


def _middle(values):
    """The median, of two the smaller: a thing on a large ground counts."""
    return float(np.sort(values)[(len(values) - 1) // 2])


def _moves(obj):
    """Whether something may move or deform an object."""
    while obj:
        shapes = getattr(obj.data, "shape_keys", None)
        if (_animated(obj) or _animated(shapes) or len(obj.constraints) or obj.parent_type == "BONE"
                or (obj.rigid_body and obj.rigid_body.type == "ACTIVE")
                or any(modifier.type in _SHAPES_MOVE for modifier in obj.modifiers)):
            return True
        obj = obj.parent
    return False


def _animated(block):
    data = block.animation_data if block else None
    return bool(data and (data.action or len(data.drivers) or len(data.nla_tracks)))
