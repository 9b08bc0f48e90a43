/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Which blacks are spotted where only small ones are (`tone_black_widest`): pupils, brows, letters, what is dark and
 * stands on something light. What is asked is asked of whole shapes: of a black one, which hangs together in the
 * picture whatever it is made of, and of the dark one that it is part of, as of the iris about a pupil. */
#include "tones/tones.h"

#include <string.h>

enum { LIGHT = 0, DARK = 1, BLACK = 2, BLACKEST = 3, SHOWN = 3, OPEN = 4, ON_LIGHT = 8 };

/* Distances are counted in thirds of a pixel: a step along a row or column, and one across. */
enum { STRAIGHT = 3, ACROSS = 4, FAR = UINT16_MAX - ACROSS };

static const float dark_below = 0.16f;  /* luminance: hardly lighter than an iris; brown skin is lighter */
static const float pupil = 0.25f;       /* of the lightness of blacks: what is so dark is a shape within a black one */
static const float nearer = 0.02f;      /* of the depth: what is so much nearer cuts a shape off */
static const float dark_widest = 2.5f;  /* of the widest black: the dark shape that one is part of */
static const float longest = 4;         /* of the widest black, from side to side: a skirting is no brow */
static const float hollow_from = 0.08f; /* so much wider than that a black is hollow to its rim */

typedef struct work {
	const frame *f;
	uint8_t *kind;
	uint16_t *away; /* thirds of a pixel to where the shape ends */
	uint32_t *open;
	uint8_t least; /* shapes of this, and of what is darker, are looked at */
} work;

static bool within(const work *w, uint8_t kind)
{
	return (kind & SHOWN) >= w->least;
}

static void kind_run(const frame *f, const encre_params *p, int y, int x, int n, uint8_t *kind)
{
	const float *color = layer_row(f, ENCRE_LAYER_COLOR, y) + (ptrdiff_t)3 * x;
	const float *albedo = layer_row(f, ENCRE_LAYER_ALBEDO, y) + (ptrdiff_t)3 * x;
	const float *depth = layer_row(f, ENCRE_LAYER_DEPTH, y) + x;
	float black = p->use_tones ? p->tone_black : 0;
	for (int i = 0; i < n; i++, color += 3, albedo += 3) {
		bool there = depth_of(depth[i]) < INFINITY;
		bool is_dark = luminance(albedo[0], albedo[1], albedo[2]) < dark_below;
		float own = tone_looks(p, color[0], color[1], color[2]);
		int dark = own < pupil * black ? BLACKEST : own < black ? BLACK : DARK;
		kind[i] = (uint8_t)(there && is_dark ? dark : LIGHT);
	}
}

static void kind_rows(void *data, int y0, int y1, int thread)
{
	(void)thread;
	const work *w = data;
	const frame *f = w->f;
	for (int y = y0; y < y1 && !bands_stopped(f->bands); y++)
		for (int x = 0, end; x < f->width; x = end) {
			const encre_params *p = style_run(f, y, x, f->width, &end);
			kind_run(f, p, y, x, end - x, w->kind + (ptrdiff_t)y * f->width + x);
		}
}

static inline uint16_t less_of(uint16_t a, int b)
{
	return b < a ? (uint16_t)b : a;
}

/* How far pixels of shapes are from what is none: a shape that the frame cuts goes on beyond it. */
static void measure(const work *w)
{
	int width = w->f->width, height = w->f->height;
	uint16_t *away = w->away;
	for (int pass = 0; pass < 2; pass++) {
		int by = pass ? 1 : -1, from = pass ? height - 1 : 0;
		for (int k = 0; k < height; k++) {
			int y = from - by * k;
			bool edge = y + by < 0 || y + by >= height;
			const uint16_t *before = edge ? NULL : away + (ptrdiff_t)(y + by) * width;
			uint16_t *own = away + (ptrdiff_t)y * width;
			const uint8_t *kind = w->kind + (ptrdiff_t)y * width;
			for (int i = 0; i < width; i++) {
				int x = pass ? width - 1 - i : i;
				uint16_t least = !within(w, kind[x]) ? 0 : pass ? own[x] : FAR;
				if (least && i > 0)
					least = less_of(least, own[x + by] + STRAIGHT);
				for (int side = -1; least && before && side <= 1; side++)
					if (x + side >= 0 && x + side < width)
						least = less_of(least, before[x + side] + (side ? ACROSS : STRAIGHT));
				own[x] = least < FAR ? least : FAR;
			}
		}
	}
}

typedef struct shape {
	size_t count;
	float wide, far;  /* at its widest; and from side to side, or top to bottom; in pixels */
	size_t ends, cut; /* pixels beside it, and those of them that are nearer or beyond the frame */
} shape;

/* The shape that hangs together with a pixel: its pixels are in `open` then, and OPEN. */
static shape gather(const work *w, uint32_t from)
{
	uint32_t width = (uint32_t)w->f->width, pixels = width * (uint32_t)w->f->height;
	uint8_t *kind = w->kind;
	shape s = {.count = 1};
	uint16_t most = 0;
	uint32_t left = UINT32_MAX, right = 0, top = UINT32_MAX, bottom = 0;
	w->open[0] = from;
	kind[from] |= OPEN;
	for (size_t k = 0; k < s.count; k++) {
		uint32_t i = w->open[k], x = i % width;
		const uint32_t to[] = {x > 0 ? i - 1 : i, x + 1 < width ? i + 1 : i, i >= width ? i - width : i,
				       i + width < pixels ? i + width : i};
		float front = depth_at(w->f, (int)x, (int)(i / width)) * (1 - nearer);
		most = w->away[i] > most ? w->away[i] : most;
		left = x < left ? x : left;
		right = x > right ? x : right;
		top = i / width < top ? i / width : top;
		bottom = i / width > bottom ? i / width : bottom;
		for (int n = 0; n < 4; n++) {
			if (to[n] == i) {
				s.ends++;
				s.cut++;
			} else if (!within(w, kind[to[n]])) {
				s.ends++;
				s.cut += depth_at(w->f, (int)(to[n] % width), (int)(to[n] / width)) < front;
			} else if (!(kind[to[n]] & OPEN)) {
				kind[to[n]] |= OPEN;
				w->open[s.count++] = to[n];
			}
		}
	}
	s.wide = (float)most * (2.0f / STRAIGHT);
	s.far = (float)(1 + (right - left > bottom - top ? right - left : bottom - top));
	return s;
}

/* Dark shapes that are not too wide are on light, if most of their outline is their own. */
static void look_at_dark(work *w, float widest)
{
	size_t pixels = (size_t)w->f->width * (size_t)w->f->height;
	w->least = DARK;
	measure(w);
	for (size_t i = 0; i < pixels; i++) {
		if (w->kind[i] != BLACK && w->kind[i] != BLACKEST)
			continue;
		shape s = gather(w, (uint32_t)i);
		bool on_light = s.wide <= dark_widest * widest && 4 * s.cut < s.ends;
		for (size_t k = 0; k < s.count; k++)
			w->kind[w->open[k]] |= on_light ? ON_LIGHT : 0;
	}
	for (size_t i = 0; i < pixels; i++)
		w->kind[i] = (uint8_t)(w->kind[i] & ~OPEN);
}

/* What is spotted of black shapes on light: all of those not too wide, and of wider ones a rim that gets narrower until
 * there is none, so that nothing turns white at once as the camera comes near. */
static void look_at_black(work *w, float widest, uint8_t *spotted)
{
	size_t pixels = (size_t)w->f->width * (size_t)w->f->height;
	measure(w);
	for (size_t i = 0; i < pixels; i++) {
		if ((w->kind[i] & (OPEN | ON_LIGHT)) != ON_LIGHT || !within(w, w->kind[i]))
			continue;
		shape s = gather(w, (uint32_t)i);
		float over = (max(s.wide, s.far / longest) / widest - 1) / hollow_from;
		float rim = over <= 0 ? INFINITY : 0.5f * widest * (1 - over) * STRAIGHT;
		for (size_t k = 0; 4 * s.cut < s.ends && k < s.count; k++)
			spotted[w->open[k]] |= (float)w->away[w->open[k]] <= rim ? TONE_SPOTTED : 0;
	}
	for (size_t i = 0; i < pixels; i++)
		w->kind[i] = (uint8_t)(w->kind[i] & ~OPEN);
}

int32_t ISA(tone_blacks_run)(frame *f, uint8_t *spotted)
{
	size_t pixels = (size_t)f->width * (size_t)f->height;
	float widest = f->params->tone_black_widest * f->scale;
	work w = {.f = f, .kind = spotted};
	int32_t code = bands_run(f->bands, f->height, 0, kind_rows, &w);
	bool any = memchr(spotted, BLACK, pixels) || memchr(spotted, BLACKEST, pixels);
	if (code || !any) {
		memset(spotted, 0, pixels);
		return code;
	}
	w.kind = late_take(&f->late, pixels, 1);
	w.away = late_take(&f->late, pixels, sizeof *w.away);
	w.open = late_take(&f->late, pixels, sizeof *w.open);
	code = w.kind && w.away && w.open ? ENCRE_OK : ENCRE_ERROR_MEMORY;
	if (!code) {
		memcpy(w.kind, spotted, pixels);
		memset(spotted, 0, pixels);
		look_at_dark(&w, widest);
		for (int least = BLACK; least <= BLACKEST; least++) {
			w.least = (uint8_t)least;
			look_at_black(&w, widest, spotted);
		}
	}
	late_drop(&f->late, w.open);
	late_drop(&f->late, w.away);
	late_drop(&f->late, w.kind);
	return code;
}
