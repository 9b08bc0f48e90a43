/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Meshes and camera of a raster job: checked, numbered through, brought onto the screen. All in double: a float of
 * object space, moved to the world and into pixels, would lose what decides pixels at an edge. */
#include "raster/geometry.h"
#include "base/refuse.h"

#include <float.h>
#include <math.h>
#include <stdbool.h>
#include <string.h>

static int corners_of(const encre_mesh *mesh)
{
	return mesh->kind == ENCRE_TRIANGLES ? 3 : 2;
}

int32_t geometry_check_mesh(const encre_mesh *mesh, int number, char *error, size_t size)
{
	if (mesh->kind < ENCRE_TRIANGLES || mesh->kind > ENCRE_LINES)
		return refuse(error, size, "mesh %d: kind %d is not known; give ENCRE_TRIANGLES or ENCRE_LINES", number,
			      (int)mesh->kind);
	if (mesh->n_primitives < 0 || mesh->n_points < 0)
		return refuse(error, size, "mesh %d: %d primitives of %d points; give 0 or more of each", number,
			      (int)mesh->n_primitives, (int)mesh->n_points);
	if (mesh->n_channels < 0 || mesh->n_channels > ENCRE_MAX_CHANNELS)
		return refuse(error, size, "mesh %d: has %d attribute channels; give 0 to %d", number,
			      (int)mesh->n_channels, ENCRE_MAX_CHANNELS);
	if (mesh->n_primitives && !mesh->points)
		return refuse(error, size, "mesh %d: has %d primitives, but no points; give them", number,
			      (int)mesh->n_primitives);
	const void *arrays[] = {mesh->points, mesh->corners, mesh->attributes, mesh->material,     mesh->style,
				mesh->object, mesh->normals, mesh->rest,       mesh->rest_normals, mesh->uv};
	for (size_t i = 0; i < sizeof arrays / sizeof *arrays; i++)
		if ((uintptr_t)arrays[i] % sizeof(float))
			return refuse(error, size,
				      "mesh %d: one of its arrays begins at an address that is no multiple of %d; copy "
				      "it to one that is",
				      number, (int)sizeof(float));
	int64_t corners = corners_of(mesh) * (int64_t)mesh->n_primitives;
	if (!mesh->corners && corners > mesh->n_points)
		return refuse(error, size,
			      "mesh %d: %d primitives without corners take more points than its %d; give corners",
			      number, (int)mesh->n_primitives, (int)mesh->n_points);
	for (int64_t i = 0; mesh->corners && i < corners; i++)
		if ((uint32_t)mesh->corners[i] >= (uint32_t)mesh->n_points)
			return refuse(error, size,
				      "mesh %d: primitive %d has a corner at point %d of %d; give indices from 0 to "
				      "the number of points less one",
				      number, (int)(i / corners_of(mesh)), (int)mesh->corners[i], (int)mesh->n_points);
	return ENCRE_OK;
}

int32_t geometry_check(geometry *g, char *error, size_t size)
{
	const encre_raster_job *job = g->job;
	if (!all_finite(job->view, 16) || !all_finite(job->projection, 16) || !all_finite(&job->clip_start, 1) ||
	    isnan(job->clip_end))
		return refuse(error, size,
			      "camera: a matrix or clip distance is not a finite number; give the camera another place "
			      "or lens");
	if (job->n_meshes < 0 || (job->n_meshes && !job->meshes) || (uintptr_t)job->meshes % _Alignof(encre_mesh))
		return refuse(error, size, "meshes: %d of them are not there; give their number and where they lie",
			      (int)job->n_meshes);
	int64_t n = 0;
	for (int i = 0; i < job->n_meshes; i++) {
		int32_t code = geometry_check_mesh(job->meshes + i, i, error, size);
		if (code)
			return code;
		n += job->meshes[i].n_primitives;
		if (job->meshes[i].n_primitives && job->meshes[i].kind == ENCRE_TRIANGLES)
			g->n_points += (size_t)job->meshes[i].n_points;
	}
	if (n > UINT32_MAX / 3)
		return refuse(error, size, "meshes: have more than %lld primitives; draw them in several jobs",
			      (long long)UINT32_MAX / 3);
	g->n_primitives = (uint32_t)n;
	return ENCRE_OK;
}

static void multiply(const double a[16], const double b[16], double out[16])
{
	for (int i = 0; i < 4; i++)
		for (int j = 0; j < 4; j++)
			out[4 * i + j] = a[4 * i] * b[j] + a[4 * i + 1] * b[4 + j] + a[4 * i + 2] * b[8 + j] +
					 a[4 * i + 3] * b[12 + j];
}

/* Of the left upper 3 x 3. They turn what lies across two edges as the edges turn: mirrored where these are. */
/* Of the scale: what is less is of rounding in a matrix that turns. */
static const double least_stretch = 1e-4;

static void cofactors(const double m[16], double out[9])
{
	for (int i = 0; i < 3; i++)
		for (int j = 0; j < 3; j++) {
			int a = (i + 1) % 3, b = (i + 2) % 3, c = (j + 1) % 3, d = (j + 2) % 3;
			out[3 * i + j] = m[4 * a + c] * m[4 * b + d] - m[4 * a + d] * m[4 * b + c];
		}
}

/* By how much more each axis of object space is scaled than all are on average, of length. */
static void stretch_of(const double m[16], float stretch[3])
{
	double length[3], mean = 0, most = 0;
	for (int k = 0; k < 3; k++) {
		double square = m[k] * m[k] + m[4 + k] * m[4 + k] + m[8 + k] * m[8 + k];
		length[k] = sqrt(square);
		mean += square / 3;
	}
	mean = sqrt(mean);
	for (int k = 0; k < 3; k++)
		most = fmax(most, fabs(length[k] - mean));
	bool even = !(most > least_stretch * mean) || !isfinite(mean);
	for (int k = 0; k < 3; k++)
		stretch[k] = even ? 1 : (float)(length[k] / mean);
}

void geometry_aim(geometry *g)
{
	const encre_raster_job *job = g->job;
	const double *v = job->view, *p = job->projection;
	double camera[16];
	for (int k = 0; k < 4; k++) { /* clip space -> pixels: row 0 is the top */
		camera[k] = 0.5 * job->frame.width * (p[12 + k] + p[k]);
		camera[4 + k] = 0.5 * job->frame.height * (p[12 + k] - p[4 + k]);
		camera[8 + k] = p[12 + k];
		camera[12 + k] = k == 2 ? -1 : 0;
	}
	uint32_t first = 0;
	for (int i = 0; i < job->n_meshes; i++) {
		const encre_mesh *mesh = job->meshes + i;
		if (!mesh->n_primitives)
			continue;
		part *part = g->parts + g->n_parts++;
		double view[16];
		multiply(v, mesh->model, view);
		multiply(camera, view, part->screen);
		part->spots = NULL;
		part->span = 0;
		part->mesh = mesh;
		part->first = first;
		cofactors(mesh->model, part->turn);
		stretch_of(mesh->model, part->stretch);
		first += (uint32_t)mesh->n_primitives;
	}
	bool perspective = p[14] != 0;
	for (int i = 0; i < 3; i++)
		g->eye[i] = perspective ? -(v[i] * v[3] + v[4 + i] * v[7] + v[8 + i] * v[11]) : v[8 + i];
	g->eye[3] = perspective;
}

const part *geometry_part(const geometry *g, const part *last, uint32_t number)
{
	if (last && number - last->first < (uint32_t)last->mesh->n_primitives)
		return last;
	int low = 0, high = g->n_parts;
	while (high - low > 1) {
		int middle = low + (high - low) / 2;
		if (g->parts[middle].first <= number)
			low = middle;
		else
			high = middle;
	}
	return g->parts + low;
}

float geometry_object(const part *part, uint32_t number)
{
	const encre_mesh *mesh = part->mesh;
	return (float)(mesh->object ? mesh->object[number - part->first] : mesh->object_index);
}

static int64_t number_of(const encre_mesh *mesh, uint32_t primitive, int k)
{
	int64_t c = corners_of(mesh) * (int64_t)primitive + k;
	return mesh->corners ? mesh->corners[c] : c;
}

static const float *point_of(const encre_mesh *mesh, uint32_t primitive, int k)
{
	return mesh->points + 3 * number_of(mesh, primitive, k);
}

static inline double row_times(const double *row, const float *p)
{
	return row[0] * (double)p[0] + row[1] * (double)p[1] + row[2] * (double)p[2] + row[3];
}

corner geometry_corner(const part *part, const float *point)
{
	const double *m = part->screen;
	return (corner){row_times(m, point), row_times(m + 4, point), row_times(m + 8, point),
			row_times(m + 12, point)};
}

void geometry_corners(const part *part, uint32_t i, corner c[3])
{
	for (int k = 0; k < corners_of(part->mesh); k++)
		c[k] = part->spots ? part->spots[number_of(part->mesh, i, k)].corner
				   : geometry_corner(part, point_of(part->mesh, i, k));
}

bool geometry_outline(const part *part, uint32_t i, const room *room, outline *o)
{
	const spot *spots[3];
	for (int k = 0; k < 3; k++)
		spots[k] = part->spots + number_of(part->mesh, i, k);
	return outline_make(room, spots, o);
}

void geometry_world(const part *part, uint32_t i, double p[3][3])
{
	for (int k = 0; k < 3; k++)
		for (int c = 0; c < 3; c++)
			p[k][c] = row_times(part->mesh->model + 4 * c, point_of(part->mesh, i, k));
}

void geometry_rest(const part *part, uint32_t i, float p[3][3])
{
	const encre_mesh *mesh = part->mesh;
	for (int k = 0; k < 3; k++) {
		const float *own = mesh->rest ? mesh->rest + 9 * (size_t)i + 3 * k : point_of(mesh, i, k);
		for (int c = 0; c < 3; c++)
			p[k][c] = own[c] * part->stretch[c];
	}
}

static void cross_edges(double p[3][3], double n[3])
{
	for (int c = 0; c < 3; c++) {
		int a = (c + 1) % 3, b = (c + 2) % 3;
		n[c] = (p[1][a] - p[0][a]) * (p[2][b] - p[0][b]) - (p[1][b] - p[0][b]) * (p[2][a] - p[0][a]);
	}
}

void geometry_across(const part *part, uint32_t i, double across[3])
{
	double p[3][3];
	geometry_world(part, i, p);
	cross_edges(p, across);
}

void geometry_normal(const geometry *g, const part *part, uint32_t i, float normal[3])
{
	double p[3][3], n[3], to[3], facing = 0, square = 0;
	geometry_world(part, i, p);
	cross_edges(p, n);
	for (int c = 0; c < 3; c++) {
		to[c] = g->eye[c] - g->eye[3] * p[0][c];
		square += n[c] * n[c];
	}
	if (!(square > 0)) { /* a line that snapping made a surface: the eye sees it from the front */
		for (int c = 0; c < 3; c++)
			square += (n[c] = to[c]) * to[c];
	}
	for (int c = 0; c < 3; c++)
		facing += n[c] * to[c];
	double length = square > 0 ? sqrt(square) : 1;
	for (int c = 0; c < 3; c++)
		normal[c] = (float)(facing < 0 ? -n[c] / length : n[c] / length);
}

bool geometry_turn(const part *part, const double normal[3], double side, float turned[3])
{
	double n[3], square = 0;
	for (int c = 0; c < 3; c++) {
		const double *row = part->turn + 3 * c;
		n[c] = row[0] * normal[0] + row[1] * normal[1] + row[2] * normal[2];
		square += n[c] * n[c];
	}
	if (!(square > 0 && square <= DBL_MAX))
		return false;
	double scale = side / sqrt(square);
	for (int c = 0; c < 3; c++)
		turned[c] = (float)(scale * n[c]);
	return true;
}
