/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Loose ends: a chain that stops short of a corner, of another line or of its own continuation is led on to it. */
#include "fine/near.h"

#include <stdlib.h>
#include <string.h>

enum { CHUNK = 256, ROUNDS = 2, OWN = 8 };

static const float back = 3; /* pixels over which a chain's direction is taken; test_fine_passes */
static const float near_reach = 3, near_cosine = 0.7f, far_reach = 6,
		   far_cosine = 0.94f, /* of what an end may tie to; test_fine_passes */
	side_cosine = 0.5f;            /* of a stripe that a step's end may tie to; test_fine_passes */
static const float ray_from = -0.5f, ray_to = 4,
		   least_sine = 0.34f; /* pixels ahead of both ends at which their lines may meet; test_fine_passes */
static const float wedge_apart = 8, wedge_to = 10,
		   wedge_sine = 0.25f; /* likewise, if the picture shows an acute corner there; test_fine_passes */
static const float wedge_over = 1.5f;  /* pixels over which ends must tell where they go for that; test_fine_passes */
static const float clear_of = 1.5f,
		   on_it = 0.75f;  /* pixels from both ends of a way, and from it, where a line bars it */
static const float margin = 0.25f; /* by how much something else must be nearer to come first; test_fine_passes */

typedef struct end {
	uint32_t site;
	float dx, dy;  /* unit, ahead */
	float over;    /* pixels over which it is taken */
	uint32_t best; /* the site to tie to; UINT32_MAX = none */
	float cost;
	uint32_t pairs, first; /* its pairs with later ends */
	bool taken;
} end;

typedef struct pair {
	float cost, x, y;
	uint32_t one, two; /* ends */
	bool corner;       /* a new site at x, y */
} pair;

typedef struct ends {
	fine *n;
	uint32_t count;
	end *end;
	pair *pair;
	uint32_t *number; /* of the end, by site; UINT32_MAX: it is none */
	uint32_t *first;  /* ends by cells, as fine.cell has the sites: member[first[i]] to member[first[i + 1] - 1] */
	uint32_t *member;
} ends;

/* The first sites of the chain after its end. */
static int own_chain(const fine *n, uint32_t i, uint32_t *own)
{
	uint32_t from = i, at = n->to[n->at[i]];
	int count = 0;
	while (count < OWN && at != UINT32_MAX) {
		own[count++] = at;
		uint32_t next = next_of(n, from, at);
		from = at;
		at = next;
	}
	return count;
}

static bool is_in(uint32_t i, const uint32_t *list, int count)
{
	for (int k = 0; k < count; k++)
		if (list[k] == i)
			return true;
	return false;
}

/* ---- what lies ahead ------------------------------------------------------------------------------------- */

/* May an end of one be led to the other? */
static bool older(const site *s, const site *other)
{
	int own = rank_of(s), its = rank_of(other);
	return its <= own || (own == RANK_SHAPE && its == RANK_CREASE);
}

/* Is a site of a stripe in a step's own layer? It runs on in the middle of two steps, at an angle to both. */
static bool is_stripe_of(const site *s, const site *other)
{
	const family_info *is = families + s->found.family, *its = families + other->found.family;
	return is->kind == KIND_STEP && its->kind == KIND_BAND && its->sample == is->sample;
}

/* Whether a line that is no younger crosses the way from an end to a corner. */
static bool barred(const fine *n, const site *s, float x, float y)
{
	float dx = x - s->placed.x, dy = y - s->placed.y, length = sqrtf(dx * dx + dy * dy);
	if (!(length > 2 * clear_of))
		return false;
	near_sites of = near_box(n, min(x, s->placed.x) - on_it, min(y, s->placed.y) - on_it,
				 max(x, s->placed.x) + on_it, max(y, s->placed.y) + on_it);
	for (uint32_t j; near_next(n, &of, &j);) {
		const site *t = n->site + j;
		float px = t->placed.x - s->placed.x, py = t->placed.y - s->placed.y,
		      along = (px * dx + py * dy) / length;
		if (!t->linked.dropped && rank_of(t) <= rank_of(s) && along > clear_of && along < length - clear_of &&
		    fabsf(px * dy - py * dx) < on_it * length)
			return true;
	}
	return false;
}

/* Whether two ends are of one chain that goes round no more than half a circle: it would be drawn twice. */
static bool goes_straight(const fine *n, uint32_t end, uint32_t other)
{
	const float half_round = 1.5707963f; /* times as long as it is across */
	uint32_t from = end, at = n->to[n->at[end]], next;
	float along = sqrtf(apart2(n->site + from, n->site + at));
	while (at != other && (next = next_of(n, from, at)) != UINT32_MAX) {
		along += sqrtf(apart2(n->site + at, n->site + next));
		from = at;
		at = next;
	}
	return at == other && along <= half_round * sqrtf(apart2(n->site + end, n->site + other));
}

/* How two ends may be joined. */
static bool join(const fine *n, const end *a, const end *b, pair *p)
{
	const site *s = n->site + a->site, *t = n->site + b->site;
	float dx = t->placed.x - s->placed.x, dy = t->placed.y - s->placed.y, length = sqrtf(dx * dx + dy * dy);
	int rank = rank_of(s) > rank_of(t) ? rank_of(s) : rank_of(t), other = rank_of(s) + rank_of(t) - rank;
	/* a silhouette that fades may go on as a crease, or as a valley that straight on */
	bool form = rank == RANK_FORM && other == RANK_SHAPE;
	if ((other != rank && rank > RANK_CREASE && !form) || !(length > 0) || length > wedge_apart)
		return false;
	float one = (dx * a->dx + dy * a->dy) / length, two = -(dx * b->dx + dy * b->dy) / length;
	p->corner = false;
	p->cost = 0.5f * length;
	if (one >= far_cosine && two >= far_cosine)
		return length <= near_reach || form || ISA(picture_agrees)(n, s, t);
	if (form)
		return false;
	float sine = a->dx * b->dy - a->dy * b->dx;
	float u = (dx * b->dy - dy * b->dx) / sine, v = (dx * a->dy - dy * a->dx) / sine, cost = u > v ? u : v;
	float x = s->placed.x + u * a->dx, y = s->placed.y + u * a->dy;
	bool meet = fabsf(sine) >= wedge_sine && u >= ray_from && v >= ray_from && cost <= wedge_to;
	/* What is small and round turns faster than its ends tell. */
	if (rank == RANK_COLOR && length <= near_reach && !(meet && ISA(picture_corner)(n, s, t, x, y)))
		return !goes_straight(n, a->site, b->site) && ISA(picture_agrees)(n, s, t);
	p->corner = true;
	p->cost = cost;
	p->x = x;
	p->y = y;
	bool told = min(a->over, b->over) >= wedge_over;
	return meet &&
	       ((cost <= ray_to && fabsf(sine) >= least_sine) || (told && ISA(picture_wedge)(n, s, t, rank, x, y))) &&
	       !barred(n, s, x, y) && !barred(n, t, x, y);
}

/* The cells in which an end may find something to tie to. */
static near_sites cells_ahead(const fine *n, const end *e)
{
	const float beyond = far_reach + 0.1f, aside = 2.7f; /* what lies ahead is never as far from the line */
	float x = n->site[e->site].placed.x, y = n->site[e->site].placed.y, wide = aside * fabsf(e->dy),
	      tall = aside * fabsf(e->dx), to_x = beyond * e->dx, to_y = beyond * e->dy;
	return near_box(n, x + min(0, to_x) - wide, y + min(0, to_y) - tall, x + max(0, to_x) + wide,
			y + max(0, to_y) + tall);
}

static void look_ahead(const ends *all, end *e)
{
	const fine *n = all->n;
	const site *s = n->site + e->site;
	uint32_t own[OWN];
	int count = own_chain(n, e->site, own);
	near_sites of = cells_ahead(n, e);
	e->best = UINT32_MAX;
	e->cost = INFINITY;
	for (uint32_t j; near_next(n, &of, &j);) {
		const site *t = n->site + j;
		float along = (t->placed.x - s->placed.x) * e->dx + (t->placed.y - s->placed.y) * e->dy,
		      d2 = apart2(s, t);
		if (!(along > 0) || d2 > 1.01f * far_reach * far_reach) /* most are not, and what follows costs more */
			continue;
		float d = sqrtf(d2);
		if (t->linked.dropped || !(d > 0) || d > far_reach || !older(s, t))
			continue;
		float cosine = along / d;
		float least = d > near_reach ? far_cosine : is_stripe_of(s, t) ? side_cosine : near_cosine;
		if (!(cosine >= least) || is_in(j, own, count))
			continue;
		float cost = d / (cosine * cosine * cosine * cosine);
		if (cost < e->cost && (d <= near_reach || ISA(picture_agrees)(n, s, t))) {
			e->cost = cost;
			e->best = j;
		}
	}
}

/* The end's pairs with later ends; written if there is room for them. */
static uint32_t pairs_of(const ends *all, uint32_t i, pair *out)
{
	const fine *n = all->n;
	const end *e = all->end + i;
	const site *s = n->site + e->site;
	uint32_t count = 0;
	near_sites of = near_site(n, s, wedge_apart);
	for (; of.row <= of.last; of.row++) {
		const uint32_t *first = all->first + (ptrdiff_t)of.row * n->across;
		for (uint32_t k = first[of.x0]; k < first[of.x1 + 1]; k++) {
			pair p = {.one = i, .two = all->member[k]};
			if (p.two <= i || !join(n, e, all->end + p.two, &p))
				continue;
			if (out)
				out[count] = p;
			count++;
		}
	}
	return count;
}

static void aim(void *data, int first, int last, int thread)
{
	(void)thread;
	const ends *all = data;
	for (int i = first; i < last && !stopped_at(all->n, i); i++) {
		const fine *n = all->n;
		end *e = all->end + i;
		const site *s = n->site + e->site;
		uint32_t from = e->site, at = n->to[n->at[from]];
		while (apart2(s, n->site + at) < back * back) {
			uint32_t next = next_of(n, from, at);
			if (next == UINT32_MAX)
				break;
			from = at;
			at = next;
		}
		float dx = s->placed.x - n->site[at].placed.x, dy = s->placed.y - n->site[at].placed.y,
		      length = sqrtf(dx * dx + dy * dy);
		e->over = length;
		e->dx = length > 0 ? dx / length : 0;
		e->dy = length > 0 ? dy / length : 0;
		look_ahead(all, e);
	}
}

static void count_pairs(void *data, int first, int last, int thread)
{
	(void)thread;
	const ends *all = data;
	for (int i = first; i < last && !stopped_at(all->n, i); i++)
		all->end[i].pairs = pairs_of(all, (uint32_t)i, NULL);
}

static void fill_pairs(void *data, int first, int last, int thread)
{
	(void)thread;
	const ends *all = data;
	for (int i = first; i < last && !stopped_at(all->n, i); i++)
		pairs_of(all, (uint32_t)i, all->pair + all->end[i].first);
}

/* ---- joining --------------------------------------------------------------------------------------------- */

static int by_cost(const void *a, const void *b)
{
	const pair *p = a, *q = b;
	int by = order(p->cost, q->cost);
	by = by ? by : order_of(p->one, q->one);
	return by ? by : order_of(p->two, q->two);
}

/* Is there anything but `partner` that the end should rather go to? */
static bool rather(const end *e, uint32_t partner, float cost)
{
	return e->best != partner && e->cost < cost - margin;
}

/* Every end that is joined adds at most one site and two links. */
typedef struct added {
	uint32_t count, sites;
	uint32_t (*link)[2];
	site *site;
} added;

static void add(added *to, uint32_t a, uint32_t b)
{
	to->link[to->count][0] = a;
	to->link[to->count++][1] = b;
}

static int32_t join_ends(ends *all, uint32_t pairs, added *to)
{
	const fine *n = all->n;
	int32_t code = ENCRE_OK;
	for (uint32_t i = 0; !code && i < pairs; i++) {
		code = at_step(n, i);
		const pair *p = all->pair + i;
		end *a = all->end + p->one, *b = all->end + p->two;
		if (a->taken || b->taken || rather(a, b->site, p->cost) || rather(b, a->site, p->cost))
			continue;
		a->taken = b->taken = true;
		if (!p->corner) {
			add(to, a->site, b->site);
			continue;
		}
		site corner = n->site[a->site];
		corner.placed.x += on_grid(p->x - corner.placed.x);
		corner.placed.y += on_grid(p->y - corner.placed.y);
		corner.found.axis = AXIS_CORNER;
		ISA(fine_controls)(n, &corner.found, &corner.placed);
		to->site[to->sites] = corner;
		add(to, a->site, n->count + to->sites);
		add(to, b->site, n->count + to->sites++);
	}
	for (uint32_t i = 0; !code && i < all->count; i++) {
		code = at_step(n, i);
		const end *e = all->end + i;
		if (e->taken || e->best == UINT32_MAX)
			continue;
		const end *other = all->number[e->best] != UINT32_MAX ? all->end + all->number[e->best] : NULL;
		if (!other || other > e || other->taken ||
		    other->best != e->site) /* once where they choose each other */
			add(to, e->site, e->best);
	}
	return code;
}

static int32_t find_ends(ends *all)
{
	fine *n = all->n;
	int32_t code = ENCRE_OK;
	all->count = 0;
	all->number = late_take(&n->f->late, n->count, sizeof *all->number);
	if (!all->number)
		return ENCRE_ERROR_MEMORY;
	for (uint32_t i = 0; !code && i < n->count; i++) {
		code = at_step(n, i);
		all->number[i] = is_end(n, i) && !is_chain(n->site + i) ? all->count++ : UINT32_MAX;
	}
	size_t cells = (size_t)n->across * (size_t)n->tall;
	all->end = late_take(&n->f->late, all->count, sizeof *all->end);
	all->first = late_take(&n->f->late, cells + 1, sizeof *all->first);
	all->member = late_take(&n->f->late, all->count, sizeof *all->member);
	if (code || !all->end || !all->first || !all->member)
		return code ? code : ENCRE_ERROR_MEMORY;
	memset(all->first, 0, (cells + 1) * sizeof *all->first);
	for (uint32_t i = 0; !code && i < n->count; i++) {
		code = at_step(n, i);
		if (all->number[i] == UINT32_MAX)
			continue;
		all->end[all->number[i]] = (end){.site = i};
		all->first[cell_of(n, &n->site[i].placed)]++;
	}
	for (size_t i = 1; i <= cells; i++)
		all->first[i] += all->first[i - 1];
	/* from the last: each finds its cell's end and moves it down */
	for (uint32_t k = all->count; !code && k-- > 0;)
		all->member[--all->first[cell_of(n, &n->site[all->end[k].site].placed)]] = k;
	return code;
}

int32_t ISA(fine_add_sites)(fine *n, const site *from, uint32_t count)
{
	if (!count)
		return ENCRE_OK;
	site *sites = late_take(&n->f->late, n->count + count, sizeof *sites);
	if (!sites)
		return ENCRE_ERROR_MEMORY;
	int32_t code = ENCRE_OK;
	for (uint32_t i = 0; !code && i < n->count + count; i++) {
		code = at_step(n, i);
		sites[i] = i < n->count ? n->site[i] : from[i - n->count];
	}
	if (code)
		return code;
	late_drop(&n->f->late, n->site);
	n->site = sites;
	n->count += count;
	return ISA(fine_sort)(n);
}

static int32_t round_of(fine *n)
{
	ends all = {.n = n};
	int32_t code = find_ends(&all);
	if (!code)
		code = bands_run(n->f->bands, (int)all.count, CHUNK, aim, &all);
	if (!code)
		code = bands_run(n->f->bands, (int)all.count, CHUNK, count_pairs, &all);
	if (code)
		return code;
	uint32_t pairs = 0;
	for (uint32_t i = 0; i < all.count; i++) {
		all.end[i].first = pairs;
		pairs += all.end[i].pairs;
	}
	all.pair = late_take(&n->f->late, pairs, sizeof *all.pair);
	added to = {.link = late_take(&n->f->late, all.count, sizeof *to.link),
		    .site = late_take(&n->f->late, all.count, sizeof *to.site)};
	if (!all.pair || !to.link || !to.site)
		return ENCRE_ERROR_MEMORY;
	code = bands_run(n->f->bands, (int)all.count, CHUNK, fill_pairs, &all);
	if (code)
		return code;
	qsort(all.pair, pairs, sizeof *all.pair, by_cost);
	code = join_ends(&all, pairs, &to);
	late_drop(&n->f->late, all.end);
	late_drop(&n->f->late, all.number);
	late_drop(&n->f->late, all.first);
	late_drop(&n->f->late, all.member);
	late_drop(&n->f->late, all.pair);
	if (!code)
		code = ISA(fine_add_sites)(n, to.site, to.sites);
	if (!code)
		code = ISA(fine_add_links)(n, to.link, to.count);
	late_drop(&n->f->late, to.link);
	late_drop(&n->f->late, to.site);
	return code;
}

int32_t ISA(fine_join_ends)(fine *n)
{
	int32_t code = ENCRE_OK;
	for (int i = 0; !code && i < ROUNDS; i++)
		code = round_of(n);
	return code;
}
