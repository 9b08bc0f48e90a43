/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The output `anchor`: where on the thing a pixel is. */
#ifndef ENCRE_ANCHORS_H
#define ENCRE_ANCHORS_H

#include "base/bands.h"
#include "raster/geometry.h"

/* Of one triangle; the corners on the screen are the caller's. */
typedef struct anchor_face {
	const part *part;
	float rest[3][3];
	float normals[9]; /* at the corners; 0 = flat */
	bool smooth;
	float flat[3]; /* of any length */
	float form[3];
} anchor_face;

/* Fills `span` and `shift` of all parts. */
int32_t anchors_measure(bands *pool, geometry *g);
void anchors_load(const part *part, uint32_t i, anchor_face *face);
/* The direction at rest in which U grows on a triangle, of length 1; 0 where it does not. */
void anchors_tangent(const part *part, uint32_t i, float tangent[3]);
/* Pixel x, y of the output, whose centre the face covers; NULL: nothing is there. */
void anchors_draw(const encre_raster_job *job, const anchor_face *face, const corner corner[3], int x, int y);

#endif
