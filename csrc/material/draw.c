/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The job: pixels of a band are sorted by material, so that programs run for full blocks. */
#include "base/arena.h"
#include "base/bands.h"
#include "base/pixel.h"
#include "material/eye.h"
#include "material/material.h"

#include <stdlib.h>
#include <string.h>

enum {
	BAND = 16,    /* rows whose pixels are sorted together */
	SAMPLES = 13, /* of a pixel of a pattern with jumps */
};

static const float alike = 0.9f; /* cosine from which on neighbours face alike */

typedef struct pixel {
	uint16_t x, row; /* row of the band */
} pixel;

typedef struct drawing {
	const encre_material_job *job;
	const bands *pool;
	const encre_materials *materials;
	int width, height, most_registers, most_operations;
	eye eye;
	/* per thread */
	block *blocks;
	float *reg, *reach;
	float (*results)[MATERIAL_BLOCK]; /* ENCRE_RESULTS */
	uint8_t *wanted;                  /* most_operations */
	pixel *sorted;                    /* BAND x width */
	uint32_t *from;                   /* n_programs + 1 */
} drawing;

/* The material of what a pixel shows; -1: nothing. */
static inline int32_t material_at(const drawing *d, int x, int y)
{
	if (!(*pixel_at(&d->job->object, x, y) > 0))
		return -1;
	float number = *pixel_at(&d->job->material, x, y);
	return number >= 0 && number < (float)d->materials->n_programs ? (int32_t)number : -1;
}

static inline float job_depth(const drawing *d, int x, int y)
{
	return *pixel_at(&d->job->depth, x, y);
}

/* On which side along a way, 1 or -1, the neighbour of the same surface lies to which n attributes change least, or
 * else the depth, because across a seam the other is far; 0: there is none. For bumps none is taken that faces
 * elsewhere, as beyond a crease, if the other does not. */
static int side_along(const drawing *d, int x, int y, int dx, int dy, int n, bool bumps)
{
	const encre_material_job *job = d->job;
	const float *own = n ? pixel_at(&job->attributes, x, y) : pixel_at(&job->depth, x, y);
	float least = INFINITY;
	bool turned = true; /* what was found */
	int found = 0;
	for (int side = -1; side <= 1; side += 2) {
		int px = x + side * dx, py = y + side * dy;
		if (px < 0 || py < 0 || px >= d->width || py >= d->height ||
		    *pixel_at(&job->object, px, py) != *pixel_at(&job->object, x, y) ||
		    *pixel_at(&job->material, px, py) != *pixel_at(&job->material, x, y))
			continue;
		const float *other = n ? pixel_at(&job->attributes, px, py) : pixel_at(&job->depth, px, py);
		float sum = 0;
		for (int c = 0; c < (n ? n : 1); c++)
			sum += fabsf(other[c] - own[c]);
		bool elsewhere = false;
		if (bumps) {
			const float *one = pixel_at(&job->normal, x, y), *two = pixel_at(&job->normal, px, py);
			elsewhere = one[0] * two[0] + one[1] * two[1] + one[2] * two[2] < alike;
		}
		if (sum < INFINITY && (elsewhere < turned || (elsewhere == turned && sum < least))) {
			least = sum;
			turned = elsewhere;
			found = side;
		}
	}
	return found;
}

/* What a program of its operations reads. */
typedef struct reads {
	bool channels, steps, place, normal, beside, looked;
	bool jumps; /* whether what it computes jumps from place to place */
} reads;

/* By how much attributes and the place change along a way. */
static void step_along(const drawing *d, block *b, int i, int x, int y, int down, int channels, const reads *r)
{
	int dx = !down, dy = down;
	int side = side_along(d, x, y, dx, dy, channels, r->beside);
	float (*to)[MATERIAL_BLOCK] = down ? b->down : b->right;
	const float *own = channels ? pixel_at(&d->job->attributes, x, y) : NULL;
	const float *other = channels ? pixel_at(&d->job->attributes, x + side * dx, y + side * dy) : NULL;
	for (int c = 0; c < channels; c++)
		to[c][i] = (float)side * (other[c] - own[c]);
	if (r->beside || (r->place && r->jumps)) {
		double here[3], there[3];
		eye_place(&d->eye, job_depth(d, x, y), x, y, here);
		eye_place(&d->eye, job_depth(d, x + side * dx, y + side * dy), x + side * dx, y + side * dy, there);
		for (int c = 0; c < 3; c++)
			b->beside[down][c][i] = (float)(side * (there[c] - here[c]));
	}
}

static void load(const drawing *d, block *b, const pixel *pixels, int n, int y0, const reads *r)
{
	const encre_material_job *job = d->job;
	int channels = job->attributes.data ? job->attributes.channels : 0;
	b->n = n;
	for (int i = 0; i < n; i++) {
		int x = pixels[i].x, y = y0 + pixels[i].row;
		b->thing[i] = (int32_t)min(*pixel_at(&job->object, x, y), 1e9f);
		if (r->channels)
			for (int c = 0; c < channels; c++)
				b->channel[c][i] = pixel_at(&job->attributes, x, y)[c];
		for (int down = 0; (r->steps || r->beside || r->jumps) && down < 2; down++)
			step_along(d, b, i, x, y, down, channels, r);
		if (r->normal)
			for (int c = 0; c < 3; c++)
				b->normal[c][i] = pixel_at(&job->normal, x, y)[c];
		if (r->looked)
			eye_looks(&d->eye, b, i, job_depth(d, x, y), x, y);
		if (r->place) {
			double place[3];
			eye_place(&d->eye, job_depth(d, x, y), x, y, place);
			for (int c = 0; c < 3; c++)
				b->place[c][i] = (float)place[c];
		}
	}
}

/* Runs a block's program for the middle of its pixels. */
static void run(block *b, float *reach, float results[][MATERIAL_BLOCK])
{
	b->wants = LEADS;
	b->reach = reach;
	b->aside[0] = b->aside[1] = 0;
	ISA(material_run)(b);
	for (int c = 0; c < ENCRE_RESULTS; c++)
		memcpy(results[c], b->reg + (size_t)b->program->result[c] * MATERIAL_BLOCK, sizeof results[c]);
}

/* What operations are there for. Bumps look at places beside the pixel by themselves. */
static void want(const encre_program *p, uint8_t *wanted)
{
	uint8_t read[ENCRE_MAX_REGISTERS] = {0};
	for (int c = 0; c < ENCRE_RESULTS; c++)
		read[p->result[c]] |=
			c < ENCRE_RESULT_TURNED || c == ENCRE_RESULT_HOLDOUT ? LEADS | LEADS_ASIDE : LEADS;
	for (int k = p->n_operations - 1; k >= 0; k--) {
		const encre_operation *o = p->operations + k;
		const encre_operation_description *what = operation_info(o->code);
		uint8_t leads = 0;
		for (int i = 0; i < what->outputs; i++) {
			leads |= read[o->out + i];
			read[o->out + i] = 0;
		}
		for (int i = 0; i < what->inputs; i++)
			read[o->in[i]] |= leads;
		wanted[k] = leads | (leads & LEADS_ASIDE && operation_jumps(o->code) ? JUMPS : 0);
	}
}

/* Whether a place, as the block has just been run, is as dense as the middle of pixel i, and as much of a hole. */
static bool same_cut(const block *b, float results[][MATERIAL_BLOCK], int i)
{
	const float *alpha = b->reg + (size_t)b->program->result[ENCRE_RESULT_ALPHA] * MATERIAL_BLOCK;
	const float *hole = b->reg + (size_t)b->program->result[ENCRE_RESULT_HOLDOUT] * MATERIAL_BLOCK;
	return alpha[i] == results[ENCRE_RESULT_ALPHA][i] && hole[i] == results[ENCRE_RESULT_HOLDOUT][i];
}

/* The mean over pixels that may jump of what run() gave, normals aside: a joint narrower than a pixel is faint, and not
 * there at some pixels only. The places lie on a lattice, a thirteenth of a pixel apart in rows and in columns. What is
 * there at the middle of a pixel fills it, so that a cut-out has no fringe: other places don't count. */
static void average(block *b, float results[][MATERIAL_BLOCK])
{
	float count[MATERIAL_BLOCK];
	for (int i = 0; i < MATERIAL_BLOCK; i++)
		count[i] = 1;
	b->wants = LEADS_ASIDE;
	b->reach = NULL;
	for (int k = 1; k < SAMPLES; k++) {
		b->aside[0] = (float)(k - (k > SAMPLES / 2 ? SAMPLES : 0)) / SAMPLES;
		int row = 5 * k % SAMPLES;
		b->aside[1] = (float)(row - (row > SAMPLES / 2 ? SAMPLES : 0)) / SAMPLES;
		ISA(material_run)(b);
		const int32_t *from = b->program->result;
		float share[MATERIAL_BLOCK];
		for (int i = 0; i < MATERIAL_BLOCK; i++) {
			share[i] = b->jump[i] && same_cut(b, results, i) ? 1 : 0;
			count[i] += share[i];
		}
		for (int c = 0; c < ENCRE_RESULT_TURNED; c++) {
			const float *value = b->reg + (size_t)from[c] * MATERIAL_BLOCK;
			for (int i = 0; c != ENCRE_RESULT_ALPHA && i < MATERIAL_BLOCK; i++)
				results[c][i] += share[i] > 0 ? value[i] : 0;
		}
	}
	for (int c = 0; c < ENCRE_RESULT_TURNED; c++)
		for (int i = 0; c != ENCRE_RESULT_ALPHA && i < MATERIAL_BLOCK; i++)
			results[c][i] /= count[i];
}

static void store(const encre_image *image, int channels, float least, int n, float results[][MATERIAL_BLOCK],
		  const pixel *pixels, int y0)
{
	if (!image->data)
		return;
	for (int i = 0; i < n; i++)
		for (int c = 0; c < channels; c++) {
			float value = results[c][i];
			pixel_at(image, pixels[i].x, y0 + pixels[i].row)[c] = min(max(value, least), FLT_MAX);
		}
}

static reads reads_of(const encre_program *p, const uint8_t *wanted)
{
	reads r = {0};
	for (int k = 0; k < p->n_operations; k++) {
		const char *name = operation_info(p->operations[k].code)->name;
		r.channels |= wanted[k] && !strcmp(name, "channel");
		r.steps |= wanted[k] && !strcmp(name, "footprint");
		r.place |= wanted[k] && !strcmp(name, "place");
		r.normal |= wanted[k] && !strcmp(name, "normal");
		r.beside |= wanted[k] && !strcmp(name, "beside");
		r.looked |= wanted[k] && (!strcmp(name, "incoming") || !strcmp(name, "camera"));
		r.jumps |= wanted[k] & JUMPS;
	}
	return r;
}

/* Sorts the pixels of rows y0..y1-1 by material; from[m] is where those of m begin. */
static void sort(const drawing *d, int y0, int y1, pixel *sorted, uint32_t *from)
{
	int n = d->materials->n_programs;
	memset(from, 0, ((size_t)n + 1) * sizeof *from);
	for (int y = y0; y < y1; y++)
		for (int x = 0; x < d->width; x++) {
			int32_t m = material_at(d, x, y);
			if (m >= 0)
				from[m]++;
		}
	uint32_t sum = 0;
	for (int m = 0; m <= n; m++) { /* the end of each, which filing from behind makes its beginning */
		sum += m < n ? from[m] : 0;
		from[m] = sum;
	}
	for (int y = y1 - 1; y >= y0; y--)
		for (int x = d->width - 1; x >= 0; x--) {
			int32_t m = material_at(d, x, y);
			if (m >= 0)
				sorted[--from[m]] = (pixel){(uint16_t)x, (uint16_t)(y - y0)};
		}
}

static void clear(const encre_image *image, int y0, int y1)
{
	size_t pixel = (size_t)image->channels * sizeof(float);
	bool dense = image->pixel_stride == (int64_t)pixel;
	for (int y = y0; image->data && y < y1; y++)
		for (int x = 0; x < (dense ? 1 : image->width); x++)
			memset(pixel_at(image, x, y), 0, dense ? (size_t)image->width * pixel : pixel);
}

/* Draws n pixels of one material, by their middles, or, `aside`, by the mean. Begins the list with those in which the
 * program may jump, and returns how many. A block with more of them than others is drawn by the mean at once: to load
 * them again takes longer than to run the others along. */
static uint32_t draw_pixels(const drawing *d, block *b, const reads *r, pixel *pixels, uint32_t n, int y0, int thread,
			    bool aside)
{
	const encre_material_job *job = d->job;
	float (*results)[MATERIAL_BLOCK] = d->results + (size_t)thread * ENCRE_RESULTS;
	float *reach = d->reach + (size_t)thread * (size_t)d->most_registers * MATERIAL_BLOCK;
	uint32_t left = 0;
	for (uint32_t k = 0; k < n && !bands_stopped(d->pool); k += MATERIAL_BLOCK) {
		pixel *from = pixels + k;
		int jumping = 0;
		load(d, b, from, (int)(n - k < MATERIAL_BLOCK ? n - k : MATERIAL_BLOCK), y0, r);
		memset(b->jump, aside, sizeof b->jump);
		run(b, r->jumps && !aside ? reach : NULL, results);
		for (int i = 0; i < b->n; i++)
			jumping += b->jump[i];
		bool whole = 2 * jumping > b->n;
		if (whole)
			average(b, results);
		store(&job->color, 3, 0, b->n, results + ENCRE_RESULT_COLOR, from, y0);
		store(&job->gloss, 3, 0, b->n, results + ENCRE_RESULT_GLOSS, from, y0);
		store(&job->emission, 3, 0, b->n, results + ENCRE_RESULT_EMISSION, from, y0);
		store(&job->surface, 2, 0, b->n, results + ENCRE_RESULT_ALPHA, from, y0);
		store(&job->shine, 6, 0, b->n, results + ENCRE_RESULT_SHINE, from, y0);
		store(&job->turned, 3, -FLT_MAX, b->n, results + ENCRE_RESULT_TURNED, from, y0);
		store(&job->holdout, 1, 0, b->n, results + ENCRE_RESULT_HOLDOUT, from, y0);
		for (int i = 0; !whole && i < b->n; i++)
			if (b->jump[i])
				pixels[left++] = from[i];
	}
	return left;
}

static void draw_band(const drawing *d, int y0, int y1, int thread)
{
	const encre_material_job *job = d->job;
	block *b = d->blocks + thread;
	pixel *sorted = d->sorted + (size_t)thread * BAND * (size_t)d->width;
	uint32_t *from = d->from + (size_t)thread * ((size_t)d->materials->n_programs + 1);
	uint8_t *wanted = d->wanted + (size_t)thread * (size_t)d->most_operations;
	b->materials = d->materials;
	b->wanted = wanted;
	b->reg = d->reg + (size_t)thread * (size_t)d->most_registers * MATERIAL_BLOCK;
	const encre_image *all[] = {&job->color, &job->gloss,  &job->emission, &job->surface,
				    &job->shine, &job->turned, &job->holdout};
	for (size_t k = 0; k < sizeof all / sizeof *all; k++)
		clear(all[k], y0, y1);
	sort(d, y0, y1, sorted, from);
	for (int m = 0; m < d->materials->n_programs; m++) {
		if (from[m] == from[m + 1])
			continue;
		b->program = d->materials->programs + m;
		want(b->program, wanted);
		reads r = reads_of(b->program, wanted);
		pixel *pixels = sorted + from[m];
		uint32_t jumping = draw_pixels(d, b, &r, pixels, from[m + 1] - from[m], y0, thread, false);
		draw_pixels(d, b, &r, pixels, jumping, y0, thread, true);
	}
}

static void draw_bands(void *data, int b0, int b1, int thread)
{
	const drawing *d = data;
	for (int i = b0; i < b1; i++)
		draw_band(d, i * BAND, (i + 1) * BAND < d->height ? (i + 1) * BAND : d->height, thread);
}

static void plan(drawing *d, int threads, arena *a)
{
	size_t n = (size_t)threads;
	d->blocks = arena_take(a, n, sizeof *d->blocks);
	d->reg = arena_take(a, n * (size_t)d->most_registers * MATERIAL_BLOCK, sizeof *d->reg);
	d->reach = arena_take(a, n * (size_t)d->most_registers * MATERIAL_BLOCK, sizeof *d->reach);
	d->results = arena_take(a, n * ENCRE_RESULTS, sizeof *d->results);
	d->wanted = arena_take(a, n * (size_t)d->most_operations, sizeof *d->wanted);
	d->sorted = arena_take(a, n * BAND * (size_t)d->width, sizeof *d->sorted);
	d->from = arena_take(a, n * ((size_t)d->materials->n_programs + 1), sizeof *d->from);
}

int32_t ISA(material_draw)(bands *pool, const encre_material_job *job)
{
	drawing d = {.job = job,
		     .pool = pool,
		     .materials = job->materials,
		     .width = job->object.width,
		     .height = job->object.height};
	for (int m = 0; m < d.materials->n_programs; m++) {
		const encre_program *p = d.materials->programs + m;
		d.most_registers = p->n_registers > d.most_registers ? p->n_registers : d.most_registers;
		d.most_operations = p->n_operations > d.most_operations ? p->n_operations : d.most_operations;
	}
	d.eye = eye_of(job);
	arena a = {0};
	plan(&d, bands_threads(pool), &a);
	void *memory = arena_make(&a);
	if (!memory)
		return ENCRE_ERROR_MEMORY;
	plan(&d, bands_threads(pool), &a);
	memset(d.blocks, 0, (size_t)bands_threads(pool) * sizeof *d.blocks);
	bands_span(pool, 0, 1);
	int32_t code = bands_run(pool, (d.height - 1) / BAND + 1, 1, draw_bands, &d);
	free(memory);
	return code;
}
