# SPDX-License-Identifier: GPL-3.0-or-later
"""Multilayer OpenEXR files, through OpenImageIO: in by bands of rows, out whole."""

import contextlib
import os
from dataclasses import dataclass

import numpy as np

from ..pen.errors import EncreError
from . import images, planes

MOST_PACKED = 2000  # values in a byte of a file: no compression does better than a fourth of that
_AT_ONCE = 1 << 29  # bytes


@dataclass(frozen=True)
class Window:
    """Where an EXR's pixels lie: size and place of the data window in the display window (full_*)."""

    width: int
    height: int
    x: int
    y: int
    full_width: int
    full_height: int


@dataclass(frozen=True)
class _Part:
    """One of a file's, and its data window from the corner of the display window."""

    file: object
    number: int
    x: int
    y: int
    width: int
    height: int


class Exr:
    """An open EXR: `channels` maps each channel's full name to its (part, number), in the file's order, `kinds` to
    "half", "float" or "uint"; `own` are those of the file itself; `views` names the eyes of a stereo picture, else ();
    `metadata` holds the text attributes. `window` holds the data windows of all parts; a part is 0 beyond its own. Use
    as a context manager.

    Raises EncreError for a file that is missing, unreadable, empty or deep, or whose parts are not of one frame.
    """

    def __init__(self, path, threads=0):
        oiio = images.openimageio()
        if threads:
            oiio.attribute("threads", threads)
            oiio.attribute("exr_threads", threads)
        self.path, self.channels, self.kinds, self.views, self.metadata = path, {}, {}, (), {}
        self._files, self._parts, self._size, self._beside, self.own = [], [], None, set(), []
        try:
            self._open(path)
        except BaseException:
            self.close()
            raise

    @property
    def window(self):
        x, y = (min(getattr(part, axis) for part in self._parts) for axis in "xy")
        return Window(max(part.x + part.width for part in self._parts) - x,
                      max(part.y + part.height for part in self._parts) - y, x, y, *self._size)

    def beside(self, path):
        """Opens another file of the same frame, unless it is. Its channels are called `PATH:NAME`."""
        if path not in self._beside:
            self._open(path, f"{path}:")
            self._beside.add(path)

    def _open(self, path, prefix=""):
        oiio = images.openimageio()
        images.check_source(path)
        with images.quiet():
            file = oiio.ImageInput.open(images.utf8(path))
        why = images.complaint(oiio).splitlines()
        if not file or file.format_name() != "openexr":
            reason = f" ({why[0].rstrip(' .')[:200]})" if why and "subsampled" in why[0].lower() else ""
            raise EncreError(f"{path}: is not a readable OpenEXR file{reason}; give a multilayer EXR")
        self._files.append(file)
        number, most, deep, before = 0, MOST_PACKED * os.path.getsize(path), False, len(self._parts)
        try:
            while file.seek_subimage(number, 0):
                spec = file.spec()
                deep = deep or spec.deep
                if not spec.deep:
                    self._add(path, prefix, _Part(file, number, spec.x - spec.full_x, spec.y - spec.full_y, spec.width,
                                                  spec.height), spec)
                    most -= spec.width * spec.height * spec.nchannels
                number += 1
        except UnicodeDecodeError:
            raise EncreError(f"{path}: holds names that are not UTF-8; render or copy it again") from None
        if len(self._parts) == before:
            raise EncreError(f"{path}: holds deep pixels, of which each has several depths; flatten it, or render it "
                             "flat" if deep else f"{path}: is not a readable OpenEXR file; give a multilayer EXR")
        if most < 0:  # a damaged or made-up size would have us ask for all memory
            raise EncreError(f"{path}: says that it holds more pixels than such a file can; render or copy it again")

    def _add(self, path, prefix, part, spec):
        # The display window starts where the file says; only the distance between the two windows matters.
        if min(spec.width, spec.height) < 1:
            raise EncreError(f"{path}: has no pixels; render it again")
        size = spec.full_width, spec.full_height
        if self._size not in (None, size):
            raise EncreError(f"{path}: its parts differ in size; save all passes in one size" if not prefix else
                             f"{path}: is {size[0]} x {size[1]}, and {self.path} {self._size[0]} x {self._size[1]}; "
                             "render both in one size")
        self._size = size
        # One part holds all views, and says so; or each part holds one, and its channels do not name it.
        view = spec.get_string_attribute("view")
        if not prefix:
            self.views = tuple(dict.fromkeys([*self.views, *(spec.getattribute("multiView") or ()),
                                              *filter(None, [view])]))
        for number, name in enumerate(spec.channelnames):
            if view and not prefix:
                name = ".".join([*name.split(".")[:-1], view, name.split(".")[-1]])
            kind = str(spec.channelformat(number))
            self.own += [] if prefix or name in self.channels else [name]
            self.channels.setdefault(prefix + name, (len(self._parts), number))
            self.kinds.setdefault(prefix + name, kind if kind in ("half", "uint") else "float")
        self._parts.append(part)
        for attribute in spec.extra_attribs:
            with contextlib.suppress(UnicodeDecodeError):  # another program's, in another encoding
                if isinstance(attribute.value, str) and (not prefix or attribute.name.startswith("cryptomatte/")):
                    self.metadata.setdefault(attribute.name, attribute.value)

    def read(self, passes, first=0, end=None):
        """{name: array (rows, W, channels)}, float32, row 0 at the top, of {name: [full channel name …]}: the rows from
        `first` to `end`, else all."""
        end = self.window.height if end is None else end
        out = {name: np.empty((end - first, self.window.width, len(channels)), np.float32)
               for name, channels in passes.items()}
        for row, band in self.bands(passes, first, end):
            for name, picture in band.items():
                out[name][row - first:row - first + len(picture)] = picture
        return out

    def bands(self, passes, first, end):
        """Yields (row, {name: array (rows, W, channels)}) of bands of the rows from `first` to `end`, else as read().

        Every chunk is decompressed once, whatever the number of channels wanted from it.
        """
        places = {name: [self.channels[channel] for channel in channels] for name, channels in passes.items()}
        parts = {}
        for part, number in sorted(place for wanted in places.values() for place in wanted):
            parts.setdefault(part, []).append(number)
        for top in range(first - first % images.ROWS, end, images.ROWS):
            row, below = max(top, first), min(top + images.ROWS, end)
            rows = {part: self._rows(part, row, below, numbers[0], numbers[-1] + 1) for part, numbers in parts.items()}
            band = {name: _together([(rows[part], number - parts[part][0]) for part, number in wanted])
                    for name, wanted in places.items()}
            del rows
            yield row, band
            del band  # not while the next is read

    def _rows(self, number, row, end, first, last):
        """The channels `first` to `last` of the rows from `row` to `end` of a part, float32 (rows, W, channels)."""
        part, window = self._parts[number], self.window
        x, y = part.x - window.x, part.y - window.y
        above, below = max(row, y), min(end, y + part.height)
        if (above, below, part.width) == (row, end, window.width):
            return self._read(part, row - y, end - y, first, last)
        out = np.zeros((end - row, window.width, last - first), np.float32)
        if above < below:
            out[above - row:below - row, x:x + part.width] = self._read(part, above - y, below - y, first, last)
        return out

    @images.quiet()
    def _read(self, part, row, end, first, last):
        """Likewise, rows and columns of the part's own window."""
        part.file.seek_subimage(part.number, 0)
        spec = part.file.spec()
        pixels = self._stored(part, spec, row, end, first, last, "float")
        for channel in range(first, last):
            if str(spec.channelformat(channel)) == "uint":  # not as shares of the largest
                pixels[..., channel - first:channel - first + 1] = self._stored(part, spec, row, end, channel,
                                                                                channel + 1, "uint")
        return pixels

    def _stored(self, part, spec, row, end, first, last, kind):
        above, below = row, end
        if spec.tile_width:  # whole tiles, or to the picture's end
            above, below = row - row % spec.tile_height, min(end + -end % spec.tile_height, spec.height)
            pixels = part.file.read_tiles(part.number, 0, spec.x, spec.x + spec.width, spec.y + above, spec.y + below,
                                          0, 1, first, last, kind)
        else:
            pixels = part.file.read_scanlines(part.number, 0, spec.y + above, spec.y + below, 0, first, last, kind)
        if pixels is None:
            images.complaint(part.file)
            raise EncreError(f"{self.path}: can't be read to its end; render or copy it again")
        return pixels.reshape(below - above, spec.width, last - first)[row - above:][:end - row]

    def close(self):
        while self._files:
            self._files.pop().close()

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.close()


def _together(places):
    """(H, W, channels) of (pixels (H, W, any), channel in them) each; a view where they lie side by side."""
    pixels, first = places[0]
    if all(other is pixels and channel == first + k for k, (other, channel) in enumerate(places)):
        return pixels[..., first:first + len(places)]
    return np.stack([pixels[..., channel] for pixels, channel in places], axis=-1)


def write(path, channels, window, views=(), texts=None):
    """Writes {full channel name: array (H, W)} as one part of 32-bit floats with {key: text}, whole or not at all.

    Raises images.WriteError where the file can't be written.
    """
    spec = _spec(window, list(channels), dict.fromkeys(channels, "float"), views, texts or {})
    rows = ((y, np.stack([picture[y:y + images.ROWS] for picture in channels.values()], axis=2))
            for y in range(0, window.height, images.ROWS))
    with images.writing([path]) as place:
        _fill(path, os.path.join(place.path, os.path.basename(path)), spec, rows)
        place.take(os.path.basename(path), path)


def _spec(window, names, kinds, views, texts):
    oiio = images.openimageio()
    spec = oiio.ImageSpec(window.width, window.height, len(names), "float")
    spec.x, spec.y, spec.full_width, spec.full_height = window.x, window.y, window.full_width, window.full_height
    spec.channelnames = tuple(names)
    if "half" in kinds.values():
        spec.channelformats = tuple(oiio.TypeDesc(kinds[name]) for name in names)
    spec["compression"] = "zip:6"  # two per cent smaller than by the default, 4
    for key, said in texts.items():
        spec[key] = said
    if views:
        spec.attribute("multiView", oiio.TypeDesc(f"string[{len(views)}]"), views)
    return spec


def _fill(path, part, spec, bands):
    """Writes the file `part`, which is to become `path`, of (row, array (rows, W, channels)). Raises images.WriteError.
    """
    out = images.openimageio().ImageOutput.create(part)
    good = out.open(part, spec)
    for y, rows in bands if good else ():
        good = good and out.write_scanlines(spec.y + y, spec.y + y + len(rows), 0, rows)
    if not (out.close() and good):
        raise images.unwritten(path, out, part)


def rewrite(exr, part, packer, alive=lambda: None):
    """Writes what a slim.Packer makes of an open Exr into another file, `part`, with the same metadata: each pass as a
    part of its own, which takes less room, or one part where there are views. alive() is called now and then. Raises
    EncreError, WriteError.
    """
    texts = {key: said for key, said in exr.metadata.items()
             if not key.startswith(("oiio:", "openexr:")) and key not in ("compression", "name", "view")}
    parts = {name: [name] for name in packer.parts} if not exr.views else {"": list(packer.parts)}
    specs = []
    for name, passes in parts.items():
        kinds = {full: kind for each in passes for full, kind in packer.parts[each].items()}
        specs.append(_spec(exr.window, list(kinds), kinds, exr.views, {} if specs else texts))
        if name:
            specs[-1]["oiio:subimagename"] = name
    out = images.openimageio().ImageOutput.create(part)
    good = out.open(part, specs) if len(specs) > 1 else out.open(part, specs[0])
    for number, rows in enumerate(_packed(exr, packer, list(parts.values()))):
        good = good and (not number or out.open(part, specs[number], "AppendSubimage"))
        good = good and out.write_image(rows)
        del rows  # not while the next are made
        alive()
    if not (out.close() and good):
        raise images.unwritten(exr.path, out, part)


def _packed(exr, packer, parts):
    """Yields the pixels (H, W, channels) of each of the parts, which are lists of passes."""
    try:
        with planes.Planes(exr.path) as found:
            if all(name in found for each in packer.parts for name in packer.sources(each)):
                for passes in parts:
                    yield _made(packer, passes, exr.window, found)
                return
    except ValueError as reason:
        if str(reason) == planes.MISSING:
            raise EncreError(f"{exr.path}: can't be read to its end; render or copy it again") from None
    yield from _unpacked(exr, packer, parts)


def _kinds(packer, passes):
    return [kind for each in passes for kind in packer.parts[each].values()]


def _empty(kinds, window):
    kind = np.float16 if {*kinds} == {"half"} else np.float32
    return np.empty((window.height, window.width, len(kinds)), kind)


def _made(packer, passes, window, found):
    """Of a file that is mapped, one part at a time."""
    picture = _empty(_kinds(packer, passes), window)
    for y in range(0, window.height, images.ROWS):
        k, end = 0, min(y + images.ROWS, window.height)
        for each in passes:
            rows = [np.asarray(found[name][y:end], np.float32) for name in packer.sources(each)]
            for row in packer.pack(each, rows).values():
                picture[y:end, :, k] = row
                k += 1
    return picture


def _unpacked(exr, packer, parts):
    """Of another, as many as fit into some memory, for each time the whole file is read."""
    while parts:
        kinds, size, count = [], 0, 0
        for passes in parts:
            kinds.append(_kinds(packer, passes))
            size += exr.window.height * exr.window.width * len(kinds[-1]) * (2 if {*kinds[-1]} == {"half"} else 4)
            if count and size > _AT_ONCE:
                break
            count += 1
        now, parts = parts[:count], parts[count:]
        pictures = [_empty(own, exr.window) for own, _ in zip(kinds, now, strict=False)]
        sources = {each: packer.sources(each) for passes in now for each in passes}
        for y, band in exr.bands(sources, 0, exr.window.height):
            for passes, picture in zip(now, pictures, strict=True):
                rows = [row for each in passes
                        for row in packer.pack(each, np.moveaxis(band[each], 2, 0)).values()]
                picture[y:y + len(rows[0])] = np.stack(rows, axis=2)
        while pictures:
            yield pictures.pop(0)
