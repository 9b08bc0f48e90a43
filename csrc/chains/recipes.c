/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What shapes follow from: a key of 128 bits, by which one is known again. Bends depend on how a model stretches its
 * mesh: what it does beside turning and scaling all ways alike is part of the key. */
#include "chains/shapes.h"

#include <string.h>

static void add_to_key(uint64_t key[2], const void *data, size_t bytes)
{
	const char *p = data;
	uint64_t a = key[0] ^ bytes, b = key[1] + bytes, word;
	if (!data)
		bytes = 0;
	for (; bytes >= 8; bytes -= 8, p += 8) {
		memcpy(&word, p, 8);
		a = (a ^ word) * 0x9e3779b97f4a7c15u;
		b = (b + word) * 0xc2b2ae3d27d4eb4fu;
		a ^= a >> 31;
		b ^= b >> 27;
	}
	word = data != NULL;
	if (bytes)
		memcpy(&word, p, bytes);
	key[0] = stir(a ^ word);
	key[1] = stir(b + word);
}

void recipe_key(recipe *r)
{
	const encre_mesh *m = r->mesh;
	size_t n = (size_t)m->n_primitives, corners = (is_line(m) ? 2 : 3) * n;
	r->key[0] = stir((uint64_t)m->kind << 32 | (uint32_t)m->n_primitives);
	r->key[1] = stir((uint32_t)m->n_points);
	add_to_key(r->key, m->points, 12 * (size_t)m->n_points);
	add_to_key(r->key, m->corners, 4 * corners);
	add_to_key(r->key, m->edges, n);
	add_to_key(r->key, m->object, 4 * n);
	add_to_key(r->key, m->material, 4 * n);
	add_to_key(r->key, r->linear, sizeof r->linear);
}

/* The left upper 3 x 3 of a model; of one that only turns and scales, that of none. */
static void linear_of(const double model[16], double linear[9])
{
	double gram[3][3], mean = 0, off = 0;
	for (int i = 0; i < 3; i++)
		for (int j = 0; j < 3; j++) {
			gram[i][j] = model[i] * model[j] + model[4 + i] * model[4 + j] + model[8 + i] * model[8 + j];
			mean += i == j ? gram[i][j] / 3 : 0;
		}
	for (int i = 0; i < 3; i++)
		for (int j = 0; j < 3; j++)
			off = fmax(off, fabs(gram[i][j] - (i == j ? mean : 0)));
	bool alike = !(off > 1e-5 * mean);
	for (int i = 0; i < 9; i++)
		linear[i] = alike ? i % 4 == 0 : model[4 * (i / 3) + i % 3];
}

bool recipe_same_arrays(const recipe *r, const recipe *s)
{
	const encre_mesh *a = r->mesh, *b = s->mesh;
	return a->points == b->points && a->corners == b->corners && a->edges == b->edges && a->object == b->object &&
	       a->material == b->material && a->kind == b->kind && a->n_primitives == b->n_primitives &&
	       a->n_points == b->n_points && !memcmp(r->linear, s->linear, sizeof r->linear);
}

recipe recipe_of(const encre_mesh *mesh)
{
	recipe r = {.mesh = mesh, .like = -1};
	linear_of(mesh->model, r.linear);
	return r;
}
