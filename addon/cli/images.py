# SPDX-License-Identifier: GPL-3.0-or-later
"""Image files, through OpenImageIO: what all kinds have in common, images of settings, textures in and out.

multilayer knows EXR, png PNG. Only the command line uses this: Blender reads and writes its own images.
"""

import contextlib
import errno
import importlib.metadata
import os
import sys
import tempfile
from dataclasses import dataclass

import numpy as np

from ..pen import colour, library
from ..pen.errors import EncreError
from . import room
from .sharing import lease
from .sharing.workplace import Workplace

_LINEAR = "openexr", "hdr"  # kinds of files that hold linear light
ROWS = 64  # read at a time: whole chunks of all but DWAB files, little memory for what is not wanted of them


def openimageio():
    try:
        import OpenImageIO
    except ImportError:
        raise EncreError("the Python module OpenImageIO is missing; run: pip install openimageio") from None
    if not hasattr(OpenImageIO, "ImageInput"):
        where = getattr(OpenImageIO, "__file__", None) or "a folder"
        raise EncreError(f"the Python module OpenImageIO is {where}, which is another's; take that off PYTHONPATH")
    return OpenImageIO


def complaint(source):
    """What OpenImageIO says went wrong; unless it is fetched, it is printed at the end."""
    try:
        return source.geterror()
    except UnicodeDecodeError:  # it quotes the file
        return ""


@contextlib.contextmanager
def quiet():
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


def utf8(path):
    """`path` as OpenImageIO takes it."""
    try:
        return os.fspath(path).encode().decode()
    except UnicodeEncodeError:
        raise EncreError(f"{path}: this name is not UTF-8; rename the file or its folder") from None


def check_source(path):
    """Raises EncreError for a file that can't be read."""
    if os.path.isdir(path):
        raise EncreError(f"{path}: is a folder; give a file in it")
    if not os.path.isfile(path):  # nor a pipe, for which opening it would wait
        raise EncreError(f"{path}: there is no such file; check the path")
    try:
        open(path, "rb").close()
    except OSError as error:
        raise EncreError(f"{path}: can't be read ({error.strerror}); check the path and who may read it") from None


def read_chosen(chosen):
    """An image of any kind as an array (H, W) or (H, W, 3) of float32, values as its parameter wants them, without its
    alpha."""
    path = chosen.name
    if not os.path.isfile(path):
        raise EncreError(f"{chosen.id}: there is no file {path}; check the path")
    pixels, kind = _stored(path)
    if pixels is None:
        raise EncreError(f"{chosen.id}: {path} can't be read; give an image such as a PNG or an EXR")
    pixels = pixels[:, :, :3] if pixels.shape[2] > 2 else pixels[:, :, 0]
    if library.params()[chosen.id].unit == "color" and kind not in _LINEAR:  # TIFFs of floats, too, as Blender has it
        pixels = colour.decode_srgb(pixels)
    return np.ascontiguousarray(pixels, np.float32)


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
    oiio = openimageio()
    if not os.path.isfile(path):
        raise EncreError(f"{path}: there is no such file; check the path")
    with quiet():
        file = oiio.ImageInput.open(utf8(path), _as_stored())
    complaint(oiio)
    if not file:
        raise EncreError(f"{path}: is not an image that can be read; give one such as a PNG or an EXR")
    spec = file.spec()
    file.close()
    if not (1 <= spec.width <= most and 1 <= spec.height <= most):
        raise EncreError(f"{path}: is {spec.width} x {spec.height} texels; give an image of 1 to {most} each way")
    if spec.depth > 1 or spec.deep or spec.nchannels not in (1, 2, 3, 4):
        raise EncreError(f"{path}: is no flat picture with 1 to 4 channels but has {spec.nchannels}; "
                         "give a texture, not render passes")
    pixels, _ = _stored(path)
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
    oiio = openimageio()
    out = oiio.ImageOutput.create(utf8(path))
    oiio.geterror()
    if not out:
        raise EncreError(f"{path}: images of this kind can't be written; give a name that ends in .png, .tif or .exr")
    if texture.pixels.shape[2] == 4 and not out.supports("alpha"):
        raise EncreError(f"{path}: the texture has alpha, which this kind of file has not; give a name in .png or .tif")
    linear = out.format_name() in _LINEAR
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
    oiio = openimageio()
    with writing(list(textures)) as place:
        for path, texture in textures.items():
            height, width, channels = texture.pixels.shape
            spec = oiio.ImageSpec(width, height, channels, texture.kind)
            spec["oiio:ColorSpace"] = "Linear" if texture.linear else "sRGB"
            if texture.straight:
                spec["oiio:UnassociatedAlpha"] = 1
            store(place, path, spec, texture.pixels)
        for path in textures:
            place.take(os.path.basename(path), path)


def _as_stored():
    """What tells OpenImageIO to leave colours alone that are not multiplied by alpha."""
    spec = openimageio().ImageSpec()
    spec["oiio:UnassociatedAlpha"] = 1
    return spec


def _stored(path):
    """(all pixels (H, W, channels) of an image as floats, without conversion of colour or alpha, or None where it can't
    be read; OpenImageIO's name for its kind of file)."""
    oiio = openimageio()
    with quiet():
        file = oiio.ImageInput.open(utf8(path), _as_stored())
        if file:
            spec = file.spec()
            room.afford(path, 4 * spec.width * spec.height * max(spec.depth, 1) * spec.nchannels)
        pixels = file.read_image("float") if file else None
    complaint(oiio)
    if pixels is None:
        return None, ""
    spec, kind = file.spec(), file.format_name()
    file.close()
    return pixels.reshape(spec.height, spec.width, spec.nchannels), kind


def draw_text(picture, lines):
    """Writes lines (x, baseline y, size in pixels, words) in black on a picture (H, W, 3) and returns that."""
    oiio = openimageio()
    height, width, _ = picture.shape
    buffer = oiio.ImageBuf(oiio.ImageSpec(width, height, 3, "float"))
    buffer.set_pixels(oiio.ROI(0, width, 0, height, 0, 1, 0, 3), np.ascontiguousarray(picture, np.float32))
    for x, y, size, words in lines:
        if not oiio.ImageBufAlgo.render_text(buffer, round(x), round(y), words, round(size), "DroidSans", (0.0,) * 3):
            complaint(buffer)
            raise EncreError("OpenImageIO finds no font to write the caption with; install openimageio from PyPI, "
                             "which brings one")
    return buffer.get_pixels(oiio.FLOAT)


@contextlib.contextmanager
def _opened(path, config=None):
    """The open image file, None where it can't be; nothing is printed about it."""
    oiio = openimageio()
    with quiet():
        file = oiio.ImageInput.open(utf8(path), *([config] if config else []))
        try:
            yield file
        finally:
            if file:
                file.close()
            complaint(oiio)


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
                complaint(file)
                return False
    return part > 0


_ELSEWHERE = {os.strerror(code) for code in (errno.ENOENT, errno.ENOTDIR, errno.EACCES, errno.EPERM, errno.EROFS)}


class WriteError(EncreError):
    """A file can't be written, which shows only after the work."""


def unwritable(path, reason):
    room = "" if reason in _ELSEWHERE else "make room there or "
    return f"{path}: can't be written ({reason}); {room}choose another folder"


def unwritten(path, out, part):
    """The WriteError for the file `path` that `out`, which wrote its `part`, could not write."""
    said = (complaint(out).replace(part, path).splitlines() or ["the disk may be full"])[0]
    return WriteError(unwritable(path, said.rstrip(" .")))


def prepare(path):
    """Finds out before any work whether `path` can be written; makes its folder. Raises EncreError."""
    folder = os.path.dirname(utf8(os.path.abspath(path)))
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
        raise EncreError(f"{path}: is a folder; choose another name")
    try:
        with contextlib.suppress(FileNotFoundError):
            os.stat(path)  # fails where the name is too long
    except OSError as error:
        raise EncreError(unwritable(path, error.strerror)) from None
    if os.path.exists(path) and not os.access(path, os.W_OK):
        raise EncreError(unwritable(path, "it is write-protected"))


@contextlib.contextmanager
def writing(paths, seconds=lease.SECONDS):
    """A Workplace beside the files `paths`, which are to be made in it. Raises WriteError for what goes wrong there."""
    path = paths[0]
    try:
        with Workplace(os.path.dirname(os.path.abspath(path)), seconds=seconds) as place:
            yield place
    except OSError as error:
        raise WriteError(unwritable(path, error.strerror)) from None


def write(path, spec, pixels, finish=lambda part: None):
    """Writes an image, whole or not at all; finish(part) may change the file that has another name yet. Raises
    WriteError."""
    with writing([path]) as place:
        store(place, path, spec, pixels)
        finish(os.path.join(place.path, os.path.basename(path)))
        place.take(os.path.basename(path), path)


def store(place, path, spec, pixels):
    """Writes an image under the name of `path` into a Workplace. Raises WriteError."""
    part = os.path.join(place.path, os.path.basename(path))
    out = openimageio().ImageOutput.create(part)
    good = out.open(part, spec) and out.write_image(pixels)
    good = out.close() and good
    # OpenImageIO's PNG writer does not notice a full disk.
    if good and out.format_name() == "png" and not whole(part):
        good = False
    if not good:
        raise unwritten(path, out, part)


def text(path, key):
    """The text that an image file holds under `key`; None: there is no such file or text."""
    if not os.path.isfile(path):
        return None
    with _opened(path) as file:
        said = file.spec().getattribute(key) if file else None
    return said if isinstance(said, str) else None


def version():
    try:
        return importlib.metadata.version("encre")
    except importlib.metadata.PackageNotFoundError:  # run from a folder
        return "not installed"
