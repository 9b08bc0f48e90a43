/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Where light crosses the threshold of a level, between two pixels. Light has noise, and on soft light a little of it
 * moves a threshold far: light is evened out first, along its level lines more than across them, and never over the
 * edge of a shadow (a wavelet transform with holes that stops at edges: Dammertz et al. 2010). */
#include "fine/near.h"
#include "base/metric.h"

#include <string.h>

enum {
	PASSES = 3,
	MARGIN = 1 << (PASSES - 1),
	HALO = (1 << PASSES) - 1,
	BAND = 32,
	SPAN = 32,
	LANES = 16,
	PIECE_ROWS = 128
};

/* What differs by more than this, relative to the light itself, is no noise; light at least. */
static const float most_noise = 0.035f, least_light = 0.02f, most_light = 1e7f; /* test_fine_sites; the last: no test */
/* Likewise, by what evening can change light: a pass moves it a third of most_noise if all others are 0.6 of that off,
 * and less if not. */
static const float most_change = 0.037f; /* a bound: mutants.txt */

/* ---- where it matters ------------------------------------------------------------------------------------ */

/* Of a span of pixels: light may cross a threshold in it, or between it and the next; evening one that does reads it.
 * Before that: into which level all of it rises, or MIXED. */
enum { CROSSED = 1, READ = 2, MIXED = 255 };

typedef struct even {
	const fine *n;
	int spans;
	uint8_t *mark; /* spans * height */
} even;

static void value_row(const float *restrict diffuse, int n, float *restrict out)
{
	for (int i = 0; i < n; i++) {
		const float *d = diffuse + (ptrdiff_t)3 * i;
		float v = max3(d[0], d[1], d[2]);
		out[i] = v < most_light ? v : most_light;
	}
}

static void values(const frame *f, int y, int x, int end, float *out)
{
	value_row(layer_row(f, ENCRE_LAYER_DIFFUSE, y) + (ptrdiff_t)3 * x, end - x, out);
}

/* Into how many levels light x rises. */
static inline int level_of(const encre_levels *levels, float x)
{
	int k = 0;
	while (k + 1 < levels->count && x > levels->level[k + 1].threshold)
		k++;
	return k;
}

static float change_of(float light)
{
	return most_change * max(light, least_light);
}

/* The level of all these pixels, evened or not; MIXED if they may have several. */
static int level_of_all(const encre_params *p, const float *light, int n)
{
	float low[LANES], high[LANES];
	for (int k = 0; k < LANES; k++)
		low[k] = high[k] = light[0];
	int i = 0;
	for (; i + LANES <= n; i += LANES)
		for (int k = 0; k < LANES; k++) {
			float v = light[i + k];
			low[k] = min(v, low[k]);
			high[k] = max(v, high[k]);
		}
	for (int k = 0; k < LANES; k++) { /* what is left of the row, then of the lanes */
		float v = light[i + k < n ? i + k : 0];
		low[0] = min(low[0], min(low[k], v));
		high[0] = max(high[0], max(high[k], v));
	}
	int level = level_of(&p->shade_levels, (low[0] - change_of(low[0])) * p->shade_exposure);
	return level == level_of(&p->shade_levels, (high[0] + change_of(high[0])) * p->shade_exposure) ? level : MIXED;
}

static bool is_painted(const float *controls, int n)
{
	bool any = false;
	for (int i = 0; controls && i < n; i++)
		any |= controls[CONTROL_COUNT * i + CONTROL_LIGHT] != 0;
	return any;
}

/* Fills the light with its noise, and finds the spans of one level. */
static void level_rows(void *data, int y0, int y1, int thread)
{
	(void)thread;
	const even *v = data;
	const frame *f = v->n->f;
	for (int y = y0; y < y1; y++) {
		float *light = v->n->light + (ptrdiff_t)y * f->width;
		uint8_t *mark = v->mark + (ptrdiff_t)y * v->spans;
		values(f, y, 0, f->width, light);
		for (int x = 0, end; x < f->width; x = end) {
			int span_end = (x / SPAN + 1) * SPAN < f->width ? (x / SPAN + 1) * SPAN : f->width;
			const encre_params *p = style_run(f, y, x, span_end, &end);
			int level = is_painted(controls_at(f, x, y), end - x) ? MIXED
									      : level_of_all(p, light + x, end - x),
			    before = x % SPAN ? mark[x / SPAN] : level;
			mark[x / SPAN] = (uint8_t)(level == before ? level : MIXED);
		}
	}
}

/* Turns levels into CROSSED and READ. */
static int32_t find_spans(const even *v)
{
	int spans = v->spans, height = v->n->f->height;
	uint8_t *crossed = late_take(&v->n->f->late, (size_t)spans * (size_t)height, sizeof *crossed);
	if (!crossed)
		return ENCRE_ERROR_MEMORY;
	int32_t code = ENCRE_OK;
	for (int y = 0; !code && y < height; y++) {
		code = y % PIECE_ROWS ? ENCRE_OK : bands_poll(v->n->f->bands);
		for (int k = 0; k < spans; k++) {
			const uint8_t *own = v->mark + (ptrdiff_t)y * spans + k;
			crossed[(ptrdiff_t)y * spans + k] =
				*own == MIXED || (k > 0 && own[-1] != *own) || (k + 1 < spans && own[1] != *own) ||
				(y > 0 && own[-spans] != *own) || (y + 1 < height && own[spans] != *own);
		}
	}
	for (int y = 0; !code && y < height; y++) {
		uint8_t *mark = v->mark + (ptrdiff_t)y * spans;
		code = y % PIECE_ROWS ? ENCRE_OK : bands_poll(v->n->f->bands);
		memset(mark, 0, (size_t)spans);
		for (int i = clamp_index(y - HALO, height); i <= clamp_index(y + HALO, height); i++) {
			const uint8_t *row = crossed + (ptrdiff_t)i * spans;
			for (int k = 0; k < spans; k++)
				mark[k] |= row[k];
		}
		for (int k = 0, before = 0; k < spans; k++) {
			int own = mark[k];
			mark[k] = (before | own | (k + 1 < spans && mark[k + 1])) ? READ : 0;
			before = own;
		}
		for (int k = 0; k < spans; k++)
			mark[k] |= crossed[(ptrdiff_t)y * spans + k];
	}
	late_drop(&v->n->f->late, crossed);
	return code;
}

/* ---- evenness -------------------------------------------------------------------------------------------- */

static ptrdiff_t stride_of(const frame *f)
{
	return (f->width + 2 * MARGIN + 15) & ~(ptrdiff_t)15;
}

/* Rows of what each pass reads: pass k those up to 2^k away. */
ptrdiff_t ISA(light_scratch)(const frame *f)
{
	return (2 * HALO + PASSES) * stride_of(f);
}

/* Adds what another pixel says of `own`, as far as it is alike: within the root of `square`. */
static inline void hear(float other, float own, float square, float share, float *restrict sum, float *restrict weights)
{
	float d = other - own, w = square - d * d;
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
		float square = scale * scale, sum = 0, weights = 4 * square * square;
		hear(b[i - step], own, square, 2, &sum, &weights);
		hear(b[i + step], own, square, 2, &sum, &weights);
		hear(a[i], own, square, 2, &sum, &weights);
		hear(c[i], own, square, 2, &sum, &weights);
		hear(a[i - step], own, square, 1, &sum, &weights);
		hear(a[i + step], own, square, 1, &sum, &weights);
		hear(c[i - step], own, square, 1, &sum, &weights);
		hear(c[i + step], own, square, 1, &sum, &weights);
		out[i] = own + sum / weights;
	}
}

/* The next pixels of a row from x on that are marked so; false after the last. */
static bool next_run(const even *v, int y, int bit, int *x, int *end)
{
	const uint8_t *mark = v->mark + (ptrdiff_t)y * v->spans;
	int k = (*end + SPAN - 1) / SPAN, last;
	while (k < v->spans && !(mark[k] & bit))
		k++;
	for (last = k; last < v->spans && (mark[last] & bit);)
		last++;
	*x = k * SPAN;
	*end = last * SPAN < v->n->f->width ? last * SPAN : v->n->f->width;
	return k < v->spans;
}

/* Makes a row of what pass k reads, or of the light. Beyond what is READ rows hold anything. */
static void make_row(const even *v, float *const *held, int k, int y)
{
	const frame *f = v->n->f;
	ptrdiff_t stride = stride_of(f);
	float *out =
		k < PASSES ? held[k] + y % (2 * (1 << k) + 1) * stride + MARGIN : v->n->light + (ptrdiff_t)y * f->width;
	for (int x, end = 0; next_run(v, y, k < PASSES ? READ : CROSSED, &x, &end);) {
		if (k == 0)
			values(f, y, x, end, out + x);
		else {
			int step = 1 << (k - 1);
			const float *row[3];
			for (int i = -1; i <= 1; i++)
				row[i + 1] = held[k - 1] +
					     clamp_index(y + i * step, f->height) % (2 * step + 1) * stride + MARGIN +
					     x;
			even_row(row, step, end - x, out + x);
		}
		for (int i = 1; k < PASSES && i <= MARGIN; i++) {
			if (x == 0)
				out[-i] = out[0];
			if (end == f->width)
				out[end - 1 + i] = out[end - 1];
		}
	}
}

static void even_rows(void *data, int y0, int y1, int thread)
{
	const even *v = data;
	float *held[PASSES];
	for (int k = 0; k < PASSES; k++)
		held[k] = k ? held[k - 1] + ((1 << k) + 1) * stride_of(v->n->f)
			    : v->n->scratch + thread * v->n->thread_scratch;
	for (int y = y0 - 2 * HALO; y < y1; y++) /* each pass as far ahead as the next ones reach */
		for (int k = 0; k <= PASSES; k++) {
			int ahead = HALO + 1 - (1 << k), row = y + ahead;
			if (row >= 0 && row >= y0 - ahead && row < v->n->f->height)
				make_row(v, held, k, row);
		}
}

int32_t ISA(light_even)(fine *n)
{
	frame *f = n->f;
	even v = {.n = n, .spans = pieces_of(f->width, SPAN)};
	n->light = late_take(&f->late, (size_t)f->width * (size_t)f->height, sizeof *n->light);
	v.mark = late_take(&f->late, (size_t)v.spans * (size_t)f->height, sizeof *v.mark);
	if (!n->light || !v.mark)
		return ENCRE_ERROR_MEMORY;
	int32_t code = bands_run(f->bands, f->height, 0, level_rows, &v);
	if (!code)
		code = find_spans(&v);
	if (!code)
		code = bands_run(f->bands, f->height, BAND, even_rows, &v);
	late_drop(&f->late, v.mark);
	return code;
}

/* ---- levels ---------------------------------------------------------------------------------------------- */

static const float *light_row(const fine *n, int y)
{
	return n->light + (ptrdiff_t)y * n->f->width;
}

void ISA(level_row)(const fine *n, int y, uint8_t *restrict level)
{
	const frame *f = n->f;
	const float *light = light_row(n, y);
	for (int x = 0, end; x < f->width; x = end) {
		const encre_params *p = style_run(f, y, x, f->width, &end);
		const float *controls = controls_at(f, x, y);
		float exposure = p->shade_exposure;
		memset(level + x, 0, (size_t)(end - x));
		for (int k = 1; k < p->shade_levels.count; k++) {
			float threshold = p->shade_levels.level[k].threshold;
			for (int i = x; i < end; i++)
				level[i] += light[i] * exposure + painted_light(controls, i - x) > threshold;
		}
	}
}

static float light_at(const fine *n, const encre_params *p, int x, int y)
{
	return bounded(light_row(n, y)[x] * p->shade_exposure + painted_light(controls_at(n->f, x, y), 0));
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
	crack_place(at, 0.5f, s);
	int style = fine_style(n, at, s);
	const encre_params *own = f->params + style;
	float one = light_at(n, own, at->column, at->row), two = light_at(n, own, qx, qy);
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
