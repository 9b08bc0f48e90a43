/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Ridges: where a layer that is averaged over its pixels changes faster than on both sides: a crease in the normals, a
 * boundary between colours, the edge of a shadow. Pixels beside a crack hold two surfaces: there is no ridge in them,
 * and no read along a direction goes past them. */
#include "fine/near.h"

enum {
	REACH = 3,
	SPAN = 2 * REACH + 1,
	SHORT = 32,
	SLICE = 64 /* pixels that are worked on together, and asked for in the next row: more would wait */
};

/* Rows about the one worked on: sample 0 of each, REACH more before it and after the last. */
typedef struct window {
	const fine *n;
	int source; /* what is sampled: edges.h */
	sample_info is;
	const float *row[3][SPAN];
	const uint8_t *mixed[SPAN];
	float least_contrast; /* difference across, below which no step is strong enough */
} window;

/* ---- in a window ----------------------------------------------------------------------------------------- */

/* What lies k away along an axis. */
static inline float value_at(const window *w, int c, int x, int axis, int k)
{
	return w->row[c][REACH + (axis ? k : 0)][x + (axis ? 0 : k)];
}

static inline bool mixed_along(const window *w, int x, int axis, int k)
{
	return w->mixed[REACH + (axis ? k : 0)][x + (axis ? 0 : k)];
}

/* What lies `step` away from a pixel, or itself where that holds two surfaces. */
static void beside(const window *w, int x, int k, int step, int axis, float *value)
{
	int sx = x + (axis ? 0 : step), sk = k + (axis ? step : 0);
	if (w->mixed[sk][sx]) {
		sx = x;
		sk = k;
	}
	for (int c = 0; c < w->is.planes; c++)
		value[c] = w->row[c][sk][sx];
}

static bool any_mixed(const window *w, int x)
{
	uint32_t any = 0;
	for (int k = REACH - 2; k <= REACH + 2; k++) {
		uint32_t four;
		memcpy(&four, w->mixed[k] + x - 2, 4);
		any |= four | w->mixed[k][x + 2];
	}
	return any;
}

/* How much the 3x3 about x changes along each axis, where none of the 5x5 is mixed. Called with a constant number of
 * planes. */
KERNEL void slopes(const window *w, const int planes, int x, float *sum)
{
	for (int k = REACH - 1; k <= REACH + 1; k++)
		for (int i = x - 1; i <= x + 1; i++) {
			float across = 0, down = 0;
			for (int c = 0; c < planes; c++) {
				float u = w->row[c][k][i + 1] - w->row[c][k][i - 1],
				      v = w->row[c][k + 1][i] - w->row[c][k - 1][i];
				across += u * u;
				down += v * v;
			}
			sum[AXIS_ROW] += across;
			sum[AXIS_COLUMN] += down;
		}
}

/* Along which axis the 3x3 about x changes more. */
static int steeper(const window *w, int x)
{
	float sum[2] = {0, 0};
	bool plain = !any_mixed(w, x);
	if (plain)
		w->is.planes == 3 ? slopes(w, 3, x, sum) : slopes(w, 1, x, sum);
	for (int k = REACH - 1; !plain && k <= REACH + 1; k++)
		for (int i = x - 1; i <= x + 1; i++)
			for (int axis = 0; axis < 2 && !w->mixed[k][i]; axis++) {
				float before[3], after[3];
				beside(w, i, k, -1, axis, before);
				beside(w, i, k, 1, axis, after);
				sum[axis] += distance2(after, before, w->is.planes);
			}
	return sum[AXIS_COLUMN] > sum[AXIS_ROW] ? AXIS_COLUMN : AXIS_ROW;
}

/* How far samples go on one side of x before they repeat. */
static int held_to(const window *w, int x, int axis, int side)
{
	int held = 0;
	while (held < REACH && !mixed_along(w, x, axis, side * (held + 1)))
		held++;
	return held;
}

/* Whether the step at x is the greatest of those of the five along its axis that go the same way: the far side of a
 * thin stripe goes the other way. Of two equal ones, which lie at the same place, the first counts. */
static bool greatest(const window *w, int x, int axis)
{
	static const int others[] = {-1, 1, -2, 2};
	float step[3], own = 0, floor = w->n->floor[w->is.step];
	if (mixed_along(w, x, axis, -1) || mixed_along(w, x, axis, 1))
		return false;
	for (int c = 0; c < w->is.planes; c++) {
		step[c] = value_at(w, c, x, axis, 1) - value_at(w, c, x, axis, -1);
		own += step[c] * step[c];
	}
	if (!(own > floor * floor))
		return false;
	int least = -held_to(w, x, axis, -1), most = held_to(w, x, axis, 1);
	for (int i = 0; i < 4; i++) {
		int k = others[i], from = k - 1 > least ? k - 1 : least, to = k + 1 < most ? k + 1 : most;
		float other = 0, dot = 0;
		for (int c = 0; c < w->is.planes; c++) {
			float d = value_at(w, c, x, axis, to) - value_at(w, c, x, axis, from);
			other += d * d;
			dot += d * step[c];
		}
		if (dot > 0 && (other > own || (k < 0 && other == own)))
			return false;
	}
	return true;
}

/* How far the three pixels about x lie from the line between their neighbours. */
static float bulge2(const window *w, int x, int k, int axis)
{
	float sum = 0;
	for (int c = 0; c < w->is.planes; c++) {
		float v[5];
		for (int i = -2; i <= 2; i++)
			v[i + 2] = w->row[c][k + (axis ? i : 0)][x + (axis ? 0 : i)];
		float e = (v[1] + v[2] + v[3]) - 1.5f * (v[0] + v[4]);
		sum += e * e;
	}
	return sum;
}

/* Whether the pixel at x is the middle one of a band, and the band is as one must be. */
static bool peaks(const window *w, int x, int axis)
{
	float v[5][3];
	for (int k = -2; k <= 2; k++)
		if (k && mixed_along(w, x, axis, k))
			return false;
	for (int c = 0; c < w->is.planes; c++)
		for (int k = 0; k < 5; k++)
			v[k][c] = value_at(w, c, x, axis, k - 2);
	stripe b;
	if (stripe_of((const float (*)[3])v, w->is.planes, w->n->floor[w->is.band], families[w->is.band].faint, &b))
		return true;
	bool cut = false; /* what is cut is asked of the layer itself */
	for (int c = 0; c < w->is.planes; c++)
		for (int k = 0; k < 5; k++)
			cut |= !(fabsf(v[k][c]) < pixel_great);
	return cut;
}

static int bulging(const window *w, int x)
{
	float sum[2] = {0, 0};
	for (int k = REACH - 1; k <= REACH + 1; k++)
		for (int i = x - 1; i <= x + 1; i++)
			for (int axis = 0; axis < 2; axis++)
				sum[axis] += sqrtf(bulge2(w, i, k, axis));
	return sum[AXIS_COLUMN] > sum[AXIS_ROW] ? AXIS_COLUMN : AXIS_ROW;
}

/* ---- rows ------------------------------------------------------------------------------------------------ */

/* What lies beyond a row's ends is as its ends are. */
static void spare(int width, uint8_t *out)
{
	for (int k = 1; k <= REACH; k++) {
		out[-k] = out[0];
		out[width - 1 + k] = out[width - 1];
	}
}

/* Bytes with REACH to spare on both sides. */
static void mixed_row(const fine *n, int y, uint8_t *out)
{
	int width = n->f->width;
	const uint8_t *crack = n->crack + (ptrdiff_t)y * width, *above = y > 0 ? crack - width : NULL;
	out[0] = crack[0] & (CRACK_RIGHT | CRACK_DOWN);
	for (int x = 1; x < width; x++)
		out[x] = (uint8_t)((crack[x] & (CRACK_RIGHT | CRACK_DOWN)) | (crack[x - 1] & CRACK_RIGHT));
	for (int x = 0; above && x < width; x++)
		out[x] |= above[x] & CRACK_DOWN;
	spare(width, out);
}

enum { STEP = 1, BAND = 4 }; /* bits by axis */

/* Squared lengths of what makes a step, across one pixel and, if it is asked for, across two if that is more, and of
 * what makes a band. Called with a constant number of planes, so that the loop over them is unrolled and the one over
 * pixels vectorised. */
KERNEL void measure(const float *const (*v)[3], int planes, bool far_too, int n, float *restrict step,
		    float *restrict wide, float *restrict bulge)
{
	for (int i = 0; i < n; i++) {
		float step2 = 0, wide2 = 0, bulge2 = 0;
		for (int c = 0; c < planes; c++) {
			float near = v[3][c][i] - v[1][c][i], far = v[4][c][i] - v[0][c][i];
			float e = (v[1][c][i] + v[2][c][i] + v[3][c][i]) - 1.5f * (v[0][c][i] + v[4][c][i]);
			step2 += near * near;
			wide2 += far * far;
			bulge2 += e * e;
		}
		step[i] = step2;
		if (far_too)
			wide[i] = wide2 > step2 ? wide2 : step2;
		bulge[i] = bulge2;
	}
}

/* Takes back what no level of light lies between, of n <= SHORT pixels: v are samples -2..2 along an axis. */
static void keep_levels(const encre_levels *levels, const float *const *v, int n, int axis, int32_t *restrict bits)
{
	float low[SHORT], high[SHORT], deep_low[SHORT], deep_high[SHORT];
	int32_t step[SHORT], band[SHORT], any = 0;
	for (int i = 0; i < n; i++)
		any |= bits[i] & (STEP | BAND) << axis;
	if (!any)
		return;
	for (int i = 0; i < n; i++) {
		float a = v[0][i], b = v[1][i], c = v[2][i], d = v[3][i], e = v[4][i];
		float ab = a < b ? a : b, de = d < e ? d : e, AB = a > b ? a : b, DE = d > e ? d : e;
		float least = ab < de ? ab : de, most = AB > DE ? AB : DE, bulge = 2 * ((b + c + d) - 1.5f * (a + e));
		low[i] = least < c ? least : c;
		high[i] = most > c ? most : c;
		deep_low[i] = low[i] + (bulge < 0 ? bulge : 0);
		deep_high[i] = high[i] + (bulge > 0 ? bulge : 0);
		step[i] = band[i] = 0;
	}
	for (int k = 1; k < levels->count; k++) {
		float threshold = levels->level[k].threshold;
		for (int i = 0; i < n; i++) {
			step[i] |= (low[i] <= threshold) & (high[i] > threshold);
			band[i] |= (deep_low[i] <= threshold) & (deep_high[i] > threshold);
		}
	}
	for (int i = 0; i < n; i++)
		bits[i] &= ~(((step[i] ? 0 : STEP) | (band[i] ? 0 : BAND)) << axis);
}

/* Where a step or a band may be along which axis. Beside a crack a step across two pixels is what it is up to there,
 * and across the crack is none. */
static void candidates(const window *w, int x0, int n, uint8_t *restrict out)
{
	const uint8_t *mixed = w->mixed[REACH] + x0, *above = w->mixed[REACH - 1] + x0,
		      *below = w->mixed[REACH + 1] + x0;
	float step[SLICE], wide[SLICE], bulge[SLICE];
	int32_t bits[SLICE];
	float least = w->n->floor[w->is.step], band = w->is.band ? w->n->floor[w->is.band] : INFINITY,
	      contrast = w->least_contrast;
	for (int axis = 0; axis < 2; axis++) {
		const float *v[5][3] = {{NULL}};
		for (int k = -2; k <= 2; k++)
			for (int c = 0; c < w->is.planes; c++)
				v[k + 2][c] = w->row[c][REACH + (axis ? k : 0)] + x0 + (axis ? 0 : k);
		bool far_too = contrast > least;
		if (w->is.planes == 1)
			measure((const float *const(*)[3])v, 1, false, n, step, wide, bulge);
		else if (far_too)
			measure((const float *const(*)[3])v, 3, true, n, step, wide, bulge);
		else
			measure((const float *const(*)[3])v, 3, false, n, step, wide, bulge);
		for (int i = 0; i < n; i++) {
			int is_step = step[i] > least * least, is_band = bulge[i] > band * band;
			int own = (is_step ? STEP << axis : 0) | (is_band ? BAND << axis : 0);
			bits[i] = axis ? bits[i] | own : own;
		}
		for (int i = 0; far_too && i < n; i++) {
			int beside = mixed[i - 1] | mixed[i + 1] | above[i] | below[i];
			int may = (wide[i] > contrast * contrast) | (beside != 0);
			bits[i] &= may ? -1 : ~(STEP << axis);
		}
		for (int i = 0; w->source == SOURCE_LIGHT && !w->n->f->style && i < n; i += SHORT) {
			const float *const at[] = {v[0][0] + i, v[1][0] + i, v[2][0] + i, v[3][0] + i, v[4][0] + i};
			keep_levels(&w->n->e->p->shade_levels, at, n - i < SHORT ? n - i : SHORT, axis, bits + i);
		}
	}
	for (int i = 0; i < n; i++) {
		int open = (mixed[i - 1] | mixed[i + 1] ? 0 : STEP) | (above[i] | below[i] ? 0 : STEP << 1);
		uint8_t all = (uint8_t)(bits[i] & (open | BAND | BAND << 1));
		out[i] = mixed[i] ? 0 : all;
	}
}

/* Likewise, where what is seen can't be read: what is mixed, and what shows only itself. */
static void closed_row(const fine *n, int y, const uint8_t *mixed, uint8_t *out)
{
	int width = n->f->width;
	const uint8_t *through = n->through + (ptrdiff_t)y * width;
	for (int x = 0; x < width; x++)
		out[x] = mixed[x] | !through[x];
	spare(width, out);
}

static void mark(const window *w, int x, int y, int family, int axis, uint16_t *ridge)
{
	found at = {(uint16_t)x, (uint16_t)y, (uint8_t)family, (uint8_t)axis};
	placed s = {0};
	if (!ISA(ridge_site)(w->n, &at, &s))
		return;
	if (families[family].word == WORD_RIDGE) {
		ridge[x] |= mark_of(family, axis);
		return;
	}
	ridge[x] |= RIDGE_MORE;
	w->n->more[(ptrdiff_t)y * w->n->f->width + x] |= mark_of(family, axis);
}

static void ridge_tile(const window *w, int y, int x0, int n, uint16_t *ridge)
{
	uint8_t candidate[SLICE];
	candidates(w, x0, n, candidate);
	for (int i = next_marked(candidate, 0, n); i < n; i = next_marked(candidate, i + 1, n)) {
		int x = x0 + i, axis;
		for (axis = 0; axis < 2; axis++)
			if ((candidate[i] & BAND << axis) && peaks(w, x, axis) && bulging(w, x) == axis)
				mark(w, x, y, w->is.band, axis, ridge);
		for (axis = 0; axis < 2; axis++)
			if ((candidate[i] & STEP << axis) && greatest(w, x, axis) && steeper(w, x) == axis)
				mark(w, x, y, w->is.step, axis, ridge);
	}
}

ptrdiff_t ISA(ridge_scratch)(const frame *f)
{
	return (2 * SPAN * (f->width + 2 * REACH) + pieces_of(f->width, THIN_SPAN) + 3) / 4;
}

/* A site may lie in the row above or below. */
static int colored_near(const fine *n, int y)
{
	int height = n->f->height, above = n->colored[clamp_index(y - 1, height)],
	    below = n->colored[clamp_index(y + 1, height)], most = above > below ? above : below;
	return n->colored[y] > most ? n->colored[y] : most;
}

void ISA(ridge_rows)(void *data, int y0, int y1, int thread)
{
	const fine *n = data;
	const frame *f = n->f;
	uint8_t *mixed = (uint8_t *)(n->scratch + thread * n->thread_scratch) + REACH;
	uint8_t *closed = mixed + SPAN * (f->width + 2 * REACH), *hits = closed - REACH + SPAN * (f->width + 2 * REACH);
	ring rings[SAMPLE_COUNT];
	for (int s = SOURCE_NORMAL; s < SAMPLE_COUNT; s++)
		rings[s] = ISA(ring_of)(n->e, (enum source)s, thread);
	for (int y = y0; y < y1 && !bands_stopped(f->bands); y++) {
		uint16_t *ridge = n->ridge + (ptrdiff_t)y * f->width;
		window w = {.n = n};
		memset(ridge, 0, (size_t)f->width * sizeof *ridge);
		for (int k = 0; k < SPAN; k++) {
			int row = clamp_index(y - REACH + k, f->height);
			uint8_t *at = mixed + (row % SPAN) * (f->width + 2 * REACH);
			if (y == y0 || (k == SPAN - 1 && y + REACH < f->height))
				mixed_row(n, row, at);
			w.mixed[k] = at;
		}
		ISA(thin_mark)(n, y, hits, ridge);
		if (n->more)
			memset(n->more + (ptrdiff_t)y * f->width, 0, (size_t)f->width * sizeof *n->more);
		for (int s = SOURCE_NORMAL; s < SAMPLE_COUNT; s++) {
			bool wanted = n->e->on[s] && samples[s].step && (s < SOURCE_SEEN || n->glimpse[y]);
			if (s == SOURCE_COLOR)
				wanted = wanted && colored_near(n, y);
			if (s == SOURCE_NORMAL && n->replaced && !n->bumps)
				wanted = wanted && memchr(n->replaced + (ptrdiff_t)y * f->width, 0, (size_t)f->width);
			if (!wanted)
				continue;
			ISA(ring_fill)(rings + s, y);
			for (int k = 0; k < SPAN && s == SOURCE_SEEN; k++) {
				uint8_t *at = closed + k * (f->width + 2 * REACH);
				closed_row(n, clamp_index(y - REACH + k, f->height), w.mixed[k], at);
				w.mixed[k] = at;
			}
			w.source = s;
			w.is = samples[s];
			w.least_contrast = s == SOURCE_COLOR && colored_near(n, y) < 2 ? n->least_contrast : 0;
			for (int c = 0; c < w.is.planes; c++)
				ISA(ring_window)(rings + s, 0, c, w.row[c]);
			plane layer = f->layer[w.is.layer];
			for (int x0 = 0; x0 < f->width; x0 += SLICE) {
				int size = f->width - x0 < SLICE ? f->width - x0 : SLICE;
				if (y + REACH + 1 < f->height) /* what the ring takes next */
					fetch(layer, encre_layer_info(w.is.layer)->channels, y + REACH + 1, x0,
					      x0 + size);
				ridge_tile(&w, y, x0, size, ridge);
			}
		}
	}
}
