/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Eyes: where the crack goes round a lone pixel of its own, a line parts and joins again within three pixels, closer
 * than any pen shows. Of its two ways the shorter stays, or the line would end at each eye: it would not taper, nor be
 * told from a speck. The two sides of a thin thing both stay. */
#include "fine/near.h"

enum { MOST = 6 };              /* sites along a way */
static const float longest = 3; /* pixels of a way; test_fine_passes */

/* A way from a place where lines meet to the next such place. */
typedef struct way {
	uint32_t to;
	float length;
} way;

static bool way_by(const fine *n, uint32_t i, uint32_t first, way *w)
{
	uint32_t from = i, at = first;
	w->length = sqrtf(apart2(n->site + i, n->site + at));
	for (int k = 0; k < MOST && w->length < longest; k++) {
		uint32_t next = next_of(n, from, at);
		w->to = at;
		if (links_at(n, at) != 2)
			return at != i;
		if (n->site[at].linked.dropped || n->site[at].placed.thin > 0 || is_chain(n->site + at))
			return false;
		from = at;
		at = next;
		w->length += sqrtf(apart2(n->site + from, n->site + at));
	}
	return false;
}

static void drop_way(fine *n, uint32_t i, uint32_t first)
{
	for (uint32_t from = i, at = first, next; (next = next_of(n, from, at)) != UINT32_MAX; from = at, at = next)
		n->site[at].linked.dropped = true;
}

/* The longer ones of ways that part at site i; returns whether there are any. */
static bool drop_longer(fine *n, uint32_t i)
{
	bool any = false;
	for (uint32_t k = n->at[i]; k < n->at[i + 1]; k++)
		for (uint32_t l = k + 1; l < n->at[i + 1]; l++) {
			way a, b;
			if (!way_by(n, i, n->to[k], &a) || !way_by(n, i, n->to[l], &b) || a.to != b.to)
				continue;
			drop_way(n, i, n->to[a.length > b.length ? k : l]);
			any = true;
		}
	return any;
}

int32_t ISA(fine_close_eyes)(fine *n)
{
	int32_t code = ENCRE_OK;
	bool any = false;
	for (uint32_t i = 0; !code && i < n->count; i++) {
		code = at_step(n, i);
		if (!n->site[i].linked.dropped && !is_chain(n->site + i) && links_at(n, i) > 2)
			any |= drop_longer(n, i);
	}
	return code || !any ? code : ISA(fine_unlink_dropped)(n);
}
