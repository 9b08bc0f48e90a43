/* SPDX-License-Identifier: GPL-3.0-or-later */
/* How a job is refused: the sentence goes to error[size], the code to the caller. And what several check. */
#ifndef ENCRE_REFUSE_H
#define ENCRE_REFUSE_H

#include "encre.h"

#include <stdbool.h>
#include <stddef.h>

/* Returns ENCRE_ERROR_ARGUMENT. The sentence names the thing and the cure. */
#if defined __GNUC__
__attribute__((format(printf, 3, 4)))
#endif
int32_t refuse(char *error, size_t size, const char *format, ...);

bool all_finite(const double *values, int n);

#endif
