# SPDX-License-Identifier: GPL-3.0-or-later
"""Builds a scene and saves it as a .blend that opens ready to render.

    python scenes/save.py SCENE.py FOLDER
"""

import importlib
import sys
from pathlib import Path

import bpy
import encre


def main():
    scene, folder = Path(sys.argv[1]).resolve(), Path(sys.argv[2])
    folder.mkdir(parents=True, exist_ok=True)
    bpy.ops.wm.read_factory_settings(use_empty=True)
    encre.register()
    sys.path.insert(0, str(scene.parent))
    importlib.import_module(scene.stem).build()
    bpy.context.scene.render.engine = "ENCRE"
    target = folder.resolve() / f"{scene.stem}.blend"
    bpy.ops.wm.save_as_mainfile(filepath=str(target), compress=True)
    encre.unregister()  # or Python would wait for its timers
    print(target)


if __name__ == "__main__":
    main()
