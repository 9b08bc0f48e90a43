/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Windows of samples -> responses of the edge detectors, one tile of a row at a time. */
#ifndef ENCRE_DETECT_H
#define ENCRE_DETECT_H

#include "base/metric.h"
#include "base/stage.h"

enum {
	TILE = 256,    /* pixels of a row that are worked on together: their intermediates stay in the L1 cache */
	MAX_REACH = 8, /* radius of the widest window, that of the widest Gaussian */
};

/* Two normalised Gaussians over one window; weight k is that of the samples at distance k. */
typedef struct gaussians {
	int reach;
	float narrow[MAX_REACH + 1], wide[MAX_REACH + 1];
} gaussians;

/* sigma (0.5..4) and 1.6 sigma over -ceil(2 sigma)..ceil(2 sigma). */
gaussians ISA(gaussians_of)(float sigma);

/* row[k] points to sample x of row y - reach + k, with at least `reach` samples before it and n + reach from it on; the
 * response to (x + i, y) goes to response[i]. 0 < n <= TILE; 3x3 windows have reach 1. step: 1, or 3 where samples of
 * three channels lie beside each other: then of each float on its own, and there are three times as many about. */

/* Difference of Gaussians, signed: positive where the centre stands out upwards. */
void ISA(detect_dog)(const gaussians *g, const float *const *row, int step, int n, float *restrict response);
/* Length of the gradient, by Sobel's 1 2 1 kernels. */
void ISA(detect_slope)(const float *const *row, int step, int n, float *restrict response);
/* The same with second differences: 0 on planes. */
void ISA(detect_bend)(const float *const *row, int n, float *restrict response);
/* 1 where another sample of the window differs from the centre. */
void ISA(detect_change)(const float *const *row, int n, float *restrict response);
/* The largest difference, by `metric`, of two opposite neighbours; row[k][c]: plane c of row y - 1 + k. */
void ISA(detect_contrast)(const color_metric *metric, const float *(*row)[3], int n, float *restrict response);

#endif
