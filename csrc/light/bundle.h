/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What of a triangle rays may or must meet that begin close together and end in one box, or go along ways of one. `to`:
 * that box, as an instance sees it; `ways`: it is of ways. */
#ifndef ENCRE_BUNDLE_H
#define ENCRE_BUNDLE_H

#include "light/local.h"
#include "light/shaft.h"

/* The places above which rays begin, as an instance sees them, side by side. */
typedef struct places {
	float at[2][3][SHAFT_SIDE * SHAFT_SIDE];
	int32_t triangle[SHAFT_SIDE * SHAFT_SIDE];
	int count;
	float doubt; /* by how much rounding may move one */
} places;

/* By how much rounding may move a place of a box in the world, as an instance sees both. */
float ISA(bundle_doubt)(const instance *in, box world, box own);
void ISA(bundle_places)(const shaft_starts *from, const instance *in, places *p);
/* From which places rays may meet a leaf, a bit each. */
uint64_t ISA(bundle_may_meet)(const triangle_leaf *leaf, const places *p, box to, bool ways);
/* Whether all rays from a box meet a triangle of a leaf: if those from its corners do. */
bool ISA(bundle_must_meet)(const triangle_leaf *leaf, int i, const box *from, float doubt, box to, bool ways);

#endif
