/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Rays go down the tree of instances and, in the space of each, down the tree of its triangles (Moeller and Trumbore).
 * A box is entered if rounding leaves any doubt (Ize 2013), by arithmetic that is monotone in its bounds: whoever would
 * enter a box enters those around it, too. That is why a hint may go straight to the box where the last ray ended and
 * finds there what the way down the tree would have found. */
#include "light/rays.h"

static const float doubt = 1.0000004f, edge = 1e-6f;

/* A ray in the space of one tree. */
typedef struct local {
	vec from, way, inverse;
	float far;
	int low[3], high[3]; /* which bounds it meets first and last */
} local;

static float inverse_of(float x)
{
	float least = x < 0 ? -1e-18f : 1e-18f;
	return 1 / (fabsf(x) < 1e-18f ? least : x);
}

/* False for a ray that is not finite: of what it meets nothing could be told, and it would enter boxes that are empty.
 */
static bool aim(local *l)
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
static bool local_of(const instance *in, const ray *r, local *l)
{
	double from[3] = {(double)r->from.x, (double)r->from.y, (double)r->from.z}, at[3];
	transform_point(in->inverse, from, at);
	*l = (local){.from = {(float)at[0], (float)at[1], (float)at[2]},
		     .way = transform_way(in->inverse, r->way),
		     .far = r->far};
	return aim(l);
}

/* The boxes of a node that a ray enters, a bit each. */
static inline unsigned entered(const tree_node *n, const local *l)
{
	const float *x0 = n->bound[l->low[0]], *y0 = n->bound[l->low[1]], *z0 = n->bound[l->low[2]];
	const float *x1 = n->bound[l->high[0]], *y1 = n->bound[l->high[1]], *z1 = n->bound[l->high[2]];
	unsigned bits = 0;
	for (int i = 0; i < TREE_WIDE; i++) {
		float t0 = max(max((x0[i] - l->from.x) * l->inverse.x, (y0[i] - l->from.y) * l->inverse.y),
			       max((z0[i] - l->from.z) * l->inverse.z, 0.0f));
		float t1 = min(min((x1[i] - l->from.x) * l->inverse.x, (y1[i] - l->from.y) * l->inverse.y),
			       (z1[i] - l->from.z) * l->inverse.z);
		t1 = min(t1 * doubt, l->far);
		bits |= t0 <= t1 ? 1u << i : 0;
	}
	return bits;
}

typedef struct meeting {
	float t[LEAF], u[LEAF], v[LEAF]; /* t: 0 where it meets nothing */
} meeting;

/* Where a ray meets the triangles of a leaf. */
static inline void meet(const triangle_leaf *leaf, const local *l, meeting *m)
{
	for (int i = 0; i < LEAF; i++) {
		vec e = {leaf->first[0][i], leaf->first[1][i], leaf->first[2][i]};
		vec f = {leaf->second[0][i], leaf->second[1][i], leaf->second[2][i]};
		vec c = {leaf->corner[0][i], leaf->corner[1][i], leaf->corner[2][i]};
		vec p = cross(l->way, f), to = minus(l->from, c), q = cross(to, e);
		float r = 1 / dot(e, p), u = dot(to, p) * r, v = dot(l->way, q) * r, at = dot(f, q) * r;
		bool in = (u >= -edge) & (v >= -edge) & (u + v <= 1 + edge) & (at > 0) & (at < l->far) &
			  (leaf->item[i] >= 0);
		m->t[i] = in ? at : 0;
		m->u[i] = u;
		m->v[i] = v;
	}
}

static bool leaf_blocks(const world *w, const shape *s, int32_t number, const local *l, int32_t skip)
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

static bool shape_blocks(const world *w, const shape *s, const local *l, int32_t skip, hint *h)
{
	int32_t stack[TREE_STACK], top = 1;
	stack[0] = 0;
	while (top) {
		int32_t at = stack[--top];
		const tree_node *n = s->tree.nodes + at;
		for (unsigned bits = entered(n, l); bits; bits &= bits - 1) {
			int slot = __builtin_ctz(bits);
			if (n->child[slot] >= 0) {
				stack[top++] = n->child[slot];
			} else if (leaf_blocks(w, s, ~n->child[slot], l, skip)) {
				h->node = at;
				h->slot = slot;
				return true;
			}
		}
	}
	return false;
}

static bool casts(const instance *in, int set)
{
	return in->there && in->shadow_sets >> set & 1;
}

/* What stopped the last ray, if this one enters its boxes. */
static bool hint_blocks(const world *w, const ray *r, const local *all, const hint *h)
{
	const instance *in = w->instances[h->instance];
	if (!casts(in, r->set) || !(entered(w->tree.nodes + h->top_node, all) >> h->top_slot & 1))
		return false;
	local l;
	if (!local_of(in, r, &l))
		return false;
	const tree_node *n = in->shape->tree.nodes + h->node;
	return entered(n, &l) >> h->slot & 1 &&
	       leaf_blocks(w, in->shape, ~n->child[h->slot], &l, h->instance == r->instance ? r->triangle : -1);
}

bool ISA(ray_blocked)(const world *w, const ray *r, hint *h)
{
	local all = {.from = r->from, .way = r->way, .far = r->far};
	int32_t stack[TREE_STACK], top = w->tree.n_nodes > 0;
	stack[0] = 0;
	if (!aim(&all))
		return false;
	if (h->instance >= 0 && hint_blocks(w, r, &all, h))
		return true;
	while (top) {
		int32_t at = stack[--top];
		const tree_node *n = w->tree.nodes + at;
		for (unsigned bits = entered(n, &all); bits; bits &= bits - 1) {
			int slot = __builtin_ctz(bits);
			int32_t child = n->child[slot];
			if (child >= 0) {
				stack[top++] = child;
				continue;
			}
			int32_t number = w->boxes[w->tree.leaves[~child].from].item;
			const instance *in = w->instances[number];
			local l;
			if (!casts(in, r->set) || !local_of(in, r, &l))
				continue;
			if (shape_blocks(w, in->shape, &l, number == r->instance ? r->triangle : -1, h)) {
				h->instance = number;
				h->top_node = at;
				h->top_slot = slot;
				return true;
			}
		}
	}
	return false;
}

/* ---- the nearest ------------------------------------------------------------------------------------------- */

static bool nearer(float share, const hit *a, const hit *b)
{
	float one = fabsf(a->share - share), other = fabsf(b->share - share);
	if (one != other)
		return one < other;
	return a->instance != b->instance ? a->instance < b->instance : a->triangle < b->triangle;
}

typedef struct search {
	float share;
	int32_t skip;          /* a triangle that does not count */
	const store *textures; /* NULL: holes don't count */
	hit best;
} search;

static void look_in(const shape *s, const local *l, int32_t number, search *f)
{
	int32_t stack[TREE_STACK], top = 1;
	stack[0] = 0;
	while (top) {
		const tree_node *n = s->tree.nodes + stack[--top];
		for (unsigned bits = entered(n, l); bits; bits &= bits - 1) {
			int32_t child = n->child[__builtin_ctz(bits)];
			if (child >= 0) {
				stack[top++] = child;
				continue;
			}
			meeting m;
			meet(s->leaves + ~child, l, &m);
			for (int i = 0; i < LEAF; i++) {
				hit found = {number, s->leaves[~child].item[i], m.t[i]};
				if (m.t[i] > 0 && found.triangle != f->skip && nearer(f->share, &found, &f->best) &&
				    (!f->textures || !s->uvs ||
				     solid_at(f->textures, s, found.triangle, m.u[i], m.v[i])))
					f->best = found;
			}
		}
	}
}

/* The way of a ray down the tree of instances. */
typedef struct walk {
	const world *w;
	local ray;
	int32_t stack[TREE_STACK], top;
	const tree_node *node;
	unsigned bits;
} walk;

static void walk_from(walk *k, const world *w, const ray *r)
{
	k->w = w;
	k->ray = (local){.from = r->from, .way = r->way, .far = r->far};
	k->stack[0] = 0;
	k->top = aim(&k->ray) && w->tree.n_nodes > 0;
	k->bits = 0;
}

/* The next instance whose box it enters; -1: there is none. */
static int32_t walk_on(walk *k)
{
	for (;;) {
		if (!k->bits) {
			if (!k->top)
				return -1;
			k->node = k->w->tree.nodes + k->stack[--k->top];
			k->bits = entered(k->node, &k->ray);
			continue;
		}
		int32_t child = k->node->child[__builtin_ctz(k->bits)];
		k->bits &= k->bits - 1;
		if (child < 0)
			return k->w->boxes[k->w->tree.leaves[~child].from].item;
		k->stack[k->top++] = child;
	}
}

bool ISA(ray_nearest)(const world *w, const double from[3], const double to[3], float share, hit *found)
{
	ray r = {.from = {(float)from[0], (float)from[1], (float)from[2]}, .far = 1};
	r.way = (vec){(float)(to[0] - from[0]), (float)(to[1] - from[1]), (float)(to[2] - from[2])};
	search f = {share, -1, NULL, {-1, -1, INFINITY}};
	walk k;
	walk_from(&k, w, &r);
	for (int32_t number; (number = walk_on(&k)) >= 0;) {
		const instance *in = w->instances[number];
		if (!in->camera)
			continue;
		double a[3], b[3];
		transform_point(in->inverse, from, a);
		transform_point(in->inverse, to, b);
		local l = {.from = {(float)a[0], (float)a[1], (float)a[2]}, .far = 1};
		l.way = (vec){(float)(b[0] - a[0]), (float)(b[1] - a[1]), (float)(b[2] - a[2])};
		if (aim(&l))
			look_in(in->shape, &l, number, &f);
	}
	*found = f.best;
	return found->instance >= 0;
}

bool ISA(ray_stops)(const world *w, const ray *r, float *share)
{
	search f = {0, -1, w->textures, {-1, -1, INFINITY}};
	walk k;
	walk_from(&k, w, r);
	for (int32_t number; (number = walk_on(&k)) >= 0;) {
		const instance *in = w->instances[number];
		local l;
		if (!casts(in, r->set) || !local_of(in, r, &l))
			continue;
		f.skip = number == r->instance ? r->triangle : -1;
		look_in(in->shape, &l, number, &f);
	}
	*share = f.best.share;
	return f.best.instance >= 0;
}
