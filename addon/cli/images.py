# SPDX-License-Identifier: GPL-3.0-or-later
"""Image files, through OpenImageIO: multilayer EXR in, EXR and PNG out, paper images, textures in and out.

Only the command line uses this: Blender reads and writes its own images.
"""

import contextlib
import importlib.metadata
import os
import struct
import sys
import tempfile
import zlib
from dataclasses import dataclass

import numpy as np

from ..pen import colour
from ..pen.errors import EncreError
from .workplace import Workplace

MOST_PACKED = 2000  # values in a byte of a file: no compression does better than a fourth of that
MOST_HALF = 65504.0
MOST_PNG = 32768  # pixels each way of a PNG
ROWS = 64  # read at a time: whole chunks of all but DWAB files, little memory for the channels not wanted


def _oiio():
    try:
        import OpenImageIO
    except ImportError:
        raise EncreError("the Python module OpenImageIO is missing; run: pip install openimageio") from None
    return OpenImageIO


def _words(source):
    """What OpenImageIO says went wrong; unless it is fetched, it is printed at the end."""
    try:
        return source.geterror()
    except UnicodeDecodeError:  # it quotes the file
        return ""


@contextlib.contextmanager
def _quiet():
    """OpenEXR and libpng write about broken files to the standard error; here it is ours to say so, in a sentence."""
    sys.stderr.flush()
    kept = os.dup(2)
    try:
        with open(os.devnull, "w") as nowhere:
            os.dup2(nowhere.fileno(), 2)
        yield
    finally:
        os.dup2(kept, 2)
        os.close(kept)


def _utf8(path):
    """`path` as OpenImageIO takes it."""
    try:
        return os.fspath(path).encode().decode()
    except UnicodeEncodeError:
        raise EncreError(f"{path}: this name is not UTF-8; rename the file or its folder") from None


@dataclass(frozen=True)
class Window:
    """Where an EXR's pixels lie: size and place of the data window in the display window (full_*)."""

    width: int
    height: int
    x: int
    y: int
    full_width: int
    full_height: int


class Exr:
    """An open EXR: `channels` maps each channel's full name to its (part, number), in the file's order; `views`
    names the eyes of a stereo picture, else (); `metadata` holds the text attributes. Use as a context manager.

    Raises EncreError for a file that is missing, unreadable or empty, or whose parts differ in size.
    """

    def __init__(self, path, threads=0):
        oiio = _oiio()
        if not os.path.isfile(path):
            raise EncreError(f"{path}: there is no such file; check the path")
        if threads:
            oiio.attribute("threads", threads)
            oiio.attribute("exr_threads", threads)
        self.path, self.channels, self.views, self.metadata, self.window = path, {}, (), {}, None
        self._file = oiio.ImageInput.open(_utf8(path))
        if not self._file or self._file.format_name() != "openexr":
            _words(oiio)
            raise EncreError(f"{path}: is not a readable OpenEXR file; give a multilayer EXR")
        part, most = 0, MOST_PACKED * os.path.getsize(path)
        try:
            while self._file.seek_subimage(part, 0):
                spec = self._file.spec()
                self._add(part, spec)
                most -= spec.width * spec.height * spec.nchannels
                part += 1
        except UnicodeDecodeError:
            raise EncreError(f"{path}: holds names that are not UTF-8; render or copy it again") from None
        if most < 0:  # a damaged or made-up size would have us ask for all memory
            raise EncreError(f"{path}: says that it holds more pixels than such a file can; render or copy it again")

    def _add(self, part, spec):
        # The display window starts where the file says; only the distance between the two windows matters.
        window = Window(spec.width, spec.height, spec.x - spec.full_x, spec.y - spec.full_y,
                        spec.full_width, spec.full_height)
        if min(spec.width, spec.height) < 1:
            raise EncreError(f"{self.path}: has no pixels; render it again")
        if self.window not in (None, window):
            raise EncreError(f"{self.path}: its parts differ in size; save all passes in one size")
        self.window = window
        # One part holds all views, and says so; or each part holds one, and its channels do not name it.
        view = spec.get_string_attribute("view")
        self.views = tuple(dict.fromkeys([*self.views, *(spec.getattribute("multiView") or ()), *filter(None, [view])]))
        for number, name in enumerate(spec.channelnames):
            if view:
                name = ".".join([*name.split(".")[:-1], view, name.split(".")[-1]])
            self.channels.setdefault(name, (part, number))
        for attribute in spec.extra_attribs:
            with contextlib.suppress(UnicodeDecodeError):  # another program's, in another encoding
                if isinstance(attribute.value, str):
                    self.metadata.setdefault(attribute.name, attribute.value)

    def read(self, passes):
        """{name: array (H, W, channels)}, float32, row 0 at the top, of {name: [full channel name …]}."""
        shape = self.window.height, self.window.width
        out = {name: np.empty((*shape, len(channels)), np.float32) for name, channels in passes.items()}
        for first, band in self.bands(passes, 0, self.window.height):
            for name, picture in band.items():
                out[name][first:first + len(picture)] = picture
        return out

    def bands(self, passes, first, end):
        """Yields (row, {name: array (rows, W, channels)}) of bands of the rows from `first` to `end`, else as read().

        Every chunk is decompressed once, whatever the number of channels wanted from it.
        """
        places = {name: [self.channels[channel] for channel in channels] for name, channels in passes.items()}
        parts = {}
        for part, number in sorted(place for wanted in places.values() for place in wanted):
            parts.setdefault(part, []).append(number)
        for top in range(first - first % ROWS, end, ROWS):
            row, below = max(top, first), min(top + ROWS, end)
            rows = {part: self._rows(part, row, below, numbers[0], numbers[-1] + 1) for part, numbers in parts.items()}
            band = {name: _together([(rows[part], number - parts[part][0]) for part, number in wanted])
                    for name, wanted in places.items()}
            del rows
            yield row, band
            del band  # not while the next is read

    @_quiet()
    def _rows(self, part, row, end, first, last):
        """The channels `first` to `last` of the rows from `row` to `end` of a part, float32 (rows, W, channels)."""
        self._file.seek_subimage(part, 0)
        spec = self._file.spec()
        above, below = row, end
        if spec.tile_width:  # whole tiles, or to the picture's end
            above, below = row - row % spec.tile_height, min(end + -end % spec.tile_height, spec.height)
            pixels = self._file.read_tiles(part, 0, spec.x, spec.x + spec.width, spec.y + above, spec.y + below, 0, 1,
                                           first, last, "float")
        else:
            pixels = self._file.read_scanlines(part, 0, spec.y + above, spec.y + below, 0, first, last, "float")
        if pixels is None:
            _words(self._file)
            raise EncreError(f"{self.path}: can't be read to its end; render or copy it again")
        return pixels.reshape(below - above, spec.width, last - first)[row - above:][:end - row]

    def close(self):
        if self._file:
            self._file.close()
            self._file = None

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


def read_paper(path):
    """An image of any kind as an array (H, W) or (H, W, 3) of float32, values as stored, without its alpha."""
    if not os.path.isfile(path):
        raise EncreError(f"paper_image: there is no file {path}; check the path")
    pixels = _stored(path, "float")
    if pixels is None:
        raise EncreError(f"paper_image: {path} can't be read; give an image such as a PNG or an EXR")
    return np.ascontiguousarray(pixels[:, :, :3] if pixels.shape[2] > 2 else pixels[:, :, 0])


@dataclass
class Texture:
    """Pixels (H, W, 3 or 4), float32, values as stored; kind: how the file stores them, "uint8", "half" ...; linear:
    whether they are linear light, as floats are, or sRGB-encoded, as whole numbers are; straight: not premultiplied."""

    pixels: np.ndarray
    kind: str
    linear: bool
    straight: bool


def read_texture(path, most):
    """The first image of a file of any kind, grey as colour, at most `most` texels each way. Raises EncreError."""
    oiio = _oiio()
    if not os.path.isfile(path):
        raise EncreError(f"{path}: there is no such file; check the path")
    with _quiet():
        file = oiio.ImageInput.open(_utf8(path), _as_stored())
    _words(oiio)
    if not file:
        raise EncreError(f"{path}: is not an image that can be read; give one such as a PNG or an EXR")
    spec = file.spec()
    file.close()
    if not (1 <= spec.width <= most and 1 <= spec.height <= most):
        raise EncreError(f"{path}: is {spec.width} x {spec.height} texels; give an image of 1 to {most} each way")
    if spec.depth > 1 or spec.deep or spec.nchannels not in (1, 2, 3, 4):
        raise EncreError(f"{path}: is no flat picture with 1 to 4 channels but has {spec.nchannels}; "
                         "give a texture, not render passes")
    pixels = _stored(path, "float")
    if pixels is None:
        raise EncreError(f"{path}: can't be read to its end; save it again")
    if spec.nchannels < 3:
        pixels = pixels[:, :, [0, 0, 0, 1][:2 + spec.nchannels]]
    kind = str(spec.format)
    return Texture(np.ascontiguousarray(pixels), kind, kind in ("half", "float", "double"),
                   bool(spec.get_int_attribute("oiio:UnassociatedAlpha")))


def fit_texture(path, texture):
    """The texture as a file of this name stores it: EXR and HDR hold linear light, premultiplied, others but TIFF
    sRGB-encoded colours. Raises EncreError where none can."""
    oiio = _oiio()
    out = oiio.ImageOutput.create(_utf8(path))
    oiio.geterror()
    if not out:
        raise EncreError(f"{path}: images of this kind can't be written; give a name that ends in .png, .tif or .exr")
    if texture.pixels.shape[2] == 4 and not out.supports("alpha"):
        raise EncreError(f"{path}: the texture has alpha, which this kind of file has not; give a name in .png or .tif")
    linear = out.format_name() in ("openexr", "hdr")
    if texture.linear == linear or out.format_name() == "tiff":
        return texture
    color, alpha = texture.pixels[..., :3], texture.pixels[..., 3:]
    if linear:
        color = colour.decode_srgb(color) * (alpha if texture.straight and alpha.size else 1)
    else:
        color = colour.encode_srgb(color / (np.where(alpha > 0, alpha, 1) if alpha.size else 1))
    return Texture(np.concatenate([color, alpha], 2, dtype=np.float32), "half" if linear else "uint16", linear,
                   not linear)


def write_textures(textures):
    """Writes {path: Texture}, all whole or none at all. Raises WriteError where one can't be written."""
    oiio = _oiio()
    with writing(list(textures)) as place:
        for path, texture in textures.items():
            height, width, channels = texture.pixels.shape
            spec = oiio.ImageSpec(width, height, channels, texture.kind)
            spec["oiio:ColorSpace"] = "Linear" if texture.linear else "sRGB"
            if texture.straight:
                spec["oiio:UnassociatedAlpha"] = 1
            _store(place, path, spec, texture.pixels)
        for path in textures:
            place.take(os.path.basename(path), path)


def _as_stored():
    """What tells OpenImageIO to leave colours alone that are not multiplied by alpha."""
    spec = _oiio().ImageSpec()
    spec["oiio:UnassociatedAlpha"] = 1
    return spec


def _stored(path, kind):
    """All pixels (H, W, channels) of an image without conversion of colour or alpha; None: it can't be read."""
    oiio = _oiio()
    with _quiet():
        file = oiio.ImageInput.open(_utf8(path), _as_stored())
        pixels = file.read_image(kind) if file else None
    _words(oiio)
    if pixels is None:
        return None
    spec = file.spec()
    file.close()
    return pixels.reshape(spec.height, spec.width, spec.nchannels)


def draw_text(picture, lines):
    """Writes lines (x, baseline y, size in pixels, words) in black on a picture (H, W, 3) and returns that."""
    oiio = _oiio()
    height, width, _ = picture.shape
    buffer = oiio.ImageBuf(oiio.ImageSpec(width, height, 3, "float"))
    buffer.set_pixels(oiio.ROI(0, width, 0, height, 0, 1, 0, 3), np.ascontiguousarray(picture, np.float32))
    for x, y, size, words in lines:
        if not oiio.ImageBufAlgo.render_text(buffer, round(x), round(y), words, round(size), "DroidSans", (0.0,) * 3):
            _words(buffer)
            raise EncreError("OpenImageIO finds no font to write the caption with; install openimageio from PyPI, "
                             "which brings one")
    return buffer.get_pixels(oiio.FLOAT)


def write_exr(path, channels, window, views=(), texts=None):
    """Writes {full channel name: array (H, W)} as one part of 32-bit floats with {key: text}, whole or not at all.

    Raises WriteError where the file can't be written.
    """
    oiio = _oiio()
    spec = oiio.ImageSpec(window.width, window.height, len(channels), "float")
    spec.x, spec.y, spec.full_width, spec.full_height = window.x, window.y, window.full_width, window.full_height
    spec.channelnames = tuple(channels)
    spec["compression"] = "zip"
    for key, said in (texts or {}).items():
        spec[key] = said
    if views:
        spec.attribute("multiView", oiio.TypeDesc(f"string[{len(views)}]"), views)
    _write(path, spec, np.stack(list(channels.values()), axis=2))


def write_png(path, rgba, window, texts=None, exposure=0.0, gamma=1.0):
    """Writes scene-linear, premultiplied (H, W, 4) as 8-bit sRGB with straight alpha, whole or not at all.

    exposure, in stops, and gamma are those of Blender's view transform Standard; texts: {key: text} to store.

    The picture is the display window: PNG has no other. Raises WriteError where the file can't be written.
    """
    oiio = _oiio()
    if max(window.full_width, window.full_height) > MOST_PNG:
        raise WriteError(f"{path}: the display window is {window.full_width} x {window.full_height}, and a PNG has at "
                         f"most {MOST_PNG} pixels each way; write an .exr")
    alpha = np.clip(rgba[:, :, 3:], 0, 1)
    straight = rgba[:, :, :3] / np.where(alpha > 0, alpha, 1)
    if exposure:
        straight *= np.float32(2) ** exposure
    encoded = colour.encode_srgb(straight)
    if gamma != 1:
        encoded **= 1 / gamma
    picture = np.zeros((window.full_height, window.full_width, 4), np.uint8)
    top, left = max(window.y, 0), max(window.x, 0)
    pixels = np.round(255 * np.concatenate([encoded, alpha], axis=2)).astype(np.uint8)
    pixels = pixels[top - window.y:, left - window.x:][:max(window.full_height - top, 0),
                                                       :max(window.full_width - left, 0)]
    picture[top:top + pixels.shape[0], left:left + pixels.shape[1]] = pixels
    spec = oiio.ImageSpec(window.full_width, window.full_height, 4, "uint8")
    spec["oiio:ColorSpace"] = "sRGB"
    spec["oiio:UnassociatedAlpha"] = 1  # the pixels are straight already
    _write(path, spec, picture, texts)


@contextlib.contextmanager
def _opened(path, config=None):
    """The open image file, None where it can't be; nothing is printed about it."""
    oiio = _oiio()
    with _quiet():
        file = oiio.ImageInput.open(_utf8(path), *([config] if config else []))
        try:
            yield file
        finally:
            if file:
                file.close()
            _words(oiio)


def whole(path, last_row=False):
    """Whether every pixel of an image file can be read; last_row: whether the last ones can, which is quick to see."""
    with _opened(path) as file:
        return bool(file) and _readable(file, last_row)


def _readable(file, last_row):
    part = 0
    while file and file.seek_subimage(part, 0):
        spec, part = file.spec(), part + 1
        end = spec.y + spec.height
        for y in range(end - 1 if last_row else spec.y, end, ROWS):
            rows = file.read_scanlines(part - 1, 0, y, min(y + ROWS, end), 0, 0, spec.nchannels, spec.format)
            if rows is None:
                _words(file)
                return False
    return part > 0


class WriteError(EncreError):
    """A file can't be written, which shows only after the work."""


def unwritable(path, reason):
    return f"{path}: can't be written ({reason}); make room there or choose another folder"


def prepare(path):
    """Finds out before any work whether `path` can be written; makes its folder. Raises EncreError."""
    folder = os.path.dirname(_utf8(os.path.abspath(path)))
    try:
        os.makedirs(folder, exist_ok=True)
        check_place(path)
        with tempfile.TemporaryFile(dir=folder) as probe:
            probe.write(bytes(65536))
    except OSError as error:
        raise EncreError(unwritable(path, error.strerror)) from None


def check_place(path):
    """Finds out whether `path` can be written in its folder, which is there. Raises EncreError."""
    if os.path.isdir(path):
        raise EncreError(unwritable(path, "it is a folder"))
    try:
        with contextlib.suppress(FileNotFoundError):
            os.stat(path)  # fails where the name is too long
    except OSError as error:
        raise EncreError(unwritable(path, error.strerror)) from None
    if os.path.exists(path) and not os.access(path, os.W_OK):
        raise EncreError(unwritable(path, "it is write-protected"))


def rewrite(path, part, kinds):
    """Writes the channels of an EXR that `kinds` {full name: "half" or "float"} names into another, `part`, as one part
    with the same metadata. Few rows are held at a time. Raises EncreError, WriteError.
    """
    oiio = _oiio()
    with Exr(path) as exr:
        window, names = exr.window, [name for name in exr.channels if name in kinds]
        spec = oiio.ImageSpec(window.width, window.height, len(names), "float")
        spec.x, spec.y, spec.full_width, spec.full_height = window.x, window.y, window.full_width, window.full_height
        spec.channelnames = tuple(names)
        spec.channelformats = tuple(oiio.TypeDesc(kinds[name]) for name in names)
        spec["compression"] = "zip"
        for key, said in exr.metadata.items():
            if not key.startswith(("oiio:", "openexr:")) and key not in ("compression", "name", "view"):
                spec[key] = said
        if exr.views:
            spec.attribute("multiView", oiio.TypeDesc(f"string[{len(exr.views)}]"), exr.views)
        halves = [k for k, name in enumerate(names) if kinds[name] == "half"]
        out = oiio.ImageOutput.create(part)
        good = out.open(part, spec)
        for y, band in exr.bands({"all": names}, 0, window.height) if good else ():
            rows = np.array(band["all"])
            rows[..., halves] = np.clip(rows[..., halves], -MOST_HALF, MOST_HALF)
            good = good and out.write_scanlines(window.y + y, window.y + y + len(rows), 0, rows)
        good = out.close() and good
        if not good:
            raise WriteError(unwritable(path, (_words(out).splitlines() or ["the disk may be full"])[0].rstrip(" .")))


def _write(path, spec, pixels, texts=None):
    with writing([path]) as place:
        _store(place, path, spec, pixels)
        if texts:
            stamp_png(os.path.join(place.path, os.path.basename(path)), texts)
        place.take(os.path.basename(path), path)


@contextlib.contextmanager
def writing(paths):
    """A Workplace beside the files `paths`, which are to be made in it. Raises WriteError for what goes wrong there."""
    path = paths[0]
    try:
        with Workplace(os.path.dirname(os.path.abspath(path))) as place:
            yield place
    except OSError as error:
        raise WriteError(unwritable(path, error.strerror)) from None


def _store(place, path, spec, pixels):
    """Writes an image under the name of `path` into a Workplace. Raises WriteError."""
    part = os.path.join(place.path, os.path.basename(path))
    out = _oiio().ImageOutput.create(part)
    good = out.open(part, spec) and out.write_image(pixels)
    good = out.close() and good
    # OpenImageIO's PNG writer does not notice a full disk.
    if good and out.format_name() == "png" and not whole(part):
        good = False
    if not good:
        reason = (_words(out).replace(part, path).splitlines() or ["the disk may be full"])[0]
        raise WriteError(unwritable(path, reason.rstrip(" .")))


def text(path, key):
    """The text that an image file holds under `key`; None: there is no such file or text."""
    if not os.path.isfile(path):
        return None
    with _opened(path) as file:
        said = file.spec().getattribute(key) if file else None
    return said if isinstance(said, str) else None


def stamp_png(path, texts):
    """Puts {key: text} into a PNG file, which Blender gives only texts of its own. OSError."""
    with open(path, "rb") as file:
        data = file.read()
    if not data.startswith(b"\x89PNG"):
        return
    chunks = b""
    for key, said in texts.items():
        body = b"tEXt" + key.encode("latin-1") + b"\0" + said.encode("latin-1")
        chunks += struct.pack(">I", len(body) - 4) + body + struct.pack(">I", zlib.crc32(body))
    with open(path, "wb") as file:
        file.write(data[:33] + chunks + data[33:])  # after IHDR, which always has this length


def version():
    try:
        return importlib.metadata.version("encre")
    except importlib.metadata.PackageNotFoundError:  # run from a folder
        return "not installed"
