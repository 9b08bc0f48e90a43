/* SPDX-License-Identifier: GPL-3.0-or-later */
/* clang-format off */
STAGE(specks, "Specks", "Crumbs of light in black ink")
SWITCH(use_specks, SURFACE, 0, "", "Fill Specks", "Fill crumbs of light that tones or lines leave in black")
FLOAT(speck_size, SURFACE, 4, 0, 32, 0, 8, "px", "use_specks", "Size", "Fill islands of light in black that are no larger than a square of this size, and gaps narrower than half of it before lines are drawn")
