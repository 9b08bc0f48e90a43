# SPDX-License-Identifier: GPL-3.0-or-later
"""Where the camera is: on its way, which the scene's animation gives, or anywhere in the room, moved by hand."""

from dataclasses import dataclass
from math import cos, pi, sin

import numpy as np
from mathutils import Euler, Matrix, Vector
from mathutils.bvhtree import BVHTree

from ...pen.errors import EncreError
from .. import cameras

_MOST_STOPS = 241   # at which the way is read; between them it is smooth
_LOOK = 0.003       # radians a pixel of the mouse
_STEEPEST = 0.49 * pi
_RADIUS = 1 / 60    # of the room's diagonal: how far from surfaces the camera stays
_SECONDS = 5        # in which it crosses the room


class Flight:
    """The way of the scene's camera, from its first frame to its last."""

    def __init__(self, scene, depsgraph_of):
        """depsgraph_of: gives the evaluated depsgraph of now. EncreError: there is no way, or nothing that flies it."""
        camera = scene.camera
        if not camera or camera.type != "CAMERA":
            raise EncreError(f"scene {scene.name} has no camera; add one and make it the scene's active camera")
        if camera.data.type == "PANO":
            raise EncreError(f"camera {camera.name}: is panoramic; make it perspective or orthographic")
        first, last, before = scene.frame_start, scene.frame_end, scene.frame_current
        count = min(last - first + 1, _MOST_STOPS)
        self.seconds = (last - first) / (scene.render.fps / scene.render.fps_base)
        self.frames = np.linspace(first, last, max(count, 1))
        self._stops, self._projections = [], []
        for frame in self.frames:
            scene.frame_set(int(frame), subframe=float(frame) % 1)
            depsgraph = depsgraph_of()
            seen = camera.evaluated_get(depsgraph)
            placed = Matrix(np.linalg.inv(cameras.view(seen)).tolist())
            self._stops.append((placed.to_translation(), placed.to_quaternion()))
            render = scene.render
            self._projections.append(np.array(seen.calc_matrix_camera(
                depsgraph, x=1600, y=900, scale_x=render.pixel_aspect_x, scale_y=render.pixel_aspect_y)))
        scene.frame_set(before)
        places = np.array([place for place, _ in self._stops])
        turns = [self._stops[0][1].rotation_difference(turn).angle for _, turn in self._stops]
        if np.ptp(places, 0).max() < 1e-4 and max(turns) < 1e-3:
            raise EncreError(f"camera {camera.name}: does not move from frame {first} to {last}, and its way is what "
                             "people are shown; give it keyframes")

    def stops(self):
        return [place for place, _ in self._stops]

    def __len__(self):
        return len(self._stops)

    def at(self, share):
        """(place, turn) at a share of the way, from 0 to 1."""
        at = min(max(share, 0), 1) * (len(self._stops) - 1)
        k = min(int(at), len(self._stops) - 2)
        (here, turn), (there, other) = self._stops[k], self._stops[k + 1]
        return here.lerp(there, at - k), turn.slerp(other, at - k)

    def projection(self, share, camera, depsgraph, width, height):
        """Camera -> clip of a picture of this size: with the lens that the camera has there."""
        wide = self._projections[round(min(max(share, 0), 1) * (len(self._stops) - 1))]
        now = np.array(camera.calc_matrix_camera(depsgraph, x=width, y=height))
        if not np.array_equal(wide, self._projections[0]):  # a lens that changes
            now[:2, :2] *= wide[:2, :2] / np.where(self._projections[0][:2, :2], self._projections[0][:2, :2], 1)
        return now


def view(place, turn):
    """World -> camera, 4 x 4."""
    return np.array((Matrix.Translation(place) @ turn.to_matrix().to_4x4()).inverted())


@dataclass
class Room:
    """What the camera can't go through, and how far it may go."""

    walls: BVHTree
    low: Vector
    high: Vector
    radius: float  # how far it stays from what is there

    @property
    def size(self):
        return (self.high - self.low).length

    @classmethod
    def of(cls, scene, stops, near):
        """scene: a fast_scene.Scene; stops: places where the camera has been, all of them inside; near: where its
        clipping starts. To each side the room goes as far as half of the looks from there do; where these meet nothing,
        to the last stop."""
        points, corners = [np.zeros((0, 3))], [np.zeros((0, 3), int)]
        for mesh in scene.objects.meshes:
            if mesh.kind != "triangles" or mesh.corners is None:
                continue
            model = np.asarray(mesh.model)
            corners.append(np.asarray(mesh.corners, int) + sum(map(len, points)))
            points.append(np.asarray(mesh.points, np.float64) @ model[:3, :3].T + model[:3, 3])
        walls = BVHTree.FromPolygons(np.concatenate(points).tolist(), np.concatenate(corners).tolist())
        places = np.array(stops)
        inner, outer = (places.min(0), places.max(0)), [places.min(0), places.max(0)]
        for axis in range(3):
            for end, choose in enumerate((min, max)):
                side = Vector([(2 * end - 1) * (k == axis) for k in range(3)])
                hits = [(stop[axis], walls.ray_cast(Vector(stop), side)[0])
                        for stop in stops[::max(1, len(stops) // 40)]]
                middle = np.median([at if hit is None else hit[axis] for at, hit in hits])
                outer[end][axis] = choose(outer[end][axis], middle)
        radius = max(np.linalg.norm(outer[1] - outer[0]) * _RADIUS, 1.5 * near)
        return cls(walls, Vector(np.minimum(inner[0], outer[0] + radius)),
                   Vector(np.maximum(inner[1], outer[1] - radius)), float(radius))

    def kept(self, here, there):
        """Where the camera comes to that wants to go from a place to another: along walls, not through them."""
        for _ in range(4):
            step = there - here
            if step.length < 1e-9:
                break
            hit, normal, *_ = self.walls.ray_cast(here, step.normalized(), step.length + self.radius)
            if hit is None:
                break
            if normal.dot(step) > 0:
                normal = -normal
            # Back to its own distance from the wall, measured across it.
            inside = (there - hit).dot(normal)
            if inside >= self.radius:
                break
            there = there + normal * (self.radius - inside)
        for _ in range(4):
            nearest, _, _, distance = self.walls.find_nearest(there, self.radius)
            if nearest is None or distance < 1e-9:
                break
            there = nearest + (there - nearest) * (self.radius / distance)
        there = Vector(np.clip(there, self.low, self.high).tolist())
        step = there - here
        if step.length > 1e-9 and self.walls.ray_cast(here, step.normalized(), step.length)[0] is not None:
            return here  # between walls that push each other's way
        return there


class Free:
    """A camera that is moved by hand: the mouse turns it, keys push it the way it looks."""

    def __init__(self, room, place, turn):
        self.room, self.place = room, place.copy()
        ahead = turn @ Vector((0, 0, -1))
        self.heading = np.arctan2(-ahead.x, ahead.y)
        self.pitch = float(np.arcsin(np.clip(ahead.z, -1, 1)))

    @property
    def turn(self):
        return Euler((self.pitch + pi / 2, 0, self.heading), "XYZ").to_quaternion()

    def look(self, right, up):
        """Turns it by pixels that the mouse has moved."""
        self.heading -= right * _LOOK
        self.pitch = min(max(self.pitch + up * _LOOK, -_STEEPEST), _STEEPEST)

    def push(self, right, ahead, up, seconds):
        """Moves it for so long."""
        way = Vector((cos(self.heading) * right - sin(self.heading) * cos(self.pitch) * ahead,
                      sin(self.heading) * right + cos(self.heading) * cos(self.pitch) * ahead,
                      sin(self.pitch) * ahead + up))
        if way.length:
            far = min(seconds, 0.2) * self.room.size / _SECONDS
            self.place = self.room.kept(self.place, self.place + way.normalized() * far)
