/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A painted ball as by example reads it, in square roots of scene-linear colours, which are about as even to the eye as
 * sRGB. */
#ifndef ENCRE_BALL_H
#define ENCRE_BALL_H

#include "base/pixel.h"
#include "base/stage.h"

typedef struct ball {
	const encre_image *image;
	int shrink, width, height; /* so many pixels of the image are one of the painting's */
	float *paint;              /* 4: what it has over the coarse colours, and how light that is */
	float texels;              /* of the painting to a pixel of the frame */
	float middle[2], radius;
	int square, columns, rows; /* coarse colours: one for so many pixels each way */
	float *coarse[2];          /* 4, the last 0; the second is scratch */
} ball;

/* Size and place of a style's ball; no memory yet. */
ball ISA(ball_of)(const frame *f, const encre_params *p);
/* Fills paint and coarse. */
int32_t ISA(ball_paint)(frame *f, ball *b);

/* Between the four nearest of an image of 4 channels, at (x, y) in its pixels, whose middles are at whole numbers. */
static inline void between(const float *restrict image, int width, int height, float x, float y, float *restrict out)
{
	x = min(max(x, 0), (float)(width - 1));
	y = min(max(y, 0), (float)(height - 1));
	int i = (int)x, j = (int)y;
	ptrdiff_t right = i + 1 < width ? 4 : 0, down = j + 1 < height ? (ptrdiff_t)4 * width : 0;
	const float *at = image + 4 * ((ptrdiff_t)j * width + i);
	float s = x - (float)i, t = y - (float)j;
	for (int c = 0; c < 4; c++)
		out[c] = mix(mix(at[c], at[right + c], s), mix(at[down + c], at[down + right + c], s), t);
}

static inline void coarse_at(const ball *b, float x, float y, float color[4])
{
	float per = 1 / (float)b->square;
	between(b->coarse[0], b->columns, b->rows, (x + 0.5f) * per - 0.5f, (y + 0.5f) * per - 0.5f, color);
}

#endif
