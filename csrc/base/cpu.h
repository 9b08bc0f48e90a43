/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What the processor can do. */
#ifndef ENCRE_CPU_H
#define ENCRE_CPU_H

#include <stdbool.h>

/* Whether it runs what is compiled for x86-64-v3, and the system keeps its wide registers. */
bool cpu_runs_v3(void);

#endif
