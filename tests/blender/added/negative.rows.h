/* SPDX-License-Identifier: GPL-3.0-or-later */
/* clang-format off */
STAGE(negative, "Negative", "Colours as on a film")
SWITCH(use_negative, SURFACE, 0, "", "Negative", "Show the negative")
FLOAT(negative_share, SURFACE, 1, 0, 1, 0, 1, "factor", "use_negative", "Share", "How much of it")
