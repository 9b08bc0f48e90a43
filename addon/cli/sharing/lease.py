# SPDX-License-Identifier: GPL-3.0-or-later
"""What a process's folder tells others of its owner: a lock that is free once it is gone, and a lease that it renews.

Both are needed. A lock tells at once that a process was killed, but that of a machine that died may stay held on a
server of files; and a process that hangs holds its lock and renews nothing. Times are the file system's own, never a
host's: a file's is compared with that of one that was written just now.
"""

import contextlib
import functools
import json
import os
import re
import socket
import stat
from dataclasses import dataclass

HOST = re.sub(r"[^A-Za-z0-9.]", "_", socket.gethostname())[:64] or "host"
SECONDS = 600  # a lease lasts: longer than a frame is ever silent
LOCK, LEASE = "lock", "lease"
_MOST = 1 << 12  # bytes of a lease
_ALONE = re.compile(r"(?:^|,)(?:nolock|local_lock=(?:all|flock)|localflock|noflock|nobrl)(?:,|$)")
_KINDS = re.compile(r"fuse(?:\.|blk|$)|9p$|virtiofs$|vboxsf$")  # of file systems whose locks no other machine sees


@dataclass(frozen=True)
class Owner:
    """What is told of one: gone: True, its lock is free, False, it is held, None: nothing is known; renewed: when, in
    the file system's seconds; lease: for how long; claim: the file that it works on, or ""."""

    gone: bool | None
    renewed: float
    lease: float = SECONDS
    claim: str = ""

    def works(self, now):
        """Whether it may still be at work."""
        return not self.gone and now - self.renewed < self.lease


def take(path):
    """The open file `path`, new and locked as long as this process lives; None: no lock can be had there."""
    file = open(f"{path}.new" if os.name == "posix" else path, "wb")  # noqa: SIM115 - it stays open
    try:
        os.chmod(file.name, 0o644)  # whoever shares the folder may try the lock
        if os.name == "posix":
            import fcntl

            fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
            os.rename(file.name, path)  # it is seen only once it is locked
        else:
            import msvcrt

            msvcrt.locking(file.fileno(), msvcrt.LK_NBLCK, 1)
    except OSError:
        file.close()
        with contextlib.suppress(OSError):
            os.remove(file.name)
        return None
    return file


def write(path, seconds, claim):
    """Renews the lease `path`; when that was, by the file system's clock."""
    # Opened and closed each time: then a server of files has it, and not this host's memory.
    with open(os.open(path, os.O_WRONLY | os.O_CREAT, 0o644), "wb") as file:
        file.write(json.dumps([seconds, claim]).encode() + b"\n")
        file.truncate()  # only now: it is never seen empty
        return os.fstat(file.fileno()).st_mtime


def owner(path, host):
    """What the folder `path` of a process on `host` tells. FileNotFoundError: it has just gone."""
    found = Owner(_gone(path, host), os.stat(path).st_mtime)  # one that is just being made has no lease yet
    with contextlib.suppress(OSError, ValueError, TypeError), _opened(os.path.join(path, LEASE)) as file:
        seconds, claim = json.loads(file.read(_MOST).partition(b"\n")[0])
        found = Owner(found.gone, os.fstat(file.fileno()).st_mtime, float(seconds), str(claim))
    return found


def _opened(path):
    """A plain file: opening anything else that a stranger put there might wait for ever. OSError."""
    how = os.O_RDONLY | getattr(os, "O_NONBLOCK", 0) | getattr(os, "O_NOFOLLOW", 0)
    file = open(os.open(path, how), "rb")  # noqa: SIM115 - for the caller; it also has a network's file looked up anew
    if not stat.S_ISREG(os.fstat(file.fileno()).st_mode):
        file.close()
        raise OSError
    return file


def _gone(path, host):
    with contextlib.suppress(OSError), _opened(os.path.join(path, LOCK)) as file:
        try:
            if os.name == "posix":
                import fcntl

                fcntl.flock(file, fcntl.LOCK_SH | fcntl.LOCK_NB)
            else:
                import msvcrt

                msvcrt.locking(file.fileno(), msvcrt.LK_NBRLCK, 1)
        except (BlockingIOError, PermissionError):
            return False
        return True if host == HOST or travel(os.path.dirname(path)) else None
    return None


@functools.cache
def travel(folder):
    """Whether locks in a folder are seen on other machines."""
    try:
        with open("/proc/self/mounts", encoding="utf-8", errors="replace") as file:
            return shared(file.read(), os.path.realpath(folder))
    except OSError:
        return True


def shared(mounts, path):
    """Likewise, of a table of mounts."""
    kind, options, longest = "", "", -1
    for row in mounts.splitlines():
        _, point, its_kind, its_options, *_ = row.split(" ")
        point = re.sub(r"\\([0-7]{3})", lambda code: chr(int(code[1], 8)), point).rstrip("/")
        if len(point) >= longest and (path + "/").startswith(point + "/"):
            kind, options, longest = its_kind, its_options, len(point)
    return not (_KINDS.match(kind) or _ALONE.search(options))
