/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Which links, and ends beyond corners, reach into which band of rows. */
#include "ink/discs.h"
#include "ink/tips.h"
#include "ink/turns.h"
#include "fine/near.h"

#include <string.h>

/* Adds a capsule to the lists of the bands that it reaches into; counts while there are no lists. */
static void enter(const frame *f, const capsules *all, uint32_t a, uint32_t b, uint32_t *next)
{
	const pen_end *one = all->end + a, *two = all->end + b;
	float reach = max(one->reach, two->reach), top = min(one->y, two->y) - reach,
	      bottom = max(one->y, two->y) + reach;
	if (!(reach > 0) || bottom < 0 || top > (float)(f->height - 1))
		return;
	for (int k = pixel_of(top - 0.5f, f->height) / BAND; k <= pixel_of(bottom + 0.5f, f->height) / BAND; k++) {
		if (all->list) {
			all->list[next[k]][0] = a;
			all->list[next[k]][1] = b;
		}
		next[k]++;
	}
}

static int32_t enter_stroke(const frame *f, const turns *t, uint32_t stroke, const capsules *all, uint32_t *next)
{
	const fine *n = f->fine;
	uint32_t from = stroke * n->count, spur = 0;
	int32_t code = ENCRE_OK;
	for (uint32_t i = 0; !code && i < n->count; i++) {
		code = at_step(n, i);
		for (; spur < t->spurs && t->spur[spur].site == i; spur++)
			if (all->end[spur_end(all, t, stroke, spur)].reach > 0)
				enter(f, all, from + i, (uint32_t)spur_end(all, t, stroke, spur), next);
		if (n->site[i].linked.dropped)
			continue;
		if (n->at[i] == n->at[i + 1])
			enter(f, all, from + i, from + i, next);
		for (uint32_t k = n->at[i]; k < n->at[i + 1]; k++)
			if (n->to[k] > i && !n->site[n->to[k]].linked.dropped)
				enter(f, all, from + i, from + n->to[k], next);
	}
	return code;
}

int32_t ISA(capsules_list)(frame *f, const turns *t, uint32_t strokes, capsules *all)
{
	size_t bands = (size_t)(f->height - 1) / BAND + 1;
	int32_t code = ENCRE_OK;
	memset(all->first, 0, (bands + 2) * sizeof *all->first);
	/* counted two places on: summed up, and filled, they end where they belong */
	for (uint32_t k = 0; !code && k < strokes; k++)
		code = enter_stroke(f, t, k, all, all->first + 2);
	if (code)
		return code;
	for (size_t k = 2; k < bands + 2; k++)
		all->first[k] += all->first[k - 1];
	all->list = late_take(&f->late, all->first[bands + 1], sizeof *all->list);
	if (!all->list)
		return ENCRE_ERROR_MEMORY;
	for (uint32_t k = 0; !code && k < strokes; k++)
		code = enter_stroke(f, t, k, all, all->first + 1);
	return code;
}
