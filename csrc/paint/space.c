/* SPDX-License-Identifier: GPL-3.0-or-later */
/* How much room for strokes there is: about as far as to the next border of colors, of light or of things, told from
 * how many borders lie about a place. That is a mean, so that nothing jumps where a border comes to be. It is told by
 * cells of some pixels each way. */
#include "paint/paint.h"

#include <string.h>

static const float seen_from = 0.03f, sure_at = 0.2f; /* between two pixels' roots, where a border is */
static const float by_borders = 1.5f;                 /* so much less room there is where one goes across */

/* Roots of a row of the picture, three planes: as the eye has it. */
static void roots(const frame *f, int y, float *restrict to)
{
	const float *rgba = output_row(f, ENCRE_OUTPUT_COMBINED, y);
	for (int c = 0; c < 3; c++)
		for (int x = 0; x < f->width; x++)
			to[(ptrdiff_t)f->width * c + x] = sqrtf(clamp01(rgba[4 * x + c]));
}

/* How sure a border lies between a pixel and another. */
static inline float border(const float *own, const float *other, ptrdiff_t apart, float near, float next)
{
	float by = max3(fabsf(own[0] - other[0]), fabsf(own[apart] - other[apart]),
			fabsf(own[2 * apart] - other[2 * apart]));
	float deep = fabsf(near - next) * (1 / step_of_depth) - max(near, next);
	return max(clamp01((by - seen_from) * (1 / (sure_at - seen_from))), deep > 0 ? 1 : 0);
}

/* Adds borders to the right of pixels of row y and below them to cells. */
static void add_row(const gouache *g, int y, const float *own, const float *next, float *cells)
{
	const frame *f = g->f;
	int below = clamp_index(y + 1, f->height), width = f->width, left = f->place.x % g->cell;
	const float *objects = layer_row(f, ENCRE_LAYER_OBJECT, y), *under = layer_row(f, ENCRE_LAYER_OBJECT, below);
	const float *near = paint_under(g, UNDER_NEAR, y), *deep = paint_under(g, UNDER_NEAR, below);
	for (int x = 0; x < width; x++) {
		int right = x + 1 < width ? x + 1 : x;
		float sure = max(border(own + x, own + right, width, near[x], near[right]),
				 border(own + x, next + x, width, near[x], deep[x]));
		if (objects && (objects[x] != objects[right] || objects[x] != under[x]))
			sure = 1;
		cells[(left + x) / g->cell] += sure;
	}
}

static void add_rows(void *data, int v0, int v1, int thread)
{
	const gouache *g = data;
	const frame *f = g->f;
	int width = f->width, top = f->place.y % g->cell;
	float *row[2] = {g->roots + (ptrdiff_t)thread * 6 * width, g->roots + ((ptrdiff_t)thread * 6 + 3) * width};
	for (int v = v0; v < v1 && !bands_stopped(f->bands); v++) {
		int y0 = v * g->cell - top, y1 = y0 + g->cell < f->height ? y0 + g->cell : f->height;
		float *cells = paint_cells(g, CELLS_BORDERS, v);
		memset(cells, 0, (size_t)g->wide * sizeof *cells);
		y0 = y0 > 0 ? y0 : 0;
		roots(f, y0, row[0]);
		for (int y = y0; y < y1; y++) {
			roots(f, clamp_index(y + 1, f->height), row[1]);
			add_row(g, y, row[0], row[1], cells);
			float *swap = row[0];
			row[0] = row[1];
			row[1] = swap;
		}
	}
}

/* Adds a part of n cells. */
static void add(const float *restrict from, float weight, int n, float *restrict to)
{
	for (int i = 0; i < n; i++)
		to[i] += weight * from[i];
}

/* Of a tent that many cells wide to either side. */
static inline float weight_of(int reach, int k)
{
	return (float)(reach - (k < 0 ? -k : k));
}

static void along_rows(void *data, int v0, int v1, int thread)
{
	(void)thread;
	const gouache *g = data;
	for (int v = v0; v < v1; v++) {
		float *to = paint_cells(g, CELLS_ALONG, v), *from = paint_cells(g, CELLS_BORDERS, v);
		memset(to, 0, (size_t)g->wide * sizeof *to);
		for (int k = 1 - g->reach; k < g->reach; k++) {
			int first = k < 0 ? -k : 0, end = k > 0 ? g->wide - k : g->wide;
			add(from + first + k, weight_of(g->reach, k), end - first, to + first);
		}
	}
}

/* A border straight across the middle of the tent counts as 1, one beside it less. */
static void down_columns(void *data, int v0, int v1, int thread)
{
	(void)thread;
	const gouache *g = data;
	float most = (float)(g->reach * g->cell), over = 1 / ((float)(g->reach * g->reach) * most);
	for (int v = v0; v < v1; v++) {
		float *room = paint_cells(g, CELLS_ROOM, v);
		memset(room, 0, (size_t)g->wide * sizeof *room);
		for (int k = 1 - g->reach; k < g->reach; k++)
			if (v + k >= 0 && v + k < g->high)
				add(paint_cells(g, CELLS_ALONG, v + k), weight_of(g->reach, k), g->wide, room);
		for (int u = 0; u < g->wide; u++) {
			float borders = room[u] * over;
			room[u] = most / (1 + by_borders * borders * borders);
		}
	}
}

int32_t ISA(paint_room_run)(gouache *g)
{
	int32_t code = bands_run(g->f->bands, g->high, 4, add_rows, g);
	code = code ? code : bands_run(g->f->bands, g->high, 4, along_rows, g);
	return code ? code : bands_run(g->f->bands, g->high, 4, down_columns, g);
}

void ISA(paint_room)(const gouache *g, int y, int x, int n, float *restrict room)
{
	const frame *f = g->f;
	float per = 1 / (float)g->cell;
	float at = max(min(((float)(f->place.y % g->cell + y) + 0.5f) * per - 0.5f, (float)(g->high - 1)), 0);
	int v = (int)at, next = v + 1 < g->high ? v + 1 : v;
	const float *above = paint_cells(g, CELLS_ROOM, v), *below = paint_cells(g, CELLS_ROOM, next);
	float down = at - (float)v;
	for (int i = 0; i < n; i++) {
		float place = ((float)(f->place.x % g->cell + x + i) + 0.5f) * per - 0.5f;
		place = max(min(place, (float)(g->wide - 1)), 0);
		int u = (int)place, right = u + 1 < g->wide ? u + 1 : u;
		float along = place - (float)u;
		room[i] = mix(mix(above[u], above[right], along), mix(below[u], below[right], along), down);
	}
}
