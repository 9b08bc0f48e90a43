# SPDX-License-Identifier: GPL-3.0-or-later
"""The layers of the scenes by Cycles and by Encre itself: how far they are apart, and what each costs.

    python tests/helpers/layered.py FOLDER [SCENE ...]     prints a row of docs/layers.md for each scene, and writes
                                                           FOLDER/layers.jpg, Encre's on the left, Cycles' on the right
"""

import resource
import subprocess
import sys
import time
from pathlib import Path

import exr
import numpy as np
import OpenImageIO as oiio
from encre.pen.colour import encode_srgb

SCENES = Path(__file__).parents[2] / "scenes"
OPTIONS = ["--size", "480x270", "--set", "save_layers=ON", "--set", "light_source=DRAWN"]


def render(scene, out, *more):
    """(path of the file, CPU seconds, seconds)"""
    before, start = resource.getrusage(resource.RUSAGE_CHILDREN), time.monotonic()
    subprocess.run([sys.executable, "-m", "encre", "render", str(SCENES / f"{scene}.py"), "-o", str(out), *OPTIONS,
                    *more], check=True, stderr=subprocess.DEVNULL)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime, time.monotonic() - start


def agree(labels, others):
    """Share of the pixels at which two pictures show the same thing, by whatever numbers."""
    pairs = np.stack([labels.ravel(), others.ravel()], 1).astype(np.int64)
    found, counts = np.unique(pairs, axis=0, return_counts=True)
    first = {}
    for (label, other), count in sorted(zip(map(tuple, found), counts, strict=True), key=lambda x: -x[1]):
        first.setdefault(label, (other, count))
    return sum(count for _, count in first.values()) / len(pairs)


def calm(labels):
    """Where all of the 5 x 5 pixels about one show the same thing."""
    padded = np.pad(labels, 2, mode="edge")
    height, width = labels.shape
    near = np.stack([padded[y:y + height, x:x + width] for y in range(5) for x in range(5)])
    return (near == near[0]).all(0)


def compared(ours, theirs):
    """(shares of pixels that differ in index, in depth; mean and p99 of the colour's, mean of the light's difference),
    of two files."""
    def part(path, name):
        return exr.part(path, f"ViewLayer.{name}")

    index, other = (part(path, "Encre Index")[..., 0] for path in (ours, theirs))
    depth, far = (np.minimum(part(path, "Depth")[..., 0], 1e6) for path in (ours, theirs))
    still = calm(other) & calm(index)
    color = np.abs(part(ours, "DiffCol") - part(theirs, "DiffCol")).max(2)[still]
    matt = still & part(theirs, "DiffCol").any(2) & part(ours, "DiffCol").any(2)
    light = np.abs(part(ours, "Encre Diffuse") - part(theirs, "Encre Diffuse")).max(2)[matt]
    return (1 - agree(index, other), (np.abs(depth - far) > 2e-3 * far).mean(), color.mean(), np.percentile(color, 99),
            light.mean())


def pair(*paths):
    """(height, width, 3) of the pictures of two files side by side, as they are shown."""
    return np.concatenate([encode_srgb(np.clip(exr.part(path, "ViewLayer.Combined")[..., :3], 0, 1))
                           for path in paths], 1)


def main(folder, *scenes):
    folder, pairs = Path(folder), []
    for scene in scenes or sorted(p.stem for p in SCENES.glob("*.py") if "def build()" in p.read_text()):
        ours, theirs = folder / f"{scene}-encre.exr", folder / f"{scene}-cycles.exr"
        mine, _ = render(scene, ours, "--set", "layer_source=ENCRE")
        slow, _ = render(scene, theirs, "--samples", "4")
        index, depth, mean, p99, light = compared(ours, theirs)
        print(f"| {scene} | {100 * index:.3f} % | {100 * depth:.3f} % | {mean:.4f} | {p99:.3f} | {light:.4f} | "
              f"{mine:.1f} s | {slow:.1f} s |", flush=True)
        pairs.append(pair(ours, theirs))
    sheet = oiio.ImageBuf(np.ascontiguousarray(np.concatenate(pairs), np.float32))
    sheet.specmod().attribute("CompressionQuality", 82)
    sheet.write(str(folder / "layers.jpg"))


if __name__ == "__main__":
    main(*sys.argv[1:])
