/* SPDX-License-Identifier: GPL-3.0-or-later */
/* clang-format off */
STAGE(tones, "Tones", "Dots, lines or ink that fill the levels of light")
SWITCH(use_tones, SURFACE, 0, "", "Tones", "Fill the levels of light with dots, lines or ink")
#define TONE_ITEMS(id) \
     ITEM(id, NONE, 0, "None", "Nothing") \
     ITEM(id, SOLID, 1, "Solid", "Ink all over, however dark the level is") \
     ITEM(id, DOTS, 2, "Dots", "Dots whose share of the surface is the level's darkness") \
     ITEM(id, LINES, 3, "Lines", "Parallel lines, as wide as the darkness wants") \
     ITEM(id, CROSS, 4, "Cross-Lines", "Lines in two directions") \
     ITEM(id, GRAIN, 5, "Grain", "Pencil rubbed over the paper, as in Hatching")
ENUM(tone_dark, SURFACE, 2, "use_tones", "Darkest Level", "What fills the darkest level of light", TONE_ITEMS(tone_dark))
ENUM(tone_middle, SURFACE, 2, "use_tones", "Levels Between", "What fills the levels between the darkest and the brightest", TONE_ITEMS(tone_middle))
ENUM(tone_light, SURFACE, 0, "use_tones", "Brightest Level", "What fills the brightest level of light", TONE_ITEMS(tone_light))
FLOAT(tone_darkness, SURFACE, 0, -1, 1, -1, 1, "", "use_tones", "Darkness", "Added to how dark a level is, which is 1 less its intensity")
FLOAT(tone_pitch, SURFACE, 8, 1, 1000, 4, 40, "px", "use_tones", "Pitch", "From dot to dot or line to line, at least two pixels of the picture")
FLOAT(tone_angle, SURFACE, 45, -180, 180, 0, 90, "degrees", "use_tones", "Angle", "By which rows of dots, and lines, are turned")
FLOAT(tone_hardness, SURFACE, 1, 0, 1, 0, 1, "factor", "use_tones", "Hardness", "1: dots and lines have an edge; 0: they fade over half their distance")
COLOR(tone_color, SURFACE, 0, 0, 0, "use_tones", "Color", "Colour of the ink")
ENUM(tone_space, SURFACE, 0, "use_tones", "Space", "What dots and lines keep to",
     ITEM(tone_space, SCREEN, 0, "Screen", "The picture, as printed: for stills")
     ITEM(tone_space, SURFACE, 1, "Surface", "The things: they move with them, and have the same size at any distance"))
#undef TONE_ITEMS
