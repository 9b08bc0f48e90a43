/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Links between sites: cracks join the two that cut a square of four pixel centres, ridges what is close. */
#include "fine/near.h"

#include <string.h>

enum { CHUNK = 512, FEW = 4, EVEN_ROUNDS = 2 };

static const float link_reach = 1.6f;  /* pixels; test_fine_passes */
static const float turn_reach = 2.0f;  /* likewise, where the axis changes in which a colour steps; test_fine_passes */
static const float most_uneven = 0.3f; /* test_fine_passes */

/* ---- who is linked --------------------------------------------------------------------------------------- */

/* Whether in the order of a row a site lies before what is on an axis at column x. */
static bool before(const site *s, int x, int axis)
{
	return s->found.column < x || (s->found.column == x && s->found.axis < axis);
}

static bool has_crack(const fine *n, int family, int x, int y, int axis)
{
	return axis == AXIS_JUNCTION || (n->crack[(ptrdiff_t)y * n->f->width + x] & mark_of(family, axis));
}

/* `at`: the first of the row that lies not before it. */
static uint32_t kept_number(const fine *n, uint32_t at, uint32_t end, int x, int axis)
{
	const site *s = n->site + at;
	return at < end && s->found.column == x && s->found.axis == axis && !s->linked.dropped ? at : n->count;
}

uint32_t ISA(crack_number)(const fine *n, int family, int x, int y, int axis)
{
	if (!has_crack(n, family, x, y, axis))
		return n->count;
	const uint32_t *first = n->first + family * n->f->height + y;
	uint32_t low = first[0], high = first[1];
	while (low < high) {
		uint32_t middle = low + (high - low) / 2;
		if (before(n->site + middle, x, axis))
			low = middle + 1;
		else
			high = middle;
	}
	return kept_number(n, low, first[1], x, axis);
}

enum { ROWS = 3 };

/* Where the last search in a row, by its number modulo ROWS, has ended: sites are linked in their order, and what they
 * may be linked to lies next to that. */
typedef struct fingers {
	uint32_t at[ROWS];
} fingers;

/* As crack_number(). */
static uint32_t number_near(const fine *n, fingers *f, int family, int x, int y, int axis)
{
	if (!has_crack(n, family, x, y, axis))
		return n->count;
	const uint32_t *first = n->first + family * n->f->height + y;
	uint32_t *finger = f->at + y % ROWS, at = *finger;
	at = at >= first[0] && at <= first[1] ? at : first[0];
	while (at < first[1] && before(n->site + at, x, axis))
		at++;
	while (at > first[0] && !before(n->site + at - 1, x, axis))
		at--;
	*finger = at;
	return kept_number(n, at, first[1], x, axis);
}

/* Cracks on the sides of the square of pixel centres from (x, y). */
static int sides(const fine *n, fingers *f, int family, int x, int y, uint32_t *side)
{
	int found = 0;
	if (x < 0 || y < 0 || x + 1 >= n->f->width || y + 1 >= n->f->height)
		return 0;
	const uint32_t all[4] = {
		number_near(n, f, family, x, y, AXIS_ROW), number_near(n, f, family, x, y + 1, AXIS_ROW),
		number_near(n, f, family, x, y, AXIS_COLUMN), number_near(n, f, family, x + 1, y, AXIS_COLUMN)};
	for (int i = 0; i < 4; i++)
		if (all[i] < n->count)
			side[found++] = all[i];
	return found;
}

/* Of the 4x4 pixels about a square: what shows on no more, and lies so far before the others, of the depth, is a wire
 * narrower than a pixel: its sides are one there. */
static const int hardly = 4;            /* test_collars */
static const float least_ahead = 0.01f; /* test_collars */

/* How many of the 4x4 pixels about a square show a thing. */
static int pixels_of(const fine *n, int x, int y, float object)
{
	int count = 0;
	for (int j = y - 1; j <= y + 2; j++)
		for (int i = x - 1; i <= x + 2; i++)
			count += i >= 0 && j >= 0 && i < n->f->width && j < n->f->height &&
				 object_at(n->f, i, j) == object;
	return count;
}

int ISA(crack_passage)(const fine *n, int x, int y)
{
	if (!n->f->layer[ENCRE_LAYER_OBJECT].data)
		return 0;
	float a = object_at(n->f, x, y), b = object_at(n->f, x + 1, y), c = object_at(n->f, x, y + 1),
	      d = object_at(n->f, x + 1, y + 1);
	if (a == b || a == c || d == b || d == c || (a != d && b != c))
		return 0;
	int one = a == d ? pixels_of(n, x, y, a) : 0, two = b == c ? pixels_of(n, x, y, b) : 0;
	float own = min(depth_at(n->f, x, y), depth_at(n->f, x + 1, y + 1)),
	      its = min(depth_at(n->f, x + 1, y), depth_at(n->f, x, y + 1));
	bool alike = one == two, first = alike ? own < its : one && (!two || one < two);
	if (alike && own == its)
		return 0;
	float ahead = first ? its - own : own - its,
	      least = least_ahead * (n->e->ortho ? n->f->camera.height : min(own, its));
	return (first ? one : two) <= hardly && ahead > least ? 0 : first ? 1 : 2;
}

static int passage_at(const fine *n, int family, int x, int y)
{
	const uint8_t *crack = n->crack + (ptrdiff_t)y * n->f->width + x, *below = crack + n->f->width;
	bool inside = family == FAMILY_CRACK && x >= 0 && y >= 0 && x + 1 < n->f->width && y + 1 < n->f->height;
	bool all = inside && (crack[0] & CRACK_RIGHT) && (crack[0] & CRACK_DOWN) && (crack[1] & CRACK_DOWN) &&
		   (below[0] & CRACK_RIGHT);
	return all ? ISA(crack_passage)(n, x, y) : 0;
}

/* The other crack round a pixel that the thing that passes leaves aside; n->count: there is none, or it has no site. */
static uint32_t beside_passage(const fine *n, fingers *f, const found *at, int x, int y, int passage)
{
	static const uint8_t side[4][3] = {
		{0, 0, AXIS_ROW}, {0, 1, AXIS_ROW}, {0, 0, AXIS_COLUMN}, {1, 0, AXIS_COLUMN}};
	int own = at->axis == AXIS_ROW ? at->row - y : 2 + at->column - x, other = passage == 2 ? own ^ 2 : 3 - own;
	return number_near(n, f, at->family, x + side[other][0], y + side[other][1], side[other][2]);
}

static int crack_links(const fine *n, fingers *f, uint32_t i, uint32_t *to)
{
	const site *s = n->site + i;
	uint32_t side[4];
	int found = 0, family = s->found.family;
	if (s->found.axis == AXIS_JUNCTION)
		return (found = sides(n, f, family, s->found.column, s->found.row, to)) > 2 ? found : 0;
	for (int k = 0; k < 2; k++) { /* the squares on both sides of the pair */
		int x = s->found.column - (s->found.axis == AXIS_COLUMN && k),
		    y = s->found.row - (s->found.axis == AXIS_ROW && k);
		int passage = passage_at(n, family, x, y), count;
		if (passage) {
			found += (to[found] = beside_passage(n, f, &s->found, x, y, passage)) < n->count;
			continue;
		}
		count = sides(n, f, family, x, y, side);
		if (count == 2)
			to[found++] = side[0] == i ? side[1] : side[0];
		else if (count > 2 && (to[found] = number_near(n, f, family, x, y, AXIS_JUNCTION)) < n->count)
			found++;
	}
	return found;
}

/* Ridges are linked that are close and go the same way: where a face thins out its two edges come close, and don't. */
static bool close(const site *a, const site *b)
{
	if (a->found.axis == b->found.axis && step_dot(a, b) < 0)
		return false;
	float reach = a->found.family == FAMILY_COLOR && a->found.axis != b->found.axis ? turn_reach : link_reach;
	return a->found.family == b->found.family && !b->linked.dropped && apart2(a, b) <= reach * reach;
}

int ISA(close_sites)(const fine *n, uint32_t i, uint32_t *to)
{
	const site *s = n->site + i;
	near_sites of = near_site(n, s, turn_reach);
	int found = 0;
	for (uint32_t j; found < ROOM && near_next(n, &of, &j);)
		if (j != i && close(s, n->site + j))
			to[found++] = j;
	return found;
}

/* The order of links: by length, then by their sites. */
static bool shorter(const fine *n, uint32_t a, uint32_t b, uint32_t c, uint32_t d)
{
	float one = apart2(n->site + a, n->site + b), two = apart2(n->site + c, n->site + d);
	uint32_t low = a < b ? a : b, other = c < d ? c : d;
	return one != two ? one < two : low != other ? low < other : a + b - low < c + d - other;
}

/* A link goes where two shorter ones join its ends. */
static int ridge_links(const fine *n, uint32_t i, uint32_t *to)
{
	uint32_t all[ROOM];
	int count = ISA(close_sites)(n, i, all), found = 0;
	for (int a = 0; a < count; a++) {
		bool kept = true;
		for (int b = 0; b < count && kept; b++)
			kept = b == a || !close(n->site + all[a], n->site + all[b]) ||
			       !shorter(n, i, all[b], i, all[a]) || !shorter(n, all[a], all[b], i, all[a]);
		if (kept)
			to[found++] = all[a];
	}
	return found;
}

static int links_of(const fine *n, fingers *f, uint32_t i, uint32_t *to)
{
	const site *s = n->site + i;
	return s->linked.dropped || is_chain(s) ? 0
	       : is_crack(s->found.family)      ? crack_links(n, f, i, to)
						: ridge_links(n, i, to);
}

/* ---- all links ------------------------------------------------------------------------------------------- */

/* They are few. */
static void ascend(uint32_t *to, uint32_t count)
{
	for (uint32_t i = 1; i < count; i++)
		for (uint32_t k = i; k > 0 && to[k - 1] > to[k]; k--) {
			uint32_t other = to[k];
			to[k] = to[k - 1];
			to[k - 1] = other;
		}
}

typedef struct linking {
	fine *n;
	uint32_t (*few)[FEW]; /* the links of a site, if it has no more than that; without `to` they are found */
} linking;

static void link_sites(void *data, int first, int end, int thread)
{
	(void)thread;
	const linking *l = data;
	const fine *n = l->n;
	fingers f = {{0}};
	uint32_t own[ROOM];
	for (int i = first; i < end && !stopped_at(n, i); i++) {
		uint32_t count = n->to ? n->at[i + 1] - n->at[i] : 0, *to = n->to && count <= FEW ? l->few[i] : own;
		if (to == own)
			count = (uint32_t)links_of(n, &f, (uint32_t)i, own);
		if (!n->to) {
			n->at[i + 1] = count;
			memcpy(l->few[i], own, (count < FEW ? count : FEW) * sizeof *own);
			continue;
		}
		ascend(to, count);
		memcpy(n->to + n->at[i], to, count * sizeof *to);
	}
}

/* ---- evenness -------------------------------------------------------------------------------------------- */

typedef struct smooth {
	fine *n;
	float (*moved)[2];
} smooth;

/* Is a site where the fill of a level ends? There the line stays. */
static bool ends_fill(const site *s)
{
	return s->found.family == FAMILY_LIGHT_STEP || s->found.family == FAMILY_LIGHT;
}

/* Halves how far a site lies beside the line between its neighbours in the chain: what few samples a pixel have is not
 * even. */
static void find_even(void *data, int first, int end, int thread)
{
	(void)thread;
	const smooth *m = data;
	const fine *n = m->n;
	for (int i = first; i < end && !stopped_at(n, i); i++) {
		const site *s = n->site + i;
		m->moved[i][0] = s->placed.x;
		m->moved[i][1] = s->placed.y;
		if (s->linked.dropped || is_chain(s) || links_at(n, i) != 2 || ends_fill(s))
			continue;
		const site *a = n->site + n->to[n->at[i]], *b = n->site + n->to[n->at[i] + 1];
		float dx = b->placed.x - a->placed.x, dy = b->placed.y - a->placed.y, square = dx * dx + dy * dy;
		float off = ((s->placed.x - a->placed.x) * dy - (s->placed.y - a->placed.y) * dx) /
			    (square > 0.01f ? square : 0.01f);
		if (off * off * square > most_uneven * most_uneven)
			continue;
		m->moved[i][0] = s->placed.x - on_grid(0.5f * off * dy);
		m->moved[i][1] = s->placed.y + on_grid(0.5f * off * dx);
	}
}

static void move_even(void *data, int first, int end, int thread)
{
	(void)thread;
	const smooth *m = data;
	for (int i = first; i < end && !stopped_at(m->n, i); i++) {
		m->n->site[i].placed.x = m->moved[i][0];
		m->n->site[i].placed.y = m->moved[i][1];
	}
}

int32_t ISA(fine_smooth)(fine *n)
{
	smooth m = {n, late_take(&n->f->late, n->count, sizeof *m.moved)};
	if (!m.moved)
		return ENCRE_ERROR_MEMORY;
	int32_t code = ENCRE_OK;
	for (int i = 0; !code && i < EVEN_ROUNDS; i++) {
		code = bands_run(n->f->bands, (int)n->count, CHUNK, find_even, &m);
		if (!code)
			code = bands_run(n->f->bands, (int)n->count, CHUNK, move_even, &m);
	}
	late_drop(&n->f->late, m.moved);
	return code;
}

int32_t ISA(fine_add_links)(fine *n, uint32_t (*link)[2], uint32_t count)
{
	if (!count)
		return ENCRE_OK;
	uint32_t *at = late_take(&n->f->late, n->count + 1, sizeof *at),
		 *to = late_take(&n->f->late, n->at[n->known] + 2 * count, sizeof *to);
	if (!at || !to)
		return ENCRE_ERROR_MEMORY;
	memset(at, 0, (n->count + 1) * sizeof *at);
	int32_t code = ENCRE_OK;
	for (uint32_t i = 0; !code && i < n->known; i++) {
		code = at_step(n, i);
		at[i + 1] = n->at[i + 1] - n->at[i];
	}
	for (uint32_t i = 0; !code && i < 2 * count; i++) {
		code = at_step(n, i);
		at[link[i / 2][i % 2] + 1]++;
	}
	for (uint32_t i = 0; !code && i < n->count; i++) {
		code = at_step(n, i);
		at[i + 1] += at[i];
	}
	for (uint32_t i = 0; !code && i < n->known; i++) {
		code = at_step(n, i);
		memcpy(to + at[i], n->to + n->at[i], (n->at[i + 1] - n->at[i]) * sizeof *to);
	}
	/* from the back of each site's list, which still ends where the next begins */
	for (uint32_t i = 2 * count; !code && i-- > 0;) {
		uint32_t site = link[i / 2][i % 2];
		code = at_step(n, i);
		to[--at[site + 1]] = link[i / 2][1 - i % 2];
	}
	for (uint32_t i = 0; !code && i < 2 * count; i++) {
		code = at_step(n, i);
		at[link[i / 2][i % 2] + 1]++;
	}
	late_drop(&n->f->late, n->at);
	late_drop(&n->f->late, n->to);
	n->at = at;
	n->to = to;
	n->known = n->count;
	return code;
}

int32_t ISA(fine_unlink_dropped)(fine *n)
{
	uint32_t count = 0, from = 0;
	int32_t code = ENCRE_OK;
	for (uint32_t i = 0; !code && i < n->count; i++) {
		uint32_t end = n->at[i + 1];
		code = at_step(n, i);
		for (uint32_t k = from; k < end; k++)
			if (!n->site[i].linked.dropped && !n->site[n->to[k]].linked.dropped)
				n->to[count++] = n->to[k];
		n->at[i + 1] = count;
		from = end;
	}
	return code;
}

int32_t ISA(fine_link)(fine *n)
{
	linking l = {n, late_take(&n->f->late, n->count, sizeof *l.few)};
	n->known = n->count;
	n->at = late_take(&n->f->late, n->count + 1, sizeof *n->at);
	if (!l.few || !n->at)
		return ENCRE_ERROR_MEMORY;
	int32_t code = bands_run(n->f->bands, (int)n->count, CHUNK, link_sites, &l);
	if (code)
		return code;
	n->at[0] = 0;
	for (uint32_t i = 0; !code && i < n->count; i++) {
		code = at_step(n, i);
		n->at[i + 1] += n->at[i];
	}
	if (code)
		return code;
	n->to = late_take(&n->f->late, n->at[n->count], sizeof *n->to);
	if (!n->to)
		return ENCRE_ERROR_MEMORY;
	code = bands_run(n->f->bands, (int)n->count, CHUNK, link_sites, &l);
	for (uint32_t i = 0; !code && i < n->count; i++) { /* what it joined an earlier family has taken */
		code = at_step(n, i);
		n->site[i].linked.dropped |= n->site[i].found.axis == AXIS_JUNCTION && n->at[i] == n->at[i + 1];
	}
	late_drop(&n->f->late, l.few);
	return code;
}
