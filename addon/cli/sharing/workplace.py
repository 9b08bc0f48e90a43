# SPDX-License-Identifier: GPL-3.0-or-later
"""A process's own folder: for what is not finished yet, and for its claim to a file that others might make as well.

The folder's name tells its owner: host, process, and a word that nobody can foresee. Others may see what it claims
(lease.py), not what it makes: that lies in a folder within. A folder whose owner is gone is swept by whoever next makes
one beside it, or is done with theirs.
"""

import contextlib
import os
import random
import re
import secrets
import shutil
import stat
import tempfile
import time

from . import lease

_NAME = re.compile(r"\.?encre-([A-Za-z0-9._]+)-(\d+)-[0-9a-f]{16}")
AT_ONCE = 3  # rounds in which two may let go of a file that they claimed at the same time
_PAUSE = 0.2, 2.0  # seconds between two rounds: at first, and at most
_FORGOTTEN = 86400  # seconds after which a folder is swept whose owner's lock tells nothing


def _others(folder):
    """(name, lease.Owner) of the folders of this kind in `folder`."""
    with contextlib.suppress(OSError):
        for entry in os.scandir(folder):
            if (match := _NAME.fullmatch(entry.name)) and entry.is_dir(follow_symlinks=False):
                with contextlib.suppress(OSError):  # its owner has just ended, or another has swept it
                    yield entry.name, lease.owner(entry.path, match[1])


def _now(folder):
    """The time by the clock of the file system."""
    with tempfile.TemporaryFile(dir=folder) as file:
        file.write(b"\n")
        file.flush()
        return os.fstat(file.fileno()).st_mtime


def sweep(folder):
    """Removes this user's folders in `folder` whose owners are gone, and those of which nothing was heard for a day."""
    with contextlib.suppress(OSError):
        for name, owner in list(_others(folder)):
            path = os.path.join(folder, name)
            if (os.name != "posix" or os.lstat(path).st_uid == os.getuid()) and _forgotten(folder, name, owner):
                shutil.rmtree(path, ignore_errors=True)


def _forgotten(folder, name, owner):
    if owner.gone is not None and (owner.gone or _host(name) == lease.HOST):
        return owner.gone
    return _now(folder) - owner.renewed > max(owner.lease, _FORGOTTEN)


def _host(name):
    return _NAME.fullmatch(name)[1]


def _process(name):
    host, pid = _NAME.fullmatch(name).groups()
    return f"process {pid} on {host}"


class Workplace:
    """A context manager; `path` is a folder for this user alone, in one that is made in `folder` and hidden there.
    seconds: how long the lease lasts. OSError: it can't be made."""

    def __init__(self, folder, prefix=".encre-", seconds=lease.SECONDS):
        self.folder, self.seconds, self.claimed = folder, seconds, ""
        sweep(folder)
        self.name = f"{prefix}{lease.HOST}-{os.getpid()}-{secrets.token_hex(8)}"
        self._root = os.path.join(folder, self.name)
        self.path = os.path.join(self._root, "own")
        self._held = None
        self._make()

    def _make(self):
        os.mkdir(self._root, 0o700)
        os.mkdir(self.path, 0o700)
        self._held = lease.take(os.path.join(self._root, lease.LOCK))
        self._put()
        os.chmod(os.path.join(self._root, lease.LEASE), 0o644)
        os.chmod(self._root, 0o755)

    def _put(self):
        """Renews the lease; when, by the file system's clock."""
        self._renewed = time.monotonic()
        return lease.write(os.path.join(self._root, lease.LEASE), self.seconds, self.claimed)

    def renew(self):
        """To be called while the work makes progress, as often as one likes."""
        if time.monotonic() - self._renewed > self.seconds / 20:
            with contextlib.suppress(OSError):  # the folder was removed, which claim() and take() tell
                self._put()

    def __enter__(self):
        return self

    def __exit__(self, *_):
        if self._held:
            self._held.close()
        shutil.rmtree(self._root, ignore_errors=True)
        sweep(self.folder)  # of those who were killed meanwhile, whom nobody may follow

    def claim(self, name):
        """Claims the file `name` of the folder against all other processes, in place of what this one had claimed; says
        who has it, None: this one now has. OSError.

        Each puts down its own claim before it looks for others', so that of two at least one sees the other's. A claim
        ends with its owner, or when its lease runs out.
        """
        self.claimed = name
        if not os.path.isdir(self.path):  # somebody has removed the folder that it is in
            shutil.rmtree(self._root, ignore_errors=True)
            os.makedirs(self.folder, exist_ok=True)
            self._make()
        now = self._put()
        self._look_anew()
        for other, owner in _others(self.folder):
            if other != self.name and owner.claim == name and owner.works(now):
                self.release()
                return _process(other)
        return None

    def _look_anew(self):
        """Changes something in the folder: on a network, a machine trusts for a while what it knows of a folder that it
        has not changed itself."""
        with contextlib.suppress(OSError):
            os.rmdir(tempfile.mkdtemp(prefix=".encre-look-", dir=self.folder))

    def claims(self):
        """{name: who has it} of the files that others work on."""
        now = self._put()
        return {owner.claim: _process(other) for other, owner in _others(self.folder)
                if other != self.name and owner.claim and owner.works(now)}

    def release(self):
        if not self.claimed:
            return
        self.claimed = ""
        with contextlib.suppress(OSError):
            self._put()

    def wait(self, rounds):
        """Lets some time pass before what others had in the last of so many `rounds` is claimed again."""
        self.renew()
        time.sleep(min(_PAUSE[0] * 1.5 ** (rounds - 1), _PAUSE[1]) * random.uniform(0.5, 1.5))

    def take(self, name, path):
        """Moves the finished file `name` of this folder to `path`, and has both last through a loss of power. OSError:
        it can't; ValueError: it is not a file of this folder but a way out of it."""
        own = os.path.join(self.path, name)
        if os.path.basename(name) != name or not stat.S_ISREG(os.lstat(own).st_mode):
            raise ValueError(name)
        _flush(own, os.O_RDWR)
        os.replace(own, path)
        if os.name == "posix":
            with contextlib.suppress(OSError):  # some file systems know no such thing for folders
                _flush(os.path.dirname(os.path.abspath(path)), os.O_RDONLY)


def _flush(path, how):
    file = os.open(path, how)
    try:
        os.fsync(file)
    finally:
        os.close(file)
