/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A shaft between two boxes goes down the tree once, for all rays within it: at a share of the way a box that holds
 * them has bounds that are linear in that share, so that each bound of a box in the tree says for which shares the two
 * may overlap. Where one triangle stands in the way of them all no ray need be asked. */
#include "light/bundle.h"

enum {
	PART_ENTRIES = 16, /* of one part: where more would be, rays go on down the tree */
	MOST_ASKED = 24 /* leaves: to ask whether rays pass by pays where pixels are not much larger than triangles */
};

/* Of coordinates: what rounding may take from a bound. */
static const float pad = 1e-5f, slack = 1.00001f;

typedef struct beam {
	float from[2][3];       /* bounds where it begins */
	float slope[2][3], far; /* and by how much they move, inverted */
} beam;

/* A box that holds another one as an instance sees it; of places, or of ways. */
static box turned(const double m[12], box b, bool ways)
{
	double mid[3] = {0.5 * ((double)b.low.x + (double)b.high.x), 0.5 * ((double)b.low.y + (double)b.high.y),
			 0.5 * ((double)b.low.z + (double)b.high.z)};
	double half[3] = {(double)b.high.x - mid[0], (double)b.high.y - mid[1], (double)b.high.z - mid[2]};
	double low[3], high[3];
	for (int i = 0; i < 3; i++) {
		double at = ways ? 0 : m[4 * i + 3], wide = 0;
		for (int k = 0; k < 3; k++) {
			at += m[4 * i + k] * mid[k];
			wide += fabs(m[4 * i + k]) * half[k];
		}
		wide += 1e-6 * (fabs(at) + wide);
		low[i] = at - wide;
		high[i] = at + wide;
	}
	return (box){{(float)low[0], (float)low[1], (float)low[2]}, {(float)high[0], (float)high[1], (float)high[2]}};
}

static beam beam_of(box from, box to, float far)
{
	bool ways = far >= 2;
	float most = max(largest(from.low), largest(from.high));
	float off = pad * (ways ? most : max(most, max(largest(to.low), largest(to.high))));
	beam b = {.from = {{from.low.x - off, from.low.y - off, from.low.z - off},
			   {from.high.x + off, from.high.y + off, from.high.z + off}},
		  .far = far};
	const float end[2][3] = {{to.low.x, to.low.y, to.low.z}, {to.high.x, to.high.y, to.high.z}};
	for (int side = 0; side < 2; side++)
		for (int k = 0; k < 3; k++) {
			float outer = side ? off : -off;
			b.slope[side][k] = inverse_of(ways ? end[side][k] : end[side][k] + outer - b.from[side][k]);
		}
	return b;
}

/* The boxes of a node that it may touch, a bit each. */
static unsigned touched(const tree_node *n, const beam *b)
{
	float first[TREE_WIDE], last[TREE_WIDE];
	for (int i = 0; i < TREE_WIDE; i++) {
		first[i] = 0;
		last[i] = b->far;
	}
	for (int side = 0; side < 2; side++)
		for (int k = 0; k < 3; k++) {
			const float *bound = n->bound[side ? k : 3 + k];
			float from = b->from[side][k], slope = b->slope[side][k];
			/* its lower bound must be below their upper one, its upper one above their lower */
			if ((slope > 0) != (side > 0))
				for (int i = 0; i < TREE_WIDE; i++)
					last[i] = min(last[i], (bound[i] - from) * slope);
			else
				for (int i = 0; i < TREE_WIDE; i++)
					first[i] = max(first[i], (bound[i] - from) * slope);
		}
	unsigned bits = 0;
	for (int i = 0; i < TREE_WIDE; i++)
		bits |= ((first[i] <= last[i] * slack) & (n->bound[0][i] <= n->bound[3][i])) ? 1u << i : 0;
	return bits;
}

/* The entries of one instance, from `first` of *s on; their end. */
static int gather(shaft *s, const tree_node *nodes, const beam *b, int first)
{
	int end = first, most = first + PART_ENTRIES < SHAFT_ENTRIES ? first + PART_ENTRIES : SHAFT_ENTRIES;
	unsigned bits = touched(nodes, b);
	if (bits)
		s->entry[end++] = (shaft_entry){0, bits};
	for (int e = first; e < end; e++) {
		const tree_node *n = nodes + s->entry[e].node;
		for (bits = s->entry[e].mask; bits; bits &= bits - 1) {
			int slot = __builtin_ctz(bits);
			if (n->child[slot] < 0)
				continue;
			unsigned inner = touched(nodes + n->child[slot], b);
			if (inner && end == most)
				continue;
			s->entry[e].mask &= ~(1u << slot);
			if (inner)
				s->entry[end++] = (shaft_entry){n->child[slot], inner};
		}
	}
	return end;
}

static vec middle_of(box b)
{
	return times(plus(b.low, b.high), 0.5f);
}

/* Looks among the entries of an instance for a triangle that all rays meet, without holes. from, to: as the instance
 * sees the boxes. */
static bool find_wall(shaft *s, const instance *in, int32_t number, box from, box to, int first, int end)
{
	const bool ways = s->far >= 2;
	local l = {.from = middle_of(from), .way = middle_of(to), .far = s->far};
	l.way = ways ? l.way : minus(l.way, l.from);
	if (in->shape->uvs || !aim(&l))
		return false;
	const float doubt = ISA(bundle_doubt)(in, s->from, from);
	for (int e = first; e < end; e++) {
		const tree_node *n = in->shape->tree.nodes + s->entry[e].node;
		for (unsigned bits = entered(n, &l) & s->entry[e].mask; bits; bits &= bits - 1) {
			int32_t child = n->child[__builtin_ctz(bits)];
			meeting m = {{0}, {0}, {0}};
			if (child < 0)
				meet(in->shape->leaves + ~child, &l, &m);
			for (int i = 0; i < LEAF; i++)
				if (m.t[i] > 0 &&
				    ISA(bundle_must_meet)(in->shape->leaves + ~child, i, &from, doubt, to, ways)) {
					s->wall[0] = number;
					s->wall[1] = in->shape->leaves[~child].item[i];
					return true;
				}
		}
	}
	return false;
}

/* Takes leaves out that no ray can meet, as a surface is mostly not in its own way: from which places rays may meet
 * what is left. */
static uint64_t turn_away(shaft *s, const shape *of, const instance *in, const shaft_starts *from, box to, int first,
			  int end)
{
	places p;
	ISA(bundle_places)(from, in, &p);
	uint64_t all = 0;
	int asked = 0;
	for (int e = first; e < end; e++) {
		const tree_node *n = of->tree.nodes + s->entry[e].node;
		for (unsigned bits = s->entry[e].mask; bits; bits &= bits - 1) {
			int slot = __builtin_ctz(bits);
			if (n->child[slot] >= 0 || asked == MOST_ASKED) {
				all = SHAFT_ALL;
				continue;
			}
			uint64_t met = ISA(bundle_may_meet)(of->leaves + ~n->child[slot], &p, to, s->far >= 2);
			asked++;
			all |= met;
			if (!met)
				s->entry[e].mask &= ~(1u << slot);
		}
	}
	return all;
}

static int compact(shaft *s, int first, int end)
{
	int kept = first;
	for (int e = first; e < end; e++)
		if (s->entry[e].mask)
			s->entry[kept++] = s->entry[e];
	return kept;
}

static bool finite_box(box b)
{
	const vec none = {0, 0, 0};
	return dot(b.low, none) + dot(b.high, none) == 0;
}

void ISA(shaft_make)(shaft *s, const world *w, const shaft_starts *from, box to, float far, int set)
{
	int32_t stack[TREE_STACK], top = w->tree.n_nodes > 0;
	int used = 0;
	s->from = from->within;
	s->to = to;
	s->far = far;
	s->n_parts = 0;
	s->wall[0] = s->wall[1] = -1;
	s->usable = finite_box(from->within) && finite_box(to);
	stack[0] = 0;
	beam all = beam_of(from->within, to, far);
	while (s->usable && top) {
		int32_t at = stack[--top];
		const tree_node *n = w->tree.nodes + at;
		for (unsigned bits = touched(n, &all); s->usable && bits; bits &= bits - 1) {
			int slot = __builtin_ctz(bits);
			if (n->child[slot] >= 0) {
				stack[top++] = n->child[slot];
				continue;
			}
			int32_t number = w->boxes[w->tree.leaves[~n->child[slot]].from].item;
			const instance *in = w->instances[number];
			if (!casts(in, set))
				continue;
			box own = turned(in->inverse, from->within, false), end = turned(in->inverse, to, far >= 2);
			s->usable =
				s->n_parts < SHAFT_PARTS && used < SHAFT_ENTRIES && finite_box(own) && finite_box(end);
			if (!s->usable)
				break;
			beam its = beam_of(own, end, far);
			int last = gather(s, in->shape->tree.nodes, &its, used);
			if (set != SET_SEEN && find_wall(s, in, number, own, end, used, last))
				return;
			uint64_t starts = SHAFT_ALL;
			if (from->count && number == from->instance)
				starts = turn_away(s, in->shape, in, from, end, used, last);
			last = compact(s, used, last);
			if (last > used)
				s->part[s->n_parts++] = (shaft_part){number, at, slot, used, last, starts};
			used = last;
		}
	}
}

bool ISA(shaft_nearest)(const shaft *s, const world *w, const double from[3], const double to[3], float share,
			hit *found)
{
	local all = {.from = {(float)from[0], (float)from[1], (float)from[2]}, .far = 1};
	all.way = (vec){(float)(to[0] - from[0]), (float)(to[1] - from[1]), (float)(to[2] - from[2])};
	if (!s->usable || !holds(&s->from, all.from) || !holds(&s->to, (vec){(float)to[0], (float)to[1], (float)to[2]}))
		return ISA(ray_nearest)(w, from, to, share, found);
	search f = SEARCH(share, -1, NULL);
	const bool good = aim(&all);
	for (int k = 0; good && k < s->n_parts; k++) {
		const shaft_part *p = s->part + k;
		const instance *in = w->instances[p->instance];
		local l;
		if (!(entered(w->tree.nodes + p->node, &all) >> p->slot & 1) || !local_between(in, from, to, &l))
			continue;
		for (int e = p->first; e < p->end; e++) {
			const tree_node *n = in->shape->tree.nodes + s->entry[e].node;
			for (unsigned bits = entered(n, &l) & s->entry[e].mask; bits; bits &= bits - 1) {
				int32_t child = n->child[__builtin_ctz(bits)];
				if (child < 0)
					ISA(leaf_nearest)(in->shape, ~child, &l, p->instance, &f);
				else
					ISA(shape_nearest)(in->shape, child, &l, p->instance, &f);
			}
		}
	}
	*found = f.best;
	return found->instance >= 0;
}
