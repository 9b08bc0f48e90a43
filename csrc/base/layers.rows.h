/* SPDX-License-Identifier: GPL-3.0-or-later */
/* clang-format off */
/* What the engine does before and after the library: size, choice and cleaning of the layers. No C stage reads these;
 * lengths in PIXELS are multiplied by supersample. */
STAGE(layers, "Layers", "What the engine renders and saves for the stages")
ENUM(layer_source, FRAME, 0, "", "Render", "What renders the picture that is inked",
     ITEM(layer_source, CYCLES, 0, "Full", "Cycles renders it first: all materials and all light, with reflections and bounced light")
     ITEM(layer_source, ENCRE, 1, "Fast", "Encre draws it by itself, in seconds and without noise; no reflections and no bounced light"))
INT(supersample, FRAME, 1, 1, 4, 1, 4, "", "", "Supersample", "Draw at this many times the width and height, with as many rays as before, and average down: for things thinner than a pixel; memory grows by its square")
ENUM(object_index, FRAME, 0, "", "Object Index", "What counts as an object of its own where outlines are drawn",
     ITEM(object_index, AUTO, 0, "Automatic", "A running number for every object or named line group, whatever the pass index is")
     ITEM(object_index, PASS, 1, "Pass Index", "The pass index set in the object's properties"))
ENUM(light_source, FRAME, 0, "layer_source=CYCLES", "Light", "What the light is that is cut into levels, hatched and followed by lines",
     ITEM(light_source, CYCLES, 0, "Cycles", "As Cycles renders it, with bounced light and noise")
     ITEM(light_source, DRAWN, 1, "Drawn", "Direct light of the scene's lamps and world, drawn exactly and without noise"))
BOOL(world_shadows, FRAME, 0, "", "World Shadows", "Where light is drawn, things keep the world's light from each other, as in Cycles: corners and contacts are dark. Takes longer")
ENUM(light_denoise, FRAME, 0, "use_shading&layer_source=CYCLES", "Denoise Light", "How Monte-Carlo noise is taken out of rendered light before it is cut into levels, and out of gloss and glass beside it",
     ITEM(light_denoise, OIDN, 0, "Open Image Denoise", "Denoise the light with the albedo and the normal as guides, where the library is there")
     ITEM(light_denoise, NONE, 1, "None", "Use the light as it was rendered"))
ENUM(mirror_denoise, FRAME, 0, "edge_detector=FINE&layer_source=CYCLES", "Denoise Mirrored", "How Monte-Carlo noise is taken out of what mirrors and clear glass show before lines are looked for in it",
     ITEM(mirror_denoise, OIDN, 0, "Open Image Denoise", "Denoise the colors and normals seen there, where the library is there")
     ITEM(mirror_denoise, NONE, 1, "None", "Look for lines in what was rendered"))
ENUM(save_layers, FRAME, 0, "", "Save Layers", "Write the layers that restyling a saved frame needs into the file",
     ITEM(save_layers, AUTO, 0, "Automatic", "When the output is a multilayer OpenEXR file; with encre render as Slim")
     ITEM(save_layers, ON, 1, "Always", "Always")
     ITEM(save_layers, OFF, 2, "Never", "Never")
     ITEM(save_layers, SLIM, 3, "Slim", "Always, without noisy passes that nobody reads; encre render stores nothing else and most of it as half floats"))
ENUM(save_rest, FRAME, 0, "", "Save Rest Positions", "Store for each pixel where on the thing at rest it is, so that drawn texture sticks to surfaces",
     ITEM(save_rest, AUTO, 0, "Automatic", "When something that is drawn sticks to surfaces")
     ITEM(save_rest, ON, 1, "Always", "Always, so that a saved frame can be drawn again with something that sticks"))
