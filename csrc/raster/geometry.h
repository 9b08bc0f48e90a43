/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The meshes of a raster job as one row of primitives, seen by its camera. */
#ifndef ENCRE_GEOMETRY_H
#define ENCRE_GEOMETRY_H

#include "encre.h"
#include "raster/outline.h"

#include <stddef.h>

/* A mesh that has primitives, and its share of their running numbers. */
typedef struct part {
	const encre_mesh *mesh;
	uint32_t first;
	double screen[16]; /* object space -> corner, row by row */
	double turn[9];    /* normals: object -> world space, of any length */
	float stretch[3];  /* of rest positions: by how much more an axis is scaled than all on average */
	double span; /* with the output `anchor`: rest units that a world unit is on its surface, 0 where it has none */
	double shift[3]; /* likewise: of a copy, added to rest positions there */
	double card[4];  /* with the output `card`: its origin on the screen, its growth per pixel to the right */
	spot *spots;     /* of triangles: spots_find()'s, by point */
} part;

typedef struct geometry {
	const encre_raster_job *job;
	uint32_t n_primitives; /* of all meshes, at most UINT32_MAX / 3: their corners are counted, too */
	size_t n_points;       /* of triangles */
	int n_parts;
	part *parts;   /* room for job->n_meshes, the owner's */
	double eye[4]; /* world space; [3] 0 = the direction towards an eye infinitely far */
} geometry;

/* Checks camera and meshes, and counts the primitives. Returns ENCRE_OK, or ENCRE_ERROR_ARGUMENT and a sentence. */
/* One mesh, by the number that it is called in messages. */
int32_t geometry_check_mesh(const encre_mesh *mesh, int number, char *error, size_t size);
int32_t geometry_check(geometry *g, char *error, size_t size);
/* Fills `parts` and `eye`. */
void geometry_aim(geometry *g);
/* The part that a primitive belongs to; `last` (may be NULL), that of the primitive before, is most often right. */
const part *geometry_part(const geometry *g, const part *last, uint32_t number);
/* The number of the object that a primitive of a part is of. */
float geometry_object(const part *part, uint32_t number);
/* A point in object space on the screen. */
corner geometry_corner(const part *part, const float *point);
/* Corners of primitive `i` of a part, whose spots are there: three, of a line two. */
void geometry_corners(const part *part, uint32_t i, corner c[3]);
/* What a triangle covers, as outline_make(). */
bool geometry_outline(const part *part, uint32_t i, const room *room, outline *o);
/* Corners of a triangle in world space, and where it rests: in object space, each axis as long as the scale makes it
 * beside the others, or patterns would be drawn out with every object that is scaled more one way. */
void geometry_world(const part *part, uint32_t i, double p[3][3]);
void geometry_rest(const part *part, uint32_t i, float p[3][3]);
/* Across a triangle in world space, to the side from which its corners go round against the clock; of any length. */
void geometry_across(const part *part, uint32_t i, double across[3]);
/* A triangle's unit normal, world space, facing the eye. */
void geometry_normal(const geometry *g, const part *part, uint32_t i, float normal[3]);
/* A normal in object space, turned and made of length 1 in world space, times `side`; false: it has no direction. */
bool geometry_turn(const part *part, const double normal[3], double side, float turned[3]);

#endif
