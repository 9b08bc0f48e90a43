/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Where bends over several faces meet in a corner: their lines go on over its edges to each other. */
#include "chains/shapes.h"

#include <stdlib.h>

enum { NEAR = 128 /* points about an end of a strip that are looked at */ };
static const double corners = 2.5; /* of its width: so far it may be to the next strip */

/* Edges that bend, by their ends. */
typedef struct web {
	shape *s;
	const recipe *r;
	uint32_t *first; /* by point, and one more */
	int32_t *edge;
	uint8_t *ends; /* by point: how many edges of strips end there */
} web;

static int32_t other_end(const mesh_edge *e, int32_t point)
{
	return e->end[e->end[0] == point];
}

static void note_strip(const web *w, int32_t number, int32_t strip)
{
	mesh_edge *e = w->s->edges + number;
	e->strip = strip;
	for (int k = 0; k < 2; k++)
		w->ends[e->end[k]] += w->ends[e->end[k]] < 255;
}

/* Goes on from the end of a strip over the edges of a corner to the nearest point of another. */
static void join_end(const web *w, int32_t number, int32_t point)
{
	const mesh_edge *edges = w->s->edges;
	int32_t points[NEAR] = {point}, by[NEAR] = {number}, from[NEAR] = {-1}, strip = edges[number].strip;
	double far[NEAR] = {0}, most_far, a[3], b[3];
	bool done[NEAR] = {false};
	int count = 1;
	const struct strip *t = w->s->strips + strip;
	for (int k = 0; k < 3; k++) {
		a[k] = (double)t->end[0][k];
		b[k] = (double)t->end[1][k];
	}
	minus3(b, a, b);
	recipe_stretch(w->r, b, a);
	most_far = corners * sqrt(dot3(a, a));
	for (;;) {
		int i = -1;
		for (int k = 0; k < count; k++)
			i = !done[k] && (i < 0 || far[k] < far[i]) ? k : i;
		if (i < 0)
			return;
		done[i] = true;
		if (i && w->ends[points[i]]) {
			for (; i; i = from[i])
				if (edges[by[i]].strip < 0)
					note_strip(w, by[i], strip);
			return;
		}
		for (uint32_t k = w->first[points[i]]; k < w->first[points[i] + 1]; k++) {
			int32_t at = w->edge[k], end = other_end(edges + at, points[i]);
			double away = far[i] + recipe_edge_length(w->r, edges + at);
			int same = 0;
			while (same < count && points[same] != end)
				same++;
			if (at == number || away > most_far || same == NEAR || (same < count && !(away < far[same])))
				continue;
			points[same] = end;
			by[same] = at;
			from[same] = i;
			far[same] = away;
			count += same == count;
		}
	}
}

static bool is_of_web(const mesh_edge *e)
{
	return e->bend >= strip_flat && !(e->flags & (EDGE_BORDER | EDGE_MANY | EDGE_NEVER));
}

bool strips_join(const recipe *r, shape *s)
{
	size_t points = (size_t)r->mesh->n_points;
	int32_t own = s->n_strips;
	web w = {.s = s,
		 .r = r,
		 .first = calloc(points + 2, sizeof *w.first),
		 .edge = malloc(2 * ((size_t)s->n_edges + 1) * sizeof *w.edge),
		 .ends = calloc(points + 1, 1)};
	bool made = w.first && w.edge && w.ends;
	for (int32_t i = 0; made && i < s->n_edges; i++)
		for (int k = 0; k < 2 && is_of_web(s->edges + i); k++)
			w.first[s->edges[i].end[k] + 2]++;
	for (size_t i = 0; made && i < points; i++)
		w.first[i + 2] += w.first[i + 1];
	for (int32_t i = 0; made && i < s->n_edges; i++)
		for (int k = 0; k < 2 && is_of_web(s->edges + i); k++)
			w.edge[w.first[s->edges[i].end[k] + 1]++] = i;
	for (int32_t i = 0; made && i < own; i++)
		note_strip(&w, s->strips[i].edge, i);
	for (int32_t i = 0; made && i < own; i++)
		for (int k = 0; k < 2; k++) {
			int32_t number = s->strips[i].edge, point = s->edges[number].end[k];
			if (w.ends[point] == 1)
				join_end(&w, number, point);
		}
	free(w.ends);
	free(w.edge);
	free(w.first);
	return made;
}
