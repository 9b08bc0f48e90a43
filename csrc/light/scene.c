/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The handle that keeps geometry with its trees, instances and lamps by their keys; the world that is made of it. */
#include "light/scene.h"
#include "light/handle.h"
#include "base/refuse.h"

#include <stdlib.h>
#include <string.h>

/* ---- geometry ---------------------------------------------------------------------------------------------- */

static void free_shape(shape *s)
{
	if (!s)
		return;
	tree_free(&s->tree);
	free(s->leaves);
	free(s->points);
	free(s->normals);
	free(s->corners);
	free(s->uvs);
	free(s->textures);
	free(s);
}

static void *copy_of(const void *from, size_t count, size_t size)
{
	void *to = malloc(count * size + 1);
	if (to && count)
		memcpy(to, from, count * size);
	return to;
}

static shape *new_shape(const encre_geometry *g)
{
	shape *s = calloc(1, sizeof *s);
	if (!s)
		return NULL;
	size_t points = (size_t)g->n_points, triangles = (size_t)g->n_triangles;
	s->n_points = g->n_points;
	s->n_triangles = g->n_triangles;
	s->points = copy_of(g->points, 3 * points, sizeof *s->points);
	s->corners = copy_of(g->corners, 3 * triangles, sizeof *s->corners);
	s->normals = g->normals ? copy_of(g->normals, 9 * triangles, sizeof *s->normals) : NULL;
	s->uvs = g->uvs ? copy_of(g->uvs, 6 * triangles, sizeof *s->uvs) : NULL;
	s->textures = g->textures ? copy_of(g->textures, triangles, sizeof *s->textures) : NULL;
	if (!s->points || !s->corners || (g->normals && !s->normals) || (g->uvs && !s->uvs) ||
	    (g->textures && !s->textures)) {
		free_shape(s);
		return NULL;
	}
	return s;
}

int32_t scene_geometry(encre_scene *scene, int64_t key, const encre_geometry *geometry, char *error, size_t size)
{
	shape *old = store_find(&scene->shapes, key), *made;
	if (!geometry) {
		if (old && old->used)
			return refuse(error, size,
				      "geometry %lld: is shown by %d instances; remove them before it, or replace it",
				      (long long)key, (int)old->used);
		free_shape(store_take(&scene->shapes, key));
		return ENCRE_OK;
	}
	if (!store_room(&scene->shapes) || !(made = new_shape(geometry)))
		return ENCRE_ERROR_MEMORY;
	store_put(&scene->shapes, key, made);
	if (old) {
		made->used = old->used;
		for (int32_t i = 0; made->used && i < scene->instances.count; i++) {
			instance *shown = scene->instances.items[i];
			shown->shape = shown->shape == old ? made : shown->shape;
		}
	}
	free_shape(old);
	return ENCRE_OK;
}

/* A triangle's box; false where it is not finite. */
static bool box_of(const shape *s, int32_t triangle, tree_box *box)
{
	float sum = 0;
	for (int c = 0; c < 3; c++) {
		const float *p = s->points + 3 * (ptrdiff_t)s->corners[3 * (ptrdiff_t)triangle + c];
		for (int k = 0; k < 3; k++) {
			sum += p[k] * 0;
			box->low[k] = c && box->low[k] < p[k] ? box->low[k] : p[k];
			box->high[k] = c && box->high[k] > p[k] ? box->high[k] : p[k];
		}
	}
	box->item = triangle;
	return sum == 0;
}

static void fill_leaf(const shape *s, const tree_box *boxes, tree_leaf from, triangle_leaf *leaf)
{
	memset(leaf, 0, sizeof *leaf);
	for (int i = 0; i < LEAF; i++) {
		leaf->item[i] = i < from.count ? boxes[from.from + i].item : -1;
		if (leaf->item[i] < 0)
			continue;
		const int32_t *corner = s->corners + 3 * (ptrdiff_t)leaf->item[i];
		for (int k = 0; k < 3; k++) {
			float p = s->points[3 * (ptrdiff_t)corner[0] + k];
			leaf->corner[k][i] = p;
			leaf->first[k][i] = s->points[3 * (ptrdiff_t)corner[1] + k] - p;
			leaf->second[k][i] = s->points[3 * (ptrdiff_t)corner[2] + k] - p;
		}
	}
}

static bool build_shape(shape *s)
{
	tree_box *boxes = malloc((size_t)s->n_triangles * sizeof *boxes + 1);
	if (!boxes)
		return false;
	int32_t n = 0;
	for (int32_t i = 0; i < s->n_triangles; i++) {
		if (!box_of(s, i, boxes + n))
			continue;
		for (int k = 0; k < 3; k++) {
			s->low[k] = n ? min(s->low[k], boxes[n].low[k]) : boxes[n].low[k];
			s->high[k] = n ? max(s->high[k], boxes[n].high[k]) : boxes[n].high[k];
		}
		n++;
	}
	bool ok = tree_build(&s->tree, boxes, n, LEAF);
	if (ok)
		s->leaves = malloc((size_t)s->tree.n_leaves * sizeof *s->leaves + 1);
	ok = ok && s->leaves;
	for (int32_t i = 0; ok && i < s->tree.n_leaves; i++)
		fill_leaf(s, boxes, s->tree.leaves[i], s->leaves + i);
	free(boxes);
	if (!ok)
		tree_free(&s->tree);
	s->built = ok;
	return ok;
}

/* ---- instances and lamps ----------------------------------------------------------------------------------- */

/* Of a matrix of 3 rows of 4; false where it has none in these numbers. */
static bool invert(const double m[12], double out[12], bool *mirrored)
{
	double det = 0;
	for (int i = 0; i < 3; i++)
		for (int j = 0; j < 3; j++) {
			int a = (j + 1) % 3, b = (j + 2) % 3, c = (i + 1) % 3, d = (i + 2) % 3;
			out[4 * i + j] = m[4 * a + c] * m[4 * b + d] - m[4 * a + d] * m[4 * b + c];
		}
	for (int k = 0; k < 3; k++)
		det += m[k] * out[4 * k];
	bool good = det - det == 0 && det != 0;
	*mirrored = det < 0;
	for (int i = 0; i < 3; i++) {
		for (int j = 0; j < 3; j++)
			out[4 * i + j] /= det;
		out[4 * i + 3] = -(out[4 * i] * m[3] + out[4 * i + 1] * m[7] + out[4 * i + 2] * m[11]);
	}
	for (int i = 0; i < 12; i++)
		good = good && out[i] - out[i] == 0;
	return good;
}

int32_t scene_instance(encre_scene *scene, int64_t key, const encre_instance *given, char *error, size_t size)
{
	instance *made = NULL;
	if (given) {
		shape *shown = store_find(&scene->shapes, given->geometry);
		if (!shown)
			return refuse(error, size,
				      "instance %lld: shows geometry %lld, which is not there; add that first",
				      (long long)key, (long long)given->geometry);
		if (!store_room(&scene->instances) || !(made = malloc(sizeof *made)))
			return ENCRE_ERROR_MEMORY;
		*made = (instance){.geometry = given->geometry,
				   .shape = shown,
				   .light_sets = given->light_sets,
				   .shadow_sets = given->shadow_sets,
				   .camera = given->camera};
		memcpy(made->model, given->model, sizeof made->model);
		made->there = invert(made->model, made->inverse, &made->mirrored);
		shown->used++;
	}
	instance *old = made ? store_put(&scene->instances, key, made) : store_take(&scene->instances, key);
	if (old)
		((shape *)store_find(&scene->shapes, old->geometry))->used--;
	free(old);
	return ENCRE_OK;
}

int32_t scene_texture(encre_scene *scene, int64_t key, const encre_texture *given)
{
	texture *made = NULL;
	if (given) {
		size_t texels = (size_t)given->width * (size_t)given->height;
		if (!store_room(&scene->textures) || !(made = malloc(sizeof *made + texels)))
			return ENCRE_ERROR_MEMORY;
		*made = (texture){given->width, given->height, given->extension, given->closest};
		memcpy(made->alpha, given->alpha, texels);
	}
	free(made ? store_put(&scene->textures, key, made) : store_take(&scene->textures, key));
	return ENCRE_OK;
}

int32_t scene_lamp(encre_scene *scene, int64_t key, const encre_lamp *given)
{
	encre_lamp *made = NULL;
	if (given) {
		if (!store_room(&scene->lamps) || !(made = malloc(sizeof *made)))
			return ENCRE_ERROR_MEMORY;
		*made = *given;
	}
	free(made ? store_put(&scene->lamps, key, made) : store_take(&scene->lamps, key));
	return ENCRE_OK;
}

encre_scene *scene_create(void)
{
	return calloc(1, sizeof(encre_scene));
}

void scene_light(encre_scene *scene)
{
	atomic_fetch_add(&scene->lit, 1);
}

void scene_leave(encre_scene *scene)
{
	if (atomic_fetch_sub(&scene->lit, 1) == 1 && atomic_load(&scene->forgotten))
		scene_free(scene);
}

bool scene_is_lit(const encre_scene *scene)
{
	return atomic_load(&scene->lit) > 0;
}

void scene_free(encre_scene *scene)
{
	if (!scene)
		return;
	if (scene_is_lit(scene)) {
		atomic_store(&scene->forgotten, true);
		return;
	}
	for (int32_t i = 0; i < scene->shapes.count; i++)
		free_shape(scene->shapes.items[i]);
	for (int32_t i = 0; i < scene->instances.count; i++)
		free(scene->instances.items[i]);
	store *const stores[] = {&scene->shapes, &scene->instances, &scene->textures, &scene->lamps};
	for (int i = 0; i < 4; i++) {
		for (int32_t k = 0; i > 1 && k < stores[i]->count; k++)
			free(stores[i]->items[k]);
		free(stores[i]->keys);
		free(stores[i]->items);
	}
	free(scene);
}

/* ---- the world --------------------------------------------------------------------------------------------- */

typedef struct builder {
	const store *shapes;
	atomic_bool failed;
} builder;

static void build_shapes(void *data, int from, int end, int thread)
{
	(void)thread;
	builder *b = data;
	for (int i = from; i < end; i++) {
		shape *s = b->shapes->items[i];
		if (s->used && !s->built && !build_shape(s))
			atomic_store(&b->failed, true);
	}
}

/* Downwards and upwards by more than what rounding of a few products takes away. */
static float below(double x, double size)
{
	return (float)(x - size * 1e-6);
}

static float above(double x, double size)
{
	return (float)(x + size * 1e-6);
}

/* The box in the world of an instance; false where it takes no part. */
static bool world_box(const instance *in, tree_box *box)
{
	if (!in->there || !in->shape->tree.n_nodes)
		return false;
	const shape *s = in->shape;
	double low[3] = {INFINITY, INFINITY, INFINITY}, high[3] = {-INFINITY, -INFINITY, -INFINITY}, size = 0;
	for (int c = 0; c < 8; c++) {
		double p[3], at[3];
		for (int k = 0; k < 3; k++)
			p[k] = (double)(c >> k & 1 ? s->high[k] : s->low[k]);
		transform_point(in->model, p, at);
		for (int k = 0; k < 3; k++) {
			low[k] = low[k] < at[k] ? low[k] : at[k];
			high[k] = high[k] > at[k] ? high[k] : at[k];
			size = fmax(size, fabs(at[k]));
		}
	}
	for (int k = 0; k < 3; k++) {
		box->low[k] = below(low[k], size);
		box->high[k] = above(high[k], size);
	}
	return size < 1e30;
}

/* Has the world show instances of its own, moved. False without memory. */
static bool move_instances(world *w, const double origin[3])
{
	size_t n = (size_t)w->n_instances;
	w->moved = malloc(n * (sizeof *w->moved + sizeof *w->instances) + 1);
	if (!w->moved)
		return false;
	const instance **all = (const instance **)(void *)(w->moved + n);
	for (size_t i = 0; i < n; i++) {
		instance *in = w->moved + i;
		double own[3]; /* where the origin is in its space */
		*in = *w->instances[i];
		transform_point(in->inverse, origin, own);
		for (int k = 0; k < 3; k++) {
			in->model[4 * k + 3] -= origin[k];
			in->inverse[4 * k + 3] = own[k];
		}
		all[i] = in;
	}
	w->instances = all;
	return true;
}

int32_t world_make(world *w, const encre_scene *scene, const double origin[3], bands *pool)
{
	*w = (world){.n_instances = scene->instances.count, .textures = &scene->textures};
	w->instances = (const instance *const *)(void *const *)scene->instances.items;
	if ((origin[0] != 0 || origin[1] != 0 || origin[2] != 0) && !move_instances(w, origin))
		return ENCRE_ERROR_MEMORY;
	builder b = {.shapes = &scene->shapes};
	atomic_init(&b.failed, false);
	int32_t code = bands_run(pool, scene->shapes.count, 1, build_shapes, &b);
	if (code)
		return code;
	w->boxes = malloc((size_t)w->n_instances * sizeof *w->boxes + 1);
	if (atomic_load(&b.failed) || !w->boxes)
		return ENCRE_ERROR_MEMORY;
	int32_t n = 0;
	for (int32_t i = 0; i < w->n_instances; i++) {
		if (!world_box(w->instances[i], w->boxes + n))
			continue;
		for (int k = 0; k < 3; k++) {
			w->low[k] = n ? min(w->low[k], w->boxes[n].low[k]) : w->boxes[n].low[k];
			w->high[k] = n ? max(w->high[k], w->boxes[n].high[k]) : w->boxes[n].high[k];
		}
		w->boxes[n++].item = i;
	}
	return tree_build(&w->tree, w->boxes, n, 1) ? ENCRE_OK : ENCRE_ERROR_MEMORY;
}

void world_free(world *w)
{
	tree_free(&w->tree);
	free(w->boxes);
	free(w->moved);
}
