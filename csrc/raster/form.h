/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Which way a surface bends. */
#ifndef ENCRE_FORM_H
#define ENCRE_FORM_H

#include <stdbool.h>

/* The direction in which a resting triangle bends most, by how its normals (of the three corners; NULL: flat) turn from
 * corner to corner; as long as it bends that way alone: 1 of a cylinder, 0 of a sphere, a plane or an even saddle. */
void form_of(float rest[3][3], const float *normals, float form[3]);

#endif
