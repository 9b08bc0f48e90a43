/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "api/check_light.h"
#include "api/check.h"
#include "api/images.h"
#include "base/refuse.h"
#include "light/handle.h"

#include <float.h>
#include <math.h>
#include <stdbool.h>

int32_t check_scene(const encre_scene *scene, char *error, size_t size)
{
	return scene ? ENCRE_OK : refuse(error, size, "scene: is NULL; make one with encre_scene_create()");
}

int32_t check_free(const encre_scene *scene, char *error, size_t size)
{
	int32_t code = check_scene(scene, error, size);
	return code || !scene_is_lit(scene)
		       ? code
		       : refuse(error, size, "scene: is being lit; wait for that, or take another scene");
}

int32_t check_geometry(int64_t key, const encre_geometry *g, char *error, size_t size)
{
	long long name = (long long)key;
	if (g->n_points < 0 || g->n_triangles < 0 || g->n_triangles > INT32_MAX / 16)
		return refuse(error, size, "geometry %lld: %d triangles of %d points; give 0 to %d of them", name,
			      (int)g->n_triangles, (int)g->n_points, INT32_MAX / 16);
	if (g->n_triangles && (!g->points || !g->corners))
		return refuse(error, size, "geometry %lld: has triangles, but no points or corners; give them", name);
	if (!g->uvs != !g->textures)
		return refuse(error, size, "geometry %lld: has %s; give both or none", name,
			      g->uvs ? "uvs without textures" : "textures without uvs");
	const void *arrays[] = {g->points, g->corners, g->normals, g->uvs, g->textures};
	for (int i = 0; i < 5; i++)
		if ((uintptr_t)arrays[i] % NUMBER)
			return refuse(error, size,
				      "geometry %lld: one of its arrays begins at an address that is no multiple of "
				      "%d; copy it to one that is",
				      name, (int)NUMBER);
	for (int64_t i = 0; i < 3 * (int64_t)g->n_triangles; i++)
		if ((uint32_t)g->corners[i] >= (uint32_t)g->n_points)
			return refuse(error, size,
				      "geometry %lld: triangle %d has a corner at point %d of %d; give indices from 0 "
				      "to the number of points less one",
				      name, (int)(i / 3), (int)g->corners[i], (int)g->n_points);
	return ENCRE_OK;
}

int32_t check_texture(int64_t key, const encre_texture *t, char *error, size_t size)
{
	long long name = (long long)key;
	if (t->width < 1 || t->height < 1 || t->width > ENCRE_MAX_TEXELS || t->height > ENCRE_MAX_TEXELS)
		return refuse(error, size, "texture %lld: %d x %d texels; give 1 to %d", name, (int)t->width,
			      (int)t->height, (int)ENCRE_MAX_TEXELS);
	if (t->extension < ENCRE_REPEAT || t->extension > ENCRE_CLIP || t->closest < 0 || t->closest > 1)
		return refuse(error, size, "texture %lld: extension is %d and closest %d; give 0 to 2, and 0 or 1",
			      name, (int)t->extension, (int)t->closest);
	return t->alpha ? ENCRE_OK : refuse(error, size, "texture %lld: has no alpha; give its texels", name);
}

int32_t check_instance(int64_t key, const encre_instance *in, char *error, size_t size)
{
	if (in->camera < 0 || in->camera > 1)
		return refuse(error, size, "instance %lld: camera is %d; give 0 or 1", (long long)key, (int)in->camera);
	return ENCRE_OK;
}

int32_t check_lamp(int64_t key, const encre_lamp *lamp, char *error, size_t size)
{
	const struct {
		const char *name;
		float value, least, most;
	} ranges[] = {
		{"width", lamp->width, 0, lamp->type == ENCRE_SUN ? 3.1416f : FLT_MAX},
		{"height", lamp->height, 0, FLT_MAX},
		{"spot_angle", lamp->spot_angle, 0, 3.1416f},
		{"spot_blend", lamp->spot_blend, 0, 1},
		{"spread", lamp->spread, 0, 3.1416f},
		{"light_set", (float)lamp->light_set, 0, 63},
		{"shadow_set", (float)lamp->shadow_set, 0, 63},
		{"shadows", (float)lamp->shadows, 0, 1},
		{"flat", (float)lamp->flat, 0, 1},
	};
	long long name = (long long)key;
	if (lamp->type < ENCRE_SUN || lamp->type > ENCRE_ELLIPSE)
		return refuse(error, size, "lamp %lld: type %d is not known; give one of enum encre_lamp_type", name,
			      (int)lamp->type);
	for (size_t i = 0; i < sizeof ranges / sizeof *ranges; i++)
		if (!(ranges[i].value >= ranges[i].least && ranges[i].value <= ranges[i].most))
			return refuse(error, size, "lamp %lld: %s is %g; give %g to %g", name, ranges[i].name,
				      (double)ranges[i].value, (double)ranges[i].least, (double)ranges[i].most);
	if (!isfinite(lamp->color[0]) || !isfinite(lamp->color[1]) || !isfinite(lamp->color[2]))
		return refuse(error, size, "lamp %lld: its color is not finite; give finite numbers", name);
	return all_finite(lamp->model, 16)
		       ? ENCRE_OK
		       : refuse(error, size, "lamp %lld: its model is not finite; give it another place", name);
}

int32_t check_reach(const encre_scene *scene, int32_t n, const float *places, const float *ways, int32_t shadow_set,
		    const uint8_t *reached, char *error, size_t size)
{
	int32_t code = check_free(scene, error, size);
	if (code)
		return code;
	if (n < 0 || n > INT32_MAX / 16 || shadow_set < 0 || shadow_set > 63)
		return refuse(error, size, "reach: %d places, shadow_set %d; give 0 to %d of them, and 0 to 63", (int)n,
			      (int)shadow_set, INT32_MAX / 16);
	if (n && (!places || !ways || !reached || (uintptr_t)places % NUMBER || (uintptr_t)ways % NUMBER))
		return refuse(error, size,
			      "reach: an array is NULL or begins at an address that is no multiple of %d; "
			      "give the places, the ways, and memory for the answers",
			      (int)NUMBER);
	return ENCRE_OK;
}

static int32_t check_bends(const encre_light_job *job, char *error, size_t size)
{
	if (job->n_bends < 0 || job->n_bends > ENCRE_MAX_BENDS || (job->n_bends && !job->bends))
		return refuse(error, size, "bends: %d ellipsoids; give 0 to %d", (int)job->n_bends, ENCRE_MAX_BENDS);
	for (int k = 0; k < job->n_bends; k++) {
		const encre_bend *b = job->bends + k;
		if (!all_finite(b->model, 16) || !(b->amount >= 0 && b->amount <= 1) || !(b->fade >= 0 && b->fade <= 1))
			return refuse(error, size,
				      "bends: ellipsoid %d has a matrix that is not finite, or an amount or fade not "
				      "from 0 to "
				      "1; give it another place or number",
				      k);
	}
	return ENCRE_OK;
}

int32_t check_light(const encre_light_job *job, encre_light_job *clean, char *error, size_t size)
{
	enum { INPUTS = 4, IMAGES = 6 };
	const encre_layer_description what[IMAGES] = {{"depth", "", 1, 1},   {"normal", "", 3, 0},
						      {"shine", "", 6, 0},   {"turned", "", 3, 0},
						      {"diffuse", "", 3, 1}, {"specular", "", 3, 0}};
	const encre_image *images[IMAGES] = {&job->depth,  &job->normal,  &job->shine,
					     &job->turned, &job->diffuse, &job->specular};
	*clean = *job;
	encre_image *cleaned[IMAGES] = {&clean->depth,  &clean->normal,  &clean->shine,
					&clean->turned, &clean->diffuse, &clean->specular};
	int width = job->diffuse.width, height = job->diffuse.height;
	int32_t code = check_scene(job->scene, error, size);
	if (!code)
		code = check_images(IMAGES, INPUTS, what, images, cleaned, width, height, error, size);
	if (!code)
		code = check_frame(&job->frame, width, height, error, size);
	if (!code)
		code = check_bends(job, error, size);
	for (int k = 0; !code && k < 27; k++)
		if (!isfinite(job->world[k]))
			code = refuse(error, size, "world: its light is not finite; give finite numbers");
	if (!code &&
	    (!all_finite(job->view, 16) || !all_finite(job->projection, 16) || !all_finite(&job->clip_start, 1) ||
	     isnan(job->clip_end) || !camera_inverse(job->view, job->projection, NULL)))
		code = refuse(error, size,
			      "camera: a matrix or clip distance is not finite, or its matrices have no inverse; give "
			      "the camera another place or lens");
	return code;
}
