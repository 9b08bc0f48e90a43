/* SPDX-License-Identifier: GPL-3.0-or-later */
/* One line on the screen: where it passes between the centres of neighbouring pixels. */
#ifndef ENCRE_SEGMENT_H
#define ENCRE_SEGMENT_H

#include "raster/outline.h"

/* Both ends: place in pixels of the full frame, a pixel's centre being whole numbers, and depth and 1 over w, with
 * which depth is linear on the screen. */
typedef struct segment {
	double x[2], y[2], z[2], u[2];
} segment;

/* Where a line passes: on the way from the centre of a pixel of the full frame to that of its right neighbour, or
 * `down` to its lower one, at `share` of it, and how deep it lies there. */
typedef struct crossing {
	int column, row;
	bool down;
	double share, x, y, z;
} crossing;

typedef void (*segment_found)(void *user, const crossing *c);

/* False where no crossing can be in the room. *y0..*y1-1: the rows of the full frame in which crossings lie. */
bool segment_make(const room *room, const corner corner[2], segment *s, int *y0, int *y1);
/* Calls `found` for each crossing at columns x0..x1-1 and rows y0..y1-1 of the full frame. Squares of four centres that
 * follow each other along lines which share a corner, too, are always joined by a crossing. */
void segment_cross(const segment *s, int x0, int x1, int y0, int y1, segment_found found, void *user);

#endif
