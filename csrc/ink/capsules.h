/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A link of a line as it is drawn. */
#ifndef ENCRE_CAPSULES_H
#define ENCRE_CAPSULES_H

#include "ink/strips.h"
#include "ink/tips.h"

/* Pixels x with way_x * x + way_y * y >= from belong to the link. */
typedef struct cut {
	float way_x, way_y, from;
} cut;

/* Of a link whose line has bristles: across it, and what each bristle gives at its ends, a byte each. */
typedef struct streaks {
	float x, y, length; /* the way across times its length; 0 for a link without a way */
	bool turned;        /* that goes from its second end to its first */
	float count[2];
	int last[2];
	uint64_t ink[2];
} streaks;

typedef struct capsule {
	const pen_end *a, *b;
	uint32_t one, two;     /* their numbers */
	const uint8_t *dry[2]; /* their bristles; NULL: none is dry */
	streaks across;        /* if any is, or a picture lies along it */
	strip_link strip;      /* of NULL: none does */
	float dx, dy, inverse; /* from a to b; 1 / length^2, 0 for a site alone */
	float reach;
	int cuts;
	cut cut[2];
} capsule;

/* How far a place lies across the link, from one rim to the other. */
static inline float across_at(const streaks *b, float px, float py, float half)
{
	float across = b->x * py - b->y * px, wide = b->length * half;
	return clamp01(0.5f + 0.5f * (b->length > 0 && half > 0 ? across / wide : 0));
}

static inline float left_by(const streaks *b, float across, float s)
{
	float left[2];
	for (int k = 0; k < 2; k++) {
		int at = (int)(across * b->count[k]);
		at = at < b->last[k] ? at : b->last[k];
		left[k] = (float)(int32_t)(b->ink[k] >> (8 * at) & 255) / 255;
	}
	return mix(left[0], left[1], s);
}

/* Pixels that a link with a strip may darken, and how much it would without: few of a row are, so those of all its
 * rows are looked up in the strip together. */
typedef struct picked {
	int n;
	float most[STRIP_PLACES];
	uint32_t place[STRIP_PLACES]; /* y << 16 | x */
} picked;

/* striped.c: inks them, and leaves none. */
void ISA(picked_ink)(const capsule *e, const canvas *c, picked *p);

#endif
