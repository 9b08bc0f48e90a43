/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Boxes are split by the surface area heuristic in bins, the widest part of a node first, until a node has eight. */
#include "light/tree.h"

#include <stdlib.h>
#include <string.h>

enum { BINS = 16, DEEP = 24 /* levels after which the longest lists are halved, so that TREE_LEVELS are enough */ };

typedef struct span {
	float low[3], high[3];
} span;

typedef struct part {
	int32_t from, end;
	span span;
} part;

typedef struct build {
	tree *tree;
	tree_box *boxes;
	int32_t most;
	bool failed;
} build;

static const span nothing = {{1e38f, 1e38f, 1e38f}, {-1e38f, -1e38f, -1e38f}};

static inline void grow(span *a, const float low[3], const float high[3])
{
	for (int k = 0; k < 3; k++) {
		a->low[k] = a->low[k] < low[k] ? a->low[k] : low[k];
		a->high[k] = a->high[k] > high[k] ? a->high[k] : high[k];
	}
}

static float area(const span *a)
{
	float x = a->high[0] - a->low[0], y = a->high[1] - a->low[1], z = a->high[2] - a->low[2];
	return x < 0 ? 0 : x * y + y * z + z * x;
}

static inline float middle(const tree_box *box, int k)
{
	return 0.5f * box->low[k] + 0.5f * box->high[k];
}

static inline int bin_of(const tree_box *box, int k, float low, float scale)
{
	int bin = (int)((middle(box, k) - low) * scale);
	return bin < BINS ? bin : BINS - 1;
}

typedef struct plan {
	int axis, at; /* -1: the centres can't be told apart */
	float low, scale;
} plan;

/* The cheapest cut between two bins along one axis. */
static void cheapest(const span bin[BINS], const int32_t count[BINS], int axis, float *best, plan *p)
{
	float right[BINS];
	int32_t n = 0;
	span b = nothing;
	for (int j = BINS - 1; j > 0; j--) {
		grow(&b, bin[j].low, bin[j].high);
		n += count[j];
		right[j] = n ? (float)n * area(&b) : -1;
	}
	b = nothing;
	n = 0;
	for (int j = 1; j < BINS; j++) {
		grow(&b, bin[j - 1].low, bin[j - 1].high);
		n += count[j - 1];
		float cost = (float)n * area(&b) + right[j];
		if (n && right[j] >= 0 && cost < *best) {
			*best = cost;
			p->axis = axis;
			p->at = j;
		}
	}
}

static plan find_cut(const build *b, const part *whole)
{
	span centres = nothing;
	for (int32_t i = whole->from; i < whole->end; i++) {
		const tree_box *box = b->boxes + i;
		float c[3] = {middle(box, 0), middle(box, 1), middle(box, 2)};
		grow(&centres, c, c);
	}
	span bin[3][BINS];
	int32_t count[3][BINS] = {{0}};
	float scale[3];
	for (int k = 0; k < 3; k++) {
		float wide = centres.high[k] - centres.low[k];
		scale[k] = wide > 1e-30f && wide < 1e38f ? BINS * 0.9999f / wide : 0;
		for (int j = 0; j < BINS; j++)
			bin[k][j] = nothing;
	}
	for (int32_t i = whole->from; i < whole->end; i++)
		for (int k = 0; k < 3; k++) {
			const tree_box *box = b->boxes + i;
			int j = bin_of(box, k, centres.low[k], scale[k]);
			count[k][j]++;
			grow(&bin[k][j], box->low, box->high);
		}
	float best = 3e38f;
	plan p = {.axis = -1};
	for (int k = 0; k < 3; k++)
		if (scale[k] > 0)
			cheapest(bin[k], count[k], k, &best, &p);
	if (p.axis >= 0) {
		p.low = centres.low[p.axis];
		p.scale = scale[p.axis];
	}
	return p;
}

static void bound(const build *b, part *p)
{
	p->span = nothing;
	for (int32_t i = p->from; i < p->end; i++)
		grow(&p->span, b->boxes[i].low, b->boxes[i].high);
}

static void split(const build *b, const part *whole, bool halve, part *left, part *right)
{
	plan p = halve ? (plan){.axis = -1} : find_cut(b, whole);
	int32_t m = whole->from;
	if (p.axis < 0)
		m += (whole->end - whole->from) / 2;
	else
		for (int32_t i = whole->from; i < whole->end; i++)
			if (bin_of(b->boxes + i, p.axis, p.low, p.scale) < p.at) {
				tree_box t = b->boxes[i];
				b->boxes[i] = b->boxes[m];
				b->boxes[m++] = t;
			}
	*left = (part){.from = whole->from, .end = m};
	*right = (part){.from = m, .end = whole->end};
	bound(b, left);
	bound(b, right);
}

/* A place for one more node; -1 without memory. */
static int32_t new_node(build *b)
{
	tree *t = b->tree;
	if (t->n_nodes == t->room) {
		int32_t room = t->room ? t->room / 2 * 3 : 16;
		tree_node *more = malloc((size_t)room * sizeof *more);
		if (!more) {
			b->failed = true;
			return -1;
		}
		if (t->n_nodes)
			memcpy(more, t->nodes, (size_t)t->n_nodes * sizeof *more);
		free(t->nodes);
		t->nodes = more;
		t->room = room;
	}
	return t->n_nodes++;
}

static int32_t make_node(build *b, const part *whole, int level)
{
	int32_t at = new_node(b);
	if (at < 0)
		return 0;
	part parts[TREE_WIDE] = {*whole};
	int n = 1;
	while (n < TREE_WIDE) {
		int widest = -1;
		float greatest = -1;
		for (int i = 0; i < n; i++) {
			int32_t count = parts[i].end - parts[i].from;
			float size = level < DEEP ? area(&parts[i].span) : (float)count;
			if (count > b->most && size > greatest) {
				greatest = size;
				widest = i;
			}
		}
		if (widest < 0)
			break;
		part cut = parts[widest];
		split(b, &cut, level >= DEEP, parts + widest, parts + n++);
	}
	for (int i = 0; i < TREE_WIDE; i++) {
		part p = i < n ? parts[i] : (part){.span = nothing};
		int32_t child = 0;
		if (i < n && p.end - p.from > b->most)
			child = make_node(b, &p, level + 1); /* may move the nodes */
		else if (i < n) {
			b->tree->leaves[b->tree->n_leaves] = (tree_leaf){p.from, p.end - p.from};
			child = ~b->tree->n_leaves++;
		}
		if (b->failed)
			return 0;
		tree_node *node = b->tree->nodes + at;
		node->child[i] = child;
		for (int k = 0; k < 3; k++) {
			node->bound[k][i] = p.span.low[k];
			node->bound[3 + k][i] = p.span.high[k];
		}
	}
	return at;
}

bool tree_build(tree *t, tree_box *boxes, int32_t n, int32_t most)
{
	*t = (tree){0};
	if (n == 0)
		return true;
	t->leaves = malloc((size_t)n * sizeof *t->leaves);
	if (!t->leaves)
		return false;
	build b = {.tree = t, .boxes = boxes, .most = most};
	part whole = {.end = n};
	bound(&b, &whole);
	make_node(&b, &whole, 0);
	if (b.failed)
		tree_free(t);
	return !b.failed;
}

void tree_free(tree *t)
{
	free(t->nodes);
	free(t->leaves);
	*t = (tree){0};
}
