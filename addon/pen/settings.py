# SPDX-License-Identifier: GPL-3.0-or-later
"""The settings of a scene and its styles, and what they ask for."""

from . import library


def switches():
    """Ids of the parameters that turn a stage off."""
    return [stage.switch.id for stage in library.stages() if stage.switch]


def every_style(scene, styles):
    """The complete values of each style, number 0 (the scene's) first; `styles` holds only what each changes."""
    base = {**library.defaults(), **scene}
    return [base] + [{**base, **values} for values in styles]


def active(scene, styles):
    """Whether any stage draws anything: with all switches off the picture stays as it was rendered."""
    return any(values[switch] for values in every_style(scene, styles) for switch in switches())


def _edges(every):
    """Whether any stage reads edges; `every` style's values."""
    return any(values["use_lines"] or values["use_smudging"] for values in every)


def shaded(scene, styles):
    """Whether light is cut into levels anywhere."""
    return any(values["use_shading"] for values in every_style(scene, styles))


def wants_light(scene, styles):
    """Whether anything compares light with a threshold, so that its noise would show as speckle."""
    return active(scene, styles) and any(
        values["use_shading"] or values["use_hatching"] or values["edge_light"] or values["line_light"]
        for values in every_style(scene, styles))


def wants_seen(scene, styles):
    """Whether lines are drawn in what mirrors and glass show."""
    every = every_style(scene, styles)
    return every[0]["edge_detector"] == "FINE" and any(values["edge_seen"] > 0 for values in every) and _edges(every)


def idle(pictures, scene, styles):
    """{weight: why} of the sources of edges that are asked for and find nothing in the layers of a picture."""
    every = every_style(scene, styles)
    if not _edges(every):
        return {}

    def alike(layer):
        picture = pictures.get(layer)
        return picture is None or bool((picture == picture[0, 0]).all())

    colors = "combined" if every[0]["color_layer"] == "LIT" else "albedo"
    reasons = {
        "edge_object": alike("object") and "one index everywhere",
        "edge_material": alike("material") and "one index everywhere",
        "edge_depth": alike("depth") and "one depth everywhere",
        "edge_normal": alike("normal") and "one normal everywhere",
        "edge_color": alike(colors) and "one colour everywhere",
        "edge_light": alike("diffuse") and "the same light everywhere",
        "edge_seen": wants_seen(scene, styles) and "seen_normal" not in pictures and "no passes that see into mirrors",
    }
    return {name: why for name, why in reasons.items() if why and any(values[name] > 0 for values in every)}
