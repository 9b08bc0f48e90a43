/* SPDX-License-Identifier: GPL-3.0-or-later */
/* clang-format off */
STAGE(shade, "Shading", "Flat light in a few levels, tinted and desaturated in the shade")
SWITCH(use_shading, SURFACE, 1, "", "Shading", "Cut the light into flat levels")
LEVELS(shade_levels, SURFACE, "", "Levels", "Levels of light, darkest first, with the thresholds between them", shade_levels_default)
FLOAT(shade_exposure, SURFACE, 1, 0, FLT_MAX, 0, 8, "", "", "Exposure", "Factor on the light before it is compared with thresholds")
ENUM(shade_light, SURFACE, 0, "use_shading", "Light", "The light that is cut into levels",
     ITEM(shade_light, ALL, 0, "All", "Direct and bounced light")
     ITEM(shade_light, DIRECT, 1, "Direct", "Direct light alone: flat tones under bounced light"))
COLOR(shade_tint, SURFACE, 0.60, 0.55, 0.90, "use_shading", "Tint", "Colour of the light in the shade")
FLOAT(shade_tint_weight, SURFACE, 1, 0, FLT_MAX, 0, 4, "", "use_shading", "Tint Weight", "How much of the tint is mixed into the shade")
FLOAT(shade_saturation, SURFACE, 0.6, 0, 1, 0, 1, "factor", "use_shading", "Shade Saturation", "Saturation that a surface keeps in full shade")
FLOAT(shade_strength, SURFACE, 1, 0, 1, 0, 1, "factor", "use_shading", "Strength", "0 is the light as rendered, 1 flat levels")
FLOAT(other_light, FRAME, 1, 0, 1, 0, 1, "factor", "use_shading", "Other Light", "How much of reflections, glass, emission and sky is put over the flat surface")
ENUM(surface, FRAME, 0, "use_shading", "Surface", "What lies under the lines",
     ITEM(surface, SHADED, 0, "Shaded", "The shaded colours")
     ITEM(surface, PAPER, 1, "Paper", "Bare paper: a pen drawing"))
COLOR(paper_color, FRAME, 1, 1, 1, "surface=PAPER", "Paper Color", "Colour of the bare paper")
