/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Lamps as they are asked, from lamps as they are given, and the points at which those with a size are asked. */
#include "light/lamp.h"

#include <stddef.h>

static vec column(const double m[16], int k)
{
	return (vec){(float)m[k], (float)m[4 + k], (float)m[8 + k]};
}

static float length(vec a)
{
	return sqrtf(dot(a, a));
}

static bool finite_lamp(const lamp *l)
{
	const float values[] = {l->at.x,         l->at.y,   l->at.z,     dot(l->way, l->way), dot(l->u, l->u),
				dot(l->v, l->v), l->radius, l->scale[0], l->scale[1],         l->scale[2]};
	float sum = 0;
	for (size_t i = 0; i < sizeof values / sizeof *values; i++)
		sum += values[i] * 0;
	return sum == 0;
}

static void make_spot(const encre_lamp *given, lamp *l)
{
	float half = 0.5f * given->spot_angle, soft = (1 - pixel_cos(half)) * given->spot_blend;
	l->edge = pixel_cos(half);
	l->blend = 1 / max(soft, 1e-6f);
}

/* Sides in the world, light per area, and the cone that a lamp with a grid before it shines into. */
static void make_area(const encre_lamp *given, lamp *l)
{
	l->u = times(column(given->model, 0), given->width);
	l->v = times(column(given->model, 1), given->height);
	l->soft = length(l->u) > 0 || length(l->v) > 0;
	float half = 0.5f * given->spread;
	if (given->spread < pi - 1e-4f) {
		l->spread = pixel_sin(half) / pixel_cos(half);
		/* tan less its angle: the difference cancels for small ones */
		float excess = half < 0.05f ? half * half * half * (1.0f / 3) : l->spread - half;
		l->gain = 1 / max(excess, 1e-12f);
	}
}

static box goal_of(const lamp *l)
{
	vec mid = l->at, half = {l->radius, l->radius, l->radius};
	if (l->type == ENCRE_SUN) {
		float k = sqrtf(2 * l->open);
		mid = times(l->way, -1);
		half = plus(times(plus(absolute(l->u), absolute(l->v)), k), times(absolute(mid), l->open));
	} else if (l->type == ENCRE_RECTANGLE || l->type == ENCRE_ELLIPSE)
		half = times(plus(absolute(l->u), absolute(l->v)), 0.5f);
	float off = 1e-5f * (largest(mid) + largest(half));
	half = plus(half, (vec){off, off, off});
	return (box){minus(mid, half), plus(mid, half)};
}

bool lamp_make(const encre_lamp *given, lamp *l)
{
	vec x = column(given->model, 0), y = column(given->model, 1), z = column(given->model, 2);
	*l = (lamp){.type = given->type,
		    .light_set = given->light_set,
		    .shadow_set = given->shadow_set,
		    .shadows = given->shadows,
		    .flat = given->flat,
		    .color = {given->color[0], given->color[1], given->color[2]},
		    .at = column(given->model, 3),
		    .way = unit(times(z, -1)),
		    .u = unit(x),
		    .v = unit(y),
		    .scale = {max(length(x), 1e-20f), max(length(y), 1e-20f), max(length(z), 1e-20f)}};
	if (given->type == ENCRE_SUN) {
		float sine = pixel_sin(0.25f * given->width);
		l->open = 2 * sine * sine;
		l->soft = given->width > 0;
		lamp_across(l, l->way, &l->u, &l->v);
	} else if (given->type == ENCRE_POINT || given->type == ENCRE_SPOT) {
		l->radius = given->width;
		l->soft = given->width > 0;
	} else {
		make_area(given, l);
	}
	if (given->type == ENCRE_SPOT)
		make_spot(given, l);
	l->goal = goal_of(l);
	return (l->color[0] || l->color[1] || l->color[2]) && dot(l->way, l->way) > 0.5f && finite_lamp(l);
}

/* Point i of Sobol's sequence in four dimensions (Joe and Kuo 2008): the first two fill a square evenly, and the others
 * do whatever the first are. */
static float sobol(uint32_t i, int dimension)
{
	uint32_t sum = 0, v[32] = {1u << 31, dimension ? 3u << 30 : 1u << 30, 1u << 29};
	for (int k = 0; i >> k; k++) {
		if (k > 1 && dimension < 2)
			v[k] = dimension ? v[k - 1] ^ v[k - 1] >> 1 : v[k - 1] >> 1;
		else if (k > 1 && dimension == 2)
			v[k] = v[k - 1] ^ v[k - 2] ^ v[k - 2] >> 2;
		else if (k > 2)
			v[k] = v[k - 2] ^ v[k - 3] ^ v[k - 3] >> 3;
		sum ^= i >> k & 1 ? v[k] : 0;
	}
	return (float)(sum >> 8) * (1.0f / (1 << 24));
}

/* Point of the unit disc by concentric squares. */
static void disc_of(float a, float b, float out[2])
{
	float x = 2 * a - 1, y = 2 * b - 1, r = fabsf(x) > fabsf(y) ? x : y;
	float angle =
		fabsf(x) > fabsf(y) ? 0.785398163f * (y / x) : 1.57079633f - 0.785398163f * (x / (y == 0 ? 1 : y));
	out[0] = r * pixel_cos(angle);
	out[1] = r * pixel_sin(angle);
}

/* Point i of a set of n, moved from its cell's corner to the middle. Were its place in the pixel tied to that on the
 * lamp, edges would be found beside where they are. */
static void point_of(uint32_t i, uint32_t n, lamp_point *p)
{
	float half = 0.5f / (float)n;
	p->square[0] = sobol(i, 0) + half;
	p->square[1] = sobol(i, 1) + half;
	disc_of(p->square[0], p->square[1], p->disc);
	for (int c = 0; c < 2; c++)
		p->place[c] = 2 * (sobol(i, 2 + c) + half) - 1;
}

/* Bits of column and row in turns: what stands together in a square of 2, 4 ... pixels follows each other. */
static uint32_t woven(uint32_t x, uint32_t y)
{
	uint32_t sum = 0;
	for (int k = 0; k < 8; k++)
		sum |= (x >> k & 1) << 2 * k | (y >> k & 1) << (2 * k + 1);
	return sum;
}

void lamp_points_make(lamp_points *p)
{
	const uint32_t n = LAMP_TILE * LAMP_TILE * LAMP_POINTS, m = LAMP_WIDE * LAMP_WIDE * LAMP_DEALT;
	for (uint32_t y = 0; y < LAMP_TILE; y++)
		for (uint32_t x = 0; x < LAMP_TILE; x++)
			for (uint32_t k = 0; k < LAMP_POINTS; k++)
				point_of(woven(x, y) * LAMP_POINTS + k, n, &p->of[y][x][k]);
	for (uint32_t y = 0; y < LAMP_WIDE; y++)
		for (uint32_t x = 0; x < LAMP_WIDE; x++)
			for (uint32_t k = 0; k < LAMP_DEALT; k++)
				point_of(woven(x, y) * LAMP_DEALT + k, m, &p->first[y][x][k]);
	for (uint32_t k = 0; k < LAMP_PLAIN; k++) {
		point_of(k, LAMP_PLAIN, &p->plain[k]);
		for (int c = 0; c < 2; c++)
			p->disc[c][k] = p->plain[k].disc[c];
	}
	p->middle = (lamp_point){.square = {0.5f, 0.5f}};
	p->rim[0] = (lamp_point){.square = {1, 0.5f}, .disc = {1, 0}};
	p->rim[1] = (lamp_point){.square = {0.5f, 1}, .disc = {0, 1}};
	p->rim[2] = (lamp_point){.square = {0, 0.5f}, .disc = {-1, 0}};
	p->rim[3] = (lamp_point){.square = {0.5f, 0}, .disc = {0, -1}};
}
