/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What the surface turns beside edges of a lane (beside.c): whether they are a bend, or it goes on so. */
#ifndef ENCRE_BESIDE_H
#define ENCRE_BESIDE_H

#include "raster/lanes.h"

#include "base/pixel.h"

/* What a way turns, or that there is an end of the surface between. */
static const float closed = -1;

/* What the surface turns beside a bend as far as it is seen, and without what only some rows or columns see: which
 * edges are one bend must not depend on that, or its line would jump to and fro. */
typedef struct sides {
	float all, sure;
	float same; /* of `sure` what goes on turning the same way */
	float seen; /* share of what is to be looked at; `closed`: too little */
} sides;

/* How much `reach` pixels beside an end of a bend turn; less counts from half of that on. Unless `enough` can be seen
 * nothing is known, but at the images' border, and from `guessed` pixels on. */
sides beside_of(const looking *l, int i, int way, const float across[3], float reach, float enough, float guessed);
/* With what cannot be seen: it goes on as what is seen, or as the other side. */
sides beside_whole(const sides *own, const sides *other);
/* How far what turns so much is a bend by itself, from 0 to 1, rather than part of what goes on turning both ways. */
float beside_alone(const sides *one, const sides *other, float turn);
/* Where a form that is shaded smoothly turns on both sides of an edge, the layer's edge bends less, or not. */
void beside_fade(const looking *l);

/* From the pixel `from` to where a turning is. In this way the bits do not depend on where the images begin. */
static inline float along(const turning *t, int from)
{
	return (float)(t->way - from) + t->share;
}

static inline const float *normal_at(const bends *s, int x, int y)
{
	return pixel_at(&s->job->normal, x, y);
}

static inline const float *normal_along(const looking *l, int at)
{
	return normal_at(l->s, l->axis ? l->number : at, l->axis ? at : l->number);
}

static inline float dot_of(const float a[3], const float b[3])
{
	return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/* By how much the normals change from one pixel of a lane to another. */
static inline void change_along(const looking *l, int from, int to, float change[3])
{
	const float *n = normal_along(l, from), *m = normal_along(l, to);
	for (int c = 0; c < 3; c++)
		change[c] = m[c] - n[c];
}

/* Rather than aside: on what is regular much is at right angles to what it turns by elsewhere. */
static inline bool turns_back(const looking *l, const turning *t, const float across[3])
{
	float change[3];
	change_along(l, t->way, t->way + 1, change);
	float dot = dot_of(change, across);
	return dot < 0 && 2 * dot * dot > dot_of(change, change) * dot_of(across, across);
}

#endif
