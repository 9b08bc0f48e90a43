/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Which points of the endless set (blue.h) lie in a pixel, by the chart of its surface: those that are born before the
 * density that is wanted there, in points to the chart's area. */
#ifndef ENCRE_POINTS_H
#define ENCRE_POINTS_H

#include "tones/blue.h"
#include "tones/tones.h"

enum { POINTS_MOST = 64 /* in a pixel */, POINTS_WIDEST = 24 /* cells to a pixel */ };

/* "px": so far from its middle along row and column a pixel holds a place. Where the surface bends a pixel and the next
 * tell otherwise where a place between them is; were it only half a pixel, some had none, and came and went. */
static const float held_within = 0.6f;

/* What is looked up for one pixel after the other is mostly the same. */
typedef struct point_reader {
	const blue_set *set; /* NULL: nothing is known yet */
	const blue_wanted *wanted;
	bool lacks; /* a tile that is not known, which is wanted now */
	blue_key key;
	const blue_tile *tile;
} point_reader;

static inline void point_turn_to(point_reader *r, int32_t level, int32_t x, int32_t y)
{
	if (r->tile && r->key.x == x && r->key.y == y && r->key.level == level)
		return;
	r->key = (blue_key){level, x, y};
	r->tile = r->set ? blue_find(r->set, r->key) : NULL;
	if (!r->tile) {
		blue_want(r->wanted, r->key);
		r->lacks = true;
	}
}

/* Of a pixel: the level that has all points which are wanted, and its place and growth in that one's cells. */
typedef struct point_grid {
	int32_t level, x, y;       /* its cell */
	float at[2];               /* and where in it */
	float a, b, c, d, over;    /* to the right and down, of x and of y; 1 / (a * d - b * c) */
	float density;             /* points to the chart's area */
	int left, right, up, down; /* cells about it in which its points may lie */
} point_grid;

/* |x| < 2^31 */
static inline int32_t point_whole_below(double x)
{
	int32_t whole = (int32_t)x;
	return whole - (whole > x);
}

/* The chart's area in pixel i; 0: it is seen on its edge. */
static inline float point_area(const tone_field chart[2], int i)
{
	float a = chart[0].right[i], b = chart[0].down[i], c = chart[1].right[i], d = chart[1].down[i];
	float area = fabsf(a * d - b * c), sides = (a * a + b * b) * (c * c + d * d);
	return area * area > 1e-6f * sides ? area : 0;
}

/* false: no point can be told there. */
static inline bool point_grid_fill(const tone_field chart[2], int i, float density, point_grid *g)
{
	float a = chart[0].right[i], b = chart[0].down[i], c = chart[1].right[i], d = chart[1].down[i];
	float rest, below = octave(density / blue_density, &rest);
	g->density = density;
	g->level = (float_bits(below) >> 23) - 127 + (rest > 1);
	g->level = g->level > BLUE_COARSEST ? g->level : BLUE_COARSEST;
	if (g->level > BLUE_FINEST)
		return false;
	double per = blue_cells(g->level), x = (double)chart[0].at[i] * per, y = (double)chart[1].at[i] * per;
	if (!(x < 0x1p30 && x > -0x1p30 && y < 0x1p30 && y > -0x1p30))
		return false;
	float cells = (float)per;
	g->a = a * cells;
	g->b = b * cells;
	g->c = c * cells;
	g->d = d * cells;
	g->over = 1 / (g->a * g->d - g->b * g->c);
	g->x = point_whole_below(x);
	g->y = point_whole_below(y);
	g->at[0] = (float)(x - g->x);
	g->at[1] = (float)(y - g->y);
	float wide = held_within * (fabsf(g->a) + fabsf(g->b)), high = held_within * (fabsf(g->c) + fabsf(g->d));
	if (!(2 * wide < POINTS_WIDEST && 2 * high < POINTS_WIDEST))
		return false;
	g->left = (int)floorf(g->at[0] - wide);
	g->right = (int)floorf(g->at[0] + wide);
	g->up = (int)floorf(g->at[1] - high);
	g->down = (int)floorf(g->at[1] + high);
	return true;
}

/* Where a point lies, in pixels from the middle of the one that holds it. */
typedef struct point {
	float way[2], born;
	uint16_t name;
} point;

static inline int points_in(const point_grid *g, point_reader *r, point to[POINTS_MOST])
{
	int n = 0;
	for (int v = g->up; v <= g->down; v++)
		for (int u = g->left; u <= g->right; u++) {
			int32_t x = g->x + u, y = g->y + v;
			point_turn_to(r, g->level, x >> BLUE_SIDE_BITS, y >> BLUE_SIDE_BITS);
			int i = (y & (BLUE_SIDE - 1)) * BLUE_SIDE + (x & (BLUE_SIDE - 1));
			if (!r->tile || !(r->tile->birth[i] < g->density) || n == POINTS_MOST)
				continue;
			float du = (float)u + ((float)r->tile->x[i] + 0.5f) * 0x1p-16f - g->at[0];
			float dv = (float)v + ((float)r->tile->y[i] + 0.5f) * 0x1p-16f - g->at[1];
			float across = (g->d * du - g->b * dv) * g->over, up = (g->a * dv - g->c * du) * g->over;
			if (max(fabsf(across), fabsf(up)) <= held_within)
				to[n++] = (point){{across, up}, r->tile->birth[i], r->tile->name[i]};
		}
	return n;
}

#endif
