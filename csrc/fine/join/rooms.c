/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What gives way to a line that runs beside it. Edges of meshes beside an outline, and of light beside what is older:
 * where they were cut off at some distance, what runs about there would be a ladder, or come and go. And contours
 * within a thing beside another of it: the rim of an eyelid is one line from afar. And of the two sides of a slit
 * between things one: pixels miss it here and hit it there. */
#include "fine/join/fronts.h"

enum { CHUNK = 512, EVENED = 12, OWN = 12 /* sites each way along a line */, RUN = 6 };

static const float share = 0.25f; /* of the room beyond what closes, which a line's half may take; test_fine_passes */

/* Px beside an older line that runs along, up to where and within which it counts; and pixels along. */
static const float wide = 4, wide_mark = 3, wide_fold = 5, wide_light = 6, along = 1, abreast = 0.5f;
static const float closed_crease = 1.5f, closed_light = 0.5f; /* light keeps 1.5 pixels clear by itself */
static const float closed_fold = 3;
static const float wide_slit = 3.5f; /* between two things */
enum { bars = 2 /* times as wide things must be: what is thinner keeps both its sides */ };
static const float least_aside = 0.7f; /* pixels */

/* Cosines, from which on lines run along each other. An edge of a mesh gives way in full from that of lines by hand on,
 * which may cross at an angle: what leaves a corner at 15 degrees would have a gap there. */
static const float level = 0.95f, level_hand = 0.985f;

enum { BRIDGE = 5 /* sites each way between those of a side of a slit, which are of it too */ };

typedef struct rooms {
	fine *n;
	float px;
	float *room;       /* by site: px to the next older line that runs along, at most as far as that counts */
	bool *side;        /* likewise: whether it is of a side of a slit */
	const float *open; /* by site: how much of it stays; NULL as long as it is not known */
	float *left;       /* likewise, to be filled */
} rooms;

/* An edge of a mesh: one that bends, or a line by hand. */
static bool is_edge(const site *s)
{
	return s->found.family == FAMILY_CREASE || s->found.family == FAMILY_MARK;
}

/* Whether from a pixel behind two things one begins so few pixels along an axis, and is no bar. */
static bool begins(const fine *n, int x, int y, int dx, int dy, int reach)
{
	float behind = object_at(n->f, x, y), depth = depth_at(n->f, x, y), own = behind;
	int k = 1, thick = 0;
	for (; k <= reach && own == behind; k++)
		own = object_at(n->f, clamp_index(x + k * dx, n->f->width), clamp_index(y + k * dy, n->f->height));
	if (own == behind || !(depth_at(n->f, clamp_index(x + (k - 1) * dx, n->f->width),
					clamp_index(y + (k - 1) * dy, n->f->height)) < depth))
		return false;
	while (thick < bars * reach && object_at(n->f, clamp_index(x + (k + thick) * dx, n->f->width),
						 clamp_index(y + (k + thick) * dy, n->f->height)) == own)
		thick++;
	return thick == bars * reach;
}

/* Whether an outline is a side of a slit between two things, or two parts of one, neither of which is thin. */
static bool is_slit(const fine *n, const site *s)
{
	front of = n->e->creases ? front_of(n, s) : (front){0};
	if (!of.way || of.object == of.other)
		return false;
	bool row = s->found.axis == AXIS_ROW;
	int x = s->found.column + (row && of.way < 0), y = s->found.row + (!row && of.way < 0),
	    reach = (int)(wide_slit * room_px(n, 1)) + 1;
	return (begins(n, x, y, -1, 0, reach) && begins(n, x, y, 1, 0, reach)) ||
	       (begins(n, x, y, 0, -1, reach) && begins(n, x, y, 0, 1, reach));
}

static bool may_give_way(const fine *n, const site *s)
{
	return !s->linked.dropped && (is_edge(s) || rank_of(s) == RANK_LIGHT || is_meeting(s) || is_fold(n, s));
}

static float widest(const fine *n, const site *s)
{
	return s->found.family == FAMILY_MARK                                       ? wide_mark
	       : rank_of(s) == RANK_SHAPE || ISA(crease_angle_smooth)(n, &s->found) ? wide_fold
										    : wide;
}

/* Beside an outline an edge of a form that is shaded smoothly is the same fold as that, once more. */
static float closes_at(const fine *n, const site *s)
{
	if (is_edge(s))
		return ISA(crease_angle_smooth)(n, &s->found) ? closed_fold : closed_crease;
	return rank_of(s) == RANK_SHAPE ? closed_fold : closed_light;
}

/* Of two lines by hand that run along each other the left, or upper, one is as an outline to the other: so it is all
 * along them. What lies nearer is the same line, beyond a place where lines meet. */
static bool is_before(const site *s, const site *t, const float way[2], float least)
{
	float x = t->placed.x - s->placed.x, y = t->placed.y - s->placed.y, aside = x * way[1] - y * way[0];
	bool down = fabsf(way[1]) > fabsf(way[0]), back = down ? way[1] > 0 : way[0] < 0;
	return (back ? -aside : aside) > least * sqrtf(way[0] * way[0] + way[1] * way[1]);
}

/* Whether a site is among those that follow on another either way. */
static bool is_own(const fine *n, uint32_t i, uint32_t site)
{
	if (i == site)
		return true;
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

/* Whether a contour lies the way that another bounds. */
static bool faces(const front *of, const site *s, const site *t)
{
	float ahead = s->found.axis == AXIS_ROW ? t->placed.x - s->placed.x : t->placed.y - s->placed.y;
	return (float)of->way * ahead > 0;
}

static float front_depth(const fine *n, const site *s, const front *of)
{
	int dx = s->found.axis == AXIS_ROW;
	return depth_at(n->f, s->found.column + (of->way > 0 && dx), s->found.row + (of->way > 0 && !dx));
}

/* Whether a line goes on without meeting others for so many sites in all: what is shorter is a notch of a slit, and has
 * no other side that surely stays. */
static bool goes_on(const fine *n, uint32_t i, int least)
{
	int sites = 1;
	for (uint32_t k = n->at[i]; k < n->at[i + 1]; k++)
		for (uint32_t from = i, at = n->to[k]; sites < least && links_at(n, at) == 2; sites++) {
			uint32_t next = next_of(n, from, at);
			from = at;
			at = next;
		}
	return links_at(n, i) == 2 && sites >= least;
}

/* On which side of a way, and how clearly, what a contour bounds is. */
static float side_of(const site *s, const front *of, const float way[2])
{
	return (float)of->way * (s->found.axis == AXIS_ROW ? way[1] : -way[0]);
}

/* Whether two outlines are the sides of a slit, and this one goes: that of what comes later, or the right, or lower.
 * Where pixels miss the slit, the other is the line: the rasteriser keeps the place of what comes first. */
static bool is_far_side(const site *s, const site *t, const front *own, const front *other, const float way[2])
{
	float x = t->placed.x - s->placed.x, y = t->placed.y - s->placed.y, side = side_of(s, own, way);
	return other->object != other->other && side * (x * way[1] - y * way[0]) < 0 &&
	       side * side_of(t, other, way) < 0 &&
	       (other->object != own->object ? other->object < own->object : is_before(s, t, way, 0));
}

/* Whether a contour within a thing is a double of another one of it: the rim between them is hardly to be seen, or what
 * lies behind. Outlines stay, then what is no faint contour, then what lies before. Where a thing ends both ways it is
 * thin: both are needed. */
static bool is_double(const fine *n, const site *s, const site *t, const float way[2])
{
	front own = front_of(n, s), other = front_of(n, t);
	bool out = faces(&own, s, t), back = faces(&other, t, s);
	if (other.way && own.object != own.other)
		return is_far_side(s, t, &own, &other, way);
	if (!other.way || other.object != own.object)
		return false;
	if (out && back)
		return false;
	if (other.object != other.other)
		return true;
	if (!s->placed.eased != !t->placed.eased)
		return s->placed.eased;
	return out == back ? is_before(s, t, way, least_aside) : front_depth(n, t, &other) < front_depth(n, s, &own);
}

/* How far light is from an older line, in px. Beside the line of a fold of something smooth, which turns from the lamp
 * there, its border is that fold once more, and must be farther off. */
static float light_room(const fine *n, const site *older, float apart)
{
	bool turns = is_chain(older) ? chain_of(n, older)->folded || (chain_of(n, older)->kind & ENCRE_CHAIN_SMOOTH)
				     : is_fold(n, older) || ISA(crease_angle_smooth)(n, &older->found);
	return turns ? max(0, closed_light + (apart - closed_fold) * (wide - closed_light) / (wide_light - closed_fold))
		     : apart;
}

static void find_rooms(void *data, int first, int end, int thread)
{
	(void)thread;
	const rooms *r = data;
	const fine *n = r->n;
	for (uint32_t i = (uint32_t)first; i < (uint32_t)end && !stopped_at(n, (int)i); i++) {
		const site *s = n->site + i;
		bool light = rank_of(s) == RANK_LIGHT;
		float way[2], other[2], far = widest(n, s) * r->px, room = far, most = light ? wide_light * r->px : far;
		if (r->open && !(r->room[i] < widest(n, s))) /* the second time it has no less */
			continue;
		r->room[i] = widest(n, s);
		r->side[i] = false;
		bool slit = !s->linked.dropped && goes_on(n, i, RUN) && is_slit(n, s);
		if (is_meeting(s) || !(slit || may_give_way(n, s)) || !way_of(n, i, way))
			continue;
		bool fold = s->found.family == FAMILY_CRACK;
		float square = way[0] * way[0] + way[1] * way[1], length = sqrtf(square);
		if (!(length > 0))
			continue;
		r->side[i] = slit;
		float across = (fabsf(way[0]) * along + fabsf(way[1]) * most) / length,
		      down = (fabsf(way[1]) * along + fabsf(way[0]) * most) / length, x0 = s->placed.x,
		      y0 = s->placed.y;
		near_sites of = near_box(n, x0 - across, y0 - down, x0 + across, y0 + down);
		for (uint32_t j; near_next(n, &of, &j);) {
			const site *t = n->site + j;
			float x = t->placed.x - s->placed.x, y = t->placed.y - s->placed.y,
			      aside = fabsf(x * way[1] - y * way[0]);
			if (t->linked.dropped || (fold && t->found.family != FAMILY_CRACK) ||
			    fabsf(x * way[0] + y * way[1]) > (slit ? abreast : along) * length ||
			    aside >= (light ? most : room) * length || !way_of(n, j, other))
				continue;
			bool hands = s->found.family == FAMILY_MARK && t->found.family == FAMILY_MARK;
			bool older = hands        ? is_before(s, t, way, least_aside)
				     : fold       ? is_double(n, s, t, way)
				     : is_edge(s) ? t->found.family < s->found.family
						  : rank_of(t) < RANK_LIGHT;
			float dot = way[0] * other[0] + way[1] * other[1],
			      both = square * (other[0] * other[0] + other[1] * other[1]),
			      least = hands ? level_hand : level;
			if (!older || !(dot * dot > least * least * both) || ((hands || fold) && is_own(n, i, j)))
				continue;
			float counts = r->open ? r->open[j] : 1, more = slit ? wide_fold - wide_slit : 0;
			if (is_edge(s) && !hands)
				counts *= clamp01((sqrtf(dot * dot / both) - level) / (level_hand - level));
			float apart = light ? light_room(n, t, aside / length / r->px) * r->px : aside / length;
			room = min(room, mix(far, apart + more * r->px, counts));
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

/* Whether a line leads to a side of a slit within a few sites. */
static bool leads_to_side(const rooms *r, uint32_t i, uint32_t first)
{
	for (uint32_t from = i, at = first, step = 0; at != UINT32_MAX && step < BRIDGE; step++) {
		uint32_t next = next_of(r->n, from, at);
		if (r->side[at])
			return true;
		from = at;
		at = next;
	}
	return false;
}

/* Whether a site is of a side of a slit, or of a few between such, as where it passes the centre of a pixel. */
static bool is_side(const rooms *r, uint32_t i)
{
	const fine *n = r->n;
	return r->side[i] || (links_at(n, i) == 2 && leads_to_side(r, i, n->to[n->at[i]]) &&
			      leads_to_side(r, i, n->to[n->at[i] + 1]));
}

/* The mean along the line, as far both ways as it goes: what stands beside it in a row, as windows do at a house's
 * corner, would cut it to dashes. Where contours meet, no room is known. Where an older line comes nearer steadily, the
 * mean is the place's own. Two lines by hand that meet again and again would be a ladder: their mean is that of all
 * that lies between two such places. */
static float even_room(const rooms *r, uint32_t i)
{
	const fine *n = r->n;
	bool side = is_side(r, i);
	float count = !side || r->side[i], sum = count * r->room[i];
	bool all = n->site[i].found.family == FAMILY_MARK;
	if (links_at(n, i) > 2)
		return through_room(r, i);
	if (links_at(n, i) != 2)
		return count > 0 ? sum : widest(n, n->site + i);
	uint32_t from[2] = {i, i}, at[2] = {n->to[n->at[i]], n->to[n->at[i] + 1]};
	for (int k = 0; k < EVENED && at[0] != i && at[1] != i; k++) {
		if (at[0] == UINT32_MAX || at[1] == UINT32_MAX ? !all && count > 0 : 0)
			break;
		for (int way = 0; way < 2; way++) {
			if (at[way] == UINT32_MAX)
				continue;
			uint32_t next = next_of(n, from[way], at[way]);
			float counts = all    ? links_at(n, at[way]) <= 2
				       : side ? r->side[at[way]]
					      : !is_meeting(n->site + at[way]);
			sum += counts * r->room[at[way]];
			count += counts;
			from[way] = at[way];
			at[way] = next;
		}
	}
	return count > 0 ? sum / count : widest(n, n->site + i);
}

static void find_open(void *data, int first, int end, int thread)
{
	(void)thread;
	const rooms *r = data;
	for (uint32_t i = (uint32_t)first; i < (uint32_t)end && !stopped_at(r->n, (int)i); i++) {
		const site *s = r->n->site + i;
		bool fold = s->found.family == FAMILY_CRACK && !s->linked.dropped && (r->side[i] || is_fold(r->n, s));
		r->left[i] = fold ? clamp01((even_room(r, i) - closed_fold) / (wide_fold - closed_fold)) : 1;
	}
}

static void give_way(void *data, int first, int end, int thread)
{
	(void)thread;
	const rooms *r = data;
	for (uint32_t i = (uint32_t)first; i < (uint32_t)end && !stopped_at(r->n, (int)i); i++) {
		site *s = r->n->site + i;
		if (!may_give_way(r->n, s) && (s->linked.dropped || !is_side(r, i)))
			continue;
		float room = even_room(r, i), far = widest(r->n, s), closed = closes_at(r->n, s);
		if (room < far)
			s->linked.crowd =
				max(s->linked.crowd, (1 - room / far) / (share * max((room - closed) * r->px, 1e-6f)));
	}
}

/* Of contours the one that another gives way to may itself give way to a third, or a little farther on to that same
 * one: as much as it does, the other stays. So they are looked at twice. */
int32_t ISA(fine_give_way)(fine *n)
{
	float *open = late_take(&n->f->late, n->count, sizeof *open);
	rooms r = {.n = n,
		   .px = room_px(n, 1),
		   .room = late_take(&n->f->late, n->count, sizeof *r.room),
		   .side = late_take(&n->f->late, n->count, sizeof *r.side),
		   .left = open};
	if (!r.room || !r.side || !open)
		return ENCRE_ERROR_MEMORY;
	const bands_kernel work[] = {find_rooms, find_open, find_rooms, give_way};
	int32_t code = ENCRE_OK;
	for (int k = 0; !code && k < 4; k++) {
		r.open = k < 2 ? NULL : open;
		code = bands_run(n->f->bands, (int)n->count, CHUNK, work[k], &r);
	}
	late_drop(&n->f->late, r.side);
	late_drop(&n->f->late, r.room);
	late_drop(&n->f->late, open);
	return code;
}
