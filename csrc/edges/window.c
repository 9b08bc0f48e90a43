/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Largest values of wide windows, at a cost that does not grow with them: rows first, then strips of columns. */
#include "edges/window.h"

#include <string.h>

enum { LANES = 16 }; /* columns that are worked on side by side */

/* ---- one row ---------------------------------------------------------------------------------------------- */

static void greater(const float *restrict a, ptrdiff_t ahead, ptrdiff_t n, float *restrict out)
{
	for (ptrdiff_t i = 0; i < n; i++)
		out[i] = a[i] > a[i + ahead] ? a[i] : a[i + ahead];
}

/* Spans of 1, 2, 4, ... items, then two of the longest that fits overlap. */
float *ISA(window_greatest)(float *a, float *spare, ptrdiff_t n, ptrdiff_t reach, ptrdiff_t lanes)
{
	ptrdiff_t wide = 2 * reach + 1, left = n + 2 * reach, span = 1;
	for (; 2 * span <= wide; span *= 2) {
		left -= span;
		greater(a, span * lanes, left * lanes, spare);
		float *swap = a;
		a = spare;
		spare = swap;
	}
	greater(a, (wide - span) * lanes, n * lanes, spare);
	return spare;
}

/* ---- pictures --------------------------------------------------------------------------------------------- */

static int reach_of(float size, int n)
{
	float reach = floorf(size / 2);
	return reach < (float)(n - 1) ? (int)reach : n - 1; /* a wider window sees no more */
}

wide_window ISA(window_plan)(arena *a, const bands *pool, int width, int height, float size, bool wrap_x, bool wrap_y)
{
	wide_window w = {.width = width,
			 .height = height,
			 .reach_x = reach_of(size, width),
			 .reach_y = reach_of(size, height),
			 .wrap_x = wrap_x,
			 .wrap_y = wrap_y};
	size_t across = (size_t)width + 2 * (size_t)w.reach_x, down = LANES * ((size_t)height + 2 * (size_t)w.reach_y);
	w.each = across > down ? across : down;
	w.scratch = arena_take(a, 2 * (size_t)bands_threads(pool) * w.each, sizeof *w.scratch);
	return w;
}

static float *scratch_of(const wide_window *w, int thread)
{
	return w->scratch + 2 * (size_t)thread * w->each;
}

void ISA(window_row)(const wide_window *w, const float *in, int thread, float *largest)
{
	float *padded = scratch_of(w, thread), *spare = padded + w->each;
	int n = w->width, reach = w->reach_x;
	for (int i = 1; i <= reach; i++) {
		padded[reach - i] = w->wrap_x ? in[wrap_index(-i, n)] : 0;
		padded[reach + n - 1 + i] = w->wrap_x ? in[wrap_index(n - 1 + i, n)] : 0;
	}
	memcpy(padded + reach, in, (size_t)n * sizeof *in);
	memcpy(largest, ISA(window_greatest)(padded, spare, n, reach, 1), (size_t)n * sizeof *in);
}

typedef struct columns {
	const wide_window *w;
	float *picture;
} columns;

/* "Rows" are strips of LANES columns here: a strip reads and writes its own columns only. */
static void column_strips(void *data, int first, int end, int thread)
{
	const columns *c = data;
	const wide_window *w = c->w;
	float *padded = scratch_of(w, thread), *spare = padded + w->each;
	for (int strip = first; strip < end; strip++) {
		int x = strip * LANES;
		size_t n = (size_t)(w->width - x < LANES ? w->width - x : LANES);
		float *column = c->picture + x;
		memset(padded, 0, ((size_t)w->height + 2 * (size_t)w->reach_y) * LANES * sizeof *padded);
		for (int y = w->wrap_y ? -w->reach_y : 0; y < w->height + (w->wrap_y ? w->reach_y : 0); y++)
			memcpy(padded + (ptrdiff_t)(w->reach_y + y) * LANES,
			       column + (ptrdiff_t)wrap_index(y, w->height) * w->width, n * sizeof *column);
		const float *largest = ISA(window_greatest)(padded, spare, w->height, w->reach_y, LANES);
		for (int y = 0; y < w->height; y++)
			memcpy(column + (ptrdiff_t)y * w->width, largest + (ptrdiff_t)y * LANES, n * sizeof *column);
	}
}

int32_t ISA(window_columns)(const wide_window *w, bands *pool, float *picture)
{
	columns c = {w, picture};
	return bands_run(pool, (w->width - 1) / LANES + 1, 1, column_strips, &c);
}
