# SPDX-License-Identifier: GPL-3.0-or-later
"""Times the stages, as ratios to copying 112 bytes a pixel in the same run: to build/bench.json and build/bench.svg.

    python tests/helpers/bench.py [--size WxH] [--rounds N] [--sizes] [--only TABLE]...

All looks, each stage alone, line searches, radii and densities, on one thread and on two, on layers where 12 % of the
pixels lie within 3 of a site of FINE; with --sizes also 720p to 8K. What is no stage, bench_costs.py measures.

Ratios, not seconds: they mean the same on a busy machine and a quiet one. The cases of a table take turns under the
same load, and the least of all rounds counts, for the copy as well: of processor time on one thread, of time by the
clock on two. What is drawn goes to memory that is there already, as the copy does.
"""

import argparse
import ctypes
import json
import os
import resource
import time
from pathlib import Path

import chart
import drawn
import numpy as np
from encre.pen import library

FILE = Path(__file__).parents[2] / "build" / "bench.json"
BYTES = 112  # a pixel's in the copy
THREADS = 1, 2
INTER_COLOR = dict(edge_threshold=0.01, line_color_strength=1.0, line_contrast=1.0, pen_1_softness=0.0,
                   line_thickness=12.0,
                   pen_1_steepness=0.5, pen_1_intensity=2.0, pen_1_grain=0.0, use_shading=False, use_smudging=False,
                   use_hatching=False)
ALL_OFF = dict(use_lines=False, use_shading=False, use_smudging=False, use_hatching=False, use_tones=False,
               use_rim=False, use_specks=False, use_wash=False, use_gouache=False, use_print=False, use_relief=False)
DOG, SOBEL, FINE = ({"edge_detector": name} for name in ("DOG", "SOBEL", "FINE"))
ALL_SOURCES = dict(line_color_strength=3.0, line_shadow_strength=4.0)
# case: its settings, the ratios that are aimed at on one thread and on two, and what is drawn
LOOKS = {
    "Water Memory, DOG": (DOG, (2.0, 1.5)),
    "Water Memory, FINE": (FINE, (2.5, 1.7)),
    "colour and light, DOG": (DOG | ALL_SOURCES, (3.0, 2.0)),
    "colour and light, FINE": (FINE | ALL_SOURCES, (3.0, 2.0)),
    "Inter-color, FINE": (FINE | INTER_COLOR, (3.0, 2.0)),
    "Inter-color, SOBEL": (SOBEL | INTER_COLOR, (3.0, 2.0)),
}
STAGES = {
    "edges, DOG": (ALL_OFF | DOG, "Encre Edges"),
    "edges, SOBEL": (ALL_OFF | SOBEL, "Encre Edges"),
    "edges, FINE": (ALL_OFF | FINE, "Encre Edges"),
    "shading": (ALL_OFF | dict(use_shading=True), "Combined"),
    "smudging": (ALL_OFF | DOG | dict(use_smudging=True), "Combined"),
    "hatching": (ALL_OFF | dict(use_hatching=True), "Combined"),
    "wash": (ALL_OFF | dict(use_wash=True), "Combined"),
    "gouache": (ALL_OFF | dict(use_gouache=True), "Combined"),
    "print": (ALL_OFF | dict(use_print=True), "Combined"),
    "relief": (ALL_OFF | dict(use_relief=True), "Combined"),
    "rim light": (ALL_OFF | dict(use_rim=True), "Combined"),
    "specks": (ALL_OFF | dict(use_specks=True), "Combined"),
    "lines, DOG": (ALL_OFF | DOG | dict(use_lines=True), "Combined"),
    "lines, FINE": (ALL_OFF | FINE | dict(use_lines=True), "Combined"),
}
RADII = 2, 5, 12, 28, 64
DENSITIES = 0, 3, 6, 12, 25  # % of the pixels near a site
SIZES = {"720p": (1280, 720), "1080p": (1920, 1080), "1440p": (2560, 1440), "4K": (3840, 2160), "8K": (7680, 4320)}


# Layers


def balls(width, height, cell):
    """Layers of balls in two colours, `cell` pixels apart, before a wall with bends; 0: a flat wall and no balls.

    Depth and index are those of the pixel centres, all else is the mean of four samples a pixel."""
    bands = [_band(width, top, min(top + 256, height), cell) for top in range(0, height, 256)]
    return {name: np.concatenate([band[name] for band in bands]) for name in bands[0]}


def _band(width, top, bottom, cell):
    """Rows of balls(): the samples of all at once would not fit at 8K."""
    def look(dx, dy):
        x, y = np.meshgrid(np.arange(width) + dx, np.arange(top, bottom) + dy)
        u, v = (a / cell % 1 * 2 - 1 for a in (x, y)) if cell else (x * 0 + 1, y * 0 + 1)
        rise = 0.64 - u * u - v * v
        ball, z = (rise > 0)[..., None], np.sqrt(np.maximum(rise, 0))
        normal = np.where(ball, np.stack([u, -v, z], -1) / 0.8,
                          np.stack([np.copysign(0.33, u), 0 * u, 0 * u + 0.944], -1))
        color = np.where((u + 0.3 * v > 0.1)[..., None], (0.7, 0.3, 0.2), (0.2, 0.4, 0.6))
        color = np.where(ball, color, (0.6, 0.6, 0.5))
        light = np.maximum(normal @ drawn.LIGHT, 0)[..., None] * (1.2, 1.15, 1.1) + (0.15, 0.15, 0.2)
        number = np.floor(x / cell) + 31 * np.floor(y / cell) + 2 if cell else 0
        return ((color, light, normal, color * light, ball * 0.0 + 1), np.where(ball[..., 0], 5 - z, 6),
                np.where(ball[..., 0], number, 1))

    samples = [look(dx, dy)[0] for dx in (-0.25, 0.25) for dy in (-0.25, 0.25)]
    color, light, normal, lit, alpha = (sum(kind) / 4 for kind in zip(*samples, strict=True))
    _, depth, index = look(0, 0)
    layers = dict(combined=np.concatenate([lit, alpha], -1), color=color, albedo=color, diffuse=light, normal=normal,
                  depth=depth, object=index)
    return {name: np.ascontiguousarray(a, np.float32) for name, a in layers.items()}


SOURCES = {"default sources": {}, "with colour and light": ALL_SOURCES}
CELL = {"default sources": 204, "with colour and light": 298}  # pixels from ball to ball: 12 % are near a site


def sites(layers, settings):
    """How many pixels hold a site, and which share of all lies within 3 of one."""
    holds = library.render(layers, settings, outputs=["Encre Edges"]).images["Encre Edges"][..., 0] > 0
    near, (height, width) = np.zeros_like(holds), holds.shape
    for dy in range(-3, 4):
        for dx in range(-3, 4):
            if dx * dx + dy * dy <= 9:
                own, other = ((slice(max(d, 0), n + min(d, 0)), slice(max(-d, 0), n + min(-d, 0)))
                              for d, n in ((dy, height), (dx, width)))
                near[own[0], other[0]] |= holds[own[1], other[1]]
    return int(holds.sum()), near.mean()


def held_bytes(layers, settings):
    """The most memory that a render holds besides input and output; glibc's count."""
    class Count(ctypes.Structure):
        _fields_ = [(name, ctypes.c_size_t) for name in ("arena", "free", "small", "blocks", "mapped", "most", "quick",
                                                         "used", "loose", "top")]

    count = ctypes.CDLL(None).mallinfo2
    count.restype = Count

    def held():
        now = count()
        return now.used + now.mapped

    library.load().forget()
    seen, before = [0], held()
    library.render(layers, settings, threads=1, progress=lambda _: seen.append(held()) or True)
    return max(seen) - before - layers["combined"].nbytes


# Time


def copy_seconds(nbytes):
    a, b = np.ones(nbytes // 4, np.float32), np.zeros(nbytes // 4, np.float32)
    best = 1e9
    for _ in range(5):
        start = time.perf_counter()
        b[:] = a
        best = min(best, time.perf_counter() - start)
    return best


class Runs:
    """Cases that take turns with the copy: (layers, settings, output); each is drawn into memory of its own size;
    image: what reads the images of settings."""

    def __init__(self, cases, image=None):
        self.cases, self.image, self.target = cases, image, {}
        most = max(layers["combined"][..., 0].size for layers, *_ in cases.values())
        self.from_, self.to = (np.ones(most * BYTES // 4, np.float32) for _ in range(2))

    def memory(self, shape):
        if shape not in self.target:
            self.target[shape] = np.zeros(shape, np.float32)
        return self.target[shape]

    def least(self, rounds, threads):
        """{case: (ratio to the copy of its pixels, seconds)}."""
        clock = time.process_time if threads == 1 else time.perf_counter
        best, copies = dict.fromkeys(self.cases, 1e9), dict.fromkeys(self.cases, 1e9)
        for _ in range(rounds):
            for name, (layers, settings, output) in self.cases.items():
                every = library.complete(library.check(settings))
                start = clock()
                library.draw(layers, every, outputs=[output], threads=threads, image=self.image, empty=self.memory)
                best[name] = min(best[name], clock() - start)
                floats = layers["combined"][..., 0].size * BYTES // 4
                start = clock()
                self.to[:floats] = self.from_[:floats]
                copies[name] = min(copies[name], clock() - start)
        of_size = {}
        for name, (layers, *_) in self.cases.items():
            size = layers["combined"].shape
            of_size[size] = min(of_size.get(size, 1e9), copies[name])
        return {name: (best[name] / of_size[self.cases[name][0]["combined"].shape], best[name]) for name in best}


def measure(title, cases, rounds, aims=None, held=False, image=None):
    """Prints a table of cases; returns it as rows for the file."""
    runs, rows = Runs(cases, image), []
    print(f"\n{title:26}" + "".join(f"{f'{n} threads' if n > 1 else '1 thread':>12}{'aim':>6}" for n in THREADS)
          + f"{'ms':>9}" + f"{'bytes':>8}" * held)
    least = [runs.least(rounds, threads) for threads in THREADS]
    for name, (layers, settings, _) in cases.items():
        aim = (aims or {}).get(name, (None, None))
        row = {"table": title, "case": name, "pixels": layers["combined"][..., 0].size,
               "ratio": [round(times[name][0], 3) for times in least],
               "seconds": [round(times[name][1], 6) for times in least]}
        if aim[0]:
            row["aim"] = aim
        if held:
            row["bytes"] = round(held_bytes(layers, settings) / row["pixels"], 1)
        rows.append(row)
        print(f"{name:26}" + "".join(f"{ratio:12.2f}{wanted or '':>6}" for ratio, wanted in zip(row["ratio"], aim,
                                                                                             strict=True))
              + f"{least[0][name][1] * 1e3:9.1f}" + (f"{row['bytes']:8.1f}" if held else ""))
    return rows


# Tables


def off(layers, rounds):
    """Nothing is drawn: Combined alone is copied, once, and compared with just that."""
    rows = measure("all off", {"of 112 bytes": (layers, ALL_OFF, "Combined")}, 4 * rounds)
    share = BYTES * layers["combined"][..., 0].size / layers["combined"].nbytes
    print(f"{'of its 16 bytes':26}" + "".join(f"{ratio * share:12.2f}{1.0:>6}" for ratio in rows[0]["ratio"]))
    return [rows[0] | {"case": "of its 16 bytes", "ratio": [round(ratio * share, 3) for ratio in rows[0]["ratio"]],
                       "aim": (1.0, 1.0)}]


def looks(layers, rounds):
    dense = balls(*size_of(layers), CELL["with colour and light"] * size_of(layers)[1] // 1080)
    cases = {name: (dense if "colour" in name else layers, settings, "Combined")
             for name, (settings, _) in LOOKS.items()}
    return measure("looks", cases, rounds, {name: aim for name, (_, aim) in LOOKS.items()}, held=True)


def stages(layers, rounds):
    painted = layers | {"controls": np.zeros((*layers["depth"].shape, library.load().layers["controls"]), np.float32)}
    place = list(library.controls()).index("smudge_range")
    painted["controls"][:, ::8, place] = 1
    return measure("stages alone", {name: (painted if name == "smudging" else layers, *case)
                                    for name, case in STAGES.items()}, rounds)


def tones(layers, rounds):
    """Ink that grows with the darkness, over half of the picture."""
    import sticks

    things = sticks.layers_of(*sticks.posed(zoom=2.5), size_of(layers))[0]
    cases = {name: (things, ALL_OFF | settings | dict(use_tones=True), "Combined")
             for name, settings in sticks.SCREENS.items()}
    marks = [name for name, values in sticks.SCREENS.items() if values["tone_1"] in ("HATCH", "STIPPLE")]
    aims = {**dict.fromkeys(cases, (4.0, 3.0)), **dict.fromkeys(marks, (10.0, 6.0))}
    tile = np.float32(np.kron(np.random.default_rng(0).random((64, 64, 1)), np.ones((4, 4, 1))))
    cases["picture"] = things, ALL_OFF | sticks.RAMP | dict(use_tones=True) | sticks.tone(
        "IMAGE", space="SURFACE", pitch=180.0, image="tile"), "Combined"
    return measure("tones alone", cases, rounds, aims, image=lambda _: tile)


def example(layers, rounds):
    """A painting over all of the picture, of which the ball's size is that of its strokes."""
    import sticks

    things = sticks.layers_of(*sticks.posed(zoom=2.5), size_of(layers))[0]
    ball = np.float32(np.kron(np.random.default_rng(0).random((128, 128, 1)), np.ones((4, 4, 3))))
    settings = ALL_OFF | dict(use_example=True, example_ball="IMAGE", example_image="ball")
    return measure("by example", {"by example": (things, settings, "Combined")}, rounds,
                   {"by example": (40.0, 25.0)}, image=lambda _: ball)


def searches(layers, rounds):
    cases = {search.lower(): (layers, DOG | dict(line_search=search), "Combined")
             for search in ("EXACT", "NEAREST", "WALK", "DILATE")}
    return measure("searches", cases, rounds)


def radii(layers, rounds):
    cases = {f"radius {r}, {detector['edge_detector']}": (layers, detector | dict(line_thickness=2.0 * r), "Combined")
             for r in RADII for detector in (DOG, FINE)}
    return measure("radii", cases, rounds)


def densities(layers, rounds):
    cases, (width, height) = {}, size_of(layers)
    for percent in DENSITIES:
        cell = round(CELL["default sources"] * height / 1080 * 12 / percent) if percent else 0
        some = balls(width, height, cell)
        for detector in (DOG, FINE):
            cases[f"{percent} %, {detector['edge_detector']}"] = some, detector, "Combined"
    return measure("density", cases, rounds)


def sizes(layers, rounds):
    rows = []
    for name, (width, height) in SIZES.items():
        some = balls(width, height, CELL["default sources"] * height // 1080)
        cases = {f"{name}, {detector['edge_detector']}": (some, detector, "Combined") for detector in (DOG, FINE)}
        rows += measure("sizes", cases, max(1, round(rounds * 2e6 / (width * height))))
    return rows


def add(part, found):
    """Other programs' findings, {case: ...}, beside the tables in the file."""
    whole = json.loads(FILE.read_text(encoding="utf-8")) if FILE.exists() else {}
    whole[part] = whole.get(part, {}) | found
    FILE.parent.mkdir(exist_ok=True)
    FILE.write_text(json.dumps(whole, indent=1), encoding="utf-8")


def size_of(layers):
    height, width = layers["depth"].shape
    return width, height


TABLES = {"off": off, "looks": looks, "stages": stages, "tones": tones, "example": example, "searches": searches,
          "radii": radii, "densities": densities, "sizes": sizes}


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--size", default="1920x1080")
    parser.add_argument("--rounds", type=int, default=5)
    parser.add_argument("--sizes", action="store_true", help="720p to 8K too: minutes, and 12 GB of memory")
    parser.add_argument("--only", action="append", choices=TABLES, help="these tables alone")
    args = parser.parse_args()
    width, height = map(int, args.size.split("x"))
    load = os.getloadavg()[0]  # of others, who were there before
    layers = balls(width, height, CELL["default sources"] * height // 1080)
    copy = copy_seconds(width * height * BYTES)
    print(f"{width} x {height}; copy of {BYTES} bytes a pixel: {copy * 1e3:.1f} ms = 1.00")
    wanted = args.only or [name for name in TABLES if name != "sizes" or args.sizes]
    rows = [row for name in wanted for row in TABLES[name](layers, args.rounds)]
    FILE.parent.mkdir(exist_ok=True)
    found = {"size": [width, height], "load": load, "rows": rows}
    FILE.write_text(json.dumps(found, indent=1), encoding="utf-8")
    FILE.with_suffix(".svg").write_text(chart.bars(rows), encoding="utf-8")
    print(f"peak memory {resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024:.0f} MB")


if __name__ == "__main__":
    main()
