/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Pictures that lie along lines: brushes, chalk, chains. */
#ifndef ENCRE_STRIPS_H
#define ENCRE_STRIPS_H

#include "ink/discs.h"
#include "ink/pen.h"

enum { STRIP_LEVELS = 17 };

/* Its ink, 0 to 1, and that of pictures each half as wide and high as the one before, down to one texel. */
typedef struct strip {
	const float *data; /* of the image that it is made of */
	int levels, width[STRIP_LEVELS], height[STRIP_LEVELS];
	float *ink[STRIP_LEVELS];
} strip;

/* Where a site lies in the strip along its line. */
typedef struct strip_end {
	const strip *of; /* NULL: its pen has none */
	float left;      /* what is left of the ink where the picture is white */
	float at, born;  /* how far along it, 0 to 1; how far two of half the length have taken its place */
	float length;    /* pixels of the whole; 0: nothing tells */
	int32_t octave;
} strip_end;

/* Which of its pictures is read, and how much of the next. */
typedef struct strip_level {
	int level;
	float next;
} strip_level;

/* Of a link: its ends, made to agree. */
typedef struct strip_link {
	const strip *of;
	float left[2], at[2], born[2];
	float length;
	strip_level level[2]; /* of the whole, and of two of half the length */
	float x, y, far;      /* the way of the line, of length 1; how far the second end lies on it */
	float rate;           /* of the strip to a pixel on it */
	bool jumps;           /* from one to the other in the middle */
} strip_link;

/* strips.c: those of the pens of all styles, by style; each image once. */
int32_t ISA(strips_make)(frame *f, const pens *all, const strip *(**to)[PENS]);
/* `far`: pixels from one end to the other. */
strip_link ISA(strip_between)(const strip_end *a, const strip_end *b, float far);
/* Where the line is so many pixels wide. */
void ISA(strip_choose)(strip_link *l, float wide);
/* Of the strip to a pixel, below 0 where it goes from b to a; 0 where nothing tells. */
float ISA(strip_rate)(const strip_end *a, const strip_end *b);

/* Ink of one level at LANES places (u, v), 0 to 1 each way; it goes on along and not across. */
static inline void strip_texels(const strip *s, int level, const float *restrict u, const float *restrict v,
				float *restrict ink)
{
	int wide = s->width[level], high = s->height[level];
	int32_t at[4][LANES];
	float right_by[LANES], down_by[LANES], texel[4][LANES];
	const float *from = s->ink[level];
	for (int k = 0; k < LANES; k++) {
		float x = (u[k] - floorf(u[k])) * (float)wide - 0.5f, y = v[k] * (float)high - 0.5f, fx = floorf(x),
		      fy = floorf(y);
		int left = (int)fx, top = (int)fy;
		int right = left + 1 < wide ? left + 1 : 0, down = top + 1 < high ? top + 1 : high - 1;
		left = left < 0 ? wide - 1 : left;
		top = top < 0 ? 0 : top;
		at[0][k] = top * wide + left;
		at[1][k] = top * wide + right;
		at[2][k] = down * wide + left;
		at[3][k] = down * wide + right;
		right_by[k] = x - fx;
		down_by[k] = y - fy;
	}
	for (int c = 0; c < 4; c++)
		for (int k = 0; k < LANES; k++)
			texel[c][k] = from[at[c][k]];
	for (int k = 0; k < LANES; k++)
		ink[k] = mix(mix(texel[0][k], texel[1][k], right_by[k]), mix(texel[2][k], texel[3][k], right_by[k]),
			     down_by[k]);
}

static inline void strip_inks(const strip *s, strip_level at, const float *restrict u, const float *restrict v,
			      float *restrict ink)
{
	float more[LANES];
	strip_texels(s, at.level, u, v, ink);
	if (!(at.next > 0))
		return;
	strip_texels(s, at.level + 1, u, v, more);
	for (int k = 0; k < LANES; k++)
		ink[k] = mix(ink[k], more[k], at.next);
}

/* What is left of the ink at LANES places px and `py` from the first end, the nearest to s of the way to the second, v
 * across from rim to rim. */
static inline void strip_left(const strip_link *l, const float *restrict px, float py, const float *restrict s,
			      const float *restrict v, float *restrict left)
{
	float u[LANES], born[LANES], ink[LANES] = {0}, least = 1, most = 0;
	for (int k = 0; k < LANES; k++) {
		float along = l->x * px[k] + l->y * py, one = l->at[0] + l->rate * along,
		      two = l->at[1] + l->rate * (along - l->far);
		float jump = s[k] > 0.5f ? 1.0f : 0.0f, share = l->jumps ? jump : s[k];
		u[k] = mix(one, two, share);
		born[k] = mix(l->born[0], l->born[1], share);
		least = min(least, born[k]);
		most = max(most, born[k]);
	}
	if (least < 1)
		strip_inks(l->of, l->level[0], u, v, ink);
	if (most > 0) {
		float half[LANES];
		for (int k = 0; k < LANES; k++)
			u[k] *= 2;
		strip_inks(l->of, l->level[1], u, v, half);
		for (int k = 0; k < LANES; k++)
			ink[k] = mix(ink[k], half[k], born[k]);
	}
	for (int k = 0; k < LANES; k++)
		left[k] = mix(mix(l->left[0], l->left[1], s[k]), 1, ink[k]);
}

#endif
