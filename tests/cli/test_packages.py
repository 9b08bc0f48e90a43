# SPDX-License-Identifier: GPL-3.0-or-later
"""What users install: source archive, wheel, extension and legacy add-on each render where nothing of ours lies."""

import os
import re
import shutil
import subprocess
import sys
import tarfile
import venv
import zipfile
from pathlib import Path

import exr
import pytest
from encre.pen.library import LIBRARY

ROOT = Path(__file__).parents[2]
SCENE = '''
import bpy
bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)
bpy.ops.mesh.primitive_cube_add()
bpy.ops.object.light_add(type="SUN", rotation=(0.5, 0.3, 0))
bpy.ops.object.camera_add(location=(4, -5, 3), rotation=(1.15, 0, 0.67))
scene = bpy.context.scene
scene.camera = bpy.context.object
scene.cycles.samples, scene.cycles.use_denoising = 1, False
scene.render.resolution_x, scene.render.resolution_y = 240, 135
'''
RENDER = '''
scene.render.engine = "ENCRE"
scene.render.image_settings.file_format = "OPEN_EXR_MULTILAYER"
scene.render.filepath = {out!r}
bpy.ops.render.render(write_still=True)
engine = next(cls for cls in bpy.types.RenderEngine.__subclasses__() if getattr(cls, "bl_idname", "") == "ENCRE")
import os, sys
print("FROM", sys.modules[engine.__module__].__file__, flush=True)
os._exit(0)
'''
INSTALL = '''
import bpy
done = bpy.ops.extensions.package_install_files(filepath={archive!r}, repo="user_default", enable_on_install=True)
assert done == {{"FINISHED"}}, done
'''


def run(*command, cwd=ROOT, **environment):
    """Standard output of a command that sees no package of ours but what is installed where it looks."""
    inherited = {name: value for name, value in os.environ.items() if not name.startswith("PYTHON")}
    done = subprocess.run([str(part) for part in command], cwd=cwd, capture_output=True, text=True, timeout=300,
                          stdin=subprocess.DEVNULL, env={**inherited, **environment})
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout


def empty(folder):
    """The interpreter of a new environment that borrows libraries from the tests', and has no Encre."""
    venv.create(folder, symlinks=True)
    python = folder / "bin" / "python"
    # A path in a .pth file is not searched for further .pth files: an editable install stays behind.
    site = Path(run(python, "-c", "import sysconfig; print(sysconfig.get_path('purelib'))").strip())
    (site / "borrowed.pth").write_text("\n".join(p for p in sys.path if Path(p).name.endswith("-packages")))
    assert run(python, "-c", "import importlib.util; print(importlib.util.find_spec('encre'))", cwd=folder) == "None\n"
    return python


def inked(path):
    ink = exr.part(path, "ViewLayer.Encre Lines")[..., 3]
    return ink.max() > 0.5 and ink.mean() < 0.5


@pytest.fixture(scope="module")
def dist(tmp_path_factory):
    """(source archive, wheel) as a release has them: the wheel is built from what the archive holds."""
    folder = tmp_path_factory.mktemp("dist")
    run(sys.executable, "-m", "build", "--no-isolation", "--outdir", folder, ROOT)
    [archive], [wheel] = folder.glob("*.tar.gz"), folder.glob("*.whl")
    return archive, wheel


def test_the_wheel_holds_the_package_and_nothing_else(dist):
    wanted = {path.relative_to(ROOT / "addon").as_posix() for path in (ROOT / "addon").rglob("*")
              if path.suffix in (".py", ".json", ".png", ".toml")}
    with zipfile.ZipFile(dist[1]) as wheel:
        names = {name for name in wheel.namelist() if ".dist-info/" not in name}
    assert names == {f"encre/{name}" for name in wanted | {LIBRARY}}


def test_the_source_holds_what_git_does(dist):
    if not (ROOT / ".git").exists():
        pytest.skip("needs a checkout")
    with tarfile.open(dist[0]) as archive:
        held = {member.name.partition("/")[2] for member in archive.getmembers() if member.isfile()}
    wanted = set(run("git", "ls-files").splitlines()) - {".ci/run", ".editorconfig", ".gitignore"}
    missing = {name for name in wanted - held if (ROOT / name).exists()}
    assert missing == set()
    assert [name for name in held if re.search(r"\.(so|dylib|dll|py[cod])$", name)] == []


@pytest.mark.parametrize("kind", [pytest.param(0, id="source", marks=pytest.mark.long), pytest.param(1, id="wheel")])
def test_pip_installs_what_renders(tmp_path, dist, kind):
    python = empty(tmp_path / "env")
    run(sys.executable, "-m", "pip", "--python", python, "install", "-q", "--ignore-installed", "--no-deps",
        "--no-index", "--no-build-isolation", dist[kind], cwd=tmp_path)
    (tmp_path / "scene.py").write_text(SCENE)
    run(python.with_name("encre"), "render", "scene.py", "-o", "out.exr", "--passes=lines", cwd=tmp_path)
    assert inked(tmp_path / "out.exr")
    where = run(python, "-c", "import encre; print(encre.__file__)", cwd=tmp_path)
    assert where.startswith(str(tmp_path / "env"))


def test_blender_installs_the_extension_and_renders(tmp_path, dist):
    pytest.importorskip("bpy", reason="needs Blender's Python module")
    with tarfile.open(dist[0]) as file:
        file.extractall(tmp_path, **({"filter": "data"} if hasattr(tarfile, "data_filter") else {}))
    [tree] = tmp_path.glob("encre-*")
    run(sys.executable, "setup.py", "-q", "extension", f"--wheel={dist[1]}", cwd=tree)
    [archive] = (tree / "build").glob("*.zip")
    out, script = tmp_path / "out.exr", tmp_path / "install.py"
    script.write_text(INSTALL.format(archive=str(archive)) + SCENE + RENDER.format(out=str(out)))
    said = run(empty(tmp_path / "env"), script, cwd=tmp_path, BLENDER_USER_EXTENSIONS=str(tmp_path / "extensions"),
               BLENDER_USER_CONFIG=str(tmp_path / "config"))
    assert inked(out)
    assert f"FROM {tmp_path / 'extensions'}" in said


@pytest.mark.skipif(not shutil.which("blender"), reason="needs the program blender")
def test_the_copied_folder_is_an_add_on(tmp_path):
    shutil.copytree(ROOT / "addon", tmp_path / "scripts" / "addons" / "encre",
                    ignore=shutil.ignore_patterns("__pycache__"))
    out, script = tmp_path / "out.exr", tmp_path / "render.py"
    script.write_text(SCENE + RENDER.format(out=str(out)))
    said = run("blender", "-b", "--factory-startup", "--addons", "encre", "-P", script, cwd=tmp_path,
               BLENDER_USER_SCRIPTS=str(tmp_path / "scripts"))
    assert inked(out)
    assert f"FROM {tmp_path / 'scripts'}" in said
