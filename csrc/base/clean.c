/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Layers as stages may trust them. Most frames are clean and packed already: one pass of reading finds that out, and
 * nothing is copied. */
#include "base/clean.h"

#include <float.h>
#include <math.h>
#include <stdatomic.h>

typedef struct clean {
	const encre_image *image, *to;
	int layer;
	atomic_llong bad;
	atomic_bool unclean;
} clean;

static float limit_of(int layer)
{
	return layer == ENCRE_LAYER_CONTROLS ? 1.0f : FLT_MAX;
}

static float *row_at(const encre_image *image, int y)
{
	return (float *)((char *)image->data + y * image->row_stride);
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

/* Cleans n adjacent values and counts as count_row() does. Called with a constant `depth` each time. */
static inline long long copy_row(const float *restrict in, int n, const bool depth, float limit, float *restrict out)
{
	int bad = 0;
	for (int i = 0; i < n; i++) {
		float v = in[i], a = fabsf(v);
		float inside = v > limit ? limit : v < -limit ? -limit : v;
		bad += !(a <= (depth ? INFINITY : FLT_MAX));
		out[i] = depth ? v : a <= FLT_MAX ? inside : 0;
	}
	return bad;
}

static void copy_rows(void *data, int y0, int y1, int thread)
{
	(void)thread;
	clean *c = data;
	const encre_image *from = c->image, *to = c->to;
	ptrdiff_t step = (ptrdiff_t)(from->pixel_stride / 4), out_step = (ptrdiff_t)(to->pixel_stride / 4);
	bool depth = c->layer == ENCRE_LAYER_DEPTH;
	float limit = limit_of(c->layer);
	long long bad = 0;
	for (int y = y0; y < y1; y++) {
		const float *in = row_at(from, y);
		float *out = row_at(to, y);
		bool whole = packed(from) && packed(to);
		int pieces = whole ? 1 : from->width, n = whole ? from->width * from->channels : from->channels;
		for (int x = 0; x < pieces; x++, in += step, out += out_step)
			bad += depth ? copy_row(in, n, true, limit, out) : copy_row(in, n, false, limit, out);
	}
	atomic_fetch_add(&c->bad, bad);
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

int32_t clean_copy(bands *pool, const encre_image *image, int layer, const encre_image *to, int64_t *bad)
{
	clean c = {.image = image, .layer = layer, .to = to};
	int32_t code = bands_run(pool, image->height, 0, copy_rows, &c);
	*bad += atomic_load(&c.bad);
	return code;
}
