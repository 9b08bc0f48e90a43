/* SPDX-License-Identifier: GPL-3.0-or-later */
/* How much light a point of a lamp gives to a place, after Cycles' definitions of lamps. */
#ifndef ENCRE_LAMP_H
#define ENCRE_LAMP_H

#include "base/stage.h"
#include "light/vector.h"
#include "encre.h"

/* A lamp that has a size is asked at fixed points. Each pixel of a square of TILE x TILE of the full frame has POINTS
 * of its own, of which the FIRST are spread as well and tell whether the rest matter; DEALT, each pixel of WIDE x WIDE
 * others, tell that of these. */
enum { LAMP_TILE = 4, LAMP_POINTS = 64, LAMP_FIRST = 16, LAMP_WIDE = 8, LAMP_DEALT = 4, LAMP_PLAIN = 16, LAMP_RIM = 4 };

typedef struct lamp_point {
	float square[2], disc[2]; /* of the unit square, and of the unit disc about 0 */
	float place[2];           /* where in the 2 x 2 pixels about a pixel's centre it is looked at from */
} lamp_point;

typedef struct lamp {
	int type, light_set, shadow_set;
	bool soft, shadows, flat;
	float color[3];
	vec at, way, u, v;  /* where it stands, where it shines, and its axes: of length 1, or its sides */
	float scale[3];     /* spot: of its space */
	float radius, open; /* sun: 1 less the cosine of half its angle */
	float edge, blend;  /* spot: cosine where it ends, and 1 over what its soft part takes of it */
	float spread, gain; /* tangent of half the angle; 0 = everywhere */
	box goal;           /* it holds where rays to it end; of a sun, their ways */
} lamp;

/* False where it gives no light. */
bool lamp_make(const encre_lamp *given, lamp *l);
typedef struct lamp_points {
	lamp_point of[LAMP_TILE][LAMP_TILE][LAMP_POINTS]; /* by row and column */
	lamp_point first[LAMP_WIDE][LAMP_WIDE][LAMP_DEALT];
	lamp_point plain[LAMP_PLAIN];     /* for light without shadows */
	float disc[2][LAMP_PLAIN];        /* of these, side by side */
	lamp_point middle, rim[LAMP_RIM]; /* where the lamp ends: ahead along its two axes, and behind */
} lamp_points;

/* Points that are well spread: those of each pixel, of 2 x 2 that begin at an even place, of each square. */
void lamp_points_make(lamp_points *p);

static const float pi = 3.14159265f;
static const float lamp_far = 1e30f;     /* of a way that does not end */
static const float lamp_near = 0.99999f; /* likewise, of one that ends at the lamp */

/* Two directions across w. */
KERNEL void lamp_across(const lamp *l, vec w, vec *u, vec *v)
{
	const bool along = fabsf(dot(l->u, w)) > 0.9f;
	vec a = {along ? l->v.x : l->u.x, along ? l->v.y : l->u.y, along ? l->v.z : l->u.z};
	*u = unit(minus(a, times(w, dot(a, w))));
	*v = cross(w, *u);
}

KERNEL float sun_light(const lamp *l, vec normal, const lamp_point *q, vec *way)
{
	float x = q->disc[0], y = q->disc[1], part = (x * x + y * y) * l->open, k = sqrtf(l->open * (2 - part));
	*way = plus(times(l->way, part - 1), plus(times(l->u, k * x), times(l->v, k * y)));
	return 2 / (2 - l->open) * max(dot(normal, *way), 0) / pi;
}

KERNEL float area_light(const lamp *l, vec to, vec normal, const lamp_point *q, vec *way)
{
	const bool round = l->type == ENCRE_ELLIPSE;
	float a = round ? 0.5f * q->disc[0] : q->square[0] - 0.5f, b = round ? 0.5f * q->disc[1] : q->square[1] - 0.5f;
	*way = plus(to, plus(times(l->u, a), times(l->v, b)));
	float square = dot(*way, *way), length = sqrtf(square), front = -dot(*way, l->way) / length;
	float value = front * max(dot(normal, *way), 0) / (square * length) / (pi * pi);
	if (l->spread > 0)
		value *= l->gain * max(l->spread - sqrtf(max(1 - front * front, 0)) / front, 0);
	return front > 0 ? value : 0;
}

static const float ball_share = 1 / (4 * pi * pi);

/* A ball as a place outside of it sees it. */
typedef struct ball {
	vec w, u, v; /* the way to its middle, of length 1, and across */
	float distance, radius, open;
} ball;

KERNEL ball ball_from(const lamp *l, vec to, float distance)
{
	ball b = {.w = times(to, 1 / distance), .distance = distance, .radius = l->radius};
	lamp_across(l, b.w, &b.u, &b.v);
	float sine = b.radius * b.radius / (distance * distance);
	b.open = sine / (1 + sqrtf(1 - sine));
	return b;
}

/* By a point of the disc: what is seen of the sphere, evenly over the angle that it fills. */
KERNEL float ball_point(const ball *b, vec normal, float x, float y, vec *way)
{
	float part = (x * x + y * y) * b->open, z = 1 - part, k = sqrtf(b->open * (2 - part));
	*way = plus(times(b->w, z), plus(times(b->u, k * x), times(b->v, k * y)));
	float value = ball_share / (b->radius * b->radius) * 2 * b->open * max(dot(normal, *way), 0);
	float inside = b->radius * b->radius - b->distance * b->distance * part * (1 + z);
	*way = times(*way, b->distance * z - sqrtf(max(inside, 0)));
	return value;
}

/* Likewise of a disc that faces the place. */
KERNEL float disc_point(const ball *b, vec to, vec normal, float x, float y, vec *way)
{
	*way = plus(to, plus(times(b->u, x * b->radius), times(b->v, y * b->radius)));
	float square = dot(*way, *way), length = sqrtf(square);
	return ball_share * dot(*way, b->w) / length * max(dot(normal, *way), 0) / (square * length);
}

KERNEL float ball_light(const lamp *l, vec to, float distance, vec normal, const lamp_point *q, vec *way)
{
	float x = q->disc[0], y = q->disc[1];
	float lone = ball_share * max(dot(normal, times(to, 1 / distance)), 0) / (distance * distance);
	vec there;
	ball b = ball_from(l, to, distance);
	float value = l->flat ? disc_point(&b, to, normal, x, y, &there) : ball_point(&b, normal, x, y, &there);
	const bool inside = !l->soft | (distance <= l->radius);
	*way = (vec){inside ? to.x : there.x, inside ? to.y : there.y, inside ? to.z : there.z};
	return inside ? lone : value;
}

KERNEL float spot_share(const lamp *l, vec way)
{
	vec k = unit(
		(vec){dot(way, l->u) / l->scale[0], dot(way, l->v) / l->scale[1], -dot(way, l->way) / l->scale[2]});
	float t = clamp01((k.z - l->edge) * l->blend);
	return t * t * (3 - 2 * t);
}

/* Of a sun, or a ball, all of which is above the horizon, or of any but a rectangle that is below it: the mean over its
 * points. */
static inline bool lamp_mean(const lamp *l, vec at, vec normal, float *value)
{
	const float most = 1e-4f; /* what is left of an angle by floats is less */
	if (l->type == ENCRE_RECTANGLE || l->type == ENCRE_ELLIPSE)
		return false;
	if (l->type == ENCRE_SUN) {
		float slope = -dot(l->way, normal), half = sqrtf(l->open * (2 - l->open));
		*value = slope < 0 ? 0 : slope / pi;
		return fabsf(slope) > half + (slope < 0 ? most : 0);
	}
	vec to = minus(l->at, at);
	float square = dot(to, to), slope = dot(to, normal);
	if (slope < -l->radius - most * sqrtf(square)) {
		*value = 0;
		return true;
	}
	*value = slope / (4 * pi * pi * square * sqrtf(square));
	return l->type == ENCRE_POINT && !l->flat && square > l->radius * l->radius && slope > l->radius;
}

/* Light from one point of the lamp, what is in the way aside, for a lamp of colour 1: the mean over its points is what
 * falls. way, *far: the ray to that point. In loops over rays of a lamp whose type the compiler knows. */
KERNEL float lamp_ray(const lamp *l, vec at, vec normal, const lamp_point *q, vec *way, float *far)
{
	*far = l->type == ENCRE_SUN ? lamp_far : lamp_near;
	if (l->type == ENCRE_SUN)
		return sun_light(l, normal, q, way);
	vec to = minus(l->at, at);
	if (l->type == ENCRE_RECTANGLE || l->type == ENCRE_ELLIPSE)
		return area_light(l, to, normal, q, way);
	float distance = sqrtf(dot(to, to)), value = ball_light(l, to, distance, normal, q, way);
	return l->type == ENCRE_SPOT ? value * spot_share(l, *way) : value;
}

/* Elsewhere. */
static inline float lamp_light(const lamp *l, vec at, vec normal, const lamp_point *q, vec *way, float *far)
{
	return lamp_ray(l, at, normal, q, way, far);
}

#endif
