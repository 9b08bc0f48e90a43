# SPDX-License-Identifier: GPL-3.0-or-later
"""The camera of scenes by formula."""

from dataclasses import dataclass

import numpy as np


@dataclass
class Camera:
    eye: np.ndarray
    view: np.ndarray  # (3, 3) world to camera: x right, y up, looking along -z
    focal: float = 1.2  # in frame heights
    height: float = 0.0  # of the frame in scene units: orthographic
    shift: tuple = (0.0, 0.0)  # pixels by which all that is seen is moved

    def rays(self, x, y, size):
        """Origins and directions (…, 3) through places of the frame; t is the depth along the view axis."""
        h, w = size
        u, v = (x - self.shift[0] - (w - 1) / 2) / h, ((h - 1) / 2 + self.shift[1] - y) / h
        if self.height:
            flat = np.stack([u * self.height, v * self.height, np.zeros_like(u)], -1)
            return self.eye + flat @ self.view, np.broadcast_to(-self.view[2], flat.shape)
        d = np.stack([u / self.focal, v / self.focal, np.full_like(u, -1.0)], -1) @ self.view
        return np.broadcast_to(self.eye, d.shape), d

    def project(self, p, size):
        """x, y and depth of points (…, 3)."""
        h, w = size
        c = (p - self.eye) @ self.view.T
        z = -c[..., 2]
        with np.errstate(divide="ignore", invalid="ignore"):
            scale = h / self.height if self.height else self.focal * h / z
            return (c[..., 0] * scale + (w - 1) / 2 + self.shift[0], (h - 1) / 2 - c[..., 1] * scale + self.shift[1], z)

    @property
    def homogeneous(self):
        return np.append(self.view[2], 0.0) if self.height else np.append(self.eye, 1.0)


def look(eye, at, roll=0.0, **more):
    """A camera at `eye` that looks at a point, turned by `roll` radians about its axis."""
    eye, at = np.asarray(eye, float), np.asarray(at, float)
    back = (eye - at) / np.linalg.norm(eye - at)
    right = np.cross([0, 1, 0], back)
    right /= np.linalg.norm(right)
    up = np.cross(back, right)
    c, s = np.cos(roll), np.sin(roll)
    return Camera(eye, np.array([c * right + s * up, c * up - s * right, back]), **more)
