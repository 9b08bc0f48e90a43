# SPDX-License-Identifier: GPL-3.0-or-later
"""The same picture by Encre and by libraries for pictures, side by side: writes docs/speed.md.

    python tests/helpers/bench_peers.py [--size WxH] [--rounds N] [--only-print]

Edges by differences of Gaussians of 1/z and of normals, and between objects; soft ink 8 pixels wide along them; light
in three flat levels, tinted and less saturated in the shade. Each library does it as who knows it would write it, on
one thread. Whatever can't be imported is said and left out; `make bench-peers` installs all. build/bench.json, which
`make bench` and bench_blender.py wrote, gives the page its other tables.
"""

import argparse
import importlib
import json
import platform
import time
from pathlib import Path

import bench
import chart
import numpy as np
from encre.pen import library

ROOT = Path(__file__).parents[2]
RADIUS, FADE, GAIN, BIAS = 4.0, 3.6, 4.0, 0.5  # Encre's own line at neutral controls
LEVELS = 0.5, (0.7, 0.5, 0.025), (1.1, 0.9, 0.025)
TINT, SATURATION = (0.60, 0.55, 0.90), 0.6
ENCRE = dict(edge_detector="DOG", length_unit="PIXELS", pen_1_grain=0.0, line_occlude=False, use_hatching=False,
             use_smudging=False, **{f"line_{kind}_width": 1.0 for kind in ("outline", "inner", "crease")})
AIMS = {"numpy and scipy": 40, "OpenCV": 30}
READ = "combined", "color", "diffuse", "depth", "normal", "object"  # what the picture is made of

PAGE = """# How fast it is

`make bench` and `make bench-peers` measure this and write the page. A ratio of 1 is the time in which this machine
copies 112 bytes a pixel, about as much as all layers hold: what has to be read takes that order of time whoever does
it. Most of what is done here is arithmetic, so a ratio tells as much of a machine's memory as of the library: two
virtual machines of one name gave 3.0 and 4.4 for *Water Memory, DOG*, with copies of 18.5 and 15.1 ms. Compare
ratios of one run.

This page: {machine}, {size}, where 12 % of the pixels lie near a line.

{tables}

![The same as bars](speed.svg)

## On many threads

Milliseconds by the clock at 1920 × 1080 on 16 cores of an Intel Xeon (a virtual machine, once, the least of several
runs), which is another machine than that of the tables above; behind them, how much faster 16 threads are than one.

| | 1 | 2 | 4 | 8 | 16 | 16 to 1 |
|---|---|---|---|---|---|---|
| the copy, by numpy | 18.9 | 17.3 | 10.2 | 6.4 | 5.4 | 3.5 |
| all off | 3.3 | 1.7 | 0.9 | 0.6 | 0.4 | 8.2 |
| Water Memory, DOG | 61.7 | 32.8 | 17.9 | 10.5 | 7.2 | 8.6 |
| Water Memory, FINE | 96.8 | 53.3 | 33.1 | 21.3 | 15.0 | 6.5 |
| colour and light, DOG | 117 | 62.4 | 26.2 | 14.3 | 9.1 | 12.8 |
| colour and light, FINE | 167 | 92.8 | 47.7 | 33.8 | 23.7 | 7.1 |
| Inter-color, FINE | 124 | 76.5 | 44.2 | 25.5 | 18.8 | 6.6 |
| Inter-color, SOBEL | 68.6 | 40.4 | 19.3 | 11.2 | 7.4 | 9.3 |
| dots | 90.3 | 56.0 | 27.8 | 17.5 | 11.3 | 8.0 |
| hatching | 240 | 164 | 74.7 | 47.7 | 27.5 | 8.7 |
| strokes toward the light | 239 | 147 | 86.6 | 47.8 | 27.0 | 8.9 |
| stipple | 201 | 103 | 60.0 | 33.1 | 18.8 | 10.7 |
| light of three hard lamps, 205,000 triangles | 1450 | 890 | 387 | 203 | 115 | 12.6 |

What stops it: with FINE, 5 to 8 ms between the passes are one thread's, a quarter to a third of a frame on 16, above
all before ends are aimed at, before passes that look for what is near, and before pens are made; dots begin with 3.7 ms
of one thread's. Strokes are drawn in bands of at least 64 rows, which are 17 at this size, so that 16 threads take two
rounds, and what reaches into two bands is traced twice: 13 ms of 28. The rest is work that takes 16 cores up to 1.65
times the processor time that it takes one. Random jobs drew the same bytes there (`tests/helpers/hashes.txt`).

## What is out of reach

On two threads DOG and SOBEL come near what was aimed at, or reach it; on one, all looks miss it. By FINE an aim of 2.5
is 46 ms: to read the layers for the first time takes 24, what passes over every pixel 14, and 8 are left for finding,
joining and drawing lines, which take 48, in some 45 functions of about a millisecond. With its layers in the caches a
frame takes about as long a pixel: that part is arithmetic, not memory. What was tried: to pass over calm blocks takes
.86 of the time where there is no line and 1.05 where there are as many as here; to ink eight pixels at once, three
times as long. With AVX-512 DOG takes .94, for which no third build is made. With all off the library itself takes 1.03.
Dots and strokes miss what was aimed at by a quarter where copies take 18.5 ms, and where they take 15.1 by four fifths
and more (7.2 and 19), without a function that takes more than 13 % of it.

## What lines cost since they know the meshes

Of the cost that FINE had before it drew edges as meshes tell them it has .75 to .82 now, with colour and light .66 to
.88, *Inter-color* .78 to .93: the same layers on one thread, in turns, three times.
Light by three hard lamps, 205,000 triangles, 1080p, is drawn in 1/34.7 of the time of Cycles at 16 samples (aim
1/25), by soft ones in 1/7.4 (aim 1/3). Lines of the shapes alone cost 3.2 processor seconds of a 1080p street, about
what Line Art costs (3.6) and half more than Freestyle (2.2); lines of what mirrors show cost it 1.4 more, and
cleaning that of noise, by Open Image Denoise, as much as 14 where puddles and panes are far apart: two thirds of that
since each is cleaned by itself.

## Beside libraries for pictures

The same picture from the same layers: edges by differences of Gaussians of 1/z and of normals, and between objects;
soft ink 8 pixels wide along them; light in three flat levels, tinted in the shade. Everyone on one thread, in processor
seconds, the least of {rounds} rounds in turns. *Apart*: the share of pixels in which the picture differs from Encre's
by more than 0.1 in a channel; a library without distances of pixels draws its ink with a disc and a blur instead.

| | seconds | Encre is so much faster | apart |
|---|---|---|---|
{rows}

The aims for numpy and OpenCV are below what any program needs: to copy the {bytes} bytes a pixel that the picture is
made of takes {copy:.4f} s here, more than a fortieth of the time of the one or a thirtieth of that of the other.
"""
COSTS = """
## Beside the stages

Processor time on one thread; drawn light is that of all threads.

| | measured | asked |
|---|---|---|
{rows}

Of what a cancel takes, .18 to .24 ms is ending the thread and raising in Python.
"""
BLENDER = """
## Beside what Blender has

`scenes/{scene}.py`, {size}, rendered by Cycles at one sample without a denoiser, with lines of the shapes by each. *Own
part*: what that takes longer than Cycles alone, in processor seconds of all threads, the least of the rounds in turns.
Line Art's part is finding its strokes and drawing them as tubes, for Blender draws Grease Pencil with a graphics card
only. The compositor's is Sobel's filter over 1/z, normals and numbers of objects, a threshold, and lines grown and
blurred; those lines are as jagged as its passes.

| | seconds | own part | of that of FINE |
|---|---|---|---|
{rows}
"""


# numpy, and what scipy and scikit-image put on top


def tone_of(light):
    tone = np.full_like(light, LEVELS[0])
    for intensity, threshold, transition in LEVELS[1:]:
        tone += (intensity - tone) * np.clip((light - threshold) / transition + 0.5, 0, 1)
    return tone


def shaded(layers):
    """Flat light over the surface, and all that was not diffuse light on top."""
    color, diffuse, combined = layers["color"], layers["diffuse"], layers["combined"][..., :3]
    value = diffuse.max(-1)
    tone = tone_of(value)
    hue = 1 + (diffuse - value[..., None]) / np.maximum(value, 0.02)[..., None]
    shade = np.maximum(1 - tone, 0)
    share = (shade / (1 + shade))[..., None]
    light = hue * tone[..., None] * (1 - share) + np.float32(TINT) * share
    bright = color.max(-1)[..., None]
    flat = (bright - (bright - color) * (1 - shade * (1 - SATURATION))[..., None]) * light
    return np.maximum(flat + combined - color * diffuse, 0)


def edges_of(layers, dog, most):
    """dog(plane), most(plane): the largest of the 5x5 about each pixel."""
    near = 1 / layers["depth"]
    bend = np.maximum.reduce([dog(layers["normal"][..., c]) for c in range(3)])
    strength = np.maximum(60 * dog(near) / most(near), 50 * (5 * np.maximum(bend, 0)) ** 1.5)
    number = layers["object"]
    changed = (most(number) != number) | (-most(-number) != number)
    return (strength >= 0.5) | changed


def covered(distance):
    return np.clip(GAIN * (np.minimum((RADIUS - distance) / FADE, 1) - BIAS), 0, 1)


def scipy_picture(layers, ndimage):
    def dog(plane):
        return (ndimage.gaussian_filter(plane, 1.0, truncate=2.0)
                - ndimage.gaussian_filter(plane, 1.6, truncate=1.25))

    edges = edges_of(layers, dog, lambda plane: ndimage.maximum_filter(plane, 3))
    dark = covered(ndimage.distance_transform_edt(~edges).astype(np.float32))
    return shaded(layers) * (1 - dark)[..., None]


def skimage_picture(layers, filters, morphology):
    edges = edges_of(layers, lambda plane: filters.difference_of_gaussians(plane, 1.0, 1.6),
                     lambda plane: morphology.dilation(plane, np.ones((3, 3), np.uint8)))
    dark = filters.gaussian(morphology.dilation(edges, morphology.disk(2)).astype(np.float32), 1.0)
    return shaded(layers) * (1 - dark)[..., None]


# OpenCV


def cv_picture(layers, cv2):
    def dog(image):
        return cv2.subtract(cv2.GaussianBlur(image, (5, 5), 1.0), cv2.GaussianBlur(image, (5, 5), 1.6))

    box = np.ones((3, 3), np.uint8)
    near, number = cv2.divide(1.0, layers["depth"]), layers["object"]
    strength = cv2.divide(dog(near), cv2.dilate(near, box), scale=60)
    red, green, blue = cv2.split(dog(layers["normal"]))
    bend = cv2.pow(cv2.multiply(cv2.max(cv2.max(cv2.max(red, green), blue), 0.0), 5.0), 1.5)
    strength = cv2.max(strength, cv2.multiply(bend, 50.0))
    clear = cv2.bitwise_not(cv2.bitwise_or(cv2.compare(strength, 0.5, cv2.CMP_GE),
                                           cv2.compare(cv2.dilate(number, box), cv2.erode(number, box), cv2.CMP_NE)))
    distance = cv2.distanceTransform(clear, cv2.DIST_L2, cv2.DIST_MASK_PRECISE)
    cover = cv2.min(cv2.addWeighted(distance, -1 / FADE, distance, 0, RADIUS / FADE), 1.0)
    paper = cv2.subtract(1.0, cv2.min(cv2.max(cv2.addWeighted(cover, GAIN, cover, 0, -GAIN * BIAS), 0.0), 1.0))

    planes, colors = cv2.split(layers["diffuse"]), cv2.split(layers["color"])
    rendered = cv2.split(layers["combined"])
    value = cv2.max(cv2.max(planes[0], planes[1]), planes[2])
    bright = cv2.max(cv2.max(colors[0], colors[1]), colors[2])
    tone = np.full_like(value, LEVELS[0])
    for intensity, threshold, transition in LEVELS[1:]:
        passed = cv2.addWeighted(value, 1 / transition, value, 0, 0.5 - threshold / transition)
        passed = cv2.min(cv2.max(passed, 0.0), 1.0)
        tone = cv2.add(tone, cv2.multiply(cv2.subtract(intensity, tone), passed))
    shade = cv2.max(cv2.subtract(1.0, tone), 0.0)
    share = cv2.divide(shade, cv2.add(shade, 1.0))
    kept = cv2.subtract(1.0, cv2.multiply(shade, 1 - SATURATION))
    floor, rest, out = cv2.max(value, 0.02), cv2.multiply(tone, cv2.subtract(1.0, share)), []
    for plane, color, own, tint in zip(planes, colors, rendered[:3], TINT, strict=True):
        hue = cv2.add(cv2.divide(cv2.subtract(plane, value), floor), 1.0)
        light = cv2.add(cv2.multiply(hue, rest), cv2.multiply(share, tint))
        flat = cv2.multiply(cv2.subtract(bright, cv2.multiply(cv2.subtract(bright, color), kept)), light)
        drawn = cv2.add(flat, cv2.subtract(own, cv2.multiply(color, plane)))
        out.append(cv2.multiply(cv2.max(drawn, 0.0), paper))
    return cv2.merge(out)


# OpenImageIO


def oiio_picture(layers, oiio):
    algo = oiio.ImageBufAlgo

    def buf(a):
        return oiio.ImageBuf(np.ascontiguousarray(a))

    def minus(number, image):
        return algo.add(algo.mul(image, -1.0), number)

    def largest(image):
        return algo.maxchan(image)

    def every(image):
        return algo.channels(image, (0, 0, 0))

    narrow, wide = (algo.make_kernel("gaussian", 4 * sigma, 4 * sigma) for sigma in (1.0, 1.6))

    def dog(image):
        return algo.sub(algo.convolve(image, narrow), algo.convolve(image, wide))

    near, number = algo.div(buf(np.ones_like(layers["depth"])), buf(layers["depth"])), buf(layers["object"])
    strength = algo.mul(algo.div(dog(near), algo.dilate(near, 3, 3)), 60.0)
    bend = algo.pow(algo.mul(algo.max(largest(dog(buf(layers["normal"]))), 0.0), 5.0), 1.5)
    strength = algo.max(strength, algo.mul(bend, 50.0))
    changed = algo.clamp(algo.sub(algo.dilate(number, 3, 3), algo.erode(number, 3, 3)), 0.0, 1.0)
    edges = algo.max(algo.clamp(algo.mul(algo.sub(strength, 0.5), 1e6), 0.0, 1.0), changed)
    dark = algo.convolve(algo.dilate(edges, 5, 5), narrow)

    diffuse, color = buf(layers["diffuse"]), buf(layers["color"])
    combined = algo.channels(buf(layers["combined"]), (0, 1, 2))
    value, bright = largest(diffuse), every(largest(color))
    tone = algo.add(algo.mul(value, 0.0), LEVELS[0])
    for intensity, threshold, transition in LEVELS[1:]:
        passed = algo.clamp(algo.add(algo.mul(value, 1 / transition), 0.5 - threshold / transition), 0.0, 1.0)
        tone = algo.add(tone, algo.mul(minus(intensity, tone), passed))
    shade = algo.max(minus(1.0, tone), 0.0)
    share = algo.div(shade, algo.add(shade, 1.0))
    kept = every(minus(1.0, algo.mul(shade, 1 - SATURATION)))
    hue = algo.add(algo.div(algo.sub(diffuse, every(value)), every(algo.max(value, 0.02))), 1.0)
    light = algo.add(algo.mul(hue, every(algo.mul(tone, minus(1.0, share)))), algo.mul(every(share), TINT))
    flat = algo.mul(algo.sub(bright, algo.mul(algo.sub(bright, color), kept)), light)
    drawn = algo.max(algo.add(flat, algo.sub(combined, algo.mul(color, diffuse))), 0.0)
    return algo.mul(drawn, every(minus(1.0, dark))).get_pixels(oiio.FLOAT)


# The page


def peers():
    """(name and version, picture from layers) of all that can be imported; names what can't."""
    def module(name):
        try:
            return importlib.import_module(name)
        except ImportError as e:
            print(f"{name}: missing, left out ({e})")
            return None

    ndimage, cv2, oiio = module("scipy.ndimage"), module("cv2"), module("OpenImageIO")
    filters, morphology = module("skimage.filters"), module("skimage.morphology")
    if ndimage:
        version = importlib.import_module("scipy").__version__
        yield "numpy and scipy", version, lambda layers: scipy_picture(layers, ndimage)
    if cv2:
        cv2.setNumThreads(1)
        yield "OpenCV", cv2.__version__, lambda layers: cv_picture(layers, cv2)
    if filters and morphology:
        version = importlib.import_module("skimage").__version__
        yield "scikit-image", version, lambda layers: skimage_picture(layers, filters, morphology)
    if oiio:
        oiio.attribute("threads", 1)
        yield "OpenImageIO", oiio.VERSION_STRING, lambda layers: oiio_picture(layers, oiio)


def processor():
    """The name of this machine's processor, as Linux knows it."""
    info = Path("/proc/cpuinfo")
    lines = info.read_text().splitlines() if info.exists() else []
    names = [line.partition(":")[2].strip() for line in lines if line.startswith("model name")]
    return f"{names[0]}, {len(names)} cores" if names else platform.processor()


def tables(found):
    """Markdown of what `make bench` measured."""
    text, table = [], None
    if found["load"] > 1.5:
        text.append(f"The machine was busy while it ran, with a load of {found['load']:.0f}. Processor time, in which "
                    "one thread is measured,\nbears that but for what others take of the caches; time by the clock, in "
                    "which two are, is too long.")
    for row in found["rows"]:
        if row["table"] != table:
            table = row["table"]
            text.append(f"\n| {table} | one thread | two threads | aim | bytes a pixel besides input and output |\n"
                        "|---|---|---|---|---|")
        aim = " / ".join(f"{a:g}" for a in row["aim"]) if "aim" in row else ""
        one, two = row["ratio"]
        text.append(f"| {row['case']} | {one:.2f} | {two:.2f} | {aim} | {row.get('bytes', '')} |")
    return "\n".join(text).strip()


def beside(found):
    """Markdown of what other programs put into the file."""
    text = ""
    if costs := found.get("costs"):
        text += COSTS.format(rows="\n".join(f"| {case} | {got} | {asked} |" for case, (got, asked) in costs.items()))
    if blender := found.get("blender"):
        rows = [f"| {name} | {taken:.2f} | " + (f"{own:.2f} | {share:.2f} times |" if own else " | |")
                for name, (taken, own, share) in blender["rows"].items()]
        text += BLENDER.format(scene=blender["scene"], size=blender["size"].replace("x", " x "), rows="\n".join(rows))
    return text


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--size", default="1920x1080")
    parser.add_argument("--rounds", type=int, default=5)
    parser.add_argument("--only-print", action="store_true")
    args = parser.parse_args()
    measured = ROOT / "build" / "bench.json"
    if not (args.only_print or measured.exists()):
        parser.error(f"{measured} has the page's other tables and is missing; run make bench first, or --only-print")
    width, height = map(int, args.size.split("x"))
    layers = bench.balls(width, height, bench.CELL["default sources"] * height // 1080)
    every = library.complete(library.check(ENCRE))
    memory = np.zeros((height, width, 4), np.float32)
    known = [("Encre", "", lambda layers: library.draw(layers, every, threads=1, empty=lambda _: memory).images[
        "Combined"][..., :3]), *peers()]
    best, pictures = {}, {}
    for _ in range(args.rounds):
        for name, _version, picture in known:
            start = time.process_time()
            pictures[name] = picture(layers)
            best[name] = min(best.get(name, 1e9), time.process_time() - start)
    rows = []
    for name, version, _ in known:
        far = (np.abs(pictures[name] - pictures["Encre"]).max(-1) > 0.1).mean()
        aim = f" (aim {AIMS[name]})" if name in AIMS else ""
        times = f"{best[name] / best['Encre']:.1f} times{aim}" if version else ""
        rows.append(f"| {f'{name} {version}'.strip()} | {best[name]:.3f} | {times} | {far:.2%} |")
        print(rows[-1])
    if not args.only_print:
        found = json.loads(measured.read_text(encoding="utf-8"))
        read = 4 * sum(library.LAYERS[name] for name in READ)
        page = PAGE.format(machine=processor(), size=f"{width} x {height}", tables=tables(found), rounds=args.rounds,
                           rows="\n".join(rows), bytes=read, copy=bench.copy_seconds(width * height * read))
        page += beside(found)
        (ROOT / "docs" / "speed.svg").write_text(chart.bars(found["rows"]), encoding="utf-8")
        (ROOT / "docs" / "speed.md").write_text(page, encoding="utf-8")


if __name__ == "__main__":
    main()
