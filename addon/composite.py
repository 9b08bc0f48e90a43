# SPDX-License-Identifier: GPL-3.0-or-later
"""`encre composite`: the stages on the passes of a saved multilayer EXR, without any Blender."""

import numpy as np

from . import core, images, layers

_KNOWN = {**layers.CYCLES, "IndexMA": "X", **layers.SAVED}
_LETTERS = "RGBAXYZW"


def view_layers(channels):
    """{view layer: {classic pass name: [full channel name …]}} in the file's order.

    Blender writes `ViewLayer.Pass.C`; both names may hold dots themselves, so known passes are looked for at the
    end. A file without view layers has the one called "", where R, G, B, A alone are Combined and Z is Depth.
    """
    found = {}
    for full in channels:
        name, _, letter = full.rpartition(".")
        if not name:
            name = {"R": "Combined", "G": "Combined", "B": "Combined", "A": "Combined", "Z": "Depth"}.get(full, full)
        layer, _, last = name.rpartition(".")
        for known in (*_KNOWN, *layers.RENAMED.values()):
            if name == known or name.endswith("." + known):
                layer, last = name[:-len(known)].removesuffix("."), known
        found.setdefault(layer, {}).setdefault(layers.classic(last), []).append(full)
    for passes in found.values():
        for names in passes.values():
            names.sort(key=lambda full: _LETTERS.find(full[-1].upper()))
    return found


def _choose(found, name, path):
    """The view layer called `name`, or the file's first; the compositor's result is not one."""
    if name is None:
        names = [n for n, passes in found.items() if n != "Composite" or set(passes) != {"Combined"}]
        return (names or list(found))[0]
    if name not in found:
        raise core.EncreError(f"{path}: " + core.unknown("view layer", name, [n or '""' for n in found]))
    return name


def _wanted(passes, path):
    """{pass: channels} that have to be read: not those that Encre's own passes stand for."""
    wanted = {name: channels for name, channels in passes.items() if name in _KNOWN}
    if "Encre Source" in wanted and "Encre Diffuse" in wanted:
        for name in ("Combined", "DiffDir", "DiffInd"):
            wanted.pop(name, None)
    for name, channels in wanted.items():
        if len(channels) != len(_KNOWN[name]):
            raise core.EncreError(f"{path}: pass {name} has the channels {', '.join(channels)}; "
                                  f"save it with all of {', '.join(_KNOWN[name])}")
    return wanted


def _settings(exr, say):
    """The file's Settings; `say` is told what they leave open."""
    settings = layers.read_metadata(exr.metadata)
    assumed = [text for value, text in ((settings.scene, "all parameters have their defaults"),
                                        (settings.frame, "its own size is the frame"),
                                        (settings.camera, "the camera is a perspective one")) if value is None]
    if assumed:
        say("note", f"{exr.path} does not hold all of Encre's metadata: {', '.join(assumed)}")
    for warning in settings.warnings:
        say("warning", warning)
    # The metadata tell where the display window lies in the frame; a data window may be a part of it.
    window = exr.window
    if settings.frame:
        settings.frame.x += window.x
        settings.frame.y += window.y
    else:  # overscan makes the frame larger than the display window
        left, top = min(window.x, 0), min(window.y, 0)
        settings.frame = core.Frame(max(window.full_width, window.x + window.width) - left,
                                    max(window.full_height, window.y + window.height) - top,
                                    window.x - left, window.y - top)
    return settings


def composite(path, out, change, view_layer=None, threads=0, say=print):
    """Restyles the EXR `path` into `out` (.exr or .png).

    change: the values to set on those in the file; say(kind, sentence) hears notes and
    warnings. Raises EncreError for the input, images.WriteError where `out` can't be written.
    """
    with images.Exr(path, threads) as exr:
        found = view_layers(exr.channels)
        layer = _choose(found, view_layer, path)
        settings = _settings(exr, say)
        scene = core.check({**(settings.scene or {}), **change})
        passes = exr.read(_wanted(found[layer], path))
        names, window = found[layer], exr.window
    styles = [values for _, values in settings.styles]
    try:
        pictures, nonfinite = layers.assemble(passes, scene, styles)
    except core.EncreError as error:
        others = ", ".join(sorted(set(names) - set(passes)))
        raise core.EncreError(f"{path}: {error}" + (f"; also in the file: {others}" if others else "")) from None
    outputs = ("Combined",) if out.lower().endswith(".png") else ("Combined", *layers.DRAWN)
    result = core.render(pictures, scene, styles, settings.camera, settings.frame, outputs, threads,
                         progress=lambda _fraction: True,  # or Ctrl-C waits for the end
                         image=images.read_paper)
    nonfinite += result.nonfinite
    if nonfinite:
        say("warning", f"{path}: {nonfinite} values were NaN or infinite and were read as 0")
    if out.lower().endswith(".png"):
        images.write_png(out, result.images["Combined"], window)
    else:
        images.write_exr(out, _named(result.images, layer, names), window)


def _named(pictures, layer, names):
    """{full channel name: array (H, W)}, named as the input's channels."""
    channels = {}
    for name, picture in pictures.items():
        letters = _KNOWN.get(name) or layers.DRAWN[name]
        prefix = f"{layer}.{name}" if layer else name
        full = names["Combined"] if name == "Combined" and "Combined" in names else [f"{prefix}.{c}" for c in letters]
        channels.update(zip(full, np.moveaxis(picture, 2, 0), strict=True))
    return channels
