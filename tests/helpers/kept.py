# SPDX-License-Identifier: GPL-3.0-or-later
"""What slow twins have found, kept in build/kept from one run of the tests to the next.

A result is named by a hash of all that it follows from: what the function is given, every line of Python in
tests/reference and of the helpers beside this file, the file that has the function, and the versions of Python and
numpy. So a twin is asked again as soon as any of these is another, and never where it can only say the same.
"""

import functools
import hashlib
import io
import os
import pickle
import platform
import shutil
import sys
import tempfile
import time
import types
import zlib
from pathlib import Path

import numpy as np

TESTS = Path(__file__).resolve().parents[1]
FOLDER = TESTS.parent / "build" / "kept"
LEAST = 0.02  # seconds of work below which it is quicker to do it again
STAYING = 4  # texts of the twins of which the results stay: branches are gone to and come back from


class _Pickler(pickle.Pickler):
    def reducer_override(self, value):
        if isinstance(value, types.FunctionType | types.MethodType) and not value.__module__.startswith("numpy."):
            raise TypeError(f"kept: {value.__name__} is named by the key, but not what it does; give what it returns")
        return NotImplemented


def _hash(*values):
    file = io.BytesIO()
    _Pickler(file, 5).dump(values)
    return hashlib.sha256(file.getbuffer()).hexdigest()[:40]


@functools.cache
def _folder(own):
    """Of the results of the functions in the file `own`, as all sources are now."""
    paths = sorted({*TESTS.glob("reference/*.py"), *TESTS.glob("helpers/*.py"), Path(own).resolve()})
    text = [(str(path.relative_to(TESTS)), path.read_bytes()) for path in paths]
    kind = f"{Path(own).stem}-"
    folder = FOLDER / (kind + _hash(text, sys.version, np.__version__, platform.machine())[:16])
    if not folder.is_dir():
        folder.mkdir(parents=True, exist_ok=True)
        old = sorted(FOLDER.glob(f"{kind}*"), key=lambda path: path.stat().st_mtime)
        for each in old[:-STAYING]:
            shutil.rmtree(each, ignore_errors=True)
    return folder


def of(function, *given, by=(), **named):
    """function(*given, **named), or what it gave when it was given the same; by: what else it follows from. It must
    change none of that, and neither ask the library nor read a file."""
    path = _folder(function.__code__.co_filename) / _hash(function.__qualname__, given, named, by)
    try:
        return pickle.loads(zlib.decompress(path.read_bytes()))
    except (OSError, zlib.error):
        pass
    start = time.process_time()
    found = function(*given, **named)
    if time.process_time() - start > LEAST:
        with tempfile.NamedTemporaryFile(dir=path.parent, delete=False) as file:
            file.write(zlib.compress(pickle.dumps(found, 5), 1))
        os.replace(file.name, path)
    return found


def kept(function):
    """The function, of which what it finds is kept."""
    return functools.wraps(function)(functools.partial(of, function))
