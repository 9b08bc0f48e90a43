/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Where lines would cover more of the picture than they may. */
#ifndef ENCRE_THICKETS_H
#define ENCRE_THICKETS_H

#include "ink/noise.h"
#include "ink/tips.h"
#include "fine/near.h"

/* matters.c: by site, how much its line matters, 0..1. */
int32_t ISA(lines_matter)(frame *f, const spots *at, float *matters);
/* Likewise, how much it is an outer contour. */
int32_t ISA(lines_outer)(frame *f, float *outer);
/* What of its line is kept at each site, from what room leaves of it there. */
int32_t ISA(lines_decide)(frame *f, float *left, float *kept);
/* doubled.c: by site, how many lines lie on each other there, its own among them, by ends of the first stroke and the
 * radius to which its line is thinned if all count. */
int32_t ISA(lines_doubled)(frame *f, const pen_end *end, const float *thin, float *lines);
/* thickets.c: by site, how much of a hand's pressure is left where lines are many, by ends that are pressed evenly:
 * each is shorter there than a swelling, and some would be bold, their neighbours faint. */
int32_t ISA(thickets_press)(frame *f, const pen_end *end, float *press);
/* Thins the ends of all strokes, by how much of what is about them those of the first cover; where `kept`
 * isn't NULL, that gets what is left of each line. */
int32_t ISA(thickets_thin)(frame *f, uint32_t strokes, const spots *at, pen_end *end, float *kept);

/* Pixels of a site's share of its line: half of each of its links. */
static inline float length_at(const fine *n, uint32_t i, float radius)
{
	float length = 0;
	for (uint32_t k = n->at[i]; k < n->at[i + 1]; k++)
		if (!n->site[n->to[k]].linked.dropped)
			length += 0.5f * sqrtf(apart2(n->site + i, n->site + n->to[k]));
	return n->at[i] == n->at[i + 1] ? 2 * radius : length;
}

/* What its room leaves of a site's radius. */
static inline float left_of(const site *s, float radius)
{
	return radius * s->linked.crowd > 1 ? 1 / s->linked.crowd : radius;
}

#endif
