# SPDX-License-Identifier: GPL-3.0-or-later
"""Who may know whom: the arrows between the rooms of the house go one way."""

import ast
import json
import re
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
CSRC, ADDON = ROOT / "csrc", ROOT / "addon"
INCLUDE = re.compile(r'^\s*#\s*include "([^"]+)"', re.MULTILINE)
# What a room of csrc may include besides itself, base and encre.h.
BELOW = {"base": set(), "edges": set(), "fine": {"edges"}, "ink": {"edges", "fine"}, "surface": {"edges", "fine"},
         "tones": set(), "paint": {"tones", "surface"}, "raster": set(), "chains": {"raster", "light", "texels"},
         "light": set(), "material": set(), "texture": {"edges"}, "texels": set(), "samples": set(), "flat": set(),
         "api": {"edges", "fine", "ink", "surface", "tones", "paint", "raster", "chains", "light", "material",
                 "texture", "texels", "samples", "flat"}}
INSIDE = {"inside.py", "staging.py", "inputs.py", "needed.py", "trust.py", "windowed.py"}  # what runs inside Blender


def includes():
    """(file, file that it includes), from csrc/."""
    for path in sorted(CSRC.rglob("*.[ch]")):
        for name in INCLUDE.findall(path.read_text(encoding="utf-8")):
            yield path.relative_to(CSRC).as_posix(), name


def room(name):
    return name.partition("/")[0] if "/" in name else ""


def test_includes_go_by_path_from_csrc():
    assert [pair for pair in includes() if not (CSRC / pair[1]).is_file()] == []


def test_every_room_of_c_is_known():
    assert {path.name for path in CSRC.iterdir() if path.is_dir()} == BELOW.keys()


def test_rooms_of_c_include_what_lies_below_them():
    # The stages' rows make the parameter struct, on which everything stands.
    wrong = [(own, other) for own, other in includes()
             if room(other) not in {"", "base", room(own)} | BELOW.get(room(own), set())
             and not (own == "base/all.rows.h" and other.endswith(".rows.h"))]
    assert wrong == []


RUN = re.compile(r"bands_run\([^;]*?, CHUNK, (\w+)(?:\[k\])?,")
LIST = re.compile(r"const bands_kernel (\w+)\[\] = \{([^}]*)\}")


def kernels_of_pieces(text):
    """Names of what bands_run() calls in a file with pieces of CHUNK, as it is or out of a list."""
    lists = {name: re.findall(r"\w+", names) for name, names in LIST.findall(text)}
    return {kernel for name in RUN.findall(text) for kernel in lists.get(name, [name])}


def test_kernels_of_long_pieces_ask_whether_they_were_stopped():
    # A piece takes up to half a millisecond, and a frame that nobody wants any more is to end within that of a row.
    silent, found = [], 0
    for path in sorted(CSRC.rglob("*.c")):
        text = path.read_text(encoding="utf-8")
        for name in sorted(kernels_of_pieces(text)):
            body = re.search(rf"^static void {name}\(.*?^}}", text, re.MULTILINE | re.DOTALL).group()
            found += 1
            if "stopped" not in body:
                silent.append((path.name, name))
    assert silent == [] and found > 30


@pytest.mark.parametrize("folder", sorted({path.parent for path in CSRC.rglob("*.c")}), ids=lambda p: p.name)
def test_a_room_of_c_names_its_files(folder):
    text = (folder / "README.md").read_text(encoding="utf-8")
    assert [path.stem for path in sorted(folder.glob("*.c")) if not re.search(rf"\b{path.stem}\b", text)] == []


@pytest.mark.parametrize("folder", ["pen", "blender", "blender/panels", "blender/study", "cli", "cli/farms",
                                    "cli/passes", "cli/sharing", "cli/study"])
def test_a_package_names_its_modules(folder):
    text = ast.get_docstring(ast.parse((ADDON / folder / "__init__.py").read_text(encoding="utf-8")))
    assert [path.stem for path in sorted((ADDON / folder).glob("[!_]*.py"))
            if not re.search(rf"\b{path.stem}\b", text)] == []


def imported(path):
    """The modules that a Python file imports, wherever it does, with their full names."""
    package = ("encre", *path.relative_to(ADDON).parts[:-1])
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            start = ".".join(package[:len(package) - node.level + 1]) if node.level else ""
            module = ".".join(filter(None, [start, node.module or ""]))
            yield from (f"{module}.{alias.name}" for alias in node.names)


def python(folder):
    return sorted((ADDON / folder).rglob("*.py"))


@pytest.mark.parametrize("path", python("pen"), ids=lambda path: path.name)
def test_pen_knows_no_blender(path):
    above = re.compile(r"(bpy|bmesh|mathutils|cycles|encre\.(blender|cli))\b")
    assert [name for name in imported(path) if above.match(name)] == []


@pytest.mark.parametrize("path", python("blender"), ids=lambda path: path.name)
def test_blender_knows_no_command_line(path):
    assert [name for name in imported(path) if name.startswith("encre.cli")] == []


@pytest.mark.parametrize("path", [p for p in python("cli") if p.name not in INSIDE], ids=lambda path: path.name)
def test_only_what_runs_inside_blender_knows_it(path):
    assert [name for name in imported(path) if re.match(r"(bpy|encre\.blender)\b", name)] == []


def test_what_blender_loads_starts_no_threads():
    """Blender's data bear none, and who reviews extensions refuses them."""
    threads = {"threading", "_thread", "concurrent", "multiprocessing"}
    assert [path.name for path in ADDON.rglob("*.py") for name in imported(path)
            if name.partition(".")[0] in threads and name != "_thread.get_ident"] == []


def test_only_the_bindings_know_ctypes():
    know = {path.name for path in ADDON.rglob("*.py") for name in imported(path) if name.partition(".")[0] == "ctypes"}
    assert know == {"abi.py", "library.py", "denoise.py"}


def test_only_one_module_asks_for_blenders_version():
    know = {path.name for path in ADDON.rglob("*.py") if "bpy.app.version" in path.read_text(encoding="utf-8")
            and "bpy.app.version_string" not in path.read_text(encoding="utf-8")}
    assert know == {"versions.py"}


def test_no_two_cases_of_blender_have_one_name():
    """Of two the later one would be run in the place of the other."""
    inside, names = ROOT / "tests" / "blender" / "inside", []
    (topics,) = re.findall(r"for topic in \(([^)]*)\)", (inside / "cases.py").read_text(encoding="utf-8"))
    for topic in re.findall(r"\w+", topics):
        tree = ast.parse((inside / f"{topic}.py").read_text(encoding="utf-8"))
        names += [each.name for each in tree.body if isinstance(each, ast.FunctionDef)]
    assert sorted({name for name in names if names.count(name) > 1 and name[0] != "_"}) == []


def test_no_preset_or_language_names_a_thing_twice():
    """Of two the later one would count in silence."""
    def once(pairs):
        names = [name for name, _ in pairs]
        assert sorted({name for name in names if names.count(name) > 1}) == []
        return dict(pairs)

    files = sorted(ADDON.rglob("*.json"))
    assert len(files) > 20
    for path in files:
        json.loads(path.read_text(encoding="utf-8"), object_pairs_hook=once)
