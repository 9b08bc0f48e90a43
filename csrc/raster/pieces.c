/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Pieces of meshes: points are joined by each triangle, with ways to the root that are halved as they are walked. */
#include "raster/pieces.h"

#include <stdatomic.h>
#include <stdlib.h>

static uint32_t root_of(uint32_t *above, uint32_t point)
{
	while (above[point] != point)
		point = above[point] = above[above[point]];
	return point;
}

static bool find(const part *part, uint32_t *piece)
{
	const encre_mesh *mesh = part->mesh;
	uint32_t n = (uint32_t)mesh->n_primitives, points = (uint32_t)mesh->n_points;
	if (!mesh->corners || mesh->kind != ENCRE_TRIANGLES) {
		for (uint32_t i = 0; i < n; i++)
			piece[i] = part->first + i;
		return true;
	}
	uint32_t *above = malloc(2 * (size_t)points * sizeof *above), *first = above + points;
	if (!above)
		return false;
	for (uint32_t p = 0; p < points; p++) {
		above[p] = p;
		first[p] = UINT32_MAX;
	}
	for (uint32_t i = 0; i < n; i++)
		for (int k = 1; k < 3; k++) {
			uint32_t a = root_of(above, (uint32_t)mesh->corners[3 * (size_t)i]);
			uint32_t b = root_of(above, (uint32_t)mesh->corners[3 * (size_t)i + (size_t)k]);
			above[a > b ? a : b] = a < b ? a : b;
		}
	for (uint32_t i = 0; i < n; i++) {
		uint32_t root = root_of(above, (uint32_t)mesh->corners[3 * (size_t)i]);
		if (first[root] == UINT32_MAX)
			first[root] = i;
		piece[i] = part->first + first[root];
	}
	free(above);
	return true;
}

typedef struct search {
	const geometry *g;
	uint32_t *piece;
	atomic_bool failed;
} search;

static void find_parts(void *data, int p0, int p1, int thread)
{
	(void)thread;
	search *s = data;
	for (int p = p0; p < p1; p++)
		if (!find(s->g->parts + p, s->piece + s->g->parts[p].first))
			atomic_store(&s->failed, true);
}

int32_t pieces_find(bands *pool, const geometry *g, uint32_t *piece)
{
	search s = {.g = g, .piece = piece};
	atomic_init(&s.failed, false);
	int32_t code = bands_run(pool, g->n_parts, 1, find_parts, &s);
	return code ? code : atomic_load(&s.failed) ? ENCRE_ERROR_MEMORY : ENCRE_OK;
}
