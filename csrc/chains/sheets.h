/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A face that shows an image, and a sheet: the part of a level of detail of that image that lies on it. */
#ifndef ENCRE_SHEETS_H
#define ENCRE_SHEETS_H

#include "chains/chains.h"
#include "texels/texels.h"

typedef struct face {
	const chains *c;
	const body *b;
	int body;
	int32_t number;
	const boundaries *of;
	corner corner[3];
	double p[3][3]; /* world space */
	double uv[3][2];
	double area;   /* twice, in uv */
	bool mirrored; /* what is left of a way in the image is right on the screen */
	double texel;  /* squared length of a texel in pixels, times the cube of w */
	double finest; /* the w beyond which the image itself is too fine */
} face;

enum { PART_ROOM = 3 + 12 /* corners of a triangle, and one more for each side that cuts it */ };

/* A part of a face: its corners in uv. */
typedef struct face_part {
	int n;
	double at[PART_ROOM][2];
} face_part;

/* Of a face, a level of detail and a tile of the image, in which places are in texels. */
typedef struct sheet {
	const face *f;
	const texel_level *l;
	int level;
	int32_t tile[2];
	face_part shown;       /* in the frame, where the level is taken */
	float low[2], high[2]; /* the box of what of that is in the tile */
	double share[3][3];    /* of a corner at a place: by x, y and 1 */
	double near[3];        /* shares so small are on the edge across */
	double from, to;       /* of w: where the level is taken */
} sheet;

/* The number of the image whose colors a face shows; -1: it shows none that has lines. */
static inline int32_t image_of(const chains *c, const encre_mesh *m, int32_t face)
{
	int32_t material = material_of(m, face);
	int32_t image = material >= 0 && material < c->job->n_image ? c->job->image[material] : -1;
	return image >= 0 && c->images[image] ? image : -1;
}

/* Whether only the inside of a closed piece could be seen of a face. */
static inline bool turned_away(const body *b, int inside, int32_t face)
{
	return inside * b->faces[face] * b->shape->closed[face] > 0;
}

/* False: it shows no image, or none of it can be seen. inside: as prints.c has it. */
bool face_make(const chains *c, int body_number, int inside, int32_t number, face *f);
/* By which w at its place a level of detail is taken: from *low to *high. */
void level_range(const face *f, int level, double *low, double *high);
/* False: the level is taken nowhere on the face that can be seen. */
bool sheet_make(sheet *s, const face *f, int level);
/* Turns to a repeat of the image. False: nothing of that is shown. */
bool sheet_turn(sheet *s, int32_t x, int32_t y);
/* The part of an image's line that lies on a face. False: none does. */
bool sheet_line(const sheet *s, int32_t number, double at[2][2], line *out);

#endif
