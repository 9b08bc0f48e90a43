/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Strokes and spots are drawn: from its middle a stroke goes both ways over its surface, pixel by pixel as these tell
 * the way, as wide as the darkness there wants. Every band draws the marks that reach it, all in the order of rows and
 * columns in which they were found. */
#include "tones/strokes.h"

enum { LANES = 8, ROWS = 8 };

static const float least_on = 0.25f; /* cosine between a step and the next */

/* ---- drawing ----------------------------------------------------------------------------------------------- */

typedef struct brush {
	const frame *f;
	const tone_marks *m;
	int y0, y1;  /* rows that may be drawn */
	bool parted; /* into objects */
} brush;

typedef struct place {
	float x, y, half; /* width */
} place;

/* What is drawn in a row: a stroke's part whose place along it, distance from its middle and half width grow evenly, or
 * a disc. */
typedef struct row_of_ink {
	float along, more_along, away, more_away, half, more_half; /* at the first pixel, and to the next */
	float object;
} row_of_ink;

/* Pixels of another object keep what they have. Called with constants each time. */
KERNEL void ink_pixels(const row_of_ink *e, int n, const bool spot, const bool crisp, const float *restrict objects,
		       float *restrict ink)
{
	for (int k = 0; k < n; k++) {
		float by = (float)k, along = e->along + by * e->more_along, away = e->away + by * e->more_away;
		float half = spot ? e->half : e->half + by * e->more_half, cover, solid = spot ? 1 : most_one(2 * half);
		away = spot ? sqrtf(along * along + away * away) : fabsf(away);
		cover = crisp ? (half >= away ? 1 : 0) : min(clamp01(half + 0.5f - away), solid);
		/* beyond its ends lies the next one: else a stroke would darken itself where its parts meet */
		int inside = (spot | ((along >= 0) & (along < 1))) & (!objects || objects[k] == e->object);
		float left = 1 - (inside ? cover : 0);
		ink[k] = 1 - (1 - ink[k]) * left;
	}
}

KERNEL void ink_row(const brush *b, row_of_ink e, int y, int x, int end, const bool spot, const bool crisp,
		    const bool parted)
{
	const float *objects = parted ? layer_row(b->f, ENCRE_LAYER_OBJECT, y) : NULL;
	float *ink = tone_ink(b->m, y);
	for (; x < end; x += LANES) {
		if (x + LANES <= b->f->width)
			ink_pixels(&e, LANES, spot, crisp, parted ? objects + x : NULL, ink + x);
		else
			ink_pixels(&e, b->f->width - x, spot, crisp, parted ? objects + x : NULL, ink + x);
		e.along += LANES * e.more_along;
		e.away += LANES * e.more_away;
		e.half += LANES * e.more_half;
	}
}

static float object_at(const brush *b, int x, int y)
{
	const float *row = layer_row(b->f, ENCRE_LAYER_OBJECT, y);
	return row ? row[x] : 0;
}

/* The pixel of this frame at a coordinate of the full one, which starts `origin` pixels before it. */
static inline int32_t bound(float x, int32_t origin, int low, int high)
{
	float first = (float)(low + origin), last = (float)(high + origin);
	x = x > first ? x : first;
	x = x < last ? x : last;
	return (int32_t)x - origin;
}

static int pixel_of(float x, int32_t origin)
{
	return (int)floorf(x) - origin;
}

/* The x at which a + x * more + y * other is within from..to, are y * slope + low .. y * slope + high. */
typedef struct range {
	float slope, low, high;
} range;

static range range_of(float more, float other, float from, float to)
{
	if (fabsf(more) < 1e-3f)
		return (range){0, -1e6f, 1e6f};
	float per = 1 / more, x0 = from * per, x1 = to * per;
	return (range){-other * per, min(x0, x1), max(x0, x1)};
}

/* A part of a stroke, over what is of its object. */
typedef struct part {
	place from, to;
	float over; /* 1 by its length */
	float object;
} part;

KERNEL void draw_part(const brush *b, const part *g, const bool crisp, const bool parted)
{
	const encre_frame *o = &b->f->place;
	place p = g->from, q = g->to;
	float ux = (q.x - p.x) * g->over, uy = (q.y - p.y) * g->over, most = max(p.half, q.half) + 0.5f;
	float high = most * fabsf(ux), wider = q.half - p.half;
	int top = bound(min(p.y, q.y) - high - 0.5f, o->y, b->y0, b->y1),
	    bottom = bound(max(p.y, q.y) + high + 0.5f, o->y, b->y0, b->y1);
	range along = range_of(ux, uy, 0, 1 / g->over), away = range_of(-uy, ux, -most, most);
	/* told of many rows at once, in a vector, though parts have but a few */
	for (int first = top; first < bottom; first += ROWS) {
		int32_t from[ROWS], to[ROWS];
		float at[ROWS], off[ROWS];
		for (int k = 0; k < ROWS; k++) {
			float fy = (float)(o->y + first + k) + 0.5f - p.y, a = fy * along.slope, c = fy * away.slope;
			from[k] = bound(max(a + along.low, c + away.low) + p.x - 0.5f, o->x, 0, b->f->width);
			to[k] = bound(min(a + along.high, c + away.high) + p.x + 1.5f, o->x, 0, b->f->width);
			float fx = (float)(o->x + from[k]) + 0.5f - p.x;
			at[k] = (fx * ux + fy * uy) * g->over;
			off[k] = fy * ux - fx * uy;
		}
		for (int k = 0; k < ROWS && first + k < bottom; k++) {
			row_of_ink e = {.along = at[k],
					.more_along = ux * g->over,
					.away = off[k],
					.more_away = -uy,
					.half = p.half + wider * at[k],
					.more_half = wider * ux * g->over,
					.object = g->object};
			ink_row(b, e, first + k, from[k], to[k], false, crisp, parted);
		}
	}
}

static void draw_crisp(const brush *b, const part *g, bool parted)
{
	draw_part(b, g, true, parted);
}

static void draw_soft(const brush *b, const part *g, bool parted)
{
	if (parted)
		draw_part(b, g, false, true);
	else
		draw_part(b, g, false, false);
}

static void draw_spot(const brush *b, const tone_slot *s, place p, float object)
{
	const encre_frame *o = &b->f->place;
	float radius = s->crisp ? p.half : ISA(tone_true_radius)(p.half), most = radius + 0.5f;
	int top = bound(p.y - most - 0.5f, o->y, b->y0, b->y1), bottom = bound(p.y + most + 0.5f, o->y, b->y0, b->y1);
	for (int y = top; y < bottom; y++) {
		float fy = (float)(o->y + y) + 0.5f - p.y, wide = sqrtf(max(most * most - fy * fy, 0));
		int x = bound(p.x - wide - 0.5f, o->x, 0, b->f->width),
		    end = bound(p.x + wide + 0.5f, o->x, 0, b->f->width);
		row_of_ink e = {.along = (float)(o->x + x) + 0.5f - p.x,
				.more_along = 1,
				.away = fy,
				.half = radius,
				.object = object};
		if (s->crisp)
			ink_row(b, e, y, x, end, true, true, b->parted);
		else
			ink_row(b, e, y, x, end, true, false, b->parted);
	}
}

/* Half of how wide a mark is where it is so dark, of `wide` at most. */
static inline float half_at(const tone_width *widths, float rank, float wide, int dark)
{
	return clamp01((widths[dark].shown - rank) * 4) * widths[dark].size * wide;
}

/* Whether a stroke gets from one pixel of the frame to another over a single surface. */
static inline bool gets_to(const brush *b, int x0, int y0, int x1, int y1)
{
	int left = x0 < x1 ? x0 : x1, top = y0 < y1 ? y0 : y1, wide = x0 < x1 ? x1 - x0 : x0 - x1,
	    high = y0 < y1 ? y1 - y0 : y0 - y1;
	const ptrdiff_t next = (ptrdiff_t)TONE_BYTES * b->m->width;
	const uint8_t *right = tone_bytes(b->m, TONE_NEAR, y0) + left, *down = tone_bytes(b->m, TONE_NEAR, top) + x1;
	int ends = 0, k = 0, i = 0;
	/* mostly one of each; none of none */
	do {
		int n = wide - k < TONE_AHEAD ? wide - k : TONE_AHEAD;
		ends |= right[k] & (1 << n) >> 1;
		k += TONE_AHEAD;
	} while (k < wide);
	do {
		int n = high - i < TONE_AHEAD ? high - i : TONE_AHEAD;
		ends |= down[i * next] >> TONE_AHEAD & (1 << n) >> 1;
		i += TONE_AHEAD;
	} while (i < high);
	return !ends;
}

/* What is known of a stroke that is traced one way from its middle. */
typedef struct tracing {
	float x, y, along, down, step; /* the last but until the first is made the way itself */
	int column, row, count;
	bool goes;
	place *places;
} tracing;

/* How much of a step stays on its surface, in eighths: a stroke that ended with the last whole step would be seen to
 * come and go as its surface turns. */
static inline float part_of_step(const brush *b, const tracing *t)
{
	enum { WHOLE = 16 };
	int at = WHOLE, on = 0;
	for (int half = WHOLE / 2; on < WHOLE && half > 0; half /= 2) {
		float part = (float)at / WHOLE;
		int x = tone_within(pixel_of(t->x + part * t->along, b->f->place.x), b->f->width),
		    y = tone_within(pixel_of(t->y + part * t->down, b->f->place.y), b->f->height);
		bool goes = gets_to(b, t->column, t->row, x, y);
		on = goes ? at : on;
		at += goes ? half : -half;
	}
	return (float)on / WHOLE;
}

/* The next place of a stroke. */
static inline void trace(const brush *b, const tone_mark *mark, const tone_width *widths, float wide, float step,
			 bool parted, tracing *t)
{
	const int way = TONE_WAY + mark->layer;
	const float *there = b->m->way[tone_bytes(b->m, way, t->row)[t->column]];
	float u = there[0] - mark->turn * there[1], v = there[1] + mark->turn * there[0];
	float on = u * t->along + v * t->down, turn = t->count == 0 ? t->step : on < 0 ? -step : step;
	t->along = u * turn;
	t->down = v * turn;
	/* over an edge beyond which strokes lie across it there is no way on */
	float part = t->count == 0 || fabsf(on) > least_on * step ? part_of_step(b, t) : 0;
	t->goes = part > 0;
	if (!t->goes)
		return;
	t->x += part * t->along;
	t->y += part * t->down;
	int tx = pixel_of(t->x, b->f->place.x), ty = pixel_of(t->y, b->f->place.y);
	int nx = tone_within(tx, b->f->width), ny = tone_within(ty, b->f->height);
	t->column = nx;
	t->row = ny;
	/* the other way is traced meanwhile */
	__builtin_prefetch(tone_bytes(b->m, way, ny) + nx);
	__builtin_prefetch(tone_bytes(b->m, TONE_NEAR, ny) + nx);
	/* it is drawn only when all of it is known */
	__builtin_prefetch(tone_ink(b->m, ny) + nx);
	if (parted)
		__builtin_prefetch(layer_row(b->f, ENCRE_LAYER_OBJECT, ny) + nx);
	int dark = tone_bytes(b->m, TONE_DARK, ny)[nx];
	float far = step / mark->reach * ((float)t->count + part);
	t->places[t->count++] =
		(place){t->x, t->y, dark ? half_at(widths, mark->rank, wide, dark) * max(1 - far * far, 0) : 0};
	t->goes = part == 1 && far < 1 && dark && tx == nx && ty == ny && t->count < TONE_PLACES_OUT;
}

/* Begins to read what the middle of a mark will ask. */
static void fetch_mark(const brush *b, const tone_mark *mark)
{
	int x = tone_within(pixel_of(mark->x, b->f->place.x), b->f->width),
	    y = tone_within(pixel_of(mark->y, b->f->place.y), b->f->height);
	__builtin_prefetch(tone_bytes(b->m, TONE_DARK, y) + x);
	__builtin_prefetch(tone_bytes(b->m, TONE_NEAR, y) + x);
	__builtin_prefetch(tone_bytes(b->m, TONE_WAY + mark->layer, y) + x);
}

static void draw_mark(const brush *b, const tone_mark *mark, int row)
{
	if (mark->other)
		return;
	if (mark->slot->kind == tone_1_STIPPLE) {
		if (mark->size > 0)
			draw_spot(b, mark->slot, (place){mark->x, mark->y, mark->size},
				  object_at(b, mark->column, row));
		return;
	}
	float step = tone_step(mark->reach), far = max(mark->reach + step, mark->pitch) + 2;
	int x = tone_within(pixel_of(mark->x, b->f->place.x), b->f->width),
	    y = tone_within(pixel_of(mark->y, b->f->place.y), b->f->height);
	if ((float)y + 1 + far < (float)b->y0 || (float)y - far > (float)b->y1)
		return;
	const tone_width *widths = b->m->widths[mark->layer];
	const tone_block *about = b->m->blocks + y / TONE_BLOCK * tone_blocks(b->f->width) + x / TONE_BLOCK;
	bool known = far < TONE_BLOCK;
	if ((known && !(widths[about->darkest].shown > mark->rank)) || !gets_to(b, mark->column, row, x, y))
		return;
	bool parted = b->parted && !(known && !about->parted);
	int dark = tone_bytes(b->m, TONE_DARK, y)[x];
	float object = object_at(b, x, y), pitch = mark->pitch * mark->size;
	/* a stroke whose width falls to both ends as a parabola has two thirds of its middle's on the mean */
	float wide = 0.75f * full_cover / stroke_length * pitch;
	place all[2 * TONE_PLACES_OUT + 1], *places = all + TONE_PLACES_OUT, back[TONE_PLACES_OUT];
	float point = 0.25f * step;
	places[0] = (place){mark->x, mark->y, half_at(widths, mark->rank, wide, dark)};
	tracing on = {mark->x, mark->y, 0, 0, step, x, y, 0, true, places + 1}, off = on;
	off.step = -step;
	off.places = back;
	/* both ways at once: each waits for what its pixels tell */
	while (on.goes | off.goes) {
		if (on.goes)
			trace(b, mark, widths, wide, step, parted, &on);
		if (off.goes)
			trace(b, mark, widths, wide, step, parted, &off);
	}
	int after = on.count, before = off.count;
	for (int k = 0; k < before; k++)
		places[-1 - k] = back[k];
	/* where the dark ends a stroke does so with a point */
	for (int k = 1 - before; k <= after; k++)
		places[k].half = min(places[k].half, places[k - 1].half + point);
	for (int k = after - 1; k >= -before; k--)
		places[k].half = min(places[k].half, places[k + 1].half + point);
	for (int k = -before; k < after; k++) {
		float x1 = places[k + 1].x - places[k].x, y1 = places[k + 1].y - places[k].y;
		part g = {places[k], places[k + 1], 1 / sqrtf(x1 * x1 + y1 * y1), object};
		if (max(g.from.half, g.to.half) > 0.02f)
			(mark->slot->crisp ? draw_crisp : draw_soft)(b, &g, parted);
	}
}

void ISA(tone_marks_draw)(const frame *f, const tone_marks *m, int reach, int y0, int y1)
{
	brush b = {f, m, y0, y1, f->layer[ENCRE_LAYER_OBJECT].data != NULL};
	int from = y0 - reach > 0 ? y0 - reach : 0, to = y1 + reach < f->height ? y1 + reach : f->height;
	for (int y = from; y < to && !bands_stopped(f->bands); y++)
		for (int64_t i = m->first[y]; i < m->first[y + 1]; i++) {
			/* the next one's middle lies elsewhere */
			if (i + 1 < m->first[y + 1])
				fetch_mark(&b, m->marks + i + 1);
			draw_mark(&b, m->marks + i, y);
		}
}
