/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A faint line close beside a strong one: whether it is found there depends on how both meet the pixels, and it would
 * come and go. A chain is dropped if most of it runs along an older one, else it is kept whole. Where light crosses
 * several thresholds at once, or a shadow is thin, the longest of its lines stands for all. */
#include "fine.h"

#include <stdlib.h>
#include <string.h>

enum { CHUNK = 1024 };

static const float beside_reach = 3;   /* pixels */
static const float parallel = 0.85f;   /* cosine of what still counts as running along */
static const float shortest = 4;       /* pixels: what is shorter may lead into a corner */
static const float most_beside = 0.5f; /* of a chain's length */

/* Before loose ends are joined each chain is of one family. */
typedef struct chain {
	uint32_t first, second; /* its first sites */
	float length;
} chain;

enum { BESIDE = 1, KNOWN = 2, KEPT = 4 };

typedef struct beside {
	fine *n;
	enum family family;
	uint8_t *mark; /* by site */
	chain *chain;
	uint32_t count;
} beside;

/* ---- sites ----------------------------------------------------------------------------------------------- */

/* The way of the line at a site, of any length; false where several meet. */
static bool way_of(const fine *n, uint32_t i, float way[2])
{
	uint32_t links = n->at[i + 1] - n->at[i];
	if (links != 1 && links != 2)
		return false;
	const site *a = n->site + n->to[n->at[i]], *b = links == 2 ? n->site + n->to[n->at[i] + 1] : n->site + i;
	way[0] = b->x - a->x;
	way[1] = b->y - a->y;
	return true;
}

/* Whether a site runs along an older one, or along one of its own family that is kept. */
static bool runs_along(const beside *b, uint32_t i, bool own)
{
	const fine *n = b->n;
	const site *s = n->site + i;
	float way[2], other[2];
	if (!way_of(n, i, way))
		return false;
	near_sites of = near_place(n, s->x, s->y, beside_reach);
	for (uint32_t j; near_next(n, &of, &j);) {
		const site *t = n->site + j;
		if (t->dropped || !(own ? t->family == s->family && (b->mark[j] & KEPT) : t->family < s->family) ||
		    apart2(s, t) > beside_reach * beside_reach || !way_of(n, j, other))
			continue;
		float dot = way[0] * other[0] + way[1] * other[1],
		      square = (way[0] * way[0] + way[1] * way[1]) * (other[0] * other[0] + other[1] * other[1]);
		if (dot * dot >= parallel * parallel * square)
			return true;
	}
	return false;
}

static void find_near(void *data, int first, int end, int thread)
{
	(void)thread;
	const beside *b = data;
	uint32_t from = b->n->first[(int)b->family * b->n->f->height];
	for (uint32_t i = from + (uint32_t)first; i < from + (uint32_t)end; i++)
		b->mark[i] = !b->n->site[i].dropped && runs_along(b, i, false) ? BESIDE : 0;
}

/* ---- chains ---------------------------------------------------------------------------------------------- */

static bool passes(const fine *n, uint32_t i)
{
	return n->at[i + 1] - n->at[i] == 2;
}

static uint32_t following(const fine *n, const chain *c, uint32_t from, uint32_t at)
{
	return from == UINT32_MAX ? c->second : at == c->first ? UINT32_MAX : next_of(n, from, at);
}

/* Marks the sites of a chain but for those where several meet. */
static void mark_chain(const beside *b, const chain *c, uint8_t bit)
{
	const fine *n = b->n;
	for (uint32_t from = UINT32_MAX, at = c->first, next; at != UINT32_MAX; from = at, at = next) {
		next = following(n, c, from, at);
		b->mark[at] |= n->at[at + 1] - n->at[at] <= 2 ? bit : 0;
	}
}

/* A chain's length, and in *along how much of it lies beside another. */
static float length_of(const beside *b, const chain *c, float *along)
{
	const fine *n = b->n;
	bool light = rank_of(n->site + c->first) == 3, before = false;
	float length = 0;
	*along = 0;
	for (uint32_t from = UINT32_MAX, at = c->first, next; at != UINT32_MAX; from = at, at = next) {
		next = following(n, c, from, at);
		bool near = (b->mark[at] & BESIDE) || (light && runs_along(b, at, true));
		float piece = from != UINT32_MAX ? sqrtf(apart2(n->site + from, n->site + at)) : 0;
		length += piece;
		*along += 0.5f * piece * (float)(near + before);
		before = near;
	}
	return length;
}

static void add(beside *b, uint32_t first, uint32_t second)
{
	chain *c = b->chain + b->count++;
	float along;
	*c = (chain){.first = first, .second = second};
	c->length = length_of(b, c, &along);
	mark_chain(b, c, KNOWN);
}

static void find_chains(beside *b, uint32_t first, uint32_t end)
{
	const fine *n = b->n;
	b->count = 0;
	for (uint32_t i = first; i < end; i++)
		for (uint32_t k = n->at[i]; !passes(n, i) && k < n->at[i + 1]; k++) {
			uint32_t j = n->to[k];
			if (passes(n, j) ? !(b->mark[j] & KNOWN) : i < j)
				add(b, i, j);
		}
	for (uint32_t i = first; i < end; i++)
		if (passes(n, i) && !(b->mark[i] & KNOWN))
			add(b, i, n->to[n->at[i]]);
}

static int by_length(const void *a, const void *b)
{
	const chain *p = a, *q = b;
	if (p->length != q->length)
		return p->length > q->length ? -1 : 1;
	if (p->first != q->first)
		return p->first < q->first ? -1 : 1;
	return p->second < q->second ? -1 : p->second > q->second;
}

static void choose(const beside *b)
{
	const fine *n = b->n;
	for (uint32_t i = 0; i < b->count; i++) {
		const chain *c = b->chain + i;
		float along, length = length_of(b, c, &along);
		if (length < shortest || along <= most_beside * length) {
			mark_chain(b, c, KEPT);
			continue;
		}
		for (uint32_t from = UINT32_MAX, at = c->first, next; at != UINT32_MAX; from = at, at = next) {
			next = following(n, c, from, at);
			n->site[at].dropped |= n->at[at + 1] - n->at[at] <= 2;
		}
	}
}

int32_t ISA(fine_drop_beside)(fine *n)
{
	beside b = {.n = n,
		    .mark = late_take(&n->f->late, n->count, sizeof *b.mark),
		    .chain = late_take(&n->f->late, n->at[n->count], sizeof *b.chain)};
	if (!b.mark || !b.chain)
		return ENCRE_ERROR_MEMORY;
	for (int k = FAMILY_NORMAL_BAND; k < FAMILY_COUNT; k++) {
		uint32_t first = n->first[k * n->f->height], end = n->first[(k + 1) * n->f->height];
		b.family = (enum family)k;
		int32_t code = rows_run(n->f->rows, (int)(end - first), CHUNK, find_near, &b);
		if (code)
			return code;
		find_chains(&b, first, end);
		qsort(b.chain, b.count, sizeof *b.chain, by_length);
		choose(&b);
	}
	return ISA(fine_link)(n);
}
