/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Light in a few levels: what shading makes a picture of. */
#ifndef ENCRE_LIT_H
#define ENCRE_LIT_H

#include "base/stage.h"

enum { LIT_CHUNK = 128 /* pixels: all that is made of them stays in the nearest cache */ };

/* What levels make of light. passed: share of the way from the level below to this one. */
typedef struct lit {
	float exposed[LIT_CHUNK], tone[LIT_CHUNK], passed[ENCRE_MAX_LEVELS][LIT_CHUNK];
} lit;

/* Of n pixels of one style from x on. diffuse: their light by channels. */
void ISA(lit_row)(const frame *f, const encre_params *p, int y, int x, int n, float (*diffuse)[LIT_CHUNK], lit *l);

/* One channel of the colour of the levels. */
void ISA(level_color_row)(const encre_levels *levels, int c, int n, lit *l, float *color);

#endif
