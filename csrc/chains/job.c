/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A job: the files of the room, in order. */
#include "chains/chains.h"

#include <limits.h>
#include <stdlib.h>
#include <string.h>

void chains_free(kept_shapes **kept)
{
	kept_shapes *k = *kept;
	if (!k)
		return;
	for (int i = 0; i < k->n; i++)
		shape_free(k->all[i]);
	free(k->all);
	free(k->placed);
	free(k->pairs);
	free(k->meets);
	free(k->points);
	colors_free(k);
	free(k);
	*kept = NULL;
}

static void aim(chains *c)
{
	const encre_chain_job *job = c->job;
	const double *v = job->view;
	c->perspective = job->projection[14] != 0;
	for (int k = 0; k < 3; k++) {
		c->eye[k] = -(v[k] * v[3] + v[4 + k] * v[7] + v[8 + k] * v[11]);
		c->back[k] = v[8 + k];
	}
	c->pixel = 2 / (fabs(job->projection[5]) * job->frame.height);
	c->x0 = job->frame.x;
	c->y0 = job->frame.y;
	c->x1 = c->x0 + job->width;
	c->y1 = c->y0 + job->height;
}

static int32_t run(chains *c, bool best)
{
	int32_t code = shapes_find(c);
	if (!code) {
		const part *part = c->g.parts;
		for (int i = 0; i < c->n_bodies; i++)
			if (c->bodies[i].mesh->n_primitives)
				c->bodies[i].part = part++;
		code = lines_aim(c);
	}
	if (!code)
		code = meets_find(c);
	if (!code)
		code = colors_find(c);
	if (!code)
		code = lines_find(c);
	if (!code && c->n_lines > INT_MAX / 4)
		code = ENCRE_ERROR_MEMORY;
	if (!code)
		code = lines_link(c);
#ifdef ENCRE_HAVE_V3
	if (!code)
		code = best ? sight_find_v3(c) : sight_find_base(c);
#else
	(void)best;
	if (!code)
		code = sight_find_base(c);
#endif
	return code ? code : runs_write(c);
}

int32_t chains_run(bands *pool, encre_chain_job *job, bool best, kept_shapes **kept, char *error, size_t size)
{
	encre_raster_job meshes = {.meshes = job->meshes,
				   .n_meshes = job->n_meshes,
				   .clip_start = job->clip_start,
				   .clip_end = job->clip_end,
				   .frame = job->frame};
	for (int i = 0; i < 16; i++) {
		meshes.view[i] = job->view[i];
		meshes.projection[i] = job->projection[i];
	}
	chains c = {.job = job, .pool = pool, .g = {.job = &meshes}, .n_bodies = job->n_meshes, .best = best};
	int32_t code = geometry_check(&c.g, error, size);
	if (code)
		return code;
	if (!*kept && !(*kept = calloc(1, sizeof **kept)))
		return ENCRE_ERROR_MEMORY;
	c.kept = *kept;
	c.kept->n_points = 0;
	c.g.parts = late_take(&c.late, (size_t)job->n_meshes + 1, sizeof *c.g.parts);
	if (c.g.parts) {
		geometry_aim(&c.g);
		aim(&c);
	}
	code = c.g.parts ? run(&c, best) : ENCRE_ERROR_MEMORY;
	job->points = code ? NULL : c.kept->points;
	job->n_points = code ? 0 : c.kept->n_points;
	tree_free(&c.tree);
	late_free(c.late);
	return code;
}
