/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Areas that are joined to larger ones: what areas.c and parted.c share. */
#ifndef ENCRE_AREAS_H
#define ENCRE_AREAS_H

#include "flat/flat.h"

enum { FLAT_STEPS = 4096 };

typedef struct joining {
	flat *f;
	int32_t *up;   /* by area: what it is part of */
	int32_t *best; /* likewise: the neighbour to which least speaks against it;
			  -1: none */
	double *least; /* and how much */
} joining;

static inline int32_t root(int32_t *up, int32_t i)
{
	while (up[i] != i)
		i = up[i] = up[up[i]];
	return i;
}

static inline double apart2(const flat *f, int32_t a, int32_t b)
{
	double sum = 0;
	for (int c = 0; c < 3; c++) {
		double d = (double)f->sum[a][c] / f->size[a] - (double)f->sum[b][c] / f->size[b];
		sum += d * d;
	}
	return sum / ((double)FLAT_UNIT * FLAT_UNIT);
}

static inline void join(joining *j, int32_t a, int32_t b)
{
	flat *f = j->f;
	bool swap = f->size[b] > f->size[a] || (f->size[b] == f->size[a] && b < a);
	int32_t into = swap ? b : a, from = swap ? a : b;
	j->up[from] = into;
	f->size[into] += f->size[from];
	f->size[from] = 0;
	for (int c = 0; c < 3; c++)
		f->sum[into][c] += f->sum[from][c];
}

/* The neighbour of texel i to the right (way 0) or above; -1: there is none. */
static inline int64_t beside(const flat *f, size_t i, int way)
{
	int x = (int)(i % (size_t)f->width), y = (int)(i / (size_t)f->width), u = x + !way, v = y + way;
	if ((!f->wraps && (u >= f->width || v >= f->height)) || (way ? f->height : f->width) < 2)
		return -1;
	size_t other = flat_index(f, u, v);
	return f->area[i] == FLAT_CLEAR || f->area[other] == FLAT_CLEAR ? -1 : (int64_t)other;
}

static inline int step_of(const flat *f, size_t a, size_t b)
{
	float sum = 0;
	for (int c = 0; c < 3; c++) {
		float d = (float)(f->fixed[a][c] - f->fixed[b][c]);
		sum += d * d;
	}
	int step = (int)sqrtf(sum);
	return step < FLAT_STEPS ? step : FLAT_STEPS - 1;
}

/* parted.c: joins areas by what lies along their borders. False without memory. */
bool flat_join(joining *j);

#endif
