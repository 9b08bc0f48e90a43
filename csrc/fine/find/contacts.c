/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Where two things touch, one surface goes on behind the other, and each can be followed from its own side by its
 * depths, which are exact at the pixels' centres: where they cross is the line, however few samples colours and normals
 * are averaged of. */
#include "fine/near.h"

/* Bends between both surfaces that tell nothing and all, of the nearest depth: below, floats round too much. */
static const float least_bend = 2e-5f, sure_bend = 4e-5f; /* test_fine_sites */

/* Pixels: by how much the place may differ that surfaces followed straight and along their bend tell, and how far it
 * may lie outside of the way between both pixels; from half of that on it counts less. */
static const float most_apart = 0.25f, most_outside = 0.1f; /* test_fine_sites */

/* How much of each other's surface both pixels hold, from and up to where the averages know better if they tell another
 * place by so many pixels: what ends just before it would meet the other, seen at a grazing angle, does not touch it.
 */
static const float mixed_from = 0.05f, mixed_sure = 0.15f, averages_from = 0.15f, averages_sure = 0.25f;

typedef struct way {
	float u[6];    /* of pixels p - 2 to q + 2 */
	bool bends[2]; /* whether p - 2 and q + 2 are of what is at p and q */
} way;

static bool read_way(const fine *n, const found *at, way *w)
{
	const frame *f = n->f;
	plane object = f->layer[ENCRE_LAYER_OBJECT], depth = f->layer[ENCRE_LAYER_DEPTH];
	int i = at->axis == AXIS_ROW ? at->column : at->row, end = at->axis == AXIS_ROW ? f->width : f->height;
	ptrdiff_t z_step = at->axis == AXIS_ROW ? 1 : depth.row, o_step = at->axis == AXIS_ROW ? 1 : object.row;
	if (!object.data || i < 1 || i + 2 >= end)
		return false;
	const float *z = depth.data + at->row * depth.row + at->column;
	const float *o = object.data + at->row * object.row + at->column;
	if (o[0] == o[o_step] || o[-o_step] != o[0] || o[2 * o_step] != o[o_step])
		return false;
	w->bends[0] = i >= 2 && o[-2 * o_step] == o[0];
	w->bends[1] = i + 3 < end && o[3 * o_step] == o[o_step];
	for (int k = w->bends[0] ? 0 : 1; k < (w->bends[1] ? 6 : 5); k++)
		w->u[k] = depth_sample(n->e, z[(k - 2) * z_step]);
	return true;
}

/* Where on the way from p to q what misses there by so much crosses. */
static inline float crossing_of(float at_p, float at_q)
{
	return at_p / (at_p + at_q);
}

float ISA(contact_place)(const fine *n, const found *at, float place, float mixed)
{
	way w;
	if (!read_way(n, at, &w))
		return place;
	const float *u = w.u;
	float p = u[2] - 2 * u[3] + u[4], q = u[3] - 2 * u[2] + u[1]; /* how far each lies before the other's plane */
	float bent_p = p - (w.bends[1] ? u[3] - 2 * u[4] + u[5] : 0),
	      bent_q = q - (w.bends[0] ? u[2] - 2 * u[1] + u[0] : 0);
	float straight = crossing_of(p, q), bent = crossing_of(bent_p, bent_q);
	float least = max(max(fabsf(u[1]), fabsf(u[2])), max(fabsf(u[3]), fabsf(u[4])));
	float outside = max(max(-bent, bent - 1), 0);
	float trust = clamp01((fabsf(bent_p + bent_q) - least_bend * least) / ((sure_bend - least_bend) * least)) *
		      clamp01(2 - 2 * fabsf(straight - bent) / most_apart) * clamp01(2 - 2 * outside / most_outside);
	bent = clamp01(bent);
	trust *= 1 - clamp01((mixed - mixed_from) / (mixed_sure - mixed_from)) *
			     clamp01((fabsf(bent - place) - averages_from) / (averages_sure - averages_from));
	return trust > 0 ? mix(place, bent, trust) : place; /* NaN where nothing is */
}
