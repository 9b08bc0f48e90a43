/* SPDX-License-Identifier: GPL-3.0-or-later */
/* How lines turn, where strokes go on beyond corners, and how dashes lie along them. */
#ifndef ENCRE_TURNS_H
#define ENCRE_TURNS_H

#include "ink/discs.h"
#include "ink/noise.h"

/* A stroke that comes to a corner goes on from its site. */
typedef struct spur {
	uint32_t site, over; /* where it ends, and the site of its line before that */
	uint32_t back;       /* likewise, as far as its way was told by */
	float dx, dy;        /* its way, of length 1 */
	float room;          /* pixels that the line is long before it, at most what was asked for */
} spur;

typedef struct turns {
	float *turn;    /* by site, 1 less the cosine of the angle: 0 straight on, 2 back; NULL: not asked for */
	float *bend;    /* by site, 0 where the line is straight, nearly 1 where it curls; likewise */
	spur *spur;     /* in the order of their sites */
	uint32_t spurs; /* how many */
} turns;

/* room: pixels along a line that a spur is told of; 0: no spurs are asked for. */
int32_t ISA(turns_find)(frame *f, float room, turns *t);

/* The next site of a line, coming from `from`: where several meet, of the one that goes most straight on, seen from
 * both sides; or UINT32_MAX. */
uint32_t ISA(onward)(const fine *n, uint32_t from, uint32_t i);

/* How lines bend, over several of their widths. */
int32_t ISA(curves_find)(frame *f, turns *t);

/* Where the end of a stroke's k-th spur is among all ends: behind those of sites. */
static inline size_t spur_end(const capsules *all, uint32_t stroke, uint32_t k)
{
	return (size_t)all->ends + (size_t)stroke * all->spurs + k;
}

/* reached.c: which links, and ends of spurs, reach into which band of rows. */
int32_t ISA(capsules_list)(frame *f, uint32_t strokes, capsules *all);

/* Where a site lies in the dashes along its line. */
typedef struct beat {
	float whole, half; /* pixels to the nearest place where dashes part, and to the nearest where one is parting */
	float born;        /* how far that has come, 0..1 */
	float length;      /* as asked for; 0: nothing tells */
	float at;          /* how far from one place to the next, 0..1, which is that times 1 + born */
	int32_t octave;    /* which places those are */
	int32_t number;    /* of the one before */
} beat;

/* What beats are told from. step: by link, as `fine` has them, the next one of its line, where that goes on over the
 * same thing. */
typedef struct beats {
	const fine *n;
	spots at; /* of all sites */
	uint32_t *step;
} beats;

/* beats.c. Takes memory of the frame's. */
int32_t ISA(beats_find)(frame *f, const spots *at, beats *b);
/* `length`: in pixels, of a dash and what follows it. */
beat ISA(beat_of)(const beats *b, uint32_t i, float length);

#endif
