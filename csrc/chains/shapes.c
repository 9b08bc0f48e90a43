/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What meshes are made of, and where they stand. A shape is known again by a key of 128 bits of all that it follows
 * from; instances share one. Bends depend on how a model stretches its mesh: what it does beside turning and scaling
 * all ways alike is part of the key. */
#include "chains/chains.h"

#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>

enum { LEAF_TRIANGLES = 4 };

/* ---- keys ------------------------------------------------------------------------------------------------------ */

typedef struct recipe {
	const encre_mesh *mesh;
	double linear[9]; /* in which bends are measured: object space, or as the model stretches it */
	uint64_t key[2];
	int like; /* an earlier mesh that is made of the same arrays; -1 */
	shape *shape;
} recipe;

static inline uint64_t stir(uint64_t h)
{
	h ^= h >> 32;
	h *= 0xd6e8feb86659fd93u;
	return h ^ h >> 29;
}

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

static void key_of(recipe *r)
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

static bool same_arrays(const recipe *r, const recipe *s)
{
	const encre_mesh *a = r->mesh, *b = s->mesh;
	return a->points == b->points && a->corners == b->corners && a->edges == b->edges && a->object == b->object &&
	       a->material == b->material && a->kind == b->kind && a->n_primitives == b->n_primitives &&
	       a->n_points == b->n_points && !memcmp(r->linear, s->linear, sizeof r->linear);
}

/* ---- edges ----------------------------------------------------------------------------------------------------- */

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

static void face_across(const recipe *r, int32_t face, double out[3])
{
	double p[3][3];
	for (uint32_t k = 0; k < 3; k++) {
		const float *q = r->mesh->points + 3 * (size_t)topology_point(r->mesh, 3 * (uint32_t)face + k);
		for (int i = 0; i < 3; i++)
			p[k][i] = r->linear[3 * i] * (double)q[0] + r->linear[3 * i + 1] * (double)q[1] +
				  r->linear[3 * i + 2] * (double)q[2];
	}
	across3(p, out);
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
	face_across(r, e->face[0], own);
	for (uint32_t d = second; d != NO_CORNER; d = s->next[d]) {
		int32_t face = (int32_t)(d / 3);
		bool same = s->place[topology_point(m, d)] == e->end[0];
		double other[3];
		face_across(r, face, other);
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
		e->face[i % 2] = -1;
	}
	return true;
}

void shape_free(shape *s)
{
	if (!s)
		return;
	tree_free(&s->tree);
	free(s->edges);
	free(s->edge_of);
	free(s->place);
	free(s->next);
	free(s->piece);
	free(s->first);
	free(s->order);
	free(s);
}

/* NULL without memory. */
static shape *make_shape(const recipe *r)
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
	s->order = malloc((n + 1) * sizeof *s->order);
	bool made = s->place && s->edge_of && s->next && s->piece && s->first && s->order && find_places(s, m);
	if (made && is_line(m))
		made = find_lines(s, m);
	else if (made) {
		topology t = {.next = s->next, .first = s->first, .piece = s->piece};
		made = topology_find(m, &t) && find_edges(r, s) && find_tree(s, m);
	}
	if (made)
		return s;
	shape_free(s);
	return NULL;
}

/* ---- all of a job ---------------------------------------------------------------------------------------------- */

typedef struct search {
	chains *c;
	recipe *recipes;
	int *ask; /* recipes whose shapes are to be made */
	atomic_bool failed;
} search;

static void find_keys(void *data, int from, int end, int thread)
{
	(void)thread;
	search *s = data;
	for (int i = from; i < end && !bands_stopped(s->c->pool); i++)
		if (s->recipes[i].like < 0)
			key_of(s->recipes + i);
}

static void make_shapes(void *data, int from, int end, int thread)
{
	(void)thread;
	search *s = data;
	for (int i = from; i < end && !bands_stopped(s->c->pool); i++) {
		recipe *r = s->recipes + s->ask[i];
		r->shape = make_shape(r);
		if (!r->shape)
			atomic_store(&s->failed, true);
	}
}

/* By number, the first recipe in a table that is as this one. */
static size_t slot_of(const recipe *all, const int *table, size_t room, const recipe *r, uint64_t h,
		      bool (*same)(const recipe *, const recipe *))
{
	size_t at = stir(h) & (room - 1);
	while (table[at] >= 0 && !same(all + table[at], r))
		at = (at + 1) & (room - 1);
	return at;
}

static bool same_key(const recipe *a, const recipe *b)
{
	return a->key[0] == b->key[0] && a->key[1] == b->key[1];
}

static int by_key(const void *a, const void *b)
{
	const shape *s = *(shape *const *)a, *t = *(shape *const *)b;
	for (int k = 0; k < 2; k++)
		if (s->key[k] != t->key[k])
			return s->key[k] < t->key[k] ? -1 : 1;
	return 0;
}

/* Among those of the last job. */
static shape *known_shape(const kept_shapes *kept, const recipe *r)
{
	shape wanted = {.key = {r->key[0], r->key[1]}}, *key = &wanted;
	shape **found = kept->n ? bsearch(&key, kept->all, (size_t)kept->n, sizeof *kept->all, by_key) : NULL;
	return found ? *found : NULL;
}

/* Keeps the shapes of this job, and forgets the others. */
static int32_t keep(kept_shapes *kept, const recipe *recipes, int n)
{
	int used = 0;
	for (int i = 0; i < n; i++)
		if (recipes[i].shape && !recipes[i].shape->used) {
			recipes[i].shape->used = true;
			used++;
		}
	shape **all = malloc(((size_t)used + 1) * sizeof *all);
	for (int i = 0; i < kept->n; i++)
		if (!kept->all[i]->used)
			shape_free(kept->all[i]);
	int k = 0;
	for (int i = 0; i < n; i++)
		if (recipes[i].shape && recipes[i].shape->used) {
			recipes[i].shape->used = false;
			if (all)
				all[k++] = recipes[i].shape;
			else
				shape_free(recipes[i].shape);
		}
	free(kept->all);
	kept->all = all;
	kept->n = k;
	if (k)
		qsort(all, (size_t)k, sizeof *all, by_key);
	return all ? ENCRE_OK : ENCRE_ERROR_MEMORY;
}

static int32_t find_shapes(chains *c, search *s, int *table, size_t room)
{
	int n = c->n_bodies, asked = 0;
	for (int i = 0; i < n; i++) {
		recipe *r = s->recipes + i;
		*r = (recipe){.mesh = c->job->meshes + i, .like = -1};
		linear_of(r->mesh->model, r->linear);
	}
	memset(table, 0xff, room * sizeof *table);
	for (int i = 0; i < n; i++) {
		recipe *r = s->recipes + i;
		size_t at = slot_of(s->recipes, table, room, r, (uint64_t)(uintptr_t)r->mesh->points, same_arrays);
		r->like = table[at];
		if (table[at] < 0)
			table[at] = i;
	}
	int32_t code = bands_run(c->pool, n, 1, find_keys, s);
	if (code)
		return code;
	memset(table, 0xff, room * sizeof *table);
	for (int i = 0; i < n; i++) {
		recipe *r = s->recipes + i;
		if (r->like >= 0)
			continue;
		size_t at = slot_of(s->recipes, table, room, r, r->key[0], same_key);
		r->like = table[at];
		if (table[at] < 0) {
			table[at] = i;
			r->shape = known_shape(c->kept, r);
			if (!r->shape)
				s->ask[asked++] = i;
		}
	}
	code = bands_run(c->pool, asked, 1, make_shapes, s);
	if (!code && atomic_load(&s->failed))
		code = ENCRE_ERROR_MEMORY;
	for (int i = 0; i < n; i++)
		if (s->recipes[i].like >= 0)
			s->recipes[i].shape = s->recipes[s->recipes[i].like].shape;
	int32_t kept = keep(c->kept, s->recipes, n);
	return code ? code : kept;
}

/* ---- bodies ---------------------------------------------------------------------------------------------------- */

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
	b->solid = s && s->tree.n_nodes && invert(mesh->model, b->inverse);
	for (int k = 0; k < 3; k++) /* boxes are floats */
		b->solid = b->solid && b->low[k] > -1e37 && b->high[k] < 1e37;
}

static void make_bodies(void *data, int from, int end, int thread)
{
	(void)thread;
	search *s = data;
	for (int i = from; i < end && !bands_stopped(s->c->pool); i++)
		make_body(s->c->bodies + i, s->c->job->meshes + i, s->recipes[i].shape);
}

static int32_t place_bodies(chains *c)
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

int32_t shapes_find(chains *c)
{
	size_t n = (size_t)c->n_bodies, room = 16;
	while (room < 2 * n)
		room *= 2;
	search s = {.c = c,
		    .recipes = late_take(&c->late, n + 1, sizeof *s.recipes),
		    .ask = late_take(&c->late, n + 1, sizeof *s.ask)};
	int *table = late_take(&c->late, room, sizeof *table);
	c->bodies = late_take(&c->late, n + 1, sizeof *c->bodies);
	c->order = late_take(&c->late, n + 1, sizeof *c->order);
	if (!s.recipes || !s.ask || !table || !c->bodies || !c->order)
		return ENCRE_ERROR_MEMORY;
	int32_t code = find_shapes(c, &s, table, room);
	if (!code)
		code = bands_run(c->pool, c->n_bodies, 1, make_bodies, &s);
	return code ? code : place_bodies(c);
}
