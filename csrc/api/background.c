/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Work that goes on while the caller does something else: steps that run one after the other on a thread of their own.
 * It has a context of its own, to which the caller's lends its threads, so that the two share nothing that is not
 * atomic. */
#include "api/check.h"
#include "api/check_light.h"
#include "api/context.h"
#include "base/refuse.h"
#include "light/handle.h"

#include <pthread.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

struct background {
	encre_context own;
	pthread_t thread;
	atomic_bool cancel, done;
	_Atomic float fraction;
	int32_t code; /* of the thread until it is done */
	int at, n_steps;
	encre_step steps[];
};

/* ---- on the thread --------------------------------------------------------------------------------------- */

static bool go_on(void *user, double fraction)
{
	background *b = user;
	atomic_store(&b->fraction, (float)((b->at + fraction) / b->n_steps));
	return !atomic_load(&b->cancel);
}

static int32_t run_step(encre_context *context, const encre_step *step)
{
	switch (step->kind) {
	case ENCRE_RENDER: return encre_render(context, step->job);
	case ENCRE_RASTER: return encre_raster(context, step->job);
	case ENCRE_LIGHT: return encre_light(context, step->job);
	case ENCRE_MATERIAL: return encre_material(context, step->job);
	case ENCRE_CHAINS: return encre_chains(context, step->job);
	case ENCRE_CALL: return encre_call(context, step->job);
	case ENCRE_EVEN: return encre_even(context, step->job);
	case ENCRE_AVERAGE: return encre_average(context, step->job);
	default: return encre_bake(context, step->job);
	}
}

static void *background_main(void *data)
{
	background *b = data;
	for (b->at = 0; !b->code && b->at < b->n_steps; b->at++) {
		void **user;
		encre_progress *progress = step_progress(b->steps + b->at, &user);
		void *before = *user;
		*progress = go_on;
		*user = b;
		/* one that was cancelled between two steps must not begin the next */
		b->code = go_on(b, 0) ? run_step(&b->own, b->steps + b->at) : fail_code(&b->own, ENCRE_ERROR_CANCELLED);
		*progress = NULL;
		*user = before;
	}
	atomic_store(&b->done, true);
	return NULL;
}

/* ---- on the caller's ------------------------------------------------------------------------------------- */

int32_t enter(encre_context *context)
{
	if (!context)
		return ENCRE_ERROR_ARGUMENT;
	if (context->telling) /* whose caller may read this before it is forgotten */
		return refuse(context->error, sizeof context->error,
			      "context: its own progress calls it; return from that, or take another context");
	if (context->background) /* whose sentence stands in its own context */
		return refuse(context->error, sizeof context->error,
			      "context: its work in the background goes on; wait for it, or take another context");
	context->error[0] = 0;
	return ENCRE_OK;
}

int32_t enter_job(encre_context *context, const void *job)
{
	int32_t code = enter(context);
	return code || job ? code : refuse(context->error, sizeof context->error, "job: is NULL; give one");
}

/* Of a step that lights one; else NULL. */
static encre_scene *scene_of(const encre_step *step)
{
	return step->kind == ENCRE_LIGHT ? ((const encre_light_job *)step->job)->scene : NULL;
}

static void light_scenes(background *b, void (*change)(encre_scene *))
{
	for (int i = 0; i < b->n_steps; i++)
		if (scene_of(b->steps + i))
			change(scene_of(b->steps + i));
}

int32_t encre_start(encre_context *context, const encre_step *steps, int32_t n_steps)
{
	int32_t code = enter(context);
	if (!code)
		code = check_steps(steps, n_steps, context->error, sizeof context->error);
	for (int i = 0; !code && i < n_steps; i++)
		if (scene_of(steps + i))
			code = check_free(scene_of(steps + i), context->error, sizeof context->error);
	if (code)
		return code;
	size_t size = (size_t)n_steps * sizeof *steps;
	background *b = calloc(1, sizeof *b + size);
	if (!b)
		return fail_code(context, ENCRE_ERROR_MEMORY);
	memcpy(b->steps, steps, size);
	b->n_steps = n_steps;
	b->own = *context;
	b->own.stop = &b->cancel;
	light_scenes(b, scene_light);
	if (pthread_create(&b->thread, NULL, background_main, b)) {
		light_scenes(b, scene_leave);
		free(b);
		snprintf(context->error, sizeof context->error,
			 "memory: no thread can be started; close other programs");
		return ENCRE_ERROR_MEMORY;
	}
	context->background = b;
	context->pool = NULL;
	return ENCRE_OK;
}

int32_t encre_poll(encre_context *context, double *fraction)
{
	background *b = context ? context->background : NULL;
	if (fraction)
		*fraction = b ? (double)atomic_load(&b->fraction) : 1;
	return b && !atomic_load(&b->done) ? ENCRE_RUNNING : encre_wait(context);
}

void encre_cancel(encre_context *context)
{
	if (context && context->background)
		atomic_store(&context->background->cancel, true);
}

int32_t encre_wait(encre_context *context)
{
	background *b = context ? context->background : NULL;
	if (!b)
		return context ? context->ended : ENCRE_ERROR_ARGUMENT;
	pthread_join(b->thread, NULL);
	b->own.ended = b->code;
	b->own.stop = NULL;
	light_scenes(b, scene_leave);
	*context = b->own;
	free(b);
	return context->ended;
}
