/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Random meshes: soups, grids, slivers, points that are no numbers, corners that are none. */
#include "fuzz.h"

#include <math.h>
#include <string.h>

enum { MESHES = 5 };

void random_matrix(double m[16])
{
	double a = 6.3 * share(), c = (float)cos(a), s = (float)sin(a);
	const double turned[16] = {c, -s, 0, share() - 0.5, s, c, 0, share() - 0.5, 0, 0, 1, share() - 0.5, 0, 0, 0, 1};
	memcpy(m, turned, sizeof turned);
	if (chance(0.05))
		for (int k = 0; k < 16; k++)
			m[k] = chance(0.3) ? (double)weird() : m[k];
	if (chance(0.03))
		memset(m, 0, sizeof turned);
}

float *random_triples(int triples)
{
	size_t n = 3 * (size_t)triples;
	float *at = take(n * sizeof *at);
	double size = chance(0.8) ? 4 : magnitude(-20, 30), odd = chance(0.2) ? 0.02 : 0;
	bool grid = chance(0.3), flat = chance(0.1);
	for (size_t k = 0; k < n; k++) {
		double v = size * (2 * share() - 1);
		v = grid ? floor(2 * v) / 2 : v;
		at[k] = chance(odd) ? weird() : (float)(k % 3 == 2 ? (flat ? -5 : v - 5) : v);
	}
	return at;
}

static void random_corners(encre_mesh *mesh, int each)
{
	int n = each * mesh->n_primitives;
	int32_t *at = take((size_t)n * sizeof *at);
	double odd = chance(0.03) ? 0.01 : 0;
	for (int k = 0; k < n; k++) {
		int most = mesh->n_points > 0 ? mesh->n_points - 1 : 0;
		bool next = k % each && chance(0.5), same = k % each && chance(0.03);
		at[k] = same ? at[k - 1] : next ? (at[k - 1] < most ? at[k - 1] + 1 : 0) : whole(0, most);
	}
	for (int k = 0; k < n; k++)
		if (chance(odd))
			at[k] = weird_int();
	mesh->corners = at;
}

static const int32_t *random_numbers(int n)
{
	if (chance(0.6))
		return NULL;
	int32_t *at = take((size_t)n * sizeof *at);
	for (int k = 0; k < n; k++)
		at[k] = chance(0.02) ? weird_int() : whole(-1, 5);
	return at;
}

static const float *random_shares(size_t n)
{
	float *at = take(n * sizeof *at);
	double odd = chance(0.2) ? 0.01 : 0;
	for (size_t k = 0; k < n; k++)
		at[k] = chance(odd) ? weird() : (float)share();
	return at;
}

static void random_mesh(encre_mesh *mesh)
{
	mesh->kind = chance(0.7) ? ENCRE_TRIANGLES : ENCRE_LINES;
	int each = mesh->kind == ENCRE_TRIANGLES ? 3 : 2;
	mesh->n_points = chance(0.1) ? whole(0, 3) : whole(3, 120);
	mesh->n_primitives = chance(0.05) ? whole(0, 4000) : whole(0, 150);
	mesh->n_channels = whole(0, 6);
	if (chance(0.2))
		mesh->n_primitives = mesh->n_points / each;
	else
		random_corners(mesh, each);
	mesh->points = random_triples(mesh->n_points);
	size_t corners = 3 * (size_t)mesh->n_primitives;
	if (mesh->kind == ENCRE_TRIANGLES && mesh->n_channels && chance(0.7))
		mesh->attributes = random_shares(corners * (size_t)mesh->n_channels);
	if (mesh->kind == ENCRE_TRIANGLES && chance(0.5))
		mesh->normals = random_shares(corners * 3);
	if (mesh->kind == ENCRE_TRIANGLES && chance(0.5))
		mesh->uv = random_shares(corners * 2);
	mesh->material = random_numbers(mesh->n_primitives);
	mesh->style = random_numbers(mesh->n_primitives);
	mesh->object = random_numbers(mesh->n_primitives);
	mesh->object_index = whole(-1, 100);
	mesh->material_index = whole(-1, 100);
	mesh->style_index = whole(0, 5);
	random_matrix(mesh->model);
	int32_t *number[] = {&mesh->kind, &mesh->n_primitives, &mesh->n_points, &mesh->n_channels};
	if (chance(0.005)) /* more than there is would be read */
		*number[whole(0, 3)] = -whole(1, INT32_MAX);
}

void random_lens(double view[16], double projection[16], double *clip_start, double *clip_end)
{
	double wide = 0.5 + share(), near = magnitude(-3, 0), far = 100;
	const double eye[16] = {1 / wide,
				0,
				0,
				0,
				0,
				1 / wide,
				0,
				0,
				0,
				0,
				-(far + near) / (far - near),
				-2 * far * near / (far - near),
				0,
				0,
				-1,
				0};
	const double flat[16] = {.2, 0, 0, 0, 0, .2, 0, 0, 0, 0, -.02, -1, 0, 0, 0, 1};
	memcpy(projection, chance(0.7) ? eye : flat, sizeof eye);
	random_matrix(view);
	if (chance(0.03))
		projection[whole(0, 15)] = chance(0.5) ? magnitude(-300, 300) : (double)weird();
	*clip_start = chance(0.7) ? near : chance(0.5) ? 0 : -5;
	*clip_end = chance(0.6) ? far : chance(0.5) ? 0 : 3;
	if (chance(0.03))
		*clip_start = chance(0.5) ? (double)weird() : -magnitude(0, 300);
	if (chance(0.03))
		*clip_end = chance(0.5) ? (double)weird() : magnitude(0, 300);
}

static int32_t run(encre_context *context, void *job)
{
	return encre_raster(context, job);
}

task random_raster(void)
{
	static encre_raster_job job;
	memset(&job, 0, sizeof job);
	task t = {.name = "raster", .run = run, .kind = ENCRE_RASTER, .job = &job, .progress = &job.progress};
	int width = chance(0.2) ? whole(1, 4) : whole(1, 100), height = chance(0.2) ? whole(1, 4) : whole(1, 100);
	shared out = {0};
	job.frame = (encre_frame){width, height, 0, 0, 0};
	if (chance(0.3)) {
		int far = chance(0.8) ? 300 : 60000;
		job.frame = (encre_frame){width, height, whole(0, far), whole(0, far), 0};
		job.frame.width += job.frame.x + whole(0, 300);
		job.frame.height += job.frame.y + whole(0, 300);
	}
	if (chance(0.005))
		job.frame.width = weird_int();
	job.n_channels = whole(0, 6);
	encre_image *image[] = {&job.depth,      &job.normal,  &job.object, &job.material, &job.style, &job.attributes,
				&job.coincident, &job.shading, &job.anchor, &job.tangent,  &job.card};
	const int channels[] = {1, 3, 1, 1, 1, job.n_channels, 1, 3, 16, 3, 4};
	t.n_outputs = sizeof image / sizeof *image;
	for (int i = 0; i < t.n_outputs; i++)
		if (chance(0.7) && channels[i])
			*image[i] = t.output[i] = picture(width, height, channels[i], &out);
	t.any_number[5] = true; /* attributes are passed on */
	job.n_meshes = whole(0, MESHES);
	encre_mesh *meshes = take(MESHES * sizeof *meshes);
	memset(meshes, 0, MESHES * sizeof *meshes);
	for (int i = 0; i < job.n_meshes; i++)
		random_mesh(meshes + i);
	job.meshes = meshes;
	random_lens(job.view, job.projection, &job.clip_start, &job.clip_end);
	return t;
}
