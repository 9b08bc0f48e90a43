/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Solid noise where sites are on their things. */
#ifndef ENCRE_NOISE_H
#define ENCRE_NOISE_H

#include "fine/fine.h"

/* By site, where it is on its thing at rest, and how long a "px" of a length is there. */
typedef struct spots {
	float *x, *y, *z, *unit;
} spots;

static inline spots spots_from(const spots *all, size_t first)
{
	return all->x ? (spots){all->x + first, all->y + first, all->z + first, all->unit + first} : *all;
}

/* Of n sites. */
void ISA(spots_fill)(const frame *f, const site *s, int n, const spots *to);
/* Noise of mean 0 and variance 1 at n spots, of a wavelength of so many "px", 0 for none. */
void ISA(solid_row)(const spots *at, int n, const float *length, const uint32_t *seed, float *noise);

#endif
