/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Where pieces of meshes pass through each other. */
#ifndef ENCRE_MEETS_H
#define ENCRE_MEETS_H

#include "raster/asks.h"
#include "raster/fronts.h"

enum { MEETS_WAYS = 2048 }; /* between pixels, that are looked at together */

/* What is known of a piece at a pixel: which of its triangles would be in front, were it alone. */
typedef struct alone {
	ask of; /* `way`: twice that of the meeting, and 1 more at its first pixel */
	uint32_t number;
	int x;
	float depth;
} alone;

/* A way from a pixel to its right or lower neighbour, where pieces may pass through each other: the piece in front at
 * the first pixel at the second one, and the other way round. */
typedef struct meeting {
	int x, y;
	bool down, may;      /* may: else at most one of them ends between the two */
	uint32_t one, other; /* in front at both */
	uint32_t at_other, at_one;
} meeting;

/* What a thread needs. */
typedef struct meets {
	meeting way[MEETS_WAYS];
	alone look[2 * MEETS_WAYS];
	fronts fronts;
	uint32_t refined[FRONTS_WAYS]; /* ways that are looked at there */
} meets;

/* Adds to the creases, and the marks if they are there, of band `i`, whose own rows end before `end`. */
void meets_draw(const raster *r, int i, const band *b, int end, meets *room);

#endif
