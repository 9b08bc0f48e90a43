/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Whether something is in the way, and what lies nearest to a place on a line. What rays find never depends on the
 * order in which they look: any number of threads, and any border, find the same. */
#ifndef ENCRE_RAYS_H
#define ENCRE_RAYS_H

#include "base/stage.h"
#include "light/scene.h"

enum { SET_SEEN = -1 /* in the place of a set of shadows: of what the camera sees */ };

typedef struct ray {
	vec from, way; /* world space; it goes to from + far * way */
	float far;
	int32_t instance, triangle; /* which does not count: the one that it begins on */
	int set;                    /* of shadows */
} ray;

/* Where the last ray was stopped: looked at first. Made by HINT_NONE. */
typedef struct hint {
	int32_t instance, top_node, top_slot, node, slot; /* -1: no instance */
} hint;
#define HINT_NONE ((hint){.instance = -1})

bool ISA(ray_blocked)(const world *w, const ray *r, hint *h);

/* What part of a ray's way is free; false if all of it. */
bool ISA(ray_stops)(const world *w, const ray *r, float *share);

typedef struct hit {
	int32_t instance, triangle;
	float share; /* of the way from `from` to `to` */
} hit;

/* Of what the camera can see on the way between two points that which lies nearest to `share` of it; false if nothing
 * does. */
bool ISA(ray_nearest)(const world *w, const double from[3], const double to[3], float share, hit *found);

#endif
