/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Gouache: the picture painted over in opaque strokes of a flat brush (after Hertzmann 1998: large ones first, small
 * ones where there is detail). Each is of the color under it and lies on the thing, along its form. How large it may be
 * tells the room: how far the next border of colors, of light or of things is. All is told from one frame. */
#include "paint/paint.h"

#include <stdlib.h>
#include <string.h>

enum { WANTED = 1 << 15 /* tiles of points that find a place at once */ };

static const float smallest = 0.2f; /* stroke, of the largest */
/* of the largest, too: how far room is told, and how large a cell is */
static const float told_within = 0.8f, cell = 0.04f;

/* ---- what is under the strokes ----------------------------------------------------------------------------- */

/* What is painted there, whatever the light: a surface's color and what shines beside it. Roots, as the eye has it. */
static void under_row(const gouache *g, int y)
{
	const frame *f = g->f;
	const float *depth = layer_row(f, ENCRE_LAYER_DEPTH, y), *color = layer_row(f, ENCRE_LAYER_COLOR, y),
		    *combined = layer_row(f, ENCRE_LAYER_COMBINED, y), *diffuse = layer_row(f, ENCRE_LAYER_DIFFUSE, y);
	float *near = paint_under(g, UNDER_NEAR, y);
	for (int x = 0; x < f->width; x++)
		near[x] = 1 / depth_of(depth[x]);
	for (int c = 0; c < 3; c++) {
		float *restrict to = paint_under(g, UNDER_PAINT + c, y);
		for (int x = 0; x < f->width; x++) {
			float own = near[x] > 0 ? clamp01(color[3 * x + c]) : 0,
			      more = combined[4 * x + c] - own * diffuse[3 * x + c];
			to[x] = sqrtf(own + clamp01(more));
		}
	}
	const float *rgba = output_row(f, ENCRE_OUTPUT_COMBINED, y);
	float *restrict light = paint_under(g, UNDER_LIGHT, y);
	for (int x = 0; x < f->width; x++)
		light[x] = sqrtf(
			clamp01(luminance(clamp01(rgba[4 * x]), clamp01(rgba[4 * x + 1]), clamp01(rgba[4 * x + 2]))));
	float *like_none = paint_under(g, UNDER_PAINT, y);
	for (int x = 0, next; x < f->width; x = next)
		if (!style_run(f, y, x, f->width, &next)->use_gouache)
			for (int i = x; i < next; i++)
				like_none[i] = pixel_great;
}

static void under_rows(void *data, int y0, int y1, int thread)
{
	(void)thread;
	const gouache *g = data;
	for (int y = y0; y < y1 && !bands_stopped(g->f->bands); y++)
		under_row(g, y);
}

/* ---- seeds and strokes ------------------------------------------------------------------------------------- */

static void find_rows(void *data, int y0, int y1, int thread)
{
	(void)thread;
	const gouache *g = data;
	for (int y = y0; y < y1 && !bands_stopped(g->f->bands); y++)
		if (g->lacks[y])
			g->lacks[y] = !ISA(paint_find)(g, y);
}

/* Finds seeds, and the points of those rows that lack some, until none does. */
static int32_t find(gouache *g)
{
	frame *f = g->f;
	int32_t code = ENCRE_OK;
	bool lacks = true;
	blue_trim(f->kept_spots);
	memset(g->lacks, 1, (size_t)f->height);
	while (!code && lacks) {
		blue_want_none(&g->wanted);
		code = bands_run(f->bands, f->height, 0, find_rows, g);
		lacks = false;
		for (int y = 0; y < f->height; y++)
			lacks |= g->lacks[y];
		if (!code && lacks)
			code = ISA(blue_make)(f, &g->wanted);
	}
	return code;
}

static void stroke_rows(void *data, int y0, int y1, int thread)
{
	(void)thread;
	const gouache *g = data;
	for (int y = y0; y < y1 && !bands_stopped(g->f->bands); y++)
		ISA(paint_strokes)(g, y);
}

typedef struct turn {
	float born;
	int32_t stroke;
} turn;

static int by_birth(const void *a, const void *b)
{
	const turn *x = a, *y = b;
	if (x->born != y->born)
		return x->born < y->born ? -1 : 1;
	return x->stroke < y->stroke ? -1 : x->stroke > y->stroke;
}

static bool sort(gouache *g, int count)
{
	turn *turns = late_take(&g->f->late, (size_t)count + 1, sizeof *turns);
	for (int i = 0; turns && i < count; i++)
		turns[i] = (turn){g->strokes[i].born, i};
	if (turns)
		qsort(turns, (size_t)count, sizeof *turns, by_birth);
	for (int i = 0; turns && i < count; i++)
		g->order[i] = turns[i].stroke;
	late_drop(&g->f->late, turns);
	return turns;
}

static void draw_rows(void *data, int y0, int y1, int thread)
{
	(void)thread;
	const gouache *g = data;
	ISA(paint_draw)(g, g->first[g->f->height], y0, y1);
}

/* ---- stage ------------------------------------------------------------------------------------------------- */

static bool wanted(const frame *f)
{
	return f->any.use_gouache;
}

static void plan(frame *f, arena *a)
{
	f->gouache = NULL;
	if (!wanted(f))
		return;
	size_t width = (size_t)f->width, height = (size_t)f->height, n = width * height;
	float size = max(f->params->gouache_size * f->scale, 2);
	gouache *g = arena_take(a, 1, sizeof *g), made = {.f = f, .size = size};
	made.least = smallest * size;
	made.cell = (int)max(cell * size, 1);
	made.reach = (int)max(told_within * size / (float)made.cell + 0.5f, 1);
	made.wide = (f->place.x % made.cell + f->width - 1) / made.cell + 1;
	made.high = (f->place.y % made.cell + f->height - 1) / made.cell + 1;
	made.a_row = f->width / 4 + 16;
	made.under = arena_take(a, n, UNDER_COUNT * sizeof *made.under);
	made.cells = arena_take(a, (size_t)made.wide * (size_t)made.high, CELLS_COUNT * sizeof *made.cells);
	made.roots = arena_take(a, (size_t)bands_threads(f->bands) * width, 6 * sizeof *made.roots);
	made.seeds = arena_take(a, height * (size_t)made.a_row, sizeof *made.seeds);
	made.count = arena_take(a, height, sizeof *made.count);
	made.first = arena_take(a, height + 1, sizeof *made.first);
	made.lacks = arena_take(a, height, sizeof *made.lacks);
	made.wanted = (blue_wanted){arena_take(a, WANTED, sizeof *made.wanted.key), WANTED - 1};
	if (g)
		*g = made;
	f->gouache = g;
}

static int32_t run(frame *f)
{
	enum { BAND = 64 };
	gouache *g = f->gouache;
	if (!g)
		return ENCRE_OK;
	int32_t code = bands_run(f->bands, f->height, 0, under_rows, g);
	code = code ? code : ISA(paint_room_run)(g);
	code = code ? code : find(g);
	if (code)
		return code;
	g->first[0] = 0;
	for (int y = 0; y < f->height; y++)
		g->first[y + 1] = g->first[y] + g->count[y];
	size_t count = (size_t)g->first[f->height];
	g->strokes = late_take(&f->late, count + 1, sizeof *g->strokes);
	g->order = late_take(&f->late, count + 1, sizeof *g->order);
	if (!g->strokes || !g->order)
		return ENCRE_ERROR_MEMORY;
	code = bands_run(f->bands, f->height, 0, stroke_rows, g);
	if (!code && !sort(g, (int)count))
		code = ENCRE_ERROR_MEMORY;
	return code ? code : bands_run(f->bands, f->height, BAND, draw_rows, g);
}

const stage STAGE_SYMBOL(gouache) = {.id = "gouache", .plan = plan, .run = run, .draws = wanted};
