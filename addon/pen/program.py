# SPDX-License-Identifier: GPL-3.0-or-later
"""Programs of materials in the making: numbers that are known are computed at once, others by registers."""

from __future__ import annotations

import contextlib
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from . import library
from .errors import EncreError
from .job import Picture, Program

MOST_REGISTERS = 1024


@dataclass(frozen=True)
class Register:
    number: int


Number = float | Register


class TooLong(EncreError):
    """A program that the machine has no room for."""

    def __init__(self) -> None:
        super().__init__("more nodes than there is room for")


class Pool:
    """Constants and textures that programs share, and what they ask of things."""

    def __init__(self) -> None:
        self.constants: list[float] = []
        self.textures: list[Picture] = []
        self.asked: list[tuple[str, str]] = []
        self._known: dict[tuple[float, ...], int] = {}

    def place(self, numbers: Sequence[float]) -> int:
        """Where these stand one after the other."""
        key = tuple(float(x) for x in numbers)
        if key not in self._known:
            self._known[key] = len(self.constants)
            self.constants += key
        return self._known[key]

    def told(self, kind: str, name: str) -> int:
        """Which of the attributes `asked` of things this is."""
        if (kind, name) not in self.asked:
            self.asked.append((kind, name))
        return self.asked.index((kind, name))

    def texture(self, texture: Picture) -> int:
        for k, other in enumerate(self.textures):
            if other.texels is texture.texels and other.wrap == texture.wrap:
                return k
        self.textures.append(texture)
        return len(self.textures) - 1


class Builder:
    """One program. Its methods take numbers and registers, and give them."""

    def __init__(self, pool: Pool) -> None:
        self.pool = pool
        self._rows: list[list[int]] = []
        self._count = 0
        self._known: dict[tuple, tuple[Register, ...]] = {}

    def run(self, name: str, inputs: Sequence[Number] = (), data: Sequence[int] = ()) -> tuple[Register, ...]:
        """The outputs of an operation."""
        key = name, tuple(inputs), tuple(data)
        if key not in self._known:
            code, count, outputs = library.load().operations[name]
            assert count == len(inputs), name
            taken = [self._register(x).number for x in inputs]
            out = self._count
            self._count += outputs
            if self._count > MOST_REGISTERS:
                raise TooLong
            pad = taken + [0] * (8 - len(taken))
            self._rows.append([code, out, *pad, *data, *[0] * (2 - len(data))])
            self._known[key] = tuple(Register(out + k) for k in range(outputs))
        return self._known[key]

    @contextlib.contextmanager
    def in_half(self) -> Iterator[None]:
        """Drops what is made meanwhile where it fails, or leaves less than half of the registers: TooLong."""
        before = len(self._rows), self._count, dict(self._known)
        try:
            yield
            if 2 * self._count > MOST_REGISTERS:
                raise TooLong
        except BaseException:
            del self._rows[before[0]:]
            self._count, self._known = before[1:]
            raise

    def _register(self, x):
        return x if isinstance(x, Register) else self.run("constant", data=(self.pool.place([x]),))[0]

    def code(self, name: str) -> int:
        return library.load().operations[name][0]

    def program(self, results: Sequence[Number]) -> Program:
        registers = [self._register(x).number for x in results]
        return Program(np.array(self._rows, np.int32).reshape(-1, 12), max(1, self._count), registers)

    # Arithmetic

    def add(self, a: Number, b: Number) -> Number:
        if isinstance(a, float) and isinstance(b, float):
            return a + b
        return b if a == 0 else a if b == 0 else self.run("add", (a, b))[0]

    def subtract(self, a: Number, b: Number) -> Number:
        if isinstance(a, float) and isinstance(b, float):
            return a - b
        return a if b == 0 else self.run("subtract", (a, b))[0]

    def multiply(self, a: Number, b: Number) -> Number:
        if isinstance(a, float) and isinstance(b, float):
            return a * b
        if a == 0 or b == 0:
            return 0.0
        return b if a == 1 else a if b == 1 else self.run("multiply", (a, b))[0]

    def divide(self, a: Number, b: Number) -> Number:
        if isinstance(b, float):
            return self.multiply(a, 1 / b if b else 0.0)
        return self.run("divide", (a, b))[0]

    def mix(self, a: Number, b: Number, t: Number) -> Number:
        if isinstance(t, float):
            return self.add(self.multiply(a, 1 - t), self.multiply(b, t))
        return a if a == b else self.run("mix", (a, b, t))[0]

    def minimum(self, a: Number, b: Number) -> Number:
        return min(a, b) if isinstance(a, float) and isinstance(b, float) else self.run("minimum", (a, b))[0]

    def maximum(self, a: Number, b: Number) -> Number:
        return max(a, b) if isinstance(a, float) and isinstance(b, float) else self.run("maximum", (a, b))[0]

    def clamp(self, a: Number) -> Number:
        return min(max(a, 0.0), 1.0) if isinstance(a, float) else self.run("clamp", (a,))[0]

    def less(self, a: Number, b: Number) -> Number:
        return float(a < b) if isinstance(a, float) and isinstance(b, float) else self.run("less", (a, b))[0]

    def apply(self, name: str, *inputs: Number) -> Number:
        """An operation that is not worth computing here."""
        return self.run(name, inputs)[0]
