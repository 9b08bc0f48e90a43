/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Where a screen has no room: a thing in a screen that is narrower than `tone_least` pitches would be a row of dots. It
 * is ink, or beside ink, as between bars and inside letters, paper. With the room dots grow to ink, or shrink to paper,
 * so that nothing jumps as the camera moves. A shadow on a surface that goes on beside it stays a screen until it is no
 * wider than a line, or cheeks and noses would have black scars. */
#include "tones/tones.h"

#include <string.h>

enum { LIGHT, SCREEN, APART, CLEARED };   /* what pixels are; APART: ink; CLEARED: kept clear of tones */
enum { AT_LIGHT, AT_DARK, WITHIN, ENDS }; /* ends of a screen; WITHIN: of both kinds, on one surface */
enum { ALL = 255 };                       /* of the room that a screen wants */
static const uint32_t NONE = UINT32_MAX;

/* Of the least width: what is narrower has no room, what is wider has all, and between it has some. */
static const float narrow = 0.7f, wide = 1.4f;
/* What is by a quarter of that wider than narrow lets all through. */
enum { necks = 4 };
/* Of half the least width: what is beside so far counts for a narrow piece. */
static const float beside = 2;
/* Of the least width: a line that the light draws is half as wide as narrow; from three quarters on it is none. */
static const float fine[] = {0.5f * 0.7f, 0.75f * 0.7f};
static const float same_depth = 0.005f; /* of the depth: from a pixel to the next of one surface */

typedef struct work {
	const frame *f;
	const tone_detail *d;
	const tone_style *styles;
	late **late;
	int reach;           /* pixels that any pixel looks as far as */
	uint8_t *ends[ENDS]; /* how many pixels end a screen, of those along the row */
} work;

static uint8_t *row_of(const work *w, uint8_t *plane, int y)
{
	return plane + (ptrdiff_t)y * w->f->width;
}

/* The end of a run of pixels from x on that are told together, and half of how wide a screen is at least there. */
static float radius_of_run(const work *w, int y, int x, int *end)
{
	int most = w->f->width - x > TONE_TOGETHER ? x + TONE_TOGETHER : w->f->width;
	return w->styles[style_run(w->f, y, x, most, end) - w->f->params].room;
}

static bool wants_room(const tone_slot *s)
{
	return tone_is_screen(s) && s->space != tone_1_space_OBJECT;
}

float ISA(tone_room)(const encre_params *p, const tone_style *style)
{
	float pitch = 0;
	for (int k = 0; k < TONE_SLOTS; k++)
		if (wants_room(style->slot + k))
			pitch = max(pitch, style->slot[k].pitch);
	return min(0.5f * p->tone_least * pitch, TONE_ROOM_MOST);
}

static void look_at_run(const work *w, const encre_params *p, int y, int x, int n, uint8_t *what)
{
	const tone_slot *slots = w->styles[p - w->f->params].slot;
	const uint8_t *keep = w->d->keep ? row_of(w, w->d->keep, y) + x : NULL;
	const uint8_t *ease = w->d->keep ? row_of(w, w->d->ease, y) + x : NULL;
	float screens[TONE_CHUNK] = {0}, solid[TONE_CHUNK] = {0};
	tone_wanted wanted;
	ISA(tone_want)(w->f, p, slots, y, x, n, &wanted);
	for (int k = 0; k < TONE_SLOTS; k++) {
		float *sum = wants_room(slots + k) ? screens : slots[k].kind == tone_1_SOLID ? solid : NULL;
		for (int i = 0; sum && wanted.any[k] && i < n; i++)
			sum[i] += wanted.dark[k][i] > 0 ? wanted.share[k][i] : 0;
	}
	for (int i = 0; i < n; i++) {
		int clear = keep && (keep[i] < 128 || ease[i] < 128), other = screens[i] > 0.5f ? SCREEN : LIGHT;
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

/* How far the end of a screen is along the column, or one more than anyone looks. */
static void column_rows(void *data, int y0, int y1, int thread)
{
	(void)thread;
	const work *w = data;
	int width = w->f->width;
	for (int y = y0; y < y1 && !bands_stopped(w->f->bands); y++) {
		uint8_t *restrict far = row_of(w, w->d->scratch, y);
		memset(far, w->reach + 1, (size_t)width);
		for (int v = tone_within(y - w->reach, w->f->height); v <= y + w->reach && v < w->f->height; v++) {
			const uint8_t *restrict from = row_of(w, w->d->value, v);
			uint8_t own = (uint8_t)(v < y ? y - v : v - y);
			for (int i = 0; i < width; i++) {
				uint8_t here = from[i] == SCREEN ? UINT8_MAX : own;
				far[i] = here < far[i] ? here : far[i];
			}
		}
	}
}

/* The squares of how far away the nearest end is, as far as `radius`; else more than that of it. */
static void nearest_row(const work *w, int y, int x, int n, float radius, uint16_t *restrict least)
{
	const uint8_t *far = row_of(w, w->d->scratch, y);
	int reach = (int)radius;
	for (int i = 0; i < n; i++)
		least[i] = (uint16_t)((reach + 1) * (reach + 1));
	for (int aside = -reach; aside <= reach; aside++) {
		const uint8_t *restrict there = far + x;
		int from = x + aside < 0 ? -x - aside : 0, end = w->f->width - x - aside;
		end = end < n ? end : n;
		for (int i = from; i < end; i++) {
			uint16_t square = (uint16_t)(aside * aside + there[i + aside] * there[i + aside]);
			least[i] = square < least[i] ? square : least[i];
		}
	}
}

/* How far pixels of a screen are from its end: 255ths of half of the width that is enough. */
static void depth_rows(void *data, int y0, int y1, int thread)
{
	(void)thread;
	const work *w = data;
	for (int y = y0; y < y1 && !bands_stopped(w->f->bands); y++) {
		const uint8_t *what = row_of(w, w->d->value, y);
		uint8_t *depth = row_of(w, w->d->raw, y);
		memset(depth, 0, (size_t)w->f->width);
		for (int x = 0, end; x < w->f->width; x = end) {
			uint16_t square[TONE_TOGETHER] = {0};
			float enough = wide * radius_of_run(w, y, x, &end);
			if (!memchr(what + x, SCREEN, (size_t)(end - x)))
				continue;
			nearest_row(w, y, x, end - x, enough, square);
			for (int i = x; i < end; i++) {
				float part = min(sqrtf(square[i - x]) / max(enough, FLT_MIN), 1);
				depth[i] = (uint8_t)(int)(what[i] == SCREEN ? 255 * part + 0.5f : 0);
			}
		}
	}
}

/* How wide a piece is, at its middle: 0 where it is narrow, 255 where it is wide. Of four pixels the mean, or pieces of
 * seven pixels would be as wide as of eight. */
static void width_rows(void *data, int y0, int y1, int thread)
{
	(void)thread;
	const work *w = data;
	for (int y = y0; y < y1 && !bands_stopped(w->f->bands); y++) {
		const uint8_t *rows[3];
		for (int k = 0; k < 3; k++)
			rows[k] = row_of(w, w->d->raw, tone_within(y + k - 1, w->f->height));
		for (int x = 0; x < w->f->width; x++) {
			int before = tone_within(x - 1, w->f->width), after = tone_within(x + 1, w->f->width), most = 0;
			for (int k = 0; k < 2; k++) {
				const uint8_t *above = rows[k], *below = rows[k + 1];
				int own = above[x] + below[x], left = own + above[before] + below[before];
				int right = own + above[after] + below[after];
				most = left > most ? left : most;
				most = right > most ? right : most;
			}
			most = rows[1][x] ? most : 0;
			row_of(w, w->d->light, y)[x] = (uint8_t)(most > 2 * 255 ? (most - 2 * 255 + 1) / 2 : 0);
		}
	}
}

static void greater_of(int n, const uint8_t *restrict a, const uint8_t *restrict b, uint8_t *restrict to)
{
	for (int i = 0; i < n; i++)
		to[i] = a[i] > b[i] ? a[i] : b[i];
}

/* The most of what is near enough to be of the same piece: in a disc, row by row. In a row it is the most of two spans,
 * each a power of 2 long, from both ends; and that of a span the most of its halves. */
static void widest_row(const work *w, uint8_t *plane, int y, int x, int n, float radius, uint8_t *most)
{
	int reach = (int)radius;
	for (int v = tone_within(y - reach, w->f->height); v <= y + reach && v < w->f->height; v++) {
		uint8_t lines[2][TONE_TOGETHER + 2 * TONE_ROOM_MOST] = {{0}}, *line = lines[0], *other = lines[1];
		int half = reach, span = 1;
		while ((float)(half * half + (v - y) * (v - y)) > radius * radius)
			half--;
		int from = tone_within(x - half, w->f->width), end = x + n + half;
		end = end < w->f->width ? end : w->f->width;
		memcpy(line + (from - x + half), row_of(w, plane, v) + from, (size_t)(end - from));
		for (int all = n + 2 * half; 2 * span <= 2 * half + 1; span *= 2) {
			uint8_t *longer = other;
			all -= span;
			greater_of(all, line, line + span, longer);
			other = line;
			line = longer;
		}
		greater_of(n, line, line + (2 * half + 1 - span), other);
		for (int i = 0; i < n; i++)
			most[i] = other[i] > most[i] ? other[i] : most[i];
	}
}

static void room_rows(void *data, int y0, int y1, int thread)
{
	(void)thread;
	const work *w = data;
	for (int y = y0; y < y1 && !bands_stopped(w->f->bands); y++) {
		const uint8_t *what = row_of(w, w->d->value, y);
		uint8_t *room = row_of(w, w->d->room, y);
		for (int x = 0, end; x < w->f->width; x = end) {
			float radius = narrow * radius_of_run(w, y, x, &end);
			uint8_t least = ALL;
			memcpy(room + x, row_of(w, w->d->light, y) + x, (size_t)(end - x));
			for (int i = x; i < end; i++)
				least = what[i] == SCREEN && room[i] < least ? room[i] : least;
			if (least < ALL)
				widest_row(w, w->d->light, y, x, end - x, radius, room + x);
			for (int i = x; i < end; i++)
				room[i] = what[i] == SCREEN ? room[i] : ALL;
		}
	}
}

/* Pixels by how much room they have, and the next of the same. */
typedef struct heap {
	uint32_t first[ALL + 1], *next; /* NONE ends a list */
} heap;

static void put(heap *h, uint8_t level, uint32_t i)
{
	h->next[i] = h->first[level];
	h->first[level] = i;
}

/* So much of the room of a piece as is there goes through a neck; and what tapers off keeps some of it for a while. */
static uint8_t through(const work *w, uint8_t neck, int room)
{
	int most = neck > ALL / necks ? ALL : necks * neck, left = room - ALL / w->reach;
	most = most < room ? most : room;
	return (uint8_t)(most > left ? most : left);
}

/* A piece is as what it hangs together with is, by the way with the widest necks, or dots would come and go along a
 * shadow. Those with most room go first, so each pixel gets more but once. */
static void spread(const work *w, heap *own, heap *got)
{
	uint32_t width = (uint32_t)w->f->width, pixels = width * (uint32_t)w->f->height;
	uint8_t *room = w->d->room, *neck = w->d->thin;
	memcpy(neck, room, pixels);
	for (uint32_t i = 0; i < pixels; i++)
		if (w->d->value[i] == SCREEN && room[i])
			put(own, room[i], i);
	for (int level = ALL; level > 0; level--)
		for (int k = 0; k < 2; k++)
			for (heap *h = k ? got : own; h->first[level] != NONE;) {
				uint32_t i = h->first[level], x = i % width;
				h->first[level] = h->next[i];
				if (room[i] != level)
					continue; /* has got more */
				const uint32_t to[] = {x > 0 ? i - 1 : i, x + 1 < width ? i + 1 : i,
						       i >= width ? i - width : i, i + width < pixels ? i + width : i};
				for (int n = 0; n < 4; n++) {
					uint8_t more = through(w, neck[to[n]], level);
					if (w->d->value[to[n]] != SCREEN || more <= room[to[n]])
						continue;
					room[to[n]] = more;
					put(got, more, to[n]);
				}
			}
}

static int32_t join(const work *w)
{
	size_t pixels = (size_t)w->f->width * (size_t)w->f->height;
	heap own, got;
	memset(own.first, 0xff, sizeof own.first);
	memset(got.first, 0xff, sizeof got.first);
	own.next = late_take(w->late, pixels, sizeof *own.next);
	got.next = own.next ? late_take(w->late, pixels, sizeof *got.next) : NULL;
	if (got.next)
		spread(w, &own, &got);
	if (got.next)
		late_drop(w->late, got.next);
	if (own.next)
		late_drop(w->late, own.next);
	return got.next ? ENCRE_OK : ENCRE_ERROR_MEMORY;
}

/* Whether the same surface goes on from a pixel to one beside it. */
static bool goes_on(const work *w, int x, int y, int u, int v)
{
	const float *one = layer_row(w->f, ENCRE_LAYER_OBJECT, y), *other = layer_row(w->f, ENCRE_LAYER_OBJECT, v);
	float a = depth_at(w->f, x, y), b = depth_at(w->f, u, v);
	return (one && one[x] == other[u]) || fabsf(a - b) <= same_depth * min(a, b);
}

/* A piece without room is told from what it lies beside: ink beside light, and paper beside ink and what is clear. */
static void ends_rows(void *data, int y0, int y1, int thread)
{
	(void)thread;
	const work *w = data;
	int width = w->f->width, height = w->f->height;
	for (int y = y0; y < y1 && !bands_stopped(w->f->bands); y++) {
		uint8_t *ends[ENDS];
		const uint8_t *what = row_of(w, w->d->value, y);
		for (int k = 0; k < ENDS; k++) {
			ends[k] = row_of(w, w->ends[k], y);
			memset(ends[k], 0, (size_t)width);
		}
		for (int x = 0; x < width; x++)
			for (int k = 0; what[x] == SCREEN && k < 4; k++) {
				int u = tone_within(x + (k == 1) - (k == 0), width);
				int v = tone_within(y + (k == 3) - (k == 2), height);
				int other = row_of(w, w->d->value, v)[u];
				if (other == SCREEN)
					continue;
				ends[other == LIGHT ? AT_LIGHT : AT_DARK][x] = 1;
				ends[WITHIN][x] |= other != CLEARED && goes_on(w, x, y, u, v);
			}
	}
}

/* The sum of so many pixels to both sides of each. */
static void sum_along(int n, int reach, const uint8_t *restrict from, uint8_t *restrict to)
{
	int sum = 0;
	for (int x = -reach; x < n; x++) {
		sum += x + reach < n ? from[x + reach] : 0;
		sum -= x - reach > 0 ? from[x - reach - 1] : 0;
		if (x >= 0)
			to[x] = (uint8_t)sum;
	}
}

static void along_rows(void *data, int y0, int y1, int thread)
{
	(void)thread;
	const work *w = data;
	for (int y = y0; y < y1 && !bands_stopped(w->f->bands); y++)
		for (int k = 0; k < ENDS; k++) {
			uint8_t *own = row_of(w, w->ends[k], y), *copy = row_of(w, w->d->scratch, y);
			memcpy(copy, own, (size_t)w->f->width);
			sum_along(w->f->width, w->reach, copy, own);
		}
}

/* The sums of n pixels down their columns. */
static void sum_down(const work *w, const uint8_t *plane, int y, int x, int n, uint16_t *restrict sum)
{
	memset(sum, 0, (size_t)n * sizeof *sum);
	for (int v = tone_within(y - w->reach, w->f->height); v <= y + w->reach && v < w->f->height; v++) {
		const uint8_t *restrict from = plane + (ptrdiff_t)v * w->f->width + x;
		for (int i = 0; i < n; i++)
			sum[i] = (uint16_t)(sum[i] + from[i]);
	}
}

/* Whether a fine dark thing is there: in a tone it is ink. */
static bool is_detail(const work *w, int x, int y)
{
	return w->d->keep && row_of(w, w->d->dark, y)[x] && row_of(w, w->d->sure[1], y)[x] > 127;
}

/* Nearly all or nothing: in between narrow pieces would be beads. */
static float most_of(float share)
{
	return clamp01(8 * share - 5);
}

static void aim_rows(void *data, int y0, int y1, int thread)
{
	(void)thread;
	const work *w = data;
	for (int y = y0; y < y1 && !bands_stopped(w->f->bands); y++) {
		uint8_t *room = row_of(w, w->d->room, y), *aim = row_of(w, w->d->aim, y);
		memset(aim, 0, (size_t)w->f->width);
		for (int x = 0, end; x < w->f->width; x = end) {
			uint16_t sum[ENDS][TONE_TOGETHER];
			uint8_t least = ALL, widest[TONE_TOGETHER] = {0};
			float radius = radius_of_run(w, y, x, &end);
			for (int i = x; i < end; i++)
				least = room[i] < least ? room[i] : least;
			if (least == ALL)
				continue;
			for (int k = 0; k < ENDS; k++)
				sum_down(w, w->ends[k], y, x, end - x, sum[k]);
			widest_row(w, w->d->raw, y, x, end - x, narrow * radius, widest);
			for (int i = 0; i < end - x; i++) {
				float light = sum[AT_LIGHT][i], all = max(light + (float)sum[AT_DARK][i], 1);
				float half = (float)widest[i] * wide / ALL, left = (float)room[x + i] / ALL;
				float line = clamp01((fine[1] - half) / (fine[1] - fine[0]));
				float less = (1 - left) * mix(1, line, clamp01(4 * (float)sum[WITHIN][i] / all - 2));
				float ink = is_detail(w, x + i, y) ? 1 : most_of(light / all);
				aim[x + i] = (uint8_t)(int)(ALL * ink * less + 0.5f);
				room[x + i] = (uint8_t)(int)(ALL * (1 - less) + 0.5f);
			}
		}
	}
}

int32_t ISA(tone_room_run)(frame *f, const tone_detail *d, const tone_style *styles)
{
	work w = {.f = f, .d = d, .styles = styles, .late = &f->late, .ends = {d->light, d->thin, d->sure[0]}};
	float most = 0;
	for (int i = 0; i < f->n_styles; i++)
		most = max(most, f->params[i].use_tones ? styles[i].room : 0);
	w.reach = (int)(beside * most) + 1;
	int32_t code = bands_run(f->bands, f->height, 0, look_at_rows, &w);
	code = code ? code : bands_run(f->bands, f->height, 0, column_rows, &w);
	code = code ? code : bands_run(f->bands, f->height, 0, depth_rows, &w);
	code = code ? code : bands_run(f->bands, f->height, 0, width_rows, &w);
	code = code ? code : bands_run(f->bands, f->height, 0, room_rows, &w);
	code = code ? code : join(&w);
	code = code ? code : bands_run(f->bands, f->height, 0, ends_rows, &w);
	code = code ? code : bands_run(f->bands, f->height, 0, along_rows, &w);
	return code ? code : bands_run(f->bands, f->height, 0, aim_rows, &w);
}
