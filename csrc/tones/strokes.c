/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Strokes and spots are drawn: from its middle a stroke goes both ways over its surface, pixel by pixel as these tell
 * the way, as wide as the darkness there wants. Every band draws the marks that reach it, all in the order of rows and
 * columns in which they were found. */
#include "tones/strokes.h"

enum {
	LANES = 8,
	ROWS = 8,
	NEAR = 4,
	STEPS = 8 /* from a stroke's middle to its end, and two more */,
	LEAST_STEP = 4 /* pixels */
};

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

static void draw_crisp(const brush *b, const part *g)
{
	draw_part(b, g, true, b->parted);
}

static void draw_soft(const brush *b, const part *g)
{
	if (b->parted)
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

/* The nearest of `size` pixels: where the frame ends its last pixel stands for what lies beyond, or strokes ended there
 * and left a pale edge. */
static inline int within(int pixel, int size)
{
	pixel = pixel < size ? pixel : size - 1;
	return pixel > 0 ? pixel : 0;
}

/* Whether a stroke gets from one pixel of the frame to another over a single surface. */
static inline bool gets_to(const brush *b, int x0, int y0, int x1, int y1)
{
	int left = x0 < x1 ? x0 : x1, top = y0 < y1 ? y0 : y1, wide = x0 < x1 ? x1 - x0 : x0 - x1,
	    high = y0 < y1 ? y1 - y0 : y0 - y1;
	const ptrdiff_t next = (ptrdiff_t)TONE_BYTES * b->m->width;
	const uint8_t *right = tone_bytes(b->m, TONE_BITS, y0) + left, *down = tone_bytes(b->m, TONE_BITS, top) + x1;
	int ends = 0;
	/* few at once, without a branch for each */
	for (int k = 0; k < wide; k += NEAR)
		for (int i = k; i < k + NEAR; i++)
			ends |= right[i < wide ? i : wide - 1] & TONE_ENDS_RIGHT;
	for (int k = 0; k < high; k += NEAR)
		for (int i = k; i < k + NEAR; i++)
			ends |= down[(i < high ? i : high - 1) * next] & TONE_ENDS_DOWN;
	return !ends;
}

/* Places of a stroke from its middle on, one way; returns how many. */
static int trace(const brush *b, const tone_mark *mark, float wide, float sign, float step, int x, int y, place *places)
{
	const tone_width *widths = b->m->widths[mark->layer];
	const ptrdiff_t way = (ptrdiff_t)(TONE_WAY + mark->layer - TONE_DARK) * b->m->width;
	const uint8_t *at = tone_bytes(b->m, TONE_DARK, y) + x;
	float px = mark->x, py = mark->y, along = 0, down = 0, rate = step / mark->reach;
	for (int n = 0; n < STEPS; n++) {
		const float *there = b->m->way[at[way]];
		float u = there[0] - mark->turn * there[1], v = there[1] + mark->turn * there[0];
		float turn = n == 0 ? sign : u * along + v * down < 0 ? -step : step;
		along = u * turn;
		down = v * turn;
		px += along;
		py += down;
		int tx = pixel_of(px, b->f->place.x), ty = pixel_of(py, b->f->place.y);
		int nx = within(tx, b->f->width), ny = within(ty, b->f->height);
		if (!gets_to(b, x, y, nx, ny))
			return n;
		x = nx;
		y = ny;
		at = tone_bytes(b->m, TONE_DARK, y) + x;
		/* it is drawn only when all of it is known */
		__builtin_prefetch(tone_ink(b->m, y) + x);
		if (b->parted)
			__builtin_prefetch(layer_row(b->f, ENCRE_LAYER_OBJECT, y) + x);
		float t = rate * (float)(n + 1);
		places[n] = (place){px, py, *at ? half_at(widths, mark->rank, wide, *at) * max(1 - t * t, 0) : 0};
		if (t >= 1 || !*at || tx != nx || ty != ny)
			return n + 1;
	}
	return STEPS;
}

/* Pixels from place to place along a stroke, of which the last lies beyond its end. */
static inline float step_of(float reach)
{
	return max(LEAST_STEP, reach / (STEPS - 2));
}

static void draw_mark(const brush *b, const tone_mark *mark, int row)
{
	float step = step_of(mark->reach), far = max(mark->reach + step, mark->pitch) + 2;
	int x = within(pixel_of(mark->x, b->f->place.x), b->f->width),
	    y = within(pixel_of(mark->y, b->f->place.y), b->f->height);
	if ((float)y + 1 + far < (float)b->y0 || (float)y - far > (float)b->y1)
		return;
	if (!gets_to(b, mark->column, row, x, y))
		return;
	int dark = tone_bytes(b->m, TONE_DARK, y)[x];
	float object = object_at(b, x, y), pitch = mark->pitch * mark->size;
	if (mark->slot->kind == tone_1_STIPPLE) {
		float area = half_at(b->m->widths[TONE_SPOTS], mark->rank, full_cover / 3.14159265f, dark);
		if (area > 0)
			draw_spot(b, mark->slot, (place){mark->x, mark->y, pitch * sqrtf(area)}, object);
		return;
	}
	/* a stroke whose width falls to both ends as a parabola has two thirds of its middle's on the mean */
	float wide = 0.75f * full_cover / stroke_length * pitch;
	place all[2 * STEPS + 1], *places = all + STEPS, back[STEPS];
	float point = 0.25f * step;
	places[0] = (place){mark->x, mark->y, half_at(b->m->widths[mark->layer], mark->rank, wide, dark)};
	int after = trace(b, mark, wide, step, step, x, y, places + 1),
	    before = trace(b, mark, wide, -step, step, x, y, back);
	for (int k = 0; k < before; k++)
		places[-1 - k] = back[k];
	/* where the dark ends a stroke does so with a point */
	for (int k = 1 - before; k <= after; k++)
		places[k].half = min(places[k].half, places[k - 1].half + point);
	for (int k = after - 1; k >= -before; k--)
		places[k].half = min(places[k].half, places[k + 1].half + point);
	float over = 1 / (step * sqrtf(1 + mark->turn * mark->turn));
	for (int k = -before; k < after; k++) {
		part g = {places[k], places[k + 1], over, object};
		if (max(g.from.half, g.to.half) > 0.02f)
			(mark->slot->crisp ? draw_crisp : draw_soft)(b, &g);
	}
}

/* ---- passes ------------------------------------------------------------------------------------------------ */

typedef struct work {
	const frame *f;
	tone_marks *m;
	int reach; /* rows */
} work;

static void look_at_rows(void *data, int y0, int y1, int thread)
{
	(void)thread;
	const work *w = data;
	for (int y = y0; y < y1; y++) {
		w->m->first[y] = ISA(tone_marks_look)(w->f, w->m, y);
	}
}

static void find_rows(void *data, int y0, int y1, int thread)
{
	(void)thread;
	const work *w = data;
	for (int y = y0; y < y1; y++)
		ISA(tone_marks_find)(w->f, w->m, y, w->m->marks + w->m->first[y]);
}

static void draw_rows(void *data, int y0, int y1, int thread)
{
	(void)thread;
	const work *w = data;
	brush b = {w->f, w->m, y0, y1, w->f->layer[ENCRE_LAYER_OBJECT].data != NULL};
	int from = y0 - w->reach > 0 ? y0 - w->reach : 0,
	    to = y1 + w->reach < w->f->height ? y1 + w->reach : w->f->height;
	for (int y = from; y < to; y++)
		for (int64_t i = w->m->first[y]; i < w->m->first[y + 1]; i++)
			draw_mark(&b, w->m->marks + i, y);
}

int32_t ISA(tone_marks_run)(frame *f, tone_marks *m)
{
	work w = {f, m, 0};
	float pitch = 0;
	for (int i = 0; i < f->n_styles; i++)
		for (int k = 0; k < TONE_SLOTS && f->params[i].use_tones; k++)
			if (tone_marked(m->styles[i].slot + k))
				pitch = max(pitch, m->styles[i].slot[k].most);
	float reach = 0.65f * stroke_length * pitch;
	w.reach = (int)min(reach + step_of(reach) + pitch, (float)f->height) + 3;
	int32_t code = bands_run(f->bands, f->height, 0, look_at_rows, &w);
	if (code)
		return code;
	int64_t sum = 0;
	for (int y = 0; y <= f->height; y++) {
		int64_t own = y < f->height ? m->first[y] : 0;
		m->first[y] = sum;
		sum += own;
	}
	m->marks = late_take(&f->late, (size_t)sum + 1, sizeof *m->marks);
	if (!m->marks)
		return ENCRE_ERROR_MEMORY;
	code = bands_run(f->bands, f->height, 0, find_rows, &w);
	/* strokes are traced in each band that they reach */
	int band = f->height / (4 * bands_threads(f->bands));
	band = band < 64 ? 64 : band < 256 ? band : 256;
	return code ? code : bands_run(f->bands, f->height, band, draw_rows, &w);
}
