/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Tones: levels of light filled with dots, lines, strokes or ink, as printed comics have them, so that the mean of the
 * ink is the darkness of the level. On the screen they are a screen of print; on surfaces they keep to the layer
 * `anchor`: dots to the two axes of the resting thing that its normal is farthest from, lines to planes through it.
 * All is drawn from one frame; but for strokes and spots every pixel by its own layers alone. */
#include "tones/strokes.h"

#include <string.h>

static void unit(float v[3])
{
	float scale = 1 / sqrtf(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
	for (int c = 0; c < 3; c++)
		v[c] *= scale;
}

/* ---- ink --------------------------------------------------------------------------------------------------- */

void ISA(tone_chart)(const frame *f, const tone_slot *s, const tone_rest *rest, int y, int x, int n,
		     tone_field chart[2])
{
	/* strokes along the rows of their lattice would cover each other, and leave gaps side by side */
	bool strokes = s->kind == tone_1_HATCH, spots = s->kind == tone_1_STIPPLE; /* these lie in no rows to turn */
	float c = strokes ? 0.9363292f * s->across[0] - 0.3511234f * s->across[1] : spots ? 1 : s->across[0];
	float d = strokes ? 0.9363292f * s->across[1] + 0.3511234f * s->across[0] : spots ? 0 : s->across[1];
	float unit = spots ? 1 : s->unit;
	if (rest)
		ISA(tone_surface_chart)(rest, n, c / unit, d / unit, chart);
	else {
		float per = spots ? 1 : 1 / (strokes ? tone_mark_pitch(s) : max(s->pitch, 2));
		ISA(tone_screen_field)(f, y, x, n, c * per, -d * per, chart);
		ISA(tone_screen_field)(f, y, x, n, d * per, c * per, chart + 1);
	}
}

static void dots(const frame *f, const tone_slot *s, const tone_rest *rest, int y, int x, int n, const float *dark,
		 float *ink)
{
	tone_field chart[2];
	ISA(tone_chart)(f, s, rest, y, x, n, chart);
	ISA(tone_dots)(s->screen, n, chart, dark, ink);
}

static void pictures(const frame *f, const tone_slot *s, const tone_rest *rest, int y, int x, int n, const float *dark,
		     float *ink)
{
	tone_field chart[2];
	ISA(tone_chart)(f, s, rest, y, x, n, chart);
	ISA(tone_picture_row)(s, n, chart, dark, ink);
}

/* What strokes.c has drawn, and what is ink for print. */
static void marks(const frame *f, int y, int x, int n, float *restrict ink)
{
	const tone_marks *m = ((const tone_frame *)f->tones)->marks;
	const uint8_t *restrict bits = tone_bytes(m, TONE_BITS, y) + x, *restrict dark =
										tone_bytes(m, TONE_DARK, y) + x;
	const float *restrict drawn = tone_ink(m, y) + x;
	int lost = 0;
	memcpy(ink, drawn, (size_t)n * sizeof *ink);
	for (int i = 0; i < n; i++)
		lost |= bits[i];
	for (int i = 0; lost & TONE_LOST && i < n; i++)
		ink[i] = bits[i] & TONE_LOST ? (float)dark[i] * (1.0f / 255) : ink[i];
	const tone_detail *detail = &((const tone_frame *)f->tones)->detail;
	size_t at = (size_t)y * (size_t)f->width + (size_t)x;
	for (int i = 0; detail->keep && i < n; i++)
		ink[i] = max(ink[i], (float)detail->inked[at + (size_t)i] * (1.0f / 255));
}

/* Two families of lines, of which the second has what the first leaves of the darkness. */
static void lines(const frame *f, const tone_slot *s, const tone_rest *rest, int y, int x, int n, const float *dark,
		  float *ink)
{
	bool cross = s->kind == tone_1_CROSS;
	tone_field field;
	float first[TONE_CHUNK], second[TONE_CHUNK], cut[TONE_CHUNK], more[TONE_CHUNK] = {0};
	float c = s->across[0], d = s->across[1], per = 1 / max(s->pitch, 2);
	float along[3] = {d + 0.15f, 0.1f, c}, other[3];
	unit(along);
	other[0] = along[1] * 0.2f - along[2] * 0.75f;
	other[1] = along[2] * 0.6f - along[0] * 0.2f;
	other[2] = along[0] * 0.75f - along[1] * 0.6f;
	unit(other);
	for (int i = 0; i < n; i++) {
		first[i] = cross ? 1 - sqrtf(1 - dark[i]) : dark[i];
		cut[i] = 1;
	}
	if (rest) {
		ISA(tone_surface_field)(rest, n, along, 1 / s->unit, &field);
		ISA(tone_cut)(rest, n, along, cut);
	} else
		ISA(tone_screen_field)(f, y, x, n, d * per, c * per, &field);
	for (int i = 0; i < n; i++) {
		first[i] *= cut[i];
		float left = first[i] < 1 ? 1 - (1 - dark[i]) / (1 - first[i]) : 0;
		second[i] = cross || cut[i] < 1 ? clamp01(left) : 0;
	}
	ISA(tone_lines)(s->screen, n, &field, first, ink);
	if (!tone_any(second, n))
		return;
	if (rest)
		ISA(tone_surface_field)(rest, n, other, 1 / s->unit, &field);
	else
		ISA(tone_screen_field)(f, y, x, n, c * per, -d * per, &field);
	ISA(tone_lines)(s->screen, n, &field, second, more);
	for (int i = 0; i < n; i++)
		ink[i] = ink[i] + more[i] - ink[i] * more[i];
}

/* What letters of a board lie on is ink in a screen too, whose dots are as large as they are and which a shadow may cut
 * through. */
static void boards(const uint8_t *restrict board, int n, const float *restrict dark, float *restrict ink)
{
	for (int i = 0; i < n; i++)
		ink[i] = max(ink[i], dark[i] > 0 ? (float)board[i] * (1.0f / 255) : 0);
}

/* Surfaces of which no place is known have their mean. */
static void mean_row(const float *restrict size, int n, const float *restrict dark, float *restrict ink)
{
	for (int i = 0; i < n; i++)
		ink[i] = size[i] > 0 ? ink[i] : dark[i];
}

/* What has less room than a screen wants is nearer to what it is without. */
static void fit(const uint8_t *restrict room, const uint8_t *restrict aims, int n, const float *restrict dark,
		float *restrict to)
{
	for (int i = 0; i < n; i++)
		to[i] = most_one((dark[i] * (float)room[i] + (float)aims[i]) * (1.0f / 255));
}

static void ink_row(const frame *f, const encre_params *p, const tone_slot *s, int y, int x, int n, int thread,
		    const float *dark, float *ink)
{
	float fitted[TONE_CHUNK];
	const tone_detail *d = &((const tone_frame *)f->tones)->detail;
	size_t at = (size_t)y * (size_t)f->width + (size_t)x;
	const float *asked = dark;
	if (d->room && tone_is_screen(s)) {
		fit(d->room + at, d->aim + at, n, dark, fitted);
		dark = fitted;
	}
	switch (s->kind) {
	case tone_1_SOLID:
		for (int i = 0; i < n; i++)
			ink[i] = dark[i] > 0 ? 1 : 0;
		return;
	case tone_1_GRAIN:
		for (int i = 0; i < n; i++)
			ink[i] = 1 - dark[i];
		if (!ISA(hatch_cover)(f, p, y, x, n, ink))
			memset(ink, 0, (size_t)n * sizeof *ink);
		return;
	case tone_1_HATCH:
	case tone_1_STIPPLE: marks(f, y, x, n, ink); return;
	default: break;
	}
	tone_rest own;
	const tone_rest *rest = tone_sticks(s) ? ISA(tone_rest_fill)(f, s, y, x, n, &own) : NULL;
	fetch_ahead(f, thread);
	(s->kind == tone_1_DOTS ? dots : s->kind == tone_1_IMAGE ? pictures : lines)(f, s, rest, y, x, n, dark, ink);
	if (rest)
		mean_row(rest->at[ANCHOR_PIXEL], n, dark, ink);
	if (d->keep && tone_is_screen(s))
		boards(d->board + at, n, asked, ink);
}

/* Ink over the picture, and over what the output has of tones. */
static void draw_row(const tone_slot *s, int n, const float *restrict ink, const float *restrict share,
		     const bool *restrict clear, float *restrict surface, float *restrict tones)
{
	for (int i = 0; i < n; i++) {
		float t = ink[i] * share[i];
		t = s->crisp ? t >= 0.5f : t;
		surface[4 * i + 3] = clear[i] ? blend(surface[4 * i + 3], 1, t) : surface[4 * i + 3];
		float alpha = clear[i] ? 1 : surface[4 * i + 3];
		for (int c = 0; c < 3; c++)
			surface[4 * i + c] = blend(surface[4 * i + c], bounded(s->color[c] * alpha), t);
		for (int c = 0; c < 4 && tones; c++)
			tones[4 * i + c] = blend(tones[4 * i + c], bounded((c < 3 ? s->color[c] : 1) * alpha), t);
	}
}

/* ---- stage ------------------------------------------------------------------------------------------------- */

static const tone_style *tones_of(const frame *f, const encre_params *p)
{
	return ((const tone_frame *)f->tones)->styles + (p - f->params);
}

/* On bare paper a shadow that a catcher shows is its tones alone, between which all else is seen. */
static void clear_shadows(const frame *f, int y, int x, int n, float *restrict surface, bool *restrict clear)
{
	bool caught = f->params->surface == surface_PAPER && ISA(tone_caught)(f, y, x, n, clear);
	for (int i = 0; i < n; i++) {
		clear[i] = caught && clear[i] && surface[4 * i + 3] < 1;
		for (int c = 0; c < 4; c++)
			surface[4 * i + c] = clear[i] ? 0 : surface[4 * i + c];
	}
}

/* The darkest level's ink comes last. */
static void tone_run(const frame *f, const encre_params *p, int y, int x, int n, int thread)
{
	float ink[TONE_CHUNK];
	bool clear[TONE_CHUNK];
	tone_wanted w;
	const tone_style *style = tones_of(f, p);
	const tone_slot *slots = style->slot;
	float *tones = output_row(f, ENCRE_OUTPUT_TONES, y),
	      *surface = output_row(f, ENCRE_OUTPUT_COMBINED, y) + (ptrdiff_t)4 * x;
	tones = tones ? tones + (ptrdiff_t)4 * x : NULL;
	clear_shadows(f, y, x, n, surface, clear);
	if (style->only >= 0) { /* what was wanted then */
		const tone_marks *m = ((const tone_frame *)f->tones)->marks;
		const uint8_t *share = tone_bytes(m, TONE_SHARE, y) + x;
		for (int i = 0; i < n; i++)
			w.share[0][i] = (float)share[i] * (1.0f / 255);
		marks(f, y, x, n, ink);
		draw_row(slots + style->only, n, ink, w.share[0], clear, surface, tones);
		return;
	}
	fetch_ahead(f, thread);
	ISA(tone_want)(f, p, slots, y, x, n, &w);
	fetch_ahead(f, thread);
	for (int k = TONE_SLOTS - 1; k >= 0; k--) {
		if (!w.any[k])
			continue;
		ink_row(f, p, slots + k, y, x, n, thread, w.dark[k], ink);
		fetch_ahead(f, thread);
		draw_row(slots + k, n, ink, w.share[k], clear, surface, tones);
	}
}

static void tone_rows(void *data, int y0, int y1, int thread)
{
	const frame *f = data;
	for (int y = y0; y < y1; y++) {
		float *tones = output_row(f, ENCRE_OUTPUT_TONES, y);
		if (tones)
			memset(tones, 0, (size_t)f->width * 4 * sizeof *tones);
		for (int x = 0, end; f->any.use_tones && x < f->width; x = end) {
			int most = f->width - x > TONE_TOGETHER ? x + TONE_TOGETHER : f->width;
			const encre_params *p = style_run(f, y, x, most, &end);
			if (p->use_tones)
				tone_run(f, p, y, x, end - x, thread);
		}
	}
}

/* picture: NULL while measuring. */
static void plan_pictures(const frame *f, const encre_params *p, tone_picture *picture, arena *a)
{
	const struct {
		int kind;
		const encre_image *image;
		float pitch;
	} given[TONE_SLOTS] = {
#define GIVEN(n) {p->tone_##n, &p->tone_##n##_image, p->tone_##n##_pitch},
		TONE_EACH(GIVEN)
#undef GIVEN
	};
	for (int k = 0; k < TONE_SLOTS; k++) {
		tone_picture own = ISA(tone_picture_of)(given[k].image, ISA(tone_pitch)(f, given[k].pitch));
		if (p->use_tones && given[k].kind == tone_1_IMAGE && own.image->data) {
			own.threshold = arena_take(a, (size_t)own.width * (size_t)own.height, sizeof *own.threshold);
			own.count = arena_take(a, TONE_GREYS, sizeof *own.count);
		}
		if (picture)
			picture[k] = own;
	}
}

static bool marked(const frame *f)
{
	bool found = false;
	for (int i = 0; i < f->n_styles; i++)
		found |= ISA(tone_marks_wanted)(f->params + i);
	return found;
}

static bool stippled(const frame *f)
{
	bool found = false;
	for (int i = 0; i < f->n_styles; i++) {
		const encre_params *p = f->params + i;
#define IN(n) || p->tone_##n == tone_##n##_STIPPLE
		found |= p->use_tones && (false TONE_EACH(IN));
#undef IN
	}
	return found;
}

static bool screened(const frame *f)
{
	bool found = false;
	for (int i = 0; i < f->n_styles; i++) {
		const encre_params *p = f->params + i;
#define IN(n) || p->tone_##n == tone_##n##_DOTS || p->tone_##n == tone_##n##_LINES || p->tone_##n == tone_##n##_CROSS
		found |= p->use_tones && (false TONE_EACH(IN));
#undef IN
	}
	return found;
}

/* Whether strokes of things go toward the light. */
static bool lit(const frame *f)
{
	bool found = false;
	for (int i = 0; i < f->n_styles; i++)
		found |= ISA(tone_marks_wanted)(f->params + i) && f->params[i].tone_strokes == tone_strokes_LIGHT;
	return found && f->layer[ENCRE_LAYER_ANCHOR].data;
}

/* Whether light is left on things in the dark. */
static bool opens(const frame *f)
{
	bool found = false;
	for (int i = 0; i < f->n_styles; i++)
		found |= f->params[i].use_tones && f->params[i].tone_open > 0;
	return found && f->layer[ENCRE_LAYER_NORMAL].data;
}

static bool works(const frame *f)
{
	return marked(f) || opens(f) || tone_joins(f) || tone_fitted(f) || tone_spots_small(f);
}

enum { WANTED = 1 << 15 /* tiles of points that find a place at once */ };

static void plan(frame *f, arena *a)
{
	f->tones = NULL;
	if (!f->any.use_tones)
		return;
	tone_frame *t = arena_take(a, 1, sizeof *t);
	tone_frame own = {.styles = arena_take(a, (size_t)f->n_styles, sizeof *own.styles)};
	own.detail.prints = marked(f) || screened(f);
	if (opens(f)) {
		own.opening = arena_take(a, (size_t)f->width * (size_t)f->height, sizeof *own.opening);
		own.things = arena_take(a, TONE_THINGS, sizeof *own.things);
	}
	own.settling = tone_joins(f) ? arena_take(a, (size_t)f->width * (size_t)f->height, sizeof *own.settling) : NULL;
	own.spotted = tone_spots_small(f) ? arena_take(a, (size_t)f->width * (size_t)f->height, 1) : NULL;
	ISA(tone_detail_plan)(f, &own.detail, a);
	if (marked(f)) {
		tone_marks *m = own.marks = arena_take(a, 1, sizeof *m);
		tone_marks planes = {
			.styles = own.styles,
			.bytes = arena_take(a, (size_t)f->width * (size_t)f->height, TONE_BYTES),
			.ink = arena_take(a, (size_t)f->width * (size_t)f->height, sizeof *planes.ink),
			.blocks = arena_take(a, (size_t)tone_blocks(f->width) * (size_t)tone_blocks(f->height),
					     2 * sizeof *planes.blocks),
			.wanted = {stippled(f) ? arena_take(a, WANTED, sizeof *planes.wanted.key) : NULL, WANTED - 1},
			.lacks = stippled(f) ? arena_take(a, (size_t)f->height, sizeof *planes.lacks) : NULL,
			.turns = lit(f) ? arena_take(a, TONE_TURNS, sizeof *planes.turns) : NULL,
			.width = f->width,
			.first = arena_take(a, (size_t)f->height + 1, sizeof *planes.first)};
		if (m)
			*m = planes;
	}
	if (t)
		*t = own;
	f->tones = t;
	for (int i = 0; i < f->n_styles; i++)
		plan_pictures(f, f->params + i, own.styles ? own.styles[i].picture : NULL, a);
}

/* What is seen where nothing is: a sky, which is a night if any of it has light, for where none has it is not meant as
 * one, and less than a quarter is as light as a day: what is dark in a picture of a bright sky, trees and houses, would
 * be blots; and shadows that were caught. */
static void look_at_nothing(const frame *f, tone_frame *t)
{
	static const float day = 0.1f;
	int64_t sky = 0, light = 0;
	bool any = false;
	t->caught = false;
	for (int y = 0; y < f->height; y++) {
		const float *depth = layer_row(f, ENCRE_LAYER_DEPTH, y), *c = layer_row(f, ENCRE_LAYER_COMBINED, y);
		const float *d = layer_row(f, ENCRE_LAYER_DIFFUSE, y);
		for (int x = 0; depth && c && d && x < f->width; x++, c += 4, d += 3) {
			bool nothing = !(depth_of(depth[x]) < INFINITY), seen = nothing && c[3] > tone_film;
			float bright = max3(c[0], c[1], c[2]);
			any |= seen && bright > 0;
			sky += seen;
			light += seen && bright > day;
			t->caught |= nothing && max3(d[0], d[1], d[2]) > 0;
		}
	}
	t->night = any && 4 * light < sky && !(f->params->tone_sky > 0);
}

static int32_t prepare(frame *f)
{
	tone_frame *t = f->tones;
	if (t) {
		t->settled = NULL; /* of the frame before */
		look_at_nothing(f, t);
	}
	for (int i = 0; i < f->n_styles && t; i++)
		if (f->params[i].use_tones)
			ISA(tone_style_fill)(f, f->params + i, t->styles + i);
	if (t && t->marks)
		ISA(tone_marks_tables)(t->marks);
	int32_t code = ENCRE_OK;
	for (int i = 0; t && i < f->n_styles; i++)
		for (int k = 0; !code && k < TONE_SLOTS; k++)
			if (t->styles[i].picture[k].threshold)
				code = ISA(tone_picture_fill)(f, t->styles[i].picture + k);
	return code;
}

/* Whether strokes are told by layers of their pixels alone, without what is clear of them and how whole things lie. */
static bool looks_first(const tone_frame *t)
{
	return t && t->marks && !t->detail.keep && !t->spotted && !t->opening && !t->settling && !t->marks->turns;
}

static void first_rows(void *data, int y0, int y1, int thread)
{
	const frame *f = data;
	const tone_frame *t = f->tones;
	if (looks_first(t))
		ISA(tone_marks_rows)(f, t->marks, y0, y1, thread);
}

static int32_t run(frame *f)
{
	tone_frame *t = f->tones;
	int32_t code = t && t->spotted ? ISA(tone_blacks_run)(f, t->spotted) : ENCRE_OK;
	if (!code && t && t->opening)
		code = ISA(tone_open_run)(f, t);
	if (!code && t && t->settling)
		code = ISA(tone_crumbs_run)(f, t);
	if (!code && t && t->detail.keep)
		code = ISA(tone_detail_run)(f, &t->detail);
	if (!code && t && t->detail.room)
		code = ISA(tone_room_run)(f, &t->detail, t->styles);
	return !code && t && t->marks ? ISA(tone_marks_run)(f, t->marks, looks_first(t)) : code;
}

const stage STAGE_SYMBOL(tones) = {.id = "tones",
				   .plan = plan,
				   .prepare = prepare,
				   .first_rows = first_rows,
				   .run = run,
				   .rows = tone_rows,
				   .draws = works};
