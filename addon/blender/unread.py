# SPDX-License-Identifier: GPL-3.0-or-later
"""When a scene need not be read again: of what the last evaluation changed nothing was anything but settings.

To walk over what a scene holds, only to find it as it was, takes longer than to draw a slider's picture.
"""

import bpy

from . import filters


def settings_alone(depsgraph):
    """Whether the last evaluation has changed nothing but properties that add-ons gave the scene, of which ours are
    some. Meshes, instances, materials and what drivers and handlers move are updates of their own; a scene with another
    world, or things hidden in it, is neither moved nor of another shape, as one whose properties are set is."""
    updates = depsgraph.updates
    return len(updates) > 0 and all(isinstance(update.id, bpy.types.Scene) and update.is_updated_geometry
                                    and update.is_updated_transform for update in updates)


def beside(context, depsgraph, settings, camera):
    """All that fast.read() reads of the settings, the scene and its view layer: equal where one evaluation that has
    changed settings has not changed any of these, too."""
    scene, layer, space = depsgraph.scene_eval, context.view_layer, context.space_data
    return (settings.every[0]["object_index"], settings.rastered, settings.shadows_world, settings.planes,
            settings.facets, settings.flat, settings.sky_colors,
            [style.name for style in scene.encre.styles],
            scene.render.film_transparent, camera and camera.name_full,
            filters.told(depsgraph),
            [(obj.visible_get(view_layer=layer, viewport=space), obj.indirect_only_get(view_layer=layer))
             for obj in layer.objects])
