/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Voronoi's cells, the same as Blender's: each cube of a grid has a point, and places are told by the points about
 * them. One cube after the other for a whole block, which compilers turn into vectors. */
#include "base/pixel.h"
#include "material/hash.h"
#include "material/material.h"

#include <math.h>

#define RUN(name)                                                                                                      \
	void ISA(run_##name)(const block *b, const encre_operation *o, const float *const in[], float *const out[])

enum { EUCLIDEAN, MANHATTAN }; /* others: Chebychev */
enum { FLAT = 1, PCG = 2 };

typedef float ways[3][MATERIAL_BLOCK];

/* The places of a block: the cubes that they are in and where in them. */
typedef struct places {
	ways cell, rest;
	float random[MATERIAL_BLOCK];
	int metric, kind;
} places;

/* A cube about each place: how its point lies from there, and its colour. */
typedef struct neighbour {
	ways way, color;
} neighbour;

static void look(const encre_operation *o, const float *const in[], places *p)
{
	p->metric = o->data[0], p->kind = o->data[1] & (FLAT | PCG);
	for (int c = 0; c < 3; c++)
		for (int i = 0; i < MATERIAL_BLOCK; i++) {
			float at = c == 2 && p->kind & FLAT ? 0 : min(max(in[c][i], -1e9f), 1e9f);
			p->cell[c][i] = floorf(at);
			p->rest[c][i] = at - p->cell[c][i];
		}
	for (int i = 0; i < MATERIAL_BLOCK; i++)
		p->random[i] = clamp01(in[3][i]);
}

/* Of the 31 bits that PCG gives. */
static inline float chance31(uint32_t hash)
{
	return (float)(int32_t)(hash & 0x7fffffff) / 2147483648.0f;
}

/* A cube's colour, and the chances that place its point. */
static inline void chances(const float cell[3], int kind, float color[3], float point[3])
{
	if (kind & PCG) {
		uint32_t v[3], flat[2];
		for (int c = 0; c < 3; c++)
			v[c] = (uint32_t)(int32_t)cell[c];
		flat[0] = v[0], flat[1] = v[1];
		pcg_of_three(v);
		pcg_of_two(flat);
		for (int c = 0; c < 3; c++)
			color[c] = chance31(v[c]);
		for (int c = 0; c < 3; c++)
			point[c] = !(kind & FLAT) ? color[c] : c < 2 ? chance31(flat[c]) : 0;
		return;
	}
	uint32_t v[3], one = (uint32_t)float_bits(1), two = (uint32_t)float_bits(2);
	for (int c = 0; c < 3; c++)
		v[c] = (uint32_t)float_bits(cell[c]);
	uint32_t hash[3] = {kind & FLAT ? jenkins_of_two(v[0], v[1]) : jenkins_of_three(v[0], v[1], v[2]),
			    kind & FLAT ? jenkins_of_three(v[0], v[1], one) : jenkins_of_four(v[0], v[1], v[2], one),
			    kind & FLAT ? jenkins_of_three(v[0], v[1], two) : jenkins_of_four(v[0], v[1], v[2], two)};
	for (int c = 0; c < 3; c++)
		color[c] = (float)hash[c] / 4294967296.0f;
	for (int c = 0; c < 3; c++)
		point[c] = c == 2 && kind & FLAT ? 0 : color[c];
}

static inline void visit(const places *p, int i, const float by[3], int kind, neighbour *n)
{
	float cell[3], color[3], point[3];
	for (int c = 0; c < 3; c++)
		cell[c] = p->cell[c][i] + by[c];
	chances(cell, kind, color, point);
	for (int c = 0; c < 3; c++) {
		n->color[c][i] = color[c];
		n->way[c][i] = by[c] + point[c] * p->random[i] - p->rest[c][i];
	}
}

/* The k-th cube of those at most `far` away. */
static inline void cube(int k, int far, float by[3])
{
	int wide = 2 * far + 1, at[3] = {k % wide, k / wide % wide, k / (wide * wide)};
	for (int c = 0; c < 3; c++)
		by[c] = (float)(at[c] - far);
}

/* That cube of all places. A loop for each kind, without branches. */
static void visit_all(const places *p, int k, int far, neighbour *n)
{
	float by[3];
	cube(k, far, by);
	if (p->kind == (PCG | FLAT))
		for (int i = 0; i < MATERIAL_BLOCK; i++)
			visit(p, i, by, PCG | FLAT, n);
	else if (p->kind == PCG)
		for (int i = 0; i < MATERIAL_BLOCK; i++)
			visit(p, i, by, PCG, n);
	else if (p->kind == FLAT)
		for (int i = 0; i < MATERIAL_BLOCK; i++)
			visit(p, i, by, FLAT, n);
	else
		for (int i = 0; i < MATERIAL_BLOCK; i++)
			visit(p, i, by, 0, n);
}

/* The cubes at most `far` away that count, from the first on to before the end. */
static void cubes(const places *p, int far, int *first, int *end)
{
	int wide = 2 * far + 1, layer = wide * wide;
	*first = p->kind & FLAT ? far * layer : 0;
	*end = p->kind & FLAT ? (far + 1) * layer : wide * layer;
}

/* The length of a way, or the square of it where it is Euclidean. */
static inline float size_of(ways way, int i, int metric)
{
	float x = fabsf(way[0][i]), y = fabsf(way[1][i]), z = fabsf(way[2][i]);
	return metric == EUCLIDEAN ? x * x + y * y + z * z : metric == MANHATTAN ? x + y + z : max(x, max(y, z));
}

static inline float length_of(float size, int metric)
{
	return metric == EUCLIDEAN ? sqrtf(size) : size;
}

/* ---- the nearest point and the second ------------------------------------------------------------------------ */

typedef struct found {
	float size[MATERIAL_BLOCK];
	int32_t which[MATERIAL_BLOCK];
} found;

static void nearest_points(const places *p, found *nearest, found *second)
{
	neighbour near;
	int first, end;
	for (int i = 0; i < MATERIAL_BLOCK; i++)
		nearest->size[i] = second->size[i] = 1e30f, nearest->which[i] = second->which[i] = 13;
	cubes(p, 1, &first, &end);
	for (int k = first; k < end; k++) {
		visit_all(p, k, 1, &near);
		for (int i = 0; i < MATERIAL_BLOCK; i++) {
			float size = size_of(near.way, i, p->metric), other = nearest->size[i];
			int32_t before = nearest->which[i];
			bool nearer = size < other, between = size < second->size[i];
			second->size[i] = nearer ? other : between ? size : second->size[i];
			second->which[i] = nearer ? before : between ? k : second->which[i];
			nearest->size[i] = nearer ? size : other;
			nearest->which[i] = nearer ? k : before;
		}
	}
}

/* What was found, again. */
static void revisit(const places *p, const found *what, neighbour *n)
{
	for (int i = 0; i < MATERIAL_BLOCK; i++) {
		float by[3];
		cube(what->which[i], 1, by);
		visit(p, i, by, p->kind, n);
	}
}

/* Distance, colour and position of what was found. */
static void show(const places *p, const found *what, float *const out[])
{
	neighbour n;
	revisit(p, what, &n);
	for (int i = 0; i < MATERIAL_BLOCK; i++)
		out[0][i] = length_of(what->size[i], p->metric);
	for (int c = 0; c < 3; c++)
		for (int i = 0; i < MATERIAL_BLOCK; i++) {
			out[1 + c][i] = n.color[c][i];
			out[4 + c][i] = n.way[c][i] + p->rest[c][i] + p->cell[c][i];
		}
}

RUN(voronoi)
{
	places p;
	found nearest, second;
	(void)b;
	look(o, in, &p);
	nearest_points(&p, &nearest, &second);
	show(&p, &nearest, out);
}

RUN(voronoi_second)
{
	places p;
	found nearest, second;
	(void)b;
	look(o, in, &p);
	nearest_points(&p, &nearest, &second);
	show(&p, &second, out);
}

/* ---- the nearest points, smoothly ---------------------------------------------------------------------------- */

RUN(voronoi_smooth)
{
	places p;
	neighbour n;
	float sum[MATERIAL_OUTPUTS][MATERIAL_BLOCK];
	int first, end;
	(void)b;
	look(o, in, &p);
	cubes(&p, 2, &first, &end);
	for (int c = 0; c < MATERIAL_OUTPUTS; c++)
		for (int i = 0; i < MATERIAL_BLOCK; i++)
			sum[c][i] = c ? 0 : 8;
	for (int k = first; k < end; k++) {
		visit_all(&p, k, 2, &n);
		for (int i = 0; i < MATERIAL_BLOCK; i++) {
			float wide = min(max(in[4][i], 1e-6f), 0.5f);
			float length = length_of(size_of(n.way, i, p.metric), p.metric);
			float t = clamp01(0.5f + 0.5f * (sum[0][i] - length) / wide), share = t * t * (3 - 2 * t);
			float less = wide * share * (1 - share), least = less / (1 + 3 * wide);
			sum[0][i] = mix(sum[0][i], length, share) - less;
			for (int c = 0; c < 3; c++) {
				sum[1 + c][i] = mix(sum[1 + c][i], n.color[c][i], share) - least;
				sum[4 + c][i] = mix(sum[4 + c][i], n.way[c][i] + p.rest[c][i], share) - least;
			}
		}
	}
	for (int c = 0; c < MATERIAL_OUTPUTS; c++)
		for (int i = 0; i < MATERIAL_BLOCK; i++)
			out[c][i] = c == 6 && p.kind & FLAT ? 0 : sum[c][i] + (c < 4 ? 0 : p.cell[c - 4][i]);
}

/* ---- how far the edge is ------------------------------------------------------------------------------------- */

RUN(voronoi_edge)
{
	places p;
	found nearest, second;
	neighbour own, n;
	int first, end;
	float edge[MATERIAL_BLOCK];
	(void)b;
	look(o, in, &p);
	p.metric = EUCLIDEAN;
	nearest_points(&p, &nearest, &second);
	revisit(&p, &nearest, &own);
	for (int i = 0; i < MATERIAL_BLOCK; i++)
		edge[i] = 8;
	cubes(&p, 1, &first, &end);
	for (int k = first; k < end; k++) {
		visit_all(&p, k, 1, &n);
		for (int i = 0; i < MATERIAL_BLOCK; i++) {
			float apart = 0, along = 0;
			for (int c = 0; c < 3; c++) {
				float between = n.way[c][i] - own.way[c][i];
				apart += between * between;
				along += 0.5f * (own.way[c][i] + n.way[c][i]) * between;
			}
			float away = along / sqrtf(max(apart, 1e-4f));
			edge[i] = apart > 1e-4f && away < edge[i] ? away : edge[i];
		}
	}
	for (int i = 0; i < MATERIAL_BLOCK; i++)
		out[0][i] = edge[i];
}
