/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Pictures that lie along lines: brushes, chalk, chains. */
#ifndef ENCRE_STRIPS_H
#define ENCRE_STRIPS_H

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

/* Of a link: its ends, made to agree. */
typedef struct strip_link {
	const strip *of;
	float left[2], at[2], born[2];
	float length;
	float x, y, far; /* the way of the line, of length 1; how far the second end lies on it */
	float rate;      /* of the strip to a pixel on it */
	bool jumps;      /* from one to the other in the middle */
} strip_link;

/* strips.c: those of the pens of all styles, by style; each image once. */
int32_t ISA(strips_make)(frame *f, const pens *all, const strip *(**to)[PENS]);
/* `far`: pixels from one end to the other. */
strip_link ISA(strip_between)(const strip_end *a, const strip_end *b, float far);
/* Of the strip to a pixel, below 0 where it goes from b to a; 0 where nothing tells. */
float ISA(strip_rate)(const strip_end *a, const strip_end *b);

/* Ink of one level at (u, v), 0 to 1 each way; it goes on along and not across. */
static inline float strip_texel(const strip *s, int level, float u, float v)
{
	int wide = s->width[level], high = s->height[level];
	float x = (u - floorf(u)) * (float)wide - 0.5f, y = v * (float)high - 0.5f, fx = floorf(x), fy = floorf(y);
	int left = (int)fx, top = (int)fy;
	int right = left + 1 < wide ? left + 1 : 0, down = top + 1 < high ? top + 1 : high - 1;
	left = left < 0 ? wide - 1 : left;
	top = top < 0 ? 0 : top;
	const float *a = s->ink[level] + (ptrdiff_t)top * wide, *b = s->ink[level] + (ptrdiff_t)down * wide;
	return mix(mix(a[left], a[right], x - fx), mix(b[left], b[right], x - fx), y - fy);
}

/* Where it is `texels` of the first level to a pixel. */
static inline float strip_ink(const strip *s, float texels, float u, float v)
{
	int level = 0;
	while (texels > 2 && level + 1 < s->levels) {
		texels *= 0.5f;
		level++;
	}
	float next = level + 1 < s->levels ? clamp01(texels - 1) : 0, ink = strip_texel(s, level, u, v);
	return next > 0 ? mix(ink, strip_texel(s, level + 1, u, v), next) : ink;
}

/* What is left of the ink at (px, py) from the first end, the nearest to s of the way to the second, v across from rim
 * to rim, which are `wide` pixels apart. */
static inline float strip_left(const strip_link *l, float px, float py, float s, float v, float wide)
{
	int end = s > 0.5f;
	float along = l->x * px + l->y * py, one = l->at[0] + l->rate * along,
	      two = l->at[1] + l->rate * (along - l->far);
	float u = l->jumps ? end ? two : one : mix(one, two, s);
	float born = l->jumps ? l->born[end] : mix(l->born[0], l->born[1], s);
	float texels = (float)l->of->width[0] / l->length, across = (float)l->of->height[0] / max(wide, 1);
	float ink = born < 1 ? strip_ink(l->of, max(texels, across), u, v) : 0;
	if (born > 0)
		ink = mix(ink, strip_ink(l->of, max(2 * texels, across), 2 * u, v), born);
	return mix(mix(l->left[0], l->left[1], s), 1, ink);
}

#endif
