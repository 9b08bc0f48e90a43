/* SPDX-License-Identifier: GPL-3.0-or-later */
/* How lines bend, over several of their widths: where pens press harder. */
#include "ink/turns.h"

#include "base/stage.h"
#include "fine/near.h"

#include <string.h>

enum { CHUNK = 1024 };

/* Along the line each way, over which its way is told: in units, and in pixels at least; and corners, likewise. */
static const float side = 28, least_side = 12, corner_arm = 12, least_corner_arm = 6;
/* Pixels: what is shorter tells no way. */
static const float least_arm = 2;
/* Units: a bend of this radius is half of the most. */
static const float half_bent = 60;

enum { MEETS = 1, AGAIN = 2 };

/* Sites in the order of their lines, for dozens are walked over from each: LANES walks go side by side then. Where
 * others meet a line its site is in all of them; a closed line goes on at both ends, for as long as walks are. Before
 * the first and behind the last stop there are LANES more. */
typedef struct stops {
	uint32_t *site;
	float *x, *y, *step; /* step: pixels to the next */
	float *runs;         /* 0 at a corner, else up to 1 */
	int32_t *room[2];    /* how many there are to walk over, back and on */
	uint8_t *marks;      /* MEETS: its site has other than two links; AGAIN: of a closed line, elsewhere, too */
} stops;

typedef struct bending {
	const fine *n;
	stops s;
	uint32_t count;
	uint8_t *laid;               /* by link */
	float *turn, *corner, *bend; /* by site: as turns.turn, over longer arms; 0 none, 1 a sharp one; turns.bend */
	float reach, arm;            /* in pixels */
} bending;

/* ---- laying ---------------------------------------------------------------------------------------------- */

static bool goes_on(const bending *g, uint32_t site)
{
	return site != UINT32_MAX && !g->n->site[site].linked.dropped;
}

static uint8_t *laid_of(const bending *g, uint32_t from, uint32_t to)
{
	uint32_t k = g->n->at[from];
	while (g->n->to[k] != to)
		k++;
	return g->laid + k;
}

static float between_stops(const bending *g, uint32_t i)
{
	return sqrtf(apart2(g->n->site + g->s.site[i], g->n->site + g->s.site[i + 1]));
}

/* Of a closed line of `count` stops, which begins at `begin`: those that walks from it may need at each end. */
static void go_round(bending *g, uint32_t begin, uint32_t count)
{
	uint32_t *site = g->s.site + begin, more = 0;
	float ahead = 0, back = 0;
	/* from its first and last; and one for the link between these, from which all may begin */
	for (; more + 1 < count && min(ahead, back) < g->reach; more++) {
		ahead += between_stops(g, begin + more);
		back += between_stops(g, begin + count - 2 - more);
	}
	more += more + 1 < count;
	memmove(site + more, site, count * sizeof *site);
	memcpy(site, site + count, more * sizeof *site);
	memcpy(site + more + count, site + more, more * sizeof *site);
	g->count += 2 * more;
	for (uint32_t i = 0; i < count + 2 * more; i++) {
		uint32_t last = count + 2 * more - 1 - i;
		g->s.room[0][begin + i] = (int32_t)(i < count - 1 ? i : count - 1);
		g->s.room[1][begin + i] = (int32_t)(last < count - 1 ? last : count - 1);
		g->s.marks[begin + i] = i < more || last < more ? AGAIN : 0;
	}
}

/* The line from i over `first` to its end, or round to i. */
static void lay(bending *g, uint32_t i, uint32_t first)
{
	uint32_t begin = g->count, before = i, at = first;
	g->s.site[g->count++] = i;
	while (goes_on(g, at) && !*laid_of(g, before, at)) {
		*laid_of(g, before, at) = *laid_of(g, at, before) = 1;
		g->s.site[g->count++] = at;
		uint32_t next = ISA(onward)(g->n, before, at);
		before = at;
		at = next;
	}
	if (goes_on(g, at)) {
		g->count--; /* i came twice */
		go_round(g, begin, g->count - begin);
		return;
	}
	for (uint32_t k = begin; k < g->count; k++) {
		g->s.room[0][k] = (int32_t)(k - begin);
		g->s.room[1][k] = (int32_t)(g->count - 1 - k);
		g->s.marks[k] = 0;
	}
}

/* First those that have ends, from one of them each. */
static int32_t lay_all(bending *g)
{
	const fine *n = g->n;
	for (int closed = 0; closed < 2; closed++)
		for (uint32_t i = 0; i < n->count; i++) {
			int32_t code = at_step(n, i);
			if (code)
				return code;
			for (uint32_t k = n->at[i]; k < n->at[i + 1] && !n->site[i].linked.dropped; k++)
				if (!g->laid[k] && goes_on(g, n->to[k]) &&
				    (closed || !goes_on(g, ISA(onward)(n, n->to[k], i))))
					lay(g, i, n->to[k]);
		}
	return ENCRE_OK;
}

static void place_rows(void *data, int first, int end, int thread)
{
	(void)thread;
	const bending *g = data;
	for (int i = first; i < end && !stopped_at(g->n, i); i++) {
		const placed *here = &g->n->site[g->s.site[i]].placed;
		g->s.x[i] = here->x;
		g->s.y[i] = here->y;
		g->s.step[i] = g->s.room[1][i] ? between_stops(g, (uint32_t)i) : 0;
		g->s.marks[i] |= links_at(g->n, g->s.site[i]) != 2 ? MEETS : 0;
	}
}

/* Whether a stop stands for its site. */
static bool is_own(const bending *g, uint32_t i)
{
	return i < g->count && !g->s.marks[i];
}

/* ---- corners --------------------------------------------------------------------------------------------- */

/* LANES of each. */
typedef struct arms {
	float x[LANES], y[LANES], length[LANES]; /* from where walks began, and along the lines */
} arms;

/* From LANES stops at once, back (-1) or on (1), to where lines meet or end. */
static void walk(const bending *g, uint32_t i, int way, arms *r)
{
	const stops *s = &g->s;
	const float *x0 = s->x + i, *y0 = s->y + i;
	const int32_t *room = s->room[way > 0] + i;
	int32_t met[LANES] = {0}, some = 1;
	*r = (arms){0};
	for (int32_t hop = 1; some; hop++) {
		const float *x = x0 + way * hop, *y = y0 + way * hop, *xb = x - way, *yb = y - way,
			    *steps = s->step + i + (way > 0 ? hop - 1 : -hop);
		const uint8_t *marks = s->marks + i + way * hop;
		some = 0;
		for (int k = 0; k < LANES; k++) {
			int32_t goes = (hop <= room[k]) & !met[k] & (r->length[k] < g->arm);
			float step = goes ? steps[k] : 0, left = g->arm - r->length[k],
			      share = step > left ? left / step : 1;
			r->length[k] += share * step;
			r->x[k] = goes ? mix(xb[k], x[k], share) - x0[k] : r->x[k];
			r->y[k] = goes ? mix(yb[k], y[k], share) - y0[k] : r->y[k];
			met[k] |= marks[k] & MEETS;
			some |= goes;
		}
	}
}

static void turn_rows(void *data, int first, int end, int thread)
{
	(void)thread;
	const bending *g = data;
	for (uint32_t i = (uint32_t)first; i < (uint32_t)end && !bands_stopped(g->n->f->bands); i += LANES) {
		arms a, b;
		walk(g, i, -1, &a);
		walk(g, i, 1, &b);
		for (uint32_t k = 0; k < LANES && i + k < (uint32_t)end; k++) {
			float one = sqrtf(a.x[k] * a.x[k] + a.y[k] * a.y[k]),
			      two = sqrtf(b.x[k] * b.x[k] + b.y[k] * b.y[k]);
			if (is_own(g, i + k) && min(one, two) > 0.5f * least_arm &&
			    min(a.length[k], b.length[k]) >= least_arm)
				g->turn[g->s.site[i + k]] =
					1 + a.x[k] / one * (b.x[k] / two) + a.y[k] / one * (b.y[k] / two);
		}
	}
}

/* The least of the turns in the farther half of an arm; 2 where it ends before that. */
static float least_turn(const bending *g, uint32_t i, int way)
{
	const stops *s = &g->s;
	float least = 2, length = 0;
	for (int32_t room = s->room[way > 0][i]; room > 0 && length < g->arm; room--) {
		length += s->step[way > 0 ? i : i - 1];
		i += (uint32_t)way;
		if (length > 0.5f * g->arm)
			least = min(least, g->turn[s->site[i]]);
		if (s->marks[i] & MEETS)
			break;
	}
	return least;
}

/* Corners are those where strokes end, but none begins from one frame to the next. */
static void corner_rows(void *data, int first, int end, int thread)
{
	(void)thread;
	const bending *g = data;
	for (uint32_t i = (uint32_t)first; i < (uint32_t)end && !stopped_at(g->n, (int)i); i++) {
		float turn = g->turn[g->s.site[i]];
		if (!is_own(g, i) || !(turn > 0.1f))
			continue;
		float bent = max(least_turn(g, i, -1), least_turn(g, i, 1));
		g->corner[g->s.site[i]] = clamp01((turn - 0.1f) / 0.15f) * clamp01(4.5f - 5 * bent / turn);
	}
}

static void run_rows(void *data, int first, int end, int thread)
{
	(void)thread;
	const bending *g = data;
	for (int i = first; i < end && !stopped_at(g->n, i); i++)
		g->s.runs[i] = 1 - g->corner[g->s.site[i]];
}

/* ---- bends ----------------------------------------------------------------------------------------------- */

/* LANES of each. */
typedef struct flanks {
	float x[LANES], y[LANES], share[LANES]; /* the way, of any length; and how much of it there is */
} flanks;

/* The mean ways of LANES stops at once, back (-1) or on (1). The place of a stop tells little of it, and the last: each
 * jitters. Corners end it. */
static void flank(const bending *g, uint32_t i, int way, flanks *to)
{
	const stops *s = &g->s;
	const int32_t *room = s->room[way > 0] + i;
	float along[LANES] = {0}, runs[LANES], shorter = 1 / g->reach;
	int32_t some = 1;
	*to = (flanks){0};
	memcpy(runs, s->runs + i, sizeof runs);
	for (int32_t hop = 1; some; hop++) {
		const float *x = s->x + i + way * hop, *y = s->y + i + way * hop, *xb = x - way, *yb = y - way,
			    *runs_there = s->runs + i + way * hop, *steps = s->step + i + (way > 0 ? hop - 1 : -hop);
		some = 0;
		for (int k = 0; k < LANES; k++) {
			int32_t goes = (hop <= room[k]) & (along[k] < g->reach) & (runs[k] > 0);
			float step = goes ? steps[k] : 0, part = (along[k] + 0.5f * step) * shorter,
			      weight = (goes & (part < 1)) ? part * (1 - part) * runs[k] : 0;
			to->x[k] += weight * (x[k] - xb[k]);
			to->y[k] += weight * (y[k] - yb[k]);
			to->share[k] += weight * step;
			along[k] += step;
			runs[k] = min(runs[k], runs_there[k]);
			some |= goes;
		}
	}
	for (int k = 0; k < LANES; k++)
		to->share[k] *= 6 * shorter;
}

/* k / (k + 1) of a curvature k, as if lines went straight on beyond their ends: so nothing jumps where one grows. */
static float bend_of(const bending *g, const flanks *a, const flanks *b, uint32_t k)
{
	float across = fabsf(a->x[k] * b->y[k] - a->y[k] * b->x[k]), along = -(a->x[k] * b->x[k] + a->y[k] * b->y[k]),
	      both = sqrtf((a->x[k] * a->x[k] + a->y[k] * a->y[k]) * (b->x[k] * b->x[k] + b->y[k] * b->y[k]));
	/* twice the tangent of half the angle, over the way from the middle of one side to that of the other */
	float bent = 2 * half_bent * g->n->f->scale * across * (a->share[k] * b->share[k]);
	return bent > 0 ? bent / (bent + g->reach * max(0, both + along)) : 0;
}

/* Where lines meet it may be another's: discs beside it cover it. */
static void bend_rows(void *data, int first, int end, int thread)
{
	(void)thread;
	const bending *g = data;
	for (uint32_t i = (uint32_t)first; i < (uint32_t)end && !bands_stopped(g->n->f->bands); i += LANES) {
		flanks a, b;
		flank(g, i, -1, &a);
		flank(g, i, 1, &b);
		for (uint32_t k = 0; k < LANES && i + k < (uint32_t)end; k++)
			if (is_own(g, i + k))
				g->bend[g->s.site[i + k]] = bend_of(g, &a, &b, k);
	}
}

/* ---- running --------------------------------------------------------------------------------------------- */

/* `count` of `size` bytes between twice LANES, all of them 0. */
static void *take(frame *f, size_t count, size_t size)
{
	char *made = late_take(&f->late, count + 2 * LANES, size);
	if (made)
		memset(made, 0, (count + 2 * LANES) * size);
	return made;
}

int32_t ISA(curves_find)(frame *f, turns *t)
{
	static const bands_kernel passes[] = {place_rows, turn_rows, corner_rows, run_rows, bend_rows};
	const fine *n = f->fine;
	/* a line of k links has k + 1 stops, and a closed one less than 3 k: of 2 k in n->to */
	size_t links = n->at[n->count], most = links + links / 2;
	bending g = {.n = n,
		     .laid = take(f, links, sizeof *g.laid),
		     .turn = take(f, n->count, sizeof *g.turn),
		     .corner = take(f, n->count, sizeof *g.corner),
		     .bend = take(f, n->count, sizeof *g.bend),
		     .reach = max(side * f->scale, least_side),
		     .arm = max(corner_arm * f->scale, least_corner_arm)};
	float *number = take(f, 4 * (most + 2 * LANES), sizeof *number);
	int32_t *room = take(f, 2 * (most + 2 * LANES), sizeof *room);
	uint32_t *site = take(f, most, sizeof *site);
	uint8_t *marks = take(f, most, sizeof *marks);
	t->bend = g.bend;
	if (!g.laid || !g.turn || !g.corner || !g.bend || !number || !room || !site || !marks)
		return ENCRE_ERROR_MEMORY;
	size_t each = most + 2 * LANES;
	g.s = (stops){.site = site + LANES,
		      .x = number + LANES,
		      .y = number + each + LANES,
		      .step = number + 2 * each + LANES,
		      .runs = number + 3 * each + LANES,
		      .room = {room + LANES, room + each + LANES},
		      .marks = marks + LANES};
	int32_t code = lay_all(&g);
	for (size_t i = 0; !code && i < sizeof passes / sizeof *passes; i++)
		code = bands_run(f->bands, (int)g.count, CHUNK, passes[i], &g);
	void *rest[] = {g.laid, g.turn, g.corner, number, room, site, marks};
	for (size_t i = 0; i < sizeof rest / sizeof *rest; i++)
		late_drop(&f->late, rest[i]);
	return code;
}
