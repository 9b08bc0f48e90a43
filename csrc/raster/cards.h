/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The output `card`: a place on a sheet that goes with the object's origin. */
#ifndef ENCRE_CARDS_H
#define ENCRE_CARDS_H

#include "raster/geometry.h"

/* Fills `card` of all parts. */
void cards_stand(geometry *g);
/* Pixel x, y of the output; NULL: nothing is there. */
void cards_draw(const encre_raster_job *job, const part *part, int x, int y);

#endif
