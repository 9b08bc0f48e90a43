/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "base/clean.h"

#include <float.h>
#include <math.h>
#include <stdatomic.h>

static float limit_of(int layer)
{
	return layer == ENCRE_LAYER_CONTROLS ? 1.0f : layer == ENCRE_LAYER_DEPTH ? INFINITY : FLT_MAX;
}

static float *row_at(const encre_image *image, int y)
{
	return (float *)((char *)image->data + y * image->row_stride);
}

/* ---- a look ---------------------------------------------------------------------------------------------- */

/* Whether a value is beyond +-limit, or NaN. Without their sign floats order as whole numbers do, NaN above infinity,
 * and a difference of two of these never overflows: its sign tells, and signs gather in one number. */
static bool any_beyond(const float *restrict in, int n, float limit)
{
	int32_t most = float_bits(limit), signs = 0;
	for (int i = 0; i < n; i++)
		signs |= most - (float_bits(in[i]) & INT32_MAX);
	return signs < 0;
}

static int64_t count_bad(const float *restrict in, int n, float most)
{
	int bad = 0;
	for (int i = 0; i < n; i++)
		bad += !(fabsf(in[i]) <= most);
	return bad;
}

static bool look(const encre_image *image, int layer, int y, int64_t *bad)
{
	const float *in = row_at(image, y);
	ptrdiff_t step = (ptrdiff_t)(image->pixel_stride / 4);
	int pieces = packed(image) ? 1 : image->width, n = image->width / pieces * image->channels;
	bool beyond = false;
	for (int x = 0; x < pieces; x++, in += step)
		if (any_beyond(in, n, limit_of(layer))) {
			*bad += count_bad(in, n, layer == ENCRE_LAYER_DEPTH ? INFINITY : FLT_MAX);
			beyond = true;
		}
	return packed(image) && (!beyond || layer == ENCRE_LAYER_DEPTH);
}

/* ---- copies ---------------------------------------------------------------------------------------------- */

typedef struct job {
	const encre_image *image, *to;
	int layer;
	atomic_llong bad;
} job;

/* Cleans n adjacent values and counts. Called with a constant `depth` each time. */
KERNEL long long copy_row(const float *restrict in, int n, const bool depth, float limit, float *restrict out)
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
	job *c = data;
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

static int32_t copy(bands *pool, const encre_image *image, int layer, const encre_image *to, int64_t *bad)
{
	job c = {.image = image, .layer = layer, .to = to};
	int32_t code = bands_run(pool, image->height, 0, copy_rows, &c);
	*bad += atomic_load(&c.bad);
	return code;
}

const cleaner ISA(cleaner) = {look, copy};
