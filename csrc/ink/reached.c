/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Which links, and ends beyond corners, reach into which band of rows. */
#include "ink/discs.h"
#include "ink/tips.h"
#include "ink/turns.h"
#include "fine/near.h"

#include <string.h>

enum { CHUNK = 4096 };

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

/* Strokes are cut into pieces of CHUNK sites, and each has its own places in the lists: in the order of strokes and
 * sites, whatever the threads. */
typedef struct listing {
	const frame *f;
	const capsules *all;
	size_t bands;
	uint32_t pieces; /* of a stroke */
	uint32_t *next;  /* by piece and band: how many reach there, and then where the next one is put */
} listing;

static void enter_pieces(void *data, int first, int end, int thread)
{
	(void)thread;
	const listing *l = data;
	const fine *n = l->f->fine;
	for (uint32_t p = (uint32_t)first; p < (uint32_t)end; p++) {
		uint32_t stroke = p / l->pieces, from = stroke * n->count, i = p % l->pieces * CHUNK, spur = 0,
			 last = n->count - i < CHUNK ? n->count : i + CHUNK, *next = l->next + p * l->bands;
		while (spur < l->all->spurs && l->all->spur[spur].site < i)
			spur++;
		for (; i < last && !stopped_at(n, (int)i); i++) {
			for (; spur < l->all->spurs && l->all->spur[spur].site == i; spur++) {
				uint32_t to = (uint32_t)spur_end(l->all, stroke, spur);
				if (l->all->end[to].reach > 0)
					enter(l->f, l->all, from + i, to, next);
			}
			if (n->site[i].linked.dropped)
				continue;
			if (n->at[i] == n->at[i + 1])
				enter(l->f, l->all, from + i, from + i, next);
			for (uint32_t k = n->at[i]; k < n->at[i + 1]; k++)
				if (n->to[k] > i && !n->site[n->to[k]].linked.dropped)
					enter(l->f, l->all, from + i, from + n->to[k], next);
		}
	}
}

int32_t ISA(capsules_list)(frame *f, uint32_t strokes, capsules *all)
{
	const fine *n = f->fine;
	listing l = {.f = f,
		     .all = all,
		     .bands = (size_t)(f->height - 1) / BAND + 1,
		     .pieces = (n->count + CHUNK - 1) / CHUNK};
	size_t pieces = (size_t)strokes * l.pieces;
	l.next = late_take(&f->late, pieces * l.bands, sizeof *l.next);
	if (!l.next)
		return ENCRE_ERROR_MEMORY;
	memset(l.next, 0, pieces * l.bands * sizeof *l.next);
	int32_t code = bands_run(f->bands, (int)pieces, 1, enter_pieces, &l);
	uint32_t sum = 0;
	for (size_t k = 0; !code && k < l.bands; k++) {
		all->first[k] = sum;
		for (size_t p = 0; p < pieces; p++) {
			uint32_t *next = l.next + p * l.bands + k, own = *next;
			*next = sum;
			sum += own;
		}
	}
	all->first[l.bands] = sum;
	all->list = code ? NULL : late_take(&f->late, sum, sizeof *all->list);
	if (!code && !all->list)
		return ENCRE_ERROR_MEMORY;
	if (!code)
		code = bands_run(f->bands, (int)pieces, 1, enter_pieces, &l);
	late_drop(&f->late, l.next);
	return code;
}
