/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What a mesh is made of: points at one place, edges with how much the surface bends there, and a tree of triangles. */
#include "chains/shapes.h"

#include <stdlib.h>
#include <string.h>

enum { LEAF_TRIANGLES = 4 };

static bool find_places(shape *s, const encre_mesh *m)
{
	size_t room = 16;
	while (room < 2 * (size_t)m->n_points)
		room *= 2;
	int32_t *table = malloc(room * sizeof *table);
	if (!table)
		return false;
	memset(table, 0xff, room * sizeof *table);
	for (int32_t i = 0; i < m->n_points; i++) {
		const float *p = m->points + 3 * (size_t)i;
		uint64_t h = 0;
		for (int k = 0; k < 3; k++) {
			float value = p[k] + 0.0f; /* -0 is 0 */
			uint32_t bits;
			memcpy(&bits, &value, 4);
			h = stir((h ^ bits) * 0x9e3779b97f4a7c15u);
		}
		size_t at = h & (room - 1);
		for (; table[at] >= 0; at = (at + 1) & (room - 1)) {
			const float *q = m->points + 3 * (size_t)table[at];
			if (q[0] == p[0] && q[1] == p[1] && q[2] == p[2])
				break;
		}
		if (table[at] < 0)
			table[at] = i;
		s->place[i] = table[at];
	}
	free(table);
	return true;
}

static enum encre_edge told_of(const encre_mesh *m, uint32_t corner)
{
	return m->edges ? (enum encre_edge)(m->edges[corner / 3] >> 2 * (corner % 3) & 3) : ENCRE_EDGE_FLAT;
}

static void find_edge(const recipe *r, const shape *s, uint32_t c, mesh_edge *e)
{
	const encre_mesh *m = r->mesh;
	uint32_t second = s->next[c];
	*e = (mesh_edge){.end = {s->place[topology_point(m, c)], s->place[topology_point(m, next_corner(c))]},
			 .face = {(int32_t)(c / 3), -1},
			 .corner = c};
	enum encre_edge told = told_of(m, c);
	bool never = told == ENCRE_EDGE_NONE, smooth = told == ENCRE_EDGE_SMOOTH;
	double own[3];
	if (second == NO_CORNER) {
		e->flags = EDGE_BORDER | (smooth ? EDGE_ROUND : 0);
		return;
	}
	e->face[1] = (int32_t)(second / 3);
	recipe_across(r, e->face[0], own);
	for (uint32_t d = second; d != NO_CORNER; d = s->next[d]) {
		int32_t face = (int32_t)(d / 3);
		bool same = s->place[topology_point(m, d)] == e->end[0];
		double other[3];
		recipe_across(r, face, other);
		for (int k = 0; k < 3 && same; k++)
			other[k] = -other[k];
		e->bend = max(e->bend, angle3(own, other));
		told = told_of(m, d);
		never |= told == ENCRE_EDGE_NONE;
		smooth &= told == ENCRE_EDGE_SMOOTH;
		e->flags |= (d != second ? EDGE_MANY : 0) | (d == second && same ? EDGE_SAME_WAY : 0) |
			    (object_of(m, face) != object_of(m, e->face[0]) ? EDGE_OBJECT : 0) |
			    (material_of(m, face) != material_of(m, e->face[0]) ? EDGE_MATERIAL : 0);
	}
	e->flags |= never ? EDGE_NEVER : smooth ? EDGE_SMOOTH : 0;
}

/* A rim of a round form is no smooth edge itself, but its points are on edges across it that are, and bend. */
static bool find_round(const shape *s, const encre_mesh *m)
{
	const float least_bend = 3; /* degrees */
	uint8_t *round = calloc((size_t)m->n_points + 1, 1);
	if (!round)
		return false;
	for (int32_t i = 0; i < s->n_edges; i++) {
		const mesh_edge *e = s->edges + i;
		if (e->flags & EDGE_SMOOTH && e->bend >= least_bend)
			round[e->end[0]] = round[e->end[1]] = 1;
	}
	for (int32_t i = 0; i < s->n_edges; i++) {
		mesh_edge *e = s->edges + i;
		e->flags |= e->flags & EDGE_SMOOTH || (round[e->end[0]] && round[e->end[1]]) ? EDGE_ROUND : 0;
	}
	free(round);
	return true;
}

static bool find_edges(const recipe *r, shape *s)
{
	uint32_t corners = 3 * (uint32_t)s->n_triangles;
	for (uint32_t c = 0; c < corners; c++)
		s->n_edges += s->first[c / 3] >> c % 3 & 1;
	s->edges = malloc(((size_t)s->n_edges + 1) * sizeof *s->edges);
	if (!s->edges)
		return false;
	memset(s->edge_of, 0xff, (size_t)corners * sizeof *s->edge_of);
	int32_t n = 0;
	for (uint32_t c = 0; c < corners; c++) {
		if (!(s->first[c / 3] >> c % 3 & 1))
			continue;
		for (uint32_t d = c; d != NO_CORNER; d = s->next[d])
			s->edge_of[d] = n;
		find_edge(r, s, c, s->edges + n++);
	}
	return find_round(s, r->mesh);
}

static double volume_of(const encre_mesh *m, int32_t face)
{
	double p[3][3], across[3];
	for (uint32_t k = 0; k < 3; k++)
		for (int i = 0; i < 3; i++)
			p[k][i] = (double)m->points[3 * (size_t)topology_point(m, 3 * (uint32_t)face + k) + (size_t)i];
	cross3(p[1], p[2], across);
	return dot3(p[0], across);
}

/* Of the pieces that have an inside: two triangles at each edge, which go round alike. */
static bool find_closed(shape *s, const encre_mesh *m)
{
	double *volume = calloc((size_t)s->n_triangles + 1, sizeof *volume);
	uint8_t *open = calloc((size_t)s->n_triangles + 1, 1);
	for (int32_t i = 0; volume && open && i < s->n_edges; i++)
		open[s->piece[s->edges[i].face[0]]] |=
			(s->edges[i].flags & (EDGE_BORDER | EDGE_MANY | EDGE_SAME_WAY)) != 0;
	for (int32_t i = 0; volume && open && i < s->n_triangles; i++)
		volume[s->piece[i]] += volume_of(m, i);
	for (int32_t i = 0; volume && open && i < s->n_triangles; i++) {
		double v = volume[s->piece[i]];
		s->closed[i] = (int8_t)(open[s->piece[i]] ? 0 : (v > 0) - (v < 0));
	}
	free(open);
	free(volume);
	return volume && open;
}

static bool find_tree(shape *s, const encre_mesh *m)
{
	tree_box *boxes = malloc(((size_t)s->n_triangles + 1) * sizeof *boxes);
	int32_t n = 0;
	if (!boxes)
		return false;
	for (int32_t i = 0; i < s->n_triangles; i++) {
		tree_box b = {.item = i};
		float sum = 0;
		for (uint32_t k = 0; k < 3; k++) {
			const float *p = m->points + 3 * (size_t)topology_point(m, 3 * (uint32_t)i + k);
			for (int j = 0; j < 3; j++) {
				b.low[j] = k ? min(b.low[j], p[j]) : p[j];
				b.high[j] = k ? max(b.high[j], p[j]) : p[j];
				sum += p[j] * 0;
			}
		}
		if (sum == 0)
			boxes[n++] = b;
	}
	bool built = tree_build(&s->tree, boxes, n, LEAF_TRIANGLES);
	for (int32_t i = 0; i < n; i++)
		s->order[i] = boxes[i].item;
	free(boxes);
	return built;
}

static bool find_lines(shape *s, const encre_mesh *m)
{
	s->edges = calloc((size_t)m->n_primitives + 1, sizeof *s->edges);
	if (!s->edges)
		return false;
	s->n_edges = m->n_primitives;
	for (int32_t i = 0; i < 2 * m->n_primitives; i++) {
		mesh_edge *e = s->edges + i / 2;
		e->end[i % 2] = s->place[m->corners ? m->corners[i] : i];
		e->face[i % 2] = e->strip = -1;
	}
	return true;
}

void shape_free(shape *s)
{
	if (!s)
		return;
	tree_free(&s->tree);
	free(s->edges);
	free(s->strips);
	free(s->edge_of);
	free(s->place);
	free(s->next);
	free(s->closed);
	free(s->piece);
	free(s->first);
	free(s->order);
	free(s);
}

shape *shape_make(const recipe *r)
{
	const encre_mesh *m = r->mesh;
	shape *s = calloc(1, sizeof *s);
	if (!s)
		return NULL;
	memcpy(s->key, r->key, sizeof s->key);
	size_t n = is_line(m) ? 0 : (size_t)m->n_primitives;
	s->n_triangles = (int32_t)n;
	s->place = calloc((size_t)m->n_points + 1, sizeof *s->place);
	s->edge_of = malloc((3 * n + 1) * sizeof *s->edge_of);
	s->next = malloc((3 * n + 1) * sizeof *s->next);
	s->piece = malloc((n + 1) * sizeof *s->piece);
	s->first = malloc(n + 1);
	s->closed = calloc(n + 1, 1);
	s->order = malloc((n + 1) * sizeof *s->order);
	bool made =
		s->place && s->edge_of && s->next && s->piece && s->first && s->closed && s->order && find_places(s, m);
	if (made && is_line(m))
		made = find_lines(s, m);
	else if (made) {
		topology t = {.next = s->next, .first = s->first, .piece = s->piece};
		made = topology_find(m, &t) && find_edges(r, s) && strips_find(r, s) && find_closed(s, m) &&
		       find_tree(s, m);
	}
	if (made)
		return s;
	shape_free(s);
	return NULL;
}
