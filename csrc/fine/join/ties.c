/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Thin things run on between pixel centres as sites along their middle: these are tied to the cracks where the thing
 * covers a centre again, and take their controls there: at their own pixels there is nothing of the thing. */
#include "fine/near.h"

static const float tie_reach = 1.8f, tie_cosine = -0.3f; /* pixels; between both ties of a site; test_fine_passes */

/* The nearest crack or thin site that lies on another side of site i than the one at `other`. */
static uint32_t tie_of(const fine *n, uint32_t i, uint32_t other)
{
	const site *s = n->site + i;
	uint32_t best = UINT32_MAX;
	float least = tie_reach * tie_reach;
	near_sites of = near_site(n, s, tie_reach);
	for (uint32_t j; near_next(n, &of, &j);) {
		const site *t = n->site + j;
		float d2 = apart2(s, t);
		if (t->linked.dropped || t->found.family != FAMILY_CRACK || !(d2 < least))
			continue;
		if (other != UINT32_MAX) {
			const site *o = n->site + other;
			float x = s->placed.x, y = s->placed.y,
			      cosine = (t->placed.x - x) * (o->placed.x - x) + (t->placed.y - y) * (o->placed.y - y);
			if (cosine > tie_cosine * sqrtf(d2 * apart2(s, o)))
				continue;
		}
		least = d2;
		best = j;
	}
	return best;
}

int32_t ISA(fine_tie)(fine *n)
{
	uint32_t first = n->first[FAMILY_THIN * n->f->height], end = n->first[(FAMILY_THIN + 1) * n->f->height],
		 count = 0;
	uint32_t (*link)[2] = late_take(&n->f->late, (size_t)2 * (end - first), sizeof *link);
	if (!link)
		return ENCRE_ERROR_MEMORY;
	for (uint32_t i = first; i < end; i++) {
		int32_t code = at_step(n, i - first);
		if (code)
			return code;
		uint32_t links = links_at(n, i), other = links == 1 ? n->to[n->at[i]] : UINT32_MAX;
		for (; links < 2 && !n->site[i].linked.dropped; links++) {
			uint32_t best = tie_of(n, i, other);
			if (best == UINT32_MAX)
				break;
			link[count][0] = i;
			link[count++][1] = other = best;
		}
	}
	int32_t code = ISA(fine_add_links)(n, link, count);
	for (uint32_t i = first; !code && i < end; i++) {
		const placed *told = &n->site[told_by(n, i)].placed;
		code = at_step(n, i - first);
		n->site[i].placed.near_x = told->near_x;
		n->site[i].placed.near_y = told->near_y;
	}
	return code;
}
