/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What the files of gouache have of each other. */
#ifndef ENCRE_PAINT_H
#define ENCRE_PAINT_H

#include "tones/points.h"

/* Of a stroke's shape, in lengths. */
static const float stroke_half = 0.5f, stroke_wide = 0.23f; /* half of its length and width */
/* By so much of the nearer one's 1 / depth one surface lies before another. */
static const float step_of_depth = 0.03f;

/* A stroke; places are in pixels of the full frame, so that its numbers are the same in any part of it. */
typedef struct paint_stroke {
	float x, y, along[2]; /* of length 1 */
	float half, wide;     /* of its length and of its width, pixels */
	float bend;           /* to the side, per square of the way along it */
	float color[3];
	float paint[3];       /* roots of what is under its middle: it stays on what is like that */
	float light, strays;  /* likewise of the picture, and how far that may be another */
	float near, slope[2]; /* 1 / depth there, and its growth to the right and down */
	float object, body;
	float born; /* those born late lie on top */
	uint32_t name;
} paint_stroke;

/* What is under the strokes, by pixel. */
enum { UNDER_PAINT, UNDER_NEAR = UNDER_PAINT + 3, UNDER_LIGHT, UNDER_COUNT };

enum { CELLS_BORDERS, CELLS_ALONG, CELLS_ROOM, CELLS_COUNT };

typedef struct paint_seed {
	float way[2], born, size; /* from its pixel's middle; `size`: length that it has */
	int32_t column;
	uint16_t name;
} paint_seed;

typedef struct gouache {
	frame *f;
	float *under;              /* of each row UNDER_COUNT times all pixels */
	float *roots;              /* of each thread two rows of the picture, three planes each */
	float *cells;              /* CELLS_COUNT times all of them */
	int32_t cell;              /* pixels each way */
	int32_t wide, high, reach; /* in cells */
	float size, least;         /* pixels: of the largest strokes, and of the smallest */
	paint_seed *seeds;         /* `a_row` of each row */
	int32_t *count;            /* of each row */
	int32_t a_row;
	uint8_t *lacks;
	blue_wanted wanted;
	paint_stroke *strokes; /* in the order of rows */
	int32_t *first, *order;
} gouache;

static inline float *paint_under(const gouache *g, int what, int y)
{
	return g->under + ((size_t)y * UNDER_COUNT + (size_t)what) * (size_t)g->f->width;
}

static inline float *paint_cells(const gouache *g, int what, int v)
{
	return g->cells + ((size_t)what * (size_t)g->high + (size_t)v) * (size_t)g->wide;
}

static inline float paint_smooth(float from, float to, float x)
{
	float t = clamp01((x - from) / (to - from));
	return t * t * (3 - 2 * t);
}

/* space.c: finds it; pixels of it at n places of a row */
int32_t ISA(paint_room_run)(gouache *g);
void ISA(paint_room)(const gouache *g, int y, int x, int n, float *room);
/* seeds.c: how surfaces lie at n pixels, those of the sky and what no place is known of, too. */
void ISA(paint_rest)(const frame *f, int y, int x, int n, tone_rest *rest);
/* The seeds of a row; false: points that they need are not known; they are asked for. */
bool ISA(paint_find)(const gouache *g, int y);
/* What they paint. */
void ISA(paint_strokes)(const gouache *g, int y);
/* brush.c */
void ISA(paint_draw)(const gouache *g, int count, int y0, int y1);

#endif
