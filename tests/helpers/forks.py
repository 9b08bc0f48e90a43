# SPDX-License-Identifier: GPL-3.0-or-later
"""`encre ARGUMENTS` as a process of its own that need not load numpy, OpenImageIO and bpy: it, and the Blender that it
starts, are forks of one process that has.

    python tests/helpers/forks.py FD      that process, which hears of commands on a socket

What is asked for is done as in any process: with its own directory, environment, standard output and error, and memory
that nobody else sees. What a process reads before Python runs, as an encoding, is that of the first one.
"""

import atexit
import contextlib
import ctypes
import importlib.util
import json
import os
import re
import runpy
import signal
import socket
import subprocess
import sys
import tempfile
from pathlib import Path

INSIDE = Path(__file__).resolve().parents[2] / "addon" / "cli" / "inside.py"
LIMIT = 150  # seconds, after which a command is given up, and run as any other process is: libraries may not bear forks
POSSIBLE = sys.platform == "linux" and importlib.util.find_spec("bpy") is not None
_server = None  # (this process's id, the process that forks, our end of its line, what Blender leaves)


def run(arguments, cwd=None, env=None):
    """subprocess.CompletedProcess of `encre arguments`, in a process of its own."""
    process, line = _started()
    line.settimeout(LIMIT)
    with tempfile.TemporaryFile() as out, tempfile.TemporaryFile() as error:
        job = {"arguments": [str(each) for each in arguments], "cwd": str(cwd or os.getcwd()),
               "env": dict(os.environ if env is None else env)}
        try:
            socket.send_fds(line, [json.dumps(job).encode() + b"\n"], [out.fileno(), error.fileno()])
            status = line.makefile().readline()
            assert status, "the process that forks has ended"
        except (OSError, AssertionError) as reason:
            stop()
            print(f"forks: {reason}; encre {' '.join(job['arguments'])} is begun anew, without", file=sys.stderr)
            return subprocess.run([sys.executable, "-m", "encre", *job["arguments"]], capture_output=True, text=True,
                                  timeout=300, cwd=cwd, env=env, stdin=subprocess.DEVNULL)
        except BaseException:
            stop()
            raise
        for file in out, error:
            file.seek(0)
        said = [file.read().decode(errors="replace") for file in (out, error)]
    return subprocess.CompletedProcess(["encre", *job["arguments"]], int(status), *said)


def _started():
    global _server
    if _server is None or _server[0] != os.getpid() or _server[1].poll() is not None:
        ours, theirs = socket.socketpair()
        left = tempfile.TemporaryDirectory(prefix="encre-forks-")
        process = subprocess.Popen([sys.executable, __file__, str(theirs.fileno())], pass_fds=[theirs.fileno()],
                                   stdin=subprocess.DEVNULL, start_new_session=True,
                                   env={**os.environ, **dict.fromkeys(("TMPDIR", "TEMP", "TMP"), left.name)})
        theirs.close()
        _server = os.getpid(), process, ours, left
    return _server[1:3]


def stop():
    global _server
    if _server is not None and _server[0] == os.getpid():
        _server[2].close()
        os.killpg(_server[1].pid, signal.SIGKILL)
        _server[1].wait()
        _server[3].cleanup()
    _server = None


atexit.register(stop)


# In the process that forks

def _serve(number):
    import bpy  # noqa: F401
    import encre.cli.composite
    import encre.cli.main
    import encre.cli.restyle  # noqa: F401
    import OpenImageIO  # noqa: F401

    _end_threads()
    line = socket.socket(fileno=number)
    line.set_inheritable(False)
    while True:
        text, fds, *_ = socket.recv_fds(line, 1 << 16, 2)
        if not text:
            os._exit(0)  # bpy's own end may crash
        while not text.endswith(b"\n"):
            text += line.recv(1 << 16)
        sys.stdout.flush()
        sys.stderr.flush()
        child = os.fork()
        if child == 0:
            line.close()
            _command(json.loads(text), *fds)
        for fd in fds:
            os.close(fd)
        status = os.waitstatus_to_exitcode(os.waitpid(child, 0)[1])
        line.sendall(f"{status}\n".encode())


def _end_threads():
    """Of OpenEXR, which waits for them: a fork has none. What else has threads goes on without them."""
    maps = Path("/proc/self/maps").read_text().splitlines()
    for path in {line.split()[-1] for line in maps if "libOpenEXR." in line}:
        for name in set(re.findall(rb"_ZN\w*20setGlobalThreadCountEi", Path(path).read_bytes())):
            getattr(ctypes.CDLL(path), name.decode())(0)


def _command(job, out, error):
    """Never returns."""
    status = 1
    try:
        _become(job["cwd"], job["env"], out, error)
        os.close(out)
        os.close(error)
        kept = {int(fd) for fd in os.listdir("/proc/self/fd")}

        class Process(subprocess.Popen):
            """As any other, but that a Blender is a fork of this process, which has its module."""

            def _execute_child(self, args, executable, preexec_fn, close_fds, pass_fds, cwd, env, startupinfo,
                               creationflags, shell, p2cread, p2cwrite, c2pread, c2pwrite, errread, errwrite, *more):
                if args[:2] != [sys.executable, str(INSIDE)]:
                    return super()._execute_child(args, executable, preexec_fn, close_fds, pass_fds, cwd, env,
                                                  startupinfo, creationflags, shell, p2cread, p2cwrite, c2pread,
                                                  c2pwrite, errread, errwrite, *more)
                self.pid = os.fork()
                if self.pid == 0:
                    _blender(args[1:], env, c2pwrite, {*kept, *pass_fds})
                self._child_created = True
                for fd in {p2cread, c2pwrite, errwrite} - {-1}:
                    if fd not in kept:
                        os.close(fd)
                self._devnull = None
                return None

        from encre import __main__ as program
        from encre.cli import child

        child.subprocess = _Like(subprocess, Popen=Process)
        sys.argv = ["encre", *job["arguments"]]
        try:
            status = program.main()
        except SystemExit as end:
            status = end.code
        if isinstance(status, str):
            print(status, file=sys.stderr)
            status = 1
        sys.stdout.flush()
        sys.stderr.flush()
    finally:
        os._exit(int(status or 0))


class _Like:
    """A module with some names replaced."""

    def __init__(self, module, **own):
        self.__dict__.update(vars(module), **own)


def _blender(arguments, env, out, kept):
    """Never returns."""
    try:
        null = os.open(os.devnull, os.O_RDONLY)
        os.dup2(null, 0)
        _become(os.getcwd(), env, out, out)
        for fd in map(int, os.listdir("/proc/self/fd")):
            if fd not in kept and fd > 2:
                with contextlib.suppress(OSError):  # that of the list itself
                    os.close(fd)
        for number in signal.SIGINT, signal.SIGTERM, signal.SIGHUP:
            signal.signal(number, signal.default_int_handler if number == signal.SIGINT else signal.SIG_DFL)
        sys.argv = arguments
        runpy.run_path(arguments[0], run_name="__main__")
    finally:
        os._exit(1)


def _become(cwd, env, out, error):
    os.chdir(cwd)
    os.environ.clear()
    os.environ.update(env)
    tempfile.tempdir = None
    os.dup2(out, 1)
    os.dup2(error, 2)


if __name__ == "__main__":
    _serve(int(sys.argv[1]))
