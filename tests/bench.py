# SPDX-License-Identifier: GPL-3.0-or-later
"""Times every stage at 1920 x 1080, as a ratio to copying the same bytes (112 a pixel) in the same run.

    python tests/bench.py [--size WxH] [--rounds N] [--set id=value]...

Ratios, not seconds: they mean the same on a busy machine and a quiet one. A stage's time is what passes between the
progress reports at its ends; the best of the rounds counts, for the copy as well.
"""

import argparse
import resource
import time

import drawn
import numpy as np
from encre import core

CASES = {
    "Water Memory": {},
    "Inter-color": dict(edge_threshold=0.01, edge_color=1.0, line_contrast=1.0, line_softness=0.0, line_thickness=12.0,
                        line_gain=0.5, line_intensity=2.0, line_paper=0.0, use_shading=False, use_smudging=False,
                        use_hatching=False),
    "Sobel, nearest": dict(edge_detector="SOBEL", line_search="NEAREST"),
    "wide lines": dict(line_thickness=64.0),
    "all off": dict(use_lines=False, use_shading=False, use_smudging=False, use_hatching=False),
}


def stages_run():
    """Ids of the stages that run, in order: all but the engine's own rows."""
    return [s.id for s in core.stages() if s.id != "layers"]


def once(layers, settings, threads):
    """Seconds of the whole and of each stage."""
    names = stages_run()
    ends = {(k + 1.5) / (len(names) + 1): name for k, name in enumerate(names)}
    marks, seen = {}, [0.0]

    def progress(fraction):
        seen[0] = time.perf_counter()
        for end, name in ends.items():
            if fraction < end:
                marks[name] = seen[0]
                break
        return True

    start = time.perf_counter()
    core.render(layers, settings, outputs=list(core.OUTPUTS), threads=threads, progress=progress)
    whole = time.perf_counter() - start
    times, last = {}, start
    for name in names:
        times[name] = marks.get(name, last) - last
        last = marks.get(name, last)
    return whole, times


def copy_seconds(nbytes):
    a, b = np.ones(nbytes // 4, np.float32), np.zeros(nbytes // 4, np.float32)
    best = 1e9
    for _ in range(5):
        start = time.perf_counter()
        b[:] = a
        best = min(best, time.perf_counter() - start)
    return best


def bake(rounds, side=2048):
    """Lines in a texture of spots, plain and uniform."""
    y, x = np.indices((side, side), np.float32) / side
    spot = np.hypot(x * 12 % 1 - 0.5, y * 12 % 1 - 0.5) < 0.35
    texture = np.float32([(0.9, 0.8, 0.5), (0.7, 0.2, 0.2)])[spot.astype(int)]
    copy = copy_seconds(24 * side * side)
    form = np.stack([0.2 + 2 * x, 0.3 * x, 1.5 - y], 2)
    print(f"\nbaking {side} x {side} texels; copy of {24 * side * side / 1e6:.0f} MB: {copy * 1e3:.1f} ms = 1.00")
    cases = {"plain": {}, "uniform": dict(form=form), "CIEDE2000": dict(scene=dict(contrast_metric="CIEDE2000")),
             "local contrast": dict(scene=dict(contrast_auto=True))}
    for case, options in cases.items():
        for threads in (1, 0):
            best = 1e9
            for _ in range(rounds):
                start = time.perf_counter()
                core.bake(texture, threads=threads, **options)
                best = min(best, time.perf_counter() - start)
            print(f"{case:18}{threads or 'all':>8}{best / copy:8.2f}{best:8.3f} s")


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--size", default="1920x1080")
    parser.add_argument("--rounds", type=int, default=5)
    parser.add_argument("--set", action="append", default=[])
    args = parser.parse_args()
    width, height = map(int, args.size.split("x"))
    extra = {k: core.parse(k, v) for k, v in (s.split("=", 1) for s in args.set)}
    layers = drawn.scene(width, height, noise=0.01)
    copy = copy_seconds(width * height * 112)
    print(f"copy of {width * height * 112 / 1e6:.0f} MB: {copy * 1e3:.1f} ms = 1.00")
    print(f"{'':18}{'threads':>8}{'whole':>8}" + "".join(f"{n:>8}" for n in stages_run()))
    for case, settings in CASES.items():
        for threads in (1, 0):
            runs = [once(layers, {**settings, **extra}, threads) for _ in range(args.rounds)]
            whole = min(r[0] for r in runs) / copy
            parts = [min(r[1][n] for r in runs) / copy for n in stages_run()]
            print(f"{case:18}{threads or 'all':>8}{whole:8.2f}" + "".join(f"{p:8.2f}" for p in parts))
    bake(args.rounds)
    print(f"peak memory {resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024:.0f} MB")


if __name__ == "__main__":
    main()
