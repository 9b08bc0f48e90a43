/* SPDX-License-Identifier: GPL-3.0-or-later */
/* One primitive on the screen: what it covers and how deep it lies. */
#ifndef ENCRE_OUTLINE_H
#define ENCRE_OUTLINE_H

#include <stdbool.h>
#include <stdint.h>

enum {
	OUTLINE_FRAME = 65536, /* pixels of a frame each way, at most */
	OUTLINE_GUARD = 32768, /* pixels kept outside of it on all sides */
	OUTLINE_NOWHERE = 128, /* of a spot: it is not finite, or so large that products would not be */
	OUTLINE_CORNERS = 12,  /* room for a triangle cut by seven planes, and two more that clipping looks ahead */
};

/* A corner on the screen: x / w and y / w are pixels of the full frame, z is the distance along the view axis. */
typedef struct corner {
	double x, y, w, z;
} corner;

/* Which way round the corners of a triangle go on the screen, also where one lies behind the eye: above 0, below 0, or
 * 0 of what is seen from its edge. */
static inline double outline_turn(const corner *a, const corner *b, const corner *c)
{
	return a->x * (b->y * c->w - c->y * b->w) + b->x * (c->y * a->w - a->y * c->w) +
	       c->x * (a->y * b->w - b->y * a->w);
}

/* A corner, and where it is on the sub-pixel grid unless it lies outside. */
typedef struct spot {
	corner corner;
	int32_t x, y;
	uint32_t outside; /* a bit for each plane beyond which it lies, or OUTLINE_NOWHERE */
} spot;

/* What can be seen: z from start to end, and the columns x0..x1-1 and rows y0..y1-1 of the images. Here and below,
 * columns and rows are counted from the guard's top left: OUTLINE_GUARD more than in the full frame. */
typedef struct room {
	double start, end;
	int frame_width, frame_height;
	int x0, x1, y0, y1;
} room;

/* A convex outline in steps of the sub-pixel grid, the box of pixels whose centres may be in it (not clipped to the
 * images), the corners as they came and the depths between which it lies. */
typedef struct outline {
	corner corner[3];
	int n;
	int32_t x[OUTLINE_CORNERS], y[OUTLINE_CORNERS];
	int x0, x1, y0, y1;
	double nearest, farthest;
} outline;

/* Whether two primitives are one surface about the centre of a pixel, as far as rounding tells. */
typedef bool (*outline_coincide)(const void *user, uint32_t earlier, uint32_t later, int column, int row);

/* Rows y0..y1-1 of the images, packed: depth (INFINITY to begin with) and number of what is nearest, and the number of
 * a later one that coincides with what was nearest when it was drawn. */
typedef struct band {
	int x0, x1, y0, y1;
	float *depth;
	uint32_t *front, *twin;
	const float *beyond; /* likewise: only what lies farther is drawn; NULL: all is */
	float close;         /* depths less apart, and a 2^20th of the depth, may be of surfaces that coincide */
	outline_coincide coincide;
	const void *user;
} band;

/* Fills all but the corner. */
void outline_see(const room *room, spot *s);
/* False where the triangle covers no pixel of the images, is not finite, or cannot be told from that. */
bool outline_make(const room *room, const spot *const spots[3], outline *o);
/* Puts `number` where the outline is nearer than what is there, and does not coincide with it. Numbers grow from call
 * to call. */
void outline_draw(const outline *o, uint32_t number, const band *b);
/* Shares of the second and the third corner at a place in pixels of the full frame, perspective-correct; 0..1 also
 * where snapping has moved an edge. */
void outline_shares(const corner corner[3], double x, double y, double *second, double *third);
/* Shares of all three corners there, and their growth per pixel to the right and down, which has no bounds, or is 0,
 * where the triangle is seen on its edge. */
void outline_growth(const corner corner[3], double x, double y, double share[3], double right[3], double down[3]);
/* Whether the planes of two triangles, at a place in pixels of the full frame and a pixel beside it, are at most
 * `close` apart along the view axis. */
bool outline_same_plane(const corner one[3], const corner other[3], double x, double y, double close);
#endif
