# SPDX-License-Identifier: GPL-3.0-or-later
"""Draws the pictures of docs/: every scene rendered once and restyled with three presets, one with all, and a page.

    python scenes/gallery.py [--size WxH] [--samples N] [--only NAME]... FOLDER [FILE.blend]...

Of a .blend only the shapes and the camera are taken. Frames go to FOLDER as EXR and as PNG in full size; those that are
there and whole are not rendered again. The small pictures go to docs/scenes/, the page is docs/gallery.md, that of
controls goes to docs/painting.md; the presets' own pictures, which Blender's panel shows, lie beside them in
addon/presets/. With --only, all but that scene's stay as they are."""

import argparse
import subprocess
import sys
from pathlib import Path

import numpy as np
import OpenImageIO as oiio
from encre.pen.presets import presets

ROOT = Path(__file__).resolve().parents[1]
SMALL = 640  # pixels wide
MOST = 60_000  # bytes of a small picture
ROW = 3  # pictures of presets beside each other
THUMBNAIL = 128
PRESETS = {"Water Memory": "water_memory", "Inter-color": "inter_color", "Ink only": "ink_only"}
SCENES = {  # name: what is to be seen
    "street": "a girl at a street corner at night",
    "dancer": "a dancer with a fan on a stage",
    "far": "a railway halt with wires and lattice masts",
    "foliage": "a garden gate with a cat, a tree and a hedge",
    "mirrors": "a girl before a mirror, a table with glasses",
    "terrain": "a girl asks for a lift on a desert road",
}
PANELS = {  # drawn by their own settings, for docs/theses.md, too
    "panel_one": "a door by the sea, half in the shade of a canopy",
    "panel_two": "a girl with an umbrella and a cat on a chest, before a striped windbreak",
}
# A .blend that came without its pictures and without a lamp is black on magenta: its shapes are shown in plaster.
LIT = """import bpy
with bpy.data.libraries.load({path!r}) as (there, here):
    here.objects = there.objects
scene = bpy.context.scene
sun = bpy.data.objects.new("Sun", bpy.data.lights.new("Sun", "SUN"))
sun.data.energy, sun.rotation_euler = 3, (0.7, 0.3, 0.6)
for obj in (*here.objects, sun):
    scene.collection.objects.link(obj)
    if obj.type == "MESH":
        obj.data.materials.clear()
scene.camera = next(obj for obj in here.objects if obj.type == "CAMERA")
scene.world = bpy.data.worlds.new("World")
scene.world.color = 0.3, 0.3, 0.4
scene.view_settings.view_transform = "Standard"
"""
SHOWN = "dancer"  # by every preset
CONTROLS = "controls"  # of docs/painting.md
HEAD = """# Gallery

Each scene is rendered once, at {size} with {samples} samples a pixel, and drawn with each preset as it comes; here it
is shown smaller. `make gallery` draws them all. What is good and bad about the hard ones is told in
[scenes.md](scenes.md).

"""
EVERY = """## Every preset

`encre render scenes/{scene}.py --preset NAME --set layer_source=ENCRE`, at {size}: fast layers, without Cycles.
[presets.md](presets.md) tells how to choose, save and share them.

"""


def encre(*args):
    subprocess.run([sys.executable, "-m", "encre", *map(str, args)], check=True)


def resized(picture, width, kernel):
    """An image buffer, so wide, of a picture (height, width, 3)."""
    height = round(width * picture.shape[0] / picture.shape[1])
    full = oiio.ImageBuf(oiio.ImageSpec(picture.shape[1], picture.shape[0], 3, "float"))
    full.set_pixels(full.roi, np.ascontiguousarray(picture, np.float32))
    return oiio.ImageBufAlgo.resize(full, kernel, 0, oiio.ROI(0, width, 0, height, 0, 1, 0, 3))


def shrink(source, target):
    """A JPEG of SMALL pixels' width on white paper, as good as MOST bytes allow.

    Averaged as stored, not in linear light: there a line thinner than a pixel would fade before it is thin."""
    picture = oiio.ImageBuf(str(source)).get_pixels(oiio.FLOAT)
    small = resized(picture[..., :3] * picture[..., 3:] + 1 - picture[..., 3:], SMALL, "blackman-harris")
    for quality in range(88, 40, -4):
        small.specmod()["Compression"] = f"jpeg:{quality}"
        if not small.write(str(target), "uint8"):
            raise SystemExit(small.geterror())
        if target.stat().st_size <= MOST:
            return


def table(what, pictures):
    """Markdown of pictures, a name and a file each, ROW beside each other."""
    rows = []
    for k in range(0, len(pictures), ROW):
        row = pictures[k:k + ROW]
        rows += [[name for name, _ in row], [f"![{what}, {name}](scenes/{file}.jpg)" for name, file in row]]
    lines = [f"| {' | '.join(row + [''] * (ROW - len(row)))} |" for row in rows]
    return "\n".join((lines[0], f"|{'---|' * ROW}", *lines[1:])) + "\n\n"


def by_every_preset(folder, size):
    """The scene that is drawn with each preset, from one frame; its part of the page."""
    frame, pictures = folder / f"{SHOWN}-fast.exr", []
    encre("render", ROOT / "scenes" / f"{SHOWN}.py", "-o", frame, "--size", size, "--preset", "ink_only", "--set",
          "layer_source=ENCRE", "--set", "save_layers=ON", "--set", "save_rest=ON", "--resume")
    for preset in presets():
        picture = f"{SHOWN}-{preset.id.replace('_', '-')}-fast"
        full = folder / f"{picture}.png"
        encre("composite", frame, "-o", full, "--preset", preset.id)
        shrink(full, ROOT / "docs" / "scenes" / f"{picture}.jpg")
        pictures.append((preset.name, picture))
    return EVERY.format(scene=SHOWN, size=size.replace("x", "×")) + table(SCENES[SHOWN], pictures)


def thumbnails(folder):
    """The pictures of all presets: the monkey among the toys, THUMBNAIL pixels wide and high. Widths in pixels are for
    frames of full size."""
    frame, full = folder / "thumbnails.exr", folder / "thumbnails.png"
    encre("render", ROOT / "scenes" / "toys.py", "-o", frame, "--size", "1920x1080", "--samples", 4, "--set",
          "save_rest=ON", "--resume")
    for preset in presets():
        encre("composite", frame, "-o", full, "--preset", preset.id)
        small = resized(oiio.ImageBuf(str(full)).get_pixels(oiio.FLOAT)[160:920, 580:1340, :3], THUMBNAIL, "box")
        small.specmod()["png:compressionLevel"] = 9
        if not small.write(str(preset.picture), "uint8"):
            raise SystemExit(small.geterror())


def controls(folder, size, samples):
    """The picture of what nodes tell lines and pencil."""
    frame, full = folder / f"{CONTROLS}.exr", folder / f"{CONTROLS}.png"
    encre("render", ROOT / "scenes" / f"{CONTROLS}.py", "-o", frame, "--size", size, "--samples", samples, "--resume")
    encre("composite", frame, "-o", full, "--preset", "water_memory")
    shrink(full, ROOT / "docs" / "painting_nodes.jpg")


def panels(folder, size, samples, only):
    """The two panels after Vainumäe, each as its file says; their part of the page."""
    page = "## Two panels\n\nEach by its own settings; [theses.md](theses.md#two-panels) tells point by point what "
    page += "they show.\n\n"
    for name, words in PANELS.items():
        if not only or name in only:
            frame, full = folder / f"{name}.exr", folder / f"{name}.png"
            encre("render", ROOT / "scenes" / f"{name}.py", "-o", frame, "--size", size, "--samples", samples,
                  "--resume")
            encre("composite", frame, "-o", full)
            shrink(full, ROOT / "docs" / "scenes" / f"{name}.jpg")
        page += f"![{words}](scenes/{name}.jpg)\n\n"
    return page


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--size", default="1920x1080")
    parser.add_argument("--samples", type=int, default=16)
    parser.add_argument("--only", action="append", metavar="NAME")
    parser.add_argument("folder", type=Path)
    parser.add_argument("files", nargs="*", type=Path)
    args = parser.parse_args()
    args.folder.mkdir(parents=True, exist_ok=True)
    sources = {name: (ROOT / "scenes" / f"{name}.py", words) for name, words in SCENES.items()}
    sources |= {path.stem: (path, path.stem) for path in args.files}
    page = HEAD.format(size=args.size.replace("x", "×"), samples=args.samples)
    for name, (source, words) in sources.items():
        drawn = {preset: f"{name}-{id_.replace('_', '-')}" for preset, id_ in PRESETS.items()}
        if not args.only or name in args.only:
            frame = args.folder / f"{name}.exr"
            if source.suffix == ".blend":
                shown = args.folder / f"{name}.py"
                shown.write_text(LIT.format(path=str(source.resolve())), encoding="utf-8")
            else:
                shown = source
            encre("render", shown, "-o", frame, "--size", args.size, "--samples", args.samples, "--resume")
            for preset, picture in drawn.items():
                full = args.folder / f"{picture}.png"
                encre("composite", frame, "-o", full, "--preset", PRESETS[preset])
                shrink(full, ROOT / "docs" / "scenes" / f"{picture}.jpg")
        page += f"## `{source.name}`\n\n" + table(words, list(drawn.items()))
    page += panels(args.folder, args.size, args.samples, args.only)
    if not args.only or CONTROLS in args.only:
        controls(args.folder, args.size, args.samples)
    if not args.only:
        page += by_every_preset(args.folder, args.size)
        thumbnails(args.folder)
        (ROOT / "docs" / "gallery.md").write_text(page.rstrip() + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
