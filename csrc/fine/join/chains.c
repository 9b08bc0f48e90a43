/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What becomes of a line's free ends: a spur is cut, a speck dropped, the pen is lifted. */
#include "fine/near.h"

#include <string.h>

static const float longest_spur = 2, longest_stub = 0.75f; /* pixels, and of a contour; test_fine_passes */
static const float cut_off = 2; /* pixels from the border within which an end is the frame's doing; test_fine_passes */

/* Where the frame cuts a line off it goes on. */
static bool at_border(const frame *f, const site *s)
{
	return s->placed.x < cut_off || s->placed.y < cut_off || s->placed.x > (float)(f->width - 1) - cut_off ||
	       s->placed.y > (float)(f->height - 1) - cut_off;
}

bool ISA(leads_nowhere)(const fine *n, uint32_t i)
{
	return is_end(n, i) && !at_border(n->f, n->site + i);
}

/* ---- spurs ----------------------------------------------------------------------------------------------- */

/* Cuts what branches off a line and ends at once. */
int32_t ISA(fine_cut_spurs)(fine *n)
{
	int32_t code = ENCRE_OK;
	for (uint32_t i = 0; !code && i < n->count; i++) {
		code = at_step(n, i);
		if (is_chain(n->site + i) || !ISA(leads_nowhere)(n, i))
			continue;
		float longest = rank_of(n->site + i) == RANK_SHAPE ? longest_stub : longest_spur;
		uint32_t first = n->to[n->at[i]], from = i, at = first, next;
		float length = sqrtf(apart2(n->site + i, n->site + at));
		while (length < longest && (next = next_of(n, from, at)) != UINT32_MAX) {
			length += sqrtf(apart2(n->site + at, n->site + next));
			from = at;
			at = next;
		}
		if (length >= longest || links_at(n, at) == 1)
			continue;
		n->site[i].linked.dropped = true;
		for (from = i, at = first; (next = next_of(n, from, at)) != UINT32_MAX; from = at, at = next)
			n->site[at].linked.dropped = true;
	}
	return code ? code : ISA(fine_unlink_dropped)(n);
}

/* ---- specks ---------------------------------------------------------------------------------------------- */

/* Whether another thing is on the other side; without numbers of things all are. */
static bool bounds_thing(const frame *f, const found *at)
{
	int x = clamp_index(at->column + (at->axis != AXIS_COLUMN), f->width),
	    y = clamp_index(at->row + (at->axis != AXIS_ROW), f->height);
	const float *one = layer_row(f, ENCRE_LAYER_OBJECT, at->row), *other = layer_row(f, ENCRE_LAYER_OBJECT, y);
	return !one || one[at->column] != other[x];
}

/* However short: an outline, or what is drawn by hand. A contour within a body is a ripple's, if it is short, and a
 * jump within a thing that of ground at a grazing angle. */
static bool is_meant(const fine *n, const site *s)
{
	if (is_chain(s))
		return (rank_of(s) == RANK_SHAPE && !chain_of(n, s)->folded) || is_by_hand(n, s);
	return (rank_of(s) == RANK_SHAPE && bounds_thing(n->f, &s->found)) || is_by_hand(n, s);
}

static float least_length(const frame *f, const site *s)
{
	return params_at(f, s->placed.near_x, s->placed.near_y)->line_shortest * f->scale;
}

/* A place of a contour, of a jump within a thing, by itself. */
static bool is_lone(const fine *n, uint32_t i)
{
	const site *s = n->site + i;
	return s->found.family == FAMILY_CRACK && links_at(n, i) == 0 && !is_meant(n, s) && least_length(n->f, s) > 0 &&
	       !at_border(n->f, s);
}

/* Pixels round: closed lines of that length are as wide as others, and gone; test_spots */
static const float full_round = 9.5f, least_round = 6.5f;

/* Whether a line that goes round little may begin there: of a colour, where one that is weak goes round more, for of
 * joints between bricks far away one here and there is strong enough; of light, for each stone has its brightest spot.
 */
static bool may_go_round(const site *s)
{
	return !s->linked.dropped && (rank_of(s) == RANK_COLOR || rank_of(s) == RANK_LIGHT);
}

/* Drops what goes round less than twice the least length of a weak colour, or four times that of light. A colour that
 * closes within a few pixels, which these may show or miss, comes in by degrees. */
static void drop_ring(const fine *n, uint32_t i)
{
	int rank = rank_of(n->site + i);
	float times = rank == RANK_LIGHT ? 4 : n->site[i].placed.weak ? 2 : 0;
	float least = times * least_length(n->f, n->site + i),
	      most = rank == RANK_COLOR ? max(least, full_round) : least, length = 0;
	uint32_t from = UINT32_MAX, at = i, first = i, sites = 0, next;
	do {
		if (rank_of(n->site + at) != rank || links_at(n, at) != 2)
			return;
		next = from == UINT32_MAX ? n->to[n->at[i]] : next_of(n, from, at);
		length += sqrtf(apart2(n->site + at, n->site + next));
		sites++;
		from = at;
		at = next;
		first = at < first ? at : first;
		/* what goes round is twice as long as it is far across, but for rounding */
	} while (at != i && length < most && apart2(n->site + i, n->site + at) < 0.26f * most * most);
	if (at != i || length >= most)
		return;
	float share = length < least ? 0 : first == i ? (length - least_round) / (full_round - least_round) : 1;
	for (; sites > 0; sites--) {
		site *s = n->site + at;
		if (share <= 0)
			s->linked.dropped = true;
		else if (share < 1)
			s->placed.eased = (uint8_t)(255 - share * (float)(255 - s->placed.eased) + 0.5f);
		next = next_of(n, from, at);
		from = at;
		at = next;
	}
}

/* Of a form that is shaded smoothly, as far as a mesh tells it: its small folds are dents of a rough surface. */
static bool is_smooth(const fine *n, const site *s)
{
	enum { OTHERS = ENCRE_CHAIN_COLOR | ENCRE_CHAIN_MARK | ENCRE_CHAIN_BORDER };
	int kind = is_chain(s) && !is_meant(n, s) ? chain_of(n, s)->kind : 0;
	return (kind & ENCRE_CHAIN_SMOOTH) && !(kind & OTHERS);
}

/* Of its least length, so much longer a line of a smooth form must be to have its whole width. */
static const float whole_length = 1.5f;

/* How far smooth forms' lines span, whose edges may go to and fro, and how long they and all else are. */
typedef struct extent {
	float left, top, right, bottom, smooth, length;
} extent;

static void extend(const fine *n, extent *e, const site *s)
{
	if (!is_smooth(n, s))
		return;
	e->left = min(e->left, s->placed.x);
	e->top = min(e->top, s->placed.y);
	e->right = max(e->right, s->placed.x);
	e->bottom = max(e->bottom, s->placed.y);
}

static float size_of(const extent *e)
{
	float x = max(e->right - e->left, 0), y = max(e->bottom - e->top, 0);
	return e->length + sqrtf(x * x + y * y);
}

/* How large all is that hangs together with a place, if it is free at all its ends; else, and from `most` on,
 * infinitely. *whole: what goes round counts more, for an eye is no dent. It is in `found`, marked as a crumb until
 * drop_if_short() goes on. */
static float size_about(const fine *n, uint32_t i, float most, uint32_t *found, uint32_t *count, float *whole)
{
	extent e = {INFINITY, INFINITY, -INFINITY, -INFINITY, 0, 0};
	found[0] = i;
	*count = 1;
	n->site[i].linked.crumb = true;
	extend(n, &e, n->site + i);
	for (uint32_t k = 0; k < *count; k++) {
		uint32_t at = found[k];
		if (is_meant(n, n->site + at) || (links_at(n, at) == 1 && !ISA(leads_nowhere)(n, at)) ||
		    size_of(&e) >= most)
			return INFINITY;
		for (uint32_t link = n->at[at]; link < n->at[at + 1]; link++) {
			uint32_t next = n->to[link];
			/* it is met from both ends */
			float half = sqrtf(apart2(n->site + at, n->site + next)) / 2;
			*(is_smooth(n, n->site + at) && is_smooth(n, n->site + next) ? &e.smooth : &e.length) += half;
			if (n->site[next].linked.crumb)
				continue;
			n->site[next].linked.crumb = true;
			extend(n, &e, n->site + next);
			found[(*count)++] = next;
		}
	}
	*whole = max(size_of(&e), e.length + e.smooth / 2);
	return size_of(&e) < most ? size_of(&e) : INFINITY;
}

/* What of a smooth form is hardly longer is thinner, so that none comes at once. */
static void drop_if_short(const fine *n, uint32_t i, uint32_t *found, bool *large)
{
	uint32_t count;
	float least = least_length(n->f, n->site + i), whole = 0,
	      size = size_about(n, i, whole_length * least, found, &count, &whole);
	for (uint32_t k = 0; k < count; k++) {
		site *s = n->site + found[k];
		s->linked.crumb = false;
		large[found[k]] |= size == INFINITY;
		s->linked.dropped |= size < least;
		if (size < INFINITY && is_smooth(n, s) && !large[found[k]])
			s->placed.eased = (uint8_t)(255 -
						    clamp01((whole / least - 1) / (whole_length - 1)) *
							    (float)(255 - s->placed.eased) +
						    0.5f);
		large[found[k]] = true;
	}
}

/* Drops what begins and ends in the open and is too short for a line. */
int32_t ISA(fine_drop_short)(fine *n)
{
	int32_t code = ENCRE_OK;
	uint32_t *found = late_take(&n->f->late, n->count, sizeof *found);
	bool *large = late_take(&n->f->late, n->count, sizeof *large);
	if (!found || !large)
		return ENCRE_ERROR_MEMORY;
	memset(large, 0, n->count * sizeof *large);
	for (uint32_t i = 0; !code && i < n->count; i++) {
		code = at_step(n, i);
		if (is_lone(n, i))
			n->site[i].linked.dropped = true;
		if (may_go_round(n->site + i))
			drop_ring(n, i);
		if (!large[i] &&
		    (ISA(leads_nowhere)(n, i) || (is_smooth(n, n->site + i) && !n->site[i].linked.dropped)))
			drop_if_short(n, i, found, large);
	}
	late_drop(&n->f->late, large);
	late_drop(&n->f->late, found);
	return code;
}

/* ---- taper ----------------------------------------------------------------------------------------------- */

/* Where lines meet: the longest of those that come from free ends. A line that goes through is whole. */
static float length_where_meet(const fine *n, uint32_t i, const float *length)
{
	float longest = 0;
	int through = 0;
	for (uint32_t k = n->at[i]; k < n->at[i + 1]; k++) {
		uint32_t j = n->to[k];
		if (links_at(n, j) > 2 || length[j] == INFINITY)
			through++;
		else
			longest = max(longest, length[j] + sqrtf(apart2(n->site + i, n->site + j)));
	}
	return through > 1 ? INFINITY : longest;
}

int32_t ISA(fine_free_lengths)(const fine *n, float reach, float *length)
{
	for (uint32_t i = 0; i < n->count; i++)
		length[i] = INFINITY;
	int32_t code = ENCRE_OK;
	for (uint32_t i = 0; !code && i < n->count; i++) {
		const site *s = n->site + i;
		code = at_step(n, i);
		uint32_t links = links_at(n, i);
		if (s->linked.dropped || links > 1 || at_border(n->f, s))
			continue;
		length[i] = 0;
		float along = 0;
		uint32_t from = i, at = links ? n->to[n->at[i]] : UINT32_MAX;
		while (at != UINT32_MAX) {
			along += sqrtf(apart2(n->site + from, n->site + at));
			if (along >= reach || links_at(n, at) > 2)
				break;
			length[at] = along < length[at] ? along : length[at];
			uint32_t next = next_of(n, from, at);
			from = at;
			at = next;
		}
	}
	for (uint32_t i = 0; !code && i < n->count; i++)
		if (links_at(n, i) > 2 && !n->site[i].linked.dropped)
			length[i] = length_where_meet(n, i, length);
	return code;
}
