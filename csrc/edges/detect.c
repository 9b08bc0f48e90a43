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
KERNEL void dog(const gaussians *g, const int reach, const int step, const float *const *row, int n,
		float *restrict response)
{
	enum { MOST = TILE + 2 * 3 * MAX_REACH };
	float narrow[MOST], wide[MOST];
	const int before = reach * step;
	const float *above[MAX_REACH + 1], *below[MAX_REACH + 1], *restrict centre = row[reach] - before;
	float a[MAX_REACH + 1], b[MAX_REACH + 1];
	for (int k = 0; k <= reach; k++) {
		above[k] = row[reach - k] - before;
		below[k] = row[reach + k] - before;
		a[k] = g->narrow[k];
		b[k] = g->wide[k];
	}
	for (int i = 0; i < n + 2 * before; i++) {
		float first = (above[1][i] - centre[i]) + (below[1][i] - centre[i]);
		float u = a[1] * first, v = b[1] * first;
		for (int k = 2; k <= reach; k++) {
			float d = (above[k][i] - centre[i]) + (below[k][i] - centre[i]);
			u += a[k] * d;
			v += b[k] * d;
		}
		narrow[i] = u;
		wide[i] = v;
	}
	for (int i = 0; i < n; i++) {
		int c = i + before;
		float sum = a[0] * narrow[c] - b[0] * wide[c];
		for (int k = 1; k <= reach; k++) {
			int l = c - k * step, r = c + k * step;
			float d = (centre[l] - centre[c]) + (centre[r] - centre[c]);
			sum += (a[k] - b[k]) * d + (a[k] * (narrow[l] + narrow[r]) - b[k] * (wide[l] + wide[r]));
		}
		response[i] = sum;
	}
}

/* The same with a constant step each time. */
KERNEL void dog_of(const gaussians *g, const int step, const float *const *row, int n, float *restrict response)
{
	switch (g->reach) {
	case 1: dog(g, 1, step, row, n, response); break;
	case 2: dog(g, 2, step, row, n, response); break;
	case 3: dog(g, 3, step, row, n, response); break;
	case 4: dog(g, 4, step, row, n, response); break;
	case 5: dog(g, 5, step, row, n, response); break;
	case 6: dog(g, 6, step, row, n, response); break;
	case 7: dog(g, 7, step, row, n, response); break;
	default: dog(g, MAX_REACH, step, row, n, response);
	}
}

void ISA(detect_dog)(const gaussians *g, const float *const *row, int step, int n, float *restrict response)
{
	if (step == 1)
		dog_of(g, 1, row, n, response);
	else
		dog_of(g, 3, row, n, response);
}

/* ---- 3x3 windows ----------------------------------------------------------------------------------------- */

/* The nine samples of a window, as pointers of which the compiler does not know that they lie beside each other: some
 * would keep two of three samples from one round of a loop for the next, and can't vectorise what comes of that. */
typedef struct window9 {
	const float *at[3][3];
} window9;

static inline window9 window_of(const float *const *row, int step)
{
	window9 w;
	for (int k = 0; k < 3; k++)
		for (int i = 0; i < 3; i++) {
			w.at[k][i] = row[k] + (i - 1) * step;
			__asm__("" : "+r"(w.at[k][i]));
		}
	return w;
}

/* Names them: a, b, c from the upper row down, l, m, r from the left. */
#define WINDOW(row, step)                                                                                              \
	window9 w = window_of(row, step);                                                                              \
	const float *restrict al = w.at[0][0], *restrict am = w.at[0][1], *restrict ar = w.at[0][2];                   \
	const float *restrict bl = w.at[1][0], *restrict bm = w.at[1][1], *restrict br = w.at[1][2];                   \
	const float *restrict cl = w.at[2][0], *restrict cm = w.at[2][1], *restrict cr = w.at[2][2]

void ISA(detect_slope)(const float *const *row, int step, int n, float *restrict response)
{
	WINDOW(row, step);
	(void)bm;
	for (int i = 0; i < n; i++) {
		float gx = (ar[i] - al[i]) + 2 * (br[i] - bl[i]) + (cr[i] - cl[i]);
		float gy = (cl[i] - al[i]) + 2 * (cm[i] - am[i]) + (cr[i] - ar[i]);
		response[i] = sqrtf(gx * gx + gy * gy);
	}
}

void ISA(detect_bend)(const float *const *row, int n, float *restrict response)
{
	WINDOW(row, 1);
	for (int i = 0; i < n; i++) {
		float a = am[i], b = bm[i], c = cm[i], left = bl[i], right = br[i];
		float lx = ((al[i] - a) + (ar[i] - a)) + 2 * ((left - b) + (right - b)) + ((cl[i] - c) + (cr[i] - c));
		float ly = ((al[i] - left) + (cl[i] - left)) + 2 * ((a - b) + (c - b)) +
			   ((ar[i] - right) + (cr[i] - right));
		response[i] = sqrtf(lx * lx + ly * ly);
	}
}

void ISA(detect_change)(const float *const *row, int n, float *restrict response)
{
	WINDOW(row, 1);
	for (int i = 0; i < n; i++) {
		float own = bm[i];
		int same = (al[i] == own) & (am[i] == own) & (ar[i] == own) & (bl[i] == own) & (br[i] == own) &
			   (cl[i] == own) & (cm[i] == own) & (cr[i] == own);
		response[i] = same ? 0.0f : 1.0f;
	}
}
#undef WINDOW

void ISA(detect_contrast)(const color_metric *metric, const float *(*row)[3], int n, float *restrict response)
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
