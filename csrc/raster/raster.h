/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The rasteriser: what its files share. */
#ifndef ENCRE_RASTER_H
#define ENCRE_RASTER_H

#include "base/stage.h"
#include "raster/geometry.h"

typedef struct band_range {
	uint16_t first, end;
} band_range;

typedef struct raster {
	const encre_raster_job *job;
	const bands *pool;
	geometry geometry;
	int width, height; /* of the images */
	room room;
	int n_bands, n_chunks;
	uint32_t chunk; /* primitives in a chunk */
	float close;    /* depths less apart may be of surfaces that coincide */

	band_range *range; /* of each primitive */
	size_t *place;     /* n_chunks x n_bands: how many, then where the next one goes */
	size_t *list;      /* n_bands + 1: where a band's primitives start */
	float *depth;      /* per thread BAND x width */
	float *beyond;     /* likewise: what the job's image says; NULL: it has none */
	uint32_t *front;   /* likewise: number of the nearest primitive */
	uint32_t *twin;    /* likewise: of one that may coincide with it */
	uint32_t *entry;   /* primitives by band */
	spot *spots;       /* of the points of triangles */
} raster;

enum { BAND = 16 };        /* rows that are drawn at once */
#define NOTHING UINT32_MAX /* number of no primitive */
/* What encre_raster() does. Images and frame of the job have been checked and images have strides; meshes and matrices
 * are checked here. Returns a code of enum encre_code; `error` gets a sentence for ENCRE_ERROR_ARGUMENT only. */
int32_t raster_run(bands *pool, const encre_raster_job *job, char *error, size_t size);

#endif
