# SPDX-License-Identifier: GPL-3.0-or-later
"""What mirrors: whether it shows things clearly; and what flat mirrors show, which is what a camera sees that stands as
far behind them as the real one before."""

from dataclasses import dataclass

import numpy as np

from ..pen.sky import directions
from . import pictures, trees

_SMOOTH = 0.1     # roughness up to which a surface is a mirror
_SOMEWHERE = 0.02  # of an image that says how rough: what is smooth in less of it is nowhere a mirror
_SHINING = {"BsdfGlossy", "BsdfAnisotropic", "BsdfGlass", "BsdfRefraction"}
_COATS = ("Coat Weight", "Coat Roughness"), ("Clearcoat", "Clearcoat Roughness")  # since 4.0, before
_LEAST = 64       # pixels of a mirror that is drawn
_MOST = 4         # of them in a picture, the largest
_STRAIGHT = 0.9999  # cosine of what normals of one plane may differ by
_NEAR = 1e-3      # how far points of one plane may lie off it, as a part of their distance


@dataclass
class Mirror:
    where: np.ndarray  # (height, width), bool
    turn: np.ndarray   # world -> world as it shows it, 4 x 4


def blurs(material):
    """Whether a material shows nothing clearly, neither mirrored nor through it: all that shines in it is rougher than
    a mirror. Where a texture says how rough, but no image, it may be clear."""
    for node in trees.nodes_of(material):
        sort = node.bl_idname.removeprefix("ShaderNode")
        if sort == "BsdfTransparent" or sort in _SHINING and (
                getattr(node, "distribution", "") == "SHARP" or _clear(node.inputs["Roughness"])):
            return False
        if sort == "BsdfPrincipled" and (_clear(node.inputs["Roughness"]) or _has(node.inputs["Alpha"], 1) or any(
                _has(node.inputs[coat], 0) and _clear(node.inputs[coat_rough])
                for coat, coat_rough in _COATS if coat in node.inputs)):
            return False
    return True


def _clear(roughness):
    if not roughness.is_linked:
        return roughness.default_value <= _SMOOTH
    node, output = trees.source_of(roughness) or (None, None)
    channel = None
    if node and node.bl_idname in ("ShaderNodeSeparateColor", "ShaderNodeSeparateRGB"):
        if getattr(node, "mode", "RGB") != "RGB":
            return True
        channel = list(node.outputs).index(output)
        node, output = trees.source_of(node.inputs[0]) or (None, None)
    if not node or node.bl_idname != "ShaderNodeTexImage" or output.name != "Color":
        return True
    try:
        image = pictures.still(node)
    except trees.Unknown:
        return True
    return image is None or pictures.share_below(image, channel, _SMOOTH) > _SOMEWHERE


def _has(socket, usual):
    return socket.is_linked or socket.default_value != usual


def find(maps, looks, clear, view, projection, frame):
    """The Mirrors of a picture. maps, looks: what the rasteriser and the materials gave; clear: by number of material,
    whether light goes through it. Orthographic cameras get none."""
    if projection[3, 3] == 1:
        return []
    red, green, blue = np.moveaxis(looks["gloss"], 2, 0)
    smooth = ((red + green + blue) > 0) & (looks["surface"][..., 1] <= _SMOOTH)
    if not smooth.any():
        return []
    thing, material = maps["object"].astype(np.intp), maps["material"].astype(np.intp)
    smooth &= ~clear[material]
    numbers, counts = np.unique(thing[smooth], return_counts=True)
    found = []
    for number in numbers[np.argsort(-counts, kind="stable")][:_MOST]:
        pixels = np.flatnonzero(smooth & (thing == number))
        if len(pixels) < _LEAST:
            break
        ray = directions(view, projection, frame, pixels, thing.shape[1])
        depth = maps["depth"].reshape(-1)[pixels, None]
        eye = -view[:3, :3].T @ view[:3, 3]
        place = eye + ray * (depth / -(ray @ view[2, :3])[:, None])
        normals = maps["shading"].reshape(-1, 3)[pixels]
        normal = np.median(normals, 0).astype(np.float64)
        normal /= max(np.linalg.norm(normal), 1e-9)
        high = place @ normal
        flat = (normals @ normal > _STRAIGHT) & (np.abs(high - np.median(high)) < _NEAR * depth[:, 0])
        if flat.sum() < _LEAST:
            continue
        where, turn = np.zeros(thing.shape, bool), np.eye(4)
        where.reshape(-1)[pixels[flat]] = True
        turn[:3, :3] -= 2 * np.outer(normal, normal)
        turn[:3, 3] = 2 * np.median(high) * normal
        found.append(Mirror(where, turn))
    return found
