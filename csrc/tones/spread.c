/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Where dots of one size on the screen lie: at the whole numbers of two fields, thinned out along one way and along
 * another until they are spread as evenly as may be. Seen at a slant, the fields' own axes lie almost along each other
 * and dots would be beads on strings. So the shortest step from dot to dot, by whole numbers of both axes, is a row;
 * rows are thinned out beside each other, and dots within them. Which step goes over to the next row must not depend on
 * how the rows are seen, or dots would jump from place to place as the camera moves: it is chosen by the whole numbers.
 * Where another step gets to be the shortest, the two are as long, and what is drawn is the same with either. */
#include "tones/tones.h"

enum { ROUNDS = 10 };

/* A step by whole numbers of both axes, and on the screen. */
typedef struct steps {
	float first[TONE_CHUNK], second[TONE_CHUNK], x[TONE_CHUNK], y[TONE_CHUNK];
} steps;

/* 1 by a power of 2 that octave() has given. */
static inline float inverse(float power)
{
	return bits_float(0x7f000000 - float_bits(power));
}

/* The longer step less whole ones of the shorter; whether anything has changed. What is done once more stays as it is:
 * how many rounds there are is told by all pixels of a chunk. */
static int shorten(int n, steps *restrict a, steps *restrict b)
{
	int any = 0;
	for (int i = 0; i < n; i++) {
		float ax = a->x[i], ay = a->y[i], bx = b->x[i], by = b->y[i];
		float p = a->first[i], q = a->second[i], r = b->first[i], t = b->second[i];
		float square = ax * ax + ay * ay, slant = (ax * bx + ay * by) / square;
		float whole = fabsf(slant) > 0.5001f ? nearest_int(slant) : 0;
		bx -= whole * ax;
		by -= whole * ay;
		r -= whole * p;
		t -= whole * q;
		int swap = bx * bx + by * by < square;
		a->x[i] = swap ? bx : ax;
		a->y[i] = swap ? by : ay;
		a->first[i] = swap ? r : p;
		a->second[i] = swap ? t : q;
		b->x[i] = swap ? ax : bx;
		b->y[i] = swap ? ay : by;
		b->first[i] = swap ? p : r;
		b->second[i] = swap ? q : t;
		any |= swap | (fabsf(slant) > 0.5001f);
	}
	return any;
}

/* Of the lattice whose dots lie a unit of both fields apart. */
static void reduce(int n, const tone_field field[2], steps *restrict a, steps *restrict b, float *restrict flat)
{
	for (int i = 0; i < n; i++) {
		float r0 = field[0].right[i], d0 = field[0].down[i], r1 = field[1].right[i], d1 = field[1].down[i];
		float cross = r0 * d1 - d0 * r1, sides = (r0 * r0 + d0 * d0) * (r1 * r1 + d1 * d1);
		int seen = cross * cross > 1e-6f * sides; /* not of NaN */
		float over = 1 / (seen ? cross : 1);
		flat[i] = seen ? 0 : 1;
		a->x[i] = seen ? d1 * over : 1;
		a->y[i] = seen ? -r1 * over : 0;
		b->x[i] = seen ? -d0 * over : 0;
		b->y[i] = seen ? r0 * over : 1;
		a->first[i] = b->second[i] = 1;
		a->second[i] = b->first[i] = 0;
	}
	for (int k = 0; k < ROUNDS && shorten(n, a, b); k++)
		;
}

void ISA(tone_spread_fill)(float pitch, int n, const tone_field field[2], tone_spread *restrict s)
{
	steps a, b;
	float per = 1 / pitch;
	reduce(n, field, &a, &b, s->flat);
	for (int i = 0; i < n; i++) {
		float p = a.first[i], q = a.second[i], r = b.first[i], t = b.second[i], sign = p * t - q * r;
		float square = a.x[i] * a.x[i] + a.y[i] * a.y[i], area = fabsf(a.x[i] * b.y[i] - a.y[i] * b.x[i]);
		/* of the steps to the next row on one side, the one that is shortest by whole numbers */
		float back = floorf(sign * (p * r + q * t) / (p * p + q * q) + 0.5f);
		r = sign * r - back * p;
		t = sign * t - back * q;
		float slant = sign * (a.x[i] * b.x[i] + a.y[i] * b.y[i]) / square - back;
		float wide = sqrtf(square), high = area / wide, even = sqrtf(area), grown0, grown1;
		float m0 = octave((high > wide ? wide : even) * per, &grown0),
		      m1 = octave((high > wide ? high : even) * per, &grown1);
		float less0 = inverse(m0), less1 = inverse(m1);
		slant *= m0 * less1;
		float turns = floorf(0.5f * slant + 0.5f), folded = slant - 2 * turns;
		/* places repeat themselves by whole numbers of the sparser of both ways: large ones would lose digits
		 */
		float rare = min(m0, m1), u = field[0].at[i] * rare, v = field[1].at[i] * rare;
		u -= floorf(u);
		v -= floorf(v);
		float across = (v * p - u * q) * max(m1 * less0, 1);
		s->at[0][i] = (u * t - v * r) * max(m0 * less1, 1) + 2 * turns * across;
		s->at[1][i] = across;
		s->apart[0][i] = wide * less0;
		s->apart[1][i] = high * less1;
		folded = fabsf(folded) <= 1 ? folded : 0; /* NaN */
		s->slant[i] = folded;
		s->grown[0][i] = grown0 - 1;
		s->grown[1][i] = grown1 - 1;
		float share[3];
		tone_births(grown0 - 1, grown1 - 1, share);
		for (int k = 0; k < 3; k++)
			s->share[k][i] = share[k];
	}
}
