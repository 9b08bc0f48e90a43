/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What a scene keeps, and what of it the rays of one job see. */
#ifndef ENCRE_SCENE_H
#define ENCRE_SCENE_H

#include "base/bands.h"
#include "light/tree.h"
#include "light/vector.h"

#include <stdatomic.h>
#include <stddef.h>

enum { LEAF = 4 };

/* Triangles side by side: a corner and the two edges from it. item < 0: there is none. */
typedef struct triangle_leaf {
	float corner[3][LEAF], first[3][LEAF], second[3][LEAF];
	int32_t item[LEAF];
} triangle_leaf;

typedef struct shape {
	int32_t n_points, n_triangles, used; /* by so many instances */
	bool built;
	float *points, *normals; /* of the owner; normals may be NULL */
	int32_t *corners;
	float *uvs; /* and textures; NULL where it has no holes */
	int32_t *textures;
	tree tree; /* over triangles; empty where none is finite */
	triangle_leaf *leaves;
	float low[3], high[3];
} shape;

typedef struct texture {
	int32_t width, height, extension;
	bool closest;
	uint8_t alpha[];
} texture;

typedef struct instance {
	int64_t geometry;
	const shape *shape;
	uint64_t light_sets, shadow_sets;
	bool camera, mirrored, there; /* there: the matrix has an inverse, and the shape something to hit */
	double model[12], inverse[12];
} instance;

/* By ascending keys. */
typedef struct store {
	int64_t *keys;
	void **items;
	int32_t count, room;
} store;

void *store_find(const store *s, int64_t key); /* NULL: it is not there */
/* Whether there is room for one more, or memory for it. */
bool store_room(store *s);
/* Puts an item in the place of the one with its key, which it returns; NULL if there was none. There is room. */
void *store_put(store *s, int64_t key, void *item);
void *store_take(store *s, int64_t key);

struct encre_scene {
	store shapes, instances, textures, lamps;
	atomic_int lit;        /* by so many steps that run or are to run */
	atomic_bool forgotten; /* freed by the last of them */
};

/* The scene as rays see it. Instances are counted as in the store. */
typedef struct world {
	const instance *const *instances;
	int32_t n_instances;
	instance *moved; /* of which they are, if the world is moved */
	tree tree;       /* over instances, one to a leaf */
	tree_box *boxes;
	float low[3], high[3]; /* of all */
	const store *textures;
} world;

/* Whether a triangle of a shape with textures is solid there, by how far it is along its two edges. */
bool solid_at(const store *textures, const shape *s, int32_t triangle, float u, float v);

/* Builds the trees that are missing, and the world, in which `origin` of the scene is 0. world_free() whatever it
 * returns. */
int32_t world_make(world *w, const encre_scene *scene, const double origin[3], bands *pool);
void world_free(world *w);

#endif
