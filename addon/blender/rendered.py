# SPDX-License-Identifier: GPL-3.0-or-later
"""What is read of a scene that Cycles renders: its materials, for where colors part, and its world, as for fast layers,
but for what can't be read."""

import bpy
import numpy as np

from . import colored, filters, materials, skies, trees, unseen

_EDGE = "color_edge"  # the control that asks for lines there


class Rendered:
    """What tells where colors part in what a renderer shows, which shows all that a material has: of one that has what
    can't be read nothing is told."""

    def __init__(self, depsgraph, images, kept):
        """images: a pictures.Images; kept: as colored.colors() takes it."""
        self.kept = kept
        self.looks = materials.read([b for b in depsgraph.ids if isinstance(b, bpy.types.Material)], images)
        self.places = {name: None if self._more(name) else colored.place(*known)
                       for name, known in self.looks.known.items()}

    def _more(self, name):
        return name in self.looks.unknown or set(self.looks.lost[name]) - {unseen.BEHIND}

    @property
    def laid(self):
        """{full name of a material: UV map that its image lies on}."""
        return {name: place.uv_map for name, place in self.places.items() if isinstance(place, colored.Place)}

    def told(self, names):
        """The Told of materials in the order of their numbers."""
        return colored.Told([self.places[name] for name in names])

    def colors(self, told, names, every):
        """The steps to the job.Colors of a Told, as colored.colors() has them."""
        things = np.zeros((2, 18 + 4 * len(self.looks.pool.asked)), np.float32)  # none of which is read
        return colored.colors(told, every, self.kept, self.looks.programs(names, things, 0), 0)


def read(depsgraph, settings, kept):
    """The Rendered of a frame; None: nobody asks where colors part. kept: a lamps.Kept."""
    if not (settings.tells_colors and (settings.wants_color_lines or _painted(depsgraph))):
        return None
    return Rendered(depsgraph, kept.images, kept.colors)


def sky(depsgraph, settings, kept):
    """(what stands in for the world where nothing is in front of it, why it is not what the settings ask for); None:
    the world itself, and nothing to be said. kept: a lamps.Kept."""
    world = filters.world(depsgraph)
    if (not settings.active or not settings.sky_colors or depsgraph.scene.render.film_transparent
            or not skies.photographed(world)):
        return None, None
    if thing := _veil(depsgraph):
        return None, f"the picture of the sky stays as it is because of {thing}; choose Fast for Render to see it flat"
    try:
        seen = skies.seen(world) * filters.exposure(depsgraph)
    except trees.Unknown as e:
        return None, f"the picture of the sky stays as it is, as only Cycles can show the world's node {e}"
    return kept.backdrops.of(seen, settings.sky_colors), None


def _veil(depsgraph):
    """A thing in front of which alpha does not say how much of the world is seen, and in which color; None: none is."""
    for block in depsgraph.ids:
        if isinstance(block, bpy.types.Object) and block.original.holdout_get(view_layer=depsgraph.view_layer):
            return f"the holdout {block.name}"
        for node in trees.nodes_of(block) if isinstance(block, bpy.types.Material) else ():
            if node.bl_idname == "ShaderNodeHoldout" or (
                    node.bl_idname == "ShaderNodeBsdfTransparent" and _tints(node.inputs["Color"])):
                return f"the node {node.name} of material {block.name}"
    return None


def _tints(socket):
    return socket.is_linked or len(set(socket.default_value[:3])) > 1


def _painted(depsgraph):
    """Whether anything is painted to have lines where colors part."""
    for block in depsgraph.ids:
        if isinstance(block, bpy.types.Mesh) and f"encre_{_EDGE}" in block.attributes:
            return True
        if isinstance(block, bpy.types.Material | bpy.types.Object) and getattr(block.encre, _EDGE) > 0:
            return True
    return False
