/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Short folds between lines that gave way to others: once loose ends are led on, for many a rung was one. */
#include "fine/join/fronts.h"

enum { CHUNK = 512, RUNG = 6 /* sites */ };

typedef struct rungs {
	fine *n;
	float *crowd; /* by site: what it is bound by, to be filled */
} rungs;

/* Where lines meet: of those but the one over site `from` the least bound. */
static float least_bound(const fine *n, uint32_t i, uint32_t from)
{
	float least = INFINITY;
	for (uint32_t k = n->at[i]; k < n->at[i + 1]; k++)
		if (n->to[k] != from)
			least = min(least, n->site[n->to[k]].linked.crowd);
	return least;
}

/* A short fold is no more to be seen than what it meets at each end: a rung of what would be a ladder goes with its
 * rail. */
static float rung_crowd(const fine *n, uint32_t i)
{
	float most = 0;
	if (links_at(n, i) != 2 || !(is_meeting(n->site + i) || is_fold(n, n->site + i)))
		return 0;
	for (uint32_t side = 0, sites = 0; side < 2; side++) {
		uint32_t from = i, at = n->to[n->at[i] + side];
		for (; links_at(n, at) == 2 && sites < RUNG; sites++) {
			uint32_t next = next_of(n, from, at);
			from = at;
			at = next;
		}
		if (links_at(n, at) <= 2)
			return 0;
		most = max(most, least_bound(n, at, from));
	}
	return most;
}

static void find_rungs(void *data, int first, int end, int thread)
{
	(void)thread;
	const rungs *r = data;
	for (int i = first; i < end && !stopped_at(r->n, i); i++)
		r->crowd[i] = r->n->site[i].linked.dropped ? 0 : rung_crowd(r->n, (uint32_t)i);
}

static void drop_rungs(void *data, int first, int end, int thread)
{
	(void)thread;
	const rungs *r = data;
	for (int i = first; i < end && !stopped_at(r->n, i); i++)
		r->n->site[i].linked.crowd = max(r->n->site[i].linked.crowd, r->crowd[i]);
}

int32_t ISA(fine_drop_rungs)(fine *n)
{
	rungs r = {n, late_take(&n->f->late, n->count, sizeof *r.crowd)};
	if (!r.crowd)
		return ENCRE_ERROR_MEMORY;
	int32_t code = bands_run(n->f->bands, (int)n->count, CHUNK, find_rungs, &r);
	if (!code)
		code = bands_run(n->f->bands, (int)n->count, CHUNK, drop_rungs, &r);
	late_drop(&n->f->late, r.crowd);
	return code;
}
