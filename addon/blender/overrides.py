# SPDX-License-Identifier: GPL-3.0-or-later
"""What is overridden on the evaluated scene, because lines need layers in which a pixel shows one thing. The user's
scene stays as it is.

Values of a scene whose data are persistent stay from frame to frame: what one frame overrode, the next gives back.
"""

import contextlib

import bpy
import numpy as np

from . import versions
from .threads import put

SAMPLES = 16  # enough for light that is denoised and cut into levels
_MOST_INDICES = 32767  # pass_index is a short


@contextlib.contextmanager
def changed(*changes):
    """Sets the (owner, property, value), which with persistent data would stay, and in the end sets them back."""
    before = [getattr(owner, name) for owner, name, _ in changes]
    try:
        for owner, name, value in changes:
            put(owner, name, value)
        yield
    finally:
        for (owner, name, _), value in zip(changes, before, strict=True):
            put(owner, name, value)


def _set(owner, name, value):
    """Only where it differs: at some properties' change Blender asks all engines anew what passes there are."""
    if getattr(owner, name) != value:
        put(owner, name, value)


def denoiser(depsgraph, shaded, overrode):
    """Cycles' denoiser cleans Combined but not the passes. Returns (whether ours must do its work too, whether this
    build lacks the one that the user asks for)."""
    user, mine = depsgraph.scene.cycles.use_denoising, depsgraph.scene_eval.cycles
    if shaded or overrode:
        _set(mine, "use_denoising", user and not shaded)
    missing = mine.use_denoising and not versions.has_cycles_denoiser()
    if missing:
        put(mine, "use_denoising", False)
    return shaded and user and depsgraph.view_layer.cycles.use_denoising, missing


def samples(scene):
    """How many samples a pixel Cycles takes at most: Encre's own number, where it is lower than Cycles'."""
    return min(scene.cycles.samples, scene.encre.samples or scene.cycles.samples)


def fewer_samples(depsgraph, fewer):
    """Has Cycles take as many as samples() says, or as many as its own settings say where nothing is drawn."""
    _set(depsgraph.scene_eval.cycles, "samples",
         samples(depsgraph.scene) if fewer else depsgraph.scene.cycles.samples)


def denoises(depsgraph):
    """Whether Cycles' denoiser is on where it may be, and is there."""
    wanted = depsgraph.scene.cycles.use_denoising and depsgraph.view_layer.cycles.use_denoising
    return wanted and versions.has_cycles_denoiser()


def _blurs(depsgraph):
    """(evaluated owner, the user's, switch, name) of motion blur and of each camera's depth of field."""
    yield depsgraph.scene_eval.render, depsgraph.scene.render, "use_motion_blur", "motion blur"
    for block in depsgraph.ids:
        if isinstance(block, bpy.types.Camera):
            yield block.dof, block.original.dof, "use_dof", "depth of field"


def without(names):
    """That a picture is without these, in a sentence."""
    return f"{' and '.join(names)}: rendered without, because lines need sharp layers"


def blurred(depsgraph):
    """The names of what is on of motion blur and depth of field."""
    return sorted({name for evaluated, _, switch, name in _blurs(depsgraph) if getattr(evaluated, switch)})


def blur(depsgraph, off):
    """Switches motion blur and depth of field off, or back to what the user set. Returns the names of what was on."""
    found = set()
    for evaluated, user, switch, name in list(_blurs(depsgraph)):
        if not off:
            _set(evaluated, switch, getattr(user, switch))
        elif getattr(evaluated, switch):
            put(evaluated, switch, False)
            found.add(name)
    return sorted(found)


def film(depsgraph, transparent):
    """Leaves the world out of the picture, or shows it as the user has set."""
    _set(depsgraph.scene_eval.render, "film_transparent", transparent or depsgraph.scene.render.film_transparent)


def expect(depsgraph, names):
    """Cycles writes an error to the log for each pass that it doesn't know; those called as an AOV it expects. No
    shader writes these, which cost four bytes a pixel each while it renders."""
    aovs = depsgraph.view_layer_eval.aovs
    for name in names:
        if name not in aovs:  # with persistent data it may be there from the last frame
            aov = aovs.add()
            put(aov, "type", "VALUE")
            put(aov, "name", name)


def follow_reflections(depsgraph):
    """Lets the passes that see into mirrors do so, where a view layer can switch that off (5.2 and later)."""
    cycles = depsgraph.view_layer_eval.cycles
    if not getattr(cycles, "denoising_pass_follow_reflections", True):
        put(cycles, "denoising_pass_follow_reflections", True)


def pass_indices(depsgraph, automatic):
    """Gives each evaluated object a pass index of its own, or back its user's; originals keep theirs.

    Cycles draws the index of clipped leaves, hair and displaced surfaces, which no rasteriser of ours can, but
    pass indices are 0 unless set by hand. Returns (line, user) by the new index: the number of the object or its
    line group, and the index that the user gave; None if indices are the user's, as they stay where a material
    reads them.
    """
    blocks = list(depsgraph.ids)
    automatic = automatic and not any(_reads_index(block) for block in blocks)
    line, user, groups = [0], [0], {}
    for obj in blocks:
        if not isinstance(obj, bpy.types.Object):
            continue
        if not automatic:
            put(obj, "pass_index", obj.original.pass_index)
            continue
        put(obj, "pass_index", (len(line) - 1) % _MOST_INDICES + 1)
        if len(line) <= _MOST_INDICES:
            line.append(_group_number(obj, groups, len(line)))
            user.append(obj.original.pass_index)
    return (np.array(line, np.float32), np.array(user, np.float32)) if automatic else None


def _group_number(obj, groups, number):
    group = obj.encre.line_group
    return groups.setdefault(group, number) if group else number


def _reads_index(block):
    """Whether a material's or a node group's colours depend on the pass index."""
    tree = block if isinstance(block, bpy.types.ShaderNodeTree) else getattr(block, "node_tree", None)
    if not isinstance(tree, bpy.types.ShaderNodeTree):
        return False
    return any(
        (node.bl_idname == "ShaderNodeObjectInfo" and node.outputs["Object Index"].is_linked)
        or (node.bl_idname == "ShaderNodeAttribute" and node.attribute_name == "pass_index")
        for node in tree.nodes)
