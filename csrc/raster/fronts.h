/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Where on a way between two pixels one piece of a mesh is no longer in front of another. */
#ifndef ENCRE_FRONTS_H
#define ENCRE_FRONTS_H

#include "raster/asks.h"
#include "raster/raster.h"

enum { FRONTS_WAYS = 256, FRONTS_SIDES = 16 }; /* that are looked at together, and triangles of both pieces on each */

/* A triangle on a way: from where to where, as shares of the way, and how deep it lies at both. */
typedef struct side_seen {
	double share[2], depth[2];
	bool first; /* of the piece that is in front at the first pixel */
} side_seen;

/* A way from a pixel to its right or lower neighbour, in pixels of the guard, and the pieces in front at both. */
typedef struct front_way {
	uint32_t piece[2];
	int x, y;
	bool down;
	int n; /* triangles found */
	side_seen side[FRONTS_SIDES];
	double share; /* what was found; 0: nothing */
} front_way;

/* What a thread needs. */
typedef struct fronts {
	front_way way[FRONTS_WAYS];
	ask ask[2 * FRONTS_WAYS]; /* `way`: twice that above, and 1 more of what is in front at its second pixel */
} fronts;

/* Finds the shares of the first n ways, of band `i`. */
void fronts_find(const raster *r, int i, fronts *room, uint32_t n);

#endif
