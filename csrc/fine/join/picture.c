/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Whether the picture shows an edge where a loose end would be led on. */
#include "fine/near.h"

/* Pixels to either side of a line where the picture is looked at; less along a way between shapes, beside which others
 * lie closer; test_fine_passes */
static const float beside = 1.5f, beside_shape = 1;

static void bilinear(const frame *f, enum encre_layer layer, int channels, float x, float y, float *value)
{
	x = x > 0 ? x < (float)(f->width - 1) ? x : (float)(f->width - 1) : 0;
	y = y > 0 ? y < (float)(f->height - 1) ? y : (float)(f->height - 1) : 0;
	int x0 = (int)x, y0 = (int)y, x1 = x0 + 1 < f->width ? x0 + 1 : x0, y1 = y0 + 1 < f->height ? y0 + 1 : y0;
	const float *above = layer_row(f, layer, y0), *below = layer_row(f, layer, y1);
	for (int c = 0; c < 3; c++) {
		float top = mix(bounded(above[channels * x0 + c]), bounded(above[channels * x1 + c]), x - (float)x0);
		float bottom = mix(bounded(below[channels * x0 + c]), bounded(below[channels * x1 + c]), x - (float)x0);
		value[c] = mix(top, bottom, y - (float)y0);
	}
}

enum { VALUES = 6 };

static bool bends(int rank)
{
	return rank <= RANK_CREASE || rank == RANK_FORM;
}

static void look_at_colors(const fine *n, float x, float y, float *value)
{
	bool lit = n->e->p->color_layer == color_layer_LIT;
	bilinear(n->f, lit ? ENCRE_LAYER_COMBINED : ENCRE_LAYER_ALBEDO, lit ? 4 : 3, x, y, value);
}

/* The layer that shows an edge of that rank, as it is compared; the last three are of a second one. */
static void look(const fine *n, int rank, float x, float y, float *value)
{
	bool seen = rank == RANK_SEEN;
	if (seen) {
		bilinear(n->f, ENCRE_LAYER_SEEN_COLOR, 3, x, y, value);
		bilinear(n->f, ENCRE_LAYER_SEEN_NORMAL, 3, x, y, value + 3);
	} else if (bends(rank))
		bilinear(n->f, ENCRE_LAYER_NORMAL, 3, x, y, value);
	else if (rank == RANK_COLOR)
		look_at_colors(n, x, y, value);
	else
		bilinear(n->f, ENCRE_LAYER_DIFFUSE, 3, x, y, value);
	for (int c = 0; (rank == RANK_COLOR || seen) && c < 3; c++)
		value[c] = srgb_encode(clamp01(value[c]));
}

static bool differ(const float *a, const float *b, int rank)
{
	float least = bends(rank) ? 0.12f : rank == RANK_LIGHT ? 0.05f : 0.02f, least_seen = 0.2f; /* of a normal */
	return distance2(a, b, 3) >= least * least ||
	       (rank == RANK_SEEN && distance2(a + 3, b + 3, 3) >= least_seen * least_seen);
}

static const float flat_light = 0.002f; /* test_fine_passes */

/* Over a longer gap a line goes on only if what lies to either side of it differs, of light by anything: where it falls
 * off softly it differs by little. A valley is alike on both. */
bool ISA(picture_agrees)(const fine *n, const site *a, const site *b)
{
	int rank = rank_of(a);
	float aside = bends(rank) ? beside_shape : beside;
	float dx = b->placed.x - a->placed.x, dy = b->placed.y - a->placed.y, length = sqrtf(dx * dx + dy * dy),
	      ox = -aside * dy / length, oy = aside * dx / length;
	for (int k = 1; k <= 3 && rank != RANK_FORM; k++) {
		float x = a->placed.x + 0.25f * (float)k * dx, y = a->placed.y + 0.25f * (float)k * dy, one[VALUES],
		      two[VALUES];
		look(n, rank, x + ox, y + oy, one);
		look(n, rank, x - ox, y - oy, two);
		if (rank == RANK_LIGHT ? distance2(one, two, 3) < flat_light * flat_light : !differ(one, two, rank))
			return false;
	}
	return true;
}

/* Far lines meet in an acute corner only if what lies between them differs from what lies outside of both. */
bool ISA(picture_wedge)(const fine *n, const site *a, const site *b, int rank, float x, float y)
{
	const site *end[2] = {a, b};
	float inside[VALUES], outside[VALUES];
	look(n, rank, (a->placed.x + b->placed.x + x) / 3, (a->placed.y + b->placed.y + y) / 3, inside);
	for (int i = 0; i < 2; i++) {
		const site *s = end[i], *other = end[1 - i];
		float dx = x - s->placed.x, dy = y - s->placed.y, length = sqrtf(dx * dx + dy * dy);
		if (!(length > 0))
			return false;
		float ox = -beside * dy / length, oy = beside * dx / length,
		      way = ox * (other->placed.x - s->placed.x) + oy * (other->placed.y - s->placed.y) > 0 ? -1 : 1;
		look(n, rank, 0.5f * (s->placed.x + x) + way * ox, 0.5f * (s->placed.y + y) + way * oy, outside);
		if (!differ(inside, outside, rank))
			return false;
	}
	return true;
}

/* Two sides of a colour meet in a corner, and do not bend round, only if what they enclose reaches so far. Halfway from
 * between the ends the wedge is half as wide as there, and a pixel holds so much of it; half of that tells. */
bool ISA(picture_corner)(const fine *n, const site *a, const site *b, float x, float y)
{
	float mx = 0.5f * (a->placed.x + b->placed.x), my = 0.5f * (a->placed.y + b->placed.y), dx = x - mx,
	      dy = y - my, length = sqrtf(dx * dx + dy * dy), wide = sqrtf(apart2(a, b));
	float ox = beside * dx / length, oy = beside * dy / length;
	float inside[3], outside[3], between[3], dot = 0;
	look_at_colors(n, mx - ox, my - oy, inside);
	look_at_colors(n, mx + ox, my + oy, outside);
	look_at_colors(n, mx + 0.5f * dx, my + 0.5f * dy, between);
	for (int c = 0; c < 3; c++)
		dot += (between[c] - outside[c]) * (inside[c] - outside[c]);
	return !(dot < 0.25f * min(wide, 2) * distance2(inside, outside, 3));
}
