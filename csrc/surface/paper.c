/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The paper under pencil lines and hatching (Vainumäe 2020, 4.3): a sheet of heights that tiles the frame. The
 * built-in sheets are pressed from noise of many sizes, by whole numbers only, so that every build has the same; their
 * recipe is docs/paper.md. */
#include "base/pixel.h"
#include "base/stage.h"

#include <float.h>
#include <stdlib.h>
#include <string.h>

enum {
	SIZE = 512,
	SIZE_BITS = 9,
	FIBRES = 8192,
	LEVELS = 16384,
	WIDEST = 8 /* texels each way that are pressed together */,
	LEVELLED = 7 /* and whose mean is taken away */,
	PIT_FROM = 84712,
	WIRES = 3 /* bits of the texels from one laid line to the next */,
	CHAINS = 7 /* and from one chain line to the next */
};

/* What sheets are pressed from: how much of tooth of 2, 3, 5 and 9 texels, of fibers, pits and laid lines. Heights
 * within a sheet differ by less than 2^21, so that levels hold them. */
static const struct sheet_kind {
	uint32_t tooth[4], fibers, pits, laid;
} sheet_kinds[] = {
	[paper_source_COLD_PRESS] = {{256, 64, 8, 1}, 16, 12, 0}, [paper_source_ROUGH] = {{192, 64, 16, 4}, 16, 24, 0},
	[paper_source_HOT_PRESS] = {{320, 16, 0, 0}, 56, 0, 0},   [paper_source_LAID] = {{256, 32, 2, 0}, 24, 0, 48},
	[paper_source_BRISTOL] = {{160, 96, 6, 1}, 28, 0, 0},
};

typedef struct paper {
	const encre_image *image; /* NULL: the built-in sheet */
	int width, height;
	ptrdiff_t row; /* width + 1: the first column stands again after the last */
	float *sheet;
	float scale, roughness;
	int32_t *column; /* per pixel of a row: texel to the left, and how far towards the next */
	float *share;
} paper;

/* The built-in sheet, which a context keeps from frame to frame. */
typedef struct built_in {
	uint32_t key;
	int32_t kind;
	float sheet[SIZE * (SIZE + 1)];
} built_in;

/* In the making. */
typedef struct pulp {
	const struct sheet_kind *kind;
	uint32_t key;
	float *sheet;
	uint32_t ground[SIZE * SIZE], pulp[SIZE * SIZE], felt[SIZE * SIZE], count[LEVELS];
	uint16_t level[SIZE * SIZE];
} pulp;

/* ---- the built-in sheet ---------------------------------------------------------------------------------- */

/* A sine of two parabolas; a full turn is 2^32, the height one texel of fibre(). */
static uint32_t wave(uint32_t a)
{
	uint32_t p = a >> 16, q = p & 32767, s = q * (32768 - q) >> 5;
	return p < 32768 ? s : 0 - s;
}

/* Positions are shares of the tile in 2^32, so overflow is the wrap. */
static void fibre(pulp *p, uint32_t m)
{
	uint32_t x = mix_bits(m + p->key), y = mix_bits(m + 1 + p->key), a = mix_bits(m + 2 + p->key),
		 c = mix_bits(m + 3 + p->key);
	uint32_t n = 16 + (c & 31), ink = 16 + 2 * (c >> 5 & 7);
	uint32_t turn = ((c >> 8 & 65535) - 32768) << 9, bend = ((c >> 24) - 128) << 13;
	for (uint32_t t = 0; t < n; t++) {
		uint32_t end = t + 1 < n - t ? t + 1 : n - t;
		p->pulp[(y >> (32 - SIZE_BITS)) * SIZE + (x >> (32 - SIZE_BITS))] += (end < 4 ? end : 4) * ink;
		x += wave(a + 0x40000000u);
		y += wave(a);
		a += turn;
		turn += bend;
	}
}

static void ground_rows(void *data, int y0, int y1, int thread)
{
	(void)thread;
	pulp *p = data;
	uint32_t key = p->key, *restrict out = p->ground;
	for (uint32_t i = (uint32_t)y0 * SIZE; i < (uint32_t)y1 * SIZE; i++)
		out[i] = mix_bits(i + key);
	memset(p->pulp + (ptrdiff_t)y0 * SIZE, 0, (size_t)(y1 - y0) * SIZE * sizeof *p->pulp);
}

static const uint32_t *wrapped_row(const uint32_t *tile, int y)
{
	return tile + (ptrdiff_t)(y & (SIZE - 1)) * SIZE;
}

/* Sums down columns, with `reach` wrapped sums on either side. */
static void wrap_columns(uint32_t *sum, int reach)
{
	memcpy(sum, sum + SIZE, (size_t)reach * sizeof *sum);
	memcpy(sum + reach + SIZE, sum + reach, (size_t)reach * sizeof *sum);
}

/* A row of what a tile has in its bits from `shift` on that `mask` leaves, weighted by a triangle: `size` in the
 * middle, 0 so many texels away. */
KERNEL void spread_row(const uint32_t *tile, int y, int shift, uint32_t mask, const int size, uint32_t *restrict out)
{
	uint32_t sum[SIZE + 2 * WIDEST] = {0};
	for (int k = 1 - size; k < size; k++) {
		const uint32_t *restrict in = wrapped_row(tile, y + k);
		uint32_t weight = (uint32_t)(size - (k < 0 ? -k : k));
		for (int x = 0; x < SIZE; x++)
			sum[WIDEST + x] += weight * (in[x] >> shift & mask);
	}
	wrap_columns(sum, WIDEST);
	memset(out, 0, SIZE * sizeof *out);
	for (int k = 1 - size; k < size; k++) {
		uint32_t weight = (uint32_t)(size - (k < 0 ? -k : k));
		for (int x = 0; x < SIZE; x++)
			out[x] += weight * sum[WIDEST + x + k];
	}
}

/* Laid paper's wires leave a wave down the sheet, and the chains that hold them a groove every so many columns. */
static uint32_t laid(int x, int y)
{
	uint32_t aside = (uint32_t)(x & ((1 << CHAINS) - 1)), near = aside < 4 ? 4 - aside : 0;
	return (wave((uint32_t)y << (32 - WIRES)) + (3u << 23) - (near << 22)) >> 12;
}

/* Tooth of four sizes, fibres, pits, and lines. */
static void press_rows(void *data, int y0, int y1, int thread)
{
	(void)thread;
	pulp *p = data;
	const struct sheet_kind *kind = p->kind;
	const uint32_t *tooth = kind->tooth;
	for (int y = y0; y < y1; y++) {
		uint32_t a[SIZE], b[SIZE], c[SIZE], d[SIZE], fibres[SIZE], pits[SIZE];
		uint32_t *restrict out = p->felt + (ptrdiff_t)y * SIZE;
		spread_row(p->ground, y, 0, 255, 2, a);
		spread_row(p->ground, y, 8, 255, 3, b);
		spread_row(p->ground, y, 16, 255, 5, c);
		spread_row(p->ground, y, 24, 255, 9, d);
		spread_row(p->ground, y + SIZE / 2, 24, 255, 5, pits);
		spread_row(p->pulp, y, 0, UINT32_MAX, 2, fibres);
		for (int x = 0; x < SIZE; x++) {
			uint32_t pit = pits[(x + SIZE / 2) & (SIZE - 1)];
			pit = pit > PIT_FROM ? pit - PIT_FROM : 0;
			out[x] = (1u << 20) + tooth[0] * a[x] + tooth[1] * b[x] + tooth[2] * c[x] + tooth[3] * d[x] +
				 kind->fibers * fibres[x] + kind->laid * laid(x, y) - kind->pits * pit;
		}
	}
}

static void level_rows(void *data, int y0, int y1, int thread)
{
	(void)thread;
	pulp *p = data;
	for (int y = y0; y < y1; y++) {
		const uint32_t *restrict felt = wrapped_row(p->felt, y);
		uint32_t sum[SIZE + 2 * LEVELLED] = {0}, around[SIZE] = {0};
		uint16_t *restrict out = p->level + (ptrdiff_t)y * SIZE;
		for (int k = -LEVELLED; k <= LEVELLED; k++) {
			const uint32_t *restrict in = wrapped_row(p->felt, y + k);
			for (int x = 0; x < SIZE; x++)
				sum[LEVELLED + x] += in[x];
		}
		wrap_columns(sum, LEVELLED);
		for (int k = 0; k <= 2 * LEVELLED; k++)
			for (int x = 0; x < SIZE; x++)
				around[x] += sum[x + k];
		for (int x = 0; x < SIZE; x++) {
			int32_t level = (int32_t)(225 * felt[x] + (1u << 28) - around[x]);
			level = level > 0 ? level >> 15 : 0;
			out[x] = (uint16_t)(level < LEVELS - 1 ? level : LEVELS - 1);
		}
	}
}

/* count becomes each level's rank: twice the texels below it and once its own. */
static void rank_levels(pulp *p)
{
	uint32_t below = 0;
	memset(p->count, 0, LEVELS * sizeof *p->count);
	for (int i = 0; i < SIZE * SIZE; i++)
		p->count[p->level[i]]++;
	for (int i = 0; i < LEVELS; i++) {
		uint32_t same = p->count[i];
		p->count[i] = 2 * below + same;
		below += same;
	}
}

static void spread_rows(void *data, int y0, int y1, int thread)
{
	(void)thread;
	pulp *p = data;
	for (int y = y0; y < y1; y++) {
		const uint16_t *level = p->level + (ptrdiff_t)y * SIZE;
		float *out = p->sheet + (ptrdiff_t)y * (SIZE + 1);
		for (int x = 0; x < SIZE; x++)
			out[x] = 0.6f + 0.4f * ((float)p->count[level[x]] / (2.0f * SIZE * SIZE));
		out[SIZE] = out[0];
	}
}

static int32_t make_sheet(frame *f, pulp *p)
{
	bands_kernel kernels[] = {press_rows, level_rows, spread_rows};
	int32_t code = bands_run(f->bands, SIZE, 0, ground_rows, p);
	for (uint32_t k = 0; !code && k < FIBRES; k++) {
		fibre(p, SIZE * SIZE + 4 * k);
		if (k % 256 == 0 && bands_stopped(f->bands))
			code = ENCRE_ERROR_CANCELLED;
	}
	for (int i = 0; !code && i < 3; i++) {
		if (kernels[i] == spread_rows)
			rank_levels(p);
		code = bands_run(f->bands, SIZE, 0, kernels[i], p);
	}
	return code;
}

/* Made, or that of an earlier frame; kept only when it is whole. */
static int32_t built_in_sheet(frame *f, paper *p)
{
	uint32_t key = mix_bits((uint32_t)f->params->paper_seed + 1);
	int32_t kind = f->params->paper_source;
	built_in *kept = *f->kept_sheet;
	int32_t code = ENCRE_OK;
	if (!kept || kept->key != key || kept->kind != kind) {
		pulp *made = late_take(&f->late, 1, sizeof *made);
		free(kept);
		*f->kept_sheet = NULL;
		kept = made ? malloc(sizeof *kept) : NULL;
		if (!kept)
			return ENCRE_ERROR_MEMORY;
		made->kind = sheet_kinds + kind;
		made->key = kept->key = key;
		kept->kind = kind;
		made->sheet = kept->sheet;
		code = make_sheet(f, made);
		late_drop(&f->late, made);
		if (code)
			free(kept);
		else
			*f->kept_sheet = kept;
	}
	if (!code)
		p->sheet = kept->sheet;
	return code;
}

/* ---- the user's sheet ------------------------------------------------------------------------------------ */

/* What is not a number, or too large to interpolate, is a hole. */
static float clean_height(float v)
{
	return fabsf(v) <= 1e30f ? v : 0;
}

/* A scan's own mean is not to tell how much pencil there is. */
static void center(const paper *p)
{
	const float level = 0.8f;
	double sum = 0;
	for (int y = 0; y < p->height; y++)
		for (int x = 0; x < p->width; x++)
			sum += (double)p->sheet[y * p->row + x];
	float more = level - (float)(sum / ((double)p->width * p->height));
	for (int y = 0; y < p->height; y++)
		for (int x = 0; x <= p->width; x++)
			p->sheet[y * p->row + x] += more;
}

static void image_rows(void *data, int y0, int y1, int thread)
{
	(void)thread;
	const paper *p = data;
	const encre_image image = with_strides(*p->image);
	for (int y = y0; y < y1; y++) {
		float *out = p->sheet + y * p->row;
		for (int x = 0; x < p->width; x++) {
			const float *in = pixel_at(&image, x, y);
			out[x] = image.channels < 3
					 ? clean_height(in[0])
					 : luminance(clean_height(in[0]), clean_height(in[1]), clean_height(in[2]));
		}
		out[p->width] = out[0];
	}
}

/* ---- from texels to pixels ------------------------------------------------------------------------------- */

/* Texel at or before pixel `at` of the full frame, within a sheet of n texels, and how far towards the next. */
static int32_t texel(const paper *p, int at, int n, float *share)
{
	double u = ((double)at + 0.5) / (double)p->scale - 0.5, whole = (double)(int64_t)u;
	whole -= whole > u;
	*share = (float)(u - whole);
	return (int32_t)(((int64_t)whole % n + n) % n);
}

static inline float rough(float raw, float roughness)
{
	return clamp01(0.8f + (raw - 0.8f) * roughness);
}

static void copied_row(int n, const float *restrict raw, float roughness, float *restrict height)
{
	for (int i = 0; i < n; i++)
		height[i] = rough(raw[i], roughness);
}

static void sampled_row(int n, const float *restrict above, const float *restrict below, const int32_t *restrict column,
			const float *restrict share, float down, float roughness, float *restrict height)
{
	for (int i = 0; i < n; i++) {
		const float *a = above + column[i], *b = below + column[i];
		float t = share[i];
		height[i] = rough(mix(mix(a[0], a[1], t), mix(b[0], b[1], t), down), roughness);
	}
}

void ISA(paper_row)(const frame *f, int y, int x0, int x1, float none, float *height)
{
	const paper *p = f->paper;
	if (!p) {
		for (int x = x0; x < x1; x++)
			height[x - x0] = none;
		return;
	}
	float down;
	int32_t j = texel(p, f->place.y + y, p->height, &down);
	const float *above = p->sheet + j * p->row, *below = j + 1 < p->height ? above + p->row : p->sheet;
	for (int x = x0, n; x < x1; x += n)
		if (p->scale == 1) { /* every pixel has a texel of its own */
			int32_t i = p->column[x];
			n = p->width - i < x1 - x ? p->width - i : x1 - x;
			for (int k = 0; k < n; k += 16) /* what is drawn goes on in the next row */
				__builtin_prefetch(below + i + k);
			copied_row(n, above + i, p->roughness, height + (x - x0));
		} else {
			n = x1 - x;
			sampled_row(n, above, below, p->column + x, p->share + x, down, p->roughness,
				    height + (x - x0));
		}
}

/* ---- stage ----------------------------------------------------------------------------------------------- */

static bool rubs(const encre_params *p)
{
	return p->use_tones && (p->tone_1 == tone_1_GRAIN || p->tone_2 == tone_2_GRAIN || p->tone_3 == tone_3_GRAIN ||
				p->tone_4 == tone_4_GRAIN || p->tone_5 == tone_5_GRAIN || p->tone_6 == tone_6_GRAIN);
}

static bool wanted(const frame *f)
{
	const encre_params *scene = f->params;
	if (scene->paper_source == paper_source_NONE ||
	    (scene->paper_source == paper_source_IMAGE && !scene->paper_image.data))
		return false;
	for (int i = 0; i < f->n_styles; i++)
		if ((f->params[i].use_lines && f->params[i].pen_1_grain > 0) ||
		    (f->params[i].use_relief && f->params[i].paper_relief > 0) ||
		    (f->params[i].use_wash && f->params[i].wash_granulation > 0) ||
		    ((f->params[i].use_hatching || rubs(f->params + i)) && f->params[i].hatch_amount > 0))
			return true;
	return false;
}

static void plan(frame *f, arena *a)
{
	f->paper = NULL;
	if (!wanted(f))
		return;
	const encre_params *scene = f->params;
	paper p = {.width = SIZE,
		   .height = SIZE,
		   .scale = scene->paper_scale * f->scale,
		   .roughness = scene->paper_roughness};
	if (scene->paper_source == paper_source_IMAGE) {
		p.image = &scene->paper_image;
		p.width = p.image->width;
		p.height = p.image->height;
	}
	p.row = (ptrdiff_t)p.width + 1;
	if (p.image)
		p.sheet = arena_take(a, (size_t)p.row * (size_t)p.height, sizeof *p.sheet);
	p.column = arena_take(a, (size_t)f->width, sizeof *p.column);
	p.share = arena_take(a, (size_t)f->width, sizeof *p.share);
	f->paper = arena_take(a, 1, sizeof p);
	if (f->paper)
		memcpy(f->paper, &p, sizeof p);
}

static int32_t prepare(frame *f)
{
	paper *p = f->paper;
	if (!p)
		return ENCRE_OK;
	for (int x = 0; x < f->width; x++)
		p->column[x] = texel(p, f->place.x + x, p->width, p->share + x);
	int32_t code = p->image ? bands_run(f->bands, p->height, 0, image_rows, p) : built_in_sheet(f, p);
	if (!code && p->image)
		center(p);
	return code;
}

const stage STAGE_SYMBOL(paper) = {.id = "paper", .plan = plan, .prepare = prepare};
