/* SPDX-License-Identifier: GPL-3.0-or-later */
/* clang-format off */
STAGE(specks, "Specks", "Crumbs of light in black ink")
SWITCH(use_specks, SURFACE, 0, "", "Fill Specks", "Ink crumbs of light that tones or lines leave in the black")
FLOAT(speck_size, SURFACE, 4, 0, 32, 0, 8, "px", "use_specks", "Size", "Islands of light in black that have no more area than such a square are filled; before lines are drawn, also what is narrower than half of it")
