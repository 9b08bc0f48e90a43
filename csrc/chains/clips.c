/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Where the clip planes of the camera cut surfaces: these end there. */
#include "chains/chains.h"

#include <string.h>

/* The cut of a triangle. False: there is none, or it lies out of the frame. */
static bool clip_line(const chains *c, int number, int32_t face, double depth, bool far, line *l)
{
	const body *b = c->bodies + number;
	uint32_t first = 3 * (uint32_t)face;
	double inside[2] = {0, 0};
	int n = 0;
	*l = (line){.body = number,
		    .other = -1,
		    .edge = face,
		    .own = {face},
		    .n_own = 1,
		    .kind = ENCRE_CHAIN_BORDER,
		    .link = {-1, -1},
		    .object = object_of(b->mesh, face)};
	for (uint32_t k = 0; k < 3; k++) {
		int32_t p = topology_point(b->mesh, first + k), q = topology_point(b->mesh, next_corner(first + k));
		/* from the end of the lower number, so that triangles on both sides find the same place */
		if (b->shape->place[p] > b->shape->place[q]) {
			int32_t swapped = p;
			p = q;
			q = swapped;
		}
		const corner *u = b->spots + p, *v = b->spots + q;
		bool before = u->z < depth;
		if (before == (v->z < depth) || n == 2)
			continue;
		const corner *seen = before == far ? u : v;
		inside[0] = seen->x / seen->w;
		inside[1] = seen->y / seen->w;
		double t = (depth - u->z) / (v->z - u->z), ends[2][3];
		world_point(b->mesh, p, ends[0]);
		world_point(b->mesh, q, ends[1]);
		for (int i = 0; i < 3; i++)
			l->p[n][i] = ends[0][i] + t * (ends[1][i] - ends[0][i]);
		l->c[n] = (corner){u->x + t * (v->x - u->x), u->y + t * (v->y - u->y), u->w + t * (v->w - u->w), depth};
		l->node[n++] = 1ull << 63 | (uint64_t)far << 62 | (uint64_t)(number + 1) << 32 |
			       (uint32_t)b->shape->edge_of[first + k];
	}
	if (n < 2 || !line_clip(c, l))
		return false;
	screen a = screen_at(l, 0), z = screen_at(l, 1);
	double turn = (z.x - a.x) * (inside[1] - a.y) - (z.y - a.y) * (inside[0] - a.x);
	l->side = (int8_t)((turn > 0) - (turn < 0));
	return true;
}

static bool is_cut(const body *b, double depth)
{
	bool before = false, beyond = false;
	for (int32_t i = 0; i < b->mesh->n_points; i++) {
		before |= b->spots[i].z < depth;
		beyond |= !(b->spots[i].z < depth);
	}
	return before && beyond;
}

int64_t clips_find(const chains *c, line *out)
{
	const encre_chain_job *job = c->job;
	int64_t n = 0;
	line l;
	for (int far = 0; far < 1 + (job->clip_end > job->clip_start); far++) {
		double depth = far ? job->clip_end : job->clip_start;
		for (int i = 0; i < c->n_bodies; i++) {
			const body *b = c->bodies + i;
			if (!b->near || is_line(b->mesh) || !is_cut(b, depth))
				continue;
			for (int32_t k = 0; k < b->shape->n_triangles; k++)
				n += clip_line(c, i, k, depth, far, out ? out + n : &l);
		}
	}
	return n;
}
