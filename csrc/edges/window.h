/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The largest value of a wide window about each pixel: for contrast_local, the strongest difference nearby. */
#ifndef ENCRE_WINDOW_H
#define ENCRE_WINDOW_H

#include "base/stage.h"

typedef struct wide_window {
	int width, height;
	int reach_x, reach_y;
	bool wrap_x, wrap_y; /* the picture tiles; where it does not, there is 0 beyond its border */
	float *scratch;      /* two of `each` floats for each thread */
	size_t each;
} wide_window;

/* Takes the scratch for windows `size` pixels wide and high. */
wide_window ISA(window_plan)(arena *a, const bands *pool, int width, int height, float size, bool wrap_x, bool wrap_y);
/* Across: largest[x] of the pixels about in[x]. Called from a kernel. */
void ISA(window_row)(const wide_window *w, const float *in, int thread, float *largest);
/* Then down the columns of such rows, in place. Returns ENCRE_OK or ENCRE_ERROR_CANCELLED. */
int32_t ISA(window_columns)(const wide_window *w, bands *pool, float *picture);

/* Largest of 2 * reach + 1 consecutive items, each `lanes` floats, for lanes side by side. a and spare: n + 2 * reach
 * items each, both are overwritten. Returns the one whose item i < n is the largest of items i..i + 2 * reach of a. */
float *ISA(window_greatest)(float *a, float *spare, ptrdiff_t n, ptrdiff_t reach, ptrdiff_t lanes);

#endif
