/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Prints a hash of what a library draws for each value of each parameter, so that builds for other systems can be
 * compared with this one's: the picture that is drawn on comes of whole numbers and of sums and products alone.
 *
 *     goldens LIBRARY */
#include "encre.h"

#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#if defined _WIN32
#include <windows.h>
#define OPEN(path) ((void *)LoadLibraryA(path))
#define FIND(library, name) ((void *)GetProcAddress((HMODULE)(library), name))
#else
#include <dlfcn.h>
#define OPEN(path) dlopen(path, RTLD_NOW)
#define FIND(library, name) dlsym(library, name)
#endif

enum { WIDTH = 97, HEIGHT = 61 };

/* Functions of the library, under their own names with a capital. */
/* clang-format off */
#define FUNCTIONS(X) \
	X(create) X(destroy) X(error) X(set_threads) X(set_simd) X(layer_info) X(output_info) X(stage_info) \
	X(params_size) X(params_init) X(params_check) X(render) X(raster)
/* clang-format on */
#define POINTER(name) static __typeof__(&encre_##name) my_##name;
FUNCTIONS(POINTER)

static void *library;

static void find(const char *name, void *to)
{
	void *function = FIND(library, name);
	if (!function) {
		fprintf(stderr, "goldens: the library has no %s\n", name);
		exit(2);
	}
	memcpy(to, &function, sizeof function);
}

static uint64_t hash_of(const encre_image *images, int n)
{
	uint64_t hash = 0xcbf29ce484222325u; /* FNV-1a */
	for (int i = 0; i < n; i++) {
		const unsigned char *bytes = (const unsigned char *)images[i].data;
		size_t size = 4 * (size_t)images[i].width * (size_t)images[i].height * (size_t)images[i].channels;
		for (size_t k = 0; bytes && k < size; k++)
			hash = (hash ^ bytes[k]) * 0x100000001b3u;
	}
	return hash;
}

static encre_image image_of(int channels)
{
	return (encre_image){.data = calloc((size_t)channels * WIDTH * HEIGHT, 4),
			     .width = WIDTH,
			     .height = HEIGHT,
			     .channels = channels};
}

/* 0: nothing, 1: the ground, 2 to 5: discs before it. */
static int shape_at(int x, int y)
{
	static const int disc[][3] = {{20, 20, 14}, {60, 25, 19}, {75, 40, 11}, {35, 45, 9}};
	for (int k = 3; k >= 0; k--)
		if ((x - disc[k][0]) * (x - disc[k][0]) + (y - disc[k][1]) * (y - disc[k][1]) <=
		    disc[k][2] * disc[k][2])
			return k + 2;
	return y > 22;
}

static float value_at(int layer, int channel, int x, int y)
{
	int shape = shape_at(x, y);
	uint32_t grain = (uint32_t)(x * 73 + y * 151 + channel * 31 + shape * 977) * 2654435761u >> 24;
	float shade = (float)((shape * 53 + channel * 97) % 200 + 20) / 256;
	switch (layer) {
	case ENCRE_LAYER_COMBINED: return channel == 3 ? (float)(shape > 0) : shade * (float)(x + 20) / 128;
	case ENCRE_LAYER_DEPTH: return shape ? (float)(12 - 2 * shape) + (float)(x + 3 * y) / 512 : 1e10f;
	case ENCRE_LAYER_NORMAL:
	case ENCRE_LAYER_SEEN_NORMAL: return shape ? channel == (shape & 1) ? -0.8f : channel == 2 ? 0.6f : 0 : 0;
	case ENCRE_LAYER_OBJECT: return (float)shape;
	case ENCRE_LAYER_MATERIAL: return (float)(shape + x / 40);
	case ENCRE_LAYER_DIFFUSE: return (float)(x * y) / (WIDTH * HEIGHT) + (float)grain / 8192;
	case ENCRE_LAYER_CONTROLS: return channel < 2 ? (float)(y - 30) / 64 : 0;
	case ENCRE_LAYER_COLOR:
	case ENCRE_LAYER_ALBEDO:
	case ENCRE_LAYER_SEEN_COLOR: return shade + (float)grain / 16384;
	case ENCRE_LAYER_SPECULAR: return (float)grain / 4096;
	default: return 0;
	}
}

static void say(encre_context *context, int32_t code, const char *what, const char *value, const encre_image *images,
		int n)
{
	if (code)
		printf("%s %s: %s\n", what, value, my_error(context));
	else
		printf("%s %s: %016" PRIx64 "\n", what, value, hash_of(images, n));
}

static void draw(encre_job *job, const char *what, const char *value)
{
	char text[400];
	if (my_params_check(job->params, text, sizeof text))
		return;
	for (int simd = 0; simd < 2; simd++) {
		encre_context *context = my_create(ENCRE_API_VERSION);
		my_set_simd(context, simd);
		my_set_threads(context, 3);
		say(context, my_render(context, job), what, value, job->outputs, ENCRE_OUTPUT_COUNT);
		my_destroy(context);
	}
}

static void number(encre_job *job, char *at, const encre_param_info *p, double value)
{
	char name[64];
	snprintf(name, sizeof name, "%d", (int)(8 * value)); /* C libraries may print fractions otherwise */
	int32_t whole = (int32_t)value;
	float real = (float)value;
	memcpy(at, p->type == ENCRE_FLOAT ? (void *)&real : (void *)&whole, 4);
	draw(job, p->id, name);
}

static void vary(encre_job *job, char *params, const encre_param_info *p)
{
	char *at = params + p->offset, before[4];
	memcpy(before, at, 4);
	if (p->type == ENCRE_BOOL || p->type == ENCRE_ENUM) {
		int n = p->type == ENCRE_BOOL ? 2 : p->n_items;
		for (int32_t k = 0; k < n; k++) {
			int32_t value = p->type == ENCRE_BOOL ? k : (int32_t)p->items[k].number;
			memcpy(at, &value, 4);
			draw(job, p->id, p->type == ENCRE_BOOL ? k ? "on" : "off" : p->items[k].id);
		}
	} else if (p->type == ENCRE_FLOAT || p->type == ENCRE_INT) {
		number(job, at, p, p->soft_min);
		number(job, at, p, (p->soft_min + p->soft_max) / 2);
	}
	memcpy(at, before, 4);
}

/* What is off by default is on: a source of weight 0 shows nothing of its settings. */
static void enliven(encre_job *job, char *params, const encre_param_info *p)
{
	(void)job;
	float some = (float)(p->soft_min + 3 * p->soft_max) / 4;
	if (p->type == ENCRE_FLOAT && p->value[0] == 0)
		memcpy(params + p->offset, &some, 4);
}

static void each_param(encre_job *job, char *params, void (*act)(encre_job *, char *, const encre_param_info *))
{
	for (int s = 0; act && my_stage_info(s); s++)
		for (int k = 0; k < my_stage_info(s)->n_params; k++)
			act(job, params, my_stage_info(s)->params + k);
}

static const encre_param_info *row_of(const char *id)
{
	for (int s = 0; my_stage_info(s); s++)
		for (int k = 0; k < my_stage_info(s)->n_params; k++)
			if (!strcmp(my_stage_info(s)->params[k].id, id))
				return my_stage_info(s)->params + k;
	fprintf(stderr, "goldens: the library has no parameter %s\n", id);
	exit(2);
}

static void raster(void)
{
	static const float points[] = {-1, -1, -4, 2, -1, -5, 0, 2, -6, 1, 1, -3, -2, 1, -7};
	static const int32_t corners[] = {0, 1, 2, 0, 3, 2, 1, 4, 2, 0, 1, 4};
	encre_mesh mesh = {.n_primitives = 4, .n_points = 5, .points = points, .corners = corners, .object_index = 1};
	encre_raster_job job = {.meshes = &mesh, .n_meshes = 1, .clip_start = 0.1, .frame = {WIDTH, HEIGHT, 0, 0}};
	for (int k = 0; k < 4; k++)
		mesh.model[5 * k] = job.view[5 * k] = 1;
	memcpy(job.projection, (double[]){1.25, 0, 0, 0, 0, 2, 0, 0, 0, 0, -1, -0.25, 0, 0, -1, 0},
	       sizeof job.projection);
	job.depth = image_of(1);
	job.normal = image_of(3);
	job.object = image_of(1);
	job.anchor = image_of(16);
	encre_context *context = my_create(ENCRE_API_VERSION);
	encre_image images[] = {job.depth, job.normal, job.object, job.anchor};
	say(context, my_raster(context, &job), "raster", "", images, 4);
	my_destroy(context);
}

int main(int n, char **arguments)
{
	library = n > 1 ? OPEN(arguments[1]) : NULL;
	if (!library) {
		fprintf(stderr, "goldens: give a library that can be loaded here\n");
		return 2;
	}
#define FOUND(name) find("encre_" #name, &my_##name);
	FUNCTIONS(FOUND)
	encre_context *context = my_create(ENCRE_API_VERSION);
	if (!context) {
		fprintf(stderr, "goldens: %s\n", my_error(NULL));
		return 2;
	}
	my_destroy(context);
	encre_job job = {.camera = {{1, 0, 0, 0, 1, 0, 0, 0, 1}, 0, 0}, .frame = {WIDTH, HEIGHT, 0, 0}, .n_styles = 1};
	for (int i = 0; i < ENCRE_LAYER_COUNT; i++) {
		int channels = my_layer_info(i)->channels;
		job.layers[i] = image_of(channels);
		for (int k = 0; k < WIDTH * HEIGHT * channels; k++)
			job.layers[i].data[k] = value_at(i, k % channels, k / channels % WIDTH, k / channels / WIDTH);
	}
	for (int i = 0; i < ENCRE_OUTPUT_COUNT; i++)
		job.outputs[i] = image_of(my_output_info(i)->channels);
	char *params = malloc((size_t)my_params_size());
	job.params = params;
	for (int lively = 0; lively < 2; lively++)
		for (int k = 0; k < row_of("edge_detector")->n_items; k++) {
			int32_t detector = (int32_t)row_of("edge_detector")->items[k].number;
			my_params_init(params);
			each_param(&job, params, lively ? enliven : NULL);
			memcpy(params + row_of("edge_detector")->offset, &detector, 4);
			printf("detector %d, lively %d\n", (int)detector, lively);
			draw(&job, "as it is", "");
			each_param(&job, params, vary);
		}
	raster();
	return 0;
}
