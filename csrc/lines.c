/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Edge pixels to ink, put over the picture. Thickness and pressure of a line come from painted controls (Vainumäe 2020,
 * 3.1 to 3.3) or from contrast and depth (Herring 2016); which edge inks a pixel is found by discs.c or search.c. */
#include "discs.h"

#include <string.h>

enum { BAND = 16 }; /* rows on a canvas: small enough to stay in a core's cache */

typedef struct lines {
	frame *f;
	canvas canvas; /* y0, y1 unset; planes of thread 0, those of the others follow */
	discs discs;
	search search;
} lines;

/* ---- ink ------------------------------------------------------------------------------------------------- */

/* Does the colour of the ink depend on the edge? */
static bool inks_differ(const frame *f)
{
	const float *color = NULL;
	for (int i = 0; i < f->n_styles; i++) {
		const encre_params *p = f->params + i;
		if (!p->use_lines)
			continue;
		if (p->line_tint > 0 || (color && memcmp(color, p->line_color, sizeof p->line_color)))
			return true;
		color = p->line_color;
	}
	return false;
}

/* The ink of the edge pixel x, y. */
static void ink_of(const frame *f, int x, int y, float ink[3])
{
	int nx, ny;
	near_of(f, x, y, &nx, &ny);
	const encre_params *p = f->params + (f->style ? f->style[(size_t)ny * (size_t)f->width + (size_t)nx] : 0);
	const float *color = f->layer[ENCRE_LAYER_COLOR].data + ny * f->layer[ENCRE_LAYER_COLOR].row + (ptrdiff_t)3 * nx;
	for (int c = 0; c < 3; c++)
		ink[c] = blend(p->line_color[c], p->line_tint_value * color[c], p->line_tint);
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
		if (p->use_lines || p->use_shading || p->use_smudging || p->use_hatching)
			fade_span(rgba + (ptrdiff_t)4 * x, end - x, fade);
	}
}

/* Ink over n pixels; lines may be NULL. */
static void ink_pixels(const frame *f, const float *dark, const uint32_t *owner, const float *color, int n, float *rgba, float *lines)
{
	float ink[3] = {color[0], color[1], color[2]};
	for (int x = 0; x < n; x++) {
		if (!(dark[x] > 0))
			continue; /* its bits stay as they are */
		float t = dark[x] < 1 ? dark[x] : 1, *p = rgba + (ptrdiff_t)4 * x;
		if (owner)
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

/* Fades, saves what other outputs show, and puts the ink over. dark is NULL where there is none. */
static void finish_row(const lines *l, int y, const float *dark, const uint32_t *owner)
{
	const frame *f = l->f;
	size_t bytes = (size_t)f->width * 4 * sizeof(float);
	float *rgba = f->output[ENCRE_OUTPUT_COMBINED].data + y * f->output[ENCRE_OUTPUT_COMBINED].row, *out = NULL;
	fade_row(f, y, rgba);
	if (f->output[ENCRE_OUTPUT_SURFACE].data)
		memcpy(f->output[ENCRE_OUTPUT_SURFACE].data + y * f->output[ENCRE_OUTPUT_SURFACE].row, rgba, bytes);
	if (f->output[ENCRE_OUTPUT_LINES].data)
		out = memset(f->output[ENCRE_OUTPUT_LINES].data + y * f->output[ENCRE_OUTPUT_LINES].row, 0, bytes);
	const float *color = f->params->line_color;
	for (int i = 0; i < f->n_styles; i++)
		if (f->params[i].use_lines)
			color = f->params[i].line_color;
	for (int x = 0; dark && x < f->width; x += LANES) {
		float most = 0;
		for (int k = 0; k < LANES; k++)
			most = dark[x + k] > most ? dark[x + k] : most;
		if (most > 0)
			ink_pixels(f, dark + x, owner ? owner + x : NULL, color, f->width - x < LANES ? f->width - x : LANES,
				   rgba + (ptrdiff_t)4 * x, out ? out + (ptrdiff_t)4 * x : NULL);
	}
}

/* ---- bands ----------------------------------------------------------------------------------------------- */

/* An empty canvas of rows y0..y1-1. */
static canvas canvas_of(const lines *l, int y0, int y1, int thread)
{
	const frame *f = l->f;
	canvas c = l->canvas;
	size_t plane = BAND * c.stride, offset = (size_t)thread * plane;
	c.y0 = y0;
	c.y1 = y1;
	c.dark += offset;
	c.depth += offset;
	c.grain += offset;
	if (c.owner) {
		c.owner += offset;
		c.distance += offset;
	}
	for (int y = y0; y < y1; y++) {
		const float *depth = f->layer[ENCRE_LAYER_DEPTH].data + y * f->layer[ENCRE_LAYER_DEPTH].row;
		size_t at = (size_t)(y - y0) * c.stride;
		ISA(paper_row)(f, y, 0, f->width, 1, c.grain + at);
		for (int x = 0; x < f->width; x++) {
			c.grain[at + (size_t)x] -= 1;
			c.depth[at + (size_t)x] = depth_of(depth[x]);
		}
		for (size_t x = (size_t)f->width; x < c.stride; x++)
			c.grain[at + x] = c.depth[at + x] = 0;
		memset(c.dark + at, 0, c.stride * sizeof *c.dark);
	}
	return c;
}

/* The offset of the edge found for a pixel, or false. */
static bool found_at(const lines *l, size_t at, int *dx, int *dy)
{
	if (l->search.held) {
		*dx = (l->search.held[at] & 63) - 32;
		*dy = (l->search.held[at] >> 6) - 32;
		return l->search.held[at] != HELD_NONE;
	}
	*dx = l->f->nearest[2 * at];
	*dy = l->f->nearest[2 * at + 1];
	return *dx != NEAREST_NONE;
}

/* Each pixel by the one edge that was found for it. Neighbours often share it. */
static void draw_found(const lines *l, canvas *c)
{
	const frame *f = l->f;
	for (int y = c->y0; y < c->y1; y++) {
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
			if (!inks || d2 >= d.reach * d.reach || c->depth[at + (size_t)x] < d.limit)
				continue;
			float coverage = fminf(1, (d.radius - sqrtf(d2)) / d.fade);
			c->dark[at + (size_t)x] = d.gain * ((1 + d.paper * c->grain[at + (size_t)x]) * coverage - d.bias);
			if (c->owner)
				c->owner[at + (size_t)x] = (uint32_t)ey << 16 | (uint32_t)ex;
		}
	}
}

static void lines_rows(void *data, int y0, int y1, int thread)
{
	const lines *l = data;
	bool strongest = l->f->params->line_search == line_search_EXACT;
	int from = y0, to = l->f->any_lines ? y1 : y0;
	if (from < to && strongest)
		ISA(discs_rows)(l->f, &l->discs, &from, &to);
	canvas c = {0};
	if (from < to) {
		c = canvas_of(l, from, to, thread);
		if (strongest)
			ISA(discs_draw)(l->f, &l->discs, &c);
		else
			draw_found(l, &c);
	}
	for (int y = y0; y < y1; y++) {
		bool inked = y >= from && y < to;
		size_t at = inked ? (size_t)(y - from) * c.stride : 0;
		finish_row(l, y, inked ? c.dark + at : NULL, inked && c.owner ? c.owner + at : NULL);
	}
}

/* ---- the stage ------------------------------------------------------------------------------------------- */

static void plan(frame *f, arena *a)
{
	lines *l = arena_take(a, 1, sizeof *l), made = {.f = f};
	if (f->any_lines) {
		bool owned = inks_differ(f);
		size_t stride = ((size_t)f->width + 2 * LANES - 1) / LANES * LANES, n = stride * BAND * (size_t)rows_threads(f->rows);
		made.canvas = (canvas){
			.width = f->width,
			.stride = stride,
			.dark = arena_take(a, n, sizeof(float)),
			.depth = arena_take(a, n, sizeof(float)),
			.grain = arena_take(a, n, sizeof(float)),
			.owner = owned ? arena_take(a, n, sizeof(uint32_t)) : NULL,
			.distance = owned ? arena_take(a, n, sizeof(float)) : NULL,
		};
		if (f->params->line_search == line_search_EXACT)
			made.discs = ISA(discs_plan)(f, a);
		else
			made.search = ISA(search_plan)(f, a);
	}
	f->lines = l;
	if (l)
		*l = made;
}

static int32_t run(frame *f)
{
	lines *l = f->lines;
	int32_t code = ENCRE_OK;
	if (f->any_lines)
		code = f->params->line_search == line_search_EXACT ? ISA(discs_gather)(f, &l->discs) : ISA(search_run)(f, &l->search);
	if (!code)
		code = rows_run(f->rows, f->height, BAND, lines_rows, l);
	ISA(discs_free)(&l->discs);
	return code;
}

const stage STAGE_SYMBOL(lines) = {.id = "lines", .plan = plan, .run = run};
