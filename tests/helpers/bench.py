# SPDX-License-Identifier: GPL-3.0-or-later
"""Times every stage at 1920 x 1080, as a ratio to copying the same bytes (112 a pixel) in the same run.

    python tests/helpers/bench.py [--size WxH] [--rounds N] [--set id=value]...

Then the lines of FINE beside those of DOG, on one thread, where 12 % of the pixels lie within 3 of a site: at most 1.3
times as long for all stages together, 1.5 times with colour and light; 12 bytes a pixel besides input and output.

Ratios, not seconds: they mean the same on a busy machine and a quiet one. A stage's time is what passes between the
progress reports at its ends; the best of the rounds counts, for the copy as well.
"""

import argparse
import ctypes
import resource
import sys
import time
from pathlib import Path

import drawn
import numpy as np
from encre.pen import library

CASES = {
    "Water Memory": {},
    "Inter-color": dict(edge_threshold=0.01, edge_color=1.0, line_contrast=1.0, line_softness=0.0, line_thickness=12.0,
                        line_gain=0.5, line_intensity=2.0, line_paper=0.0, use_shading=False, use_smudging=False,
                        use_hatching=False),
    "Sobel, nearest": dict(edge_detector="SOBEL", line_search="NEAREST"),
    "wide lines": dict(line_thickness=64.0),
}
ALL_OFF = dict(use_lines=False, use_shading=False, use_smudging=False, use_hatching=False)


def stages_run():
    """Ids of the stages that run, in order: all but the engine's own rows."""
    return [s.id for s in library.stages() if s.id != "layers"]


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
    library.render(layers, settings, outputs=list(library.OUTPUTS), threads=threads, progress=progress)
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
                library.bake(texture, threads=threads, **options)
                best = min(best, time.perf_counter() - start)
            print(f"{case:18}{threads or 'all':>8}{best / copy:8.2f}{best:8.3f} s")


def all_off(rounds, layers):
    """With every switch off, Combined alone: it is copied once."""
    copy = copy_seconds(layers["combined"].nbytes)
    print(f"\nall off; copy of {layers['combined'].nbytes / 1e6:.0f} MB: {copy * 1e3:.1f} ms = 1.00")
    for threads in (1, 0):
        best = 1e9
        for _ in range(4 * rounds):
            start = time.perf_counter()
            library.render(layers, ALL_OFF, threads=threads)
            best = min(best, time.perf_counter() - start)
        print(f"{'all off':18}{threads or 'all':>8}{best / copy:8.2f}")


# What FINE costs

SOURCES = {"default sources": {}, "with colour and light": dict(edge_color=3.0, edge_light=4.0)}
CELL = {"default sources": 204, "with colour and light": 298}  # pixels from ball to ball: 12 % are near a site


def balls(width, height, cell):
    """Layers of balls in two colours, `cell` pixels apart, before a wall with bends; 0: a flat wall and no balls.

    Depth and index are those of the pixel centres, all else is the mean of four samples a pixel."""
    def look(dx, dy):
        x, y = np.meshgrid(np.arange(width) + dx, np.arange(height) + dy)
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


def turns(rounds, jobs):
    """Least processor seconds of each job (layers, settings) on one thread; they take turns under the same load."""
    best = [1e9] * len(jobs)
    for _ in range(rounds):
        for k, (layers, settings) in enumerate(jobs):
            start = time.process_time()
            library.render(layers, settings, threads=1)
            best[k] = min(best[k], time.process_time() - start)
    return best


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

    seen, before = [0], held()
    library.render(layers, settings, threads=1, progress=lambda _: seen.append(held()) or True)
    return max(seen) - before - layers["combined"].nbytes


def fine(rounds, width, height):
    print(f"\nFINE beside DOG, one thread, all stages, {width} x {height}")
    print(f"{'':24}{'near':>7}{'FINE':>7}{'DOG':>7}{'ratio':>7}{'no edges':>10}{'1000 sites':>12}{'quarter':>9}"
          f"{'bytes':>7}")
    copy = copy_seconds(width * height * 112)
    empty = balls(width, height, 0)
    for name, settings in SOURCES.items():
        full, quarter = balls(width, height, CELL[name]), balls(width // 2, height // 2, CELL[name])
        dog = settings | dict(edge_detector="DOG")
        own, other, least, small = turns(rounds, [(full, settings), (full, dog), (empty, settings),
                                                  (quarter, settings)])
        count, near = sites(full, settings)
        held = held_bytes(full, settings) / (width * height)
        print(f"{name:24}{near:7.1%}{own / copy:7.2f}{other / copy:7.2f}{own / other:7.2f}{least / copy:10.2f}"
              f"{(own - least) / copy / count * 1000:12.4f}{4 * small / own:9.2f}{held:7.1f}")


def light(rounds, width, height):
    """Three lamps over a cube, a ball and 64 balls of 3,200 triangles each; trees are built in the first round."""
    sys.path.insert(0, str(Path(__file__).parents[1]))
    import lamps  # knows the reference

    stage = lamps.Stage(width, height, smooth=True)
    points, corners, normals = lamps.ball(40)
    stage.scene.geometry(9, points, corners, normals)
    for k in range(64):
        model = lamps.moved(k % 8 - 4.0, k // 8 - 3.0, 2.5, 0.25)
        stage.scene.instance(9 + k, 9, model)
        stage.meshes.append(lamps.Mesh(points, corners, model=model, object_index=9 + k))
    depth, copy = stage.depth(), copy_seconds(width * height * 112)
    print(f"\nlight by rays, one thread, {width} x {height}; processor seconds, and as a ratio to the copy")
    cases = {"hard lamps": ("sun", "point", "spot"), "soft lamps": ("wide sun", "ball", "rectangle")}
    for case, names in cases.items():
        best = 1e9
        for _ in range(rounds):
            start = time.process_time()
            stage.light(*(lamps.LAMPS[name] for name in names), depth=depth, threads=1)
            best = min(best, time.process_time() - start)
        print(f"{case:18}{best:8.2f} s{best / copy:8.1f}")


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--size", default="1920x1080")
    parser.add_argument("--rounds", type=int, default=5)
    parser.add_argument("--set", action="append", default=[])
    args = parser.parse_args()
    width, height = map(int, args.size.split("x"))
    extra = {k: library.parse(k, v) for k, v in (s.split("=", 1) for s in args.set)}
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
    all_off(args.rounds, layers)
    fine(args.rounds, width, height)
    light(args.rounds, width, height)
    bake(args.rounds)
    print(f"peak memory {resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024:.0f} MB")


if __name__ == "__main__":
    main()
