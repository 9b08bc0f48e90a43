/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Meshes of the job before are looked for in its order, so that the first one that is compared is the right one unless
 * meshes came or went. */
#include "raster/kept.h"

#include "raster/contours.h"
#include "base/arena.h"

#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>

/* Bytes that stay after a job, at most: six million triangles. */
static const size_t most_kept = (size_t)1 << 28;

/* A mesh, by copies of what it is made of. */
typedef struct kept_mesh {
	const encre_mesh *mesh; /* of the job */
	uint64_t change;        /* never the same for two that differ in what bends depend on */
	int32_t n_triangles, n_points;
	bool has_corners, has_edges, found;
	size_t size;
	void *memory; /* of what follows */
	topology topology;
	float *points;
	int32_t *corners; /* without has_corners none */
	uint8_t *edges;   /* likewise */
} kept_mesh;

/* Of a part of a job, counted without lines. */
typedef struct kept_bends {
	uint64_t change; /* of the mesh that they were found for; 0: they are not there */
	double model[16];
	float offset;
	int32_t n_triangles; /* that there is room for */
	uint16_t *bends;
} kept_bends;

struct raster_kept {
	uint64_t changes; /* so far */
	int n_meshes, n_bends;
	kept_mesh **meshes;
	kept_bends *bends;
};

/* What is found of the job's meshes. */
typedef struct search {
	geometry *g;
	raster_kept *kept;
	int *number; /* by part: its mesh among those kept; -1: lines */
	int *bends;  /* by part: its bends among those kept */
	atomic_bool failed;
} search;

/* ---- meshes ------------------------------------------------------------------------------------------------ */

/* NULL without memory. */
static kept_mesh *new_mesh(const encre_mesh *mesh)
{
	kept_mesh *m = malloc(sizeof *m);
	size_t n = (size_t)mesh->n_primitives, points = (size_t)mesh->n_points;
	arena a = {0};
	if (!m)
		return NULL;
	*m = (kept_mesh){.mesh = mesh,
			 .n_triangles = mesh->n_primitives,
			 .n_points = mesh->n_points,
			 .has_corners = mesh->corners};
	for (int pass = 0; pass < 2; pass++) {
		m->points = arena_take(&a, 3 * points, sizeof *m->points);
		m->corners = arena_take(&a, m->has_corners ? 3 * n : 0, sizeof *m->corners);
		m->edges = arena_take(&a, n, sizeof *m->edges);
		m->topology.next = arena_take(&a, 3 * n, sizeof *m->topology.next);
		m->topology.first = arena_take(&a, n, sizeof *m->topology.first);
		m->topology.piece = arena_take(&a, n, sizeof *m->topology.piece);
		m->size = sizeof *m + a.used;
		if (pass == 0 && !(m->memory = arena_make(&a))) {
			free(m);
			return NULL;
		}
	}
	if (mesh->corners)
		memcpy(m->corners, mesh->corners, 3 * n * sizeof *m->corners);
	return m;
}

static void free_mesh(kept_mesh *m)
{
	if (m)
		free(m->memory);
	free(m);
}

static bool same_corners(const kept_mesh *m, const encre_mesh *mesh)
{
	return m->n_triangles == mesh->n_primitives && m->n_points == mesh->n_points &&
	       m->has_corners == (mesh->corners != NULL) &&
	       (!m->has_corners || !memcmp(m->corners, mesh->corners, 3 * (size_t)m->n_triangles * sizeof *m->corners));
}

/* Takes over where the points are and what edges are taken for. */
static void update(raster_kept *kept, kept_mesh *m, const encre_mesh *mesh)
{
	size_t points = 3 * (size_t)m->n_points * sizeof *m->points, n = (size_t)m->n_triangles;
	m->mesh = mesh;
	if (m->change && m->has_edges == (mesh->edges != NULL) && !memcmp(m->points, mesh->points, points) &&
	    (!mesh->edges || !memcmp(m->edges, mesh->edges, n)))
		return;
	memcpy(m->points, mesh->points, points);
	m->found = m->found && !m->topology.by_place && !topology_by_place(mesh);
	m->has_edges = mesh->edges;
	if (mesh->edges)
		memcpy(m->edges, mesh->edges, n);
	m->change = ++kept->changes;
}

/* The mesh of this shape among those of the job before, from number *next on, which is taken from them; NULL: none. */
static kept_mesh *take(raster_kept *kept, const encre_mesh *mesh, int *next)
{
	for (int k = 0; k < kept->n_meshes; k++) {
		int i = (*next + k) % kept->n_meshes;
		kept_mesh *m = kept->meshes[i];
		if (!m || !same_corners(m, mesh))
			continue;
		kept->meshes[i] = NULL;
		*next = i + 1;
		return m;
	}
	return NULL;
}

static bool same_arrays(const encre_mesh *a, const encre_mesh *b)
{
	return a->points == b->points && a->corners == b->corners && a->edges == b->edges &&
	       a->n_points == b->n_points && a->n_primitives == b->n_primitives;
}

/* Where the mesh of these arrays is in a table of numbers plus 1, or may be put: 0. */
static int *place_of(int *table, size_t room, kept_mesh *const *made, const encre_mesh *mesh)
{
	size_t at = (size_t)((uintptr_t)mesh->points >> 4) * 2654435761u % room;
	while (table[at] && !same_arrays(made[table[at] - 1]->mesh, mesh))
		at = at + 1 < room ? at + 1 : 0;
	return table + at;
}

/* Finds or makes the mesh of every part. */
static bool match_parts(search *s, kept_mesh **made, int *n_made, int *table, size_t room)
{
	int next = 0;
	for (int p = 0; p < s->g->n_parts; p++) {
		const encre_mesh *mesh = s->g->parts[p].mesh;
		s->number[p] = -1;
		if (mesh->kind != ENCRE_TRIANGLES)
			continue;
		int *place = place_of(table, room, made, mesh);
		if (!*place) {
			kept_mesh *m = take(s->kept, mesh, &next);
			m = m ? m : new_mesh(mesh);
			if (!m)
				return false;
			made[*n_made] = m;
			*place = ++*n_made;
			update(s->kept, m, mesh);
		}
		s->number[p] = *place - 1;
	}
	return true;
}

static void free_meshes(raster_kept *kept)
{
	for (int i = 0; i < kept->n_meshes; i++)
		free_mesh(kept->meshes[i]);
	free(kept->meshes);
	kept->meshes = NULL;
	kept->n_meshes = 0;
}

static bool match(search *s)
{
	size_t parts = (size_t)s->g->n_parts, room = 2 * parts + 1;
	kept_mesh **made = malloc((parts + 1) * sizeof *made);
	int *table = calloc(room, sizeof *table), n_made = 0;
	bool ok = made && table && match_parts(s, made, &n_made, table, room);
	free(table);
	free_meshes(s->kept);
	s->kept->meshes = made;
	s->kept->n_meshes = n_made;
	return ok;
}

static void find_topologies(void *data, int m0, int m1, int thread)
{
	(void)thread;
	search *s = data;
	for (int i = m0; i < m1; i++) {
		kept_mesh *m = s->kept->meshes[i];
		m->found = m->found || topology_find(m->mesh, &m->topology);
		if (!m->found)
			atomic_store(&s->failed, true);
	}
}

/* ---- bends ------------------------------------------------------------------------------------------------- */

/* Room for the bends of as many parts as there are, those of the job before in their places. */
static bool room_for_bends(search *s)
{
	raster_kept *kept = s->kept;
	int n = 0;
	for (int p = 0; p < s->g->n_parts; p++)
		s->bends[p] = s->number[p] < 0 ? -1 : n++;
	kept_bends *bends = malloc(((size_t)n + 1) * sizeof *bends);
	if (!bends)
		return false;
	for (int i = 0; i < n || i < kept->n_bends; i++) {
		if (i >= n)
			free(kept->bends[i].bends);
		else
			bends[i] = i < kept->n_bends ? kept->bends[i] : (kept_bends){0};
	}
	free(kept->bends);
	kept->bends = bends;
	kept->n_bends = n;
	return true;
}

static bool find_part_bends(const part *part, const kept_mesh *m, kept_bends *b)
{
	if (b->change == m->change && b->offset == part->mesh->crease_offset &&
	    !memcmp(b->model, part->mesh->model, sizeof b->model))
		return true;
	b->change = 0;
	if (b->n_triangles != m->n_triangles) {
		free(b->bends);
		b->bends = malloc(3 * (size_t)m->n_triangles * sizeof *b->bends);
		b->n_triangles = b->bends ? m->n_triangles : 0;
	}
	if (!b->bends || !contours_bends(part, &m->topology, b->bends))
		return false;
	b->change = m->change;
	b->offset = part->mesh->crease_offset;
	memcpy(b->model, part->mesh->model, sizeof b->model);
	return true;
}

static void find_bends(void *data, int p0, int p1, int thread)
{
	(void)thread;
	search *s = data;
	for (int p = p0; p < p1; p++) {
		if (s->number[p] < 0)
			continue;
		part *part = s->g->parts + p;
		kept_bends *b = s->kept->bends + s->bends[p];
		if (!find_part_bends(part, s->kept->meshes[s->number[p]], b))
			atomic_store(&s->failed, true);
		part->bends = b->bends;
	}
}

/* ---- both -------------------------------------------------------------------------------------------------- */

static int32_t find(bands *pool, search *s, bool bends)
{
	if (!match(s) || (bends && !room_for_bends(s)))
		return ENCRE_ERROR_MEMORY;
	int32_t code = bands_run(pool, s->kept->n_meshes, 1, find_topologies, s);
	if (code || atomic_load(&s->failed))
		return code ? code : ENCRE_ERROR_MEMORY;
	for (int p = 0; p < s->g->n_parts; p++)
		s->g->parts[p].topology = s->number[p] < 0 ? NULL : &s->kept->meshes[s->number[p]]->topology;
	if (bends)
		code = bands_run(pool, s->g->n_parts, 1, find_bends, s);
	return code ? code : atomic_load(&s->failed) ? ENCRE_ERROR_MEMORY : ENCRE_OK;
}

int32_t kept_find(bands *pool, geometry *g, bool bends, raster_kept **kept)
{
	*kept = *kept ? *kept : calloc(1, sizeof **kept);
	int *numbers = malloc((2 * (size_t)g->n_parts + 1) * sizeof *numbers);
	search s = {.g = g, .kept = *kept, .number = numbers, .bends = numbers ? numbers + g->n_parts : NULL};
	atomic_init(&s.failed, false);
	int32_t code = numbers && *kept ? find(pool, &s, bends) : ENCRE_ERROR_MEMORY;
	free(numbers);
	return code;
}

void kept_pieces(const geometry *g, uint32_t *piece)
{
	for (int p = 0; p < g->n_parts; p++) {
		const part *part = g->parts + p;
		for (uint32_t i = 0; i < (uint32_t)part->mesh->n_primitives; i++)
			piece[part->first + i] = part->first + (part->topology ? part->topology->piece[i] : i);
	}
}

void kept_free(raster_kept **kept, bool all)
{
	raster_kept *k = *kept;
	size_t size = 0;
	for (int i = 0; k && i < k->n_meshes; i++)
		size += k->meshes[i]->size;
	for (int i = 0; k && i < k->n_bends; i++)
		size += 3 * (size_t)k->bends[i].n_triangles * sizeof *k->bends[i].bends;
	if (!k || (!all && size <= most_kept))
		return;
	free_meshes(k);
	for (int i = 0; i < k->n_bends; i++)
		free(k->bends[i].bends);
	free(k->bends);
	free(k);
	*kept = NULL;
}
