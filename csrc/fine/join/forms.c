/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Lines of forms come and go as a form turns: each that hangs together is as wide as it is long and clear, so that none
 * comes at once. So are borders of light, whose short ones are patches that belong to nothing, what mirrors show of
 * rough water, and lines between colours: of paving far away, where joints are hardly to be seen, bits are left. */
#include "fine/near.h"

#include <string.h>

static const float counts_from = 1, counts_ramp = 1; /* of edge_threshold: so strong counts, and in full; test_forms */
static const float clearest = 100;                   /* times its length counts at most, or it might have no bound */
static const float least_share = 0.1f;               /* of its width: less is not drawn; test_forms */

static const float even_forms_over = 8; /* px to either side, about */

enum { CHUNK = 512 };

/* One that is thinned; RANK_COUNT: it is none, or dropped. */
static enum rank kind_of(const site *s)
{
	enum rank rank = (enum rank)rank_of(s);
	bool own = rank == RANK_FORM || rank == RANK_LIGHT || rank == RANK_COLOR || rank == RANK_SEEN;
	return own && !s->linked.dropped ? rank : RANK_COUNT;
}

/* How much of a site's length counts. Of colours all where they are just an edge, and more where they are clearer:
 * letters and eyes are small, and no scraps. Nor is what somebody painted. */
static float clear_at(const fine *n, uint32_t i)
{
	float threshold = n->e->p->edge_threshold, strength = n->site[i].placed.strength;
	enum rank rank = (enum rank)rank_of(n->site + i);
	if (rank == RANK_FORM && threshold > 0)
		return clamp01((strength / threshold - counts_from) / counts_ramp);
	if (rank == RANK_COLOR && ISA(fine_painted)(n, &n->site[i].placed) > 0)
		return clearest;
	if (rank == RANK_COLOR)
		return threshold > 0 ? min(clearest, max(0, (strength / threshold - least_faint) / (1 - least_faint)))
				     : clearest;
	return 1;
}

/* Collects what hangs together with open[0]; the length of what is clear of it, and how clear the clearest is. */
static float collect(const fine *n, bool *known, uint32_t *open, uint32_t *count, float *most)
{
	float length = 0;
	*most = clear_at(n, open[0]);
	for (uint32_t at = 0; at < *count; at++)
		for (uint32_t i = open[at], k = n->at[i]; k < n->at[i + 1]; k++) {
			uint32_t j = n->to[k];
			if (kind_of(n->site + i) != kind_of(n->site + j))
				continue;
			length += 0.25f * sqrtf(apart2(n->site + i, n->site + j)) * (clear_at(n, i) + clear_at(n, j));
			if (!known[j]) {
				known[j] = true;
				*most = max(*most, clear_at(n, j));
				open[(*count)++] = j;
			}
		}
	return length;
}

static float full_length(const encre_params *p, enum rank rank)
{
	return rank == RANK_FORM    ? p->line_suggestive_shortest
	       : rank == RANK_LIGHT ? p->line_shadow_shortest
	       : rank == RANK_COLOR ? p->line_color_shortest
				    : p->line_mirror_shortest;
}

/* Of the width, by the length of all, and of forms by how clear the clearest is. Below half the length asked none is
 * left: what closes would stay as a spot, and short folds are dashes. */
static float share_of(const fine *n, const site *s, float most, float length)
{
	enum rank rank = (enum rank)rank_of(s);
	float full = full_length(params_at(n->f, s->placed.near_x, s->placed.near_y), rank) * n->f->scale;
	float share = !(full > 0) ? 1 : clamp01(2 * length / full - 1);
	return rank == RANK_FORM ? min(most, share) : share;
}

/* Evens out how wide the lines of forms are along each, but for their ends: a fold that is deep here and there is one
 * stroke. */
static void even_forms(fine *n, const uint32_t *open, uint32_t count, float *wide, float *next)
{
	int rounds = (int)(even_forms_over * even_forms_over * n->f->scale * n->f->scale);
	for (uint32_t k = 0; k < count; k++)
		wide[open[k]] = (float)(255 - n->site[open[k]].placed.eased);
	for (int round = 0; round < rounds; round++) {
		for (uint32_t k = 0; k < count; k++) {
			uint32_t i = open[k];
			float sum = 2 * wide[i], weights = 2;
			for (uint32_t l = n->at[i]; l < n->at[i + 1] && n->at[i + 1] - n->at[i] > 1; l++)
				if (kind_of(n->site + n->to[l]) == RANK_FORM) {
					sum += wide[n->to[l]];
					weights++;
				}
			next[i] = sum / weights;
		}
		for (uint32_t k = 0; k < count; k++)
			wide[open[k]] = next[open[k]];
	}
	for (uint32_t k = 0; k < count; k++)
		n->site[open[k]].placed.eased = (uint8_t)(255 - wide[open[k]] + 0.5f);
}

/* ---- colours ---------------------------------------------------------------------------------------------- */

/* Of lines between colours: what of a texture far away hangs together changes from frame to frame, so each has the mean
 * of the shares about it. */
typedef struct evened {
	fine *n;
	float *share;    /* by site; below 0: it is none */
	float (*sum)[2]; /* by cell: of the shares, and how many there are */
	float spread;    /* pixels */
} evened;

static void sum_shares(void *data, int first, int end, int thread)
{
	(void)thread;
	const evened *e = data;
	for (int cell = first; cell < end && !stopped_at(e->n, cell); cell++) {
		float *sum = e->sum[cell];
		sum[0] = sum[1] = 0;
		for (uint32_t k = e->n->cell[cell]; k < e->n->cell[cell + 1]; k++) {
			float share = e->share[e->n->member[k]];
			sum[0] += max(0, share);
			sum[1] += share >= 0;
		}
	}
}

static void ease(site *s, float share)
{
	s->placed.eased = (uint8_t)(255 - share * (float)(255 - s->placed.eased) + 0.5f);
	s->linked.dropped |= share < least_share;
}

static void ease_colors(void *data, int first, int end, int thread)
{
	(void)thread;
	const evened *e = data;
	for (int i = first; i < end && !stopped_at(e->n, i); i++) {
		float sum[2];
		if (e->share[i] < 0)
			continue;
		sums_about(e->n, e->sum, e->n->site + i, e->spread, sum);
		ease(e->n->site + i, sum[0] / sum[1]);
	}
}

static int32_t even_colors(fine *n, float *share)
{
	int cells = n->across * n->tall;
	evened e = {.n = n,
		    .share = share,
		    .sum = late_take(&n->f->late, (size_t)cells, sizeof *e.sum),
		    .spread = color_spread * room_px(n, color_least_px)};
	if (!e.sum)
		return ENCRE_ERROR_MEMORY;
	int32_t code = bands_run(n->f->bands, cells, CHUNK, sum_shares, &e);
	code = code ? code : bands_run(n->f->bands, (int)n->count, CHUNK, ease_colors, &e);
	late_drop(&n->f->late, e.sum);
	return code;
}

/* ---- all -------------------------------------------------------------------------------------------------- */

int32_t ISA(fine_ease_forms)(fine *n)
{
	bool *known = late_take(&n->f->late, n->count + 1, sizeof *known);
	uint32_t *open = late_take(&n->f->late, n->count + 1, sizeof *open);
	float *color = late_take(&n->f->late, n->count + 1, sizeof *color);
	float *wide = late_take(&n->f->late, 2 * (size_t)n->count + 1, sizeof *wide);
	if (!known || !open || !color || !wide)
		return ENCRE_ERROR_MEMORY;
	memset(known, 0, n->count * sizeof *known);
	bool any = false;
	for (uint32_t i = 0; i < n->count; i++)
		color[i] = -1;
	int32_t code = ENCRE_OK;
	for (uint32_t i = 0; !code && i < n->count; i++) {
		code = at_step(n, i);
		if (known[i] || kind_of(n->site + i) == RANK_COUNT)
			continue;
		uint32_t count = 1;
		open[0] = i;
		known[i] = true;
		float most, length = collect(n, known, open, &count, &most);
		if (kind_of(n->site + i) == RANK_FORM)
			even_forms(n, open, count, wide, wide + n->count);
		for (uint32_t k = 0; k < count; k++) {
			site *s = n->site + open[k];
			float share = share_of(n, s, most, length);
			if (rank_of(s) != RANK_COLOR) {
				ease(s, share);
			} else if (params_at(n->f, s->placed.near_x, s->placed.near_y)->line_color_shortest > 0) {
				color[open[k]] = share;
				any = true;
			}
		}
	}
	if (!code && any)
		code = even_colors(n, color);
	late_drop(&n->f->late, wide);
	late_drop(&n->f->late, color);
	late_drop(&n->f->late, open);
	late_drop(&n->f->late, known);
	return code ? code : ISA(fine_unlink_dropped)(n); /* what a contour was led on to may be gone */
}
