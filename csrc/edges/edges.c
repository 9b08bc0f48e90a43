/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Layers -> edge strength: where lines can be (Vainumäe 2020, 3.1; Herring 2016, A.2).
 *
 * Each source of edges has a ring of sampled rows; tile by tile its strength is weighed, and the strongest source wins
 * the pixel. To add a source: name it in enum source (the order decides ties), sample its layer in samples.c,
 * give its strength in sources.c and its weight here. The detector FINE does all that in its own way (fine.h). */
#include "edges/edges.h"
#include "base/between.h"
#include "base/pixel.h"

#include <stdio.h>
#include <string.h>

/* Divisors of depth may be tiny: factors up to this leave all products finite. */
static const float most_factor = 1e28f;

/* ---- 5x5 least depth ------------------------------------------------------------------------------------- */

enum { GROUP = 32 /* pixels that are passed over if none is an edge */ };

/* Of n pixels from x0 on, where only columns from..to - 1 of x0 - 2.. lie in the frame. Called with constants where
 * they can be. */
KERNEL void places_of(const frame *f, int y, int x0, const int n, const int from, const int to, uint8_t *restrict place)
{
	static const int beside[] = {-1, 1, -2, 2}; /* keys grow: of equals in a column the first counts */
	const float *restrict own = layer_row(f, ENCRE_LAYER_DEPTH, y) + x0 - 2, *row[4];
	float column[TILE + 4];
	int32_t column_key[TILE + 4], key[TILE];
	for (int k = 0; k < 4; k++) { /* what lies outside the frame is never less */
		bool inside = y + beside[k] >= 0 && y + beside[k] < f->height;
		row[k] = layer_row(f, ENCRE_LAYER_DEPTH, inside ? y + beside[k] : y) + x0 - 2;
	}
	for (int i = 0; i < n + 4; i++) {
		column[i] = INFINITY;
		column_key[i] = INT32_MAX / 2;
	}
	for (int i = from; i < to; i++) {
		float least = depth_of(own[i]);
		int32_t least_key = 12;
		for (int k = 0; k < 4; k++) {
			float z = depth_of(row[k][i]);
			int32_t at = 32 * beside[k] * beside[k] + (beside[k] + 2) * 5 + 2;
			least_key = z < least ? at : least_key;
			least = min(z, least);
		}
		column[i] = least;
		column_key[i] = least_key;
	}
	for (int i = 0; i < n; i++) {
		float least = column[i + 2];
		int32_t least_key = column_key[i + 2];
		for (int k = 0; k < 4; k++) {
			float z = column[i + 2 + beside[k]];
			int32_t at = column_key[i + 2 + beside[k]] + 32 * beside[k] * beside[k] + beside[k];
			int nearer = (z < least) | ((z == least) & (at < least_key));
			least_key = nearer ? at : least_key;
			least = min(z, least);
		}
		key[i] = least_key;
	}
	for (int i = 0; i < n; i++)
		place[i] = (uint8_t)(key[i] & 31);
}

/* Place (dy + 2) * 5 + dx + 2 of the least depth of the 5x5 window about n pixels from (x0, y). Ties: least distance,
 * row, column, which 32 * distance^2 + place orders; first down the columns, then across. */
static void nearest_places(const frame *f, int y, int x0, int n, uint8_t *restrict place)
{
	int from = x0 < 2 ? 2 - x0 : 0, to = f->width - x0 + 2 < n + 4 ? f->width - x0 + 2 : n + 4;
	if (n == GROUP && from == 0 && to == GROUP + 4)
		places_of(f, y, x0, GROUP, 0, GROUP + 4, place);
	else
		places_of(f, y, x0, n, from, to, place);
}

/* ---- weights --------------------------------------------------------------------------------------------- */

static float weight_in(const encre_params *p, enum source s)
{
	switch (s) {
	case SOURCE_OBJECT: return p->line_outline_strength;
	case SOURCE_MATERIAL: return p->line_material_strength;
	case SOURCE_DEPTH: return p->line_inner_strength;
	case SOURCE_NORMAL: return p->line_crease_strength;
	case SOURCE_COLOR: return p->line_color_strength;
	case SOURCE_MARK: return p->line_mark_strength;
	case SOURCE_SEEN: return p->line_mirror_strength;
	case SOURCE_SUGGESTIVE: return p->line_suggestive_strength;
	case SOURCE_HIDDEN: return p->line_hidden_strength;
	default: return p->line_shadow_strength;
	}
}

/* Whether weights of source s depend on the pixel. */
static bool weighed_each(const edges *e, enum source s)
{
	return e->f->style || (s == SOURCE_COLOR && e->f->layer[ENCRE_LAYER_CONTROLS].data);
}

/* Weights of source s at n pixels; false if all are 0. style: that of the pixel the controls come from, NULL = the
 * scene's. The painted control is that of the pixel itself. */
static bool weigh(const edges *e, enum source s, int y, int x0, int n, const uint8_t *style, float *restrict weight)
{
	int any = 0;
	for (int i = 0; i < n; i++)
		weight[i] = e->weight[s][style ? style[i] : 0];
	const float *controls = controls_at(e->f, x0, y);
	for (int i = 0; s == SOURCE_COLOR && controls && i < n; i++) {
		float control = controls[CONTROL_COUNT * (ptrdiff_t)i + CONTROL_COLOR_EDGE];
		weight[i] = painted_weight(e, weight[i], control);
		any |= control > 0;
	}
	for (int i = 0; i < n; i++) {
		weight[i] = positive(weight[i]);
		any |= weight[i] > 0;
	}
	return any;
}

/* own becomes weighed, strength the most of all. Weights: of each pixel, or NULL and one of all. */
KERNEL void weigh_in(int n, const float *restrict weights, float one, float *restrict own, float *restrict strength)
{
	for (int i = 0; i < n; i++) {
		float w = (weights ? weights[i] : one) * own[i];
		own[i] = min(w, pixel_most);
		strength[i] = max(own[i], strength[i]);
	}
}

/* ---- rows ------------------------------------------------------------------------------------------------ */

static bool any_edge(const float *restrict strength, int n, float threshold)
{
	int any = 0;
	for (int i = 0; i < n; i++)
		any |= (strength[i] >= threshold) & (strength[i] > 0);
	return any;
}

/* What the sources of a tile give, those that have weight there, in their order. */
typedef struct rivals {
	int count, number[SOURCE_SEEN];
	float strength[SOURCE_SEEN][TILE];
} rivals;

/* Of n pixels from x on: the first of the strongest sources wins. */
static void mark_edges(const rivals *r, const float *restrict strength, int x, int n, float threshold,
		       uint8_t *restrict edge)
{
	int32_t winner[GROUP];
	for (int i = 0; i < n; i++)
		winner[i] = 0;
	for (int k = r->count; k-- > 0;) {
		const float *restrict own = r->strength[k] + x;
		int32_t number = r->number[k];
		for (int i = 0; i < n; i++)
			winner[i] = own[i] == strength[i] ? number : winner[i];
	}
	for (int i = 0; i < n; i++)
		edge[i] = (uint8_t)(((strength[i] >= threshold) & (strength[i] > 0)) ? winner[i] : 0);
}

/* Lines go on below: what is written there would wait for the memory, and all that is written after it. */
static void fetch_below(const frame *f, int y, ptrdiff_t at, int n)
{
	if (y + 1 >= f->height)
		return;
	__builtin_prefetch(f->near + at + f->width, 1);
	for (int i = 0; i < n; i += 16)
		__builtin_prefetch(f->strength + at + i + f->width, 1);
}

static void edge_tile(const edges *e, ring *rings, int y, int x0, int n, int thread)
{
	const frame *f = e->f;
	ptrdiff_t at = (ptrdiff_t)y * f->width + x0;
	rivals r;
	float strength[TILE], weight[TILE];
	uint8_t style[TILE];
	r.count = 0;
	for (int i = 0; i < n; i++)
		strength[i] = 0;
	if (f->style) {
		nearest_places(f, y, x0, n, f->near + at);
		for (int i = 0; i < n; i++)
			style[i] = f->style[at + i + (f->near[at + i] / 5 - 2) * (ptrdiff_t)f->width +
					    f->near[at + i] % 5 - 2];
	}
	for (int s = 0; s < SOURCE_SEEN; s++) {
		bool each = weighed_each(e, (enum source)s);
		if (!e->on[s] || (each ? !weigh(e, (enum source)s, y, x0, n, f->style ? style : NULL, weight)
				       : !(e->weight[s][0] > 0)))
			continue;
		fetch_ahead(f, thread);
		ISA(ring_fill)(rings + s, y);
		float *own = r.strength[r.count];
		fetch_ahead(f, thread);
		ISA(source_strength)(rings + s, y, x0, n, own);
		if (s == SOURCE_COLOR && each) {
			for (int i = 0; i < n; i++) {
				own[i] = min(weight[i] * own[i], pixel_most);
				weight[i] = 1;
			}
			ISA(source_painted)(rings + s, y, x0, n, own);
		}
		if (each)
			weigh_in(n, weight, 0, own, strength);
		else
			weigh_in(n, NULL, e->weight[s][0], own, strength);
		r.number[r.count++] = 1 + s;
		fetch_ahead(f, thread);
	}
	plane out = f->output[ENCRE_OUTPUT_EDGES];
	if (out.data)
		memcpy(out.data + y * out.row + x0, strength, (size_t)n * sizeof *strength);
	uint8_t *restrict edge = f->edge + at;
	for (int i = 0; i < n; i += GROUP) {
		int m = n - i < GROUP ? n - i : GROUP;
		if (!any_edge(strength + i, m, e->p->edge_threshold)) {
			memset(edge + i, 0, (size_t)m);
			continue;
		}
		mark_edges(&r, strength + i, i, m, e->p->edge_threshold, edge + i);
		memcpy(f->strength + at + i, strength + i, (size_t)m * sizeof *strength);
		if (!f->style)
			nearest_places(f, y, x0 + i, m, f->near + at + i);
		fetch_below(f, y, at + i, m);
	}
}

/* The rings of a thread, which go on from one call to the next where the rows do. */
typedef struct held_rings {
	ring ring[SOURCE_SEEN];
	int next, reading; /* the row after the last, and of which reading of the layers that is */
} held_rings;

static void edge_rows(void *data, int y0, int y1, int thread)
{
	const edges *e = data;
	held_rings *h = e->rings + thread;
	for (int s = 0; s < SOURCE_SEEN && (h->next != y0 || h->reading != e->f->reading); s++)
		h->ring[s] = ISA(ring_of)(e, (enum source)s, thread);
	h->next = y1;
	h->reading = e->f->reading;
	for (int y = y0; y < y1; y++)
		for (int x0 = 0; x0 < e->f->width && !bands_stopped(e->f->bands); x0 += TILE)
			edge_tile(e, h->ring, y, x0, e->f->width - x0 < TILE ? e->f->width - x0 : TILE, thread);
}

/* ---- contrast_local: the strongest difference nearby gives a full line ------------------------------------ */

static void difference_rows(void *data, int y0, int y1, int thread)
{
	const edges *e = data;
	int width = e->f->width;
	for (int s = SOURCE_COLOR; s < SAMPLE_COUNT; s++) {
		if (!e->full[s])
			continue;
		edges near = *e; /* FINE's windows are larger, and of light as it is */
		near.fine = false;
		near.reach[s] = 1;
		ring r = ISA(ring_of)(&near, (enum source)s, thread);
		for (int y = y0; y < y1 && !bands_stopped(e->f->bands); y++) {
			float *row = e->difference[s] + (ptrdiff_t)y * width;
			ISA(ring_fill)(&r, y);
			for (int x0 = 0; x0 < width; x0 += TILE)
				ISA(source_difference)(&r, x0, width - x0 < TILE ? width - x0 : TILE, row + x0);
			ISA(window_row)(&e->window, row, thread, e->full[s] + (ptrdiff_t)y * width);
		}
	}
}

/* ---- stage ----------------------------------------------------------------------------------------------- */

static const char *check(const encre_params *p, char *text, size_t size)
{
	if (p->edge_detector == edge_detector_FINE && p->line_search != line_search_EXACT) {
		snprintf(text, size,
			 "line_search: the detector FINE draws along its sites and knows no other search; give EXACT, "
			 "or another edge_detector");
		return text;
	}
	if (p->depth_space != depth_space_LINEAR || p->depth_far > p->depth_near)
		return NULL;
	snprintf(text, size, "depth_far: %g is not beyond depth_near, %g; give a larger depth_far",
		 (double)p->depth_far, (double)p->depth_near);
	return text;
}

/* Everything that follows from parameters alone. */
static edges setup(const frame *f)
{
	const encre_params *p = f->params;
	edges e = {.f = f,
		   .p = p,
		   .fine = p->edge_detector == edge_detector_FINE,
		   .gauss = ISA(gaussians_of)(p->edge_blur),
		   .dog = p->edge_detector == edge_detector_DOG};
	e.contrast = !e.dog || p->color_detector == color_detector_CONTRAST;
	e.inverse = e.fine || p->depth_space == depth_space_INVERSE;
	e.ortho = e.inverse && f->camera.orthographic;
	float gain = !e.dog ? 10 : e.inverse ? 60 : 200;
	float divisor = e.ortho ? f->camera.height : e.inverse ? 1 : p->depth_far - p->depth_near;
	e.depth_factor = gain / divisor < most_factor ? gain / divisor : most_factor;
	for (int i = 0; e.fine && f->n_chained && i < f->n_styles; i++) {
		bool meshes = p->crease_source == crease_source_AUTO;
		e.bump[i] = meshes ? p[i].crease_bumps : weight_in(p + i, SOURCE_NORMAL);
		e.on[SOURCE_NORMAL] |= e.bump[i] > 0;
	}
	for (int s = 0; s < SOURCE_COUNT; s++) {
		for (int i = 0; i < f->n_styles; i++) {
			e.weight[s][i] = weight_in(p + i, (enum source)s);
			e.on[s] |= e.weight[s][i] > 0;
		}
		bool dog = s == SOURCE_DEPTH || s == SOURCE_NORMAL
				   ? e.dog
				   : (s == SOURCE_COLOR || s == SOURCE_LIGHT) && !e.contrast;
		e.reach[s] = e.fine ? 3 : dog ? e.gauss.reach : 1;
	}
	e.on[SOURCE_OBJECT] &= f->layer[ENCRE_LAYER_OBJECT].data != NULL;
	e.on[SOURCE_MATERIAL] &= f->layer[ENCRE_LAYER_MATERIAL].data != NULL;
	e.on[SOURCE_MARK] &= f->n_chains > 0;
	e.on[SOURCE_COLOR] |= f->layer[ENCRE_LAYER_CONTROLS].data != NULL;
	e.on[SOURCE_SEEN] &= e.fine && f->layer[ENCRE_LAYER_SEEN_COLOR].data && f->layer[ENCRE_LAYER_SEEN_NORMAL].data;
	e.on[SOURCE_SUGGESTIVE] &= e.fine;
	e.on[SOURCE_HIDDEN] &= e.fine;
	e.on[SAMPLE_SEEN_COLOR] = e.on[SOURCE_SEEN];
	e.on[SAMPLE_SEEN_DEPTH] = e.on[SOURCE_SEEN] && f->layer[ENCRE_LAYER_SEEN_DEPTH].data;
	e.reach[SAMPLE_SEEN_COLOR] = e.reach[SAMPLE_SEEN_DEPTH] = e.reach[SOURCE_SEEN];
	return e;
}

static void plan(frame *f, arena *a)
{
	if (!f->want_edges)
		return;
	edges e = setup(f);
	bool any = false;
	size_t pixels = (size_t)f->width * (size_t)f->height, threads = (size_t)bands_threads(f->bands);
	if (!e.fine) {
		f->edge = arena_take(a, pixels, 1);
		f->strength = arena_take(a, pixels, sizeof *f->strength);
		f->near = arena_take(a, pixels, 1);
		e.marked = e.on[SOURCE_MARK] ? arena_take(a, pixels, 1) : NULL;
	}
	e.plane_samples = (f->width + 2 * MAX_REACH + 15) & ~15;
	for (int s = 0; s < SAMPLE_COUNT; s++) {
		e.ring_at[s] = e.thread_samples;
		e.thread_samples += e.on[s] ? (2 * e.reach[s] + 1) * channels_of((enum source)s) * e.plane_samples : 0;
		if (e.on[s] && is_color(s) && e.contrast && e.p->contrast_local) {
			e.full[s] = arena_take(a, pixels, sizeof *e.full[s]);
			e.difference[s] = e.fine ? e.full[s] : arena_take(a, pixels, sizeof *e.difference[s]);
			any = true;
		}
	}
	if (any)
		e.window = ISA(window_plan)(a, f->bands, f->width, f->height, e.p->contrast_window * f->scale, false,
					    false);
	e.samples = arena_take(a, threads * (size_t)e.thread_samples, sizeof *e.samples);
	e.rings = arena_take(a, threads, sizeof *e.rings);
	f->edges = arena_take(a, 1, sizeof e);
	edges *made = f->edges;
	if (made && !f->edges_kept)
		*made = e;
	if (made) { /* kept ones are of another frame's place in memory */
		made->f = f;
		made->p = f->params;
	}
	for (size_t i = 0; made && i < threads; i++)
		made->rings[i].next = -1;
	if (e.fine)
		ISA(fine_plan)(f, &e, a);
}

static void mark_pixel(void *user, const passage *p)
{
	const edges *e = user;
	bool next = p->share > 0.5f;
	if (p->of->kind & ENCRE_CHAIN_MARK)
		e->marked[(ptrdiff_t)(p->y + (next && p->down)) * e->f->width + p->x + (next && !p->down)] = 1;
}

/* Lines drawn by hand are those of the nearer pixel. */
static int32_t prepare(frame *f)
{
	edges *e = f->edges;
	if (!f->want_edges || f->edges_kept || !e->marked)
		return ENCRE_OK;
	memset(e->marked, 0, (size_t)f->width * (size_t)f->height);
	between_each(f, mark_pixel, e);
	return ENCRE_OK;
}

static bool draws_nothing(const frame *f)
{
	(void)f;
	return false;
}

/* Whether all is found with the first reading of the layers: nothing of the whole frame must be known before. */
static bool found_at_once(const edges *e)
{
	return !e->fine && !e->window.each;
}

static void first_rows(void *data, int y0, int y1, int thread)
{
	const frame *f = data;
	if (f->want_edges && !f->edges_kept && found_at_once(f->edges))
		edge_rows(f->edges, y0, y1, thread);
}

static int32_t run(frame *f)
{
	edges *e = f->edges;
	if (!f->want_edges || f->edges_kept || found_at_once(e))
		return ENCRE_OK;
	int32_t code = ENCRE_OK;
	if (e->window.each) {
		code = bands_run(f->bands, f->height, 0, difference_rows, e);
		for (int s = SOURCE_COLOR; !code && s < SAMPLE_COUNT; s++)
			if (e->full[s])
				code = ISA(window_columns)(&e->window, f->bands, e->full[s]);
	}
	if (code)
		return code;
	return e->fine ? ISA(fine_run)(f) : bands_run(f->bands, f->height, 0, edge_rows, e);
}

const stage STAGE_SYMBOL(edges) = {.id = "edges",
				   .check = check,
				   .plan = plan,
				   .prepare = prepare,
				   .run = run,
				   .rows = first_rows,
				   .draws = draws_nothing};
