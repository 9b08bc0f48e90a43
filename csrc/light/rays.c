/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Rays go down the tree of instances and, in the space of each, down the tree of its triangles (Moeller and Trumbore).
 */
#include "light/local.h"

/* Whether a ray is stopped by a shape; *h: by what. */
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

void ISA(leaf_nearest)(const shape *s, int32_t leaf, const local *l, int32_t instance, search *f)
{
	meeting m;
	meet(s->leaves + leaf, l, &m);
	for (int i = 0; i < LEAF; i++) {
		hit found = {instance, s->leaves[leaf].item[i], m.t[i]};
		if (m.t[i] > 0 && found.triangle != f->skip && nearer(f->share, &found, &f->best) &&
		    (!f->textures || !s->uvs || solid_at(f->textures, s, found.triangle, m.u[i], m.v[i])))
			f->best = found;
	}
}

void ISA(shape_nearest)(const shape *s, int32_t from, const local *l, int32_t instance, search *f)
{
	int32_t stack[TREE_STACK], top = 1;
	stack[0] = from;
	while (top) {
		const tree_node *n = s->tree.nodes + stack[--top];
		for (unsigned bits = entered(n, l); bits; bits &= bits - 1) {
			int32_t child = n->child[__builtin_ctz(bits)];
			if (child >= 0)
				stack[top++] = child;
			else
				ISA(leaf_nearest)(s, ~child, l, instance, f);
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
	search f = SEARCH(share, -1, NULL);
	walk k;
	walk_from(&k, w, &r);
	for (int32_t number; (number = walk_on(&k)) >= 0;) {
		local l;
		if (w->instances[number]->camera && local_between(w->instances[number], from, to, &l))
			ISA(shape_nearest)(w->instances[number]->shape, 0, &l, number, &f);
	}
	*found = f.best;
	return found->instance >= 0;
}

bool ISA(ray_stops)(const world *w, const ray *r, float *share)
{
	search f = SEARCH(0, -1, w->textures);
	walk k;
	walk_from(&k, w, r);
	for (int32_t number; (number = walk_on(&k)) >= 0;) {
		const instance *in = w->instances[number];
		local l;
		if (!casts(in, r->set) || !local_of(in, r, &l))
			continue;
		f.skip = number == r->instance ? r->triangle : -1;
		ISA(shape_nearest)(in->shape, 0, &l, number, &f);
	}
	*share = f.best.share;
	return f.best.instance >= 0;
}
