# SPDX-License-Identifier: GPL-3.0-or-later
"""Measures how wide baked lines are on a surface: on a cylinder whose texture is stretched along it, and on a sphere.

Spots, circles on the surface, are drawn into the texture; the ink in a sector about a spot, divided by the length of
the spot's rim in it, is the width of the line there. All lengths are texels of mean size.
"""

import numpy as np
from encre.cli import multilayer, png
from encre.pen import colour, library, unwrap
from encre.pen.job import Frame, Mesh

WIDTH, HEIGHT, THICKNESS, SECTORS = 2048, 1024, 16.0, 12
COLORS = np.float32([(0.93, 0.82, 0.55), (0.75, 0.28, 0.22)])


class Sphere:
    """Of radius 1, its texture laid on by longitude and latitude."""

    name, rim, beside = "sphere", 0.13, (2.6, -2.2, 1.3)
    spots = [((k + 0.5 * (row % 2)) / n, 0.5 + row / 8) for row in range(-3, 4)
             for n in (round(15 * np.cos(np.pi * row / 8)),) for k in range(n)]

    def at(self, u, v):
        lon, lat = 2 * np.pi * u, np.pi * (v - 0.5)
        return np.stack([np.cos(lat) * np.cos(lon), np.cos(lat) * np.sin(lon), np.sin(lat)], -1)

    def area(self, u, v):
        """Of a piece of the texture, per its own."""
        return 2 * np.pi**2 * np.cos(np.pi * (v - 0.5)) + 0 * u

    def polar(self, center, u, v):
        """Distance and direction on the surface from a point, and how much longer than its own a circle of the rim
        is than one of this distance."""
        p, c = self.at(u, v), self.at(*center)
        distance = np.arccos(np.clip(p @ c, -1, 1))
        east = np.array([-c[1], c[0], 0]) / np.hypot(c[0], c[1])
        longer = np.sin(self.rim) / np.maximum(np.sin(distance), 1e-6)
        return distance, np.arctan2(p @ np.cross(c, east), p @ east), longer


class Cylinder:
    """Of radius 1/2 and height 2; along it its texture is eight times as coarse at the top as at the bottom."""

    name, rim, beside = "cylinder", 0.13, (1.9, -2.3, 1.1)
    spots = [((k + 0.5 * (row % 2)) / 8, v) for row, v in enumerate((0.27, 0.5, 0.67, 0.8, 0.92)) for k in range(8)]

    def _height(self, v):
        return 4 * (v + 3.5 * v * v) / 9 - 1

    def at(self, u, v):
        turn = 2 * np.pi * u
        return np.stack([np.cos(turn) / 2, np.sin(turn) / 2, self._height(v)], -1)

    def area(self, u, v):
        return np.pi * 4 * (1 + 7 * v) / 9 + 0 * u

    def polar(self, center, u, v):
        x = np.pi * ((u - center[0] + 0.5) % 1 - 0.5)
        y = self._height(v) - self._height(center[1])
        distance = np.hypot(x, y)
        return distance, np.arctan2(y, x), self.rim / np.maximum(distance, 1e-6)


def mesh(surface, across=128, up=64):
    u, v = np.meshgrid(np.linspace(0, 1, across + 1), np.linspace(0, 1, up + 1))
    index = np.arange(u.size).reshape(u.shape)
    quads = np.stack([index[:-1, :-1], index[:-1, 1:], index[1:, 1:], index[1:, :-1]], -1).reshape(-1, 4)
    corners = quads[:, [0, 1, 2, 0, 2, 3]].reshape(-1, 3)
    seam = index.copy()
    seam[:, -1] = seam[:, 0]
    return unwrap.Unwrapped(surface.at(u, v).reshape(-1, 3), seam.reshape(-1)[corners],
                            np.stack([u, v], -1).reshape(-1, 2)[corners])


def texels(width=WIDTH, height=HEIGHT):
    """u and v of every texel's centre, row 0 at the top."""
    return np.meshgrid((np.arange(width) + 0.5) / width, 1 - (np.arange(height) + 0.5) / height)


def spotted(surface):
    u, v = texels()
    inside = np.zeros(u.shape, bool)
    for spot in surface.spots:
        rows = about(surface, spot)
        inside[rows] |= surface.polar(spot, u[rows], v[rows])[0] < surface.rim
    return COLORS[inside.astype(int)]


def about(surface, spot):
    """The rows of the texture that lie near a spot."""
    v = texels(1)[1]
    near = np.nonzero(surface.polar(spot, np.full_like(v, spot[0]), v)[0] < 1.5 * surface.rim)[0]
    return slice(near.min(), near.max() + 1)


def baked(surface, texture, uniform):
    settings = dict(line_thickness=THICKNESS, contrast_full=library.bake(texture, draw=False).greatest)
    form = unwrap.form(mesh(surface), WIDTH, HEIGHT) if uniform else None
    return library.bake(texture, settings, form, wrap=(True, False)).texture


def widths(surface, texture, drawn):
    """Of the line in each sector about each spot."""
    u, v = texels()
    ink = 1 - drawn[..., 0] / texture[..., 0]
    area = surface.area(u, v) / (WIDTH * HEIGHT)
    found = []
    for spot in surface.spots:
        rows = about(surface, spot)
        distance, direction, longer = surface.polar(spot, u[rows], v[rows])
        near = np.abs(distance / surface.rim - 1) < 0.44
        sector = ((direction[near] / (2 * np.pi) + 0.5) * SECTORS).astype(int) % SECTORS
        found.append(np.bincount(sector, ((ink * area)[rows] * longer)[near], SECTORS))
    circle = 2 * np.pi * (np.sin(surface.rim) if surface.name == "sphere" else surface.rim)
    return np.array(found) * SECTORS / circle / np.sqrt(area.mean())


def seen(surface, texture, size):
    """A picture of the surface with its texture, the light from the left."""
    shape, eye = mesh(surface), np.array(surface.beside)
    back = eye / np.linalg.norm(eye)
    right = np.cross((0, 0, 1), back) / np.hypot(back[0], back[1])
    axes = np.stack([right, np.cross(back, right), back])
    view = np.eye(4)
    view[:3, :3], view[:3, 3] = axes, -axes @ eye
    flat = np.diag([0.78, 0.78, -0.1, 1.0])
    fine = 4 * size
    drawn = library.raster([Mesh(shape.points[shape.corners].reshape(-1, 3), attributes=shape.uv, object_index=1)],
                        view, flat, Frame(fine, fine), (fine, fine), 0.01, channels=2)
    x = (drawn["attributes"][..., 0] % 1 * WIDTH).astype(int).clip(0, WIDTH - 1)
    y = ((1 - drawn["attributes"][..., 1]) * HEIGHT).astype(int).clip(0, HEIGHT - 1)
    light = 0.55 + 0.45 * np.clip(drawn["normal"] @ (axes.T @ (-0.5, 0.5, 0.7)), 0, 1)
    picture = np.where(drawn["object"][..., None] > 0, colour.decode_srgb(texture[y, x]) * light[..., None], 1.0)
    return picture.reshape(size, 4, size, 4, 3).mean((1, 3))


HEAD = ["| surface | lines | least | median | greatest | varies by |", "|---|---|---|---|---|---|"]


def told(surface, name, w):
    """What the table in docs/baking.md says of these widths."""
    ratio = w.max() / w.min()
    change = f"{ratio:.1f} times" if ratio > 2 else f"{100 * (ratio - 1):.0f} %"
    return f"| {surface.name} | {name} | {w.min():.1f} | {np.median(w):.1f} | {w.max():.1f} | {change} |"


def measured(folder):
    """That table, line by line; draws both surfaces into `folder`."""
    rows = list(HEAD)
    for surface in (Cylinder(), Sphere()):
        texture, row = spotted(surface), []
        for name, uniform in (("plain", False), ("uniform", True)):
            drawn = baked(surface, texture, uniform)
            rows.append(told(surface, name, widths(surface, texture, drawn)))
            row.append(seen(surface, drawn, 280))
        picture = np.concatenate([np.concatenate(row, 1), np.ones((280, 560, 1))], 2)
        png.write(folder / f"baking_{surface.name}.png", picture, multilayer.Window(560, 280, 0, 0, 560, 280))
    return rows
