# SPDX-License-Identifier: GPL-3.0-or-later
"""Layers of meshes with the lines that these tell, put together as the engine does."""

import numpy as np
from encre.pen import chains, library


def lines(meshes, view, projection, frame, size, start=0.1, cards=0):
    """The Chains of meshes whose objects are numbered as the layer `object` has them; the last `cards` of them are cut
    out by alpha, and tell nothing."""
    count = 1 + max(int(np.max(mesh.object_index if mesh.object is None else mesh.object)) for mesh in meshes)
    points = library.chains(meshes[:len(meshes) - cards], view, projection, frame, size, start)
    whole = np.ones(count, bool)
    whole[[mesh.object_index for mesh in meshes[len(meshes) - cards:]]] = False
    return chains.told(points, np.arange(count, dtype=np.float32), whole)


def layers(meshes, view, projection, frame, size, start=0.1):
    """Grey surfaces in even light, of normals that show nothing."""
    shape, grey = size[::-1], np.full((*size[::-1], 3), 0.5, np.float32)
    maps = library.raster(meshes, view, projection, frame, size, start, outputs=("depth", "object"))
    return dict(combined=np.dstack([grey, np.ones(shape, np.float32)]), color=grey, diffuse=grey, depth=maps["depth"],
                normal=np.zeros_like(grey), object=maps["object"],
                chains=lines(meshes, view, projection, frame, size, start))
