/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef ENCRE_CLEAN_H
#define ENCRE_CLEAN_H

#include "base/stage.h"

/* Pixels lie next to each other: stages can read or write the caller's memory. */
static inline bool packed(const encre_image *image)
{
	return image->pixel_stride == 4 * (int64_t)image->channels;
}

/* Adds how many values of a layer are NaN or infinite (an infinite depth is none) to *bad, and tells in *copy whether
 * stages need a copy: values to be cleaned, or pixels apart. Returns ENCRE_OK or ENCRE_ERROR_CANCELLED. */
int32_t clean_scan(bands *pool, const encre_image *image, int layer, int64_t *bad, bool *copy);
/* Writes a copy in which these values are 0 and controls lie in -1..1, and counts likewise; depth stays as it is. */
int32_t clean_copy(bands *pool, const encre_image *image, int layer, const encre_image *to, int64_t *bad);

#endif
