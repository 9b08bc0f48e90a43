/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The boundary: the context, and the jobs that one room does by itself. Everything that comes in is checked once; rooms
 * trust what they are given. */
#include "api/check.h"
#include "api/check_light.h"
#include "api/check_material.h"
#include "api/context.h"
#include "base/cpu.h"
#include "base/refuse.h"
#include "chains/chains.h"
#include "flat/flat.h"
#include "light/handle.h"
#include "material/material.h"
#include "raster/facets.h"
#include "raster/geometry.h"
#include "raster/raster.h"
#include "samples/average.h"
#include "samples/even.h"
#include "texture/bake.h"
#include "tones/blue.h"

#include <stdio.h>
#include <stdlib.h>

enum { MAX_THREADS = 1024 };

/* ---- context --------------------------------------------------------------------------------------------- */

encre_context *encre_create(int32_t api_version)
{
	encre_context *context = api_version == ENCRE_API_VERSION ? calloc(1, sizeof *context) : NULL;
	if (context) {
		context->simd = 1;
		context->best = cpu_runs_v3();
	}
	return context;
}

void encre_destroy(encre_context *context)
{
	if (!context || context->telling)
		return;
	encre_cancel(context);
	encre_wait(context);
	bands_destroy(context->pool);
	free(context->memory.memory);
	edges_drop(&context->edges);
	free(context->edges.memory.memory);
	free(context->light.memory);
	chains_free(&context->chains);
	free(context->sheet);
	blue_drop(&context->spots);
	free(context->strokes.point);
	free(context);
}

const char *encre_error(const encre_context *context)
{
	return context ? context->error
		       : "encre: no memory for a context, or libencre has another API version; install one version of "
			 "both";
}

int32_t fail_code(encre_context *context, int32_t code)
{
	if (code == ENCRE_ERROR_MEMORY)
		snprintf(context->error, sizeof context->error,
			 "memory: this frame needs more than there is; render it smaller or in borders");
	if (code == ENCRE_ERROR_CANCELLED)
		snprintf(context->error, sizeof context->error, "cancelled");
	return code;
}

int32_t encre_set_threads(encre_context *context, int32_t threads)
{
	int32_t code = enter(context);
	if (code)
		return code;
	if (threads < 0 || threads > MAX_THREADS)
		return refuse(context->error, sizeof context->error,
			      "threads: %d is outside 0..%d; give 0 for as many as processors", (int)threads,
			      MAX_THREADS);
	if (threads != context->threads) {
		bands_destroy(context->pool);
		context->pool = NULL;
	}
	context->threads = threads;
	return ENCRE_OK;
}

int32_t encre_set_simd(encre_context *context, int32_t level)
{
	int32_t code = enter(context);
	if (code)
		return code;
	if (level < 0 || level > 1)
		return refuse(context->error, sizeof context->error,
			      "simd: level %d is outside 0..1; give 1 for the best there is", (int)level);
	context->simd = level;
	return ENCRE_OK;
}

/* Calls back for a job of the context, which is in no state to be given another one meanwhile. */
static bool told(void *data, double fraction)
{
	encre_context *context = data;
	context->telling = true;
	bool go_on = context->progress(context->user, fraction);
	context->telling = false;
	context->error[0] = 0; /* of what it has called and was refused */
	return go_on;
}

bands *pool_of(encre_context *context, encre_progress progress, void *user)
{
	if (!context->pool) {
		int n = context->threads ? context->threads : bands_processors();
		context->pool = bands_create(n < 1 ? 1 : n > MAX_THREADS ? MAX_THREADS : n);
	}
	context->progress = progress;
	context->user = user;
	if (context->pool)
		bands_progress(context->pool, progress ? told : NULL, context, context->stop);
	return context->pool;
}

bool use_best(const encre_context *context)
{
	return context->simd && context->best;
}

/* ---- raster ---------------------------------------------------------------------------------------------- */

int32_t encre_raster(encre_context *context, encre_raster_job *job)
{
	encre_raster_job clean;
	int32_t code = enter_job(context, job);
	if (!code)
		code = check_raster(job, &clean, context->error, sizeof context->error);
	if (code)
		return code;
	bands *pool = pool_of(context, job->progress, job->user);
	if (!pool)
		return fail_code(context, ENCRE_ERROR_MEMORY);
	code = raster_run(pool, &clean, context->error, sizeof context->error);
	return context->error[0] ? code : fail_code(context, code);
}

/* ---- chains ---------------------------------------------------------------------------------------------- */

int32_t encre_chains(encre_context *context, encre_chain_job *job)
{
	int32_t code = enter_job(context, job);
	if (!code)
		code = check_chains(job, context->error, sizeof context->error);
	if (code)
		return code;
	bands *pool = pool_of(context, job->progress, job->user);
	if (!pool)
		return fail_code(context, ENCRE_ERROR_MEMORY);
	code = chains_run(pool, job, use_best(context), &context->chains, context->error, sizeof context->error);
	return context->error[0] ? code : fail_code(context, code);
}

/* ---- bake ------------------------------------------------------------------------------------------------ */

int32_t encre_bake(encre_context *context, encre_bake_job *job)
{
	encre_bake_job clean;
	int32_t code = enter_job(context, job);
	if (!code)
		code = check_bake(job, &clean, context->error, sizeof context->error);
	if (code)
		return code;
	bands *pool = pool_of(context, job->progress, job->user);
	if (!pool)
		return fail_code(context, ENCRE_ERROR_MEMORY);
	code = use_best(context) ? BEST(bake_run)(pool, &clean, job) : bake_run_base(pool, &clean, job);
	return fail_code(context, code);
}

/* ---- samples --------------------------------------------------------------------------------------------- */

int32_t encre_even(encre_context *context, encre_even_job *job)
{
	encre_even_job clean;
	int32_t code = enter_job(context, job);
	if (!code)
		code = check_even(job, &clean, context->error, sizeof context->error);
	if (code)
		return code;
	bands *pool = pool_of(context, job->progress, job->user);
	if (!pool)
		return fail_code(context, ENCRE_ERROR_MEMORY);
	code = use_best(context) ? BEST(even_run)(pool, &clean) : even_run_base(pool, &clean);
	return fail_code(context, code);
}

int32_t encre_average(encre_context *context, encre_average_job *job)
{
	encre_average_job clean;
	int32_t code = enter_job(context, job);
	if (!code)
		code = check_average(job, &clean, context->error, sizeof context->error);
	if (code)
		return code;
	bands *pool = pool_of(context, job->progress, job->user);
	return fail_code(context, pool ? average_run(pool, &clean) : ENCRE_ERROR_MEMORY);
}

/* ---- light ----------------------------------------------------------------------------------------------- */

encre_scene *encre_scene_create(void)
{
	return scene_create();
}

void encre_scene_free(encre_scene *scene)
{
	scene_free(scene);
}

int32_t encre_scene_geometry(encre_context *context, encre_scene *scene, int64_t key, const encre_geometry *geometry)
{
	char *error = context->error;
	size_t size = sizeof context->error;
	int32_t code = enter(context);
	if (!code)
		code = check_free(scene, error, size);
	if (!code && geometry)
		code = check_geometry(key, geometry, error, size);
	if (!code)
		code = scene_geometry(scene, key, geometry, error, size);
	return fail_code(context, code);
}

int32_t encre_scene_instance(encre_context *context, encre_scene *scene, int64_t key, const encre_instance *instance)
{
	char *error = context->error;
	size_t size = sizeof context->error;
	int32_t code = enter(context);
	if (!code)
		code = check_free(scene, error, size);
	if (!code && instance)
		code = check_instance(key, instance, error, size);
	if (!code)
		code = scene_instance(scene, key, instance, error, size);
	return fail_code(context, code);
}

int32_t encre_scene_texture(encre_context *context, encre_scene *scene, int64_t key, const encre_texture *texture)
{
	char *error = context->error;
	size_t size = sizeof context->error;
	int32_t code = enter(context);
	if (!code)
		code = check_free(scene, error, size);
	if (!code && texture)
		code = check_texture(key, texture, error, size);
	if (!code)
		code = scene_texture(scene, key, texture);
	return fail_code(context, code);
}

int32_t encre_scene_lamp(encre_context *context, encre_scene *scene, int64_t key, const encre_lamp *lamp)
{
	char *error = context->error;
	size_t size = sizeof context->error;
	int32_t code = enter(context);
	if (!code)
		code = check_free(scene, error, size);
	if (!code && lamp)
		code = check_lamp(key, lamp, error, size);
	if (!code)
		code = scene_lamp(scene, key, lamp);
	return fail_code(context, code);
}

int32_t encre_scene_reach(encre_context *context, encre_scene *scene, int32_t n, const float *places, const float *ways,
			  int32_t shadow_set, uint8_t *reached)
{
	int32_t code = enter(context);
	if (!code)
		code = check_reach(scene, n, places, ways, shadow_set, reached, context->error, sizeof context->error);
	if (code || !n)
		return code;
	bands *pool = pool_of(context, NULL, NULL);
	code = pool ? reach_run_base(pool, scene, n, places, ways, shadow_set, reached) : ENCRE_ERROR_MEMORY;
	return fail_code(context, code);
}

int32_t encre_light(encre_context *context, encre_light_job *job)
{
	encre_light_job clean;
	int32_t code = enter_job(context, job);
	if (!code && !context->stop) /* in the background it is lit from the first step on */
		code = check_free(job->scene, context->error, sizeof context->error);
	if (!code)
		code = check_light(job, &clean, context->error, sizeof context->error);
	if (code)
		return code;
	bands *pool = pool_of(context, job->progress, job->user);
	if (!pool)
		return fail_code(context, ENCRE_ERROR_MEMORY);
	scene_light(clean.scene);
	code = use_best(context) ? BEST(light_run)(pool, &clean, &context->light)
				 : light_run_base(pool, &clean, &context->light);
	scene_leave(clean.scene);
	return fail_code(context, code);
}

/* ---- normals ----------------------------------------------------------------------------------------------- */

int32_t encre_smooth(encre_context *context, const encre_mesh *mesh, float angle, float *normals)
{
	int32_t code = enter(context);
	if (code)
		return code;
	char *error = context->error;
	size_t size = sizeof context->error;
	if (!mesh || mesh->kind != ENCRE_TRIANGLES)
		return refuse(error, size, "mesh 0: has no triangles; give a mesh of kind ENCRE_TRIANGLES");
	if ((code = geometry_check_mesh(mesh, 0, error, size)))
		return code;
	if ((uint32_t)mesh->n_primitives > UINT32_MAX / 3 || (mesh->n_primitives && !normals))
		return refuse(error, size,
			      "mesh 0: no room for normals, or too many triangles; give 9 floats a triangle");
	if (!(angle >= 0 && angle <= 3.1416f))
		return refuse(error, size, "angle: %g; give radians from 0 to pi", (double)angle);
	return fail_code(context, facets_smooth(mesh, angle, normals));
}

/* ---- materials --------------------------------------------------------------------------------------------- */

const encre_operation_description *encre_operation_info(int32_t code)
{
	return operation_info(code);
}

int32_t encre_picture_levels(encre_context *context, const encre_picture *picture, uint8_t *bytes)
{
	int32_t code = enter(context);
	if (!code)
		code = check_picture(picture, 0, context->error, sizeof context->error);
	if (!code && (!bytes || bytes != picture->bytes))
		code = refuse(context->error, sizeof context->error, "texture 0: has other bytes; give its own");
	if (!code)
		picture_levels(picture, bytes);
	return code;
}

int32_t encre_flatten(encre_context *context, const encre_picture *picture, int32_t most, void *texels)
{
	int32_t code = enter(context);
	if (!code)
		code = check_picture(picture, 0, context->error, sizeof context->error);
	if (!code && (!texels || (texels != picture->bytes && texels != picture->texels)))
		code = refuse(context->error, sizeof context->error, "texture 0: has other texels; give its own");
	if (!code && (most < 1 || most > ENCRE_MAX_FLAT))
		code = refuse(context->error, sizeof context->error, "flat colors: %d; give 1 to %d", (int)most,
			      ENCRE_MAX_FLAT);
	if (code)
		return code;
	bands *pool = pool_of(context, NULL, NULL);
	if (!pool)
		return fail_code(context, ENCRE_ERROR_MEMORY);
	code = flat_run(pool, picture, most, picture->bytes ? texels : NULL, picture->bytes ? NULL : texels);
	return fail_code(context, code);
}

int32_t encre_material(encre_context *context, encre_material_job *job)
{
	encre_material_job clean;
	int32_t code = enter_job(context, job);
	if (!code)
		code = check_material(job, &clean, context->error, sizeof context->error);
	if (code)
		return code;
	bands *pool = pool_of(context, job->progress, job->user);
	if (!pool)
		return fail_code(context, ENCRE_ERROR_MEMORY);
	code = use_best(context) ? BEST(material_draw)(pool, &clean) : material_draw_base(pool, &clean);
	return fail_code(context, code);
}

/* ---- others' functions ----------------------------------------------------------------------------------- */

int32_t encre_call(encre_context *context, encre_call_job *job)
{
	int32_t code = enter_job(context, job);
	if (code)
		return code;
	if (!job->function)
		return refuse(context->error, sizeof context->error, "function: is NULL; give one");
	context->progress = job->progress;
	context->user = job->user;
	if (job->progress && !told(context, 0))
		return fail_code(context, ENCRE_ERROR_CANCELLED);
	job->function(job->argument);
	return ENCRE_OK;
}
