/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What the files that draw light share: the picture with a margin around it, and what each pixel's centre shows. */
#ifndef ENCRE_LIGHT_H
#define ENCRE_LIGHT_H

#include "light/lamp.h"
#include "light/rays.h"

/* Pixels around the images that are drawn, too: where a shadow is soft, a pixel of the border takes part in what is
 * done with others as far away as that. */
enum { LIGHT_MARGIN = 28 };

enum { SURFACE_NOTHING = -1, SURFACE_STRAY = -2 /* of no geometry: only depth and normal tell of it */ };

typedef struct surface {
	vec at, normal;             /* normal: by which light falls; towards the eye, as `across` */
	vec lift, across;           /* how far above it rays begin that graze it; of the triangle, length 1 */
	int32_t instance, triangle; /* or SURFACE_... */
} surface;

/* What a lamp does at a pixel: 0 where none of its light would come. Of a lamp with a size its middle's doings, LIT or
 * DARK where they were asked for, lie CORE_SHIFT higher. */
enum { LIT = 1, DARK = 2, MIXED = LIT | DARK, CORE_SHIFT = 2 };

typedef struct light {
	const encre_light_job *job;
	bands *bands;
	world world;
	int width, height;  /* with the margin */
	double inverse[16]; /* clip -> world */
	surface *surfaces;
	uint8_t *state;
	float *plain;    /* light without shadows */
	float *share;    /* what of it comes */
	float *cut;      /* two each: where on the ways to the right and down an edge passes, negative: nowhere */
	float *spare;    /* shares while they are smoothed */
	float *exact;    /* 1: the share is that of an edge whose place is known; negative: not all points were asked */
	float *sum;      /* three each: the light of all lamps so far */
	double clip[16]; /* world -> clip */
	lamp lamp;
	lamp_points points;
} light;

/* place.c: fills the surfaces of a row. */
void ISA(place_row)(light *l, int y);
/* What the way of sight through a place in pixels of the picture with its margin meets on the surface that the centre
 * of another pixel shows; *inside: whether it is still the same triangle. */
surface ISA(place_on)(const light *l, const surface *near, float x, float y, bool *inside);
/* Where in the full frame a place is, in pixels; far outside if it is behind the camera. */
void ISA(place_pixel)(const light *l, vec at, double out[2]);

/* shadow.c: the shares of light of one lamp; soft.c: of one with a size. */
int32_t ISA(shadow_run)(light *l);
int32_t ISA(soft_run)(light *l);
/* Adds a point's light to *all, and to *seen if nothing is in its way. */
void ISA(shadow_ask)(const light *l, const surface *s, const lamp_point *q, float *all, float *seen, hint *h);
/* What is nearest on the way to the lamp's middle; false if nothing is. */
bool ISA(shadow_thrower)(const light *l, const surface *s, vec *place);
/* Fills `cut`. */
void ISA(edge_rows)(void *light, int y0, int y1, int thread);

/* The line by which a shadow passes a pixel's centre: dot of (x, y) = far, in pixels from it, through (a, 0) and (0,
 * b). */
typedef struct edge_line {
	float x, y, far, a, b;
} edge_line;

bool ISA(edge_at)(const light *l, int x, int y, edge_line *e);

static inline int core_at(const light *l, ptrdiff_t i)
{
	return l->state[i] >> (l->lamp.soft ? CORE_SHIFT : 0) & MIXED;
}

static inline bool one_surface(const surface *a, const surface *b)
{
	vec d = minus(b->at, a->at);
	float near = 0.3f * sqrtf(dot(d, d));
	return dot(a->across, b->across) > 0.5f && fabsf(dot(d, a->across)) <= near && fabsf(dot(d, b->across)) <= near;
}

#endif
