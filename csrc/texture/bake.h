/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Inter-color lines drawn into a texture: what bake.c and stamp.c share. */
#ifndef ENCRE_BAKE_H
#define ENCRE_BAKE_H

#include "edges/window.h"

/* Lines are stamped LANES texels at a time; a sheet has as many to spare right of each row. SHEET: rows of one. */
enum { LANES = 8, SHEET = 64 };

typedef struct bake {
	const encre_bake_job *job; /* strides are filled in */
	const encre_params *p;
	int width, height;
	bool wrap_x, wrap_y;
	bands *bands;
	float *radius;   /* width * height: the greatest difference of a texel's pairs, then half its line's width, 0 =
			    none */
	float *full;     /* likewise: the difference that gives a full line; NULL unless contrast_local */
	float *reach;    /* per row: how far its lines go up and down */
	float *greatest; /* per row: greatest difference */
	int64_t *bad;    /* per row: values that are not finite */
	float *ring;     /* per thread: 3 rows of 3 planes of `padded` floats */
	wide_window window; /* for contrast_local */
	float *sheet;       /* per thread: SHEET rows of `padded` floats */
	size_t padded;
	float farthest; /* the largest of reach */
} bake;

/* Rows y0..y1-1 of the texture, row y at (y - y0) * padded. Holds the darkness, which is not yet clamped to 1. */
typedef struct sheet {
	int y0, y1;
	float *dark;
} sheet;

/* Index i of n texels: repeated where the texture tiles, else the nearest inside. */
static inline int texel_index(int i, int n, bool wrap)
{
	return wrap ? wrap_index(i, n) : clamp_index(i, n);
}

/* stamp.c: how far the line of texel (x, y), whose radius is set, goes up and down at most. */
float ISA(stamp_reach)(const bake *b, int x, int y);
/* Draws the lines of all texels of row y, which may lie outside the texture where it tiles. */
void ISA(stamp_row)(const bake *b, const sheet *s, int y);

/* What encre_bake() does, for a job that has been checked. Fills nonfinite and greatest of `result`. */
int32_t bake_run_base(bands *pool, const encre_bake_job *job, encre_bake_job *result);
int32_t bake_run_v3(bands *pool, const encre_bake_job *job, encre_bake_job *result);

#endif
