/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Screens: a darkness in 0..1 becomes ink whose mean is that, in dots or lines of a fixed size on the screen. */
#ifndef ENCRE_TONES_H
#define ENCRE_TONES_H

#include "base/stage.h"

enum { TONE_CHUNK = 256, TONE_BIRTHS = 11, TONE_STEPS = 33, TONE_SLOTS = 4 };

/* A coordinate in which a screen repeats itself, at the pixels of a chunk, and its growth per pixel. */
typedef struct tone_field {
	float at[TONE_CHUNK], right[TONE_CHUNK], down[TONE_CHUNK];
} tone_field;

/* One look of dots or lines. */
typedef struct tone_screen {
	float pitch; /* pixels, at least 2 */
	float soft;  /* pixels over which edges fade, at least 1 */
	/* radius of full-grown dots in pixels, by the square roots of how grown those between are, along one axis and
	   the other, and by even() of the darkness */
	float radius[TONE_BIRTHS][TONE_BIRTHS][TONE_STEPS];
} tone_screen;

tone_screen *ISA(tone_screen_fill)(tone_screen *screen, float pitch, float hardness, bool dots);
void ISA(tone_dots)(const tone_screen *screen, int n, const tone_field field[2], const float *restrict dark,
		    float *restrict ink);
void ISA(tone_lines)(const tone_screen *screen, int n, const tone_field *field, const float *restrict dark,
		     float *restrict ink);

/* 2^floor(log2 x) and, in *rest, x divided by it, of 2^-60 <= x <= 2^60; others are moved there. */
static inline float octave(float x, float *rest)
{
	x = x > 0x1p-60f ? x : 0x1p-60f;
	x = x < 0x1p60f ? x : 0x1p60f;
	int32_t bits = float_bits(x);
	*rest = bits_float((bits & 0x7fffff) | 0x3f800000);
	return bits_float(bits & 0x7f800000);
}

#endif
