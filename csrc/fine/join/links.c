/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Links between sites: cracks join the two that cut a square of four pixel centres, ridges what is close. */
#include "fine/fine.h"

#include <stdlib.h>
#include <string.h>

enum { CHUNK = 2048, ROOM = 64, FEW = 4, EVEN_ROUNDS = 2 };

static const float link_reach = 1.6f; /* pixels */
static const float most_uneven = 0.3f;

/* ---- who is linked --------------------------------------------------------------------------------------- */

/* Number of the crack found at a pixel, or n->count. */
static uint32_t find(const fine *n, int family, int x, int y, int axis)
{
	uint8_t mark = (uint8_t)(right_of((enum family)family) << axis);
	if (axis != AXIS_JUNCTION && !(n->crack[(ptrdiff_t)y * n->f->width + x] & mark))
		return n->count;
	const uint32_t *first = n->first + family * n->f->height + y;
	uint32_t low = first[0], high = first[1];
	while (low < high) {
		uint32_t middle = low + (high - low) / 2;
		const site *s = n->site + middle;
		if (s->column < x || (s->column == x && s->axis < axis))
			low = middle + 1;
		else
			high = middle;
	}
	const site *s = n->site + low;
	return low < first[1] && s->column == x && s->axis == axis && !s->dropped ? low : n->count;
}

/* Cracks on the sides of the square of pixel centres from (x, y). */
static int sides(const fine *n, int family, int x, int y, uint32_t *side)
{
	int found = 0;
	if (x < 0 || y < 0 || x + 1 >= n->f->width || y + 1 >= n->f->height)
		return 0;
	const uint32_t all[4] = {find(n, family, x, y, AXIS_ROW), find(n, family, x, y + 1, AXIS_ROW),
				 find(n, family, x, y, AXIS_COLUMN), find(n, family, x + 1, y, AXIS_COLUMN)};
	for (int i = 0; i < 4; i++)
		if (all[i] < n->count)
			side[found++] = all[i];
	return found;
}

static int crack_links(const fine *n, uint32_t i, uint32_t *to)
{
	const site *s = n->site + i;
	uint32_t side[4];
	int found = 0;
	if (s->axis == AXIS_JUNCTION)
		return (found = sides(n, s->family, s->column, s->row, to)) > 2 ? found : 0;
	for (int k = 0; k < 2; k++) { /* the squares on both sides of the pair */
		int x = s->column - (s->axis == AXIS_COLUMN && k), y = s->row - (s->axis == AXIS_ROW && k);
		int count = sides(n, s->family, x, y, side);
		if (count == 2)
			to[found++] = side[0] == i ? side[1] : side[0];
		else if (count > 2 && (to[found] = find(n, s->family, x, y, AXIS_JUNCTION)) < n->count)
			found++;
	}
	return found;
}

/* Ridges are linked that are close and go the same way: where a face thins out its two edges come close, and don't. */
static bool close(const site *a, const site *b)
{
	if (a->axis == b->axis && a->step[0] * b->step[0] + a->step[1] * b->step[1] + a->step[2] * b->step[2] < 0)
		return false;
	return a->family == b->family && !b->dropped && apart2(a, b) <= link_reach * link_reach;
}

static int close_sites(const fine *n, uint32_t i, uint32_t *to)
{
	const site *s = n->site + i;
	near_sites of = near_place(n, s->x, s->y, link_reach);
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
	int count = close_sites(n, i, all), found = 0;
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

static int links_of(const fine *n, uint32_t i, uint32_t *to)
{
	const site *s = n->site + i;
	return s->dropped ? 0 : is_crack((enum family)s->family) ? crack_links(n, i, to) : ridge_links(n, i, to);
}

/* ---- crumbs ---------------------------------------------------------------------------------------------- */

typedef struct turn {
	fine *n;
	uint32_t first;
} turn;

/* Fewer sites than this that hang together are no line. */
static int crumb_of(const site *s)
{
	return s->family == FAMILY_SEEN_DEPTH ? 9 : s->family >= FAMILY_SEEN ? 4 : is_band(s->family) ? 4 : 3;
}

static bool crumb(const fine *n, uint32_t i)
{
	uint32_t found[ROOM] = {i}, to[ROOM];
	int count = 1, wanted = crumb_of(n->site + i);
	for (int k = 0; k < count && count < wanted; k++) {
		int near = close_sites(n, found[k], to);
		for (int j = 0; j < near && count < wanted; j++) {
			bool known = false;
			for (int l = 0; l < count; l++)
				known |= found[l] == to[j];
			if (!known)
				found[count++] = to[j];
		}
	}
	return count < wanted;
}

static void find_crumbs(void *data, int first, int end, int thread)
{
	(void)thread;
	const turn *t = data;
	for (int k = first; k < end; k++) {
		uint32_t i = t->first + (uint32_t)k;
		site *s = t->n->site + i;
		s->crumb = !s->dropped && crumb(t->n, i);
	}
}

static void drop_crumbs(void *data, int first, int end, int thread)
{
	(void)thread;
	const turn *t = data;
	for (int k = first; k < end; k++) {
		site *s = t->n->site + t->first + k;
		s->dropped |= s->crumb;
	}
}

int32_t ISA(fine_drop_crumbs)(fine *n, enum family family)
{
	turn t = {n, n->first[family * n->f->height]};
	int count = (int)(n->first[(family + 1) * n->f->height] - t.first);
	if (family <= FAMILY_MARK)
		return ENCRE_OK;
	int32_t code = bands_run(n->f->bands, count, CHUNK, find_crumbs, &t);
	return code ? code : bands_run(n->f->bands, count, CHUNK, drop_crumbs, &t);
}

/* ---- weak sites ------------------------------------------------------------------------------------------ */

int32_t ISA(fine_drop_weak)(fine *n, enum family family)
{
	uint32_t first = n->first[family * n->f->height], end = n->first[(family + 1) * n->f->height], count = 0;
	uint32_t to[ROOM],
		*open = family == FAMILY_COLOR_BAND ? late_take(&n->f->late, end - first, sizeof *open) : NULL;
	if (family != FAMILY_COLOR_BAND)
		return ENCRE_OK;
	if (!open)
		return ENCRE_ERROR_MEMORY;
	for (uint32_t i = first; i < end; i++)
		if (!n->site[i].dropped && !n->site[i].weak)
			open[count++] = i;
	while (count > 0)
		for (int k = close_sites(n, open[--count], to); k-- > 0;)
			if (n->site[to[k]].weak) {
				n->site[to[k]].weak = 0;
				open[count++] = to[k];
			}
	for (uint32_t i = first; i < end; i++)
		n->site[i].dropped |= n->site[i].weak;
	late_drop(&n->f->late, open);
	return ENCRE_OK;
}

/* ---- all links ------------------------------------------------------------------------------------------- */

static int ascending(const void *a, const void *b)
{
	uint32_t x = *(const uint32_t *)a, y = *(const uint32_t *)b;
	return (x > y) - (x < y);
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
	uint32_t own[ROOM];
	for (int i = first; i < end; i++) {
		uint32_t count = n->to ? n->at[i + 1] - n->at[i] : 0, *to = n->to && count <= FEW ? l->few[i] : own;
		if (to == own)
			count = (uint32_t)links_of(n, (uint32_t)i, own);
		if (!n->to) {
			n->at[i + 1] = count;
			memcpy(l->few[i], own, (count < FEW ? count : FEW) * sizeof *own);
			continue;
		}
		qsort(to, count, sizeof *to, ascending);
		memcpy(n->to + n->at[i], to, count * sizeof *to);
	}
}

/* ---- evenness -------------------------------------------------------------------------------------------- */

typedef struct smooth {
	fine *n;
	float (*moved)[2];
} smooth;

/* Halves how far a site lies beside the line between its neighbours in the chain: what few samples a pixel have is not
 * even. */
static void find_even(void *data, int first, int end, int thread)
{
	(void)thread;
	const smooth *m = data;
	const fine *n = m->n;
	for (int i = first; i < end; i++) {
		const site *s = n->site + i;
		m->moved[i][0] = s->x;
		m->moved[i][1] = s->y;
		if (s->dropped || n->at[i + 1] - n->at[i] != 2)
			continue;
		const site *a = n->site + n->to[n->at[i]], *b = n->site + n->to[n->at[i] + 1];
		float dx = b->x - a->x, dy = b->y - a->y, square = dx * dx + dy * dy;
		float off = ((s->x - a->x) * dy - (s->y - a->y) * dx) / (square > 0.01f ? square : 0.01f);
		if (off * off * square > most_uneven * most_uneven)
			continue;
		m->moved[i][0] = s->x - 0.5f * off * dy;
		m->moved[i][1] = s->y + 0.5f * off * dx;
	}
}

static void move_even(void *data, int first, int end, int thread)
{
	(void)thread;
	const smooth *m = data;
	for (int i = first; i < end; i++) {
		m->n->site[i].x = m->moved[i][0];
		m->n->site[i].y = m->moved[i][1];
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
	return code ? code : ISA(fine_sort)(n);
}

int32_t ISA(fine_add_links)(fine *n, uint32_t (*link)[2], uint32_t count)
{
	uint32_t *at = late_take(&n->f->late, n->count + 1, sizeof *at),
		 *to = late_take(&n->f->late, n->at[n->linked] + 2 * count, sizeof *to);
	if (!at || !to)
		return ENCRE_ERROR_MEMORY;
	memset(at, 0, (n->count + 1) * sizeof *at);
	for (uint32_t i = 0; i < n->linked; i++)
		at[i + 1] = n->at[i + 1] - n->at[i];
	for (uint32_t i = 0; i < 2 * count; i++)
		at[link[i / 2][i % 2] + 1]++;
	for (uint32_t i = 0; i < n->count; i++)
		at[i + 1] += at[i];
	for (uint32_t i = 0; i < n->linked; i++)
		memcpy(to + at[i], n->to + n->at[i], (n->at[i + 1] - n->at[i]) * sizeof *to);
	for (uint32_t i = 2 * count;
	     i-- > 0;) { /* from the back of each site's list, which still ends where the next begins */
		uint32_t site = link[i / 2][i % 2];
		to[--at[site + 1]] = link[i / 2][1 - i % 2];
	}
	for (uint32_t i = 0; i < 2 * count; i++)
		at[link[i / 2][i % 2] + 1]++;
	late_drop(&n->f->late, n->at);
	late_drop(&n->f->late, n->to);
	n->at = at;
	n->to = to;
	n->linked = n->count;
	return ENCRE_OK;
}

int32_t ISA(fine_link)(fine *n)
{
	linking l = {n, late_take(&n->f->late, n->count, sizeof *l.few)};
	n->linked = n->count;
	n->at = late_take(&n->f->late, n->count + 1, sizeof *n->at);
	if (!l.few || !n->at)
		return ENCRE_ERROR_MEMORY;
	int32_t code = bands_run(n->f->bands, (int)n->count, CHUNK, link_sites, &l);
	if (code)
		return code;
	n->at[0] = 0;
	for (uint32_t i = 0; i < n->count; i++)
		n->at[i + 1] += n->at[i];
	n->to = late_take(&n->f->late, n->at[n->count], sizeof *n->to);
	if (!n->to)
		return ENCRE_ERROR_MEMORY;
	code = bands_run(n->f->bands, (int)n->count, CHUNK, link_sites, &l);
	for (uint32_t i = 0; i < n->count; i++) /* what it joined an earlier family has taken */
		n->site[i].dropped |= n->site[i].axis == AXIS_JUNCTION && n->at[i] == n->at[i + 1];
	late_drop(&n->f->late, l.few);
	return code;
}
