/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Lines of forms come and go as a form turns: each that hangs together is as wide as it is long and clear, so that none
 * comes at once. So are borders of light, whose short ones are patches that belong to nothing, what mirrors show of
 * rough water, and lines between colours: of paving far away, where joints are hardly to be seen, bits are left. And
 * the edges of a small thing, most of which its outline has the place of, now of these, now of those. */
#include "fine/near.h"

#include <string.h>

static const float counts_from = 1, counts_ramp = 1; /* of edge_threshold: so strong counts, and in full; test_forms */
static const float clearest = 100;                   /* times its length counts at most, or it might have no bound */
static const float least_share = 0.1f;               /* of its width: less is not drawn; test_forms */

enum { KNOWN = 1, NEAR = 2, CHUNK = 512 };
static const float hangs = 1.5f;    /* pixels from place to place of an edge, or where edges meet; test_creases */
static const float full_across = 2; /* of line_shortest: edges that go so far are as wide as others; test_creases */

/* One that is thinned; RANK_COUNT: it is none, or dropped. */
static enum rank kind_of(const site *s)
{
	enum rank rank = (enum rank)rank_of(s);
	bool own = rank == RANK_FORM || rank == RANK_LIGHT || rank == RANK_COLOR || rank == RANK_SEEN ||
		   s->found.family == FAMILY_CREASE;
	return own && !s->linked.dropped ? rank : RANK_COUNT;
}

/* Of which object is what a line is of. */
static float object_of(const fine *n, const site *s)
{
	return object_at(n->f, s->placed.near_x, s->placed.near_y);
}

/* Whether two sites that are linked hang together: edges of two things, one of which leads to the other's, do not. */
static bool is_alike(const fine *n, const site *s, const site *t)
{
	enum rank kind = kind_of(s);
	return kind == kind_of(t) && (kind != RANK_CREASE || object_of(n, s) == object_of(n, t));
}

/* How much of a site's length counts. Of colours all where they are just an edge, and more where they are clearer:
 * letters and eyes are small, and no scraps. */
static float clear_at(const fine *n, uint32_t i)
{
	float threshold = n->e->p->edge_threshold, strength = n->site[i].placed.strength;
	enum rank rank = (enum rank)rank_of(n->site + i);
	if (rank == RANK_FORM && threshold > 0)
		return clamp01((strength / threshold - counts_from) / counts_ramp);
	if (rank == RANK_COLOR)
		return threshold > 0 ? min(clearest, max(0, (strength / threshold - least_faint) / (1 - least_faint)))
				     : clearest;
	return 1;
}

/* Collects what hangs together with open[0]; the length of what is clear of it, and how clear the clearest is. */
static float collect(const fine *n, uint8_t *known, uint32_t *open, uint32_t *count, float *most)
{
	float length = 0;
	*most = clear_at(n, open[0]);
	for (uint32_t at = 0; at < *count; at++)
		for (uint32_t i = open[at], k = n->at[i]; k < n->at[i + 1]; k++) {
			uint32_t j = n->to[k];
			if (!is_alike(n, n->site + i, n->site + j))
				continue;
			length += 0.25f * sqrtf(apart2(n->site + i, n->site + j)) * (clear_at(n, i) + clear_at(n, j));
			if (!known[j]) {
				known[j] = KNOWN;
				*most = max(*most, clear_at(n, j));
				open[(*count)++] = j;
			}
		}
	return length;
}

/* Whether a site is of an edge of an object, also where an older line has its place. */
static bool is_edge_of(const fine *n, const site *s, float object)
{
	return s->found.family == FAMILY_CREASE && !(s->placed.weak && s->linked.dropped) && object_of(n, s) == object;
}

/* Of the width of edges, by how far they go, corner to corner of the box about all that hang together, and by how much
 * of these an older line has the place: small things are drawn by their outlines, buttons and boxes on a wall by edges
 * alone. Takes what it finds into `open`, which begins with `count` of them. */
static float share_of_edges(const fine *n, uint8_t *known, uint32_t *open, uint32_t count)
{
	const placed *first = &n->site[open[0]].placed;
	float full = full_across * params_at(n->f, first->near_x, first->near_y)->line_shortest * n->f->scale;
	float object = object_of(n, n->site + open[0]), across = 0;
	float low[2] = {INFINITY, INFINITY}, high[2] = {-INFINITY, -INFINITY};
	uint32_t end = count, owned = 0;
	for (uint32_t k = 0; k < count; k++)
		known[open[k]] |= NEAR;
	for (uint32_t k = 0; k < end && across < full; k++) {
		const site *s = n->site + open[k];
		owned += s->linked.dropped;
		low[0] = min(low[0], s->placed.x);
		low[1] = min(low[1], s->placed.y);
		high[0] = max(high[0], s->placed.x);
		high[1] = max(high[1], s->placed.y);
		across = sqrtf((high[0] - low[0]) * (high[0] - low[0]) + (high[1] - low[1]) * (high[1] - low[1]));
		near_sites of = near_site(n, s, hangs);
		for (uint32_t j; near_next(n, &of, &j);)
			if (!(known[j] & NEAR) && is_edge_of(n, n->site + j, object) &&
			    apart2(s, n->site + j) <= hangs * hangs) {
				known[j] |= NEAR;
				open[end++] = j;
			}
	}
	for (uint32_t k = 0; k < end; k++)
		known[open[k]] &= (uint8_t)~NEAR;
	return across < full ? 1 - (float)owned / (float)end * (1 - across / full) : 1;
}

static float full_length(const encre_params *p, enum rank rank)
{
	return rank == RANK_FORM    ? p->line_suggestive_shortest
	       : rank == RANK_LIGHT ? p->line_shadow_shortest
	       : rank == RANK_COLOR ? p->line_color_shortest
				    : p->line_mirror_shortest;
}

/* Of the width, of forms by how clear the clearest is, and by the length of all. Of others below half the length asked
 * none is left: they close, and a patch would stay as a spot. */
static float share_of(const fine *n, const site *s, float most, float length)
{
	enum rank rank = (enum rank)rank_of(s);
	float full = full_length(params_at(n->f, s->placed.near_x, s->placed.near_y), rank) * n->f->scale;
	float share = !(full > 0) ? 1 : rank == RANK_FORM ? length / full : clamp01(2 * length / full - 1);
	return rank == RANK_FORM ? min(most, share) : share;
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
	uint8_t *known = late_take(&n->f->late, n->count + 1, sizeof *known);
	uint32_t *open = late_take(&n->f->late, n->count + 1, sizeof *open);
	float *color = late_take(&n->f->late, n->count + 1, sizeof *color);
	if (!known || !open || !color)
		return ENCRE_ERROR_MEMORY;
	memset(known, 0, n->count);
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
		known[i] = KNOWN;
		float most, length = collect(n, known, open, &count, &most);
		bool edge = kind_of(n->site + i) == RANK_CREASE;
		float edges = edge ? share_of_edges(n, known, open, count) : 0;
		for (uint32_t k = 0; k < count; k++) {
			site *s = n->site + open[k];
			float share = edge ? edges : share_of(n, s, most, length);
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
	late_drop(&n->f->late, color);
	late_drop(&n->f->late, open);
	late_drop(&n->f->late, known);
	return code ? code : ISA(fine_unlink_dropped)(n); /* what a contour was led on to may be gone */
}
