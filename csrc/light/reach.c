/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Whether light reaches places, whatever a camera sees. */
#include "light/handle.h"
#include "light/rays.h"

typedef struct reach {
	const world *world;
	const float *places, *ways;
	int set;
	uint8_t *reached;
} reach;

static void reach_rows(void *data, int from, int to, int thread)
{
	(void)thread;
	const reach *r = data;
	hint h = HINT_NONE;
	for (ptrdiff_t i = from; i < to; i++) {
		ray one = {.from = vec_of(r->places + 3 * i),
			   .way = vec_of(r->ways + 3 * i),
			   .far = 1,
			   .instance = -1,
			   .triangle = -1,
			   .set = r->set};
		r->reached[i] = !ISA(ray_blocked)(r->world, &one, &h);
	}
}

int32_t ISA(reach_run)(bands *pool, const encre_scene *scene, int32_t n, const float *places, const float *ways,
		       int set, uint8_t *reached)
{
	world w;
	int32_t code = world_make(&w, scene, (const double[3]){0, 0, 0}, pool);
	reach r = {&w, places, ways, set, reached};
	if (!code)
		code = bands_run(pool, n, 0, reach_rows, &r);
	world_free(&w);
	return code;
}
