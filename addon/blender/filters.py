# SPDX-License-Identifier: GPL-3.0-or-later
"""What a view layer leaves out or has instead: its override of materials, as Cycles takes it."""


def override(depsgraph):
    """The material that all surfaces of a view layer have, None: each has its own."""
    return depsgraph.view_layer_eval.material_override


def materials(obj, override):
    """The materials of an evaluated object, slot by slot; what has no slot has one material, or none at all (None)."""
    return [override or slot.material for slot in obj.material_slots] or [override]


def told(depsgraph):
    """All that is read here; equal where it is the same."""
    instead = override(depsgraph)
    return [instead and instead.name_full]
