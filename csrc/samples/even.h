/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Light from which a denoiser could not take all noise, evened out: what even.c and along.c share. */
#ifndef ENCRE_EVEN_H
#define ENCRE_EVEN_H

#include "base/bands.h"
#include "base/pixel.h"
#include "base/stage.h"

/* The directions from a pixel in which places on both its sides are looked at, down and right; as bits of a mask. */
enum { ACROSS, DOWN, DOWN_RIGHT, DOWN_LEFT, AHEAD, ALL_AHEAD = (1 << AHEAD) - 1 };
static const int even_ahead[AHEAD][2] = {{0, 1}, {1, 0}, {1, 1}, {1, -1}};

/* Pixels to these places, in passes, the farthest first; the last four look for peaks and pits, too. */
enum { PASSES = 5, LEVELLED_FROM = 1, LAST_PASS = PASSES - 1 };

/* A strip of the frame is worked on at once, with REACH rows above and below it, which are not right themselves. What
 * adds up is told in even.c. Each row of a plane has PAD pixels more at both ends, as its first and last. */
enum { REACH = ENCRE_EVEN_REACH, PAD = 16 };

enum even_plane {
	EVEN_NEAR,   /* 1/depth, 0: nothing there */
	EVEN_NORMAL, /* and the two after it */
	EVEN_NUMBER = EVEN_NORMAL + 3,
	EVEN_RENDERED,
	EVEN_GIVEN, /* V of the light that is given */
	EVEN_VALUE, /* of what it becomes; EVEN_NEXT takes turns with it */
	EVEN_NEXT,
	EVEN_NOISE, /* by which a mean may differ */
	EVEN_TAKEN, /* likewise, by what the denoiser took away */
	EVEN_DOWN,  /* slopes, then ways */
	EVEN_RIGHT,
	EVEN_BORDER, /* V where it is the border of a shadow, and how surely it is one */
	EVEN_SURE,
	EVEN_SPARE, /* and the others of a dozen, six of which hold what the first six did, for means */
	EVEN_PLANES = EVEN_SPARE + 6
};

typedef struct evener {
	const encre_even_job *job; /* strides are filled in */
	bands *bands;
	int width, height; /* of the frame */
	int top, rows;     /* of the strip with what is around it: its first row in the frame, and how many it has */
	int own, own_end;  /* rows of the strip itself, counted from top */
	ptrdiff_t stride;
	float *plane[EVEN_PLANES];
	uint8_t *same[PASSES]; /* bits of directions: both places show what the pixel shows; width * rows */
	float *above;          /* V as it was given in the REACH rows before the strip, which are changed by now */
	float *scratch;        /* by thread: 8 rows */
} evener;

/* A row of a plane, or the nearest of the strip. */
static inline float *even_row(const evener *e, int plane, int y)
{
	return e->plane[plane] + clamp_index(y, e->rows) * e->stride + PAD;
}

static inline float *even_scratch(const evener *e, int thread, int k)
{
	return e->scratch + ((ptrdiff_t)8 * thread + k) * e->stride + PAD;
}

static inline void even_pad(float *row, int width)
{
	for (int k = 1; k <= PAD; k++) {
		row[-k] = row[0];
		row[width - 1 + k] = row[width - 1];
	}
}

/* Means of five by five places, `apart` pixels from each other, about the pixels of a row: sum has those of five rows,
 * padded. */
static inline void even_across(const evener *e, float *restrict sum, int apart, float *restrict out)
{
	even_pad(sum, e->width);
	for (int x = 0; x < e->width; x++)
		out[x] = (sum[x] + sum[x + apart] + sum[x - apart] + sum[x + 2 * apart] + sum[x - 2 * apart]) / 5;
}

/* Of a plane; scratch: a row. */
void ISA(even_mean)(const evener *e, int plane, int y, int apart, float *scratch, float *out);

/* along.c: EVEN_BORDER and EVEN_SURE, then EVEN_VALUE made calm, into EVEN_NEXT. */
int32_t ISA(even_border)(evener *e);
int32_t ISA(even_calm)(evener *e);

/* What encre_even() does, for a job that has been checked. */
int32_t even_run_base(bands *pool, const encre_even_job *job);
int32_t even_run_v3(bands *pool, const encre_even_job *job);

#endif
