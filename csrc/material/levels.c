/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Levels of detail of pictures of bytes. */
#include "base/pixel.h"
#include "material/material.h"

enum { CODES = 256 };

/* The code whose light is nearest: of how many `middles` between neighbours it is above. */
static uint8_t code_of(const float middles[CODES - 1], float light)
{
	int code = 0;
	for (int step = CODES / 2; step; step /= 2)
		code += middles[code + step - 1] < light ? step : 0;
	return (uint8_t)code;
}

/* The mean of a texel and of its neighbours to the right and above, which are itself at a picture's end. */
static void mean_of(const encre_picture *t, const uint8_t *const four[4], const float middles[CODES - 1],
		    uint8_t out[4])
{
	float light[3] = {0};
	int alpha = 0;
	for (int k = 0; k < 4; k++) {
		float share = t->straight ? (float)four[k][3] : 1;
		for (int c = 0; c < 3; c++)
			light[c] += share * t->curve[four[k][c]];
		alpha += four[k][3];
	}
	float whole = t->straight ? (float)alpha : 4;
	for (int c = 0; c < 3; c++)
		out[c] = whole > 0 ? code_of(middles, light[c] / whole) : 0;
	out[3] = (uint8_t)((alpha + 2) / 4);
}

void picture_levels(const encre_picture *t, uint8_t *bytes)
{
	float middles[CODES - 1];
	for (int k = 0; k < CODES - 1; k++)
		middles[k] = 0.5f * t->curve[k] + 0.5f * t->curve[k + 1];
	int width = t->width, height = t->height;
	for (int level = 1; level < t->levels; level++) {
		const uint8_t *from = bytes;
		bytes += (size_t)4 * (size_t)width * (size_t)height;
		int wide = width > 1 ? width / 2 : 1, high = height > 1 ? height / 2 : 1;
		size_t right = width > 1 ? 4 : 0, above = height > 1 ? (size_t)4 * (size_t)width : 0;
		for (int y = 0; y < high; y++)
			for (int x = 0; x < wide; x++) {
				const uint8_t *first = from + (size_t)4 * ((size_t)2 * (size_t)y * (size_t)width +
									   (size_t)2 * (size_t)x);
				const uint8_t *const four[4] = {first, first + right, first + above,
								first + above + right};
				mean_of(t, four, middles, bytes + (size_t)4 * ((size_t)y * (size_t)wide + (size_t)x));
			}
		width = wide;
		height = high;
	}
}
