/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Where shapes stand in the world, and a tree of them. */
#include "chains/shapes.h"

#include <stdlib.h>

static bool invert(const double m[12], double out[12])
{
	double det = 0;
	for (int i = 0; i < 3; i++)
		for (int j = 0; j < 3; j++) {
			int a = (j + 1) % 3, b = (j + 2) % 3, d = (i + 1) % 3, e = (i + 2) % 3;
			out[4 * i + j] = m[4 * a + d] * m[4 * b + e] - m[4 * a + e] * m[4 * b + d];
		}
	for (int k = 0; k < 3; k++)
		det += m[k] * out[4 * k];
	if (!(fabs(det) > 0) || !(fabs(det) < INFINITY))
		return false;
	for (int i = 0; i < 3; i++) {
		for (int j = 0; j < 3; j++)
			out[4 * i + j] /= det;
		out[4 * i + 3] = -(out[4 * i] * m[3] + out[4 * i + 1] * m[7] + out[4 * i + 2] * m[11]);
	}
	double sum = 0;
	for (int i = 0; i < 12; i++)
		sum += out[i] * 0;
	return sum == 0;
}

static void make_body(body *b, const encre_mesh *mesh, const shape *s)
{
	*b = (body){.mesh = mesh,
		    .shape = s,
		    .low = {INFINITY, INFINITY, INFINITY},
		    .high = {-INFINITY, -INFINITY, -INFINITY}};
	for (int32_t i = 0; mesh->n_primitives && i < mesh->n_points; i++) {
		double p[3];
		world_point(mesh, i, p);
		for (int k = 0; k < 3; k++) {
			b->low[k] = p[k] < b->low[k] ? p[k] : b->low[k];
			b->high[k] = p[k] > b->high[k] ? p[k] : b->high[k];
		}
	}
	b->solid = s && !mesh->open && s->tree.n_nodes && invert(mesh->model, b->inverse);
	for (int k = 0; k < 3; k++) /* boxes are floats */
		b->solid = b->solid && b->low[k] > -1e37 && b->high[k] < 1e37;
}

typedef struct placing {
	chains *c;
	const recipe *recipes;
} placing;

static void make_bodies(void *data, int from, int end, int thread)
{
	(void)thread;
	const placing *p = data;
	for (int i = from; i < end && !bands_stopped(p->c->pool); i++)
		make_body(p->c->bodies + i, p->c->job->meshes + i, p->recipes[i].shape);
}

static int32_t build_tree(chains *c)
{
	tree_box *boxes = malloc(((size_t)c->n_bodies + 1) * sizeof *boxes);
	int32_t n = 0;
	uint32_t edges = 0;
	if (!boxes)
		return ENCRE_ERROR_MEMORY;
	for (int i = 0; i < c->n_bodies; i++) {
		body *b = c->bodies + i;
		b->first = edges;
		edges += b->shape ? (uint32_t)b->shape->n_edges : 0;
		if (!b->solid)
			continue;
		tree_box box = {.item = i};
		for (int k = 0; k < 3; k++) {
			double pad = 1e-6 * (fabs(b->low[k]) + fabs(b->high[k])) + 1e-9;
			box.low[k] = (float)(b->low[k] - pad);
			box.high[k] = (float)(b->high[k] + pad);
		}
		boxes[n++] = box;
	}
	bool built = tree_build(&c->tree, boxes, n, 1);
	for (int32_t i = 0; i < n; i++)
		c->order[i] = boxes[i].item;
	free(boxes);
	return built ? ENCRE_OK : ENCRE_ERROR_MEMORY;
}

int32_t bodies_place(chains *c, const recipe *recipes)
{
	placing p = {c, recipes};
	int32_t code = bands_run(c->pool, c->n_bodies, 1, make_bodies, &p);
	return code ? code : build_tree(c);
}
