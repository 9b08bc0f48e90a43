# SPDX-License-Identifier: GPL-3.0-or-later
"""What the command line may hold: commands, their options and what each takes."""

import argparse
import os
import re
import textwrap

from ..pen import layers
from ..pen.errors import EncreError
from . import images, sequence
from .passes import renderers
from .progress import say
from .sharing import lease

MOST_JOBS = 256
MOST_SAMPLES = 1 << 24  # Cycles takes no more
AGAIN = 75  # as sysexits.h has it: the same command may well succeed later, or on another machine

STATUS = """exit status:
  0    all is done, every picture is in its place
  1    something failed under way, and would again
  2    the command, its input or its output can't be used
  75   try again: memory ran out, a process was killed or took too long, or others have what is left
  130  interrupted"""


def without(argv, **options):
    """`argv` without some options. options: {an option's name, with _ for -: how many words it takes, "?" for one that
    may be missing}; of a single letter, -f, too."""
    names = {("--" if len(name) > 1 else "-") + name.replace("_", "-"): words for name, words in options.items()}
    rest, skip = [], 0
    for number, word in enumerate(argv):
        name = word.partition("=")[0]
        if skip:
            skip -= 1
        elif name in names:
            after = argv[number + 1:number + 2]
            words = names[name]
            if words == "?":
                words = 1 if after and not after[0].startswith("-") else 0
            skip = 0 if "=" in word else words
        elif not (word[:2] in names and not word.startswith("--")):  # -f1-4
            rest.append(word)
    return rest


def joined(argv):
    """`argv` with -f and a list that begins with a minus as one word: argparse would take the list for an option."""
    words = []
    for word in argv:
        if words and words[-1] in ("-f", "--frame") and re.match(r"-\d.*[-,x]", word):
            words[-1] += f"={word}" if words[-1].startswith("--") else word
        else:
            words.append(word)
    return words


class _Parser(argparse.ArgumentParser):
    def __init__(self, examples="", **options):
        super().__init__(allow_abbrev=False, epilog="\n\n".join(filter(None, [examples, STATUS])),
                         formatter_class=argparse.RawDescriptionHelpFormatter, **options)
        if self.description:
            self.description = textwrap.fill(self.description, 100)

    def parse_known_args(self, args=None, namespace=None):
        """As argparse's, but a command says itself what it doesn't know, and so names its own help."""
        found, rest = super().parse_known_args(args, namespace)
        if rest:
            self.error(f"unrecognized arguments: {' '.join(rest)}")
        return found, rest

    def error(self, message):
        if re.fullmatch(r"unrecognized arguments: \S.*\.exr", message):  # what a shell makes of in.*.exr
            message += " (of a sequence give one name with # for the number, in quotes: 'in.####.exr')"
        say("error", f"{message}; see {self.prog} --help")
        self.exit(2)


def _ending(*endings):
    def check(path):
        if os.path.splitext(path)[1].lower() not in endings:
            raise argparse.ArgumentTypeError(f"{path or repr(path)} must be a name that ends in {' or '.join(endings)}")
        if re.search(r"%\d*d", os.path.basename(path)):
            raise argparse.ArgumentTypeError(f"{path}: write # for each digit of the frame's number, not %d")
        return path
    return check


def _size(text):
    match = re.fullmatch(r"(\d+)[xX](\d+)", text)
    size = [int(number) for number in match.groups()] if match else [0]
    if not all(4 <= number <= 65536 for number in size):
        raise argparse.ArgumentTypeError(f"{text!r} is not a size WIDTHxHEIGHT from 4x4 to 65536x65536")
    return size


def _frame(text):
    frames = _frame_list(text)
    if len(frames) > 1:
        raise argparse.ArgumentTypeError(f"{text!r} is not one frame number; give one")
    return frames[0]


def _frame_list(text):
    try:
        return sequence.numbers(text)
    except EncreError as error:
        raise argparse.ArgumentTypeError(str(error)) from None


def _count(text):
    if not 1 <= (int(text) if re.fullmatch(r"\d{1,9}", text) else 0) <= MOST_SAMPLES:
        raise argparse.ArgumentTypeError(f"{text!r} is not a whole number from 1 to {MOST_SAMPLES}")
    return int(text)


def _jobs(text):
    if not 1 <= (int(text) if re.fullmatch(r"\d{1,9}", text) else 0) <= MOST_JOBS:
        raise argparse.ArgumentTypeError(f"{text!r} is not a number of processes from 1 to {MOST_JOBS}")
    return int(text)


def _share(text):
    """How --jobs tells a process which frames are its own, and where to tell what becomes of them."""
    k, n, path = text.split("/", 2)
    return int(k), int(n), path


def _threads(text):
    if not re.fullmatch(r"\d{1,4}", text) or int(text) > 1024:
        raise argparse.ArgumentTypeError(f"{text!r} is not a number of threads from 1 to 1024, nor 0 for one a "
                                         "processor")
    return int(text)


def _passes(text):
    known = {name.split()[-1].lower(): name for name in layers.DRAWN}
    wanted = [word.strip().lower() for word in text.split(",")]
    if wanted == ["all"]:
        return list(known.values())
    if not set(wanted) <= known.keys():
        raise argparse.ArgumentTypeError(f"{text!r} is no list of {', '.join(known)}, nor all")
    return [known[word] for word in wanted]


def _number(text):
    if not re.fullmatch(r"\d{1,6}", text):
        raise argparse.ArgumentTypeError(f"{text!r} is not a whole number from 0 to 999999")
    return int(text)


def _share_of_people(text):
    if not re.fullmatch(r"0?\.\d{1,6}", text) or not 0 < float(text) < 1:
        raise argparse.ArgumentTypeError(f"{text!r} is not a share between 0 and 1, such as 0.7")
    return float(text)


def _seconds(text):
    if not re.fullmatch(r"\d{1,9}(\.\d*)?", text) or not float(text) > 0:
        raise argparse.ArgumentTypeError(f"{text!r} is not a number of seconds above 0")
    return float(text)


def _scenes():
    """What says which frames of which scene are rendered, and how."""
    command = argparse.ArgumentParser(add_help=False)
    command.add_argument("scene", metavar="SCENE", type=_ending(".blend", ".py"), help="a .blend or .py file")
    command.add_argument("-o", "--output", metavar="OUT", required=True, type=_ending(".png", ".exr"), help=(
        "a .png, or a multilayer .exr to draw again; # in the name stands for digits of the frame number"))
    command.add_argument("-f", "--frame", metavar="N", type=_frame_list, help=(
        "the frame (default: the scene's current one), or a list such as 1-100x5,7"))
    command.add_argument("-s", "--start", metavar="A", type=_frame, help=(
        "first frame of an animation, which has the scene's frame step"))
    command.add_argument("-e", "--end", metavar="B", type=_frame, help="last frame of an animation")
    command.add_argument("--scene", metavar="NAME", dest="scene_name",
                         help="the scene in the file (default: the open one)")
    command.add_argument("--camera", metavar="NAME", help="the camera (default: the scene's)")
    command.add_argument("--view-layer", metavar="NAME", help="render only this one")
    command.add_argument("--passes", metavar="LIST", type=_passes, default=[], help=(
        "in an .exr also what is drawn: lines, surface, edges, light, or all (default: as the view layers have it)"))
    by = command.add_mutually_exclusive_group()
    by.add_argument("--fast", dest="layer_source", action="store_const", const="ENCRE", help=(
        "without Cycles, in seconds: no reflections, no bounced light (default: as the preset or the file has it)"))
    by.add_argument("--full", dest="layer_source", action="store_const", const="CYCLES", help="by Cycles")
    command.add_argument("--samples", metavar="N", type=_count, help=(
        "samples a pixel that Cycles takes (default: those of its settings, at most 16 or as Encre's panel says)"))
    command.add_argument("--size", metavar="WxH", type=_size, help="size of the full frame in pixels")
    command.add_argument("--device", choices=("cpu", "cuda", "optix", "hip", "oneapi", "metal"),
                         type=str.lower,
                         help="what Cycles computes on (default: as the file has it)")
    command.add_argument("--threads", metavar="N", type=_threads,
                         help="0: one a processor (default: as the file has it)")
    command.add_argument("--strict", action="store_true", help=(
        "missing or broken textures, libraries, caches and styles, scripts that fail, and a file newer than this "
        "Blender are errors"))
    command.add_argument("--enable-autoexec", action="store_true", help="run the scripts in the file; trust its maker")
    command.add_argument("--path-mapping", metavar="FILE", help=(
        "where the scene's files lie on this machine: rules as Open Job Description writes them"))
    command.add_argument("--frame-timeout", metavar="S", type=_seconds, help=(
        "give a frame, or opening the scene, up after so many seconds"))
    command.add_argument("--blender", metavar="PATH", help="the Blender program to use")
    return command


def parser():
    """The parser; of what it reads, `command` names the command."""
    whole = _Parser(prog="encre", description="Comic-book pictures from Blender scenes and from rendered layers.")
    whole.add_argument("--version", action="version", version=f"encre {images.version()}")
    commands = whole.add_subparsers(dest="command", required=True, metavar="COMMAND")

    share = argparse.ArgumentParser(add_help=False)
    share.add_argument("--no-wait", action="store_true", help=(
        "end with status 75 where others have what is left, instead of waiting for it"))
    share.add_argument("--lease", metavar="S", type=_seconds, default=lease.SECONDS, help=(
        f"seconds after which others may take a frame over of which nothing was heard (default: {lease.SECONDS})"))

    style = argparse.ArgumentParser(add_help=False)
    style.add_argument("--preset", metavar="P", help="apply a preset: its name, as encre presets lists them, or file")
    style.add_argument("--set", metavar="ID=VALUE", action="append", default=[], dest="sets",
                       help="change a parameter after the preset (encre params lists them); may be repeated")

    scenes = _scenes()
    command = commands.add_parser("render", parents=[scenes, style, share], help="render a scene",
                                  description=(
        "Render a scene with Blender. A .py scene is run in an empty file. Blender is --blender, else the Python "
        "module bpy, else `blender` on PATH. With --resume several processes may render one sequence: each takes "
        "frames that no other has."), examples="""examples:
  encre render scene.blend -o panel.png
  encre render scene.blend -o frames/####.exr -s 1 -e 48 --resume
  encre render scene.py -o test.png -f 1-100x5,7 --set line_thickness=6""")
    command.add_argument("--resume", action="store_true", help=(
        "leave frames alone that are whole and were made from the same file (whatever it links), parameters, "
        "samples, size and versions"))
    command.add_argument("--quick", action="store_true", help="with --resume: don't read finished frames to their end")
    command.add_argument("--keep-going", action="store_true",
                         help="go on after a frame that failed, and say at the end which")
    command.add_argument("--dry-run", action="store_true", help=(
        "only say which files would be written, also by File Output nodes"))
    command.add_argument("--progress", choices=("text", "json", "openjd"), default="text", help=(
        "json: an object a line on the standard output; openjd: lines for a session of Open Job Description"))
    command.add_argument("--jobs", metavar="N", type=_jobs, default=1, help=(
        "Blenders that share the frames, each with memory of its own (default: 1)"))
    command.add_argument("--serve", metavar="SOCKET", nargs="?", const="", help=(
        "keep Blender open for frames that are asked for later: lists on the standard input, or on a socket of Unix's "
        "that encre ask knows"))
    command.add_argument("--detach", action="store_true",
                         help="with --serve SOCKET: end when it answers, and leave it to itself")
    command.add_argument("--verbose", action="store_true", help="pass on what Blender prints")

    command = commands.add_parser("submit", parents=[scenes, style], help="write or hand over the job of a farm",
                                  description=(
        "Write frames of a scene as a job of a farm's own system, and with --run hand it over. The scene is opened, to "
        "list its frames and the files that it reads."), examples="""examples:
  encre submit scene.blend -o frames/####.png -f 1-240 --farm slurm --chunk 4 --run
  encre submit scene.blend -o frames/####.exr -s 1 -e 240 --farm deadline --job bundle
  encre submit scene.blend -o frames/####.png -f 1-240 --farm openjd --film film.mp4""")
    command.add_argument("--farm", choices=("openjd", "slurm", "flamenco", "deadline", "opencue"), required=True)
    command.add_argument("--job", metavar="FOLDER", help="where its files go (default: SCENE.FARM)")
    command.add_argument("--run", action="store_true", help="hand it over")
    command.add_argument("--chunk", metavar="N", type=_count, default=1, help="frames of a task (default: 1)")
    command.add_argument("--retries", metavar="N", type=_count, default=5,
                         help="times that a task is tried again which may succeed then (default: 5)")
    command.add_argument("--cpus", metavar="N", type=_count, default=0,
                         help="processors that a task asks for, of openjd, deadline and slurm")
    command.add_argument("--memory", metavar="GB", type=_count, default=0, help="and its memory")
    command.add_argument("--film", metavar="FILM", type=_ending(".mp4", ".mov", ".mkv", ".webm"),
                         help="at the end have ffmpeg put the .png files together")
    command.add_argument("--encre", metavar="COMMAND", default="encre",
                         help="the command encre on the machines that render (default: encre)")

    command = commands.add_parser("ask", help="have frames rendered by encre render --serve", description=(
        "Have frames rendered by a process that encre render --serve SOCKET keeps."), examples="""examples:
  encre render scene.blend -o frames/####.exr --resume --serve blender.socket --detach
  encre ask blender.socket -f 1-4
  encre ask blender.socket --end""")
    command.add_argument("socket", metavar="SOCKET")
    asked = command.add_mutually_exclusive_group(required=True)
    asked.add_argument("-f", "--frame", metavar="N", type=_frame_list, help="frames, a list such as 1-100x5,7")
    asked.add_argument("--end", action="store_true", help="end it")
    command.add_argument("--progress", choices=("text", "json", "openjd"), default="text",
                         help="as encre render has it")

    command = commands.add_parser("composite", parents=[style, share], help="restyle a rendered EXR", description=(
        "Restyle a rendered multilayer EXR, without Blender. The settings in the file are where it starts."),
        examples="""examples:
  encre composite 0001.exr -o panel.png --preset ink_only --set line_thickness=6
  encre composite 0001.exr -o panel.png --set shade_levels="0.5; 0.7,0.5,0.025; 1.1,0.9,0.025"
  encre composite 'in.####.exr' -o 'out.####.png' -f 1-100x5,7 --resume --jobs 4
  encre composite other.exr --check --layer depth=Z""")
    command.add_argument("layers", metavar="LAYERS.exr", help=(
        "a multilayer EXR that Blender wrote; # in the name stands for digits of the frame number"))
    command.add_argument("-o", "--output", metavar="OUT", type=_ending(".png", ".exr"),
                         help="a .png (sRGB), or an .exr with Combined and Encre's passes")
    command.add_argument("-f", "--frame", metavar="N", type=_frame_list, help=(
        "of a sequence, the frames to draw: a list such as 1-100x5,7 (default: all that are there)"))
    command.add_argument("-s", "--start", metavar="A", type=_frame, help="first frame of a sequence")
    command.add_argument("-e", "--end", metavar="B", type=_frame, help="last frame of a sequence")
    command.add_argument("--resume", action="store_true",
                         help="leave frames alone that are whole and were drawn from the same file and settings")
    command.add_argument("--keep-going", action="store_true",
                         help="of a sequence, go on after a frame that failed, and say at the end which")
    command.add_argument("--jobs", metavar="N", type=_jobs, default=1,
                         help="processes that share a sequence (default: 1)")
    command.add_argument("--share", type=_share, help=argparse.SUPPRESS)
    command.add_argument("--check", action="store_true",
                         help="only say which passes there are, and what each that is missing switches off")
    command.add_argument("--layer", metavar="WORD=NAME", action="append", default=[], dest="asked", help=(
        "another renderer's name for combined, depth, normal, color, light, object or material, as depth=Z, or a file "
        "of its own, as depth=depth.####.exr or depth=all.exr:Z"))
    command.add_argument("--from", choices=sorted(renderers.PROFILES), dest="renderer", help=(
        "whose names the passes have (default: whose is clear)"))
    command.add_argument("--view-layer", metavar="N", help="name of the view layer (default: the file's first)")
    command.add_argument("--allow-paths", action="store_true", help=(
        "read images that the file names wherever they lie, not only beside the file"))
    command.add_argument("--threads", metavar="N", type=_threads, default=0,
                         help="default, and 0: one a processor")

    command = commands.add_parser("bake", parents=[style], help="draw inter-color lines into a texture", description=(
        "Draw lines into a texture where its colors meet, as wide as they differ. Of the parameters, line_thickness "
        "(in texels) and those of contrast count. 8- and 16-bit images are sRGB, images of floats linear."),
        examples="""examples:
  encre bake wood.png -o wood_lines.png --uniform vase.obj
  encre bake wood.png -o wood_lines.png --uniform scene.blend:Vase --mips""")
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
    command.add_argument("--threads", metavar="N", type=_threads, default=0,
                         help="default, and 0: one a processor")
    command.add_argument("--blender", metavar="PATH", help="the Blender program to use for FILE.blend:OBJECT")

    command = commands.add_parser("compare", parents=[style], help="compare baked and dynamic lines", description=(
        "Render a scene without lines between colors, with such lines baked into its textures and with lines drawn "
        "in the frame, and put the three and a caption into the quadrants of one picture. OUT_crops shows details, "
        "OUT_blender Blender's own lines."))
    command.add_argument("scene", metavar="SCENE", type=_ending(".blend", ".py"), help="a .blend or .py file")
    command.add_argument("-o", "--output", metavar="OUT", required=True, type=_ending(".png"), help=(
        "a .png twice as wide and high as the frame; # in the name stands for digits of the frame number"))
    command.add_argument("--seed", metavar="N", type=int, default=0, help="chooses which of the two is on the left")
    command.add_argument("-f", "--frame", metavar="N", type=_frame_list, help=(
        "the frame, or a list such as 1-100x5,7 (default: the scene's current one)"))
    command.add_argument("-s", "--start", metavar="A", type=_frame, help="first frame of an animation")
    command.add_argument("-e", "--end", metavar="B", type=_frame, help="last frame of an animation")
    command.add_argument("--uniform", action="store_true", help="bake lines that are equally wide on the surface")
    command.add_argument("--mips", action="store_true", help="bake mip levels, each shown at its distance")
    command.add_argument("--quadrants", action="store_true", help="only the quadrants: no crops, no Blender's lines")
    command.add_argument("--samples", metavar="N", type=_count, help="samples a pixel")
    command.add_argument("--size", metavar="WxH", type=_size, help="size of the frame in pixels")
    command.add_argument("--blender", metavar="PATH", help="the Blender program to use")
    command.add_argument("--verbose", action="store_true", help="pass on what Blender prints")

    command = commands.add_parser("study", parents=[style], help="ask people which of two looks they prefer",
                                  description=(
        "Open a window in which people compare two looks of a scene whose camera moves, one person after the other, "
        "and write a text file of each. --analyse tells what came of it, --plan how many people it takes; both need "
        "scipy: pip install scipy."), examples="""examples:
  encre study room.blend -o answers
  encre study room.blend -o answers --left ink_only --right pencil --open "Why?"
  encre study --analyse answers
  encre study --plan 0.7""")
    command.add_argument("scene", metavar="SCENE", nargs="?", type=_ending(".blend", ".py"),
                         help="a .blend or .py file")
    command.add_argument("-o", "--output", metavar="DIR", help="the folder for the files, one a person")
    for side, default in ("left", "dynamic"), ("right", "baked"):
        command.add_argument(f"--{side}", metavar="LOOK", default=default, help=(
            f"{'one' if side == 'left' else 'the other'} look: dynamic (the scene as it is), baked (lines between "
            f"colors in its textures), plain, or a preset (default: {default})"
            + ("; on which side each stands is drawn at random" if side == "left" else "")))
    command.add_argument("--question", metavar="'NAME: TEXT'", action="append", default=[], dest="questions", help=(
        "ask this instead of the thesis' two questions; may be repeated"))
    command.add_argument("--open", metavar="TEXT", action="append", default=[], dest="open_",
                         help="also ask this, to be answered in words; may be repeated")
    command.add_argument("--slider", action="store_true", help="let people change how thick all lines are")
    command.add_argument("--presses", metavar="N", type=_number, default=100,
                         help="keys after which the questions come (default: 100)")
    command.add_argument("--moves", metavar="N", type=_number, default=1000, help=(
        "ticks, thirty a second, with the mouse moved in the free mode after which they come (default: 1000)"))
    command.add_argument("--flights", choices=("ask", "live", "drawn"), default="ask", help=(
        "drawn: before anybody sits down, and kept in DIR; ask: if the machine is too slow for live ones (default)"))
    command.add_argument("--size", metavar="WxH", type=_size, help="size of the window (default: the whole screen)")
    command.add_argument("--play", metavar="FILE", help="show again what a person saw, by their file")
    command.add_argument("--analyse", metavar="DIR", help="tell what came of the sessions in a folder")
    command.add_argument("--plan", metavar="SHARE", type=_share_of_people, help=(
        "tell how many people it takes to find that this share of all prefer one look, as 0.7"))
    command.add_argument("--power", metavar="P", type=_share_of_people, default=0.8,
                         help="of --plan: which share of such studies is to find it (default: 0.8)")
    command.add_argument("--blender", metavar="PATH", help="the Blender program to use")
    command.add_argument("--verbose", action="store_true", help="pass on what Blender prints")

    command = commands.add_parser("params", help="list the parameters")
    command.add_argument("--json", action="store_true", help="as a JSON list, for programs")

    commands.add_parser("presets", help="list the presets")
    return whole
