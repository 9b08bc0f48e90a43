/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Edge pixels to ink, put over the picture. Thickness and pressure of a line come from painted controls (Vainumäe 2020,
 * 3.2) or from contrast and depth (Herring 2016); which edge inks a pixel is found by discs.c or search.c. */
#include "ink/discs.h"
#include "ink/pen.h"

#include <string.h>

typedef struct lines {
	frame *f;
	canvas canvas; /* y0, y1 unset; planes of thread 0, those of the other threads follow */
	discs discs;
	capsules capsules;
	float color[3]; /* of all ink, where it doesn't differ */
} lines;

/* ---- the pen ------------------------------------------------------------------------------------------------ */

bool ISA(pen_of)(const frame *f, int nx, int ny, enum source source, float strength, pen *d)
{
	const encre_params *p = params_at(f, nx, ny);
	if (!p->use_lines)
		return false;
	const float *controls = controls_at(f, nx, ny);
	float thickness = controls ? controls[CONTROL_THICKNESS] : 0;
	float pressed = 1 + (controls ? controls[CONTROL_INTENSITY] : 0);
	float z = depth_at(f, nx, ny);
	const float widths[SOURCE_COUNT] = {
		[SOURCE_OBJECT] = p->line_outline_width,
		[SOURCE_MATERIAL] = p->line_material_width,
		[SOURCE_DEPTH] = p->line_inner_width,
		[SOURCE_NORMAL] = p->line_crease_width,
		[SOURCE_COLOR] = p->line_color_width,
		[SOURCE_LIGHT] = p->line_shadow_width,
		[SOURCE_MARK] = p->line_mark_width,
		[SOURCE_SEEN] = p->line_mirror_width,
		[SOURCE_SUGGESTIVE] = p->line_suggestive_width,
		[SOURCE_HIDDEN] = p->line_hidden_width,
	};

	/* bounded before anything that may be 0 is multiplied in: infinity times 0 is no number */
	float radius = min(0.5f * p->line_thickness * f->scale * widths[source], 1e30f);
	radius *= thickness > 0 ? 1 + 8 * thickness : 1 + thickness;
	radius *= mix(1, min(1, strength), p->line_contrast);
	float full = p->line_far_distance;
	if (p->line_far_unit == line_far_unit_RELATIVE && f->camera.distance > 0)
		full = min(full * f->camera.distance, FLT_MAX);
	if (full > 0 && !f->camera.orthographic) {
		bool outline = source == SOURCE_OBJECT || source == SOURCE_DEPTH; /* far away it says most of a shape */
		float least = outline ? min(0.5f * p->line_far_thinnest * f->scale, radius) : 0;
		radius = max(radius * min(full / z, p->line_far_thickest), least);
	}
	if (p->ink_in_shade != 0) {
		float lit = clamp01(exposed_at(f, p, nx, ny));
		radius *= max(0, 1 + p->ink_in_shade * (1 - 2 * lit));
	}

	float intensity = min(pressed * p->pen_1_intensity, 1e30f);
	d->p = p;
	d->radius = min(radius, 0.5f * f->params->line_thickest * f->scale);
	d->pressed = pressed;
	d->gain = min(p->pen_1_steepness * intensity, 1e30f);
	d->bias = max(0, 1 - 0.5f * intensity);
	d->limit = !f->params->line_occlude ? 0 : f->camera.orthographic ? z - 0.1f * f->camera.height : 0.9f * z;
	return true;
}

bool ISA(disc_of)(const frame *f, int x, int y, disc *d)
{
	size_t at = (size_t)y * (size_t)f->width + (size_t)x;
	int nx, ny;
	pen pen;
	near_of(f, x, y, &nx, &ny);
	if (!ISA(pen_of)(f, nx, ny, (enum source)(f->edge[at] - 1), f->strength[at], &pen))
		return false;
	d->x = d->last = (uint16_t)x;
	d->style = (uint16_t)(pen.p - f->params);
	d->radius = pen.radius;
	d->gain = pen.gain;
	d->bias = pen.bias;
	d->reach = pen.radius - fade_of(pen.p, pen.radius) * d->bias;
	d->limit = pen.limit;
	return d->reach > 0 && d->gain > 0;
}

/* ---- ink ------------------------------------------------------------------------------------------------- */

/* Does the colour of the ink depend on the edge? If not, it is in `color`. */
static bool inks_differ(const frame *f, float *color)
{
	bool found = false;
	for (int i = 0; i < f->n_styles; i++) {
		const encre_params *p = f->params + i;
		if (!p->use_lines)
			continue;
		if ((f->params->edge_detector == edge_detector_FINE ? ISA(inks_by_site)(p) : p->ink_tint > 0) ||
		    (found && memcmp(color, p->ink_color, sizeof p->ink_color) != 0))
			return true;
		memcpy(color, p->ink_color, sizeof p->ink_color);
		found = true;
	}
	return false;
}

static bool strokes_overlap(const frame *f)
{
	bool found = false;
	for (int i = 0; i < f->n_styles; i++) {
		pens pens = ISA(pens_of)(f, f->params + i);
		found |= f->params[i].use_lines && ISA(pens_strokes)(&pens) > 1;
	}
	return found && f->params->edge_detector == edge_detector_FINE;
}

/* The ink of the edge pixel x, y. */
static void ink_of(const frame *f, int x, int y, float ink[3])
{
	int nx, ny;
	near_of(f, x, y, &nx, &ny);
	const encre_params *p = params_at(f, nx, ny);
	const float *color = layer_row(f, ENCRE_LAYER_COLOR, ny) + (ptrdiff_t)3 * nx;
	for (int c = 0; c < 3; c++)
		ink[c] = blend(p->ink_color[c], p->ink_tint_value * color[c], p->ink_tint);
}

static void fade_span(float *rgba, int n, float fade)
{
	for (int x = 0; x < n; x++)
		for (int c = 0; c < 3; c++)
			rgba[4 * x + c] = blend(rgba[4 * x + c], rgba[4 * x + 3], fade);
}

/* Towards white, but where the pixel's style has every switch off: there nothing is touched. */
static void fade_row(const frame *f, int y, float *rgba)
{
	float fade = f->params->surface_fade;
	for (int x = 0, end; fade > 0 && x < f->width; x = end) {
		const encre_params *p = style_run(f, y, x, f->width, &end);
		if (draws(p))
			fade_span(rgba + (ptrdiff_t)4 * x, end - x, fade);
	}
}

/* Ink over n pixels; lines may be NULL. own: inks of sites, whose numbers `owner` then has. */
static void ink_pixels(const frame *f, const float (*own)[3], const float *dark, const uint32_t *owner,
		       const float *color, int n, float *rgba, float *lines)
{
	float ink[3] = {color[0], color[1], color[2]};
	for (int x = 0; x < n; x++) {
		if (!(dark[x] > 0))
			continue; /* its bits stay as they are */
		float t = dark[x] < 1 ? dark[x] : 1, *p = rgba + (ptrdiff_t)4 * x;
		if (owner && own)
			memcpy(ink, own[owner[x]], sizeof ink);
		else if (owner)
			ink_of(f, (int)(owner[x] & 0xffff), (int)(owner[x] >> 16), ink);
		for (int c = 0; c < 3; c++)
			p[c] = blend(p[c], ink[c], t);
		p[3] = t + p[3] - t * p[3];
		if (lines) {
			float *l = lines + (ptrdiff_t)4 * x;
			for (int c = 0; c < 3; c++)
				l[c] = ink[c] * t;
			l[3] = t;
		}
	}
}

/* The ink of one row of the canvas over its pixels. */
static void ink_row(const canvas *c, int y, const float (*own)[3], const float *color, float *rgba, float *lines)
{
	size_t row = (size_t)(y - c->y0) * c->stride;
	const float *dark = c->dark + row;
	const uint32_t *owner = c->owner ? c->owner + row : NULL;
	for (int x = 0; x < c->f->width; x += LANES) {
		if (!(c->open[y - c->y0] >> (x >> c->shift) & 1)) {
			x |= (1 << c->shift) - LANES; /* on to the next block */
			continue;
		}
		float most = 0;
		for (int k = 0; k < LANES; k++)
			most = dark[x + k] > most ? dark[x + k] : most;
		if (!(most > 0))
			continue;
		if (y + 1 < c->y1) { /* lines go on below */
			const float *below = output_row(c->f, ENCRE_OUTPUT_COMBINED, y + 1) + (ptrdiff_t)4 * x;
			__builtin_prefetch(below);
			__builtin_prefetch(below + 16);
		}
		ink_pixels(c->f, own, dark + x, owner ? owner + x : NULL, color,
			   c->f->width - x < LANES ? c->f->width - x : LANES, rgba + (ptrdiff_t)4 * x,
			   lines ? lines + (ptrdiff_t)4 * x : NULL);
	}
}

/* Fades, saves what other outputs show, and puts the ink over. */
static void finish_row(const lines *l, const canvas *c, int y)
{
	const frame *f = l->f;
	size_t bytes = (size_t)f->width * 4 * sizeof(float);
	float *rgba = output_row(f, ENCRE_OUTPUT_COMBINED, y), *lines = NULL;
	fade_row(f, y, rgba);
	if (f->output[ENCRE_OUTPUT_SURFACE].data)
		memcpy(output_row(f, ENCRE_OUTPUT_SURFACE, y), rgba, bytes);
	if (f->output[ENCRE_OUTPUT_LINES].data)
		lines = memset(output_row(f, ENCRE_OUTPUT_LINES, y), 0, bytes);
	if (c->open[y - c->y0])
		ink_row(c, y, (const float (*)[3])l->capsules.ink, l->color, rgba, lines);
}

/* ---- bands ----------------------------------------------------------------------------------------------- */

static canvas canvas_of(const lines *l, int y0, int y1, int thread)
{
	canvas c = l->canvas;
	size_t offset = (size_t)thread * BAND * c.stride;
	c.y0 = y0;
	c.y1 = y1;
	if (!c.dark) /* no lines */
		return c;
	c.dark += offset;
	c.depth += offset;
	c.grain += offset;
	if (c.owner) {
		c.owner += offset;
		c.distance += offset;
	}
	if (c.laid) {
		c.laid += offset;
		c.darkest += offset;
		c.darkest_owner = c.owner ? c.darkest_owner + offset : NULL;
	}
	if (c.more) {
		c.way_x += offset;
		c.way_y += offset;
		c.more += offset;
	}
	return c;
}

static void open_pixels(int n, const float *restrict z, float *restrict depth, float *restrict grain)
{
	for (int i = 0; i < n; i++) {
		depth[i] = depth_of(z[i]);
		grain[i] -= 1;
	}
}

void ISA(canvas_open)(canvas *c, int y, uint64_t blocks)
{
	const frame *f = c->f;
	const float *depth = layer_row(f, ENCRE_LAYER_DEPTH, y);
	size_t row = (size_t)(y - c->y0) * c->stride;
	c->open[y - c->y0] |= blocks;
	for (; blocks; blocks &= blocks - 1) {
		int x0 = __builtin_ctzll(blocks) << c->shift, size = 1 << c->shift;
		int inside = f->width - x0 < size ? f->width - x0 : size;
		size_t at = row + (size_t)x0, bytes = (size_t)size * sizeof(float);
		memset(c->dark + at, 0, bytes);
		if (c->laid) {
			memset(c->laid + at, 0, bytes);
			memset(c->darkest + at, 0, bytes);
		}
		if (c->more) {
			memset(c->way_x + at, 0, bytes);
			memset(c->way_y + at, 0, bytes);
			memset(c->more + at, 0, bytes);
		}
		if (inside < size) {
			memset(c->grain + at, 0, bytes);
			memset(c->depth + at, 0, bytes);
		}
		if (inside <= 0)
			continue;
		if (y + 1 < f->height) { /* lines go on below */
			const float *below = layer_row(f, ENCRE_LAYER_DEPTH, y + 1) + x0;
			for (int i = 0; i < inside; i += 16)
				__builtin_prefetch(below + i);
		}
		ISA(paper_row)(f, y, x0, x0 + inside, 1, c->grain + at);
		open_pixels(inside, depth + x0, c->depth + at, c->grain + at);
	}
}

/* The offset of the edge found for a pixel, or false. */
static bool found_at(const lines *l, size_t at, int *dx, int *dy)
{
	if (is_held(l->f))
		return held_at(l->f, at, dx, dy);
	*dx = l->f->nearest[2 * at];
	*dy = l->f->nearest[2 * at + 1];
	return *dx != NEAREST_NONE;
}

/* Each pixel by the one edge that was found for it. Neighbours often share it. */
static void draw_found(const lines *l, canvas *c)
{
	const frame *f = l->f;
	for (int y = c->y0; y < c->y1 && !bands_stopped(f->bands); y++) {
		size_t row = (size_t)y * (size_t)f->width, at = (size_t)(y - c->y0) * c->stride;
		disc d = {0};
		bool inks = false;
		for (int x = 0, ex = -1, ey = -1; x < f->width; x++) {
			int dx, dy;
			if (!found_at(l, row + (size_t)x, &dx, &dy))
				continue;
			if (x + dx != ex || y + dy != ey) {
				ex = x + dx;
				ey = y + dy;
				inks = ISA(disc_of)(f, ex, ey, &d);
			}
			float d2 = (float)dx * (float)dx + (float)dy * (float)dy;
			if (!inks || d2 >= d.reach * d.reach)
				continue;
			canvas_touch(c, y, x, x + 1);
			if (c->depth[at + (size_t)x] < d.limit)
				continue;
			const encre_params *p = f->params + d.style;
			float coverage = min(1, (d.radius - sqrtf(d2)) / fade_of(p, d.radius));
			c->dark[at + (size_t)x] =
				d.gain * ((1 + p->pen_1_grain * c->grain[at + (size_t)x]) * coverage - d.bias);
			if (c->owner)
				c->owner[at + (size_t)x] = (uint32_t)ey << 16 | (uint32_t)ex;
		}
	}
}

static void lines_rows(void *data, int y0, int y1, int thread)
{
	const lines *l = data;
	canvas c = canvas_of(l, y0, y1, thread);
	if (l->f->any.use_lines && l->f->fine)
		ISA(capsules_draw)(&l->capsules, &c);
	else if (l->f->any.use_lines && l->f->params->line_search == line_search_EXACT)
		ISA(discs_draw)(&l->discs, &c);
	else if (l->f->any.use_lines)
		draw_found(l, &c);
	for (int y = y0; y < y1 && !bands_stopped(l->f->bands); y++)
		finish_row(l, &c, y);
}

/* ---- the stage ------------------------------------------------------------------------------------------- */

static bool reads_edges(const frame *f)
{
	return f->any.use_lines;
}

static void plan(frame *f, arena *a)
{
	lines *l = arena_take(a, 1, sizeof *l), made = {.f = f};
	if (f->any.use_lines) {
		bool owned = inks_differ(f, made.color), layered = strokes_overlap(f),
		     sided = f->params->edge_detector == edge_detector_FINE && !layered;
		int shift = 5;
		while ((f->width + LANES) >> shift >= 64)
			shift++;
		size_t stride = (((size_t)(f->width + LANES) >> shift) + 1) << shift,
		       n = stride * BAND * (size_t)bands_threads(f->bands);
		made.canvas = (canvas){
			.f = f,
			.shift = shift,
			.stride = stride,
			.dark = arena_take(a, n, sizeof(float)),
			.depth = arena_take(a, n, sizeof(float)),
			.grain = arena_take(a, n, sizeof(float)),
			.owner = owned ? arena_take(a, n, sizeof(uint32_t)) : NULL,
			.distance = owned ? arena_take(a, n, sizeof(float)) : NULL,
			.laid = layered ? arena_take(a, n, sizeof(float)) : NULL,
			.darkest = layered ? arena_take(a, n, sizeof(float)) : NULL,
			.darkest_owner = layered && owned ? arena_take(a, n, sizeof(uint32_t)) : NULL,
			.way_x = sided ? arena_take(a, n, sizeof(float)) : NULL,
			.way_y = sided ? arena_take(a, n, sizeof(float)) : NULL,
			.more = sided ? arena_take(a, n, sizeof(float)) : NULL,
		};
		if (f->params->edge_detector == edge_detector_FINE)
			; /* its memory is taken when its sites are counted */
		else if (f->params->line_search == line_search_EXACT)
			made.discs = ISA(discs_plan)(f, a);
		else
			ISA(search_plan)(f, a);
	}
	f->lines = l;
	if (l)
		*l = made;
}

static int32_t run(frame *f)
{
	lines *l = f->lines;
	int32_t code = ENCRE_OK;
	if (f->any.use_lines && f->fine)
		code = ISA(halos_draw)(f);
	if (code)
		return code;
	if (f->any.use_lines && f->fine)
		code = ISA(capsules_gather)(f, l->canvas.owner != NULL, &l->capsules);
	else if (f->any.use_lines)
		code = f->params->line_search == line_search_EXACT ? ISA(discs_gather)(f, &l->discs)
								   : ISA(search_run)(f);
	if (!code && f->strokes && f->any.use_lines && f->fine)
		code = ISA(capsules_tell)(f, &l->capsules, l->color);
	if (!code)
		code = bands_run(f->bands, f->height, BAND, lines_rows, l);
	if (!code && f->any.use_lines)
		code = ISA(specks_fill)(f, true, f->output[ENCRE_OUTPUT_LINES]);
	ISA(discs_free)(&l->discs);
	return code;
}

const stage STAGE_SYMBOL(lines) = {.id = "lines", .reads_edges = reads_edges, .plan = plan, .run = run};
