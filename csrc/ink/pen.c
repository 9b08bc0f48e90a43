/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The hand that draws a line: pressure, wobble, roughness, gaps, dry bristles, by solid noise at the anchor of the
 * surface in front at a site. What is drawn sticks to the thing, and needs no other frame. */
#include "ink/pen.h"

#include "base/pixel.h"
#include "base/stage.h"

/* ---- noise ----------------------------------------------------------------------------------------------- */

/* One over the standard deviation of value noise: the weights are Perlin's quintic, whose squares and those of the rest
 * have a mean of 181/231 an axis. */
static const float unit_variance = 2.4972f;

static inline float hashed(int32_t x, int32_t y, int32_t z, uint32_t seed)
{
	uint32_t h = (seed + 0x2545f491u) * 0x9e3779b1u;
	h = (h ^ (uint32_t)x) * 0x85ebca6bu;
	h ^= h >> 13;
	h = (h ^ (uint32_t)y) * 0xc2b2ae35u;
	h ^= h >> 16;
	h = (h ^ (uint32_t)z) * 0x27d4eb2fu;
	h ^= h >> 15;
	h *= 0x165667b1u;
	h ^= h >> 13;
	return (float)(h >> 8) * (2.0f / 16777216) - 1;
}

static inline float quintic(float t)
{
	return t * t * t * (t * (t * 6 - 15) + 10);
}

static float lattice(const float p[3], uint32_t seed)
{
	int32_t i[3];
	float w[3];
	for (int k = 0; k < 3; k++) {
		float at = min(max(p[k], -1e9f), 1e9f), low = floorf(at);
		i[k] = (int32_t)low;
		w[k] = quintic(at - low);
	}
	float side[2][2];
	for (int z = 0; z < 2; z++)
		for (int y = 0; y < 2; y++)
			side[z][y] = mix(hashed(i[0], i[1] + y, i[2] + z, seed),
					 hashed(i[0] + 1, i[1] + y, i[2] + z, seed), w[0]);
	return mix(mix(side[0][0], side[0][1], w[1]), mix(side[1][0], side[1][1], w[1]), w[2]);
}

/* Of mean 0 and variance 1, with a wavelength of so many units of p. Two octaves are blended, the finer one entering
 * with weight 0 where its turn comes, so that nothing pops while a thing comes nearer. */
static float solid(const float p[3], float wavelength, uint32_t seed)
{
	float rate = 1 / wavelength;
	if (!(rate > 1e-30f && rate < 1e30f))
		return 0;
	int32_t bits = float_bits(rate), octave = (bits >> 23) - 127;
	float part = (float)(bits & 0x7fffff) * (1.0f / 8388608), noise[2];
	for (int k = 0; k < 2; k++) {
		/* an offset of its own, or the zeros of all octaves met in the origin */
		float scale = bits_float((octave + k + 127) << 23), aside = 17.3f * (float)(octave + k);
		const float at[3] = {p[0] * scale + aside, p[1] * scale + aside, p[2] * scale + aside};
		noise[k] = lattice(at, seed);
	}
	float turn = part * (1.3466f - 0.3466f * part) * 1.57079633f; /* log2(1 + part), to 0.01 */
	return (pixel_cos(turn) * noise[0] + pixel_sin(turn) * noise[1]) * unit_variance;
}

/* ---- the hand -------------------------------------------------------------------------------------------- */

/* Where a site is on its thing, in units of which a "px" of a length is `unit`. */
typedef struct spot {
	float p[3], unit;
} spot;

/* As near as this share of its depth, pixels beside the front-most one count as its surface. */
static const float one_surface = 0.02f;

/* The mean, by nearness, of those of the four pixels about a site that show the surface in front: so noise runs on
 * evenly where the thing moves by parts of a pixel. Where nothing tells, a place in the frame. */
static spot spot_of(const frame *f, const site *s)
{
	float x = s->placed.x, y = s->placed.y, left = floorf(x), top = floorf(y), front = INFINITY, sum = 0;
	/* in units of length, or another number of pixels would have other octaves, and so another line */
	spot at = {.p = {(x + (float)f->place.x + 0.5f) / f->scale, (y + (float)f->place.y + 0.5f) / f->scale, 0},
		   .unit = 1};
	const float *anchor[4];
	float depth[4], object[4], weight[4], number = 0;
	if (!f->layer[ENCRE_LAYER_ANCHOR].data)
		return at;
	for (int k = 0; k < 4; k++) {
		int px = clamp_index((int)left + (k & 1), f->width), py = clamp_index((int)top + (k >> 1), f->height);
		const float *objects = layer_row(f, ENCRE_LAYER_OBJECT, py);
		float fx = x - left, fy = y - top;
		anchor[k] = anchor_at(f, px, py);
		depth[k] = anchor[k][ANCHOR_PIXEL] > 0 ? depth_at(f, px, py) : INFINITY;
		object[k] = objects ? objects[px] : 0;
		weight[k] = 1e-3f + (k & 1 ? fx : 1 - fx) * (k >> 1 ? fy : 1 - fy);
		number = depth[k] < front ? object[k] : number;
		front = min(front, depth[k]);
	}
	if (!(front < INFINITY))
		return at;
	at = (spot){0};
	for (int k = 0; k < 4; k++) {
		if (!(depth[k] <= front * (1 + one_surface)) || object[k] != number)
			continue;
		for (int c = 0; c < 3; c++)
			at.p[c] += weight[k] * anchor[k][ANCHOR_POSITION + c];
		at.unit += weight[k] * anchor[k][ANCHOR_PIXEL];
		sum += weight[k];
	}
	for (int c = 0; c < 3; c++)
		at.p[c] = bounded(at.p[c] / sum);
	at.unit = min(at.unit / sum * f->scale, 1e30f);
	return at;
}

enum { SEED_PRESSURE, SEED_ACROSS, SEED_DOWN, SEED_ROUGH, SEED_GAPS, SEED_FLOW, SEED_BRISTLE, SEEDS = 16 };

static uint32_t seed_of(const encre_params *p, int stroke, int what)
{
	return ((uint32_t)p->pen_seed * STROKES + (uint32_t)stroke) * SEEDS + (uint32_t)what;
}

bool ISA(pen_draws)(const encre_params *p)
{
	return p->pen_pressure > 0 || p->pen_wobble > 0 || p->pen_rough > 0 || p->pen_gaps > 0 || p->pen_dry > 0 ||
	       p->pen_strokes > 1;
}

/* A pen gives neither up nor three times its ink. */
static const float least_pressure = 0.12f, most_pressure = 3;

float ISA(pen_pressure)(const frame *f, const encre_params *p, const site *s, int stroke)
{
	if (!(p->pen_pressure > 0))
		return 1;
	spot at = spot_of(f, s);
	float noise = solid(at.p, at.unit * p->pen_pressure_length, seed_of(p, stroke, SEED_PRESSURE));
	return min(max(1 + p->pen_pressure * noise, least_pressure), most_pressure);
}

/* What is as small as a pixel would only be noise. */
static float resolved(const frame *f, float length)
{
	return clamp01(length * f->scale - 1);
}

/* Noise of unit variance that is above this for a share of 1 - gaps of its way, about. */
static float least_of(float gaps)
{
	float x = 2 * gaps - 1;
	return x * (1.15f + 0.75f * x * x * x * x);
}

static uint8_t bristle(const encre_params *p, const spot *at, int stroke, int k, float flow)
{
	float streak = 0.6f * solid(at->p, at->unit * p->pen_dry_length, seed_of(p, stroke, SEED_BRISTLE + k));
	return (uint8_t)(255 * clamp01(2.5f * (streak + 1.15f - p->pen_dry * flow)) + 0.5f);
}

touch ISA(pen_touch)(const frame *f, const encre_params *p, const site *s, int stroke)
{
	spot at = spot_of(f, s);
	touch t = {.left = 1};
	if (p->pen_rough > 0) {
		t.rough = solid(at.p, at.unit * p->pen_rough_length, seed_of(p, stroke, SEED_ROUGH));
		t.fray = p->pen_rough * f->scale * resolved(f, p->pen_rough_length);
	}
	if (p->pen_gaps > 0) {
		float noise = solid(at.p, at.unit * p->pen_gaps_length, seed_of(p, stroke, SEED_GAPS));
		t.left = p->pen_gaps < 1 ? clamp01(4 * (noise - least_of(p->pen_gaps)) + 0.5f) : 0;
	}
	if (p->pen_wobble > 0) {
		float far = p->pen_wobble * f->scale, length = at.unit * p->pen_wobble_length;
		t.dx = far * solid(at.p, length, seed_of(p, stroke, SEED_ACROSS));
		t.dy = far * solid(at.p, length, seed_of(p, stroke, SEED_DOWN));
	}
	if (p->pen_dry > 0) {
		float flow = 1 + 0.6f * solid(at.p, at.unit * 6 * p->pen_dry_length, seed_of(p, stroke, SEED_FLOW));
		for (int k = 0; k < p->pen_bristles; k++)
			t.ink[k] = bristle(p, &at, stroke, k, flow);
	}
	return t;
}
