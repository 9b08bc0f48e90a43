/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What a context holds, and how the jobs of all kinds take threads and kernels from it. */
#ifndef ENCRE_CONTEXT_H
#define ENCRE_CONTEXT_H

#include "api/same.h"
#include "base/stage.h"

typedef struct background background;

struct encre_context {
	int32_t threads, simd;
	bool best;   /* the processor runs BEST(); asked once, which takes tens of microseconds in a virtual machine */
	bands *pool; /* NULL until needed, or after a change of threads */
	background *background;  /* NULL: nothing goes on */
	const atomic_bool *stop; /* of work in the background: true ends it. NULL: it is the caller that works */
	int32_t ended;           /* with which code the last that went on has ended */
	encre_progress progress; /* of the job that runs, and whether it is being called just now */
	void *user;
	bool telling;
	arena_held memory;          /* of the last picture, for the next */
	kept_edges edges;           /* likewise */
	arena_held light;           /* likewise, of the last light */
	struct kept_shapes *chains; /* likewise, of meshes and their lines */
	void *sheet;                /* paper, likewise */
	void *spots;                /* places of spots, likewise */
	drawn_strokes strokes;      /* of the last picture for which they were asked */
	char error[512];
};

/* What each function of a context begins with: refuses while work goes on in the background and from within the
 * context's own progress, and forgets the last error. */
int32_t enter(encre_context *context);
/* Likewise, of one that takes a job. */
int32_t enter_job(encre_context *context, const void *job);

/* The kernels for the best instructions that this build has; use_best() tells whether to run them. */
#ifdef ENCRE_HAVE_V3
#define BEST(name) JOIN(name, v3)
#else
#define BEST(name) JOIN(name, base)
#endif

bool use_best(const encre_context *context);
/* The threads, which will report to `progress`; NULL without memory. */
bands *pool_of(encre_context *context, encre_progress progress, void *user);
/* `code`, with the sentence of those codes that have always the same. */
int32_t fail_code(encre_context *context, int32_t code);

#endif
