# SPDX-License-Identifier: GPL-3.0-or-later
"""Builds all that is downloaded, for every platform, from Linux, and looks at what came out.

    python tools/wheels.py [PLATFORM...]      build/release/

Wheel, extension and add-on, index.json, by which Blender takes the folder for a repository of extensions, and
SHA256SUMS. ENCRE_WEBSITE is the address that extensions show.

The compiler is clang as the package ziglang brings it, with the C libraries of all platforms. What is looked at: that
the wheel needs no newer Linux than its name says (auditwheel), that libraries are of their format and show our names
alone. That they draw what Linux draws, and which of them could be run, docs/downloads.md tells.
"""

import hashlib
import json
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
OUT = ROOT / "build" / "release"
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
    """(wheel, extension, add-on for Blenders before 4.2) of a platform."""
    with tempfile.TemporaryDirectory() as folder:
        run(sys.executable, "setup.py", "-q", "bdist_wheel", f"--dist-dir={folder}", ENCRE_PLATFORM=platform)
        [wheel] = Path(folder).glob("*.whl")
        wheel = Path(shutil.move(wheel, OUT / wheel.name))
    made = [wheel]
    for kind in "extension", "addon":
        said = run(sys.executable, "setup.py", "-q", kind, f"--wheel={wheel}", ENCRE_PLATFORM=platform)
        zip_ = ROOT / said.split()[-1]
        made.append(Path(shutil.move(zip_, OUT / zip_.name)))
    return made


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


def index(extensions):
    """What a repository of extensions says of its files, as Blender wants it (its Extensions API, v1)."""
    data = []
    for path in extensions:
        import tomllib  # Python 3.11; all else here does with 3.10

        with zipfile.ZipFile(path) as held:
            manifest = tomllib.loads(held.read("blender_manifest.toml").decode())
        said = {key: value for key, value in manifest.items() if key not in ("wheels", "paths_exclude_pattern")}
        data.append({**said, "archive_url": f"./{path.name}", "archive_size": path.stat().st_size,
                     "archive_hash": "sha256:" + hashlib.sha256(path.read_bytes()).hexdigest()})
    return {"version": "v1", "blocklist": [], "data": data}


def main(platforms):
    shutil.rmtree(OUT, ignore_errors=True)  # of files of another version nothing is to be told
    OUT.mkdir(parents=True)
    made = []
    for platform in platforms or SETUP["PLATFORMS"]:
        built = build(platform)
        look(built[0], platform)
        print(*(path.relative_to(ROOT) for path in built), sep="\n", flush=True)
        made.append(built)
    (OUT / "index.json").write_text(json.dumps(index([extension for _, extension, _ in made]), indent=1) + "\n",
                                    encoding="utf-8")
    sums = [f"{hashlib.sha256(path.read_bytes()).hexdigest()}  {path.name}\n" for path in sorted(OUT.iterdir())]
    (OUT / "SHA256SUMS").write_text("".join(sums), encoding="utf-8")


if __name__ == "__main__":
    main(sys.argv[1:])
