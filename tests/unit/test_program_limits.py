# SPDX-License-Identifier: GPL-3.0-or-later
"""Where what materials may ask for ends: the last number that is right is taken, the first beyond it refused."""

from ctypes import byref, c_void_p

import numpy as np
import pytest
from encre.pen import abi
from encre.pen.library import API_VERSION, load
from jobs import Job

MOST_TEXELS, MOST_REGISTERS = 32768, 1024


def refused_if(wrong, job, words):
    if wrong:
        job.refused(words)
    else:
        job.run()


@pytest.mark.parametrize("registers", [0, 1, MOST_REGISTERS, MOST_REGISTERS + 1])
def test_how_many_registers_a_program_has(registers):
    job = Job("material")
    job.block.programs[0].n_registers = registers
    refused_if(registers in (0, MOST_REGISTERS + 1), job, "^program 0: has .* registers; give 1 to 1024")


def test_results_are_registers():
    for k in (0, abi.RESULTS - 1):
        for register in (-1, 0, 1):
            job = Job("material")
            job.block.programs[0].result[k] = register
            refused_if(register != 0, job, f"^program 0: result {k} is no register of it; give 0 to 0$")


def test_what_succeeds_takes_the_sentence_of_what_was_refused_away():
    good, bad = Job("material"), Job("material")
    bad.block.programs[0].n_registers = 0
    lib = good.lib.lib
    context = c_void_p(lib.encre_create(API_VERSION))
    try:
        assert lib.encre_material(context, byref(bad.job)) and lib.encre_error(context)
        assert lib.encre_material(context, byref(good.job)) == 0 and lib.encre_error(context) == b""
    finally:
        lib.encre_destroy(context)


@pytest.mark.parametrize("name", list(load().operations))
def test_an_operation_names_what_is_there(name):
    """Registers that are there and are not those it writes, the last constant, channel, texture and value."""
    code, inputs, outputs = load().operations[name]
    need = {"constant": 1, "footprint": 6, "ramp": 10, "steps": 10, "curve": 2, "brick": 9, "noise": 2}.get(name, 0)
    first = {"channel": 2, "footprint": 0, "texture": 0, "thing": 1}.get(name, 3)  # the last that is right
    which = 1 if name == "footprint" else 0

    def with_(out=1, register=0, constants=40, **data):
        job = Job("material")
        job.block.programs[0].n_registers, job.block.n_constants = 1 + outputs, constants
        o = job.operation
        o.code, o.out = code, out
        getattr(o, "in")[:] = [register] * 8
        o.data[:] = first, 2 if name in ("ramp", "steps", "curve") else 0
        if need:
            o.data[which] = 3
        for k, value in data.items():
            o.data[int(k[1:])] = value
        return job

    words = "names a register, constant, channel or texture that it can't use"
    with_().run()
    for wrong in (dict(out=2), dict(out=-1), dict(register=-1), dict(register=1 + outputs)):
        with_(**wrong).refused(words)
    if inputs:
        for register in (1, outputs):
            with_(register=register).refused(words)
        for k in range(8):  # those that it does not take are any
            job = with_()
            getattr(job.operation, "in")[k] = -1
            refused_if(k < inputs, job, words)
    if need:
        with_(constants=3 + need).run()
        with_(constants=2 + need).refused(words)
        with_(**{f"d{which}": -1}).refused(words)
    if name in ("channel", "footprint", "texture", "thing"):
        with_(d0=first + 1).refused(words)
        with_(d0=-1).refused(words)
    if name in ("ramp", "steps", "curve"):
        least = 2 if name == "curve" else 1
        with_(d1=least).run()
        with_(d1=least - 1).refused(words)


@pytest.mark.parametrize("width, height, levels, wrap, right", [
    (1, 1, 1, 0, True), (1, 1, 2, 0, False), (1, 1, 0, 0, False), (5, 3, 3, 2, True), (3, 5, 3, 0, True),
    (5, 3, 4, 0, False), (4, 1, 3, 0, True), (0, 1, 1, 0, False), (1, 0, 1, 0, False), (1, 1, 1, -1, False),
    (1, 1, 1, 3, False), (MOST_TEXELS, 1, 16, 0, True), (MOST_TEXELS + 1, 1, 1, 0, False),
    (1, MOST_TEXELS + 1, 1, 0, False), (1, MOST_TEXELS, 1, 0, True)])
def test_pictures_of_materials_have_their_levels(width, height, levels, wrap, right):
    job = Job("material")
    picture = job.block.textures[0]
    picture.texels = job.memory(32 * max(width * height, 1))
    picture.width, picture.height, picture.levels, picture.wrap = width, height, levels, wrap
    refused_if(not right, job, "^texture 0: is ")
    picture.texels = None
    job.refused("^texture 0: has neither")


def test_pictures_of_materials_have_numbers_or_bytes():
    job = Job("material")
    picture = job.block.textures[0]
    curve = np.zeros(256, np.float32)
    picture.bytes, picture.curve = job.memory(4), curve.ctypes.data
    job.refused("^texture 0: has neither")  # has both
    picture.texels = None
    job.run()
    for bad in (-1, np.nan, np.inf):
        curve[7] = bad
        job.refused("^texture 0: has neither")
    curve[:] = 0
    picture.curve = None
    job.refused("^texture 0: has neither")


@pytest.mark.parametrize("field", ["n_programs", "n_textures", "n_constants", "n_things", "n_values"])
def test_numbers_of_materials_are_those_of_what_is_there(field):
    job = Job("material")
    setattr(job.block, field, -1)
    job.refused("^materials: ")
    job = Job("material")
    pointer = field[2:] if field != "n_values" else "things"
    setattr(job.block, pointer, None)
    job.refused("^materials: ")
    setattr(job.block, field, 0)
    if field == "n_constants":
        job.block.programs[0].n_operations = 0
    job.run()


def test_operations_are_there():
    job = Job("material")
    job.block.programs[0].operations = None
    job.refused("^program 0: ")
    job.block.programs[0].n_operations = -1
    job.refused("^program 0: ")
    job.block.programs[0].n_operations = 0
    job.run()
    for code in (-1, len(load().operations)):
        job = Job("material")
        job.operation.code = code
        job.refused(f"^program 0: operation 0 has the unknown code {code}")
