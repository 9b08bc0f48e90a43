/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Which triangles of a mesh share edges, and which hang together: what the indices of its corners tell, and where these
 * end the places of points. */
#ifndef ENCRE_TOPOLOGY_H
#define ENCRE_TOPOLOGY_H

#include "encre.h"

#include <stdbool.h>

#define NO_CORNER UINT32_MAX

/* Corner c begins the edge to the next corner of triangle c / 3. Triangles share an edge by the indices of its points,
 * of which those count as one that a triangle has at one place; it has no edges. Two edges of one triangle each are one
 * if both have their ends at the same places, and no third. */
typedef struct topology {
	uint32_t *next;  /* by corner: the next one that has the same edge, in the order of the mesh, or NO_CORNER */
	uint8_t *first;  /* by triangle: bit k: edge k is an edge, and no triangle before has it; bit 3 + k: it goes
			    from the lower point to the higher, or, of two that are one by places, from the lesser */
	uint32_t *piece; /* by triangle: the first that it hangs together with */
	bool by_place;   /* it depends on where the points are */
} topology;

static inline int32_t topology_point(const encre_mesh *mesh, uint32_t corner)
{
	return mesh->corners ? mesh->corners[corner] : (int32_t)corner;
}

static inline bool topology_rises(const topology *t, uint32_t corner)
{
	return t->first[corner / 3] >> (3 + corner % 3) & 1;
}

/* Whether some triangle has two corners at one place: edges then depend on where the points are. */
bool topology_by_place(const encre_mesh *mesh);
/* Fills the three arrays and by_place. False without memory, of which it takes 12 bytes a triangle and 16 a point for a
 * while, and up to 32 an edge that one triangle alone has. */
bool topology_find(const encre_mesh *mesh, topology *t);

#endif
