/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The strongest edge for every pixel, exactly: every edge pixel is a disc, the line is the union of the discs.
 *
 * Most of a disc lies nearer to a neighbouring edge pixel that inks at least as much, and so adds nothing. Each
 * disc is cut down to the pixels where it can win before anything is drawn, which makes the work about as large as
 * the inked area and not that times the radius. Equal discs side by side in a row are drawn as one. */
#include "ink/discs.h"

#include <stdlib.h>
#include <string.h>

enum { TILE = 32 };

typedef struct gather {
	const frame *f;
	discs *all;
} gather;

/* ---- one disc per edge pixel ------------------------------------------------------------------------------ */

static void count_rows(void *data, int y0, int y1, int thread)
{
	(void)thread;
	const gather *g = data;
	for (int y = y0; y < y1; y++) {
		const uint8_t *edge = g->f->edge + (size_t)y * (size_t)g->f->width;
		uint32_t n = 0;
		for (int x = 0; x < g->f->width; x++)
			n += edge[x] != 0;
		g->all->count[y] = n;
	}
}

static void fill_row(const frame *f, discs *all, int y)
{
	const uint8_t *edge = f->edge + (size_t)y * (size_t)f->width;
	disc *out = all->disc + all->first[y];
	uint32_t left = all->count[y];
	const float *strength = f->strength + (size_t)(y + 1 < f->height ? y + 1 : y) * (size_t)f->width;
	float reach = 0;
	for (int x = 0; left; x++) {
		uint64_t eight;
		if (x + 8 <= f->width && (memcpy(&eight, edge + x, 8), eight == 0)) {
			x += 7;
			continue;
		}
		if (!edge[x])
			continue;
		left--;
		__builtin_prefetch(strength + x); /* lines go on below */
		if (!ISA(disc_of)(f, x, y, out))
			continue;
		reach = max(reach, out->reach);
		out++;
	}
	all->count[y] = (uint32_t)(out - (all->disc + all->first[y]));
	all->up[y] = all->down[y] = (uint16_t)min(reach, OPEN - 1);
}

/* The least of a tile by halves, as a loop that carries it along the row would not be vectorised. */
static void tile_row(const frame *f, int y, float *tiles)
{
	const float *depth = layer_row(f, ENCRE_LAYER_DEPTH, y);
	for (int x0 = 0; x0 < f->width; x0 += TILE) {
		float nearest[TILE];
		int n = f->width - x0 < TILE ? f->width - x0 : TILE;
		for (int x = n; x < TILE; x++)
			nearest[x] = INFINITY;
		if (n == TILE)
			for (int x = 0; x < TILE; x++)
				nearest[x] = depth_of(depth[x0 + x]);
		else
			for (int x = 0; x < n; x++)
				nearest[x] = depth_of(depth[x0 + x]);
		for (int half = TILE / 2; half; half /= 2)
			for (int x = 0; x < half; x++)
				nearest[x] = min(nearest[x], nearest[x + half]);
		tiles[x0 / TILE] = min(tiles[x0 / TILE], nearest[0]);
	}
}

/* A band is a row of tiles. */
static void fill_rows(void *data, int y0, int y1, int thread)
{
	(void)thread;
	const gather *g = data;
	const frame *f = g->f;
	int across = (f->width - 1) / TILE + 1;
	float *tiles = g->all->nearest + (size_t)(y0 / TILE) * (size_t)across;
	for (int i = 0; i < across; i++)
		tiles[i] = INFINITY;
	for (int y = y0; y < y1 && f->params->line_occlude; y++)
		tile_row(f, y, tiles); /* depth is in the cache then, for the discs */
	for (int y = y0; y < y1 && !bands_stopped(f->bands); y++)
		fill_row(f, g->all, y);
}

/* Each of n values `step` apart becomes the least of those up to k away. */
static void least_within(float *v, float *copy, int n, int step, int k)
{
	for (int i = 0; i < n; i++)
		copy[i] = v[(ptrdiff_t)i * step];
	for (int i = 0; i < n; i++) {
		float all = copy[i];
		for (int j = i < k ? 0 : i - k; j < n && j <= i + k; j++)
			all = min(all, copy[j]);
		v[(ptrdiff_t)i * step] = all;
	}
}

/* ---- bounds ---------------------------------------------------------------------------------------------- */

/* How far e must go towards its edge neighbour n, on the axis of the two or diagonally in dx + dy. A pixel at distance
 * d <= reach of e is nearer to n by at least (dx - 1/2) / reach, diagonally by (dx + dy - 1) / reach: that is `lead`.
 * If this makes up for a smaller radius, n covers it at least as well as e does. `equal`: the bound where radii are
 * equal; of two diagonal neighbours at the same distance the one in the upper row has the pixel. Every pixel so passed
 * on gets nearer to its edge, so the chain ends. */
static int bound(const disc *e, const disc *n, float lead, int equal, float nearest)
{
	if (!n || n->style != e->style || n->gain < e->gain || n->bias > e->bias ||
	    (n->limit > e->limit && n->limit > nearest))
		return OPEN;
	float smaller = max(0, e->radius - n->radius);
	float far = lead + smaller * e->reach;
	if (far > 1.5f * e->reach || far >= OPEN)
		return far > 1 ? OPEN : equal;
	int k = (int)far;
	k -= (float)k == far; /* the last pixel before it */
	return k > equal ? k : equal;
}

/* Row y modulo three, with a pixel to spare on either side. */
static uint32_t *places(const frame *f, const discs *all, int y, int thread)
{
	return all->place + (size_t)(3 * thread + (y + 3) % 3) * ((size_t)f->width + 2) + 1;
}

static void place_row(const frame *f, const discs *all, int y, uint32_t *place)
{
	memset(place - 1, 0, ((size_t)f->width + 2) * sizeof *place);
	if (y < 0 || y >= f->height)
		return;
	const disc *row = all->disc + all->first[y];
	for (uint32_t i = 0; i < all->count[y]; i++)
		place[row[i].x] = i + 1;
}

static const disc *placed(const disc *row, const uint32_t *place, int x)
{
	return place[x] ? row + place[x] - 1 : NULL;
}

static void bound_row(const frame *f, discs *all, int y, int thread)
{
	const float *tiles = all->nearest + (size_t)(y / TILE) * (size_t)((f->width - 1) / TILE + 1);
	const disc *row[3];
	const uint32_t *place[3];
	for (int i = 0; i < 3; i++) { /* outside the frame none is placed */
		row[i] = all->disc + all->first[clamp_index(y + i - 1, f->height)];
		place[i] = places(f, all, y + i - 1, thread);
	}
	for (uint32_t k = 0; k < all->count[y]; k++) {
		disc *e = all->disc + all->first[y] + k;
		int x = e->x;
		float nearest = f->params->line_occlude ? tiles[x / TILE] : INFINITY;
		e->left = (uint16_t)bound(e, placed(row[1], place[1], x - 1), 0.5f, 0, nearest);
		e->right = (uint16_t)bound(e, placed(row[1], place[1], x + 1), 0.5f, 0, nearest);
		e->up = (uint16_t)bound(e, placed(row[0], place[0], x), 0.5f, 0, nearest);
		e->down = (uint16_t)bound(e, placed(row[2], place[2], x), 0.5f, 0, nearest);
		for (int i = 0; i < 2; i++) {
			e->corner[i][0] = (uint16_t)bound(e, placed(row[2 * i], place[2 * i], x - 1), 1, i, nearest);
			e->corner[i][1] = (uint16_t)bound(e, placed(row[2 * i], place[2 * i], x + 1), 1, i, nearest);
		}
	}
}

static void bound_rows(void *data, int y0, int y1, int thread)
{
	const gather *g = data;
	for (int y = y0 - 1; y <= y0; y++)
		place_row(g->f, g->all, y, places(g->f, g->all, y, thread));
	for (int y = y0; y < y1 && !bands_stopped(g->f->bands); y++) {
		place_row(g->f, g->all, y + 1, places(g->f, g->all, y + 1, thread));
		bound_row(g->f, g->all, y, thread);
	}
}

static bool same(const disc *a, const disc *b)
{
	return b->x == a->last + 1 && a->right == 0 && b->left == 0 && a->style == b->style && a->radius == b->radius &&
	       a->gain == b->gain && a->bias == b->bias && a->limit == b->limit && a->up == b->up && a->down == b->down;
}

/* Joins equal neighbours. What no pixel within reach can tell apart is equal: limits that hide nothing. */
static void join_rows(void *data, int y0, int y1, int thread)
{
	(void)thread;
	const gather *g = data;
	discs *all = g->all;
	int across = (g->f->width - 1) / TILE + 1;
	for (int y = y0; y < y1; y++) {
		const float *tiles = all->nearest + (size_t)(y / TILE) * (size_t)across;
		disc *row = all->disc + all->first[y], *end = row + all->count[y], *out = row;
		int up = 0, down = 0;
		for (disc *e = row; e < end; e++) {
			int reach = (int)min(e->reach, OPEN - 1);
			e->up = (uint16_t)(e->up < reach ? e->up : reach);
			e->down = (uint16_t)(e->down < reach ? e->down : reach);
			up = e->up > up ? e->up : up;
			down = e->down > down ? e->down : down;
			if (g->f->params->line_occlude && e->limit <= tiles[e->x / TILE])
				e->limit = 0;
			if (out > row && same(out - 1, e)) {
				out[-1].last = e->last;
				out[-1].right = e->right;
				out[-1].corner[0][1] = e->corner[0][1];
				out[-1].corner[1][1] = e->corner[1][1];
			} else {
				*out++ = *e;
			}
		}
		all->count[y] = (uint32_t)(out - row);
		all->up[y] = (uint16_t)up;
		all->down[y] = (uint16_t)down;
	}
}

/* ---- drawing --------------------------------------------------------------------------------------------- */

/* What the spans of a disc have in common. */
typedef struct shade {
	float first, last, radius, steep, gain, cut, paper, limit;
} shade;

static shade shade_of(const frame *f, const disc *e)
{
	const encre_params *p = f->params + e->style;
	return (shade){.first = e->x,
		       .last = e->last,
		       .radius = e->radius,
		       .steep = e->gain / fade_of(p, e->radius),
		       .gain = e->gain,
		       .cut = e->gain * e->bias,
		       .paper = p->pen_1_grain,
		       .limit = e->limit};
}

/* Eight pixels from x on at a time: pixels beyond the end of the span get what they are due, which is no more than
 * another disc gives them. */
static void ink_span(const shade *restrict e, float dy, int x, int end, float *restrict dark,
		     const float *restrict depth, const float *restrict grain)
{
	float first = e->first, last = e->last, radius = e->radius, steep = e->steep, gain = e->gain;
	float cut = e->cut, paper = e->paper, limit = e->limit, dy2 = dy * dy;
	for (; x < end; x += LANES)
		for (int k = 0; k < LANES; k++) {
			float px = (float)(x + k), a = first - px, b = px - last;
			float dx = positive(max(a, b)), t = (radius - sqrtf(dx * dx + dy2)) * steep;
			t = t < gain ? t : gain;
			t = (1 + paper * grain[x + k]) * t - cut;
			t = depth[x + k] >= limit ? t : 0;
			dark[x + k] = t > dark[x + k] ? t : dark[x + k];
		}
}

/* Likewise, and remembers who inked. Discs come in reading order: an equal takes over only if it is nearer. */
static void own_span(const shade *restrict e, int y, float dy, int x, int end, float *restrict dark,
		     const float *restrict depth, const float *restrict grain, float *restrict distance,
		     uint32_t *restrict owner)
{
	float first = e->first, last = e->last, radius = e->radius, steep = e->steep, gain = e->gain;
	float cut = e->cut, paper = e->paper, limit = e->limit, dy2 = dy * dy;
	uint32_t row = (uint32_t)y << 16;
	for (; x < end; x += LANES)
		for (int k = 0; k < LANES; k++) {
			float px = (float)(x + k), ex = px < first ? first : px;
			ex = ex > last ? last : ex;
			float dx = px - ex, d2 = dx * dx + dy2, before = dark[x + k];
			float t = (radius - sqrtf(d2)) * steep;
			t = t < gain ? t : gain;
			t = (1 + paper * grain[x + k]) * t - cut;
			t = most_one(t);
			t = depth[x + k] >= limit ? t : 0;
			float rival = t == before ? distance[x + k] : -1; /* squared distance that an equal must beat */
			int wins = t > before || (t > 0 && d2 < rival);
			dark[x + k] = wins ? t : before;
			distance[x + k] = wins ? d2 : distance[x + k];
			owner[x + k] = wins ? row | (uint32_t)(int)ex : owner[x + k];
		}
}

static void draw_disc(const disc *e, int y, canvas *c)
{
	int from = y - e->up < c->y0 ? c->y0 : y - e->up, to = y + e->down >= c->y1 ? c->y1 - 1 : y + e->down;
	shade s = shade_of(c->f, e);
	for (int row = from; row <= to; row++) {
		int dy = row - y, below = dy > 0, ahead = dy < 0 ? -dy : dy;
		float square = e->reach * e->reach - (float)dy * (float)dy;
		int half = square > 0 ? (int)sqrtf(square) : 0;
		int left = half < e->left ? half : e->left, right = half < e->right ? half : e->right;
		for (int i = 0; i < 2;
		     i++) { /* towards the corners of the other half the bound is looser by 2 * ahead */
			int signed_ahead = i == below ? ahead : -ahead;
			int l = e->corner[i][0] - signed_ahead, r = e->corner[i][1] - signed_ahead;
			left = e->corner[i][0] != OPEN && l < left ? l : left;
			right = e->corner[i][1] != OPEN && r < right ? r : right;
		}
		if (e->last > e->x) { /* the bounds are those of its ends; what lies between them is its own */
			left = left > 0 ? left : 0;
			right = right > 0 ? right : 0;
		}
		int x = e->x - left, end = e->last + right + 1;
		x = x < 0 ? 0 : x;
		end = end > c->f->width ? c->f->width : end;
		if (x >= end)
			continue;
		canvas_touch(c, row, x, end);
		size_t at = (size_t)(row - c->y0) * c->stride;
		if (c->owner)
			own_span(&s, y, (float)dy, x, end, c->dark + at, c->depth + at, c->grain + at, c->distance + at,
				 c->owner + at);
		else
			ink_span(&s, (float)dy, x, end, c->dark + at, c->depth + at, c->grain + at);
	}
}

void ISA(discs_draw)(const discs *all, canvas *c)
{
	for (int y = c->y0 - all->reach < 0 ? 0 : c->y0 - all->reach; y < c->f->height && y < c->y1 + all->reach; y++) {
		if (y + all->down[y] < c->y0 || y - all->up[y] >= c->y1)
			continue;
		if (bands_stopped(c->f->bands))
			return;
		const disc *row = all->disc + all->first[y];
		for (uint32_t i = 0; i < all->count[y]; i++)
			draw_disc(row + i, y, c);
	}
}

/* ---- the passes ------------------------------------------------------------------------------------------ */

discs ISA(discs_plan)(const frame *f, arena *a)
{
	size_t rows = (size_t)f->height, across = (size_t)(f->width - 1) / TILE + 1, tall = (rows - 1) / TILE + 1;
	return (discs){
		.first = arena_take(a, rows, sizeof(size_t)),
		.count = arena_take(a, rows, sizeof(uint32_t)),
		.up = arena_take(a, rows, sizeof(uint16_t)),
		.down = arena_take(a, rows, sizeof(uint16_t)),
		.nearest = arena_take(a, across * tall, sizeof(float)),
		.row_nearest = arena_take(a, across > tall ? across : tall, sizeof(float)),
		.place = arena_take(a, 3 * (size_t)bands_threads(f->bands) * ((size_t)f->width + 2), sizeof(uint32_t)),
	};
}

static void sum_reach(const frame *f, discs *all)
{
	all->reach = 0;
	for (int y = 0; y < f->height; y++) {
		all->reach = all->up[y] > all->reach ? all->up[y] : all->reach;
		all->reach = all->down[y] > all->reach ? all->down[y] : all->reach;
	}
}

int32_t ISA(discs_gather)(const frame *f, discs *all)
{
	gather g = {f, all};
	int32_t code = bands_run(f->bands, f->height, 0, count_rows, &g);
	if (code)
		return code;
	size_t n = 0;
	for (int y = 0; y < f->height; y++) {
		all->first[y] = n;
		n += all->count[y];
	}
	all->disc = n <= SIZE_MAX / sizeof *all->disc ? malloc(n ? n * sizeof *all->disc : 1) : NULL;
	if (!all->disc)
		return ENCRE_ERROR_MEMORY;
	code = bands_run(f->bands, f->height, TILE, fill_rows, &g);
	if (code)
		return code;
	sum_reach(f, all);
	int across = (f->width - 1) / TILE + 1, tall = (f->height - 1) / TILE + 1, k = all->reach / TILE + 1;
	for (int i = 0; i < tall; i++)
		least_within(all->nearest + (ptrdiff_t)i * across, all->row_nearest, across, 1, k);
	for (int i = 0; i < across; i++)
		least_within(all->nearest + i, all->row_nearest, tall, across, k);
	code = bands_run(f->bands, f->height, 0, bound_rows, &g);
	if (!code)
		code = bands_run(f->bands, f->height, 0, join_rows, &g);
	sum_reach(f, all);
	return code;
}

void ISA(discs_free)(discs *all)
{
	free(all->disc);
	all->disc = NULL;
}
