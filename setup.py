# SPDX-License-Identifier: GPL-3.0-or-later
"""Builds csrc/ into one plain shared library inside the package.

    python setup.py build_ext --inplace [--debug] [--werror] [--scalar] [--sanitize=address,undefined]

    python setup.py extension [--wheel=FILE]       build/encre-VERSION-PLATFORM.zip, what Blender 4.2 and later installs
    python setup.py addon [--wheel=FILE]           build/encre-VERSION-PLATFORM-addon.zip, for Blender 3.4 to 4.1

CC chooses the compiler. --debug also checks what must hold between the passes of FINE, and aborts where it does not.
--scalar builds without vectorisation and without the second instruction set: results are the same bytes, and the test
suite holds them to it. --sanitize=memory needs clang; with `address` the gaps between blocks of a frame's memory are
guarded, too. The library has no Python ABI, so the wheel is tagged py3-none. ENCRE_PLATFORM builds for another platform
than this one, with the compiler of the package ziglang (tools/wheels.py).
"""

import base64
import hashlib
import json
import os
import platform
import shlex
import shutil
import subprocess
import sys
import zipfile
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

from setuptools import Command, Extension, setup
from setuptools.command.bdist_wheel import bdist_wheel
from setuptools.command.build_ext import build_ext

# By Blender's names for them: the file, and for other machines than this one the compiler's target and the wheel's tag.
PLATFORMS = {
    "linux-x64": ("libencre.so", "x86_64-linux-gnu.2.28", "manylinux_2_28_x86_64"),
    "linux-arm64": ("libencre.so", "aarch64-linux-gnu.2.28", "manylinux_2_28_aarch64"),
    "macos-x64": ("libencre.dylib", "x86_64-macos.11.0", "macosx_11_0_x86_64"),
    "macos-arm64": ("libencre.dylib", "aarch64-macos.11.0", "macosx_11_0_arm64"),
    "windows-x64": ("libencre.dll", "x86_64-windows-gnu", "win_amd64"),
}
OTHER = os.environ.get("ENCRE_PLATFORM", "")
SYSTEM = {"darwin": "macos", "win32": "windows"}.get(sys.platform, "linux")
CPU = {"x86_64": "x64", "AMD64": "x64", "aarch64": "arm64"}.get(platform.machine(), platform.machine())
PLATFORM = OTHER or f"{SYSTEM}-{CPU}"
NAME, TARGET, TAG = PLATFORMS.get(PLATFORM, ("libencre.so", "", ""))
# A file that names anything with these is compiled once per instruction set (csrc/base/stage.h), any other once.
KERNELS = ("ISA(", "STAGE_SYMBOL(")
# No option that lets the compiler change a result: every build gives the same bits.
FLAGS = shlex.split("-std=c11 -Icsrc -D_POSIX_C_SOURCE=200809L -fPIC -fvisibility=hidden -pthread "
                    "-Wall -Wextra -Wpedantic -fno-math-errno -fno-trapping-math -ffp-contract=off")


def commands(out, build, *, debug=False, werror=False, scalar=False, sanitize=""):
    """Compiler commands for the objects in `build` and then for the library `out`."""
    cc = shlex.split(os.environ.get("CC", "cc"))
    if OTHER:
        cc = [sys.executable, "-m", "ziglang", "cc", "-target", TARGET]
    flags = FLAGS + (["-D_DARWIN_C_SOURCE"] if PLATFORM.startswith("macos") else [])  # it hides sysconf()'s names
    flags += ["-O1", "-g"] if debug or sanitize else ["-O1", "-fno-tree-vectorize"] if scalar else ["-O3"]
    flags += ["-DENCRE_DEBUG"] if debug else []
    flags += ["-Werror"] if werror else []
    flags += [f"-fsanitize={sanitize}", "-fno-sanitize-recover=all"] if sanitize else []
    flags += shlex.split(os.environ.get("CFLAGS", ""))  # last: what is asked for counts
    variants = {"base": []}
    if PLATFORM.endswith("-x64") and not scalar:
        variants["v3"] = ["-march=x86_64_v3" if OTHER else "-march=x86-64-v3"]
        flags.append("-DENCRE_HAVE_V3")
    compile_, objects = [], []
    for source in sorted(Path("csrc").rglob("*.c")):
        kernels = any(name in source.read_text(encoding="utf-8") for name in KERNELS)
        for isa, march in variants.items():
            if isa != "base" and not kernels:
                continue
            objects.append(str(build / f"{source.stem}-{isa}.o"))
            compile_.append([*cc, *flags, *march, f"-DENCRE_ISA={isa}", "-c", str(source), "-o", objects[-1]])
    if PLATFORM.startswith("linux") and not sanitize:
        flags.append("-Wl,--no-undefined")
    if PLATFORM.startswith("macos"):
        flags.append(f"-Wl,-install_name,@rpath/{NAME}")  # or it has the path of the build
    if OTHER:
        flags.append("-Wl,-s")  # no debug data
    link = [*cc, *flags, "-shared", *objects, "-o", str(out), *shlex.split(os.environ.get("LDFLAGS", "")), "-lm"]
    return compile_, link


def _compile(command):
    """The compiler's exit status. What was compiled by the same command from files that are older is left as it is."""
    made = Path(command[-1])
    by, of = made.with_suffix(".cmd"), made.with_suffix(".d")
    told = "\0".join(command)
    try:
        sources = of.read_text(encoding="utf-8").replace("\\\n", " ").split(": ", 1)[1].split()
        if by.read_text(encoding="utf-8") == told and made.stat().st_mtime_ns > max(
                os.stat(name).st_mtime_ns for name in sources):
            return 0
    except (OSError, IndexError):
        pass
    by.unlink(missing_ok=True)
    status = subprocess.call([*command, "-MD", "-MF", str(of)])
    if not status:
        by.write_text(told, encoding="utf-8")
    return status


class BuildLibrary(build_ext):
    user_options = build_ext.user_options + [
        ("werror", None, "make warnings errors"),
        ("scalar", None, "build without vectorisation"),
        ("sanitize=", None, "sanitizers, separated by commas"),
    ]
    boolean_options = build_ext.boolean_options + ["werror", "scalar"]

    def initialize_options(self):
        super().initialize_options()
        self.werror, self.scalar, self.sanitize = False, False, ""

    def get_ext_filename(self, fullname):
        return os.path.join(*fullname.split(".")[:-1], NAME)

    def build_extension(self, ext):
        out = Path(self.get_ext_fullpath(ext.name))
        variant = "-".join(filter(None, [OTHER, "debug" * bool(self.debug), "scalar" * bool(self.scalar),
                                         self.sanitize]))
        build = Path(self.build_temp, variant.replace(",", "-") or "release")
        build.mkdir(parents=True, exist_ok=True)
        out.parent.mkdir(parents=True, exist_ok=True)
        part = out.with_name(out.name + ".part")
        compile_, link = commands(part, build, debug=self.debug, werror=self.werror, scalar=self.scalar,
                                  sanitize=self.sanitize)
        with ThreadPoolExecutor(os.cpu_count()) as pool:
            failed = any(list(pool.map(_compile, compile_))) or subprocess.call(link)
        if failed:
            raise SystemExit("encre: the C library does not compile; read the compiler's messages above")
        os.replace(part, out)  # a running program keeps the old file


class Wheel(bdist_wheel):
    def get_tag(self):
        return "py3", "none", TAG if OTHER else super().get_tag()[2]

    def run(self):
        # What earlier builds left there would be packed too: modules that have moved since, libraries of others.
        shutil.rmtree(self.get_finalized_command("build").build_lib, ignore_errors=True)
        super().run()


class _Zip(Command):
    """A zip that a Blender installs, of what a wheel holds."""

    user_options = [("wheel=", None, "the wheel to take all from, instead of one built now")]

    def initialize_options(self):
        self.wheel = None

    def finalize_options(self):
        pass

    def run(self):
        if not self.wheel:
            self.run_command("bdist_wheel")
            self.wheel = self.distribution.dist_files[-1][2]
        _, version, tag = Path(self.wheel).stem.split("-", 2)
        os.makedirs("build", exist_ok=True)
        out = Path("build", f"encre-{version}-{PLATFORM}{self.ending}.zip")
        with zipfile.ZipFile(self.wheel) as held, zipfile.ZipFile(out, "w", zipfile.ZIP_DEFLATED) as file:
            self.pack(held, file, version, tag)
        print(out)

    def python(self, held):
        """(name in the package, contents) of all but the command line, the library and the manifest."""
        for name in held.namelist():
            inner = name.removeprefix("encre/")
            if not (inner == name or inner in (NAME, "__main__.py", "blender_manifest.toml")
                    or inner.startswith("cli/")):
                yield inner, held.read(name)


class ExtensionZip(_Zip):
    """What Blender 4.2 and later installs: the Python without the command line, and a wheel that holds the library.

    So Blender runs the Python under the extension's own name, and forgets it when it is updated. It never forgets a
    library, and a loader takes another file of the same name for the one that it has: this name tells the build."""

    ending = ""

    def pack(self, held, file, version, tag):
        library = held.read(f"encre/{NAME}")
        build = f"{version}+{hashlib.sha256(library).hexdigest()[:8]}"
        wheel = f"wheels/encre_library-{build}-{tag}.whl"
        head = f'version = "{version}"\nplatforms = ["{PLATFORM}"]\nwheels = ["./{wheel}"]\n'
        if website := os.environ.get("ENCRE_WEBSITE"):  # of whoever publishes it: its pages, where faults are told too
            head += f"website = {json.dumps(website)}\n"
        file.writestr("blender_manifest.toml", head + held.read("encre/blender_manifest.toml").decode())
        for name, data in self.python(held):
            file.writestr(name, data)
        file.write("LICENSE")
        with file.open(wheel, "w") as inside:
            library_wheel(inside, build, tag, library)


class AddonZip(_Zip):
    """What Blender 3.4 to 4.1 installs: one folder with the Python, without the command line, and the library."""

    ending = "-addon"

    def pack(self, held, file, version, tag):
        for name, data in self.python(held):
            file.writestr(f"encre/{name}", data)
        file.writestr(f"encre/{NAME}", held.read(f"encre/{NAME}"))
        file.write("LICENSE", "encre/LICENSE")


def library_wheel(file, build, tag, library):
    """Writes a wheel that puts the library where Python looks for modules."""
    stem, ending = os.path.splitext(NAME)
    info = f"encre_library-{build}.dist-info"
    members = {
        f"{stem}-{build}{ending}": library,
        f"{info}/METADATA": f"Metadata-Version: 2.1\nName: encre-library\nVersion: {build}\n".encode(),
        f"{info}/WHEEL": f"Wheel-Version: 1.0\nGenerator: encre\nRoot-Is-Purelib: false\nTag: {tag}\n".encode(),
    }
    rows = [f"{name},sha256={base64.urlsafe_b64encode(hashlib.sha256(data).digest()).decode().rstrip('=')},{len(data)}"
            for name, data in members.items()]
    members[f"{info}/RECORD"] = "\n".join([*rows, f"{info}/RECORD,,", ""]).encode()
    with zipfile.ZipFile(file, "w", zipfile.ZIP_DEFLATED) as wheel:
        for name, data in members.items():
            wheel.writestr(name, data)


if __name__ == "__main__":  # tests take commands() from here
    setup(
        ext_modules=[Extension("encre.libencre", [])],
        cmdclass={"build_ext": BuildLibrary, "bdist_wheel": Wheel, "extension": ExtensionZip, "addon": AddonZip},
    )
