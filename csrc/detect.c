/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Edge detectors on windows of samples: the difference of Gaussians (Winnemoeller, Olsen & Gooch 2006; Vainumäe 2020,
 * 4.3), Sobel's kernels and the inter-color contrast (Herring 2016, 3.2). All work on differences between samples, so
 * that flat areas give exactly 0. */
#include "detect.h"
#include "metric.h"
#include "pixel.h"

/* ---- difference of Gaussians ----------------------------------------------------------------------------- */

static void fill_gaussian(double sigma, int reach, float *weight)
{
	/* e^(-1/2 sigma^2) by its series; weight k is its k^2-th power. In double, because a rounded weight would
	 * count 200 times. */
	double t = -1 / (2 * sigma * sigma), term = 1, e = 1;
	for (int i = 1; i < 32; i++)
		e += term *= t / i;
	double w[MAX_REACH + 1] = {1}, sum = 1;
	for (int k = 1; k <= reach; k++) {
		w[k] = w[k - 1];
		for (int i = 0; i < 2 * k - 1; i++)
			w[k] *= e;
		sum += 2 * w[k];
	}
	for (int k = 0; k <= reach; k++)
		weight[k] = (float)(w[k] / sum);
}

gaussians ISA(gaussians_of)(float sigma)
{
	gaussians g = {.reach = 1};
	while ((float)g.reach < 2 * sigma && g.reach < MAX_REACH)
		g.reach++;
	fill_gaussian((double)sigma, g.reach, g.narrow);
	fill_gaussian(1.6 * (double)sigma, g.reach, g.wide);
	return g;
}

/* Down a column, of differences from its sample in the centre row. */
static void blur_columns(const gaussians *g, const float *const *row, int n, float *restrict narrow, float *restrict wide)
{
	const float *restrict centre = row[g->reach] - g->reach;
	for (int i = 0; i < n; i++)
		narrow[i] = wide[i] = 0;
	for (int k = 1; k <= g->reach; k++) {
		const float *restrict above = row[g->reach - k] - g->reach, *restrict below = row[g->reach + k] - g->reach;
		float a = g->narrow[k], b = g->wide[k];
		for (int i = 0; i < n; i++) {
			float d = (above[i] - centre[i]) + (below[i] - centre[i]);
			narrow[i] += a * d;
			wide[i] += b * d;
		}
	}
}

/* With c the centre, u a sample of its row and u + v that sample's blurred column: the blur less c is the weighted sum
 * of (u - c) + v. */
void ISA(detect_dog)(const gaussians *g, const float *const *row, int n, float *restrict response)
{
	float narrow[TILE + 2 * MAX_REACH], wide[TILE + 2 * MAX_REACH];
	int reach = g->reach;
	blur_columns(g, row, n + 2 * reach, narrow, wide);
	for (int i = 0; i < n; i++)
		response[i] = g->narrow[0] * narrow[i + reach] - g->wide[0] * wide[i + reach];
	const float *restrict u = row[reach];
	for (int k = 1; k <= reach; k++) {
		const float *restrict before = u - k, *restrict after = u + k;
		const float *narrow0 = narrow + reach - k, *narrow1 = narrow + reach + k;
		const float *wide0 = wide + reach - k, *wide1 = wide + reach + k;
		float a = g->narrow[k], b = g->wide[k], ab = a - b;
		for (int i = 0; i < n; i++) {
			float d = (before[i] - u[i]) + (after[i] - u[i]);
			response[i] += ab * d + (a * (narrow0[i] + narrow1[i]) - b * (wide0[i] + wide1[i]));
		}
	}
}

/* ---- 3x3 windows ----------------------------------------------------------------------------------------- */

void ISA(detect_slope)(const float *const *row, int n, float *restrict response)
{
	const float *restrict a = row[0], *restrict b = row[1], *restrict c = row[2];
	for (int i = 0; i < n; i++) {
		float gx = (a[i + 1] - a[i - 1]) + 2 * (b[i + 1] - b[i - 1]) + (c[i + 1] - c[i - 1]);
		float gy = (c[i - 1] - a[i - 1]) + 2 * (c[i] - a[i]) + (c[i + 1] - a[i + 1]);
		response[i] = sqrtf(gx * gx + gy * gy);
	}
}

void ISA(detect_bend)(const float *const *row, int n, float *restrict response)
{
	const float *restrict a = row[0], *restrict b = row[1], *restrict c = row[2];
	for (int i = 0; i < n; i++) {
		float lx = ((a[i - 1] - a[i]) + (a[i + 1] - a[i])) + 2 * ((b[i - 1] - b[i]) + (b[i + 1] - b[i])) +
			   ((c[i - 1] - c[i]) + (c[i + 1] - c[i]));
		float ly = ((a[i - 1] - b[i - 1]) + (c[i - 1] - b[i - 1])) + 2 * ((a[i] - b[i]) + (c[i] - b[i])) +
			   ((a[i + 1] - b[i + 1]) + (c[i + 1] - b[i + 1]));
		response[i] = sqrtf(lx * lx + ly * ly);
	}
}

void ISA(detect_change)(const float *const *row, int n, float *restrict response)
{
	const float *restrict a = row[0], *restrict b = row[1], *restrict c = row[2];
	for (int i = 0; i < n; i++) {
		int same = (a[i - 1] == b[i]) & (a[i] == b[i]) & (a[i + 1] == b[i]) & (b[i - 1] == b[i]) &
			   (b[i + 1] == b[i]) & (c[i - 1] == b[i]) & (c[i] == b[i]) & (c[i + 1] == b[i]);
		response[i] = same ? 0.0f : 1.0f;
	}
}

void ISA(detect_contrast)(int metric, const float *(*row)[3], int n, float *restrict response)
{
	static const int pair[4][2] = {{0, 0}, {0, 1}, {1, 1}, {2, 1}}; /* row, column + 1 of one of the two: N NE E SE */
	for (int i = 0; i < n; i++)
		response[i] = 0;
	for (int k = 0; k < 4; k++) {
		const float *a[3], *b[3];
		for (int c = 0; c < 3; c++) {
			a[c] = row[pair[k][0]][c] + pair[k][1];
			b[c] = row[2 - pair[k][0]][c] - pair[k][1];
		}
		ISA(metric_difference)(metric, n, a, b, response);
	}
}

/* ---- greatest of a window -------------------------------------------------------------------------------- */

/* Spans of 1, 2, 4, ... items, then two of the longest that fits overlap. In place: items are read ahead of where they
 * are written. */
void ISA(window_greatest)(float *a, ptrdiff_t n, ptrdiff_t reach, ptrdiff_t lanes)
{
	ptrdiff_t window = 2 * reach + 1, left = n + 2 * reach, span = 1;
	for (; 2 * span <= window; span *= 2) {
		left -= span;
		for (ptrdiff_t i = 0, ahead = span * lanes; i < left * lanes; i++)
			a[i] = a[i] > a[i + ahead] ? a[i] : a[i + ahead];
	}
	for (ptrdiff_t i = 0, ahead = (window - span) * lanes; i < n * lanes; i++)
		a[i] = a[i] > a[i + ahead] ? a[i] : a[i + ahead];
}
