/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Dots at the whole numbers of two fields, as many to the unit along each as keep them a pitch or up to two apart on
 * the screen; those half-way between along one or both have grown to their share (ruled.c tells why). A level for each
 * axis keeps them round, of one size and evenly spread on slanted ground up to the horizon. How large they must be for
 * the ink that is asked for, overlaps and soft edges and all, is found by trying. */
#include "tones/tones.h"

#include <string.h>

enum { RADII = 40, SAMPLES = 12 };

/* Ink of a disc of radius r whose edge fades over `soft`, at a distance: small ones must not be too dark, for a disc
 * smaller than a pixel has an edge on all sides of it, so that r' = sqrt(r^2 - 1/12) is drawn, or cbrt(3 r^2) - 1/2. */
static const float small_radius = 0.57735f;

static inline float true_radius_of_large(float r)
{
	return sqrtf(max(r * r - 1.0f / 12, 0));
}

static inline float true_radius(float r)
{
	float large = true_radius_of_large(r), small = pixel_cbrt(3 * (r * r) + 1e-30f) - 0.5f;
	return r > small_radius ? large : small;
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
	float ink[RADII + 1], soft = s->soft + s->more_soft * s->pitch, most = 1.1f * s->pitch + soft;
	ink[0] = 0;
	for (int k = 1; k <= RADII; k++)
		ink[k] = ink[k - 1] < 1 ? mean_ink(s->pitch, soft, h0, h1, most * (float)k / RADII) : 1;
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

enum { TRIED = 9 /* pixels of pitch */ };

void ISA(tone_screen_fill)(tone_screen *s, const tone_slot *slot, float hardness)
{
	bool own = slot->space == tone_1_space_OBJECT;
	float fade = slot->crisp ? 0 : (1 - hardness) * 0.5f;
	s->pitch = own ? TRIED : max(slot->pitch, 2);
	s->least = own ? 5 : s->pitch;
	s->most = own ? 1e6f : s->pitch;
	s->soft = slot->crisp ? 0.002f : 1;
	s->more_soft = fade;
	for (int b0 = 0; b0 < TONE_BIRTHS && slot->kind == tone_1_DOTS; b0++)
		for (int b1 = 0; b1 <= b0; b1++)
			fill_radii(s, b0, b1);
}

/* Where a value of n steps lies between two of them. */
static inline int32_t step_at(float at, int n, float *rest)
{
	int32_t i = (int32_t)at;
	i = i < n - 2 ? i : n - 2;
	*rest = at - (float)i;
	return i;
}

/* A table's values don't come in vectors: what is asked of it is told before, and what it says is mixed behind. */
static void radii_at(const tone_screen *s, int n, const float *restrict h0, const float *restrict h1,
		     const float *restrict dark, float *restrict radius)
{
	enum { ROW = TONE_STEPS, PLANE = TONE_BIRTHS * ROW };
	const float *table = s->radius[0][0];
	int32_t at[TONE_CHUNK];
	float a[TONE_CHUNK], b[TONE_CHUNK], t[TONE_CHUNK], low[4][TONE_CHUNK], high[4][TONE_CHUNK];
	for (int i = 0; i < n; i++)
		at[i] = step_at(h0[i] * (TONE_BIRTHS - 1), TONE_BIRTHS, a + i) * PLANE +
			step_at(h1[i] * (TONE_BIRTHS - 1), TONE_BIRTHS, b + i) * ROW +
			step_at(even(dark[i]) * (TONE_STEPS - 1), TONE_STEPS, t + i);
	for (int i = 0; i < n; i++)
		for (int k = 0; k < 4; k++) {
			const float *from = table + at[i] + (k >> 1) * PLANE + (k & 1) * ROW;
			low[k][i] = from[0];
			high[k][i] = from[1];
		}
	for (int i = 0; i < n; i++) {
		float one = mix(mix(low[0][i], high[0][i], t[i]), mix(low[1][i], high[1][i], t[i]), b[i]);
		float other = mix(mix(low[2][i], high[2][i], t[i]), mix(low[3][i], high[3][i], t[i]), b[i]);
		radius[i] = mix(one, other, a[i]);
	}
}

void ISA(tone_lattice_fill)(float least, float most, int n, const tone_field field[2], tone_lattice *l)
{
	const float *a = field[0].right, *b = field[0].down, *c = field[1].right, *d = field[1].down;
	for (int i = 0; i < n; i++) {
		float cross = a[i] * d[i] - b[i] * c[i], area = fabsf(cross);
		float sides = (a[i] * a[i] + b[i] * b[i]) * (c[i] * c[i] + d[i] * d[i]);
		l->flat[i] = area * area > 1e-6f * sides ? 0 : 1; /* also of NaN */
		float over = 1 / (l->flat[i] > 0 ? 1 : cross);
		float x0 = d[i] * over, y0 = -c[i] * over, x1 = -b[i] * over, y1 = a[i] * over;
		float along0 = sqrtf(x0 * x0 + y0 * y0), along1 = sqrtf(x1 * x1 + y1 * y1);
		float sine = fabsf(over) / max(along0 * along1, 1e-30f);
		float shear = sqrtf(sine > 0.05f ? min(sine, 1) : 0.05f), grown0, grown1;
		along0 *= shear;
		along1 *= shear;
		float pitch0 = min(max(along0, least), most), pitch1 = min(max(along1, least), most);
		float m0 = octave(along0 / pitch0, &grown0), m1 = octave(along1 / pitch1, &grown1);
		l->pitch[0][i] = pitch0;
		l->pitch[1][i] = pitch1;
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

/* Squared distances on the screen by steps along both axes. */
typedef struct metric {
	float first, both, second;
} metric;

/* As it is; and, as dots begin to overlap, as if rows met at right angles and dots had the same area: only so they
 * overlap by as much as was tried. The holes between dark ones, all that is seen of them, lie as slanted as the rows.
 */
static inline metric metric_at(const tone_lattice *l, int i, float pitch, float dark)
{
	float x0 = l->across[0][i], y0 = l->up[0][i], x1 = l->across[1][i], y1 = l->up[1][i];
	float size0 = pitch * (1 + l->grown[0][i]), size1 = pitch * (1 + l->grown[1][i]),
	      square = clamp01(5 * dark - 2);
	float first = mix(x0 * x0 + y0 * y0, size0 * size0, square),
	      second = mix(x1 * x1 + y1 * y1, size1 * size1, square), both = (x0 * x1 + y0 * y1) * (1 - square);
	float area = size0 * size1, even = area / sqrtf(max(first * second - both * both, 1e-3f * area * area));
	even = square > 0 ? even : 1;
	return (metric){first * even, 2 * both * even, second * even};
}

/* The squared distance of the nearest of the four dots about a pixel that are off by these parts of a step. */
static inline float nearest(const tone_lattice *l, const metric *m, int i, float off0, float off1)
{
	float f0 = l->at[0][i] - off0, f1 = l->at[1][i] - off1, best = 1e30f;
	f0 -= floorf(f0);
	f1 -= floorf(f1);
	for (int k = 0; k < 4; k++) {
		float e0 = (k & 1 ? 1.0f : 0.0f) - f0, e1 = (k & 2 ? 1.0f : 0.0f) - f1;
		best = min(best, e0 * e0 * m->first + e0 * e1 * m->both + e1 * e1 * m->second);
	}
	return max(best, 0);
}

/* Of the dots of one birth the radius and a pixel's distance, by the width of their edge. */
typedef struct births {
	float radius[4][TONE_CHUNK], distance[4][TONE_CHUNK];
} births;

enum { BLOCK = 32 };

KERNEL void cover(const bool small, float soft, float share, int n, const float *restrict radius,
		  const float *restrict distance, float *restrict ink)
{
	for (int i = 0; i < n; i++) {
		float r = small ? true_radius(radius[i]) : true_radius_of_large(radius[i]);
		ink[i] = max(ink[i], clamp01((r * soft - distance[i]) * share + 0.5f));
	}
}

/* Small dots take longest, and are seldom among those of a block. */
static void cover_row(float soft, float share, int n, const births *b, const float *restrict flat,
		      const float *restrict dark, float *restrict ink)
{
	memset(ink, 0, (size_t)n * sizeof *ink);
	for (int k = 0; k < 4; k++)
		for (int x = 0; x < n; x += BLOCK) {
			const float *radius = b->radius[k] + x, *distance = b->distance[k] + x;
			int end = n - x < BLOCK ? n - x : BLOCK, any = 0;
			for (int i = 0; i < end; i++)
				any |= !(radius[i] > small_radius);
			if (any)
				cover(true, soft, share, end, radius, distance, ink + x);
			else
				cover(false, soft, share, end, radius, distance, ink + x);
		}
	for (int i = 0; i < n; i++)
		ink[i] = flat[i] > 0 ? dark[i] : ink[i];
}

/* How the place in pixels of the pitch that radii were tried for grows per pixel of the screen: along both axes to the
 * right and down. */
typedef struct slant {
	float right0, down0, right1, down1, area;
} slant;

/* Dots that lie on the thing as if painted on, so they are ellipses where it is seen at a slant. x, y: how far a pixel
 * is from one in pixels of the pitch that radii were tried for. */
static inline void painted_dot(float radius, float soft, float x, float y, const slant *g, float *to, float *away)
{
	float d = sqrtf(x * x + y * y), per = 1 / max(d, 1e-6f);
	float right = (x * g->right0 + y * g->right1) * per, down = (x * g->down0 + y * g->down1) * per;
	float slope = sqrtf(right * right + down * down);
	slope = d > 1e-6f ? slope : 0;
	float share = 1 / (soft * max(slope, 0.25f * g->area));
	*to = radius * share;
	*away = d * share;
}

static inline float from_whole(float at)
{
	return at - floorf(at + 0.5f);
}

static void painted(const tone_screen *s, int n, const tone_field field[2], const tone_lattice *l,
		    float (*restrict root)[TONE_CHUNK], const float *restrict radius, births *restrict b)
{
	for (int i = 0; i < n; i++) {
		float soft = s->soft + s->more_soft * sqrtf(l->pitch[0][i] * l->pitch[1][i]);
		/* from one to the next there are grown + 1 pitches */
		float size0 = s->pitch * (1 + l->grown[0][i]), size1 = s->pitch * (1 + l->grown[1][i]);
		float grows0 = size0 * l->scale[0][i], grows1 = size1 * l->scale[1][i];
		slant g = {.right0 = grows0 * field[0].right[i],
			   .down0 = grows0 * field[0].down[i],
			   .right1 = grows1 * field[1].right[i],
			   .down1 = grows1 * field[1].down[i]};
		g.area = sqrtf(fabsf(g.right0 * g.down1 - g.down0 * g.right1));
		float x = size0 * from_whole(l->at[0][i]), x_between = size0 * from_whole(l->at[0][i] - 0.5f);
		float y = size1 * from_whole(l->at[1][i]), y_between = size1 * from_whole(l->at[1][i] - 0.5f);
		float r = radius[i], h0 = root[0][i], h1 = root[1][i];
		painted_dot(r, soft, x, y, &g, b->radius[0] + i, b->distance[0] + i);
		painted_dot(r * h0, soft, x_between, y, &g, b->radius[1] + i, b->distance[1] + i);
		painted_dot(r * h1, soft, x, y_between, &g, b->radius[2] + i, b->distance[2] + i);
		painted_dot(r * (h0 * h1), soft, x_between, y_between, &g, b->radius[3] + i, b->distance[3] + i);
	}
}

static void of_one_size(const tone_screen *s, float share, int n, const tone_lattice *l,
			float (*restrict root)[TONE_CHUNK], const float *restrict radius, const float *restrict dark,
			births *restrict b)
{
	for (int i = 0; i < n; i++) {
		float h0 = root[0][i], h1 = root[1][i], r = radius[i];
		metric m = metric_at(l, i, s->pitch, dark[i]);
		b->radius[0][i] = r * share;
		b->radius[1][i] = r * h0 * share;
		b->radius[2][i] = r * h1 * share;
		b->radius[3][i] = r * h0 * h1 * share;
		b->distance[0][i] = sqrtf(nearest(l, &m, i, 0, 0));
		b->distance[1][i] = sqrtf(nearest(l, &m, i, 0.5f, 0));
		b->distance[2][i] = sqrtf(nearest(l, &m, i, 0, 0.5f));
		b->distance[3][i] = sqrtf(nearest(l, &m, i, 0.5f, 0.5f));
	}
}

void ISA(tone_dots)(const tone_screen *s, int n, const tone_field field[2], const float *restrict dark,
		    float *restrict ink)
{
	tone_lattice l;
	births b;
	float root[2][TONE_CHUNK], radius[TONE_CHUNK], soft = s->soft + s->more_soft * s->pitch, share = 1 / soft;
	ISA(tone_lattice_fill)(s->least, s->most, n, field, &l);
	for (int k = 0; k < 2; k++)
		for (int i = 0; i < n; i++)
			root[k][i] = sqrtf(l.grown[k][i]);
	radii_at(s, n, root[0], root[1], dark, radius);
	if (s->least < s->most) {
		painted(s, n, field, &l, root, radius, &b);
		cover_row(1, 1, n, &b, l.flat, dark, ink);
	} else {
		of_one_size(s, share, n, &l, root, radius, dark, &b);
		cover_row(soft, share, n, &b, l.flat, dark, ink);
	}
}
