/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Where chains of mesh edges pass between the centres of neighbouring pixels, for what is still drawn pixel by pixel.
 */
#ifndef ENCRE_BETWEEN_H
#define ENCRE_BETWEEN_H

#include "base/stage.h"

/* On the way from a pixel's centre to that of its right neighbour, or of its lower one: at `share` of it, 0 < share <=
 * 1, and so deep. `of` tells of what. */
typedef struct passage {
	const encre_chain_point *of;
	int x, y, down;
	float share, depth;
} passage;

/* How deep an edge lies at a share of its way on the screen from one point to the next. */
float depth_between(const frame *f, const encre_chain_point *a, const encre_chain_point *b, double t);

typedef void (*passage_found)(void *user, const passage *p);

/* Calls `found` for all passages in the images, in the order of the chains. */
void between_each(const frame *f, passage_found found, void *user);
/* Fills of each pixel two, of its way to the right and down: where a contour passes, or where numbers change; 0:
 * nowhere. Of several the first that lies on the nearer of both surfaces. */
void between_contours(const frame *f, float *place);

#endif
