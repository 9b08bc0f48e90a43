# SPDX-License-Identifier: GPL-3.0-or-later
"""What is said while work goes on, to readers that may leave."""

import subprocess
import sys

import pytest

SAYS = """
from encre.cli.progress import Progress, say
progress = Progress(say, as_json=JSON)
print("ready", flush=True)
input()
for frame in range(3):
    progress.begin(frame, frame + 1, 3)
    progress.written([str(frame)])
    say("note", "frame is done")
open("all", "w").close()
"""


@pytest.mark.parametrize(("stream", "as_json"), [("stdout", True), ("stderr", False)])
def test_work_goes_on_when_the_reader_leaves(tmp_path, stream, as_json):
    """Its status is that of the work, and not of a pipe."""
    child = subprocess.Popen([sys.executable, "-c", SAYS.replace("JSON", str(as_json))], cwd=tmp_path, text=True,
                             stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.PIPE)
    assert child.stdout.readline() == "ready\n"
    getattr(child, stream).close()
    child.stdin.write("\n")
    child.stdin.close()
    said = child.stderr.read() if as_json else ""
    assert child.wait(60) == 0 and (tmp_path / "all").exists()
    assert not as_json or said.count("warning: nobody reads what --progress json tells") == said.count("warning") == 1
