# SPDX-License-Identifier: GPL-3.0-or-later
"""The private line between `encre render` and the process that it starts, which here is a Python that says this and
that."""

import sys
import time

import pytest
from encre.cli import child

HEAD = """
import json, os, socket, sys, time
with open(sys.argv[-1]) as file:
    line = socket.socket(fileno=json.load(file)["line"])
"""


@pytest.fixture(params=[True, False], ids=["pipe", "file"])
def starts(request, monkeypatch, tmp_path):
    """Gives a Child that runs some lines of Python, and the list of what it prints."""
    monkeypatch.setattr(child, "_PIPES", request.param)
    monkeypatch.setenv("TMPDIR", str(tmp_path))
    monkeypatch.setattr("tempfile.tempdir", str(tmp_path))

    def start(code):
        printed = []
        return child.Child([sys.executable, "-c", HEAD + code], {}, printed.append), printed
    return start


def test_rows_come_whole_though_they_are_sent_in_pieces(starts):
    made, printed = starts("""
for piece in (b'{"event": "a"', b', "text": "\\xc3', b'\\xb6"}\\n{"event": "b"}\\n{"event"'):
    line.sendall(piece)
    time.sleep(0.05)
sys.stdout.buffer.write(b"one\\rtwo\\n\\n" + b"x" * 200_000 + b"\\n\\xff last")
""")
    with made as running:
        assert running.next() == {"event": "a", "text": "ö"} and running.next() == {"event": "b"}
        with pytest.raises(child.Ended, match="(?s)exit status 0.*last"):
            running.next()
    assert printed == ["one", "two", "x" * 200_000, "\ufffd last"]


def test_how_it_ended_is_told(starts, tmp_path):
    made, _ = starts("print('oh', flush=True); os.kill(os.getpid(), 11)")
    with made as running, pytest.raises(child.Ended, match='signal SIGSEGV.*"oh"'):
        made.hear = lambda _line: False
        running.next()
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("code", ["time.sleep(1000)", "while True: print('still here', flush=True)"])
def test_it_is_given_up_in_time(starts, tmp_path, code):
    """Also where it prints for ever."""
    made, _ = starts(code)
    start = time.monotonic()
    with made as running, pytest.raises(TimeoutError):
        running.next(start + 0.5)
    assert time.monotonic() - start < 10 and list(tmp_path.iterdir()) == []
