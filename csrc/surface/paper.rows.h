/* SPDX-License-Identifier: GPL-3.0-or-later */
/* clang-format off */
STAGE(paper, "Paper", "The grain under pencil lines and hatching")
ENUM(paper_source, FRAME, 0, "", "Paper", "Paper whose grain pencil lines, hatching and washes show",
     ITEM(paper_source, PROCEDURAL, 0, "Procedural", "Encre's own paper, with grain and fibers")
     ITEM(paper_source, IMAGE, 1, "Image", "A picture of your own")
     ITEM(paper_source, NONE, 2, "None", "Smooth paper"))
IMAGE(paper_image, FRAME, "", "paper_source=IMAGE", "Image", "Picture of the paper's grain, repeated side by side: what is light is high")
FLOAT(paper_scale, FRAME, 1, 0.01, 1024, 0.25, 8, "px", "paper_source=PROCEDURAL|IMAGE", "Scale", "Size of the grain: how many pixels of the frame a pixel of the paper covers")
FLOAT(paper_roughness, FRAME, 1, 0, FLT_MAX, 0, 4, "", "paper_source=PROCEDURAL|IMAGE", "Roughness", "How rough the paper is: contrast of its grain")
INT(paper_seed, FRAME, 0, 0, 2147483647, 0, 1000, "", "paper_source=PROCEDURAL", "Seed", "Each number is another sheet of paper. Keyframe it to make lines boil")
