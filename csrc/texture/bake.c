/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Inter-color lines drawn into a texture (Herring 2016, 3.4 and A.2): the contrast of opposing neighbours gives each
 * texel the radius of a line, which darkens the texture. */
#include "texture/bake.h"
#include "edges/detect.h"
#include "base/metric.h"
#include "base/pixel.h"

#include <stdlib.h>

enum { PIECE = 64 }; /* texels of a row that are looked at together */

/* ---- texture -> differences ------------------------------------------------------------------------------ */

/* n texels `step` floats apart to planes, cut to 0..1. Returns how many values are not finite; these are 0. */
static inline int split(const float *restrict in, const ptrdiff_t step, int channels, int n, float *restrict r,
			float *restrict g, float *restrict b)
{
	int bad = 0;
	for (int i = 0; i < n; i++) {
		float u = in[i * step], v = in[i * step + 1], w = in[i * step + 2];
		int a = fabsf(u) <= FLT_MAX, d = fabsf(v) <= FLT_MAX, e = fabsf(w) <= FLT_MAX;
		bad += 3 - a - d - e;
		r[i] = a ? clamp01(u) : 0;
		g[i] = d ? clamp01(v) : 0;
		b[i] = e ? clamp01(w) : 0;
	}
	for (int i = 0; channels > 3 && i < n; i++)
		bad += !(fabsf(in[i * step + 3]) <= FLT_MAX);
	return bad;
}

static void decode(int n, float *restrict c)
{
	for (int i = 0; i < n; i++)
		c[i] = srgb_decode(c[i]);
}

/* Row y in the space of the metric, in three planes with one texel more at each end. */
static int load_row(const bake *b, int y, float *plane)
{
	const encre_image *image = &b->job->texture;
	const float *in = pixel_at(image, 0, y);
	ptrdiff_t step = (ptrdiff_t)(image->pixel_stride / 4);
	int n = b->width, metric = b->p->contrast_metric, bad;
	float *c[3] = {plane + 1, plane + b->padded + 1, plane + 2 * b->padded + 1};
	switch (step) { /* steps that the compiler knows make vectors */
	case 3: bad = split(in, 3, image->channels, n, c[0], c[1], c[2]); break;
	case 4: bad = split(in, 4, image->channels, n, c[0], c[1], c[2]); break;
	default: bad = split(in, step, image->channels, n, c[0], c[1], c[2]);
	}
	if (!b->job->linear && metric != contrast_metric_RGB)
		for (int k = 0; k < 3; k++)
			decode(n, c[k]);
	if (b->job->linear || metric != contrast_metric_RGB)
		ISA(metric_space)(metric, n, c[0], c[1], c[2]);
	for (int k = 0; k < 3; k++) {
		c[k][-1] = c[k][texel_index(-1, n, b->wrap_x)];
		c[k][n] = c[k][texel_index(n, n, b->wrap_x)];
	}
	return bad;
}

/* Whether no pair differs, as in most of a drawn texture: spares the metric, which may be dear. */
static bool flat(const float *(*row)[3], int n)
{
	int differ = 0;
	for (int c = 0; c < 3; c++) {
		const float *restrict above = row[0][c], *restrict here = row[1][c], *restrict below = row[2][c];
		for (int i = 0; i < n; i++)
			differ |= (above[i - 1] != below[i + 1]) | (above[i] != below[i]) |
				  (above[i + 1] != below[i - 1]) | (here[i - 1] != here[i + 1]);
	}
	return !differ;
}

static void difference_rows(void *data, int y0, int y1, int thread)
{
	const bake *b = data;
	int n = b->width;
	float *ring = b->ring + 9 * (size_t)thread * b->padded;
	for (int y = y0 - 1; y <= y1; y++) {
		int bad =
			load_row(b, texel_index(y, b->height, b->wrap_y), ring + 3 * (size_t)((y + 3) % 3) * b->padded);
		if (y >= y0 && y < y1)
			b->bad[y] = bad;
		if (y < y0 + 1)
			continue;
		float *out = b->radius + (ptrdiff_t)(y - 1) * n, greatest = 0;
		color_metric metric = metric_of(b->p);
		for (int x = 0; x < n; x += PIECE) {
			const float *row[3][3];
			int left = n - x < PIECE ? n - x : PIECE;
			for (int k = 0; k < 3; k++)
				for (int c = 0; c < 3; c++)
					row[k][c] =
						ring + (3 * (size_t)((y + 1 + k) % 3) + (size_t)c) * b->padded + 1 + x;
			if (flat(row, left))
				memset(out + x, 0, (size_t)left * sizeof *out);
			else
				ISA(detect_contrast)(&metric, row, left, out + x);
		}
		for (int x = 0; x < n; x++)
			greatest = out[x] > greatest ? out[x] : greatest;
		b->greatest[y - 1] = greatest;
		if (b->full)
			ISA(window_row)(&b->window, out, thread, b->full + (ptrdiff_t)(y - 1) * n);
	}
}

/* ---- differences -> radii -> ink ------------------------------------------------------------------------- */

static void radius_rows(void *data, int y0, int y1, int thread)
{
	(void)thread;
	const bake *b = data;
	float least = b->p->contrast_threshold, widest = 0.5f * b->p->line_thickness;
	for (int y = y0; y < y1; y++) {
		float *restrict radius = b->radius + (ptrdiff_t)y * b->width, reach = 0;
		const float *restrict full = b->full ? b->full + (ptrdiff_t)y * b->width : NULL;
		for (int x = 0; x < b->width; x++) {
			float most = !full ? b->p->contrast_full : full[x] > 0.25f ? full[x] : 0.25f;
			radius[x] = widest * metric_strength(radius[x], least, most);
		}
		for (int x = 0; x < b->width; x++) {
			float far = radius[x] > 0 ? ISA(stamp_reach)(b, x, y) : 0;
			reach = far > reach ? far : reach;
		}
		b->reach[y] = reach;
	}
}

/* Called with constant channels and steps each time. */
KERNEL void darken(const float *restrict in, const ptrdiff_t step, float *restrict out, const ptrdiff_t out_step,
		   const int channels, int n, const float *restrict dark)
{
	for (int i = 0; i < n; i++) {
		float light = 1 - (dark[i] < 1 ? dark[i] : 1);
		for (int c = 0; c < channels; c++) {
			float v = in[i * step + c];
			v = fabsf(v) <= FLT_MAX ? v : 0;
			out[i * out_step + c] = c < 3 ? v * light : v;
		}
	}
}

static void ink_rows(void *data, int y0, int y1, int thread)
{
	const bake *b = data;
	const encre_image *in = &b->job->texture, *out = &b->job->output;
	sheet s = {y0, y1, b->sheet + (size_t)thread * SHEET * b->padded};
	int far = (int)b->farthest, from = y0 - far, to = y1 + far;
	memset(s.dark, 0, (size_t)(y1 - y0) * b->padded * sizeof *s.dark);
	if (!b->wrap_y) {
		from = from < 0 ? 0 : from;
		to = to < b->height ? to : b->height;
	}
	for (int y = from; y < to; y++) {
		float reach = b->reach[texel_index(y, b->height, true)];
		if (reach > 0 && (float)y + reach >= (float)y0 && (float)y - reach < (float)y1)
			ISA(stamp_row)(b, &s, y);
	}
	for (int y = y0; y < y1; y++) {
		const float *row = pixel_at(in, 0, y), *dark = s.dark + (size_t)(y - y0) * b->padded;
		float *to_row = (float *)((char *)out->data + y * out->row_stride);
		ptrdiff_t step = (ptrdiff_t)(in->pixel_stride / 4), out_step = (ptrdiff_t)(out->pixel_stride / 4);
		if (step == 4 && out_step == 4 && in->channels == 4)
			darken(row, 4, to_row, 4, 4, b->width, dark);
		else if (step == 3 && out_step == 3)
			darken(row, 3, to_row, 3, 3, b->width, dark);
		else
			darken(row, step, to_row, out_step, in->channels, b->width, dark);
	}
}

/* ---- the whole ------------------------------------------------------------------------------------------- */

static void plan(bake *b, arena *a)
{
	size_t width = (size_t)b->width, height = (size_t)b->height, threads = (size_t)bands_threads(b->bands);
	b->padded = (width + 2 + LANES + 15) & ~(size_t)15;
	b->radius = arena_take(a, width * height, sizeof *b->radius);
	b->reach = arena_take(a, height, sizeof *b->reach);
	b->greatest = arena_take(a, height, sizeof *b->greatest);
	b->bad = arena_take(a, height, sizeof *b->bad);
	b->ring = arena_take(a, threads * 9 * b->padded, sizeof *b->ring);
	b->sheet = b->job->output.data ? arena_take(a, threads * SHEET * b->padded, sizeof *b->sheet) : NULL;
	b->full = NULL;
	if (b->p->contrast_local) {
		b->full = arena_take(a, width * height, sizeof *b->full);
		b->window =
			ISA(window_plan)(a, b->bands, b->width, b->height, b->p->contrast_window, b->wrap_x, b->wrap_y);
	}
}

static int32_t run(bake *b, encre_bake_job *result)
{
	bool draw = b->job->output.data;
	bands_span(b->bands, 0, draw ? 0.5 : 2); /* of a span a run takes half */
	int32_t code = bands_run(b->bands, b->height, 0, difference_rows, b);
	if (code)
		return code;
	result->nonfinite = 0;
	result->greatest = 0;
	for (int y = 0; y < b->height; y++) {
		result->nonfinite += b->bad[y];
		result->greatest = b->greatest[y] > result->greatest ? b->greatest[y] : result->greatest;
	}
	if (!draw)
		return ENCRE_OK;
	if (b->full)
		code = ISA(window_columns)(&b->window, b->bands, b->full);
	if (!code)
		code = bands_run(b->bands, b->height, 0, radius_rows, b);
	for (int y = 0; y < b->height; y++)
		b->farthest = b->reach[y] > b->farthest ? b->reach[y] : b->farthest;
	bands_span(b->bands, 0.5, 1.5);
	return code ? code : bands_run(b->bands, b->height, SHEET, ink_rows, b);
}

int32_t ISA(bake_run)(bands *pool, const encre_bake_job *job, encre_bake_job *result)
{
	bake b = {.job = job,
		  .p = job->params,
		  .width = job->texture.width,
		  .height = job->texture.height,
		  .wrap_x = job->wrap_x,
		  .wrap_y = job->wrap_y,
		  .bands = pool};
	arena a = {0};
	plan(&b, &a);
	void *memory = arena_make(&a);
	if (!memory)
		return ENCRE_ERROR_MEMORY;
	plan(&b, &a);
	int32_t code = run(&b, result);
	free(memory);
	return code;
}
