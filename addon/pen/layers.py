# SPDX-License-Identifier: GPL-3.0-or-later
"""Passes of a rendered picture -> the layers that the library reads.

Pure numpy: the engine uses it on Cycles' passes in memory, the command line on bands of a saved file's. Pictures are
float32 (height, width, channels), row 0 at the top, of any strides, so a picture stored bottom-up is a flipped view.
Passes go by their classic names; `classic()` translates those of Blender 5.
"""

from collections.abc import Callable, Iterator

import numpy as np

from .errors import EncreError
from .job import Frame
from .settings import Settings

# A picture without its noise, by albedo and normal; of light depth and, if it is known, the object's number follow.
Denoise = Callable[..., np.ndarray]

# The layer `diffuse` by depth and normal.
Illuminate = Callable[[np.ndarray, np.ndarray], np.ndarray]

# What Cycles must render for us: classic name -> channel names, as RenderEngine.register_pass() takes them.
CYCLES = {
    "Combined": "RGBA",
    "Depth": "Z",
    "Normal": "XYZ",
    "DiffDir": "RGB",
    "DiffInd": "RGB",
    "DiffCol": "RGB",
    "GlossDir": "RGB",
    "GlossInd": "RGB",
    "GlossCol": "RGB",
    "TransCol": "RGB",
    "Emit": "RGB",
    "IndexOB": "X",
}
# Its passes that look into mirrors and through clear glass, up to the first rough surface.
SEEN = {"Denoising Albedo": "RGB", "Denoising Normal": "XYZ", "Denoising Depth": "Z"}
_TOWARDS = np.array((1, 1, -1), np.float32)  # Cycles' camera looks along +z
# Its pass of what the world shows behind everything.
BEHIND = {"Env": "RGB"}
_BAND = 64  # rows of a picture that are held twice
# By how much normals and depths, as a share, differ where something else is seen than the surface; where normals do,
# colours or directions must, too: of lamps and of what is black the passes hold less. Pixels about it are read as well.
_OTHER_NORMAL, _OTHER_DEPTH, _READ_ABOUT = 0.1, 0.02, 6
_SAME = 1e-3  # within which nothing else is seen, so that there is no noise
# The pictures that the library draws beside Combined.
DRAWN = {"Encre Lines": "RGBA", "Encre Surface": "RGBA", "Encre Edges": "X", "Encre Light": "RGB",
         "Encre Tones": "RGBA"}
# Blender 5 renamed these passes.
RENAMED = {
    "DiffDir": "Diffuse Direct",
    "DiffInd": "Diffuse Indirect",
    "DiffCol": "Diffuse Color",
    "GlossDir": "Glossy Direct",
    "GlossInd": "Glossy Indirect",
    "GlossCol": "Glossy Color",
    "TransCol": "Transmission Color",
    "Emit": "Emission",
    "Env": "Environment",
    "IndexOB": "Object Index",
    "IndexMA": "Material Index",
}
_CLASSIC = {new: old for old, new in RENAMED.items()}


def classic(name: str) -> str:
    """The classic name of a pass that any Blender wrote."""
    return _CLASSIC.get(name, name)


def seen_depth(length: np.ndarray, projection: np.ndarray, frame: Frame, clip_start: float) -> np.ndarray:
    """The layer `seen_depth` from Cycles' pass Denoising Depth.

    length: (height, width, 1), of the ray, from the near plane on; 0 = nothing there. projection: camera -> clip, 4 x
    4, of the full frame. The ray goes on behind a mirror as if it went straight. On matt surfaces this is Depth, in
    Blender 3.4, 4.2, 4.5 and 5.0, with perspective and orthographic cameras.
    """
    height, width = length.shape[:2]
    x = (2 * (np.arange(width) + frame.x + 0.5) / frame.width - 1 + projection[0, 2]) / projection[0, 0]
    y = (1 - 2 * (np.arange(height) + frame.y + 0.5) / frame.height + projection[1, 2]) / projection[1, 1]
    orthographic = projection[3, 3] == 1
    slant = 1 if orthographic else np.sqrt(1 + y[:, None, None] ** 2 + x[:, None] ** 2)
    return np.where(length > 0, length / slant + clip_start, 0).astype(np.float32)


def seen_passes(seen: dict[str, np.ndarray]) -> Iterator[tuple[str, np.ndarray]]:
    """The passes SEEN by name, one at a time, as Cycles has them, of the layers of what mirrors show, if there are any;
    but for the depth, which files have as a layer."""
    if seen:
        yield "Denoising Albedo", seen["seen_color"]
        # Rows from the bottom up, as Blender's passes are: nothing turns them around once more.
        yield "Denoising Normal", (seen["seen_normal"][::-1] * _TOWARDS)[::-1]


def unmirrored(layers: dict[str, np.ndarray], view: np.ndarray) -> dict[str, np.ndarray]:
    """The layers of what mirrors show where nothing mirrors: each surface shows itself.

    view: world -> camera, rotation, 9 numbers.
    """
    to_camera = np.asarray(view, np.float32).reshape(3, 3).T
    return {"seen_color": layers.get("albedo", layers["color"]), "seen_normal": layers["normal"] @ to_camera,
            "seen_depth": np.where(layers["depth"] < 1e9, layers["depth"], np.float32(0))}


def unmirror(layers: dict[str, np.ndarray], materials: np.ndarray, which: np.ndarray, view: np.ndarray) -> bool:
    """Makes surfaces show themselves, in the layers of what mirrors show that are there; says whether there are any.

    materials: numbers, (height, width, 1); which: (m,) bool, of which materials; view: as in unmirrored.
    """
    any_such = False
    for rows in range(0, len(materials), _BAND):
        where = which[materials[rows:rows + _BAND].astype(np.intp)]
        if where.any():
            any_such = True
            band = {name: picture[rows:rows + _BAND] for name, picture in layers.items()}
            for name, own in unmirrored(band, view).items():
                if name in band:
                    np.copyto(band[name], own, where=where)
    return any_such


def sees_through(layers: dict[str, np.ndarray], view: np.ndarray) -> np.ndarray:
    """Where (height, width) lines are looked for in what mirrors and clear glass show, and what is read for them, but
    for pixels that show nothing but their own surface. view: as in unmirrored."""
    found = np.zeros(layers["depth"].shape[:2], np.uint8)
    other, deep, bare = 1, 2, 4  # what is found
    for rows in range(0, len(found), _BAND):
        band = {name: picture[rows:rows + _BAND] for name, picture in layers.items()}
        own = unmirrored(band, view)
        there = own["seen_depth"][..., 0] > 0
        off = _square(band["seen_normal"] - own["seen_normal"])
        share = np.clip(np.sum(band["seen_normal"] * own["seen_normal"], 2)
                        / np.maximum(_square(own["seen_normal"]), 1e-12), 0, 1)[..., None]
        aside = _square(band["seen_normal"] - share * own["seen_normal"])
        tint = _square(np.clip(band["seen_color"], 0, 1) - np.clip(own["seen_color"], 0, 1))
        here = found[rows:rows + _BAND]
        here[there & (off > _OTHER_NORMAL ** 2) & (np.maximum(aside, tint) > _OTHER_NORMAL ** 2)] = other
        here[np.maximum(off, tint) < _SAME ** 2] |= bare
        if "seen_depth" in band:
            far, front = band["seen_depth"][..., 0], own["seen_depth"][..., 0]
            here[there & (far > 0) & (np.abs(far - front) > _OTHER_DEPTH * front)] |= deep
    where = ~_grown(found & deep == 0, 1)
    where |= found & other > 0
    where = _grown(where, _READ_ABOUT)
    where &= found & bare == 0
    return where


def _square(vectors):
    return np.sum(vectors * vectors, 2)


def _grown(where, pixels):
    """What is true, grown by so many pixels to all sides."""
    for axis in (0, 1):
        wide, grown = np.pad(where, [(pixels, pixels) if axis == a else (0, 0) for a in (0, 1)]), where.copy()
        for k in range(2 * pixels + 1):
            grown |= wide[k:][:len(where)] if axis == 0 else wide[:, k:][:, :where.shape[1]]
        where = grown
    return where


class _Passes:
    """Takes passes as (height, width, channels), and counts the NaN and infinities that it reads as 0."""

    def __init__(self, passes):
        self.passes, self.nonfinite = passes, 0

    def __contains__(self, name):
        return name in self.passes

    def raw(self, name):
        picture = np.asarray(self.passes.pop(name), np.float32)
        return picture[..., None] if picture.ndim == 2 else picture

    def __call__(self, name):
        picture, bad = finite(self.raw(name))
        self.nonfinite += bad
        return picture

    def total(self, *names):
        """The sum of those of the passes that are there; None without any."""
        out = None
        for name in names:
            if name in self:
                out = self(name) if out is None else out + self(name)
        return out


def finite(picture: np.ndarray) -> tuple[np.ndarray, int]:
    """(the picture, 0 where its values are not finite; how many these are); itself where all are."""
    bad = ~np.isfinite(picture)
    found = int(np.count_nonzero(bad))
    return (np.where(bad, np.float32(0), picture) if found else picture), found


def _require(passes, known, layer, name):
    if layer not in known and name not in passes:
        found = ", ".join(sorted(passes)) or "none"
        raise EncreError(f"pass {name} is missing: render the picture with it; passes found: {found}")


def _by_style(style, flags):
    """flags[style number] per pixel, (height, width, 1); one bool where all styles agree."""
    if style is None or len(set(flags)) == 1:
        return flags[0]
    known = (style >= 0) & (style < len(flags))
    return np.asarray(flags)[np.where(known, style, 0).astype(np.intp)]


def _pick(flags, yes, no):
    """yes() where the flags are set, else no(); neither is computed where nothing asks for it."""
    if np.ndim(flags):
        return np.where(flags, yes(), no())
    return yes() if flags else no()


class _Light:
    """Light without the colour of the surface, direct alone or all of it, as rendered or denoised.

    guides: for the denoiser. In place of the albedo it is told where diffuse light is seen at all: by textures it would
    print their joints and checks into light that knows nothing of them. surface: depth and, if
    known, number of the object, by which what the denoiser leaves is evened out.
    """

    def __init__(self, read, direct, denoise, guides, surface):
        self.denoise, self.guides, self.surface, self.cleaned = denoise, guides, surface, {}
        first = read("DiffDir")
        self.rendered = {True: first if np.ndim(direct) or direct else None,
                         False: first + read("DiffInd") if "DiffInd" in read else first}

    def clean(self, direct):
        if not self.denoise:
            return self.rendered[direct]
        if direct not in self.cleaned:
            self.cleaned[direct] = self.denoise(self.rendered[direct], *self.guides, *self.surface)
        return self.cleaned[direct]


# Layers that may as well be absent where they are 0 everywhere.
_NEUTRAL = ("specular", "highlights", "gloss", "style", "controls", "anchor", "tangent", "card")


def assemble(passes: dict[str, np.ndarray], settings: Settings, known: dict[str, np.ndarray] | None = None,
             denoise: Denoise | None = None, denoise_other: bool = False,
             illuminate: Illuminate | None = None) -> tuple[dict[str, np.ndarray], int]:
    """The layers of one picture.

    passes: {classic name: picture}, of CYCLES, BEHIND and SEEN; each is popped when it is read, so that its memory is
    free after its last reader.
    settings: the settings.Settings of the picture.
    known: layers that need not be made of passes, as the rasteriser or a file has them.
    denoise: function of (picture, albedo, normal) that gives the picture (height, width, 3) without noise, or None; of
    light it gets the layers depth and, where known, object, too, to even out what is left.
    denoise_other: clean also what is not diffuse light (Cycles' own denoiser is off while shading is on, because
    it would clean Combined but not the passes, and their difference would be noise).
    illuminate: function of (depth, normal) that draws the layer `diffuse`, instead of what is in the passes.
    Returns ({layer: picture}, number of values read as 0 because they were not finite). EncreError: a pass that
    can't be done without is missing; the sentence lists those found.
    """
    read, layers = _Passes(passes), dict(known or {})
    for layer, name in (("combined", "Combined"), ("diffuse", "DiffDir"), ("color", "DiffCol"), ("depth", "Depth"),
                        ("normal", "Normal")):
        _require(passes, layers, layer, name)
    if "object" not in layers:
        for layer, name in (("object", "IndexOB"), ("material", "IndexMA")):
            if name in read:
                layers[layer] = read.raw(name)
    # The library itself cleans and counts what goes through unchanged: depth may be infinite.
    layers["normal"], layers["color"] = read.raw("Normal"), read("DiffCol")
    _albedo(read, layers, settings)
    if "depth" not in layers:
        layers["depth"] = read.raw("Depth")
    if illuminate:
        # A surface without a diffuse colour has no diffuse light.
        layers["diffuse"] = illuminate(layers["depth"], layers["normal"]) * layers["color"].any(2, keepdims=True)
    _light(read, layers, settings, denoise, denoise_other)
    if "Denoising Albedo" in read and "Denoising Normal" in read:
        layers["seen_color"] = read.raw("Denoising Albedo")
        layers["seen_normal"] = read.raw("Denoising Normal") * _TOWARDS
    else:
        layers.pop("seen_depth", None)
    for name in _NEUTRAL:
        if name in layers and not layers[name].any():
            del layers[name]
    return layers, read.nonfinite


def _albedo(read, layers, settings):
    """Adds the layers `albedo` and, if wanted, `specular`, `highlights` and `background`."""
    if settings.wants_parts and "Env" in read:
        layers["background"] = read.raw("Env")
    layers["albedo"] = np.array(layers["color"])
    for name in ("GlossCol", "TransCol", "Emit"):
        if name in read:
            color = read(name)
            layers["albedo"] += color
            if name == "GlossCol" and settings.wants_gloss:
                layers["gloss"] = np.array(color)
            if name == "GlossCol" and settings.wants_specular:
                gloss = read.total("GlossDir")
                if settings.wants_parts and gloss is not None:
                    layers["highlights"] = gloss * color
                more = read.total("GlossInd")
                gloss = more if gloss is None else gloss if more is None else gloss + more
                if gloss is not None:
                    layers["specular"] = gloss * color
    np.minimum(layers["albedo"], np.float32(1), out=layers["albedo"])


def _light(read, layers, settings, denoise, denoise_other):
    """Adds the layers `diffuse` and `combined`."""
    style = layers.get("style")
    shading = _by_style(style, [v["use_shading"] for v in settings.every])
    direct = _by_style(style, [v["shade_light"] == "DIRECT" for v in settings.every])
    guides = (_where_lit(layers["color"]), finite(layers["normal"])[0]) if denoise else None
    surface = [layers[name] for name in ("depth", "object") if name in layers]
    light = _Light(read, direct, denoise, guides, surface) if "DiffDir" in read else None
    if "diffuse" in layers:
        layers["diffuse"], bad = finite(layers["diffuse"])
        read.nonfinite += bad
    else:
        assert light  # else DiffDir is missing, and assemble() has said so
        clean = light.clean
        layers["diffuse"] = _pick(direct, lambda: clean(True), lambda: clean(False))
    if "combined" not in layers:
        layers["combined"] = _put_together(read, layers, light, shading, denoise_other)


def _where_lit(color):
    """Whether there is any colour for diffuse light to be seen in, of a byte a pixel."""
    return np.broadcast_to(color.any(2, keepdims=True), color.shape)


def _put_together(read, layers, light, shading, denoise_other):
    """The layer `combined`: as rendered, but where light is cut into levels the diffuse part is that of `diffuse`.

    What is left of the picture besides diffuse light is the difference of the passes as rendered; were it taken
    from the denoised light, the noise would come back through it.
    """
    if light is None or not np.any(shading) or layers["diffuse"] is light.rendered[False]:
        return read.raw("Combined")
    combined, color = read("Combined"), layers["color"]
    other = color * light.rendered[False]
    np.subtract(combined[..., :3], other, out=other)
    if denoise_other and light.denoise and np.abs(other).max(initial=0) > _SAME:
        # Nothing but rounding makes it negative in a pixel of its own, and the denoiser knows no negative light.
        guides = layers["albedo"], light.guides[1]
        other = light.denoise(np.maximum(other, 0), *guides) + np.minimum(other, 0)
    result = np.array(combined, order="C")
    shaded = result[..., :3]
    if not np.ndim(shading):  # everywhere: it is at least somewhere
        np.multiply(color, layers["diffuse"], out=shaded)
        shaded += other
        return result
    plain = color * light.clean(False) + other if denoise_other and light.denoise else combined[..., :3]
    shaded[:] = np.where(shading, color * layers["diffuse"] + other, plain)
    return result


class Whole:
    """The layers of a picture (height, width), from those of its bands of rows. zeros(shape) makes an array."""

    def __init__(self, height: int, width: int,
                 zeros: Callable[[tuple[int, ...]], np.ndarray] = lambda shape: np.zeros(shape, np.float32)) -> None:
        self.shape, self.zeros = (height, width), zeros
        self.layers: dict[str, np.ndarray] = {}

    def add(self, row: int, layers: dict[str, np.ndarray]) -> None:
        """Those of the rows from `row` on."""
        for name, picture in layers.items():
            if name not in self.layers:
                self.layers[name] = self.zeros((*self.shape, picture.shape[2]))
            self.layers[name][row:row + len(picture)] = picture
