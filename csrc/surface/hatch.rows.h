/* SPDX-License-Identifier: GPL-3.0-or-later */
/* clang-format off */
STAGE(hatch, "Hatching", "Pencil rubbed into dark and shaded surfaces")
SWITCH(use_hatching, SURFACE, 1, "", "Hatching", "Rub a pencil into dark and shaded surfaces, over the grain of the paper")
FLOAT(hatch_amount, SURFACE, 0.45, 0, FLT_MAX, 0, 2, "", "use_hatching", "Amount", "Strength of the hatching where the paper is high")
FLOAT(hatch_color_threshold, SURFACE, 0.35, 0, FLT_MAX, 0, 2, "", "use_hatching", "Color Threshold", "Surface colors darker than this are hatched. 0: none")
FLOAT(hatch_color_light, SURFACE, 0.5, 0, 1, 0, 1, "factor", "use_hatching&hatch_color_threshold", "Light on Dark", "How much light keeps the pencil off dark colors, level by level. 0: they are black in any light")
FLOAT(hatch_light_threshold, SURFACE, 0.5, 0, FLT_MAX, 0, 2, "", "use_hatching", "Light Threshold", "Light darker than this is hatched. 0: none")
COLOR(hatch_color, SURFACE, 0, 0, 0, "use_hatching", "Color", "Color of the pencil")
