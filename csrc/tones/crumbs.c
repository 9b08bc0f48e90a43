/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Crumbs (`tone_crumbs`): where solid ink fills the darkest level, islands of ink in light, and of light in ink, that
 * are smaller than a dot of the pen become what is around them. Camouflage, worn cloth and bumps are cut into hundreds
 * of these, where an inker has one black with a few folds. What has a color of its own is a feature: a pupil, a button,
 * the point of a price. */
#include "tones/tones.h"

#include <string.h>

enum { OTHER = 0, LIGHT = 1, INK = 2, KINDS = 3, NOTHING = 4, SEEN = 8 };

/* By how much of the cube root of a channel a feature is darker or lighter than what is around it, at the most: pupils
 * of dark faces are, and red spots on yellow; patches of camouflage are not. */
static const float contrast = 0.22f;
/* Of the depth: light that lies so far behind ink is seen between it, and so far before no mark on it. */
static const float behind = 0.001f, before = 0.005f;
static const float brightest = 4; /* that counts of the light around: what shines has any */
static const float longest = 4;   /* of `tone_crumbs`, from side to side or top to bottom: what is longer is a fold */

typedef struct work {
	const frame *f;
	tone_frame *t;
	uint8_t *kind;
	uint32_t *open;
} work;

typedef struct island {
	size_t count;
	uint32_t far; /* from side to side, or top to bottom */
	bool whole;   /* nothing of it or about it is unknown, or no surface */
	int around;
	float least[2][3], most[2][3]; /* cube roots of channels: its own, and of what is around it */
	float light, depth, own_depth; /* means: around it, and its own */
} island;

/* Whether solid ink fills what is in the dark. */
static bool inks(const frame *f, const tone_style *s, const encre_params *p)
{
	return p->use_tones && p->shade_levels.count > 1 && (tone_spots_small(f) || s->slot->kind == tone_1_SOLID);
}

static void look_rows(void *data, int y0, int y1, int thread)
{
	(void)thread;
	const work *w = data;
	const frame *f = w->f;
	const uint8_t *spotted = w->t->spotted;
	for (int y = y0; y < y1 && !bands_stopped(f->bands); y++)
		for (int x = 0, end; x < f->width; x = end) {
			int most = f->width - x > TONE_CHUNK ? x + TONE_CHUNK : f->width;
			const encre_params *p = style_run(f, y, x, most, &end);
			size_t at = (size_t)y * (size_t)f->width + (size_t)x;
			const float *depth = layer_row(f, ENCRE_LAYER_DEPTH, y) + x;
			float *light = w->t->settling + at;
			ISA(tone_light)(f, p, y, x, end - x, light);
			bool any = inks(f, w->t->styles + (p - f->params), p);
			float begins = any ? p->shade_levels.level[1].threshold : 0;
			for (int i = 0; i < end - x; i++) {
				bool ink = spotted ? spotted[at + (size_t)i] && light[i] < 0 : light[i] < begins;
				int nothing = depth_of(depth[i]) < INFINITY ? 0 : NOTHING;
				w->kind[at + (size_t)i] = (uint8_t)(any ? (ink ? INK : LIGHT) | nothing : OTHER);
			}
		}
}

static void add_color(const frame *f, int x, int y, float least[3], float most[3])
{
	const float *color = layer_row(f, ENCRE_LAYER_ALBEDO, y) + (ptrdiff_t)3 * x;
	for (int c = 0; c < 3; c++) {
		float own = tone_cube_root(color[c]);
		least[c] = min(least[c], own);
		most[c] = max(most[c], own);
	}
}

/* What goes on beyond a rim of these pixels that is none of the frame is not known. */
static bool is_cut(const frame *f, int x, int y)
{
	const encre_frame *p = &f->place;
	return (x == 0 && p->x > 0) || (y == 0 && p->y > 0) || (x + 1 == f->width && p->x + f->width < p->width) ||
	       (y + 1 == f->height && p->y + f->height < p->height);
}

/* Gathers in `open` what hangs together with a pixel by sides or corners. */
static island gather(const work *w, uint32_t from)
{
	const frame *f = w->f;
	uint32_t width = (uint32_t)f->width, height = (uint32_t)f->height;
	uint8_t own = w->kind[from] & KINDS;
	uint32_t left = UINT32_MAX, right = 0, bottom = 0;
	island of = {.count = 1, .whole = true};
	w->open[0] = from;
	w->kind[from] |= SEEN;
	for (size_t k = 0; k < of.count; k++) {
		uint32_t x = w->open[k] % width, y = w->open[k] / width;
		left = x < left ? x : left;
		right = x > right ? x : right;
		bottom = y > bottom ? y : bottom;
		of.whole = of.whole && !(w->kind[w->open[k]] & NOTHING) && !is_cut(f, (int)x, (int)y);
		for (uint32_t v = y > 0 ? y - 1 : 0; v <= y + 1 && v < height; v++)
			for (uint32_t u = x > 0 ? x - 1 : 0; u <= x + 1 && u < width; u++) {
				uint8_t *there = w->kind + (size_t)v * width + u;
				of.whole = of.whole && (*there & KINDS) != OTHER;
				if ((*there & KINDS) != own || *there & SEEN)
					continue;
				*there |= SEEN;
				w->open[of.count++] = v * width + u;
			}
	}
	uint32_t wide = right - left + 1, tall = bottom - from / width + 1; /* it is its first, from above */
	of.far = wide > tall ? wide : tall;
	return of;
}

/* What it is, and what is around it: each pixel of that counts once for each of its own that it touches. */
static void look_around(const work *w, island *of)
{
	const frame *f = w->f;
	int width = f->width, height = f->height;
	uint8_t own = w->kind[w->open[0]] & KINDS;
	for (int k = 0; k < 6; k++) {
		of->least[k / 3][k % 3] = 1;
		of->most[k / 3][k % 3] = 0;
	}
	for (size_t k = 0; k < of->count; k++) {
		int x = (int)w->open[k] % width, y = (int)w->open[k] / width;
		add_color(f, x, y, of->least[0], of->most[0]);
		of->own_depth += depth_at(f, x, y);
		for (int v = y > 0 ? y - 1 : 0; v <= y + 1 && v < height; v++)
			for (int u = x > 0 ? x - 1 : 0; u <= x + 1 && u < width; u++) {
				size_t at = (size_t)v * (size_t)width + (size_t)u;
				if ((w->kind[at] & KINDS) == own)
					continue;
				of->light += max(min(w->t->settling[at], brightest), -1);
				add_color(f, u, v, of->least[1], of->most[1]);
				of->depth += depth_at(f, u, v);
				of->around++;
			}
	}
	float n = (float)of->around;
	of->light /= n;
	of->depth /= n;
	of->own_depth /= (float)of->count;
}

/* Light in ink is one only on it: skin is seen between hair. */
static bool is_feature(const island *of, int kind)
{
	int dark = kind == INK ? 0 : 1;
	float most = 0, far = of->own_depth - of->depth;
	for (int c = 0; c < 3; c++)
		most = max(most, of->most[1 - dark][c] - of->least[dark][c]);
	bool on_it = kind == INK || (far <= behind * of->depth && -far <= before * of->depth);
	return on_it && most > contrast;
}

/* Light first: what is within a black as small as itself goes with it. */
static void settle(const work *w, float size)
{
	const frame *f = w->f;
	size_t pixels = (size_t)f->width * (size_t)f->height;
	for (int kind = LIGHT; kind <= INK; kind++)
		for (size_t i = 0; i < pixels; i++) {
			if ((w->kind[i] & KINDS) != kind || w->kind[i] & SEEN)
				continue;
			island of = gather(w, (uint32_t)i);
			if (!of.whole || (float)of.count > size * size || (float)of.far > longest * size)
				continue;
			look_around(w, &of);
			if (!of.around || is_feature(&of, kind))
				continue;
			for (size_t k = 0; k < of.count; k++) {
				uint32_t at = w->open[k];
				int x = (int)at % f->width, y = (int)at / f->width;
				const encre_params *p = params_at(f, x, y);
				const encre_level *next = p->shade_levels.level + 1;
				float end = next->threshold + max(0.5f * next->transition, 1e-3f);
				w->kind[at] = (uint8_t)(LIGHT + INK - kind);
				w->t->settling[at] = kind == LIGHT ? -1 : max(of.light, end);
				if (w->t->spotted)
					w->t->spotted[at] = kind == LIGHT ? TONE_SPOTTED : 0;
			}
		}
}

int32_t ISA(tone_crumbs_run)(frame *f, tone_frame *t)
{
	size_t pixels = (size_t)f->width * (size_t)f->height;
	work w = {.f = f, .t = t, .kind = late_take(&f->late, pixels, 1)};
	w.open = w.kind ? late_take(&f->late, pixels, sizeof *w.open) : NULL;
	int32_t code = w.open ? bands_run(f->bands, f->height, 0, look_rows, &w) : ENCRE_ERROR_MEMORY;
	if (!code)
		settle(&w, f->params->tone_crumbs * f->scale);
	t->settled = t->settling;
	late_drop(&f->late, w.open);
	late_drop(&f->late, w.kind);
	return code;
}
