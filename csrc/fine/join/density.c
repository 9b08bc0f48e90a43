/* SPDX-License-Identifier: GPL-3.0-or-later */
/* How much room lines between colours have, and lines of light: where a texture is farther away than its pixels can
 * show, as a chequered floor is near the horizon, or the shadow of a fence, its lines close up, break, and follow what
 * sampling has left of it. They get thinner as the next lines of their kind on both sides come near, and are gone
 * before that is all there is to see. */
#include "fine/near.h"

enum { CHUNK = 512 };

static const float reach = 10; /* px in which next lines are looked for; test_fine_passes */
/* In pixels: another site is on a line of its own that lies so far ahead, across this line, and no farther beside its
 * axis: of lines that part other colours, and of those that part the same colours the other way round. */
static const float ahead_other = 1.75f, aside_other = 1.5f, ahead_back = 1, aside_back = 4; /* test_fine_passes */
static const float gone = 2.5f; /* px: lines that are so close are not drawn; test_fine_passes */
/* Of pixels, at which colours turn back: from so many on, and in full, there is a line on each; test_fine_passes */
static const float turns_from = 0.25f, turns_full = 0.45f;
static const float share = 0.25f; /* of the room beyond that, which a line's half may take; test_fine_passes */

typedef struct crowd {
	fine *n;
	int rank;
	float reach, spread, gone; /* in pixels */
	float *near;               /* by site: 1 / the distance to the farther of the next lines on both sides */
	float (*sum)[2];           /* by cell: of that, and how many sites there are */
} crowd;

/* What was too short to be a line shows all the same how dense lines would be. */
static bool counts(const site *s, int rank)
{
	return rank_of(s) == rank && (!s->linked.dropped || s->linked.crumb);
}

static bool is_next(const site *s, const site *other, float ahead, float aside)
{
	bool back = s->found.axis == other->found.axis && step_dot(s, other) < 0;
	float least = back ? ahead_back : ahead_other, most = back ? aside_back : aside_other;
	return ahead * ahead > least * least && aside * aside <= most * most;
}

/* Lines are as far apart as they are straight across: `lean` pixels aside for each along the axis, up to 45 degrees
 * where a line tells, and `along` of each of these. */
typedef struct gap {
	float lean, along, before, after;
} gap;

static gap gap_at(const fine *n, uint32_t i, float reach)
{
	gap g = {.along = 1, .before = reach, .after = reach};
	float way[2];
	if (way_of(n, i, way)) {
		bool down = n->site[i].found.axis == AXIS_COLUMN;
		float back = -way[down], aside = way[!down];
		g.lean = fabsf(aside) > fabsf(back) ? back / aside : back == 0 ? 0 : (back < 0) != (aside < 0) ? -1 : 1;
		g.along = 1 / sqrtf(1 + g.lean * g.lean);
	}
	return g;
}

/* Takes what is next among the sites of a strip of cells. */
static void look_in(const fine *n, const site *s, near_sites strip, gap *g)
{
	for (uint32_t i; near_next(n, &strip, &i);) {
		const site *other = n->site + i;
		bool down = s->found.axis == AXIS_COLUMN;
		float x = other->placed.x - s->placed.x, y = other->placed.y - s->placed.y, aside = down ? x : y,
		      ahead = ((down ? y : x) + g->lean * aside) * g->along;
		if (!is_next(s, other, ahead, aside) || !counts(other, rank_of(s)))
			continue;
		if (ahead > 0)
			g->after = ahead < g->after ? ahead : g->after;
		else
			g->before = -ahead < g->before ? -ahead : g->before;
	}
}

/* Strip by strip of cells outwards, as long as one may hold something nearer. */
static float distance_to_next(const crowd *c, uint32_t i)
{
	const fine *n = c->n;
	const site *s = n->site + i;
	gap g = gap_at(n, i, c->reach);
	float nearer = fabsf(g.lean) * aside_back;
	near_sites of = near_site(n, s, c->reach / g.along + nearer), narrow = near_site(n, s, aside_back);
	bool down = s->found.axis == AXIS_COLUMN;
	float at = down ? s->placed.y : s->placed.x;
	int own = pixel_of(at, down ? n->f->height : n->f->width) / CELL, first = down ? of.row : of.x0,
	    last = down ? of.last : of.x1;
	for (int way = -1; way <= 1; way += 2)
		for (int k = way < 0 ? own : own + 1; k >= first && k <= last; k += way) {
			float edge = (float)(way < 0 ? (k + 1) * CELL : k * CELL) - 0.5f;
			float least = (fabsf(at - edge) - nearer) * g.along;
			if (k != own && least >= (way < 0 ? g.before : g.after))
				break;
			look_in(n, s,
				down ? (near_sites){.row = k, .last = k, .x0 = narrow.x0, .x1 = narrow.x1}
				     : (near_sites){.row = narrow.row, .last = narrow.last, .x0 = k, .x1 = k},
				&g);
		}
	float next = g.before > g.after ? g.before : g.after;
	bool stripe = s->found.family == FAMILY_COLOR_BAND || s->found.family == FAMILY_LIGHT_BAND;
	return stripe ? next / (2 - next / c->reach) : next; /* it has two sides */
}

static void find_next(void *data, int first, int end, int thread)
{
	(void)thread;
	const crowd *c = data;
	for (int i = first; i < end && !stopped_at(c->n, i); i++)
		if (counts(c->n->site + i, c->rank)) {
			bool pixels = c->rank == RANK_COLOR && !is_chain(c->n->site + i);
			float turns = pixels ? ISA(color_turns)(c->n, &c->n->site[i].found) : 0;
			c->near[i] = max(1 / distance_to_next(c, (uint32_t)i),
					 clamp01((turns - turns_from) / (turns_full - turns_from)));
		}
}

static void sum_cells(void *data, int first, int end, int thread)
{
	(void)thread;
	const crowd *c = data;
	for (int cell = first; cell < end && !stopped_at(c->n, cell); cell++) {
		float *sum = c->sum[cell];
		sum[0] = sum[1] = 0;
		for (uint32_t k = c->n->cell[cell]; k < c->n->cell[cell + 1]; k++)
			if (counts(c->n->site + c->n->member[k], c->rank)) {
				sum[0] += c->near[c->n->member[k]];
				sum[1]++;
			}
	}
}

/* Alone a site tells little: a check's short side has no next line near, and where a line breaks its neighbours seem to
 * be alone. So cells are averaged. */
static float mean_distance(const crowd *c, const site *s)
{
	float sum[2];
	sums_about(c->n, c->sum, s, c->spread, sum);
	return sum[1] / sum[0];
}

static void bound(void *data, int first, int end, int thread)
{
	(void)thread;
	const crowd *c = data;
	for (int i = first; i < end && !stopped_at(c->n, i); i++) {
		site *s = c->n->site + i;
		if (s->linked.dropped || !counts(s, c->rank))
			continue;
		float mean = mean_distance(c, s), room = mean > c->gone ? mean - c->gone : 1e-6f;
		s->linked.crowd = (1 - mean / c->reach) / (share * room);
	}
}

int32_t ISA(fine_crowd)(fine *n)
{
	int cells = n->across * n->tall;
	float px = room_px(n, color_least_px);
	crowd c = {.n = n,
		   .reach = reach * px,
		   .spread = color_spread * px,
		   .gone = gone * px,
		   .near = late_take(&n->f->late, n->count, sizeof *c.near),
		   .sum = late_take(&n->f->late, (size_t)cells, sizeof *c.sum)};
	if (!c.near || !c.sum)
		return ENCRE_ERROR_MEMORY;
	const struct {
		int rank;
		bool on;
	} kinds[] = {{RANK_COLOR, n->e->on[SOURCE_COLOR]}, {RANK_LIGHT, n->e->on[SOURCE_LIGHT]}};
	int32_t code = ENCRE_OK;
	for (int k = 0; k < 2 && !code; k++) {
		if (!kinds[k].on)
			continue;
		c.rank = kinds[k].rank;
		code = bands_run(n->f->bands, (int)n->count, CHUNK, find_next, &c);
		if (!code)
			code = bands_run(n->f->bands, cells, CHUNK, sum_cells, &c);
		if (!code)
			code = bands_run(n->f->bands, (int)n->count, CHUNK, bound, &c);
	}
	return code;
}
