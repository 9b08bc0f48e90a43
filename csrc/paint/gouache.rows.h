/* SPDX-License-Identifier: GPL-3.0-or-later */
/* clang-format off */
STAGE(gouache, "Gouache", "Opaque strokes of a flat brush")
SWITCH(use_gouache, SURFACE, 0, "", "Gouache", "Paint the picture in opaque strokes of a flat brush. They stay on the things as the camera moves")
FLOAT(gouache_size, FRAME, 100, 4, 4096, 16, 200, "px", "use_gouache", "Brush", "Length of the largest strokes, on walls and in the sky. Where there is less room strokes are smaller, down to a fifth")
FLOAT(gouache_variety, SURFACE, 1, 0, 8, 0, 3, "", "use_gouache", "Variety", "How much the color of each stroke differs from its surface")
FLOAT(gouache_body, SURFACE, 1, 0, 8, 0, 3, "", "use_gouache", "Body", "How much you see of the hairs of the brush and of how thick the paint is")
