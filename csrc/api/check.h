/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The checks of jobs. They return ENCRE_OK, or ENCRE_ERROR_ARGUMENT and one sentence in error[size]. */
#ifndef ENCRE_CHECK_H
#define ENCRE_CHECK_H

#include "encre.h"

#include <stddef.h>

int32_t check_frame(const encre_frame *f, int width, int height, char *error, size_t size);
/* Images, parameters, frame and camera. `in` and `out` get the job's images with strides filled in. */
int32_t check_job(const encre_job *job, encre_image in[ENCRE_LAYER_COUNT], encre_image out[ENCRE_OUTPUT_COUNT],
		  char *error, size_t size);
/* Images and frame: meshes and matrices are geometry_check()'s. `clean` gets the job with strides filled in. */
int32_t check_raster(const encre_raster_job *job, encre_raster_job *clean, char *error, size_t size);
/* Size and frame, likewise. */
int32_t check_chains(const encre_chain_job *job, char *error, size_t size);
/* Likewise, and the parameters. */
/* check_samples.c */
int32_t check_even(const encre_even_job *job, encre_even_job *clean, char *error, size_t size);
int32_t check_average(const encre_average_job *job, encre_average_job *clean, char *error, size_t size);
int32_t check_bake(const encre_bake_job *job, encre_bake_job *clean, char *error, size_t size);
/* Steps and that their jobs leave progress alone: what else a job says is checked at its turn. */
int32_t check_steps(const encre_step *steps, int32_t n_steps, char *error, size_t size);
/* Where the job of a step, of a known kind, has its progress, and the user of it. */
encre_progress *step_progress(const encre_step *step, void ***user);

#endif
