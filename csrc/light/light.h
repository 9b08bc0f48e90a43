/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What the files that draw light share: the picture with a margin around it, and what each pixel's centre shows. */
#ifndef ENCRE_LIGHT_H
#define ENCRE_LIGHT_H

#include "light/lamp.h"
#include "light/rays.h"

/* Pixels around the images that are drawn, too: where a shadow is soft, a pixel of the border takes part in what is
 * done with others as far away as that. */
enum { LIGHT_MARGIN = 22 };

enum { SURFACE_NOTHING = -1, SURFACE_STRAY = -2 /* of no geometry: only depth and normal tell of it */ };

typedef struct surface {
	vec at, normal;             /* normal: by which light falls; towards the eye, as `across` */
	vec from, across;           /* where rays begin; of the triangle, length 1 */
	int32_t instance, triangle; /* or SURFACE_... */
} surface;

/* What a lamp does at a pixel: 0 where none of its light would come. */
enum { LIT = 1, DARK = 2, MIXED = LIT | DARK, FULL = 4 /* all of its points were asked */ };

typedef struct light {
	const encre_light_job *job;
	bands *bands;
	world world;
	int width, height;  /* with the margin */
	double inverse[16]; /* clip -> world */
	surface *surfaces;
	uint8_t *state;
	float *plain; /* light without shadows */
	float *share; /* what of it comes */
	float *more;  /* two each: on the ways to the right and down where an edge passes, negative: none; or shares
			 while they are smoothed */
	float *sum;   /* three each: the light of all lamps so far */
	lamp lamp;
	lamp_points points;
} light;

/* place.c: fills the surfaces of a row. */
void ISA(place_row)(light *l, int y);
/* What the way of sight through a place in pixels of the picture with its margin meets on the surface that the centre
 * of another pixel shows; *inside: whether it is still the same triangle. */
surface ISA(place_on)(const light *l, const surface *near, float x, float y, bool *inside);
/* shadow.c: the shares of light of one lamp. */
int32_t ISA(shadow_run)(light *l);

static inline bool one_surface(const surface *a, const surface *b)
{
	vec d = minus(b->at, a->at);
	float near = 0.3f * sqrtf(dot(d, d));
	return dot(a->across, b->across) > 0.5f && fabsf(dot(d, a->across)) <= near && fabsf(dot(d, b->across)) <= near;
}

#endif
