/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Specks: islands of light in black that are too small or too narrow to be drawn take the colour of what is around
 * them. Slits and gaps under a pixel wide are but a row of dots, which an inker fills or draws a whole line along.
 * Filled before lines are drawn, so that these do not take them for light, and after it, what lines leave. */
#include "base/stage.h"

enum { MOST = 128 /* pixels of an island */, BAND = 128, ROW = 2 * MOST + 1 };

/* What is brighter is no black; what is clear shows white. */
static const float black = 0.03f;
/* How much lighter a mark is than what it lies on, of square roots of luminance; how far from it, and how far behind,
 * of the depth: for what it lies on may be hollow. */
static const float contrast = 0.3f, same_depth = 0.005f, behind = 0.001f;
/* Of `speck_size`: what is as long as it will, but narrower. After lines that would be lines of the second ink. */
static const float narrow = 0.5f;

typedef struct specks {
	const frame *f;
	uint8_t *light; /* by pixel: it is no black */
	uint8_t *seen;  /* by thread: pixels about the one with which an island begins, ROW to a row */
	bool drawn;     /* lines are */
	plane ink;      /* what is filled is told here as well; no data: nobody asks */
} specks;

typedef struct island {
	int x[MOST], y[MOST], count; /* the first is the upper one, and of these the left one */
	int left, right, bottom, count_around;
	float around[3];
	float own_depth, depth, lightest, light; /* without its light: the most of its own, and the sum around it */
} island;

static void light_rows(void *data, int y0, int y1, int thread)
{
	(void)thread;
	const specks *s = data;
	const frame *f = s->f;
	for (int y = y0; y < y1 && !bands_stopped(f->bands); y++) {
		const float *rgba = output_row(f, ENCRE_OUTPUT_COMBINED, y);
		uint8_t *light = s->light + (ptrdiff_t)y * f->width;
		for (int x = 0; x < f->width; x++) {
			const float *c = rgba + (ptrdiff_t)4 * x;
			light[x] = max3(c[0], c[1], c[2]) + (1 - c[3]) > black;
		}
	}
}

/* Nothing is beyond the picture. */
static bool is_light(const specks *s, int x, int y)
{
	return x >= 0 && x < s->f->width && y >= 0 && s->light[(ptrdiff_t)y * s->f->width + x];
}

static bool begins(const specks *s, int x, int y)
{
	return s->light[(ptrdiff_t)y * s->f->width + x] && !is_light(s, x - 1, y) && !is_light(s, x - 1, y - 1) &&
	       !is_light(s, x, y - 1) && !is_light(s, x + 1, y - 1);
}

/* Whether a pixel is at a rim of these that is none of the whole frame: what goes on beyond it is not known. */
static bool is_cut(const frame *f, int x, int y)
{
	const encre_frame *p = &f->place;
	return (x == 0 && p->x > 0) || (y == 0 && p->y > 0) || (x + 1 == f->width && p->x + f->width < p->width) ||
	       (y + 1 == f->height && p->y + f->height < p->height);
}

/* How light a surface is without its light. */
static float lightness(const frame *f, int x, int y)
{
	const float *c = layer_row(f, ENCRE_LAYER_ALBEDO, y) + (ptrdiff_t)3 * x;
	return sqrtf(clamp01(luminance(c[0], c[1], c[2])));
}

static void add(const frame *f, island *of, int x, int y)
{
	of->own_depth += depth_at(f, x, y);
	of->lightest = max(of->lightest, lightness(f, x, y));
	of->x[of->count] = x;
	of->y[of->count++] = y;
	of->left = x < of->left ? x : of->left;
	of->right = x > of->right ? x : of->right;
	of->bottom = y > of->bottom ? y : of->bottom;
}

/* The neighbours of its i-th pixel: more of it, or what is around it. False where it goes on too far, or beyond what is
 * known of the frame, or before where it began. */
static bool grow(const specks *s, uint8_t *seen, int most, int i, island *of)
{
	const frame *f = s->f;
	int x = of->x[i], y = of->y[i];
	if (is_cut(f, x, y))
		return false;
	for (int v = y > 0 ? y - 1 : 0; v <= y + 1 && v < f->height; v++)
		for (int u = x > 0 ? x - 1 : 0; u <= x + 1 && u < f->width; u++) {
			if (!s->light[(ptrdiff_t)v * f->width + u]) {
				const float *c = output_row(f, ENCRE_OUTPUT_COMBINED, v) + (ptrdiff_t)4 * u;
				for (int k = 0; k < 3; k++)
					of->around[k] += c[k];
				of->depth += depth_at(f, u, v);
				of->light += lightness(f, u, v);
				of->count_around++;
				continue;
			}
			if (v < of->y[0] || (v == of->y[0] && u < of->x[0]))
				return false;
			uint8_t *was = seen + (ptrdiff_t)(v - of->y[0]) * ROW + MOST + u - of->x[0];
			if (*was)
				continue;
			if (of->count == most)
				return false;
			*was = 1;
			add(f, of, u, v);
		}
	return true;
}

/* The island that begins at a pixel, of at most so many. */
static bool find(const specks *s, uint8_t *seen, int most, int x, int y, island *of)
{
	bool whole = true;
	of->count = of->count_around = 0;
	of->left = of->right = x;
	of->bottom = y;
	of->own_depth = of->depth = of->lightest = of->light = 0;
	memset(of->around, 0, sizeof of->around);
	seen[MOST] = 1;
	add(s->f, of, x, y);
	for (int i = 0; whole && i < of->count; i++)
		whole = grow(s, seen, most, i, of);
	for (int i = 0; i < of->count; i++)
		seen[(ptrdiff_t)(of->y[i] - y) * ROW + MOST + of->x[i] - x] = 0;
	return whole;
}

/* Pixels along a side. */
static float size_of(const frame *f, const encre_params *p)
{
	return p->use_specks ? p->speck_size * f->scale : 0;
}

/* How many pixels islands have at most that are filled. */
static int most_of(const specks *s, float size)
{
	return size > 0 ? (int)min(s->drawn ? size * size : MOST, MOST) : 0;
}

static bool is_speck(const specks *s, const island *of, float size)
{
	int wide = of->right - of->left + 1, tall = of->bottom - of->y[0] + 1;
	float length = s->drawn ? 0 : (float)(wide > tall ? wide : tall);
	return of->count_around > 0 && (float)of->count <= max(size * size, narrow * size * length);
}

/* A point of a price, a star on a coat: light by its own colour, on what is around it, and not seen behind it as skin
 * is between hair. */
static bool is_mark(const island *of)
{
	float n = (float)of->count_around, depth = of->depth / n, own = of->own_depth / (float)of->count;
	return of->lightest - of->light / n > contrast && own - depth <= behind * depth &&
	       depth - own <= same_depth * depth;
}

static void fill(const specks *s, const island *of, int y0, int y1)
{
	float inked[4] = {0, 0, 0, 1};
	for (int k = 0; k < 3; k++)
		inked[k] = bounded(of->around[k] / (float)of->count_around);
	for (int i = 0; i < of->count; i++) {
		ptrdiff_t x = (ptrdiff_t)4 * of->x[i], y = of->y[i];
		if (y < y0 || y >= y1)
			continue;
		memcpy(output_row(s->f, ENCRE_OUTPUT_COMBINED, (int)y) + x, inked, sizeof inked);
		if (s->ink.data)
			memcpy(s->ink.data + y * s->ink.row + x, inked, sizeof inked);
	}
}

/* Of all islands that reach into its rows. */
static void fill_rows(void *data, int y0, int y1, int thread)
{
	const specks *s = data;
	const frame *f = s->f;
	uint8_t *seen = s->seen + (ptrdiff_t)thread * ROW * MOST;
	int farthest = 0;
	for (int i = 0; i < f->n_styles; i++) {
		int most = most_of(s, size_of(f, f->params + i));
		farthest = most > farthest ? most : farthest;
	}
	for (int y = y0 - farthest > 0 ? y0 - farthest : 0; y < y1 && !bands_stopped(f->bands); y++)
		for (int x = 0; x < f->width; x++) {
			if (!begins(s, x, y))
				continue;
			island of;
			float size = size_of(f, params_at(f, x, y));
			int most = most_of(s, size);
			if (most > 0 && find(s, seen, most, x, y, &of) && is_speck(s, &of, size) && !is_mark(&of))
				fill(s, &of, y0, y1);
		}
}

int32_t ISA(specks_fill)(frame *f, bool drawn, plane ink)
{
	specks *s = f->specks;
	if (!s)
		return ENCRE_OK;
	s->drawn = drawn;
	s->ink = ink;
	int32_t code = bands_run(f->bands, f->height, 0, light_rows, s);
	return code ? code : bands_run(f->bands, f->height, BAND, fill_rows, s);
}

static bool wanted(const frame *f)
{
	return f->any.use_specks;
}

static void plan(frame *f, arena *a)
{
	f->specks = NULL;
	if (!wanted(f))
		return;
	size_t seen = (size_t)bands_threads(f->bands) * ROW * MOST;
	specks *s = arena_take(a, 1, sizeof *s),
	       made = {.f = f,
		       .light = arena_take(a, (size_t)f->width * (size_t)f->height, 1),
		       .seen = arena_take(a, seen, 1)};
	if (s) {
		*s = made;
		memset(s->seen, 0, seen);
	}
	f->specks = s;
}

static int32_t run(frame *f)
{
	return ISA(specks_fill)(f, false, (plane){0});
}

const stage STAGE_SYMBOL(specks) = {.id = "specks", .plan = plan, .run = run, .draws = wanted};
