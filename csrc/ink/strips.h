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
	/* height + 1 rows of width + 2 texels, each with the one below it: from the last of the row before the first,
	   for the strip goes on along, and from the first above the first */
	float (*pair[STRIP_LEVELS])[2];
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

enum { STRIP_PLACES = 128 };

/* What is left of the ink at n places, at most STRIP_PLACES and a multiple of LANES: (px, py) from the first end, the
 * nearest to s of the way to the second, v across from rim to rim. */
void ISA(strip_left)(const strip_link *l, int n, const float *restrict px, const float *restrict py,
		     const float *restrict s, const float *restrict v, float *restrict left);

#endif
