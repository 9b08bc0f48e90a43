/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The images that come in and go out, as tables that other languages read. */
#include "base/stage.h"

#include <stddef.h>

static const encre_layer_description layers[ENCRE_LAYER_COUNT] = {
	[ENCRE_LAYER_COMBINED] = {"combined", "the rendered image, scene-linear, premultiplied alpha", 4, 1},
	[ENCRE_LAYER_COLOR] = {"color", "diffuse surface colour, scene-linear", 3, 1},
	[ENCRE_LAYER_ALBEDO] = {"albedo", "unlit colour of any surface", 3, 0},
	[ENCRE_LAYER_DIFFUSE] = {"diffuse", "diffuse light without the surface colour", 3, 1},
	[ENCRE_LAYER_SPECULAR] = {"specular", "reflected specular light", 3, 0},
	[ENCRE_LAYER_DEPTH] = {"depth", "distance along the view axis in scene units", 1, 1},
	[ENCRE_LAYER_NORMAL] = {"normal", "world-space normal averaged over the pixel", 3, 1},
	[ENCRE_LAYER_OBJECT] = {"object", "object index", 1, 0},
	[ENCRE_LAYER_MATERIAL] = {"material", "material index", 1, 0},
	[ENCRE_LAYER_STYLE] = {"style", "style number, 0 the scene's", 1, 0},
#define CONTROL(id, name, ...) name ", "
	[ENCRE_LAYER_CONTROLS] = {"controls",
#include "base/controls.rows.h"
				  "each -1..1", CONTROL_COUNT, 0},
	[ENCRE_LAYER_SEEN_COLOR] = {"seen_color", "unlit colour of what mirrors and clear glass show", 3, 0},
	[ENCRE_LAYER_SEEN_NORMAL] = {"seen_normal", "its normal, in the space of the camera", 3, 0},
	[ENCRE_LAYER_SEEN_DEPTH] = {"seen_depth", "its distance, as depth", 1, 0},
	[ENCRE_LAYER_HIGHLIGHTS] = {"highlights", "what of specular comes straight from lamps", 3, 0},
	[ENCRE_LAYER_BACKGROUND] = {"background", "what of combined is light of the world behind everything", 3, 0},
	[ENCRE_LAYER_ANCHOR] =
		{"anchor",
		 "rest position, rest normal, size of a pixel there, how the position grows to the right "
		 "and down, which way the surface bends",
		 16, 0},
	[ENCRE_LAYER_GLOSS] = {"gloss", "unlit colour of what mirrors, as metals do", 3, 0},
	[ENCRE_LAYER_TANGENT] = {"tangent", "direction on the resting surface in which U grows", 3, 0},
	[ENCRE_LAYER_CARD] = {"card",
			      "place on a sheet that goes with the object's origin, and its growth to the right", 4, 0},
};

#define CONTROL(id, text, lab, most, least, file_pass, place)                                                          \
	{.name = text, .label = lab, .white = most, .black = least, .saved = file_pass, .channel = place},
static const encre_control_description controls[CONTROL_COUNT] = {
#include "base/controls.rows.h"
};

static const encre_layer_description outputs[ENCRE_OUTPUT_COUNT] = {
	[ENCRE_OUTPUT_COMBINED] = {"Combined", "the finished picture, scene-linear, premultiplied alpha", 4, 0},
	[ENCRE_OUTPUT_LINES] = {"Encre Lines", "the ink alone, premultiplied", 4, 0},
	[ENCRE_OUTPUT_SURFACE] = {"Encre Surface", "the picture before the lines", 4, 0},
	[ENCRE_OUTPUT_EDGES] = {"Encre Edges", "edge strength", 1, 0},
	[ENCRE_OUTPUT_LIGHT] = {"Encre Light", "discrete, tinted light", 3, 0},
	[ENCRE_OUTPUT_TONES] = {"Encre Tones", "dots, lines and ink in the shade alone, premultiplied", 4, 0},
};

const encre_layer_description *encre_layer_info(int32_t layer)
{
	return layer >= 0 && layer < ENCRE_LAYER_COUNT ? layers + layer : NULL;
}

const encre_layer_description *encre_output_info(int32_t output)
{
	return output >= 0 && output < ENCRE_OUTPUT_COUNT ? outputs + output : NULL;
}

const encre_control_description *encre_control_info(int32_t control)
{
	return control >= 0 && control < CONTROL_COUNT ? controls + control : NULL;
}
