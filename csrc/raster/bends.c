/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Bends that are spread over several faces, as a bevel's: from afar they are one edge, and none of their own edges may
 * bend enough to be drawn. They are looked for along rows and columns (lanes.c); of what these say of a pixel one bend
 * is made. The line runs in the middle of the turning, and takes the place of those edges of the mesh that are part of
 * it. */
#include "raster/lanes.h"

static const float narrow = 2.5f / 540;       /* of the frame's height: what bends within it counts in full */
static const float most_narrow = 12;          /* pixels */
static const float fading[2] = {0.5f, 0.15f}; /* of what bends is lost for each time that it is as wide again: of flat
						faces, of smooth ones, which must bend more */
static const float longest = 4;               /* times `narrow`: nothing wider is a bend */
static const float least_longest = 5;         /* pixels: two edges, 3.5 px apart across, along a diagonal */
static const float clearly = 1.001f; /* times: of a diagonal rounding would choose now the row, now the column */
static const float whole = 0.85f;    /* of what a column says a row must say to have found the same */

static int longer_of(const bends *s)
{
	return s->width > s->height ? s->width : s->height;
}

static void find_columns(void *data, int x0, int x1, int thread)
{
	const bends *s = data;
	const lane *own = s->lane + thread;
	int count[BAND] = {0};
	memset(own->told, 0, (size_t)longer_of(s) * sizeof *own->told);
	for (int y = 0; y + 1 < s->height; y++)
		for (int x = x0; x < x1; x++)
			count[x - x0] =
				lane_note(s, x, y, 1, own->turning + (ptrdiff_t)(x - x0) * longer_of(s), count[x - x0]);
	for (int x = x0; x < x1; x++) {
		if (!lane_look(&(looking){s, own->turning + (ptrdiff_t)(x - x0) * longer_of(s), own->best,
					  count[x - x0], 1, x, s->height, own->told}))
			continue;
		for (int y = 0; y < s->height; y++) {
			ptrdiff_t at = (ptrdiff_t)y * s->width + x;
			if (!(own->told[y].most > 0))
				continue;
			s->way[at] |= WAY_TOLD;
			s->bend[at] = own->told[y];
			own->told[y].most = 0;
		}
	}
}

/* How much a bend still counts that is so many pixels wide. A chamfer's edges part instead. */
static float faded(const bends *s, const bend *b, float wide)
{
	return b->chamfer ? b->most : b->most / (1 + fading[b->smooth] * max(0, wide / s->narrow - 1));
}

/* Of what a row and a column say of a pixel makes one, measured across the line. */
static void unite(const bends *s, bend *column, const bend *row)
{
	int dot = 0, one = 0, other = 0;
	for (int c = 0; c < 3; c++) {
		dot += column->across[c] * row->across[c];
		one += column->across[c] * column->across[c];
		other += row->across[c] * row->across[c];
	}
	bool same = min(column->most, row->most) > whole * max(column->most, row->most),
	     both = same && 2.0f * (float)dot * (float)dot > (float)one * (float)other;
	float u = 1 / column->wide, v = 1 / row->wide;
	if (same ? v > clearly * u : row->most > column->most)
		*column = *row;
	if (!(column->most > 0))
		return;
	float wide = both ? 1 / sqrtf(u * u + v * v) : column->wide;
	column->off *= wide / column->wide;
	column->wide = wide;
	column->most = faded(s, column, wide);
}

static void find_rows(void *data, int y0, int y1, int thread)
{
	const bends *s = data;
	const lane *own = s->lane + thread;
	memset(own->told, 0, (size_t)longer_of(s) * sizeof *own->told);
	for (int y = y0; y < y1; y++) {
		int count = 0;
		for (int x = 0; x + 1 < s->width; x++)
			count = lane_note(s, x, y, 0, own->turning, count);
		lane_look(&(looking){s, own->turning, own->best, count, 0, y, s->width, own->told});
		s->told[y] = false;
		for (int x = 0; x < s->width; x++) {
			ptrdiff_t at = (ptrdiff_t)y * s->width + x;
			bool by_column = s->way[at] & WAY_TOLD;
			if (!by_column && !(own->told[x].most > 0))
				continue;
			if (!by_column)
				s->bend[at] = (bend){.wide = 1};
			unite(s, s->bend + at, own->told + x);
			s->way[at] |= WAY_TOLD;
			s->told[y] = true;
			own->told[x].most = 0;
		}
	}
}

/* ---- all of them ------------------------------------------------------------------------------------------- */

void bends_plan(bends *b, const encre_raster_job *job, int threads, arena *a)
{
	b->job = job;
	b->width = job->creases.width;
	b->height = job->creases.height;
	b->narrow = min(max(narrow * (float)job->frame.height, 1), most_narrow);
	b->longest = max(longest * b->narrow, least_longest);
	b->way = arena_take(a, (size_t)b->width * (size_t)b->height, sizeof *b->way);
	b->told = arena_take(a, (size_t)b->height, sizeof *b->told);
	b->bend = arena_take(a, (size_t)b->width * (size_t)b->height, sizeof *b->bend);
	b->lane = arena_take(a, (size_t)threads, sizeof *b->lane);
	for (int i = 0; i < threads; i++) {
		lane own = {arena_take(a, (size_t)BAND * (size_t)longer_of(b), sizeof *own.turning),
			    arena_take(a, (size_t)longer_of(b), sizeof *own.best),
			    arena_take(a, (size_t)longer_of(b), sizeof *own.told)};
		if (a->base)
			b->lane[i] = own;
	}
}

int32_t bends_find(bands *pool, bends *b)
{
	int32_t code = bands_run(pool, b->height, BAND, neighbours_rows, b);
	if (!code)
		code = bands_run(pool, b->width, BAND, find_columns, b);
	return code ? code : bands_run(pool, b->height, BAND, find_rows, b);
}
