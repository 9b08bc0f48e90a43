/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Random frames. Parameters are those that the library names: there is no list of them here. */
#include "fuzz.h"

#include <float.h>
#include <math.h>
#include <string.h>

/* ---- parameters -------------------------------------------------------------------------------------------- */

enum { MOST_ROWS = 256, REPAIRS = 4 };

static const encre_param_info *rows[MOST_ROWS];
static int n_rows;
static const encre_param_info *detector; /* pairs are tried under each of its values */

static void find_rows(void)
{
	if (n_rows)
		return;
	for (int s = 0; encre_stage_info(s); s++)
		for (int i = 0; i < encre_stage_info(s)->n_params && n_rows < MOST_ROWS; i++) {
			const encre_param_info *row = encre_stage_info(s)->params + i;
			rows[n_rows++] = row;
			if (!strcmp(row->id, "edge_detector"))
				detector = row;
		}
}

static float random_float(const encre_param_info *p)
{
	if (chance(0.02))
		return weird();
	if (chance(0.7))
		return (float)between(p->soft_min, p->soft_max);
	if (p->hard_max < 1e30)
		return (float)between(p->hard_min, p->hard_max);
	return chance(0.2) ? FLT_MAX : (float)fmin(magnitude(-20, 38), FLT_MAX);
}

static encre_levels random_levels(void)
{
	encre_levels levels = {.count = chance(0.02) ? weird_int() : whole(1, ENCRE_MAX_LEVELS)};
	double at = 0, step = magnitude(-2, 0);
	for (int k = 0; k < ENCRE_MAX_LEVELS; k++) {
		encre_level *level = levels.level + k;
		at += step * (0.2 + share());
		*level = (encre_level){(float)(1.5 * share()),
				       (float)at,
				       (float)(0.1 * step * share()),
				       {(float)share(), (float)share(), (float)share()}};
		float *number = &level->intensity;
		if (chance(0.003))
			number[whole(0, 5)] = weird();
	}
	return levels;
}

static void put(char *block, const encre_param_info *p)
{
	char *field = block + p->offset;
	float color[3] = {(float)share(), (float)share(), (float)share()}, number = random_float(p);
	int32_t n = chance(0.02) ? weird_int() : (int32_t)between(p->soft_min, p->soft_max);
	encre_levels levels;
	encre_image image;
	switch (p->type) {
	case ENCRE_BOOL: n = whole(0, 1); break;
	case ENCRE_ENUM: n = (int32_t)p->items[whole(0, p->n_items - 1)].number; break;
	case ENCRE_INT: break;
	case ENCRE_FLOAT: memcpy(field, &number, sizeof number); return;
	case ENCRE_COLOR:
		if (chance(0.02))
			color[whole(0, 2)] = weird();
		memcpy(field, color, sizeof color);
		return;
	case ENCRE_LEVELS:
		levels = random_levels();
		memcpy(field, &levels, sizeof levels);
		return;
	default: {
		image = picture(whole(1, 40), whole(1, 40), chance(0.6) ? 1 : whole(1, 4), NULL);
		scene s = random_scene(image.width, image.height);
		paint(&image, COLORS, &s);
		memcpy(field, &image, sizeof image);
		return;
	}
	}
	memcpy(field, &n, sizeof n);
}

/* Where two settings exclude each other the library names one of them: that one becomes what it was. */
static void repair(char *block)
{
	char text[400];
	const char *sentence;
	char fresh[8192];
	if (encre_params_size() > (int64_t)sizeof fresh)
		return;
	encre_params_init(fresh);
	for (int i = 0; i < REPAIRS && (sentence = encre_params_check(block, text, sizeof text)); i++)
		for (int k = 0; k < n_rows; k++) {
			size_t n = strlen(rows[k]->id);
			if (strncmp(sentence, rows[k]->id, n) || sentence[n] != ':')
				continue;
			size_t size = rows[k]->type == ENCRE_LEVELS  ? sizeof(encre_levels)
				      : rows[k]->type == ENCRE_IMAGE ? sizeof(encre_image)
				      : rows[k]->type == ENCRE_COLOR ? 3 * sizeof(float)
								     : 4;
			memcpy(block + rows[k]->offset, fresh + rows[k]->offset, size);
		}
}

/* The built-in sheet takes longer than all the rest: it is made now and then. */
static void lighten(char *block)
{
	for (int i = 0; i < n_rows; i++)
		for (int k = 0; !strcmp(rows[i]->id, "paper_source") && k < rows[i]->n_items; k++)
			if (!strcmp(rows[i]->items[k].id, "NONE")) {
				int32_t number = (int32_t)rows[i]->items[k].number;
				memcpy(block + rows[i]->offset, &number, sizeof number);
			}
}

/* What is off by default is on for once: a source of weight 0 shows nothing of its settings. */
static void enliven(char *block)
{
	for (int i = 0; i < n_rows; i++)
		if (rows[i]->type == ENCRE_FLOAT && rows[i]->value[0] == 0 && chance(0.5)) {
			float value = (float)between(rows[i]->soft_min, rows[i]->soft_max);
			memcpy(block + rows[i]->offset, &value, sizeof value);
		}
}

static char *blocks(int count)
{
	find_rows();
	char *all = take((size_t)encre_params_size() * (size_t)count);
	bool light = chance(0.85);
	for (int i = 0; i < count; i++) {
		encre_params_init(all + i * encre_params_size());
		if (light)
			lighten(all + i * encre_params_size());
		if (chance(0.6))
			enliven(all + i * encre_params_size());
	}
	return all;
}

void *random_params(int count)
{
	char *all = blocks(count);
	double few = chance(0.5) ? 0.1 : 0.5;
	for (int i = 0; i < count; i++) {
		char *block = all + i * encre_params_size();
		for (int k = 0; k < n_rows; k++)
			if (chance(few) && (rows[k]->type != ENCRE_IMAGE || i < 8))
				put(block, rows[k]);
		if (chance(0.9))
			repair(block);
	}
	return all;
}

uint64_t pair_count(void)
{
	find_rows();
	return (uint64_t)n_rows * (uint64_t)(n_rows - 1) / 2 * (uint64_t)detector->n_items;
}

void *paired_params(uint64_t k, int count)
{
	char *all = blocks(count);
	int32_t number = (int32_t)detector->items[k % (uint64_t)detector->n_items].number;
	uint64_t pair = k / (uint64_t)detector->n_items % ((uint64_t)n_rows * (uint64_t)(n_rows - 1) / 2);
	uint64_t second = 1;
	while (pair >= second)
		pair -= second++;
	for (int i = 0; i < count; i++) {
		char *block = all + i * encre_params_size();
		put(block, rows[pair]);
		put(block, rows[second]);
		if (rows[pair] != detector && rows[second] != detector)
			memcpy(block + detector->offset, &number, sizeof number);
		repair(block);
	}
	return all;
}

/* ---- frames ------------------------------------------------------------------------------------------------ */

/* Mostly small: more pictures find more than larger ones. Some rows are longer than what is worked on together. */
static void random_size(int *width, int *height)
{
	int kind = whole(0, 19);
	int most = kind < 3 ? 4 : kind < 15 ? 32 : 90;
	*width = kind == 19 ? whole(250, 600) : whole(1, most);
	*height = kind == 19 ? whole(1, 12) : whole(1, most);
}

static enum content content_of(int layer)
{
	switch (layer) {
	case ENCRE_LAYER_DIFFUSE:
	case ENCRE_LAYER_SPECULAR: return LIGHTS;
	case ENCRE_LAYER_DEPTH:
	case ENCRE_LAYER_SEEN_DEPTH: return DEPTHS;
	case ENCRE_LAYER_NORMAL:
	case ENCRE_LAYER_SEEN_NORMAL: return DIRECTIONS;
	case ENCRE_LAYER_OBJECT:
	case ENCRE_LAYER_MATERIAL:
	case ENCRE_LAYER_STYLE: return NUMBERS;
	case ENCRE_LAYER_CONTROLS: return SHARES;
	case ENCRE_LAYER_ANCHOR: return chance(0.5) ? DIRECTIONS : COLORS; /* sides of a thing, and places */
	default: return COLORS;
	}
}

static void random_camera(encre_camera *camera)
{
	double a = 6.3 * share(), b = 6.3 * share();
	const double view[9] = {cos(a), -sin(a) * cos(b), sin(a) * sin(b), sin(a), cos(a) * cos(b), -cos(a) * sin(b),
				0,      sin(b),           cos(b)};
	for (int k = 0; k < 9; k++)
		camera->view[k] = (float)view[k];
	camera->orthographic = chance(0.4);
	camera->height = chance(0.9) ? (float)(10 * share() + 0.1) : (float)magnitude(-37, 38);
	camera->distance = chance(0.5) ? 0 : chance(0.9) ? (float)(10 * share()) : (float)magnitude(-37, 38);
	if (chance(0.01))
		camera->distance = weird();
	if (chance(0.01))
		camera->view[whole(0, 8)] = weird();
	if (chance(0.01))
		camera->height = weird();
	if (chance(0.005))
		camera->orthographic = weird_int();
}

static encre_frame random_place(int width, int height)
{
	encre_frame f = {width, height, 0, 0, chance(0.5) ? 0 : weird_int()};
	if (chance(0.3)) {
		int far = chance(0.8) ? 300 : 60000;
		f.x = whole(0, far);
		f.y = whole(0, far);
		f.width += f.x + whole(0, 300);
		f.height += f.y + whole(0, 300);
	}
	int32_t *number[] = {&f.width, &f.height, &f.x, &f.y};
	if (chance(0.01))
		*number[whole(0, 3)] = weird_int();
	return f;
}

static int32_t run(encre_context *context, void *job)
{
	return encre_render(context, job);
}

task random_render(uint64_t k)
{
	static encre_job job;
	memset(&job, 0, sizeof job);
	task t = {.name = "render",
		  .run = run,
		  .kind = ENCRE_RENDER,
		  .job = &job,
		  .progress = &job.progress,
		  .result = &job.nonfinite,
		  .result_size = sizeof job.nonfinite};
	shared in = {0}, out = {0};
	int width, height;
	random_size(&width, &height);
	scene s = random_scene(width, height);
	for (int i = 0; i < ENCRE_LAYER_COUNT; i++) {
		const encre_layer_description *layer = encre_layer_info(i);
		if (chance(layer->required ? 0.002 : 0.3))
			continue;
		job.layers[i] = picture(width, height, layer->channels, &in);
		paint(job.layers + i, content_of(i), &s);
	}
	for (int i = 0; i < ENCRE_OUTPUT_COUNT; i++)
		if (chance(0.6))
			job.outputs[i] = t.output[i] = picture(width, height, encre_output_info(i)->channels, &out);
	t.n_outputs = ENCRE_OUTPUT_COUNT;
	job.n_styles = chance(0.6) ? 1 : chance(0.95) ? whole(2, 6) : 256;
	job.params = chance(0.6) ? paired_params(k, job.n_styles) : random_params(job.n_styles);
	for (int i = 0, number; i < detector->n_items; i++) {
		memcpy(&number, (const char *)job.params + detector->offset, sizeof number);
		t.name = number == detector->items[i].number ? detector->items[i].id : t.name;
	}
	bool outputs = false;
	for (int i = 0; i < ENCRE_OUTPUT_COUNT; i++)
		outputs |= job.outputs[i].data != NULL;
	job.tell_strokes = outputs && k % 3 == 0 && !strcmp(t.name, "FINE");
	random_camera(&job.camera);
	job.frame = random_place(width, height);
	return t;
}
