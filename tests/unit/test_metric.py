# SPDX-License-Identifier: GPL-3.0-or-later
"""Inline maths in units of the last place, and colour differences against published values."""

import ctypes
import os
import shlex
import subprocess
from pathlib import Path

import numpy as np
import pytest
from reference import metric as reference

ROOT = Path(__file__).resolve().parents[2]
METRICS = ("RGB", "CIE76", "CIEDE2000", "CMC")  # in the order of their numbers


@pytest.fixture(scope="module")
def probe(tmp_path_factory):
    out = tmp_path_factory.mktemp("probe") / "probe.so"
    flags = "-std=c11 -O3 -fPIC -shared -Wall -Werror -fno-math-errno -fno-trapping-math -ffp-contract=off"
    subprocess.run([*shlex.split(os.environ.get("CC", "cc")), *flags.split(), f"-I{ROOT / 'csrc'}",
                    str(ROOT / "tests" / "helpers" / "probe.c"), "-o", str(out), "-lm"], check=True)
    return ctypes.CDLL(str(out))


def pointer(a):
    return a.ctypes.data_as(ctypes.c_void_p)


def call(function, x, y=None):
    x = np.ascontiguousarray(x, np.float32)
    y = np.ascontiguousarray(x if y is None else y, np.float32)
    out = np.empty_like(x)
    function(x.size, pointer(x), pointer(y), pointer(out))
    return out


def planes(colors):
    """(n, 3) -> contiguous (3, n) float32."""
    return np.ascontiguousarray(np.asarray(colors, np.float32).T)


def difference(probe, name, one, two):
    one, two = planes(one), planes(two)
    out = np.zeros(one.shape[1], np.float32)
    probe.probe_difference(METRICS.index(name), out.size, pointer(one), pointer(two), pointer(out))
    return out


def space(probe, name, linear):
    colors = planes(linear)
    probe.probe_space(METRICS.index(name), colors.shape[1], pointer(colors))
    return colors.T


def ulps(got, want):
    return np.abs(got - want) / np.spacing(np.abs(want).astype(np.float32)).astype(np.float64)


RNG = np.random.default_rng(7)
N = 200_000
UNIT, SIGNED = RNG.random(N).astype(np.float32), RNG.uniform(-1, 1, N).astype(np.float32)
WIDE = (10 ** RNG.uniform(-29, 29, N)).astype(np.float32)
ANGLES = RNG.uniform(-40, 40, N).astype(np.float32)
SMALL_TO_1 = (10 ** RNG.uniform(-8, 0, N)).astype(np.float32)


# Limits are what the maths reaches, so that a digit lost in any constant shows; 4 are promised (srgb: 6).
@pytest.mark.parametrize("name, x, y, want, limit", [
    ("cbrt", WIDE, WIDE, lambda x, y: np.cbrt(x), 0.52),
    ("srgb", UNIT, UNIT, lambda x, y: reference.encode(x), 5.5),
    ("srgb", UNIT / 128, UNIT, lambda x, y: reference.encode(x), 5.5),
    ("exp", 87 * SIGNED, UNIT, lambda x, y: np.exp(x), 1.25),
    ("log", WIDE, UNIT, lambda x, y: np.log(x), 1.25),
    ("log", 0.75 + 0.6 * UNIT, UNIT, lambda x, y: np.log(x), 1.25),
    ("pow", UNIT, 6 * SMALL_TO_1, lambda x, y: x**y, 1.25),
    ("pow", SMALL_TO_1, 6 * UNIT, lambda x, y: x**y, 1.25),
    ("pow", WIDE, UNIT, lambda x, y: x**y, 1.25),
    ("pow", 0.75 + 0.6 * UNIT, 180 * UNIT[::-1], lambda x, y: x**y, 1.25),
    ("pow", 1e-42 + 1e-38 * UNIT, UNIT, lambda x, y: x**y, 1.25),  # subnormal numbers
    ("atan2", SIGNED, SIGNED[::-1], lambda x, y: np.arctan2(x, y), 2.7),
    ("atan2", WIDE * np.sign(SIGNED), WIDE[::-1] * np.sign(SIGNED[::-1]), lambda x, y: np.arctan2(x, y), 2.7),
    ("sin", ANGLES, ANGLES, lambda x, y: np.sin(x), 1.6),
    ("cos", ANGLES, ANGLES, lambda x, y: np.cos(x), 1.6),
    ("sin", 200 * ANGLES, ANGLES, lambda x, y: np.sin(x), 1.6),
    ("sin", np.float32(np.pi) * np.arange(-1000, 1000), ANGLES[:2000], lambda x, y: np.sin(x), 1.6),
    ("luminance", UNIT, SIGNED**2, lambda x, y: 0.2126 * x + 0.7152 * y + 0.0722 * 0.25, 2),
])
def test_inline_maths(probe, name, x, y, want, limit):
    x, y = np.asarray(x, np.float32), np.asarray(y, np.float32)
    expected = want(x.astype(np.float64), y.astype(np.float64))
    normal = np.abs(expected) > 1.2e-38
    error = ulps(call(getattr(probe, f"probe_{name}"), x, y), expected)[normal]
    assert error.max() <= limit


@pytest.mark.parametrize("name", METRICS)
def test_colours_do_not_depend_on_their_neighbours(probe, name):
    """Runs of one colour are encoded once: of any length, beginning anywhere, black and minus nothing among them."""
    values = np.float32([0, 0.2, 1, 0.2, 0.0031, -0.0, 0.7])
    for n in (1, 2, 7, 8, 9, 15, 16, 17, 31, 33, 255, 257):
        for run in (1, 3, 8, 20, 300):
            colors = np.stack([values[(np.arange(n) // run + c) % len(values)] for c in range(3)], 1)
            alone = np.concatenate([space(probe, name, colors[i:i + 1].copy()) for i in range(n)])
            assert space(probe, name, colors).tobytes() == alone.tobytes(), (n, run)


def test_exact_values(probe):
    assert call(probe.probe_srgb, [0, 1]).tolist() == [0, 1]
    assert call(probe.probe_cbrt, [0, 1, 8, 27]).tolist() == [0, 1, 2, 3]
    assert call(probe.probe_pow, [0, 0, 1, 0.5, 3, 1e-30, 1e30, 2], [0, 2, 9, 1, 0, 9, 9, 127.5]).tolist() == \
        [1, 0, 1, 0.5, 1, 0, 2.0**127, 2.0**127]
    assert call(probe.probe_atan2, [0, 0, 1, -1], [0, 1, 0, 0]).tolist() == \
        np.float32([0, 0, np.pi / 2, -np.pi / 2]).tolist()
    assert call(probe.probe_exp, [0, -1e30, -87.1, 1e30, 88.1]) == \
        pytest.approx(np.exp([0.0, -87.0, -87.0, 88.0, 88.0]), rel=1e-6, abs=0)
    nothing = [0, -1, np.nan, np.inf, -np.inf, 1e9, 1.001e9]
    assert np.isposinf(call(probe.probe_depth, nothing)).all()
    assert call(probe.probe_depth, [1e-40, 5, 0.999e9]).tolist() == np.float32([1e-40, 5, 0.999e9]).tolist()


def test_ciede2000_published_pairs(probe, data):
    table = np.genfromtxt(data / "ciede2000-sharma.txt", delimiter=",", skip_header=0, comments="#")
    table = table[np.isfinite(table).all(axis=1)]
    assert len(table) == 34
    one, two, want = table[:, :3], table[:, 3:6], table[:, 6]
    for a, b in ((one, two), (two, one)):
        assert np.abs(100 * difference(probe, "CIEDE2000", a, b) - want).max() <= 1e-4


@pytest.mark.parametrize("name", METRICS)
def test_against_reference(probe, name):
    one, two = RNG.random((2, 20_000, 3)).astype(np.float32)
    one[:4000] = one[:4000, :1]  # greys
    two[2000:6000] = one[2000:6000] + RNG.normal(0, 0.01, (4000, 3))  # hardly different
    two[6000:8000] = two[6000:8000] ** 6  # dark
    one[8000:9000] = 0.0
    one, two = np.clip(one, 0, 1), np.clip(two, 0, 1)
    got = difference(probe, name, space(probe, name, one), space(probe, name, two))
    encoded = [reference.encode(c.astype(np.float64)) for c in (one, two)]
    sure = ~reference.jumps(name, *encoded)
    assert sure.mean() > 0.98
    want = reference.difference(name, *encoded)
    assert np.all(np.abs(got - want)[sure] <= (2e-6 + 2e-5 * want)[sure])


@pytest.mark.parametrize("name", METRICS)
def test_black_white_grey(probe, name):
    grey = np.repeat(np.linspace(0, 1, 101, dtype=np.float32)[:, None], 3, axis=1)
    same = space(probe, name, grey)
    assert not difference(probe, name, same, same).any()
    if name != "RGB":
        assert not same[:, 1:].any()  # no chroma, to the last bit
    ends = difference(probe, name, same[:1], same[-1:])
    assert abs(ends[0] - (1 if name != "CMC" else reference.difference(name, np.zeros(3), np.ones(3)))) < 1e-6


def test_lab_where_its_cube_root_meets_the_line(probe):
    """The two meet with one slope, so that only fine differences tell where."""
    grey = np.repeat(np.linspace(0.0087, 0.0090, 301)[:, None], 3, axis=1).astype(np.float32)
    want = reference.lab(reference.encode(grey.astype(np.float64)))
    assert np.abs(space(probe, "CIE76", grey) - want).max() < 2e-5


def test_cmc_branches_at_164_and_345_degrees(probe):
    hue = np.radians(np.float64([163.998, 164.002, 344.998, 345.002]))
    one = np.stack([np.full(4, 50.0), 90 * np.cos(hue), 90 * np.sin(hue)], axis=1).astype(np.float32)
    for turn in (-0.3, 0.3):  # one order's branch, then the other's, is the larger
        two = np.stack([np.full(4, 50.0), 60 * np.cos(hue + turn), 60 * np.sin(hue + turn)], axis=1).astype(np.float32)
        want = reference.cmc(one.astype(np.float64), two.astype(np.float64)) / 100
        assert difference(probe, "CMC", one, two) == pytest.approx(want, rel=1e-5)


def test_difference_keeps_the_largest(probe):
    one, two = planes([[0, 0, 0]] * 2), planes([[1, 1, 1]] * 2)
    out = np.float32([0.5, 3])
    probe.probe_difference(0, 2, pointer(one), pointer(two), pointer(out))
    assert out.tolist() == [1, 3]
