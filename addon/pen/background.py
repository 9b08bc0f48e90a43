# SPDX-License-Identifier: GPL-3.0-or-later
"""Works of the library that go on while Python does something else."""

from collections.abc import Callable, Generator, Sequence
from typing import Any

from . import abi
from .errors import Cancelled, EncreError
from .job import Work
from .library import Library, load
from .params import text_of

_RUNNING, _CANCELLED = 4, 3  # enum encre_code

# What is done in steps, so that others may wait for the library: it yields lists of works, which run one after the
# other, and is sent their results, or an empty list to take breath; and it returns what has come of it.
Steps = Generator[list[Work], list[Any], Any]


def run(steps: Steps, threads: int = 0, progress: Callable[[float], bool] | None = None) -> Any:
    """What steps return; the library does its part of them while this waits."""
    results: list[Any] = [None]
    try:
        while True:
            works = steps.send(results.pop())  # nothing is kept here that the steps let go
            results.append([load().run(work, threads, 1, progress) for work in works])
            del works
    except StopIteration as end:
        return end.value


class Background:
    """A thread of the library's, which has one list of works at a time."""

    def __init__(self, threads: int = 0, simd: int = 1, library: Library | None = None) -> None:
        self._library = library or load()
        self._works: list[Work] = []
        self._context = self._library.context(threads, simd)

    def __del__(self) -> None:
        if getattr(self, "_context", None):  # it waits until nobody uses the works any more
            self._library.lib.encre_destroy(self._context)

    def start(self, works: Sequence[Work]) -> None:
        """Starts works, which run one after the other; one may read what an earlier one draws. EncreError: others go
        on, or the library has no memory for them."""
        if self._library.lib.encre_start(self._context, abi.steps(works), len(works)):
            raise EncreError(self._sentence())
        self._works = list(works)

    def poll(self) -> list[Any] | None:
        """None as long as works go on, then once their results; EncreError, Cancelled: one of them failed."""
        return self._ended(self._library.lib.encre_poll(self._context, None))

    def wait(self) -> list[Any]:
        """Waits for what poll() gives at last."""
        return self._ended(self._library.lib.encre_wait(self._context)) or []

    def cancel(self) -> None:
        """Has the works end soon, if they have not yet: poll() then raises Cancelled."""
        self._library.lib.encre_cancel(self._context)

    def _ended(self, code):
        if code == _RUNNING:
            return None
        works, self._works = self._works, []
        if code and works:
            raise (Cancelled if code == _CANCELLED else EncreError)(self._sentence())
        return [work.result() for work in works]

    def _sentence(self):
        return text_of(self._library.lib.encre_error(self._context))


class Course:
    """Steps on their way, of which a Background does the library's part."""

    def __init__(self, behind: Background, steps: Steps) -> None:
        self._behind, self._steps, self._waits = behind, steps, False
        self.value: Any = None  # what they have returned

    def go_on(self) -> bool:
        """Does one step, unless the library is still at the last; whether there are more. EncreError, Cancelled: they
        have failed."""
        results = None
        if self._waits:
            results = self._behind.poll()
            if results is None:
                return True
        self._waits = False
        try:
            works = self._steps.send(results)  # type: ignore[arg-type]
        except StopIteration as end:
            self.value = end.value
            return False
        if works:
            self._behind.start(works)
            self._waits = True
        return True
