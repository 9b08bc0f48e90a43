/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Bends over several faces, as of bevels: found once for what a mesh is made of, whatever size they are. From an edge
 * beside which the surface is flat it is followed over what bends, from triangle to triangle, to where it is flat
 * again. From afar that is one line, at the edge in its middle. */
#include "chains/shapes.h"

#include <stdlib.h>
#include <string.h>

enum { STEPS = 52 /* triangles that are passed, at most */ };

static const float least = 20, most = 150; /* degrees that a strip bends */
static const double beside = 1.6;          /* of its width: so far it must be flat on both sides, */
static const float is_flat = .05f;         /* which is what turns less than this share of its bend */
static const float alike = .3f; /* of an edge's bend: what bends less beside it is flat, before more is known */

/* ---- across an edge ---------------------------------------------------------------------------------------- */

/* The way across an edge from its middle, in the space in which bends are measured. */
typedef struct section {
	const recipe *r;
	const shape *s;
	double middle[3], axis[3];
} section;

typedef struct side {
	int n;
	double far[STEPS + 1]; /* to edges that bend */
	float sum[STEPS + 1];  /* of their bends, with those before */
	int32_t edge[STEPS + 1];
	int32_t face[STEPS + 1]; /* beyond the edge; of 0, beside the first one */
	float at[STEPS + 1][3];  /* where it is crossed, object space */
	double end;              /* so far the surface has been followed */
	bool closed;             /* it ends there */
	/* where it goes on */
	int32_t ahead, over, under;
	double last[3], shares[2];
} side;

static const float *point_of(const section *s, int32_t number)
{
	return s->r->mesh->points + 3 * (size_t)number;
}

static double share_of_point(const section *s, int32_t number)
{
	double at[3];
	recipe_point(s->r, number, at);
	minus3(at, s->middle, at);
	return dot3(at, s->axis);
}

static void begin(const section *s, int32_t number, int32_t face, side *t)
{
	const mesh_edge *e = s->s->edges + number;
	t->n = 0;
	t->end = t->far[0] = 0;
	t->closed = false;
	t->sum[0] = 0;
	t->edge[0] = number;
	t->face[0] = t->ahead = face;
	t->over = e->end[1];
	t->under = e->end[0];
	memcpy(t->last, s->middle, sizeof t->last);
	t->shares[0] = share_of_point(s, t->over);
	t->shares[1] = share_of_point(s, t->under);
	for (int k = 0; k < 3; k++)
		t->at[0][k] = 0.5f * (point_of(s, t->over)[k] + point_of(s, t->under)[k]);
}

/* The edge by which the section leaves the triangle ahead; -1: none. */
static int32_t leaves_by(const section *s, side *t)
{
	const mesh_edge *edges = s->s->edges;
	uint32_t c = 3 * (uint32_t)t->ahead;
	int32_t third = -1;
	for (uint32_t d = c; d < c + 3; d++) {
		int32_t p = s->s->place[topology_point(s->r->mesh, d)];
		third = p != t->over && p != t->under ? p : third;
	}
	if (third < 0)
		return -1;
	double share = share_of_point(s, third);
	t->shares[share > 0 ? 0 : 1] = share;
	*(share > 0 ? &t->over : &t->under) = third;
	for (uint32_t d = c; d < c + 3; d++) {
		int32_t at = s->s->edge_of[d];
		if (at >= 0 &&
		    (edges[at].end[0] == t->over ? edges[at].end[1] == t->under
						 : edges[at].end[0] == t->under && edges[at].end[1] == t->over))
			return at;
	}
	return -1;
}

/* Follows the surface to the next edge that bends, at most as far as asked. False: there is none. */
static bool follow(const section *s, side *t, double far)
{
	for (int step = 0; step < STEPS && t->n < STEPS && t->end < far && !t->closed; step++) {
		int32_t number = leaves_by(s, t);
		const mesh_edge *e = s->s->edges + number;
		if (number < 0)
			return false;
		const float *p = point_of(s, t->over), *q = point_of(s, t->under);
		double f = t->shares[0] / (t->shares[0] - t->shares[1]), here[3], there[3], way[3];
		for (int k = 0; k < 3; k++)
			here[k] = (double)p[k] + f * ((double)q[k] - (double)p[k]);
		recipe_stretch(s->r, here, there);
		minus3(there, t->last, way);
		t->end += sqrt(dot3(way, way));
		memcpy(t->last, there, sizeof t->last);
		t->closed = e->flags & (EDGE_BORDER | EDGE_MANY);
		if (t->closed)
			return false;
		t->ahead = e->face[e->face[0] == t->ahead];
		if (e->bend < strip_flat)
			continue;
		int n = ++t->n;
		t->far[n] = t->end;
		t->sum[n] = t->sum[n - 1] + e->bend;
		t->edge[n] = number;
		t->face[n] = t->ahead;
		for (int k = 0; k < 3; k++)
			t->at[n][k] = (float)here[k];
		return true;
	}
	return false;
}

/* ---- strips ------------------------------------------------------------------------------------------------ */

/* Whether a side is flat as far as asked behind its edge i, but for so many degrees. */
static bool is_flat_beyond(const section *s, side *t, int i, double far, float degrees)
{
	double end = t->far[i] + far;
	int k = i;
	for (;;) {
		while (k < t->n && t->far[k + 1] <= end)
			k++;
		if (t->sum[k] - t->sum[i] > degrees)
			return false;
		if (k < t->n || t->closed || t->end >= end)
			return true;
		if (!follow(s, t, end) && !t->closed && !(t->end >= end)) /* nor a number */
			return false;
	}
}

/* Whether what comes next on one side is so far away, or bends so little, that a strip may end at an edge. */
static bool may_end(const section *s, side *open, side *bent, float own)
{
	return bent->n && is_flat_beyond(s, open, 0, beside * bent->far[1], alike * own);
}

/* Follows a strip from its edge at one end to the other; which of its edges that is, 0: it has no end. */
static int find_end(const section *s, side *t, float own)
{
	for (int i = 1; i <= t->n || follow(s, t, INFINITY); i++) {
		float turn = own + t->sum[i];
		if (turn > most)
			return 0;
		if (turn >= least && is_flat_beyond(s, t, i, beside * t->far[i], is_flat * turn))
			return i;
	}
	return 0;
}

/* Which of the edges of a strip, up to `end`, is its middle, 0 that at which it begins. Of two that share it the
 * longer one, as all along a rim; of equal ones, by which way the faces beside the strip look. */
static int find_middle(const section *s, const side *t, int end, float own, double across[2][3])
{
	float half = 0.5f * (own + t->sum[end]), nearest = INFINITY;
	int best = -1;
	for (int k = 0; k <= end; k++) {
		const mesh_edge *e = s->s->edges + t->edge[k];
		float off = fabsf(own + t->sum[k] - 0.5f * e->bend - half);
		if (e->flags & EDGE_NEVER || off > nearest + 0.2f * e->bend)
			continue;
		bool tied = best >= 0 && off > nearest - 0.2f * e->bend;
		if (tied) {
			const double x[3] = {0.5377, 0.2943, 0.7901};
			double one = recipe_edge_length(s->r, s->s->edges + t->edge[best]),
			       other = recipe_edge_length(s->r, e), looks = dot3(across[1], x) - dot3(across[0], x);
			if (fabs(one - other) > 1e-3 * one ? one > other : looks < 0)
				continue;
		}
		nearest = min(off, nearest);
		best = k;
	}
	return best;
}

/* Whether, about an end of an edge, what lies beside one of its faces bends about as much as the edge. */
static bool bends_aside(const section *s, int32_t number, int32_t face, int32_t point)
{
	const mesh_edge *edges = s->s->edges;
	int32_t from = number;
	for (int step = 0; step < 8; step++) {
		int32_t next = -1;
		for (uint32_t d = 3 * (uint32_t)face; d < 3 * (uint32_t)face + 3; d++) {
			int32_t at = s->s->edge_of[d];
			if (at >= 0 && at != from && (edges[at].end[0] == point || edges[at].end[1] == point))
				next = at;
		}
		if (next < 0 || edges[next].flags & (EDGE_BORDER | EDGE_MANY))
			return false;
		if (edges[next].bend >= alike * edges[number].bend)
			return true;
		face = edges[next].face[edges[next].face[0] == face];
		from = next;
	}
	return false;
}

/* Whether the flat beside an edge is no wider along it than the strip is across: it is a strip itself, seen along. */
static bool is_along(const section *s, int32_t number, int32_t face, double width)
{
	const mesh_edge *e = s->s->edges + number;
	return recipe_edge_length(s->r, e) < width && bends_aside(s, number, face, e->end[0]) &&
	       bends_aside(s, number, face, e->end[1]);
}

/* A strip that begins at an edge and goes on over one of its faces. */
static bool find_strip(const section *s, int32_t number, side *open, side *bent, strip *out)
{
	const mesh_edge *e = s->s->edges + number;
	double across[2][3];
	if (!may_end(s, open, bent, e->bend))
		return false;
	int end = find_end(s, bent, e->bend);
	float turn = e->bend + bent->sum[end];
	if (!end || !is_flat_beyond(s, open, 0, beside * bent->far[end], is_flat * turn))
		return false;
	if (is_along(s, number, open->face[0], bent->far[end]) ||
	    is_along(s, bent->edge[end], bent->face[end], bent->far[end]))
		return false;
	recipe_across(s->r, open->face[0], across[0]);
	recipe_across(s->r, bent->face[end], across[1]);
	out->bend = min(turn, angle3(across[0], across[1]));
	for (int k = 0; k < 2; k++) {
		double size = sqrt(dot3(across[k], across[k]));
		for (int i = 0; i < 3; i++)
			across[k][i] /= size;
	}
	int middle = find_middle(s, bent, end, e->bend, across);
	if (middle < 0 || out->bend < least)
		return false;
	out->edge = bent->edge[middle];
	memcpy(out->end[0], bent->at[0], sizeof out->end[0]);
	memcpy(out->end[1], bent->at[end], sizeof out->end[1]);
	return true;
}

static bool add_strip(shape *s, const strip *found, int64_t *room)
{
	mesh_edge *e = s->edges + found->edge;
	if (!(found->bend > e->bend))
		return true;
	if (e->strip >= 0) { /* it has been found from the other end */
		if (found->bend > s->strips[e->strip].bend)
			s->strips[e->strip] = *found;
		return true;
	}
	strip *all = with_room(s->strips, sizeof *all, s->n_strips, room);
	if (!all)
		return false;
	s->strips = all;
	e->strip = s->n_strips;
	all[s->n_strips++] = *found;
	return true;
}

/* ---- all of a mesh --------------------------------------------------------------------------------------- */

bool strips_find(const recipe *r, shape *s)
{
	int64_t room = 0;
	side two[2];
	for (int32_t i = 0; i < s->n_edges; i++)
		s->edges[i].strip = -1;
	for (int32_t i = 0; i < s->n_edges; i++) {
		const mesh_edge *e = s->edges + i;
		section n = {.r = r, .s = s};
		strip found;
		double ends[2][3];
		if (e->bend < strip_flat || e->flags & (EDGE_BORDER | EDGE_MANY))
			continue;
		for (int k = 0; k < 2; k++)
			recipe_point(r, e->end[k], ends[k]);
		minus3(ends[1], ends[0], n.axis);
		for (int k = 0; k < 3; k++)
			n.middle[k] = 0.5 * (ends[0][k] + ends[1][k]);
		for (int k = 0; k < 2; k++) {
			begin(&n, i, e->face[k], two + k);
			follow(&n, two + k, INFINITY);
		}
		for (int k = 0; k < 2; k++)
			if (find_strip(&n, i, two + k, two + !k, &found) && !add_strip(s, &found, &room))
				return false;
	}
	return !s->n_strips || strips_join(r, s);
}

/* ---- on the screen ----------------------------------------------------------------------------------------- */

static const double whole = 5.0 / 540, gone = 9.0 / 540; /* of the frame's height: up to so wide it is a whole line,
							    and none from there on */

float strip_fade(const chains *c, const body *b, const mesh_edge *e)
{
	const strip *t = b->shape->strips + e->strip;
	const mesh_edge *own = b->shape->edges + t->edge;
	const corner *p = b->spots + own->end[0], *q = b->spots + own->end[1];
	if (!(p->w > 0 && q->w > 0))
		return 0;
	double x = q->x / q->w - p->x / p->w, y = q->y / q->w - p->y / p->w, length = sqrt(x * x + y * y), wide = 0;
	if (!(length > 0))
		return 0;
	for (int k = 0; k < 2; k++) {
		corner at = geometry_corner(b->part, t->end[k]);
		if (!(at.w > 0))
			return 0;
		wide += fabs((at.x / at.w - p->x / p->w) * y - (at.y / at.w - p->y / p->w) * x) / length;
	}
	double share = (gone * c->job->frame.height - wide) / ((gone - whole) * c->job->frame.height);
	return share > 1 ? 1 : share > 0 ? (float)share : 0;
}
