/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Where lines, contours and creases pass between pixels. */
#ifndef ENCRE_CROSSINGS_H
#define ENCRE_CROSSINGS_H

#include "raster/raster.h"

/* Widens *y0..*y1-1 by the rows of the images in which a primitive has crossings that are drawn. */
void crossings_rows(const raster *r, const part *part, uint32_t primitive, int *y0, int *y1);
/* Draws marks and creases of band `i`, whose own rows end before `end`. f: with creases only. */
void crossings_draw(const raster *r, int i, const band *b, int end, struct flush *f);

#endif
