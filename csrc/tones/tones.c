/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Tones: levels of light filled with dots, lines or ink, as printed comics have them, so that the mean of the ink is
 * the darkness of the level. On the screen they are a screen of print; on surfaces they keep to the layer `anchor`:
 * dots to the two axes of the resting thing that its normal is farthest from, lines to planes through it. Every pixel
 * is drawn by its own layers alone, from one frame. */
#include "tones/tones.h"

#include <string.h>

/* A style's tone of a level. */
typedef struct slot {
	int kind, space;
	float pitch, gradient, across[2]; /* pixels; cosine and sine of the angle */
	const float *color;
	int like; /* the first slot that looks the same, perhaps this one: ink that is the same grows from one to the
		     next */
	const tone_screen *screen; /* of the first that looks the same */
} slot;

typedef struct style_tones {
	slot slot[TONE_SLOTS];
	tone_screen screen[TONE_SLOTS];
} style_tones;

/* What there is to draw in a chunk: of each slot its share of the pixel and its darkness there. */
typedef struct wanted {
	float share[TONE_SLOTS][TONE_CHUNK], dark[TONE_SLOTS][TONE_CHUNK];
	bool any[TONE_SLOTS];
} wanted;

/* ---- which tone, and how dark ------------------------------------------------------------------------------ */

static int slot_of(int level)
{
	return level < TONE_SLOTS ? level : TONE_SLOTS - 1;
}

/* Light that levels are compared with; what shines or reflects is not in the dark. Nothing there: INFINITY. */
static void light_row(const frame *f, const encre_params *p, int y, int x, int n, float *restrict light)
{
	const float *controls = controls_at(f, x, y),
		    *combined = layer_row(f, ENCRE_LAYER_COMBINED, y) + (ptrdiff_t)4 * x,
		    *color = layer_row(f, ENCRE_LAYER_COLOR, y) + (ptrdiff_t)3 * x,
		    *diffuse = layer_row(f, ENCRE_LAYER_DIFFUSE, y) + (ptrdiff_t)3 * x;
	for (int i = 0; i < n; i++) {
		const float *d = diffuse + 3 * i;
		light[i] = max(max3(d[0], d[1], d[2]) * p->shade_exposure + painted_light(controls, i),
			       other_light(combined + 4 * i, color + 3 * i, d));
	}
}

/* Levels are at most two at a pixel: their transitions don't overlap. */
static void want_level(const encre_params *p, int level, float gradient, int n, const float *restrict light,
		       const float *restrict added, float *restrict share, float *restrict sum)
{
	const encre_level *own = p->shade_levels.level + level, *next = own + 1;
	bool first = level == 0, last = level == p->shade_levels.count - 1;
	float base = 1 - own->intensity + p->tone_darkness, start = first ? 0 : own->threshold;
	float in = own->transition > 1e-30f ? 1 / own->transition : 0,
	      out = !last && next->transition > 1e-30f ? 1 / next->transition : 0;
	float span = last ? 0 : next->threshold - start, along = span > 1e-30f ? 1 / span : 0;
	float fall = last ? 0 : gradient * (next->intensity - own->intensity);
	for (int i = 0; i < n; i++) {
		float x = light[i];
		float entered = first ? 1 : in > 0 ? clamp01((x - own->threshold) * in + 0.5f) : x > own->threshold;
		float left = last ? 0 : out > 0 ? clamp01((x - next->threshold) * out + 0.5f) : x > next->threshold;
		float here = max(entered - left, 0);
		share[i] += here;
		sum[i] += here * clamp01(base - fall * clamp01((x - start) * along) + added[i]);
	}
}

static bool any(const float *values, int n)
{
	float most = 0;
	for (int i = 0; i < n; i++)
		most = max(most, values[i]);
	return most > 0;
}

static void want(const frame *f, const encre_params *p, const slot *slots, int y, int x, int n, wanted *w)
{
	float light[TONE_CHUNK], added[TONE_CHUNK], none[TONE_CHUNK] = {0};
	const float *controls = controls_at(f, x, y), *depth = layer_row(f, ENCRE_LAYER_DEPTH, y) + x;
	light_row(f, p, y, x, n, light);
	for (int i = 0; i < n; i++)
		added[i] = controls ? controls[CONTROL_COUNT * i + CONTROL_HATCHING] : 0;
	for (int k = 0; k < TONE_SLOTS; k++)
		w->any[k] = false;
	for (int level = 0; level < p->shade_levels.count; level++) {
		const slot *own = slots + slot_of(level);
		int k = own->like;
		if (own->kind == tone_1_NONE)
			continue;
		if (!w->any[k]) {
			memset(w->share[k], 0, sizeof w->share[k]);
			memset(w->dark[k], 0, sizeof w->dark[k]);
		}
		w->any[k] = true;
		want_level(p, level, own->gradient, n, light, own->kind == tone_1_GRAIN ? none : added, w->share[k],
			   w->dark[k]);
	}
	for (int k = 0; k < TONE_SLOTS; k++) {
		for (int i = 0; i < n && w->any[k]; i++) {
			float share = depth_of(depth[i]) < INFINITY ? w->share[k][i] : 0;
			w->dark[k][i] = share > 0 ? clamp01(w->dark[k][i] / w->share[k][i]) : 0;
			w->share[k][i] = clamp01(share);
		}
		w->any[k] = w->any[k] && any(w->dark[k], n);
	}
}

/* ---- where screens lie ------------------------------------------------------------------------------------- */

/* A field of the picture: along (right, down), pixels of the full frame. */
static void screen_field(const frame *f, int y, int x, int n, float right, float down, tone_field *field)
{
	float row = (float)(f->place.y + y) + 0.5f;
	for (int i = 0; i < n; i++) {
		field->at[i] = right * ((float)(f->place.x + x + i) + 0.5f) + down * row;
		field->right[i] = right;
		field->down[i] = down;
	}
}

/* A field of the thing: its place along a direction in the space in which it rests. */
static void surface_field(const float *restrict anchor, int n, const float along[3], tone_field *field)
{
	for (int i = 0; i < n; i++) {
		const float *a = anchor + (ptrdiff_t)ANCHOR_COUNT * i, *r = a + ANCHOR_RIGHT, *d = a + ANCHOR_DOWN;
		field->at[i] = a[0] * along[0] + a[1] * along[1] + a[2] * along[2];
		field->right[i] = r[0] * along[0] + r[1] * along[1] + r[2] * along[2];
		field->down[i] = d[0] * along[0] + d[1] * along[1] + d[2] * along[2];
	}
}

/* The two axes of the thing that its normal is farthest from, turned. */
static void surface_chart(const float *restrict anchor, int n, float cosine, float sine, tone_field field[2])
{
	for (int i = 0; i < n; i++) {
		const float *a = anchor + (ptrdiff_t)ANCHOR_COUNT * i, *normal = a + ANCHOR_NORMAL;
		float x = fabsf(normal[0]), y = fabsf(normal[1]), z = fabsf(normal[2]);
		int first = x >= y && x >= z ? 1 : 0, second = x < z && y < z ? 1 : 2;
		for (int k = 0; k < 2; k++) {
			float one = k ? -sine : cosine, two = k ? cosine : sine;
			field[k].at[i] = one * a[first] + two * a[second];
			field[k].right[i] = one * a[ANCHOR_RIGHT + first] + two * a[ANCHOR_RIGHT + second];
			field[k].down[i] = one * a[ANCHOR_DOWN + first] + two * a[ANCHOR_DOWN + second];
		}
	}
}

/* How well planes across a direction cut the surface: not where they graze it. */
static void cut_row(const float *restrict anchor, int n, const float along[3], float *restrict cut)
{
	for (int i = 0; i < n; i++) {
		const float *normal = anchor + (ptrdiff_t)ANCHOR_COUNT * i + ANCHOR_NORMAL;
		float dot = normal[0] * along[0] + normal[1] * along[1] + normal[2] * along[2];
		cut[i] = clamp01((sqrtf(max(1 - dot * dot, 0)) - 0.3f) / 0.12f);
	}
}

static void unit(float v[3])
{
	float scale = 1 / sqrtf(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
	for (int c = 0; c < 3; c++)
		v[c] *= scale;
}

/* ---- ink --------------------------------------------------------------------------------------------------- */

static void dots(const frame *f, const slot *s, int y, int x, int n, const float *dark, float *ink)
{
	tone_field chart[2];
	float c = s->across[0], d = s->across[1];
	const float *anchor = s->space == tone_1_space_SURFACE ? anchor_at(f, x, y) : NULL;
	if (anchor)
		surface_chart(anchor, n, c, d, chart);
	else {
		screen_field(f, y, x, n, c, -d, chart);
		screen_field(f, y, x, n, d, c, chart + 1);
	}
	ISA(tone_dots)(s->screen, n, chart, dark, ink);
}

/* Two families of lines, of which the second has what the first leaves of the darkness. */
static void lines(const frame *f, const slot *s, int y, int x, int n, const float *dark, float *ink)
{
	bool cross = s->kind == tone_1_CROSS;
	tone_field field;
	float first[TONE_CHUNK], second[TONE_CHUNK], cut[TONE_CHUNK], more[TONE_CHUNK] = {0};
	float c = s->across[0], d = s->across[1];
	float along[3] = {d + 0.15f, 0.1f, c}, other[3];
	const float *anchor = s->space == tone_1_space_SURFACE ? anchor_at(f, x, y) : NULL;
	unit(along);
	other[0] = along[1] * 0.2f - along[2] * 0.75f;
	other[1] = along[2] * 0.6f - along[0] * 0.2f;
	other[2] = along[0] * 0.75f - along[1] * 0.6f;
	unit(other);
	for (int i = 0; i < n; i++) {
		first[i] = cross ? 1 - sqrtf(1 - dark[i]) : dark[i];
		cut[i] = 1;
	}
	if (anchor) {
		surface_field(anchor, n, along, &field);
		cut_row(anchor, n, along, cut);
	} else
		screen_field(f, y, x, n, d, c, &field);
	for (int i = 0; i < n; i++) {
		first[i] *= cut[i];
		float left = first[i] < 1 ? 1 - (1 - dark[i]) / (1 - first[i]) : 0;
		second[i] = cross || cut[i] < 1 ? clamp01(left) : 0;
	}
	ISA(tone_lines)(s->screen, n, &field, first, ink);
	if (!any(second, n))
		return;
	if (anchor)
		surface_field(anchor, n, other, &field);
	else
		screen_field(f, y, x, n, c, -d, &field);
	ISA(tone_lines)(s->screen, n, &field, second, more);
	for (int i = 0; i < n; i++)
		ink[i] = ink[i] + more[i] - ink[i] * more[i];
}

/* Surfaces of which no place is known have their mean. */
static void mean_row(const float *anchor, int n, const float *restrict dark, float *restrict ink)
{
	for (int i = 0; i < n; i++)
		ink[i] = anchor[(ptrdiff_t)ANCHOR_COUNT * i + ANCHOR_PIXEL] > 0 ? ink[i] : dark[i];
}

static void ink_row(const frame *f, const encre_params *p, const slot *s, int y, int x, int n, const float *dark,
		    float *ink)
{
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
	case tone_1_DOTS: dots(f, s, y, x, n, dark, ink); break;
	default: lines(f, s, y, x, n, dark, ink);
	}
	if (s->space == tone_1_space_SURFACE && anchor_at(f, x, y))
		mean_row(anchor_at(f, x, y), n, dark, ink);
}

/* Ink over the picture, and over what the output has of tones. */
static void draw_row(const float *color, int n, const float *restrict ink, const float *restrict share,
		     float *restrict surface, float *restrict tones)
{
	for (int i = 0; i < n; i++) {
		float t = ink[i] * share[i], alpha = surface[4 * i + 3];
		for (int c = 0; c < 3; c++)
			surface[4 * i + c] = blend(surface[4 * i + c], bounded(color[c] * alpha), t);
		for (int c = 0; c < 4 && tones; c++)
			tones[4 * i + c] = blend(tones[4 * i + c], (c < 3 ? color[c] : 1) * alpha, t);
	}
}

/* ---- stage ------------------------------------------------------------------------------------------------- */

static const style_tones *tones_of(const frame *f, const encre_params *p)
{
	return (const style_tones *)f->tones + (p - f->params);
}

/* The darkest level's ink comes last. */
static void tone_run(const frame *f, const encre_params *p, int y, int x, int n)
{
	float ink[TONE_CHUNK];
	wanted w;
	const slot *slots = tones_of(f, p)->slot;
	float *tones = output_row(f, ENCRE_OUTPUT_TONES, y),
	      *surface = output_row(f, ENCRE_OUTPUT_COMBINED, y) + (ptrdiff_t)4 * x;
	want(f, p, slots, y, x, n, &w);
	for (int k = TONE_SLOTS - 1; k >= 0; k--) {
		if (!w.any[k])
			continue;
		ink_row(f, p, slots + k, y, x, n, w.dark[k], ink);
		draw_row(slots[k].color, n, ink, w.share[k], surface, tones ? tones + (ptrdiff_t)4 * x : NULL);
	}
}

static void tone_rows(void *data, int y0, int y1, int thread)
{
	(void)thread;
	const frame *f = data;
	for (int y = y0; y < y1; y++) {
		float *tones = output_row(f, ENCRE_OUTPUT_TONES, y);
		if (tones)
			memset(tones, 0, (size_t)f->width * 4 * sizeof *tones);
		for (int x = 0, end; f->any.use_tones && x < f->width; x = end) {
			int most = f->width - x > TONE_CHUNK ? x + TONE_CHUNK : f->width;
			const encre_params *p = style_run(f, y, x, most, &end);
			if (p->use_tones)
				tone_run(f, p, y, x, end - x);
		}
	}
}

static void plan(frame *f, arena *a)
{
	f->tones = f->any.use_tones ? arena_take(a, (size_t)f->n_styles, sizeof(style_tones)) : NULL;
}

static bool alike(const slot *a, const slot *b)
{
	return a->kind == b->kind && a->space == b->space && a->pitch == b->pitch && a->across[0] == b->across[0] &&
	       a->across[1] == b->across[1] && memcmp(a->color, b->color, 3 * sizeof *a->color) == 0;
}

static void fill_slots(const frame *f, const encre_params *p, style_tones *t)
{
#define SLOT(n)                                                                                                        \
	{                                                                                                              \
		.kind = p->tone_##n, .space = p->tone_##n##_space, .pitch = p->tone_##n##_pitch * f->scale,            \
		.gradient = p->tone_##n##_gradient,                                                                    \
		.across = {pixel_cos(p->tone_##n##_angle * 0.0174532925f),                                             \
			   pixel_sin(p->tone_##n##_angle * 0.0174532925f)},                                            \
		.color = p->tone_##n##_color                                                                           \
	}
	const slot given[TONE_SLOTS] = {SLOT(1), SLOT(2), SLOT(3), SLOT(4)};
#undef SLOT
	memcpy(t->slot, given, sizeof given);
	for (int k = 0; k < TONE_SLOTS; k++) {
		slot *s = t->slot + k;
		s->like = k;
		for (int j = k - 1; j >= 0; j--)
			if (alike(t->slot + j, s))
				s->like = j;
		s->screen = t->screen + s->like;
		if (s->like == k)
			ISA(tone_screen_fill)(t->screen + k, s->pitch, p->tone_hardness, s->kind == tone_1_DOTS);
	}
}

static int32_t prepare(frame *f)
{
	style_tones *styles = f->tones;
	for (int i = 0; i < f->n_styles && styles; i++)
		if (f->params[i].use_tones)
			fill_slots(f, f->params + i, styles + i);
	return ENCRE_OK;
}

const stage STAGE_SYMBOL(tones) = {.id = "tones", .plan = plan, .prepare = prepare, .rows = tone_rows};
