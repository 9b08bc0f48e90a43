/* SPDX-License-Identifier: GPL-3.0-or-later */
/* One shape: what it is made of, by which it is known again, and how it is found. */
#ifndef ENCRE_SHAPES_H
#define ENCRE_SHAPES_H

#include "chains/chains.h"

typedef struct recipe {
	const encre_mesh *mesh;
	double linear[9]; /* in which bends are measured: object space, or as the model stretches it */
	uint64_t key[2];
	int like; /* an earlier mesh that is made of the same arrays; -1 */
	shape *shape;
} recipe;

/* Degrees: what bends less is no part of a strip. */
static const float strip_flat = 1;

/* In the space in which bends are measured: a way of object space, a point, across a triangle, an edge's length. */
static inline void recipe_stretch(const recipe *r, const double p[3], double out[3])
{
	const double *m = r->linear;
	for (int i = 0; i < 3; i++)
		out[i] = m[3 * i] * p[0] + m[3 * i + 1] * p[1] + m[3 * i + 2] * p[2];
}

static inline void recipe_point(const recipe *r, int32_t number, double out[3])
{
	const float *p = r->mesh->points + 3 * (size_t)number;
	recipe_stretch(r, (double[]){(double)p[0], (double)p[1], (double)p[2]}, out);
}

static inline void recipe_across(const recipe *r, int32_t face, double out[3])
{
	double p[3][3];
	for (uint32_t k = 0; k < 3; k++)
		recipe_point(r, topology_point(r->mesh, 3 * (uint32_t)face + k), p[k]);
	across3(p, out);
}

static inline double recipe_edge_length(const recipe *r, const mesh_edge *e)
{
	double a[3], b[3];
	recipe_point(r, e->end[0], a);
	recipe_point(r, e->end[1], b);
	minus3(a, b, a);
	return sqrt(dot3(a, a));
}

static inline uint64_t stir(uint64_t h)
{
	h ^= h >> 32;
	h *= 0xd6e8feb86659fd93u;
	return h ^ h >> 29;
}

/* recipes.c: that of a mesh, without its key, which is found next; whether two are made of the same arrays. */
recipe recipe_of(const encre_mesh *mesh);
void recipe_key(recipe *r);
bool recipe_same_arrays(const recipe *r, const recipe *s);
/* shape.c: NULL without memory. */
shape *shape_make(const recipe *r);
/* bevel.c: bends over several faces; bevel_corners.c: leads those that meet in a corner on to each other. False without
 * memory. */
bool strips_find(const recipe *r, shape *s);
bool strips_join(const recipe *r, shape *s);
/* bodies.c: where shapes stand, and a tree of them; by mesh of the job. Returns a code of enum encre_code. */
int32_t bodies_place(chains *c, const recipe *recipes);

#endif
