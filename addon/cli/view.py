# SPDX-License-Identifier: GPL-3.0-or-later
"""Pictures shown as Blender shows them: exposure, look, view transform, gamma.

Standard is sRGB. All else is told by an OpenColorIO configuration, which every Blender brings along; OpenImageIO, in
which OpenColorIO is, applies it.
"""

import numpy as np

from ..pen import colour
from . import images, installed

_SRGB = ("", "sRGB")
_HERE = "lin_rec709_scene"  # the working space that colour.to_rec709() leads to


def _configuration(display, transform, look):
    """(path, names of its colour spaces) of the first configuration that knows all three; None: none does."""
    oiio = images.openimageio()
    for path in installed.colour_configurations():
        with images.quiet():  # it may be of a newer kind than OpenImageIO's
            known = oiio.ColorConfig(path)
        if not known.geterror() and display in known.getDisplayNames() and transform in known.getViewNames(display) \
                and look in ("", *known.getLookNames()):
            return path, known.resolve(_HERE) in known.getColorSpaceNames()
    return None


class Shown:
    """How a picture is shown: by a metadata.View as far as this machine can. As a function, it makes of scene-linear
    colours (rows, W, 3), not multiplied by alpha, what a display gets, 0 ... 1.

    wide: whether the colours came from another working space, and are in Rec. 709 now, whatever a configuration says.
    """

    def __init__(self, view, wide=False):
        self.view, self.wide = view, wide
        self.plain = view.transform in ("", "Standard") and view.display in _SRGB and not view.look
        self.known = None if self.plain else _configuration(view.display or "sRGB", view.transform, view.look)

    def lacks(self):
        """What of the view can't be shown, in half a sentence; None: nothing."""
        if not (self.plain or self.known):
            own = " and look ".join(name for name in (self.view.transform, self.view.look) if name)
            return f"no Blender is found here that brings the view transform {own}: the PNG is Standard"
        if self.view.beside:
            return f"{' and '.join(self.view.beside)} of the scene's view are Blender's alone: the PNG is without"
        return None

    def __call__(self, linear):
        if self.view.exposure:
            linear = linear * np.float32(2 ** self.view.exposure)
        encoded = np.clip(self._displayed(linear), 0, 1) if self.known else colour.encode_srgb(linear)
        return encoded if self.view.gamma == 1 else encoded ** (1 / self.view.gamma)

    def _displayed(self, linear):
        oiio, view, (path, here) = images.openimageio(), self.view, self.known
        working = _HERE if self.wide and here else "scene_linear"
        picture = oiio.ImageBuf(np.ascontiguousarray(linear, np.float32))
        if view.look:  # by itself: together with a view OpenImageIO leaves it out
            picture = oiio.ImageBufAlgo.ociolook(picture, view.look, working, working, unpremult=False,
                                                 colorconfig=path)
        picture = oiio.ImageBufAlgo.ociodisplay(picture, view.display or "sRGB", view.transform, fromspace=working,
                                                unpremult=False, colorconfig=path)
        if picture.has_error:
            raise images.WriteError(f"view transform {view.transform}: {path} can't be used "
                                    f"({images.complaint(picture)}); install Blender again")
        return picture.get_pixels(oiio.FLOAT)
