# SPDX-License-Identifier: GPL-3.0-or-later
"""The command `encre`: render, submit, ask, composite, bake, compare, study, params, presets.

Every error is one line `encre: error: …` on the standard error, and every warning and note one like it. What strangers
named is shown with its control characters written out.
"""

import contextlib
import json
import math
import os
import sys
import time
import traceback
import warnings

import numpy as np

from ..pen import library, presets, slots
from ..pen.errors import EncreError, shown
from ..pen.params import Chosen
from . import images, render, sequence, shadows, tools
from .arguments import AGAIN, joined, parser, without
from .bake import bake
from .child import RenderError, TryAgain
from .farms import mapping, submit
from .frames import SERVED
from .passes import substitutes
from .progress import Progress, say
from .restyle import LEFT, check, plan, restyle, sum_up
from .sharing import crew, serve
from .sharing.jobs import run as run_jobs
from .sharing.jobs import teller
from .study import sessions


def _changes(args, rules=()):
    """The values that --preset and --set give: each alone is good; together they are judged over what they change."""
    values = dict(presets.find(args.preset).values) if args.preset is not None else {}
    if by := getattr(args, "layer_source", None):
        values["layer_source"] = by
    for text in args.sets:
        id_, equals, value = text.partition("=")
        if not equals:
            raise EncreError(f"--set {text}: has no value; write --set ID=VALUE")
        values[id_.strip()] = library.parse(id_.strip(), value)
    for id_, value in values.items():
        if value and library.params()[id_].type == "image":
            values[id_] = os.path.abspath(mapping.apply(rules, value))
            images.read_chosen(Chosen(id_, values[id_]))
    return values


def _named(args):
    """Ids that --set gives."""
    return [text.partition("=")[0].strip() for text in args.sets]


def _frames(args):
    ranged = args.start is not None or args.end is not None
    if ranged and args.frame is not None:
        raise EncreError("-f gives frames, -s and -e a range; give one or the other")
    if None not in (args.start, args.end) and args.start > args.end:
        raise EncreError(f"-s {args.start} is after -e {args.end}; give the first frame first")
    return (args.start, args.end) if ranged else args.frame


def _scene(args):
    images.check_source(args.scene)
    return args.scene


def _render(args):
    if args.quick and not args.resume:
        raise EncreError("--quick says how --resume looks at frames; give both")
    if args.passes and not args.output.lower().endswith(".exr"):
        raise EncreError(f"--passes names passes of an .exr, and {args.output} has none; end its name in .exr")
    frames, serves = _frames(args), args.serve is not None
    if serves and (frames is not None or args.dry_run or args.jobs > 1):
        raise EncreError("--serve renders frames that are asked for later; leave out which, --dry-run and --jobs")
    if args.detach and not args.serve:
        raise EncreError("--detach leaves --serve SOCKET to itself; give both")
    progress = _progress(args)
    try:
        if args.detach:
            serve.detach(args.serve, without(args.argv, detach=0))
            return
        options = _options(args)
        how = {"resume": args.resume, "quick": args.quick, "keep_going": args.keep_going, "wait": not args.no_wait}
        if args.dry_run:
            render.planned(args.scene, args.output, frames, progress=progress, **options).show(args.resume, args.quick)
        elif serves:
            progress.as_json = True
            with render.opened(args.scene, args.output, SERVED, frame_timeout=args.frame_timeout, seconds=args.lease,
                               progress=progress, **options) as work:
                serve.serve(work, args.serve or None, progress, _status, **how)
            return
        elif args.jobs > 1 and not (frames and not isinstance(frames, tuple) and len(frames) == 1):
            crew.run([*without(args.argv, f=1, frame=1, s=1, start=1, e=1, end=1, jobs=1, progress=1, no_wait=0)],
                     frames, args.jobs, args.threads, args.keep_going, not args.no_wait, progress)
        else:
            render.render(args.scene, args.output, frames=frames, frame_timeout=args.frame_timeout,
                          seconds=args.lease, progress=progress, **how, **options)
    except (EncreError, OSError, MemoryError) as error:
        progress.tell("error", text=_words(error), status=_status(error))
        raise
    progress.tell("done")


def _progress(args):
    return Progress(say, args.progress == "json", getattr(args, "verbose", False), args.progress == "openjd")


def _options(args):
    """What of the command line says what is rendered, as render.opened() takes it. The scene is looked for."""
    rules = mapping.read(args.path_mapping) if args.path_mapping else []
    args.scene = mapping.apply(rules, args.scene)
    args.output = mapping.apply(rules, args.output)
    _scene(args)
    return {"values": _changes(args, rules), "blender": args.blender, "samples": args.samples, "size": args.size,
            "scene_name": args.scene_name, "camera": args.camera, "view_layer": args.view_layer,
            "threads": args.threads, "device": args.device, "strict": args.strict, "autoexec": args.enable_autoexec,
            "passes": args.passes, "named": _named(args), "mapping": rules}


def _submit(args):
    if args.film and not args.output.lower().endswith(".png"):
        raise EncreError(f"--film takes .png files, and {args.output} is none; end its name in .png")
    if (args.cpus or args.memory) and args.farm in ("flamenco", "opencue"):
        raise EncreError(f"--cpus and --memory are nothing that a job of {args.farm} says here; set them there")
    frames, progress = _frames(args), Progress(say)
    work = render.planned(args.scene, args.output, frames, progress=progress, **_options(args))
    own = {"submit": 0, "farm": 1, "job": 1, "run": 0, "chunk": 1, "retries": 1, "film": 1, "cpus": 1,
           "memory": 1, "encre": 1, "f": 1,
           "frame": 1, "s": 1, "start": 1, "e": 1, "end": 1, "o": 1, "output": 1}
    options = [word for word in without(args.argv[1:], **own) if word != args.scene]
    stem = os.path.splitext(os.path.basename(args.scene))[0]
    place = os.path.abspath(args.job or f"{stem}.{args.farm}")
    seconds = {"timeout": math.ceil(args.frame_timeout), "opening": math.ceil(args.frame_timeout)} \
        if args.frame_timeout else {}
    submit.submit(args.farm, submit.Job(
        name=f"encre-{stem}", encre=args.encre, scene=os.path.abspath(args.scene),
        out=os.path.abspath(sequence.pattern(args.output)), frames=list(work.todo), options=options,
        inputs=work.ready["inputs"], fps=work.ready["fps"], place=place, chunk=args.chunk, retries=args.retries,
        film=os.path.abspath(args.film) if args.film else "", cpus=args.cpus, memory=args.memory, **seconds), args.run)


def _ask(args):
    progress = _progress(args)
    try:
        serve.ask(args.socket, serve.END if args.end else ",".join(map(str, args.frame)), progress)
    except EncreError as error:
        progress.tell("error", text=str(error), status=_status(error))
        raise
    progress.tell("done")


def _compare(args):
    frames = _frames(args)
    tools.load("compare", "compare").compare(
        _scene(args), args.output, seed=args.seed, quadrants_only=args.quadrants, frames=frames,
        values=_changes(args), samples=args.samples, size=args.size, uniform=args.uniform, mips=args.mips,
        blender=args.blender, say=say, verbose=args.verbose)


def _composite(args):
    asked = substitutes.given(args.asked)
    if args.check:
        faults = []
        for text, fault in check(args.layers, _frames(args), asked, view_layer=args.view_layer, renderer=args.renderer,
                                 allow_paths=args.allow_paths, as_png=(args.output or "").lower().endswith(".png")):
            if text:
                print("\n".join(map(shown, text.splitlines())), flush=True)
            faults += [fault] if fault else []
        for fault in faults[:-1]:
            say("error", fault)
        if faults:
            raise EncreError(faults[-1])
        return
    if args.output is None:
        raise EncreError("-o is missing; say where the picture goes")
    changes, frames = _changes(args), _frames(args)
    whole = plan(args.layers, args.output, frames, args.keep_going)
    share, states, jobs = args.share, {}, min(args.jobs, len(whole))

    def tell(frame, state, words=""):
        states[frame] = state
        if words:
            say("note" if state == LEFT else "warning", words)

    if jobs > 1:
        run_jobs(args.argv, args.layers, whole, jobs, args.threads, args.keep_going, tell)
    else:
        restyle(whole, args.output, changes, teller(share[2], whole) if share else tell, share=(share or (0, 1))[:2],
                resume=args.resume, keep_going=args.keep_going, wait=not args.no_wait, seconds=args.lease,
                view_layer=args.view_layer, threads=args.threads, allow_paths=args.allow_paths, asked=asked,
                named=_named(args), renderer=args.renderer)
    if not share:
        sum_up(whole, states)


def _bake(args):
    tile = None if args.tile is None else ("x" in args.tile, "y" in args.tile)
    start = time.perf_counter()
    written = bake(args.texture, args.output, library.check(_changes(args)), args.uniform, args.mips, tile,
                   args.threads, args.blender, say)
    print(shown(f"{', '.join(written)} ({time.perf_counter() - start:.1f} s)"))


def _study(args):
    wanted = [name for name, given in (("SCENE", args.scene), ("--analyse", args.analyse), ("--plan", args.plan))
              if given is not None]
    if len(wanted) != 1:
        raise EncreError("give a scene, --analyse DIR or --plan SHARE: one of the three")
    if args.analyse is not None:
        print("\n".join(map(shown, sessions.analyse(args.analyse).splitlines())))
    elif args.plan is not None:
        print(sessions.planned(args.plan, args.power))
    elif args.output is None and args.play is None:
        raise EncreError("-o is missing; name the folder for the files, one a person")
    else:
        sessions.run(_scene(args), args.output, left=args.left, right=args.right,
                  questions=[sessions.question(text) for text in args.questions], open_=args.open_, slider=args.slider,
                  flights=args.flights.upper(), presses=args.presses, moves=args.moves, values=_changes(args),
                  size=args.size, play=args.play, blender=args.blender, say=say, verbose=args.verbose)


def _params(args):
    if args.json:
        print(json.dumps([_row(p) for p in library.params().values()], indent=1, ensure_ascii=False))
        return
    for stage in library.stages():
        if rows := [p for p in stage.params if not slots.repeats(p)]:
            print(f"{stage.label}: {stage.help}")
            for p in rows:
                print(f"  {p.id} = {_written(p)}  ({_allowed(p)})\n      {p.help}")
            print()
    *some, last = (pen.id for pen in slots.pens()[1:])
    print(f"{', '.join(some)} and {last} have all that {slots.pens()[0].id} has, and other tones all that "
          f"{slots.tones()[0].id} has: {last}_wobble, {slots.tones()[-1].id}_pitch.")


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


COMMANDS = {"render": _render, "submit": _submit, "ask": _ask, "composite": _composite, "bake": _bake,
            "compare": _compare, "study": _study, "params": _params, "presets": _presets}


def _words(error):
    """A sentence; what the system says holds no cure."""
    if isinstance(error, OSError):
        try:
            os.getcwd()
        except OSError:
            return "the folder in which this was started is gone; change into one that is there"
        return f"{error.filename or 'a file'}: {error.strerror or error}; check the path and who may use it"
    return str(error) or "there is not enough memory; give a smaller picture"


def _status(error):
    """The exit status that an error leads to."""
    if isinstance(error, (TryAgain, MemoryError)):
        return AGAIN
    under_way = isinstance(error, (RenderError, images.WriteError)) or not isinstance(error, EncreError)
    return 1 if under_way else 2


def _ready_to_print():
    """A terminal that knows few characters gets the others written out, and a closed stream nothing."""
    for name in ("stdout", "stderr"):
        if getattr(sys, name) is None:
            setattr(sys, name, open(os.devnull, "w"))  # noqa: SIM115 - it stays open
        with contextlib.suppress(AttributeError):
            getattr(sys, name).reconfigure(errors="backslashreplace")


def main(argv=None):
    """Runs the command line `argv` (default: the process's) and returns its exit status."""
    _ready_to_print()
    heard = {}  # what modules warn of, once
    try:
        with warnings.catch_warnings(), np.errstate(over="ignore", invalid="ignore", divide="ignore"):
            # What overflows becomes infinite, and is counted with what is not finite in the input.
            warnings.showwarning = lambda message, *_, **__: heard.setdefault(str(message))
            argv = joined(sys.argv[1:] if argv is None else argv)
            args = parser().parse_args(argv)
            args.argv = argv
            for words in () if getattr(args, "share", None) else shadows.words():
                say("warning", words)
            COMMANDS[args.command](args)
        for words in heard:
            say("warning", words)
        sys.stdout.flush()
        return 0
    except BrokenPipeError:  # the reader of our output left, as `head` does
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return 0
    except (EncreError, MemoryError, OSError) as error:
        say("error", _words(error))
        return _status(error)
    except Exception as error:  # a mistake of ours; no trace of it helps who rendered, its place helps who mends it
        at = traceback.extract_tb(error.__traceback__)[-1]
        say("error", f"this should not happen: {type(error).__name__}: {str(error)[:300]} "
                      f"({os.path.basename(at.filename)}, line {at.lineno}); please report it")
        return 1
