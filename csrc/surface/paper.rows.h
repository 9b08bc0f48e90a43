/* SPDX-License-Identifier: GPL-3.0-or-later */
/* clang-format off */
STAGE(paper, "Paper", "The grain under pencil lines and hatching")
ENUM(paper_source, FRAME, 0, "", "Paper", "Paper whose grain pencil lines, hatching and washes show",
     ITEM(paper_source, COLD_PRESS, 0, "Cold Press", "Watercolor paper with tooth of many sizes, pits and faint fibers")
     ITEM(paper_source, ROUGH, 1, "Rough", "Watercolor paper with large dents and deep pits")
     ITEM(paper_source, HOT_PRESS, 2, "Hot Press", "Smooth paper with fine tooth and fibers")
     ITEM(paper_source, LAID, 3, "Laid", "Drawing paper with close lines across it and a wider line now and then, as of Ingres")
     ITEM(paper_source, BRISTOL, 4, "Bristol", "Sketchbook paper with even tooth for pencil")
     ITEM(paper_source, IMAGE, 5, "Image", "A picture of your own")
     ITEM(paper_source, NONE, 6, "None", "No grain"))
IMAGE(paper_image, FRAME, "", "paper_source=IMAGE", "Image", "Picture of the paper's grain, repeated side by side: what is light is high")
FLOAT(paper_scale, FRAME, 1, 0.01, 1024, 0.25, 8, "px", "paper_source=COLD_PRESS|ROUGH|HOT_PRESS|LAID|BRISTOL|IMAGE", "Scale", "Size of the grain: how many pixels of the frame a pixel of the paper covers")
FLOAT(paper_roughness, FRAME, 1, 0, FLT_MAX, 0, 4, "", "paper_source=COLD_PRESS|ROUGH|HOT_PRESS|LAID|BRISTOL|IMAGE", "Roughness", "How rough the paper is: contrast of its grain")
INT(paper_seed, FRAME, 0, 0, 2147483647, 0, 1000, "", "paper_source=COLD_PRESS|ROUGH|HOT_PRESS|LAID|BRISTOL", "Seed", "Each number is another sheet of paper. Keyframe it to make lines boil")
