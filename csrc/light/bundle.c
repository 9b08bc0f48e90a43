/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Rays and a triangle, many at once: the products by which Moeller and Trumbore tell whether a ray meets it are linear
 * in where it begins and in its way, so that bounds of them hold for all rays between. */
#include "light/lamp.h"
#include "light/bundle.h"

/* By how much the space of an instance is larger than the world, at most. */
static float inverse_scale(const instance *in)
{
	float scale = 0;
	for (int k = 0; k < 3; k++)
		scale = max(scale, (float)(fabs(in->inverse[4 * k]) + fabs(in->inverse[4 * k + 1]) +
					   fabs(in->inverse[4 * k + 2])));
	return scale;
}

/* `most`: the largest coordinate as the instance sees it, and in the world. */
static float doubt_of(const instance *in, float most, float world)
{
	return 4e-7f * (most + inverse_scale(in) * world);
}

float ISA(bundle_doubt)(const instance *in, box world, box own)
{
	return doubt_of(in, max(largest(own.low), largest(own.high)), max(largest(world.low), largest(world.high)));
}

void ISA(bundle_places)(const shaft_starts *from, const instance *in, places *p)
{
	float most = 0, world = 0;
	for (int j = 0; j < from->count; j++) {
		for (int h = 0; h < 2; h++) {
			vec a = from->at[h][j];
			double own[3] = {(double)a.x, (double)a.y, (double)a.z}, at[3];
			transform_point(in->inverse, own, at);
			for (int k = 0; k < 3; k++) {
				p->at[h][k][j] = (float)at[k];
				most = max(most, fabsf((float)at[k]));
			}
			world = max(world, largest(a));
		}
		p->triangle[j] = from->triangle[j];
	}
	p->count = from->count;
	p->doubt = doubt_of(in, most, world);
}

/* A triangle, and the ways to it, or the places of a box beyond it. */
typedef struct target {
	float c[3], e[3], f[3], n[3], mid[3], half[3];
	float slope, wide, way, edges, side, kept;
} target;

static target target_of(const triangle_leaf *leaf, int i, box to, bool ways)
{
	target g = {.c = {leaf->corner[0][i], leaf->corner[1][i], leaf->corner[2][i]},
		    .e = {leaf->first[0][i], leaf->first[1][i], leaf->first[2][i]},
		    .f = {leaf->second[0][i], leaf->second[1][i], leaf->second[2][i]}};
	const float low[3] = {to.low.x, to.low.y, to.low.z}, high[3] = {to.high.x, to.high.y, to.high.z};
	for (int k = 0; k < 3; k++) {
		g.mid[k] = 0.5f * (low[k] + high[k]) - (ways ? 0 : g.c[k]);
		g.half[k] = 0.5f * (high[k] - low[k]);
		g.n[k] = g.f[(k + 1) % 3] * g.e[(k + 2) % 3] - g.f[(k + 2) % 3] * g.e[(k + 1) % 3];
		g.slope += g.mid[k] * g.n[k];
		g.wide += g.half[k] * fabsf(g.n[k]);
		g.way += fabsf(g.mid[k]) + g.half[k];
		g.edges += fabsf(g.e[k]) + fabsf(g.f[k]);
	}
	g.side = g.slope < 0 ? -1 : 1;
	g.kept = ways ? 0 : 1;
	return g;
}

/* Where rays from a place meet the triangle's plane, by Moeller and Trumbore, times det: products that are linear in a
 * ray's way, and in where it begins, so that bounds of them hold for all between. */
typedef struct products {
	float u, v, w, t, det;                     /* of the ray to the middle */
	float u_off, v_off, w_off, t_off, det_off; /* by so much those of others differ, at most */
} products;

KERNEL products products_of(const target *g, float x, float y, float z, float from_doubt)
{
	const float *e = g->e, *f = g->f, *n = g->n, *mid = g->mid, *half = g->half;
	x -= g->c[0];
	y -= g->c[1];
	z -= g->c[2];
	/* f x to, to x e, and what is left of n */
	float a0 = f[1] * z - f[2] * y, a1 = f[2] * x - f[0] * z, a2 = f[0] * y - f[1] * x;
	float b0 = y * e[2] - z * e[1], b1 = z * e[0] - x * e[2], b2 = x * e[1] - y * e[0];
	float d0 = n[0] - a0 - b0, d1 = n[1] - a1 - b1, d2 = n[2] - a2 - b2;
	float under = g->kept * (x * n[0] + y * n[1] + z * n[2]);
	float far = fabsf(x) + fabsf(y) + fabsf(z);
	float doubt = g->edges * (from_doubt + 1e-6f * far + 2e-6f * g->edges);
	float all = doubt * (g->way + g->kept * far);
	return (products){
		.u = g->side * (mid[0] * a0 + mid[1] * a1 + mid[2] * a2),
		.v = g->side * (mid[0] * b0 + mid[1] * b1 + mid[2] * b2),
		.w = g->side * (mid[0] * d0 + mid[1] * d1 + mid[2] * d2 - under),
		.t = g->side * (f[0] * b0 + f[1] * b1 + f[2] * b2),
		.det = g->side * (g->slope - under),
		.u_off = half[0] * fabsf(a0) + half[1] * fabsf(a1) + half[2] * fabsf(a2) + all,
		.v_off = half[0] * fabsf(b0) + half[1] * fabsf(b1) + half[2] * fabsf(b2) + all,
		.w_off = half[0] * fabsf(d0) + half[1] * fabsf(d1) + half[2] * fabsf(d2) + all,
		.t_off = doubt * g->edges,
		.det_off = g->wide + all,
	};
}

/* From which places rays may meet a triangle, is added to `met`: where one of the products has the wrong sign for all
 * ways, at both heights, the ray passes on that side. */
static void may_meet(const triangle_leaf *leaf, int i, const places *p, box to, bool ways, int *restrict met)
{
	const target g = target_of(leaf, i, to, ways);
	for (int j = 0; j < p->count; j++) {
		float det = INFINITY, u = -INFINITY, v = -INFINITY, w = -INFINITY, t = -INFINITY;
		for (int h = 0; h < 2; h++) {
			products m = products_of(&g, p->at[h][0][j], p->at[h][1][j], p->at[h][2][j], p->doubt);
			det = min(det, m.det - m.det_off);
			u = max(u, m.u + m.u_off);
			v = max(v, m.v + m.v_off);
			w = max(w, m.w + m.w_off);
			t = max(t, m.t + m.t_off);
		}
		bool by = (u < 0) | (v < 0) | (w < 0) | (t < 0);
		met[j] |= !((det > 0) & by) & (p->triangle[j] != leaf->item[i]);
	}
}

uint64_t ISA(bundle_may_meet)(const triangle_leaf *leaf, const places *p, box to, bool ways)
{
	int met[SHAFT_SIDE * SHAFT_SIDE] = {0};
	uint64_t bits = 0;
	for (int i = 0; i < LEAF; i++)
		if (leaf->item[i] >= 0)
			may_meet(leaf, i, p, to, ways, met);
	for (int j = 0; j < p->count; j++)
		bits |= (uint64_t)met[j] << j;
	return bits;
}

bool ISA(bundle_must_meet)(const triangle_leaf *leaf, int i, const box *from, float doubt, box to, bool ways)
{
	const target g = target_of(leaf, i, to, ways);
	int32_t met[8];
	for (int j = 0; j < 8; j++) {
		products m = products_of(&g, j & 1 ? from->low.x : from->high.x, j & 2 ? from->low.y : from->high.y,
					 j & 4 ? from->low.z : from->high.z, doubt);
		float before = ways ? INFINITY : lamp_near * (m.det - m.det_off);
		met[j] = (m.det > m.det_off) & (m.u > m.u_off) & (m.v > m.v_off) & (m.w > m.w_off) & (m.t > m.t_off) &
			 (m.t + m.t_off < before);
	}
	int all = 1;
	for (int j = 0; j < 8; j++)
		all &= met[j];
	return all;
}
