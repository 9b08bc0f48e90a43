/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A frame: layers are made clean and packed, then the stages run in order. */
#include "api/check.h"
#include "api/context.h"
#include "base/clean.h"

#include <stdlib.h>
#include <string.h>

#define POINTER(name) &JOIN(stage, JOIN_(name, base)),
static const stage *const stages_base[] = {STAGES(POINTER)};
#undef POINTER
#ifdef ENCRE_HAVE_V3
#define POINTER(name) &JOIN(stage, JOIN_(name, v3)),
static const stage *const stages_v3[] = {STAGES(POINTER)};
#undef POINTER
#endif
enum { N_STAGES = sizeof stages_base / sizeof *stages_base };

static const stage *const *stages_of(const encre_context *context)
{
	return use_best(context) ? BEST(stages) : stages_base;
}

typedef struct work {
	encre_context *context;
	encre_job *job;
	frame f;
	encre_image in[ENCRE_LAYER_COUNT], out[ENCRE_OUTPUT_COUNT];
	bool copy[ENCRE_LAYER_COUNT];
	uint8_t *style;
} work;

/* ---- nothing is drawn ------------------------------------------------------------------------------------ */

static void blank_rows(void *data, int y0, int y1, int thread)
{
	(void)thread;
	const encre_image *image = data;
	for (int y = y0; y < y1; y++)
		for (int x = 0; x < image->width; x++)
			memset((char *)image->data + y * image->row_stride + x * image->pixel_stride, 0,
			       4 * (size_t)image->channels);
}

/* All switches are off, and nobody asks for edges or light: one way from the layer `combined` to what goes out. */
static int32_t copy(work *w)
{
	static const int pictures[] = {ENCRE_OUTPUT_COMBINED, ENCRE_OUTPUT_SURFACE};
	const encre_image *combined = w->in + ENCRE_LAYER_COMBINED;
	int64_t *bad = &w->job->nonfinite, counted = 0;
	int32_t code = ENCRE_OK;
	bool read = false;
	for (int i = 0; !code && i < 2; i++)
		if (w->out[pictures[i]].data) {
			code = clean_copy(w->f.bands, combined, ENCRE_LAYER_COMBINED, w->out + pictures[i],
					  read ? &counted : bad);
			read = true;
		}
	if (!code && !read)
		code = clean_scan(w->f.bands, combined, ENCRE_LAYER_COMBINED, bad, &read);
	if (!code && w->out[ENCRE_OUTPUT_LINES].data)
		code = bands_run(w->f.bands, w->f.height, 0, blank_rows, w->out + ENCRE_OUTPUT_LINES);
	return code;
}

/* ---- stages ---------------------------------------------------------------------------------------------- */

static plane plane_of(const encre_image *image)
{
	return (plane){image->data, (ptrdiff_t)(image->row_stride / 4)};
}

/* Counts what is not finite and finds which layers must be copied. */
static int32_t scan(work *w)
{
	for (int i = 0; i < ENCRE_LAYER_COUNT; i++) {
		if (!w->in[i].data)
			continue;
		int32_t code = clean_scan(w->f.bands, w->in + i, i, &w->job->nonfinite, w->copy + i);
		if (code)
			return code;
	}
	return ENCRE_OK;
}

static void plan(work *w, arena *a)
{
	frame *f = &w->f;
	size_t n = (size_t)f->width * (size_t)f->height;
	for (int i = 0; i < ENCRE_LAYER_COUNT; i++) {
		f->layer[i] = plane_of(w->in + i);
		if (!w->copy[i])
			continue;
		float *copy = arena_take(a, n, 4 * (size_t)encre_layer_info(i)->channels);
		/* while measuring the original stands in: a stage's plan may ask whether a layer is there */
		f->layer[i] = (plane){copy ? copy : w->in[i].data, (ptrdiff_t)f->width * encre_layer_info(i)->channels};
	}
	if (!f->layer[ENCRE_LAYER_ALBEDO].data)
		f->layer[ENCRE_LAYER_ALBEDO] = f->layer[ENCRE_LAYER_COLOR];
	for (int i = 0; i < ENCRE_OUTPUT_COUNT; i++)
		if (w->out[i].data && packed(w->out + i))
			f->output[i] = plane_of(w->out + i);
		else if (w->out[i].data || i == ENCRE_OUTPUT_COMBINED)
			f->output[i] = (plane){arena_take(a, n, 4 * (size_t)encre_output_info(i)->channels),
					       (ptrdiff_t)f->width * encre_output_info(i)->channels};
	w->style = f->n_styles > 1 ? arena_take(a, n, 1) : NULL;
	f->style = w->style;
	const stage *const *stages = stages_of(w->context);
	f->edge = f->near = NULL;
	f->strength = NULL;
	f->nearest = NULL;
	f->nearest_planned = false;
	for (int s = 0; s < N_STAGES; s++)
		if (stages[s]->plan)
			stages[s]->plan(f, a);
}

static void style_rows(void *data, int y0, int y1, int thread)
{
	(void)thread;
	work *w = data;
	plane p = w->f.layer[ENCRE_LAYER_STYLE];
	for (int y = y0; y < y1; y++) {
		uint8_t *out = w->style + (size_t)y * (size_t)w->f.width;
		for (int x = 0; x < w->f.width; x++) {
			float v = p.data ? p.data[y * p.row + x] : 0;
			out[x] = v >= 1 && v < (float)w->f.n_styles ? (uint8_t)v : 0;
		}
	}
}

static void export_rows(void *data, int y0, int y1, int thread)
{
	(void)thread;
	work *w = data;
	for (int i = 0; i < ENCRE_OUTPUT_COUNT; i++) {
		const encre_image *image = w->out + i;
		if (!image->data || packed(image))
			continue;
		for (int y = y0; y < y1; y++)
			for (int x = 0; x < w->f.width; x++)
				memcpy((char *)image->data + y * image->row_stride + x * image->pixel_stride,
				       w->f.output[i].data + y * w->f.output[i].row + (ptrdiff_t)x * image->channels,
				       4 * (size_t)image->channels);
	}
}

static int32_t clean_layer(work *w, int i)
{
	encre_image to = w->in[i];
	int64_t counted = 0;
	to.data = w->f.layer[i].data;
	to.pixel_stride = 4 * (int64_t)to.channels;
	to.row_stride = 4 * (int64_t)w->f.layer[i].row;
	return clean_copy(w->f.bands, w->in + i, i, &to, &counted);
}

static int32_t run(work *w)
{
	frame *f = &w->f;
	const stage *const *stages = stages_of(w->context);
	int32_t code = ENCRE_OK;
	for (int i = 0; !code && i < ENCRE_LAYER_COUNT; i++)
		if (w->copy[i])
			code = clean_layer(w, i);
	if (!code && w->style)
		code = bands_run(f->bands, f->height, 0, style_rows, w);
	for (int s = 0; !code && s < N_STAGES; s++) {
		bands_span(f->bands, (s + 0.5) / (N_STAGES + 1), (s + 1.5) / (N_STAGES + 1));
		code = stages[s]->run(f);
	}
	bands_span(f->bands, (N_STAGES + 0.5) / (N_STAGES + 1), 1);
	return code ? code : bands_run(f->bands, f->height, 0, export_rows, w);
}

int32_t encre_render(encre_context *context, encre_job *job)
{
	work w = {.context = context, .job = job};
	int32_t code = enter(context);
	if (!code)
		code = check_job(job, w.in, w.out, context->error, sizeof context->error);
	if (code)
		return code;
	frame *f = &w.f;
	f->width = w.in[0].width;
	f->height = w.in[0].height;
	f->camera = job->camera;
	f->place = job->frame;
	f->params = job->params;
	f->n_styles = job->n_styles;
	f->scale = scale_of(f->params, f->place.height);
	bool any = w.out[ENCRE_OUTPUT_EDGES].data || w.out[ENCRE_OUTPUT_LIGHT].data;
	for (int i = 0; i < f->n_styles; i++) {
		any |= draws(f->params + i);
#define SWITCH(id, ...) f->any.id |= f->params[i].id;
#include "base/all.rows.h"
	}
	f->want_edges = w.out[ENCRE_OUTPUT_EDGES].data;
	for (int s = 0; s < N_STAGES; s++)
		f->want_edges |= stages_base[s]->reads_edges && stages_base[s]->reads_edges(f);
	f->bands = pool_of(context, job->progress, job->user);
	if (!f->bands)
		return fail_code(context, ENCRE_ERROR_MEMORY);
	job->nonfinite = 0;
	if (!any)
		return fail_code(context, copy(&w));
	bands_span(f->bands, 0, 0.5 / (N_STAGES + 1));
	code = scan(&w);
	if (code)
		return fail_code(context, code);

	arena a = {0};
	plan(&w, &a);
	char *memory = a.used <= SIZE_MAX - 64 ? malloc(a.used + 64) : NULL;
	if (!memory)
		return fail_code(context, ENCRE_ERROR_MEMORY);
	a = (arena){memory + (64 - (uintptr_t)memory % 64), 0};
	plan(&w, &a);
	code = run(&w);
	late_free(f->late);
	free(memory);
	return fail_code(context, code);
}
