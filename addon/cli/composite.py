# SPDX-License-Identifier: GPL-3.0-or-later
"""`encre composite`: the stages on the passes of a saved multilayer EXR, without any Blender."""

from dataclasses import replace
from pathlib import Path

import numpy as np

from ..pen import colour, denoise, layers, library, metadata, saved, slim
from ..pen.errors import EncreError, unknown
from ..pen.job import Frame
from ..pen.params import Chosen
from ..pen.settings import Settings
from ..pen.stored import known, opaque, view_layers, wanted
from . import denoiser, images, interrupt, multilayer, png, room
from .passes import substitutes
from .view import Shown

_COMPOSITED = "Composite"  # how Blender calls the compositor's picture among the view layers
_PICTURES = {"combined", "beauty", "rgba", "rgb", "color", "final"}  # how others call theirs
_LEAST = 21  # floats of a pixel that are always kept: the layers that are required, and what is drawn
_AT_ONCE = 1 << 22  # pixels of noisy light that are read at a time


def packer(exr, keep=()):
    """The slim.Packer of an open file."""
    return slim.Packer(view_layers(exr.channels, exr.views), lambda passes: wanted(passes, exr.path, True), exr.kinds,
                       metadata.read(exr.metadata).camera, keep)


def _has_picture(passes):
    return "Combined" in passes or "Encre Source" in passes


def _choose(found, name, path):
    """The view layer called `name`, or the file's first; the compositor's result is not one."""
    if name is None:
        names = [n for n, eyes in found.items()
                 if n != _COMPOSITED or any(set(passes) != {"Combined"} for passes in eyes.values())]
        drawn = [n for n in names if any(_has_picture(passes) for passes in found[n].values())]
        return (drawn or names or list(found))[0]
    if name not in found:
        raise EncreError(f"{path}: " + unknown("view layer", name, found))
    return name


def _place(stored, window):
    """The frame of what was rendered: the metadata's, or else the display window, which overscan makes larger."""
    x, y, *_ = stored.border or (0, 0)
    if frame := stored.frame:
        return replace(frame, x=frame.x + window.x + x, y=frame.y + window.y + y)
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


def _read(exr, found, settings, place, camera, threads, kept, keep=True):
    """(layers of what was rendered, number of values read as 0) of one view, whose passes have the Names `found`. Bands
    of rows are read and folded one after another: all passes at once would be twice as much. Without `keep` it is only
    found out whether that can be done."""
    rows, columns = place
    # Normals seen are the camera's, the others the world's: without a camera nothing can be told from them.
    whole, nonfinite = layers.Whole(rows.stop - rows.start, columns.stop - columns.start, kept.zeros), 0
    names = found.passes
    read = found.read(exr.path, bool(camera and settings.wants_seen))
    _afford(exr, read, whole.shape)
    mattes = substitutes.Mattes(found.mattes)
    noisy = keep and _denoises(names, settings) and denoiser.available()
    for first, around, passes in (_strips if noisy else _bands)(exr, read, rows):
        passes = {name: opaque(picture[:, columns], name) if name in known() else picture[:, columns]
                  for name, picture in passes.items()}
        clean = denoiser.cleaner(threads, settings.light_scale, first - around[0] - rows.start) if noisy else None
        slim.unpack(passes, camera)
        mattes.number(passes)
        substitutes.fill(passes, settings)
        try:
            band, bad = layers.assemble(passes, settings, saved.unpack(passes), clean)
        except EncreError as error:
            others = ", ".join(sorted(set(names) - set(read))) or "nothing"
            like = next((full[0].rpartition(".")[0] for name, full in names.items() if name.lower() in _PICTURES), "")
            cure = "" if _has_picture(names) else _cure(names, like)
            raise EncreError(f"{exr.path}: {error}; besides in the file: {others}{cure}") from None
        if keep:
            whole.add(first - rows.start, {name: picture[around[0]:len(picture) - around[1]]
                                           for name, picture in band.items()})
        nonfinite += bad
        passes.clear()  # not kept while the next are read
        band.clear()
        kept.give_back()
    return whole.layers, nonfinite


def _afford(exr, read, shape):
    """Finds out whether there is room for the least that is kept of a view. Raises EncreError."""
    kept = sum(len(names) for name, names in read.items()
               if name.startswith("Encre ") and name not in ("Encre Source", "Encre Diffuse"))
    size = 4 * shape[0] * shape[1] * (_LEAST + kept)
    room.afford(exr.path, size, size if shape[0] * shape[1] >= room.LARGE else 0)


def _cure(names, like):
    """What to do where there is no picture. like: the pass that seems to be it, "": none does."""
    if like:
        return f"; if {like} is the picture: --layer combined={like}"
    if names.keys() & {"Y", "y"}:
        return "; Y is a picture in gray: save it with R, G and B"
    return "; depth alone is no picture: save both in one file" if names.keys() == {"Depth"} else ""


def _bands(exr, wanted, rows):
    """(row, (0, 0), passes) of bands of rows, none of which is kept here while the next is read."""
    return map(lambda band: (band[0], (0, 0), band[1]), exr.bands(wanted, rows.start, rows.stop))


def _strips(exr, wanted, rows):
    """Yields (row, how many more above and below, passes) of strips of rows, with as many more as the denoiser sees."""
    step = max(_AT_ONCE // exr.window.width // denoise.REACH, 1) * denoise.REACH
    for first in range(rows.start, rows.stop, step):
        end = min(first + step, rows.stop)
        above, below = min(denoise.REACH, first - rows.start), min(denoise.REACH, rows.stop - end)
        passes = exr.read(wanted, first - above, end + below)
        for picture in passes.values():
            _forget_nonfinite(picture[:above])
            _forget_nonfinite(picture[len(picture) - below:])
        del picture
        yield first, (above, below), passes
        del passes  # not while the next are read


def _forget_nonfinite(margin):
    """What is not finite around a strip is counted where it is drawn."""
    np.copyto(margin, 0, where=~np.isfinite(margin))


def _denoises(names, settings):
    """Whether light that Encre has not cleaned yet is compared with thresholds: its noise would show as speckle."""
    return settings.denoises and "Encre Diffuse" not in names and {"DiffDir", "DiffCol"} <= names.keys()


def _allowed(settings, change, path, allow_paths, stored):
    """The values of the scene and the styles, (name, values), with images that may be opened: a stranger's file is not
    to choose what else is read. `stored`: {Chosen: pixels} of those that it holds itself."""
    read = set(settings.images)

    def allow(values, own):
        """own: what the user has set of them."""
        return {id_: image(Chosen(id_, value), own) if library.params()[id_].type == "image" else value
                for id_, value in values.items()}

    def image(chosen, own):
        if chosen not in read:
            return None
        if own.get(chosen.id) or chosen in stored:
            return chosen.name
        beside = Path(path).resolve().parent
        place = str(beside / chosen.name)
        if not allow_paths and not Path(place).resolve().is_relative_to(beside):
            raise EncreError(f"{path}: names the {chosen.id.replace('_', ' ')} {place}, which does not lie beside it; "
                             f"give --allow-paths if you trust the file, or --set {chosen.id}=PATH")
        return place

    return allow(settings.scene, change), [(name, allow(values, {})) for name, values in settings.styles]


def _composited(exr, found, layer):
    """Whether the compositor made another picture than it had of a view layer."""
    for view, names in found.get(_COMPOSITED, {}).items() if layer != _COMPOSITED else ():
        pair = {"made": names.get("Combined", ()), "had": found[layer].get(view, {}).get("Combined", ())}
        if len(pair["made"]) != len(pair["had"]) or any(
                not np.array_equal(band["made"], band["had"], equal_nan=True)
                for _, band in exr.bands(pair, 0, exr.window.height)):
            return True
    return False


def check(path, view_layer=None, asked=None, renderer=None, allow_paths=False, as_png=False):
    """(text that lists which passes an EXR holds and what each that is missing switches off, why composite() can't draw
    it or None): it is read as that reads it, to its end."""
    with multilayer.Exr(path) as exr:
        found = view_layers(exr.own, exr.views)
        lines = []
        for layer in [_choose(found, view_layer, path)] if view_layer is not None else found:
            view, passes = next(iter(found[layer].items()))
            if layer == _COMPOSITED and set(passes) == {"Combined"} and view_layer is None and len(found) > 1:
                lines += [f"{path}: {layer}, what the compositor made, is not drawn again"]
                continue
            names = substitutes.Names(exr, passes, layer, view, asked or {}, renderer)
            lines += [f"{path}: view layer {layer}" if layer else path, *substitutes.listed(names)]
        try:
            _Work(exr, {}, allow_paths, asked or {}, 0, as_png, (), renderer).draw(view_layer, only_look=True)
        except EncreError as error:
            return "\n".join(lines), str(error)
    return "\n".join(lines), None


def images_of(path, change, allow_paths=False):
    """Paths of the image files that composite() would read for an EXR. Raises EncreError."""
    with multilayer.Exr(path) as exr:
        stored = metadata.read(exr.metadata)
    settings = Settings({**(stored.scene or {}), **change}, stored.styles)
    settings = Settings(*_allowed(settings, change, path, allow_paths, stored.images))
    return [chosen.name for chosen in settings.images if chosen not in stored.images]


def composite(path, out, change, view_layer=None, threads=0, say=print, allow_paths=False, asked=None, texts=None,
              named=(), renderer=None):
    """Restyles the EXR `path` into `out` (.exr or .png).

    change: the values to set on those in the file; say(kind, sentence) hears notes and warnings; allow_paths: open
    images that the file names wherever they lie; asked: {classic pass name: name in the file} where that is another,
    or a file of its own; renderer: whose names of passes it has, None: whose is clear; texts: {key: text} to store in
    `out`; named: ids of which it is said if they change nothing. Without a view layer's name all are drawn, into a .png
    the first. Raises EncreError for the input, images.WriteError where `out` can't be written.
    """
    with multilayer.Exr(path, threads) as exr:
        work = _Work(exr, change, allow_paths, asked or {}, threads, out.lower().endswith(".png"), named, renderer)
        work.draw(view_layer)
    for kind, text in work.said:
        say(kind, text)
    stored = work.stored
    if work.as_png:
        matrix = colour.to_rec709(exr.metadata.get(colour.INTEROP, ""))
        if matrix is not None:
            work.picture[..., :3] = work.picture[..., :3] @ matrix.T.astype(np.float32)
        shown = Shown(stored.view or metadata.View(), matrix is not None)
        if words := shown.lacks() if stored.view else "the scene's exposure and view transform are not told: the PNG " \
                "is Standard, without exposure":
            say("note", f"{path}: {words}")
        png.write(out, work.picture, exr.window, texts, shown)
    else:
        named = {key: exr.metadata[key] for key in (colour.INTEROP,) if key in exr.metadata}
        multilayer.write(out, work.channels, exr.window, exr.views, {**named, **(texts or {})})


class _Work:
    """What is drawn of a file: `channels` {full name: array (H, W)}, `picture`, the last Combined, and `said`, the keys
    of which are what there is to say."""

    def __init__(self, exr, change, allow_paths, asked, threads, as_png, named, renderer):
        self.exr, self.change, self.asked, self.threads, self.as_png = exr, change, asked, threads, as_png
        self.renderer = renderer
        for name in asked.values():
            if path := substitutes.in_file(name)[0]:
                exr.beside(path)
        self.channels, self.said, self.nonfinite = {}, {}, 0
        self.stored = metadata.read(exr.metadata)
        if "layer_source" not in named:  # which a preset says of what is rendered
            change = {id_: value for id_, value in change.items() if id_ != "layer_source"}
        scene = {**(self.stored.scene or {}), **change}
        if (factor := scene.pop("supersample", 1)) > 1:
            self._say("note", f"supersample {factor} needs a render: {exr.path} holds layers of the frame's size, and "
                              "is drawn at that")
        space = exr.metadata.get(colour.INTEROP, "")
        settings = Settings(scene, self.stored.styles, space)
        self.held = Settings(self.stored.scene)
        if (value := settings.every[0]["layer_source"]) != self.held.every[0]["layer_source"]:
            self._say("note", f"layer_source {value} needs a render: {exr.path} is drawn as its layers are")
        self.settings = Settings(*_allowed(settings, change, exr.path, allow_paths, self.stored.images), space)
        self._say("note", settings.in_vain(named))
        self.place = _rows_and_columns(self.stored.border, exr.window)
        self.room = room.Room(exr.window.width * exr.window.height)

    def _image(self, chosen):
        own = self.change.get(chosen.id) == chosen.name
        return images.read_chosen(chosen) if own or chosen not in self.stored.images else self.stored.images[chosen]

    def _say(self, kind, sentence):
        if sentence:
            self.said[kind, sentence] = None

    def draw(self, view_layer, only_look=False):
        """Draws the view layer of this name, or all; only_look: finds out whether it can be."""
        exr, found = self.exr, view_layers(self.exr.own, self.exr.views)
        first = _choose(found, view_layer, exr.path)
        # What --layer names lies in one of them, whose name is not told.
        others = [name for name, eyes in found.items() if any(map(_has_picture, eyes.values()))
                  and name not in (first, _COMPOSITED) and view_layer is None and not self.asked]
        if others and self.as_png:
            self._say("note", f"{exr.path}: view layer {first} is drawn, and not {', '.join(others)}; choose by "
                              "--view-layer, or write an .exr, which has room for all")
            others = []
        for layer in [name for name in found if name in (first, *others)]:
            eyes = {view: substitutes.Names(exr, passes, layer, view, self.asked, self.renderer)
                    for view, passes in found[layer].items()}
            eyes = {view: names for view, names in eyes.items() if _has_picture(names.passes)} or eyes
            if self.as_png and len(eyes) > 1:
                raise EncreError(f"{exr.path}: is stereo, and a PNG has one view; write an .exr")
            for view, names in eyes.items():
                self._draw(layer, view, names, f"{exr.path}, view layer {layer}," if others else exr.path, only_look)
        if only_look:
            return
        if _composited(exr, found, first):
            self._say("note", f"{exr.path}: what the compositor made ({_COMPOSITED}.Combined) is not drawn again, as "
                              "its nodes run in Blender alone: composite the new Combined by them")
        for warning in self.stored.warnings:
            self._say("warning", warning)
        if self.nonfinite:
            self._say("warning", f"{exr.path}: {self.nonfinite} values were NaN or infinite and were read as 0")
        if self.stored.lost:
            self._say("note", f"{exr.path}: {' and '.join(self.stored.lost)} in Combined are not drawn again")

    def _draw(self, layer, view, found, where, only_look):
        stored, window, names = self.stored, self.exr.window, found.passes
        settings, missing = substitutes.switch_off(names, self.settings)
        read, bad = _read(self.exr, found, settings, self.place, stored.camera, self.threads, self.room, not only_look)
        if only_look:
            return
        if (layer, view) in stored.chains:
            read["chains"] = stored.chains[layer, view]
        self._say("note", found.words(where, self.asked))
        self._say("note", _notes(stored, names, where))
        if _denoises(names, settings) and not denoiser.available():
            cure = "; rendered with light_source=DRAWN it has none" if stored.scene is not None else ""
            self._say("note", f"{where} holds light as it was rendered, and Open Image Denoise is not installed here: "
                              f"its noise stays{cure}")
        light = settings.every[0]["light_source"]
        if settings.wants_light and light != self.held.every[0]["light_source"] and not self.held.fast \
                and substitutes.lit(names) and np.ptp(read["diffuse"]):
            held = "Cycles' light" if light == "DRAWN" else "light that Encre has drawn"
            self._say("note", f"light_source {light} needs a render: {where} holds {held}, which is kept")
        self._say("note", settings.blots(_place(stored, window).height))
        self._say("note", missing and f"{where} has {'; '.join(missing)}")
        if old := saved.tells_no_lines(names, "chains" in read, settings):
            self._say("note", f"{where} has {old}")
        self._say("note", _idle(read, settings, where))
        if behind := np.count_nonzero(read["depth"] < 0):
            self._say("warning", f"{where}: the depth of {behind} pixels is negative, behind the camera: lines between "
                                 "them may be missing or too many; save it growing away from the camera")
        with interrupt.heeded() as progress:
            def go_on(fraction):
                self.room.give_back()
                return progress(fraction)

            try:
                result = library.draw(read, settings.every, stored.camera, _place(stored, window),
                                      ("Combined", *(() if self.as_png else _drawn(settings))), self.threads,
                                      progress=go_on, image=self._image,
                                      empty=self.room.zeros)
            except EncreError as error:
                raise EncreError(f"{where}: {error}") from None
        del read
        pictures = {name: _whole(picture, self.place, window) for name, picture in result.images.items()}
        self.picture = pictures["Combined"]
        self.channels.update(_named(pictures, layer, view, names))
        self.nonfinite += bad + result.nonfinite


def _drawn(settings):
    """Names of the pictures beside Combined that go into a file: without tones theirs would be empty."""
    return [name for name in layers.DRAWN if name != "Encre Tones" or settings.any("use_tones")]


def _named(pictures, layer, view, names):
    """{full channel name: array (H, W)}, named as the input's channels."""
    channels, letters = {}, {**known(), **layers.DRAWN}
    for name, picture in pictures.items():
        prefix = ".".join(filter(None, [layer, name, view]))
        if name == "Combined" and (own := [full for full in names.get(name, ())
                                      if full[-1] in "rR" and ".exr:" not in full]):
            prefix = own[0].rpartition(".")[0]
        full = [f"{prefix}.{letter}".removeprefix(".") for letter in letters[name]]
        channels.update(zip(full, np.moveaxis(picture, 2, 0), strict=True))
    return channels
