/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What is clear as a whole: a letter or none of it, the letters of a word all one way though one stroke is a little
 * wider than the next, and small grounds, faces and pages, of which details leave no more than patches to tones. */
#include "tones/words.h"

#include <stdlib.h>
#include <string.h>

/* What pixels are in `raw`: nothing asked, or open to what spreads, and told no more; above, to so many 254ths what was
 * asked of what is alike and hangs together with them. */
enum { NOTHING, OPEN, ALL = 255 };

static const float same_depth = 0.005f;  /* of the depth: from a pixel to the next of one thing */
static const int alike = 20;             /* 0.08 * 255: from a pixel to the next of one colour */
static const uint8_t filled = 88;        /* contrast of what is fine because most of its thing is: it counts in full */
static const size_t many = 3, some = 10; /* one in so many pixels */
static const float small = 7; /* as wide as so many strokes: a face in which dots would be as large as eyes */

/* So many reaches about a dark pixel its ground is looked for, in so many rows of so many places. */
enum { reaches = 3, looks = 13 };
static const int least_contrast = 76; /* 0.3 * 255 */

/* Whether the same thing goes on from a pixel to its neighbour. */
static bool goes_on(const frame *f, spot s, spot t)
{
	float a = depth_at(f, s.x, s.y), b = depth_at(f, t.x, t.y);
	return fabsf(a - b) <= same_depth * min(a, b);
}

static bool is_alike(const work *w, spot s, spot t)
{
	const float *one = layer_row(w->f, ENCRE_LAYER_OBJECT, s.y), *other = layer_row(w->f, ENCRE_LAYER_OBJECT, t.y);
	int step = w->d->value[s.i] - w->d->value[t.i];
	return step <= alike && step >= -alike && (!one || one[s.x] == other[t.x]) && goes_on(w->f, s, t);
}

/* What is alike and hangs together with a pixel, into `open`; returns how many pixels. */
static size_t gather(const work *w, size_t from)
{
	uint8_t *state = w->d->raw;
	size_t count = 1;
	spot to[4];
	w->open[0] = (uint32_t)from;
	state[from] = OPEN;
	for (size_t k = 0; k < count; k++) {
		spot s = spot_of(w, w->open[k]);
		for (int n = beside(w, s, to) - 1; n >= 0; n--)
			if (state[to[n].i] == NOTHING && is_alike(w, s, to[n])) {
				state[to[n].i] = OPEN;
				w->open[count++] = (uint32_t)to[n].i;
			}
	}
	return count;
}

/* What to tell of `count` pixels that hang together, so many of which are marked, by such a sum of 255ths. */
typedef uint8_t (*judge)(const work *w, size_t count, size_t marked, size_t sum);

static uint8_t level(float share)
{
	return (uint8_t)(OPEN + (int)((ALL - OPEN) * share + 0.5f));
}

static float share_of_level(uint8_t level)
{
	return level > OPEN ? (float)(level - OPEN) * (1.0f / (ALL - OPEN)) : 0;
}

/* By and by, from a quarter of it on: what is seen behind a rail changes as the camera moves, and so does how
 * much of the rail stands out from it. */
static uint8_t letter(const work *w, size_t count, size_t marked, size_t sum)
{
	(void)w;
	(void)sum;
	return level(clamp01(6 * (float)marked / (float)count - 1.5f));
}

/* What is asked is half of it: it comes by and by. */
static float most_of(float share)
{
	return clamp01(4 * share - 3.5f);
}

/* How far margins leave no more than patches of it: OPEN where they do not, 255 where wholly. */
static uint8_t ground(const work *w, size_t count, size_t marked, size_t sum)
{
	(void)marked;
	float share = (float)sum / (255 * (float)count), wide = small * (float)(2 * w->d->reach + 1);
	float patch = most_of((float)some * share) * most_of(wide * wide / (float)count);
	return level(max(most_of((float)many * share), patch));
}

/* What is to be told of what marked pixels hang together with. */
static void survey(const work *w, const uint8_t *marks, judge told)
{
	uint8_t *state = w->d->raw;
	memset(state, NOTHING, pixels_of(w));
	for (size_t i = 0; i < pixels_of(w); i++) {
		if (!marks[i] || state[i] != NOTHING)
			continue;
		size_t count = gather(w, i), marked = 0, sum = 0;
		for (size_t k = 0; k < count; k++) {
			marked += marks[w->open[k]] != 0;
			sum += marks[w->open[k]];
		}
		uint8_t own = told(w, count, marked, sum);
		for (size_t k = 0; k < count; k++)
			state[w->open[k]] = own;
	}
}

/* What a detail's rim, which shows two things, belongs to: the pixel about it that stands out most. */
static size_t stands_out(const work *w, int x, int y)
{
	size_t own = (size_t)y * (size_t)w->f->width + (size_t)x, best = own;
	const uint8_t *value = w->d->value;
	for (int k = 0; k < 9; k++) {
		int v = tone_within(y + k / 3 - 1, w->f->height), u = tone_within(x + k % 3 - 1, w->f->width);
		size_t i = (size_t)v * (size_t)w->f->width + (size_t)u;
		if (w->dark ? value[i] < value[best] : value[i] > value[best])
			best = i;
	}
	int more = value[best] - value[own];
	return more > alike || more < -alike ? best : own;
}

/* Slits between letters, where what these lie on is seen, are not fine. Where strokes of a letter meet, it is. */
static void whole_rows(void *data, int y0, int y1, int thread)
{
	(void)thread;
	const work *w = data;
	const uint8_t *own = details(w), *state = w->d->raw;
	for (int y = y0; y < y1 && !bands_stopped(w->f->bands); y++)
		for (int x = 0; x < w->f->width; x++) {
			size_t i = (size_t)y * (size_t)w->f->width + (size_t)x, at = own[i] ? stands_out(w, x, y) : i;
			float whole = share_of_level(state[at]);
			uint8_t *sure = w->d->sure[w->dark] + i;
			w->d->scratch[i] = own[i] && whole > 0 ? own[i] : whole >= 1 ? filled : 0;
			*sure = (uint8_t)(int)((float)*sure * whole + 0.5f);
			if (!w->dark && state[i] == OPEN)
				w->d->light[i] = 0;
		}
}

/* Takes details from `scratch`, and leaves there what is within the gap along the row. */
static void along_rows(void *data, int y0, int y1, int thread)
{
	(void)thread;
	const work *w = data;
	int width = w->f->width;
	for (int y = y0; y < y1 && !bands_stopped(w->f->bands); y++) {
		uint8_t *own = row_of(w, details(w), y), *to = row_of(w, w->d->scratch, y);
		int last = -w->gap - 1;
		memcpy(own, to, (size_t)width);
		for (int x = 0; x < width; x++) {
			last = own[x] ? x : last;
			to[x] = x - last <= w->gap ? OPEN : NOTHING;
		}
		last = width + w->gap;
		for (int x = width - 1; x >= 0; x--) {
			last = own[x] ? x : last;
			to[x] |= last - x <= w->gap ? OPEN : NOTHING;
		}
	}
}

static void down_rows(void *data, int y0, int y1, int thread)
{
	(void)thread;
	const work *w = data;
	int width = w->f->width, height = w->f->height;
	for (int y = y0; y < y1 && !bands_stopped(w->f->bands); y++) {
		uint8_t *restrict to = row_of(w, w->d->raw, y);
		memset(to, NOTHING, (size_t)width);
		for (int v = tone_within(y - w->gap, height); v <= y + w->gap && v < height; v++) {
			const uint8_t *restrict from = row_of(w, w->d->scratch, v);
			for (int i = 0; i < width; i++)
				to[i] |= from[i];
		}
	}
}

static void spread(const work *w)
{
	uint8_t *state = w->d->raw, *sure = w->d->sure[w->dark];
	if (!w->dark)
		memset(w->d->flat, 0, pixels_of(w));
	for (size_t i = 0; i < pixels_of(w); i++) {
		if (!details(w)[i]) {
			sure[i] = 0;
			continue;
		}
		if (state[i] != OPEN)
			continue;
		size_t count = 1;
		w->open[0] = (uint32_t)i;
		state[i] = NOTHING;
		for (size_t k = 0; k < count; k++) {
			spot s = spot_of(w, w->open[k]), to[4];
			for (int n = beside(w, s, to) - 1; n >= 0; n--)
				if (state[to[n].i] == OPEN && goes_on(w->f, s, to[n])) {
					state[to[n].i] = NOTHING;
					w->open[count++] = (uint32_t)to[n].i;
				}
		}
		uint8_t all = ISA(word_sureness)(w, sure, count), lines = w->dark ? 0 : ISA(word_strokes)(w, count);
		uint8_t flat = w->dark || !w->d->prints ? 0 : ISA(word_flatness)(w, count);
		for (size_t k = 0; k < count; k++)
			if (details(w)[w->open[k]]) {
				w->d->print[w->open[k]] = lines;
				if (!w->dark)
					w->d->flat[w->open[k]] = flat;
				sure[w->open[k]] = all;
				details(w)[w->open[k]] = all ? details(w)[w->open[k]] : 0;
			}
	}
}

/* Of what is fine that remains which is whole, and hangs together with what surely is. Of light things `print` gets how
 * surely they are strokes. */
static int32_t choose(work *w, bool dark)
{
	bands *pool = w->f->bands;
	w->dark = dark;
	survey(w, details(w), letter);
	int32_t code = bands_run(pool, w->f->height, 0, whole_rows, w);
	code = code ? code : bands_run(pool, w->f->height, 0, along_rows, w);
	code = code ? code : bands_run(pool, w->f->height, 0, down_rows, w);
	if (!code)
		spread(w);
	return code;
}

int32_t ISA(tone_words_run)(frame *f, const tone_detail *d)
{
	work w = {.f = f, .d = d, .gap = 2 * d->reach + 1};
	w.open = late_take(&f->late, pixels_of(&w), sizeof *w.open);
	if (!w.open)
		return ENCRE_ERROR_MEMORY;
	int32_t code = choose(&w, false);
	code = code ? code : choose(&w, true);
	late_drop(&f->late, w.open);
	return code;
}

static void ground_rows(void *data, int y0, int y1, int thread)
{
	(void)thread;
	const work *w = data;
	for (int y = y0; y < y1 && !bands_stopped(w->f->bands); y++)
		for (int x = 0; x < w->f->width; x++) {
			spot s = {x, y, (size_t)y * (size_t)w->f->width + (size_t)x}, to[4];
			const uint8_t *state = w->d->raw, *value = w->d->value;
			int most = state[s.i];
			for (int n = beside(w, s, to) - 1; n >= 0; n--) { /* its rim shows it, too */
				int step = value[s.i] - value[to[n].i], own = state[to[n].i];
				most = step <= 2 * alike && step >= -2 * alike && own > most ? own : most;
			}
			bool lighter = value[s.i] > least_contrast; /* than anything: else no dark thing lies on it */
			w->d->ease[s.i] = (uint8_t)(most > OPEN && lighter ? 255 - most : 255);
		}
}

/* Whether one may lie on the other, on ground however steep: what is seen past a post is not what it lies on. */
static bool is_on(const frame *f, spot s, spot t)
{
	float a = depth_at(f, s.x, s.y), b = depth_at(f, t.x, t.y), away = max(abs(t.x - s.x), abs(t.y - s.y));
	return fabsf(a - b) <= same_depth * away * min(a, b);
}

/* Whether what a pixel of a dark detail lies on is lighter than it, of a light one darker: of what is about it details
 * of its kind are not the ground, nor, for they lie on it as well, those of the other. */
static bool lies_on(const work *w, spot s)
{
	const tone_detail *d = w->d;
	const uint8_t *own = details(w), *others = w->dark ? d->thin : d->dark;
	int apart = 0, sign = w->dark ? 1 : -1;
	for (int k = 0; k < looks * looks; k++) {
		int v = s.y + reaches * d->reach * (k / looks - looks / 2) / (looks / 2);
		int u = s.x + reaches * d->reach * (k % looks - looks / 2) / (looks / 2);
		v = tone_within(v, w->f->height);
		u = tone_within(u, w->f->width);
		size_t i = (size_t)v * (size_t)w->f->width + (size_t)u;
		bool more = sign * (d->value[i] - d->value[s.i]) > alike && !others[i];
		apart += own[i] || !is_on(w->f, s, (spot){u, v, i}) ? 0 : more ? 1 : -1;
	}
	return apart > 0;
}

static void print_rows(void *data, int y0, int y1, int thread)
{
	(void)thread;
	const work *w = data;
	for (int y = y0; y < y1 && !bands_stopped(w->f->bands); y++)
		for (int x = 0; x < w->f->width; x++) {
			spot s = {x, y, (size_t)y * (size_t)w->f->width + (size_t)x};
			w->d->scratch[s.i] = details(w)[s.i] && lies_on(w, s);
		}
}

/* The ground between light letters, and their holes, are no print. */
static void print_of_rows(void *data, int y0, int y1, int thread)
{
	(void)thread;
	const work *w = data;
	size_t width = (size_t)w->f->width;
	uint8_t *to = w->dark ? w->d->print : w->d->sure[0];
	for (size_t i = (size_t)y0 * width; i < (size_t)y1 * width; i++) {
		float own = (float)w->d->sure[w->dark][i] * (1.0f / 255) * share_of_level(w->d->raw[i]);
		float lines = w->dark ? 1 : (float)w->d->print[i] * (1.0f / 255);
		to[i] = (uint8_t)(int)(details(w)[i] ? 255 * own * lines + 0.5f : 0);
	}
}

static int32_t find_print(work *w, bool dark)
{
	bands *pool = w->f->bands;
	w->dark = dark;
	int32_t code = bands_run(pool, w->f->height, 0, print_rows, w);
	if (!code)
		survey(w, w->d->scratch, letter);
	return code ? code : bands_run(pool, w->f->height, 0, print_of_rows, w);
}

/* Grounds that details' margins, in `scratch`, leave little of are clear. Leaves for strokes and spots what is
 * print in `print`, of light things in sure[0]. */
int32_t ISA(tone_ground_run)(frame *f, const tone_detail *d)
{
	work w = {.f = f, .d = d};
	w.open = late_take(&f->late, pixels_of(&w), sizeof *w.open);
	if (!w.open)
		return ENCRE_ERROR_MEMORY;
	survey(&w, d->scratch, ground);
	int32_t code = bands_run(f->bands, f->height, 0, ground_rows, &w);
	for (int dark = 0; !code && d->prints && dark < 2; dark++)
		code = find_print(&w, dark != 0);
	late_drop(&f->late, w.open);
	return code;
}
