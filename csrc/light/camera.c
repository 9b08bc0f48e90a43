/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "light/handle.h"

#include <math.h>
#include <string.h>

/* Gauss and Jordan, the largest pivot first. False where there is no inverse. */
static bool invert(const double m[16], double out[16])
{
	double a[4][8];
	for (int i = 0; i < 4; i++)
		for (int j = 0; j < 8; j++)
			a[i][j] = j < 4 ? m[4 * i + j] : (double)(j - 4 == i);
	for (int k = 0; k < 4; k++) {
		int pivot = k;
		for (int i = k + 1; i < 4; i++)
			pivot = fabs(a[i][k]) > fabs(a[pivot][k]) ? i : pivot;
		for (int j = 0; j < 8; j++) {
			double t = a[k][j];
			a[k][j] = a[pivot][j];
			a[pivot][j] = t;
		}
		double scale = a[k][k];
		if (!(fabs(scale) > 0))
			return false;
		for (int j = 0; j < 8; j++)
			a[k][j] /= scale;
		for (int i = 0; i < 4; i++) {
			double share = a[i][k];
			for (int j = 0; i != k && j < 8; j++)
				a[i][j] -= share * a[k][j];
		}
	}
	for (int i = 0; i < 16; i++)
		out[i] = a[i / 4][4 + i % 4];
	return true;
}

void camera_product(const double view[16], const double projection[16], double both[16])
{
	for (int i = 0; i < 4; i++)
		for (int j = 0; j < 4; j++) {
			both[4 * i + j] = 0;
			for (int k = 0; k < 4; k++)
				both[4 * i + j] += projection[4 * i + k] * view[4 * k + j];
		}
}

bool camera_inverse(const double view[16], const double projection[16], double inverse[16])
{
	double both[16], out[16];
	camera_product(view, projection, both);
	if (!invert(both, out))
		return false;
	if (inverse)
		memcpy(inverse, out, sizeof out);
	return true;
}
