/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Eight rays at once against one box after the other, and against one triangle after the other. A shaft leaves few of
 * either, so that nearly all of eight have to do with each. */
#include "light/pack.h"
#include "light/local.h"

_Static_assert((int)PACK == (int)TREE_WIDE, "negative() takes as many");

/* Rays in one space. */
typedef struct lanes {
	vecs from, way, inverse;
	float far;
} lanes;

/* The bits of those that are finite. */
static unsigned aim_lanes(lanes *r)
{
	int32_t good[PACK];
	for (int k = 0; k < PACK; k++) {
		const vec none = {0, 0, 0}, way = lane(&r->way, k);
		put_lane(&r->inverse, k, (vec){inverse_of(way.x), inverse_of(way.y), inverse_of(way.z)});
		good[k] = -(dot(lane(&r->from, k), none) + dot(way, none) == 0);
	}
	return negative(good);
}

/* As local_of(). */
static unsigned lanes_of(const instance *in, const lanes *all, lanes *r)
{
	const double *m = in->inverse;
	for (int k = 0; k < PACK; k++) {
		double from[3] = {(double)all->from.x[k], (double)all->from.y[k], (double)all->from.z[k]}, at[3];
		transform_point(m, from, at);
		put_lane(&r->from, k, (vec){(float)at[0], (float)at[1], (float)at[2]});
	}
	for (int k = 0; k < PACK; k++)
		put_lane(&r->way, k, transform_way(m, lane(&all->way, k)));
	r->far = all->far;
	return aim_lanes(r);
}

/* Where a ray meets the nearer bound of a box along an axis, and the farther one. */
static inline float nearer_bound(const float bound[2], float from, float inverse)
{
	float a = (bound[0] - from) * inverse, b = (bound[1] - from) * inverse;
	return inverse < 0 ? b : a;
}

static inline float farther_bound(const float bound[2], float from, float inverse)
{
	float a = (bound[0] - from) * inverse, b = (bound[1] - from) * inverse;
	return inverse < 0 ? a : b;
}

/* The bits of those that enter a box of a node, as entered() tells it. */
static unsigned enter(const tree_node *n, int slot, const lanes *r)
{
	const float x[2] = {n->bound[0][slot], n->bound[3][slot]}, y[2] = {n->bound[1][slot], n->bound[4][slot]};
	const float z[2] = {n->bound[2][slot], n->bound[5][slot]};
	int32_t in[PACK];
	for (int k = 0; k < PACK; k++) {
		vec from = lane(&r->from, k), by = lane(&r->inverse, k);
		float t0 = max(max(nearer_bound(x, from.x, by.x), nearer_bound(y, from.y, by.y)),
			       max(nearer_bound(z, from.z, by.z), 0.0f));
		float t1 = min(min(farther_bound(x, from.x, by.x), farther_bound(y, from.y, by.y)),
			       farther_bound(z, from.z, by.z));
		in[k] = -(t0 <= min(t1 * doubt, r->far));
	}
	return negative(in);
}

/* What of an instance is asked. */
typedef struct asked {
	const world *w;
	const shape *shape;
	lanes rays;
	int32_t skip[PACK]; /* a triangle that does not count */
} asked;

/* The bits of those that a triangle of a leaf stops. */
static unsigned stopped_by(const triangle_leaf *leaf, int i, const asked *a)
{
	const vec e = {leaf->first[0][i], leaf->first[1][i], leaf->first[2][i]};
	const vec f = {leaf->second[0][i], leaf->second[1][i], leaf->second[2][i]};
	const vec c = {leaf->corner[0][i], leaf->corner[1][i], leaf->corner[2][i]};
	const int32_t item = leaf->item[i];
	float u[PACK], v[PACK];
	int32_t met[PACK];
	for (int k = 0; k < PACK; k++) {
		crossing x = crosses(c, e, f, lane(&a->rays.from, k), lane(&a->rays.way, k));
		met[k] = -(inside(x, a->rays.far) & (item != a->skip[k]));
		u[k] = x.u;
		v[k] = x.v;
	}
	unsigned bits = negative(met);
	for (unsigned left = a->shape->uvs ? bits : 0; left; left &= left - 1) {
		int k = __builtin_ctz(left);
		bits &= ~((unsigned)!solid_at(a->w->textures, a->shape, item, u[k], v[k]) << k);
	}
	return bits;
}

/* The bits of `left` that the boxes of a node stop of which a bit is set. */
static unsigned stopped_below(const asked *a, int32_t node, unsigned boxes, unsigned left)
{
	int32_t stack[TREE_STACK], top = 1;
	unsigned stopped = 0;
	stack[0] = node;
	for (; top && left; boxes = (1u << TREE_WIDE) - 1) {
		const tree_node *n = a->shape->tree.nodes + stack[--top];
		for (unsigned bits = boxes; bits && left; bits &= bits - 1) {
			int slot = __builtin_ctz(bits);
			unsigned in = enter(n, slot, &a->rays) & left;
			if (!in)
				continue;
			if (n->child[slot] >= 0) {
				stack[top++] = n->child[slot];
				continue;
			}
			const triangle_leaf *leaf = a->shape->leaves + ~n->child[slot];
			for (int i = 0; i < LEAF && in; i++)
				if (leaf->item[i] >= 0) {
					unsigned found = stopped_by(leaf, i, a) & in;
					in &= ~found;
					left &= ~found;
					stopped |= found;
				}
		}
	}
	return stopped;
}

/* Takes rays into the space of an instance: the bits of those of `left` that are finite there. */
static unsigned ask_instance(asked *a, const world *w, int32_t number, const pack *p, const lanes *all, unsigned left)
{
	a->w = w;
	a->shape = w->instances[number]->shape;
	for (int k = 0; k < PACK; k++)
		a->skip[k] = p->instance[k] == number ? p->triangle[k] : -1;
	return lanes_of(w->instances[number], all, &a->rays) & left;
}

/* The bits of those of `left` that a part of a shaft stops. */
static unsigned part_stops(shaft *s, const shaft_part *part, const world *w, const pack *p, const lanes *all,
			   unsigned left)
{
	asked a;
	unsigned stopped = 0;
	left &= enter(w->tree.nodes + part->node, part->slot, all);
	left = left ? ask_instance(&a, w, part->instance, p, all, left) : 0;
	for (int e = part->first; e < part->end && left; e++) {
		shaft_entry own = s->entry[e];
		unsigned found = stopped_below(&a, own.node, own.mask, left);
		if (!found)
			continue;
		s->entry[e] = s->entry[part->first];
		s->entry[part->first] = own;
		left &= ~found;
		stopped |= found;
	}
	return stopped;
}

/* The bits of those of `left` that anything stops. */
static unsigned world_stops(const world *w, const pack *p, const lanes *all, unsigned left)
{
	int32_t stack[TREE_STACK], top = w->tree.n_nodes > 0;
	unsigned stopped = 0;
	stack[0] = 0;
	while (top && left) {
		const tree_node *n = w->tree.nodes + stack[--top];
		for (int slot = 0; slot < TREE_WIDE && left; slot++) {
			unsigned in = enter(n, slot, all) & left;
			if (!in)
				continue;
			if (n->child[slot] >= 0) {
				stack[top++] = n->child[slot];
				continue;
			}
			asked a;
			int32_t number = w->boxes[w->tree.leaves[~n->child[slot]].from].item;
			if (!casts(w->instances[number], p->set))
				continue;
			in = ask_instance(&a, w, number, p, all, in);
			unsigned found = stopped_below(&a, 0, (1u << TREE_WIDE) - 1, in);
			left &= ~found;
			stopped |= found;
		}
	}
	return stopped;
}

/* The bits of those that go through a shaft. */
static unsigned within(const shaft *s, const pack *p)
{
	int32_t in[PACK];
	const bool ways = s->far >= 2;
	for (int k = 0; k < PACK; k++) {
		vec from = lane(&p->from, k), way = lane(&p->way, k);
		int32_t begins = holds(&s->from, from), ends = holds(&s->to, ways ? way : plus(from, way));
		in[k] = -(begins & ends);
	}
	return negative(in);
}

/* The bits of those for which something of a part may be in the way. */
static unsigned starts_at(const shaft_part *part, const pack *p)
{
	unsigned bits = 0;
	for (int k = 0; k < PACK; k++)
		bits |= (unsigned)(part->starts >> p->start[k] & 1) << k;
	return bits;
}

/* The bits of those that begin on a shaft's wall. */
static unsigned on_wall(const shaft *s, const pack *p)
{
	unsigned bits = 0;
	for (int k = 0; k < PACK; k++)
		bits |= (unsigned)!shaft_walled(s, p->instance[k], p->triangle[k]) << k;
	return bits;
}

unsigned ISA(pack_blocked)(shaft *s, const world *w, const pack *p, unsigned asked)
{
	lanes all;
	all.from = p->from;
	all.way = p->way;
	all.far = p->far;
	asked &= aim_lanes(&all);
	unsigned through = s && s->usable ? within(s, p) & asked : 0;
	const bool walled = through && s->wall[0] >= 0;
	through &= walled ? ~on_wall(s, p) : ~0u;
	unsigned stopped = asked & ~through ? world_stops(w, p, &all, asked & ~through) : 0;
	if (walled)
		return stopped | through;
	for (int k = 0; through && k < s->n_parts; k++) {
		shaft_part own = s->part[k];
		unsigned left = starts_at(&own, p) & through;
		unsigned found = left ? part_stops(s, &own, w, p, &all, left) : 0;
		if (!found)
			continue;
		s->part[k] = s->part[0];
		s->part[0] = own;
		through &= ~found;
		stopped |= found;
	}
	return stopped;
}
