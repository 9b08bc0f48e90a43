/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Points and directions, and matrices of 3 rows of 4: from one space to another. */
#ifndef ENCRE_VECTOR_H
#define ENCRE_VECTOR_H

#include "base/pixel.h"

#include <stdbool.h>

typedef struct vec {
	float x, y, z;
} vec;

typedef struct box {
	vec low, high;
} box;

static inline vec vec_of(const float *p)
{
	return (vec){p[0], p[1], p[2]};
}

static inline vec plus(vec a, vec b)
{
	return (vec){a.x + b.x, a.y + b.y, a.z + b.z};
}

static inline vec minus(vec a, vec b)
{
	return (vec){a.x - b.x, a.y - b.y, a.z - b.z};
}

static inline vec times(vec a, float s)
{
	return (vec){a.x * s, a.y * s, a.z * s};
}

static inline float dot(vec a, vec b)
{
	return a.x * b.x + a.y * b.y + a.z * b.z;
}

static inline vec cross(vec a, vec b)
{
	return (vec){a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

static inline vec unit(vec a)
{
	return times(a, 1 / sqrtf(dot(a, a) + 1e-30f));
}

static inline void box_add(box *b, vec p)
{
	b->low = (vec){min(b->low.x, p.x), min(b->low.y, p.y), min(b->low.z, p.z)};
	b->high = (vec){max(b->high.x, p.x), max(b->high.y, p.y), max(b->high.z, p.z)};
}

static inline bool holds(const box *b, vec p)
{
	return (p.x >= b->low.x) & (p.x <= b->high.x) & (p.y >= b->low.y) & (p.y <= b->high.y) & (p.z >= b->low.z) &
	       (p.z <= b->high.z);
}

static inline vec absolute(vec a)
{
	return (vec){fabsf(a.x), fabsf(a.y), fabsf(a.z)};
}

static inline float largest(vec a)
{
	return max3(fabsf(a.x), fabsf(a.y), fabsf(a.z));
}

static inline void transform_point(const double m[12], const double p[3], double out[3])
{
	for (int i = 0; i < 3; i++)
		out[i] = m[4 * i] * p[0] + m[4 * i + 1] * p[1] + m[4 * i + 2] * p[2] + m[4 * i + 3];
}

static inline vec transform_way(const double m[12], vec p)
{
	double x = (double)p.x, y = (double)p.y, z = (double)p.z;
	return (vec){(float)(m[0] * x + m[1] * y + m[2] * z), (float)(m[4] * x + m[5] * y + m[6] * z),
		     (float)(m[8] * x + m[9] * y + m[10] * z)};
}

#endif
