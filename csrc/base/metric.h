/* SPDX-License-Identifier: GPL-3.0-or-later */
/* How different two colours look: the measures of the inter-color metric (Herring 2016, 3.4). */
#ifndef ENCRE_METRIC_H
#define ENCRE_METRIC_H

#include "base/pixel.h"
#include "base/stage.h"

/* How differences are measured: contrast_metric, and the weights of HSL. */
typedef struct color_metric {
	int kind;
	float hue, saturation, lightness;
} color_metric;

static inline color_metric metric_of(const encre_params *p)
{
	return (color_metric){p->contrast_metric, p->contrast_hue, p->contrast_saturation, p->contrast_lightness};
}

/* Turns n linear colours within 0..1, one plane a channel, into those that contrast_metric `metric` compares, in place:
 * sRGB-encoded for RGB; for HSL lightness, and hue and chroma as a way in the plane; CIE L*a*b* for the others. */
void ISA(metric_space)(int metric, int n, float *restrict r, float *restrict g, float *restrict b);

/* greatest[i] = the larger of itself and the difference of colours i of `a` and `b`, three planes each, from
 * metric_space. Black and white differ by 1. */
void ISA(metric_difference)(const color_metric *metric, int n, const float *const a[3], const float *const b[3],
			    float *restrict greatest);

/* CIEDE2000 of two colours from metric_space, divided by 100, whatever the metric. */
float ISA(metric_ciede2000)(int metric, const float *one, const float *two);

/* Strength of an edge between colours that differ this much: 0 below `least`, 1 from `most` on. */
static inline float metric_strength(float difference, float least, float most)
{
	float ramp = most - least, share = (difference - least) / (ramp > 0 ? ramp : 1);
	share = ramp > 0 ? clamp01(share) : 1;
	return difference < least ? 0 : share;
}

#endif
