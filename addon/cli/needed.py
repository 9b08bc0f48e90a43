# SPDX-License-Identifier: GPL-3.0-or-later
"""Files that a scene reads, some of which may be missing or broken, and those that it writes besides the picture.

Runs inside Blender, which passes over most of this without a word. inside.py and staging.py import it.
"""

import os

import bpy

from ..blender import versions
from ..pen import plain


def lost(strict):
    """Words for each file that is used in every frame and can't be; strict: images are opened to find out."""
    return [words for path, image in dict(_always()).items() if (words := _wrong(path, image and strict))]


def lost_now(scene, strict):
    """Likewise for those of the current frame, which has been set."""
    found = {}
    for layer in scene.view_layers:
        for id_ in layer.depsgraph.ids if layer.use and layer.depsgraph else ():
            if isinstance(id_, bpy.types.Volume):
                if id_.is_sequence and not id_.packed_file and not id_.grids.load():
                    found[id_.grids.error_message or id_.filepath] = None
                continue
            tree = id_ if isinstance(id_, bpy.types.ShaderNodeTree) else getattr(id_, "node_tree", None)
            for node in tree.nodes if isinstance(tree, bpy.types.ShaderNodeTree) else ():
                image = getattr(node, "image", None)
                if image and image.source == "SEQUENCE" and not image.packed_files:
                    path = _absolute(image.filepath_from_user(image_user=node.image_user), image.library)
                    if path not in found and (words := _wrong(path, strict)):
                        found[words] = None
    return list(found)


def _absolute(path, library=None):
    return bpy.path.abspath(path, library=library)


def _always():
    """(path, whether it is an image)."""
    for library in bpy.data.libraries:
        if not library.packed_file:
            yield _absolute(library.filepath), False
    for image in bpy.data.images:
        if image.source in ("FILE", "MOVIE", "TILED") and image.users and image.filepath and not image.packed_files:
            yield from ((_absolute(path, image.library), image.source != "MOVIE") for path in _tiles(image))
    for data in (*bpy.data.volumes, *bpy.data.cache_files, *bpy.data.fonts):
        packed, in_frames = getattr(data, "packed_file", None), getattr(data, "is_sequence", False)
        if data.users and data.filepath not in ("", "<builtin>") and not packed and not in_frames:
            yield _absolute(data.filepath, data.library), False


def _tiles(image):
    """Paths of an image: several of one in tiles."""
    if image.source != "TILED":
        return [image.filepath]
    numbers = [tile.number for tile in image.tiles]
    return [image.filepath.replace("<UDIM>", str(number))
            .replace("<UVTILE>", f"u{(number - 1001) % 10 + 1}_v{(number - 1001) // 10 + 1}") for number in numbers]


def _wrong(path, as_image):
    """What is wrong with a file, with its name; None: nothing is known to be."""
    if not os.path.exists(path):
        return f"{path} (not there)"
    if os.path.isdir(path):  # some caches are
        return None
    try:
        with plain.opened(path) as file:
            if not file.read(1):
                return f"{path} (empty)"
    except OSError as error:
        return f"{path} ({error.strerror})"
    return f"{path} (broken)" if as_image and not _opens(path) else None


def _opens(path):
    try:
        image = bpy.data.images.load(path, check_existing=False)
    except RuntimeError:
        return False
    good = all(image.size)
    bpy.data.images.remove(image)
    return good


def styles(scene):
    """(object or material, style) that names a style which the scene has not."""
    found = {}
    for obj in _objects(scene):
        for block in (obj, *(slot.material for slot in obj.material_slots if slot.material)):
            if block.encre.style and block.encre.style not in scene.encre.styles:
                found[block.name, block.encre.style] = None
    return list(found)


def _objects(scene):
    for obj in scene.objects:
        yield obj
        if obj.instance_collection:
            yield from obj.instance_collection.all_objects


def _nodes(tree):
    for node in tree.nodes if tree else ():
        if not node.mute:
            yield node
            yield from _nodes(getattr(node, "node_tree", None))


def tree(scene):
    """The compositor's nodes of a scene, also where they are not used; None: it has none."""
    return getattr(scene, "node_tree", None) or versions.compositor(scene)


def _compositor(scene):
    return list(_nodes(versions.compositor(scene))) if scene.render.use_compositing else []


def unrendered(scene):
    """Names of the view layers that the compositor reads and that are not rendered."""
    return list(dict.fromkeys(
        node.layer for node in _compositor(scene)
        if node.type == "R_LAYERS" and node.scene == scene and any(output.is_linked for output in node.outputs)
        and not getattr(scene.view_layers.get(node.layer), "use", True)))


def outputs(scene):
    """(where a File Output node writes, the folder that this needs, the node), which Blender does by itself."""
    for node in _compositor(scene):
        if node.type == "OUTPUT_FILE" and any(socket.is_linked for socket in node.inputs):
            path = _absolute(node.base_path) if hasattr(node, "base_path") else next(files(node))
            yield path, path if _in_slots(node) else os.path.dirname(path), node


def _in_slots(node):
    """Whether the node writes a file for each of its inputs into a folder, as it does before 5.0."""
    return hasattr(node, "base_path") and node.format.file_format != "OPEN_EXR_MULTILAYER"


def files(node):
    """Paths of the files that a File Output node writes, without the frame's number and the ending."""
    if _in_slots(node):
        for slot in node.file_slots:
            yield os.path.join(_absolute(node.base_path), slot.path.lstrip("/\\"))
    elif hasattr(node, "base_path"):
        yield _absolute(node.base_path)
    else:
        path = os.path.join(_absolute(node.directory), node.file_name.lstrip("/\\"))
        yield path
        yield from (path + item.name for item in node.file_output_items)


def no_folder(path):
    """What lies where a folder of `path` would have to be; None: nothing does."""
    while path != os.path.dirname(path) and not os.path.exists(path):
        path = os.path.dirname(path)
    return None if os.path.isdir(path) else path


def strips(scene):
    """Whether the sequencer shows anything."""
    editor = scene.sequence_editor
    return bool(editor) and any(not strip.mute for strip in versions.strips(editor))
