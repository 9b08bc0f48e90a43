# SPDX-License-Identifier: GPL-3.0-or-later
"""The command `encre`: render, composite, bake, params, presets.

Exit status: 0; 2 for usage, bad input and an output that can't be written; 1 for what fails under way; 130 when
interrupted (by __main__.py). Every error is one line `encre: error: …` on the standard error.
"""

import argparse
import json
import os
import re
import sys
import time
from importlib import metadata

from ..pen import library, presets
from ..pen.errors import EncreError
from . import images, tools
from .bake import bake
from .composite import composite
from .render import RenderError, render

LAST_FRAME = 1048574  # Blender counts no further


class _Parser(argparse.ArgumentParser):
    def __init__(self, **options):
        super().__init__(allow_abbrev=False, **options)

    def error(self, message):
        self.exit(2, f"encre: error: {message}; see {self.prog} --help\n")


def _say(kind, sentence):
    print(f"encre: {kind}: {sentence}", file=sys.stderr, flush=True)


# Arguments


def _ending(*endings):
    def check(path):
        if os.path.splitext(path)[1].lower() not in endings:
            raise argparse.ArgumentTypeError(f"{path} must be a name that ends in {' or '.join(endings)}")
        return path
    return check


def _size(text):
    match = re.fullmatch(r"(\d+)[xX](\d+)", text)
    size = [int(number) for number in match.groups()] if match else [0]
    if not all(4 <= number <= 65536 for number in size):
        raise argparse.ArgumentTypeError(f"{text!r} is not a size WIDTHxHEIGHT from 4x4 to 65536x65536")
    return size


def _frame(text):
    if not re.fullmatch(r"[-+]?\d{1,7}", text) or abs(int(text)) > LAST_FRAME:
        raise argparse.ArgumentTypeError(f"{text!r} is not a frame number from {-LAST_FRAME} to {LAST_FRAME}")
    return int(text)


def _count(text):
    if not re.fullmatch(r"[1-9]\d{0,8}", text):
        raise argparse.ArgumentTypeError(f"{text!r} is not a whole number from 1")
    return int(text)


def _version():
    try:
        return f"encre {metadata.version('encre')}"
    except metadata.PackageNotFoundError:  # run from a folder, as `encre render` does inside Blender
        return "encre, not installed"


def _parser():
    parser = _Parser(prog="encre", description="Comic-book pictures from Blender scenes and from rendered layers.")
    parser.add_argument("--version", action="version", version=_version())
    commands = parser.add_subparsers(dest="command", required=True, metavar="COMMAND")

    style = argparse.ArgumentParser(add_help=False)
    style.add_argument("--preset", metavar="P", help="apply a preset (encre presets lists them)")
    style.add_argument("--set", metavar="ID=VALUE", action="append", default=[], dest="sets",
                       help="change a parameter after the preset (encre params lists them); may be repeated")

    command = commands.add_parser("render", parents=[style], help="render a scene with Blender", description=(
        "Render a scene with Blender. A .py scene is run in an empty file. Blender is --blender, else the Python "
        "module bpy, else `blender` on PATH."))
    command.add_argument("scene", metavar="SCENE", type=_ending(".blend", ".py"), help="a .blend or .py file")
    command.add_argument("-o", "--output", metavar="OUT", required=True, type=_ending(".png", ".exr"), help=(
        "a .png, or a multilayer .exr with all passes; # in the name stands for digits of the frame number"))
    command.add_argument("-f", "--frame", metavar="N", type=_frame, help="the frame (default: the scene's current one)")
    command.add_argument("-s", "--start", metavar="A", type=_frame, help="first frame of an animation")
    command.add_argument("-e", "--end", metavar="B", type=_frame, help="last frame of an animation")
    command.add_argument("--samples", metavar="N", type=_count, help="samples a pixel")
    command.add_argument("--size", metavar="WxH", type=_size, help="size of the full frame in pixels")
    command.add_argument("--resume", action="store_true", help="leave frames alone whose file is there and whole")
    command.add_argument("--blender", metavar="PATH", help="the Blender program to use")
    command.add_argument("--verbose", action="store_true", help="pass on what Blender prints")
    command.set_defaults(run=_render)

    command = commands.add_parser("composite", parents=[style], help="restyle a rendered multilayer EXR", description=(
        "Restyle a rendered multilayer EXR, without Blender. The settings in the file are where it starts."))
    command.add_argument("layers", metavar="LAYERS.exr", help="a multilayer EXR that Blender wrote")
    command.add_argument("-o", "--output", metavar="OUT", required=True, type=_ending(".png", ".exr"),
                         help="a .png (sRGB), or an .exr with Combined and Encre's passes")
    command.add_argument("--view-layer", metavar="N", help="name of the view layer (default: the file's first)")
    command.add_argument("--threads", metavar="N", type=_count, default=0, help="default: one a processor")
    command.set_defaults(run=_composite)

    command = commands.add_parser("bake", parents=[style], help="draw inter-color lines into a texture", description=(
        "Draw lines into a texture where its colours meet, as wide as they differ. Of the parameters, line_thickness "
        "(in texels) and those of contrast count. 8- and 16-bit images are sRGB, images of floats linear."))
    command.add_argument("texture", metavar="TEXTURE", help="an image of any kind; it is never changed")
    command.add_argument("-o", "--output", metavar="OUT", required=True, help="the image to write, not TEXTURE itself")
    command.add_argument("--uniform", metavar="MESH", help=(
        "give lines the same width everywhere on this mesh: MESH.obj, or FILE.blend:OBJECT, which needs Blender; "
        "line_thickness is then in texels of mean size"))
    command.add_argument("--mips", action="store_true", help=(
        "also write NAME.mip1.png, NAME.mip2.png ... beside OUT = NAME.png: images half, a quarter ... as large, each "
        "with lines drawn for its own texels, to mix by distance in a material"))
    command.add_argument("--tile", choices=("none", "x", "y", "xy"), help=(
        "where the texture repeats and lines go on over its border (default: xy; with --uniform, where the mesh does)"))
    command.add_argument("--threads", metavar="N", type=_count, default=0, help="default: one a processor")
    command.add_argument("--blender", metavar="PATH", help="the Blender program to use for FILE.blend:OBJECT")
    command.set_defaults(run=_bake)

    command = commands.add_parser("compare", parents=[style], help="compare baked and dynamic lines", description=(
        "Render a scene without lines between colours, with such lines baked into its textures and with lines drawn "
        "in the frame, and put the three and a caption into the quadrants of one picture. OUT_crops shows details, "
        "OUT_blender Blender's own lines."))
    command.add_argument("scene", metavar="SCENE", type=_ending(".blend", ".py"), help="a .blend or .py file")
    command.add_argument("-o", "--output", metavar="OUT", required=True, type=_ending(".png"), help=(
        "a .png twice as wide and high as the frame; # in the name stands for digits of the frame number"))
    command.add_argument("--seed", metavar="N", type=int, default=0, help="chooses which of the two is on the left")
    command.add_argument("-f", "--frame", metavar="N", type=_frame, help="the frame (default: the scene's current one)")
    command.add_argument("-s", "--start", metavar="A", type=_frame, help="first frame of an animation")
    command.add_argument("-e", "--end", metavar="B", type=_frame, help="last frame of an animation")
    command.add_argument("--uniform", action="store_true", help="bake lines that are equally wide on the surface")
    command.add_argument("--mips", action="store_true", help="bake mip levels, each shown at its distance")
    command.add_argument("--quadrants", action="store_true", help="only the quadrants: no crops, no Blender's lines")
    command.add_argument("--samples", metavar="N", type=_count, help="samples a pixel")
    command.add_argument("--size", metavar="WxH", type=_size, help="size of the frame in pixels")
    command.add_argument("--blender", metavar="PATH", help="the Blender program to use")
    command.add_argument("--verbose", action="store_true", help="pass on what Blender prints")
    command.set_defaults(run=_compare)

    command = commands.add_parser("params", help="list the parameters")
    command.add_argument("--json", action="store_true", help="as a JSON list, for programs")
    command.set_defaults(run=_params)

    command = commands.add_parser("presets", help="list the presets")
    command.set_defaults(run=_presets)
    return parser


# Commands


def _changes(args):
    """The values that --preset and --set give."""
    values = dict(presets.find(args.preset).values) if args.preset is not None else {}
    for text in args.sets:
        id_, equals, value = text.partition("=")
        if not equals:
            raise EncreError(f"--set {text}: has no value; write --set ID=VALUE")
        values[id_.strip()] = library.parse(id_.strip(), value)
    if values.get("paper_image"):
        values["paper_image"] = os.path.abspath(values["paper_image"])
        images.read_paper(values["paper_image"])
    return library.check(values)


def _frames(args):
    ranged = args.start is not None or args.end is not None
    if ranged and args.frame is not None:
        raise EncreError("-f gives one frame, -s and -e a range; give one or the other")
    if None not in (args.start, args.end) and args.start > args.end:
        raise EncreError(f"-s {args.start} is after -e {args.end}; give the first frame first")
    return [args.start, args.end] if ranged else args.frame


def _scene(args):
    if not os.path.isfile(args.scene):
        raise EncreError(f"{args.scene}: there is no such file; check the path")
    return args.scene


def _render(args):
    frames = _frames(args)
    render(_scene(args), args.output, frames=frames, values=_changes(args),
           samples=args.samples, size=args.size, resume=args.resume, blender=args.blender, say=_say,
           verbose=args.verbose)


def _compare(args):
    frames = _frames(args)
    tools.load("compare", "compare").compare(
        _scene(args), args.output, seed=args.seed, quadrants_only=args.quadrants, frames=frames,
        values=_changes(args), samples=args.samples, size=args.size, uniform=args.uniform, mips=args.mips,
        blender=args.blender, say=_say, verbose=args.verbose)


def _composite(args):
    changes = _changes(args)
    images.prepare(args.output)
    if os.path.exists(args.output) and os.path.exists(args.layers) and os.path.samefile(args.output, args.layers):
        raise EncreError(f"{args.output}: is the file that is read, whose layers would be lost; give another name")
    start = time.perf_counter()
    composite(args.layers, args.output, changes, args.view_layer, args.threads, _say)
    print(f"{args.output} ({time.perf_counter() - start:.1f} s)")


def _bake(args):
    tile = None if args.tile is None else ("x" in args.tile, "y" in args.tile)
    bake(args.texture, args.output, _changes(args), args.uniform, args.mips, tile, args.threads, args.blender, _say)


def _params(args):
    if args.json:
        print(json.dumps([_row(p) for p in library.params().values()], indent=1, ensure_ascii=False))
        return
    for stage in library.stages():
        print(f"{stage.label}: {stage.help}")
        for p in stage.params:
            print(f"  {p.id} = {_written(p)}  ({_allowed(p)})\n      {p.help}")
        print()


def _row(p):
    return {"id": p.id, "stage": p.stage, "label": p.label, "help": p.help, "type": p.type, "scope": p.scope,
            "default": p.default, "unit": p.unit, "enabled_if": p.enabled_if, "hard_min": p.hard_min,
            "hard_max": p.hard_max, "soft_min": p.soft_min, "soft_max": p.soft_max,
            "items": [{"id": item.id, "label": item.label, "help": item.help} for item in p.items]}


def _written(p):
    """The default as --set takes it."""
    value = p.default
    if p.type == "bool":
        return "on" if value else "off"
    if p.type == "color":
        return ",".join(f"{x:g}" for x in value)
    if p.type == "levels":
        return '"' + "; ".join(",".join(f"{x:g}" for x in level) for level in value) + '"'
    return "none" if value is None else f"{value:g}" if p.type == "float" else str(value)


def _allowed(p):
    if p.type == "enum":
        return ", ".join(item.id for item in p.items)
    if p.type in ("int", "float"):
        limits = f"from {p.hard_min:g}" + ("" if p.hard_max is None else f" to {p.hard_max:g}")
        return " ".join(filter(None, [p.type, limits, p.unit]))
    return {"bool": "on, off", "color": "r,g,b", "levels": "list of levels", "image": "path of an image"}[p.type]


def _presets(_args):
    for preset in presets.presets():
        print(f"{preset.id}: {preset.name}. {preset.description}")


def main(argv=None):
    """Runs the command line `argv` (default: the process's) and returns its exit status."""
    try:
        args = _parser().parse_args(argv)
        args.run(args)
        sys.stdout.flush()
        return 0
    except BrokenPipeError:  # the reader of our output left, as `head` does
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return 0
    except (EncreError, MemoryError, OSError) as error:
        sentence = str(error) or "there is not enough memory; give a smaller picture"
        print(f"encre: error: {sentence}", file=sys.stderr)
        under_way = isinstance(error, (RenderError, images.WriteError)) or not isinstance(error, EncreError)
        return 1 if under_way else 2
