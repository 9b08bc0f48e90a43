/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Where colors part in the images of a job: found once for each, and kept as long as jobs have it. */
#include "chains/chains.h"

#include "texels/texels.h"

#include <stdatomic.h>
#include <stdlib.h>

/* Px: lines so close are not drawn; pixels of a px, at least. As density.c has it. */
static const float gone = 2.5f, least_px = 0.6f;
static const float least_seen = 0.03f; /* contrast: what is less is noise, or so thin that nobody sees it */

typedef struct making {
	chains *c;
	atomic_bool failed;
} making;

/* The least contrast that can be a line in some style, however faint, beside one that is. */
static float least_contrast(const encre_params *p, int n, bool painted)
{
	const float faint = 0.5f, least_full = 0.25f;
	float weight = painted ? 1 : 0;
	for (int i = 0; i < n; i++)
		weight = max(weight, p[i].line_color_strength + (painted ? 1 : 0));
	if (!(weight > 0))
		return INFINITY;
	float most = p->contrast_local ? min(p->contrast_full, least_full) : p->contrast_full,
	      least = p->contrast_threshold, share = min(1, faint * p->edge_threshold / weight);
	least = most > least ? least + (most - least) * share : least;
	return max(least, least_seen);
}

static void make_images(void *data, int from, int end, int thread)
{
	(void)thread;
	making *m = data;
	for (int i = from; i < end && !bands_stopped(m->c->pool); i++) {
		uint32_t levels = atomic_exchange(m->c->lacking + i, 0);
		boundaries *b = m->c->images[i];
		if (!levels)
			continue;
#ifdef ENCRE_HAVE_V3
		bool made = m->c->best ? boundaries_fill_v3(b, m->c->recipes + i, levels)
				       : boundaries_fill_base(b, m->c->recipes + i, levels);
#else
		bool made = boundaries_fill_base(b, m->c->recipes + i, levels);
#endif
		if (!made)
			atomic_store(&m->failed, true);
	}
}

void colors_free(kept_shapes *kept)
{
	for (int i = 0; i < kept->n_images; i++)
		boundaries_free(kept->images[i]);
	free(kept->images);
	kept->images = NULL;
	kept->n_images = 0;
}

/* Those of this job are kept, each once, and others forgotten. */
static int32_t keep_images(chains *c)
{
	kept_shapes *kept = c->kept;
	int n = c->job->n_images, count = 0;
	boundaries **all = malloc(((size_t)n + 1) * sizeof *all);
	for (int i = 0; i < kept->n_images; i++)
		kept->images[i]->used = false;
	for (int i = 0; i < n; i++)
		if (c->images[i])
			c->images[i]->used = false;
	for (int i = 0; i < n; i++)
		if (c->images[i] && !c->images[i]->used) {
			c->images[i]->used = true;
			if (all)
				all[count] = c->images[i];
			count++;
		}
	for (int i = 0; i < kept->n_images; i++)
		if (!kept->images[i]->used)
			boundaries_free(kept->images[i]);
	if (!all) {
		for (int i = 0; i < n; i++)
			if (c->images[i] && c->images[i]->used) {
				c->images[i]->used = false;
				boundaries_free(c->images[i]);
			}
		count = 0;
	}
	free(kept->images);
	kept->images = all;
	kept->n_images = count;
	return all ? ENCRE_OK : ENCRE_ERROR_MEMORY;
}

int32_t colors_find(chains *c)
{
	const encre_chain_job *job = c->job;
	const encre_params *p = job->params;
	float least = job->n_images && p ? least_contrast(p, job->n_styles, true) : INFINITY;
	c->images = NULL;
	c->gone = (double)(gone * (p ? max(scale_of(p, job->frame.height), least_px) : 1));
	if (!p || !(least < INFINITY))
		return ENCRE_OK;
	size_t n = (size_t)job->n_images;
	texel_recipe *recipes = c->recipes = late_take(&c->late, n + 1, sizeof *recipes);
	atomic_uint *levels = c->lacking = late_take(&c->late, n + 1, sizeof *levels);
	c->images = late_take(&c->late, n + 1, sizeof *c->images);
	if (!recipes || !levels || !c->images)
		return ENCRE_ERROR_MEMORY;
	bool begun = true;
	for (size_t i = 0; i < n; i++) {
		recipes[i] = recipe_of_image(job->images + i, metric_of(p), least, p->color_smooth);
		c->images[i] = NULL;
		for (int k = 0; k < c->kept->n_images && !c->images[i]; k++)
			if (boundaries_are(c->kept->images[k], recipes + i))
				c->images[i] = c->kept->images[k];
		for (size_t k = 0; k < i && !c->images[i]; k++) /* or two would be made of one */
			if (c->images[k] && boundaries_are(c->images[k], recipes + i))
				c->images[i] = c->images[k];
		if (!c->images[i])
			c->images[i] = boundaries_begin(recipes + i);
		begun = begun && c->images[i];
		atomic_init(levels + i, 0);
	}
	int32_t code = keep_images(c);
	if (!begun)
		code = ENCRE_ERROR_MEMORY;
	return code;
}

int32_t colors_fill(chains *c, bool *any)
{
	making m = {.c = c};
	*any = false;
	for (int i = 0; i < c->job->n_images; i++) {
		*any |= atomic_load(c->lacking + i) != 0;
		for (int k = 0; k < i; k++)
			if (c->images[k] == c->images[i]) { /* the first makes all */
				atomic_fetch_or(c->lacking + k, atomic_exchange(c->lacking + i, 0));
				break;
			}
	}
	int32_t code = *any ? bands_run(c->pool, c->job->n_images, 1, make_images, &m) : ENCRE_OK;
	return !code && atomic_load(&m.failed) ? ENCRE_ERROR_MEMORY : code;
}
