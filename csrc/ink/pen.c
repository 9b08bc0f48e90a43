/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The hand that draws a line: pressure, wobble, roughness, gaps, dry bristles, by solid noise where its sites are on
 * their things. */
#include "ink/pen.h"

#include "base/pixel.h"
#include "base/stage.h"

enum {
	SEED_PRESSURE,
	SEED_ACROSS,
	SEED_DOWN,
	SEED_ROUGH,
	SEED_GAPS,
	SEED_FLOW,
	SEED_BRISTLE,
	SEED_FARTHER = SEED_BRISTLE + BRISTLES,
	SEEDS = 16
};

/* Of the streaks that bristles leave, about, in units of length. */
static const float streak_length = 33;

bool ISA(pen_varies)(const hand *h)
{
	return h->pen_pressure > 0 || h->pen_wobble > 0 || h->pen_rough > 0 || h->pen_gaps > 0 || h->pen_dry > 0 ||
	       h->pen_dash > 0 || h->pen_strip > 0 || h->pen_overshoot > 0;
}

/* What one use of the hand's noise reads of its parameters: how strong it is and how long its waves are. */
#define USE(name, strong, long)                                                                                        \
	static float name##_of(const hand *h)                                                                          \
	{                                                                                                              \
		return h->strong > 0 ? h->long : 0;                                                                    \
	}
USE(pressure, pen_pressure, pen_pressure_length)
USE(wobble, pen_wobble, pen_wobble_length)
USE(rough, pen_rough, pen_rough_length)
USE(gaps, pen_gaps, pen_gaps_length)
USE(overshoot, pen_overshoot, pen_overshoot)
#undef USE

static float dry_of(const hand *h)
{
	return h->pen_dry > 0 ? streak_length : 0;
}

/* Noise of one seed and, as far as it boils, of the seed of now, of variance 1 together. */
static void boil_row(const strokes *s, int n, const float *length, uint32_t *seed, float *noise)
{
	float anew[SPAN];
	for (int i = 0; i < n; i++)
		seed[i] ^= s->again[i];
	ISA(solid_row)(&s->at, n, length, seed, anew);
	for (int i = 0; i < n; i++) {
		float turn = 1.57079633f * s->hand[i]->pen_boil;
		if (s->again[i])
			noise[i] = pixel_cos(turn) * noise[i] + pixel_sin(turn) * anew[i];
	}
}

/* Noise at n <= SPAN sites, of waves times `times`; false where no hand asks for it. */
static bool noise_row(const strokes *s, int n, float (*length_of)(const hand *), float times, int what, float *noise)
{
	float length[SPAN];
	uint32_t seed[SPAN];
	bool asked = false, boils = false;
	for (int i = 0; i < n; i++) {
		length[i] = times * length_of(s->hand[i]);
		seed[i] = ((uint32_t)s->hand[i]->pen_seed * STROKES + (uint32_t)s->stroke) * SEEDS + (uint32_t)what;
		asked |= length[i] > 0;
		boils |= length[i] > 0 && s->again[i] && s->hand[i]->pen_boil > 0;
	}
	if (asked)
		ISA(solid_row)(&s->at, n, length, seed, noise);
	if (boils)
		boil_row(s, n, length, seed, noise);
	return asked;
}

/* A pen gives neither up nor three times its ink. */
static const float least_pressure = 0.12f, most_pressure = 3;

void ISA(pen_pressures)(const strokes *s, int n, float *factor)
{
	float noise[SPAN];
	bool asked = noise_row(s, n, pressure_of, 1, SEED_PRESSURE, noise);
	for (int i = 0; i < n; i++)
		factor[i] = asked && s->hand[i]->pen_pressure > 0
				    ? min(max(1 + s->hand[i]->pen_pressure * noise[i], least_pressure), most_pressure)
				    : 1;
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

static void dry_row(const strokes *s, int n, touch *t)
{
	float flow[SPAN], streak[SPAN];
	if (!noise_row(s, n, dry_of, 6, SEED_FLOW, flow))
		return;
	for (int k = 0; k < STREAKS; k++) {
		noise_row(s, n, dry_of, 1, SEED_BRISTLE + k, streak);
		for (int i = 0; i < n; i++) {
			float dry = s->hand[i]->pen_dry * (1 + 0.6f * flow[i]);
			if (s->hand[i]->pen_dry > 0)
				t[i].ink[k] = (uint8_t)(255 * clamp01(2.5f * (0.6f * streak[i] + 1.15f - dry)) + 0.5f);
		}
	}
}

void ISA(pen_touches)(const frame *f, const strokes *s, int n, touch *t)
{
	float noise[SPAN], down[SPAN];
	for (int i = 0; i < n; i++)
		t[i] = (touch){.left = 1};
	if (noise_row(s, n, rough_of, 1, SEED_ROUGH, noise))
		for (int i = 0; i < n; i++) {
			t[i].rough = noise[i];
			t[i].fray = s->hand[i]->pen_rough * f->scale * resolved(f, s->hand[i]->pen_rough_length);
		}
	if (noise_row(s, n, gaps_of, 1, SEED_GAPS, noise))
		for (int i = 0; i < n; i++) {
			float gaps = s->hand[i]->pen_gaps;
			if (gaps > 0)
				t[i].left = gaps < 1 ? clamp01(4 * (noise[i] - least_of(gaps)) + 0.5f) : 0;
		}
	if (noise_row(s, n, wobble_of, 1, SEED_ACROSS, noise) && noise_row(s, n, wobble_of, 1, SEED_DOWN, down))
		for (int i = 0; i < n; i++) {
			float far = s->hand[i]->pen_wobble * f->scale;
			t[i].dx = far * noise[i];
			t[i].dy = far * down[i];
		}
	if (noise_row(s, n, overshoot_of, 1, SEED_FARTHER, noise))
		for (int i = 0; i < n; i++)
			t[i].farther = max(0, 1 + 0.5f * noise[i]);
	dry_row(s, n, t);
}
