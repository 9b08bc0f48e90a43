/* SPDX-License-Identifier: GPL-3.0-or-later */
/* clang-format off */
STAGE(smudge, "Smudging", "Color spread across the lines, where it is painted")
SWITCH(use_smudging, SURFACE, 1, "", "Smudging", "Spread color across the lines where it is painted")
FLOAT(smudge_range, SURFACE, 10, 0, 1024, 0, 64, "px", "use_smudging", "Range", "How far color runs across the line where Smudge Range is painted white")
FLOAT(smudge_falloff, SURFACE, 0.5, 0, 1, 0, 1, "factor", "use_smudging", "Falloff", "Share of the range over which the color stays full, times Smudge Falloff as painted")
FLOAT(smudge_pick, SURFACE, 7, 0, 1024, 0, 64, "px", "use_smudging", "Pick Distance", "How far behind the line the color is picked up")
FLOAT(smudge_depth, SURFACE, 0.01, 0, FLT_MAX, 0, 1, "", "use_smudging", "Depth Difference", "Color runs only where the two surfaces differ in depth by more than this share")
FLOAT(smudge_curve, SURFACE, 1, 0.01, 100, 0.1, 10, "", "use_smudging", "Falloff Curve", "How soon the color fades: above 1 sooner, below 1 later")
