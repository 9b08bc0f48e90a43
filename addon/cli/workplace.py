# SPDX-License-Identifier: GPL-3.0-or-later
"""A process's own folder: for what is not finished yet, and for its claims to frames that others might take as well.

The folder's name tells its owner: host, process, when that started, and a word that nobody can foresee. A folder whose
owner is gone is swept by whoever next makes one beside it, or is done with theirs.
"""

import contextlib
import os
import re
import secrets
import shutil
import socket
import stat
import subprocess
import sys

_HOST = re.sub(r"[^A-Za-z0-9.]", "_", socket.gethostname())[:64] or "host"
_NAME = re.compile(r"\.?encre-([A-Za-z0-9._]+)-(\d+)-(\d+)-[0-9a-f]{16}")


def _started(pid):
    """When a process of this host started, in the system's own count; 0: it can't be told; None: there is none."""
    if sys.platform == "linux":
        try:
            with open(f"/proc/{pid}/stat", "rb") as file:
                words = file.read().rpartition(b")")[2].split()  # the name before may hold anything
        except OSError:
            return None
        return None if words[0] == b"Z" else int(words[19])
    if os.name == "posix":
        told = subprocess.run(["ps", "-o", "lstart=", "-p", str(pid)], capture_output=True).stdout
        return int.from_bytes(re.sub(rb"\D", b"", told)[-8:], "big") if told.strip() else None
    return 0


def _lock(path):
    """The open file `path`, locked as long as this process lives; None: another has it. OSError: there is no file."""
    file = open(path, "ab")  # noqa: SIM115 - it stays open
    try:
        if os.name == "posix":
            import fcntl

            fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
        else:
            import msvcrt

            msvcrt.locking(file.fileno(), msvcrt.LK_NBLCK, 1)
    except OSError:
        file.close()
        return None
    return file


def _alive(folder, name):
    """Whether the owner of a folder may still be there. Of another host's nothing can be told: it may."""
    host, pid, started = _NAME.fullmatch(name).groups()
    if host != _HOST:
        return True
    if _started(int(pid)) == int(started) and int(started):
        return True
    # A process of another container of this host's name has a number that means nothing here, but holds the lock.
    try:
        lock = _lock(os.path.join(folder, name, "lock"))
    except OSError:
        return False
    if lock is None:
        return True
    lock.close()
    return False


def _others(folder):
    """Names of the folders of this kind in `folder` that are this user's or another's who may write there."""
    with contextlib.suppress(OSError):
        for entry in os.scandir(folder):
            if _NAME.fullmatch(entry.name) and entry.is_dir(follow_symlinks=False):
                yield entry.name


def sweep(folder):
    """Removes the folders in `folder` whose owners are gone."""
    for name in list(_others(folder)):
        path = os.path.join(folder, name)
        with contextlib.suppress(FileNotFoundError):  # its owner has just ended, or another has swept it
            if (os.name != "posix" or os.lstat(path).st_uid == os.getuid()) and not _alive(folder, name):
                shutil.rmtree(path, ignore_errors=True)


class Workplace:
    """A context manager; `path` is the folder, made in `folder` and hidden there. OSError: it can't be made."""

    def __init__(self, folder, prefix=".encre-"):
        self.folder = folder
        sweep(folder)
        self.name = f"{prefix}{_HOST}-{os.getpid()}-{_started(os.getpid()) or 0}-{secrets.token_hex(8)}"
        self.path = os.path.join(folder, self.name)
        os.mkdir(self.path, 0o700)
        self._held = _lock(os.path.join(self.path, "lock"))

    def __enter__(self):
        return self

    def __exit__(self, *_):
        if self._held:
            self._held.close()
        shutil.rmtree(self.path, ignore_errors=True)
        sweep(self.folder)  # of those who were killed meanwhile, whom nobody may follow

    def claim(self, name):
        """Claims the file `name` of the folder against all other processes; says who has it, None: this one now has.

        Each puts down its own mark before it looks for others', so that of two at least one sees the other's.
        """
        mark = f"claim-{name}"[:200]
        if not os.path.isdir(self.path):  # somebody has removed the folder that it is in
            os.makedirs(self.path, 0o700)
            self._held = _lock(os.path.join(self.path, "lock"))
        with open(os.path.join(self.path, mark), "xb"):
            pass
        for other in _others(self.folder):
            if other != self.name and os.path.lexists(os.path.join(self.folder, other, mark)) \
                    and _alive(self.folder, other):
                self.release(name)
                host, pid, _ = _NAME.fullmatch(other).groups()
                return f"process {pid} on {host}"
        return None

    def release(self, name):
        with contextlib.suppress(OSError):
            os.remove(os.path.join(self.path, f"claim-{name}"[:200]))

    def take(self, name, path):
        """Moves the finished file `name` of this folder to `path`. OSError: it can't; ValueError: it is not a file of
        this folder but a way out of it."""
        own = os.path.join(self.path, name)
        if os.path.basename(name) != name or not stat.S_ISREG(os.lstat(own).st_mode):
            raise ValueError(name)
        os.replace(own, path)
