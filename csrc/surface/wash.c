/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Watercolour, from colour and light apart: paper seen through washes, paper * exp(-sum of optical densities) (after
 * Curtis et al. 1997 and Bousseau et al. 2006). What a thing's colour absorbs lies thin in the light and not at all in
 * the brightest, where the paper stays white; over it lie two glazes where light is less. Washes dry darker along their
 * own borders and along the things', lie unevenly, and leave gaps. All of it sticks to the things and is told from one
 * frame. */
#include "base/pixel.h"
#include "surface/solid.h"
#include "surface/tent.h"

#include <string.h>

enum { CHUNK = 256, BAND_ROWS = 64, WIDTHS = 2 /* of pools: narrow, wide */, NOISES = 4 };
enum { SHADE, DEEP, BODY, BORDER };    /* channels of the masks */
enum { WET, GAP, CLOUD, HUE, CLOUDS }; /* noises that are kept for the last pass */

static const float unit = 16384;                        /* of masks */
static const float shade_at = 0.5f, deep_at = 0.1f;     /* light at which the glazes end */
static const float soft_within = 80;                    /* pixels at 1080 over which a border gets fully soft */
static const float step_of_depth = 0.03f, alike = 0.6f; /* what parts two pixels */

typedef struct wash {
	frame *f;
	int reach[WIDTHS];
	float *lit;     /* width * height: 0 in the shade, 1 in full light */
	uint16_t *mask; /* width * height * TENT_CHANNELS */
	int16_t *cloud; /* width * height * CLOUDS */
	uint16_t *row[WIDTHS], *line;
	int32_t *sums[WIDTHS];
	int most;
} wash;

static inline float smooth(float from, float to, float x)
{
	float t = clamp01((x - from) / (to - from));
	return t * t * (3 - 2 * t);
}

/* ---- paint and light --------------------------------------------------------------------------------------- */

/* What is painted at a pixel: its colour, with what shines or mirrors beside it; of that the share, and highlights,
 * which are paper. Nothing there: what the world shows. */
typedef struct paint {
	float color[3], shines, highlight;
	bool there;
} paint;

static inline paint paint_at(const frame *f, int x, int y)
{
	const float *combined = layer_row(f, ENCRE_LAYER_COMBINED, y) + 4 * x,
		    *color = layer_row(f, ENCRE_LAYER_COLOR, y), *diffuse = layer_row(f, ENCRE_LAYER_DIFFUSE, y),
		    *highlights = layer_row(f, ENCRE_LAYER_HIGHLIGHTS, y);
	paint p = {.there = depth_of(layer_row(f, ENCRE_LAYER_DEPTH, y)[x]) < INFINITY};
	float alpha = combined[3], clear = alpha > 0 ? 1 / max(alpha, 1e-6f) : 0, other = 0, own = 0;
	for (int c = 0; c < 3; c++) {
		float high = highlights ? positive(highlights[3 * x + c]) : 0;
		float more =
			p.there ? positive(combined[c] - color[3 * x + c] * diffuse[3 * x + c] - high) : combined[c];
		float base = p.there ? clamp01(color[3 * x + c]) : 0;
		p.color[c] = clamp01((base + more) * (p.there ? 1 : clear));
		p.highlight = max(p.highlight, high);
		other = max(other, more);
		own = max(own, base);
	}
	p.shines = clamp01(other / max(other + own, 1e-6f));
	return p;
}

/* 1 of black, 0 of what is light: dark paint is put on thick in any light. */
static inline float darkness(const float color[3])
{
	return 1 - clamp01(pixel_cbrt(clamp01(luminance(color[0], color[1], color[2]))) / 0.75f);
}

static void light_rows(void *data, int y0, int y1, int thread)
{
	(void)thread;
	const wash *w = data;
	const frame *f = w->f;
	const float shade = 0.35f, full = 0.92f; /* as the meter has them */
	for (int y = y0; y < y1 && !bands_stopped(f->bands); y++)
		for (int x = 0; x < f->width; x++) {
			paint p = paint_at(f, x, y);
			float own = (exposed_at(f, params_at(f, x, y), x, y) - shade) / (full - shade);
			own = p.there ? max(min(own, 4), -4) : 0.6f;
			w->lit[(ptrdiff_t)f->width * y + x] = p.there ? mix(own, max(own, 0.75f), p.shines) : own;
		}
}

/* ---- masks of washes --------------------------------------------------------------------------------------- */

static bool parts(const frame *f, int x, int y, int u, int v)
{
	if (u < 0 || v < 0 || u >= f->width || v >= f->height)
		return false;
	const float *object[2] = {layer_row(f, ENCRE_LAYER_OBJECT, y), layer_row(f, ENCRE_LAYER_OBJECT, v)},
		    *material[2] = {layer_row(f, ENCRE_LAYER_MATERIAL, y), layer_row(f, ENCRE_LAYER_MATERIAL, v)};
	const float *a = layer_row(f, ENCRE_LAYER_NORMAL, y) + (ptrdiff_t)3 * x,
		    *b = layer_row(f, ENCRE_LAYER_NORMAL, v) + (ptrdiff_t)3 * u;
	float near = depth_of(layer_row(f, ENCRE_LAYER_DEPTH, y)[x]),
	      far = depth_of(layer_row(f, ENCRE_LAYER_DEPTH, v)[u]);
	if (!(near < INFINITY) && !(far < INFINITY))
		return false;
	return (object[0] && object[0][x] != object[1][u]) || (material[0] && material[0][x] != material[1][u]) ||
	       fabsf(near - far) > step_of_depth * min(near, far) || a[0] * b[0] + a[1] * b[1] + a[2] * b[2] < alike;
}

/* How fast light changes, per pixel, over a few. */
static float slope(const wash *w, int x, int y)
{
	const frame *f = w->f;
	int far = (int)max(1.5f * f->scale + 0.5f, 1);
	const float *row = w->lit + (ptrdiff_t)f->width * y;
	float across = row[clamp_index(x + far, f->width)] - row[clamp_index(x - far, f->width)];
	float down = w->lit[(ptrdiff_t)f->width * clamp_index(y + far, f->height) + x] -
		     w->lit[(ptrdiff_t)f->width * clamp_index(y - far, f->height) + x];
	return sqrtf(across * across + down * down) / (float)(2 * far);
}

/* Where less light than `at` falls: over `wide`, and softer where the paper is wet. */
static inline float glaze(float at, float wide, float soft, float lit)
{
	float half = 0.5f * (wide + 0.5f * soft) + 0.012f;
	return 1 - smooth(at - half, at + half, lit);
}

static inline int16_t kept(float noise)
{
	return (int16_t)nearest_int(max(min(noise, 4), -4) * 8000);
}

static void mask_pixel(const wash *w, int x, int y, uint32_t seed, solid_memory *memory)
{
	const frame *f = w->f;
	const encre_params *p = params_at(f, x, y);
	ptrdiff_t i = (ptrdiff_t)f->width * y + x;
	uint16_t *mask = w->mask + TENT_CHANNELS * i;
	int16_t *cloud = w->cloud + CLOUDS * i;
	if (!p->use_wash) {
		memset(mask, 0, TENT_CHANNELS * sizeof *mask);
		return;
	}
	float size = f->params->wash_size * f->scale, wide[2], big[2], mid[2], fine[2] = {0};
	solid_place at = solid_place_of(f, x, y);
	solid_noise(&at, 5 * size, seed + 1, memory + 0, wide);
	solid_noise(&at, size, seed + 2, memory + 1, big);
	solid_noise(&at, 0.4f * size, seed + 3, memory + 2, mid);
	float wet = smooth(-0.15f, 0.55f, big[1]) * p->wash_wet;
	cloud[WET] = kept(wet);
	cloud[GAP] = kept(mid[1]);
	cloud[CLOUD] = kept(p->wash_uneven * (0.053f * big[0] + 0.037f * mid[0] + 0.13f * wide[0]));
	cloud[HUE] = kept(0.55f * p->wash_uneven * (wide[1] + big[0]));
	paint own = paint_at(f, x, y);
	/* Both grow with the slope of light: a wall that is lit evenly would get blotches as a soft border's share. */
	float steep = f->scale * slope(w, x, y), stray = min(0.1f, p->wash_wobble * steep);
	float soft = min(wet, soft_within * steep);
	if (stray > 0)
		solid_noise(&at, 0.1f * size, seed + 4, memory + 3, fine);
	float lit = w->lit[i] + stray * (0.6f * mid[0] + 0.4f * fine[0]);
	float cover[TENT_CHANNELS] = {0, 0, 1, 0};
	if (own.there) {
		cover[SHADE] = glaze(shade_at, 0.05f, soft, lit);
		cover[DEEP] = glaze(deep_at, 0.1f, soft, lit);
		cover[BODY] = glaze(p->wash_white, 0.22f, soft, lit);
		cover[BODY] += (1 - cover[BODY]) * min(1.6f * darkness(own.color), 0.8f);
	}
	cover[BORDER] = parts(f, x, y, x - 1, y) || parts(f, x, y, x + 1, y) || parts(f, x, y, x, y - 1) ||
			parts(f, x, y, x, y + 1);
	for (int c = 0; c < TENT_CHANNELS; c++)
		mask[c] = (uint16_t)(clamp01(cover[c]) * unit + 0.5f);
}

static void mask_rows(void *data, int y0, int y1, int thread)
{
	const wash *w = data;
	const frame *f = w->f;
	uint32_t seed = (uint32_t)f->params->wash_seed * 16;
	int width = f->width, room = w->most + 1;
	uint16_t *line =
		w->line + (size_t)thread * TENT_CHANNELS * (size_t)(width + 2 * room) + (ptrdiff_t)TENT_CHANNELS * room;
	for (int y = y0; y < y1 && !bands_stopped(f->bands); y++) {
		solid_memory memory[NOISES] = {0};
		for (int x = 0; x < width; x++)
			mask_pixel(w, x, y, seed, memory);
		const uint16_t *mask = w->mask + (ptrdiff_t)TENT_CHANNELS * width * y;
		memcpy(line, mask, (size_t)width * TENT_CHANNELS * sizeof *line);
		for (int k = 1; k <= room; k++) {
			memcpy(line - (ptrdiff_t)TENT_CHANNELS * k, line, TENT_CHANNELS * sizeof *line);
			memcpy(line + (ptrdiff_t)TENT_CHANNELS * (width - 1 + k),
			       line + (ptrdiff_t)TENT_CHANNELS * (width - 1), TENT_CHANNELS * sizeof *line);
		}
		for (int k = 0; k < WIDTHS; k++)
			if (w->reach[k])
				ISA(tent_row)(width, w->reach[k], line,
					      w->row[k] + (ptrdiff_t)TENT_CHANNELS * width * y);
	}
}

/* ---- pigment ----------------------------------------------------------------------------------------------- */

/* How much darker a wash dries along its border: what it is more than its surroundings. */
static inline float pool(const float mask[], float (*around)[TENT_CHANNELS], int wash)
{
	return clamp01(mask[wash] - around[0][wash]) + 0.5f * clamp01(mask[wash] - around[1][wash]);
}

/* What a colour absorbs at density 1. Paint has no black: that of darks is capped, of all channels together, or greens
 * would turn grey. */
static inline void absorption(const encre_params *p, const paint *own, float hue, float k[3])
{
	float gray = luminance(own->color[0], own->color[1], own->color[2]), most = 0, least = INFINITY;
	float turn[3] = {1 + 0.05f * hue, 1, 1 - 0.05f * hue};
	for (int c = 0; c < 3; c++) {
		float value = (gray + p->wash_color * (own->color[c] - gray)) * mix(1, turn[c], min(p->wash_color, 1));
		k[c] = -pixel_log(max(min(value, 0.985f), 0.012f));
		most = max(most, k[c]);
		least = min(least, k[c]);
	}
	float mean = 0.5f * (most + least) / 2.9f, cap = p->wash_density / sqrtf(1 + mean * mean);
	for (int c = 0; c < 3; c++)
		k[c] *= cap;
}

static void paint_pixel(const wash *w, const encre_params *p, int x, int y, const float mask[],
			float (*around)[TENT_CHANNELS], float paper, const float glazed[3], solid_memory *memory,
			float *rgba)
{
	const frame *f = w->f;
	ptrdiff_t i = (ptrdiff_t)f->width * y + x;
	const int16_t *kept = w->cloud + CLOUDS * i;
	float wet = (float)kept[WET] / 8000, gap = (float)kept[GAP] / 8000, cloud = (float)kept[CLOUD] / 8000,
	      lit = w->lit[i];
	paint own = paint_at(f, x, y);
	float k[3], dark = darkness(own.color);
	absorption(p, &own, (float)kept[HUE] / 8000, k);
	float pools = p->wash_pooling * (1 - wet) * (0.75f + 0.5f * clamp01(0.5f + gap));
	float near = min(0.5f * (float)w->reach[0] * around[0][BORDER], 1),
	      wide = min(0.5f * (float)w->reach[1] * around[1][BORDER], 1);
	float rim = 0.55f * near * near + 0.25f * wide * wide;
	float body = mix(0.52f, 0.95f, 1 - smooth(0.35f, 0.95f, lit));
	body += (1 - body) * clamp01(1.6f * dark);
	body = own.there ? body * (0.3f + 0.7f * mask[BODY]) : 0;
	body = body * (1 + cloud) + pools * (0.55f * rim + 0.5f * pool(mask, around, BODY));
	float shade = mask[SHADE] * (1 + 1.2f * cloud) +
		      pools * (1.5f * pool(mask, around, SHADE) + 0.35f * mask[SHADE] * rim);
	float deep = mask[DEEP] * (1 + 1.2f * cloud) + 1.4f * pools * pool(mask, around, DEEP);
	if (!own.there) { /* the sky thins downward */
		float down = ((float)(f->place.y + y) + 0.5f) / (float)f->place.height;
		body = max(min(0.95f - 0.9f * down + 0.4f * cloud + 0.02f * gap, 1.1f), 0.04f) * 0.8f;
		body += 0.12f * pools * rim;
	}
	float density[3], sum = 0, more = 0.26f * (mask[SHADE] + 0.5f * mask[DEEP]);
	for (int c = 0; c < 3; c++) {
		density[c] = k[c] * (body + more * pixel_exp(-0.8f * k[c])) + positive(shade + 1.4f * deep) * glazed[c];
		density[c] = positive(density[c]);
		sum += density[c] / 3;
	}
	/* pigment settles in valleys of all sizes, where a wash is neither thin nor black */
	float grain = p->wash_granulation * smooth(0.03f, 0.35f, sum) * (1 - smooth(1.2f, 2.6f, sum));
	float size = f->scale, narrow[2] = {0}, broad[2] = {0};
	solid_place at = {{(float)(f->place.x + x), (float)(f->place.y + y), 0}, 1, 0};
	if (grain > 0) {
		solid_noise(&at, 5 * size, 11, memory, narrow);
		solid_noise(&at, 13 * size, 12, memory + 1, broad);
	}
	float tooth = 0.35f * (paper - 0.5f) + 0.2f * (narrow[0] + broad[0]), valley = clamp01(0.2f - 3 * tooth);
	float left = own.there ? p->wash_gaps * mask[BORDER] * smooth(0.15f, 0.45f, gap) * smooth(0.3f, 0.8f, lit) : 0;
	float all = positive(1 + grain * (2.2f * valley - 0.6f)) * (1 - left);
	float bare = own.there ? clamp01(1.2f * own.highlight - 0.12f) : 0;
	for (int c = 0; c < 3; c++) {
		float sheet = f->params->wash_paper[c] * (1 + 0.035f * (paper - 0.5f));
		rgba[c] = bounded(mix(sheet * pixel_exp(-all * density[c]), sheet, bare) * rgba[3]);
	}
}

static void paint_run(const wash *w, const encre_params *p, int32_t *const sums[WIDTHS], int y, int x, int n)
{
	const frame *f = w->f;
	const float middle = 0.8f; /* of heights of paper */
	solid_memory memory[2] = {0};
	float glazed[3];
	for (int c = 0; c < 3; c++)
		glazed[c] = -pixel_log(max(min(p->wash_glaze[c], 1), 0.05f)) * p->wash_shade;
	float paper[CHUNK], *out = output_row(f, ENCRE_OUTPUT_COMBINED, y) + (ptrdiff_t)4 * x;
	if (p->wash_granulation > 0)
		ISA(paper_row)(f, y, x, x + n, middle, paper);
	for (int i = 0; !(p->wash_granulation > 0) && i < n; i++)
		paper[i] = middle;
	for (int i = 0; i < n; i++) {
		float mask[TENT_CHANNELS], around[WIDTHS][TENT_CHANNELS];
		ptrdiff_t at = TENT_CHANNELS * ((ptrdiff_t)f->width * y + x + i);
		for (int c = 0; c < TENT_CHANNELS; c++) {
			mask[c] = (float)w->mask[at + c] / unit;
			for (int k = 0; k < WIDTHS; k++)
				around[k][c] = w->reach[k] ? (float)sums[k][TENT_CHANNELS * (x + i) + c] /
								     (unit * (float)(w->reach[k] * w->reach[k]))
							   : mask[c];
		}
		paint_pixel(w, p, x + i, y, mask, around, 0.5f + 2.5f * (paper[i] - middle), glazed, memory,
			    out + 4 * i);
	}
}

static void paint_rows(void *data, int y0, int y1, int thread)
{
	const wash *w = data;
	const frame *f = w->f;
	int32_t *sums[WIDTHS];
	for (int k = 0; k < WIDTHS; k++) {
		sums[k] = w->reach[k] ? w->sums[k] + (size_t)thread * 3 * TENT_CHANNELS * (size_t)f->width : NULL;
		if (w->reach[k])
			ISA(tent_begin)(w->row[k], f->width, f->height, w->reach[k], y0, sums[k]);
	}
	for (int y = y0; y < y1 && !bands_stopped(f->bands); y++) {
		for (int x = 0, end; x < f->width; x = end) {
			const encre_params *p = style_run(f, y, x, f->width - x > CHUNK ? x + CHUNK : f->width, &end);
			if (p->use_wash)
				paint_run(w, p, sums, y, x, end - x);
		}
		for (int k = 0; k < WIDTHS; k++)
			if (w->reach[k])
				ISA(tent_next)(w->row[k], f->width, f->height, w->reach[k], y, sums[k]);
	}
}

/* ---- stage ------------------------------------------------------------------------------------------------- */

static bool wanted(const frame *f)
{
	return f->any.use_wash;
}

static int reach_of(const frame *f, float width)
{
	int reach = (int)min(width * f->scale + 0.5f, TENT_MOST);
	return reach > 1 ? reach : 0; /* of 1 it has the pixel alone */
}

/* How far into a wash its darker border reaches, in units of length. */
static const float pool_width = 22;

static void plan(frame *f, arena *a)
{
	f->wash = NULL;
	if (!wanted(f))
		return;
	size_t width = (size_t)f->width, n = width * (size_t)f->height, threads = (size_t)bands_threads(f->bands);
	wash *w = arena_take(a, 1, sizeof *w), made = {.f = f};
	made.reach[0] = reach_of(f, pool_width / 3);
	made.reach[1] = reach_of(f, pool_width);
	made.most = made.reach[1];
	made.lit = arena_take(a, n, sizeof *made.lit);
	made.mask = arena_take(a, n, TENT_CHANNELS * sizeof *made.mask);
	made.cloud = arena_take(a, n, CLOUDS * sizeof *made.cloud);
	made.line = arena_take(a, threads * (width + 2 * (size_t)made.most + 2), TENT_CHANNELS * sizeof *made.line);
	for (int k = 0; k < WIDTHS; k++)
		if (made.reach[k]) {
			made.row[k] = arena_take(a, n, TENT_CHANNELS * sizeof *made.row[k]);
			made.sums[k] = arena_take(a, threads * width, 3 * TENT_CHANNELS * sizeof *made.sums[k]);
		}
	if (w)
		*w = made;
	f->wash = w;
}

static int32_t run(frame *f)
{
	wash *w = f->wash;
	if (!w)
		return ENCRE_OK;
	int32_t code = bands_run(f->bands, f->height, 0, light_rows, w);
	code = code ? code : bands_run(f->bands, f->height, 0, mask_rows, w);
	return code ? code : bands_run(f->bands, f->height, BAND_ROWS, paint_rows, w);
}

const stage STAGE_SYMBOL(wash) = {.id = "wash", .plan = plan, .run = run, .draws = wanted};
