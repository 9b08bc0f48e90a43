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
/* bodies.c: where shapes stand, and a tree of them; by mesh of the job. Returns a code of enum encre_code. */
int32_t bodies_place(chains *c, const recipe *recipes);

#endif
