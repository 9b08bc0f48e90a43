/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Four channels blurred by a tent: whole numbers, so that sums that run along rows and down columns are exact wherever
 * they begin, and bands and threads give the same bytes. */
#ifndef ENCRE_TENT_H
#define ENCRE_TENT_H

#include "base/stage.h"

enum { TENT_CHANNELS = 4, TENT_MOST = 128 /* pixels to either side */ };

/* One row of n pixels. line has `reach` + 1 pixels of room before and after, which hold the first and the last. */
void ISA(tent_row)(int n, int reach, const uint16_t *restrict line, uint16_t *restrict out);
/* Of rows that tent_row() gave, height of them: the sums of the tent about row y, three rows of sums in all; from row y
 * to the next. A sum divided by reach * reach is the blurred number. */
void ISA(tent_begin)(const uint16_t *rows, int width, int height, int reach, int y, int32_t *restrict sums);
void ISA(tent_next)(const uint16_t *rows, int width, int height, int reach, int y, int32_t *sums);

#endif
