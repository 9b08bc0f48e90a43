/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Which way a surface bends: the shape operator of a triangle on which normals are interpolated linearly is constant,
 * and exact. It is of the thing at rest, so that what follows it does not wander when the camera moves. */
#include "raster/form.h"

#include <math.h>
#include <string.h>

/* Radians by which normals turn across a triangle: less is what rounding makes of a plane. */
static const double flat_bend = 2e-4, sure_bend = 1e-3;

static double dot(const double a[3], const double b[3])
{
	return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static void cross(const double a[3], const double b[3], double out[3])
{
	for (int c = 0; c < 3; c++) {
		int i = (c + 1) % 3, j = (c + 2) % 3;
		out[c] = a[i] * b[j] - a[j] * b[i];
	}
}

static double unit(double v[3])
{
	double length = sqrt(dot(v, v));
	for (int c = 0; c < 3; c++)
		v[c] /= length > 0 ? length : 1;
	return length;
}

/* The shape operator [a b; b c] in a basis of the triangle's plane; false: the triangle has no area. */
static bool shape(float rest[3][3], const float *normals, double basis[2][3], double s[3], double *size)
{
	double edge[2][3], turn[2][3], normal[3], corner[3][3];
	for (int k = 0; k < 3; k++) {
		for (int c = 0; c < 3; c++)
			corner[k][c] = (double)normals[3 * k + c];
		unit(corner[k]);
	}
	for (int k = 0; k < 2; k++)
		for (int c = 0; c < 3; c++) {
			edge[k][c] = (double)rest[k + 1][c] - (double)rest[0][c];
			turn[k][c] = corner[k + 1][c] - corner[0][c];
		}
	cross(edge[0], edge[1], normal);
	double area = unit(normal), along = 0, up[2][2], bent[2][2];
	memcpy(basis[0], edge[0], sizeof basis[0]);
	along = unit(basis[0]);
	cross(normal, basis[0], basis[1]);
	if (!(area > 1e-12 * along * along) || !isfinite(area))
		return false;
	for (int k = 0; k < 2; k++)
		for (int i = 0; i < 2; i++) {
			up[k][i] = dot(edge[k], basis[i]);
			bent[k][i] = dot(turn[k], basis[i]);
		}
	/* edge 0 lies along the first axis */
	double first[2], second[2];
	for (int i = 0; i < 2; i++) {
		first[i] = bent[0][i] / up[0][0];
		second[i] = (bent[1][i] - up[1][0] * first[i]) / up[1][1];
	}
	s[0] = first[0];
	s[1] = 0.5 * (first[1] + second[0]);
	s[2] = second[1];
	*size = sqrt(area);
	return true;
}

void form_of(float rest[3][3], const float *normals, float form[3])
{
	double basis[2][3], s[3], size, way[2];
	memset(form, 0, 3 * sizeof *form);
	if (!normals || !shape(rest, normals, basis, s, &size))
		return;
	double mean = 0.5 * (s[0] + s[2]), apart = 0.5 * (s[0] - s[2]), half = sqrt(apart * apart + s[1] * s[1]);
	double less = fmin(fabs(mean), half), more = fmax(fabs(mean), half);
	double sure = (2 * more * size - flat_bend) / (sure_bend - flat_bend);
	double length = more > 0 ? less / more * fmin(fmax(sure, 0), 1) : 0;
	if (!(length > 0))
		return;
	way[0] = apart >= 0 ? half + apart : s[1];
	way[1] = apart >= 0 ? s[1] : half - apart;
	double scale = length / sqrt(way[0] * way[0] + way[1] * way[1]);
	for (int c = 0; c < 3; c++) {
		double towards = mean >= 0 ? way[0] * basis[0][c] + way[1] * basis[1][c]
					   : way[0] * basis[1][c] - way[1] * basis[0][c];
		form[c] = (float)(towards * scale);
	}
}
