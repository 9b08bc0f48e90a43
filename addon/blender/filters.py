# SPDX-License-Identifier: GPL-3.0-or-later
"""What a view layer leaves out or has instead, and how the film is exposed, as Cycles takes it."""


def override(depsgraph):
    """The material that all surfaces of a view layer have, None: each has its own."""
    return depsgraph.view_layer_eval.material_override


def materials(obj, override):
    """The materials of an evaluated object, slot by slot; what has no slot has one material, or none at all (None)."""
    return [override or slot.material for slot in obj.material_slots] or [override]


def surfaces(depsgraph):
    """Whether a view layer shows surfaces, which without it throw no shadows either."""
    return depsgraph.view_layer_eval.use_solid


def hair(depsgraph):
    """Likewise hair."""
    return depsgraph.view_layer_eval.use_strand


def world(depsgraph):
    """The evaluated world that a view layer has, None: nothing is behind it and lights it."""
    layer = depsgraph.view_layer_eval
    if not layer.use_sky:
        return None
    return getattr(layer, "world_override", None) or depsgraph.scene_eval.world  # since 4.3


def exposure(depsgraph):
    """By what the film multiplies all light."""
    return depsgraph.scene_eval.cycles.film_exposure


def told(depsgraph):
    """All that is read here; equal where it is the same."""
    return [surfaces(depsgraph), hair(depsgraph), exposure(depsgraph),
            *(block and block.name_full for block in (override(depsgraph), world(depsgraph)))]
