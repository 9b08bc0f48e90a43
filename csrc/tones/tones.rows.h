/* SPDX-License-Identifier: GPL-3.0-or-later */
/* clang-format off */
STAGE(tones, "Tones", "Dots, lines or ink that fill the levels of light")
SWITCH(use_tones, SURFACE, 0, "", "Tones", "Fill light and shadow with screentone: dots, lines, hatching, stipple or black")
FLOAT(tone_darkness, SURFACE, 0, -1, 1, -1, 1, "", "use_tones", "Darkness", "Makes the tones of all levels darker; below 0 lighter")
FLOAT(tone_black, SURFACE, 0, 0, 1, 0, 0.5, "", "use_tones", "Spotted Blacks", "Colors darker than this have the tone of the darkest level, whatever their light")
FLOAT(tone_dark, SURFACE, 0, 0, 1, 0, 0.5, "", "use_tones", "Dark Colors", "Colors darker than this get darker tones, the more so the nearer they are to Spotted Blacks. 0: none do")
FLOAT(tone_form, SURFACE, 0, 0, 1, 0, 1, "factor", "use_tones&tone_dark", "Form of Dark Colors", "How much light and shade show on dark colors. 0: they have nearly the same tone all over, 1: they get darker as their light does, but not solid")
FLOAT(tone_reds, SURFACE, 0, 0, 100, 0, 5, "", "use_tones&tone_dark", "Deep Reds and Blues", "How much lighter deep reds and blues may be and still count as dark, as red-brown hair should. 1: twice as light. 0: no lighter than others")
FLOAT(tone_black_widest, FRAME, 0, 0, 4096, 0, 200, "px", "use_tones&tone_black", "Widest Black", "Spot only blacks up to this width that stand on something light, as pupils, brows and letters: they get tone 1, and levels of light begin with tone 2. 0: spot all")
ENUM(tone_black_by, SURFACE, 0, "use_tones", "Blacks By", "How the darkness of a color is measured",
     ITEM(tone_black_by, VALUE, 0, "Brightest Channel", "By the largest of red, green and blue: deep blues count as lighter than grays")
     ITEM(tone_black_by, LUMINANCE, 1, "Luminance", "As the eye sees it: navy is as dark as a dark gray"))
FLOAT(tone_local, SURFACE, 0, 0, 1, 0, 1, "factor", "use_tones", "Local Values", "How much light colors keep out of the darkest level. 1: white does so down to half of the light")
FLOAT(tone_open, SURFACE, 0, 0, 4, 0, 2, "factor", "use_tones", "Light in the Dark", "How much of things that hardly any light reaches stays open, instead of filled as the darkest level: light colors that turn to the upper left, as on faces. 0: nothing")
FLOAT(tone_crumbs, FRAME, 0, 0, 4096, 0, 20, "px", "use_tones", "Join Crumbs", "Islands of solid ink, and of light in it, that are no larger than a square of this size join what is around them, but for what has a color of its own, as pupils. 0: all stay")
BOOL(tone_mirrors, SURFACE, 0, "use_tones", "Through Mirrors", "Give what mirrors and clear glass show its own tones, and no tones where they show the sky")
FLOAT(tone_sky, FRAME, 0, 0, FLT_MAX, 0, 4, "", "use_tones&tone_mirrors", "Sky", "How much the sky's own brightness counts as light. 1: as bright as it is; more is lighter. 0: bare paper, or black where it is darker than Spotted Blacks")
FLOAT(tone_detail, FRAME, 0, 0, 4096, 0, 40, "px", "use_tones", "Clear Detail", "Keep tones off letters, eyes and bars whose strokes are no wider than this. 0: tones go over everything")
FLOAT(tone_least, FRAME, 0, 0, 100, 0, 4, "", "use_tones", "Least Width", "Dots and lines with less room than this many spacings become ink, or paper beside ink. 0: they keep any room")
BOOL(tone_crisp, SURFACE, 0, "use_tones", "Crisp", "Each pixel of a tone is ink or paper, without gray edges, and the screen sits on whole pixels: for print at 600 dots an inch or more")
ENUM(tone_strokes, SURFACE, 0, "use_tones", "Strokes", "Which way the strokes of hatching go",
     ITEM(tone_strokes, FORM, 0, "Along the Form", "Around round forms, otherwise along planes that cut the object")
     ITEM(tone_strokes, LIGHT, 1, "Toward the Light", "Down from the light")
     ITEM(tone_strokes, UV, 2, "Along UV", "Along U of the UV map that renders use; along the form where there is none"))
FLOAT(tone_light_direction, SURFACE, 135, -180, 180, -180, 180, "degrees", "use_tones&tone_strokes=LIGHT", "Light Direction", "Where the light comes from, in degrees about the up axis: 0 is along X, 90 along Y")
FLOAT(tone_light_height, SURFACE, 45, -90, 90, 0, 90, "degrees", "use_tones&tone_strokes=LIGHT", "Light Height", "How high the light is above the ground, in degrees")
ENUM(tone_pitch_unit, FRAME, 0, "use_tones", "Spacing Unit", "Unit of the spacing of dots and lines",
     ITEM(tone_pitch_unit, LENGTH, 0, "Length", "From dot to dot, in the unit of other lengths")
     ITEM(tone_pitch_unit, LPI, 1, "Lines an Inch", "Dots or lines to the inch of the printed page"))
/* One tone for each level of light, the darkest first; the last is that of all brighter levels. tone_<n> is what it is,
 * tone_<n>_... how it looks. One more: a row below with SAME, which draws what files saved before have, TONE_SLOTS and
 * TONE_EACH (tones.h), and TONES (pen/params.py). */
#define TONE(n, value, whose, more) \
ENUM(tone_##n, SURFACE, value, "use_tones", "Tone " #n, "What fills " whose, \
     ITEM(tone_##n, NONE, 0, "None", "Nothing") \
     ITEM(tone_##n, SOLID, 1, "Solid", "Ink all over, however dark the level is") \
     ITEM(tone_##n, DOTS, 2, "Dots", "Dots, larger where the level is darker") \
     ITEM(tone_##n, LINES, 3, "Lines", "Parallel lines, wider where the level is darker") \
     ITEM(tone_##n, CROSS, 4, "Cross-Lines", "Lines in two directions") \
     ITEM(tone_##n, GRAIN, 5, "Grain", "Pencil rubbed over the paper, as in Hatching") \
     ITEM(tone_##n, HATCH, 6, "Hatching", "Strokes along the form, in layers across each other as it gets darker") \
     ITEM(tone_##n, STIPPLE, 7, "Stipple", "Spots set by hand, more where it is darker") \
     ITEM(tone_##n, IMAGE, 8, "Image", "A picture, repeated side by side, whose dark parts are inked first") more(n)) \
IMAGE(tone_##n##_image, SURFACE, "", "use_tones&tone_" #n "=IMAGE", "Image " #n, "Picture whose dark parts are inked first; only the order of its grays counts") \
FLOAT(tone_##n##_pitch, SURFACE, 8, 0.02, 1000, 4, 40, "px", "use_tones&tone_" #n "=DOTS|LINES|CROSS|HATCH|STIPPLE|IMAGE", "Spacing " #n, "Size of the screentone: about the distance from dot to dot or line to line, at least two pixels. For an image its width") \
FLOAT(tone_##n##_angle, SURFACE, 45, -180, 180, 0, 90, "degrees", "use_tones&tone_" #n "=DOTS|LINES|CROSS|HATCH|IMAGE", "Angle " #n, "Angle of the rows of dots, lines and strokes") \
ENUM(tone_##n##_space, SURFACE, 0, "use_tones&tone_" #n "=DOTS|LINES|CROSS|HATCH|STIPPLE|IMAGE", "Space " #n, "What dots, lines and strokes stick to", \
     ITEM(tone_##n##_space, SCREEN, 0, "Screen", "The picture, as printed: for stills") \
     ITEM(tone_##n##_space, SURFACE, 1, "Surface", "The objects: dots move with them and have the same size at any distance") \
     ITEM(tone_##n##_space, OBJECT, 2, "Object", "The objects, as if painted on: dots grow and shrink with them. Their spacing is in hundredths of a unit, centimeters") \
     ITEM(tone_##n##_space, FLAT, 3, "Flat", "A flat sheet at the origin of each object: it moves and rolls with the object, and is even all over it")) \
FLOAT(tone_##n##_gradient, SURFACE, 0, 0, 1, 0, 1, "factor", "use_tones&tone_" #n "=DOTS|LINES|CROSS|GRAIN|HATCH|STIPPLE|IMAGE", "Gradient " #n, "How much the tone gets lighter within its level, up to that of the next level") \
COLOR(tone_##n##_color, SURFACE, 0, 0, 0, "use_tones&tone_" #n "=SOLID|DOTS|LINES|CROSS|GRAIN|HATCH|STIPPLE|IMAGE", "Color " #n, "Color of its ink")
#define SAME(n) ITEM(tone_##n, SAME, 9, "Same", "As the level before")
#define NONE_BEFORE(n)
TONE(1, 2, "the darkest level of light", NONE_BEFORE)
TONE(2, 2, "the second level of light", NONE_BEFORE)
TONE(3, 0, "the third level of light", NONE_BEFORE)
TONE(4, 0, "the fourth level of light", NONE_BEFORE)
TONE(5, 9, "the fifth level of light", SAME)
TONE(6, 9, "the sixth level of light, and all brighter ones", SAME)
#undef NONE_BEFORE
#undef SAME
#undef TONE
