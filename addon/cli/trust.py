# SPDX-License-Identifier: GPL-3.0-or-later
"""A stranger's .blend in Blender: no Python of it runs, and it writes nothing but pictures below the output's folder.

Blender itself runs no scripts and drivers then; the rest is here. It is changed in memory alone, as soon as the file is
loaded and before anything of it is evaluated, which may write already. Runs inside Blender, where inside.py imports it.
"""

import os
import re
import stat
import tempfile

import bpy

from . import needed


def plain(path):
    """Whether what lies at a path, if anything does, can be opened without waiting for another process."""
    try:
        kind = os.stat(path).st_mode
    except OSError:
        return True
    return stat.S_ISREG(kind) or stat.S_ISDIR(kind)


def opened(path, place):
    """Opens a .blend and says what its maker may miss, in halves of sentences. RuntimeError: Blender can't open it.

    place: the folder below which File Output nodes may write, None: they may not.
    """
    guard, done = _Guard(place), []

    @bpy.app.handlers.persistent  # one of another kind goes when a file is loaded
    def loaded(*_):
        guard.disarm()
        done.append(True)

    bpy.app.handlers.load_post.insert(0, loaded)
    try:
        bpy.ops.wm.open_mainfile(filepath=path, use_scripts=False)
    finally:
        bpy.app.handlers.load_post.remove(loaded)
    if not done:
        raise RuntimeError("what is in it can't be kept from running")
    return guard.words


class _Guard:
    def __init__(self, place):
        self.place, self.words = place and os.path.realpath(place), []

    def disarm(self):
        for scene in bpy.data.scenes:
            self._freestyle(scene)
            self._osl(scene)
        self._outputs()
        self._caches()
        self._pipes()

    def _freestyle(self, scene):
        """Some Blenders run its modules whatever they are told of scripts: 3.4, 4.2 and 5.0, not 4.5 and 5.2."""
        for layer in scene.view_layers:
            settings = layer.freestyle_settings
            if scene.render.use_freestyle and settings.mode == "SCRIPT" and any(m.use for m in settings.modules):
                self.words.append(f"Freestyle of view layer {layer.name} is drawn by scripts, and is not drawn")
            for module in list(settings.modules):
                settings.modules.remove(module)

    def _osl(self, scene):
        """Shaders of Open Shading Language are programs that read any file."""
        if getattr(scene, "cycles", None) and scene.cycles.shading_system:
            scene.cycles.shading_system = False
            self.words.append(f"Open Shading Language of scene {scene.name} is off")
        for camera in bpy.data.cameras:
            if camera.type == "CUSTOM":  # since 5.0
                camera.type = "PERSP"
                self.words.append(f"camera {camera.name} is one of Open Shading Language, and made a perspective one")

    def _outputs(self):
        shown = {node for scene in bpy.data.scenes for *_, node in needed.outputs(scene)}
        trees = [tree for scene in bpy.data.scenes if (tree := needed.tree(scene))]
        for tree in (*trees, *(group for group in bpy.data.node_groups if group.type == "COMPOSITING")):
            for node in [node for node in tree.nodes if node.type == "OUTPUT_FILE"]:
                if path := next((path for path in needed.files(node) if not self._below(path)), None):
                    if node in shown:
                        self.words.append(f"node {node.name} would write {path}, which does not lie below the "
                                          "output's folder, and is left out")
                    tree.nodes.remove(node)

    def _below(self, path):
        # A template stands for a name that the file's maker chose.
        path = re.sub(r"\{[^{}]*\}", "..", path) if "/{" in path or "}/" in path or "}{" in path else path
        folder = os.path.realpath(os.path.dirname(os.path.normpath(path)))
        return self.place is not None and os.path.commonpath([folder, self.place]) == self.place

    def _caches(self):
        """Those that are not baked are written whenever a frame is evaluated."""
        names = []
        for name, caches in _point_caches():
            writes = [cache.use_disk_cache and not cache.is_baked for cache in caches]
            if any(writes):
                # Not one by one: this way Blender does not take it for a wish to delete what is on disk.
                for switch in "use_disk_cache", "use_external":
                    caches.foreach_set(switch, [getattr(cache, switch) and not write
                                                for cache, write in zip(caches, writes, strict=True)])
                names.append(name)
        for obj in bpy.data.objects:
            for domain in (m.domain_settings for m in obj.modifiers if m.type == "FLUID" and m.domain_settings):
                if domain.cache_type == "REPLAY" or getattr(domain, "is_cache_baking_any", False):
                    domain.cache_directory = tempfile.mkdtemp(prefix="fluid-")
                    names.append(obj.name)
        if names:
            self.words.append("caches on disk that are not baked are neither read nor written, and what they hold is "
                              f"simulated from the first frame on that is rendered: {', '.join(dict.fromkeys(names))}")

    def _pipes(self):
        """Blender would wait for who writes into them."""
        for data in (*bpy.data.images, *bpy.data.movieclips, *bpy.data.fonts, *bpy.data.sounds, *bpy.data.volumes,
                     *bpy.data.cache_files):
            path = bpy.path.abspath(data.filepath, library=data.library)
            if data.filepath not in ("", "<builtin>") and not plain(path):
                data.filepath = ""
                self.words.append(f"{path} is no file, and is left out")


def _point_caches():
    """(what it is of, its caches)."""
    for obj in bpy.data.objects:
        for modifier in obj.modifiers:
            if cache := getattr(modifier, "point_cache", None):
                yield obj.name, cache.point_caches
            for surface in getattr(getattr(modifier, "canvas_settings", None), "canvas_surfaces", ()):
                yield obj.name, surface.point_cache.point_caches
        for system in obj.particle_systems:
            for cache in (system.point_cache, getattr(system.cloth, "point_cache", None)):
                if cache:
                    yield obj.name, cache.point_caches
    for scene in bpy.data.scenes:
        if scene.rigidbody_world and scene.rigidbody_world.point_cache:
            yield f"rigid bodies of {scene.name}", scene.rigidbody_world.point_cache.point_caches
