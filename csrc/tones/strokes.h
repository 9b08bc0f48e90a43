/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Strokes and spots: what scatter.c finds of them and strokes.c draws. */
#ifndef ENCRE_STROKES_H
#define ENCRE_STROKES_H

#include "tones/tones.h"

enum {
	TONE_SPOTS = TONE_LAYERS, /* the row of tables that spots take */
	/* a pixel's bits: its slot; whether the surface ends beside it; times 2^layer: the place of a mark is in it */
	TONE_SLOT = 3,
	TONE_ENDS_RIGHT = 4,
	TONE_ENDS_DOWN = 8,
	TONE_FOUND = 16
};

static const float stroke_length = 5;        /* pitches */
static const float full_cover = 0.69314718f; /* area of all marks of a layer, about: half of the surface is covered */

/* A stroke or spot: pixels of this frame. */
typedef struct tone_mark {
	float x, y;  /* its middle */
	float size;  /* 0..1, how far it is grown along and across */
	float rank;  /* 0..1, by which few or many are drawn */
	float reach; /* half of its length; 0 of spots */
	float turn;  /* radians by which it strays */
	const tone_slot *slot;
	int32_t column; /* of the pixel that holds its place on the lattice */
	uint8_t layer;
} tone_mark;

/* What strokes need of a pixel. */
typedef struct tone_pixel {
	uint8_t dark; /* 1..255; 0: no mark fills it */
	uint8_t bits; /* strokes.c */
	uint8_t ink;
	uint8_t way[TONE_LAYERS]; /* of each layer's strokes, 256ths of half a turn from the right down */
} tone_pixel;

/* What strokes.c has of a frame; NULL where there are none. */
struct tone_marks {
	const tone_style *styles;
	tone_pixel *pixels; /* width * height */
	int64_t *first;     /* height + 1: of each row */
	tone_mark *marks;
	/* by layer, spots last, and darkness: which ranks are drawn; how large */
	float shown[TONE_LAYERS + 1][256], size[TONE_LAYERS + 1][256];
	float way[256][2];
};

static inline tone_pixel *tone_pixels(const frame *f, const tone_marks *m, int y)
{
	return m->pixels + (size_t)y * (size_t)f->width;
}

static inline bool tone_marked(const tone_slot *s)
{
	return s->kind == tone_1_HATCH || s->kind == tone_1_STIPPLE;
}

/* From mark to mark, about; a pixel holds one place of each layer at most. */
static inline float tone_mark_pitch(const tone_slot *s)
{
	return max(s->pitch * (s->kind == tone_1_STIPPLE ? 0.5f : 1), 3);
}

/* scatter.c: whether a style has marks; the tables; what strokes need of a row, and how many marks have their places in
 * it; and these, in the order of columns and layers. */
bool ISA(tone_marks_wanted)(const encre_params *p);
void ISA(tone_marks_tables)(tone_marks *m);
int ISA(tone_marks_look)(const frame *f, const tone_marks *m, int y);
void ISA(tone_marks_find)(const frame *f, const tone_marks *m, int y, tone_mark *marks);
/* strokes.c: ink of all, from darkness on. */
int32_t ISA(tone_marks_run)(frame *f, tone_marks *m);

#endif
