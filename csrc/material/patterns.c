/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Patterns by formula, the same as Blender's. */
#include "base/pixel.h"
#include "material/hash.h"
#include "material/material.h"

#include <math.h>

#define RUN(name)                                                                                                      \
	void ISA(run_##name)(const block *b, const encre_operation *o, const float *const in[], float *const out[])

/* A whole number; far from 0 they are all alike. */
static inline int32_t whole(float x)
{
	return (int32_t)min(max(floorf(x), -1e9f), 1e9f);
}

RUN(checker)
{
	(void)o;
	for (int i = 0; i < b->n; i++) {
		int32_t odd = 0;
		for (int c = 0; c < 3; c++) /* places on a boundary are inside, whatever rounding does */
			odd ^= whole((in[c][i] + 0.000001f) * 0.999999f);
		out[0][i] = odd & 1 ? 1 : 0;
	}
}

/* ---- bricks ------------------------------------------------------------------------------------------------ */

/* By chance, 0..1. */
static float chance_of(uint32_t n)
{
	n = (n + 1013) & 0x7fffffff;
	n = (n >> 13) ^ n;
	n = (n * (n * n * 60493 + 19990303) + 1376312589) & 0x7fffffff;
	return 0.5f * ((float)n / 1073741824.0f);
}

static inline bool every(int32_t row, float frequency)
{
	int32_t n = whole(frequency);
	return n > 0 && row % n == 0;
}

RUN(brick)
{
	const float *p = b->materials->constants + o->data[0];
	float offset = p[0], offset_every = p[1], squash = p[2], squash_every = p[3], mortar = p[4], smooth = p[5],
	      bias = p[6], wide = p[7], high = p[8];
	for (int i = 0; i < b->n; i++) {
		float width = wide, shift = 0;
		int32_t row = whole(in[1][i] / high);
		if (offset_every >= 1 && squash_every >= 1) {
			width *= every(row, squash_every) ? squash : 1;
			shift = every(row, offset_every) ? width * offset : 0;
		}
		int32_t number = whole((in[0][i] + shift) / width);
		float x = in[0][i] + shift - width * (float)number, y = in[1][i] - high * (float)row;
		float inside = min(min(x, y), min(width - x, high - y));
		out[0][i] = clamp01(chance_of(((uint32_t)row << 16) + ((uint32_t)number & 0xffff)) + bias);
		float t = smooth > 0 ? clamp01((mortar - inside) / (mortar * smooth)) : 1;
		out[1][i] = inside >= mortar ? 0 : t * t * (3 - 2 * t);
	}
}

/* ---- noise ------------------------------------------------------------------------------------------------- */

/* The height above a corner's plane, whose slope is one of sixteen. */
static float slope_at(const int32_t cell[3], const float rest[3], int corner)
{
	int dx = corner & 1, dy = corner >> 1 & 1, dz = corner >> 2;
	uint32_t h =
		jenkins_of_three((uint32_t)(cell[0] + dx), (uint32_t)(cell[1] + dy), (uint32_t)(cell[2] + dz)) & 15;
	float x = rest[0] - (float)dx, y = rest[1] - (float)dy, z = rest[2] - (float)dz;
	float u = h < 8 ? x : y, v = h < 4 ? y : h == 12 || h == 14 ? x : z;
	return (h & 1 ? -u : u) + (h & 2 ? -v : v);
}

/* Perlin's noise, -1..1. */
static float noise_at(const float p[3])
{
	int32_t cell[3];
	float rest[3], fade[3], value[8];
	for (int c = 0; c < 3; c++) {
		cell[c] = whole(p[c]);
		float t = rest[c] = clamp01(p[c] - (float)cell[c]);
		fade[c] = t * t * t * (t * (t * 6 - 15) + 10);
	}
	for (int k = 0; k < 8; k++)
		value[k] = slope_at(cell, rest, k);
	for (int c = 0, n = 4; c < 3; c++, n /= 2)
		for (int k = 0; k < n; k++)
			value[k] = mix(value[2 * k], value[2 * k + 1], fade[c]);
	return 0.9820f * value[0];
}

RUN(noise)
{
	const float *p = b->materials->constants + o->data[0];
	int octaves = (int)min(max(p[0], 0), 15);
	for (int i = 0; i < b->n; i++) {
		float sum = 0, most = 0, share = 1, scale = 1, rough = clamp01(in[3][i]);
		for (int k = 0; k <= octaves; k++, scale *= 2, share *= rough) {
			float at[3] = {scale * in[0][i], scale * in[1][i], scale * in[2][i]};
			sum += share * noise_at(at);
			most += share;
		}
		float even = sum / most;
		if (p[1] > 0) {
			float at[3] = {scale * in[0][i], scale * in[1][i], scale * in[2][i]};
			even = mix(even, (sum + share * noise_at(at)) / (most + share), p[1]);
		}
		out[0][i] = 0.5f * even + 0.5f;
	}
}
