/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Strokes and spots are drawn: from its middle a stroke goes both ways over its surface, pixel by pixel as these tell
 * the way, as wide as the darkness there wants. Every band draws the marks that reach it, all in the order of rows and
 * columns in which they were found. */
#include "tones/strokes.h"

enum { BAND = 64, STEPS = 24 };

/* ---- drawing ----------------------------------------------------------------------------------------------- */

typedef struct brush {
	const frame *f;
	const tone_marks *m;
	int y0, y1; /* rows that may be drawn */
} brush;

typedef struct place {
	float x, y, half; /* width */
} place;

/* Ink between two places, over what is of the object at pixel (column, row). */
static void draw_between(const brush *b, const tone_mark *mark, place p, place q, int column, int row)
{
	bool spot = mark->slot->kind == tone_1_STIPPLE, crisp = mark->slot->crisp;
	float most = max(p.half, q.half), along[2] = {q.x - p.x, q.y - p.y};
	float square = along[0] * along[0] + along[1] * along[1], over = square > 0 ? 1 / square : 0;
	int left = (int)max(min(p.x, q.x) - most - 0.5f, 0), right = (int)max(max(p.x, q.x) + most + 1.5f, 0);
	int top = (int)max(min(p.y, q.y) - most - 0.5f, (float)b->y0),
	    bottom = (int)max(max(p.y, q.y) + most + 1.5f, 0);
	right = right < b->f->width ? right : b->f->width;
	bottom = bottom < b->y1 ? bottom : b->y1;
	const float *objects = layer_row(b->f, ENCRE_LAYER_OBJECT, row);
	float object = objects ? objects[column] : 0;
	for (int y = top; y < bottom; y++) {
		const float *own = layer_row(b->f, ENCRE_LAYER_OBJECT, y);
		tone_pixel *px = tone_pixels(b->f, b->m, y);
		float fy = (float)y + 0.5f - p.y;
		for (int x = left; x < right; x++) {
			float fx = (float)x + 0.5f - p.x, at = (fx * along[0] + fy * along[1]) * over, t = clamp01(at);
			if (!spot && (at < 0 || at >= 1))
				continue; /* the next one's: else a stroke would darken itself where its parts meet */
			float dx = fx - t * along[0], dy = fy - t * along[1], half = mix(p.half, q.half, t);
			float reach = spot ? ISA(tone_true_radius)(half) : half, solid = spot ? 1 : min(2 * half, 1);
			float away = sqrtf(dx * dx + dy * dy), cover = min(clamp01(reach + 0.5f - away), solid);
			cover = crisp ? half >= away : cover;
			if (cover > 0 && (!own || own[x] == object))
				px[x].ink = (uint8_t)(255.5f - (float)(255 - px[x].ink) * (1 - cover));
		}
	}
}

/* Half of how wide a mark is where it is so dark. */
static float half_at(const brush *b, const tone_mark *mark, uint8_t dark)
{
	const tone_slot *s = mark->slot;
	bool spot = s->kind == tone_1_STIPPLE;
	int row = spot ? TONE_SPOTS : mark->layer;
	float drawn = clamp01((b->m->shown[row][dark] - mark->rank) * 4) * b->m->size[row][dark],
	      pitch = tone_mark_pitch(s);
	if (spot)
		return pitch * mark->size * sqrtf(drawn * full_cover / 3.14159265f);
	/* a stroke whose width falls to both ends as a parabola has two thirds of its middle's on the mean */
	return 0.75f * full_cover * pitch / stroke_length * mark->size * drawn;
}

/* Whether a stroke gets from one pixel to another over a single surface. */
static bool gets_to(const brush *b, int x0, int y0, int x1, int y1)
{
	const frame *f = b->f;
	if (x1 < 0 || y1 < 0 || x1 >= f->width || y1 >= f->height)
		return false;
	const tone_pixel *from = tone_pixels(f, b->m, y0);
	unsigned ends = 0;
	for (int x = x0 < x1 ? x0 : x1; x < (x0 < x1 ? x1 : x0); x++)
		ends |= from[x].bits & TONE_ENDS_RIGHT;
	for (int y = y0 < y1 ? y0 : y1; y < (y0 < y1 ? y1 : y0); y++)
		ends |= tone_pixels(f, b->m, y)[x1].bits & TONE_ENDS_DOWN;
	return !ends;
}

/* Places of a stroke from its middle on, one way; returns how many. */
static int trace(const brush *b, const tone_mark *mark, float sign, float step, int x, int y, place *places)
{
	const frame *f = b->f;
	float px = mark->x, py = mark->y, last[2] = {0, 0};
	int n = 0;
	for (; n < STEPS; n++) {
		const float *there = b->m->way[tone_pixels(f, b->m, y)[x].way[mark->layer]];
		float way[2] = {there[0] - mark->turn * there[1], there[1] + mark->turn * there[0]};
		float turn = n == 0 ? sign : way[0] * last[0] + way[1] * last[1] < 0 ? -1.0f : 1.0f;
		last[0] = way[0] * turn;
		last[1] = way[1] * turn;
		px += step * last[0];
		py += step * last[1];
		int nx = (int)floorf(px), ny = (int)floorf(py);
		if (!gets_to(b, x, y, nx, ny))
			break;
		x = nx;
		y = ny;
		float t = step * (float)(n + 1) / mark->reach;
		uint8_t dark = tone_pixels(f, b->m, y)[x].dark;
		places[n] = (place){px, py, dark ? half_at(b, mark, dark) * max(1 - t * t, 0) : 0};
		if (t >= 1 || !dark)
			return n + 1;
	}
	return n;
}

static void draw_mark(const brush *b, const tone_mark *mark, int row)
{
	const frame *f = b->f;
	float far = max(mark->reach, tone_mark_pitch(mark->slot)) + 2;
	if (mark->y + far < (float)b->y0 || mark->y - far > (float)b->y1)
		return;
	int x = (int)floorf(mark->x), y = (int)floorf(mark->y);
	if (!gets_to(b, mark->column, row, x, y))
		return;
	float half = half_at(b, mark, tone_pixels(f, b->m, y)[x].dark);
	if (mark->slot->kind == tone_1_STIPPLE) {
		place at = {mark->x, mark->y, half};
		if (half > 0)
			draw_between(b, mark, at, at, x, y);
		return;
	}
	place all[2 * STEPS + 1], *places = all + STEPS, back[STEPS];
	float step = max(2, mark->reach / (STEPS - 1)), point = 0.25f * step;
	places[0] = (place){mark->x, mark->y, half};
	int after = trace(b, mark, 1, step, x, y, places + 1), before = trace(b, mark, -1, step, x, y, back);
	for (int k = 0; k < before; k++)
		places[-1 - k] = back[k];
	/* where the dark ends a stroke does so with a point */
	for (int k = 1 - before; k <= after; k++)
		places[k].half = min(places[k].half, places[k - 1].half + point);
	for (int k = after - 1; k >= -before; k--)
		places[k].half = min(places[k].half, places[k + 1].half + point);
	for (int k = -before; k < after; k++)
		if (places[k].half > 0.02f || places[k + 1].half > 0.02f)
			draw_between(b, mark, places[k], places[k + 1], x, y);
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
	brush b = {w->f, w->m, y0, y1};
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
			pitch = tone_marked(m->styles[i].slot + k) ? max(pitch, m->styles[i].slot[k].pitch) : pitch;
	w.reach = (int)min(pitch * (0.65f * stroke_length + 1), (float)f->height) + 3;
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
	return code ? code : bands_run(f->bands, f->height, BAND, draw_rows, &w);
}
