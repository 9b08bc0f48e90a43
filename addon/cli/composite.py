# SPDX-License-Identifier: GPL-3.0-or-later
"""`encre composite`: the stages on the passes of a saved multilayer EXR, without any Blender."""

import numpy as np

from ..pen import layers, library, metadata, saved
from ..pen.errors import EncreError, unknown
from ..pen.job import Frame
from ..pen.settings import Settings
from . import images, interrupt

_LETTERS = "RGBAXYZW"
_BARE = {**dict.fromkeys("RGBA", "Combined"), "Z": "Depth"}


def _known():
    """{classic pass name: channel letters} of all that is read."""
    return {**layers.CYCLES, "IndexMA": "X", **saved.passes(True), **layers.SEEN}


def view_layers(channels, views=()):
    """{view layer: {view: {classic pass name: [full channel name …]}}} in the file's order.

    Blender writes `ViewLayer.Pass.C`, in stereo `ViewLayer.Pass.view.C`; both names may hold dots themselves, so
    known passes are looked for at the end. A picture without view layers or views has the one called "", where
    R, G, B, A alone are Combined and Z is Depth.
    """
    found, names = {}, (*_known(), *layers.RENAMED.values())
    for full in channels:
        name, _, letter = full.rpartition(".")
        view = next((view for view in views if name.rpartition(".")[2] == view), "")
        name = name.removesuffix(view).removesuffix(".") or _BARE.get(letter, letter)
        layer, _, last = name.rpartition(".")
        for known in names:
            if name == known or name.endswith("." + known):
                layer, last = name[:-len(known)].removesuffix("."), known
        passes = found.setdefault(layer, {}).setdefault(view, {})
        passes.setdefault(layers.classic(last), []).append(full)
    for eyes in found.values():
        for passes in eyes.values():
            for fulls in passes.values():
                fulls.sort(key=lambda full: _LETTERS.find(full[-1].upper()))
    return found


def _choose(found, name, path):
    """The view layer called `name`, or the file's first; the compositor's result is not one."""
    if name is None:
        names = [n for n, eyes in found.items()
                 if n != "Composite" or any(set(passes) != {"Combined"} for passes in eyes.values())]
        return (names or list(found))[0]
    if name not in found:
        raise EncreError(f"{path}: " + unknown("view layer", name, found))
    return name


def _wanted(passes, path, seen):
    """{pass: channels} that have to be read: not those that Encre's own passes stand for, what is `seen` if asked."""
    letters = _known()
    wanted = {name: channels for name, channels in passes.items()
              if name in letters and (seen or name not in {*layers.SEEN, "Encre Seen Depth"})}
    if "Encre Seen Depth" in wanted:
        wanted.pop("Denoising Depth", None)
    if "Encre Source" in wanted and "Encre Diffuse" in wanted:
        for name in ("Combined", "DiffDir", "DiffInd"):
            wanted.pop(name, None)
    for name, channels in wanted.items():
        if len(channels) != len(letters[name]):
            raise EncreError(f"{path}: pass {name} has the channels {', '.join(channels)}; "
                                  f"save it with all of {', '.join(letters[name])}")
    return wanted


def _place(stored, window):
    """The frame of what was rendered: the metadata's, or else the display window, which overscan makes larger."""
    x, y, *_ = stored.border or (0, 0)
    if frame := stored.frame:
        return Frame(frame.width, frame.height, frame.x + window.x + x, frame.y + window.y + y)
    left, top = min(window.x, 0), min(window.y, 0)
    return Frame(max(window.full_width, window.x + window.width) - left,
                      max(window.full_height, window.y + window.height) - top, window.x - left + x, window.y - top + y)


def _rows_and_columns(border, window):
    """The pixels that were rendered, as a pair of slices; all without a border."""
    if not border:
        return np.s_[0:window.height, 0:window.width]
    x, y, width, height = border
    if x + width > window.width or y + height > window.height:
        raise EncreError(f"the metadata {metadata.BORDER} lie outside the picture; render it again, or remove "
                              "them")
    return np.s_[y:y + height, x:x + width]


def _whole(picture, at, window):
    """`picture` in its place, nothing around it, as Blender saves a border."""
    if picture.shape[:2] == (window.height, window.width):
        return picture
    out = np.zeros((window.height, window.width, picture.shape[2]), np.float32)
    out[at] = picture
    return out


def _notes(stored, passes, path):
    """What the file leaves open, in one sentence; None: nothing."""
    assumed = [text for known, text in (
        (stored.scene is not None, "all parameters start from their defaults"),
        (stored.frame, "its own size is the frame"),
        (stored.camera, "the camera is a perspective one"),
        ("Encre Source" in passes, "Combined is taken as the picture without Encre")) if not known]
    return f"{path} does not hold all that Encre saves: {', '.join(assumed)}" if assumed else None


def _idle(pictures, settings, path):
    """Which sources of edges have nothing to work on, in one sentence; None: all have."""
    found = ", ".join(f"{name} ({why})" for name, why in settings.idle(pictures).items())
    return f"{path} gives these sources of lines nothing to work on: {found}" if found else None


def _read(exr, names, settings, place, seen):
    """(layers of what was rendered, number of values read as 0, names of the passes) of one view, whose passes have
    these `names`. Bands of rows are read and folded one after another: all passes at once would be twice as much."""
    rows, columns = place
    whole, nonfinite = layers.Whole(rows.stop - rows.start, columns.stop - columns.start), 0
    wanted = _wanted(names, exr.path, seen)
    for first, passes in exr.bands(wanted, rows.start, rows.stop):
        passes = {name: picture[:, columns] for name, picture in passes.items()}
        try:
            band, bad = layers.assemble(passes, settings, saved.unpack(passes))
        except EncreError as error:
            others = ", ".join(sorted(set(names) - set(wanted))) or "nothing"
            raise EncreError(f"{exr.path}: {error}; besides in the file: {others}") from None
        whole.add(first - rows.start, band)
        nonfinite += bad
        passes.clear()  # not kept while the next are read
        band.clear()
    return whole.layers, nonfinite, wanted


def composite(path, out, change, view_layer=None, threads=0, say=print):
    """Restyles the EXR `path` into `out` (.exr or .png).

    change: the values to set on those in the file; say(kind, sentence) hears notes and warnings. Raises
    EncreError for the input, images.WriteError where `out` can't be written.
    """
    png, channels, nonfinite, notes = out.lower().endswith(".png"), {}, 0, []
    with images.Exr(path, threads) as exr:
        stored = metadata.read(exr.metadata)
        scene = {**(stored.scene or {}), **change}
        if (factor := scene.pop("supersample", 1)) > 1:
            say("note", f"supersample {factor} needs a render: {path} holds layers of the frame's size, and is drawn "
                        "at that")
        settings = Settings(scene, stored.styles)
        found = view_layers(exr.channels, exr.views)
        layer = _choose(found, view_layer, path)
        place = _rows_and_columns(stored.border, exr.window)
        if png and len(found[layer]) > 1:
            raise EncreError(f"{path}: is stereo, and a PNG has one view; write an .exr")
        # Normals seen are the camera's, the others the world's: without a camera nothing can be told from them.
        seen = stored.camera is not None and settings.wants_seen
        for view, names in found[layer].items():
            read, bad, passes = _read(exr, names, settings, place, seen)
            notes = notes or [_notes(stored, passes, path), _idle(read, settings, path)]
            with interrupt.heeded() as progress:
                result = library.draw(read, settings.every, stored.camera, _place(stored, exr.window),
                                      ("Combined",) if png else ("Combined", *layers.DRAWN), threads,
                                      progress=progress, image=images.read_paper)
            del read
            pictures = {name: _whole(picture, place, exr.window) for name, picture in result.images.items()}
            channels.update(_named(pictures, layer, view, names))
            nonfinite += bad + result.nonfinite
            del result
    for kind, text in [*(("note", note) for note in notes), *(("warning", warning) for warning in stored.warnings)]:
        if text:
            say(kind, text)
    if nonfinite:
        say("warning", f"{path}: {nonfinite} values were NaN or infinite and were read as 0")
    if png:
        images.write_png(out, pictures["Combined"], exr.window)
    else:
        images.write_exr(out, channels, exr.window, exr.views)


def _named(pictures, layer, view, names):
    """{full channel name: array (H, W)}, named as the input's channels."""
    channels, letters = {}, {**_known(), **layers.DRAWN}
    for name, picture in pictures.items():
        prefix = ".".join(filter(None, [layer, name, view]))
        full = names["Combined"] if name == "Combined" and "Combined" in names else [
            f"{prefix}.{letter}" for letter in letters[name]]
        channels.update(zip(full, np.moveaxis(picture, 2, 0), strict=True))
    return channels
