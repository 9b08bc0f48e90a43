/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Lines along bends that are spread over several faces. Each pixel by which one goes says where it runs and how much it
 * bends; the latter is evened along the line. The line takes the place of those edges of the mesh that are part of the
 * bend. */
#include "raster/bevels.h"

#include "base/pixel.h"
#include "raster/bends.h"

#include <stdlib.h>

typedef struct lines {
	bends bends;
	int even;    /* pixels along a line to each side, over which it is */
	float *most; /* of each pixel that is told of a bend: degrees, along the line */
} lines;

/* ---- evenness -------------------------------------------------------------------------------------------- */

static float most_at(const lines *l, int x, int y)
{
	return is_told(&l->bends, x, y) ? l->most[(ptrdiff_t)y * l->bends.width + x] : 0;
}

static bool goes_by(const bend *b)
{
	return b->most > 0 && fabsf(b->off) <= goes_by_within;
}

static bool parallel(const bend *one, const bend *other)
{
	int dot = 0, square = 0;
	for (int c = 0; c < 3; c++) {
		dot += one->across[c] * other->across[c];
		square += one->across[c] * one->across[c];
	}
	return 2 * abs(dot) > square;
}

/* Follows a line from a pixel by which it goes, one row or column at a time; returns how far. */
static int follow(const lines *l, int x, int y, int way, float *sum)
{
	const bends *s = &l->bends;
	const bend *b = bend_at(s, x, y);
	int axis = b->axis, steps = 0;
	while (steps < l->even) {
		const bend *next = NULL;
		int next_x = x, next_y = y;
		for (int aside = -1; aside <= 1; aside++) {
			int px = x + (axis ? way : aside), py = y + (axis ? aside : way);
			if (px < 0 || py < 0 || px >= s->width || py >= s->height)
				continue;
			const bend *other = bend_at(s, px, py);
			if (!is_told(s, px, py) || !goes_by(other) || !parallel(b, other) ||
			    (next && fabsf(next->off) <= fabsf(other->off)))
				continue;
			next = other;
			next_x = px;
			next_y = py;
		}
		if (!next)
			break;
		x = next_x;
		y = next_y;
		*sum += next->most;
		steps++;
	}
	return steps;
}

/* What a bend is along its line, and less the shorter it is: from pixel to pixel it is not even. */
static void even_rows(void *data, int y0, int y1, int thread)
{
	(void)thread;
	const lines *l = data;
	const bends *s = &l->bends;
	for (int y = y0; y < y1; y++)
		for (int x = 0; x < s->width; x++) {
			if (!is_told(s, x, y))
				continue;
			const bend *b = bend_at(s, x, y);
			float *most = l->most + (ptrdiff_t)y * s->width + x, sum = b->most;
			int length = 1;
			*most = 0;
			if (!goes_by(b))
				continue;
			for (int way = -1; way <= 1; way += 2)
				length += follow(l, x, y, way, &sum);
			float enough = max(0.5f * b->wide, 2);
			*most = sum / (float)length * clamp01((float)length / enough - 1);
		}
}

/* ---- lines ----------------------------------------------------------------------------------------------- */

/* Of an edge at a place in pixels that is part of a bend whose line passes close by: how far it is a line by itself.
 * 1: it is part of none. */
static float own_part(const lines *l, float px, float py, float bend_of_it)
{
	const bends *s = &l->bends;
	int reach = (int)s->longest + 1;
	float own = 1;
	for (int axis = 0; axis < 2; axis++) {
		float aside = axis ? px : py, along = axis ? py : px;
		int size = axis ? s->height : s->width, across = axis ? s->width : s->height;
		for (int j = (int)(aside + 0.5f) - 1; j <= (int)(aside + 0.5f); j++)
			for (int i = (int)along - reach; i <= (int)along + reach; i++) {
				if (i < 0 || j < 0 || i >= size || j >= across || fabsf(aside - (float)j) > 0.5f)
					continue;
				int x = axis ? j : i, y = axis ? i : j;
				if (!(most_at(l, x, y) > bend_of_it))
					continue;
				const bend *b = bend_at(s, x, y);
				float from = (float)(i + b->first);
				if (b->axis != axis || fabsf(b->off) > 0.75f || along < from ||
				    along > from + (float)b->ways)
					continue;
				float away = along - (float)i - b->second;
				own = min(own, fabsf(away) < fabsf(away + b->parting) ? b->own : 0);
			}
	}
	return own;
}

/* Whether lines may be drawn in a row, or take the place of edges there. */
static bool any_near(const lines *l, int y)
{
	const bends *s = &l->bends;
	int reach = (int)s->longest + 3, end = y + reach < s->height - 1 ? y + reach : s->height - 1;
	for (int row = y > reach ? y - reach : 0; row <= end; row++)
		if (s->told[row])
			return true;
	return false;
}

static void draw_way(const lines *l, int x, int y, int axis)
{
	const bends *s = &l->bends;
	float *crease = pixel_at(&s->job->creases, x, y) + 2 * axis;
	float degrees = min(most_at(l, x, y), most_at(l, x + !axis, y + axis));
	if (degrees > fabsf(crease[1])) {
		const bend *p = bend_at(s, x, y), *q = bend_at(s, x + !axis, y + axis);
		int dot = 0;
		for (int c = 0; c < 3; c++)
			dot += p->across[c] * q->across[c];
		float one = p->off, two = dot > 0 ? q->off : -q->off;
		if (dot != 0 && one != two && (one <= 0) != (two <= 0)) {
			crease[0] = (float)fmax((double)(fabsf(one) / (fabsf(one) + fabsf(two))), LEAST_SHARE);
			crease[1] = p->smooth && q->smooth ? -degrees - crease_spread : degrees + crease_spread;
			return;
		}
	}
	float own = fabsf(crease[1]) > 0 ? fabsf(crease[1]) + own_ahead : 0;
	if (!(crease[0] > 0 && fabsf(crease[1]) < 180))
		return;
	float left = own_part(l, (float)x + (axis ? 0 : crease[0]), (float)y + (axis ? crease[0] : 0), own);
	if (left == 1)
		return;
	if (crease_scale(crease, left))
		crease[1] += crease[1] < 0 ? -crease_spread : crease_spread;
}

static void draw_rows(void *data, int y0, int y1, int thread)
{
	(void)thread;
	const lines *l = data;
	const bends *s = &l->bends;
	for (int y = y0; y < y1; y++)
		for (int x = 0, end = any_near(l, y) ? s->width : 0; x < end; x++)
			for (int axis = 0; axis < 2; axis++)
				if (x + !axis < s->width && y + axis < s->height)
					draw_way(l, x, y, axis);
}

/* ---- all of them ------------------------------------------------------------------------------------------- */

static void plan(lines *l, const encre_raster_job *job, int threads, arena *a)
{
	bends_plan(&l->bends, job, threads, a);
	l->even = (int)(1.5f * l->bends.narrow) + 3;
	l->most = arena_take(a, (size_t)l->bends.width * (size_t)l->bends.height, sizeof *l->most);
}

int32_t bevels_draw(bands *pool, const encre_raster_job *job)
{
	lines l;
	arena a = {0};
	plan(&l, job, bands_threads(pool), &a);
	void *memory = arena_make(&a);
	if (!memory)
		return ENCRE_ERROR_MEMORY;
	plan(&l, job, bands_threads(pool), &a);
	int32_t code = bends_find(pool, &l.bends);
	if (!code)
		code = bands_run(pool, l.bends.height, BAND, even_rows, &l);
	if (!code)
		code = bands_run(pool, l.bends.height, BAND, draw_rows, &l);
	free(memory);
	return code;
}
