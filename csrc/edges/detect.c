/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Edge detectors on windows of samples: the difference of Gaussians (Winnemoeller, Olsen & Gooch 2006; Vainumäe 2020,
 * 3.1), Sobel's kernels and the inter-color contrast (Herring 2016, A.2). All work on differences between samples, so
 * that flat areas give exactly 0. */
#include "edges/detect.h"
#include "base/metric.h"
#include "base/pixel.h"

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

/* First down the columns, of differences from their sample in the centre row. Then across: with c the centre, u a
 * sample of its row and u + v that sample's blurred column, the blur less c is the weighted sum of (u - c) + v. Called
 * with a constant reach each time: the taps become straight code over whole rows. */
KERNEL void dog(const gaussians *g, const int reach, const float *const *row, int n, float *restrict response)
{
	float narrow[TILE + 2 * MAX_REACH], wide[TILE + 2 * MAX_REACH];
	const float *above[MAX_REACH + 1], *below[MAX_REACH + 1], *restrict centre = row[reach] - reach;
	float a[MAX_REACH + 1], b[MAX_REACH + 1];
	for (int k = 0; k <= reach; k++) {
		above[k] = row[reach - k] - reach;
		below[k] = row[reach + k] - reach;
		a[k] = g->narrow[k];
		b[k] = g->wide[k];
	}
	for (int i = 0; i < n + 2 * reach; i++) {
		float u = 0, v = 0;
		for (int k = 1; k <= reach; k++) {
			float d = (above[k][i] - centre[i]) + (below[k][i] - centre[i]);
			u += a[k] * d;
			v += b[k] * d;
		}
		narrow[i] = u;
		wide[i] = v;
	}
	for (int i = 0; i < n; i++) {
		int c = i + reach;
		float sum = a[0] * narrow[c] - b[0] * wide[c];
		for (int k = 1; k <= reach; k++) {
			float d = (centre[c - k] - centre[c]) + (centre[c + k] - centre[c]);
			sum += (a[k] - b[k]) * d +
			       (a[k] * (narrow[c - k] + narrow[c + k]) - b[k] * (wide[c - k] + wide[c + k]));
		}
		response[i] = sum;
	}
}

void ISA(detect_dog)(const gaussians *g, const float *const *row, int n, float *restrict response)
{
	switch (g->reach) {
	case 1: dog(g, 1, row, n, response); break;
	case 2: dog(g, 2, row, n, response); break;
	case 3: dog(g, 3, row, n, response); break;
	case 4: dog(g, 4, row, n, response); break;
	case 5: dog(g, 5, row, n, response); break;
	case 6: dog(g, 6, row, n, response); break;
	case 7: dog(g, 7, row, n, response); break;
	default: dog(g, MAX_REACH, row, n, response);
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
	/* row and column of one of the two from the window's middle column on: N, NE, E, SE */
	static const int pair[4][2] = {{0, 0}, {0, 1}, {1, 1}, {2, 1}};
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
