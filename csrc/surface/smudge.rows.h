/* SPDX-License-Identifier: GPL-3.0-or-later */
/* clang-format off */
STAGE(smudge, "Smudging", "Color spread across the lines, where it is painted")
SWITCH(use_smudging, SURFACE, 1, "", "Smudging", "Spread color across the lines where it is painted")
FLOAT(smudge_range, SURFACE, 10, 0, 1024, 0, 64, "px", "use_smudging", "Range", "Reach across the line where the painted control is full")
FLOAT(smudge_falloff, SURFACE, 0.5, 0, 1, 0, 1, "factor", "use_smudging", "Falloff", "Share of the range, times the painted control, over which the color stays full")
FLOAT(smudge_pick, SURFACE, 7, 0, 1024, 0, 64, "px", "use_smudging", "Pick Distance", "How far behind the line the color is picked up")
FLOAT(smudge_depth, SURFACE, 0.01, 0, FLT_MAX, 0, 1, "", "use_smudging", "Depth Difference", "Least relative difference in depth of the two surfaces")
FLOAT(smudge_curve, SURFACE, 1, 0.01, 100, 0.1, 10, "", "use_smudging", "Falloff Curve", "Exponent of the falloff: above 1 the color fades sooner")
