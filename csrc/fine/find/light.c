/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Where light crosses the threshold of a level, between two pixels: where what is filled by levels ends. */
#include "fine/near.h"
#include "base/metric.h"

#include <string.h>

enum { CHUNK = 256 };

/* Into how many levels light x rises. */
static inline int level_of(const encre_levels *levels, float x)
{
	int k = 0;
	while (k + 1 < levels->count && x > levels->level[k + 1].threshold)
		k++;
	return k;
}

void ISA(level_row)(const fine *n, int y, uint8_t *restrict level)
{
	const frame *f = n->f;
	const float *diffuse = layer_row(f, ENCRE_LAYER_DIFFUSE, y);
	for (int x = 0, end; x < f->width; x = end) {
		const encre_params *p = style_run(f, y, x, f->width - x > CHUNK ? x + CHUNK : f->width, &end);
		const float *d = diffuse + (ptrdiff_t)3 * x, *controls = controls_at(f, x, y);
		metering m = metering_of(f, p);
		float light[CHUNK];
		for (int i = 0; i < end - x; i++)
			light[i] = exposed(m, max3(d[3 * i], d[3 * i + 1], d[3 * i + 2])) + painted_light(controls, i);
		memset(level + x, 0, (size_t)(end - x));
		for (int k = 1; k < p->shade_levels.count; k++) {
			float threshold = p->shade_levels.level[k].threshold;
			for (int i = x; i < end; i++)
				level[i] += light[i - x] > threshold;
		}
	}
}

/* Of a style that fills by levels: how much two of them differ, by both. */
static void fill_contrasts(const color_metric *metric, const encre_params *p, float *contrast)
{
	int count = p->shade_levels.count;
	float plane[3][ENCRE_MAX_LEVELS] = {{0}}, grey[ENCRE_MAX_LEVELS];
	for (int k = 0; k < count; k++)
		for (int c = 0; c < 3; c++)
			plane[c][k] = clamp01(p->shade_levels.level[k].intensity);
	memcpy(grey, plane[0], sizeof grey);
	ISA(metric_space)(metric->kind, count, plane[0], plane[1], plane[2]);
	for (int one = 0; one < count; one++)
		for (int two = 0; two < count; two++) {
			const float *a[3] = {plane[0] + one, plane[1] + one, plane[2] + one},
				    *b[3] = {plane[0] + two, plane[1] + two, plane[2] + two};
			float *difference = contrast + ENCRE_MAX_LEVELS * one + two;
			*difference = 0;
			if (grey[one] != grey[two])
				ISA(metric_difference)(metric, 1, a, b, difference);
		}
}

void ISA(light_plan)(fine *n, const edges *e, arena *a)
{
	const frame *f = n->f;
	size_t room = ENCRE_MAX_LEVELS * ENCRE_MAX_LEVELS;
	color_metric metric = metric_of(e->p);
	if (!e->on[SOURCE_LIGHT])
		return;
	n->level_contrast = arena_take(a, (size_t)f->n_styles * room, sizeof *n->level_contrast);
	for (int i = 0; n->level_contrast && i < f->n_styles; i++)
		fill_contrasts(&metric, f->params + i, n->level_contrast + (size_t)i * room);
}

/* Between two levels. */
static float level_contrast(const fine *n, const encre_params *p, int one, int two)
{
	return n->level_contrast[((p - n->f->params) * ENCRE_MAX_LEVELS + one) * ENCRE_MAX_LEVELS + two];
}

float ISA(light_contrast)(const fine *n, const encre_params *p, float one, float two)
{
	return level_contrast(n, p, level_of(&p->shade_levels, one), level_of(&p->shade_levels, two));
}

float ISA(light_threshold)(const encre_params *p, float one, float two)
{
	const encre_levels *levels = &p->shade_levels;
	int low = level_of(levels, min(one, two)), high = level_of(levels, max(one, two));
	return low < high ? 0.5f * (levels->level[low + 1].threshold + levels->level[high].threshold) : NAN;
}

/* ---- room ------------------------------------------------------------------------------------------- */

/* Pixels from the line of a stronger threshold within which there is no room for another one, and up to where that
 * thins out. */
static const float closed = 1.5f, wide = 4, pace = 0.5f; /* test_fine_sites */

/* Light at a place on the thing that a crack's first pixel shows; false beyond it. */
static bool light_at(const fine *n, const encre_params *own, const found *at, float x, float y, float *light)
{
	const frame *f = n->f;
	/* so also a place that is no number, of a slope too large to be squared */
	if (!(x >= -0.5f && y >= -0.5f && x < (float)f->width - 0.5f && y < (float)f->height - 0.5f))
		return false;
	x = min(max(x, 0), (float)(f->width - 1)); /* beyond the centres of the first and last pixels it is as there */
	y = min(max(y, 0), (float)(f->height - 1));
	int left = (int)x, top = (int)y;
	float value[4];
	for (int k = 0; k < 4; k++) {
		int u = clamp_index(left + (k & 1), f->width), v = clamp_index(top + (k >> 1), f->height);
		const float *object = f->layer[ENCRE_LAYER_OBJECT].data ? layer_row(f, ENCRE_LAYER_OBJECT, v) : NULL;
		if (is_nothing(n, u, v) ||
		    (object && object[u] != layer_row(f, ENCRE_LAYER_OBJECT, at->row)[at->column]))
			return false;
		value[k] = bounded(exposed_at(f, own, u, v));
	}
	float a = x - (float)left;
	*light = mix(mix(value[0], value[1], a), mix(value[2], value[3], a), y - (float)top);
	return true;
}

/* The way up of light at a crack, per pixel, times its squared length. */
static float slope_at(const fine *n, const encre_params *own, const found *at, float rise, float way[2])
{
	const frame *f = n->f;
	bool down = at->axis == AXIS_COLUMN;
	float across = 0;
	for (int k = 0; k < 4; k++) {
		int along = k & 1, side = k & 2 ? 1 : -1;
		int x = at->column + (down ? side : along), y = at->row + (down ? along : side);
		float light = bounded(exposed_at(f, own, clamp_index(x, f->width), clamp_index(y, f->height)));
		across += 0.25f * (float)side * light;
	}
	way[down] = rise;
	way[!down] = across;
	return sqrtf(rise * rise + across * across);
}

/* How far a place where light crosses threshold k is from the line of a stronger one, up to `wide`. Of lines along a
 * penumbra so always the same give way, wherever the pixels are. */
static float room_of(const fine *n, const encre_params *own, const found *at, const placed *s, int k, float rise)
{
	const encre_levels *levels = &own->shade_levels;
	float way[2], slope = slope_at(n, own, at, rise, way), room = wide;
	for (int j = 1; j < levels->count; j++) {
		float threshold = levels->level[j].threshold, step = threshold - levels->level[k].threshold;
		float sign = step < 0 ? -1 : 1, before = -sign * step, light;
		if (j == k || !(fabsf(step) < 2 * wide * slope))
			continue;
		float its = level_contrast(n, own, j - 1, j), mine = level_contrast(n, own, k - 1, k);
		if (its < mine || (its == mine && j > k))
			continue;
		for (int paces = 1; (float)(paces - 1) * pace < room; paces++) {
			float far = (float)paces * pace;
			float x = s->x + sign * far * way[0] / slope, y = s->y + sign * far * way[1] / slope;
			if (!light_at(n, own, at, x, y, &light))
				break;
			float after = sign * (light - threshold);
			if (after >= 0) {
				room = min(room, far - pace * after / max(after - before, 1e-20f));
				break;
			}
			before = after;
		}
	}
	return room;
}

/* ---- sites ------------------------------------------------------------------------------------------ */

bool ISA(light_site)(const fine *n, const found *at, placed *s)
{
	const frame *f = n->f;
	int qx = at->column + (at->axis == AXIS_ROW), qy = at->row + (at->axis == AXIS_COLUMN);
	if (is_nothing(n, at->column, at->row) && is_nothing(n, qx, qy))
		return false;
	crack_place(at, 0.5f, s);
	int style = fine_style(n, at, s);
	const encre_params *own = f->params + style;
	float one = bounded(exposed_at(f, own, at->column, at->row)), two = bounded(exposed_at(f, own, qx, qy));
	int low = level_of(&own->shade_levels, one < two ? one : two),
	    high = level_of(&own->shade_levels, one > two ? one : two);
	if (low == high)
		return false;
	crack_place(at, clamp01((ISA(light_threshold)(own, one, two) - one) / (two - one)), s);
	float room = high == low + 1 ? room_of(n, own, at, s, high, two - one) : wide;
	if (room <= closed)
		return false;
	s->eased = (uint8_t)(255 * (wide - room) / (wide - closed) + 0.5f);
	s->strength = 0;
	float difference = ISA(light_contrast)(n, own, one, two);
	return ISA(fine_weigh)(n, s, style, SOURCE_LIGHT, ISA(color_strength)(n, at, SOURCE_LIGHT, difference));
}
