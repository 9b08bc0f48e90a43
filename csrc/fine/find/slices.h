/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Slices across things up to three pixels wide: slices.c finds them, thin.c follows them along a thing. `at`: a pixel
 * along the axis, `across`: its row or column. All give false where there is no stripe before one ground. */
#ifndef ENCRE_SLICES_H
#define ENCRE_SLICES_H

#include "fine/near.h"

enum { PLANES = 6, MOST_HIT = 4 };

static const float width_ramp = 0.6f; /* pixels from what is thin to what is not; test_fine_sites */

/* A few pixels along an axis, across a stripe before one ground. `middle` is a coordinate along the axis; the thing
 * covers pixel centres nearer to it than half its width, and no others: that is at least `low` and at most `high`. */
typedef struct slice {
	float area, peak, middle, low, high;
	float stands[PLANES]; /* how it stands out, summed up */
	int hits;             /* pixel centres that it covers */
	float ground;         /* the object behind it */
	float trust;          /* in the above, 0 to 1 */
} slice;

static inline float thing_at(const fine *n, int axis, int across, int at)
{
	return axis ? object_at(n->f, across, at) : object_at(n->f, at, across);
}

/* 0 up to `from`, 1 from `to` on. */
static inline float ramp(float x, float from, float to)
{
	return x > from ? x < to ? (x - from) / (to - from) : 1 : 0;
}

/* The slice across the thing at a pixel: a few pixels between cracks, and two more on each side. */
bool ISA(slice_at)(const fine *n, int axis, int across, int at, slice *s);
/* The slice about a pixel, as narrow as it can be. */
bool ISA(slice_about)(const fine *n, int axis, int across, int at, slice *s);
/* The slice of a thing that covers no centre of the pixels across it here, but lies in this one. */
bool ISA(slice_between)(const fine *n, int axis, int x, int y, slice *s);

#endif
