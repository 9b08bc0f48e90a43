/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What a caller may get wrong, found before anything runs. */
#include "api/check.h"
#include "base/params.h"
#include "base/refuse.h"

#include <float.h>

enum { MAX_SIZE = 65536, MAX_STYLES = 256 };

static encre_image with_strides(encre_image image)
{
	if (!image.pixel_stride)
		image.pixel_stride = 4 * (int64_t)image.channels;
	if (!image.row_stride)
		image.row_stride = image.pixel_stride * image.width;
	return image;
}

static int32_t check_image(const encre_image *image, const encre_layer_description *what, int width, int height,
			   char *error, size_t size)
{
	if (image->channels != what->channels)
		return refuse(error, size, "%s: has %d channels; give %d", what->name, (int)image->channels,
			      (int)what->channels);
	if (image->width < 1 || image->height < 1 || image->width > MAX_SIZE || image->height > MAX_SIZE)
		return refuse(error, size, "%s: is %d x %d pixels; give 1 to %d each way", what->name,
			      (int)image->width, (int)image->height, MAX_SIZE);
	if (image->width != width || image->height != height)
		return refuse(error, size, "%s: is %d x %d pixels where %d x %d are due; give all images the same size",
			      what->name, (int)image->width, (int)image->height, width, height);
	if (image->pixel_stride % 4 || image->row_stride % 4 ||
	    (image->pixel_stride && image->pixel_stride < 4 * (int64_t)image->channels))
		return refuse(error, size,
			      "%s: strides are not whole floats or shorter than a pixel; give bytes, multiples of 4",
			      what->name);
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
	if (!job->params || job->n_styles < 1 || job->n_styles > MAX_STYLES)
		return refuse(error, size, "params: %d styles; give 1 to %d parameter blocks", (int)job->n_styles,
			      MAX_STYLES);
	char text[400];
	for (int i = 0; i < job->n_styles; i++) {
		const char *e = encre_params_check((const encre_params *)job->params + i, text, sizeof text);
		if (e && i)
			return refuse(error, size, "style %d: %s", i, e);
		if (e)
			return refuse(error, size, "%s", e);
	}
	const encre_frame *p = &job->frame;
	if (p->width < 1 || p->height < 1 || p->x < 0 || p->y < 0 || p->x > p->width - width ||
	    p->y > p->height - height)
		return refuse(error, size,
			      "frame: %d x %d pixels at %d, %d do not lie in a frame of %d x %d; give the full frame "
			      "and the place of the images in it",
			      width, height, (int)p->x, (int)p->y, (int)p->width, (int)p->height);
	if (job->camera.orthographic && !(job->camera.height > 0 && job->camera.height <= FLT_MAX))
		return refuse(error, size,
			      "camera: an orthographic height of %g; give the frame's height in scene units",
			      (double)job->camera.height);
	return ENCRE_OK;
}

int32_t check_raster(const encre_raster_job *job, encre_raster_job *clean, char *error, size_t size)
{
	const encre_layer_description what[] = {
		{"depth", "", 1, 0},    {"normal", "", 3, 0}, {"object", "", 1, 0},
		{"material", "", 1, 0}, {"style", "", 1, 0},  {"attributes", "", job->n_channels, 0},
		{"marks", "", 2, 0},
	};
	const encre_image *images[] = {&job->depth, &job->normal,     &job->object, &job->material,
				       &job->style, &job->attributes, &job->marks};
	const encre_image *first = NULL;
	*clean = *job;
	encre_image *clean_images[] = {&clean->depth, &clean->normal,     &clean->object, &clean->material,
				       &clean->style, &clean->attributes, &clean->marks};
	if (job->n_channels < 0 || job->n_channels > ENCRE_MAX_CHANNELS)
		return refuse(error, size, "attributes: %d channels; give 0 to %d", (int)job->n_channels,
			      ENCRE_MAX_CHANNELS);
	for (size_t i = 0; i < sizeof images / sizeof *images; i++) {
		if (!images[i]->data)
			continue;
		if (!first)
			first = images[i];
		int32_t code = check_image(images[i], what + i, first->width, first->height, error, size);
		if (code)
			return code;
		*clean_images[i] = with_strides(*images[i]);
	}
	if (!first)
		return refuse(error, size, "raster: no output is given; give at least one image to draw into");
	return ENCRE_OK;
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
	for (int i = 0; i < 3; i++) {
		int32_t code =
			images[i]->data ? check_image(images[i], what + i, width, height, error, size) : ENCRE_OK;
		if (code)
			return code;
		*clean_images[i] = with_strides(*images[i]);
	}
	if (!job->params)
		return refuse(error, size, "params: are missing; give a parameter block");
	char text[400];
	const char *e = encre_params_check(job->params, text, sizeof text);
	return e ? refuse(error, size, "%s", e) : ENCRE_OK;
}
