# SPDX-License-Identifier: GPL-3.0-or-later
"""Frames of a sequence: which are meant, how their files are called, and by what a finished one is known."""

import hashlib
import json
import os
import re

from ..pen import library, plain
from ..pen.errors import EncreError

LAST_FRAME = 1048574  # Blender counts no further
_PART = re.compile(r"([-+]?\d{1,7})(?:-([-+]?\d{1,7})(?:x([1-9]\d{0,6}))?)?")


def numbers(text):
    """The frames of a list such as `1-100x5,7`, in its order, each once. EncreError: it is none."""
    found = {}
    for part in text.split(","):
        match = _PART.fullmatch(part.strip())
        first = int(match[1]) if match else 0
        last = int(match[2]) if match and match[2] else first
        if last < first:
            raise EncreError(f"{text!r} goes backwards from {first} to {last}; give the first frame first: "
                             f"{last}-{first}")
        if not match or max(abs(first), abs(last)) > LAST_FRAME:
            raise EncreError(f"{text!r} is not a frame number from {-LAST_FRAME} to {LAST_FRAME} nor a list such as "
                             "1-100x5,7; give one")
        found.update(dict.fromkeys(range(first, last + 1, int(match[3] or 1))))
    return list(found)


def meant(wanted, ready):
    """The frames that are meant by a list, (first, last) or None, of a scene that is `ready`: its first, last, step and
    current frame."""
    if not isinstance(wanted, tuple):
        return [ready["current"]] if wanted is None else wanted
    first, last = (own if number is None else number
                   for number, own in zip(wanted, (ready["first"], ready["last"]), strict=True))
    return list(range(first, last + 1, ready["step"]))


def listed(frames):
    """Numbers as text, runs of three and more as first-last."""
    runs = []
    for frame in sorted(frames):
        if runs and frame == runs[-1][-1] + 1:
            runs[-1].append(frame)
        else:
            runs.append([frame])
    return ", ".join(f"{run[0]}-{run[-1]}" if len(run) > 2 else ", ".join(map(str, run)) for run in runs)


def path(pattern, frame):
    """The file of a frame: runs of # in the name of `pattern` are its digits."""
    folder, name = os.path.split(pattern)
    return os.path.join(folder, re.sub("#+", lambda run: f"{frame:0{len(run[0])}d}", name))


def pattern(out):
    """`out` with four digits before its ending where it has no place for the frame's number."""
    folder, name = os.path.split(out)
    stem, ending = os.path.splitext(name)
    return out if "#" in name else os.path.join(folder, f"{stem}####{ending}")


def found(given):
    """The frames whose files are there, of a `given` name with #, in order."""
    folder, name = os.path.split(given)
    wanted = re.compile("(-?[0-9]+)".join(map(re.escape, re.split("#+", name))))
    frames = {int(match[1]) for entry in os.listdir(folder or ".") if (match := wanted.fullmatch(entry))}
    return sorted(frame for frame in frames if os.path.isfile(path(given, frame)))


def stamp(path):
    """What changes when another file takes this name; None: there is none."""
    try:
        with open(path, "rb") as file:  # opened, for a network's file to be looked up anew
            found = os.fstat(file.fileno())
    except OSError:
        return None
    return found.st_dev, found.st_ino, found.st_mtime_ns, found.st_size


def content(file):
    """A word for what a file holds. OSError: it can't be read."""
    sum_ = hashlib.sha256()
    with plain.opened(file) as opened:
        while chunk := opened.read(1 << 20):
            sum_.update(chunk)
    return sum_.hexdigest()


def contents(values):
    """{id: content} of the images that are among values of parameters. OSError: one can't be read."""
    return {id_: content(value) for id_, value in values.items() if value and library.params()[id_].type == "image"}


def mark(**said):
    """A word for everything that a picture depends on, to be stored in its file."""
    return hashlib.sha256(json.dumps(said, sort_keys=True).encode()).hexdigest()
