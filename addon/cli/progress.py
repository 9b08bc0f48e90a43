# SPDX-License-Identifier: GPL-3.0-or-later
"""What `encre` says while it works: a bar on a terminal, a line a frame elsewhere, or JSON for programs."""

import json
import os
import re
import sys
import time

from ..pen.errors import shown

_SAMPLE = re.compile(r"Sample (\d+)/(\d+)")
_PART = re.compile(r"part (\d+) of (\d+)$")  # of a supersampled frame, as subframes.py says it
_REPORT = re.compile(r"(Info|Warning): (.+)")  # how Blender prints what the engine reports
WIDTH = 30


def put(text, stream="stdout", end="\n"):
    """Prints; whether somebody reads it. Work goes on where nobody does any more, as after `| head -1`."""
    stream = getattr(sys, stream)
    try:
        print(text, end=end, file=stream, flush=True)
        return True
    except OSError:
        with open(os.devnull, "w") as nowhere:  # what is left in the stream would fail again at the end
            os.dup2(nowhere.fileno(), stream.fileno())
        return False


def say(kind, sentence):
    """One line on the standard error: an error, a warning or a note."""
    put(f"encre: {kind}: {shown(sentence)}", "stderr")


class Progress:
    """say(kind, sentence) hears notes and warnings; `as_json`: one object a line goes to the standard output, none to
    the standard error; openjd: lines of an Open Job Description's session, likewise; verbose: pass on all that Blender
    prints. send(text): where such lines go, and whether somebody reads them."""

    def __init__(self, say, as_json=False, verbose=False, openjd=False, send=put):
        self._say, self.as_json, self.verbose, self.openjd, self.send = say, as_json, verbose, openjd, send
        self.number, self.count = 1, 1  # of the frame, of how many
        self.label, self.start, self.told, self.frame = "", 0.0, set(), None
        self.tty = not (as_json or openjd) and sys.stderr is not None and sys.stderr.isatty()
        self.part = 0, 1  # how many parts of the frame are done, and of how many

    def tell(self, event, **more):
        if self.openjd and (line := self._openjd(event, more)):
            put(shown(line))
        if self.as_json and not self.send(json.dumps({"event": event, **more})):
            self.as_json = False
            self._say("warning", "nobody reads what --progress json tells any more; rendering goes on")

    def _openjd(self, event, more):
        if event in ("progress", "written", "finished", "done"):
            done = self.number - 1 + more.get("fraction", 1)
            return f"openjd_progress: {100 * done / self.count if event != 'done' else 100:.2f}"
        kind = {"note": "status", "warning": "status", "failed": "status", "error": "fail"}.get(event)
        return kind and f"openjd_{kind}: {more['text']}"

    def relay(self, event, more):
        """What another process has told."""
        if event == "frame":
            self.begin(more["frame"], more["number"], more["count"])
        elif event == "progress":
            self.frame, self.label = more["frame"], self.label or f"frame {more['frame']}"
            self._sample(round(1000 * more["fraction"]), 1000)
        elif event == "written":
            self.frame, self.start = more["frame"], time.monotonic() - more["seconds"]
            self.label = f"frame {self.frame} ({self.number}/{self.count})"
            self.written(more["files"])
        elif event in ("note", "warning"):
            self.say(event, more["text"])
        elif event == "failed":
            self.failed(more["frame"], more["text"])
        else:
            self.tell(event, **more)

    def say(self, kind, sentence, **more):
        self.clear()
        self._say(kind, sentence)
        self.tell(kind, text=sentence, **({"frame": self.frame} if self.label else {}), **more)

    def begin(self, frame, number, count):
        self.number, self.count = number, count
        self.frame, self.label = frame, f"frame {frame} ({number}/{count})"
        self.start, self.part = time.monotonic(), (0, 1)
        self.tell("frame", frame=frame, number=number, count=count)
        self._sample(0, 1)

    def written(self, paths, another=False):
        """A frame is in its place; another: by another process, which was there first."""
        self.clear()
        took = time.monotonic() - self.start
        if another:
            self.say("note", f"frame {self.frame} was finished by another process meanwhile, whose picture stays")
            self.label = ""
            return
        self.tell("written", frame=self.frame, files=paths, seconds=round(took, 3))
        for path in () if self.as_json or self.openjd else paths:
            put(shown(f"{self.label}: {path} ({took:.1f} s)"), "stderr")
        self.label = ""

    def failed(self, frame, sentence):
        """A frame that the others go on without."""
        self.clear()
        self.label = ""
        self._say("warning", sentence)
        self.tell("failed", frame=frame, text=sentence)

    def hear(self, line):
        """A line that Blender printed; whether it is known."""
        if self.verbose:
            put(shown(line), "stderr")
        if sample := _SAMPLE.search(line):
            self._sample(int(sample[1]), int(sample[2]))
        elif part := _PART.search(line):
            self.part = int(part[1]) - 1, int(part[2])
        elif words := _REPORT.match(line):
            if self.label and words[2] not in self.told:  # once, though every frame says it
                self.told.add(words[2])
                self.say({"Info": "note", "Warning": "warning"}[words[1]], words[2])
        else:
            return False
        return True

    def _sample(self, number, count):
        if not self.label:
            return
        done, parts = self.part
        count, number = parts * max(count, 1), done * max(count, 1) + number
        self.tell("progress", frame=self.frame, fraction=round(number / count, 4))
        if self.tty:
            filled = WIDTH * number // count
            bar = "#" * filled + "." * (WIDTH - filled)
            put(f"\r{self.label} [{bar}] {100 * number // count:3d} %", "stderr", end="")

    def clear(self):
        if self.tty:
            put("\r\x1b[K", "stderr", end="")
