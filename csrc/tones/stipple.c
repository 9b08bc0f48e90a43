/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Spots: which points of an endless set (blue.c) lie in a pixel, by the chart of its surface. How many are wanted, to a
 * pixel, tells the darkness; how many that is to the unit of the chart, how the surface is seen. A point is there from
 * the density on at which it is born, and grows from nothing with it: so what comes nearer or gets darker only gets
 * more spots, and all stay where they are on the thing. */
#include "tones/points.h"
#include "tones/strokes.h"

#include <string.h>

static const float grown_within = 0.8f; /* by so much of its own density the wanted one is above it */
static const float uneven = 0.12f;      /* of a radius */

enum { STEPS = 32 };

/* The area of spots to the area they lie in, were none on another, whose ink is 0, 1/32, .. 1: for a radius of 1.25
 * pixels, where soft edges cover each other, and of 5; measured. */
static const float area_for[2][STEPS + 1] = {
	{0.0000f, 0.0424f, 0.0848f, 0.1271f, 0.1695f, 0.2119f, 0.2542f, 0.2965f, 0.3386f, 0.3810f, 0.4235f,
	 0.4662f, 0.5091f, 0.5524f, 0.5964f, 0.6421f, 0.6888f, 0.7367f, 0.7867f, 0.8392f, 0.8944f, 0.9524f,
	 1.0148f, 1.0825f, 1.1558f, 1.2399f, 1.3331f, 1.4403f, 1.5688f, 1.7319f, 1.9570f, 2.3363f, 3.2000f},
	{0.0000f, 0.0422f, 0.0846f, 0.1273f, 0.1697f, 0.2118f, 0.2539f, 0.2963f, 0.3385f, 0.3809f, 0.4232f,
	 0.4656f, 0.5084f, 0.5504f, 0.5933f, 0.6361f, 0.6794f, 0.7233f, 0.7681f, 0.8142f, 0.8623f, 0.9124f,
	 0.9655f, 1.0219f, 1.0827f, 1.1492f, 1.2243f, 1.3073f, 1.4068f, 1.5294f, 1.6906f, 1.9516f, 3.2000f},
};

/* How many times longer than wide a circle of the thing is seen, at most, and from which on spots are thinned in full;
 * so many more there are for each, and so far apart those that are left. */
static const float slant_most = 5, slant_full = 0.3f, more = 1.4f, apart_at_least = 0.7f;

/* By so much the spots that are left are more than they should be; measured. */
static float too_many(float slant, float thinned)
{
	return 1 + 0.36f * thinned * (1.3f - 0.3f * thinned) + 0.12f * clamp01(4 * (slant - 1.3f)) +
	       0.085f * max(slant - 2, 0);
}

/* Darker is of larger spots, too. */
static float radius_of(float dark, float apart)
{
	return apart * (0.336f + 0.252f * dark);
}

/* Spots of a radius to a pixel. */
static float wanted(float dark, float radius)
{
	float small = clamp01((1 / radius - 0.2f) * (1 / 0.6f)), at = dark * STEPS;
	int i = at < STEPS - 1 ? (int)at : STEPS - 1;
	at -= (float)i;
	float a = mix(area_for[0][i], area_for[0][i + 1], at), b = mix(area_for[1][i], area_for[1][i + 1], at);
	return mix(b, a, small) / (3.14159265f * radius * radius);
}

/* What is told for one pixel after the other is mostly the same. */
typedef struct reader {
	point_reader points;
	int dark; /* -1: none yet; of this and `apart` */
	float apart, radius, to_pixel;
} reader;

static inline void darken(reader *r, uint8_t dark, float apart)
{
	if (r->dark == dark && r->apart == apart)
		return;
	float tone = (float)dark * (1.0f / 255);
	r->dark = dark;
	r->apart = apart;
	r->radius = radius_of(tone, apart);
	r->to_pixel = wanted(tone, r->radius);
}

/* Of a pixel: its points, and how spots are thinned there, as marks have it. */
typedef struct grid {
	point_grid points;
	float thinned, within;
} grid;

static bool grid_fill(const tone_slot *s, const tone_field chart[2], int i, uint8_t dark, reader *r, grid *g)
{
	float a = chart[0].right[i], b = chart[0].down[i], c = chart[1].right[i], d = chart[1].down[i];
	float area = point_area(chart, i);
	if (!(area > 0))
		return false;
	darken(r, dark, min(max(s->unit / sqrtf(area), s->least), s->most));
	float sum = a * a + b * b + c * c + d * d, root = sqrtf(max(sum * sum - 4 * area * area, 0));
	float slant = min((sum + root) / (2 * area), slant_most);
	float to_pixel = r->to_pixel;
	g->thinned = clamp01((slant - 1) * (1 / slant_full));
	to_pixel /= too_many(slant, g->thinned);
	g->within = min(apart_at_least / sqrtf(to_pixel), widest_apart);
	return point_grid_fill(chart, i, to_pixel * (1 + more * (slant - 1)) / area, &g->points);
}

/* Where a spot lies, in pixels from the middle of the one that holds it. */
typedef struct spot {
	float way[2], radius, born, thinned, within;
	uint32_t name;
} spot;

static int spots_in(const grid *g, reader *r, spot to[POINTS_MOST])
{
	point found[POINTS_MOST];
	int n = points_in(&g->points, &r->points, found);
	for (int k = 0; k < n; k++) {
		const point *p = found + k;
		float grown = clamp01((g->points.density / p->born - 1) * (1 / grown_within));
		float hand = 1 + uneven * ((float)p->name * 0x1p-15f - 1);
		to[k] = (spot){{p->way[0], p->way[1]},
			       r->radius * sqrtf(grown) * hand,
			       p->born,
			       g->thinned,
			       g->within,
			       p->name};
	}
	return n;
}

/* ---- pixels ------------------------------------------------------------------------------------------------ */

/* A pixel beside the seam of two charts, on the other one. */
typedef struct beyond {
	tone_rest rest;
	tone_field chart[2];
	int axis;
} beyond;

static void beyond_fill(const tone_rest *rest, int i, beyond *b)
{
	for (int c = 0; c < ANCHOR_COUNT; c++)
		b->rest.at[c][0] = rest->at[c][i];
	b->rest.at[ANCHOR_NORMAL + tone_axis(rest, i)][0] = 0;
	b->axis = tone_axis(&b->rest, 0);
	ISA(tone_surface_chart)(&b->rest, 1, 1, 0, b->chart);
}

/* Of spots those that lie on their side of the seam. */
static int sift(const frame *f, const tone_slot *s, const tone_rest *rest, int i, int x, int y, int axis, bool second,
		spot *spots, int n)
{
	int left = 0;
	for (int k = 0; k < n; k++)
		if (ISA(tone_before_seam)(f, s, rest, i, x, y, axis, second, spots[k].way))
			spots[left++] = spots[k];
	return left;
}

/* Spots whose places are in pixel x of row y, the i-th of the chart. rest: NULL on the screen. */
static int find(const frame *f, const tone_slot *s, const tone_rest *rest, const tone_field chart[2], int i, int x,
		int y, uint8_t dark, reader *r, spot to[2 * POINTS_MOST])
{
	grid g;
	int n = grid_fill(s, chart, i, dark, r, &g) ? spots_in(&g, r, to) : 0;
	if (!rest || !ISA(tone_near_seam)(rest, i))
		return n;
	beyond b;
	beyond_fill(rest, i, &b);
	n = sift(f, s, rest, i, x, y, tone_axis(rest, i), false, to, n);
	int more = grid_fill(s, b.chart, 0, dark, r, &g) ? spots_in(&g, r, to + n) : 0;
	return n + sift(f, s, rest, i, x, y, b.axis, true, to + n, more);
}

/* The run of pixels from x on that the same slot fills. */
static int run_of(const uint8_t *whose, int x, int end)
{
	int n = x + 1;
	while (n < end && whose[n] == whose[x])
		n++;
	return n;
}

int ISA(tone_spots_find)(const frame *f, const tone_marks *m, int y, int x0, int n, tone_mark *marks, bool *lacks)
{
	uint8_t *bits = tone_bytes(m, TONE_BITS, y);
	const uint8_t *dark = tone_bytes(m, TONE_DARK, y), *whose = tone_bytes(m, TONE_WHOSE, y);
	reader r = {.points = {.set = *f->kept_spots, .wanted = &m->wanted}, .dark = -1};
	spot spots[2 * POINTS_MOST];
	int sum = 0;
	for (int from = x0, end; from < x0 + n; from = end) {
		end = run_of(whose, from, x0 + n - from < TONE_TOGETHER ? x0 + n : from + TONE_TOGETHER);
		const encre_params *p = style_run(f, y, from, end, &end);
		const tone_slot *s = m->styles[p - f->params].slot + whose[from];
		int any = 0;
		for (int x = from; x < end; x++)
			any |= dark[x] && (!marks || bits[x] & TONE_FOUND);
		if (!any || !p->use_tones || s->kind != tone_1_STIPPLE)
			continue;
		tone_rest own;
		tone_field chart[2];
		const tone_rest *rest = tone_sticks(s) ? ISA(tone_rest_fill)(f, s, y, from, end - from, &own) : NULL;
		ISA(tone_chart)(f, s, rest, y, from, end - from, chart);
		for (int x = from; x < end; x++) {
			if (!dark[x] || bits[x] & TONE_LOST || (marks && !(bits[x] & TONE_FOUND)))
				continue;
			int count = find(f, s, rest, chart, x - from, x, y, dark[x], &r, spots);
			bits[x] = (uint8_t)(bits[x] | (count ? TONE_FOUND : 0));
			for (int k = 0; marks && k < count; k++) {
				const float *way = spots[k].way;
				marks[sum + k] =
					(tone_mark){.x = (float)(f->place.x + x) + 0.5f + way[0],
						    .y = (float)(f->place.y + y) + 0.5f + way[1],
						    .size = spots[k].radius,
						    .born = spots[k].born,
						    .thinned = spots[k].thinned,
						    .within = spots[k].within,
						    .weight = 1,
						    .slot = s,
						    .column = x,
						    .name = spots[k].name,
						    .off = (int32_t)(256 * (way[0] * way[0] + way[1] * way[1]) + 0.5f)};
			}
			sum += count;
		}
	}
	*lacks = r.points.lacks;
	return sum;
}
