/* SPDX-License-Identifier: GPL-3.0-or-later */
/* clang-format off */
/* The hands and the tools that draw the lines of FINE; pen.c reads these, kinds.c those of kinds and colours.
 *
 * Pens are alike, in groups of rows that one macro makes, and each kind of line says which draws it. What the first is
 * for a tool the rows line_... tell, the others have that of their own. One more: a STAGE with both groups here, an item
 * in KIND_PEN, PENS in pen.h, and PENS in pen/params.py, after which the list in the panel has it. */
#ifndef PEN_ROWS
#define PEN_RULE "use_lines&edge_detector=FINE"
/* The hand. What is random in it is noise where a line is on its thing. */
#define PEN_ROWS(pen) \
FLOAT(pen##_pressure, SURFACE, 0, 0, 4, 0, 1, "factor", PEN_RULE, "Pressure", "How far lines swell and thin along their way, as a share of their width") \
FLOAT(pen##_pressure_length, SURFACE, 210, 1, 16384, 20, 500, "px", PEN_RULE "&" #pen "_pressure", "Pressure Length", "Length of the line from one swelling to the next, about") \
FLOAT(pen##_curve, SURFACE, 0, -1, 4, -1, 1, "factor", PEN_RULE, "Curve", "How much wider lines are where they bend, as a share of their width; below 0 they are thinner there") \
FLOAT(pen##_wobble, SURFACE, 0, 0, 128, 0, 8, "px", PEN_RULE, "Wobble", "How far the hand strays from the edge") \
FLOAT(pen##_wobble_length, SURFACE, 135, 1, 16384, 20, 500, "px", PEN_RULE "&" #pen "_wobble", "Wobble Length", "Length of the line from one stray to the next, about") \
FLOAT(pen##_rough, SURFACE, 0, 0, 64, 0, 4, "px", PEN_RULE, "Roughness", "How far the rim of the line is frayed") \
FLOAT(pen##_rough_length, SURFACE, 12, 1, 1024, 3, 60, "px", PEN_RULE "&" #pen "_rough", "Roughness Length", "Size of what is frayed, about") \
FLOAT(pen##_gaps, SURFACE, 0, 0, 1, 0, 0.5, "factor", PEN_RULE, "Gaps", "Share of a line that is left out") \
FLOAT(pen##_gaps_length, SURFACE, 90, 1, 16384, 20, 500, "px", PEN_RULE "&" #pen "_gaps", "Gaps Length", "Length from one gap to the next, about") \
FLOAT(pen##_dash, SURFACE, 0, 0, 16384, 0, 200, "px", PEN_RULE, "Dash", "Length of dashes, about; 0: lines are whole") \
FLOAT(pen##_dash_space, SURFACE, 10, 0, 16384, 0, 200, "px", PEN_RULE "&" #pen "_dash", "Dash Space", "Length left out between dashes") \
FLOAT(pen##_dry, SURFACE, 0, 0, 2, 0, 1, "factor", PEN_RULE, "Dryness", "How much of the line the bristles leave white") \
FLOAT(pen##_dry_length, SURFACE, 33, 1, 16384, 5, 300, "px", PEN_RULE "&" #pen "_dry", "Dryness Length", "Length of the streaks, about") \
INT(pen##_bristles, SURFACE, 6, 1, 8, 1, 8, "", PEN_RULE "&" #pen "_dry", "Bristles", "Streaks side by side across the line") \
FLOAT(pen##_strip, SURFACE, 0, 0, 1, 0, 1, "factor", PEN_RULE, "Strip", "How much of a line is left white where a picture that lies along it is light") \
FLOAT(pen##_strip_length, SURFACE, 300, 1, 16384, 20, 1000, "px", PEN_RULE "&" #pen "_strip", "Strip Length", "Length of the line along which the picture lies, about, then it begins anew") \
INT(pen##_strokes, SURFACE, 1, 1, 4, 1, 4, "", PEN_RULE, "Strokes", "How many times each line is drawn, every time with another wobble") \
FLOAT(pen##_overshoot, SURFACE, 0, 0, 1024, 0, 60, "px", PEN_RULE, "Overshoot", "How far strokes go on beyond corners, about") \
FLOAT(pen##_overshoot_color, SURFACE, 1, 0, 1, 0, 1, "factor", PEN_RULE "&" #pen "_overshoot", "Overshoot of Colors", "Share of it by which lines between colors and materials go on: bricks and letters bristle at 1") \
FLOAT(pen##_pool, SURFACE, 0, 0, 4, 0, 1, "factor", PEN_RULE, "Pooling", "How much wider lines are where they turn back, where ink gathers") \
INT(pen##_seed, SURFACE, 0, 0, 2147483647, 0, 1000, "", PEN_RULE, "Seed", "Another hand") \
INT(pen##_hold, SURFACE, 0, 0, 10000, 0, 8, "", PEN_RULE, "Hold", "Frames for which a line stays as it is drawn, then it is drawn anew: 2 is on twos; 0: lines are drawn once for all frames") \
FLOAT(pen##_boil, SURFACE, 1, 0, 1, 0, 1, "factor", PEN_RULE "&" #pen "_hold", "Boil", "How much of a line is another whenever it is drawn anew")
/* Apart from the others: a hand has numbers alone. */
#define STRIP_ROW(pen) \
IMAGE(pen##_strip_image, SURFACE, "", PEN_RULE "&" #pen "_strip", "Strip Image", "Picture along the line, ink where it is dark, from its left to its right and from rim to rim")
/* The tool. */
#define TOOL_ROWS(pen) \
FLOAT(pen##_width, SURFACE, 1, 0, 4096, 0, 4, "", PEN_RULE, "Width", "Its lines are so many times as wide as those of the first pen") \
FLOAT(pen##_taper, SURFACE, 0, 0, 4096, 0, 128, "px", PEN_RULE, "Taper", "Length over which a line thins out towards an end that meets no other line; 0: blunt ends") \
FLOAT(pen##_softness, SURFACE, 0.9, 0, 1, 0, 1, "factor", PEN_RULE, "Softness", "Share of the half width over which a line fades; 0 is a sharp pen") \
FLOAT(pen##_intensity, SURFACE, 1, 0, FLT_MAX, 0, 4, "", PEN_RULE, "Intensity", "Pressure of the pencil") \
FLOAT(pen##_gain, SURFACE, 4, 0, FLT_MAX, 0, 16, "", PEN_RULE, "Steepness", "How quickly a line gets from bare paper to full ink") \
FLOAT(pen##_paper, SURFACE, 0.6, 0, 1, 0, 1, "factor", PEN_RULE, "Paper", "How much the grain of the paper breaks the line")
#define KIND_PEN(id, label, help) \
ENUM(id, SURFACE, 0, PEN_RULE, label, help, \
     ITEM(id, PEN, 0, "Pen", "The pen of the lines' own settings") \
     ITEM(id, PEN_2, 1, "Pen 2", "The second pen") \
     ITEM(id, PEN_3, 2, "Pen 3", "The third pen"))
#endif
STAGE(pen, "Pen", "The hand and the tool that draw the lines")
PEN_ROWS(pen)
STRIP_ROW(pen)
FLOAT(ink_on_dark, SURFACE, 0, 0, 1, 0, 1, "factor", "use_lines&edge_detector=FINE", "Ink on Dark", "How far lines that run through dark areas take the second ink, so that they are seen there")
COLOR(ink_dark_color, SURFACE, 1, 1, 1, "use_lines&edge_detector=FINE&ink_on_dark", "Second Ink", "Color of lines that run through dark areas")
FLOAT(ink_dark_threshold, SURFACE, 0.03, 0, FLT_MAX, 0, 0.5, "", "use_lines&edge_detector=FINE&ink_on_dark", "Dark Threshold", "Pictures darker than this on both sides of a line are dark areas")
FLOAT(ink_dark_width, SURFACE, 1, 0, 1, 0.2, 1, "factor", "use_lines&edge_detector=FINE&ink_on_dark", "Dark Width", "How wide lines through dark areas are, as a share of their width: what is light looks wider than what is dark")
FLOAT(ink_dark_colors, SURFACE, 1, 0, 1, 0, 1, "factor", "use_lines&edge_detector=FINE&ink_on_dark", "Dark Colors", "How wide, of that, lines between colors and materials are in the dark; 0: patterns are not drawn there")
FLOAT(line_lit, SURFACE, 0, 0, 1, 0, 1, "factor", "use_lines&edge_detector=FINE", "Ink in Light", "How far lines in the light take the ink of the light")
COLOR(line_lit_color, SURFACE, 0.5, 0.25, 0.1, "use_lines&edge_detector=FINE&line_lit", "Ink of the Light", "Color of lines in the light")
STAGE(pen_2, "Pen 2", "A second pen, for the kinds of line that name it")
PEN_ROWS(pen_2)
TOOL_ROWS(pen_2)
STRIP_ROW(pen_2)
STAGE(pen_3, "Pen 3", "A third pen, for the kinds of line that name it")
PEN_ROWS(pen_3)
TOOL_ROWS(pen_3)
STRIP_ROW(pen_3)
STAGE(kinds, "Kinds of Line", "Which pen and which ink draw each kind of line")
KIND_PEN(line_pen_outline, "Outline Pen", "Lines between an object and what lies behind it")
KIND_PEN(line_pen_contact, "Contact Pen", "Lines between objects that touch")
KIND_PEN(line_pen_inner, "Inner Pen", "Lines between parts of an object of which one hides the other")
KIND_PEN(line_pen_crease, "Crease Pen", "Lines where a surface bends")
KIND_PEN(line_pen_intersection, "Intersection Pen", "Lines where pieces of a mesh pass through each other")
KIND_PEN(line_pen_material, "Material Pen", "Lines between materials")
KIND_PEN(line_pen_color, "Color Pen", "Lines between colors")
KIND_PEN(line_pen_light, "Shadow Edge Pen", "Lines between levels of light")
KIND_PEN(line_pen_seen, "Mirror Pen", "Lines in mirrors and behind glass")
KIND_PEN(line_pen_suggestive, "Suggestive Pen", "Suggestive contours")
KIND_PEN(line_pen_mark, "Mark Pen", "Lines drawn by hand")
BOOL(line_color_by_kind, SURFACE, 0, "use_lines&edge_detector=FINE", "Color by Kind", "Each kind of line has an ink of its own")
COLOR(line_color_outline, SURFACE, 0, 0, 0, "use_lines&edge_detector=FINE&line_color_by_kind", "Outline Ink", "Lines between an object and what lies behind it")
COLOR(line_color_contact, SURFACE, 0, 0, 0, "use_lines&edge_detector=FINE&line_color_by_kind", "Contact Ink", "Lines between objects that touch")
COLOR(line_color_inner, SURFACE, 0, 0, 0, "use_lines&edge_detector=FINE&line_color_by_kind", "Inner Ink", "Lines between parts of an object of which one hides the other")
COLOR(line_color_crease, SURFACE, 0, 0, 0, "use_lines&edge_detector=FINE&line_color_by_kind", "Crease Ink", "Lines where a surface bends")
COLOR(line_color_intersection, SURFACE, 0, 0, 0, "use_lines&edge_detector=FINE&line_color_by_kind", "Intersection Ink", "Lines where pieces of a mesh pass through each other")
COLOR(line_color_material, SURFACE, 0, 0, 0, "use_lines&edge_detector=FINE&line_color_by_kind", "Material Ink", "Lines between materials")
COLOR(line_color_color, SURFACE, 0, 0, 0, "use_lines&edge_detector=FINE&line_color_by_kind", "Color Ink", "Lines between colors")
COLOR(line_color_light, SURFACE, 0, 0, 0, "use_lines&edge_detector=FINE&line_color_by_kind", "Shadow Edge Ink", "Lines between levels of light")
COLOR(line_color_seen, SURFACE, 0, 0, 0, "use_lines&edge_detector=FINE&line_color_by_kind", "Mirror Ink", "Lines in mirrors and behind glass")
COLOR(line_color_suggestive, SURFACE, 0, 0, 0, "use_lines&edge_detector=FINE&line_color_by_kind", "Suggestive Ink", "Suggestive contours")
COLOR(line_color_mark, SURFACE, 0, 0, 0, "use_lines&edge_detector=FINE&line_color_by_kind", "Mark Ink", "Lines drawn by hand")
