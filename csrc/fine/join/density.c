/* SPDX-License-Identifier: GPL-3.0-or-later */
/* How much room lines have. Those between colours: where a texture is farther away than its pixels can show, as a
 * chequered floor is near the horizon, its lines close up, break, and follow what sampling has left of it. They get
 * thinner as the next lines on both sides come near, and are gone before that is all there is to see. Edges of meshes
 * beside an outline, and of light beside what is older: where they were cut off at some distance, what runs about there
 * would be a ladder, or come and go. */
#include "fine/near.h"

enum { CHUNK = 2048, EVENED = 12, OWN = 12 /* sites each way along a line */ };

/* In px, which in small frames are whole pixels: closer lines these can't part, and in large ones no more than 8. Next
 * lines are looked for so far away, and their distance is averaged over so much each way. */
static const float largest_px = 8, reach = 10, spread = 20; /* test_fine_passes */
/* In pixels: another site is on a line of its own that lies so far ahead and no farther to the side: of lines that part
 * other colours, and of those that part the same colours the other way round. */
static const float ahead_other = 1.75f, aside_other = 1.5f, ahead_back = 1, aside_back = 4; /* test_fine_passes */
static const float gone = 2.5f;   /* px: lines that are so close are not drawn; test_fine_passes */
static const float share = 0.25f; /* of the room beyond that, which a line's half may take; test_fine_passes */

/* Pixels in a px. */
static float px_of(const fine *n)
{
	return min(max(n->f->scale, 1), largest_px);
}

typedef struct crowd {
	fine *n;
	float reach, spread, gone; /* in pixels */
	float *near;               /* by site: 1 / the distance to the farther of the next lines on both sides */
	float (*sum)[2];           /* by cell: of that, and how many sites there are */
} crowd;

/* What was too short to be a line shows all the same how dense lines would be. */
static bool counts(const site *s)
{
	return rank_of(s) == RANK_COLOR && (!s->linked.dropped || s->linked.crumb);
}

static bool is_next(const site *s, const site *other, float ahead, float aside)
{
	bool back = s->found.axis == other->found.axis && step_dot(s, other) < 0;
	float least = back ? ahead_back : ahead_other, most = back ? aside_back : aside_other;
	return ahead * ahead > least * least && aside * aside <= most * most;
}

typedef struct gap {
	float before, after;
} gap;

/* Takes what is next among the sites of a strip of cells. */
static void look_in(const fine *n, const site *s, near_sites strip, gap *g)
{
	for (uint32_t i; near_next(n, &strip, &i);) {
		const site *other = n->site + i;
		bool down = s->found.axis == AXIS_COLUMN;
		float x = other->placed.x - s->placed.x, y = other->placed.y - s->placed.y, ahead = down ? y : x,
		      aside = down ? x : y;
		if (!is_next(s, other, ahead, aside) || !counts(other))
			continue;
		if (ahead > 0)
			g->after = ahead < g->after ? ahead : g->after;
		else
			g->before = -ahead < g->before ? -ahead : g->before;
	}
}

/* Strip by strip of cells outwards, as long as one may hold something nearer. */
static float distance_to_next(const crowd *c, const site *s)
{
	const fine *n = c->n;
	gap g = {c->reach, c->reach};
	near_sites of = near_site(n, s, c->reach), narrow = near_site(n, s, aside_back);
	bool down = s->found.axis == AXIS_COLUMN;
	float at = down ? s->placed.y : s->placed.x;
	int own = pixel_of(at, down ? n->f->height : n->f->width) / CELL, first = down ? of.row : of.x0,
	    last = down ? of.last : of.x1;
	for (int way = -1; way <= 1; way += 2)
		for (int k = way < 0 ? own : own + 1; k >= first && k <= last; k += way) {
			float edge = (float)(way < 0 ? (k + 1) * CELL : k * CELL) - 0.5f;
			if (k != own && (way < 0 ? at - edge >= g.before : edge - at >= g.after))
				break;
			look_in(n, s,
				down ? (near_sites){.row = k, .last = k, .x0 = narrow.x0, .x1 = narrow.x1}
				     : (near_sites){.row = narrow.row, .last = narrow.last, .x0 = k, .x1 = k},
				&g);
		}
	float next = g.before > g.after ? g.before : g.after;
	return s->found.family == FAMILY_COLOR_BAND ? next / (2 - next / c->reach) : next; /* a stripe has two sides */
}

static void find_next(void *data, int first, int end, int thread)
{
	(void)thread;
	const crowd *c = data;
	for (int i = first; i < end && !stopped_at(c->n, i); i++)
		if (counts(c->n->site + i))
			c->near[i] = 1 / distance_to_next(c, c->n->site + i);
}

static void sum_cells(void *data, int first, int end, int thread)
{
	(void)thread;
	const crowd *c = data;
	for (int cell = first; cell < end; cell++) {
		float *sum = c->sum[cell];
		sum[0] = sum[1] = 0;
		for (uint32_t k = c->n->cell[cell]; k < c->n->cell[cell + 1]; k++)
			if (counts(c->n->site + c->n->member[k])) {
				sum[0] += c->near[c->n->member[k]];
				sum[1]++;
			}
	}
}

/* Alone a site tells little: a check's short side has no next line near, and where a line breaks its neighbours seem to
 * be alone. So cells are averaged, with weights that fall to 0 at `spread`. */
static float mean_distance(const crowd *c, const site *s)
{
	near_sites of = near_site(c->n, s, c->spread);
	float sum = 0, count = 0;
	for (int row = of.row; row <= of.last; row++)
		for (int x = of.x0; x <= of.x1; x++) {
			const float *cell = c->sum[row * c->n->across + x];
			float dx = ((float)x + 0.5f) * CELL - 0.5f - s->placed.x,
			      dy = ((float)row + 0.5f) * CELL - 0.5f - s->placed.y;
			float weight = max(0, 1 - fabsf(dx) / c->spread) * max(0, 1 - fabsf(dy) / c->spread);
			sum += weight * cell[0];
			count += weight * cell[1];
		}
	return count / sum;
}

static void bound(void *data, int first, int end, int thread)
{
	(void)thread;
	const crowd *c = data;
	for (int i = first; i < end && !stopped_at(c->n, i); i++) {
		site *s = c->n->site + i;
		if (s->linked.dropped || !counts(s))
			continue;
		float mean = mean_distance(c, s), room = mean > c->gone ? mean - c->gone : 1e-6f;
		s->linked.crowd = (1 - mean / c->reach) / (share * room);
	}
}

int32_t ISA(fine_crowd)(fine *n)
{
	int cells = n->across * n->tall;
	float px = px_of(n);
	crowd c = {.n = n,
		   .reach = reach * px,
		   .spread = spread * px,
		   .gone = gone * px,
		   .near = late_take(&n->f->late, n->count, sizeof *c.near),
		   .sum = late_take(&n->f->late, (size_t)cells, sizeof *c.sum)};
	if (!c.near || !c.sum)
		return ENCRE_ERROR_MEMORY;
	int32_t code = bands_run(n->f->bands, (int)n->count, CHUNK, find_next, &c);
	if (!code)
		code = bands_run(n->f->bands, cells, CHUNK, sum_cells, &c);
	return code ? code : bands_run(n->f->bands, (int)n->count, CHUNK, bound, &c);
}

/* ---- beside older lines --------------------------------------------------------------------------------------- */

/* Px beside an older line that runs along, up to where and within which it counts; as above, and pixels along. */
static const float wide = 4, wide_mark = 3, along = 1;
static const float closed_crease = 1.5f, closed_light = 0.5f; /* light keeps 1.5 pixels clear by itself */
static const float least_aside = 0.7f;                        /* pixels */
static const float level = 0.95f, level_hand = 0.985f;        /* cosines; lines by hand may cross at an angle */

typedef struct rooms {
	fine *n;
	float px;
	float *room; /* by site: px to the next older line that runs along, at most as far as that counts */
} rooms;

/* An edge of a mesh: one that bends, or a line by hand. */
static bool is_edge(const site *s)
{
	return s->found.family == FAMILY_CREASE || s->found.family == FAMILY_MARK;
}

static bool may_give_way(const site *s)
{
	return !s->linked.dropped && (is_edge(s) || rank_of(s) == RANK_LIGHT);
}

static float widest(const site *s)
{
	return s->found.family == FAMILY_MARK ? wide_mark : wide;
}

/* Of two lines by hand that run along each other the left, or upper, one is as an outline to the other: so it is all
 * along them. What lies nearer is the same line, beyond a place where lines meet. */
static bool is_before(const site *s, const site *t, const float way[2])
{
	float x = t->placed.x - s->placed.x, y = t->placed.y - s->placed.y, aside = x * way[1] - y * way[0];
	bool down = fabsf(way[1]) > fabsf(way[0]), back = down ? way[1] > 0 : way[0] < 0;
	return (back ? -aside : aside) > least_aside * sqrtf(way[0] * way[0] + way[1] * way[1]);
}

/* Whether a site is among those that follow on another either way. */
static bool is_own(const fine *n, uint32_t i, uint32_t site)
{
	for (uint32_t k = n->at[i]; k < n->at[i + 1]; k++)
		for (uint32_t from = i, at = n->to[k], links = 0; at != UINT32_MAX && links < OWN; links++) {
			if (at == site)
				return true;
			uint32_t next = next_of(n, from, at);
			from = at;
			at = next;
		}
	return false;
}

static void find_rooms(void *data, int first, int end, int thread)
{
	(void)thread;
	const rooms *r = data;
	const fine *n = r->n;
	for (uint32_t i = (uint32_t)first; i < (uint32_t)end; i++) {
		const site *s = n->site + i;
		float way[2], other[2], room = widest(s) * r->px;
		r->room[i] = widest(s);
		if (!may_give_way(s) || !way_of(n, i, way))
			continue;
		float square = way[0] * way[0] + way[1] * way[1], length = sqrtf(square);
		near_sites of = near_site(n, s, room + along);
		for (uint32_t j; near_next(n, &of, &j);) {
			const site *t = n->site + j;
			bool hands = s->found.family == FAMILY_MARK && t->found.family == FAMILY_MARK;
			bool older = is_edge(s) ? t->found.family < s->found.family : rank_of(t) < RANK_LIGHT;
			if ((hands ? !is_before(s, t, way) || is_own(n, i, j) : !older) || t->linked.dropped ||
			    !way_of(n, j, other))
				continue;
			float x = t->placed.x - s->placed.x, y = t->placed.y - s->placed.y,
			      aside = fabsf(x * way[1] - y * way[0]), dot = way[0] * other[0] + way[1] * other[1];
			if (fabsf(x * way[0] + y * way[1]) <= along * length && aside < room * length &&
			    dot * dot > (hands ? level_hand * level_hand : level * level) * square *
						(other[0] * other[0] + other[1] * other[1]))
				room = aside / length;
		}
		r->room[i] = room / r->px;
	}
}

/* Where lines meet, that of the line that goes through with most of it. */
static float through_room(const rooms *r, uint32_t i)
{
	float most[2] = {0, 0};
	for (uint32_t k = r->n->at[i]; k < r->n->at[i + 1]; k++) {
		float room = r->room[r->n->to[k]];
		most[1] = max(most[1], min(most[0], room));
		most[0] = max(most[0], room);
	}
	return most[1];
}

/* The mean along the line, as far both ways as it goes: what stands beside it in a row, as windows do at a house's
 * corner, would cut it to dashes. Where an older line comes nearer steadily, the mean is the place's own. Two lines by
 * hand that meet again and again would be a ladder: their mean is that of all that lies between two such places. */
static float even_room(const rooms *r, uint32_t i)
{
	const fine *n = r->n;
	float sum = r->room[i], count = 1;
	bool all = n->site[i].found.family == FAMILY_MARK;
	if (links_at(n, i) > 2)
		return through_room(r, i);
	if (links_at(n, i) != 2)
		return sum;
	uint32_t from[2] = {i, i}, at[2] = {n->to[n->at[i]], n->to[n->at[i] + 1]};
	for (int k = 0; k < EVENED && at[0] != i && at[1] != i; k++) {
		if (at[0] == UINT32_MAX || at[1] == UINT32_MAX ? !all : 0)
			break;
		for (int side = 0; side < 2; side++) {
			if (at[side] == UINT32_MAX)
				continue;
			uint32_t next = next_of(n, from[side], at[side]);
			float counts = !all || links_at(n, at[side]) <= 2;
			sum += counts * r->room[at[side]];
			count += counts;
			from[side] = at[side];
			at[side] = next;
		}
	}
	return sum / count;
}

static void give_way(void *data, int first, int end, int thread)
{
	(void)thread;
	const rooms *r = data;
	for (uint32_t i = (uint32_t)first; i < (uint32_t)end; i++) {
		site *s = r->n->site + i;
		if (!may_give_way(s))
			continue;
		float room = even_room(r, i), closed = is_edge(s) ? closed_crease : closed_light, far = widest(s);
		if (room < far)
			s->linked.crowd =
				max(s->linked.crowd, (1 - room / far) / (share * max((room - closed) * r->px, 1e-6f)));
	}
}

int32_t ISA(fine_give_way)(fine *n)
{
	rooms r = {.n = n, .px = px_of(n), .room = late_take(&n->f->late, n->count, sizeof *r.room)};
	if (!r.room)
		return ENCRE_ERROR_MEMORY;
	int32_t code = bands_run(n->f->bands, (int)n->count, CHUNK, find_rooms, &r);
	if (!code)
		code = bands_run(n->f->bands, (int)n->count, CHUNK, give_way, &r);
	late_drop(&n->f->late, r.room);
	return code;
}
