/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Random jobs for the library. fuzz.c runs them and looks at what came back, pictures.c makes images, render.c,
 * raster.c, light.c, material.c and bake.c one kind of job each, samples.c two. A seed is a job: the same one on every
 * machine. */
#ifndef ENCRE_FUZZ_H
#define ENCRE_FUZZ_H

#include "encre.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* ---- chance (fuzz.c) --------------------------------------------------------------------------------------- */

uint64_t bits(void);
double share(void); /* 0 <= share < 1 */
int whole(int low, int high);
bool chance(double probability);
/* A number between both, often one of them; and the same by orders of magnitude. */
double between(double low, double high);
double magnitude(int low, int high);
/* No number, infinite, tiny, huge, a zero. */
float weird(void);
int32_t weird_int(void);

/* ---- memory (fuzz.c) --------------------------------------------------------------------------------------- */

/* Memory of the job, exactly so long, filled with a pattern. After the job nothing of it may have changed but samples
 * of outputs. */
void *take(size_t size);

/* ---- images (pictures.c) ----------------------------------------------------------------------------------- */

/* An image in memory of its own: packed, or with gaps, bottom-up, column by column, or beside other images. `beside`:
 * where that memory is remembered between images of one size; NULL: never shared. */
typedef struct shared {
	char *at;
	int64_t pixel_stride, row_stride, used;
} shared;

encre_image picture(int width, int height, int channels, shared *beside);
float *sample(const encre_image *image, int x, int y);

/* What an image shows. */
enum content { COLORS, LIGHTS, DEPTHS, DIRECTIONS, NUMBERS, SHARES };

/* One scene of shapes that all layers of a job show, and how much of them is no number. */
typedef struct scene {
	int n_shapes, noise;
	double weird;
	struct shape {
		double x, y, size, slope;
		int kind;
		double value[ENCRE_MAX_CHANNELS];
	} shape[8];
} scene;

scene random_scene(int width, int height);
void paint(const encre_image *image, enum content content, const scene *s);

/* ---- parameters (render.c) --------------------------------------------------------------------------------- */

/* A block that mostly can be rendered with. */
void *random_params(int count);
/* Blocks of which each pair of parameters, over all values of the first enum, comes once in pair_count() of k. */
void *paired_params(uint64_t k, int count);
uint64_t pair_count(void);

/* ---- places (raster.c) ------------------------------------------------------------------------------------- */

void random_matrix(double m[16]);
/* n triples: soups, grids, flat or odd ones, in front of the camera. */
float *random_triples(int n);
void random_lens(double view[16], double projection[16], double *clip_start, double *clip_end);

/* ---- jobs -------------------------------------------------------------------------------------------------- */

/* A job that is ready to run; outputs are those whose samples may change. */
typedef struct task {
	const char *name; /* what it tries: hashes are told by it */
	int32_t (*run)(encre_context *context, void *job);
	int32_t kind; /* enum encre_kind: the same in the background */
	void *job;
	encre_progress *progress; /* of the job */
	encre_image output[16];
	int n_outputs;
	bool any_number[16]; /* what the output holds may be no number */
	bool in_place;       /* its first output is what it reads, too: done twice is more than once */
	const void *result;  /* what else comes back, and how long it is */
	size_t result_size;
} task;

task random_render(uint64_t k);
task random_raster(void);
task random_bake(void);
task random_light(void);
task random_material(void);
task random_even(void);
task random_average(void);

#endif
