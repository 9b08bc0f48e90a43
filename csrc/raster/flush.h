/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Where a piece of a mesh ends flush with another piece of it. */
#ifndef ENCRE_FLUSH_H
#define ENCRE_FLUSH_H

#include "raster/raster.h"
#include "raster/segment.h"

enum { FLUSH_WAYS = 1024 }; /* that are looked at together */

/* A place just beside an edge, and which triangle of its mesh is in front there. */
typedef struct beside {
	double x, y, z;
	uint32_t way, number;
} beside;

/* A way between pixels on which an edge passes, where another piece of its mesh may go on from it. */
typedef struct flush_way {
	crossing at;
	uint32_t number; /* of the edge's triangle */
	int k;           /* the edge is that from this corner to the next */
	uint32_t side[2];
} flush_way;

/* What a thread needs. */
typedef struct flush {
	uint32_t n;
	flush_way way[FLUSH_WAYS];
	beside look[2 * FLUSH_WAYS];
} flush;

/* Finds for all n ways of band `i` what lies on both sides of the edge. */
void flush_look(const raster *r, int i, flush *f);
/* What is seen of an edge that was looked at. */
enum flush_seen {
	FLUSH_NOT,     /* what it tells itself */
	FLUSH_COVERED, /* nothing: other surfaces lie before it */
	FLUSH_GOES_ON, /* the surfaces on both sides go through it */
};
/* In *bend by how much the surface bends where it goes on, as contours_bend(). */
enum flush_seen flush_seen(const raster *r, const flush_way *way, uint16_t *bend);

#endif
