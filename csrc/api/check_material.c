/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "api/check_material.h"
#include "api/check.h"
#include "api/images.h"
#include "base/refuse.h"
#include "material/material.h"

#include <math.h>
#include <string.h>

/* How many constants the data of an operation name, from which on; -1: its data name something else. */
static int64_t constants_of(const char *name, const encre_operation *o, int64_t *from)
{
	static const struct {
		const char *name;
		int which, each, count; /* count 0: the other data tells */
	} rows[] = {{"constant", 0, 1, 1}, {"footprint", 1, 6, 1}, {"ramp", 0, 5, 0}, {"steps", 0, 5, 0},
		    {"curve", 0, 1, 0},    {"brick", 0, 9, 1},     {"noise", 0, 2, 1}};
	for (size_t k = 0; k < sizeof rows / sizeof *rows; k++)
		if (!strcmp(name, rows[k].name)) {
			*from = o->data[rows[k].which];
			return rows[k].each * (int64_t)(rows[k].count ? rows[k].count : o->data[1]);
		}
	return -1;
}

static bool data_are_there(const encre_materials *m, const encre_operation *o, const char *name, int channels)
{
	int64_t from = 0, n = constants_of(name, o, &from);
	if (n >= 0 && (from < 0 || from > m->n_constants - n))
		return false;
	if (!strcmp(name, "channel"))
		return o->data[0] >= 0 && o->data[0] < channels;
	if (!strcmp(name, "footprint"))
		return o->data[0] >= 0 && o->data[0] <= channels - 3;
	if (!strcmp(name, "texture"))
		return o->data[0] >= 0 && o->data[0] < m->n_textures;
	if (!strcmp(name, "thing"))
		return o->data[0] >= 0 && o->data[0] < m->n_values;
	if (!strcmp(name, "ramp") || !strcmp(name, "steps"))
		return o->data[1] >= 1;
	if (!strcmp(name, "curve"))
		return o->data[1] >= 2;
	return true;
}

static bool registers_are_there(const encre_program *p, const encre_operation *o,
				const encre_operation_description *what)
{
	if (o->out < 0 || o->out > p->n_registers - what->outputs)
		return false;
	for (int k = 0; k < what->inputs; k++)
		if (o->in[k] < 0 || o->in[k] >= p->n_registers ||
		    (o->in[k] >= o->out && o->in[k] < o->out + what->outputs))
			return false;
	return o->in[0] >= 0 && o->in[0] < p->n_registers;
}

static int32_t check_program(const encre_materials *m, int number, int channels, char *error, size_t size)
{
	const encre_program *p = m->programs + number;
	if (p->n_registers < 1 || p->n_registers > ENCRE_MAX_REGISTERS || p->n_operations < 0 ||
	    (p->n_operations && !p->operations))
		return refuse(error, size, "program %d: has %d registers; give 1 to %d, and its operations", number,
			      (int)p->n_registers, ENCRE_MAX_REGISTERS);
	for (int k = 0; k < ENCRE_RESULTS; k++)
		if (p->result[k] < 0 || p->result[k] >= p->n_registers)
			return refuse(error, size, "program %d: result %d is no register of it; give 0 to %d", number,
				      k, (int)p->n_registers - 1);
	for (int k = 0; k < p->n_operations; k++) {
		const encre_operation *o = p->operations + k;
		const encre_operation_description *what = operation_info(o->code);
		if (!what)
			return refuse(error, size,
				      "program %d: operation %d has the unknown code %d; see encre_operation_info()",
				      number, k, (int)o->code);
		if (!registers_are_there(p, o, what) || !data_are_there(m, o, what->name, channels))
			return refuse(error, size,
				      "program %d: operation %d, %s, names a register, constant, channel or texture "
				      "that it can't use; give one that is there",
				      number, k, what->name);
	}
	return ENCRE_OK;
}

static bool rises(const float *curve)
{
	for (int k = 0; k < 256; k++)
		if (!isfinite(curve[k]) || (k && curve[k] < curve[k - 1]))
			return false;
	return true;
}

int32_t check_picture(const encre_picture *t, int number, char *error, size_t size)
{
	int levels = 1;
	for (int32_t wide = t->width > t->height ? t->width : t->height; wide > 1; wide /= 2)
		levels++;
	bool floats = t->texels && (uintptr_t)t->texels % NUMBER == 0 && !t->bytes;
	bool bytes = t->bytes && t->curve && (uintptr_t)t->curve % NUMBER == 0 && !t->texels;
	if (!floats && (!bytes || !rises(t->curve)))
		return refuse(
			error, size,
			"texture %d: has neither texels alone nor bytes alone with a curve that is finite and never "
			"falls; give one of both",
			number);
	if (t->width < 1 || t->height < 1 || t->width > ENCRE_MAX_TEXELS || t->height > ENCRE_MAX_TEXELS ||
	    t->levels < 1 || t->levels > levels || t->wrap < ENCRE_REPEAT || t->wrap > ENCRE_CLIP)
		return refuse(error, size,
			      "texture %d: is %d x %d texels in %d levels; give 1 to %d each way, their levels, and "
			      "how it goes on",
			      number, (int)t->width, (int)t->height, (int)t->levels, ENCRE_MAX_TEXELS);
	return ENCRE_OK;
}

static int32_t check_materials(const encre_materials *m, int channels, char *error, size_t size)
{
	if (!m || m->n_programs < 0 || m->n_textures < 0 || m->n_constants < 0 || m->n_things < 0 || m->n_values < 0 ||
	    (m->n_programs && !m->programs) || (m->n_textures && !m->textures) || (m->n_constants && !m->constants) ||
	    (m->n_things && m->n_values && !m->things))
		return refuse(error, size, "materials: their numbers are not those of what is there; give both");
	int32_t code = ENCRE_OK;
	for (int k = 0; !code && k < m->n_textures; k++)
		code = check_picture(m->textures + k, k, error, size);
	for (int k = 0; !code && k < m->n_programs; k++)
		code = check_program(m, k, channels, error, size);
	return code;
}

int32_t check_material(const encre_material_job *job, encre_material_job *clean, char *error, size_t size)
{
	enum { INPUTS = 5, IMAGES = 12 };
	int width = job->object.width, height = job->object.height, channels = job->attributes.channels;
	const encre_layer_description what[IMAGES] = {{"object", "", 1, 1},
						      {"material", "", 1, 1},
						      {"depth", "", 1, 1},
						      {"normal", "", 3, 1},
						      {"attributes", "", job->attributes.data ? channels : 1, 0},
						      {"color", "", 3, 0},
						      {"gloss", "", 3, 0},
						      {"emission", "", 3, 0},
						      {"surface", "", 2, 0},
						      {"shine", "", 6, 0},
						      {"turned", "", 3, 0},
						      {"holdout", "", 1, 0}};
	const encre_image *images[IMAGES] = {&job->object,     &job->material, &job->depth,  &job->normal,
					     &job->attributes, &job->color,    &job->gloss,  &job->emission,
					     &job->surface,    &job->shine,    &job->turned, &job->holdout};
	*clean = *job;
	encre_image *cleaned[IMAGES] = {&clean->object,     &clean->material, &clean->depth,  &clean->normal,
					&clean->attributes, &clean->color,    &clean->gloss,  &clean->emission,
					&clean->surface,    &clean->shine,    &clean->turned, &clean->holdout};
	if (job->attributes.data && (channels < 1 || channels > ENCRE_MAX_CHANNELS))
		return refuse(error, size, "attributes: %d channels; give 1 to %d", channels, ENCRE_MAX_CHANNELS);
	int32_t code = check_images(IMAGES, INPUTS, what, images, cleaned, width, height, error, size);
	if (!code)
		code = check_frame(&job->frame, width, height, error, size);
	if (!code)
		code = check_materials(job->materials, job->attributes.data ? channels : 0, error, size);
	for (int k = 0; !code && k < 16; k++)
		if (!isfinite(job->view[k]) || !isfinite(job->projection[k]))
			code = refuse(error, size, "camera: a matrix is not finite; give the camera another place");
	return code;
}
