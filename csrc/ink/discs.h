/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What the files that draw lines share: the disc of an edge pixel, its darkness, and the ways to find the edge that
 * inks a pixel. */
#ifndef ENCRE_DISCS_H
#define ENCRE_DISCS_H

#include "base/pixel.h"
#include "base/stage.h"

#include <math.h>

/* How an edge is drawn, whatever its shape: half the width, darkness and the least depth it covers. */
typedef struct pen {
	const encre_params *p;
	float radius, gain, bias, limit;
	float pressed; /* the painted factor on its intensity */
} pen;

/* The disc of an edge pixel, or of the edge pixels x..last of one row whose discs differ in nothing but their place.
 * The darkness that it gives a pixel at distance d, on paper of height h, is, before it is clamped to 0..1,
 *   gain * ((1 + pen_1_grain * (h - 1)) * min(1, (radius - d) / fade) - bias). */
typedef struct disc {
	uint16_t x, last;
	uint16_t style;
	float radius;
	float gain, bias; /* gain times intensity; 1 - intensity / 2 */
	float reach;      /* nothing is darkened from here on, however high the paper */
	float limit;      /* pixels with less depth are not covered */
	/* Pixels that a neighbouring edge covers at least as well are left to it: how far the disc goes left of x,
	 * right of last, up and down; and at most dx + dy = corner[below][right] towards a corner (OPEN: no bound). */
	uint16_t left, right, up, down, corner[2][2];
} disc;

enum { OPEN = UINT16_MAX };

/* From the rim inwards until coverage is full. There is a disc for each edge pixel, so that what follows from style and
 * radius is not kept in it. */
static inline float fade_of(const encre_params *p, float radius)
{
	return max(p->pen_1_softness * radius, 1);
}

/* lines.c: the pen of an edge of that source and strength with the controls of pixel nx, ny; false where lines are off.
 */
bool ISA(pen_of)(const frame *f, int nx, int ny, enum source source, float strength, pen *d);
/* lines.c: fills all fields but the bounds; false if the edge pixel inks nothing. */
bool ISA(disc_of)(const frame *f, int x, int y, disc *d);

/* Where an edge pixel takes its controls from. */
static inline void near_of(const frame *f, int x, int y, int *nx, int *ny)
{
	int k = f->near ? f->near[(size_t)y * (size_t)f->width + (size_t)x]
			: 12; /* sites own pixels at their near pixel */
	*nx = x + k % 5 - 2;
	*ny = y + k / 5 - 2;
}

/* LANES pixels are inked at a time; a canvas has as many to spare right of each row. BAND: few rows, for the cache. */
enum { LANES = 8, BAND = 16 };

/* A band of rows that is being inked; row y is at (y - y0) * stride in each plane. Pixels are opened, that is given
 * their depth, paper and no darkness, in blocks of 1 << shift when a disc first touches them. */
typedef struct canvas {
	const frame *f;
	int y0, y1, shift;
	size_t stride;
	uint64_t open[BAND]; /* by row, a bit per block */
	float *dark;         /* darkness, at least 0, not yet clamped to 1 */
	float *depth;        /* INFINITY = nothing there */
	float *grain;        /* height of the paper - 1 */
	/* Which edge inks each pixel, as y << 16 | x, or the number of a link's end, and the square of its distance;
	 * NULL where all ink is the same. Then dark is clamped, so that among equals the nearest, then the first in
	 * reading order, can be kept. */
	uint32_t *owner;
	float *distance;
	/* What earlier strokes of a hand laid here, the darkest of them and, where there are owners, whose that is;
	 * NULL where each line is drawn once. */
	float *laid, *darkest;
	uint32_t *darkest_owner;
	/* The way from the line to each pixel that it darkens most, and what lines on the other side add to that; NULL
	 * where a line is not even across. */
	float *way_x, *way_y, *more;
} canvas;

void ISA(canvas_open)(canvas *c, int y, uint64_t blocks);

/* Opens what inking pixels x..end-1 of row y touches. */
static inline void canvas_touch(canvas *c, int y, int x, int end)
{
	uint64_t first = (uint64_t)1 << (x >> c->shift), last = (uint64_t)1 << ((end + LANES - 1) >> c->shift);
	uint64_t closed = ((last - first) | last) & ~c->open[y - c->y0];
	if (closed)
		ISA(canvas_open)(c, y, closed);
}

/* discs.c: the strongest of all edges. Discs lie in the order of their pixels. */
typedef struct discs {
	size_t *first;       /* per row */
	uint32_t *count;     /* per row */
	uint16_t *up, *down; /* per row: how far any disc goes */
	int reach;           /* the largest of them */
	float *nearest;      /* least depth about each tile */
	float *row_nearest;  /* scratch */
	uint32_t *place;     /* per thread, by pixel of three rows: 1 + which disc of its row that is; 0: none */
	disc *disc;          /* allocated when they are counted */
} discs;

discs ISA(discs_plan)(const frame *f, arena *a);
/* Finds all discs. Returns ENCRE_OK or an error; discs_free() is due in any case. */
int32_t ISA(discs_gather)(const frame *f, discs *all);
void ISA(discs_free)(discs *all);
void ISA(discs_draw)(const discs *all, canvas *c);

/* capsules.c: of each stroke the strongest of all links between the sites of detector FINE, and of the sites without a
 * link; strokes over each other. */
typedef struct capsules {
	struct pen_end *end;     /* by stroke, and in it by site */
	float (*ink)[3];         /* likewise; NULL where all ink is the same */
	uint8_t (*dry)[8];       /* likewise, what each bristle gives (pen.h); NULL where none is dry */
	struct strip_end *strip; /* likewise, where it lies in the picture along it (strips.h); NULL: no pen has one */
	uint32_t count;          /* of sites */
	uint32_t strokes;        /* how many times a line is drawn at most */
	uint32_t ends;           /* strokes times sites; ends beyond corners follow */
	struct spur *spur;       /* these (turns.h) */
	uint32_t spurs;
	bool moved;          /* ends lie elsewhere than their sites */
	uint32_t *first;     /* by band of the canvas, and one more: where its list begins */
	uint32_t (*list)[2]; /* ends of the links that reach into a band; twice the same: a site alone */
} capsules;

/* inked: inks differ. */
/* tips.c makes them, capsules.c draws them. */
int32_t ISA(capsules_gather)(frame *f, bool inked, capsules *all);
void ISA(capsules_draw)(const capsules *all, canvas *c);
/* export.c: tells whoever asks (frame.strokes) of what is drawn; color: of all ink where it is the same. */
int32_t ISA(capsules_tell)(frame *f, const capsules *all, const float color[3]);
/* halo.c: covers what lies behind outlines, around these, in the picture. */
int32_t ISA(halos_draw)(frame *f);
/* widths.c: evens half the widths at all sites along their lines; another block of memory takes the place of theirs. */
int32_t ISA(capsules_even)(frame *f, float **radius);

/* search.c: the other ways name one edge for every pixel. */
typedef struct search {
	uint16_t *held,
		*next;  /* width * height: (dy + 32) << 6 | dx + 32 of the edge, HELD_NONE = none; not for NEAREST */
	float *blurred; /* width * height, for WALK */
	uint8_t *gap;   /* width * height, for WALK: pixels to the nearest edge pixel, the larger of dx and dy */
	float *column;  /* scratch per thread, for WALK; likewise rows */
	uint8_t *rows;
} search;

enum { HELD_NONE = UINT16_MAX };

/* Planned by any stage, it is f->search, and NULL for NEAREST, which fills f->nearest; run does nothing twice. */
void ISA(search_plan)(frame *f, arena *a);
int32_t ISA(search_run)(frame *f);

/* Whether pixels have edges that search.c holds. */
static inline bool is_held(const frame *f)
{
	return f->params->edge_detector != edge_detector_FINE && f->params->line_search != line_search_EXACT &&
	       f->params->line_search != line_search_NEAREST;
}

/* The way from a pixel to the edge held for it, or false. */
static inline bool held_at(const frame *f, size_t at, int *dx, int *dy)
{
	const search *s = f->search;
	*dx = (s->held[at] & 63) - 32;
	*dy = (s->held[at] >> 6) - 32;
	return s->held[at] != HELD_NONE;
}

#endif
