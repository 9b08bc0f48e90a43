/* SPDX-License-Identifier: GPL-3.0-or-later */
/* clang-format off */
STAGE(print, "Print", "Colors as dots of a few inks, as in old comics")
SWITCH(use_print, SURFACE, 0, "", "Print", "Print the colors as screens of dots in a few inks, one over the other; lines stay solid")
ENUM(print_inks, SURFACE, 0, "use_print", "Inks", "The inks that print the colors",
     ITEM(print_inks, FOUR, 0, "Four", "Cyan, magenta, yellow and black, each in a screen of its own angle")
     ITEM(print_inks, TWO, 1, "Two", "A dark ink and a light one of your own: duotone"))
COLOR(print_dark, SURFACE, 0.02, 0.035, 0.12, "use_print&print_inks=TWO", "Dark Ink", "Color of the ink that draws the shade")
COLOR(print_light, SURFACE, 0.95, 0.30, 0.16, "use_print&print_inks=TWO", "Light Ink", "Color of the ink that draws what is neither dark nor white")
COLOR(print_paper, SURFACE, 0.93, 0.89, 0.80, "use_print", "Paper", "Color of the paper that is printed on")
FLOAT(print_pitch, SURFACE, 7, 0.02, 1000, 3, 30, "px", "use_print", "Spacing", "From dot to dot, at least two pixels of the picture")
FLOAT(print_black, SURFACE, 0.5, 0, 1, 0, 1, "factor", "use_print&print_inks=FOUR", "Black Ink", "How much black ink replaces the dark that the three colored inks would make together")
FLOAT(print_least, SURFACE, 0.06, 0, 0.5, 0, 0.5, "factor", "use_print", "Least Dot", "Smallest dot, as a share of the paper: smaller dots are left out, and gaps that small are filled")
