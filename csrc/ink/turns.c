/* SPDX-License-Identifier: GPL-3.0-or-later */
/* How lines turn: where ink gathers, and where strokes go on beyond corners. */
#include "ink/turns.h"

#include "base/stage.h"
#include "fine/near.h"

enum { CHUNK = 1024 };

/* Pixels along a line over which its way is told: single links jump from one crack to the next. */
static const float arm = 6, least_arm = 2;
/* 1 less the cosine: strokes end where a line turns by more than 35 degrees within its arms. */
static const float corner = 0.18f;
/* A bend that is as sharp all along is no corner: half an arm on it has this share of the turn. */
static const float passing = 0.7f;

typedef struct reached {
	uint32_t last;
	float dx, dy, length; /* from where the walk began, and along the line */
	float most, least;    /* of the turns on the way: all, and those in its farther half */
} reached;

/* Walks from i over `first`, to where lines meet or end. turn: by site, or NULL. */
static reached walk(const fine *n, uint32_t i, uint32_t first, float reach, const float *turn)
{
	const placed *from = &n->site[i].placed;
	reached r = {.last = i, .least = 2};
	uint32_t before = i, at = first;
	while (at != UINT32_MAX && at != i && !n->site[at].linked.dropped && r.length < reach) {
		const placed *a = &n->site[before].placed, *b = &n->site[at].placed;
		float step = sqrtf(apart2(n->site + before, n->site + at)),
		      share = r.length + step > reach ? (reach - r.length) / step : 1;
		r.dx = mix(a->x, b->x, share) - from->x;
		r.dy = mix(a->y, b->y, share) - from->y;
		r.length += share * step;
		if (turn) {
			r.most = max(r.most, turn[at] + (at < i ? 0 : -1e-6f));
			r.least = r.length > 0.5f * reach ? min(r.least, turn[at]) : r.least;
		}
		uint32_t next = next_of(n, before, at);
		before = r.last = at;
		at = next;
	}
	return r;
}

static bool unit_of(reached *r)
{
	float length = sqrtf(r->dx * r->dx + r->dy * r->dy);
	if (!(length > 0.5f * least_arm))
		return false;
	r->dx /= length;
	r->dy /= length;
	return true;
}

/* Told by arms: where lines meet, single links go any way. */
static uint32_t straight_on(const fine *n, uint32_t from, uint32_t i)
{
	reached a = walk(n, i, from, arm, NULL);
	uint32_t next = UINT32_MAX;
	float least = 1;
	if (!unit_of(&a))
		return next;
	for (uint32_t k = n->at[i]; k < n->at[i + 1]; k++) {
		reached b = walk(n, i, n->to[k], arm, NULL);
		if (n->to[k] == from || !unit_of(&b) || !(1 + a.dx * b.dx + a.dy * b.dy < least))
			continue;
		least = 1 + a.dx * b.dx + a.dy * b.dy;
		next = n->to[k];
	}
	return next;
}

uint32_t ISA(onward)(const fine *n, uint32_t from, uint32_t i)
{
	if (links_at(n, i) == 2)
		return next_of(n, from, i);
	uint32_t next = straight_on(n, from, i);
	return next != UINT32_MAX && straight_on(n, next, i) == from ? next : UINT32_MAX;
}

typedef struct finding {
	const fine *n;
	float *turn;
	float room;
} finding;

static void turn_rows(void *data, int first, int end, int thread)
{
	(void)thread;
	const finding *g = data;
	const fine *n = g->n;
	for (int i = first; i < end && !stopped_at(n, i); i++) {
		g->turn[i] = 0;
		if (n->site[i].linked.dropped || links_at(n, (uint32_t)i) != 2)
			continue;
		const uint32_t *to = n->to + n->at[i];
		reached a = walk(n, (uint32_t)i, to[0], arm, NULL), b = walk(n, (uint32_t)i, to[1], arm, NULL);
		if (unit_of(&a) && unit_of(&b) && a.length >= least_arm && b.length >= least_arm)
			g->turn[i] = 1 + a.dx * b.dx + a.dy * b.dy;
	}
}

/* The sharpest of a bend that has straight arms. */
static bool is_corner(const finding *g, uint32_t i)
{
	const fine *n = g->n;
	const float *turn = g->turn;
	if (!(turn[i] > corner))
		return false;
	for (uint32_t k = n->at[i]; k < n->at[i + 1]; k++) {
		reached r = walk(n, i, n->to[k], arm, turn);
		if (r.most >= turn[i] || r.least > passing * turn[i])
			return false;
	}
	return true;
}

/* How long the stroke is that ends at i and comes over `first`: back to where others meet it, or to its corner before.
 * Round a nail a line may go on for long, and yet each stroke of it is short. */
static float room_of(const finding *g, uint32_t i, uint32_t first)
{
	const site *s = g->n->site;
	float length = 0;
	for (uint32_t before = i, at = first, next; length < g->room; before = at, at = next) {
		if (at == UINT32_MAX || at == i || s[at].linked.dropped)
			break;
		length += sqrtf(apart2(s + before, s + at));
		if (is_corner(g, at))
			break;
		next = next_of(g->n, before, at);
	}
	return min(length, g->room);
}

/* The strokes that end at a site where others meet them; stored from `at` on unless that is NULL. */
static uint32_t spurs_at(const finding *g, uint32_t i, spur *at)
{
	enum { MOST = 4 };
	const fine *n = g->n;
	uint32_t links = links_at(n, i), count = 0;
	reached way[MOST];
	if (n->site[i].linked.dropped || links < 2 || links > MOST || (links == 2 && !is_corner(g, i)))
		return 0;
	for (uint32_t k = 0; k < links; k++) {
		way[k] = walk(n, i, n->to[n->at[i] + k], arm, NULL);
		if (!unit_of(way + k))
			way[k].length = 0;
	}
	for (uint32_t k = 0; k < links; k++) {
		bool ends = way[k].length >= least_arm;
		for (uint32_t j = 0; j < links; j++)
			ends &= j == k || way[j].length == 0 ||
				1 + way[k].dx * way[j].dx + way[k].dy * way[j].dy > corner;
		if (!ends)
			continue;
		if (at)
			at[count] = (spur){.site = i,
					   .over = n->to[n->at[i] + k],
					   .back = way[k].last,
					   .dx = -way[k].dx,
					   .dy = -way[k].dy,
					   .room = room_of(g, i, n->to[n->at[i] + k])};
		count++;
	}
	return count;
}

int32_t ISA(turns_find)(frame *f, float room, turns *t)
{
	const fine *n = f->fine;
	t->turn = late_take(&f->late, n->count, sizeof *t->turn);
	finding g = {n, t->turn, room};
	if (!t->turn)
		return ENCRE_ERROR_MEMORY;
	int32_t code = bands_run(f->bands, (int)n->count, CHUNK, turn_rows, &g);
	for (int pass = 0; pass < 2 && room > 0; pass++) {
		t->spurs = 0;
		for (uint32_t i = 0; !code && i < n->count; i++) {
			code = at_step(n, i);
			t->spurs += spurs_at(&g, i, t->spur ? t->spur + t->spurs : NULL);
		}
		if (code || pass || !t->spurs)
			return code;
		t->spur = late_take(&f->late, t->spurs, sizeof *t->spur);
		if (!t->spur)
			return ENCRE_ERROR_MEMORY;
	}
	return code;
}
