/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Strokes and spots: what scatter.c finds of them and strokes.c draws. */
#ifndef ENCRE_STROKES_H
#define ENCRE_STROKES_H

#include "tones/points.h"

enum {
	/* what strokes need of a pixel, a byte each: */
	TONE_DARK = 0, /* 1..255; 0: no mark fills it */
	TONE_BITS,     /* whether the surface ends beside it; times 2^layer: the place of a mark is in it; whether its
			own is known */
	TONE_WHOSE,    /* its slot */
	TONE_SHARE,    /* of the marks in the pixel, 255ths */
	TONE_NEAR,     /* whether the surface ends between the pixel and the next to the right, the next but one, ...;
			times 2^TONE_AHEAD: and downward */
	TONE_WAY,      /* of each layer's strokes, tone_way_of() */
	TONE_BYTES = TONE_WAY + TONE_LAYERS,
	TONE_AHEAD = 4,
	TONE_BLOCK = 32,
	TONE_PLACES_OUT = 8 /* from a stroke's middle to its end, and two more */,
	TONE_LEAST_STEP = 4 /* pixels */,
	TONE_TURNS = 4096 /* things whose turn is known */,
	TONE_ENDS_RIGHT = 4,
	TONE_ENDS_DOWN = 8,
	TONE_FOUND = 16,
	TONE_PLACES = TONE_FOUND * ((1 << TONE_LAYERS) - 1),
	TONE_LOST = 128 /* nobody knows its place: it has the mean */
};

static const float stroke_length = 5;        /* pitches */
static const float widest_apart = 40;        /* "px": so much and no more they are apart that grow with the thing */
static const float full_cover = 0.69314718f; /* area of all marks of a layer, about: half of the surface is covered */

/* A stroke or spot: pixels of the full frame, so that its numbers are the same in any part of it. */
typedef struct tone_mark {
	float x, y;  /* its middle */
	float size;  /* how far it is grown along and across; beside a seam of lattices a little above 1. Of a spot its
			radius, pixels */
	float rank;  /* 0..1, by which few or many are drawn */
	float pitch; /* pixels */
	float reach; /* half of its length; 0 of spots */
	float turn;  /* radians by which it strays */
	const tone_slot *slot;
	int32_t column; /* of this frame's pixel that holds its place on the lattice */
	uint32_t name;  /* of the place */
	int32_t off;    /* 256ths of the square of the way from its middle to the place, in pixels: so that of a place
			   half-way between two pixels any rounding tells the same */
	/* of a spot: the density at which it was born; how far, 0..1, those born before, nearer than so many pixels,
	   take from it; and what they leave of its area */
	float born, thinned, within, weight;
	uint8_t layer;
	bool other; /* a pixel beside holds it, too, and rather */
} tone_mark;

/* Which ranks are drawn, and how large. */
typedef struct tone_width {
	float shown, size;
} tone_width;

/* What TONE_BLOCK pixels each way have at most, and whether of one object. */
typedef struct tone_block {
	float object;
	uint8_t darkest;
	bool parted;
} tone_block;

/* How a thing is turned from rest, seen by the camera, row by row, times any number. */
typedef struct tone_turn {
	float object, by[9];
	bool taken;
} tone_turn;

/* What strokes have of a frame; NULL where there are none. */
struct tone_marks {
	const tone_style *styles;
	uint8_t *bytes; /* of each row all pixels' darkness, then their bits, ... */
	float *ink;
	tone_block *blocks; /* twice all: each with the 8 about it, and alone */
	tone_turn *turns;   /* TONE_TURNS; NULL: no strokes go toward the light */
	int32_t width;
	int64_t *first; /* height + 1: of each row */
	tone_mark *marks;
	uint8_t *lacks; /* of each row: its spots are not counted; NULL: there are none */
	blue_wanted wanted;
	tone_width widths[TONE_LAYERS][256]; /* by layer and darkness */
	uint8_t layers[256];                 /* TONE_FOUND << layer of those that a darkness has */
	float way[256][2];                   /* by tone_way_of() */
};

static inline uint8_t *tone_bytes(const tone_marks *m, int what, int y)
{
	return m->bytes + ((size_t)y * TONE_BYTES + (size_t)what) * (size_t)m->width;
}

static inline int tone_blocks(int pixels)
{
	return (pixels + TONE_BLOCK - 1) / TONE_BLOCK;
}

/* Pixels from place to place along a stroke that goes so far both ways, of which the last lies beyond its end. */
static inline float tone_step(float reach)
{
	return max(TONE_LEAST_STEP, reach / (TONE_PLACES_OUT - 2));
}

static inline float *tone_ink(const tone_marks *m, int y)
{
	return m->ink + (size_t)y * (size_t)m->width;
}

/* A way on the screen, either way along it, as one of 256 places on half of the square |x| + |y| = 1. */
static inline uint8_t tone_way_of(float x, float y)
{
	float sum = fabsf(x) + fabsf(y), along = y < 0 ? -x : x;
	int told = (sum > 1e-30f) & (sum < 1e30f); /* not where squares of the anchor overflow */
	along = told ? along / sum : 1;
	return (uint8_t)(int)(128.5f - 128 * along);
}

/* From mark to mark of constant size, about; a pixel holds one place of each layer at most. */
static inline float tone_mark_pitch(const tone_slot *s)
{
	return max(s->pitch * (s->kind == tone_1_STIPPLE ? 0.5f : 1), 3);
}

/* The axis along which the normal of the i-th pixel is longest; of equal ones the first. */
static inline int tone_axis(const tone_rest *rest, int i)
{
	const float (*normal)[TONE_REST] = rest->at + ANCHOR_NORMAL;
	float x = fabsf(normal[0][i]), y = fabsf(normal[1][i]), z = fabsf(normal[2][i]);
	return x >= y && x >= z ? 0 : y >= z ? 1 : 2;
}

/* seams.c: of pixel x in row y, the i-th of these: whether another axis than its own may begin beside it; the area that
 * strokes have there; and whether a spot's place so far from its middle, in pixels, lies where no part of the normal is
 * longer than along `axis`: second: nor as long, for the pixel's own is another. */
bool ISA(tone_near_seam)(const tone_rest *rest, int i);
float ISA(tone_grown_beside_seam)(const frame *f, const tone_slot *s, const tone_rest *rest, int i, int x, int y);
bool ISA(tone_before_seam)(const frame *f, const tone_slot *s, const tone_rest *rest, int i, int x, int y, int axis,
			   bool second, const float way[2]);
/* held.c: how things are turned; how one is, NULL where nobody knows. */
void ISA(tone_turns_find)(const frame *f, tone_marks *m);
const float *ISA(tone_turn_of)(const tone_marks *m, float object);
/* ways.c: of the pixels of a chunk that strokes of slot k fill: their ways, and where the surface ends. */
void ISA(tone_ways)(const frame *f, const tone_marks *m, const tone_slot *slots, int k, const tone_rest *rest, int y,
		    int x, int n);
/* scatter.c: whether a style has marks; the tables; what strokes need of a row, and how many marks have their places in
 * it; and these, in the order of columns and layers. */
bool ISA(tone_marks_wanted)(const encre_params *p);
void ISA(tone_marks_tables)(tone_marks *m);
int ISA(tone_marks_look)(const frame *f, const tone_marks *m, int y, int thread);
void ISA(tone_marks_find)(const frame *f, const tone_marks *m, int y, tone_mark *marks);
/* And which of these pixels beside it hold rather. */
void ISA(tone_marks_sift)(const frame *f, const tone_marks *m, int y);
/* strokes.c: the ink that rows have of marks whose places are at most `reach` rows away. */
void ISA(tone_marks_draw)(const frame *f, const tone_marks *m, int reach, int y0, int y1);
/* stipple.c: the spots of n pixels of a row, counted where marks is NULL, and then written, in the order of columns.
 * lacks: points that they need are not known; they are asked for. */
int ISA(tone_spots_find)(const frame *f, const tone_marks *m, int y, int x, int n, tone_mark *marks, bool *lacks);
/* sieve.c: takes from spots of slanted surfaces what is too much. */
int32_t ISA(tone_spots_thin)(frame *f, tone_marks *m);
/* passes.c: what strokes need of rows; and ink of all, where `looked` from there on. */
void ISA(tone_marks_rows)(const frame *f, const tone_marks *m, int y0, int y1, int thread);
int32_t ISA(tone_marks_run)(frame *f, tone_marks *m, bool looked);

#endif
