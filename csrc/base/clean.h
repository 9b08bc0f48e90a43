/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Layers as stages may trust them: finite (an infinite depth is none), controls within -1..1, pixels side by side. Most
 * are so already, and are read where they lie: all that it takes is a look at them. */
#ifndef ENCRE_CLEAN_H
#define ENCRE_CLEAN_H

#include "base/stage.h"

/* Pixels lie next to each other: stages can read or write the caller's memory. */
static inline bool packed(const encre_image *image)
{
	return image->pixel_stride == 4 * (int64_t)image->channels;
}

typedef struct cleaner {
	/* Adds to *bad how many values of row y are NaN or infinite. False if the layer must be copied
	 * before stages can read it. */
	bool (*look)(const encre_image *image, int layer, int y, int64_t *bad);
	/* Writes a copy in which these values are 0 and controls lie in -1..1, and counts likewise; depth stays as it
	 * is. Returns ENCRE_OK or ENCRE_ERROR_CANCELLED. */
	int32_t (*copy)(bands *pool, const encre_image *image, int layer, const encre_image *to, int64_t *bad);
} cleaner;

extern const cleaner cleaner_base, cleaner_v3;

#endif
