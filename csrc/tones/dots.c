/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Dots: discs of one size on the screen, as spread.c tells where, or ellipses as if painted on, at the whole numbers of
 * two fields, as many to the unit along each as keep them apart. Those half-way between have grown to their share
 * (ruled.c tells why). How large they must be for the ink that is asked for, overlaps and soft edges and all, is found
 * by trying. */
#include "tones/tones.h"

#include <string.h>

enum { RADII = 40, TRIES = 377, ACROSS = 233 /* Fibonacci numbers: all over a cell */, YOUNG = 4 };

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

/* How far it is from places all over half of a cell to the nearest dot of each birth, in a lattice of rows that are
 * `high` apart, each shifted by so many dots along the one before. */
static void distances(float wide, float high, float slant, float (*restrict distance)[TRIES])
{
	for (int n = 0; n < TRIES; n++) {
		float x = (float)(n * ACROSS % TRIES) / TRIES, y = ((float)n + 0.5f) / (2 * TRIES);
		for (int k = 0; k < YOUNG; k++) {
			float best = 1e30f, off = k >> 1 ? y + 0.5f : y;
			for (int j = 0; j < 2; j++, off -= 1) {
				float along = x - 0.5f * (float)(k & 1) + off * slant;
				along = (along - floorf(along + 0.5f)) * wide;
				best = min(best, along * along + off * high * (off * high));
			}
			distance[k][n] = sqrtf(best);
		}
	}
}

/* Mean ink over a cell whose full-grown dots have this radius. root: of young ones' share. */
static float mean_ink(float (*restrict distance)[TRIES], const float root[YOUNG], float soft, float radius)
{
	float ink[TRIES] = {0}, share = 1 / soft, sum = 0;
	for (int k = 0; k < YOUNG; k++) {
		float reach = true_radius(radius * root[k] * share) + 0.5f;
		for (int n = 0; n < TRIES; n++)
			ink[n] = max(ink[n], clamp01(reach - distance[k][n] * share));
	}
	for (int n = 0; n < TRIES; n++)
		sum += ink[n];
	return sum / TRIES;
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

/* About the logarithm of 1 + grown. */
static inline float halfway(float grown)
{
	return grown * (4 - grown) * (1.0f / 3);
}

static void fill_radii(tone_screen *s, int shear, int b0, int b1)
{
	float h0 = 2 - sqrtf(4 - 3 * (float)b0 / (TONE_BIRTHS - 1)),
	      h1 = 2 - sqrtf(4 - 3 * (float)b1 / (TONE_BIRTHS - 1));
	float slant = (float)shear / (TONE_SHEARS - 1), share[YOUNG] = {1}, distance[YOUNG][TRIES];
	float ink[RADII + 1], soft = s->soft, most = 1.1f * s->pitch + soft;
	tone_births(h0, h1, share + 1);
	for (int k = 1; k < YOUNG; k++)
		share[k] = sqrtf(share[k]);
	distances(s->pitch * (1 + h0), s->pitch * (1 + h1), slant, distance);
	ink[0] = 0;
	for (int k = 1; k <= RADII; k++)
		ink[k] = ink[k - 1] < 1 ? mean_ink(distance, share, soft, most * (float)k / RADII) : 1;
	for (int t = 0, k = 1; t < TONE_STEPS; t++) {
		float step = (float)t / (TONE_STEPS - 1);
		while (k < RADII && even(ink[k]) < step)
			k++;
		float before = even(ink[k - 1]), after = even(ink[k]);
		float part = after > before ? (step - before) / (after - before) : 1;
		s->radius[shear][b0][b1][t] = most * ((float)(k - 1) + clamp01(part)) / RADII;
	}
}

enum { TRIED = 8 /* pixels of pitch */ };

void ISA(tone_screen_fill)(tone_screen *s, const tone_slot *slot)
{
	bool own = slot->space == tone_1_space_OBJECT;
	s->pitch = own ? TRIED : max(slot->pitch, 2);
	s->least = own ? 5 : s->pitch;
	s->most = own ? 1e6f : s->pitch;
	s->soft = slot->crisp ? 0.002f : 1;
	for (int shear = 0; shear < (own ? 1 : TONE_SHEARS) && slot->kind == tone_1_DOTS; shear++)
		for (int b0 = 0; b0 < TONE_BIRTHS; b0++)
			for (int b1 = 0; b1 < TONE_BIRTHS; b1++)
				fill_radii(s, shear, b0, b1);
	if (own) /* radii_at() reads the next shear, too, though of none of it is taken */
		memcpy(s->radius[1], s->radius[0], sizeof s->radius[0]);
}

/* Where a value of n steps lies between two of them. */
static inline int32_t step_at(float at, int n, float *rest)
{
	int32_t i = (int32_t)at;
	i = i < n - 2 ? i : n - 2;
	*rest = at - (float)i;
	return i;
}

/* A table's values don't come in vectors: what is asked of it is told before, and what it says is mixed behind. Between
 * births by threes, as they are others beside the diagonal than on it. */
static void radii_at(const tone_screen *s, int n, const float *restrict slant, float (*restrict grown)[TONE_CHUNK],
		     const float *restrict dark, float *restrict radius)
{
	enum { ROW = TONE_STEPS, PLANE = TONE_BIRTHS * ROW, SHEAR = TONE_BIRTHS * PLANE };
	const float *table = s->radius[0][0][0];
	int32_t at[TONE_CHUNK], next[TONE_CHUNK];
	float a[TONE_CHUNK], b[TONE_CHUNK], x[TONE_CHUNK], t[TONE_CHUNK];
	float none[2][TONE_CHUNK], one[2][TONE_CHUNK], both[2][TONE_CHUNK];
	for (int i = 0; i < n; i++) {
		at[i] = step_at(halfway(grown[0][i]) * (TONE_BIRTHS - 1), TONE_BIRTHS, a + i) * PLANE +
			step_at(halfway(grown[1][i]) * (TONE_BIRTHS - 1), TONE_BIRTHS, b + i) * ROW +
			step_at(even(dark[i]) * (TONE_STEPS - 1), TONE_STEPS, t + i);
		next[i] = a[i] > b[i] ? PLANE : ROW;
	}
	for (int i = 0; i < n; i++)
		at[i] += step_at(fabsf(slant[i]) * (TONE_SHEARS - 1), TONE_SHEARS, x + i) * SHEAR;
	for (int i = 0; i < n; i++)
		for (int k = 0; k < 2; k++) {
			const float *from = table + at[i] + k * SHEAR;
			none[k][i] = mix(from[0], from[1], t[i]);
			one[k][i] = mix(from[next[i]], from[next[i] + 1], t[i]);
			both[k][i] = mix(from[PLANE + ROW], from[PLANE + ROW + 1], t[i]);
		}
	for (int i = 0; i < n; i++) {
		float less = min(a[i], b[i]), more = max(a[i], b[i]), sum[2];
		for (int k = 0; k < 2; k++)
			sum[k] = (1 - more) * none[k][i] + (more - less) * one[k][i] + less * both[k][i];
		radius[i] = mix(sum[0], sum[1], x[i]);
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

/* Of the dots of one birth the radius and a pixel's distance, by the width of their edge. */
typedef struct births {
	float radius[YOUNG][TONE_CHUNK], distance[YOUNG][TONE_CHUNK];
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
	for (int k = 0; k < YOUNG; k++)
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
		ink[i] = blend(ink[i], dark[i], flat[i]);
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

/* Where a pitch is seen as less than 3.5 pixels high, rows of dots that slant across those of pixels would be bands
 * of moire: there dots pass to their mean, as from afar, and have done so at half of that. */
static const float least_height = 1.75f;

static inline float too_low(const slant *g, float pitch)
{
	float sum = g->right0 * g->right0 + g->down0 * g->down0 + g->right1 * g->right1 + g->down1 * g->down1;
	float area = g->area * g->area, most = 0.5f * (sum + sqrtf(max(sum * sum - 4 * area * area, 0)));
	return clamp01(2 - pitch / (least_height * sqrtf(max(most, 1e-30f))));
}

static inline float from_whole(float at)
{
	return at - floorf(at + 0.5f);
}

/* From one to the next there are grown + 1 pitches. */
static inline slant slant_at(const tone_screen *s, const tone_field field[2], const tone_lattice *l, int i)
{
	float grows0 = s->pitch * (1 + l->grown[0][i]) * l->scale[0][i];
	float grows1 = s->pitch * (1 + l->grown[1][i]) * l->scale[1][i];
	slant g = {.right0 = grows0 * field[0].right[i],
		   .down0 = grows0 * field[0].down[i],
		   .right1 = grows1 * field[1].right[i],
		   .down1 = grows1 * field[1].down[i]};
	g.area = sqrtf(fabsf(g.right0 * g.down1 - g.down0 * g.right1));
	return g;
}

static void flatten(const tone_screen *s, int n, const tone_field field[2], tone_lattice *l)
{
	for (int i = 0; i < n; i++) {
		slant g = slant_at(s, field, l, i);
		l->flat[i] = l->flat[i] > 0 ? 1 : too_low(&g, s->pitch);
	}
}

static void painted(const tone_screen *s, int n, const tone_field field[2], const tone_lattice *l,
		    const float *restrict radius, births *restrict b)
{
	for (int i = 0; i < n; i++) {
		float soft = s->soft;
		float size0 = s->pitch * (1 + l->grown[0][i]), size1 = s->pitch * (1 + l->grown[1][i]);
		slant g = slant_at(s, field, l, i);
		float x = size0 * from_whole(l->at[0][i]), x_between = size0 * from_whole(l->at[0][i] - 0.5f);
		float y = size1 * from_whole(l->at[1][i]), y_between = size1 * from_whole(l->at[1][i] - 0.5f);
		float r = radius[i], share[3];
		tone_births(l->grown[0][i], l->grown[1][i], share);
		painted_dot(r, soft, x, y, &g, b->radius[0] + i, b->distance[0] + i);
		painted_dot(r * sqrtf(share[0]), soft, x_between, y, &g, b->radius[1] + i, b->distance[1] + i);
		painted_dot(r * sqrtf(share[1]), soft, x, y_between, &g, b->radius[2] + i, b->distance[2] + i);
		painted_dot(r * sqrtf(share[2]), soft, x_between, y_between, &g, b->radius[3] + i, b->distance[3] + i);
	}
}

static void of_one_size(float per, int n, const tone_spread *l, const float *restrict radius, births *restrict b)
{
	for (int i = 0; i < n; i++) {
		float r = radius[i] * per, wide = l->apart[0][i], high = l->apart[1][i];
		b->radius[0][i] = r;
		for (int k = 0; k < 3; k++)
			b->radius[k + 1][i] = r * sqrtf(l->share[k][i]);
		/* the nearest dot is in one of the two rows beside a pixel */
		for (int young = 0; young < 2; young++) {
			float off = l->at[1][i] - 0.5f * (float)young, best = 1e30f, best_between = 1e30f;
			off -= floorf(off);
			for (int k = 0; k < 2; k++, off -= 1) {
				float along = fabsf(from_whole(l->at[0][i] + off * l->slant[i]));
				float x = along * wide, between = (0.5f - along) * wide, y = off * high;
				best = min(best, x * x + y * y);
				best_between = min(best_between, between * between + y * y);
			}
			b->distance[2 * young][i] = sqrtf(best);
			b->distance[2 * young + 1][i] = sqrtf(best_between);
		}
	}
}

void ISA(tone_dots)(const tone_screen *s, int n, const tone_field field[2], const float *restrict dark,
		    float *restrict ink)
{
	births b;
	float radius[TONE_CHUNK], soft = s->soft;
	if (s->least < s->most) {
		tone_lattice l;
		ISA(tone_lattice_fill)(s->least, s->most, n, field, &l);
		const float upright[TONE_CHUNK] = {0};
		radii_at(s, n, upright, l.grown, dark, radius);
		painted(s, n, field, &l, radius, &b);
		if (s->soft == 1) /* else there is no grey */
			flatten(s, n, field, &l);
		cover_row(1, 1, n, &b, l.flat, dark, ink);
	} else {
		tone_spread l;
		ISA(tone_spread_fill)(s->pitch, n, field, &l);
		radii_at(s, n, l.slant, l.grown, dark, radius);
		of_one_size(1 / soft, n, &l, radius, &b);
		cover_row(soft, 1 / soft, n, &b, l.flat, dark, ink);
	}
}
