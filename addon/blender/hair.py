# SPDX-License-Identifier: GPL-3.0-or-later
"""Hair, of particles and as curves -> triangles: along each strand a tube of three sides, which from wherever it is
seen is nearly as wide as the round strand, for light; and ribbons, which turn to who looks, as Cycles' do."""

import functools

import numpy as np

from ..pen.job import EDGES, edge_kinds
from ..pen.ribbons import Ribbons
from .attributes import get
from .triangles import Triangles

_SIDES = 3
_WIDER = 2 * np.pi / (3 * np.sqrt(3))  # the tube's corners are farther out than the strand: on the mean it is as wide
_RADIUS = 0.005                        # what Cycles takes for that of curves that tell none
_FEWEST = 8                            # pieces that a tube of less has, by Catmull-Rom's curve as in Cycles
_PIECES = 5  # of a ribbon between two points of a strand, as Cycles has Embree cut it
_MOST = 64   # of a strand, about: of more points each has fewer


def of(instance, rendered):
    """[(key, blocks that it is made of, a function that gives its Triangles or None)] of the strands of an instance.
    rendered: whether hair is as it is rendered, not as the viewport has it."""
    obj, found = instance.object, []
    if obj.type == "CURVES" and instance.show_self:
        key = "curves", obj.data.as_pointer(), obj.data.name_full, obj.original.as_pointer()
        found.append((key, (), functools.partial(_of_curves, obj)))
    for modifier in obj.modifiers if instance.show_particles and len(obj.particle_systems) else ():
        if is_strands(modifier, rendered):
            system = modifier.particle_system
            key = "particles", obj.original.as_pointer(), system.name, rendered
            found.append((key, (system.settings,), functools.partial(_of_particles, obj, system, rendered)))
    return found


def is_strands(modifier, rendered):
    if modifier.type != "PARTICLE_SYSTEM" or not (modifier.show_render if rendered else modifier.show_viewport):
        return False
    settings = modifier.particle_system.settings
    return settings.type == "HAIR" and settings.render_type == "PATH"


# Strands

def _of_curves(obj):
    curves = obj.data
    position, radius = (curves.attributes.get(name) for name in ("position", "radius"))
    if position is None or not len(position.data):
        return None
    points = get(position.data, "vector", np.float32, 3)
    radius = (get(radius.data, "value", np.float32) if radius is not None and len(radius.data) == len(points)
              else np.full(len(points), _RADIUS, np.float32))
    first = get(curves.curves, "first_point_index", np.int32)
    return tubes(points, radius, first, np.diff(np.append(first, len(points))))


def _of_particles(obj, system, rendered):
    settings = system.settings
    parents, children = len(system.particles), len(system.child_particles)
    if not rendered:
        children = int(children * settings.display_percentage / 100)
    first = parents if settings.child_type != "NONE" and children else 0  # parents of children are not shown
    steps = 2 ** (settings.render_step if rendered else settings.display_step) + 1
    if settings.kink == "SPIRAL":
        steps += settings.kink_extra_steps
    count = parents + children - first
    if not count:
        return None
    place, at = functools.partial(system.co_hair, object=obj), range(steps)
    points = np.array([place(particle_no=k, step=step)[:] for k in range(first, first + count) for step in at])
    points = points.reshape(count, steps, 3)
    for step in range(1, steps):  # a strand that ends early has no more points, and of these Blender says 0
        ended = ~points[:, step].any(1)
        points[ended, step] = points[ended, step - 1]
    world = np.linalg.inv(np.array(obj.matrix_world, np.float64))
    points = points @ world[:3, :3].T + world[:3, 3]
    radius = _thickness(settings, points)
    made = tubes(points.reshape(-1, 3).astype(np.float32), radius.reshape(-1), np.arange(count) * steps,
                 np.full(count, steps))
    slot = max(0, min(settings.material, len(obj.material_slots)) - 1)
    if made is not None and slot:
        made.material = np.full(len(made.corners), slot, np.int32)
    return made


def _thickness(settings, points):
    """Radii (strands, steps), as Cycles makes them."""
    along = np.linalg.norm(np.diff(points, axis=1), axis=2).cumsum(1)
    left = np.ones(points.shape[:2])
    left[:, 1:] -= along / np.maximum(along[:, -1:], 1e-30)
    shape = settings.shape
    left = np.maximum(left, 0) ** (1 + shape if shape < 0 else 1 / (1 - min(shape, 0.9999)))
    radius = settings.tip_radius + left * (settings.root_radius - settings.tip_radius)
    if settings.use_close_tip:
        radius[:, -1] = 0
    return (radius * settings.radius_scale / 2).astype(np.float32)


# Tubes

def tubes(points, radius, first, count):
    """The Triangles of strands: points (n, 3) and radii (n,), of which each strand has `count` from `first` on, one
    strand after the other. None: there is none."""
    kept = count > 1
    first, count = first[kept], count[kept]
    if not len(count):
        return None
    ribbons = _ribbons(points, radius, first, count)
    pieces = max(1, round(_FEWEST / max(1, count.max() - 1)))
    points, along, radius, first, count = _curved(points, radius, first, count, pieces)
    side = _sides(along, first, count)
    turns = 2 * np.pi * np.arange(_SIDES, dtype=np.float32) / _SIDES
    normals = (side[:, None] * np.cos(turns)[:, None] + np.cross(along, side)[:, None] * np.sin(turns)[:, None])
    ring = (points[:, None] + _WIDER * radius[:, None, None] * normals).astype(np.float32)
    begin = np.delete(np.arange(len(points)), first + count - 1)
    a, b = (_SIDES * begin[:, None] + np.roll(np.arange(_SIDES), -k) for k in (0, 1))
    corners = np.stack([a, b, b + _SIDES, a, b + _SIDES, a + _SIDES], -1).reshape(-1, 3)
    ring, normals = ring.reshape(-1, 3), normals.reshape(-1, 3).astype(np.float32)
    one, two, three = ring[corners].transpose(1, 0, 2)
    corners = corners[np.cross(two - one, three - one).any(1)].astype(np.int32)  # at tips and where points coincide
    if not len(corners):
        return None
    none = edge_kinds(np.full((1, 3), EDGES["none"])).repeat(len(corners))
    return Triangles(ring, corners, None, None, None, 1, np.empty((0, 2), np.int32), none, normals[corners], {}, {},
                     None, None, None, ribbons)


def _ribbons(points, radius, first, count):
    pieces = max(1, min(_PIECES, _MOST // max(1, count.max() - 1)))
    points, along, radius, first, count = _curved(points, radius, first, count, pieces)
    begin = np.delete(np.arange(len(points)), first + count - 1)
    begin = begin[(points[begin] != points[begin + 1]).any(1) & ((radius[begin] > 0) | (radius[begin + 1] > 0))]
    return Ribbons(points.astype(np.float32), along.astype(np.float32), radius.astype(np.float32), begin)


def _curved(points, radius, first, count, pieces):
    """(points, unit vectors along them, radii, first, count) of the same strands with so many pieces between two
    points."""
    place = np.concatenate([np.arange(f, f + c) for f, c in zip(first, count, strict=True)]) if (
        count.sum() < len(points)) else np.arange(len(points))
    values = np.concatenate([points, radius[:, None]], 1)[place]
    first = np.cumsum(count) - count
    strand = np.repeat(np.arange(len(count)), count)
    ends = first + count - 1
    begin = np.delete(np.arange(len(values)), ends)
    of = strand[begin]
    p0, p1, p2, p3 = (values[k][:, None] for k in (np.maximum(begin - 1, first[of]), begin, begin + 1,
                                                   np.minimum(begin + 2, ends[of])))
    bends, twists = 2 * p0 - 5 * p1 + 4 * p2 - p3, 3 * (p1 - p2) + p3 - p0
    t = (np.arange(pieces + 1, dtype=np.float32) / pieces)[:, None]
    curve = p1 + t / 2 * (p2 - p0 + t * (bends + t * twists))
    along = (p2 - p0 + t * (2 * bends + 3 * t * twists))[..., :3]
    along = np.where(along.any(2, keepdims=True), along, (p2 - p1)[..., :3])
    finer = (count - 1) * pieces + 1
    starts = np.cumsum(finer) - finer
    out = np.empty((finer.sum(), 7), np.float32)
    # The last piece's end is overwritten by the next one's beginning, but for a strand's last.
    for k in (pieces, *range(pieces)):
        out[starts[of] + (begin - first[of]) * pieces + k] = np.concatenate([curve[:, k], along[:, k]], 1)
    return out[:, :3], _unit(out[:, 4:]), np.maximum(out[:, 3], 0), starts, finer


def _sides(along, first, count):
    """Unit vectors (n, 3) across the strands, which turn no more than the strands do."""
    side = _across(along)
    for step in range(1, count.max()):
        here = first[count > step] + step
        way = along[here]
        turned = side[here - 1] - np.einsum("ij,ij->i", side[here - 1], way)[:, None] * way
        usable = np.einsum("ij,ij->i", turned, turned) > 1e-6
        side[here[usable]] = _unit(turned[usable])
    return side


def _across(along):
    """Any unit vectors (n, 3) across these."""
    axis = np.zeros_like(along)
    axis[np.arange(len(along)), abs(along).argmin(1)] = 1
    return _unit(np.cross(along, axis))


def _unit(vectors):
    return vectors / np.maximum(np.linalg.norm(vectors, axis=1, keepdims=True), 1e-30)
