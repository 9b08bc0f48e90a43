/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Which triangles of a mesh hang together. */
#ifndef ENCRE_PIECES_H
#define ENCRE_PIECES_H

#include "raster/geometry.h"
#include "base/stage.h"

/* piece: of each primitive the running number of the first that it hangs together with, by the indices of points; two
 * meshes never do. Returns a code of enum encre_code. Takes 8 bytes a point of the meshes that are looked through at
 * once, one by each thread. */
int32_t pieces_find(bands *pool, const geometry *g, uint32_t *piece);

#endif
