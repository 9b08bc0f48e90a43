/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A faint line close beside a strong one: whether it is found there depends on how both meet the pixels, and it would
 * come and go. What is found is dropped if it leads nowhere and most of it runs along an older line, else it is kept
 * whole. */
#include "fine/near.h"

#include <stdlib.h>
#include <string.h>

enum { CHUNK = 1024 };

static const float beside_reach = 3.5f; /* pixels; test_fine_passes */
static const float parallel = 0.85f;    /* cosine of what still counts as running along; test_fine_passes */
static const float most_beside = 0.5f;  /* of a chain's length; test_fine_passes */
/* A line that turns to and fro more is a scribble round what pixels can't show. Light ends at the borders of faces, and
 * what is filled there with it, however often these turn: only noise turns more; test_fine_passes */
static const float most_wiggle = 0.12f, most_wiggle_light = 0.3f;
/* pixels: shorter lines of light, and of what mirrors and glass show, that meet nothing are noise; test_fine_passes */
static const float least_light = 6, least_seen = 9;
/* A run of sites between those at which not exactly two meet. */
typedef struct chain {
	uint32_t first, second; /* its first sites */
	float length;
	int rank;     /* of its oldest part */
	float wiggle; /* variance of the sines of half the angles by which it turns, pixel by pixel */
	int loose;    /* how many of its ends lead nowhere */
	bool closed;
	bool chain; /* some of it comes from chains of edges, and stays */
} chain;

static const uint32_t NONE = UINT32_MAX; /* an enumerator is an int */

typedef struct beside {
	fine *n;
	int rank;
	bool *beside;    /* by site: whether it runs along an older line */
	uint32_t *chain; /* by site: number of its chain; NONE where chains meet */
	uint32_t count;
	struct chain *list;
	uint32_t steps; /* along chains since it was asked whether to go on */
} beside;

/* ---- sites ----------------------------------------------------------------------------------------------- */

/* Whether a site runs along one of an older rank. */
static bool runs_along(const beside *b, uint32_t i)
{
	const fine *n = b->n;
	const site *s = n->site + i;
	int rank = rank_of(s);
	float way[2], other[2];
	if (!way_of(n, i, way))
		return false;
	near_sites of = near_site(n, s, beside_reach);
	for (uint32_t j; near_next(n, &of, &j);) {
		const site *t = n->site + j;
		if (t->linked.dropped || rank_of(t) >= rank || (b->chain[j] == b->chain[i] && b->chain[i] != NONE) ||
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
	for (uint32_t i = (uint32_t)first; i < (uint32_t)end && !stopped_at(b->n, (int)i); i++)
		if (!b->n->site[i].linked.dropped && rank_of(b->n->site + i) == b->rank)
			b->beside[i] = runs_along(b, i);
}

/* ---- chains ---------------------------------------------------------------------------------------------- */

static uint32_t following(const fine *n, const chain *c, uint32_t from, uint32_t at)
{
	return from == UINT32_MAX ? c->second : at == c->first ? UINT32_MAX : next_of(n, from, at);
}

static void add(beside *b, uint32_t first, uint32_t second)
{
	const fine *n = b->n;
	chain c = {.first = first, .second = second, .rank = RANK_COUNT, .loose = ISA(leads_nowhere)(n, first)};
	uint32_t last = first, anchor = first;
	float way[2] = {0}, sum = 0, squares = 0;
	int count = 0;
	for (uint32_t from = UINT32_MAX, at = first, next; at != UINT32_MAX; from = at, at = next) {
		next = following(n, &c, from, at);
		c.length += from != UINT32_MAX ? sqrtf(apart2(n->site + from, n->site + at)) : 0;
		last = at;
		float dx = n->site[at].placed.x - n->site[anchor].placed.x,
		      dy = n->site[at].placed.y - n->site[anchor].placed.y, length = sqrtf(dx * dx + dy * dy);
		if (length >= 1) {
			dx /= length;
			dy /= length;
			if (way[0] != 0 || way[1] != 0) {
				float half = sqrtf(max(0, 0.5f - 0.5f * (dx * way[0] + dy * way[1])));
				sum += way[0] * dy - way[1] * dx < 0 ? -half : half;
				squares += half * half;
				count++;
			}
			way[0] = dx;
			way[1] = dy;
			anchor = at;
		}
		if (links_at(n, at) > 2)
			continue;
		b->chain[at] = b->count;
		/* what is drawn by hand is meant */
		c.chain |= is_chain(n->site + at);
		int rank = is_by_hand(n, n->site + at) ? RANK_SHAPE : rank_of(n->site + at);
		c.rank = rank < c.rank ? rank : c.rank;
	}
	c.loose += ISA(leads_nowhere)(n, last);
	c.wiggle = count > 1 ? squares / (float)count - sum * sum / (float)(count * count) : 0;
	c.closed = last == first && links_at(n, first) == 2;
	b->list[b->count++] = c;
}

static int32_t find_chains(beside *b)
{
	const fine *n = b->n;
	int32_t code = ENCRE_OK;
	for (uint32_t i = 0; i < n->count; i++)
		b->chain[i] = NONE;
	for (uint32_t i = 0; !code && i < n->count; i++) {
		code = at_step(n, i);
		for (uint32_t k = n->at[i]; links_at(n, i) != 2 && k < n->at[i + 1]; k++) {
			uint32_t j = n->to[k];
			if (links_at(n, j) == 2 ? b->chain[j] == NONE : i < j)
				add(b, i, j);
		}
	}
	for (uint32_t i = 0; !code && i < n->count; i++) {
		code = at_step(n, i);
		if (links_at(n, i) == 2 && b->chain[i] == NONE)
			add(b, i, n->to[n->at[i]]);
	}
	return code;
}

/* Older ones first, then longer ones. */
static int by_weight(const void *a, const void *b)
{
	const chain *p = a, *q = b;
	int by = p->rank - q->rank;
	by = by ? by : order(q->length, p->length);
	by = by ? by : order_of(p->first, q->first);
	return by ? by : order_of(p->second, q->second);
}

/* How much of a chain lies beside older lines. */
static float length_beside(const beside *b, const chain *c)
{
	const fine *n = b->n;
	float length = 0, before = 0;
	for (uint32_t from = UINT32_MAX, at = c->first, next; at != UINT32_MAX; from = at, at = next) {
		next = following(n, c, from, at);
		float piece = from != UINT32_MAX ? sqrtf(apart2(n->site + from, n->site + at)) : 0, its = b->beside[at];
		length += 0.5f * piece * (its + before);
		before = its;
	}
	return length;
}

static void choose(beside *b, const chain *c)
{
	const fine *n = b->n;
	if (c->chain)
		return;
	/* light thins out beside what is older (borders.c) */
	bool drop = c->rank != RANK_LIGHT && c->loose && length_beside(b, c) > most_beside * c->length;
	drop |= c->wiggle > (c->rank == RANK_LIGHT ? most_wiggle_light : most_wiggle);
	float least = c->rank == RANK_LIGHT ? least_light : c->rank == RANK_SEEN ? least_seen : 0;
	drop |= c->length < least && (c->loose == 2 || c->closed);
	for (uint32_t from = UINT32_MAX, at = c->first, next; at != UINT32_MAX; from = at, at = next, b->steps++) {
		next = following(n, c, from, at);
		n->site[at].linked.dropped |= drop && links_at(n, at) <= 2;
	}
}

int32_t ISA(fine_drop_beside)(fine *n)
{
	beside b = {.n = n,
		    .beside = late_take(&n->f->late, n->count, sizeof *b.beside),
		    .chain = late_take(&n->f->late, n->count, sizeof *b.chain),
		    .list = late_take(&n->f->late, n->at[n->count] / 2, sizeof *b.list)}; /* each has a link */
	if (!b.beside || !b.chain || !b.list)
		return ENCRE_ERROR_MEMORY;
	memset(b.beside, 0, n->count * sizeof *b.beside);
	int32_t code = find_chains(&b);
	if (code)
		return code;
	qsort(b.list, b.count, sizeof *b.list, by_weight);
	uint32_t i = 0;
	while (i < b.count && b.list[i].rank == RANK_SHAPE)
		i++;
	for (b.rank = RANK_CREASE; !code && b.rank < RANK_COUNT; b.rank++) {
		code = bands_run(n->f->bands, (int)n->count, CHUNK, find_near, &b);
		for (; !code && i < b.count && b.list[i].rank <= b.rank; i++)
			if (b.list[i].rank == b.rank) {
				choose(&b, b.list + i);
				if (b.steps >= CHUNK) { /* a step looks at all that is near */
					b.steps -= CHUNK;
					code = bands_poll(n->f->bands);
				}
			}
	}
	late_drop(&n->f->late, b.list);
	late_drop(&n->f->late, b.chain);
	late_drop(&n->f->late, b.beside);
	return code;
}
