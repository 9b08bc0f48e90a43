/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Pictures on surfaces: between texels and between levels of detail. Where a pixel covers a long strip of texels, as on
 * a floor that is seen at a slant, several places along the strip are averaged: one level for its length would blur
 * what its width shows sharp. */
#include "base/pixel.h"
#include "material/material.h"

#include <math.h>

enum { MOST_PROBES = 8 };

static int along(int i, int n, int wrap)
{
	return wrap == ENCRE_REPEAT ? wrap_index(i, n) : clamp_index(i, n);
}

/* Between the four texels around a place. */
typedef struct between {
	size_t number[4];
	float share[4];
} between;

static void add_floats(const encre_picture *t, const between *w, float share, float sum[4])
{
	for (int k = 0; k < 4; k++)
		for (int c = 0; c < 4; c++)
			sum[c] += share * w->share[k] * t->texels[4 * w->number[k] + (size_t)c];
}

/* Codes are mixed, and their mean made light, as renderers do. */
static void add_bytes(const encre_picture *t, const between *w, float share, float sum[4])
{
	float code[3] = {0}, alpha = 0, whole = 0;
	for (int k = 0; k < 4; k++) {
		const uint8_t *texel = t->bytes + 4 * w->number[k];
		float its = w->share[k] * (float)texel[3], part = t->straight ? its : w->share[k];
		for (int c = 0; c < 3; c++)
			code[c] += part * (float)texel[c];
		alpha += its;
		whole += part;
	}
	alpha *= 1 / 255.0f;
	for (int c = 0; c < 3 && whole > 0; c++) {
		float mean = min(code[c] / whole, 255);
		int k = mean < 254 ? (int)mean : 254;
		sum[c] += share * (t->straight ? alpha : 1) * mix(t->curve[k], t->curve[k + 1], mean - (float)k);
	}
	sum[3] += share * alpha;
}

/* Adds `share` of the colour at u, v of one level, whose texels are width x height behind `first` others. */
static void add_level(const encre_picture *t, size_t first, int width, int height, float u, float v, float share,
		      float sum[4])
{
	float x = u * (float)width - 0.5f, y = v * (float)height - 0.5f;
	float left = floorf(x), low = floorf(y), right = x - left, up = y - low;
	int columns[2], rows[2];
	between w;
	for (int k = 0; k < 2; k++) {
		columns[k] = along((int)left + k, width, t->wrap);
		rows[k] = along((int)low + k, height, t->wrap);
	}
	for (int k = 0; k < 4; k++) {
		w.number[k] = first + (size_t)rows[k >> 1] * (size_t)width + (size_t)columns[k & 1];
		w.share[k] = (k & 1 ? right : 1 - right) * (k & 2 ? up : 1 - up);
	}
	(t->texels ? add_floats : add_bytes)(t, &w, share, sum);
}

static void add_probe(const encre_picture *t, float level, float u, float v, float share, float sum[4])
{
	if (t->wrap == ENCRE_CLIP && !(u >= 0 && u <= 1 && v >= 0 && v <= 1))
		return;
	if (t->wrap == ENCRE_REPEAT) {
		u -= floorf(u);
		v -= floorf(v);
	}
	u = clamp01(u);
	v = clamp01(v);
	int whole = (int)level;
	float rest = level - (float)whole;
	size_t first = 0;
	int width = t->width, height = t->height;
	for (int k = 0; k <= whole + 1 && k < t->levels; k++) {
		float part = k == whole ? 1 - rest : k == whole + 1 ? rest : 0;
		if (k == t->levels - 1 && k <= whole)
			part = 1;
		if (part > 0)
			add_level(t, first, width, height, u, v, share * part, sum);
		first += (size_t)width * (size_t)height;
		width = width > 1 ? width / 2 : 1;
		height = height > 1 ? height / 2 : 1;
	}
}

/* About log2(x) for x >= 1: exact at powers of two, straight between them. */
static float level_of(float x)
{
	int32_t bits = float_bits(x);
	return (float)((bits >> 23) - 127) + (bits_float((bits & 0x7fffff) | 0x3f800000) - 1);
}

void ISA(run_texture)(const block *b, const encre_operation *o, const float *const in[], float *const out[])
{
	const encre_picture *t = b->materials->textures + o->data[0];
	for (int i = 0; i < b->n; i++) {
		float u = in[0][i], v = in[1][i], step[2][2], length[2], sum[4] = {0};
		for (int k = 0; k < 2; k++) {
			step[k][0] = in[2 + 2 * k][i];
			step[k][1] = in[3 + 2 * k][i];
			float x = step[k][0] * (float)t->width, y = step[k][1] * (float)t->height;
			length[k] = min(sqrtf(x * x + y * y), 1e9f);
		}
		int major = length[1] > length[0];
		float longer = max(length[major], 0), shorter = max(length[!major], 1);
		int n = longer > shorter ? (int)min(ceilf(longer / shorter), MOST_PROBES) : 1;
		float level = level_of(max(max(shorter, longer / (float)n), 1));
		for (int k = 0; k < n; k++) {
			float at = ((float)k + 0.5f) / (float)n - 0.5f;
			add_probe(t, level, u + at * step[major][0], v + at * step[major][1], 1 / (float)n, sum);
		}
		for (int c = 0; c < 4; c++)
			out[c][i] = sum[c];
	}
}
