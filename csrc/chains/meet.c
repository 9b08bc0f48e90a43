/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Where surfaces pass through each other: exact segments, triangle by triangle, between bodies and between the pieces
 * of one. They don't depend on the camera and are kept; a pair of bodies is asked again when one of them has moved, and
 * for the first time when both may be seen. A segment ends where an edge passes through a triangle, by which it knows
 * the next one. */
#include "chains/chains.h"

#include <stdlib.h>
#include <string.h>

static const double least_angle = 1e-6; /* sine between planes that meet in a line */

/* What meets of a body depend on. */
struct placed {
	uint64_t key[2];
	double model[16];
};

typedef struct box3 {
	float low[3], high[3];
} box3;

static inline uint64_t stir(uint64_t a, uint64_t b)
{
	uint64_t h = (a ^ (b + 0x9e3779b97f4a7c15u + (a << 6) + (a >> 2))) * 0xff51afd7ed558ccdu;
	return h ^ h >> 32;
}

/* ---- two triangles --------------------------------------------------------------------------------------------- */

/* Where a triangle meets the plane of another: two points, in the order of a direction, and the edges they lie on. */
typedef struct cut {
	double p[2][3], at[2];
	int edge[2];
} cut;

static bool cut_of(double p[3][3], const double side[3], const double way[3], cut *out)
{
	int n = 0;
	for (int c = 0; c < 3 && n < 2; c++) {
		int e = (c + 1) % 3;
		if ((side[c] > 0) == (side[e] > 0) && (side[c] < 0) == (side[e] < 0))
			continue;
		if (side[c] == 0) /* taken where the edge before ends */
			continue;
		double f = side[c] / (side[c] - side[e]);
		for (int k = 0; k < 3; k++)
			out->p[n][k] = p[c][k] + f * (p[e][k] - p[c][k]);
		out->at[n] = dot3(out->p[n], way);
		out->edge[n++] = c;
	}
	for (int c = 0; c < 3 && n < 2; c++) /* through a corner: the other end is that */
		if (side[c] == 0) {
			memcpy(out->p[n], p[c], sizeof out->p[n]);
			out->at[n] = dot3(p[c], way);
			out->edge[n++] = c;
		}
	if (n == 2 && out->at[0] > out->at[1]) {
		cut swapped = *out;
		for (int k = 0; k < 2; k++) {
			memcpy(out->p[k], swapped.p[1 - k], sizeof out->p[k]);
			out->at[k] = swapped.at[1 - k];
			out->edge[k] = swapped.edge[1 - k];
		}
	}
	return n == 2;
}

static uint64_t node_of(const chains *c, const meet *m, int own, int edge)
{
	int other = 1 - own;
	int32_t number = c->bodies[m->body[own]].shape->edge_of[3 * (size_t)m->face[own] + (size_t)edge];
	uint64_t by = (uint64_t)(m->body[own] + 1) << 32 | (uint32_t)(number < 0 ? -m->face[own] - 1 : number);
	return stir(by, (uint64_t)(m->body[other] + 1) << 32 | (uint32_t)m->face[other]) | (uint64_t)1 << 63;
}

static bool faces_meet(const chains *c, double p[2][3][3], meet *m)
{
	double across[2][3], length[2], size = 0, side[2][3], way[3];
	for (int q = 0; q < 2; q++) {
		across3(p[q], across[q]);
		length[q] = sqrt(dot3(across[q], across[q]));
		for (int k = 0; k < 3; k++)
			for (int i = 0; i < 3; i++)
				size = fmax(size, fabs(p[q][k][i]));
	}
	if (!(length[0] > 0 && length[1] > 0))
		return false;
	double least = 1e-7 * size + 1e-12;
	for (int q = 0; q < 2; q++) {
		bool before = false, behind = false;
		for (int k = 0; k < 3; k++) {
			double to[3];
			minus3(p[q][k], p[1 - q][0], to);
			side[q][k] = dot3(to, across[1 - q]) / length[1 - q];
			if (fabs(side[q][k]) < least)
				side[q][k] = 0;
			before |= side[q][k] > 0;
			behind |= side[q][k] < 0;
		}
		if (!(before && behind))
			return false;
	}
	cross3(across[0], across[1], way);
	double sine = sqrt(dot3(way, way));
	if (sine < least_angle * length[0] * length[1])
		return false;
	for (int k = 0; k < 3; k++)
		way[k] /= sine;
	cut cuts[2];
	if (!cut_of(p[0], side[0], way, cuts) || !cut_of(p[1], side[1], way, cuts + 1))
		return false;
	int low = cuts[0].at[0] > cuts[1].at[0] ? 0 : 1, high = cuts[0].at[1] < cuts[1].at[1] ? 0 : 1;
	if (cuts[high].at[1] - cuts[low].at[0] <= 4 * least)
		return false;
	memcpy(m->p[0], cuts[low].p[0], sizeof m->p[0]);
	memcpy(m->p[1], cuts[high].p[1], sizeof m->p[1]);
	m->node[0] = node_of(c, m, low, cuts[low].edge[0]);
	m->node[1] = node_of(c, m, high, cuts[high].edge[1]);
	return true;
}

/* ---- two bodies ------------------------------------------------------------------------------------------------ */

static bool add_meet(kept_shapes *kept, const meet *m)
{
	meet *meets = with_room(kept->meets, sizeof *meets, kept->n_meets, &kept->room_meets);
	if (!meets)
		return false;
	kept->meets = meets;
	kept->meets[kept->n_meets++] = *m;
	return true;
}

/* The box of a triangle in the space of a body; false: it lies outside of the body's. */
static bool box_in(const body *b, double p[3][3], box3 *box)
{
	for (int k = 0; k < 3; k++) {
		double low = fmin(p[0][k], fmin(p[1][k], p[2][k])), high = fmax(p[0][k], fmax(p[1][k], p[2][k]));
		if (low > b->high[k] || high < b->low[k])
			return false;
	}
	for (int c = 0; c < 3; c++) {
		double at[3];
		move3(b->inverse, p[c], at);
		for (int k = 0; k < 3; k++) {
			float low = (float)at[k], high = low, pad = 1e-6f * fabsf(low);
			box->low[k] = c ? min(box->low[k], low - pad) : low - pad;
			box->high[k] = c ? max(box->high[k], high + pad) : high + pad;
		}
	}
	return true;
}

static inline bool overlaps(const tree_node *n, int i, const box3 *box)
{
	bool apart = false;
	for (int k = 0; k < 3; k++)
		apart |= n->bound[k][i] > box->high[k] || n->bound[3 + k][i] < box->low[k];
	return !apart;
}

static bool face_meets(chains *c, int i, int32_t face, int k, double p[3][3], const box3 *box)
{
	const shape *own = c->bodies[i].shape, *s = c->bodies[k].shape;
	int32_t stack[TREE_STACK], top = 1;
	stack[0] = 0;
	while (top) {
		const tree_node *n = s->tree.nodes + stack[--top];
		for (int slot = 0; slot < TREE_WIDE; slot++) {
			if (!overlaps(n, slot, box))
				continue;
			if (n->child[slot] >= 0) {
				stack[top++] = n->child[slot];
				continue;
			}
			tree_leaf leaf = s->tree.leaves[~n->child[slot]];
			for (int32_t at = leaf.from; at < leaf.from + leaf.count; at++) {
				int32_t other = s->order[at];
				if (i == k && (other <= face || own->piece[face] == own->piece[other]))
					continue;
				meet m = {.body = {i, k}, .face = {face, other}};
				double both[2][3][3];
				memcpy(both[0], p, sizeof both[0]);
				world_face(c->bodies[k].mesh, other, both[1]);
				if (faces_meet(c, both, &m) && !add_meet(c->kept, &m))
					return false;
			}
		}
	}
	return true;
}

/* False without memory. */
static bool bodies_meet(chains *c, int i, int k)
{
	if (i != k && c->bodies[i].shape->n_triangles > c->bodies[k].shape->n_triangles) {
		int swapped = i;
		i = k;
		k = swapped;
	}
	for (int32_t face = 0; face < c->bodies[i].shape->n_triangles; face++) {
		double p[3][3];
		box3 box;
		world_face(c->bodies[i].mesh, face, p);
		if (box_in(c->bodies + k, p, &box) && !face_meets(c, i, face, k, p, &box))
			return false;
	}
	return true;
}

/* Whether a mesh has more than one piece, which can meet. */
static bool has_pieces(const shape *s)
{
	for (int32_t i = 1; i < s->n_triangles; i++)
		if (s->piece[i] != s->piece[0])
			return true;
	return false;
}

/* ---- all pairs ------------------------------------------------------------------------------------------------- */

static int by_number(const void *a, const void *b)
{
	return *(const int *)a - *(const int *)b;
}

/* Bodies from number i on whose boxes overlap that of i, in order; `found` has room for all. */
static int neighbours_of(const chains *c, int i, int *found)
{
	const body *b = c->bodies + i;
	int32_t stack[TREE_STACK], top = 1;
	int n = 0;
	stack[0] = 0;
	while (top) {
		const tree_node *node = c->tree.nodes + stack[--top];
		for (int slot = 0; slot < TREE_WIDE; slot++) {
			bool apart = false;
			for (int k = 0; k < 3; k++)
				apart |= (double)node->bound[k][slot] > b->high[k] ||
					 (double)node->bound[3 + k][slot] < b->low[k];
			if (apart)
				continue;
			if (node->child[slot] >= 0)
				stack[top++] = node->child[slot];
			else if (c->order[c->tree.leaves[~node->child[slot]].from] >= i)
				found[n++] = c->order[c->tree.leaves[~node->child[slot]].from];
		}
	}
	qsort(found, (size_t)n, sizeof *found, by_number);
	return n;
}

static bool same_place(const struct placed *p, const body *b)
{
	return b->shape && p->key[0] == b->shape->key[0] && p->key[1] == b->shape->key[1] &&
	       !memcmp(p->model, b->mesh->model, sizeof p->model);
}

/* Before all: what is kept of the last job, by pairs. */
typedef struct former {
	meet_pair *pairs;
	meet *meets;
	int64_t n_pairs, at;
} former;

static bool add_pair(kept_shapes *kept, int i, int k, int64_t first)
{
	meet_pair *pairs = with_room(kept->pairs, sizeof *pairs, kept->n_pairs, &kept->room_pairs);
	if (!pairs)
		return false;
	kept->pairs = pairs;
	kept->pairs[kept->n_pairs++] = (meet_pair){{i, k}, first, kept->n_meets - first};
	return true;
}

static const meet_pair *known_pair(former *f, int i, int k)
{
	while (f->at < f->n_pairs &&
	       (f->pairs[f->at].body[0] < i || (f->pairs[f->at].body[0] == i && f->pairs[f->at].body[1] < k)))
		f->at++;
	const meet_pair *p = f->pairs + f->at;
	return f->at < f->n_pairs && p->body[0] == i && p->body[1] == k ? p : NULL;
}

static bool pair_of(chains *c, former *f, int i, int k, const bool *moved)
{
	kept_shapes *kept = c->kept;
	const meet_pair *known = known_pair(f, i, k);
	int64_t first = kept->n_meets;
	if (known && !moved[i] && !moved[k]) {
		for (int64_t m = 0; m < known->count; m++)
			if (!add_meet(kept, f->meets + known->first + m))
				return false;
		return add_pair(kept, i, k, first);
	}
	if (!c->bodies[i].near || !c->bodies[k].near || (i == k && !has_pieces(c->bodies[i].shape)))
		return true;
	return bodies_meet(c, i, k) && add_pair(kept, i, k, first);
}

static int32_t find_pairs(chains *c, former *f, const bool *moved, int *found)
{
	for (int i = 0; i < c->n_bodies; i++) {
		int n = c->bodies[i].solid ? neighbours_of(c, i, found) : 0;
		for (int at = 0; at < n; at++)
			if (!pair_of(c, f, i, found[at], moved))
				return ENCRE_ERROR_MEMORY;
		int32_t code = n ? bands_poll(c->pool) : ENCRE_OK;
		if (code)
			return code;
	}
	return ENCRE_OK;
}

static int32_t place(chains *c, bool *moved)
{
	kept_shapes *kept = c->kept;
	for (int i = 0; i < c->n_bodies; i++)
		moved[i] = i >= kept->n_placed || !same_place(kept->placed + i, c->bodies + i);
	struct placed *placed = malloc(((size_t)c->n_bodies + 1) * sizeof *placed);
	if (!placed)
		return ENCRE_ERROR_MEMORY;
	free(kept->placed);
	kept->placed = placed;
	kept->n_placed = c->n_bodies;
	for (int i = 0; i < c->n_bodies; i++) {
		const shape *s = c->bodies[i].shape;
		placed[i] = (struct placed){.key = {s ? s->key[0] : 0, s ? s->key[1] : 0}};
		memcpy(placed[i].model, c->bodies[i].mesh->model, sizeof placed[i].model);
	}
	return ENCRE_OK;
}

int32_t meets_find(chains *c)
{
	kept_shapes *kept = c->kept;
	former f = {kept->pairs, kept->meets, kept->n_pairs, 0};
	bool *moved = late_take(&c->late, (size_t)c->n_bodies + 1, sizeof *moved);
	int *found = late_take(&c->late, (size_t)c->n_bodies + 1, sizeof *found);
	kept->pairs = NULL;
	kept->meets = NULL;
	kept->n_pairs = kept->room_pairs = kept->n_meets = kept->room_meets = 0;
	int32_t code = moved && found ? place(c, moved) : ENCRE_ERROR_MEMORY;
	if (!code && c->tree.n_nodes)
		code = find_pairs(c, &f, moved, found);
	if (code) /* what is known then is not of these bodies */
		kept->n_placed = 0;
	free(f.pairs);
	free(f.meets);
	return code;
}
