/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Widths along lines: where what a line is made of changes, or how clear it is, its width eases over about itself. */
#include "ink/discs.h"
#include "fine/near.h"

enum { CHUNK = 1024 };

/* Pixels along the line each way over which it is evened: its width, within these. */
static const float least_reach = 2, most_reach = 8;

/* Pixels by which a radius changes from a site to the next where it is evened. */
static const float least_change = 0.2f;

typedef struct widths {
	const frame *f;
	const fine *n;
	float *own, *even; /* by site */
	uint8_t *varied;   /* by cell: the radius changes along a link there */
} widths;

static void vary(const widths *w, uint32_t i)
{
	w->varied[cell_of(w->n, &w->n->site[i].placed)] = 1;
}

/* Most lines are as wide all along, and are not walked. */
static int32_t find_varied(const widths *w)
{
	const fine *n = w->n;
	int32_t code = ENCRE_OK;
	memset(w->varied, 0, (size_t)n->across * (size_t)n->tall);
	for (uint32_t i = 0; !code && i < n->count; i++) {
		code = at_step(n, i);
		for (uint32_t k = n->at[i]; k < n->at[i + 1]; k++)
			if (n->to[k] > i && fabsf(w->own[n->to[k]] - w->own[i]) > least_change &&
			    !n->site[i].linked.dropped && !n->site[n->to[k]].linked.dropped) {
				vary(w, i);
				vary(w, n->to[k]);
			}
	}
	return code;
}

static bool varies(const widths *w, const placed *s, float reach)
{
	near_sites of = near_place(w->n, s->x, s->y, reach);
	for (int row = of.row; row <= of.last; row++)
		for (int x = of.x0; x <= of.x1; x++)
			if (w->varied[row * w->n->across + x])
				return true;
	return false;
}

typedef struct mean {
	float most, sum, weights;
} mean;

/* Adds what lies along the line up to `reach`, or to where it meets others, with weights that fall to 0 there. What
 * branches off an older line has nothing of the width of that: a faint one would be a thorn on it. */
static void add_along(const widths *w, uint32_t i, float reach, mean *m)
{
	const fine *n = w->n;
	for (uint32_t k = n->at[i]; k < n->at[i + 1]; k++) {
		uint32_t from = i, at = n->to[k];
		for (float along = 0; at != UINT32_MAX && at != i && !n->site[at].linked.dropped;) {
			along += sqrtf(apart2(n->site + from, n->site + at));
			if (along >= reach || branches_off(n, at, from))
				break;
			float weight = 1 - along / reach;
			m->sum += weight * w->own[at];
			m->weights += weight;
			m->most = max(m->most, w->own[at]);
			uint32_t next = next_of(n, from, at);
			from = at;
			at = next;
		}
	}
}

/* The mean along the line, over the width of the widest that is near: so both sides of a change ease alike. */
static float evened(const widths *w, uint32_t i)
{
	float own = w->own[i];
	if (w->n->site[i].linked.dropped || links_at(w->n, i) > 2 || !varies(w, &w->n->site[i].placed, most_reach))
		return own;
	mean near = {.most = own}, m = {.sum = own, .weights = 1};
	add_along(w, i, most_reach, &near);
	add_along(w, i, min(max(2 * near.most, least_reach), most_reach), &m);
	return m.sum / m.weights;
}

static void even_out(void *data, int first, int end, int thread)
{
	(void)thread;
	const widths *w = data;
	for (int i = first; i < end && !stopped_at(w->n, i); i++)
		w->even[i] = evened(w, (uint32_t)i);
}

int32_t ISA(capsules_even)(frame *f, float **radius)
{
	const fine *n = f->fine;
	size_t cells = (size_t)n->across * (size_t)n->tall;
	widths w = {.f = f, .n = n, .own = *radius, .varied = late_take(&f->late, cells, sizeof *w.varied)};
	if (!w.varied)
		return ENCRE_ERROR_MEMORY;
	int32_t code = find_varied(&w);
	if (!code && memchr(w.varied, 1, cells)) {
		w.even = late_take(&f->late, n->count, sizeof *w.even);
		if (!w.even)
			return ENCRE_ERROR_MEMORY;
		code = bands_run(f->bands, (int)n->count, CHUNK, even_out, &w);
		late_drop(&f->late, w.own);
		*radius = w.even;
	}
	late_drop(&f->late, w.varied);
	return code;
}
