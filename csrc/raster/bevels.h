/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Bends that are spread over several faces. */
#ifndef ENCRE_BEVELS_H
#define ENCRE_BEVELS_H

#include "raster/raster.h"

/* Adds to the creases of a job, when all its bands are drawn, where it has normals and object numbers as well. */
int32_t bevels_draw(bands *pool, const encre_raster_job *job);

#endif
