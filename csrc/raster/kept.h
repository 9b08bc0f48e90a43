/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What does not depend on the camera, kept from one raster job to the next: of each mesh which triangles share edges
 * and hang together, and how much the surface bends at edges. A mesh is known again by what it is made of, which is
 * compared, so that nothing kept can be of another. */
#ifndef ENCRE_KEPT_H
#define ENCRE_KEPT_H

#include "base/bands.h"
#include "raster/geometry.h"

typedef struct raster_kept raster_kept;

/* Tells the parts of triangles their topology and, if asked for, their bends, which hold until the next call. Keeps
 * what has not changed since the last, and forgets what is not there any more. *kept: NULL at first. Returns a code of
 * enum encre_code. Takes about 42 bytes a triangle, less where instances share a mesh. */
int32_t kept_find(bands *pool, geometry *g, bool bends, raster_kept **kept);
/* piece: of each primitive the running number of the first that it hangs together with, by the indices of points; two
 * meshes never do. */
void kept_pieces(const geometry *g, uint32_t *piece);
/* Gives the memory back; if it is not `all`, then only where it is much. */
void kept_free(raster_kept **kept, bool all);

#endif
