/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Each point is brought onto the screen once: about six triangles have it, and each is looked at several times. */
#include "raster/spots.h"

enum { BLOCK = 4096 /* points that a thread takes at once */ };

typedef struct search {
	const geometry *g;
	const room *room;
	spot *spots;
} search;

static void find_blocks(void *data, int b0, int b1, int thread)
{
	(void)thread;
	const search *s = data;
	size_t from = (size_t)b0 * BLOCK, end = (size_t)b1 * BLOCK;
	for (int p = 0; p < s->g->n_parts; p++) {
		const part *part = s->g->parts + p;
		if (!part->spots)
			continue;
		size_t first = (size_t)(part->spots - s->spots), n = (size_t)part->mesh->n_points;
		for (size_t i = from > first ? from : first; i < end && i < first + n; i++) {
			s->spots[i].corner = geometry_corner(part, part->mesh->points + 3 * (i - first));
			outline_see(s->room, s->spots + i);
		}
	}
}

int32_t spots_find(bands *pool, geometry *g, const room *room, spot *spots)
{
	search s = {g, room, spots};
	for (int p = 0; p < g->n_parts; p++) {
		part *part = g->parts + p;
		if (part->mesh->kind != ENCRE_TRIANGLES)
			continue;
		part->spots = spots;
		spots += part->mesh->n_points;
	}
	return bands_run(pool, (int)((g->n_points + BLOCK - 1) / BLOCK), 1, find_blocks, &s);
}
