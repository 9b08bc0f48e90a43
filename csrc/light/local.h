/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A ray in the space of one tree, the boxes of a node that it enters, the triangles of a leaf that it meets. A box is
 * entered if rounding leaves any doubt (Ize 2013), by arithmetic that is monotone in its bounds: whoever would enter a
 * box enters those around it, too. That is why it may begin at any box of a tree and finds there what the way down the
 * tree would have found. */
#ifndef ENCRE_LOCAL_H
#define ENCRE_LOCAL_H

#include "light/rays.h"

#include <string.h>

static const float doubt = 1.0000004f, edge = 1e-6f;

typedef struct local {
	vec from, way, inverse;
	float far;
	int low[3], high[3]; /* which bounds it meets first and last */
} local;

static inline float inverse_of(float x)
{
	float least = x < 0 ? -1e-18f : 1e-18f;
	return 1 / (fabsf(x) < 1e-18f ? least : x);
}

/* False for a ray that is not finite: of what it meets nothing could be told, and it would enter boxes that are empty.
 */
static inline bool aim(local *l)
{
	l->inverse = (vec){inverse_of(l->way.x), inverse_of(l->way.y), inverse_of(l->way.z)};
	const float inverse[3] = {l->inverse.x, l->inverse.y, l->inverse.z};
	for (int k = 0; k < 3; k++) {
		l->low[k] = inverse[k] < 0 ? 3 + k : k;
		l->high[k] = inverse[k] < 0 ? k : 3 + k;
	}
	const vec none = {0, 0, 0};
	return dot(l->from, none) + dot(l->way, none) == 0;
}

/* The ray in the space of an instance; false if it is not finite there. */
static inline bool local_of(const instance *in, const ray *r, local *l)
{
	double from[3] = {(double)r->from.x, (double)r->from.y, (double)r->from.z}, at[3];
	transform_point(in->inverse, from, at);
	*l = (local){.from = {(float)at[0], (float)at[1], (float)at[2]},
		     .way = transform_way(in->inverse, r->way),
		     .far = r->far};
	return aim(l);
}

/* Whether each is negative, a bit each. */
static inline unsigned negative(const int32_t x[TREE_WIDE])
{
#ifdef __AVX__ /* one instruction that no compiler makes of the loop */
	float eight __attribute__((vector_size(4 * TREE_WIDE)));
	memcpy(&eight, x, sizeof eight);
	return (unsigned)__builtin_ia32_movmskps256(eight);
#else
	unsigned bits = 0;
	for (int i = 0; i < TREE_WIDE; i++)
		bits |= x[i] < 0 ? 1u << i : 0;
	return bits;
#endif
}

/* The boxes of a node that a ray enters, a bit each. */
static inline unsigned entered(const tree_node *n, const local *l)
{
	const float *x0 = n->bound[l->low[0]], *y0 = n->bound[l->low[1]], *z0 = n->bound[l->low[2]];
	const float *x1 = n->bound[l->high[0]], *y1 = n->bound[l->high[1]], *z1 = n->bound[l->high[2]];
	int32_t in[TREE_WIDE];
	for (int i = 0; i < TREE_WIDE; i++) {
		float t0 = max(max((x0[i] - l->from.x) * l->inverse.x, (y0[i] - l->from.y) * l->inverse.y),
			       max((z0[i] - l->from.z) * l->inverse.z, 0.0f));
		float t1 = min(min((x1[i] - l->from.x) * l->inverse.x, (y1[i] - l->from.y) * l->inverse.y),
			       (z1[i] - l->from.z) * l->inverse.z);
		t1 = min(t1 * doubt, l->far);
		in[i] = -(t0 <= t1);
	}
	return negative(in);
}

typedef struct meeting {
	float t[LEAF], u[LEAF], v[LEAF]; /* t: 0 where it meets nothing */
} meeting;

/* Where a ray meets the plane of a triangle, by a corner and the two edges from it. */
typedef struct crossing {
	float t, u, v; /* along the ray, and along the edges */
} crossing;

static inline crossing crosses(vec c, vec e, vec f, vec from, vec way)
{
	vec p = cross(way, f), to = minus(from, c), q = cross(to, e);
	float r = 1 / dot(e, p);
	return (crossing){dot(f, q) * r, dot(to, p) * r, dot(way, q) * r};
}

static inline bool inside(crossing x, float far)
{
	return (x.u >= -edge) & (x.v >= -edge) & (x.u + x.v <= 1 + edge) & (x.t > 0) & (x.t < far);
}

/* Where a ray meets the triangles of a leaf. */
static inline void meet(const triangle_leaf *leaf, const local *l, meeting *m)
{
	for (int i = 0; i < LEAF; i++) {
		vec e = {leaf->first[0][i], leaf->first[1][i], leaf->first[2][i]};
		vec f = {leaf->second[0][i], leaf->second[1][i], leaf->second[2][i]};
		vec c = {leaf->corner[0][i], leaf->corner[1][i], leaf->corner[2][i]};
		crossing x = crosses(c, e, f, l->from, l->way);
		bool in = inside(x, l->far) & (leaf->item[i] >= 0);
		m->t[i] = in ? x.t : 0;
		m->u[i] = x.u;
		m->v[i] = x.v;
	}
}

/* The ray between two points that are known better than in floats. */
static inline bool local_between(const instance *in, const double from[3], const double to[3], local *l)
{
	double a[3], b[3];
	transform_point(in->inverse, from, a);
	transform_point(in->inverse, to, b);
	*l = (local){.from = {(float)a[0], (float)a[1], (float)a[2]}, .far = 1};
	l->way = (vec){(float)(b[0] - a[0]), (float)(b[1] - a[1]), (float)(b[2] - a[2])};
	return aim(l);
}

static inline bool leaf_blocks(const world *w, const shape *s, int32_t number, const local *l, int32_t skip)
{
	const triangle_leaf *leaf = s->leaves + number;
	meeting m;
	meet(leaf, l, &m);
	bool any = false;
	if (s->uvs) {
		for (int i = 0; i < LEAF; i++)
			any |= m.t[i] > 0 && leaf->item[i] != skip &&
			       solid_at(w->textures, s, leaf->item[i], m.u[i], m.v[i]);
		return any;
	}
	for (int i = 0; i < LEAF; i++)
		any |= (m.t[i] > 0) & (leaf->item[i] != skip);
	return any;
}

static inline bool casts(const instance *in, int set)
{
	return in->there && (set == SET_SEEN ? in->camera : in->shadow_sets >> set & 1);
}

/* What is looked for: what lies nearest to a share of the way. */
typedef struct search {
	float share;
	int32_t skip;          /* a triangle that does not count */
	const store *textures; /* NULL: holes don't count */
	hit best;
} search;
#define SEARCH(share, skip, textures) ((search){share, skip, textures, {-1, -1, INFINITY}})

/* Looks in a leaf, or below a node, of the tree of an instance's shape. */
void ISA(leaf_nearest)(const shape *s, int32_t leaf, const local *l, int32_t instance, search *f);
void ISA(shape_nearest)(const shape *s, int32_t from, const local *l, int32_t instance, search *f);

#endif
