/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Chords of a lamp, as it is seen from a place, and where on them what is hidden of it ends. */
#ifndef ENCRE_CHORDS_H
#define ENCRE_CHORDS_H

#include "light/light.h"

enum { CHORDS = 7 /* at most */ };

/* A lamp as a square, or disc, of half width 1 about 0: `across` goes to where it is seen, `along` runs with the line.
 */
typedef struct view {
	const light *light;
	const surface *at;
	rays *from;
	float across[2], along[2]; /* in the lamp's own coordinates */
	bool square, folded; /* folded: it is two straight lines, by place and slope at `corner`, not one that bends */
	float enough, corner[2], slope[2];
	float point[LAMP_FIRST][2];       /* across and along */
	float cut[CHORDS], chord[CHORDS]; /* where the line crosses, and where along it */
} view;

/* A place by where it is across and along. */
typedef struct spot {
	float across, along;
} spot;

/* From where to where on a chord the lamp is. */
void ISA(chord_ends)(const view *w, float along, float *low, float *high);
/* The bits of places that are seen, of at most PACK. */
unsigned ISA(spots_seen)(const view *w, const spot *of, int count);
/* Finds where on a chord what is hidden ends, most likely within `wide` of `guess`; false if nowhere. */
bool ISA(cross_chord)(view *w, int k, float along, float guess, float wide);

#endif
