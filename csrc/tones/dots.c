/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Dots at the whole numbers of two fields, as many to the unit along each as keep them a pitch or up to two apart on
 * the screen; those half-way between along one or both have grown to their share (ruled.c tells why). A level for each
 * axis keeps them round, of one size and evenly spread on slanted ground up to the horizon. How large they must be for
 * the ink that is asked for, overlaps and soft edges and all, is found by trying. */
#include "tones/tones.h"

enum { RADII = 40, SAMPLES = 12 };

/* Ink of a disc of radius r whose edge fades over `soft`, at a distance: small ones must not be too dark, for a disc
 * smaller than a pixel has an edge on all sides of it, so that r' = sqrt(r^2 - 1/12) is drawn, or cbrt(3 r^2) - 1/2. */
static inline float true_radius(float r)
{
	float square = r * r, large = sqrtf(max(square - 1.0f / 12, 0)), small = pixel_cbrt(3 * square + 1e-30f) - 0.5f;
	return r > 0.57735f ? large : small;
}

static inline float disc(float radius, float distance, float soft, float share)
{
	return clamp01((true_radius(radius * share) * soft - distance) * share + 0.5f);
}

/* Mean ink over a cell: dots are grown to squares of h along the axes, and old ones 1 + h^2 pitches apart. */
static float mean_ink(float pitch, float soft, float h0, float h1, float radius)
{
	float sum = 0, share = 1 / soft, size[2] = {pitch * (1 + h0 * h0), pitch * (1 + h1 * h1)};
	for (int j = 0; j < SAMPLES; j++)
		for (int i = 0; i < SAMPLES; i++) {
			float turn = 0.618034f * (float)j, x = ((float)i + turn - floorf(turn)) / (2 * SAMPLES);
			float y = ((float)j + 0.5f) / (2 * SAMPLES), most = 0;
			for (int k = 0; k < 4; k++) {
				float dx = (x - 0.5f * (float)(k & 1)) * size[0],
				      dy = (y - 0.5f * (float)(k >> 1)) * size[1];
				float grown = (k & 1 ? h0 : 1) * (k >> 1 ? h1 : 1);
				most = max(most, disc(radius * grown, sqrtf(dx * dx + dy * dy), soft, share));
			}
			sum += most;
		}
	return sum / (SAMPLES * SAMPLES);
}

float ISA(tone_true_radius)(float r)
{
	return true_radius(r);
}

/* The darkness whose even steps a table has: fine at both ends, where ink grows as the square of a radius, and its gaps
 * as that of what they lack. */
static inline float even(float dark)
{
	float low = sqrtf(0.5f * dark), high = 1 - sqrtf(0.5f * max(1 - dark, 0));
	return dark < 0.5f ? low : high;
}

static void fill_radii(tone_screen *s, int b0, int b1)
{
	float h0 = (float)b0 / (TONE_BIRTHS - 1), h1 = (float)b1 / (TONE_BIRTHS - 1);
	float ink[RADII + 1], most = 1.1f * s->pitch + s->soft;
	ink[0] = 0;
	for (int k = 1; k <= RADII; k++)
		ink[k] = ink[k - 1] < 1 ? mean_ink(s->pitch, s->soft, h0, h1, most * (float)k / RADII) : 1;
	for (int t = 0, k = 1; t < TONE_STEPS; t++) {
		float step = (float)t / (TONE_STEPS - 1);
		while (k < RADII && even(ink[k]) < step)
			k++;
		float before = even(ink[k - 1]), after = even(ink[k]);
		float share = after > before ? (step - before) / (after - before) : 1;
		float radius = most * ((float)(k - 1) + clamp01(share)) / RADII;
		s->radius[b0][b1][t] = s->radius[b1][b0][t] = radius;
	}
}

tone_screen *ISA(tone_screen_fill)(tone_screen *s, float pitch, float hardness, bool crisp, bool dots)
{
	s->pitch = pitch > 2 ? pitch : 2;
	s->soft = crisp ? 0.002f : 1 + (1 - hardness) * 0.5f * s->pitch;
	for (int b0 = 0; b0 < TONE_BIRTHS && dots; b0++)
		for (int b1 = 0; b1 <= b0; b1++)
			fill_radii(s, b0, b1);
	return s;
}

static inline float table_at(const float *steps, float t)
{
	int k = (int)t;
	k = k < TONE_STEPS - 2 ? k : TONE_STEPS - 2;
	return mix(steps[k], steps[k + 1], t - (float)k);
}

static float radius_at(const tone_screen *s, float h0, float h1, float dark)
{
	float a = h0 * (TONE_BIRTHS - 1), b = h1 * (TONE_BIRTHS - 1), t = even(dark) * (TONE_STEPS - 1);
	int i = (int)a, j = (int)b;
	i = i < TONE_BIRTHS - 2 ? i : TONE_BIRTHS - 2;
	j = j < TONE_BIRTHS - 2 ? j : TONE_BIRTHS - 2;
	a -= (float)i;
	b -= (float)j;
	float low = mix(table_at(s->radius[i][j], t), table_at(s->radius[i][j + 1], t), b);
	float high = mix(table_at(s->radius[i + 1][j], t), table_at(s->radius[i + 1][j + 1], t), b);
	return mix(low, high, a);
}

void ISA(tone_lattice_fill)(float pitch, int n, const tone_field field[2], tone_lattice *l)
{
	const float *a = field[0].right, *b = field[0].down, *c = field[1].right, *d = field[1].down;
	float per = 1 / pitch;
	for (int i = 0; i < n; i++) {
		float cross = a[i] * d[i] - b[i] * c[i], area = fabsf(cross);
		float sides = (a[i] * a[i] + b[i] * b[i]) * (c[i] * c[i] + d[i] * d[i]);
		l->flat[i] = area * area > 1e-6f * sides ? 0 : 1; /* also of NaN */
		float over = 1 / (l->flat[i] > 0 ? 1 : cross);
		float x0 = d[i] * over, y0 = -c[i] * over, x1 = -b[i] * over, y1 = a[i] * over;
		float along0 = sqrtf(x0 * x0 + y0 * y0), along1 = sqrtf(x1 * x1 + y1 * y1);
		float sine = fabsf(over) / max(along0 * along1, 1e-30f);
		float shear = sqrtf(sine > 0.05f ? min(sine, 1) : 0.05f), grown0, grown1;
		float m0 = octave(along0 * shear * per, &grown0), m1 = octave(along1 * shear * per, &grown1);
		l->at[0][i] = field[0].at[i] * m0;
		l->at[1][i] = field[1].at[i] * m1;
		l->across[0][i] = x0 / m0;
		l->up[0][i] = y0 / m0;
		l->across[1][i] = x1 / m1;
		l->up[1][i] = y1 / m1;
		l->grown[0][i] = grown0 - 1;
		l->grown[1][i] = grown1 - 1;
		l->scale[0][i] = m0;
		l->scale[1][i] = m1;
	}
}

/* The squared distance of the nearest of the four dots about a pixel that are off by these parts of a step. */
static inline float nearest(const tone_lattice *l, int i, float off0, float off1)
{
	float f0 = l->at[0][i] - off0, f1 = l->at[1][i] - off1, best = 1e30f;
	f0 -= floorf(f0);
	f1 -= floorf(f1);
	for (int k = 0; k < 4; k++) {
		float e0 = (k & 1 ? 1.0f : 0.0f) - f0, e1 = (k & 2 ? 1.0f : 0.0f) - f1;
		float x = e0 * l->across[0][i] + e1 * l->across[1][i], y = e0 * l->up[0][i] + e1 * l->up[1][i];
		best = min(best, x * x + y * y);
	}
	return best;
}

void ISA(tone_dots)(const tone_screen *s, int n, const tone_field field[2], const float *restrict dark,
		    float *restrict ink)
{
	tone_lattice l;
	float root[2][TONE_CHUNK], radius[TONE_CHUNK], soft = s->soft, share = 1 / soft;
	ISA(tone_lattice_fill)(s->pitch, n, field, &l);
	for (int k = 0; k < 2; k++)
		for (int i = 0; i < n; i++)
			root[k][i] = sqrtf(l.grown[k][i]);
	for (int i = 0; i < n; i++)
		radius[i] = radius_at(s, root[0][i], root[1][i], dark[i]);
	for (int i = 0; i < n; i++) {
		float h0 = root[0][i], h1 = root[1][i], r = radius[i];
		float most = disc(r, sqrtf(nearest(&l, i, 0, 0)), soft, share);
		most = max(most, disc(r * h0, sqrtf(nearest(&l, i, 0.5f, 0)), soft, share));
		most = max(most, disc(r * h1, sqrtf(nearest(&l, i, 0, 0.5f)), soft, share));
		most = max(most, disc(r * h0 * h1, sqrtf(nearest(&l, i, 0.5f, 0.5f)), soft, share));
		ink[i] = l.flat[i] > 0 ? dark[i] : most;
	}
}
