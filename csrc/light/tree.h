/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A tree of boxes, eight to a node, over triangles or over the instances that place them. */
#ifndef ENCRE_TREE_H
#define ENCRE_TREE_H

#include <stdbool.h>
#include <stdint.h>

/* STACK: what waits on the way down: at most 7 boxes of each of the LEVELS. */
enum { TREE_WIDE = 8, TREE_LEVELS = 36, TREE_STACK = TREE_WIDE * TREE_LEVELS };

typedef struct tree_node {
	float bound[6][TREE_WIDE]; /* least x, y, z, then greatest */
	int32_t child[TREE_WIDE];  /* a node; negative: ~leaf. Where there is none the box holds nothing */
} tree_node;

typedef struct tree_box {
	float low[3], high[3];
	int32_t item;
} tree_box;

/* Which boxes, in the order that tree_build() leaves them in. */
typedef struct tree_leaf {
	int32_t from, count;
} tree_leaf;

typedef struct tree {
	tree_node *nodes;
	tree_leaf *leaves;
	int32_t n_nodes, n_leaves, room; /* of nodes */
} tree;

/* Builds a tree with leaves of at most `most` of the n boxes, which are finite, and puts them in order. False without
 * memory. With n 0 the tree has no nodes. */
bool tree_build(tree *t, tree_box *boxes, int32_t n, int32_t most);
void tree_free(tree *t);

#endif
