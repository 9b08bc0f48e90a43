# SPDX-License-Identifier: GPL-3.0-or-later
"""Pictures that a failed test compared, left in build/failed for somebody to look at."""

import re
import shutil
from pathlib import Path

import numpy as np

ROOT = Path(__file__).resolve().parents[2]
FOLDER = ROOT / "build" / "failed"
MOST, SIDE = 8, 8  # pictures of a test; pixels from which on an array is one


def pictures(names):
    """{name: (H, W) or (H, W, C)} of what looks like a picture in {name: value}, also inside dictionaries."""
    found = {}
    for name, value in names.items():
        inner = {f"{name} {key}": each for key, each in value.items()} if isinstance(value, dict) else {name: value}
        for each, array in inner.items():
            if (isinstance(array, np.ndarray) and array.dtype.kind in "fb" and array.ndim in (2, 3)
                    and min(array.shape[:2]) >= SIDE and (array.ndim == 2 or array.shape[2] in (1, 3, 4))):
                found[each] = array
    return found


def pairs(found):
    """The first two pictures of a shape, but for those of two dictionaries: these go by their keys."""
    ends, left = {}, []
    for name, picture in found.items():
        ends.setdefault((name.partition(" ")[2], picture.shape), []).append(name)
    for (_, _), names in ends.items():
        left += [tuple(names[:2])] if len(names) > 1 else []
    return left


def leave(test, names):
    """Writes the pictures among the variables {name: value} of a test, and how each two that are alike differ. What is
    to be said of it, or ""."""
    found = pictures(names)
    two = pairs(found)
    found = {name: found[name] for name in [*dict.fromkeys(sum(two, ())), *found]}
    folder = FOLDER / re.sub(r"[^\w.-]+", "-", test)[-120:]
    shutil.rmtree(folder, ignore_errors=True)
    if not found:
        return ""
    folder.mkdir(parents=True)
    said = [f"pictures: {folder.relative_to(FOLDER.parents[1])}"]
    for name in [*found][:MOST]:
        _write(folder / f"{name}.png", found[name])
    for one, other in two[:MOST // 2]:
        off = np.abs(np.nan_to_num(found[one].astype(float)) - np.nan_to_num(found[other].astype(float)))
        off = off.max(-1) if off.ndim == 3 else off
        row, column = np.unravel_index(off.argmax(), off.shape)
        _write(folder / f"{one} - {other}.png", off / (off.max() or 1))
        said.append(f"{one} and {other} differ in {(off > 0).sum()} of {off.size} pixels, at most by {off.max():.3g}, "
                    f"in row {row}, column {column}")
    return "\n".join(said)


def _write(path, picture):
    import OpenImageIO as oiio

    picture = np.nan_to_num(np.atleast_3d(picture).astype(np.float32), posinf=1, neginf=0)
    if picture.shape[2] == 4:  # over white paper
        picture = picture[..., :3] + 1 - picture[..., 3:]
    if picture.min() < 0:  # directions, say
        picture = picture / np.abs(picture).max() / 2 + 0.5
    elif picture.max() > 1:
        picture = picture / picture.max()
    spec = oiio.ImageSpec(picture.shape[1], picture.shape[0], picture.shape[2], "uint8")
    out = oiio.ImageOutput.create(str(path))
    if out and out.open(str(path), spec):
        out.write_image(np.ascontiguousarray(picture))
        out.close()
