/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Which triangles of a mesh share edges, and which hang together: what the indices of its corners tell, and where these
 * end the places of points. */
#ifndef ENCRE_TOPOLOGY_H
#define ENCRE_TOPOLOGY_H

#include "encre.h"

#include <stdbool.h>
#include <stddef.h>

#define NO_CORNER UINT32_MAX

/* Corner c begins the edge to the next corner of triangle c / 3. Triangles share an edge by the indices of its points,
 * of which those count as one that a triangle has at one place; it has no edges. Two edges of one triangle each are one
 * if both have their ends at the same places, and no third. */
typedef struct topology {
	uint32_t *next;  /* by corner: the next one that has the same edge, in the order of the mesh, or NO_CORNER */
	uint8_t *first;  /* by triangle: bit k: edge k is an edge, and no triangle before has it */
	uint32_t *piece; /* by triangle: the first that it hangs together with */
} topology;

static inline int32_t topology_point(const encre_mesh *mesh, uint32_t corner)
{
	return mesh->corners ? mesh->corners[corner] : (int32_t)corner;
}

static inline bool topology_same_place(const encre_mesh *mesh, int32_t a, int32_t b)
{
	const float *p = mesh->points + 3 * (size_t)a, *q = mesh->points + 3 * (size_t)b;
	return p[0] == q[0] && p[1] == q[1] && p[2] == q[2];
}

/* What stands for all that is united with it: the least, found by ways that are halved as they are walked. At first
 * each stands for itself. */
static inline uint32_t topology_root(uint32_t *above, uint32_t of)
{
	while (above[of] != of)
		of = above[of] = above[above[of]];
	return of;
}

static inline void topology_unite(uint32_t *above, uint32_t a, uint32_t b)
{
	a = topology_root(above, a);
	b = topology_root(above, b);
	above[a > b ? a : b] = a < b ? a : b;
}

/* Fills the three arrays. False without memory, of which it takes 12 bytes a triangle and 16 a point for a
 * while, and up to 32 an edge that one triangle alone has. */
bool topology_find(const encre_mesh *mesh, topology *t);

#endif
