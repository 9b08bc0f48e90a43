/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What encre_scene_…() and encre_light() do, with arguments that have been checked but for keys. They return a code of
 * enum encre_code; `error` gets a sentence for ENCRE_ERROR_ARGUMENT only. */
#ifndef ENCRE_HANDLE_H
#define ENCRE_HANDLE_H

#include "base/arena.h"
#include "base/bands.h"

#include <stddef.h>

encre_scene *scene_create(void);
/* At once, or by scene_leave() where it is lit. */
void scene_free(encre_scene *scene);
/* Between the two, which may be nested, it is lit: nothing may change. scene_is_lit() says so. */
void scene_light(encre_scene *scene);
void scene_leave(encre_scene *scene);
bool scene_is_lit(const encre_scene *scene);
int32_t scene_geometry(encre_scene *scene, int64_t key, const encre_geometry *geometry, char *error, size_t size);
int32_t scene_instance(encre_scene *scene, int64_t key, const encre_instance *given, char *error, size_t size);
int32_t scene_texture(encre_scene *scene, int64_t key, const encre_texture *given);
int32_t scene_lamp(encre_scene *scene, int64_t key, const encre_lamp *given);
/* World -> clip space. */
void camera_product(const double view[16], const double projection[16], double both[16]);
/* Clip space -> world; false where there is none. `inverse` may be NULL. */
bool camera_inverse(const double view[16], const double projection[16], double inverse[16]);
/* Images have strides. `held` is for the next one. */
int32_t light_run_base(bands *pool, const encre_light_job *job, arena_held *held);
int32_t light_run_v3(bands *pool, const encre_light_job *job, arena_held *held);
/* As encre_scene_reach(). */
int32_t reach_run_base(bands *pool, const encre_scene *scene, int32_t n, const float *places, const float *ways,
		       int set, uint8_t *reached);

#endif
