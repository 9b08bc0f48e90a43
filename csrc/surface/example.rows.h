/* SPDX-License-Identifier: GPL-3.0-or-later */
/* clang-format off */
STAGE(example, "By Example", "Colors and brush work of a painted ball")
SWITCH(use_example, SURFACE, 0, "", "By Example", "Paint surfaces as a ball is painted")
ENUM(example_ball, SURFACE, 0, "use_example", "Ball", "The painting of a ball that is lit from the top left",
     ITEM(example_ball, GOUACHE, 0, "Gouache", "Opaque strokes of a flat brush, warm in the light and violet in the shade")
     ITEM(example_ball, WASH, 1, "Wash", "Thin washes of watercolor, one over the other, with hard edges and grain")
     ITEM(example_ball, IMAGE, 2, "Image", "A ball of your own, painted over the template"))
IMAGE(example_image, SURFACE, "color", "use_example&example_ball=IMAGE", "Image", "Picture of a painted ball. The ball is three quarters as wide as the picture, and the paint goes on beyond it")
FLOAT(example_strength, SURFACE, 1, 0, 1, 0, 1, "factor", "use_example", "Strength", "0 is the surface without the painting, 1 the painting")
FLOAT(example_own_color, SURFACE, 1, 0, 1, 0, 1, "factor", "use_example", "Own Colors", "How much surfaces keep their own colors under the light and shade of the ball. 0: they have the ball's colors")
FLOAT(example_light, SURFACE, 0.75, 0, 1, 0, 1, "factor", "use_example", "Follow Light", "0: colors follow the way a surface faces, as on the ball. 1: they follow the light that falls on it, with its shadows")
FLOAT(example_loose, SURFACE, 0.5, 0, 1, 0, 1, "factor", "use_example", "Looseness", "0: each patch has exactly the color of its place. 1: patches are as they are painted on the ball")
FLOAT(example_size, SURFACE, 800, 8, 65536, 100, 2000, "px", "use_example", "Ball Size", "Diameter of the ball in the picture: a larger ball has larger strokes")
