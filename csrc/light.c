/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Where light crosses the threshold of a level, between two pixels. Light has noise, and on soft light a little of it
 * moves a threshold far: light is evened out first, along its level lines more than across them, and never over the
 * edge of a shadow (a wavelet transform with holes that stops at edges: Dammertz et al. 2010). */
#include "fine.h"
#include "metric.h"

enum { PASSES = 3, MARGIN = 1 << (PASSES - 1) };

/* What differs by more than this, relative to the light itself, is no noise; light at least. */
static const float most_noise = 0.035f, least_light = 0.02f, most_light = 1e15f;

/* ---- evenness -------------------------------------------------------------------------------------------- */

typedef struct even {
	const fine *n;
	const float *from; /* NULL: the layer */
	float *to;
	int step;
} even;

static ptrdiff_t stride_of(const frame *f)
{
	return (f->width + 2 * MARGIN + 15) & ~(ptrdiff_t)15;
}

static const float *light_row(const fine *n, int y)
{
	return n->light + y * stride_of(n->f) + MARGIN;
}

static void value_row(const float *restrict diffuse, int n, float *restrict out)
{
	for (int i = 0; i < n; i++) {
		const float *d = diffuse + (ptrdiff_t)3 * i;
		float v = max3(d[0], d[1], d[2]);
		out[i] = v < most_light ? v : most_light;
	}
}

/* Adds what another pixel says of `own`, as far as it is alike. */
static inline void hear(float other, float own, float sharp, float share, float *restrict sum, float *restrict weights)
{
	float d = other - own, w = 1 - d * d * sharp;
	w = w > 0 ? w : 0;
	w = share * w * w;
	*sum += w * d;
	*weights += w;
}

/* The mean of the 3x3 at a distance of `step` pixels, weighted as a B-spline and by how alike they are. */
static void even_row(const float *const *row, int step, int n, float *restrict out)
{
	const float *restrict a = row[0], *restrict b = row[1], *restrict c = row[2];
	for (int i = 0; i < n; i++) {
		float own = b[i], scale = most_noise * (own > least_light ? own : least_light);
		float sharp = 1 / (scale * scale), sum = 0, weights = 4;
		hear(b[i - step], own, sharp, 2, &sum, &weights);
		hear(b[i + step], own, sharp, 2, &sum, &weights);
		hear(a[i], own, sharp, 2, &sum, &weights);
		hear(c[i], own, sharp, 2, &sum, &weights);
		hear(a[i - step], own, sharp, 1, &sum, &weights);
		hear(a[i + step], own, sharp, 1, &sum, &weights);
		hear(c[i - step], own, sharp, 1, &sum, &weights);
		hear(c[i + step], own, sharp, 1, &sum, &weights);
		out[i] = own + sum / weights;
	}
}

static void even_rows(void *data, int y0, int y1, int thread)
{
	(void)thread;
	const even *v = data;
	const frame *f = v->n->f;
	ptrdiff_t stride = stride_of(f);
	for (int y = y0; y < y1; y++) {
		float *out = v->to + y * stride + MARGIN;
		if (v->from) {
			const float *row[3];
			for (int k = 0; k < 3; k++)
				row[k] = v->from + clamp_index(y + (k - 1) * v->step, f->height) * stride + MARGIN;
			even_row(row, v->step, f->width, out);
		} else
			value_row(f->layer[ENCRE_LAYER_DIFFUSE].data + y * f->layer[ENCRE_LAYER_DIFFUSE].row, f->width,
				  out);
		for (int k = 1; k <= MARGIN; k++) {
			out[-k] = out[0];
			out[f->width - 1 + k] = out[f->width - 1];
		}
	}
}

int32_t ISA(light_even)(fine *n)
{
	size_t room = (size_t)stride_of(n->f) * (size_t)n->f->height;
	float *light = late_take(&n->f->late, room, sizeof *light), *spare = late_take(&n->f->late, room, sizeof *spare);
	if (!light || !spare)
		return ENCRE_ERROR_MEMORY;
	even v = {.n = n, .to = spare};
	int32_t code = rows_run(n->f->rows, n->f->height, 0, even_rows, &v);
	for (int pass = 0; !code && pass < PASSES; pass++) {
		v = (even){n, pass % 2 ? light : spare, pass % 2 ? spare : light, 1 << pass};
		code = rows_run(n->f->rows, n->f->height, 0, even_rows, &v);
	}
	late_drop(&n->f->late, spare);
	n->light = light;
	return code;
}

/* ---- levels ---------------------------------------------------------------------------------------------- */

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
	const float *light = light_row(n, y);
	for (int x = 0, end; x < f->width; x = end) {
		const encre_params *p = style_run(f, y, x, f->width, &end);
		float exposure = p->shade_exposure;
		memset(level + x, 0, (size_t)(end - x));
		for (int k = 1; k < p->shade_levels.count; k++) {
			float threshold = p->shade_levels.level[k].threshold;
			for (int i = x; i < end; i++)
				level[i] += light[i] * exposure > threshold;
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

bool ISA(light_site)(const fine *n, site *s)
{
	const frame *f = n->f;
	int qx = s->column + (s->axis == AXIS_ROW), qy = s->row + (s->axis == AXIS_COLUMN);
	crack_place(s, 0.5f);
	int style = fine_style(n, s);
	const encre_params *own = f->params + style;
	float one = bounded(light_row(n, s->row)[s->column] * own->shade_exposure),
	      two = bounded(light_row(n, qy)[qx] * own->shade_exposure);
	int low = level_of(&own->shade_levels, one < two ? one : two),
	    high = level_of(&own->shade_levels, one > two ? one : two);
	if (low == high)
		return false;
	/* a step over several thresholds is one line */
	float threshold = 0.5f * (own->shade_levels.level[low + 1].threshold + own->shade_levels.level[high].threshold);
	crack_place(s, clamp01((threshold - one) / (two - one)));
	s->strength = 0;
	return ISA(fine_weigh)(n, s, style, SOURCE_LIGHT, ISA(light_contrast)(n, own, one, two));
}
