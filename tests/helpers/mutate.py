# SPDX-License-Identifier: GPL-3.0-or-later
"""Changes constants of csrc, one at a time, and looks whether a test notices: make mutate.

    python tests/helpers/mutate.py [--seed N] [--count N] [--only FILE[:LINE]]... [--all] [--floats] [--part K/N]
    python tests/helpers/mutate.py --python

In a copy of the tree a float grows or shrinks by a fifth and a whole number by one. One library is built with all
changes in it, each behind a switch (`mutant_now == 7 ? 1.2f : 1.0f`), and the nearest tests run once for each, the
likeliest to notice first. What survives is listed in mutants.txt with the reason why no test can tell, or wants a test.
Constants are drawn from all files, those of FINE twice as likely."""

import argparse
import contextlib
import ctypes
import functools
import os
import random
import re
import resource
import shutil
import signal
import subprocess
import sys
import tempfile
import time
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import mutants

HERE = Path(__file__).resolve()
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

# The nearest tests of a file or folder: the first that fits; one after another, the likeliest to notice first.
TESTS = (
    ("csrc/fine/find/", "fine/test_fine_sites.py", "fine/test_fine_ink.py"),
    ("csrc/fine/gather.c", "fine/test_bound.py", "fine/test_fine_sites.py", "fine/test_fine_passes.py"),
    ("csrc/fine/sites.c", "fine/test_fine_sites.py", "fine/test_bound.py", "fine/test_fine_passes.py"),
    ("csrc/fine/near.h", "fine/test_fine_passes.py", "fine/test_bound.py", "fine/test_fine_sites.py"),
    ("csrc/fine/fine.", "fine/test_fine_sites.py", "fine/test_bound.py", "fine/test_fine_passes.py"),
    ("csrc/fine/", "fine/test_fine_passes.py", "fine/test_fine_sites.py", "fine/test_fine_ink.py"),
    ("csrc/edges/", "stages/test_edges.py", "fine/test_fine_sites.py"),
    *((f"csrc/ink/{name}.", "fine/test_fine_ink.py", "fine/test_fine.py -k 'not calm and not still'")
      for name in ("capsules", "hands", "kinds", "noise", "pen", "reached", "thickets", "tips", "turns", "widths")),
    ("csrc/ink/nearest.c", "stages/test_lines.py -k 'nearest or sizes'", "stages/test_surface.py -k smudg",
     "fine/test_fine_ink.py"),
    ("csrc/ink/", "stages/test_lines.py", "fine/test_fine_ink.py"),
    ("csrc/surface/paper", "stages/test_paper.py", "stages/test_surface.py"),
    *((f"csrc/surface/{name}", f"stages/test_{test}.py")
      for name, test in (("ball", "example"), ("example", "example"), ("rim", "rim"), ("wash", "wash"))),
    ("csrc/surface/", "stages/test_surface.py", "stages/test_paper.py"),
    ("csrc/tones/", "stages/test_tones.py -k twin", "stages/test_tones.py -k 'not twin and not ink'",
     "stages/test_tones.py -k 'ink and not twin'"),
    ("csrc/raster/be", "fine/test_bevels.py", "fine/test_creases.py"),  # bends, bevels
    ("csrc/raster/meets", "fine/test_meets.py", "fine/test_creases.py"),
    ("csrc/raster/pieces", "fine/test_meets.py", "fine/test_creases.py"),
    ("csrc/raster/geometry", "stages/test_raster.py stages/test_raster_input.py", "unit/test_limits.py",
     "fine/test_creases.py"),
    ("csrc/raster/", "stages/test_raster.py stages/test_raster_input.py", "fine/test_creases.py", "fine/test_marks.py",
     "fine/test_meets.py"),
    ("csrc/texture/", "stages/test_bake.py -k 'not size4'"),
    ("csrc/base/metric.", "unit/test_metric.py", "stages/test_edges.py"),
    ("csrc/base/pixel.h", "unit/test_metric.py", "stages/test_surface.py"),
    ("csrc/base/layers", "unit/test_limits.py", "unit/test_layers.py unit/test_house.py"),
    ("csrc/base/params", "unit/test_layers.py unit/test_house.py", "stages/test_surface.py"),
    ("csrc/light/", "stages/test_shadows.py", "stages/test_light.py", "stages/test_light_edges.py"),
    ("csrc/material/", "stages/test_material.py"),
    ("csrc/api/check", "unit/test_boundary.py unit/test_limits.py unit/test_program_limits.py",
     "stages/test_light.py -k refused"),
    ("csrc/api/images", "unit/test_boundary.py unit/test_limits.py"),
    ("csrc/api/background", "unit/test_background.py"),
    ("csrc/api/encre", "unit/test_limits.py", "unit/test_memory.py", "unit/test_layers.py"),
    ("csrc/", "unit/test_layers.py", "unit/test_memory.py", "stages/test_edges.py -k sizes", "stages/test_surface.py"),
)

TWINS = ("csrc/fine/", "csrc/edges/")  # their tests ask twins that take their time


# Lines of Python that once could go wrong unseen: what stands there, what it becomes, who should notice.
PYTHON = (
    ("addon/blender/subframes.py", "_SEED_STEP = 1013904223", "_SEED_STEP = 0", "blender/test_supersample.py -k noise"),
    ("addon/pen/colour.py", "< 1 / 128", "< 0", "unit/test_colour.py"),
    ("addon/blender/meshes.py", "if instance.is_instance and not group:", "if instance.is_instance:",
     "blender/test_details.py"),
    ("addon/pen/supersample.py", "in reversed(range(factor))", "in range(factor)",
     "blender/test_supersample.py -k marks"),
    ("addon/blender/frame.py", 'render.threads if render.threads_mode == "FIXED" else 0', "0",
     "blender/test_details.py"),
    ("addon/pen/params.py", "return not true(term[1:])", "return true(term[1:])", "blender/test_details.py"),
    ("addon/blender/panels/presets.py", 'bl_options = {"REGISTER", "UNDO"}', 'bl_options = {"REGISTER"}',
     "blender/test_details.py"),
    ("addon/pen/unwrap.py", "weight = np.repeat(area, 3)", "weight = np.ones(3 * len(area))",
     "unit/test_unwrap.py -k corner"),
    ("addon/blender/painting.py", "if value else _GREY", "", "blender/test_paint.py"),
)


def tests_of(path):
    return next(tests for prefix, *tests in TESTS if path.startswith(prefix))


# In the copy


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
            return pytest.main(["-x", "-q", "-p", "no:cacheprovider", "-p", "no:randomly", "-m", "not long",
                                *arguments])

    def fails(self, number, selections):
        """The tests that notice the mutant of this number, or None."""
        for selection in selections:
            ended = self._ended(number, selection)
            if ended == STALE:
                raise SystemExit(f"mutate: {self.probe.name} is not the library that was changed")
            if ended == -signal.SIGKILL and self._unchanged(selection):
                raise SystemExit(f"mutate: {selection} takes more than {LIMIT} s, or fails, though nothing is changed; "
                                 "make two rows of it in TESTS")
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

    def run(self, chosen):
        """(mutant, the tests that notice it or None or "does not compile", seconds) for each: one library holds all
        that may change while it runs; what a compiler must know, sizes and tables, is built alone."""
        numbers = dict(enumerate(chosen, 1))
        together = self._switchable(numbers)
        with self._changed({path: mutants.switched(self._text(path), own) for path, own in by_file(together).items()}):
            self.build()
            for number, mutant in together.items():
                yield self._timed(number, mutant)
        for number, mutant in numbers.items():
            if number not in together:
                with self._changed({mutant.path: mutants.alone(self._text(mutant.path), mutant)}):
                    try:
                        with _quiet():
                            self.build()
                    except subprocess.CalledProcessError:
                        yield mutant, "does not compile", 0
                        continue
                    yield self._timed(number, mutant)

    def _timed(self, number, mutant):
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
    import shlex
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


def python(root):
    alive = 0
    with tempfile.TemporaryDirectory(prefix="encre-mutate-") as folder:
        tree = Path(folder).resolve()
        copy(root, tree)
        own = Copy(tree)
        own.warm(False)
        for change in PYTHON:
            by = own.run_python(change)
            alive += by is None
            word = "noticed " if by else "SURVIVES"
            print(f"{word}  {change[0]}: {change[1]} -> {change[2] or 'nothing'}", flush=True)
    return 1 if alive else 0


def main(arguments=None):
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--seed", type=int, default=None, help="of the sample; another each time")
    parser.add_argument("--count", type=int, default=200)
    parser.add_argument("--only", action="append", help="files whose name begins so, as csrc/fine/find, or FILE:LINE")
    parser.add_argument("--python", action="store_true", help="the lines of PYTHON, not constants of C")
    parser.add_argument("--all", action="store_true", help="every change of every constant")
    parser.add_argument("--floats", action="store_true", help="no whole numbers")
    parser.add_argument("--part", default="1/1", help="of the sample, by files: 2/3 is the second of three")
    args = parser.parse_args(arguments)
    seed = args.seed if args.seed is not None else random.SystemRandom().randrange(10**6)
    root = HERE.parents[2]
    if args.python:
        return python(root)
    only = tuple(args.only or ("",))
    every = {path: [m for m in found if ("." in m.old + m.new or not args.floats)
                    and (path.startswith(only) or f"{path}:{m.line}" in only)]
             for path, found in mutants.every_mutant(root).items()}
    if not any(every.values()):
        raise SystemExit(f"mutate: no file of csrc begins with {' or '.join(only)}; give a path as csrc/fine/sites.c")
    chosen = mutants.draw(every, args.count, random.Random(seed))
    if args.all:
        chosen = [mutant for found in every.values() for mutant in found]
    k, parts = map(int, args.part.split("/"))
    chosen.sort(key=lambda mutant: (mutant.path.startswith(TWINS), mutant.path))
    chosen = chosen[len(chosen) * (k - 1) // parts:len(chosen) * k // parts]
    print(f"mutate: seed {seed}, {len(chosen)} changes", flush=True)
    listed, survived = mutants.known(), []
    equal = [mutant for mutant in chosen if mutant.names & listed]
    with tempfile.TemporaryDirectory(prefix="encre-mutate-") as folder:
        tree = Path(folder).resolve()
        copy(root, tree)
        own = Copy(tree)
        own.warm(any(m.path.startswith(TWINS) for m in chosen),
                 any(m.path.startswith("csrc/light/") for m in chosen))
        for mutant, by, took in own.run([m for m in chosen if m not in equal]):
            if by is None:
                survived.append(mutant)
            print(f"{'SURVIVES' if by is None else 'noticed ':8} {took:5.1f} s  {mutant}{f'   [{by}]' if by else ''}",
                  flush=True)
    tried = len(chosen) - len(equal)
    print(f"mutate: seed {seed}: {tried - len(survived)} noticed, {len(survived)} survived: "
          f"{100 * len(survived) / max(1, tried):.1f} % of {tried}; besides, {len(equal)} are known to change nothing")
    for mutant in survived:
        print(f"    {mutant}")
    return 1 if survived and (len(survived) > 0.05 * tried or tried < 20) else 0


if __name__ == "__main__":
    sys.exit(main())
