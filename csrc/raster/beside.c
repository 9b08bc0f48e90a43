/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "raster/beside.h"

static const float beside_from = 0.12f, beside_to = 0.25f; /* share of a bend that as wide a stretch on the side that
							     turns less may turn: else it goes on there */
static const float as_other = 2;    /* times what the other side turns is what is not seen taken to */
static const float least_edge = 20; /* degrees that an edge bends, below which none is a line */
static const float least_seen = 1;  /* pixels beside an edge that must be seen to tell what the form does there */

sides beside_of(const looking *l, int i, int way, const float across[3], float reach, float enough, float guessed)
{
	const turning *own = l->list + i;
	float at = own->share, seen = way < 0 ? along(own, 0) : (float)(l->size - 1 - own->way) - at;
	bool border = true;
	sides found = {0};
	for (int k = i + way; k >= 0 && k < l->count; k += way) {
		float away = fabsf(along(l->list + k, own->way) - at);
		if (away >= reach)
			break;
		if (l->list[k].turn < 0) {
			seen = away;
			border = false;
			break;
		}
		float turn = l->list[k].turn * most_one(2 - 2 * away / reach);
		found.all += turn;
		found.sure += l->list[k].sliver ? 0 : turn;
		found.same += l->list[k].sliver || turns_back(l, l->list + k, across) ? 0 : turn;
	}
	if (seen < enough)
		return (sides){.seen = border || seen >= guessed ? 0 : closed};
	found.seen = most_one(seen / reach);
	return found;
}

sides beside_whole(const sides *own, const sides *other)
{
	if (own->seen >= 1)
		return *own;
	float going = own->seen > 0 ? own->sure * (1 / own->seen - 1) : 0,
	      more = max(going, (1 - own->seen) * as_other * other->sure);
	return (sides){own->all + more, own->sure + more, own->same + more, 1};
}

float beside_alone(const sides *one, const sides *other, float turn)
{
	return clamp01((beside_to - min(one->all, other->all) / turn) / (beside_to - beside_from));
}

/* Both ways as far as a bend over several faces may be wide and count in full. What lies beyond an outline is not
 * known: it is taken to go on as the other side does. */
static float left_of(const looking *l, int k)
{
	const turning *t = l->list + k;
	float across[3], reach = l->s->narrow;
	change_along(l, t->way, t->way + 1, across);
	sides one = beside_of(l, k, -1, across, reach, least_seen, least_seen),
	      other = beside_of(l, k, 1, across, reach, least_seen, least_seen);
	if (one.seen < 0 && other.seen < 0)
		return 1;
	one.seen = max(one.seen, 0);
	other.seen = max(other.seen, 0);
	sides before = beside_whole(&one, &other), after = beside_whole(&other, &one);
	return beside_alone(&before, &after, fabsf(t->edge));
}

/* A cloth's fold seen at a slant bends at edge after edge, each of which would be a scrap of a line. */
void beside_fade(const looking *l)
{
	for (int k = 0; k < l->count; k++) {
		const turning *t = l->list + k;
		if (t->turn < 0 || !(t->edge <= -least_edge))
			continue;
		int x = l->axis ? l->number : t->way, y = l->axis ? t->way : l->number;
		crease_scale(pixel_at(&l->s->job->creases, x, y) + (ptrdiff_t)2 * l->axis, left_of(l, k));
	}
}
