/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What a caller may get wrong, found before anything runs. */
#include "api/check.h"
#include "api/images.h"
#include "base/refuse.h"
#include "base/stage.h"
#include "raster/outline.h"

#include <float.h>
#include <math.h>

enum { MAX_STYLES = 256 };
_Static_assert((int)MAX_SIZE <= (int)OUTLINE_FRAME && MAX_SIZE <= UINT16_MAX + 1, "coordinates have 16 bits");

/* ---- frame and camera ------------------------------------------------------------------------------------ */

int32_t check_frame(const encre_frame *f, int width, int height, char *error, size_t size)
{
	if (f->width < 1 || f->height < 1 || f->width > MAX_SIZE || f->height > MAX_SIZE)
		return refuse(error, size, "frame: is %d x %d pixels; give 1 to %d each way", (int)f->width,
			      (int)f->height, MAX_SIZE);
	if (f->x < 0 || f->y < 0 || f->x > f->width - width || f->y > f->height - height)
		return refuse(error, size,
			      "frame: %d x %d pixels at %d, %d do not lie in a frame of %d x %d; give the full frame "
			      "and the place of the images in it",
			      width, height, (int)f->x, (int)f->y, (int)f->width, (int)f->height);
	return ENCRE_OK;
}

/* Rows of length 1 at right angles; mirrored or not. */
static bool turns(const float view[9])
{
	for (int i = 0; i < 3; i++)
		for (int j = 0; j < 3; j++) {
			float dot = 0;
			for (int k = 0; k < 3; k++)
				dot += view[3 * i + k] * view[3 * j + k];
			if (!(fabsf(dot - (float)(i == j)) < 1e-3f))
				return false;
		}
	return true;
}

static int32_t check_camera(const encre_camera *camera, char *error, size_t size)
{
	if (!turns(camera->view))
		return refuse(error, size,
			      "camera: view is no rotation; give three rows of length 1 that are at right angles");
	if (camera->orthographic < 0 || camera->orthographic > 1)
		return refuse(error, size, "camera: orthographic is %d; give 0 or 1", (int)camera->orthographic);
	if (camera->orthographic && !(camera->height > 0 && camera->height <= FLT_MAX))
		return refuse(error, size,
			      "camera: an orthographic height of %g; give the frame's height in scene units",
			      (double)camera->height);
	if (!(camera->distance >= 0 && camera->distance <= FLT_MAX))
		return refuse(error, size,
			      "camera: a distance of %g; give the depth of what the picture is about, or 0",
			      (double)camera->distance);
	if (!(camera->light >= 0 && camera->light <= FLT_MAX))
		return refuse(error, size, "camera: a light of %g; give that of what is fully lit, or 0",
			      (double)camera->light);
	if (!(camera->shade >= 0 && (camera->shade < camera->light || camera->shade == 0)))
		return refuse(error, size, "camera: a shade of %g; give less than its light, %g, or 0",
			      (double)camera->shade, (double)camera->light);
	return ENCRE_OK;
}

/* ---- jobs ------------------------------------------------------------------------------------------------ */

static int32_t check_params(const encre_params *params, int count, char *error, size_t size)
{
	if (!params || count < 1 || count > MAX_STYLES)
		return refuse(error, size, "params: %d styles; give 1 to %d parameter blocks", params ? count : 0,
			      MAX_STYLES);
	if ((uintptr_t)params % _Alignof(encre_params))
		return refuse(error, size,
			      "params: begin at an address that is no multiple of %d; copy them to one that is",
			      (int)_Alignof(encre_params));
	char text[400];
	for (int i = 0; i < count; i++) {
		const char *e = encre_params_check(params + i, text, sizeof text);
		if (e && i)
			return refuse(error, size, "style %d: %s", i, e);
		if (e)
			return refuse(error, size, "%s", e);
	}
	int32_t code = ENCRE_OK;
	for (int i = 0; i < count; i++) {
#define IMAGE(id, ...)                                                                                                 \
	if (!code && params[i].id.data)                                                                                \
		code = check_memory(#id, &params[i].id, error, size);
#include "base/all.rows.h"
	}
	return code;
}

/* An output, which has strides, lies apart from the images of all styles. */
static int32_t check_apart_from_images(const encre_job *job, const char *name, const encre_image *out, char *error,
				       size_t size)
{
	const encre_params *params = job->params;
	int32_t code = ENCRE_OK;
	for (int i = 0; i < job->n_styles; i++) {
#define IMAGE(id, ...)                                                                                                 \
	if (!code && params[i].id.data) {                                                                              \
		encre_image given = with_strides(params[i].id);                                                        \
		code = check_apart(name, out, #id, grid_of(&given), error, size);                                      \
	}
#include "base/all.rows.h"
	}
	return code;
}

/* Outputs of a job, which have strides, lie apart from each other and from what it reads. */
static int32_t check_outputs(const encre_job *job, const encre_image *in, const encre_image *out, char *error,
			     size_t size)
{
	const encre_params *scene = job->params;
	bool any = false;
	for (int i = 0; i < ENCRE_OUTPUT_COUNT; i++) {
		const char *name = encre_output_info(i)->name;
		int32_t code = ENCRE_OK;
		if (!out[i].data)
			continue;
		any = true;
		for (int k = 0; !code && k < ENCRE_LAYER_COUNT; k++)
			if (in[k].data)
				code = check_apart(name, out + i, encre_layer_info(k)->name, grid_of(in + k), error,
						   size);
		for (int k = 0; !code && k < i; k++)
			if (out[k].data)
				code = check_apart(name, out + i, encre_output_info(k)->name, grid_of(out + k), error,
						   size);
		if (!code)
			code = check_apart_from_images(job, name, out + i, error, size);
		if (!code)
			code = check_apart(name, out + i, "the parameters",
					   grid_of_bytes(scene, (size_t)job->n_styles * sizeof *scene), error, size);
		if (code)
			return code;
	}
	return any || job->tell_strokes
		       ? ENCRE_OK
		       : refuse(error, size, "outputs: none is given; give at least one image to draw into");
}

/* Distances to edges are 16-bit numbers. */
static int32_t check_reach(const encre_job *job, int width, int height, char *error, size_t size)
{
	const encre_params *scene = job->params;
	float reach = nearest_reach(scene, job->n_styles, scale_of(scene, job->frame.height));
	double far = sqrt((double)width * width + (double)height * height);
	if (scene->edge_detector == edge_detector_FINE || !(reach > NEAREST_FAR) || far <= NEAREST_FAR)
		return ENCRE_OK;
	return refuse(error, size,
		      "line_thickest, smudge_range: in %d x %d pixels reach %g of them, where %d can be counted; "
		      "give less, or render in borders",
		      width, height, (double)reach, NEAREST_FAR);
}

/* Places that are no numbers, or so far away that no frame has them, would be no lines. */
static int32_t check_points(const encre_job *job, char *error, size_t size)
{
	const float beside = 1000, most = 1e9f; /* pixels */
	float right = (float)job->frame.width + beside, bottom = (float)job->frame.height + beside;
	if (job->n_chains < 0 || job->n_chained < 0 || (job->n_chains && !job->chains) ||
	    (job->n_chained && !job->chained))
		return refuse(error, size, "chains: %lld points and %lld objects; give as many as there are, or 0",
			      (long long)job->n_chains, (long long)job->n_chained);
	for (int64_t i = 0; i < job->n_chains; i++) {
		const encre_chain_point *p = job->chains + i;
		const float values[] = {p->along[0], p->along[1], p->bend, p->fade, p->gap};
		bool numbers = fabsf(p->depth) <= FLT_MAX && p->x >= -beside && p->x <= right && p->y >= -beside &&
			       p->y <= bottom;
		for (size_t k = 0; k < sizeof values / sizeof *values; k++)
			numbers &= fabsf(values[k]) <= most;
		if (!numbers)
			return refuse(error, size, "chains: point %lld is at no place; give what encre_chains() gave",
				      (long long)i);
		if (i && p->run < p[-1].run)
			return refuse(error, size, "chains: run %d follows run %d; give runs one after the other",
				      (int)p->run, (int)p[-1].run);
	}
	return ENCRE_OK;
}

int32_t check_job(const encre_job *job, encre_image in[ENCRE_LAYER_COUNT], encre_image out[ENCRE_OUTPUT_COUNT],
		  char *error, size_t size)
{
	int width = job->layers[0].width, height = job->layers[0].height;
	int32_t code;
	for (int i = 0; i < ENCRE_LAYER_COUNT; i++) {
		const encre_layer_description *what = encre_layer_info(i);
		if (!job->layers[i].data && what->required)
			return refuse(error, size,
				      "%s: this layer is missing and required; render it or name the file that has it",
				      what->name);
		if (job->layers[i].data && (code = check_image(job->layers + i, what, width, height, error, size)))
			return code;
		in[i] = with_strides(job->layers[i]);
	}
	for (int i = 0; i < ENCRE_OUTPUT_COUNT; i++) {
		if (job->outputs[i].data &&
		    (code = check_image(job->outputs + i, encre_output_info(i), width, height, error, size)))
			return code;
		out[i] = with_strides(job->outputs[i]);
	}
	if ((code = check_params(job->params, job->n_styles, error, size)) ||
	    (code = check_outputs(job, in, out, error, size)) ||
	    (code = check_frame(&job->frame, width, height, error, size)) ||
	    (code = check_camera(&job->camera, error, size)) || (code = check_points(job, error, size)))
		return code;
	if (job->tell_strokes && ((const encre_params *)job->params)->edge_detector != edge_detector_FINE)
		return refuse(error, size, "edge_detector: only FINE has strokes; choose it, or ask for none");
	return check_reach(job, width, height, error, size);
}

/* Memory that a raster job's meshes take. Numbers of meshes may still be wrong: then geometry_check() refuses them. */
static int32_t check_apart_from_meshes(const encre_raster_job *job, const char *name, const encre_image *output,
				       char *error, size_t size)
{
	size_t meshes = job->meshes && job->n_meshes > 0 ? (size_t)job->n_meshes : 0;
	int32_t code = check_apart(name, output, "the meshes", grid_of_bytes(job->meshes, meshes * sizeof *job->meshes),
				   error, size);
	for (size_t i = 0; !code && i < meshes; i++) {
		const encre_mesh *m = job->meshes + i;
		size_t points = m->n_points > 0 ? (size_t)m->n_points : 0,
		       primitives = m->n_primitives > 0 ? (size_t)m->n_primitives : 0,
		       channels = m->n_channels > 0 ? (size_t)m->n_channels : 0,
		       corners = primitives * (m->kind == ENCRE_LINES ? 2 : 3);
		const struct {
			const void *from;
			size_t count;
		} taken[] = {{m->points, 3 * points},   {m->corners, corners},  {m->attributes, corners * channels},
			     {m->material, primitives}, {m->style, primitives}, {m->object, primitives},
			     {m->normals, 3 * corners}, {m->rest, 3 * corners}, {m->rest_normals, 3 * corners},
			     {m->uv, 2 * corners}};
		for (size_t k = 0; !code && k < sizeof taken / sizeof *taken; k++)
			if (taken[k].from)
				code = check_apart(name, output, "a mesh",
						   grid_of_bytes(taken[k].from, NUMBER * taken[k].count), error, size);
	}
	return code;
}

int32_t check_chains(const encre_chain_job *job, char *error, size_t size)
{
	if (job->width < 1 || job->height < 1 || job->width > MAX_SIZE || job->height > MAX_SIZE)
		return refuse(error, size, "chains: images of %d x %d pixels; give 1 to %d each way", (int)job->width,
			      (int)job->height, MAX_SIZE);
	if (!(job->least_bend >= 0 && job->least_bend <= 180))
		return refuse(error, size, "chains: a least_bend of %g; give 0 to 180 degrees",
			      (double)job->least_bend);
	if (job->most_before < 0 || job->most_before > 1000)
		return refuse(error, size, "chains: most_before is %d; give 0 to 1000", (int)job->most_before);
	if (job->n_images < 0 || job->n_image < 0 || (job->n_images && !job->images) || (job->n_image && !job->image))
		return refuse(error, size, "chains: %d images for %d materials; give as many as there are, or 0",
			      (int)job->n_images, (int)job->n_image);
	for (int32_t i = 0; i < job->n_images; i++) {
		const encre_colored *image = job->images + i;
		if (!image->colors || image->width < 1 || image->height < 1 || image->width > ENCRE_MAX_COLORED ||
		    image->height > ENCRE_MAX_COLORED || image->wrap < 0 || image->wrap > ENCRE_MIRROR)
			return refuse(error, size, "chains: image %d has %d x %d texels; give 1 to %d each way", (int)i,
				      (int)image->width, (int)image->height, ENCRE_MAX_COLORED);
	}
	for (int32_t i = 0; i < job->n_image; i++)
		if (job->image[i] < -1 || job->image[i] >= job->n_images)
			return refuse(error, size,
				      "chains: material %d has image %d of %d; give one that is there, or -1", (int)i,
				      (int)job->image[i], (int)job->n_images);
	int32_t code = job->params ? check_params(job->params, job->n_styles, error, size) : ENCRE_OK;
	return code ? code : check_frame(&job->frame, job->width, job->height, error, size);
}

int32_t check_raster(const encre_raster_job *job, encre_raster_job *clean, char *error, size_t size)
{
	const encre_layer_description what[] = {
		{"depth", "", 1, 0},      {"normal", "", 3, 0},  {"object", "", 1, 0},
		{"material", "", 1, 0},   {"style", "", 1, 0},   {"attributes", "", job->n_channels, 0},
		{"coincident", "", 1, 0}, {"shading", "", 3, 0}, {"anchor", "", 16, 0},
		{"tangent", "", 3, 0},    {"card", "", 4, 0},
	};
	const encre_image *images[] = {&job->depth,  &job->normal,     &job->object,     &job->material,
				       &job->style,  &job->attributes, &job->coincident, &job->shading,
				       &job->anchor, &job->tangent,    &job->card};
	const encre_image *first = NULL;
	*clean = *job;
	encre_image *clean_images[] = {&clean->depth,  &clean->normal,     &clean->object,     &clean->material,
				       &clean->style,  &clean->attributes, &clean->coincident, &clean->shading,
				       &clean->anchor, &clean->tangent,    &clean->card};
	if (job->n_channels < 0 || job->n_channels > ENCRE_MAX_CHANNELS)
		return refuse(error, size, "attributes: %d channels; give 0 to %d", (int)job->n_channels,
			      ENCRE_MAX_CHANNELS);
	enum { IMAGES = sizeof images / sizeof *images };
	for (int i = 0; !first && i < IMAGES; i++)
		first = images[i]->data ? images[i] : NULL;
	if (!first)
		return refuse(error, size, "raster: no output is given; give at least one image to draw into");
	int32_t code = check_images(IMAGES, 0, what, images, clean_images, first->width, first->height, error, size);
	for (int i = 0; !code && i < IMAGES; i++)
		if (images[i]->data)
			code = check_apart_from_meshes(job, what[i].name, clean_images[i], error, size);
	if (!code && job->beyond.data) {
		const encre_layer_description beyond = {"beyond", "", 1, 0};
		code = check_image(&job->beyond, &beyond, first->width, first->height, error, size);
		clean->beyond = with_strides(job->beyond);
		for (int k = 0; !code && k < IMAGES; k++)
			if (images[k]->data)
				code = check_apart(what[k].name, clean_images[k], "beyond", grid_of(&clean->beyond),
						   error, size);
	}
	return code ? code : check_frame(&job->frame, first->width, first->height, error, size);
}

int32_t check_bake(const encre_bake_job *job, encre_bake_job *clean, char *error, size_t size)
{
	int width = job->texture.width, height = job->texture.height, channels = job->texture.channels;
	if (!job->texture.data || channels < 3 || channels > 4)
		return refuse(error, size, "texture: has %d channels; give 3 or 4", job->texture.data ? channels : 0);
	if (width < 1 || height < 1 || width > ENCRE_MAX_TEXELS || height > ENCRE_MAX_TEXELS)
		return refuse(error, size, "texture: is %d x %d texels; give 1 to %d each way", width, height,
			      ENCRE_MAX_TEXELS);
	const encre_layer_description what[] = {
		{"texture", "", channels, 1}, {"form", "", 3, 0}, {"output", "", channels, 0}};
	const encre_image *images[] = {&job->texture, &job->form, &job->output};
	*clean = *job;
	encre_image *clean_images[] = {&clean->texture, &clean->form, &clean->output};
	int32_t code = check_images(3, 2, what, images, clean_images, width, height, error, size);
	if (!code)
		code = check_params(job->params, 1, error, size);
	const struct {
		const char *name;
		int32_t value;
	} flags[] = {{"linear", job->linear}, {"wrap_x", job->wrap_x}, {"wrap_y", job->wrap_y}};
	for (int i = 0; !code && i < 3; i++)
		if (flags[i].value < 0 || flags[i].value > 1)
			return refuse(error, size, "%s: is %d; give 0 or 1", flags[i].name, (int)flags[i].value);
	if (!code && job->output.data)
		code = check_apart("output", &clean->output, "the parameters",
				   grid_of_bytes(job->params, sizeof(encre_params)), error, size);
	return code;
}

/* ---- steps ----------------------------------------------------------------------------------------------- */

encre_progress *step_progress(const encre_step *step, void ***user)
{
	encre_job *render = step->job;
	encre_raster_job *raster = step->job;
	encre_light_job *light = step->job;
	encre_material_job *material = step->job;
	encre_bake_job *bake = step->job;
	encre_call_job *call = step->job;
	encre_chain_job *chains = step->job;
	encre_even_job *even = step->job;
	encre_average_job *average = step->job;
	switch (step->kind) {
	case ENCRE_RENDER: *user = &render->user; return &render->progress;
	case ENCRE_RASTER: *user = &raster->user; return &raster->progress;
	case ENCRE_LIGHT: *user = &light->user; return &light->progress;
	case ENCRE_MATERIAL: *user = &material->user; return &material->progress;
	case ENCRE_CALL: *user = &call->user; return &call->progress;
	case ENCRE_CHAINS: *user = &chains->user; return &chains->progress;
	case ENCRE_EVEN: *user = &even->user; return &even->progress;
	case ENCRE_AVERAGE: *user = &average->user; return &average->progress;
	default: *user = &bake->user; return &bake->progress;
	}
}

int32_t check_steps(const encre_step *steps, int32_t n_steps, char *error, size_t size)
{
	if (!steps || n_steps < 1 || n_steps > ENCRE_MAX_STEPS)
		return refuse(error, size, "steps: %d are given; give 1 to %d", steps ? (int)n_steps : 0,
			      ENCRE_MAX_STEPS);
	for (int i = 0; i < n_steps; i++) {
		void **user;
		if (steps[i].kind < ENCRE_RENDER || steps[i].kind > ENCRE_AVERAGE)
			return refuse(error, size, "step %d: kind %d is not known; give one of enum encre_kind", i,
				      (int)steps[i].kind);
		if (!steps[i].job)
			return refuse(error, size, "step %d: it has no job; give it one", i);
		if (*step_progress(steps + i, &user))
			return refuse(error, size,
				      "step %d: its progress would be called on another thread; give NULL, and ask "
				      "encre_poll()",
				      i);
	}
	return ENCRE_OK;
}
