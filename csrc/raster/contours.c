/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Contours of triangles. A surface ends on the screen where it turns away from the eye, is cut off or changes its
 * number. That is told from the sides of an edge on which its triangles lie, in whatever sense their corners go round:
 * on one only, and the surface ends or folds there. Where it goes on it may bend: that is told by its triangles'
 * normals in the world, whichever way round their corners go. */
#include "raster/contours.h"

#include "base/pixel.h"

#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>

enum {
	DIFFERENT = 4, /* beside the sides: numbers differ */
	SHARED = 8,    /* likewise: several triangles have it */
	FACING = 9,    /* above the bits of the edges */
};

static inline int32_t point_at(const encre_mesh *mesh, uint32_t corner)
{
	return mesh->corners ? mesh->corners[corner] : (int32_t)corner;
}

/* The edges of a mesh by their points: corner i begins the edge to the next corner of its triangle. */
typedef struct edge_list {
	uint32_t *corner;    /* those of each point, at which an edge's lower point stands, in the order of the mesh */
	uint32_t *start;     /* n_points + 1: where a point's begin */
	uint32_t *first;     /* by higher point: where in `corner` the edge was met first, plus 1 */
	uint8_t *cover;      /* by where it was met first: sides, going from the lower point */
	uint16_t *bend;      /* likewise: the most that two triangles bend there; NULL where nobody asks */
	corner *seen;        /* by point: on the screen */
	double (*across)[3]; /* by triangle: as geometry_across(), with `bend` only */
	int32_t *same; /* by point: the first of those that corners of one triangle have at its place; NULL: none have
			*/
} edge_list;

static inline int32_t first_at(const edge_list *list, int32_t point)
{
	while (list->same && list->same[point] != point)
		point = list->same[point];
	return point;
}

static inline int32_t end_at(const encre_mesh *mesh, const edge_list *list, uint32_t corner)
{
	return first_at(list, point_at(mesh, corner));
}

static inline void ends_of(const encre_mesh *mesh, const edge_list *list, uint32_t corner, int32_t *low, int32_t *high)
{
	int32_t a = end_at(mesh, list, corner), b = end_at(mesh, list, corner % 3 == 2 ? corner - 2 : corner + 1);
	*low = a < b ? a : b;
	*high = a < b ? b : a;
}

static inline bool same_place(const corner *a, const corner *b)
{
	return a->x == b->x && a->y == b->y && a->z == b->z && a->w == b->w;
}

/* Where the triangle lies beside each of its edges, also where a corner lies behind the eye. What is no triangle, as
 * at a pole or a tip with a point for each meridian, parts nothing: as if it lay on both sides. */
static enum contour_side facing(const encre_mesh *mesh, const corner *seen, uint32_t i)
{
	const corner *a = seen + point_at(mesh, 3 * i), *b = seen + point_at(mesh, 3 * i + 1),
		     *c = seen + point_at(mesh, 3 * i + 2);
	if (same_place(a, b) || same_place(b, c) || same_place(c, a))
		return CONTOUR_BOTH;
	double volume = a->x * (b->y * c->w - c->y * b->w) + b->x * (c->y * a->w - a->y * c->w) +
			c->x * (a->y * b->w - b->y * a->w);
	return volume > 0 ? CONTOUR_RIGHT : volume < 0 ? CONTOUR_LEFT : CONTOUR_NONE;
}

static inline enum contour_side turned(enum contour_side side)
{
	return side == CONTOUR_RIGHT ? CONTOUR_LEFT : side == CONTOUR_LEFT ? CONTOUR_RIGHT : side;
}

static bool same_numbers(const encre_mesh *mesh, uint32_t i, uint32_t j)
{
	return (!mesh->object || mesh->object[i] == mesh->object[j]) &&
	       (!mesh->material || mesh->material[i] == mesh->material[j]);
}

static enum encre_edge edge_at(const encre_mesh *mesh, uint32_t corner)
{
	return mesh->edges ? (enum encre_edge)(mesh->edges[corner / 3] >> 2 * (corner % 3) & 3) : ENCRE_EDGE_FLAT;
}

/* How much the surface bends between the triangles of two corners at which the same edge begins or ends. */
static uint16_t bend_of(const encre_mesh *mesh, const edge_list *list, uint32_t c, uint32_t d)
{
	enum encre_edge one = edge_at(mesh, c), other = edge_at(mesh, d), edge = one < other ? one : other;
	if (one >= ENCRE_EDGE_NONE || other >= ENCRE_EDGE_NONE)
		return 0;
	const double *a = list->across[c / 3], *b = list->across[d / 3];
	double along = 0, sine = 0;
	double turn =
		end_at(mesh, list, c) == end_at(mesh, list, d) ? -1 : 1; /* else they go along it in opposite ways */
	for (int k = 0; k < 3; k++) {
		int i = (k + 1) % 3, j = (k + 2) % 3;
		double s = a[i] * b[j] - a[j] * b[i];
		along += turn * a[k] * b[k];
		sine += s * s;
	}
	double longest = fmax(sqrt(sine), fabs(along)); /* products of areas: too large or too small for a float */
	if (!(longest > 0 && longest < INFINITY))
		return 0;
	double degrees =
		57.29577951308232 * (double)pixel_atan2((float)(sqrt(sine) / longest), (float)(along / longest));
	double bend = BEND_UNIT * (degrees + (double)mesh->crease_offset) + 0.5;
	if (!(bend >= BEND_LEAST))
		return 0;
	return (uint16_t)((bend < BEND_MOST ? (int)bend : BEND_MOST) | (edge == ENCRE_EDGE_SMOOTH ? BEND_SMOOTH : 0));
}

static void bend_more(uint16_t *bend, uint16_t other)
{
	if ((other & ~BEND_SMOOTH) > (*bend & ~BEND_SMOOTH))
		*bend = other;
}

/* Where a pole or a tip has a point for each meridian, what meets at one of them meets there. */
static void find_same(const encre_mesh *mesh, const uint16_t *edges, uint32_t n, edge_list *list)
{
	int32_t *same = list->same;
	list->same = NULL;
	for (uint32_t i = 0; i < n; i++)
		for (uint32_t k = 0; edges[i] >> FACING == CONTOUR_BOTH && k < 3; k++) {
			int32_t a = point_at(mesh, 3 * i + k), b = point_at(mesh, 3 * i + (k + 1) % 3);
			if (!same_place(list->seen + a, list->seen + b))
				continue;
			for (int32_t p = 0; !list->same && p < mesh->n_points; p++)
				same[p] = p;
			list->same = same;
			a = first_at(list, a);
			b = first_at(list, b);
			same[a > b ? a : b] = a < b ? a : b;
		}
}

/* Files the edges under their lower points; one between a point and itself is none. */
static void file_edges(const encre_mesh *mesh, uint32_t corners, const uint16_t *edges, edge_list *list)
{
	int32_t low, high;
	for (uint32_t c = 0; c < corners; c++) {
		ends_of(mesh, list, c, &low, &high);
		list->start[low + 1] += low != high && edges[c / 3] >> FACING != CONTOUR_BOTH;
	}
	for (int32_t p = 0; p < mesh->n_points; p++)
		list->start[p + 1] += list->start[p];
	for (uint32_t c = 0; c < corners; c++) {
		ends_of(mesh, list, c, &low, &high);
		if (low != high && edges[c / 3] >> FACING != CONTOUR_BOTH)
			list->corner[list->start[low]++] = c;
	}
	for (int32_t p = mesh->n_points; p > 0; p--) /* filing has moved each to where the next one's begin */
		list->start[p] = list->start[p - 1];
	list->start[0] = 0;
}

/* Looks through the edges from a point to higher ones. edges[i] has what facing() says of triangle i above its edges.
 */
static void join(const encre_mesh *mesh, int32_t point, const edge_list *list, uint16_t *edges, uint16_t *bends)
{
	uint32_t from = list->start[point], end = list->start[point + 1];
	int32_t low, high;
	for (uint32_t k = from; k < end; k++) {
		uint32_t c = list->corner[k];
		ends_of(mesh, list, c, &low, &high);
		bool met = list->first[high] > from; /* at this point: places of earlier ones come before */
		if (!met) {
			list->first[high] = k + 1;
			list->cover[k] = 0;
			if (bends)
				list->bend[k] = 0;
		}
		uint32_t first = list->first[high] - 1;
		if (bends && met)
			bend_more(list->bend + first, bend_of(mesh, list, list->corner[first], c));
		enum contour_side side = (enum contour_side)(edges[c / 3] >> FACING);
		list->cover[first] |= (uint8_t)(end_at(mesh, list, c) == point ? side : turned(side));
		list->cover[first] |= met ? SHARED : 0;
		list->cover[first] |= same_numbers(mesh, c / 3, list->corner[first] / 3) ? 0 : DIFFERENT;
	}
	for (uint32_t k = from; k < end; k++) {
		uint32_t c = list->corner[k];
		ends_of(mesh, list, c, &low, &high);
		if (list->first[high] != k + 1)
			continue;
		if (bends)
			bends[c] = list->bend[k];
		if ((list->cover[k] & ~SHARED) == CONTOUR_BOTH)
			continue;
		enum contour_side side = (enum contour_side)(list->cover[k] & CONTOUR_BOTH);
		side = list->cover[k] & DIFFERENT ? CONTOUR_BOTH : end_at(mesh, list, c) == point ? side : turned(side);
		unsigned fold = list->cover[k] & SHARED && side != CONTOUR_BOTH;
		edges[c / 3] |= (uint16_t)(side << 2 * (c % 3) | fold << (CONTOUR_FOLDS + c % 3));
	}
}

/* bends: all 0, or NULL. */
static bool find(const part *part, uint16_t *edges, uint16_t *bends)
{
	const encre_mesh *mesh = part->mesh;
	uint32_t n = (uint32_t)mesh->n_primitives;
	size_t points = (size_t)mesh->n_points;
	edge_list list;
	arena a = {0};
	for (int pass = 0; pass < 2; pass++) {
		list.seen = arena_take(&a, points, sizeof *list.seen);
		list.across = bends ? arena_take(&a, n, sizeof *list.across) : NULL;
		list.same = arena_take(&a, points, sizeof *list.same);
		list.corner = arena_take(&a, (size_t)3 * n, sizeof *list.corner);
		list.start = arena_take(&a, points + 1, sizeof *list.start);
		list.first = arena_take(&a, points, sizeof *list.first);
		list.cover = arena_take(&a, (size_t)3 * n, sizeof *list.cover);
		list.bend = bends ? arena_take(&a, (size_t)3 * n, sizeof *list.bend) : NULL;
		if (pass == 0 && !(a = (arena){.base = malloc(a.used)}).base)
			return false;
	}
	memset(list.start, 0, (points + 1) * sizeof *list.start);
	memset(list.first, 0, points * sizeof *list.first);
	for (size_t k = 0; k < points; k++)
		list.seen[k] = geometry_corner(part, mesh->points + 3 * k);
	for (uint32_t i = 0; i < n; i++) {
		edges[i] = (uint16_t)(facing(mesh, list.seen, i) << FACING);
		if (bends)
			geometry_across(part, i, list.across[i]);
	}
	find_same(mesh, edges, n, &list);
	file_edges(mesh, 3 * n, edges, &list);
	for (int32_t point = 0; point < mesh->n_points; point++)
		join(mesh, point, &list, edges, bends);
	for (uint32_t i = 0; i < n; i++)
		edges[i] &= (1 << FACING) - 1;
	free(a.base);
	return true;
}

typedef struct search {
	const geometry *g;
	uint16_t *edges, *bends;
	atomic_bool failed;
} search;

static void find_parts(void *data, int p0, int p1, int thread)
{
	(void)thread;
	search *s = data;
	for (int p = p0; p < p1; p++) {
		const part *part = s->g->parts + p;
		uint16_t *bends = s->bends ? s->bends + (size_t)3 * part->first : NULL;
		if (part->mesh->kind == ENCRE_TRIANGLES && !find(part, s->edges + part->first, bends))
			atomic_store(&s->failed, true);
	}
}

int32_t contours_find(bands *pool, const geometry *g, uint16_t *edges, uint16_t *bends)
{
	search s = {.g = g, .edges = edges, .bends = bends};
	if (bends)
		memset(bends, 0, (size_t)3 * g->n_primitives * sizeof *bends);
	atomic_init(&s.failed, false);
	int32_t code = bands_run(pool, g->n_parts, 1, find_parts, &s);
	return code ? code : atomic_load(&s.failed) ? ENCRE_ERROR_MEMORY : ENCRE_OK;
}
