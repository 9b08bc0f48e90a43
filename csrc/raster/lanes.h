/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Bends along one row or column of pixels (lanes.c), of which bends.c makes those of the picture. */
#ifndef ENCRE_LANES_H
#define ENCRE_LANES_H

#include "raster/bends.h"

/* Where the surface turns between two pixel centres of a lane, which is a row or a column. */
typedef struct turning {
	float share; /* of the way to the next pixel, at which it is */
	float turn;  /* degrees; negative: the surface ends */
	float edge;  /* the bend of the edge there, as in the layer */
	int32_t way;
	bool sliver; /* only some rows or columns of pixels see the face between it and where the surface ends */
} turning;

/* Edges one after the other, as which something is clearest. */
typedef struct run {
	float clear, bends; /* degrees; 0: none */
	float slant;        /* pixels across its line for each along the lane */
	int first, last;
} run;

/* Of one thread. */
typedef struct lane {
	turning *turning; /* BAND lanes of them */
	run *best;        /* of the runs that have an edge */
	bend *told;       /* by pixel */
} lane;

/* A lane while it is looked through. */
typedef struct looking {
	const bends *s;
	const turning *list;
	run *best;
	int count, axis, number, size; /* number: which row or column it is */
	bend *out;                     /* of its pixels; none is told of any to begin with */
} looking;

/* Adds the way from a pixel to the next along the axis, if anything happens there; returns how many it makes. */
int lane_note(const bends *s, int x, int y, int axis, turning *list, int count);
/* Tells pixels of the bends of a lane; returns whether there is any. */
bool lane_look(const looking *l);

#endif
