/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Corners at one point belong together if their facets hang together around it by edges that bend little: the first of
 * them stands for all, as in topology.c. Each counts by its area and its angle, so that it hardly matters how a face
 * was cut into triangles. A corner that is alone has its facet's own normal. */
#include "raster/facets.h"
#include "base/arena.h"
#include "base/pixel.h"
#include "raster/topology.h"

#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

static const float *point_of(const encre_mesh *mesh, uint32_t corner)
{
	return mesh->points + 3 * (size_t)topology_point(mesh, corner);
}

/* Twice the triangle's area along its normal. */
static void across(const encre_mesh *mesh, uint32_t i, double n[3])
{
	const float *a = point_of(mesh, 3 * i), *b = point_of(mesh, 3 * i + 1), *c = point_of(mesh, 3 * i + 2);
	double u[3], v[3];
	for (int k = 0; k < 3; k++) {
		u[k] = (double)b[k] - a[k];
		v[k] = (double)c[k] - a[k];
	}
	n[0] = u[1] * v[2] - u[2] * v[1];
	n[1] = u[2] * v[0] - u[0] * v[2];
	n[2] = u[0] * v[1] - u[1] * v[0];
}

static double dot(const double a[3], const double b[3])
{
	return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static double cosine(const double a[3], const double b[3])
{
	double lengths = sqrt(dot(a, a)) * sqrt(dot(b, b));
	return lengths > 0 ? dot(a, b) / lengths : 0;
}

static uint32_t next_of(uint32_t corner)
{
	return corner % 3 == 2 ? corner - 2 : corner + 1;
}

/* Both ends of the edge that begins at the corner, if it runs between two facets that look to the same side. */
static void join_over(const encre_mesh *mesh, const topology *t, uint32_t c, double least, const uint8_t *flat,
		      uint32_t *first)
{
	uint32_t d = t->next[c];
	if (!(t->first[c / 3] >> c % 3 & 1) || d == NO_CORNER || t->next[d] != NO_CORNER || !flat[c / 3] ||
	    !flat[d / 3] || !topology_same_place(mesh, topology_point(mesh, c), topology_point(mesh, next_of(d))))
		return;
	double a[3], b[3];
	across(mesh, c / 3, a);
	across(mesh, d / 3, b);
	if (!(cosine(a, b) > least))
		return;
	topology_unite(first, c, next_of(d));
	topology_unite(first, next_of(c), d);
}

/* Whether the normals at a triangle's corners are one, within 3 degrees, and nearly its own, within 15: files that know
 * no flat shading have it so, also where bones have bent it since. What is turned more is so on purpose, as on leaves.
 */
static bool is_facet(const encre_mesh *mesh, uint32_t i)
{
	double own[3], n[3][3];
	if (!mesh->normals)
		return true;
	across(mesh, i, own);
	for (size_t k = 0; k < 9; k++)
		n[k / 3][k % 3] = mesh->normals[9 * (size_t)i + k];
	bool one = true;
	for (int k = 0; k < 3; k++)
		one &= cosine(n[k], n[(k + 1) % 3]) > 0.9986 && cosine(own, n[k]) > 0.966;
	return one;
}

/* A facet's normal as long as its area times its angle at the corner: a board beside its bevel stays a plane. */
static void at_corner(const encre_mesh *mesh, uint32_t c, double n[3])
{
	const float *p = point_of(mesh, c), *q = point_of(mesh, next_of(c)), *r = point_of(mesh, next_of(next_of(c)));
	double u[3], v[3];
	for (int k = 0; k < 3; k++) {
		u[k] = (double)q[k] - p[k];
		v[k] = (double)r[k] - p[k];
	}
	across(mesh, c / 3, n);
	double length = sqrt(dot(n, n)), along = dot(u, v), longest = length > fabs(along) ? length : fabs(along);
	double share = length > 0 ? pixel_atan2((float)(length / longest), (float)(along / longest)) : 0;
	for (int k = 0; k < 3; k++)
		n[k] *= share;
}

static void add(const encre_mesh *mesh, const uint8_t *flat, uint32_t *first, float *normals)
{
	uint32_t corners = 3 * (uint32_t)mesh->n_primitives;
	for (uint32_t c = 0; c < corners; c++)
		for (size_t k = 3 * (size_t)c; k < 3 * (size_t)c + 3; k++)
			normals[k] = flat[c / 3] ? 0 : mesh->normals[k];
	for (uint32_t c = 0; c < corners; c++) {
		double n[3];
		if (!flat[c / 3])
			continue;
		at_corner(mesh, c, n);
		for (size_t k = 0; k < 3; k++)
			normals[3 * (size_t)topology_root(first, c) + k] += (float)n[k];
	}
}

static void set_length(float *n)
{
	double length = sqrt((double)n[0] * n[0] + (double)n[1] * n[1] + (double)n[2] * n[2]);
	if (!(length > 0 && length < INFINITY)) { /* a triangle without an area */
		n[0] = n[1] = 0;
		n[2] = 1;
		length = 1;
	}
	for (int k = 0; k < 3; k++)
		n[k] = (float)(n[k] / length);
}

int32_t facets_smooth(const encre_mesh *mesh, float angle, float *normals)
{
	size_t triangles = (size_t)mesh->n_primitives;
	uint32_t corners = 3 * (uint32_t)triangles, *first = NULL;
	uint8_t *flat = NULL;
	topology t;
	arena a = {0};
	void *memory = NULL;
	for (int pass = 0; pass < 2; pass++) {
		t.next = arena_take(&a, corners, sizeof *t.next);
		t.piece = arena_take(&a, triangles, sizeof *t.piece);
		first = arena_take(&a, corners, sizeof *first);
		t.first = arena_take(&a, triangles, sizeof *t.first);
		flat = arena_take(&a, triangles, sizeof *flat);
		if (pass == 0 && !(memory = arena_make(&a)))
			return ENCRE_ERROR_MEMORY;
	}
	if (!topology_find(mesh, &t)) {
		free(memory);
		return ENCRE_ERROR_MEMORY;
	}
	for (uint32_t c = 0; c < corners; c++)
		first[c] = c;
	for (uint32_t i = 0; i < triangles; i++)
		flat[i] = is_facet(mesh, i);
	for (uint32_t c = 0; c < corners; c++)
		join_over(mesh, &t, c, (double)pixel_cos(angle), flat, first);
	add(mesh, flat, first, normals);
	for (uint32_t c = 0; c < corners; c++) {
		if (!flat[c / 3])
			continue;
		if (topology_root(first, c) == c)
			set_length(normals + 3 * (size_t)c);
		else /* before it, and done */
			memcpy(normals + 3 * (size_t)c, normals + 3 * (size_t)topology_root(first, c),
			       3 * sizeof *normals);
	}
	free(memory);
	return ENCRE_OK;
}
