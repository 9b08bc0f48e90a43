/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Random programs of materials. */
#include "fuzz.h"

#include <string.h>

enum { PROGRAMS = 5, TEXTURES = 2, CONSTANTS = 60, THINGS = 4, VALUES = 3, BORDER = 300 };

static int32_t run(encre_context *context, void *job)
{
	return encre_material(context, job);
}

static bool named(const encre_operation_description *what, const char *name)
{
	return !strcmp(what->name, name);
}

/* ---- programs ---------------------------------------------------------------------------------------------- */

/* Registers to read from, none of which is written to at the same time, mostly. */
static void choose_inputs(encre_operation *o, const encre_operation_description *what, int registers)
{
	for (int i = 0; i < ENCRE_INPUTS; i++) {
		int tries = 50;
		do
			o->in[i] = whole(0, registers - 1);
		while (i < what->inputs && tries-- && o->in[i] >= o->out && o->in[i] < o->out + what->outputs);
	}
}

/* What the operation looks up, within the tables. */
static void choose_data(encre_operation *o, const encre_operation_description *what, int channels)
{
	int32_t *data = o->data;
	bool footprint = named(what, "footprint");
	if ((footprint && channels < 3) || (named(what, "channel") && !channels))
		o->code = 0;
	else if (footprint) {
		data[0] = whole(0, channels - 3);
		data[1] = whole(0, CONSTANTS - 6);
	} else if (named(what, "channel"))
		data[0] = whole(0, channels - 1);
	else if (named(what, "texture"))
		data[0] = whole(0, TEXTURES - 1);
	else if (named(what, "thing"))
		data[0] = whole(0, VALUES - 1);
	else if (named(what, "ramp") || named(what, "steps")) {
		data[1] = whole(1, 6);
		data[0] = 5 * whole(0, CONSTANTS / 5 - data[1]);
	} else if (named(what, "curve")) {
		data[1] = whole(2, 20);
		data[0] = whole(0, CONSTANTS - data[1]);
	} else if (!strncmp(what->name, "voronoi", 7)) {
		data[0] = whole(0, 2);
		data[1] = whole(0, 3);
	} else
		data[0] = whole(0, CONSTANTS - 9);
}

static encre_program random_program(int codes, int channels)
{
	int registers = chance(0.05) ? whole(1, ENCRE_MAX_REGISTERS) : whole(12, 40);
	int n = chance(0.05) ? 0 : whole(1, 40);
	size_t size = (size_t)(n + 1) * sizeof(encre_operation);
	encre_operation *operations = take(size);
	memset(operations, 0, size);
	for (int k = 0; k < n; k++) {
		encre_operation *o = operations + k;
		o->code = whole(0, codes - 1);
		const encre_operation_description *what = encre_operation_info(o->code);
		o->out = registers > what->outputs ? whole(0, registers - what->outputs) : 0;
		choose_inputs(o, what, registers);
		choose_data(o, what, channels);
		if (chance(0.0005))
			o->code = weird_int();
		if (chance(0.0005))
			o->data[whole(0, 1)] = weird_int();
	}
	encre_program p = {.operations = operations, .n_operations = n, .n_registers = registers};
	for (int c = 0; c < ENCRE_RESULTS; c++)
		p.result[c] = whole(0, registers - 1);
	return p;
}

/* ---- tables ------------------------------------------------------------------------------------------------ */

static float *random_values(int n, double odd)
{
	float *values = take((size_t)n * sizeof *values);
	bool shares = chance(0.5);
	for (int k = 0; k < n; k++)
		values[k] = chance(odd) ? weird() : (float)(shares ? share() : between(-2, 5));
	return values;
}

static encre_picture random_texture(double odd)
{
	int width = whole(1, 9), height = whole(1, 9), levels = 1, texels = 0;
	for (int longest = width > height ? width : height; longest > 1; longest /= 2)
		levels++;
	levels = whole(1, levels);
	for (int k = 0, w = width, h = height; k < levels; k++) {
		texels += w * h;
		w = w > 1 ? w / 2 : 1;
		h = h > 1 ? h / 2 : 1;
	}
	encre_picture t = {.width = width, .height = height, .levels = levels, .wrap = whole(0, 2)};
	if (chance(0.5)) {
		t.texels = random_values(4 * texels, odd);
		return t;
	}
	uint8_t *bytes = take((size_t)texels * 4);
	for (int k = 0; k < 4 * texels; k++)
		bytes[k] = (uint8_t)whole(0, 255);
	float *curve = take(256 * sizeof *curve);
	for (int k = 0; k < 256; k++)
		curve[k] = k && chance(0.9) ? curve[k - 1] + (float)share() : k ? curve[k - 1] : (float)between(-2, 1);
	t.bytes = bytes;
	t.curve = curve;
	t.straight = chance(0.5);
	return t;
}

static encre_materials random_tables(int channels)
{
	int codes = 0;
	while (encre_operation_info(codes))
		codes++;
	double odd = chance(0.15) ? 0.05 : 0;
	encre_picture *textures = take(TEXTURES * sizeof *textures);
	for (int k = 0; k < TEXTURES; k++)
		textures[k] = random_texture(odd);
	encre_program *programs = take(PROGRAMS * sizeof *programs);
	for (int k = 0; k < PROGRAMS; k++)
		programs[k] = random_program(codes, channels);
	return (encre_materials){.programs = programs,
				 .textures = textures,
				 .constants = random_values(CONSTANTS, odd),
				 .things = random_values(THINGS * VALUES, odd),
				 .n_programs = PROGRAMS,
				 .n_textures = TEXTURES,
				 .n_constants = CONSTANTS,
				 .n_things = THINGS,
				 .n_values = VALUES};
}

/* ---- jobs -------------------------------------------------------------------------------------------------- */

/* Patches of things and materials, so that most pixels show something. */
static void deal(const encre_image *object, const encre_image *material)
{
	for (int y = 0; y < object->height; y++)
		for (int x = 0; x < object->width; x++) {
			*sample(object, x, y) = (float)(chance(0.95) ? 1 + x / 9 % 5 : 0);
			*sample(material, x, y) = (float)((x / 7 + y / 5) % (PROGRAMS + 1));
		}
}

task random_material(void)
{
	static encre_material_job job;
	static encre_materials tables;
	memset(&job, 0, sizeof job);
	task t = {.name = "material",
		  .run = run,
		  .kind = ENCRE_MATERIAL,
		  .job = &job,
		  .progress = &job.progress,
		  .n_outputs = 7};
	bool wide = chance(0.1); /* blocks of pixels go on beyond a row */
	int width = wide ? whole(100, 700) : whole(1, 60), height = wide ? whole(1, 5) : whole(1, 60);
	int channels = chance(0.15) ? 0 : whole(1, 8);
	shared in = {0}, out = {0};
	scene shown = random_scene(width, height);
	const struct {
		encre_image *image;
		int channels;
		enum content content;
	} inputs[] = {{&job.object, 1, NUMBERS},
		      {&job.material, 1, NUMBERS},
		      {&job.depth, 1, DEPTHS},
		      {&job.normal, 3, DIRECTIONS},
		      {&job.attributes, channels, COLORS}};
	for (size_t k = 0; k < sizeof inputs / sizeof *inputs; k++)
		if (inputs[k].channels) {
			*inputs[k].image = picture(width, height, inputs[k].channels, &in);
			paint(inputs[k].image, inputs[k].content, &shown);
		}
	if (chance(0.9))
		deal(&job.object, &job.material);
	encre_image *outputs[] = {&job.color, &job.gloss,  &job.emission, &job.surface,
				  &job.shine, &job.turned, &job.holdout};
	const int of_each[] = {3, 3, 3, 2, 6, 3, 1};
	for (int k = 0; k < t.n_outputs; k++)
		if (chance(0.8))
			*outputs[k] = t.output[k] = picture(width, height, of_each[k], &out);
	tables = random_tables(channels);
	job.materials = &tables;
	job.frame = (encre_frame){width, height, 0, 0, 0};
	if (chance(0.3)) {
		job.frame = (encre_frame){width, height, whole(0, BORDER), whole(0, BORDER), 0};
		job.frame.width += job.frame.x + whole(0, BORDER);
		job.frame.height += job.frame.y + whole(0, BORDER);
	}
	double clip_start, clip_end;
	random_lens(job.view, job.projection, &clip_start, &clip_end);
	return t;
}
