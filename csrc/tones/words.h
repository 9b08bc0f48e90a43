/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What words.c and letters.c share: pixels that hang together, among details of one kind. */
#ifndef ENCRE_TONES_WORDS_H
#define ENCRE_TONES_WORDS_H

#include "tones/tones.h"

typedef struct work {
	const frame *f;
	const tone_detail *d;
	uint32_t *open; /* pixels whose neighbours have not been looked at */
	bool dark;      /* dark details are looked at */
	int gap;        /* half of what may lie between letters */
} work;

static inline uint8_t *row_of(const work *w, uint8_t *plane, int y)
{
	return plane + (ptrdiff_t)y * w->f->width;
}

static inline uint8_t *details(const work *w)
{
	return w->dark ? w->d->dark : w->d->thin;
}

static inline size_t pixels_of(const work *w)
{
	return (size_t)w->f->width * (size_t)w->f->height;
}

typedef struct spot {
	int x, y;
	size_t i; /* of its pixel in a plane */
} spot;

static inline spot spot_of(const work *w, uint32_t i)
{
	uint32_t width = (uint32_t)w->f->width, y = i / width;
	return (spot){(int)(i - y * width), (int)y, i};
}

/* The neighbours of a pixel in the frame; returns how many. */
static inline int beside(const work *w, spot s, spot to[4])
{
	size_t width = (size_t)w->f->width;
	int n = 0;
	if (s.x > 0)
		to[n++] = (spot){s.x - 1, s.y, s.i - 1};
	if (s.x + 1 < w->f->width)
		to[n++] = (spot){s.x + 1, s.y, s.i + 1};
	if (s.y > 0)
		to[n++] = (spot){s.x, s.y - 1, s.i - width};
	if (s.y + 1 < w->f->height)
		to[n++] = (spot){s.x, s.y + 1, s.i + width};
	return n;
}

/* letters.c: of `count` pixels in `open` that hang together */
uint8_t ISA(word_sureness)(const work *w, const uint8_t *sure, size_t count);
uint8_t ISA(word_strokes)(const work *w, size_t count);
uint8_t ISA(word_flatness)(const work *w, size_t count);

#endif
