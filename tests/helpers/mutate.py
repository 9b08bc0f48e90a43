# SPDX-License-Identifier: GPL-3.0-or-later
"""Changes constants of csrc, one at a time, and looks whether a test notices: make mutate.

    python tests/helpers/mutate.py [--seed N] [--count N] [--only FILE] [--all] [--floats] [--part K/N] | --python

In a copy of the tree a float grows or shrinks by a fifth and a whole number by one; what it is part of is compiled
again, and the nearest tests run, the likeliest to notice first. What survives is listed in mutants.txt with the reason
why no test can tell, or wants a test. Constants are drawn from all files, those of FINE twice as likely."""

import argparse
import contextlib
import functools
import os
import random
import resource
import shutil
import signal
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import mutants

HERE = Path(__file__).resolve()
# Memory that is never set holds a pattern, and an index beyond an array ends the process: both are noticed at once.
SEEN = ("-fsanitize=bounds -fsanitize-undefined-trap-on-error -ftrivial-auto-var-init=pattern -U_FORTIFY_SOURCE "
        "-D_FORTIFY_SOURCE=2")
LIMIT, STILL = 40, 1200  # seconds that a mutant's tests may compute, and may take: what hangs is noticed

# The nearest tests of a file or folder: the first that fits; one after another, the likeliest to notice first.
TESTS = (
    ("csrc/fine/find/", "fine/test_fine_sites.py", "fine/test_fine_ink.py"),
    ("csrc/fine/gather.c", "fine/test_bound.py", "fine/test_fine_sites.py", "fine/test_fine_passes.py"),
    ("csrc/fine/sites.c", "fine/test_fine_sites.py", "fine/test_bound.py", "fine/test_fine_passes.py"),
    ("csrc/fine/fine.", "fine/test_fine_sites.py", "fine/test_bound.py", "fine/test_fine_passes.py"),
    ("csrc/fine/", "fine/test_fine_passes.py", "fine/test_fine_sites.py", "fine/test_fine_ink.py"),
    ("csrc/edges/", "stages/test_edges.py", "fine/test_fine_sites.py"),
    *((f"csrc/ink/{name}.", "fine/test_fine_ink.py", "fine/test_fine.py -k 'not calm and not still'")
      for name in ("capsules", "tips", "pen", "kinds")),
    ("csrc/ink/nearest.c", "stages/test_lines.py -k 'nearest or sizes'", "stages/test_surface.py -k smudg",
     "fine/test_fine_ink.py"),
    ("csrc/ink/", "stages/test_lines.py", "fine/test_fine_ink.py"),
    ("csrc/surface/", "stages/test_surface.py"),
    ("csrc/tones/", "stages/test_tones.py"),
    ("csrc/raster/bevels", "fine/test_bevels.py"),
    ("csrc/raster/meets", "fine/test_meets.py"),
    ("csrc/raster/pieces", "fine/test_meets.py"),
    ("csrc/raster/", "stages/test_raster.py stages/test_raster_input.py", "fine/test_creases.py", "fine/test_marks.py",
     "fine/test_meets.py"),
    ("csrc/texture/", "stages/test_bake.py -k 'not size4'"),
    ("csrc/base/metric", "unit/test_metric.py"),
    ("csrc/base/pixel.h", "unit/test_metric.py", "stages/test_surface.py"),
    ("csrc/base/params", "unit/test_layers.py unit/test_house.py"),
    ("csrc/light/", "stages/test_shadows.py", "stages/test_light.py", "stages/test_light_edges.py"),
    ("csrc/material/", "stages/test_material.py"),
    ("csrc/api/check", "unit/test_boundary.py", "stages/test_light.py -k refused"),
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

    def build(self, name):
        """Whether it compiles: the library and the one with probes."""
        self.built.probe_fine(name)
        link, _ = self.built.objects(self.tree / "addon" / "libencre.so.part")
        subprocess.run(link, check=True)
        os.replace("addon/libencre.so.part", "addon/libencre.so")

    def warm(self, fine, light=False):
        self.build("probe_0")
        import numpy  # noqa: F401
        import pytest  # noqa: F401
        from encre.pen import library

        # What a process has loaded its children have, though another file takes its place: here another is loaded.
        self._own, library._path = library._path, lambda: str(self.built.BUILD / "probe_0.so")
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
        passes.library = functools.cache(lambda: passes.load("probe_0"))
        if self._pytest(["tests/fine/test_fine_sites.py", "tests/fine/test_fine_passes.py"]):
            raise SystemExit("mutate: the twins fail before anything is changed")

    def _pytest(self, arguments):
        import pytest
        with open(os.devnull, "w") as nowhere, contextlib.redirect_stdout(nowhere), contextlib.redirect_stderr(nowhere):
            return pytest.main(["-x", "-q", "-p", "no:cacheprovider", "-p", "no:randomly", "-m", "not long",
                                *arguments])

    def fails(self, selections):
        """The tests that notice, or None."""
        for selection in selections:
            child = os.fork()
            if child == 0:
                os.setsid()
                resource.setrlimit(resource.RLIMIT_CPU, (LIMIT, LIMIT))
                code = 1
                try:
                    code = self._noticed(selection)
                finally:
                    os._exit(code)
            if not _wait(child):
                return selection
        return None

    def _noticed(self, selection):
        from encre.pen import library
        library._path = self._own
        library.load.cache_clear()
        if "passes" in sys.modules:
            import passes
            passes.case.cache_clear()
            passes.library = functools.cache(lambda: passes.load(f"probe_{self.runs}"))
            for name in [name for name in sys.modules if "test_fine" in name]:  # they remember what they compared
                del sys.modules[name]
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

    def run(self, mutant):
        """The tests that notice it, "does not compile", or None."""
        path = self.tree / mutant.path
        was = path.read_text(encoding="utf-8")
        lines = was.split("\n")
        line = lines[mutant.line - 1]
        assert line[mutant.column:].startswith(mutant.old)
        lines[mutant.line - 1] = line[:mutant.column] + mutant.new + line[mutant.column + len(mutant.old):]
        self.runs += 1
        stamp, kept = path.stat(), self.built.BUILD.with_name("kept")
        kept.mkdir(exist_ok=True)
        for made in self.built.BUILD.glob("*.o"):
            shutil.copy2(made, kept / made.name)
        try:
            path.write_text("\n".join(lines), encoding="utf-8")
            try:
                os.environ["CFLAGS"] = SEEN
                with _quiet():
                    self.build(f"probe_{self.runs}")
            except subprocess.CalledProcessError:
                return "does not compile"
            return self.fails(tests_of(mutant.path))
        finally:
            os.environ["CFLAGS"] = ""
            path.write_text(was, encoding="utf-8")
            os.utime(path, ns=(stamp.st_atime_ns, stamp.st_mtime_ns))
            for made in kept.glob("*.o"):
                os.replace(made, self.built.BUILD / made.name)
            (self.built.BUILD / f"probe_{self.runs}.so").unlink(missing_ok=True)


def _words(selection):
    import shlex
    return [f"tests/{word}" if word.endswith(".py") else word for word in shlex.split(selection)]


def _wait(child):
    """Whether a process ends well in time."""
    end = time.monotonic() + STILL
    while time.monotonic() < end:
        done, status = os.waitpid(child, os.WNOHANG)
        if done:
            return status == 0
        time.sleep(0.02)
    os.killpg(child, signal.SIGKILL)
    os.waitpid(child, 0)
    return False


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
    parser.add_argument("--only", default="", help="files whose name begins so, as csrc/fine/find")
    parser.add_argument("--python", action="store_true", help="the lines of PYTHON, not constants of C")
    parser.add_argument("--all", action="store_true", help="every change of every constant")
    parser.add_argument("--floats", action="store_true", help="no whole numbers")
    parser.add_argument("--line", type=int, default=0, help="of the file that --only names")
    parser.add_argument("--part", default="1/1", help="of the sample, by files: 2/3 is the second of three")
    args = parser.parse_args(arguments)
    seed = args.seed if args.seed is not None else random.SystemRandom().randrange(10**6)
    root = HERE.parents[2]
    if args.python:
        return python(root)
    every = {path: [m for m in found if "." in m.old + m.new or not args.floats]
             for path, found in mutants.every_mutant(root).items() if path.startswith(args.only)}
    if not every:
        raise SystemExit(f"mutate: no file of csrc begins with {args.only!r}; give a path as csrc/fine/sites.c")
    chosen = mutants.draw(every, args.count, random.Random(seed))
    if args.all:
        chosen = [mutant for found in every.values() for mutant in found]
    if args.line:
        chosen = [mutant for mutant in chosen if mutant.line == args.line]
    k, parts = map(int, args.part.split("/"))
    chosen.sort(key=lambda mutant: (mutant.path.startswith(TWINS), mutant.path))
    chosen = chosen[len(chosen) * (k - 1) // parts:len(chosen) * k // parts]
    print(f"mutate: seed {seed}, {len(chosen)} changes", flush=True)
    listed, survived, equal = mutants.known(), [], []
    with tempfile.TemporaryDirectory(prefix="encre-mutate-") as folder:
        tree = Path(folder).resolve()
        copy(root, tree)
        own = Copy(tree)
        own.warm(any(m.path.startswith(TWINS) for m in chosen),
                 any(m.path.startswith("csrc/light/") for m in chosen))
        for mutant in chosen:
            if (mutant.path, mutant.text, mutant.old, mutant.new) in listed:
                equal.append(mutant)
                continue
            start = time.monotonic()
            by = own.run(mutant)
            if by is None:
                survived.append(mutant)
            print(f"{'SURVIVES' if by is None else 'noticed ':8} {time.monotonic() - start:5.1f} s  {mutant}"
                  f"{f'   [{by}]' if by else ''}", flush=True)
    tried = len(chosen) - len(equal)
    print(f"mutate: seed {seed}: {tried - len(survived)} noticed, {len(survived)} survived: "
          f"{100 * len(survived) / max(1, tried):.1f} % of {tried}; besides, {len(equal)} are known to change nothing")
    for mutant in survived:
        print(f"    {mutant}")
    return 1 if survived and (len(survived) > 0.05 * tried or tried < 20) else 0


if __name__ == "__main__":
    sys.exit(main())
