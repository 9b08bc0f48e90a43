/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The shapes of a job: instances share one, and those of the last job are known again by their keys. */
#include "chains/shapes.h"

#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>

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
			recipe_key(s->recipes + i);
}

static void make_shapes(void *data, int from, int end, int thread)
{
	(void)thread;
	search *s = data;
	for (int i = from; i < end && !bands_stopped(s->c->pool); i++) {
		recipe *r = s->recipes + s->ask[i];
		r->shape = shape_make(r);
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
		*r = recipe_of(c->job->meshes + i);
	}
	memset(table, 0xff, room * sizeof *table);
	for (int i = 0; i < n; i++) {
		recipe *r = s->recipes + i;
		size_t at =
			slot_of(s->recipes, table, room, r, (uint64_t)(uintptr_t)r->mesh->points, recipe_same_arrays);
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
	return code ? code : bodies_place(c, s.recipes);
}
