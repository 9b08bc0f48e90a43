/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Lines that share a node are joined in pairs, before anybody asks what can be seen of them: hidden parts then bridge
 * gaps by themselves. The only two of a group join whatever the corner, else the straightest pair is first. */
#include "chains/chains.h"

#include <stdlib.h>

enum { MOST = 64 /* ends at a node that are looked at */, GROUPS = 4 };
static const double across_groups = 0.35, sharpest = 0.5; /* in 1 + cosine of the corner: 0 straight on, 2 back */

typedef struct node_end {
	uint64_t node;
	int64_t end; /* 2 x line + end */
} node_end;

static int by_node(const void *a, const void *b)
{
	const node_end *x = a, *y = b;
	if (x->node != y->node)
		return x->node < y->node ? -1 : 1;
	return x->end < y->end ? -1 : x->end > y->end;
}

static int group_of(int kind)
{
	if (kind & (ENCRE_CHAIN_CONTOUR | ENCRE_CHAIN_BORDER | ENCRE_CHAIN_NUMBER | ENCRE_CHAIN_MATERIAL))
		return 0;
	return kind & ENCRE_CHAIN_MEET ? 1 : kind & ENCRE_CHAIN_MARK ? 3 : 2;
}

typedef struct spoke {
	double x, y; /* the way from the node on */
	int group;
	bool left;
} spoke;

static spoke spoke_of(const line *l, int end)
{
	screen a = screen_at(l, l->part[0]), b = screen_at(l, l->part[1]);
	double length = apart(a, b), turn = end ? -1 : 1;
	spoke s = {.group = group_of(l->kind), .left = true};
	if (length > 1e-9) {
		s.x = turn * (b.x - a.x) / length;
		s.y = turn * (b.y - a.y) / length;
	}
	return s;
}

/* How ill two spokes go on in each other; INFINITY: they don't. */
static double cost_of(const spoke *a, const spoke *b, const int left[GROUPS])
{
	double turn = 1 + a->x * b->x + a->y * b->y;
	if (a->group == b->group && left[a->group] == 2)
		return turn - 3;
	return turn > sharpest ? INFINITY : turn + (a->group == b->group ? 0 : across_groups);
}

static void join_node(line *lines, const node_end *ends, int n)
{
	spoke s[MOST];
	int left[GROUPS] = {0};
	n = n < MOST ? n : MOST;
	for (int i = 0; i < n; i++) {
		s[i] = spoke_of(lines + ends[i].end / 2, (int)(ends[i].end & 1));
		left[s[i].group]++;
	}
	for (;;) {
		double best = INFINITY;
		int p = -1, q = -1;
		for (int i = 0; i < n; i++)
			for (int k = i + 1; s[i].left && k < n; k++) {
				if (!s[k].left || ends[i].end / 2 == ends[k].end / 2)
					continue;
				double cost = cost_of(s + i, s + k, left);
				if (cost < best) {
					best = cost;
					p = i;
					q = k;
				}
			}
		if (p < 0)
			return;
		lines[ends[p].end / 2].link[ends[p].end & 1] = ends[q].end;
		lines[ends[q].end / 2].link[ends[q].end & 1] = ends[p].end;
		s[p].left = s[q].left = false;
		left[s[p].group]--;
		left[s[q].group]--;
	}
}

int32_t lines_link(chains *c)
{
	node_end *ends = late_take(&c->late, 2 * (size_t)c->n_lines + 1, sizeof *ends);
	int64_t n = 0;
	if (!ends)
		return ENCRE_ERROR_MEMORY;
	for (int64_t i = 0; i < c->n_lines; i++)
		for (int k = 0; k < 2; k++)
			if (!c->lines[i].clipped[k])
				ends[n++] = (node_end){c->lines[i].node[k], 2 * i + k};
	qsort(ends, (size_t)n, sizeof *ends, by_node);
	for (int64_t i = 0, end; i < n; i = end) {
		for (end = i + 1; end < n && ends[end].node == ends[i].node;)
			end++;
		if (end - i > 1)
			join_node(c->lines, ends + i, (int)(end - i < MOST ? end - i : MOST));
	}
	late_drop(&c->late, ends);
	return ENCRE_OK;
}
