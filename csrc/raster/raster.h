/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The rasteriser: what its files share. */
#ifndef ENCRE_RASTER_H
#define ENCRE_RASTER_H

#include "base/stage.h"
#include "raster/kept.h"

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
	int more;       /* rows that a band needs below its own: 1 for marks and creases */

	band_range *range;   /* of each primitive */
	size_t *place;       /* n_chunks x n_bands: how many, then where the next one goes */
	size_t *list;        /* n_bands + 1: where a band's primitives start */
	float *depth;        /* per thread (BAND + 1) x width */
	float *beyond;       /* likewise: what the job's image says; NULL: it has none */
	uint32_t *front;     /* likewise: number of the nearest primitive */
	uint32_t *twin;      /* likewise: of one that may coincide with it */
	uint32_t *entry;     /* primitives by band */
	spot *spots;         /* of the points of triangles */
	uint8_t *faces;      /* of each triangle: contours_find()'s; with marks or creases only */
	uint16_t *edges;     /* of each triangle: what contours_find() says; with marks or creases only */
	uint32_t *piece;     /* of each primitive: the first that it hangs together with; with marks or creases only */
	struct meets *meets; /* for each thread; with creases only */
	struct flush *flush; /* likewise */
} raster;

enum { BAND = 16 };              /* rows that are drawn at once */
#define NOTHING UINT32_MAX       /* number of no primitive */
#define LEAST_SHARE (1.0 / 1024) /* where a line passes: 0 is nowhere, also in half floats */

/* Whether two primitives coincide at the centre of a pixel, as outline_coincide. */
bool raster_coincide(const void *r, uint32_t one, uint32_t other, int column, int row);

/* What encre_raster() does. Images and frame of the job have been checked and images have strides; meshes and matrices
 * are checked here. *kept: as kept_find() takes it. Returns a code of enum encre_code; `error` gets a sentence for
 * ENCRE_ERROR_ARGUMENT only. */
int32_t raster_run(bands *pool, const encre_raster_job *job, raster_kept **kept, char *error, size_t size);

#endif
