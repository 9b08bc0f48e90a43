# SPDX-License-Identifier: GPL-3.0-or-later
"""Times what is no stage: FINE beside DOG, the pens, light by rays, baking, and how soon work ends that is cancelled.

    python tests/helpers/bench_costs.py [--size WxH] [--rounds N] [--side N]

In processor time on one thread where nothing else is said; jobs that are compared take turns. What is asked for goes to
build/bench.json, beside the tables of bench.py.
"""

import argparse
import contextlib
import sys
import time
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[1]))  # of what the lamps are held to
import bench
import hands
import lamps
import numpy as np
from bench import ALL_OFF, BYTES, CELL, DOG, FINE, SOURCES, THREADS, balls, copy_seconds, held_bytes, sites
from encre.pen import background, library
from encre.pen.errors import Cancelled

PLAIN = ALL_OFF | FINE | dict(use_lines=True)
# case: what a hand or a tool changes of plain lines
PENS = {
    "pressure and wobble": dict(pen_1_pressure=0.45, pen_1_wobble=0.9),
    "wider in bends": dict(pen_1_curve=0.3),
    "second ink in the dark": dict(ink_on_dark=1.0),
    "frayed": dict(pen_1_rough=0.45),
    "dashes": dict(pen_1_dash=40.0),
    "gaps": dict(pen_1_gaps=0.2),
    "dry bristles": dict(pen_1_dry=0.8),
    "strip": dict(pen_1_strip=1.0, pen_1_strip_image="chalk"),
    "tapered, with overshoot": dict(pen_1_taper=40.0, pen_1_overshoot=12.0),
    "brush: all but dashes": dict(pen_1_pressure=0.45, pen_1_wobble=0.9, pen_1_rough=0.45, pen_1_taper=40.0,
                                  pen_1_pool=0.5),
}
STRIP = 1 - hands.chalk()
PEN_ASKED = 0.3  # microseconds a site beside plain lines
ENOUGH = 20  # seconds after which no other round begins of what takes long


def turns(rounds, jobs):
    """Least processor seconds of each job (layers, settings) on one thread; they take turns under the same load."""
    best = [1e9] * len(jobs)
    for _ in range(rounds):
        for k, (layers, settings) in enumerate(jobs):
            start = time.process_time()
            library.render(layers, settings, threads=1, image=lambda _: STRIP)
            best[k] = min(best[k], time.process_time() - start)
    return best


def fine(rounds, width, height):
    print(f"\nFINE beside DOG, one thread, all stages, {width} x {height}")
    print(f"{'':24}{'near':>7}{'FINE':>7}{'DOG':>7}{'ratio':>7}{'no edges':>10}{'1000 sites':>12}{'quarter':>9}"
          f"{'bytes':>7}")
    copy = copy_seconds(width * height * BYTES)
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


def pens(rounds, width, height):
    """What pens cost beside plain lines: {case: (measured, asked)}."""
    layers = balls(width, height, CELL["default sources"] * height // 1080)
    plain, *times = turns(rounds, [(layers, PLAIN), *((layers, PLAIN | changed) for changed in PENS.values())])
    count = sites(layers, PLAIN)[0]
    print(f"\npens, one thread, {width} x {height}, {count} sites; plain lines {plain * 1e3:.1f} ms")
    found = {}
    for case, seconds in zip(PENS, times, strict=True):
        cost = (seconds - plain) / count * 1e6
        found[f"pen, {case}"] = f"{cost:.2f} µs a site", f"at most {PEN_ASKED}"
        print(f"{case:26}{cost:8.3f} µs a site (aim {PEN_ASKED}){seconds * 1e3:9.1f} ms")
    return found


def many(width, height):
    """A cube, a ball and 64 balls of 3,200 triangles each."""
    stage = lamps.Stage(width, height, smooth=True)
    points, corners, normals = lamps.ball(40)
    stage.scene.geometry(9, points, corners, normals)
    for k in range(64):
        model = lamps.moved(k % 8 - 4.0, k // 8 - 3.0, 2.5, 0.25)
        stage.scene.instance(9 + k, 9, model)
        stage.meshes.append(lamps.Mesh(points, corners, model=model, object_index=9 + k))
    return stage


def light(rounds, width, height):
    """Three lamps; trees are built in the first round. What takes long is timed once."""
    stage = many(width, height)
    depth, copy = stage.depth(), copy_seconds(width * height * BYTES)
    print(f"\nlight by rays, one thread, {width} x {height}; processor seconds, and as a ratio to the copy")
    cases = {"hard lamps": ("sun", "point", "spot"), "soft lamps": ("wide sun", "ball", "rectangle")}
    for case, names in cases.items():
        best, begun = 1e9, time.process_time()
        for k in range(rounds):
            if k and time.process_time() - begun > ENOUGH:
                break
            start = time.process_time()
            stage.light(*(lamps.LAMPS[name] for name in names), depth=depth, threads=1)
            best = min(best, time.process_time() - start)
        print(f"{case:18}{best:8.2f} s{best / copy:8.1f}")


def bake(rounds, side):
    """Lines in a texture of spots, plain and uniform."""
    y, x = np.indices((side, side), np.float32) / side
    spot = np.hypot(x * 12 % 1 - 0.5, y * 12 % 1 - 0.5) < 0.35
    texture = np.float32([(0.9, 0.8, 0.5), (0.7, 0.2, 0.2)])[spot.astype(int)]
    copy = copy_seconds(24 * side * side)
    form = np.stack([0.2 + 2 * x, 0.3 * x, 1.5 - y], 2)
    print(f"\nbaking {side} x {side} texels; copy of {24 * side * side / 1e6:.0f} MB: {copy * 1e3:.1f} ms = 1.00")
    cases = {"plain": {}, "uniform": dict(form=form), "CIEDE2000": dict(scene=dict(contrast_metric="CIEDE2000")),
             "local contrast": dict(scene=dict(contrast_local=True))}
    for case, options in cases.items():
        for threads in (1, 0):
            best = 1e9
            for _ in range(rounds):
                start = time.perf_counter()
                library.bake(texture, threads=threads, **options)
                best = min(best, time.perf_counter() - start)
            print(f"{case:18}{threads or 'all':>8}{best / copy:8.2f}{best:8.3f} s")


def works(width, height):
    """{case: Work}"""
    layers = balls(width, height, CELL["default sources"] * height // 1080)
    lib, stage = library.load(), many(width, height)
    seen = stage.view, stage.projection, lamps.Frame(width, height)
    made = {"rasteriser": lib.raster_work(stage.meshes, *seen, (width, height), 0.1)}
    for name, settings in {"DOG": DOG, "FINE": FINE}.items():
        made[name] = lib.draw_work(layers, lib.complete(lib.check(settings)))
    for name in "sun", "wide sun":
        own = many(width, height)
        own.scene.lamp(0, lamps.LAMPS[name])
        made[name] = own.scene.light_work(own.depth(), None, *seen, 0.1)
    return made


def cancelled(width, height):
    """Work in the background that is cancelled at 40 moments: what all threads still do until it has ended."""
    print(f"\ncancelled after the fact, {width} x {height}; processor milliseconds until the end")
    print(f"{'':18}{'threads':>8}{'median':>9}{'9 of 10':>9}")
    for case, work in works(width, height).items():
        for threads in THREADS:
            behind, spent = background.Background(threads), []
            behind.start([work])
            start = time.perf_counter()
            behind.wait()
            whole = time.perf_counter() - start
            for k in range(40):
                behind.start([work])
                time.sleep(whole * 0.9 * k / 40)
                start = time.process_time()
                behind.cancel()
                with contextlib.suppress(Cancelled):
                    behind.wait()
                spent.append(1e3 * (time.process_time() - start))
            print(f"{case:18}{threads:8}{np.median(spent):9.2f}{np.quantile(spent, 0.9):9.2f}")


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--size", default="1920x1080")
    parser.add_argument("--rounds", type=int, default=5)
    parser.add_argument("--side", type=int, default=2048, help="texels of the texture that is baked")
    args = parser.parse_args()
    width, height = map(int, args.size.split("x"))
    fine(args.rounds, width, height)
    bench.add("costs", pens(args.rounds, width, height))
    light(args.rounds, width, height)
    bake(args.rounds, args.side)
    cancelled(width, height)


if __name__ == "__main__":
    main()
