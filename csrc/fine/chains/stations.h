/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Places along chains of mesh edges, on which it is decided what of them is a line and how wide. */
#ifndef ENCRE_STATIONS_H
#define ENCRE_STATIONS_H

#include "fine/near.h"

/* Of two lines that lie close the more important one stays: a boundary is one of numbers, or where surfaces pass
 * through each other. */
enum importance { IMPORTANCE_COLOR, IMPORTANCE_CREASE, IMPORTANCE_BOUNDARY, IMPORTANCE_MARK, IMPORTANCE_CONTOUR };

/* What is true of a station. */
enum {
	STATION_NONE = 1,   /* it is no line: it bends too little, or its style draws none */
	STATION_WEAK = 2,   /* it is one only where it goes on from one that is not weak */
	STATION_ADDED = 4,  /* a corner or an end, between those that lie evenly: it counts for no other line */
	STATION_HIDDEN = 8, /* the layers show something else there */
	STATION_FIRST = 16, /* of its run */
	STATION_LAST = 32,
	STATION_CLOSED = 64, /* the first or last of a run that goes round */
	STATION_TIED = 128,  /* the first or last, where the run meets others */
};

typedef struct station {
	double x, y;  /* pixels of the full frame */
	float dx, dy; /* the way of its run, of length 1 */
	float s;      /* pixels along the run */
	float depth, bend, over, fade, gap, along;
	float growth; /* 0..1: what bends hardly more than asked is thinner */
	float solid;  /* likewise, for all reasons but other lines */
	float keep;   /* 0..1: what is left of its width */
	float apart,
		across; /* pixels to the other contour of the thing that it bounds: evened along the run, and there */
	float sine, tapers; /* of the angle with that contour; how much the thing comes to a tip, 0..1 */
	float strength;
	int32_t mesh, edge, object, behind, run, kind;
	int32_t color[2];
	uint16_t near_x, near_y; /* of the image: where it takes its controls */
	int8_t side;
	uint8_t importance, source, flags;
	bool agrees, tells; /* the layers show what it is of; whether they can tell */
} station;

/* Pixels from station to station. */
static const float station_step = 0.75f;

/* Stations by square cells of the full frame, so that a part of it has the same ones; in each at most so many, the most
 * important ones. Those of the cells of a row lie one after the other, with what is asked of all that are near. */
typedef struct station_grid {
	int across, tall;
	float cell;  /* pixels */
	double x, y; /* of the first cell, in the full frame */
	uint32_t most;
	uint32_t *first;          /* by cell, and one more */
	uint32_t *station;        /* which one it is */
	float *px, *py, *dx, *dy; /* its place, from that of the first cell, and its way */
	float *importance;
} station_grid;

typedef struct stations {
	fine *n;
	float px; /* pixels of a px */
	const encre_chain_point *point;
	int64_t points;
	int32_t runs;
	float least_bend[2]; /* degrees, of an edge and of one that is shaded smoothly, that are a line in any style */
	int64_t (
		*run)[2]; /* by run: its first point, and the first after it; what is no line in any style parts them */
	uint32_t *first;  /* by run, and one more: its first station */
	uint32_t count;
	station *at;
	station_grid grid;
	float *mean; /* scratch, by station */
} stations;

/* Called for runs or stations, a band at a time. */
enum { RUN_CHUNK = 16, STATION_CHUNK = 512 };

/* stations.c: finds all, and what each would be by itself. */
int32_t ISA(stations_make)(stations *s);
/* agreement.c: finds those at which the layers show something else, along whole stretches. */
int32_t ISA(stations_compare)(stations *s);
/* spacing.c: the grid; how thin things are; and how much of lines is left where many lie close. */
int32_t ISA(stations_sort)(stations *s);
int32_t ISA(stations_measure)(stations *s);
int32_t ISA(stations_thin_out)(stations *s);
/* Half the width that a line of a thin thing may have. */
float ISA(station_radius)(const stations *s, const station *t);
/* inhibitor.c: what gives way to lines beside it. */
int32_t ISA(stations_give_way)(stations *s);
/* smooth.c: moves those of round forms with few faces onto curves. The grid keeps where they were. */
int32_t ISA(stations_smooth)(stations *s);
/* gaps.c: how far an outline keeps off what lies behind it; of a place on its edge. */
void ISA(gap_of)(const stations *s, const station *t, chain_site *of);
/* replaced.c: what pixels do not make, as chains tell it. */
int32_t ISA(chains_replace)(stations *s);
/* fragments.c: drops what is left and spans too little. */
int32_t ISA(stations_drop_fragments)(stations *s);

static inline bool is_drawn(const station *t)
{
	return !(t->flags & (STATION_NONE | STATION_HIDDEN));
}

/* Whether the same thing goes on behind the contour. */
static inline bool is_folded(const station *t)
{
	return t->behind == t->object && t->side;
}

static inline int grid_index(double at, double from, float cell, int count)
{
	return clamp_index((int)((at - from) / (double)cell), count);
}

/* Rows of cells that a strip through a place touches; members from .. end - 1 of a row are near. */
typedef struct station_rows {
	int row, last;
	double x, y;         /* the place */
	float dx, dy;        /* the way to which the strip is square */
	float across, along; /* pixels from the place to its ends and sides */
	uint32_t from, end;
} station_rows;

static inline station_rows rows_beside(const station_grid *g, double x, double y, const station *way, float across,
				       float along)
{
	float tall = fabsf(way->dx) * across + fabsf(way->dy) * along;
	return (station_rows){.row = grid_index(y - (double)tall, g->y, g->cell, g->tall),
			      .last = grid_index(y + (double)tall, g->y, g->cell, g->tall),
			      .x = x,
			      .y = y,
			      .dx = way->dx,
			      .dy = way->dy,
			      .across = across,
			      .along = along};
}

static inline bool next_row(const station_grid *g, station_rows *w)
{
	if (w->row > w->last)
		return false;
	float top = (float)(g->y + (double)w->row * (double)g->cell - w->y), low = -w->across, high = w->across,
	      way = fabsf(w->dx), side = w->along * fabsf(w->dy), room = 0.01f; /* pixels, for rounding */
	/* those beyond the grid are in its outermost cells */
	if (way > 0.01f && w->row > 0 && w->row < g->tall - 1) {
		low = max(low, (top - side - room) / way);
		high = min(high, (top + g->cell + side + room) / way);
	}
	float lean = w->dx > 0 ? -w->dy : w->dy, wide = w->along * fabsf(w->dx) + room;
	float left = min(lean * low, lean * high) - wide, right = max(lean * low, lean * high) + wide;
	const uint32_t *first = g->first + (size_t)w->row++ * (size_t)g->across;
	w->from = first[grid_index(w->x + (double)left, g->x, g->cell, g->across)];
	w->end = first[grid_index(w->x + (double)right, g->x, g->cell, g->across) + 1];
	return true;
}

#endif
