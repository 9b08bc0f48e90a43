/* SPDX-License-Identifier: GPL-3.0-or-later */
/* How much of the light of a lamp with a size comes to what each pixel shows.
 *
 * Each pixel asks the few points that its place in a square of the full frame deals to it. Where these disagree, there
 * or nearby, it asks many, each from another place in the 2 x 2 pixels about it. No two pixels of a tile ask the same
 * points: what would be bands is grain, which a mean of such neighbours on the same surface as have much the same share
 * takes away, and then the means of pairs on either side: far pairs where a penumbra is wide. Those leave slopes as
 * they are.
 *
 * Half of the light comes where the lamp's middle goes behind what throws the shadow. Where a penumbra is at most a few
 * pixels wide that edge is found as for a lamp without a size, and its ramp is as wide as the penumbra. */
#include "light/light.h"

#include <stdlib.h>

enum {
	NEAR = 4, /* pixels: how far disagreement reaches */
	TAPS = LAMP_TILE - 1,
	FARTHEST = 8,                    /* pixels: to the places of a pair; then by halves */
	REACH = TAPS + 2 * FARTHEST - 1, /* pixels: of the means together */
	BESIDE = 2,                      /* pixels: likewise, of an edge */
	SHARP = 2,
	SOFT = 4 /* pixels: a penumbra of less is an edge with a ramp, one of more is asked for point by point */
};
_Static_assert(NEAR + BESIDE + REACH + 1 <= LIGHT_MARGIN - 2,
	       "beyond the images surfaces are known in the margin only");

/* Shares that differ by more are on two sides of an edge: of the places of a tile; of pairs, a pixel apart. */
static const float alike_dealt = 0.35f, alike_pairs = 0.04f;

/* Whether some of the light, but not all, comes to one surface near a pixel. */
static bool mixed_near(const light *l, int x, int y)
{
	ptrdiff_t i = (ptrdiff_t)y * l->width + x;
	int y0 = y < NEAR ? 0 : y - NEAR, y1 = y + NEAR < l->height ? y + NEAR : l->height - 1;
	int x0 = x < NEAR ? 0 : x - NEAR, x1 = x + NEAR < l->width ? x + NEAR : l->width - 1;
	int any = 0, own = l->state[i] & MIXED;
	for (int v = y0; v <= y1; v++)
		for (int u = x0; u <= x1; u++)
			any |= l->state[(ptrdiff_t)v * l->width + u];
	if ((any & MIXED) != MIXED || own == MIXED)
		return own == MIXED;
	for (int v = y0; v <= y1; v++)
		for (int u = x0; u <= x1; u++) {
			ptrdiff_t j = (ptrdiff_t)v * l->width + u;
			if ((l->state[j] & ~own & MIXED) && one_surface(l->surfaces + i, l->surfaces + j))
				return true;
		}
	return false;
}

static bool goes_on(const light *l, int x, int y, int u, int v)
{
	ptrdiff_t i = (ptrdiff_t)y * l->width + x, j = (ptrdiff_t)v * l->width + u;
	return u >= 0 && v >= 0 && u < l->width && v < l->height && l->state[j] &&
	       one_surface(l->surfaces + i, l->surfaces + j);
}

/* What a place shows between the centres of pixels i and j. Beyond a triangle its plane runs under the next one where
 * the surface is hollow, and what is not there would lie in its shadow: then it is what the centre of i shows. */
static surface place_within(const light *l, ptrdiff_t i, ptrdiff_t j, float x, float y)
{
	bool inside;
	surface s = ISA(place_on)(l, l->surfaces + j, x, y, &inside);
	if (!inside && i != j)
		s = ISA(place_on)(l, l->surfaces + i, x, y, &inside);
	return inside ? s : l->surfaces[i];
}

/* Places are looked at from within the surface: beside where it ends from the pixel's own column or row. */
static float full_share(const light *l, int x, int y, hint *h)
{
	const encre_frame *f = &l->job->frame;
	const lamp_point *points = l->points.of[(f->y + y) & (LAMP_TILE - 1)][(f->x + x) & (LAMP_TILE - 1)];
	bool columns[2] = {goes_on(l, x, y, x - 1, y), goes_on(l, x, y, x + 1, y)};
	bool rows[2] = {goes_on(l, x, y, x, y - 1), goes_on(l, x, y, x, y + 1)};
	float all = 0, seen = 0;
	for (int k = 0; k < LAMP_POINTS; k++) {
		const lamp_point *q = points + k;
		float a = columns[q->place[0] > 0] ? q->place[0] : 0, b = rows[q->place[1] > 0] ? q->place[1] : 0;
		int u = x + (int)floorf(0.5f + a), v = y + (int)floorf(0.5f + b);
		ptrdiff_t i = (ptrdiff_t)y * l->width + x, j = (ptrdiff_t)v * l->width + u;
		surface s = l->surfaces[i];
		if (u == x || v == y || goes_on(l, x, y, u, v))
			s = place_within(l, i, j, (float)x + 0.5f + a, (float)y + 0.5f + b);
		ISA(shadow_ask)(l, &s, q, &all, &seen, h);
	}
	int more = all > 0 ? 0 : LAMP_PLAIN; /* of its own none gives light */
	for (int k = 0; k < more; k++)
		ISA(shadow_ask)(l, l->surfaces + (ptrdiff_t)y * l->width + x, l->points.plain + k, &all, &seen, h);
	return all > 0 ? seen / all : 0;
}

/* Into `spare`: others read what the centres found. */
static void full_rows(void *data, int y0, int y1, int thread)
{
	(void)thread;
	light *l = data;
	hint h = HINT_NONE;
	for (int y = y0; y < y1; y++)
		for (int x = 0; x < l->width; x++) {
			ptrdiff_t i = (ptrdiff_t)y * l->width + x;
			bool full = l->state[i] && mixed_near(l, x, y);
			l->spare[i] = full ? full_share(l, x, y, &h) : l->share[i];
			l->exact[i] = full ? 0 : -1;
		}
}

/* ---- penumbrae of a few pixels ----------------------------------------------------------------------------- */

/* Whether light comes from the lamp's middle. */
static void core_rows(void *data, int y0, int y1, int thread)
{
	(void)thread;
	light *l = data;
	hint h = HINT_NONE;
	for (ptrdiff_t i = (ptrdiff_t)y0 * l->width; i < (ptrdiff_t)y1 * l->width; i++) {
		float all = 0, seen = 0;
		if (l->exact[i] < 0)
			continue;
		ISA(shadow_ask)(l, l->surfaces + i, &l->points.middle, &all, &seen, &h);
		if (all > 0)
			l->state[i] |= (uint8_t)((seen > 0 ? LIT : DARK) << CORE_SHIFT);
	}
}

/* By how many pixels the shadow of a place moves across an edge when the light comes from a lamp's rim and not from its
 * middle. */
static float moves(const light *l, const surface *s, vec place, const lamp_point *rim, const edge_line *e)
{
	vec way;
	float far;
	lamp_light(&l->lamp, s->at, s->normal, rim, &way, &far);
	vec off = minus(place, s->at), from = far < lamp_far ? minus(way, off) : way;
	float slope = dot(from, s->across);
	vec to = minus(off, times(from, dot(off, s->across) / (fabsf(slope) < 1e-12f ? 1e-12f : slope)));
	double a[2], b[2];
	ISA(place_pixel)(l, s->at, a);
	ISA(place_pixel)(l, plus(s->at, to), b);
	return (float)(b[0] - a[0]) * e->x + (float)(b[1] - a[1]) * e->y;
}

/* Whether light falls from all of the lamp: else half of what falls is not where its middle goes. */
static bool faces(const light *l, const surface *s)
{
	bool all = true;
	for (int k = 0; k < LAMP_RIM; k++) {
		vec way;
		float far;
		all &= lamp_light(&l->lamp, s->at, s->normal, l->points.rim + k, &way, &far) > 0;
	}
	return all;
}

/* How many pixels wide the penumbra is that an edge has, by what throws it; SOFT if more, or if it can't be told. */
static float width_of(const light *l, int x, int y, const edge_line *e)
{
	ptrdiff_t i = (ptrdiff_t)y * l->width + x;
	bool across = fabsf(e->a) <= fabsf(e->b), inside;
	/* a little to the dark side: what is in the way there ends here */
	float far = across ? e->a : e->b, more = (core_at(l, i) == LIT) == (far > 0) ? 0.03f : -0.03f;
	float u = (float)x + 0.5f + (across ? far + more : 0), v = (float)y + 0.5f + (across ? 0 : far + more);
	surface s = ISA(place_on)(l, l->surfaces + i, u, v, &inside);
	if (!inside) {
		ptrdiff_t side = across ? 1 : l->width;
		s = ISA(place_on)(l, l->surfaces + (far > 0 ? i + side : i - side), u, v, &inside);
	}
	vec place;
	if (!inside || !faces(l, &s) || !ISA(shadow_thrower)(l, &s, &place))
		return SOFT;
	float a = moves(l, &s, place, l->points.rim, e), b = moves(l, &s, place, l->points.rim + 1, e);
	float half = l->lamp.type == ENCRE_RECTANGLE ? fabsf(a) + fabsf(b) : sqrtf(a * a + b * b);
	return 2 * half < SOFT ? 2 * half : SOFT;
}

/* Into `share`, which is free meanwhile: widths, negative where no edge passes. */
static void width_rows(void *data, int y0, int y1, int thread)
{
	(void)thread;
	light *l = data;
	edge_line e;
	for (int y = y0; y < y1; y++)
		for (int x = 0; x < l->width; x++)
			l->share[(ptrdiff_t)y * l->width + x] = ISA(edge_at)(l, x, y, &e) ? width_of(l, x, y, &e) : -1;
}

/* The pixel nearest to one, on its surface, beside which an edge passes; negative: none. */
static ptrdiff_t edge_near(const light *l, int x, int y, int *column, int *row)
{
	ptrdiff_t i = (ptrdiff_t)y * l->width + x, found = -1;
	int nearest = 2 * BESIDE * BESIDE + 1;
	for (int v = y - BESIDE; v <= y + BESIDE; v++)
		for (int u = x - BESIDE; u <= x + BESIDE; u++) {
			int far = (u - x) * (u - x) + (v - y) * (v - y);
			ptrdiff_t j = (ptrdiff_t)v * l->width + u;
			if (far >= nearest || u < 0 || v < 0 || u >= l->width || v >= l->height || l->share[j] < 0 ||
			    (j != i && !one_surface(l->surfaces + i, l->surfaces + j)))
				continue;
			nearest = far;
			found = j;
			*column = u;
			*row = v;
		}
	return found;
}

static void narrow_rows(void *data, int y0, int y1, int thread)
{
	(void)thread;
	light *l = data;
	edge_line e;
	int u = 0, v = 0;
	for (int y = y0; y < y1; y++)
		for (int x = 0; x < l->width; x++) {
			ptrdiff_t i = (ptrdiff_t)y * l->width + x, j;
			int own = core_at(l, i);
			if (l->exact[i] < 0 || !own || (j = edge_near(l, x, y, &u, &v)) < 0)
				continue;
			ISA(edge_at)(l, u, v, &e);
			float away = e.x * (float)(x - u) + e.y * (float)(y - v) - e.far, width = max(l->share[j], 2);
			float lit = (core_at(l, j) == LIT) == (e.far < 0) ? away : -away;
			float ramp = clamp01(0.5f + lit / width);
			/* another edge may lie between the two */
			ramp = own == LIT ? max(ramp, 0.5f) : min(ramp, 0.5f);
			l->exact[i] = clamp01((SOFT - width) / (SOFT - SHARP));
			l->spare[i] += l->exact[i] * (ramp - l->spare[i]);
		}
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
	return u >= 0 && v >= 0 && u < l->width && v < l->height && l->state[j] && !(l->exact[j] > 0) &&
	       (j == i || one_surface(l->surfaces + i, l->surfaces + j));
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
	for (int y = y0; y < y1; y++)
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
	for (int y = y0; y < y1; y++)
		for (int x = 0; x < m->light->width; x++) {
			ptrdiff_t i = (ptrdiff_t)y * m->light->width + x;
			float exact = m->light->exact[i], sum = 0, weights = 2;
			m->to[i] = m->from[i];
			if (exact < 0 || exact >= 1)
				continue;
			pair_up(m, x, y, 1, 0, 2, &sum, &weights);
			pair_up(m, x, y, 0, 1, 2, &sum, &weights);
			pair_up(m, x, y, 1, 1, 1, &sum, &weights);
			pair_up(m, x, y, -1, 1, 1, &sum, &weights);
			m->to[i] = clamp01(m->from[i] + (1 - exact) * sum / weights);
		}
}

int32_t ISA(soft_run)(light *l)
{
	const bands_kernel first[] = {full_rows, core_rows, ISA(edge_rows), width_rows, narrow_rows};
	int32_t code = ENCRE_OK;
	for (int k = 0; !code && k < 5; k++)
		code = bands_run(l->bands, l->height, 0, first[k], l);
	smoothing m = {l, l->spare, l->share, 1, alike_dealt};
	if (!code)
		code = bands_run(l->bands, l->height, 0, dealt_rows, &m);
	for (int step = FARTHEST; !code && step > 0; step /= 2) {
		bool odd = m.to == l->share;
		m = (smoothing){l, m.to, odd ? l->spare : l->share, step, alike_pairs / (float)step};
		code = bands_run(l->bands, l->height, 0, pair_rows, &m);
	}
	return code;
}
