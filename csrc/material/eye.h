/* SPDX-License-Identifier: GPL-3.0-or-later */
/* From pixels and their depth to places in the world, and how these are looked at. */
#ifndef ENCRE_MATERIAL_EYE_H
#define ENCRE_MATERIAL_EYE_H

#include "material/material.h"

#include <math.h>

typedef struct eye {
	double inverse[12]; /* pixel and depth -> world: right, down, ahead, origin */
	bool straight;      /* rays of an orthographic camera */
	const double *view;
	const encre_frame *frame;
} eye;

/* A pixel's ray, in the world, grows with its place: right and down by so much. */
static inline eye eye_of(const encre_material_job *job)
{
	const double *v = job->view, *p = job->projection;
	const encre_frame *f = &job->frame;
	eye e = {.straight = p[14] == 0, .view = v, .frame = f};
	double sign = e.straight ? 1 : -p[14]; /* w is that times the depth */
	double camera[4][3] = {
		{2 * sign / (f->width * p[0]), 0, 0}, {0, -2 * sign / (f->height * p[5]), 0}, {0, 0, -1}, {0, 0, 0}};
	double origin[2] = {e.straight ? (-1 - p[3]) / p[0] : (-sign + p[2]) / p[0],
			    e.straight ? (1 - p[7]) / p[5] : (sign + p[6]) / p[5]};
	for (int k = 0; k < 2; k++)
		camera[e.straight ? 3 : 2][k] = origin[k];
	for (int c = 0; c < 3; c++) {
		double from = -(v[c] * v[3] + v[4 + c] * v[7] + v[8 + c] * v[11]);
		for (int k = 0; k < 4; k++)
			e.inverse[3 * k + c] = v[c] * camera[k][0] + v[4 + c] * camera[k][1] + v[8 + c] * camera[k][2] +
					       (k == 3 ? from : 0);
	}
	return e;
}

/* The point of the world that lies z deep at a pixel. */
static inline void eye_place(const eye *e, float depth, int x, int y, double out[3])
{
	double z = (double)depth, wide = e->straight ? 1 : z;
	double px = e->frame->x + x + 0.5, py = e->frame->y + y + 0.5;
	for (int c = 0; c < 3; c++) {
		const double *m = e->inverse + c;
		out[c] = wide * (m[0] * px + m[3] * py) + z * m[6] + m[9];
	}
}

/* How pixel i of a block is looked at: `incoming` and `camera` of operations.rows.h. */
static inline void eye_looks(const eye *e, block *b, int i, float depth, int x, int y)
{
	const double *m = e->inverse;
	double px = e->frame->x + x + 0.5, py = e->frame->y + y + 0.5, place[3], ray[3], size = 0;
	eye_place(e, depth, x, y, place);
	for (int c = 0; c < 3; c++) {
		ray[c] = (e->straight ? 0 : m[c] * px + m[3 + c] * py) + m[6 + c];
		size += ray[c] * ray[c];
	}
	float length = sqrtf((float)size);
	for (int c = 0; c < 3; c++) {
		const double *row = e->view + 4 * c;
		double seen = row[0] * place[0] + row[1] * place[1] + row[2] * place[2] + row[3];
		b->incoming[c][i] = length > 0 ? -(float)ray[c] / length : 0;
		b->camera[c][i] = (float)(c == 2 ? -seen : seen);
	}
	b->camera[3][i] = (float)(px / e->frame->width);
	b->camera[4][i] = (float)(1 - py / e->frame->height);
}

#endif
