# SPDX-License-Identifier: GPL-3.0-or-later
"""What users install: source archive, wheel, extension and legacy add-on each render where nothing of ours lies."""

import json
import os
import re
import shutil
import subprocess
import sys
import tarfile
import venv
import zipfile
from pathlib import Path

import built
import exr
import pytest
from encre.pen.installed import LIBRARY

pytestmark = pytest.mark.slow

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
bpy.context.view_layer.encre.use_pass_lines = True
scene.render.image_settings.file_format = "OPEN_EXR_MULTILAYER"
scene.render.filepath = {out!r}
bpy.ops.render.render(write_still=True)
import sys
engine = bpy.types.RenderEngine.bl_rna_get_subclass_py("ENCRE")
print("FROM", engine.bl_label, sys.modules[engine.__module__].__file__, flush=True)
'''
END = """
import os
os._exit(0)
"""
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


def ink(path):
    return exr.part(path, "ViewLayer.Encre Lines")[..., 3]


def inked(path):
    return ink(path).max() > 0.25 and ink(path).mean() < 0.5


@pytest.fixture(scope="module")
def dist(tmp_path_factory):
    """(source archive, wheel) as a release has them: the wheel is built from what the archive holds."""
    folder = tmp_path_factory.mktemp("dist")
    soon = "-C--build-option=build_ext", "-C--build-option=--scalar"  # compiled in half of the time
    run(sys.executable, "-m", "build", "--no-isolation", "--outdir", folder, *soon, ROOT, CFLAGS="-O0")
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


def extension(wheel, folder, kind="extension"):
    """The zip that Blender installs, made of the wheel by what the source holds."""
    run(sys.executable, "setup.py", "-q", kind, f"--wheel={wheel}", cwd=folder)
    [made] = (folder / "build").glob("*.zip")
    return made.rename(wheel.with_suffix(f".{kind}.zip"))


def rewritten(wheel, to, members):
    """The wheel with other contents for some of its files."""
    with zipfile.ZipFile(wheel) as source, zipfile.ZipFile(to, "w") as file:
        assert members.keys() <= set(source.namelist())
        for name in source.namelist():
            file.writestr(name, members.get(name) or source.read(name))
    return to


@pytest.fixture(scope="module")
def tree(dist, tmp_path_factory):
    folder = tmp_path_factory.mktemp("tree")
    with tarfile.open(dist[0]) as file:
        file.extractall(folder, **({"filter": "data"} if hasattr(tarfile, "data_filter") else {}))
    [tree] = folder.glob("encre-*")
    return tree


def test_the_extension_holds_the_python_and_a_wheel_of_the_library(dist, tree):
    wanted = {path.relative_to(ROOT / "addon").as_posix() for path in (ROOT / "addon").rglob("*")
              if path.suffix in (".py", ".json", ".toml", ".png")}
    wanted = {name for name in wanted if not name.startswith("cli/")} - {"__main__.py"}
    with zipfile.ZipFile(extension(dist[1], tree)) as archive:
        [wheel] = [name for name in archive.namelist() if name.startswith("wheels/")]
        assert set(archive.namelist()) == wanted | {"LICENSE", wheel}
        manifest = archive.read("blender_manifest.toml").decode()
        assert f'wheels = ["./{wheel}"]' in manifest
        # What reviewers of extensions refuse.
        refused = re.compile(r"\bimport (threading|subprocess)\b|sys\.path\.|sys\.path *=|\b(eval|exec)\(")
        assert [name for name in archive.namelist()
                if name.endswith(".py") and refused.search(archive.read(name).decode())] == []
        with zipfile.ZipFile(archive.open(wheel)) as held:
            assert held.testzip() is None
            [library] = [name for name in held.namelist() if ".dist-info/" not in name]
            assert re.fullmatch(r"libencre-\d+\.\d+\.\d+\+[0-9a-f]{8}\.(so|dylib|dll)", library)


def test_blender_runs_the_extension_that_it_installed_last(tmp_path, dist, tree):
    """Three after each other in one process: the first, a later version, another build of that version. Python finds
    other packages of their names before them."""
    pytest.importorskip("bpy", reason="needs Blender's Python module")
    engine = (ROOT / "addon" / "blender" / "engine.py").read_text(encoding="utf-8")
    assert 'bl_label = "Encre"' in engine
    wheels = [dist[1]]
    for name, version, thickness in ("Thin", "9.0.0", "0.1f"), ("Thick", "9.0.0", "1.0f"):
        library = built.changed(tmp_path / f"{name}.so", "csrc/ink/lines.c", "0.5f * p->line_thickness",
                                f"{thickness} * p->line_thickness")
        (tmp_path / name).mkdir()
        tag = dist[1].name.split("-", 2)[2]
        wheels.append(rewritten(dist[1], tmp_path / name / f"encre-{version}-{tag}", {
            f"encre/{LIBRARY}": library.read_bytes(),
            "encre/blender/engine.py": engine.replace('bl_label = "Encre"', f'bl_label = "{name}"').encode()}))
    for name in "encre", "encre_library", "pen":
        (tmp_path / "rubbish" / name).mkdir(parents=True)
        (tmp_path / "rubbish" / name / "__init__.py").write_text("raise ImportError('rubbish')")
    script, pictures = tmp_path / "install.py", [tmp_path / f"{k}.exr" for k in range(3)]
    script.write_text("".join(INSTALL.format(archive=str(extension(wheel, tree))) + SCENE + RENDER.format(out=str(out))
                              for wheel, out in zip(wheels, pictures, strict=True)) + END)
    said = run(empty(tmp_path / "env"), script, cwd=tmp_path, BLENDER_USER_EXTENSIONS=str(tmp_path / "extensions"),
               BLENDER_USER_CONFIG=str(tmp_path / "config"), PYTHONPATH=str(tmp_path / "rubbish"))
    place = tmp_path / "extensions" / "user_default" / "encre" / "blender" / "engine.py"
    assert re.findall("^FROM (.*)$", said, re.MULTILINE) == [f"{name} {place}" for name in ("Encre", "Thin", "Thick")]
    first, thin, thick = (ink(out).mean() for out in pictures)
    assert inked(pictures[0]) and thin < 0.7 * first and thick > 1.3 * first


TWO = '''
import bpy
import addon_utils, json
bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)
def fact(*what):
    print("FACT " + json.dumps(what), flush=True)
def state():
    engine = bpy.types.RenderEngine.bl_rna_get_subclass_py("ENCRE")
    ours = tuple(name + ".blender." for name in ONE_AND_OTHER)
    classes = [cls for kind in (bpy.types.Panel, bpy.types.Operator, bpy.types.PropertyGroup)
               for cls in kind.__subclasses__() if cls.__module__.startswith(ours) and cls.is_registered]
    return [engine and engine.__module__, sorted({cls.__module__.partition(".blender.")[0] for cls in classes}),
            hasattr(bpy.context.scene, "encre")]
def enable(name):
    said = []
    addon_utils.enable(name, handle_error=lambda error: said.append(str(error)))
    fact(name, said, *state())
for first, second in ONE_AND_OTHER, ONE_AND_OTHER[::-1]:
    enable(first)
    enable(second)
    addon_utils.disable(first)
    fact("off", *state())
    enable(second)
    addon_utils.disable(second)
    fact("off", *state())
''' + END


def two(command, tmp_path, names, **environment):
    """Enables each of two Encres while the other is enabled, and then by itself."""
    script = tmp_path / "two.py"
    script.write_text(TWO.replace("ONE_AND_OTHER", repr(names)))
    said = run(*command, script, cwd=tmp_path, **environment)
    found = [json.loads(line[5:]) for line in said.splitlines() if line.startswith("FACT ")]
    expected = []
    for first, second in names, names[::-1]:
        [sentence] = found[len(expected) + 1][1]
        assert sentence.startswith("Encre is enabled already, from ") and f"/{first.rpartition('.')[2]}: " in sentence
        expected += [[first, [], f"{first}.blender.engine", [first], True],
                     [second, [sentence], f"{first}.blender.engine", [first], True], ["off", None, [], False],
                     [second, [], f"{second}.blender.engine", [second], True], ["off", None, [], False]]
    assert found == expected


def copied(folder, *names):
    for name in names:
        shutil.copytree(ROOT / "addon", folder / "scripts" / "addons" / name,
                        ignore=shutil.ignore_patterns("__pycache__"))


def test_of_two_encres_the_first_stays(tmp_path, dist, tree):
    """An add-on and an extension."""
    pytest.importorskip("bpy", reason="needs Blender's Python module")
    copied(tmp_path, "encre_copy")
    places = {"BLENDER_USER_EXTENSIONS": str(tmp_path / "extensions"), "BLENDER_USER_CONFIG": str(tmp_path / "config"),
              "BLENDER_USER_SCRIPTS": str(tmp_path / "scripts")}
    install = tmp_path / "install.py"
    install.write_text(INSTALL.replace("enable_on_install=True", "enable_on_install=False").format(
        archive=str(extension(dist[1], tree))) + END)
    python = empty(tmp_path / "env")
    run(python, install, cwd=tmp_path, **places)
    two([python], tmp_path, ["encre_copy", "bl_ext.user_default.encre"], **places)


@pytest.mark.skipif(not shutil.which("blender"), reason="needs the program blender")
def test_of_two_add_ons_the_first_stays(tmp_path):
    copied(tmp_path, "encre", "encre_copy")
    two(["blender", "-b", "--factory-startup", "-P"], tmp_path, ["encre", "encre_copy"],
        BLENDER_USER_SCRIPTS=str(tmp_path / "scripts"))


@pytest.mark.skipif(not shutil.which("blender"), reason="needs the program blender")
def test_an_old_blender_installs_the_addons_zip(tmp_path, dist, tree):
    archive = extension(dist[1], tree, "addon")
    with zipfile.ZipFile(archive) as held:
        assert {name.partition("/")[0] for name in held.namelist()} == {"encre"}
        assert {"encre/__init__.py", "encre/LICENSE", f"encre/{LIBRARY}"} <= set(held.namelist())
    out, script = tmp_path / "out.exr", tmp_path / "render.py"
    install = (f"import bpy\nbpy.ops.preferences.addon_install(filepath={str(archive)!r})\n"
               'bpy.ops.preferences.addon_enable(module="encre")\n')
    script.write_text(install + SCENE + RENDER.format(out=str(out)) + END)
    (tmp_path / "scripts" / "addons").mkdir(parents=True)
    said = run("blender", "-b", "--factory-startup", "-P", script, cwd=tmp_path,
               BLENDER_USER_SCRIPTS=str(tmp_path / "scripts"))
    assert inked(out)
    assert f"FROM Encre {tmp_path / 'scripts'}" in said
