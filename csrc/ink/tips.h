/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What tips.c makes of sites, and capsules.c draws. */
#ifndef ENCRE_TIPS_H
#define ENCRE_TIPS_H

#include "fine/fine.h"

/* What a site gives the links that end at it. On paper of height h, a share `bias` of which the pencil doesn't reach,
 * the darkness that coverage min(1, (out - d) / fade) gets at distance d is gain * (h * coverage - bias). Of that ramp
 * pixels show how dark it gets and where it is half as dark, but none is steeper than a pixel is wide, and what is
 * thinner than a pixel is as much fainter instead: so the ink of a line doesn't depend on the size of the frame. */
typedef struct pen_end {
	float x, y;
	float out, fade;
	float gain, ease; /* one over the other */
	float bias, paper, limit;
	float reach;       /* nothing is darkened from here on */
	uint32_t bristles; /* 0: none is dry */
} pen_end;

/* Whether its line is between colours or materials, and so lies on a surface. */
static inline bool is_colored(const site *s)
{
	return s->placed.source == SOURCE_COLOR || s->placed.source == SOURCE_MATERIAL;
}

/* A thing not much wider than its lines lets no paper between them: they are one, from its middle. How much they are,
 * where each is `radius` pixels wide to each side. Where it tapers they spread towards the middle so much only that
 * there is as much ink as both together leave of paper, for of what darkens a pixel the most counts and not the sum. */
static inline float filled_by(const site *s, float radius)
{
	float half = s->placed.half, beyond = half - radius, one = clamp01(1 - 2 * beyond),
	      spread = half > 0 ? clamp01((0.5f - beyond) / (2 * half)) : one;
	return s->placed.thin * mix(one, spread, s->linked.tapers);
}

#endif
