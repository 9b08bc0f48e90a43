# SPDX-License-Identifier: GPL-3.0-or-later
"""The layers of a picture without a renderer: what is read of a scene, once. fast_scene.Scene then draws it."""

import copy

import bpy
import numpy as np

from ..pen import library
from ..pen.sky import Sky
from . import colored, filters, lamps, materials, meshes, pictures, skies, subject, trees, unseen, volumes
from .fast_scene import Scene


class Kept:
    """What need not be read again for the next Scene: meshes, and trees of triangles for the light.

    Of a new Scene and an older one that share it only the new one may be drawn.
    """

    def __init__(self, light=None):
        """light: the lamps.Kept that it is to share."""
        self.meshes, self.light = meshes.Kept(), light or lamps.Kept()
        self.images = self.light.images
        self.colors = self.light.colors

    def update(self, depsgraph):
        """Forgets what has another shape since the last evaluation. (An engine that has just been made is told of
        nothing: it begins with a Kept of its own.)"""
        self.meshes.drop({meshes.block_name(update.id) for update in depsgraph.updates if update.is_updated_geometry})
        self.images.drop({meshes.block_name(update.id) for update in depsgraph.updates})
        pictures.turn(not len(depsgraph.updates))


def read(depsgraph, settings, clip, kept=None, camera=None, visible=None):
    """The Scene of an evaluated depsgraph. On the main thread alone.

    clip: (start, end) of what looks at it; kept: a Kept; camera: the evaluated one whose focus tells what the picture
    is about, None: only the scene's size does; visible: whether an original object is, None: all are.
    """
    kept = kept or Kept()
    pictures.turn()
    light = lamps.Light(depsgraph, clip, kept.light, visible, settings.shadows_world, settings.planes)
    blocks = [block for block in depsgraph.ids if isinstance(block, bpy.types.Material)]
    looks = materials.read(blocks, kept.images)
    objects = meshes.extract(depsgraph, settings.every[0]["object_index"] == "AUTO", None, light, kept.meshes, visible,
                             looks, settings.wants_anchor, settings.wants_tangent, flat=settings.flat,
                             facets=settings.facets)
    first = _join_attributes(objects)
    light.tidy()
    notes = []
    if light.unknown:
        notes.append(f"drawn light leaves out {', '.join(light.unknown)}: only Cycles can read it")
    if light.dark:
        notes.append("no lamp and no world that can be drawn: a lamp shines from the camera")
    unknown = [f"{name} ({looks.unknown[name]})" for name in objects.materials if name in looks.unknown]
    if unknown:
        notes.append(f"in their viewport color, as only Cycles can show them: {', '.join(unknown)}")
    world = filters.world(depsgraph)
    try:
        sky = skies.seen(world)
    except trees.Unknown as e:
        sky = Sky(np.array(world.color))
        notes.append(f"the world in its viewport color, as only Cycles can show its node {e}")
    notes += unseen.of_materials(looks, objects.materials) + unseen.of_things(depsgraph, visible)
    foggy, unread = volumes.fogs(depsgraph, light.mean)
    if unread:
        notes.append(f"not shown, as only Cycles can show it: what fills {', '.join(unread)}")
    made = looks.programs(objects.materials, objects.things, first, objects.flat)
    sky *= light.exposure
    flat = settings.sky_colors and skies.photographed(world)
    backdrop = kept.light.backdrops.of(sky, settings.sky_colors) if flat else sky
    film = depsgraph.scene.render.film_transparent  # a frame by Cycles before this one may have overridden the other
    return Scene(objects, light, made, sky, backdrop, film,
                 subject.read(depsgraph, camera, light), clip, notes, first > 0,
                 first + looks.channels(objects.materials), looks.through(objects.materials),
                 looks.shine(objects.materials), looks.turned(objects.materials), looks.holdout(objects.materials),
                 looks.lit(objects.materials, first), colored.find(looks, objects.materials), first, kept.colors, foggy)


def repainted(scene, depsgraph, images):
    """A Scene whose materials look into other pictures and which is else the same; images: what gives them, with a
    get() as pictures.Images has it."""
    looks = materials.read([block for block in depsgraph.ids if isinstance(block, bpy.types.Material)], images)
    other = copy.copy(scene)
    other.materials = looks.programs(scene.objects.materials, scene.objects.things,
                                     len(library.controls()) if scene.painted else 0, scene.objects.flat)
    other.told = colored.find(looks, scene.objects.materials)
    return other


def _join_attributes(objects):
    """Puts behind the controls of each mesh what programs of materials read; the first channel of these."""
    first = len(library.controls()) if any(mesh.attributes is not None for mesh in objects.meshes) else 0
    for mesh, shown in zip(objects.meshes, objects.shown, strict=True):
        if shown is None or not first:
            mesh.attributes = mesh.attributes if shown is None else shown
            continue
        painted = mesh.attributes
        mesh.attributes = np.zeros((len(shown), 3, first + shown.shape[2]), np.float32)
        mesh.attributes[..., first:] = shown
        if painted is not None:
            mesh.attributes[..., :first] = painted
    return first
