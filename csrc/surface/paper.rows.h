/* SPDX-License-Identifier: GPL-3.0-or-later */
/* clang-format off */
STAGE(paper, "Paper", "The grain under pencil lines and hatching")
ENUM(paper_source, FRAME, 0, "", "Paper", "Paper whose grain pencil lines, hatching and washes show",
     ITEM(paper_source, PROCEDURAL, 0, "Procedural", "Built-in paper with grain and fibre")
     ITEM(paper_source, IMAGE, 1, "Image", "A height map")
     ITEM(paper_source, NONE, 2, "None", "Smooth paper"))
IMAGE(paper_image, FRAME, "", "paper_source=IMAGE", "Image", "Height map of the paper, tiled; values as stored, about 0.8 on average")
FLOAT(paper_scale, FRAME, 1, 0.01, 1024, 0.25, 8, "px", "paper_source=PROCEDURAL|IMAGE", "Scale", "Pixels of the frame that a texel of the paper covers")
FLOAT(paper_roughness, FRAME, 1, 0, FLT_MAX, 0, 4, "", "paper_source=PROCEDURAL|IMAGE", "Roughness", "Contrast of the heights about their mean")
INT(paper_seed, FRAME, 0, 0, 2147483647, 0, 1000, "", "paper_source=PROCEDURAL", "Seed", "Another sheet of paper; keyframe it to make lines boil")
