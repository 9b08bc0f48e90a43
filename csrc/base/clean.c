/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Layers as stages may trust them. Most frames are clean and packed already: one pass of reading finds that out, and
 * nothing is copied. */
#include "base/clean.h"

#include <float.h>
#include <math.h>
#include <stdatomic.h>

typedef struct clean {
	const encre_image *image;
	int layer;
	float *to;
	atomic_llong bad;
	atomic_bool unclean;
} clean;

static float limit_of(int layer)
{
	return layer == ENCRE_LAYER_CONTROLS ? 1.0f : FLT_MAX;
}

static const float *row_at(const encre_image *image, int y)
{
	return (const float *)((const char *)image->data + y * image->row_stride);
}

/* Counts of n adjacent values; *over: one is beyond the limit. */
static long long count_row(const float *restrict in, int n, bool depth, float limit, int *over)
{
	int nan = 0, inf = 0, out = 0;
	for (int i = 0; i < n; i++) {
		float a = fabsf(in[i]);
		nan += !(a <= INFINITY);
		inf += a > FLT_MAX;
		out |= a > limit;
	}
	*over |= out;
	return nan + (depth ? 0 : inf);
}

static void scan_rows(void *data, int y0, int y1, int thread)
{
	(void)thread;
	clean *c = data;
	const encre_image *image = c->image;
	ptrdiff_t step = (ptrdiff_t)(image->pixel_stride / 4);
	bool depth = c->layer == ENCRE_LAYER_DEPTH;
	float limit = limit_of(c->layer);
	long long bad = 0;
	int over = 0;
	for (int y = y0; y < y1; y++) {
		const float *in = row_at(image, y);
		if (packed(image))
			bad += count_row(in, image->width * image->channels, depth, limit, &over);
		else
			for (int x = 0; x < image->width; x++)
				bad += count_row(in + x * step, image->channels, depth, limit, &over);
	}
	atomic_fetch_add(&c->bad, bad);
	if (over)
		atomic_store(&c->unclean, true);
}

static void copy_rows(void *data, int y0, int y1, int thread)
{
	(void)thread;
	clean *c = data;
	const encre_image *image = c->image;
	ptrdiff_t step = (ptrdiff_t)(image->pixel_stride / 4);
	int channels = image->channels;
	bool depth = c->layer == ENCRE_LAYER_DEPTH;
	float limit = limit_of(c->layer);
	for (int y = y0; y < y1; y++) {
		const float *in = row_at(image, y);
		float *out = c->to + (size_t)y * (size_t)image->width * (size_t)channels;
		for (int x = 0; x < image->width; x++)
			for (int k = 0; k < channels; k++) {
				float v = in[x * step + k];
				float finite = fabsf(v) <= FLT_MAX ? v : 0;
				float inside = finite > limit ? limit : finite < -limit ? -limit : finite;
				out[x * channels + k] = depth ? v : inside;
			}
	}
}

int32_t clean_scan(bands *pool, const encre_image *image, int layer, int64_t *bad, bool *copy)
{
	clean c = {.image = image, .layer = layer};
	int32_t code = bands_run(pool, image->height, 0, scan_rows, &c);
	long long found = atomic_load(&c.bad);
	*bad += found;
	*copy = !packed(image) || (layer != ENCRE_LAYER_DEPTH && (atomic_load(&c.unclean) || found));
	return code;
}

int32_t clean_copy(bands *pool, const encre_image *image, int layer, float *to)
{
	clean c = {.image = image, .layer = layer, .to = to};
	return bands_run(pool, image->height, 0, copy_rows, &c);
}
