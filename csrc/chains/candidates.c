/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Which edges can be lines in a frame. An edge at which all faces lie on one side is a contour; that is told by which
 * way round they are seen, in homogeneous coordinates, also where a corner lies behind the eye. */
#include "chains/chains.h"

#include <stdlib.h>
#include <string.h>

enum { CHUNK = 4096 /* edges that a thread takes at once */ };

typedef struct search {
	chains *c;
	uint32_t n_edges; /* of all bodies */
	int n_chunks;
	uint8_t *is_line; /* by edge */
	int64_t *count;   /* by chunk, and one more: first how many lines, then where they begin */
} search;

/* ---- on the screen --------------------------------------------------------------------------------------------- */

/* Whether all corners of a body's box lie beyond one side of what is looked at. */
static bool may_be_seen(const chains *c, const body *b)
{
	int beyond[5] = {0};
	const double *p = c->job->projection, *v = c->job->view;
	for (int k = 0; k < 8; k++) {
		double at[4] = {0, 0, 0, 1}, clip[4];
		for (int i = 0; i < 3; i++)
			at[i] = v[4 * i] * (k & 1 ? b->low[0] : b->high[0]) +
				v[4 * i + 1] * (k & 2 ? b->low[1] : b->high[1]) +
				v[4 * i + 2] * (k & 4 ? b->low[2] : b->high[2]) + v[4 * i + 3];
		for (int i = 0; i < 4; i++)
			clip[i] = p[4 * i] * at[0] + p[4 * i + 1] * at[1] + p[4 * i + 2] * at[2] + p[4 * i + 3];
		double w = clip[3], x = 0.5 * c->job->frame.width * (clip[0] + w),
		       y = 0.5 * c->job->frame.height * (w - clip[1]);
		beyond[0] += -at[2] < c->job->clip_start;
		beyond[1] += x < (c->x0 - MARGIN - 1) * w;
		beyond[2] += x > (c->x1 + MARGIN + 1) * w;
		beyond[3] += y < (c->y0 - MARGIN - 1) * w;
		beyond[4] += y > (c->y1 + MARGIN + 1) * w;
	}
	for (int k = 0; k < 5; k++)
		if (beyond[k] == 8)
			return false;
	return true;
}

static void aim_bodies(void *data, int from, int end, int thread)
{
	(void)thread;
	chains *c = data;
	for (int i = from; i < end && !bands_stopped(c->pool); i++) {
		body *b = c->bodies + i;
		if (!b->near)
			continue;
		for (int32_t k = 0; k < b->mesh->n_points; k++)
			b->spots[k] = geometry_corner(b->part, b->mesh->points + 3 * (size_t)k);
		for (int32_t k = 0; k < b->shape->n_triangles; k++) {
			const corner *p[3];
			for (uint32_t n = 0; n < 3; n++)
				p[n] = b->spots + topology_point(b->mesh, 3 * (uint32_t)k + n);
			double turn = outline_turn(p[0], p[1], p[2]);
			b->faces[k] = (int8_t)((turn > 0) - (turn < 0));
		}
	}
}

bool line_clip(const chains *c, line *l)
{
	const corner *a = l->c, *b = l->c + 1;
	const encre_chain_job *job = c->job;
	bool far = job->clip_end > job->clip_start;
	const double side[6][2] = {
		{a->z - job->clip_start, b->z - job->clip_start},
		{far ? job->clip_end - a->z : 1, far ? job->clip_end - b->z : 1},
		{a->x - (c->x0 - MARGIN) * a->w, b->x - (c->x0 - MARGIN) * b->w},
		{(c->x1 + MARGIN) * a->w - a->x, (c->x1 + MARGIN) * b->w - b->x},
		{a->y - (c->y0 - MARGIN) * a->w, b->y - (c->y0 - MARGIN) * b->w},
		{(c->y1 + MARGIN) * a->w - a->y, (c->y1 + MARGIN) * b->w - b->y},
	};
	l->part[0] = 0;
	l->part[1] = 1;
	l->clipped[0] = l->clipped[1] = false;
	for (int k = 0; k < 6; k++) {
		double u = side[k][0], v = side[k][1];
		if (!(u >= 0 || v >= 0))
			return false;
		if (u < 0 && u / (u - v) > l->part[0]) {
			l->part[0] = u / (u - v);
			l->clipped[0] = true;
		} else if (v < 0 && u / (u - v) < l->part[1]) {
			l->part[1] = u / (u - v);
			l->clipped[1] = true;
		}
		if (k == 1)
			memcpy(l->whole, l->part, sizeof l->whole);
	}
	if (!(l->part[1] > l->part[0]))
		return false;
	l->whole_long = apart(screen_at(l, l->whole[0]), screen_at(l, l->whole[1]));
	return l->whole_long < 1e9; /* or it is no number */
}

/* ---- edges ----------------------------------------------------------------------------------------------------- */

/* Whether all faces of an edge lie on one side of it. */
static bool is_contour(const body *b, const mesh_edge *e)
{
	const int8_t *faces = b->faces;
	const shape *s = b->shape;
	if (!(e->flags & EDGE_MANY)) {
		int one = (int)faces[e->face[0]];
		int other = (int)faces[e->face[1]] * (e->flags & EDGE_SAME_WAY ? -1 : 1);
		return one * other < 0 || (one == 0) != (other == 0);
	}
	bool right = false, left = false;
	for (uint32_t d = e->corner; d != NO_CORNER; d = s->next[d]) {
		int side = faces[d / 3] * (s->place[topology_point(b->mesh, d)] == e->end[0] ? 1 : -1);
		right |= side > 0;
		left |= side < 0;
	}
	return !(right && left);
}

static int kind_of(const chains *c, const body *b, int32_t number, line *l)
{
	const mesh_edge *e = b->shape->edges + number;
	int kind = 0, smooth = e->flags & EDGE_SMOOTH ? ENCRE_CHAIN_SMOOTH : 0;
	bool never = e->flags & EDGE_NEVER;
	l->bend = never || e->flags & EDGE_BORDER ? 0 : e->bend + b->mesh->crease_offset;
	if (e->flags & EDGE_BORDER)
		kind = ENCRE_CHAIN_BORDER;
	else if (is_contour(b, e))
		kind = ENCRE_CHAIN_CONTOUR;
	if (e->flags & EDGE_OBJECT)
		kind |= ENCRE_CHAIN_NUMBER;
	if (e->flags & EDGE_MATERIAL)
		kind |= ENCRE_CHAIN_MATERIAL;
	if (l->bend >= c->job->least_bend)
		kind |= ENCRE_CHAIN_CREASE;
	if (e->strip >= 0 && !(kind & ~ENCRE_CHAIN_CREASE)) {
		l->over = b->shape->strips[e->strip].bend + b->mesh->crease_offset;
		l->fade = l->over >= c->job->least_bend ? strip_fade(c, b, e) : 0;
		kind |= l->fade > 0 ? ENCRE_CHAIN_BEVEL : 0;
	}
	int round = e->flags & EDGE_ROUND ? ENCRE_CHAIN_ROUND : 0;
	return kind ? kind | smooth | round : 0;
}

static void load_edge(const body *b, int i, int32_t number, line *l)
{
	const mesh_edge *e = b->shape->edges + number;
	const encre_mesh *m = b->mesh;
	l->body = i;
	l->other = -1;
	l->edge = number;
	for (int k = 0; k < 2; k++) {
		l->c[k] = b->spots[e->end[k]];
		world_point(m, e->end[k], l->p[k]);
		l->node[k] = (uint64_t)(i + 1) << 32 | (uint32_t)e->end[k];
	}
	l->link[0] = l->link[1] = -1;
	l->n_own = 0;
	l->side = 0;
	l->color[0] = l->color[1] = 0;
	l->object = m->object_index;
	if (is_line(m))
		return;
	l->object = object_of(m, e->face[0]);
	for (uint32_t d = e->corner; d != NO_CORNER && l->n_own < OWN; d = b->shape->next[d])
		l->own[l->n_own++] = (int32_t)(d / 3);
	if (!(l->kind & (ENCRE_CHAIN_CONTOUR | ENCRE_CHAIN_BORDER)))
		return;
	l->side = b->faces[e->face[0]];
	if (!l->side && e->face[1] >= 0)
		l->side = (int8_t)(b->faces[e->face[1]] * (e->flags & EDGE_SAME_WAY ? 1 : -1));
}

static bool edge_line(const chains *c, int i, int32_t number, line *l)
{
	const body *b = c->bodies + i;
	l->fade = l->over = 0;
	l->bend = 180;
	l->kind = is_line(b->mesh) ? ENCRE_CHAIN_MARK : kind_of(c, b, number, l);
	if (!l->kind)
		return false;
	load_edge(b, i, number, l);
	return line_clip(c, l);
}

/* Lines of a chunk of edges: counted, or with `out` written down. */
static int64_t walk(const search *s, int chunk, line *out)
{
	const chains *c = s->c;
	uint32_t at = (uint32_t)chunk * CHUNK, end = s->n_edges - at < CHUNK ? s->n_edges : at + CHUNK;
	int low = 0, high = c->n_bodies;
	int64_t n = 0;
	while (high - low > 1) {
		int middle = low + (high - low) / 2;
		if (c->bodies[middle].first <= at)
			low = middle;
		else
			high = middle;
	}
	for (int i = low; at < end && i < c->n_bodies; i++) {
		const body *b = c->bodies + i;
		uint32_t stop = b->first + (b->shape ? (uint32_t)b->shape->n_edges : 0);
		stop = stop < end ? stop : end;
		line l;
		for (; at < stop && b->near && b->shape && !b->mesh->open; at++)
			if (out) {
				if (s->is_line[at])
					edge_line(c, i, (int32_t)(at - b->first), out + n++);
			} else {
				s->is_line[at] = edge_line(c, i, (int32_t)(at - b->first), &l);
				n += s->is_line[at];
			}
		at = stop > at ? stop : at;
	}
	return n;
}

static void count_lines(void *data, int from, int end, int thread)
{
	(void)thread;
	search *s = data;
	for (int k = from; k < end && !bands_stopped(s->c->pool); k++)
		s->count[k] = walk(s, k, NULL);
}

static void write_lines(void *data, int from, int end, int thread)
{
	(void)thread;
	search *s = data;
	for (int k = from; k < end && !bands_stopped(s->c->pool); k++)
		walk(s, k, s->c->lines + s->count[k]);
}

/* ---- meets ----------------------------------------------------------------------------------------------------- */

static bool meet_line(const chains *c, int64_t number, line *l)
{
	const meet *m = c->kept->meets + number;
	const body *a = c->bodies + m->body[0], *b = c->bodies + m->body[1];
	double across[2][3];
	if (!a->near || !b->near)
		return false;
	for (int k = 0; k < 2; k++) {
		double p[3][3];
		world_face(k ? b->mesh : a->mesh, m->face[k], p);
		across3(p, across[k]);
	}
	float bend = angle3(across[0], across[1]);
	*l = (line){.body = m->body[0],
		    .other = m->body[1],
		    .edge = (int32_t)((m->node[0] ^ 3 * m->node[1]) & 0xffffff),
		    .own = {m->face[0], m->face[1]},
		    .n_own = 2,
		    .kind = ENCRE_CHAIN_MEET,
		    .bend = bend > 90 ? 180 - bend : bend, /* surfaces have no inside: the angle that they leave */
		    .link = {-1, -1}};
	l->object = object_of(a->mesh, m->face[0]);
	if (l->object != object_of(b->mesh, m->face[1]))
		l->kind |= ENCRE_CHAIN_OTHER;
	for (int k = 0; k < 2; k++) {
		const double *p = m->p[k], *v = c->job->view, *q = c->job->projection;
		double at[3], x[4];
		memcpy(l->p[k], p, sizeof l->p[k]);
		move3(v, p, at);
		for (int i = 0; i < 4; i++)
			x[i] = q[4 * i] * at[0] + q[4 * i + 1] * at[1] + q[4 * i + 2] * at[2] + q[4 * i + 3];
		l->c[k] = (corner){0.5 * c->job->frame.width * (x[3] + x[0]),
				   0.5 * c->job->frame.height * (x[3] - x[1]), x[3], -at[2]};
		l->node[k] = m->node[k];
	}
	return line_clip(c, l);
}

/* ---- all ------------------------------------------------------------------------------------------------------- */

int32_t lines_aim(chains *c)
{
	for (int i = 0; i < c->n_bodies; i++) {
		body *b = c->bodies + i;
		b->near = b->part && b->shape && may_be_seen(c, b);
		if (!b->near)
			continue;
		b->spots = late_take(&c->late, (size_t)b->mesh->n_points, sizeof *b->spots);
		b->faces = late_take(&c->late, (size_t)b->shape->n_triangles + 1, sizeof *b->faces);
		if (!b->spots || !b->faces)
			return ENCRE_ERROR_MEMORY;
	}
	return bands_run(c->pool, c->n_bodies, 1, aim_bodies, c);
}

int32_t lines_find(chains *c)
{
	search s = {.c = c};
	int32_t code;
	for (int i = 0; i < c->n_bodies; i++)
		s.n_edges += c->bodies[i].shape ? (uint32_t)c->bodies[i].shape->n_edges : 0;
	s.n_chunks = (int)((s.n_edges + (uint64_t)CHUNK - 1) / CHUNK);
	s.count = late_take(&c->late, (size_t)s.n_chunks + 1, sizeof *s.count);
	s.is_line = late_take(&c->late, s.n_edges, 1);
	if (!s.count || !s.is_line)
		return ENCRE_ERROR_MEMORY;
	if ((code = bands_run(c->pool, s.n_chunks, 1, count_lines, &s)))
		return code;
	int64_t sum = 0;
	for (int k = 0; k < s.n_chunks; k++) {
		int64_t count = s.count[k];
		s.count[k] = sum;
		sum += count;
	}
	line l;
	int64_t meets = 0;
	for (int64_t i = 0; i < c->kept->n_meets; i++)
		meets += meet_line(c, i, &l);
	prints printed;
	if ((code = colors_print(c, &printed)))
		return code;
	int64_t clips = clips_find(c, NULL);
	c->n_lines = sum + meets + clips + printed.n;
	c->lines = late_take(&c->late, (size_t)c->n_lines + 1, sizeof *c->lines);
	if (!c->lines) {
		prints_free(&printed);
		return ENCRE_ERROR_MEMORY;
	}
	for (int64_t i = 0, n = sum; i < c->kept->n_meets; i++)
		n += meet_line(c, i, c->lines + n);
	clips_find(c, c->lines + sum + meets);
	prints_move(&printed, c->lines + sum + meets + clips); /* last: what is no line after all is written, too */
	code = bands_run(c->pool, s.n_chunks, 1, write_lines, &s);
	late_drop(&c->late, s.is_line);
	return code;
}
