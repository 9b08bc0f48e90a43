/* SPDX-License-Identifier: GPL-3.0-or-later */
/* How much room lines between colours have. Where a texture is farther away than its pixels can show, as a chequered
 * floor is near the horizon, its lines close up, break, and follow what sampling has left of it. They get thinner as
 * the next lines on both sides come near, and are gone before that is all there is to see. */
#include "fine.h"

enum { CHUNK = 2048 };

/* In pixels. Next lines are looked for so far away, and their distance is averaged over as much. */
static const float reach = 10;
/* Another site is on a line of its own that lies so far ahead and no farther to the side: of lines that part other
 * colours, and of those that part the same colours the other way round. */
static const float ahead_other = 1.75f, aside_other = 1.5f, ahead_back = 1, aside_back = 4;
static const float gone = 3;      /* lines that are so close are not drawn */
static const float share = 0.25f; /* of the room beyond that, which a line's half may take */

typedef struct crowd {
	fine *n;
	float *apart; /* by site: pixels to the farther of the next lines on both sides, at most `reach` */
} crowd;

/* What was too short to be a line shows all the same how dense lines would be. */
static bool counts(const site *s)
{
	return rank_of(s) == 2 && (!s->dropped || s->crumb);
}

static bool is_next(const site *s, const site *other, float ahead, float aside)
{
	bool back = s->axis == other->axis &&
		    s->step[0] * other->step[0] + s->step[1] * other->step[1] + s->step[2] * other->step[2] < 0;
	float least = back ? ahead_back : ahead_other, most = back ? aside_back : aside_other;
	return ahead * ahead > least * least && aside * aside <= most * most;
}

static float distance_to_next(const fine *n, const site *s)
{
	float before = reach, after = reach;
	near_sites of = near_place(n, s->x, s->y, reach);
	for (uint32_t i; near_next(n, &of, &i);) {
		const site *other = n->site + i;
		float x = other->x - s->x, y = other->y - s->y, ahead = s->axis == AXIS_COLUMN ? y : x,
		      aside = s->axis == AXIS_COLUMN ? x : y;
		if (!is_next(s, other, ahead, aside) || !counts(other))
			continue;
		if (ahead > 0)
			after = ahead < after ? ahead : after;
		else
			before = -ahead < before ? -ahead : before;
	}
	float next = before > after ? before : after;
	return s->family == FAMILY_COLOR_BAND ? next / (2 - next / reach) : next; /* a stripe has two sides */
}

static void find_next(void *data, int first, int end, int thread)
{
	(void)thread;
	const crowd *c = data;
	for (int i = first; i < end; i++)
		if (counts(c->n->site + i))
			c->apart[i] = distance_to_next(c->n, c->n->site + i);
}

/* Alone a site tells little: a check's short side has no next line near, and where a line breaks its neighbours seem to
 * be alone. */
static void average(void *data, int first, int end, int thread)
{
	(void)thread;
	const crowd *c = data;
	for (int k = first; k < end; k++) {
		site *s = c->n->site + k;
		if (s->dropped || !counts(s))
			continue;
		float sum = 0, count = 0;
		near_sites of = near_place(c->n, s->x, s->y, reach);
		for (uint32_t i; near_next(c->n, &of, &i);) {
			const site *other = c->n->site + i;
			if (!counts(other) || apart2(s, other) > reach * reach)
				continue;
			sum += 1 / c->apart[i];
			count++;
		}
		float mean = count / sum, room = mean > gone ? mean - gone : 1e-6f;
		s->crowd = (1 - mean / reach) / (share * room);
	}
}

int32_t ISA(fine_crowd)(fine *n)
{
	crowd c = {n, late_take(&n->f->late, n->count, sizeof *c.apart)};
	if (!c.apart)
		return ENCRE_ERROR_MEMORY;
	int32_t code = rows_run(n->f->rows, (int)n->count, CHUNK, find_next, &c);
	return code ? code : rows_run(n->f->rows, (int)n->count, CHUNK, average, &c);
}
