# SPDX-License-Identifier: GPL-3.0-or-later
"""A copy of the tree in which changes are built and tested, for mutate.py."""

import contextlib
import ctypes
import functools
import os
import re
import resource
import shlex
import shutil
import signal
import subprocess
import sys
import time
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import mutants

# Memory that is never set holds a pattern, and an index beyond an array ends the process: both are noticed at once.
SEEN = ("-fsanitize=bounds -fsanitize-undefined-trap-on-error -ftrivial-auto-var-init=pattern -U_FORTIFY_SOURCE "
        "-D_FORTIFY_SOURCE=2")
LIMIT, STILL = 60, 1200  # seconds that a mutant's tests may compute, and may take: what hangs is noticed
STALE = 77  # how a process ends that finds another library than the one that was changed
SWITCH = '__attribute__((visibility("default"))) int mutant_now'
CHOSEN = f"""
#include <stdlib.h>
{SWITCH};
__attribute__((constructor)) static void choose_mutant(void)
{{
	const char *chosen = getenv("ENCRE_MUTANT");
	mutant_now = chosen ? atoi(chosen) : 0;
}}
"""

def copy(root, to):
    """The tree as it is, built, with the tests' own package `encre`."""
    listed = subprocess.run(["git", "ls-files", "-co", "--exclude-standard"], cwd=root, capture_output=True, text=True,
                            check=True).stdout.split("\n")
    for name in filter(None, listed):
        if (root / name).is_file():
            (to / name).parent.mkdir(parents=True, exist_ok=True)
            shutil.copy2(root / name, to / name)
    if (root / "build" / "scalar").is_dir():  # objects that are as new as their sources
        shutil.copytree(root / "build" / "scalar", to / "build" / "scalar", copy_function=shutil.copy2)
    (to / "build" / "path").mkdir(parents=True)
    (to / "build" / "path" / "encre").symlink_to(to / "addon")


class Copy:
    """A tree in which mutants are built and tested, each in a process of its own that begins with all that tests need
    and with what the twins found before: a twin is asked again only where it is given something else."""

    def __init__(self, tree):
        self.tree, self.runs = tree, 0
        os.chdir(tree)
        sys.path[:0] = [str(tree / "build" / "path"), str(tree / "tests" / "helpers"), str(tree / "tests")]
        os.environ["PYTHONPATH"] = os.pathsep.join(sys.path[:3])
        import built
        self.built = built

    def build(self):
        """The library and the one with probes, under a name of its own: what is loaded stays as it is."""
        self.runs += 1
        self.probe = self.built.probe_fine(f"probe_{self.runs}")
        link, _ = self.built.objects(self.tree / "addon" / "libencre.so.part")
        subprocess.run(link, check=True)
        os.replace("addon/libencre.so.part", "addon/libencre.so")

    def warm(self, fine, light=False):
        (self.tree / "build" / "mutant.h").write_text(f"extern {SWITCH};\n", encoding="utf-8")
        with open("csrc/base/cpu.c", "a", encoding="utf-8") as file:
            file.write(CHOSEN)
        os.environ["CFLAGS"] = f"{SEEN} -include {self.tree}/build/mutant.h"
        self.build()
        import numpy  # noqa: F401
        import pytest  # noqa: F401
        from encre.pen import installed

        # What a process has loaded its children have, though another file takes its place: here another is loaded.
        self._own, installed.path = installed.path, lambda own=str(self.probe): own
        self._import(fine, light)
        if str(self.tree / "addon" / "libencre") in Path("/proc/self/maps").read_text():
            raise SystemExit("mutate: the library that is to change is loaded before it does")

    def _import(self, fine, light):
        if light:
            sys.path.append(str(self.tree / "tests" / "stages"))
            import test_shadows
            for name in test_shadows.ALL:
                test_shadows.case(name)
        if not fine:
            return
        import passes
        from reference import chains, ends
        from reference import passes as twins
        slow = {twins: ("crack_links", "ridge_links", "ties", "smooth", "crowd"), chains: ("beside", "spurs")}
        for place, name in ((place, name) for place, names in slow.items() for name in names):
            setattr(place, name, _remembering(getattr(place, name)))
        ends.lead_on = _remembering(ends.lead_on)
        passes.library = functools.cache(lambda: passes.load("probe_1"))
        if self._pytest(["tests/fine/test_fine_sites.py", "tests/fine/test_fine_passes.py"]):
            raise SystemExit("mutate: the twins fail before anything is changed")
        names = "test_fine_sites", "test_fine_passes"
        loaded = [module for name, module in sys.modules.items() if name.endswith(names)]
        if len(loaded) != 2:
            raise SystemExit("mutate: pytest names its modules otherwise; what tests have compared can't be kept")
        for module in loaded:
            module.compare = _where_changed(module.compare, {name: _found(name) for name in module.ALL})

    def _pytest(self, arguments):
        import pytest
        with open(os.devnull, "w") as nowhere, contextlib.redirect_stdout(nowhere), contextlib.redirect_stderr(nowhere):
            return pytest.main(["-x", "-q", "-p", "no:cacheprovider", "-p", "no:randomly",
                                "-m", "not slow and not long", *arguments])

    def fails(self, number, selections):
        """The tests that notice the mutant of this number, or None."""
        for selection in selections:
            ended = self._ended(number, selection)
            if ended == STALE:
                raise SystemExit(f"mutate: {self.probe.name} is not the library that was changed")
            if (ended == -signal.SIGKILL or ended and selection == selections[-1]) and self._unchanged(selection):
                raise SystemExit(f"mutate: {selection} takes more than {LIMIT} s, or fails, though nothing is changed; "
                                 "make two rows of it in TESTS, or mend it")
            if ended:
                return selection if ended > 0 else f"{selection}: {signal.Signals(-ended).name}"
        return None

    @functools.cache  # noqa: B019
    def _unchanged(self, selection):
        return self._ended(0, selection)

    def _ended(self, number, selection):
        child = os.fork()
        if child == 0:
            os.setsid()
            resource.setrlimit(resource.RLIMIT_CPU, (LIMIT, LIMIT))
            code = 1
            try:
                code = self._noticed(number, selection)
            finally:
                os._exit(code)
        return _wait(child)

    def _noticed(self, number, selection):
        from encre.pen import installed, library
        if self.probe.name in Path("/proc/self/maps").read_text():
            return STALE
        os.environ["ENCRE_MUTANT"] = str(number)
        if ctypes.c_int.in_dll(ctypes.CDLL(str(self.probe)), "mutant_now").value != number:
            return STALE
        installed.path = self._own
        library.load.cache_clear()
        if "passes" in sys.modules:
            import passes
            passes.case.cache_clear()
            passes.library = functools.cache(lambda: passes.load(self.probe.stem))
        return int(self._pytest(_words(selection)))

    def run_python(self, change):
        """Likewise, of a row of PYTHON; in a new Python."""
        name, old, new, selection = change
        path = self.tree / name
        was = path.read_text(encoding="utf-8")
        if was.count(old) != 1:
            raise SystemExit(f"mutate: {name} has {was.count(old)} times {old!r}; mend the row of PYTHON")
        path.write_text(was.replace(old, new), encoding="utf-8")
        try:
            done = subprocess.run([sys.executable, "-m", "pytest", "-x", "-q", "-p", "no:cacheprovider",
                                   *_words(selection)], cwd=self.tree, capture_output=True)
            return selection if done.returncode == 1 else None
        finally:
            path.write_text(was, encoding="utf-8")

    def run(self, chosen, tests_of):
        """(mutant, the tests that notice it or None or "does not compile", seconds) for each; tests_of() tells which
        tests are nearest to a path. One library holds all that may change while it runs; what a compiler must know,
        sizes and tables, is built alone."""
        numbers = dict(enumerate(chosen, 1))
        together = self._switchable(numbers)
        with self._changed({path: mutants.switched(self._text(path), own) for path, own in by_file(together).items()}):
            self.build()
            for number, mutant in together.items():
                yield self._timed(mutant, number, tests_of)
        for number, mutant in numbers.items():
            if number not in together:
                with self._changed({mutant.path: mutants.alone(self._text(mutant.path), mutant)}):
                    try:
                        with _quiet():
                            self.build()
                    except subprocess.CalledProcessError:
                        yield mutant, "does not compile", 0
                        continue
                    yield self._timed(mutant, number, tests_of)

    def _timed(self, mutant, number, tests_of):
        start = time.monotonic()
        return mutant, self.fails(number, tests_of(mutant.path)), time.monotonic() - start

    def _text(self, path):
        return (self.tree / path).read_text(encoding="utf-8")

    def _switchable(self, numbers):
        """Those of {number: mutant} that compile as switches."""
        _, compile_ = self.built.objects(self.tree / "build" / "unused")
        files = {self.tree / mutant.path for mutant in numbers.values()}
        commands = [[*command, "-w", "-fsyntax-only"] for command in compile_
                    if files & self.built.read(self.tree / command[command.index("-c") + 1])]
        left = dict(numbers)
        while True:
            texts = {path: mutants.switched(self._text(path), own) for path, own in by_file(left).items()}
            with self._changed(texts), ThreadPoolExecutor(os.cpu_count()) as pool:
                ended = list(pool.map(functools.partial(subprocess.run, cwd=self.tree, capture_output=True, text=True),
                                      commands))
            commands = [command for command, done in zip(commands, ended, strict=True) if done.returncode]
            if not commands:
                return left
            lines = {(path.removeprefix(f"{self.tree}/"), int(line)) for done in ended if done.returncode
                     for path, line in re.findall(r"^(\S+?):(\d+):", done.stderr, re.MULTILINE)}
            fewer = {number: m for number, m in left.items() if (m.path, m.line) not in lines}
            if len(fewer) == len(left):
                raise SystemExit(f"mutate: no switches, but {ended[0].stderr[-1000:]}")
            left = fewer

    @contextlib.contextmanager
    def _changed(self, texts):
        """Files with other texts, and afterwards they and their objects as before."""
        stamps = {path: ((self.tree / path).stat(), self._text(path)) for path in texts}
        kept = self.built.BUILD.with_name("kept")
        kept.mkdir(exist_ok=True)
        for made in self.built.BUILD.glob("*.o"):
            shutil.copy2(made, kept / made.name)
        try:
            for path, text in texts.items():
                (self.tree / path).write_text(text, encoding="utf-8")
            yield
        finally:
            for path, (stamp, was) in stamps.items():
                (self.tree / path).write_text(was, encoding="utf-8")
                os.utime(self.tree / path, ns=(stamp.st_atime_ns, stamp.st_mtime_ns))
            for made in kept.glob("*.o"):
                os.replace(made, self.built.BUILD / made.name)


def by_file(numbers):
    """{number: mutant} by the mutants' files."""
    files = {}
    for number, mutant in numbers.items():
        files.setdefault(mutant.path, {})[number] = mutant
    return files


def _words(selection):
    return [f"tests/{word}" if word.endswith(".py") else word for word in shlex.split(selection)]


def _wait(child):
    """How a process ends: 0 is well, and in time."""
    end = time.monotonic() + STILL
    while time.monotonic() < end:
        done, status = os.waitpid(child, os.WNOHANG)
        if done:
            return os.waitstatus_to_exitcode(status)
        time.sleep(0.02)
    os.killpg(child, signal.SIGKILL)
    return os.waitstatus_to_exitcode(os.waitpid(child, 0)[1])


@contextlib.contextmanager
def _quiet():
    """Without what compilers say."""
    kept, nowhere = os.dup(2), os.open(os.devnull, os.O_WRONLY)
    os.dup2(nowhere, 2)
    try:
        yield
    finally:
        os.dup2(kept, 2)
        os.close(kept)
        os.close(nowhere)


def _remembering(function):
    found = {}

    def remembered(table, *more):
        key = table.site.tobytes(), repr(table.links), *(id(x) if not isinstance(x, int | tuple) else x for x in more)
        if key not in found:
            found[key] = function(table, *more)
        return found[key]
    return remembered


def _found(name):
    import passes
    return [(s.name, s.site.tobytes(), s.link.tobytes(), s.name == "see through" and s.through.tobytes())
            for s in passes.case(name).every]


def _where_changed(compare, before):
    """compare(), which is cached, asked anew of cases alone in which the library finds something else than before."""
    @functools.cache
    def compared(name):
        return compare(name) if _found(name) == before[name] else compare.__wrapped__(name)
    return compared
