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

/* Pixels first..end - 1 of row y that the capsule may darken. */
static inline void span_of(const capsule *c, int y, int width, int *first, int *end)
{
	float ahead = (float)y - c->a->y, low = min(0, c->dx) - c->reach, high = max(0, c->dx) + c->reach;
	if (fabsf(c->dy) > 1e-6f) { /* between the tangents */
		float middle = ahead * c->dx / c->dy,
		      half = c->reach * sqrtf(c->dx * c->dx + c->dy * c->dy) / fabsf(c->dy);
		low = max(low, middle - half);
		high = min(high, middle + half);
	}
	low += c->a->x;
	high += c->a->x;
	for (int i = 0; i < c->cuts; i++) {
		const cut *k = c->cut + i;
		float rest = k->from - k->way_y * (float)y;
		if (k->way_x > 1e-3f)
			low = max(low, rest / k->way_x);
		else if (k->way_x < -1e-3f)
			high = min(high, rest / k->way_x);
		else if (rest > 0.1f)
			high = low - 1;
	}
	*first = low > 0 ? low < (float)width ? (int)low : width : 0; /* one more than needed to the left */
	*end = high < 0 ? 0 : high < (float)(width - 1) ? (int)high + 1 : width;
}

/* What a link gives pixels of a row. */
typedef struct shading {
	float from, py, dx, dy, ux, uy;
	float out, fade, gain, ease, bias, paper, limit;
	float more_out, more_fade, more_gain, more_ease, more_bias, more_paper, more_limit;
} shading;

static inline shading shading_of(const capsule *e, int y)
{
	const pen_end *a = e->a, *b = e->b;
	float py = (float)y - a->y;
	return (shading){.from = a->x,
			 .py = py,
			 .dx = e->dx,
			 .dy = e->dy,
			 .ux = e->dx * e->inverse,
			 .uy = py * e->dy * e->inverse,
			 .out = a->out,
			 .fade = a->fade,
			 .gain = a->gain,
			 .ease = a->ease,
			 .bias = a->bias,
			 .paper = a->paper,
			 .limit = a->limit,
			 .more_out = b->out - a->out,
			 .more_fade = b->fade - a->fade,
			 .more_gain = b->gain - a->gain,
			 .more_ease = b->ease - a->ease,
			 .more_bias = b->bias - a->bias,
			 .more_paper = b->paper - a->paper,
			 .more_limit = b->limit - a->limit};
}

/* A place beside a link: how dark it would be, and would be at most; how far along it lies, and the way to it. */
typedef struct shade {
	float t, most, width, s, px, ex, ey, square;
} shade;

/* Where `papered` is false paper is as high as can be. */
KERNEL shade shade_at(const shading *l, int x, const float *grain, const bool papered)
{
	float px = (float)x - l->from, s = px * l->ux + l->uy;
	s = clamp01(s);
	float ex = px - s * l->dx, ey = l->py - s * l->dy, d2 = ex * ex + ey * ey;
	float h = papered ? 1 + (l->paper + s * l->more_paper) * *grain : 1, low = l->bias + s * l->more_bias;
	float rise = positive(h - low), most = (l->gain + s * l->more_gain) * rise, ramp = l->ease + s * l->more_ease;
	ramp = ramp < rise ? ramp : rise; /* of coverage times height, from nothing to the darkest */
	most = most_one(most);
	float soft = l->fade + s * l->more_fade;
	soft = papered ? soft / h : soft;
	float middle = l->out + s * l->more_out - soft * (low + 0.5f * ramp), width = soft * ramp;
	width = max(width, pixel_one);
	float faint = positive(most_one(2 * middle)), half = max(middle, pixel_half);
	float t = 0.5f + (half - sqrtf(d2)) / width;
	t = faint * most * most_one(t);
	return (shade){t, most, width, s, px, ex, ey, d2};
}

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

/* across.c: when all links are drawn, what each adds on the other side of pixels than what darkens them most; and that
 * is added up. */
void ISA(capsule_add_across)(const capsule *e, const canvas *c);
void ISA(add_across)(const canvas *c);

#endif
