/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Along a row or a column of pixels the surface turns at its edges, whose places the layer of creases has. Edges in a
 * row are one bend if what they turn is much more than what a wider stretch on either side does: so what is round has
 * none, be it made of few faces or of many. How wide a bend is comes from how its edges scatter, so that it hardly
 * changes along a bevel; it counts less and less as it gets wider. */
#include "base/pixel.h"
#include "raster/beside.h"

static const float least_bend = 20;    /* degrees, below which nothing is looked for */
static const float close_by = 3;       /* times `narrow`, at which a bend weighs half as much as a sharper one */
static const float most_of_one = 0.6f; /* share of a bend that one edge may have: else it is drawn by itself */
static const float own_line = 0.36f;   /* share from which on an edge is seen by itself, unless it is close: */
static const float one_to = 1.25f, two_from = 1.75f; /* pixels across, from the middle: up to which there is one line,
							and from which on two */
static const float stretch = 1.6f;                   /* times as wide as a bend is what is looked at on either side */
static const float least_straight = 0.8f;            /* of all that it turns: it goes one way round */
static const float least_seen = 2;     /* pixels beside a bend that must be seen to tell whether it goes on, */
static const float least_share = 0.5f; /* and of its width */
static const float guessed = 1;        /* likewise, from which on the other side tells of a narrow one */
static const float narrower = 0.8f;    /* times `narrow`, up to which it is one */
static const float noted = 2.6f;       /* pixels from its line within which pixels are told of a bend */
static const float most_bare = 0.55f;  /* share of a bend's width in which nothing bends */
static const float most_apart = 1.25f; /* times `narrow`, that is always bridged */
static const float least_wide = 0.25f; /* pixels: of edges that all pass at one place */

enum { MOST_EDGES = 64 };

static float degrees_between(const float *n, const float *m)
{
	float square = 0;
	for (int c = 0; c < 3; c++)
		square += (n[c] - m[c]) * (n[c] - m[c]);
	float half = 0.5f * sqrtf(square);
	return 114.591559f * pixel_atan2(half, sqrtf(max(0, 1 - half * half)));
}

/* Where a surface ends on a way: at a contour of a mesh, if one is known there. Were it always half way, what is seen
 * of the surface beside a bend would change by up to a pixel as a straight outline passes pixel after pixel, and what
 * counts as one bend with it: the bend's line would be a row of scallops. */
static float end_place(const bends *s, int x, int y, int axis)
{
	float mark = s->job->marks.data ? contour_mark(pixel_at(&s->job->marks, x, y)[axis]) : 0;
	return mark < 0 ? contour_place(mark) : 0.5f;
}

static bool is_sliver(const turning *edge, const turning *end)
{
	return edge->edge != 0 && end->turn < 0 && fabsf(along(end, edge->way) - edge->share) < 1;
}

/* Where a way turns: at its edge. What turns more than that has others, on the longer side of it. */
static float turn_place(const float *crease, float turn)
{
	float place = crease[0], own = min(fabsf(crease[1]) / turn, 1);
	if (!(place > 0))
		return 0.5f;
	return mix(place < 0.5f ? 0.5f * (1 + place) : 0.5f * place, place, own);
}

int lane_note(const bends *s, int x, int y, int axis, turning *list, int count)
{
	unsigned what = s->way[(ptrdiff_t)y * s->width + x] >> WAY_BITS * axis & (WAY_TURNS | WAY_CLOSED);
	int way = axis ? y : x;
	if (what == 0)
		return count;
	if (what == WAY_CLOSED) {
		/* of ends of the surface in a row the first and the last tell all */
		count -= count > 1 && list[count - 1].turn < 0 && list[count - 2].turn < 0;
		list[count] = (turning){end_place(s, x, y, axis), closed, 0, way, false};
		for (int k = count - 1; k >= 0 && list[k].way + 1 >= way; k--)
			list[k].sliver |= is_sliver(list + k, list + count);
		return count + 1;
	}
	float turn = degrees_between(normal_at(s, x, y), normal_at(s, x + !axis, y + axis));
	if (turn == 0)
		return count;
	const float *crease = pixel_at(&s->job->creases, x, y) + 2 * axis;
	list[count] = (turning){turn_place(crease, turn), turn, crease[1], way, false};
	for (int k = count - 1; k >= 0 && list[k].way + 1 >= way; k--)
		list[count].sliver |= is_sliver(list + count, list + k);
	return count + 1;
}

/* ---- bends ----------------------------------------------------------------------------------------------- */

/* How a lane crosses the line in which the faces of two of its pixels meet. */
typedef struct crossed {
	bool ridge;  /* rather than a valley */
	float slant; /* pixels across the line for each along the lane */
} crossed;

static crossed crossed_between(const looking *l, int from, int to)
{
	const encre_raster_job *job = l->s->job;
	const double *v = job->view, *p = job->projection;
	const float *n = normal_along(l, from), *m = normal_along(l, to);
	double along[3] = {n[1] * m[2] - n[2] * m[1], n[2] * m[0] - n[0] * m[2], n[0] * m[1] - n[1] * m[0]}, seen[3];
	for (int k = 0; k < 3; k++)
		seen[k] = v[4 * k] * along[0] + v[4 * k + 1] * along[1] + v[4 * k + 2] * along[2];
	double at = 0.5 * (from + to) + 0.5, aside = l->number + 0.5, nearer = 0,
	       x = 2 * (job->frame.x + (l->axis ? aside : at)) / job->frame.width - 1,
	       y = 1 - 2 * (job->frame.y + (l->axis ? at : aside)) / job->frame.height, right = 0, up = 0;
	for (int k = 0; k < 3; k++) {
		nearer += p[12 + k] * seen[k];
		right += p[k] * seen[k];
		up += p[4 + k] * seen[k];
	}
	right = (right - x * nearer) * job->frame.width;
	up = (up - y * nearer) * job->frame.height;
	double length = sqrt(right * right + up * up), lengthwise = l->axis ? right : up;
	bool mirrored = p[0] * p[5] < 0;
	return (crossed){(lengthwise > 0) != mirrored, length > 0 ? (float)(fabs(lengthwise) / length) : 1};
}

/* What edges are together, one after the other. */
typedef struct sum {
	int from; /* pixel */
	float least, span, gap, turn, along, square;
} sum;

static void sum_add(sum *s, const turning *t)
{
	float at = along(t, s->from);
	s->gap = s->turn > 0 ? max(s->gap, at - s->span) : 0;
	s->turn += t->turn;
	s->along += t->turn * at;
	s->square += t->turn * at * at;
	s->span = at;
}

static sum sum_from(const turning *t)
{
	return (sum){.from = t->way, .least = t->share};
}

/* Pixels from its first pixel. */
static float middle_of(const sum *s)
{
	return s->along / s->turn;
}

/* As wide as what turns evenly and scatters as much; two edges alone would be wider than they are apart. */
static float wide_of(const sum *s)
{
	float middle = middle_of(s), wide = sqrtf(12 * max(0, s->square / s->turn - middle * middle));
	return max(min(wide, s->span - s->least), least_wide);
}

/* Of what goes on beside, too: where a bend is wider than what is taken for it its middle would jump to and fro. */
static sum sum_around(const looking *l, int first, int last, float reach)
{
	int from = first, to = last;
	float across[3];
	change_along(l, l->list[first].way, l->list[last].way + 1, across);
	while (from > 0 && l->list[from - 1].turn >= 0 && !l->list[from - 1].sliver &&
	       !turns_back(l, l->list + from - 1, across) &&
	       along(l->list + first, l->list[from - 1].way) - l->list[from - 1].share < reach)
		from--;
	while (to < l->count - 1 && l->list[to + 1].turn >= 0 && !l->list[to + 1].sliver &&
	       !turns_back(l, l->list + to + 1, across) &&
	       along(l->list + to + 1, l->list[last].way) - l->list[last].share < reach)
		to++;
	sum all = sum_from(l->list + from);
	for (int k = from; k <= to; k++)
		sum_add(&all, l->list + k);
	return all;
}

/* How far an edge is a line by itself rather than a part of the bend, from 0 to 1. `slant`: pixels across the bend for
 * each along the lane. */
static float own_of(const turning *t, const sum *of, float slant)
{
	float share = fabsf(t->edge) / of->turn, away = slant * fabsf(along(t, of->from) - middle_of(of));
	return share > most_of_one ? 1 : share > own_line ? clamp01((away - one_to) / (two_from - one_to)) : 0;
}

static bool any_own_line(const looking *l, int first, int last, const sum *of, float slant)
{
	for (int k = first; k <= last; k++)
		if (own_of(l->list + k, of, slant) >= 1)
			return true;
	return false;
}

/* Its edges are one line, or two by themselves. */
static bool is_chamfer(const turning *first, const turning *last, float turn)
{
	float least = min(fabsf(first->edge), fabsf(last->edge));
	return least > own_line * turn && least >= least_bend;
}

/* What a bend over several faces must bend to be as wide a line as an edge: no more where that may be none. */
static float as_bend(float edge)
{
	return edge + min(max(edge - least_bend, 0), own_ahead);
}

/* Notes these edges as a bend, if they are one and none that has one of them is as clear. */
static void weigh(const looking *l, int first, int last, const sum *of)
{
	const bends *s = l->s;
	float wide = wide_of(of), sharp = wide / (close_by * s->narrow), blunt = 1 + sharp * sharp;
	if (of->gap > max(most_bare * (of->span - of->least), most_apart * s->narrow) &&
	    !is_chamfer(l->list + first, l->list + last, of->turn)) /* two, one beside the other */
		return;
	bool any = false;
	for (int k = first; k <= last; k++)
		any |= of->turn > l->best[k].clear * blunt;
	if (!any)
		return;
	float reach = max(stretch * wide, s->narrow), enough = max(least_seen, least_share * wide),
	      guess = wide <= narrower * s->narrow ? guessed : INFINITY;
	float across[3];
	change_along(l, l->list[first].way, l->list[last].way + 1, across);
	sides one = beside_of(l, first, -1, across, reach, enough, guess),
	      other = beside_of(l, last, 1, across, reach, enough, guess);
	if (one.seen < 0 || other.seen < 0 || one.seen + other.seen < 1) /* neither tells */
		return;
	crossed c = crossed_between(l, l->list[first].way, l->list[last].way + 1);
	sides before = beside_whole(&one, &other), after = beside_whole(&other, &one);
	float alone = beside_alone(&before, &after, of->turn);
	/* a ridge has a line rather than the valley close beside it */
	run r = {.clear = alone * (of->turn - (c.ridge ? max(before.same, after.same) : max(before.sure, after.sure))) /
			  blunt,
		 .bends = alone * (of->turn - 0.5f * (before.sure + after.sure)),
		 .slant = c.slant,
		 .first = first,
		 .last = last};
	if (!(r.bends >= least_bend && r.clear > 0) || any_own_line(l, first, last, of, c.slant) ||
	    !(degrees_between(normal_along(l, l->list[first].way), normal_along(l, l->list[last].way + 1)) >=
	      least_straight * r.bends))
		return;
	for (int k = first; k <= last; k++)
		if (r.clear > l->best[k].clear)
			l->best[k] = r;
}

/* Which edge the line of a bend comes from as its faces part, in which its edges become lines by themselves: any, but
 * along all of it, and from frame to frame, the same. */
static bool from_first(const float *n, const float *m)
{
	static const float rather[3] = {0.31f, 0.43f, 0.85f};
	return dot_of(n, rather) > dot_of(m, rather);
}

/* Tells the pixels about its middle of a bend. */
static void tell(const looking *l, const run *r)
{
	const turning *one = l->list + r->first, *other = l->list + r->last;
	const float *n = normal_along(l, one->way), *m = normal_along(l, other->way + 1);
	sum of = sum_from(one);
	bool flat = false;
	for (int k = r->first; k <= r->last; k++) {
		sum_add(&of, l->list + k);
		flat |= l->list[k].edge > 0;
	}
	bool chamfer = is_chamfer(one, other, of.turn);
	bool ahead = from_first(n, m);
	const turning *kept = ahead ? one : other, *second = ahead ? other : one;
	float own = own_of(second, &of, r->slant), shift = own_of(kept, &of, r->slant);
	of = sum_around(l, r->first, r->last, 0.5f * wide_of(&of));
	float middle = middle_of(&of), line = mix(middle, along(kept, of.from), shift);
	bend b = {.wide = wide_of(&of),
		  .most = mix(r->bends, min(as_bend(fabsf(kept->edge)), r->bends), shift),
		  .own = own,
		  .parting = along(second, of.from) - line,
		  .ways = (uint8_t)(other->way + 1 - one->way),
		  .axis = (uint8_t)l->axis,
		  .smooth = !flat,
		  .chamfer = chamfer};
	for (int c = 0; c < 3; c++)
		b.across[c] = (int8_t)(63 * (m[c] - n[c]));
	int from = of.from + (int)(line - noted), to = of.from + (int)(line + noted) + 1;
	from = from < one->way ? from : one->way; /* where it is, no other line goes by */
	to = to > other->way + 1 ? to : other->way + 1;
	for (int k = from > 0 ? from : 0; k <= to && k < l->size; k++) {
		bend *out = l->out + k;
		b.off = (float)(k - of.from) - line;
		b.first = (int8_t)(one->way - k);
		b.second = along(second, k);
		bool its = fabsf(b.off) <= noted || (k >= one->way && k <= other->way + 1);
		if (its && !(out->most > 0 && fabsf(out->off) <= fabsf(b.off)))
			*out = b;
	}
}

bool lane_look(const looking *l)
{
	bool any = false;
	for (int k = 0; k < l->count; k++)
		l->best[k] = (run){0};
	for (int first = 0; first < l->count; first++) {
		sum all = sum_from(l->list + first);
		for (int last = first; last < l->count && last - first < MOST_EDGES; last++) {
			const turning *t = l->list + last;
			if (t->turn < 0 || along(t, all.from) - all.least > l->s->longest)
				break;
			sum_add(&all, t);
			if (all.turn >= least_bend)
				weigh(l, first, last, &all);
		}
	}
	for (int first = 0; first < l->count; first++) {
		const run *r = l->best + first;
		bool own = r->clear > 0 && r->first == first;
		for (int k = first + 1; own && k <= r->last; k++)
			own = l->best[k].first == first && l->best[k].last == r->last;
		if (own)
			tell(l, r);
		any |= own;
	}
	beside_fade(l);
	return any;
}
