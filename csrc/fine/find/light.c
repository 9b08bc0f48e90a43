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
		float light[CHUNK], exposure = p->shade_exposure;
		for (int i = 0; i < end - x; i++)
			light[i] = max3(d[3 * i], d[3 * i + 1], d[3 * i + 2]) * exposure + painted_light(controls, i);
		memset(level + x, 0, (size_t)(end - x));
		for (int k = 1; k < p->shade_levels.count; k++) {
			float threshold = p->shade_levels.level[k].threshold;
			for (int i = x; i < end; i++)
				level[i] += light[i - x] > threshold;
		}
	}
}

float ISA(light_contrast)(const fine *n, const encre_params *p, float one, float two)
{
	int metric = n->e->p->contrast_metric;
	const encre_level *level = p->shade_levels.level;
	float a = clamp01(level[level_of(&p->shade_levels, one)].intensity),
	      b = clamp01(level[level_of(&p->shade_levels, two)].intensity);
	if (a == b)
		return 0;
	float plane[3][2] = {{a, b}, {a, b}, {a, b}}, difference = 0;
	ISA(metric_space)(metric, 2, plane[0], plane[1], plane[2]);
	const float *first[3] = {plane[0], plane[1], plane[2]}, *second[3] = {plane[0] + 1, plane[1] + 1, plane[2] + 1};
	ISA(metric_difference)(metric, 1, first, second, &difference);
	return difference;
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
	/* a step over several thresholds is one line */
	float threshold = 0.5f * (own->shade_levels.level[low + 1].threshold + own->shade_levels.level[high].threshold);
	crack_place(at, clamp01((threshold - one) / (two - one)), s);
	s->strength = 0;
	float difference = ISA(light_contrast)(n, own, one, two);
	return ISA(fine_weigh)(n, s, style, SOURCE_LIGHT, ISA(color_strength)(n, at, SOURCE_LIGHT, difference));
}
