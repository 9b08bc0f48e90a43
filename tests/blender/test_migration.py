# SPDX-License-Identifier: GPL-3.0-or-later
"""Files of older versions keep their look."""

import json
import subprocess
import sys

SCRIPT = '''
import json, os, sys
import bpy
import encre
from encre.blender import migration

encre.register()
old, new, foreign = sys.argv[1:]
scene, told = bpy.context.scene, {}

def opened(path):
    bpy.ops.wm.open_mainfile(filepath=path)
    settings = bpy.context.scene.encre
    return [settings.version, settings.crease_source, settings.line_depth_unit, settings.crease_angle,
            settings.line_min_length, round(settings.line_thickness, 3), bpy.context.view_layer.encre.use_pass_lines]

bpy.ops.wm.save_as_mainfile(filepath=foreign)  # nobody has chosen Encre in it
scene.render.engine, scene.encre.line_thickness = "ENCRE", 5
bpy.ops.wm.save_as_mainfile(filepath=new)
bpy.app.handlers.save_pre.remove(migration._saving)  # version 0.1.0 wrote none
scene.encre.version = 0
bpy.ops.wm.save_as_mainfile(filepath=old)
facts = {name: opened(path) for name, path in (("old", old), ("new", new), ("foreign", foreign))}
print("FACT", json.dumps(facts), flush=True)
os._exit(0)  # bpy's own end may crash
'''


def test_old_files_keep_their_look(tmp_path):
    paths = [str(tmp_path / f"{name}.blend") for name in ("old", "new", "foreign")]
    done = subprocess.run([sys.executable, "-c", SCRIPT, *paths], capture_output=True, text=True, timeout=120)
    line = next(line for line in done.stdout.splitlines() if line.startswith("FACT "))
    assert json.loads(line[5:]) == {"old": [2, "LAYERS", "SCENE", 20.0, 0.0, 5.0, True],
                                    "new": [2, "AUTO", "RELATIVE", 32.0, 12.0, 5.0, False],
                                    "foreign": [2, "AUTO", "RELATIVE", 32.0, 12.0, 8.0, False]}
