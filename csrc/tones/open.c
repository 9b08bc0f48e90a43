/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What is left open in the dark. A figure that no light reaches, filled with ink, is a negative with white lines: an
 * inker leaves its face open. Of each thing the colors that hardly have any light, as light as each other, get some,
 * the more the lighter they are and the more they turn to the upper left. Where a thing has light enough its shade
 * tells its shape and stays as dark as it is; so does the ground. */
#include "tones/tones.h"

#include <string.h>

enum { WHOLE = 256 /* parts of a pixel */, LIT = 255, TRIES = 32, NONE = UINT16_MAX };

static const float toward[3] = {-0.7f, 0.25f, 0.67f}; /* to the right, up and to the eye: of length 1 */
static const float lightest = 0.83f;  /* from black to white, from which on colors are as light as may be */
static const float enough = 1.0f / 3; /* share of a thing that has light by which nothing of it is left open */
static const float full = 0.145f;     /* what is so light, and turned so, begins to be open */
static const float sure = 0.25f;      /* of a threshold: over which what has light begins to count */
static const float beyond = 0.25f;    /* of the next level: so light at most, or where light falls could not be seen */

typedef struct work {
	const frame *f;
	tone_frame *t;
	uint16_t *shade; /* how light the color is, 0 to WHOLE * (TONE_SHADES - 1); NONE: a black, or none is wanted */
	uint8_t *lit;
} work;

/* The entry of an object, or the one that it may take; NULL: there are too many. */
static tone_thing *entry_of(tone_thing *things, float object)
{
	uint32_t at = (uint32_t)float_bits(object) * 2654435761u >> 16;
	for (uint32_t k = 0; k < TRIES; k++) {
		tone_thing *t = things + (at + k) % TONE_THINGS;
		if (!t->taken || t->object == object)
			return t;
	}
	return NULL;
}

static float threshold_of(const encre_params *p)
{
	bool any = p->use_tones && p->tone_open > 0 && p->shade_levels.count > 1;
	return any ? max(p->shade_levels.level[1].threshold, 0) : 0;
}

/* How light a color is between what counts as black and white, as the eye has it. */
static float lightness(const encre_params *p, const float *color)
{
	float black = tone_cube_root(p->tone_black), own = tone_looks(p, color[0], color[1], color[2]);
	return clamp01((tone_cube_root(positive(own)) - black) / max(1 - black, 1e-3f));
}

/* The most light that is left on a color: so much that where light falls is still seen, and no more than full light
 * would be on it. */
static float most_of(const encre_params *p, const float *color, float begins)
{
	float r = color[0], g = color[1], b = color[2], own = tone_looks(p, r, g, b);
	float lit = ISA(tone_counts_as)(p, own, r, g, b, p->tone_black, p->tone_dark);
	bool last = p->shade_levels.count < 3;
	float most = last ? 2 * begins : mix(begins, p->shade_levels.level[2].threshold, beyond);
	return min(max(most, begins), lit);
}

/* How light each pixel's color is, and whether it has light. */
static void look_rows(void *data, int y0, int y1, int thread)
{
	(void)thread;
	const work *w = data;
	const frame *f = w->f;
	for (int y = y0; y < y1 && !bands_stopped(f->bands); y++)
		for (int x = 0, end; x < f->width; x = end) {
			int most = f->width - x > TONE_CHUNK ? x + TONE_CHUNK : f->width;
			const encre_params *p = style_run(f, y, x, most, &end);
			const float *color = layer_row(f, ENCRE_LAYER_COLOR, y) + (ptrdiff_t)3 * x;
			float light[TONE_CHUNK] = {0}, begins = threshold_of(p);
			size_t at = (size_t)y * (size_t)f->width + (size_t)x;
			if (begins > 0)
				ISA(tone_light)(f, p, y, x, end - x, light);
			for (int i = 0; i < end - x; i++) {
				bool part = begins > 0 && light[i] >= 0;
				float own = part ? lightness(p, color + (ptrdiff_t)3 * i) : 0;
				float has = max(light[i], exposed_at(f, p, x + i, y)) - begins;
				int shade = (int)((TONE_SHADES - 1) * WHOLE * min(own / lightest, 1) + 0.5f);
				has = clamp01(has / max(sure * begins, FLT_MIN) + 0.5f);
				w->shade[at + (size_t)i] = part ? (uint16_t)shade : NONE;
				w->lit[at + (size_t)i] = (uint8_t)(int)(LIT * has + 0.5f);
			}
		}
}

static bool part_of(const work *w, int x, int y)
{
	return w->shade[(size_t)y * (size_t)w->f->width + (size_t)x] < NONE && depth_at(w->f, x, y) < INFINITY;
}

static tone_thing *thing_at(const work *w, int x, int y, tone_thing *last)
{
	const float *objects = layer_row(w->f, ENCRE_LAYER_OBJECT, y);
	float object = objects ? objects[x] : 0;
	return last && last->taken && last->object == object ? last : entry_of(w->t->things, object);
}

/* The first of two shades that a color lies between. */
static int between(uint16_t shade)
{
	int first = shade / WHOLE;
	return first < TONE_SHADES - 1 ? first : TONE_SHADES - 2;
}

static void count(const work *w)
{
	const frame *f = w->f;
	memset(w->t->things, 0, TONE_THINGS * sizeof *w->t->things);
	for (int y = 0; y < f->height && !bands_stopped(f->bands); y++) {
		tone_thing *thing = NULL;
		for (int x = 0; x < f->width; x++) {
			size_t at = (size_t)y * (size_t)f->width + (size_t)x;
			if (!part_of(w, x, y))
				continue;
			thing = thing_at(w, x, y, thing);
			if (!thing)
				continue;
			const float *objects = layer_row(f, ENCRE_LAYER_OBJECT, y);
			thing->object = objects ? objects[x] : 0;
			thing->taken = true;
			int first = between(w->shade[at]), second = w->shade[at] - first * WHOLE;
			const int part[2] = {WHOLE - second, second};
			for (int k = 0; k < 2; k++) {
				thing->all[first + k] += (uint64_t)part[k];
				thing->lit[first + k] += (uint64_t)(part[k] * w->lit[at]);
			}
		}
	}
}

/* How much of what is as light as a pixel of its thing has light. */
static float share_of(const tone_thing *thing, uint16_t shade)
{
	int first = between(shade);
	float share[2], along = (float)(shade - first * WHOLE) / WHOLE;
	for (int k = 0; k < 2; k++) {
		uint64_t all = thing->all[first + k] * LIT;
		share[k] = all ? (float)((double)thing->lit[first + k] / (double)all) : 0;
	}
	return mix(share[0], share[1], along);
}

static void open_rows(void *data, int y0, int y1, int thread)
{
	(void)thread;
	const work *w = data;
	const frame *f = w->f;
	for (int y = y0; y < y1 && !bands_stopped(f->bands); y++) {
		const float *normal = layer_row(f, ENCRE_LAYER_NORMAL, y), *color = layer_row(f, ENCRE_LAYER_COLOR, y);
		float *open = w->t->opening + (ptrdiff_t)y * f->width;
		tone_thing *thing = NULL;
		for (int x = 0; x < f->width; x++) {
			const encre_params *p = params_at(f, x, y);
			const float *n = normal + (ptrdiff_t)3 * x;
			float begins = threshold_of(p), square = n[0] * n[0] + n[1] * n[1] + n[2] * n[2];
			open[x] = 0;
			if (!part_of(w, x, y) || !(square > 1e-12f && square < 1e12f))
				continue;
			thing = thing_at(w, x, y, thing);
			if (!thing)
				continue;
			uint16_t shade = w->shade[(size_t)y * (size_t)f->width + (size_t)x];
			float less = positive(1 - share_of(thing, shade) / enough), turned = 0;
			for (int axis = 0; axis < 3; axis++)
				turned += toward[axis] * turned_to(f, axis, n);
			turned = positive(turned);
			float bright = turned * turned / square * lightness(p, color + (ptrdiff_t)3 * x);
			open[x] = min(begins * bright * less * p->tone_open / full,
				      most_of(p, color + (ptrdiff_t)3 * x, begins));
		}
	}
}

int32_t ISA(tone_open_run)(frame *f, tone_frame *t)
{
	size_t pixels = (size_t)f->width * (size_t)f->height;
	work w = {.f = f, .t = t, .shade = late_take(&f->late, pixels, sizeof *w.shade)};
	w.lit = w.shade ? late_take(&f->late, pixels, 1) : NULL;
	t->open = NULL;
	int32_t code = w.lit ? bands_run(f->bands, f->height, 0, look_rows, &w) : ENCRE_ERROR_MEMORY;
	if (!code)
		count(&w);
	code = code ? code : bands_run(f->bands, f->height, 0, open_rows, &w);
	t->open = t->opening;
	if (w.lit)
		late_drop(&f->late, w.lit);
	if (w.shade)
		late_drop(&f->late, w.shade);
	return code;
}
