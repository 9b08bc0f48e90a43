/* SPDX-License-Identifier: GPL-3.0-or-later */
/* clang-format off */
/* The hands and the tools that draw the lines of FINE; pen.c reads these, kinds.c those of kinds and colours.
 *
 * Pens are alike, in groups of rows that one macro makes, and each kind of line says which draws it. One more: a STAGE
 * with both groups here, an item in KIND_PEN, PENS in pen.h, and PENS in pen/params.py, after which the list in the
 * panel has it. DOG and SOBEL know the first pen alone, and of that the tool. */
#ifndef PEN_ROWS
#define PEN_RULE "use_lines&edge_detector=FINE"
/* The tool. */
#define TOOL_ROWS(pen, rule) \
FLOAT(pen##_width, SURFACE, 1, 0, 4096, 0, 4, "", PEN_RULE, "Width", "Width of this pen's lines, as a multiple of what Thickness and their kind give") \
FLOAT(pen##_taper, SURFACE, 0, 0, 4096, 0, 128, "px", PEN_RULE, "Taper", "Length over which a line gets thinner toward an end that meets no other line. 0: blunt ends") \
FLOAT(pen##_softness, SURFACE, 0.9, 0, 1, 0, 1, "factor", rule, "Softness", "How soft the sides of a line are. 0: a sharp pen") \
FLOAT(pen##_intensity, SURFACE, 1, 0, FLT_MAX, 0, 4, "", rule, "Intensity", "How hard the pencil is pressed: less is fainter") \
FLOAT(pen##_steepness, SURFACE, 4, 0, FLT_MAX, 0, 16, "", rule, "Steepness", "How quickly a line gets from bare paper to full ink") \
FLOAT(pen##_grain, SURFACE, 0.6, 0, 1, 0, 1, "factor", rule, "Paper Grain", "How much the grain of the paper breaks the line")
/* The hand. What is random in it is noise where a line is on its thing. */
#define PEN_ROWS(pen) \
FLOAT(pen##_pressure, SURFACE, 0, 0, 4, 0, 1, "factor", PEN_RULE, "Pressure", "How much lines swell and thin along their way, as a share of their width") \
FLOAT(pen##_pressure_length, SURFACE, 210, 1, 16384, 20, 500, "px", PEN_RULE "&" #pen "_pressure", "Pressure Length", "About the length of line from one swelling to the next") \
FLOAT(pen##_curve, SURFACE, 0, -1, 4, -1, 1, "factor", PEN_RULE, "Curve", "How much wider lines are where they bend, as a share of their width. Below 0 they are thinner there") \
FLOAT(pen##_wobble, SURFACE, 0, 0, 128, 0, 8, "px", PEN_RULE, "Wobble", "How far the hand strays from the edge") \
FLOAT(pen##_wobble_length, SURFACE, 135, 1, 16384, 20, 500, "px", PEN_RULE "&" #pen "_wobble", "Wobble Length", "About the length of line from one stray to the next") \
FLOAT(pen##_rough, SURFACE, 0, 0, 64, 0, 4, "px", PEN_RULE, "Roughness", "How far the sides of the line are frayed") \
FLOAT(pen##_rough_length, SURFACE, 12, 1, 1024, 3, 60, "px", PEN_RULE "&" #pen "_rough", "Roughness Length", "About the size of the fraying") \
FLOAT(pen##_gaps, SURFACE, 0, 0, 1, 0, 0.5, "factor", PEN_RULE, "Gaps", "Share of a line that is left out") \
FLOAT(pen##_gaps_length, SURFACE, 90, 1, 16384, 20, 500, "px", PEN_RULE "&" #pen "_gaps", "Gaps Length", "About the length from one gap to the next") \
FLOAT(pen##_dash, SURFACE, 0, 0, 16384, 0, 200, "px", PEN_RULE, "Dash", "About the length of dashes. 0: whole lines") \
FLOAT(pen##_dash_space, SURFACE, 10, 0, 16384, 0, 200, "px", PEN_RULE "&" #pen "_dash", "Dash Space", "Length of the gaps between dashes") \
FLOAT(pen##_dry, SURFACE, 0, 0, 2, 0, 1, "factor", PEN_RULE, "Dryness", "How much of the line the bristles leave white") \
FLOAT(pen##_strip, SURFACE, 0, 0, 1, 0, 1, "factor", PEN_RULE, "Strip", "How much of a line is left white where Strip Image is light") \
FLOAT(pen##_strip_length, SURFACE, 300, 1, 16384, 20, 1000, "px", PEN_RULE "&" #pen "_strip", "Strip Length", "About the length of line that Strip Image covers before it repeats") \
INT(pen##_strokes, SURFACE, 1, 1, 4, 1, 4, "", PEN_RULE, "Strokes", "How many times each line is drawn, every time with another wobble") \
FLOAT(pen##_overshoot, SURFACE, 0, 0, 1024, 0, 60, "px", PEN_RULE, "Overshoot", "About how far strokes go on beyond corners") \
FLOAT(pen##_overshoot_color, SURFACE, 1, 0, 1, 0, 1, "factor", PEN_RULE "&" #pen "_overshoot", "Overshoot of Colors", "Overshoot of lines between colors and materials, as a share of Overshoot. At 1 bricks and letters bristle") \
FLOAT(pen##_pool, SURFACE, 0, 0, 4, 0, 1, "factor", PEN_RULE, "Pooling", "How much wider lines are at sharp turns, where ink gathers") \
INT(pen##_seed, SURFACE, 0, 0, 2147483647, 0, 1000, "", PEN_RULE, "Seed", "Each number is another hand") \
INT(pen##_hold, SURFACE, 0, 0, 10000, 0, 8, "", PEN_RULE, "Hold", "How many frames a line stays before it is drawn again: 2 is on twos. 0: lines are drawn once for all frames") \
FLOAT(pen##_boil, SURFACE, 1, 0, 1, 0, 1, "factor", PEN_RULE "&" #pen "_hold", "Boil", "How much a line changes each time it is drawn again")
/* Apart from the others: a hand has numbers alone. */
#define STRIP_ROW(pen) \
IMAGE(pen##_strip_image, SURFACE, "", PEN_RULE "&" #pen "_strip", "Strip Image", "Picture that lies along the line, from its left to its right: ink where it is dark")
#define KIND_PEN(id, label, help) \
ENUM(id, SURFACE, 0, PEN_RULE, label, help, \
     ITEM(id, PEN_1, 0, "Pen 1", "The first pen") \
     ITEM(id, PEN_2, 1, "Pen 2", "The second pen") \
     ITEM(id, PEN_3, 2, "Pen 3", "The third pen"))
#endif
STAGE(pen_1, "Pen 1", "The pen of all kinds of line that name no other")
TOOL_ROWS(pen_1, "use_lines")
PEN_ROWS(pen_1)
STRIP_ROW(pen_1)
STAGE(pen_2, "Pen 2", "A second pen, for the kinds of line that name it")
TOOL_ROWS(pen_2, PEN_RULE)
PEN_ROWS(pen_2)
STRIP_ROW(pen_2)
STAGE(pen_3, "Pen 3", "A third pen, for the kinds of line that name it")
TOOL_ROWS(pen_3, PEN_RULE)
PEN_ROWS(pen_3)
STRIP_ROW(pen_3)
STAGE(kinds, "Kinds of Line", "Which pen and which ink draw each kind of line")
KIND_PEN(line_outline_pen, "Outline Pen", "Lines between an object and what lies behind it")
KIND_PEN(line_contact_pen, "Contact Pen", "Lines between objects that touch")
KIND_PEN(line_inner_pen, "Inner Pen", "Lines where one part of an object hides another")
KIND_PEN(line_crease_pen, "Crease Pen", "Lines where a surface bends")
KIND_PEN(line_intersection_pen, "Intersection Pen", "Lines where pieces of a mesh pass through each other")
KIND_PEN(line_material_pen, "Material Pen", "Lines between materials")
KIND_PEN(line_color_pen, "Color Pen", "Lines between colors")
KIND_PEN(line_shadow_pen, "Shadow Edge Pen", "Lines between levels of light")
KIND_PEN(line_mirror_pen, "Mirror Pen", "Lines in mirrors and behind glass")
KIND_PEN(line_suggestive_pen, "Fold Pen", "Folds: lines where a smooth form nearly turns away")
KIND_PEN(line_mark_pen, "Mark Pen", "Lines drawn by hand")
KIND_PEN(line_hidden_pen, "Hidden Pen", "Lines behind other things")
BOOL(ink_by_kind, SURFACE, 0, "use_lines&edge_detector=FINE", "Color by Kind", "Each kind of line has an ink of its own")
COLOR(line_outline_ink, SURFACE, 0, 0, 0, "use_lines&edge_detector=FINE&ink_by_kind", "Outline Ink", "Lines between an object and what lies behind it")
COLOR(line_contact_ink, SURFACE, 0, 0, 0, "use_lines&edge_detector=FINE&ink_by_kind", "Contact Ink", "Lines between objects that touch")
COLOR(line_inner_ink, SURFACE, 0, 0, 0, "use_lines&edge_detector=FINE&ink_by_kind", "Inner Ink", "Lines where one part of an object hides another")
COLOR(line_crease_ink, SURFACE, 0, 0, 0, "use_lines&edge_detector=FINE&ink_by_kind", "Crease Ink", "Lines where a surface bends")
COLOR(line_intersection_ink, SURFACE, 0, 0, 0, "use_lines&edge_detector=FINE&ink_by_kind", "Intersection Ink", "Lines where pieces of a mesh pass through each other")
COLOR(line_material_ink, SURFACE, 0, 0, 0, "use_lines&edge_detector=FINE&ink_by_kind", "Material Ink", "Lines between materials")
COLOR(line_color_ink, SURFACE, 0, 0, 0, "use_lines&edge_detector=FINE&ink_by_kind", "Color Ink", "Lines between colors")
COLOR(line_shadow_ink, SURFACE, 0, 0, 0, "use_lines&edge_detector=FINE&ink_by_kind", "Shadow Edge Ink", "Lines between levels of light")
COLOR(line_mirror_ink, SURFACE, 0, 0, 0, "use_lines&edge_detector=FINE&ink_by_kind", "Mirror Ink", "Lines in mirrors and behind glass")
COLOR(line_suggestive_ink, SURFACE, 0, 0, 0, "use_lines&edge_detector=FINE&ink_by_kind", "Fold Ink", "Folds: lines where a smooth form nearly turns away")
COLOR(line_mark_ink, SURFACE, 0, 0, 0, "use_lines&edge_detector=FINE&ink_by_kind", "Mark Ink", "Lines drawn by hand")
COLOR(line_hidden_ink, SURFACE, 0, 0, 0, "use_lines&edge_detector=FINE&ink_by_kind", "Hidden Ink", "Lines behind other things")
