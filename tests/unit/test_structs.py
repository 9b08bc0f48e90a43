# SPDX-License-Identifier: GPL-3.0-or-later
"""The structs of csrc/encre.h as ctypes has them: the same fields at the same offsets, of the same size."""

import ctypes
import os
import re
import shlex
import subprocess
from pathlib import Path

import pytest
from encre.pen import abi, library

ROOT = Path(__file__).parents[2]
MIRRORS = {
    "encre_image": abi.Image,
    "encre_layer_description": abi.LayerInfo,
    "encre_control_description": abi.ControlInfo,
    "encre_level": abi.Level,
    "encre_levels": abi.Levels,
    "encre_enum_item": abi.Item,
    "encre_param_info": abi.ParamInfo,
    "encre_stage_description": abi.StageInfo,
    "encre_camera": abi.Camera,
    "encre_frame": abi.Frame,
    "encre_mesh": abi.Mesh,
    "encre_raster_job": abi.RasterJob,
    "encre_chain_point": abi.ChainPoint,
    "encre_line_description": abi.LineInfo,
    "encre_stroke_point": abi.StrokePoint,
    "encre_chain_job": abi.ChainJob,
    "encre_colored": abi.Colored,
    "encre_bake_job": abi.BakeJob,
    "encre_geometry": abi.Geometry,
    "encre_texture": abi.Texture,
    "encre_instance": abi.Instance,
    "encre_lamp": abi.Lamp,
    "encre_bend": abi.Bend,
    "encre_light_job": abi.LightJob,
    "encre_even_job": abi.EvenJob,
    "encre_average_job": abi.AverageJob,
    "encre_call_job": abi.CallJob,
    "encre_step": abi.Step,
    "encre_operation_description": abi.OperationInfo,
    "encre_operation": abi.Operation,
    "encre_program": abi.Program,
    "encre_picture": abi.Picture,
    "encre_materials": abi.Materials,
    "encre_material_job": abi.MaterialJob,
}


def declared():
    """{struct: names of its fields in order}, as the header declares them."""
    text = re.sub(r"/\*.*?\*/", "", (ROOT / "csrc" / "encre.h").read_text(encoding="utf-8"), flags=re.S)
    structs = {}
    for name, body in re.findall(r"typedef struct (\w+) \{(.*?)\} \1;", text, re.S):
        declarators = [d for line in body.split(";") if line.strip() for d in line.split(",")]
        structs[name] = [re.search(r"(\w+)\s*(\[\w+\])?\s*$", d)[1] for d in declarators]
    return structs


@pytest.fixture(scope="module")
def compiled(tmp_path_factory):
    """{struct: (its size, {field: (offset, size)})}, as the compiler lays them out."""
    folder = tmp_path_factory.mktemp("structs")
    lines = [f'printf("{s} {f} %zu %zu %zu\\n", sizeof({s}), offsetof({s}, {f}), sizeof((({s} *)0)->{f}));'
             for s, fields in declared().items() for f in fields]
    source = '#include "encre.h"\n#include <stddef.h>\n#include <stdio.h>\nint main(void) {\n%s\n}\n'
    (folder / "print.c").write_text(source % "\n".join(lines))
    subprocess.run([*shlex.split(os.environ.get("CC", "cc")), "-std=c11", f"-I{ROOT / 'csrc'}", str(folder / "print.c"),
                    "-o", str(folder / "print")], check=True)
    out = {}
    for line in subprocess.run([folder / "print"], capture_output=True, text=True, check=True).stdout.splitlines():
        struct, field, *numbers = line.split()
        size, offset, width = map(int, numbers)
        out.setdefault(struct, (size, {}))[1][field] = offset, width
    return out


def test_every_struct_has_its_mirror():
    assert declared().keys() == MIRRORS.keys() | {"encre_job"}


@pytest.mark.parametrize("struct", [*MIRRORS, "encre_job"])
def test_fields_lie_where_the_compiler_puts_them(struct, compiled):
    mirror = MIRRORS.get(struct) or library.load()._job
    fields = {name: (getattr(mirror, name).offset, getattr(mirror, name).size) for name, *_ in mirror._fields_}
    assert (ctypes.sizeof(mirror), fields) == compiled[struct]
    assert list(fields) == declared()[struct]
