/* SPDX-License-Identifier: GPL-3.0-or-later */
/* How much of the light of a lamp with a size comes to what each pixel shows.
 *
 * Each pixel asks the few points that its place in a square of the full frame deals to it. Where these disagree, there
 * or nearby, it asks more, and where those disagree and a line or a corner parts the lamp, straight.c tells the share.
 * Else it asks many, each from another place in the 2 x 2 pixels about it. No two pixels of a tile ask the same points:
 * what would be bands is grain, which a mean of such neighbours on the same surface as have much the same share takes
 * away, and then the means of pairs on either side: far pairs where a penumbra is wide. Those leave slopes as they are.
 * Last, no pixel is left a little brighter, or darker, than all about it: cut into tones it would be a speck.
 *
 * Narrow penumbrae are the matter of narrow.c. */
#include "light/light.h"

#include <stdlib.h>

_Static_assert(LAMP_POINTS % PACK == 0 && LAMP_FIRST % PACK == 0, "no point is left over");

enum {
	ABOUT = 2,  /* pixels: about one for which a line or corner parts the lamp, */
	SELDOM = 3, /* there are at least so many of these for one for which none does */
	BESIDE = 1, /* pixels: so near to where its surface ends, points are counted */
	NEAR = 4,   /* pixels: how far disagreement reaches */
	TAPS = LAMP_TILE - 1,
	FARTHEST = 8,                /* pixels: to the places of a pair; then by halves */
	REACH = TAPS + 2 * FARTHEST, /* pixels: of the means and what levels them together */
};
_Static_assert(NEAR + NARROW_REACH + REACH + 2 <= LIGHT_MARGIN - 2,
	       "beyond the images surfaces are known in the margin only");

/* Of the light that is there: of a lamp that gives less, what the centres say is evened out and no more is
 * asked; of one that gives less than the other one, fewer points. By so much less whatever is left of grain counts, so
 * that many lamps together are as smooth as one, in not much more time. */
static const float small_part = 0.02f, lesser_part = 0.125f;
enum { LESSER_POINTS = LAMP_POINTS / 4 };

static const float thin_share = 0.008f; /* by so much a line's share differs by chance from those on either side */

/* Shares that differ by more are on two sides of an edge: of the places of a tile; of pairs, a pixel apart. */
static const float alike_dealt = 0.35f, alike_pairs = 0.04f;

/* Whether there is light and shadow near a square at all, on whatever surfaces. */
static bool mixed_about(const light *l, int x, int y)
{
	const int more = SHAFT_SIDE + NEAR;
	int any = 0;
	for (int v = y < NEAR ? 0 : y - NEAR; v < y + more && v < l->height; v++)
		for (int u = x < NEAR ? 0 : x - NEAR; u < x + more && u < l->width; u++)
			any |= l->state[(ptrdiff_t)v * l->width + u];
	return (any & MIXED) == MIXED;
}

/* Whether some of the light, but not all, comes to one surface near a pixel. */
static bool mixed_near(const light *l, int x, int y)
{
	ptrdiff_t i = (ptrdiff_t)y * l->width + x;
	int y0 = y < NEAR ? 0 : y - NEAR, y1 = y + NEAR < l->height ? y + NEAR : l->height - 1;
	int x0 = x < NEAR ? 0 : x - NEAR, x1 = x + NEAR < l->width ? x + NEAR : l->width - 1;
	int own = l->state[i] & MIXED;
	if (own == MIXED)
		return true;
	for (int v = y0; v <= y1; v++)
		for (int u = x0; u <= x1; u++) {
			ptrdiff_t j = (ptrdiff_t)v * l->width + u;
			if ((l->state[j] & ~own & MIXED) && one_surface(l->surfaces + i, l->surfaces + j))
				return true;
		}
	return false;
}

/* What a place shows between the centres of pixels i and j. Beyond a triangle its plane runs under the next one where
 * the surface is hollow, and what is not there would lie in its shadow: then it is what the centre of i shows. */
static surface place_within(const light *l, facets *known, ptrdiff_t i, ptrdiff_t j, float x, float y)
{
	bool inside;
	surface s = ISA(place_on)(l, known, l->surfaces + j, x, y, &inside);
	if (!inside && i != j)
		s = ISA(place_on)(l, known, l->surfaces + i, x, y, &inside);
	return inside ? s : l->surfaces[i];
}

/* Asks points of a pixel. Places are looked at from within the surface: beside where it ends from the pixel's own
 * column or row. */
static void ask_points(const light *l, int x, int y, float *all, float *seen, rays *from)
{
	const encre_frame *f = &l->job->frame;
	const lamp_point *points =
		l->points.of[(f->y + y - DEALT_FROM) & (LAMP_TILE - 1)][(f->x + x - DEALT_FROM) & (LAMP_TILE - 1)];
	bool columns[2] = {goes_on(l, x, y, x - 1, y), goes_on(l, x, y, x + 1, y)};
	bool rows[2] = {goes_on(l, x, y, x, y - 1), goes_on(l, x, y, x, y + 1)};
	asking ask;
	ask.count = 0;
	const int count = part_of(l, (ptrdiff_t)y * l->width + x) < lesser_part ? LESSER_POINTS : LAMP_POINTS;
	for (int k = 0; k < count; k++) {
		const lamp_point *q = points + k;
		float a = columns[q->place[0] > 0] ? q->place[0] : 0, b = rows[q->place[1] > 0] ? q->place[1] : 0;
		int u = x + (int)floorf(0.5f + a), v = y + (int)floorf(0.5f + b);
		ptrdiff_t i = (ptrdiff_t)y * l->width + x, j = (ptrdiff_t)v * l->width + u;
		surface s = l->surfaces[i];
		if (u == x || v == y || goes_on(l, x, y, u, v))
			s = place_within(l, &from->facets, i, j, (float)x + 0.5f + a, (float)y + 0.5f + b);
		ISA(ask_add)(&ask, &s, q, 0);
		if (ask.count == PACK)
			ask_sum(&ask, ISA(ask_all)(l, &ask, from->shaft), 0, PACK, all, seen);
	}
}

static bool asks_if(light *l, int x, int y, bool full)
{
	ptrdiff_t i = (ptrdiff_t)y * l->width + x;
	l->exact[i] = full ? 0 : -1;
	l->asked[i] = UNASKED;
	l->spare[i] = l->share[i];
	return full;
}

static bool asks_first(light *l, int x, int y)
{
	const ptrdiff_t i = (ptrdiff_t)y * l->width + x;
	const bool mixed = l->state[i] && mixed_near(l, x, y), full = mixed && part_of(l, i) >= small_part;
	asks_if(l, x, y, full);
	l->exact[i] = mixed ? 0 : -1;
	return full;
}

static bool asks_none(light *l, int x, int y)
{
	return asks_if(l, x, y, false);
}

/* From the pixel's centre, so that a line may part the points. */
static void ask_first(light *l, int x, int y, rays *from)
{
	const encre_frame *f = &l->job->frame;
	const lamp_point *points =
		l->points.of[(f->y + y - DEALT_FROM) & (LAMP_TILE - 1)][(f->x + x - DEALT_FROM) & (LAMP_TILE - 1)];
	const ptrdiff_t i = (ptrdiff_t)y * l->width + x;
	const surface *s = l->surfaces + i;
	float value[LAMP_FIRST], all = 0, seen = 0, share;
	uint32_t bits = 0;
	asking ask;
	ask.count = 0;
	for (int first = 0; first < LAMP_FIRST; first += PACK) {
		for (int k = 0; k < PACK; k++)
			ISA(ask_add)(&ask, s, points + first + k, 0);
		unsigned comes = ISA(ask_all)(l, &ask, from->shaft);
		bits |= comes << first;
		for (int k = 0; k < PACK; k++) {
			float before = all;
			ask_sum(&ask, comes, k, 1, &all, &seen);
			value[first + k] = all - before; /* as the sum has it */
		}
	}
	l->asked[i] = all > 0 ? seen / all : 0;
	if (!(seen > 0 && seen < all))
		return;
	bool parted = ISA(straight_share)(l, s, points, value, bits, from, &share);
	l->asked[i] = parted ? 2 * PARTED + min(max(share, 1e-3f), 1 - 1e-3f) : 2 * CROOKED + l->asked[i];
}

static void ask_rest(light *l, int x, int y, rays *from)
{
	ptrdiff_t i = (ptrdiff_t)y * l->width + x;
	float all = 0, seen = 0;
	ask_points(l, x, y, &all, &seen, from);
	int more = all > 0 ? 0 : LAMP_PLAIN; /* of its own none gives light */
	for (int k = 0; k < more; k++)
		ISA(ask_point)(l, l->surfaces + i, l->points.plain + k, &all, &seen, from);
	l->spare[i] += (1 - l->exact[i]) * (all > 0 ? seen / all : 0);
}

/* Asks for all pixels of a square of which a bit is set. */
static void ask_square(light *l, int x, int y, uint64_t left, void (*ask)(light *l, int x, int y, rays *from),
		       rays *from)
{
	while (left && !bands_stopped(l->bands)) {
		uint64_t group = ISA(ask_group)(l, x, y, left, 1, from->shaft);
		left &= ~group;
		for (; group && !bands_stopped(l->bands); group &= group - 1) {
			int k = __builtin_ctzll(group);
			ask(l, x + k % SHAFT_SIDE, y + k / SHAFT_SIDE, from);
		}
	}
}

static void first_rows(void *data, int y0, int y1, int thread)
{
	(void)thread;
	light *l = data;
	shaft s;
	rays from = RAYS(&s);
	for (int y = y0; y < y1; y += SHAFT_SIDE)
		for (int x = 0; x < l->width; x += SHAFT_SIDE)
			ask_square(l, x, y, square_of(l, x, y, y1, mixed_about(l, x, y) ? asks_first : asks_none),
				   ask_first, &from);
}

/* Whether the first points of a pixel and of those about it, as far as these were asked, see the same; *sharp: whether
 * there are pixels about of which all see light, and such of which none does. */
static bool agree(const light *l, int x, int y, bool *sharp)
{
	bool lit = false, dark = false, all = false, none = false;
	for (int v = y ? y - 1 : 0; v <= y + 1 && v < l->height; v++)
		for (int u = x ? x - 1 : 0; u <= x + 1 && u < l->width; u++) {
			float asked = l->asked[(ptrdiff_t)v * l->width + u];
			if (asked == UNASKED)
				continue;
			lit |= asked > 0;
			dark |= asked != 1;
			none |= asked == 0;
			all |= asked == 1;
		}
	*sharp = all && none;
	return !(lit && dark);
}

static float asked_share(const light *l, int x, int y)
{
	if (x < 0 || y < 0 || x >= l->width || y >= l->height)
		return UNASKED;
	float asked = l->asked[(ptrdiff_t)y * l->width + x];
	bool known = asked != UNASKED && asked_kind(asked) != CROOKED; /* points alone may be that far off */
	return known ? asked - (float)(2 * asked_kind(asked)) : UNASKED;
}

/* Whether a pixel is darker than two on either side of it, or brighter: what is thinner than a pixel is missed, or
 * fills it, by a centre. */
static bool stands_out(const light *l, int x, int y)
{
	const float own = asked_share(l, x, y);
	for (int k = 0; k < 4; k++) {
		int u = k == 1 ? 0 : k == 3 ? -1 : 1, v = k > 0;
		float a = asked_share(l, x + u, y + v), b = asked_share(l, x - u, y - v);
		if (a != UNASKED && b != UNASKED && (min(a, b) - own > thin_share || own - max(a, b) > thin_share))
			return true;
	}
	return false;
}

/* Whether one line parts the lamp for a pixel well within its surface, and for nearly all about it: few points may miss
 * a bar. */
static bool parted_about(const light *l, int x, int y)
{
	ptrdiff_t i = (ptrdiff_t)y * l->width + x;
	if (asked_kind(l->asked[i]) != PARTED)
		return false;
	int crooked = 0, parted = 0;
	for (int v = y < ABOUT ? 0 : y - ABOUT; v <= y + ABOUT && v < l->height; v++)
		for (int u = x < ABOUT ? 0 : x - ABOUT; u <= x + ABOUT && u < l->width; u++) {
			ptrdiff_t j = (ptrdiff_t)v * l->width + u;
			if (!one_surface(l->surfaces + i, l->surfaces + j)) {
				if (abs(u - x) <= BESIDE && abs(v - y) <= BESIDE)
					return false;
				continue;
			}
			if (l->asked[j] < 2)
				continue;
			crooked += asked_kind(l->asked[j]) == CROOKED;
			parted += asked_kind(l->asked[j]) == PARTED;
		}
	return SELDOM * crooked <= parted;
}

/* Into `spare`, beside what narrow.c knows, where points were asked. */
static bool asks_rest(light *l, int x, int y)
{
	ptrdiff_t i = (ptrdiff_t)y * l->width + x;
	float *exact = l->exact + i, *to = l->spare + i;
	if (*exact < 0 || l->asked[i] == UNASKED)
		return false;
	bool thin = *to == narrow_thin, sharp;
	*to *= *exact;
	if (*exact >= 1)
		return false;
	bool same = agree(l, x, y, &sharp);
	if (!same && (thin || (sharp && !(*exact > 0)) || !parted_about(l, x, y) || stands_out(l, x, y))) {
		if (asked_kind(l->asked[i]) == CROOKED) /* half of the light is not where the lamp's middle goes */
			*to = *exact = 0;
		return true;
	}
	*to = same ? *to + (1 - *exact) * (l->asked[i] > 0) : l->asked[i] - 2 * PARTED;
	*exact = same ? *exact : by_line;
	return false;
}

static void rest_rows(void *data, int y0, int y1, int thread)
{
	(void)thread;
	light *l = data;
	shaft s;
	rays from = RAYS(&s);
	for (int y = y0; y < y1; y += SHAFT_SIDE)
		for (int x = 0; x < l->width; x += SHAFT_SIDE)
			ask_square(l, x, y, square_of(l, x, y, y1, asks_rest), ask_rest, &from);
}

/* ---- means ------------------------------------------------------------------------------------------------- */

typedef struct smoothing {
	light *light;
	const float *from;
	float *to;
	int step;    /* pixels to the places of a pair */
	float alike; /* shares that differ by more are on two sides of an edge */
} smoothing;

/* Whether the share of a place says something of that of pixel i: it lies on its surface, and is not known exactly. */
static bool takes_part(const light *l, ptrdiff_t i, int u, int v)
{
	ptrdiff_t j = (ptrdiff_t)v * l->width + u;
	return u >= 0 && v >= 0 && u < l->width && v < l->height && l->state[j] &&
	       !(l->exact[j] > 0 && l->exact[j] <= 1) && (j == i || one_surface(l->surfaces + i, l->surfaces + j));
}

/* The mean of a neighbourhood in which the places of a square weigh the same, less the share itself. */
static float dealt_mean(const smoothing *m, int x, int y)
{
	ptrdiff_t i = (ptrdiff_t)y * m->light->width + x;
	float sum = 0, weights = 0;
	for (int b = -TAPS; b <= TAPS; b++)
		for (int a = -TAPS; a <= TAPS; a++) {
			if (!takes_part(m->light, i, x + a, y + b))
				continue;
			float difference = m->from[i + (ptrdiff_t)b * m->light->width + a] - m->from[i];
			float weight = (float)((LAMP_TILE - abs(a)) * (LAMP_TILE - abs(b))) *
				       clamp01(2 - 2 * fabsf(difference) / m->alike);
			sum += weight * difference;
			weights += weight;
		}
	return weights > 0 ? sum / weights : 0;
}

static void dealt_rows(void *data, int y0, int y1, int thread)
{
	(void)thread;
	const smoothing *m = data;
	for (int y = y0; y < y1 && !bands_stopped(m->light->bands); y++)
		for (int x = 0; x < m->light->width; x++) {
			ptrdiff_t i = (ptrdiff_t)y * m->light->width + x;
			float exact = m->light->exact[i];
			m->to[i] = m->from[i];
			if (exact >= 0 && exact < 1)
				m->to[i] = clamp01(m->from[i] + (1 - exact) * dealt_mean(m, x, y));
		}
}

/* By how much the mean of two places on either side differs, where both take part. */
static void pair_up(const smoothing *m, int x, int y, int a, int b, float weight, float *sum, float *weights)
{
	ptrdiff_t i = (ptrdiff_t)y * m->light->width + x, j = (ptrdiff_t)b * m->step * m->light->width + a * m->step;
	if (!takes_part(m->light, i, x + a * m->step, y + b * m->step) ||
	    !takes_part(m->light, i, x - a * m->step, y - b * m->step))
		return;
	float off = 0.5f * (m->from[i + j] + m->from[i - j]) - m->from[i];
	float even = max(1 - off * off / (m->alike * m->alike), 0);
	weight *= even * even;
	*sum += weight * off;
	*weights += weight;
}

static void pair_rows(void *data, int y0, int y1, int thread)
{
	(void)thread;
	const smoothing *m = data;
	for (int y = y0; y < y1 && !bands_stopped(m->light->bands); y++)
		for (int x = 0; x < m->light->width; x++) {
			ptrdiff_t i = (ptrdiff_t)y * m->light->width + x;
			float exact = m->light->exact[i], sum = 0, weights = 2;
			m->to[i] = m->from[i];
			if (exact == by_line && m->step == 1) /* chords leave a little chance, too */
				exact = 0;
			if (exact < 0 || exact >= 1)
				continue;
			pair_up(m, x, y, 1, 0, 2, &sum, &weights);
			pair_up(m, x, y, 0, 1, 2, &sum, &weights);
			pair_up(m, x, y, 1, 1, 1, &sum, &weights);
			pair_up(m, x, y, -1, 1, 1, &sum, &weights);
			m->to[i] = clamp01(m->from[i] + (1 - exact) * sum / weights);
		}
}

static void level_rows(void *data, int y0, int y1, int thread)
{
	(void)thread;
	const smoothing *m = data;
	for (int y = y0; y < y1 && !bands_stopped(m->light->bands); y++)
		for (int x = 0; x < m->light->width; x++) {
			ptrdiff_t i = (ptrdiff_t)y * m->light->width + x;
			float exact = m->light->exact[i];
			m->to[i] = m->from[i];
			if (exact >= 0 && exact != 1)
				m->to[i] += (exact < 1 ? 1 - exact : 1) * ISA(lone_grain)(m->light, m->from, x, y);
		}
}

int32_t ISA(soft_run)(light *l)
{
	int32_t code = bands_run(l->bands, l->height, 0, first_rows, l);
	if (!code)
		code = ISA(narrow_run)(l);
	if (!code)
		code = bands_run(l->bands, l->height, 0, rest_rows, l);
	smoothing m = {l, l->spare, l->share, 1, alike_dealt};
	if (!code)
		code = bands_run(l->bands, l->height, 0, dealt_rows, &m);
	for (int step = FARTHEST; !code && step > 0; step /= 2) {
		bool odd = m.to == l->share;
		m = (smoothing){l, m.to, odd ? l->spare : l->share, step, alike_pairs / (float)step};
		code = bands_run(l->bands, l->height, 0, pair_rows, &m);
	}
	for (int k = 0; !code && k < 2; k++) { /* what stood beside a speck may be one then */
		m = (smoothing){.light = l, .from = k ? l->spare : l->share, .to = k ? l->share : l->spare};
		code = bands_run(l->bands, l->height, 0, level_rows, &m);
	}
	return code;
}
