/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Bends that are spread over several faces: what is found of them (bends.c) before lines are drawn (bevels.c). */
#ifndef ENCRE_BENDS_H
#define ENCRE_BENDS_H

#include "raster/raster.h"

/* Of a pixel, by which the line of such a bend may go. */
typedef struct bend {
	float off;     /* where the pixel lies from the line's middle, along the axis; when united, across the line */
	float wide;    /* pixels, likewise */
	float most;    /* degrees; 0: there is none */
	float own;     /* how far one of its edges is a line by itself, from 0 to 1, */
	float parting; /* how far along the axis that is from the line's middle, */
	float second;  /* and from the pixel */
	int8_t across[3]; /* how its normals change, along the axis */
	int8_t first;     /* its ways begin there, from the pixel, */
	uint8_t ways;     /* and are so many */
	uint8_t axis : 1, smooth : 1, chamfer : 1;
} bend;

/* Of a pixel: what happens on the way to its right and, WAY_BITS further, to its lower neighbour; and WAY_TOLD, where
 * it is told of a bend. */
enum { WAY_TURNS = 1, WAY_CLOSED = 2 /* the surface ends */, WAY_BITS = 2, WAY_TOLD = 16 };

/* Pixels from a pixel, that a line that goes by it may be away. */
static const float goes_by_within = 1.25f;

/* Degrees by which a bend must bend more than an edge that is part of it to have its place: an edge has its full width
 * sooner. Between the same two pixels it must only bend more, or its line would have a gap there. */
static const float own_ahead = 16;

typedef struct bends {
	const encre_raster_job *job;
	int width, height;
	float narrow;      /* pixels, within which what bends counts in full */
	float longest;     /* pixels: nothing wider is a bend */
	uint8_t *way;      /* of each pixel */
	bool *told;        /* of each row: whether a pixel of it is */
	bend *bend;        /* of each pixel that is told of one; of others it is not written */
	struct lane *lane; /* bends.c's, for each thread */
} bends;

/* Takes what it needs of an arena, as arena.h says. */
void bends_plan(bends *b, const encre_raster_job *job, int threads, arena *a);
int32_t bends_find(bands *pool, bends *b);

/* neighbours.c: fills `way` of these rows, of bends, when all other pictures are drawn. */
void neighbours_rows(void *bends, int y0, int y1, int thread);

/* Leaves a share of what an edge bends, in the layer of creases; returns whether anything is left. Less than a degree
 * would not be seen beside `crease_spread` in half floats. */
static inline bool crease_scale(float *crease, float share)
{
	crease[1] *= share;
	if (fabsf(crease[1]) >= 1)
		return true;
	crease[0] = crease[1] = 0;
	return false;
}

static inline const bend *bend_at(const bends *b, int x, int y)
{
	return b->bend + (ptrdiff_t)y * b->width + x;
}

static inline bool is_told(const bends *b, int x, int y)
{
	return b->way[(ptrdiff_t)y * b->width + x] & WAY_TOLD;
}

#endif
