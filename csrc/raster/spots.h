/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Where the points of triangles lie on the screen. */
#ifndef ENCRE_SPOTS_H
#define ENCRE_SPOTS_H

#include "raster/geometry.h"
#include "base/bands.h"

/* Fills `spots`, which has room for all points of the geometry, and tells the parts of triangles theirs. Returns a code
 * of enum encre_code. */
int32_t spots_find(bands *pool, geometry *g, const room *room, spot *spots);

#endif
