/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Edges are filed under their lower points, and found again by the higher; points at which a triangle has no length
 * stand for each other. What only one triangle has is welded where another such edge lies at its place. Pieces of
 * meshes: points are joined by each triangle and weld, with ways to the root that are halved as they are walked. */
#include "raster/topology.h"

#include "base/arena.h"

#include <stdlib.h>
#include <string.h>

/* ---- edges ------------------------------------------------------------------------------------------------- */

typedef struct edge_list {
	uint32_t *corner; /* those of each point, at which an edge's lower point stands, in the order of the mesh */
	uint32_t *start;  /* n_points + 1: where a point's begin */
	uint32_t *met;    /* by higher point: where in `corner` the edge was met last, plus 1 */
	int32_t *same; /* by point: itself, or one before it that stands for it too; NULL: all stand for themselves */
} edge_list;

/* A triangle with two corners at one place is none, and has no edges. */
static inline bool is_flat(const encre_mesh *mesh, uint32_t i)
{
	int32_t a = topology_point(mesh, 3 * i), b = topology_point(mesh, 3 * i + 1),
		c = topology_point(mesh, 3 * i + 2);
	return topology_same_place(mesh, a, b) || topology_same_place(mesh, b, c) || topology_same_place(mesh, c, a);
}

static inline int32_t first_at(const edge_list *list, int32_t point)
{
	while (list->same && list->same[point] != point)
		point = list->same[point];
	return point;
}

/* Where a pole or a tip has a point for each meridian, what meets at one of them meets there. */
static void find_same(const encre_mesh *mesh, edge_list *list)
{
	int32_t *same = list->same;
	list->same = NULL;
	for (uint32_t i = 0; i < (uint32_t)mesh->n_primitives; i++)
		for (uint32_t k = 0; is_flat(mesh, i) && k < 3; k++) {
			int32_t a = topology_point(mesh, 3 * i + k), b = topology_point(mesh, 3 * i + (k + 1) % 3);
			if (!topology_same_place(mesh, a, b))
				continue;
			for (int32_t p = 0; !list->same && p < mesh->n_points; p++)
				same[p] = p;
			list->same = same;
			a = first_at(list, a);
			b = first_at(list, b);
			same[a > b ? a : b] = a < b ? a : b;
		}
}

static inline int32_t end_at(const encre_mesh *mesh, const edge_list *list, uint32_t corner)
{
	return first_at(list, topology_point(mesh, corner));
}

static inline void ends_of(const encre_mesh *mesh, const edge_list *list, uint32_t corner, int32_t *low, int32_t *high)
{
	int32_t a = end_at(mesh, list, corner);
	int32_t b = end_at(mesh, list, corner % 3 == 2 ? corner - 2 : corner + 1);
	*low = a < b ? a : b;
	*high = a < b ? b : a;
}

static void file_edges(const encre_mesh *mesh, uint32_t corners, edge_list *list)
{
	int32_t low, high;
	for (uint32_t c = 0; c < corners; c++) {
		ends_of(mesh, list, c, &low, &high);
		list->start[low + 1] += low != high && !(list->same && is_flat(mesh, c / 3));
	}
	for (int32_t p = 0; p < mesh->n_points; p++)
		list->start[p + 1] += list->start[p];
	for (uint32_t c = 0; c < corners; c++) {
		ends_of(mesh, list, c, &low, &high);
		if (low != high && !(list->same && is_flat(mesh, c / 3)))
			list->corner[list->start[low]++] = c;
	}
	for (int32_t p = mesh->n_points; p > 0; p--) /* filing has moved each to where the next one's begin */
		list->start[p] = list->start[p - 1];
	list->start[0] = 0;
}

/* Looks through the edges from a point to higher ones. */
static void join(const encre_mesh *mesh, int32_t point, const edge_list *list, topology *t)
{
	uint32_t from = list->start[point], end = list->start[point + 1];
	int32_t low, high;
	for (uint32_t k = from; k < end; k++) {
		uint32_t c = list->corner[k];
		ends_of(mesh, list, c, &low, &high);
		bool met = list->met[high] > from; /* at this point: places of earlier ones come before */
		if (met)
			t->next[list->corner[list->met[high] - 1]] = c;
		t->first[c / 3] |= (uint8_t)(!met << c % 3);
		list->met[high] = k + 1;
	}
}

static bool find_edges(const encre_mesh *mesh, topology *t)
{
	uint32_t corners = 3 * (uint32_t)mesh->n_primitives;
	size_t points = (size_t)mesh->n_points;
	edge_list list;
	arena a = {0};
	for (int pass = 0; pass < 2; pass++) {
		list.corner = arena_take(&a, corners, sizeof *list.corner);
		list.start = arena_take(&a, points + 1, sizeof *list.start);
		list.met = arena_take(&a, points, sizeof *list.met);
		list.same = arena_take(&a, points, sizeof *list.same);
		if (pass == 0 && !(a = (arena){.base = malloc(a.used)}).base)
			return false;
	}
	memset(list.start, 0, (points + 1) * sizeof *list.start);
	memset(list.met, 0, points * sizeof *list.met);
	memset(t->next, 0xff, corners * sizeof *t->next); /* NO_CORNER */
	memset(t->first, 0, (size_t)mesh->n_primitives);
	find_same(mesh, &list);
	file_edges(mesh, corners, &list);
	for (int32_t point = 0; point < mesh->n_points; point++)
		join(mesh, point, &list, t);
	free(a.base);
	return true;
}

/* ---- welds ------------------------------------------------------------------------------------------------- */

typedef struct weld_table {
	uint32_t *one, *other; /* corners of edges at one place: the first two; other: many if there are more */
	size_t mask;
} weld_table;

static const uint32_t many = NO_CORNER - 1;

static inline bool is_alone(const topology *t, uint32_t c)
{
	return t->first[c / 3] >> c % 3 & 1 && t->next[c] == NO_CORNER;
}

/* The ends of an edge, the lesser first by x, then y, then z. */
static void places_of(const encre_mesh *mesh, uint32_t c, const float *end[2])
{
	const float *a = mesh->points + 3 * (size_t)topology_point(mesh, c);
	const float *b = mesh->points + 3 * (size_t)topology_point(mesh, c % 3 == 2 ? c - 2 : c + 1);
	int k = 0;
	while (k < 2 && a[k] == b[k])
		k++;
	bool rises = a[k] <= b[k];
	end[0] = rises ? a : b;
	end[1] = rises ? b : a;
}

static size_t hash_of(const float *const end[2])
{
	uint64_t hash = 0;
	for (int k = 0; k < 6; k++) {
		float v = end[k / 3][k % 3] + 0.0f; /* -0 is 0 */
		uint32_t bits;
		memcpy(&bits, &v, sizeof bits);
		hash = (hash ^ bits) * 0x9e3779b97f4a7c15u;
		hash ^= hash >> 29;
	}
	return (size_t)hash;
}

static bool same_edge(const encre_mesh *mesh, uint32_t c, const float *const end[2])
{
	const float *own[2];
	places_of(mesh, c, own);
	for (int k = 0; k < 6; k++)
		if (own[k / 3][k % 3] != end[k / 3][k % 3])
			return false;
	return true;
}

static void enter(const encre_mesh *mesh, weld_table *w, uint32_t c)
{
	const float *end[2];
	places_of(mesh, c, end);
	size_t at = hash_of(end) & w->mask;
	while (w->one[at] != NO_CORNER && !same_edge(mesh, w->one[at], end))
		at = (at + 1) & w->mask;
	if (w->one[at] == NO_CORNER)
		w->one[at] = c;
	else
		w->other[at] = w->other[at] == NO_CORNER ? c : many;
}

/* Of meshes whose points were split, for flat shading or by a file that knows no others, each triangle would stand
 * alone. Of more than two edges at one place, as of leaves with two sides, none is welded. */
static bool weld(const encre_mesh *mesh, topology *t)
{
	uint32_t corners = 3 * (uint32_t)mesh->n_primitives;
	size_t alone = 0, room = 1;
	for (uint32_t c = 0; c < corners; c++)
		alone += is_alone(t, c);
	if (alone < 2)
		return true;
	while (room < 2 * alone)
		room *= 2;
	weld_table w = {.one = malloc(2 * room * sizeof *w.one), .mask = room - 1};
	if (!w.one)
		return false;
	w.other = w.one + room;
	memset(w.one, 0xff, 2 * room * sizeof *w.one); /* NO_CORNER */
	for (uint32_t c = 0; c < corners; c++)
		if (is_alone(t, c))
			enter(mesh, &w, c);
	for (size_t k = 0; k < room; k++) {
		uint32_t c = w.one[k], d = w.other[k];
		if (c == NO_CORNER || d >= many)
			continue;
		t->next[c] = d;
		t->first[d / 3] &= (uint8_t)~(1u << d % 3);
	}
	free(w.one);
	return true;
}

/* ---- pieces ------------------------------------------------------------------------------------------------ */

static bool find_pieces(const encre_mesh *mesh, topology *t)
{
	uint32_t n = (uint32_t)mesh->n_primitives, points = (uint32_t)mesh->n_points;
	uint32_t *above = malloc(2 * (size_t)points * sizeof *above), *first = above + points;
	if (!above)
		return false;
	for (uint32_t p = 0; p < points; p++) {
		above[p] = p;
		first[p] = UINT32_MAX;
	}
	for (uint32_t c = 0; c < 3 * n; c++) {
		uint32_t point = (uint32_t)topology_point(mesh, c);
		topology_unite(above, (uint32_t)topology_point(mesh, c / 3 * 3), point);
		if (t->next[c] != NO_CORNER) /* of a weld one end is enough */
			topology_unite(above, point, (uint32_t)topology_point(mesh, t->next[c]));
	}
	for (uint32_t i = 0; i < n; i++) {
		uint32_t root = topology_root(above, (uint32_t)topology_point(mesh, 3 * i));
		if (first[root] == UINT32_MAX)
			first[root] = i;
		t->piece[i] = first[root];
	}
	free(above);
	return true;
}

bool topology_find(const encre_mesh *mesh, topology *t)
{
	return find_edges(mesh, t) && weld(mesh, t) && find_pieces(mesh, t);
}
