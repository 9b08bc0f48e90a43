/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef ENCRE_RASTER_H
#define ENCRE_RASTER_H

#include "base/stage.h"

/* What encre_raster() does. Images and frame of the job have been checked and images have strides; meshes and matrices
 * are checked here. Returns a code of enum encre_code; `error` gets a sentence for ENCRE_ERROR_ARGUMENT only. */
int32_t raster_run(bands *pool, const encre_raster_job *job, char *error, size_t size);

#endif
