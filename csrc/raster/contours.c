/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Contours of triangles. A surface ends on the screen where it turns away from the eye, is cut off or changes its
 * number. That is told from the sides of an edge on which its triangles lie, in whatever sense their corners go round:
 * on one only, and the surface ends or folds there. Where it goes on it may bend: that is told by its triangles'
 * normals in the world, whichever way round their corners go. */
#include "raster/contours.h"

#include "base/pixel.h"

#include <stdlib.h>
#include <string.h>

enum {
	DIFFERENT = 4,    /* beside the sides: numbers differ */
	SHARED = 8,       /* likewise: several triangles have it */
	TRIANGLES = 4096, /* that a thread takes at once */
};

static inline bool same_place(const corner *a, const corner *b)
{
	return a->x == b->x && a->y == b->y && a->z == b->z && a->w == b->w;
}

/* Where the triangle lies beside each of its edges, also where a corner lies behind the eye. What is no triangle, as
 * at a pole or a tip with a point for each meridian, parts nothing: as if it lay on both sides. */
static enum contour_side facing(const part *part, uint32_t i)
{
	const corner *a = &part->spots[topology_point(part->mesh, 3 * i)].corner,
		     *b = &part->spots[topology_point(part->mesh, 3 * i + 1)].corner,
		     *c = &part->spots[topology_point(part->mesh, 3 * i + 2)].corner;
	if (same_place(a, b) || same_place(b, c) || same_place(c, a))
		return CONTOUR_BOTH;
	double volume = outline_turn(a, b, c);
	return volume > 0 ? CONTOUR_RIGHT : volume < 0 ? CONTOUR_LEFT : CONTOUR_NONE;
}

static inline enum contour_side turned(enum contour_side side)
{
	return side == CONTOUR_RIGHT ? CONTOUR_LEFT : side == CONTOUR_LEFT ? CONTOUR_RIGHT : side;
}

static bool same_numbers(const encre_mesh *mesh, uint32_t i, uint32_t j)
{
	return (!mesh->object || mesh->object[i] == mesh->object[j]) &&
	       (!mesh->material || mesh->material[i] == mesh->material[j]);
}

static enum encre_edge edge_at(const encre_mesh *mesh, uint32_t corner)
{
	return mesh->edges ? (enum encre_edge)(mesh->edges[corner / 3] >> 2 * (corner % 3) & 3) : ENCRE_EDGE_FLAT;
}

uint16_t contours_bend(const double one[3], const double other[3], float offset)
{
	double along = 0, sine = 0;
	for (int k = 0; k < 3; k++) {
		int i = (k + 1) % 3, j = (k + 2) % 3;
		double s = one[i] * other[j] - one[j] * other[i];
		along += one[k] * other[k];
		sine += s * s;
	}
	double longest = fmax(sqrt(sine), fabs(along)); /* products of areas: too large or too small for a float */
	if (!(longest > 0 && longest < INFINITY))
		return 0;
	double degrees =
		57.29577951308232 * (double)pixel_atan2((float)(sqrt(sine) / longest), (float)(along / longest));
	double bend = BEND_UNIT * (degrees + (double)offset) + 0.5;
	return bend >= BEND_LEAST ? bend < BEND_MOST ? (uint16_t)bend : BEND_MOST : 0;
}

uint16_t contours_bend_seen(const geometry *g, uint32_t one, uint32_t other)
{
	const uint32_t number[2] = {one, other};
	double across[2][3];
	const part *part = NULL;
	for (int side = 0; side < 2; side++) {
		float normal[3];
		part = geometry_part(g, part, number[side]);
		geometry_normal(g, part, number[side] - part->first, normal);
		for (int c = 0; c < 3; c++)
			across[side][c] = (double)normal[c];
	}
	return contours_bend(across[0], across[1], part->mesh->crease_offset);
}

/* How much the surface bends between the triangles of two corners at which the same edge begins or ends. */
static uint16_t bend_of(const encre_mesh *mesh, const topology *t, double (*across)[3], uint32_t c, uint32_t d)
{
	enum encre_edge one = edge_at(mesh, c), other = edge_at(mesh, d), edge = one < other ? one : other;
	if (one >= ENCRE_EDGE_NONE || other >= ENCRE_EDGE_NONE)
		return 0;
	const double *a = across[c / 3], *b = across[d / 3];
	/* else they go along it in opposite ways */
	double turn = topology_rises(t, c) == topology_rises(t, d) ? -1 : 1;
	uint16_t bend = contours_bend(a, (double[]){turn * b[0], turn * b[1], turn * b[2]}, mesh->crease_offset);
	return (uint16_t)(bend | (bend && edge == ENCRE_EDGE_SMOOTH ? BEND_SMOOTH : 0));
}

bool contours_bends(const part *part, const topology *t, uint16_t *bends)
{
	const encre_mesh *mesh = part->mesh;
	uint32_t n = (uint32_t)mesh->n_primitives;
	double (*across)[3] = malloc(n * sizeof *across);
	if (!across)
		return false;
	memset(bends, 0, (size_t)3 * n * sizeof *bends);
	for (uint32_t i = 0; i < n; i++)
		geometry_across(part, i, across[i]);
	for (uint32_t c = 0; c < 3 * n; c++) {
		if (!(t->first[c / 3] >> c % 3 & 1))
			continue;
		for (uint32_t d = t->next[c]; d != NO_CORNER; d = t->next[d]) {
			uint16_t bend = bend_of(mesh, t, across, c, d);
			if ((bend & ~BEND_SMOOTH) > (bends[c] & ~BEND_SMOOTH))
				bends[c] = bend;
		}
	}
	free(across);
	return true;
}

/* ---- contours ---------------------------------------------------------------------------------------------- */

/* The side of an edge on which a triangle lies that has it at a corner, going from the lower point. */
static inline enum contour_side side_of(const topology *t, const uint8_t *faces, uint32_t corner)
{
	enum contour_side side = (enum contour_side)faces[corner / 3];
	return topology_rises(t, corner) ? side : turned(side);
}

/* What contours_find() says of the edge of these corners, the first and those that follow it. */
static unsigned edge_of(const encre_mesh *mesh, const topology *t, const uint8_t *faces, uint32_t c)
{
	unsigned cover = side_of(t, faces, c);
	for (uint32_t d = t->next[c]; d != NO_CORNER; d = t->next[d])
		cover |= SHARED | side_of(t, faces, d) | (same_numbers(mesh, d / 3, c / 3) ? 0 : DIFFERENT);
	if ((cover & ~(unsigned)SHARED) == CONTOUR_BOTH)
		return 0;
	enum contour_side side = (enum contour_side)(cover & CONTOUR_BOTH);
	side = cover & DIFFERENT ? CONTOUR_BOTH : topology_rises(t, c) ? side : turned(side);
	unsigned fold = cover & SHARED && side != CONTOUR_BOTH;
	return side << 2 * (c % 3) | fold << (CONTOUR_FOLDS + c % 3);
}

typedef struct search {
	const geometry *g;
	uint8_t *faces;
	uint16_t *edges;
} search;

static void find_faces(void *data, int from, int end, int thread)
{
	(void)thread;
	const search *s = data;
	const part *part = NULL;
	for (uint32_t i = (uint32_t)from; i < (uint32_t)end; i++) {
		part = geometry_part(s->g, part, i);
		if (part->topology)
			s->faces[i] = (uint8_t)facing(part, i - part->first);
	}
}

static void find_edges(void *data, int from, int end, int thread)
{
	(void)thread;
	const search *s = data;
	const part *part = NULL;
	for (uint32_t i = (uint32_t)from; i < (uint32_t)end; i++) {
		part = geometry_part(s->g, part, i);
		const topology *t = part->topology;
		uint32_t own = i - part->first;
		unsigned all = 0;
		for (uint32_t k = 0; t && k < 3; k++)
			if (t->first[own] >> k & 1)
				all |= edge_of(part->mesh, t, s->faces + part->first, 3 * own + k);
		s->edges[i] = (uint16_t)all;
	}
}

int32_t contours_find(bands *pool, const geometry *g, uint8_t *faces, uint16_t *edges)
{
	search s = {g, faces, edges};
	int n = (int)g->n_primitives;
	int32_t code = bands_run(pool, n, TRIANGLES, find_faces, &s);
	return code ? code : bands_run(pool, n, TRIANGLES, find_edges, &s);
}
