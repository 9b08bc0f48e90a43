# SPDX-License-Identifier: GPL-3.0-or-later
"""A cube in the sun as a script, `encre render` on it, and what is to be said of the outcome."""

import subprocess
import sys

import forks

CUBE = '''
import bpy
scene = bpy.context.scene
assert not scene.objects, "the file is not empty"
mesh = bpy.data.meshes.new("Cube")
mesh.from_pydata([(x, y, z) for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)], [],
                 [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)])
sun = bpy.data.lights.new("Sun", "SUN")
sun.energy = 3
camera = bpy.data.cameras.new("Camera")
for name, data in ("Cube", mesh), ("Sun", sun), ("Camera", camera):
    scene.collection.objects.link(bpy.data.objects.new(name, data))
bpy.data.objects["Sun"].rotation_euler = 0.5, 0.3, 0
bpy.data.objects["Camera"].location = 4, -5, 3
bpy.data.objects["Camera"].rotation_euler = 1.15, 0, 0.67
scene.camera = bpy.data.objects["Camera"]
scene.cycles.samples, scene.cycles.use_denoising = 1, False
scene.render.resolution_x, scene.render.resolution_y = 64, 36
scene.view_settings.view_transform = "Standard"
scene.frame_start, scene.frame_end = 3, 4
'''
ALL = "--set=save_layers=ON"  # instead of slim files


def script(tmp_path, more):
    """The cube's scene and some lines after."""
    path = tmp_path / "scene.py"
    path.write_text(CUBE + more)
    return path


def encre(*args, python=None, **options):
    """What came of `encre args`. python: one of another place; it starts anew, and so does what options say more of."""
    if python is None and forks.POSSIBLE and options.keys() <= {"cwd", "env"}:
        return forks.run(args, **options)
    command = [python or sys.executable, "-m", "encre", *map(str, args)]
    return subprocess.run(command, capture_output=True, text=True, timeout=300, **options)


def works(result):
    assert result.returncode == 0 and result.stdout.count("\n") <= 1 and "error" not in result.stderr, result.stderr
    return result.stderr


def fails(result, *words, status=2):
    assert result.returncode == status and result.stdout == "" and "Traceback" not in result.stderr, result.stderr
    sentence = result.stderr.splitlines()[-1]
    assert sentence.startswith("encre: error: ") and all(word in sentence for word in words), sentence


def left(folder):
    return sorted(p.name for p in folder.iterdir() if p.suffix != ".py")
