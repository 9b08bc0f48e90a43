/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Normals of facets as of one smooth surface. */
#ifndef ENCRE_FACETS_H
#define ENCRE_FACETS_H

#include "encre.h"

/* As encre_smooth(), of a mesh that is checked. ENCRE_ERROR_MEMORY without it: what topology_find() takes, 8 bytes a
 * corner and 6 a triangle. */
int32_t facets_smooth(const encre_mesh *mesh, float angle, float *normals);

#endif
