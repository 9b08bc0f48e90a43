/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Bands of rows on a small pool of threads. */
#ifndef ENCRE_BANDS_H
#define ENCRE_BANDS_H

#include "encre.h"

#include <stdatomic.h>

typedef struct bands bands;
/* Works on rows y0..y1-1 and writes only these. thread is 0..bands_threads()-1, for per-thread scratch. */
typedef void (*bands_kernel)(void *data, int y0, int y1, int thread);

/* How many threads this process may run at once; less than 1 where the machine does not say. */
int bands_processors(void);
/* NULL without memory. Threads that can't be started are done without. */
bands *bands_create(int threads);
void bands_destroy(bands *pool);
int bands_threads(const bands *pool);
/* From now on finished bands are reported to `call` (may be NULL); takes back a cancellation. *stop (may be NULL), once
 * true, cancels as well, and sooner: a call may be slow, and so is not made for every row. */
void bands_progress(bands *pool, encre_progress call, void *user, const atomic_bool *stop);
/* Asked by kernels and what one thread does alone, every few hundredths of a millisecond: once it is true they return
 * at once, as nobody will look at what they make. */
bool bands_stopped(const bands *pool);
/* The share of the whole that each following bands_run reports. */
void bands_span(bands *pool, double from, double to);
/* Cuts 0..height-1 into bands of `band` rows (0 = a good height) and runs the kernel on all. Returns ENCRE_OK or
 * ENCRE_ERROR_CANCELLED; after a cancellation it does nothing more. Must not be called from a kernel. */
int32_t bands_run(bands *pool, int height, int band, bands_kernel kernel, void *data);
/* Between pieces of what one thread must do alone: reports where the work stands. Returns as bands_run() does; not to
 * be called from a kernel either. */
int32_t bands_poll(bands *pool);

#endif
