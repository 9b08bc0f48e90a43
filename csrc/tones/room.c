/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Where a screen has no room: a piece of it that is narrower than `tone_least` pitches would be a row of dots. It is
 * ink, or beside ink, as between bars and inside letters, paper. */
#include "tones/tones.h"

#include <string.h>

enum { LIGHT, SCREEN, APART, CLEARED }; /* what pixels are; APART: ink; CLEARED: kept clear of tones */
enum { CORE = 1, MAYBE = 255 };

/* Of the least width: what is narrower has no room, what is wider has. */
static const float narrow = 0.7f, wide = 1.4f;
/* Of half the least width: as far light is looked for beside a narrow piece. */
static const float beside = 2;

typedef struct work {
	const frame *f;
	const tone_detail *d;
	const tone_style *styles;
	late **late;
	int reach; /* pixels that any pixel looks as far as */
	/* what one pass looks for in a plane: what is `sought`, or all else */
	const uint8_t *plane;
	uint8_t sought;
	bool other;
} work;

static uint8_t *row_of(const work *w, uint8_t *plane, int y)
{
	return plane + (ptrdiff_t)y * w->f->width;
}

/* Half of how wide a screen is at least. */
static float radius_of(const work *w, int x, int y)
{
	return w->styles[style_at(w->f, x, y)].room;
}

static bool is_screen(const tone_slot *s)
{
	return (s->kind == tone_1_DOTS || s->kind == tone_1_LINES || s->kind == tone_1_CROSS) &&
	       s->space != tone_1_space_OBJECT;
}

float ISA(tone_room)(const encre_params *p, const tone_style *style)
{
	float pitch = 0;
	for (int k = 0; k < TONE_SLOTS; k++)
		if (is_screen(style->slot + k))
			pitch = max(pitch, style->slot[k].pitch);
	return min(0.5f * p->tone_least * pitch, TONE_ROOM_MOST);
}

static void look_at_run(const work *w, const encre_params *p, int y, int x, int n, uint8_t *what)
{
	const tone_slot *slots = w->styles[p - w->f->params].slot;
	const uint8_t *keep = w->d->keep ? row_of(w, w->d->keep, y) + x : NULL;
	float screens[TONE_CHUNK] = {0}, solid[TONE_CHUNK] = {0};
	tone_wanted wanted;
	ISA(tone_want)(w->f, p, slots, y, x, n, &wanted);
	for (int k = 0; k < TONE_SLOTS; k++) {
		float *sum = is_screen(slots + k) ? screens : slots[k].kind == tone_1_SOLID ? solid : NULL;
		for (int i = 0; sum && wanted.any[k] && i < n; i++)
			sum[i] += wanted.dark[k][i] > 0 ? wanted.share[k][i] : 0;
	}
	for (int i = 0; i < n; i++) {
		int clear = keep && keep[i] < 128, other = screens[i] > 0.5f ? SCREEN : LIGHT;
		what[i] = (uint8_t)(solid[i] > 0.5f ? APART : clear ? CLEARED : other);
	}
}

static void look_at_rows(void *data, int y0, int y1, int thread)
{
	(void)thread;
	const work *w = data;
	for (int y = y0; y < y1 && !bands_stopped(w->f->bands); y++) {
		uint8_t *what = row_of(w, w->d->value, y);
		memset(what, LIGHT, (size_t)w->f->width);
		for (int x = 0, end; x < w->f->width; x = end) {
			int most = w->f->width - x > TONE_CHUNK ? x + TONE_CHUNK : w->f->width;
			const encre_params *p = style_run(w->f, y, x, most, &end);
			if (p->use_tones)
				look_at_run(w, p, y, x, end - x, what + x);
		}
	}
}

/* How far what is sought is along the column, or one more than anyone looks. */
static void column_rows(void *data, int y0, int y1, int thread)
{
	(void)thread;
	const work *w = data;
	int width = w->f->width;
	for (int y = y0; y < y1 && !bands_stopped(w->f->bands); y++) {
		uint8_t *restrict far = row_of(w, w->d->scratch, y);
		memset(far, w->reach + 1, (size_t)width);
		for (int v = tone_within(y - w->reach, w->f->height); v <= y + w->reach && v < w->f->height; v++) {
			const uint8_t *restrict from = w->plane + (ptrdiff_t)v * width;
			uint8_t own = (uint8_t)(v < y ? y - v : v - y), sought = w->sought, other = w->other;
			for (int i = 0; i < width; i++) {
				uint8_t here = (from[i] == sought) != other ? own : UINT8_MAX;
				far[i] = here < far[i] ? here : far[i];
			}
		}
	}
}

/* Whether what was sought is so near. */
static bool is_near(const work *w, int x, int y, float radius)
{
	const uint8_t *far = row_of(w, w->d->scratch, y);
	int reach = (int)radius, last = x + reach < w->f->width ? x + reach : w->f->width - 1;
	for (int u = tone_within(x - reach, w->f->width); u <= last; u++)
		if ((float)((u - x) * (u - x) + far[u] * far[u]) <= radius * radius)
			return true;
	return false;
}

static void core_rows(void *data, int y0, int y1, int thread)
{
	(void)thread;
	const work *w = data;
	for (int y = y0; y < y1 && !bands_stopped(w->f->bands); y++) {
		const uint8_t *what = row_of(w, w->d->value, y);
		uint8_t *sure = row_of(w, w->d->thin, y), *core = row_of(w, w->d->light, y);
		for (int x = 0; x < w->f->width; x++) {
			float radius = radius_of(w, x, y);
			bool screen = what[x] == SCREEN;
			core[x] = screen && !is_near(w, x, y, narrow * radius) ? CORE : 0;
			sure[x] = core[x] && !is_near(w, x, y, wide * radius) ? CORE : 0;
		}
	}
}

static void room_rows(void *data, int y0, int y1, int thread)
{
	(void)thread;
	const work *w = data;
	for (int y = y0; y < y1 && !bands_stopped(w->f->bands); y++) {
		const uint8_t *what = row_of(w, w->d->value, y);
		uint8_t *room = row_of(w, w->d->room, y);
		for (int x = 0; x < w->f->width; x++) {
			bool fits = what[x] == SCREEN && is_near(w, x, y, narrow * radius_of(w, x, y));
			room[x] = fits ? MAYBE : what[x] == SCREEN ? TONE_NO_ROOM : TONE_ROOM;
		}
	}
}

/* What is neither wide nor narrow is as what it hangs together with is, if that is wide: else dots would come and go
 * along a shadow. */
static int32_t join(const work *w)
{
	int width = w->f->width, height = w->f->height;
	size_t pixels = (size_t)width * (size_t)height, count = 0;
	uint8_t *room = w->d->room;
	uint32_t *open = late_take(w->late, pixels, sizeof *open);
	if (!open)
		return ENCRE_ERROR_MEMORY;
	for (size_t i = 0; i < pixels; i++)
		if (w->d->thin[i] && room[i] == MAYBE) {
			room[i] = TONE_ROOM;
			open[count++] = (uint32_t)i;
		}
	while (count) {
		uint32_t i = open[--count], x = i % (uint32_t)width;
		const ptrdiff_t to[] = {x > 0 ? -1 : 0, x + 1 < (uint32_t)width ? 1 : 0,
					i >= (uint32_t)width ? -width : 0, i + (size_t)width < pixels ? width : 0};
		for (int k = 0; k < 4; k++)
			if (room[i + to[k]] == MAYBE) {
				room[i + to[k]] = TONE_ROOM;
				open[count++] = (uint32_t)(i + to[k]);
			}
	}
	late_drop(w->late, open);
	return ENCRE_OK;
}

/* Whether a fine dark thing is there: in a tone it is ink. */
static bool is_detail(const work *w, int x, int y)
{
	return w->d->keep && row_of(w, w->d->dark, y)[x];
}

/* Between letters and beside eyes what has no room is paper, or would underline them. */
static void cleared_rows(void *data, int y0, int y1, int thread)
{
	(void)thread;
	const work *w = data;
	for (int y = y0; y < y1 && !bands_stopped(w->f->bands); y++) {
		uint8_t *room = row_of(w, w->d->room, y);
		for (int x = 0; x < w->f->width; x++)
			if ((room[x] == MAYBE || room[x] == TONE_NO_ROOM) && !is_detail(w, x, y) &&
			    is_near(w, x, y, radius_of(w, x, y)))
				room[x] = TONE_BESIDE_INK;
	}
}

static void light_rows(void *data, int y0, int y1, int thread)
{
	(void)thread;
	const work *w = data;
	for (int y = y0; y < y1 && !bands_stopped(w->f->bands); y++) {
		uint8_t *room = row_of(w, w->d->room, y);
		for (int x = 0; x < w->f->width; x++)
			if (room[x] == MAYBE || room[x] == TONE_NO_ROOM) {
				bool ink = is_detail(w, x, y) || is_near(w, x, y, beside * radius_of(w, x, y));
				room[x] = ink ? TONE_NO_ROOM : TONE_BESIDE_INK;
			}
	}
}

static int32_t seek(work *w, const uint8_t *plane, int sought, bool other, bands_kernel kernel)
{
	w->plane = plane;
	w->sought = (uint8_t)sought;
	w->other = other;
	int32_t code = bands_run(w->f->bands, w->f->height, 0, column_rows, w);
	return code ? code : bands_run(w->f->bands, w->f->height, 0, kernel, w);
}

int32_t ISA(tone_room_run)(frame *f, const tone_detail *d, const tone_style *styles)
{
	work w = {.f = f, .d = d, .styles = styles, .late = &f->late};
	float most = 0;
	for (int i = 0; i < f->n_styles; i++)
		most = max(most, f->params[i].use_tones ? styles[i].room : 0);
	w.reach = (int)(beside * most) + 1;
	int32_t code = bands_run(f->bands, f->height, 0, look_at_rows, &w);
	code = code ? code : seek(&w, d->value, SCREEN, true, core_rows);
	code = code ? code : seek(&w, d->light, CORE, false, room_rows);
	code = code ? code : join(&w);
	if (!code && d->keep)
		code = seek(&w, d->value, CLEARED, false, cleared_rows);
	return code ? code : seek(&w, d->value, LIGHT, false, light_rows);
}
