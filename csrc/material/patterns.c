/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Patterns by formula, the same as Blender's. */
#include "base/pixel.h"
#include "material/hash.h"
#include "material/material.h"

#include <math.h>

#define RUN(name)                                                                                                      \
	void ISA(run_##name)(const block *b, const encre_operation *o, const float *const in[], float *const out[])
#define REACH(name)                                                                                                    \
	void ISA(reach_##name)(const block *b, const encre_operation *o, const float *const in[],                      \
			       const float *const by[], float *const out[])

/* A whole number; far from 0 they are all alike. */
static inline int32_t whole(float x)
{
	return (int32_t)min(max(floorf(x), -1e9f), 1e9f);
}

/* The field of a checker along an axis: places on a boundary are inside, whatever rounding does. */
static inline int32_t field_at(float x)
{
	return whole((x + 0.000001f) * 0.999999f);
}

RUN(checker)
{
	(void)b, (void)o;
	for (int i = 0; i < MATERIAL_BLOCK; i++) {
		int32_t odd = field_at(in[0][i]) ^ field_at(in[1][i]) ^ field_at(in[2][i]);
		out[0][i] = odd & 1 ? 1 : 0;
	}
}

REACH(checker)
{
	(void)b, (void)o;
	for (int i = 0; i < MATERIAL_BLOCK; i++) {
		int32_t apart = 0;
		for (int c = 0; c < 3; c++)
			apart |= field_at(in[c][i] - by[c][i]) ^ field_at(in[c][i] + by[c][i]);
		out[0][i] = apart ? INFINITY : 0;
	}
}

/* ---- bricks ------------------------------------------------------------------------------------------------ */

/* By chance, 0..1. */
static float chance_of(uint32_t n)
{
	n = (n + 1013) & 0x7fffffff;
	n = (n >> 13) ^ n;
	n = (n * (n * n * 60493 + 19990303) + 1376312589) & 0x7fffffff;
	return 0.5f * ((float)(int32_t)n / 1073741824.0f);
}

typedef struct wall {
	float offset, squash, mortar, smooth, bias, width, height;
	int32_t offset_every, squash_every; /* rows; 0: none */
} wall;

static wall wall_of(const block *b, const encre_operation *o)
{
	const float *p = b->materials->constants + o->data[0];
	bool uneven = p[1] >= 1 && p[3] >= 1;
	return (wall){p[0], p[2], p[4], p[5], p[6], p[7], p[8], uneven ? whole(p[1]) : 0, uneven ? whole(p[3]) : 0};
}

/* Whether a row is one of every n: doubles tell it as well as integers, and in vectors. */
static inline bool every(int32_t row, int32_t n)
{
	double turn = (double)row / (double)n;
	return n > 0 && turn == floor(turn);
}

/* How wide the bricks of a row are, and how far left of 0 one of them begins. */
static inline float width_in(const wall *w, int32_t row)
{
	return w->width * (every(row, w->squash_every) ? w->squash : 1);
}

static inline float shift_in(const wall *w, int32_t row, float width)
{
	return every(row, w->offset_every) ? width * w->offset : 0;
}

RUN(brick)
{
	const wall w = wall_of(b, o);
	const float *restrict u = in[0], *restrict v = in[1];
	float *restrict tint = out[0], *restrict joint = out[1];
	const float slope = w.smooth > 0 ? w.mortar * w.smooth : 0;
	for (int i = 0; i < MATERIAL_BLOCK; i++) {
		int32_t row = whole(v[i] / w.height);
		float width = width_in(&w, row), shift = shift_in(&w, row, width);
		int32_t number = whole((u[i] + shift) / width);
		float x = u[i] + shift - width * (float)number, y = v[i] - w.height * (float)row;
		float inside = min(min(x, y), min(width - x, w.height - y));
		tint[i] = clamp01(chance_of(((uint32_t)row << 16) + ((uint32_t)number & 0xffff)) + w.bias);
		float t = clamp01((w.mortar - inside) / slope); /* 1 of a slope of 0 */
		joint[i] = inside >= w.mortar ? 0 : t * t * (3 - 2 * t);
	}
}

/* Nothing jumps within one brick, where all is joint or nothing is. Smooth joints don't jump, but may as well. */
REACH(brick)
{
	const wall w = wall_of(b, o);
	const float *restrict u = in[0], *restrict v = in[1], *restrict du = by[0], *restrict dv = by[1];
	for (int i = 0; i < MATERIAL_BLOCK; i++) {
		int32_t row = whole((v[i] - dv[i]) / w.height);
		float width = width_in(&w, row), shift = shift_in(&w, row, width);
		int32_t number = whole((u[i] - du[i] + shift) / width);
		bool one = row == whole((v[i] + dv[i]) / w.height) && number == whole((u[i] + du[i] + shift) / width);
		float x = u[i] + shift - width * (float)number, y = v[i] - w.height * (float)row;
		float across = min(x, width - x), up = min(y, w.height - y);
		bool brick = min(across - du[i], up - dv[i]) >= w.mortar;
		bool joint = min(across + du[i], up + dv[i]) < w.mortar - w.mortar * positive(w.smooth);
		out[0][i] = out[1][i] = (one && (brick || joint)) || du[i] + dv[i] == 0 ? 0 : INFINITY;
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
