/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Rays that go through one shaft, side by side: what one of them meets is asked of all at once, by the arithmetic of
 * local.h. */
#ifndef ENCRE_PACK_H
#define ENCRE_PACK_H

#include "light/shaft.h"

enum { PACK = 8 };

typedef struct vecs {
	float x[PACK], y[PACK], z[PACK];
} vecs;

typedef struct pack {
	vecs from, way; /* as of a ray, in the world */
	float far;
	int32_t instance[PACK], triangle[PACK], start[PACK]; /* start: as of a shaft, of each */
	int set;
} pack;

/* As ray_blocked() of each ray of which `asked` has a bit: the bits of those that are. s, through which rays go
 * where they fit, may be NULL. */
unsigned ISA(pack_blocked)(shaft *s, const world *w, const pack *p, unsigned asked);

static inline vec lane(const vecs *of, int k)
{
	return (vec){of->x[k], of->y[k], of->z[k]};
}

static inline void put_lane(vecs *to, int k, vec a)
{
	to->x[k] = a.x;
	to->y[k] = a.y;
	to->z[k] = a.z;
}

#endif
