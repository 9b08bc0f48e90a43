# SPDX-License-Identifier: GPL-3.0-or-later
"""Rows of parameters, as panels of stages, lists and styles show them."""

import functools

from ...pen import denoise
from ...pen.params import terms
from .. import versions
from ..languages import CONTEXT, iface_
from . import presets, settings
from .levels import draw_levels


def enabled(group, rule):
    """Whether a parameter's `enabled_if` holds for the values of a group; parameters that it lacks count as on."""
    return all(terms(rule, lambda id_: getattr(group, id_, True)).values())


def labelled(group, p):
    """What a row is called, with the unit of its number."""
    words = iface_(p.label, CONTEXT)
    if p.unit == "px":
        settings = group.id_data.encre
        return f"{words} mm" if settings.length_unit == "MM" else f"{words} px"
    return f"{words} °" if p.unit in ("angle", "degrees") else words


def draw_params(layout, group, params, path, label=None):
    """A row for each parameter; label(p): what it is called there, in the language that Blender speaks."""
    label = label or functools.partial(labelled, group)
    layout.use_property_split = True
    layout.use_property_decorate = path != "style"
    preset = presets.current(group.id_data)
    for p in params:
        line = layout.row(align=True)
        row = line.column()
        noisy = p.id == "light_denoise" and not denoise.available(versions.home())
        row.active = enabled(group, p.enabled_if) and not noisy
        if p.type == "levels":
            draw_levels(row, group, path)
        elif p.type == "image":
            row.template_ID(group, p.id, open="image.open", text=label(p))
        elif noisy:
            row.label(text=iface_("{}: this Blender has none", CONTEXT).format(label(p)), translate=False)
        else:
            # Beside a number there is room for a dozen letters, at the width that Blender begins with.
            row.use_property_split = p.type not in ("float", "int", "bool")
            row.prop(group, p.id, text=label(p), translate=False)
        if path == "scene":
            settings.draw_reset(line, group, p, preset)
