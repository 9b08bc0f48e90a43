/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The checks of material jobs: programs that pass read and write nothing but what is theirs. */
#ifndef ENCRE_CHECK_MATERIAL_H
#define ENCRE_CHECK_MATERIAL_H

#include "encre.h"

#include <stddef.h>

/* Returns ENCRE_OK, or ENCRE_ERROR_ARGUMENT and one sentence in error[size]. `clean` gets the job with strides filled
 * in. */
/* Refuses a picture that programs can't look into; number: by which it is named. */
int32_t check_picture(const encre_picture *t, int number, char *error, size_t size);
int32_t check_material(const encre_material_job *job, encre_material_job *clean, char *error, size_t size);

#endif
