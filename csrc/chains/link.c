/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Lines that share a node are joined in pairs, before anybody asks what can be seen of them: hidden parts then bridge
 * gaps by themselves. The only two of a group join whatever the corner, else the straightest pair is first. */
#include "chains/chains.h"

#include <string.h>

enum { MOST = 64 /* ends at a node that are looked at */, GROUPS = 5 };
static const double across_groups = 0.35, sharpest = 0.5; /* in 1 + cosine of the corner: 0 straight on, 2 back */

typedef struct node_end {
	uint64_t node;
	int64_t end; /* 2 x line + end */
} node_end;

static inline size_t bucket_of(uint64_t node, int shift)
{
	return (size_t)((node * 0x9e3779b97f4a7c15u) >> shift);
}

/* Few are in a bucket; what comes first in it stays so. */
static void sort_bucket(node_end *ends, uint32_t n)
{
	for (uint32_t i = 1; i < n; i++) {
		node_end own = ends[i];
		uint32_t k = i;
		for (; k > 0 && ends[k - 1].node > own.node; k--)
			ends[k] = ends[k - 1];
		ends[k] = own;
	}
}

static int group_of(int kind)
{
	if (kind & (ENCRE_CHAIN_CONTOUR | ENCRE_CHAIN_BORDER | ENCRE_CHAIN_NUMBER | ENCRE_CHAIN_MATERIAL))
		return 0;
	return kind & ENCRE_CHAIN_MEET ? 1 : kind & ENCRE_CHAIN_MARK ? 3 : kind & ENCRE_CHAIN_COLOR ? 4 : 2;
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

static void join(line *lines, int64_t a, int64_t b)
{
	lines[a / 2].link[a & 1] = b;
	lines[b / 2].link[b & 1] = a;
}

static void join_node(line *lines, const node_end *ends, int n)
{
	spoke s[MOST];
	int left[GROUPS] = {0};
	n = n < MOST ? n : MOST;
	if (n == 2 && group_of(lines[ends[0].end / 2].kind) == group_of(lines[ends[1].end / 2].kind)) {
		if (ends[0].end / 2 != ends[1].end / 2)
			join(lines, ends[0].end, ends[1].end);
		return;
	}
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
		join(lines, ends[p].end, ends[q].end);
		s[p].left = s[q].left = false;
		left[s[p].group]--;
		left[s[q].group]--;
	}
}

int32_t lines_link(chains *c)
{
	size_t room = 2 * (size_t)c->n_lines + 1, buckets = 2;
	int shift = 63;
	while (buckets < room && shift > 32) {
		buckets *= 2;
		shift--;
	}
	node_end *all = late_take(&c->late, room, sizeof *all), *ends = late_take(&c->late, room, sizeof *ends);
	uint32_t *first = late_take(&c->late, buckets + 2, sizeof *first), n = 0;
	if (!all || !ends || !first)
		return ENCRE_ERROR_MEMORY;
	memset(first, 0, (buckets + 2) * sizeof *first);
	for (int64_t i = 0; i < c->n_lines; i++)
		for (int k = 0; k < 2; k++)
			if (!c->lines[i].clipped[k]) {
				all[n] = (node_end){c->lines[i].node[k], 2 * i + k};
				first[bucket_of(all[n++].node, shift) + 2]++;
			}
	for (size_t k = 0; k < buckets; k++)
		first[k + 2] += first[k + 1];
	for (uint32_t i = 0; i < n; i++)
		ends[first[bucket_of(all[i].node, shift) + 1]++] = all[i];
	for (size_t k = 0; k < buckets; k++)
		sort_bucket(ends + first[k], first[k + 1] - first[k]);
	for (uint32_t i = 0, end; i < n; i = end) {
		for (end = i + 1; end < n && ends[end].node == ends[i].node;)
			end++;
		if (end - i > 1)
			join_node(c->lines, ends + i, (int)(end - i < MOST ? end - i : MOST));
	}
	late_drop(&c->late, first);
	late_drop(&c->late, ends);
	late_drop(&c->late, all);
	return ENCRE_OK;
}
