/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Which edges of triangles can be contours on the screen. */
#ifndef ENCRE_CONTOURS_H
#define ENCRE_CONTOURS_H

#include "raster/geometry.h"
#include "raster/topology.h"
#include "base/stage.h"

/* On which side of an edge surfaces lie on the screen, going from its first corner to its second, y down. */
enum contour_side { CONTOUR_NONE = 0, CONTOUR_RIGHT = 1, CONTOUR_LEFT = 2, CONTOUR_BOTH = 3 };

enum { CONTOUR_FOLDS = 6 };

/* edges: of each primitive, for triangles two bits per edge, that from corner k to the next from bit 2 k on. Of the
 * triangles of a mesh that share an edge, by the indices of its points, one has the side on which all of them lie, or
 * CONTOUR_BOTH where numbers of objects or materials differ; else all have none. From bit CONTOUR_FOLDS on a bit per
 * edge that has a side: several triangles share it, so that the surface folds there and does not end. Parts have their
 * topology and spots. faces: room for one of each primitive. Returns a code of enum encre_code. */
int32_t contours_find(bands *pool, const geometry *g, uint8_t *faces, uint16_t *edges);

/* bends: of each triangle three, by corners as the sides: for one of those that share an edge by how much it bends
 * there, in BEND_UNIT of a degree, and BEND_SMOOTH; 0 where that is less than BEND_LEAST. False without memory, of
 * which it takes 24 bytes a triangle. */
bool contours_bends(const part *part, const topology *t, uint16_t *bends);
/* Likewise between two surfaces, by what lies across them, of any length; `offset` is the mesh's crease_offset. */
uint16_t contours_bend(const double one[3], const double other[3], float offset);
/* Likewise between what is seen of two triangles, with the second one's crease_offset. */
uint16_t contours_bend_seen(const geometry *g, uint32_t one, uint32_t other);

enum { BEND_UNIT = 128, BEND_LEAST = 5 * BEND_UNIT, BEND_MOST = 180 * BEND_UNIT, BEND_SMOOTH = 1 << 15 };

/* Degrees, negative for an edge that is shaded smoothly. */
static inline float bend_degrees(uint16_t bend)
{
	float degrees = (float)(bend & ~BEND_SMOOTH) / BEND_UNIT;
	return bend & BEND_SMOOTH ? -degrees : degrees;
}

static inline enum contour_side contour_side(uint16_t edges, int k)
{
	return (enum contour_side)(edges >> 2 * k & CONTOUR_BOTH);
}

static inline bool contour_folds(uint16_t edges, int k)
{
	return edges >> (CONTOUR_FOLDS + k) & 1;
}

/* At how many edges of a triangle the surface ends. */
static inline int contour_ends(uint16_t edges)
{
	int ends = 0;
	for (int k = 0; k < 3; k++)
		ends += contour_side(edges, k) != CONTOUR_NONE && !contour_folds(edges, k);
	return ends;
}

#endif
