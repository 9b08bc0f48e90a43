/* SPDX-License-Identifier: GPL-3.0-or-later */
/* clang-format off */
/* What the engine does before and after the library: size, choice and cleaning of the layers. No C stage reads these;
 * lengths in PIXELS are multiplied by supersample. */
STAGE(layers, "Layers", "What the engine renders and saves for the stages")
ENUM(layer_source, FRAME, 0, "", "Render", "Which renderer makes the picture that Encre inks",
     ITEM(layer_source, CYCLES, 0, "Full", "Cycles renders it first: all materials and all light, with reflections and bounced light")
     ITEM(layer_source, ENCRE, 1, "Fast", "Encre draws it by itself, in seconds and without noise; no reflections and no bounced light"))
INT(supersample, FRAME, 1, 1, 4, 1, 4, "", "", "Supersample", "Draw the picture this many times as wide and high, then scale it down: for things thinner than a pixel. 2 takes four times the memory")
ENUM(object_index, FRAME, 0, "", "Object Index", "Which things get outlines of their own",
     ITEM(object_index, AUTO, 0, "Automatic", "Every object, or all objects of one line group")
     ITEM(object_index, PASS, 1, "Pass Index", "All objects that have the same pass index in their properties"))
ENUM(light_source, FRAME, 0, "layer_source=CYCLES", "Light", "Which light is cut into steps and hatched, and has shadow edges",
     ITEM(light_source, CYCLES, 0, "Cycles", "As Cycles renders it, with bounced light and noise")
     ITEM(light_source, DRAWN, 1, "Drawn", "Light of the scene's lamps and world, without noise and without bounced light"))
BOOL(world_shadows, FRAME, 0, "", "World Shadows", "Drawn light: objects block the world's light, as in Cycles, so that corners and contacts get dark. Takes longer")
FLOAT(world_planes, FRAME, 0, 0, 1, 0, 1, "factor", "", "Planes", "Drawn light: how much the world's light tells the sides of things apart. Tops are lightest, sides toward the lamps lighter than those away from them, also in an evenly lit room")
FLOAT(facet_angle, FRAME, 0, 0, 180, 0, 90, "angle", "", "Smooth Facets", "Drawn light: flat-shaded faces that bend by less than this are lit as one smooth surface, so that shade and highlights have no corners where no line is. 0: as they are shaded")
INT(flat_colors, SURFACE, 0, 0, 64, 0, 32, "", "layer_source=ENCRE", "Flat Colors", "Most colors that an image on a surface may have: it becomes flat areas, without painted shade and grain. 0: images stay as they are")
INT(sky_colors, FRAME, 16, 0, 64, 0, 32, "", "", "Sky Colors", "Most colors of a picture of the sky behind the scene: it becomes flat shapes, as a painted backdrop. Light and reflections come from the whole picture. 0: it stays as it is")
ENUM(light_denoise, FRAME, 0, "layer_source=CYCLES", "Denoise", "How noise is taken out of rendered light, gloss, glass and mirrors before Encre draws",
     ITEM(light_denoise, OIDN, 0, "Open Image Denoise", "Denoise by Open Image Denoise, if this Blender has it")
     ITEM(light_denoise, NONE, 1, "None", "Use the light as it was rendered"))
ENUM(save_layers, FRAME, 0, "", "Save Layers", "Save the layers that are needed to draw a saved frame in another look",
     ITEM(save_layers, AUTO, 0, "Automatic", "In multilayer OpenEXR files; encre render saves as Slim does")
     ITEM(save_layers, ON, 1, "Always", "Always")
     ITEM(save_layers, OFF, 2, "Never", "Never")
     ITEM(save_layers, SLIM, 3, "Slim", "Always, but without noisy passes that Encre does not read. encre render saves nothing else, and most of it as half floats"))
ENUM(save_rest, FRAME, 0, "", "Save Rest Positions", "Save where each pixel lies on the object at rest, so that dots and strokes stick to surfaces",
     ITEM(save_rest, AUTO, 0, "Automatic", "When something that is drawn sticks to surfaces")
     ITEM(save_rest, ON, 1, "Always", "Always, so that a saved frame can be drawn again with something that sticks"))
