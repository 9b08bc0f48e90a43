# SPDX-License-Identifier: GPL-3.0-or-later
"""A scene's frames as a job of a farm's own system (systems.py), written into a folder or handed over."""

import json
import os
import shutil
import subprocess
import urllib.error
import urllib.request
from dataclasses import dataclass

from ...pen.errors import EncreError, shown
from .. import images, sequence
from ..child import RenderError
from ..progress import put
from .systems import FARMS

TIMEOUT = 86400  # seconds for a frame, where --frame-timeout says nothing else


@dataclass(frozen=True)
class Job:
    """What a farm must know. scene, out and place (the folder of the job's files) are absolute; out has # for the
    frame's number; options: more of `encre render`; chunk: frames of a task; timeout, opening: seconds; cpus, memory:
    what a task asks of its machine, processors and gigabytes, 0: nothing."""

    name: str
    encre: str
    scene: str
    out: str
    frames: list
    options: list
    inputs: list
    fps: float
    place: str
    chunk: int = 1
    retries: int = 5
    film: str = ""
    cpus: int = 0
    memory: int = 0
    timeout: int = TIMEOUT
    opening: int = TIMEOUT

    @property
    def folder(self):
        return os.path.dirname(self.out)

    def chunks(self, least=1):
        """Lists of frames as text, of as many frames as a task gets, and `least`."""
        size = max(self.chunk, least)
        return [sequence.listed(self.frames[k:k + size]).replace(" ", "") for k in range(0, len(self.frames), size)]


def submit(farm, job, run):
    """Writes the job's files and, with `run`, hands them over; their paths. EncreError, RenderError."""
    files = FARMS[farm].write(job)
    for name, text in files.items():
        path = os.path.join(job.place, name)
        images.prepare(path)
        with open(path, "w", encoding="utf-8", newline="\n") as file:
            file.write(text)
    command = FARMS[farm].run(job.place)
    if not run:
        then = f"; then: {' '.join(command)}" if command else ""
        put(shown(f"{job.place}: {', '.join(files)}{then}"), "stderr")
        return
    if farm == "flamenco":
        _post(files["job.json"])
        return
    if not shutil.which(command[0]):
        raise EncreError(f"{command[0]}: is not on this machine, and hands jobs over to {farm}; install it, or take "
                         f"the files in {job.place} to a machine that has it")
    if (status := subprocess.run(command).returncode) != 0:
        raise RenderError(f"{command[0]} did not take the job (status {status}); see what it said above")


def _post(text):
    """Hands a job to the Manager of Flamenco that FLAMENCO_MANAGER names."""
    manager = os.environ.get("FLAMENCO_MANAGER", "http://localhost:8080").rstrip("/")
    request = urllib.request.Request(f"{manager}/api/v3/jobs", text.encode(), {"Content-Type": "application/json"})
    try:
        with urllib.request.urlopen(request, timeout=60) as answer:
            put(shown(f"job {json.load(answer).get('id', '?')} at {manager}"), "stderr")
    except urllib.error.HTTPError as error:
        said = error.read(2000).decode(errors="replace").strip()
        raise RenderError(f"{manager}: does not take the job ({error.code}: {said}); put encre.js into its folder "
                          "scripts") from None
    except (urllib.error.URLError, ValueError, OSError) as error:
        raise RenderError(f"{manager}: can't be asked ({getattr(error, 'reason', error)}); name the Manager by the "
                          "variable FLAMENCO_MANAGER") from None
