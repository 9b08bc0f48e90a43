# SPDX-License-Identifier: GPL-3.0-or-later
"""Builds the wheel and the extension for every platform, from Linux, and looks at what came out.

    python tools/wheels.py [PLATFORM...]      build/wheels/

The compiler is clang as the package ziglang brings it, with the C libraries of all platforms. What is looked at: that
the wheel needs no newer Linux than its name says (auditwheel), that libraries are of their format and show our names
alone. That they draw what Linux draws, and which of them could be run, docs/downloads.md tells.
"""

import os
import re
import runpy
import shutil
import subprocess
import sys
import tempfile
import zipfile
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
OUT = ROOT / "build" / "wheels"
SETUP = runpy.run_path(str(ROOT / "setup.py"), run_name="wheels")
# How libraries begin.
MAGIC = {".so": b"\x7fELF", ".dylib": b"\xcf\xfa\xed\xfe", ".dll": b"MZ"}


def run(*command, **environment):
    done = subprocess.run([str(part) for part in command], cwd=ROOT, capture_output=True, text=True,
                          env={**os.environ, **environment})
    if done.returncode:
        raise SystemExit(f"wheels: {' '.join(map(str, command))} failed:\n{done.stdout}{done.stderr}")
    return done.stdout


def build(platform):
    """(wheel, extension) of a platform."""
    with tempfile.TemporaryDirectory() as folder:
        run(sys.executable, "setup.py", "-q", "bdist_wheel", f"--dist-dir={folder}", ENCRE_PLATFORM=platform)
        [wheel] = Path(folder).glob("*.whl")
        wheel = Path(shutil.move(wheel, OUT / wheel.name))
    said = run(sys.executable, "setup.py", "-q", "extension", f"--wheel={wheel}", ENCRE_PLATFORM=platform)
    extension = ROOT / said.split()[-1]
    return wheel, Path(shutil.move(extension, OUT / extension.name))


def shown(library):
    """The functions that a library shows to others."""
    if library.suffix == ".dll":
        table = run("objdump", "-p", library).partition("[Ordinal/Name Pointer] Table")[2].partition("\n\n")[0]
        return set(re.findall(r"(\S+)$", table.strip(), re.MULTILINE))
    if library.suffix == ".so":
        said = run("nm", "-D", "--defined-only", library)
    else:
        said = run(next(filter(shutil.which, ("llvm-nm", "llvm-nm-14")), "llvm-nm"), "-g", "--defined-only", library)
    return set(re.findall(r" T _?(\S+)$", said, re.MULTILINE))


def look(wheel, platform):
    """Ends with a sentence if the wheel is not what its name says."""
    name, _, tag = SETUP["PLATFORMS"][platform]
    with tempfile.TemporaryDirectory() as folder, zipfile.ZipFile(wheel) as held:
        library = Path(held.extract(f"encre/{name}", folder))
        with open(library, "rb") as file:
            head = file.read(len(MAGIC[library.suffix]))
        if head != MAGIC[library.suffix]:
            raise SystemExit(f"wheels: {name} in {wheel.name} is no library of {platform}")
        header = (ROOT / "csrc" / "encre.h").read_text(encoding="utf-8")
        if wrong := shown(library) ^ set(re.findall(r"^ENCRE_API .*?(encre_\w+)\(", header, re.MULTILINE)):
            raise SystemExit(f"wheels: {name} in {wheel.name} lacks, or should not show, {', '.join(sorted(wrong))}")
    if tag.startswith("manylinux"):
        said = " ".join(run(sys.executable, "-m", "auditwheel", "show", wheel).split())
        found = re.search(r'platform tag: "manylinux_2_(\d+)_', said)
        if not found or int(found[1]) > int(tag.split("_")[2]):
            raise SystemExit(f"wheels: {wheel.name} needs a newer Linux than its name says: {said}")


def main(platforms):
    OUT.mkdir(parents=True, exist_ok=True)
    for platform in platforms or SETUP["PLATFORMS"]:
        wheel, extension = build(platform)
        look(wheel, platform)
        print(wheel.relative_to(ROOT), extension.relative_to(ROOT), sep="\n", flush=True)


if __name__ == "__main__":
    main(sys.argv[1:])
