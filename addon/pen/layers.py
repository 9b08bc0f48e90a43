# SPDX-License-Identifier: GPL-3.0-or-later
"""Passes of a rendered picture -> the layers that the library reads.

Pure numpy: the engine uses it on Cycles' passes in memory, the command line on those of a saved file. Pictures are
float32 (height, width, channels), row 0 at the top, of any strides, so a picture stored bottom-up is a flipped view.
Passes go by their classic names; `classic()` translates those of Blender 5.
"""

import numpy as np

from . import library
from .errors import EncreError

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
# The pictures that the library draws beside Combined.
DRAWN = {"Encre Lines": "RGBA", "Encre Surface": "RGBA", "Encre Edges": "X", "Encre Light": "RGB"}
# The last of SEEN as a distance along the view axis; saved where SEEN is rendered.
SAVED_SEEN = {"Encre Seen Depth": "X"}
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
    "IndexOB": "Object Index",
    "IndexMA": "Material Index",
}
_CLASSIC = {new: old for old, new in RENAMED.items()}


def __getattr__(name):
    # SAVED: what restyling a saved picture needs besides Cycles' passes, and the library says what is painted. Z of the
    # marks is 0: Blender's compositor knows no passes of two channels.
    if name == "SAVED":
        return {"Encre Source": "RGBA", "Encre Diffuse": "RGB", "Encre Index": "XYZ",
                **dict.fromkeys(control_passes(), "XYZ"), "Encre Marks": "XYZ"}
    raise AttributeError(name)


def control_passes():
    """{pass of a file: [(its channel, that of the layer `controls`)]}."""
    out = {}
    for k, control in enumerate(library.controls().values()):
        out.setdefault(control.saved, []).append((control.channel, k))
    return out


def saved_controls(controls):
    """The passes that keep the layer `controls` in a file."""
    out = {}
    for name, places in control_passes().items():
        out[name] = np.zeros((*controls.shape[:2], 3), np.float32)
        for channel, k in places:
            out[name][..., channel] = controls[..., k]
    return out


def _controls(read):
    """The layer `controls` of the passes that saved_controls() gave; None without any. Older files have fewer."""
    there = [(read.raw(name), places) for name, places in control_passes().items() if name in read]
    if not there:
        return None
    out = np.zeros((*there[0][0].shape[:2], len(library.controls())), np.float32)
    for picture, places in there:
        for channel, k in places:
            out[..., k] = picture[..., channel]
    return out


def classic(name):
    """The classic name of a pass that any Blender wrote."""
    return _CLASSIC.get(name, name)


def seen_depth(length, projection, frame, clip_start):
    """The pass Encre Seen Depth from Cycles' Denoising Depth.

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


class _Passes:
    """Reads passes as (height, width, channels) without NaN and infinities, and counts those it found."""

    def __init__(self, passes):
        self.passes, self.clean, self.nonfinite = passes, {}, 0

    def __contains__(self, name):
        return self.passes.get(name) is not None

    def raw(self, name):
        picture = np.asarray(self.passes[name], np.float32)
        return picture[..., None] if picture.ndim == 2 else picture

    def __call__(self, name):
        if name not in self.clean:
            picture = self.raw(name)
            bad = ~np.isfinite(picture)
            found = np.count_nonzero(bad)
            self.nonfinite += found
            self.clean[name] = np.where(bad, np.float32(0), picture) if found else picture
        return self.clean[name]

    def total(self, *names):
        """The sum of those of the passes that are there; None without any."""
        there = [self(name) for name in names if name in self]
        return sum(there[1:], there[0]) if there else None


def _require(passes, *choices):
    if not any(name in passes for name in choices):
        found = ", ".join(sorted(name for name in passes.passes if name in passes)) or "none"
        raise EncreError(f"pass {choices[-1]} is missing: render the picture with it; passes found: {found}")


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
    """Light without the colour of the surface, direct alone or all of it, as rendered or denoised."""

    def __init__(self, passes, denoise, guides):
        self.passes, self.denoise, self.guides, self.kept = passes, denoise, guides, {}

    def rendered(self, direct):
        if ("rendered", direct) not in self.kept:
            names = ("DiffDir",) if direct else ("DiffDir", "DiffInd")
            self.kept["rendered", direct] = self.passes.total(*names)
        return self.kept["rendered", direct]

    def clean(self, direct):
        if not self.denoise:
            return self.rendered(direct)
        if ("clean", direct) not in self.kept:
            self.kept["clean", direct] = self.denoise(self.rendered(direct), *self.guides)
        return self.kept["clean", direct]


def assemble(passes, settings, denoise=None, denoise_other=False):
    """The layers of one picture.

    passes: {classic name: picture}, Cycles', any of SAVED, which are preferred, of SEEN and of SAVED_SEEN; absent ones
    None or not there.
    settings: the settings.Settings of the picture.
    denoise: function of (picture, albedo, normal) that gives the picture (height, width, 3) without noise, or None.
    denoise_other: clean also what is not diffuse light (Cycles' own denoiser is off while shading is on, because
    it would clean Combined but not the passes, and their difference would be noise).
    Returns ({layer: picture}, number of values read as 0 because they were not finite). EncreError: a pass that
    can't be done without is missing; the sentence lists those found.
    """
    read = _Passes(passes)
    _require(read, "Encre Source", "Combined")
    _require(read, "Encre Diffuse", "DiffDir")
    for name in ("DiffCol", "Depth", "Normal"):
        _require(read, name)
    # The library itself cleans and counts what goes through unchanged: depth may be infinite.
    layers = {"depth": read.raw("Depth"), "normal": read.raw("Normal"), "color": read("DiffCol")}
    layers["albedo"] = np.minimum(read.total("DiffCol", "GlossCol", "TransCol", "Emit"), np.float32(1))
    gloss = read.total("GlossDir", "GlossInd")
    if gloss is not None and "GlossCol" in read:
        layers["specular"] = gloss * read("GlossCol")
    if "Encre Index" in read:
        index = read.raw("Encre Index")
        layers.update(object=index[..., :1], material=index[..., 1:2], style=index[..., 2:3])
    else:
        for layer, name in (("object", "IndexOB"), ("material", "IndexMA")):
            if name in read:
                layers[layer] = read.raw(name)
    if (controls := _controls(read)) is not None:
        layers["controls"] = controls
    if "Encre Marks" in read and read.raw("Encre Marks").any():
        layers["marks"] = read.raw("Encre Marks")[..., :2]

    if "Denoising Albedo" in read and "Denoising Normal" in read:
        layers["seen_color"] = read.raw("Denoising Albedo")
        layers["seen_normal"] = read.raw("Denoising Normal") * np.float32((1, 1, -1))  # Cycles' camera looks along +z
        if "Encre Seen Depth" in read:
            layers["seen_depth"] = read.raw("Encre Seen Depth")

    shading = _by_style(layers.get("style"), [v["use_shading"] for v in settings.every])
    direct = _by_style(layers.get("style"), [v["shade_light"] == "DIRECT" for v in settings.every])
    light = _Light(read, denoise, (layers["albedo"], read("Normal")) if denoise else None)
    if "Encre Diffuse" in read:
        layers["diffuse"] = read("Encre Diffuse")
    else:
        layers["diffuse"] = _pick(direct, lambda: light.clean(True), lambda: light.clean(False))
    if "Encre Source" in read:
        layers["combined"] = read.raw("Encre Source")
    else:
        layers["combined"] = _put_together(read, layers, light, shading, denoise_other)
    return layers, read.nonfinite


def _put_together(read, layers, light, shading, denoise_other):
    """The layer `combined`: as rendered, but where light is cut into levels the diffuse part is that of `diffuse`.

    What is left of the picture besides diffuse light is the difference of the passes as rendered; were it taken
    from the denoised light, the noise would come back through it.
    """
    if not np.any(shading) or "DiffDir" not in read:
        return read.raw("Combined")
    rendered, color = light.rendered(False), layers["color"]
    if layers["diffuse"] is rendered:
        return read.raw("Combined")
    combined = read("Combined")
    other = combined[..., :3] - color * rendered
    plain = combined[..., :3]
    if denoise_other and light.denoise:
        # Nothing but rounding makes it negative in a pixel of its own, and the denoiser knows no negative light.
        other = light.denoise(np.maximum(other, 0), *light.guides) + np.minimum(other, 0)
        if np.ndim(shading):
            plain = color * light.clean(False) + other
    result = np.empty_like(combined, order="C")
    result[..., :3] = _pick(shading, lambda: color * layers["diffuse"] + other, lambda: plain)
    result[..., 3] = combined[..., 3]
    return result
