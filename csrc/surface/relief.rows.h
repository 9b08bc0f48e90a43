/* SPDX-License-Identifier: GPL-3.0-or-later */
/* clang-format off */
STAGE(relief, "Sheet", "The sheet of paper itself, seen through washes and shade")
SWITCH(use_relief, SURFACE, 0, "", "Sheet", "Show the paper under the picture, its relief and its color; lines lie over it")
FLOAT(paper_relief, SURFACE, 0.4, 0, FLT_MAX, 0, 2, "", "use_relief", "Relief", "How strongly light from the upper left models the grain of the paper, in washes and shade alike")
FLOAT(paper_under, SURFACE, 0.5, 0, 1, 0, 1, "factor", "use_relief", "Shines Through", "How much the color of the paper shows through the picture. Transparent parts show the paper itself")
COLOR(paper_under_color, SURFACE, 0.90, 0.84, 0.72, "use_relief&paper_under", "Sheet Color", "Color of the paper under the picture")
