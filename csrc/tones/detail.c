/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What tones leave clear: letters, eyes and bars that are finer than a tone shows, light ones and what is about dark
 * ones, stay paper. A thing is fine where a run along the row or the column is no longer than `tone_detail` until
 * colours change, and less and less where it is longer; half as long again is fine if words.c finds that what is
 * beside it is. */
#include "tones/tones.h"

#include <string.h>

/* Square roots of luminance, which are near how light colours look, by 255: so much must a fine thing differ from what
 * it lies on, and from there on it is wholly clear. */
static const float least_contrast = 0.3f * 255, sure_contrast = 0.34f * 255;
static const int alike = 20; /* 0.08 * 255 */
/* Of the depth: what lies farther behind a dark thing is not what it lies on. */
static const float same_depth = 0.005f;

/* Pixels more than the reach: where strokes meet neither is short, nor what is beside these. */
enum { beyond = 2 };

typedef struct work {
	const frame *f;
	const tone_detail *d;
	bool dark; /* dark things on light ones are looked for */
} work;

static uint8_t *row_of(const work *w, uint8_t *plane, int y)
{
	return plane + (ptrdiff_t)y * w->f->width;
}

/* The least by pixel, of the negative the most. */
static void least_of(bool negative, int n, const uint8_t *restrict a, uint8_t *restrict to)
{
	if (negative)
		for (int i = 0; i < n; i++)
			to[i] = a[i] > to[i] ? a[i] : to[i];
	else
		for (int i = 0; i < n; i++)
			to[i] = a[i] < to[i] ? a[i] : to[i];
}

/* Of each of n pixels the least of the `reach` before it, itself, and as many after it; `line` begins so many before
 * the first. */
static void least_along(bool negative, int n, int reach, const uint8_t *line, uint8_t *to)
{
	memcpy(to, line, (size_t)n);
	for (int k = 1; k <= 2 * reach; k++)
		least_of(negative, n, line + k, to);
}

/* The same down n columns of a plane; as if its outermost rows went on. */
static void least_down(const work *w, bool negative, uint8_t *plane, int y, int x, int n, uint8_t *to)
{
	int height = w->f->height;
	memcpy(to, row_of(w, plane, y) + x, (size_t)n);
	for (int k = -w->d->far; k <= w->d->far; k++)
		least_of(negative, n, row_of(w, plane, tone_within(y + k, height)) + x, to);
}

/* Pixels from x on of a row, whose outermost go on. */
static void row_part(const work *w, uint8_t *plane, int y, int x, int n, uint8_t *to)
{
	const uint8_t *row = row_of(w, plane, y);
	for (int i = 0; i < n; i++)
		to[i] = row[tone_within(x + i, w->f->width)];
}

/* The least along a row, from `reach` pixels before x to as many after the n pixels; `line` begins 2 reach before x. */
static void narrow_part(const work *w, bool negative, const uint8_t *line, int x, int n, uint8_t *to)
{
	int reach = w->d->far, first = reach - x, last = reach + w->f->width - 1 - x;
	least_along(negative, n + 2 * reach, reach, line, to);
	for (int i = 0; i < first; i++)
		to[i] = to[first];
	for (int i = last + 1; i < n + 2 * reach; i++)
		to[i] = to[last];
}

/* What is no longer than the reach lets through is taken away along a row: the least, and of these the most, at n
 * pixels; of the negative the other way round. `line` gets what is there, from 2 reach before x on. */
static void open_part(const work *w, bool negative, uint8_t *plane, int y, int x, int n, uint8_t *line, uint8_t *to)
{
	int reach = w->d->far;
	uint8_t narrow[TONE_CHUNK + 2 * TONE_DETAIL_FAR];
	row_part(w, plane, y, x - 2 * reach, n + 4 * reach, line);
	narrow_part(w, negative, line, x, n, narrow);
	least_along(!negative, n, reach, narrow, to);
}

static int chunk_at(const work *w, int x)
{
	return w->f->width - x < TONE_CHUNK ? w->f->width - x : TONE_CHUNK;
}

static void value_rows(void *data, int y0, int y1, int thread)
{
	(void)thread;
	const work *w = data;
	for (int y = y0; y < y1 && !bands_stopped(w->f->bands); y++) {
		const float *c = layer_row(w->f, ENCRE_LAYER_ALBEDO, y);
		uint8_t *to = row_of(w, w->d->value, y);
		for (int i = 0; i < w->f->width; i++, c += 3) {
			to[i] = (uint8_t)(int)(255 * sqrtf(clamp01(luminance(c[0], c[1], c[2]))) + 0.5f);
		}
	}
}

static void narrow_rows(void *data, int y0, int y1, int thread)
{
	(void)thread;
	const work *w = data;
	for (int y = y0; y < y1 && !bands_stopped(w->f->bands); y++)
		least_down(w, w->dark, w->d->value, y, 0, w->f->width, row_of(w, w->d->scratch, y));
}

/* The least of squares, and of these the most of rows. */
static void square_rows(void *data, int y0, int y1, int thread)
{
	(void)thread;
	const work *w = data;
	for (int y = y0; y < y1 && !bands_stopped(w->f->bands); y++)
		for (int x = 0, n; x < w->f->width; x += n) {
			uint8_t line[TONE_CHUNK + 4 * TONE_DETAIL_FAR];
			n = chunk_at(w, x);
			open_part(w, false, w->d->scratch, y, x, n, line, row_of(w, w->d->dark, y) + x);
		}
}

/* By how much pixels differ from what is left of them where what is as long as the reach lets through is taken away
 * along the row or the column; of light ones also where squares are. */
static void differ_rows(void *data, int y0, int y1, int thread)
{
	(void)thread;
	const work *w = data;
	int reach = w->d->far;
	for (int y = y0; y < y1 && !bands_stopped(w->f->bands); y++)
		for (int x = 0, n; x < w->f->width; x += n) {
			uint8_t line[TONE_CHUNK + 4 * TONE_DETAIL_FAR];
			uint8_t across[TONE_CHUNK], down[TONE_CHUNK], square[TONE_CHUNK];
			n = chunk_at(w, x);
			open_part(w, w->dark, w->d->value, y, x, n, line, across);
			least_down(w, !w->dark, w->d->scratch, y, x, n, down);
			least_of(w->dark, n, across, down);
			const uint8_t *own = line + 2 * reach;
			uint8_t *to = row_of(w, w->d->raw, y) + x;
			for (int i = 0; i < n; i++)
				to[i] = (uint8_t)(w->dark ? down[i] - own[i] : own[i] - down[i]);
			if (w->dark)
				continue;
			least_down(w, true, w->d->dark, y, x, n, square);
			for (int i = 0; i < n; i++)
				row_of(w, w->d->light, y)[x + i] = (uint8_t)(own[i] - square[i]);
		}
}

/* Whether what is as light or as dark beside a pixel is as fine: at rims of large things it is not, though rendered
 * pixels there differ from one to the next. */
static bool is_fine(const work *w, int x, int y)
{
	float own = row_of(w, w->d->value, y)[x];
	for (int k = 0; k < 9; k++) {
		int v = tone_within(y + k / 3 - 1, w->f->height), u = tone_within(x + k % 3 - 1, w->f->width);
		float other = row_of(w, w->d->value, v)[u], more = w->dark ? own - other : other - own;
		if (more >= -alike && row_of(w, w->d->raw, v)[u] < 0.5f * least_contrast)
			return false;
	}
	return true;
}

/* How long what is fine is at a pixel along the row or the column, in pixels of the contrast that it has at most: what
 * its ends cover of a pixel counts as such, or it would be now longer, now shorter as the camera moves. It ends where
 * half of that contrast is not there. Without end where it is longer than any that is fine, or the frame, of what is
 * dark a nearer thing too, cuts it off. */
static float length_of(const work *w, int x, int y, int right, int down)
{
	int most = 2 * w->d->far + 1, own = row_of(w, w->d->value, y)[x], sign = w->dark ? -1 : 1;
	int ground = own - sign * row_of(w, w->d->raw, y)[x], sum = sign * (own - ground), best = sum;
	float nearer = w->dark ? depth_at(w->f, x, y) * (1 - same_depth) : 0;
	for (int way = -1; way <= 1; way += 2)
		for (int k = 1, more = best; 2 * more >= best; k++) {
			int u = x + k * way * right, v = y + k * way * down;
			if (k > most || u < 0 || v < 0 || u >= w->f->width || v >= w->f->height)
				return INFINITY;
			more = sign * (row_of(w, w->d->value, v)[u] - ground);
			sum += more > 0 ? more : 0;
			best = more > best ? more : best;
			/* the last one may show both */
			int next_u = tone_within(2 * more < best ? u + way * right : u, w->f->width);
			int next_v = tone_within(2 * more < best ? v + way * down : v, w->f->height);
			if (depth_at(w->f, u, v) < nearer || depth_at(w->f, next_u, next_v) < nearer)
				return INFINITY;
		}
	return (float)sum / (float)best;
}

/* How surely a thing is fine, 255ths: windows of which a rope leaves no more than a strip are no letters. */
static uint8_t sureness(const work *w, int x, int y)
{
	float length = min(length_of(w, x, y, 1, 0), length_of(w, x, y, 0, 1));
	float full = (float)(2 * w->d->reach + 1), fades = (float)(w->d->far - w->d->reach);
	return (uint8_t)(int)(255 * clamp01((full - length) / fades + 0.5f) + 0.5f);
}

static void fine_rows(void *data, int y0, int y1, int thread)
{
	(void)thread;
	const work *w = data;
	for (int y = y0; y < y1 && !bands_stopped(w->f->bands); y++) {
		const uint8_t *raw = row_of(w, w->d->raw, y);
		uint8_t *to = row_of(w, w->dark ? w->d->dark : w->d->thin, y), *how = row_of(w, w->d->sure[w->dark], y);
		for (int x = 0; x < w->f->width; x++) {
			bool fine = raw[x] > least_contrast && is_fine(w, x, y);
			to[x] = fine ? raw[x] : 0;
			how[x] = fine ? sureness(w, x, y) : 0;
		}
	}
}

static float sure(float contrast)
{
	return clamp01((contrast - least_contrast) / (sure_contrast - least_contrast));
}

/* Whether what is darker about a light pixel is what it lies on. */
static bool lies_on(const work *w, int x, int y)
{
	int reach = w->d->far + 1, left = tone_within(x - reach, w->f->width);
	float own = row_of(w, w->d->value, y)[x], depth = depth_at(w->f, x, y);
	for (int v = tone_within(y - reach, w->f->height); v <= y + reach && v < w->f->height; v++) {
		const uint8_t *value = row_of(w, w->d->value, v);
		for (int u = left; u <= x + reach && u < w->f->width; u++)
			if (own - (float)value[u] > least_contrast &&
			    fabsf(depth_at(w->f, u, v) - depth) <= same_depth * depth)
				return true;
	}
	return false;
}

/* How much a pixel is of a fine light thing: at its rim by how light it is. */
static float of_light(const work *w, int x, int y)
{
	float most = 0, own = row_of(w, w->d->light, y)[x];
	for (int k = 0; own > 0 && k < 9; k++) {
		const uint8_t *row = row_of(w, w->d->light, tone_within(y + k / 3 - 1, w->f->height));
		most = max(most, row[tone_within(x + k % 3 - 1, w->f->width)]);
	}
	float share = own > 0 ? sure(most) * clamp01(2 * own / most - 0.9f) : 0;
	return share > 0 && lies_on(w, x, y) ? share : 0;
}

/* How much a fine dark thing within so many pixels, or a light one, lies on what this pixel shows. */
static float about(const work *w, bool seek_dark, int reach, int x, int y)
{
	int sign = seek_dark ? -1 : 1, own = row_of(w, w->d->value, y)[x];
	int left = tone_within(x - reach, w->f->width);
	float best = 0, depth = depth_at(w->f, x, y);
	for (int v = tone_within(y - reach, w->f->height); v <= y + reach && v < w->f->height; v++) {
		const uint8_t *thing = row_of(w, seek_dark ? w->d->dark : w->d->thin, v);
		const uint8_t *value = row_of(w, w->d->value, v), *how = row_of(w, w->d->sure[seek_dark], v);
		for (int u = left; u <= x + reach && u < w->f->width; u++) {
			float contrast = min(thing[u], (float)(sign * (value[u] - own)));
			if (contrast <= least_contrast || !(fabsf(depth_at(w->f, u, v) - depth) <= same_depth * depth))
				continue;
			float away = sqrtf((float)((u - x) * (u - x) + (v - y) * (v - y)));
			float wide = ((float)reach + 0.5f) * ((float)how[u] / 255); /* it grows: no tone is grey */
			best = max(best, sure(contrast) * clamp01(wide - away));
		}
	}
	return best;
}

/* The most of a square about each of n pixels, at most twice as far as details go. */
static void most_about(const work *w, int reach, uint8_t *plane, int y, int x, int n, uint8_t *to)
{
	uint8_t line[TONE_CHUNK + 4 * TONE_DETAIL_FAR + 4 * beyond] = {0}, part[sizeof line];
	for (int k = -reach; k <= reach; k++) {
		row_part(w, plane, tone_within(y + k, w->f->height), x - reach, n + 2 * reach, part);
		least_of(true, n + 2 * reach, part, line);
	}
	least_along(true, n, reach, line, to);
}

static uint8_t share_left(float clear)
{
	return (uint8_t)(int)(255 * (1 - clear) + 0.5f);
}

static void keep_rows(void *data, int y0, int y1, int thread)
{
	(void)thread;
	const work *w = data;
	for (int y = y0; y < y1 && !bands_stopped(w->f->bands); y++)
		for (int x = 0, n; x < w->f->width; x += n) {
			uint8_t light[TONE_CHUNK], dark[TONE_CHUNK], how[TONE_CHUNK];
			uint8_t *keep = row_of(w, w->d->keep, y) + x, *margin = row_of(w, w->d->scratch, y) + x;
			n = chunk_at(w, x);
			most_about(w, w->d->far + beyond, w->d->thin, y, x, n, light);
			most_about(w, w->d->far + beyond, w->d->sure[0], y, x, n, how);
			most_about(w, w->d->reach, w->d->dark, y, x, n, dark);
			for (int i = 0; i < n; i++) {
				float share = sure(light[i]) * (float)how[i] * (1.0f / 255);
				float clear = share > 0 ? share * of_light(w, x + i, y) : 0;
				float wide = dark[i] > least_contrast ? about(w, true, w->d->reach, x + i, y) : 0;
				keep[i] = share_left(max(clear, wide));
				margin[i] = (uint8_t)(255 - share_left(most_one(2 * wide))); /* as wide as it looks */
			}
		}
}

/* Whether nothing dark is seen on what a pixel shows: black paint, and deep reds and blues, as signs have. */
static bool is_board(const work *w, int x, int y)
{
	float value = row_of(w, w->d->value, y)[x];
	if (value <= least_contrast)
		return true;
	const float *c = layer_row(w->f, ENCRE_LAYER_ALBEDO, y) + (ptrdiff_t)3 * x;
	float reds = w->f->params[style_at(w->f, x, y)].tone_reds;
	return value * value <= least_contrast * least_contrast * (1 + reds * tone_deep(c[0], c[1], c[2]));
}

/* How much pixels are what light print lies on. A board is flat and of a colour on which nothing dark is seen; where
 * dark print is near, the pupil of an eye, it is a face. */
static void around_rows(void *data, int y0, int y1, int thread)
{
	(void)thread;
	const work *w = data;
	for (int y = y0; y < y1 && !bands_stopped(w->f->bands); y++)
		for (int x = 0, n; x < w->f->width; x += n) {
			uint8_t light[TONE_CHUNK], print[TONE_CHUNK], *to = row_of(w, w->d->around, y) + x;
			uint8_t *board = row_of(w, w->d->board, y) + x;
			n = chunk_at(w, x);
			most_about(w, w->d->far, w->d->thin, y, x, n, light);
			bool any = false;
			for (int i = 0; i < n; i++) {
				float own = light[i] > least_contrast ? about(w, false, w->d->far, x + i, y) : 0;
				to[i] = (uint8_t)(255 - share_left(own));
				board[i] = to[i] && is_board(w, x + i, y) ? to[i] : 0;
				any |= board[i];
			}
			if (!any)
				continue;
			most_about(w, w->d->far, w->d->flat, y, x, n, light);
			most_about(w, 2 * (w->d->far + beyond), w->d->print, y, x, n, print);
			for (int i = 0; i < n; i++)
				board[i] = print[i] < 128 && light[i] ? board[i] : 0;
		}
}

void ISA(tone_detail_plan)(const frame *f, tone_detail *d, arena *a)
{
	size_t pixels = (size_t)f->width * (size_t)f->height;
	if (!tone_fitted(f))
		return;
	d->reach = (int)min(0.5f * f->params->tone_detail * f->scale, TONE_DETAIL_MOST); /* 2 reach + 1, rounded */
	d->reach = d->reach > 0 ? d->reach : 1;
	d->far = d->reach + d->reach / 2 + 1;
	uint8_t **plane[] = {&d->value, &d->scratch, &d->light, &d->thin,   &d->dark,  &d->raw,
			     d->sure,   d->sure + 1, &d->print, &d->around, &d->board, &d->flat};
	for (size_t k = 0; k < sizeof plane / sizeof *plane; k++)
		*plane[k] = arena_take(a, pixels, 1);
	d->inked = d->raw;
	d->keep = f->params->tone_detail > 0 ? arena_take(a, pixels, 1) : NULL;
	d->ease = f->params->tone_detail > 0 ? arena_take(a, pixels, 1) : NULL;
	d->room = f->params->tone_least > 0 ? arena_take(a, pixels, 1) : NULL;
	d->aim = f->params->tone_least > 0 ? arena_take(a, pixels, 1) : NULL;
}

static int32_t seek(work *w, bool dark)
{
	bands *pool = w->f->bands;
	w->dark = dark;
	int32_t code = bands_run(pool, w->f->height, 0, narrow_rows, w);
	if (!code && !dark)
		code = bands_run(pool, w->f->height, 0, square_rows, w);
	code = code ? code : bands_run(pool, w->f->height, 0, differ_rows, w);
	return code ? code : bands_run(pool, w->f->height, 0, fine_rows, w);
}

int32_t ISA(tone_detail_run)(frame *f, const tone_detail *d)
{
	work w = {.f = f, .d = d};
	int32_t code = bands_run(f->bands, f->height, 0, value_rows, &w);
	code = code ? code : seek(&w, false);
	code = code ? code : seek(&w, true);
	code = code ? code : ISA(tone_words_run)(f, d);
	code = code ? code : bands_run(f->bands, f->height, 0, keep_rows, &w);
	code = code ? code : ISA(tone_ground_run)(f, d);
	return code || !d->prints ? code : bands_run(f->bands, f->height, 0, around_rows, &w);
}
