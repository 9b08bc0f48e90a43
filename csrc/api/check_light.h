/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The checks of scenes and of their light. They return ENCRE_OK, or ENCRE_ERROR_ARGUMENT and one sentence in
 * error[size]. Whether keys are there is for the scene to say. */
#ifndef ENCRE_CHECK_LIGHT_H
#define ENCRE_CHECK_LIGHT_H

#include "encre.h"

#include <stddef.h>

int32_t check_scene(const encre_scene *scene, char *error, size_t size);
/* Likewise, and that it is not being lit. */
int32_t check_free(const encre_scene *scene, char *error, size_t size);
int32_t check_geometry(int64_t key, const encre_geometry *g, char *error, size_t size);
int32_t check_texture(int64_t key, const encre_texture *t, char *error, size_t size);
int32_t check_instance(int64_t key, const encre_instance *in, char *error, size_t size);
int32_t check_lamp(int64_t key, const encre_lamp *lamp, char *error, size_t size);
int32_t check_reach(const encre_scene *scene, int32_t n, const float *places, const float *ways, int32_t shadow_set,
		    const uint8_t *reached, char *error, size_t size);
/* `clean` gets the job with strides filled in. */
int32_t check_light(const encre_light_job *job, encre_light_job *clean, char *error, size_t size);

#endif
