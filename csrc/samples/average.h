/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Pictures of many samples a pixel, averaged down. */
#ifndef ENCRE_AVERAGE_H
#define ENCRE_AVERAGE_H

#include "base/bands.h"

/* What encre_average() does, for a job that has been checked. */
int32_t average_run(bands *pool, const encre_average_job *job);

#endif
