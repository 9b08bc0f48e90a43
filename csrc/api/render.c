/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A frame: the stages run in order, on layers that are clean and packed. That most are shows only when all is read, and
 * so the first stages draw with that same reading, on trust; the few frames with a value that is none lose that work.
 */
#include "api/check.h"
#include "api/context.h"
#include "base/clean.h"

#include <stdatomic.h>
#include <string.h>

#define POINTER(name) &JOIN(stage, JOIN_(name, base)),
static const stage *const stages_base[] = {STAGES(POINTER)};
#undef POINTER
#ifdef ENCRE_HAVE_V3
#define POINTER(name) &JOIN(stage, JOIN_(name, v3)),
static const stage *const stages_v3[] = {STAGES(POINTER)};
#undef POINTER
#endif

static const stage *const *stages_of(const encre_context *context)
{
	return use_best(context) ? BEST(stages) : stages_base;
}

typedef struct work {
	encre_context *context;
	encre_job *job;
	frame f;
	encre_image in[ENCRE_LAYER_COUNT], out[ENCRE_OUTPUT_COUNT];
	bool copy[ENCRE_LAYER_COUNT]; /* stages read one */
	uint8_t *style;
	const cleaner *clean;
	int early;          /* stages up to this one draw, if at all, with the first reading */
	const stage *later; /* the one that draws after it */
	bool looked;
	atomic_bool unclean[ENCRE_LAYER_COUNT], any_unclean;
	atomic_llong bad;
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

static void look_rows(void *data, int y0, int y1, int thread)
{
	(void)thread;
	work *w = data;
	int64_t bad = 0;
	for (int y = y0; y < y1; y++)
		w->clean->look(w->in + ENCRE_LAYER_COMBINED, ENCRE_LAYER_COMBINED, y, &bad);
	atomic_fetch_add(&w->bad, bad);
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
			code = w->clean->copy(w->f.bands, combined, ENCRE_LAYER_COMBINED, w->out + pictures[i],
					      read ? &counted : bad);
			read = true;
		}
	if (!code && !read) {
		code = bands_run(w->f.bands, w->f.height, 0, look_rows, w);
		*bad += atomic_load(&w->bad);
	}
	static const int inks[] = {ENCRE_OUTPUT_LINES, ENCRE_OUTPUT_TONES};
	for (int i = 0; !code && i < 2; i++)
		if (w->out[inks[i]].data)
			code = bands_run(w->f.bands, w->f.height, 0, blank_rows, w->out + inks[i]);
	return code;
}

/* ---- stages ---------------------------------------------------------------------------------------------- */

static plane plane_of(const encre_image *image)
{
	return (plane){image->data, (ptrdiff_t)(image->row_stride / 4)};
}

/* Without an own layer of colours, edges compare those of surfaces. */
static void stand_in(work *w)
{
	if (!w->in[ENCRE_LAYER_ALBEDO].data)
		w->f.layer[ENCRE_LAYER_ALBEDO] = w->f.layer[ENCRE_LAYER_COLOR];
}

/* Whether what runs after needs the whole picture first. */
static bool draws_whole(const stage *s, const frame *f)
{
	return s->run && (!s->draws || s->draws(f));
}

/* The stage of edges is the first, and plans in memory of its own. */
static void plan(work *w, arena *a, arena *edges)
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
	stand_in(w);
	for (int i = 0; i < ENCRE_OUTPUT_COUNT; i++)
		if (w->out[i].data && packed(w->out + i))
			f->output[i] = plane_of(w->out + i);
		else if (w->out[i].data || i == ENCRE_OUTPUT_COMBINED)
			f->output[i] = (plane){arena_take(a, n, 4 * (size_t)encre_output_info(i)->channels),
					       (ptrdiff_t)f->width * encre_output_info(i)->channels};
	f->reads = 0;
	for (int i = 0; i < ENCRE_LAYER_COUNT; i++)
		if (f->layer[i].data && !w->copy[i] && w->in[i].data) {
			f->read[f->reads].from = f->layer[i];
			f->read[f->reads++].channels = encre_layer_info(i)->channels;
		}
	f->read[f->reads].from = f->output[ENCRE_OUTPUT_COMBINED];
	f->read[f->reads++].channels = encre_output_info(ENCRE_OUTPUT_COMBINED)->channels;
	f->ahead = arena_take(a, (size_t)bands_threads(f->bands), sizeof *f->ahead);
	for (int i = 0; f->ahead && i < bands_threads(f->bands); i++)
		f->ahead[i] = (ahead){0};
	w->style = f->n_styles > 1 ? arena_take(a, n, 1) : NULL;
	f->style = w->style;
	const stage *const *stages = stages_of(w->context);
	f->edge = f->near = NULL;
	f->strength = NULL;
	f->nearest = NULL;
	f->nearest_planned = f->search_planned = f->search_done = false;
	f->hatches_along = true;
	for (int s = STAGE_shade + 1; s < STAGE_hatch; s++)
		f->hatches_along &= !draws_whole(stages[s], f);
	for (int s = 0; s < N_STAGES; s++)
		if (stages[s]->plan)
			stages[s]->plan(f, s ? a : edges);
}

/* What is not finite is none of the numbers. */
static void style_rows(void *data, int y0, int y1, int thread)
{
	(void)thread;
	const work *w = data;
	plane p = w->f.layer[ENCRE_LAYER_STYLE];
	for (int y = y0; y < y1; y++) {
		uint8_t *out = w->style + (size_t)y * (size_t)w->f.width;
		for (int x = 0; x < w->f.width; x++) {
			float v = p.data ? p.data[y * p.row + x] : 0;
			out[x] = v >= 1 && v < (float)w->f.n_styles ? (uint8_t)v : 0;
		}
	}
}

/* Counts what is not finite and finds which layers must be copied. */
static void look_at(work *w, int y0, int y1)
{
	int64_t bad = 0;
	for (int i = 0; i < ENCRE_LAYER_COUNT; i++)
		for (int y = y0; w->in[i].data && !w->copy[i] && y < y1; y++)
			if (!w->clean->look(w->in + i, i, y, &bad)) {
				atomic_store(w->unclean + i, true);
				atomic_store(&w->any_unclean, true);
			}
	atomic_fetch_add(&w->bad, bad);
}

static void first_rows(void *data, int y0, int y1, int thread)
{
	work *w = data;
	const stage *const *stages = stages_of(w->context);
	for (int y = y0, end; y < y1 && !bands_stopped(w->f.bands); y = end) {
		end = y1 - y < NEAR_ROWS ? y1 : y + NEAR_ROWS;
		if (!w->looked)
			look_at(w, y, end);
		w->f.ahead[thread] = (ahead){.y = end, .end = y1 - end < NEAR_ROWS ? y1 : end + NEAR_ROWS};
		for (int s = 0; s < w->early && !atomic_load(&w->any_unclean) && !bands_stopped(w->f.bands); s++)
			if (stages[s]->rows)
				stages[s]->rows(&w->f, y, end, thread);
		for (int s = 0; s < N_STAGES && !atomic_load(&w->any_unclean) && !bands_stopped(w->f.bands); s++)
			if (stages[s]->first_rows)
				stages[s]->first_rows(&w->f, y, end, thread);
		while (w->f.ahead[thread].y < w->f.ahead[thread].end) /* what no stage has asked for by now */
			fetch_ahead(&w->f, thread);
	}
}

/* What was not drawn at first, a few rows at a time: between these it can be cancelled. */
static void later_rows(void *data, int y0, int y1, int thread)
{
	work *w = data;
	for (int y = y0; y < y1 && !bands_stopped(w->f.bands); y += NEAR_ROWS)
		w->later->rows(&w->f, y, y1 - y < NEAR_ROWS ? y1 : y + NEAR_ROWS, thread);
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

static int32_t clean_layer(work *w, int i, int64_t *bad)
{
	encre_image to = w->in[i];
	to.data = w->f.layer[i].data;
	to.pixel_stride = 4 * (int64_t)to.channels;
	to.row_stride = 4 * (int64_t)w->f.layer[i].row;
	return w->clean->copy(w->f.bands, w->in + i, i, &to, bad);
}

/* What was not clean is copied, and drawn anew. */
static int32_t read_again(work *w)
{
	frame *f = &w->f;
	size_t n = (size_t)f->width * (size_t)f->height;
	int32_t code = ENCRE_OK;
	for (int i = 0; !code && i < ENCRE_LAYER_COUNT; i++) {
		if (!atomic_load(w->unclean + i))
			continue;
		int channels = encre_layer_info(i)->channels;
		int64_t counted = 0;
		f->layer[i] = (plane){late_take(&f->late, n, 4 * (size_t)channels), (ptrdiff_t)f->width * channels};
		code = f->layer[i].data ? clean_layer(w, i, &counted) : ENCRE_ERROR_MEMORY;
	}
	stand_in(w);
	w->looked = true;
	f->reading++;
	atomic_store(&w->any_unclean, false);
	return code ? code : bands_run(f->bands, f->height, 0, first_rows, w);
}

static int32_t first(work *w)
{
	frame *f = &w->f;
	const stage *const *stages = stages_of(w->context);
	int32_t code = ENCRE_OK;
	for (int i = 0; !code && i < ENCRE_LAYER_COUNT; i++)
		if (w->copy[i])
			code = clean_layer(w, i, &w->job->nonfinite);
	for (int s = 0; !code && s < N_STAGES; s++)
		if (stages[s]->prepare)
			code = stages[s]->prepare(f);
	while (w->early < N_STAGES && !draws_whole(stages[w->early], f))
		w->early++;
	if (!code && w->style)
		code = bands_run(f->bands, f->height, 0, style_rows, w);
	if (!code)
		code = bands_run(f->bands, f->height, 0, first_rows, w);
	w->job->nonfinite += atomic_load(&w->bad);
	return code || !atomic_load(&w->any_unclean) ? code : read_again(w);
}

static int32_t run(work *w)
{
	frame *f = &w->f;
	const stage *const *stages = stages_of(w->context);
	bands_span(f->bands, 0, 1.5 / (N_STAGES + 2));
	int32_t code = first(w);
	for (int s = 0; !code && s < N_STAGES; s++) {
		bands_span(f->bands, (s + 1.5) / (N_STAGES + 2), (s + 2.5) / (N_STAGES + 2));
		late *before = f->late;
		if (!s)
			f->late = w->context->edges.late;
		if (stages[s]->run)
			code = stages[s]->run(f);
		if (!s) {
			w->context->edges.late = f->late;
			f->late = before;
		}
		w->later = stages[s];
		if (!code && w->later->rows && s >= w->early)
			code = bands_run(f->bands, f->height, 0, later_rows, w);
	}
	bands_span(f->bands, (N_STAGES + 1.5) / (N_STAGES + 2), 1);
	return code ? code : bands_run(f->bands, f->height, 0, export_rows, w);
}

static metering metering_by(const encre_params *p, const encre_camera *camera)
{
	float full = 0, shade = 0;
	if (p->shade_meter == shade_meter_LAMPS) {
		full = camera->light;
		shade = camera->shade;
	} else if (p->shade_meter == shade_meter_FIXED) {
		full = p->meter_light;
		shade = p->meter_shade;
	}
	if (!(full > 1e-30f))
		return (metering){FLT_MAX, 1, 0, 1};
	if (!(shade > 1e-30f && full - shade > 1e-30f))
		return (metering){FLT_MAX, 1 / full, 0, full};
	return (metering){shade, ENCRE_SHADE / shade, (1 - ENCRE_SHADE) / (full - shade), full};
}

int32_t encre_render(encre_context *context, encre_job *job)
{
	work w = {.context = context, .job = job};
	int32_t code = enter_job(context, job);
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
	f->kept_sheet = &context->sheet;
	f->kept_spots = &context->spots;
	f->n_styles = job->n_styles;
	f->chains = job->chains;
	f->n_chains = job->n_chains;
	f->chained = job->chained;
	f->n_chained = job->n_chained;
	f->strokes = job->tell_strokes ? &context->strokes : NULL;
	f->scale = scale_of(f->params, f->place.height);
	f->metered = metering_by(f->params, &job->camera);
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
	job->strokes = NULL;
	job->n_strokes = 0;
	if (f->strokes)
		f->strokes->count = 0;
	w.clean = use_best(context) ? &BEST(cleaner) : &cleaner_base;
	if (!any)
		return fail_code(context, copy(&w));
	for (int i = 0; i < ENCRE_LAYER_COUNT; i++)
		w.copy[i] = w.in[i].data && !packed(w.in + i);

	kept_edges *kept = &context->edges;
	arena a = {0}, edges = {0};
	f->output[ENCRE_OUTPUT_EDGES] = plane_of(w.out + ENCRE_OUTPUT_EDGES);
	f->edges_kept = edges_are_of(kept, f, job->same);
	if (kept->size && !kept->key)
		return fail_code(context, ENCRE_ERROR_MEMORY);
	plan(&w, &a, &edges);
	if (f->edges_kept)
		arena_again(&edges, &kept->memory);
	if (!arena_hold(&a, &context->memory) || (!f->edges_kept && !arena_hold(&edges, &kept->memory))) {
		edges_drop(kept);
		return fail_code(context, ENCRE_ERROR_MEMORY);
	}
	plan(&w, &a, &edges);
	code = run(&w);
	if (code || !kept->key)
		edges_drop(kept);
	late_free(f->late);
	if (!code && f->strokes) {
		job->strokes = f->strokes->point;
		job->n_strokes = (int64_t)f->strokes->count;
	}
	return fail_code(context, code);
}
