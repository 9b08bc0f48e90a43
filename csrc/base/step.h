/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The edge of a step of light: over a pixel, so that it is as smooth as a line's. */
#ifndef ENCRE_STEP_H
#define ENCRE_STEP_H

#include "base/pixel.h"

#include <math.h>

/* Of n pixels in a row or column the one beside pixel i, to the side d of it (-1 or 1); where there is none, that on
 * its other side. */
static inline int step_beside(int i, int d, int n)
{
	return i + d >= 0 && i + d < n ? i + d : clamp_index(i - d, n);
}

/* The less of the differences to both sides: what a contour alone makes is none of the light's own. */
static inline float step_differs(float before, float at, float after)
{
	static const float most = 1e6f; /* what shows nothing has light without end */
	float x = min(at, most);
	return min(fabsf(x - min(before, most)), fabsf(min(after, most) - x));
}

/* 1 / how much light differs from a pixel to the next, by its differences along the row and the column; 0: it does
 * not. */
static inline float step_steepness(float across, float down)
{
	float most = sqrtf(across * across + down * down);
	return most > 1e-4f ? 1 / most : 0;
}

/* Share of a pixel with light x that lies above a threshold. */
static inline float step_passed(float x, float threshold, float steep)
{
	float edge = clamp01((x - threshold) * steep + 0.5f), hard = x > threshold ? 1 : 0;
	return steep > 0 ? edge : hard;
}

#endif
