/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What can be in the way of rays that begin close together and end at one lamp. They find what each would have found
 * alone: a shaft says where they need not look. */
#ifndef ENCRE_SHAFT_H
#define ENCRE_SHAFT_H

#include "light/rays.h"

enum { SHAFT_PARTS = 16, SHAFT_ENTRIES = 64, SHAFT_SIDE = 8 /* pixels of a square whose rays may share one */ };
enum { SHAFT_FEW = 4 /* pixels that one is not worth while for */ };

#define SHAFT_ALL (~(uint64_t)0) /* starts */

/* An instance by its place in the tree of all, its entries, and from which of the starts rays may meet it. */
typedef struct shaft_part {
	int32_t instance, node, slot, first, end;
	uint64_t starts;
} shaft_part;

/* Which boxes of a node matter. */
typedef struct shaft_entry {
	int32_t node;
	unsigned mask;
} shaft_entry;

typedef struct shaft {
	bool usable; /* false: each ray looks for itself */
	box from, to;
	float far;
	int32_t wall[2]; /* instance and triangle that stop all its rays but those that begin there; -1: none is known
			  */
	int n_parts;
	shaft_part part[SHAFT_PARTS]; /* what stopped the last ray first; entries likewise */
	shaft_entry entry[SHAFT_ENTRIES];
} shaft;

/* Where rays begin: in a box, and if that is all of them on one instance above `count` places (0: anywhere in it),
 * somewhere between two heights; of the triangle there they meet nothing. */
typedef struct shaft_starts {
	box within;
	int count;
	int32_t instance;
	vec at[2][SHAFT_SIDE * SHAFT_SIDE];
	int32_t triangle[SHAFT_SIDE * SHAFT_SIDE];
} shaft_starts;

/* To a box with `far` 1, or along ways of that box with lamp_far. One of SET_SEEN has no wall. */
void ISA(shaft_make)(shaft *s, const world *w, const shaft_starts *from, box to, float far, int set);
/* Whether it is usable, and nothing is in the way of rays from one of its starts. */
static inline bool shaft_free(const shaft *s, int start)
{
	if (!s->usable || s->wall[0] >= 0) /* if it is not usable nothing else of it is set */
		return false;
	uint64_t parts = 0;
	for (int k = 0; k < s->n_parts; k++)
		parts |= s->part[k].starts;
	return !(parts >> start & 1);
}

/* Whether it is usable, and all rays that begin on a triangle of an instance are stopped. */
static inline bool shaft_walled(const shaft *s, int32_t instance, int32_t triangle)
{
	return s->usable && s->wall[0] >= 0 && !(s->wall[0] == instance && s->wall[1] == triangle);
}

/* As ray_nearest(), through a shaft of SET_SEEN. */
bool ISA(shaft_nearest)(const shaft *s, const world *w, const double from[3], const double to[3], float share,
			hit *found);

#endif
