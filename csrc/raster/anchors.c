/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Where on the thing a pixel is: the rest position of the triangle in front, and its growth from pixel to pixel. A
 * corner's share of a place on the screen is a quotient of linear functions of the place, so that its derivatives are
 * exact, in perspective too. */
#include "raster/anchors.h"
#include "raster/form.h"
#include "raster/raster.h"

#include <math.h>
#include <string.h>

enum {
	MEASURED = 65536, /* triangles of a part that are measured, about */
	STEEPEST = 64     /* pixels' spans that the position grows per pixel, at most */
};

static double area_of(double p[3][3])
{
	double square = 0;
	for (int c = 0; c < 3; c++) {
		int a = (c + 1) % 3, b = (c + 2) % 3;
		double across = (p[1][a] - p[0][a]) * (p[2][b] - p[0][b]) - (p[1][b] - p[0][b]) * (p[2][a] - p[0][a]);
		square += across * across;
	}
	return sqrt(square);
}

/* Along each axis by up to half its size, of all its surface: where it is small beside the waves of noise its copies
 * are drawn much as it is, as the eyes of a face must be. By powers of two, so that a mesh that changes its size is
 * shifted by as much as before, but for when it doubles. */
static void shift_part(part *part, double area)
{
	int power;
	frexp(sqrt(area), &power);
	for (uint32_t c = 0; c < 3; c++) {
		uint32_t bits = mix_bits(mix_bits((uint32_t)part->mesh->seed) + c);
		part->shift[c] = part->mesh->seed ? ldexp((double)bits - 0x1p31, power - 32) : 0;
	}
}

/* Of a large mesh every so many: always the same ones, so that an animated mesh has no flicker from the choice. */
static void measure(part *part)
{
	double world = 0, rest = 0;
	uint32_t n = (uint32_t)part->mesh->n_primitives, step = n / MEASURED + 1;
	for (uint32_t i = 0; i < n; i += step) {
		double there[3][3], here[3][3];
		float corners[3][3];
		geometry_world(part, i, there);
		geometry_rest(part, i, corners);
		for (int k = 0; k < 9; k++)
			here[k / 3][k % 3] = (double)corners[k / 3][k % 3];
		double one = area_of(there), other = area_of(here);
		if (isfinite(one) && isfinite(other)) {
			world += one;
			rest += other;
		}
	}
	part->span = world > 0 ? sqrt(rest / world) : 0;
	shift_part(part, rest * step);
}

static void measure_parts(void *data, int p0, int p1, int thread)
{
	(void)thread;
	geometry *g = data;
	for (int i = p0; i < p1; i++)
		if (g->parts[i].mesh->kind == ENCRE_TRIANGLES)
			measure(g->parts + i);
}

int32_t anchors_measure(bands *pool, geometry *g)
{
	return g->n_parts ? bands_run(pool, g->n_parts, 1, measure_parts, g) : ENCRE_OK;
}

static bool unit(const double n[3], float *out)
{
	double square = n[0] * n[0] + n[1] * n[1] + n[2] * n[2], scale = square > 0 ? 1 / sqrt(square) : 0;
	for (int c = 0; c < 3; c++)
		out[c] = (float)(n[c] * scale);
	return square > 0;
}

/* Of the surface as geometry_rest() stretches it. */
static void stretch_normal(const part *part, const float own[3], float normal[3])
{
	const float *s = part->stretch;
	double n[3];
	if (s[0] == 1 && s[1] == 1 && s[2] == 1) {
		memcpy(normal, own, 3 * sizeof *own);
		return;
	}
	for (int c = 0; c < 3; c++)
		n[c] = (double)own[c] * (double)s[(c + 1) % 3] * (double)s[(c + 2) % 3];
	unit(n, normal);
}

void anchors_load(const part *part, uint32_t i, anchor_face *face)
{
	const encre_mesh *mesh = part->mesh;
	face->part = part;
	const float *normals = mesh->rest_normals;
	face->smooth = normals != NULL;
	geometry_rest(part, i, face->rest);
	for (int k = 0; normals && k < 3; k++)
		stretch_normal(part, normals + (size_t)i * 9 + 3 * k, face->normals + 3 * k);
	form_of(face->rest, face->smooth ? face->normals : NULL, face->form);
	for (int c = 0; c < 3; c++) {
		int a = (c + 1) % 3, b = (c + 2) % 3;
		const float *p = face->rest[0], *q = face->rest[1], *r = face->rest[2];
		face->flat[c] = (q[a] - p[a]) * (r[b] - p[b]) - (q[b] - p[b]) * (r[a] - p[a]);
	}
}

void anchors_tangent(const part *part, uint32_t i, float tangent[3])
{
	const float *uv = part->mesh->uv ? part->mesh->uv + (size_t)i * 6 : NULL;
	float rest[3][3];
	double along[3];
	memset(tangent, 0, 3 * sizeof *tangent);
	if (!uv)
		return;
	geometry_rest(part, i, rest);
	double u1 = (double)uv[2] - (double)uv[0], v1 = (double)uv[3] - (double)uv[1];
	double u2 = (double)uv[4] - (double)uv[0], v2 = (double)uv[5] - (double)uv[1];
	double area = u1 * v2 - u2 * v1, side = area < 0 ? -1 : area > 0 ? 1 : 0;
	for (int c = 0; c < 3; c++) {
		double p = (double)rest[0][c];
		along[c] = side * (v2 * ((double)rest[1][c] - p) - v1 * ((double)rest[2][c] - p));
	}
	unit(along, tangent);
	if (!(isfinite(tangent[0]) && isfinite(tangent[1]) && isfinite(tangent[2])))
		memset(tangent, 0, 3 * sizeof *tangent);
}

static void draw_normal(const anchor_face *face, const double share[3], float *out)
{
	double n[3] = {(double)face->flat[0], (double)face->flat[1], (double)face->flat[2]}, smooth[3] = {0};
	for (int k = 0; k < 9 && face->smooth; k++)
		smooth[k % 3] += share[k / 3] * (double)face->normals[k];
	if (!unit(smooth, out))
		unit(n, out);
}

/* growth, at most STEEPEST pixels long: of a surface that is seen on its edge it has no bounds. */
static void draw_growth(const anchor_face *face, const double growth[3], double pixel, float *out)
{
	double g[3] = {0}, square = 0;
	for (int c = 0; c < 3; c++) {
		for (int k = 0; k < 3; k++)
			g[c] += growth[k] * (double)face->rest[k][c];
		square += g[c] * g[c];
	}
	double length = sqrt(square), most = STEEPEST * pixel, scale = length > most ? most / length : 1;
	for (int c = 0; c < 3; c++)
		out[c] = (float)(g[c] * scale);
}

void anchors_draw(const encre_raster_job *job, const anchor_face *face, const corner corner[3], int x, int y)
{
	float *out = pixel_at(&job->anchor, x, y);
	memset(out, 0, ANCHOR_COUNT * sizeof *out);
	if (!face)
		return;
	double share[3], right[3], down[3], w = 0;
	outline_growth(corner, job->frame.x + x + 0.5, job->frame.y + y + 0.5, share, right, down);
	for (int k = 0; k < 3; k++)
		w += share[k] * corner[k].w;
	double lens = fabs(job->projection[0] * job->projection[5]) * job->frame.width * job->frame.height;
	double pixel = lens > 0 ? 2 * w / sqrt(lens) * face->part->span : 0;
	for (int c = 0; c < 3; c++) {
		const float *p = face->rest[0] + c; /* from the first corner on: a constant stays what it is */
		out[ANCHOR_POSITION + c] = (float)((double)p[0] + share[1] * ((double)p[3] - (double)p[0]) +
						   share[2] * ((double)p[6] - (double)p[0]) + face->part->shift[c]);
	}
	draw_normal(face, share, out + ANCHOR_NORMAL);
	out[ANCHOR_PIXEL] = (float)pixel;
	draw_growth(face, right, pixel, out + ANCHOR_RIGHT);
	draw_growth(face, down, pixel, out + ANCHOR_DOWN);
	memcpy(out + ANCHOR_FORM, face->form, sizeof face->form);
	bool finite = out[ANCHOR_PIXEL] > 0;
	for (int c = 0; c < ANCHOR_COUNT; c++)
		finite = finite && isfinite(out[c]);
	if (!finite)
		memset(out, 0, ANCHOR_COUNT * sizeof *out);
}
