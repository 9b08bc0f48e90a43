/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Creases and folds that hang together at their ends and span next to nothing: a few pixels of what was left by lines
 * that they gave way to. */
#include "fine/chains/stations.h"

#include <string.h>

/* Px that they must span; how much of its width a place must have to count; pixels from end to end. */
static const float least_span = 3, least_keep = 0.05f, together = 0.5f;

typedef struct part {
	double left, top, right, bottom;
	bool stays;
} part;

typedef struct ends {
	stations *s;
	int32_t *up;    /* by run: one that it hangs together with, or itself */
	uint32_t *slot; /* of a hash table of ends: 1 + twice the run, and which end */
	uint32_t mask;
} ends;

static int32_t root_of(int32_t *up, int32_t i)
{
	while (up[i] != i)
		i = up[i] = up[up[i]];
	return i;
}

static const station *end_of(const stations *s, uint32_t end)
{
	uint32_t run = end / 2;
	return s->at + (end % 2 ? s->first[run + 1] - 1 : s->first[run]);
}

static bool has_stations(const stations *s, int32_t run)
{
	return s->first[run] < s->first[run + 1];
}

/* Ends that are together share one of four grids' cells. */
static void join_end(ends *e, uint32_t end)
{
	const station *t = end_of(e->s, end);
	for (uint32_t k = 0; k < 4; k++) {
		int64_t x = (int64_t)floor(t->x + 0.5 * (k & 1)), y = (int64_t)floor(t->y + 0.5 * (k >> 1));
		uint32_t at = mix_bits(mix_bits((uint32_t)x) + (uint32_t)y) + k * 0x9e3779b9u;
		for (at = mix_bits(at) & e->mask; e->slot[at]; at = (at + 1) & e->mask) {
			uint32_t other = e->slot[at] - 1;
			const station *o = end_of(e->s, other);
			if (fabs(o->x - t->x) < (double)together && fabs(o->y - t->y) < (double)together) {
				int32_t a = root_of(e->up, (int32_t)(end / 2)),
					b = root_of(e->up, (int32_t)(other / 2));
				e->up[a > b ? a : b] = a < b ? a : b;
				break;
			}
		}
		if (!e->slot[at])
			e->slot[at] = end + 1;
	}
}

static void add(part *p, const station *t)
{
	if (!(t->keep >= least_keep))
		return;
	p->left = fmin(p->left, t->x);
	p->top = fmin(p->top, t->y);
	p->right = fmax(p->right, t->x);
	p->bottom = fmax(p->bottom, t->y);
	p->stays |= (t->kind & (ENCRE_CHAIN_BORDER | ENCRE_CHAIN_NUMBER | ENCRE_CHAIN_MARK | ENCRE_CHAIN_OTHER)) ||
		    (t->importance == IMPORTANCE_CONTOUR && !is_folded(t));
}

int32_t ISA(stations_drop_fragments)(stations *s)
{
	fine *n = s->n;
	size_t runs = (size_t)s->runs, room = 16;
	while (room < 16 * runs) /* a slot for each end and grid, and as many more */
		room *= 2;
	ends e = {s, late_take(&n->f->late, runs, sizeof *e.up), late_take(&n->f->late, room, sizeof *e.slot),
		  (uint32_t)(room - 1)};
	part *all = late_take(&n->f->late, runs, sizeof *all);
	if (!e.up || !e.slot || !all)
		return ENCRE_ERROR_MEMORY;
	memset(e.slot, 0, room * sizeof *e.slot);
	int32_t code = ENCRE_OK;
	for (int32_t i = 0; i < s->runs; i++) {
		e.up[i] = i;
		all[i] = (part){INFINITY, INFINITY, -INFINITY, -INFINITY, false};
	}
	for (int32_t i = 0; !code && i < s->runs; i++) {
		code = at_step(n, (uint32_t)i);
		for (uint32_t k = 0; has_stations(s, i) && k < 2; k++)
			join_end(&e, 2 * (uint32_t)i + k);
	}
	for (int32_t i = 0; !code && i < s->runs; i++) {
		part *own = all + root_of(e.up, i);
		code = at_step(n, (uint32_t)i);
		for (uint32_t k = s->first[i]; k < s->first[i + 1]; k++)
			add(own, s->at + k);
	}
	double least = (double)(least_span * s->px);
	for (int32_t i = 0; !code && i < s->runs; i++) {
		const part *own = all + root_of(e.up, i);
		double wide = own->right - own->left, tall = own->bottom - own->top;
		if (own->stays || !(wide * wide + tall * tall < least * least))
			continue;
		for (uint32_t k = s->first[i]; k < s->first[i + 1]; k++)
			s->at[k].keep = 0;
	}
	late_drop(&n->f->late, all);
	late_drop(&n->f->late, e.slot);
	late_drop(&n->f->late, e.up);
	return code;
}
