/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Borders of light give way to an older line that runs beside them: where they were cut off at some distance, what runs
 * about there would come and go. */
#include "fine/near.h"

enum { CHUNK = 512, EVENED = 12 /* sites each way along a line */ };

static const float share = 0.25f; /* of the room beyond what closes, which a line's half may take; test_fine_passes */

/* Px beside an older line that runs along, up to where it counts, and pixels along; within `closed` there is no room:
 * light keeps 1.5 pixels clear by itself. Likewise beside the line of a fold of something smooth, which turns from the
 * lamp there: its border is that fold once more, and must be farther off. */
static const float wide = 4, along = 1, closed = 0.5f, wide_fold = 6, closed_fold = 3;
static const float level = 0.95f; /* cosine, from which on lines run along each other */

typedef struct borders {
	fine *n;
	float px;
	float *room; /* by site: px to the next older line that runs along, at most `wide` */
} borders;

static float room_beside(const fine *n, const site *older, float apart)
{
	bool turns = is_chain(older) && (chain_of(n, older)->folded || (chain_of(n, older)->kind & ENCRE_CHAIN_SMOOTH));
	return turns ? max(0, closed + (apart - closed_fold) * (wide - closed) / (wide_fold - closed_fold)) : apart;
}

static void find_rooms(void *data, int first, int end, int thread)
{
	(void)thread;
	const borders *b = data;
	const fine *n = b->n;
	for (uint32_t i = (uint32_t)first; i < (uint32_t)end && !stopped_at(n, (int)i); i++) {
		const site *s = n->site + i;
		float way[2], other[2], most = wide_fold * b->px;
		b->room[i] = wide;
		if (s->linked.dropped || rank_of(s) != RANK_LIGHT || !way_of(n, i, way))
			continue;
		float square = way[0] * way[0] + way[1] * way[1], length = sqrtf(square);
		if (!(length > 0))
			continue;
		float across = (fabsf(way[0]) * along + fabsf(way[1]) * most) / length,
		      down = (fabsf(way[1]) * along + fabsf(way[0]) * most) / length, x0 = s->placed.x,
		      y0 = s->placed.y;
		near_sites of = near_box(n, x0 - across, y0 - down, x0 + across, y0 + down);
		for (uint32_t j; near_next(n, &of, &j);) {
			const site *t = n->site + j;
			float x = t->placed.x - x0, y = t->placed.y - y0, aside = fabsf(x * way[1] - y * way[0]);
			if (t->linked.dropped || rank_of(t) >= RANK_LIGHT ||
			    fabsf(x * way[0] + y * way[1]) > along * length || aside >= most * length ||
			    !way_of(n, j, other))
				continue;
			float dot = way[0] * other[0] + way[1] * other[1],
			      both = square * (other[0] * other[0] + other[1] * other[1]);
			if (dot * dot > level * level * both)
				b->room[i] = min(b->room[i], room_beside(n, t, aside / length / b->px));
		}
	}
}

/* Where lines meet, that of the line that goes through with most of it. */
static float through_room(const borders *b, uint32_t i)
{
	float most[2] = {0, 0};
	for (uint32_t k = b->n->at[i]; k < b->n->at[i + 1]; k++) {
		float room = b->room[b->n->to[k]];
		most[1] = max(most[1], min(most[0], room));
		most[0] = max(most[0], room);
	}
	return most[1];
}

/* The mean along the line, as far both ways as it goes: what stands beside it in a row, as windows do at a house's
 * corner, would cut it to dashes. Where an older line comes nearer steadily, the mean is the place's own. */
static float even_room(const borders *b, uint32_t i)
{
	const fine *n = b->n;
	float count = 1, sum = b->room[i];
	if (links_at(n, i) > 2)
		return through_room(b, i);
	if (links_at(n, i) != 2)
		return sum;
	uint32_t from[2] = {i, i}, at[2] = {n->to[n->at[i]], n->to[n->at[i] + 1]};
	for (int k = 0; k < EVENED && at[0] != i && at[1] != i; k++) {
		if (at[0] == UINT32_MAX || at[1] == UINT32_MAX)
			break;
		for (int way = 0; way < 2; way++) {
			uint32_t next = next_of(n, from[way], at[way]);
			sum += b->room[at[way]];
			count++;
			from[way] = at[way];
			at[way] = next;
		}
	}
	return sum / count;
}

static void give_way(void *data, int first, int end, int thread)
{
	(void)thread;
	const borders *b = data;
	for (uint32_t i = (uint32_t)first; i < (uint32_t)end && !stopped_at(b->n, (int)i); i++) {
		site *s = b->n->site + i;
		if (s->linked.dropped || rank_of(s) != RANK_LIGHT)
			continue;
		float room = even_room(b, i);
		if (room < wide)
			s->linked.crowd =
				max(s->linked.crowd, (1 - room / wide) / (share * max((room - closed) * b->px, 1e-6f)));
	}
}

int32_t ISA(fine_give_way)(fine *n)
{
	borders b = {.n = n, .px = room_px(n, 1), .room = late_take(&n->f->late, n->count, sizeof *b.room)};
	if (!b.room)
		return ENCRE_ERROR_MEMORY;
	int32_t code = bands_run(n->f->bands, (int)n->count, CHUNK, find_rooms, &b);
	code = code ? code : bands_run(n->f->bands, (int)n->count, CHUNK, give_way, &b);
	late_drop(&n->f->late, b.room);
	return code;
}
