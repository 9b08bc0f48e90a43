/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Which edges of triangles can be contours on the screen. */
#ifndef ENCRE_CONTOURS_H
#define ENCRE_CONTOURS_H

#include "raster/geometry.h"
#include "base/stage.h"

/* On which side of an edge surfaces lie on the screen, going from its first corner to its second, y down. */
enum contour_side { CONTOUR_NONE = 0, CONTOUR_RIGHT = 1, CONTOUR_LEFT = 2, CONTOUR_BOTH = 3 };

/* edges: of each primitive, for triangles two bits per edge, that from corner k to the next from bit 2 k on. Of the
 * triangles of a mesh that share an edge, by the indices of its points, one has the side on which all of them lie, or
 * CONTOUR_BOTH where numbers of objects or materials differ; else all have none. Returns a code of enum encre_code.
 * Takes about 20 bytes a triangle of the meshes that are searched at once, one by each thread. */
int32_t contours_find(bands *pool, const geometry *g, uint8_t *edges);

static inline enum contour_side contour_side(uint8_t edges, int k)
{
	return (enum contour_side)(edges >> 2 * k & CONTOUR_BOTH);
}

#endif
