/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Ridges: where a layer that is averaged over its pixels changes faster than on both sides: a crease in the normals, a
 * boundary between colours, the edge of a shadow. Pixels beside a crack hold two surfaces: there is no ridge in them,
 * and no read along a direction goes past them. */
#include "fine.h"
#include "metric.h"

enum { REACH = 3, SPAN = 2 * REACH + 1 };

static const float least_of_step = 0.4f;   /* share of a step that slopes beside it may not explain */
static const float crease_from = 0.35f, crease_ramp = 0.37f; /* of the difference of normals at crease_angle */
static const float least_color = 0.01f, least_light = 0.02f;
static const float more_of_band = 1.2f, least_light_band = 0.1f; /* floor: times a step's; of light */
static const float widest_band = 2.05f;    /* pixels */
static const float least_of_peak = 1.5f;   /* times the step across a band */
static const float most_against = 0.1f;    /* share of a band that a pixel of it may lie the other way */

/* Rows about the one worked on: sample 0 of each, REACH more before it and after the last. */
typedef struct window {
	const fine *n;
	enum source source;
	int planes;
	const float *row[3][SPAN];
	const uint8_t *mixed[SPAN];
	float least_contrast; /* difference across, below which no step is strong enough */
} window;

static enum family step_of(enum source s)
{
	return s == SOURCE_NORMAL ? FAMILY_NORMAL : s == SOURCE_COLOR ? FAMILY_COLOR : FAMILY_LIGHT_STEP;
}

static enum family band_of(enum source s)
{
	return (enum family)(step_of(s) - 1);
}

static float floor_of(const fine *n, enum source s)
{
	return s == SOURCE_NORMAL ? crease_from * n->crease : s == SOURCE_COLOR ? least_color : least_light;
}

static float band_floor(const fine *n, enum source s)
{
	return s == SOURCE_LIGHT ? least_light_band : more_of_band * floor_of(n, s);
}

/* ---- in a window ----------------------------------------------------------------------------------------- */

static float difference2(const float *a, const float *b, int planes)
{
	float sum = 0;
	for (int c = 0; c < planes; c++)
		sum += (a[c] - b[c]) * (a[c] - b[c]);
	return sum;
}

/* What lies `step` away from a pixel, or itself where that holds two surfaces. */
static void beside(const window *w, int x, int k, int step, int axis, float *value)
{
	int sx = x + (axis ? 0 : step), sk = k + (axis ? step : 0);
	if (w->mixed[sk][sx]) {
		sx = x;
		sk = k;
	}
	for (int c = 0; c < w->planes; c++)
		value[c] = w->row[c][sk][sx];
}

/* Along which axis the 3x3 about x changes more. */
static int steeper(const window *w, int x)
{
	float sum[2] = {0, 0};
	for (int k = REACH - 1; k <= REACH + 1; k++)
		for (int i = x - 1; i <= x + 1; i++)
			for (int axis = 0; axis < 2 && !w->mixed[k][i]; axis++) {
				float before[3], after[3];
				beside(w, i, k, -1, axis, before);
				beside(w, i, k, 1, axis, after);
				sum[axis] += difference2(after, before, w->planes);
			}
	return sum[AXIS_COLUMN] > sum[AXIS_ROW] ? AXIS_COLUMN : AXIS_ROW;
}

/* Samples along an axis about x; value[REACH] is its own. Returns how far they go before they repeat, on the shorter side. */
static int along(const window *w, int x, int axis, float (*value)[3])
{
	int shorter = REACH;
	for (int side = -1; side <= 1; side += 2) {
		int held = 0;
		for (int k = 1; k <= REACH && held == k - 1; k++)
			held += !w->mixed[REACH + (axis ? side * k : 0)][x + (axis ? 0 : side * k)];
		for (int k = 0; k <= REACH; k++)
			for (int c = 0, at = side * (k < held ? k : held); c < w->planes; c++)
				value[REACH + side * k][c] = w->row[c][REACH + (axis ? at : 0)][x + (axis ? 0 : at)];
		shorter = held < shorter ? held : shorter;
	}
	return shorter;
}

/* Whether the step at x is the greatest of those of the five along its axis that go the same way: the far side of a thin
 * stripe goes the other way. Of two equal ones, which lie at the same place, the first counts. */
static bool greatest(const window *w, int x, int axis)
{
	float value[SPAN][3], own, floor = floor_of(w->n, w->source);
	if (along(w, x, axis, value) < 1)
		return false;
	own = difference2(value[REACH + 1], value[REACH - 1], w->planes);
	if (!(own > floor * floor))
		return false;
	for (int k = -2; k <= 2; k++) {
		float other = difference2(value[REACH + k + 1], value[REACH + k - 1], w->planes), dot = 0;
		for (int c = 0; c < w->planes; c++)
			dot += (value[REACH + k + 1][c] - value[REACH + k - 1][c]) * (value[REACH + 1][c] - value[REACH - 1][c]);
		if (dot > 0 && (other > own || (k < 0 && other == own)))
			return false;
	}
	return true;
}

/* How far the three pixels about x lie from the line between their neighbours. */
static float bulge2(const window *w, int x, int k, int axis)
{
	float sum = 0;
	for (int c = 0; c < w->planes; c++) {
		float v[5];
		for (int i = -2; i <= 2; i++)
			v[i + 2] = w->row[c][k + (axis ? i : 0)][x + (axis ? 0 : i)];
		float e = (v[1] + v[2] + v[3]) - 1.5f * (v[0] + v[4]);
		sum += e * e;
	}
	return sum;
}

/* Whether the pixel at x is the one of a band that lies farthest from that line. */
static bool peaks(const window *w, int x, int axis)
{
	float value[SPAN][3], dot[3] = {0, 0, 0};
	if (along(w, x, axis, value) < 2)
		return false;
	const float (*v)[3] = (const float (*)[3])value + REACH - 2;
	for (int c = 0; c < w->planes; c++) {
		float e = (v[1][c] + v[2][c] + v[3][c]) - 1.5f * (v[0][c] + v[4][c]);
		for (int i = 0; i < 3; i++)
			dot[i] += (v[i + 1][c] - mix(v[0][c], v[4][c], 0.25f * (float)(i + 1))) * e;
	}
	return dot[1] > dot[0] && dot[1] > dot[2];
}

static int bulging(const window *w, int x)
{
	float sum[2] = {0, 0};
	for (int k = REACH - 1; k <= REACH + 1; k++)
		for (int i = x - 1; i <= x + 1; i++)
			for (int axis = 0; axis < 2; axis++)
				sum[axis] += sqrtf(bulge2(w, i, k, axis));
	return sum[AXIS_COLUMN] > sum[AXIS_ROW] ? AXIS_COLUMN : AXIS_ROW;
}

/* ---- sites ----------------------------------------------------------------------------------------------- */

/* A pixel's value in linear terms. */
static void read(const fine *n, enum source source, int x, int y, float *value)
{
	const frame *f = n->f;
	enum encre_layer layer = source == SOURCE_NORMAL ? ENCRE_LAYER_NORMAL : source == SOURCE_LIGHT ? ENCRE_LAYER_DIFFUSE
	                       : n->e->p->color_layer == color_layer_LIT ? ENCRE_LAYER_COMBINED : ENCRE_LAYER_ALBEDO;
	const float *in = f->layer[layer].data + y * f->layer[layer].row + (ptrdiff_t)(layer == ENCRE_LAYER_COMBINED ? 4 : 3) * x;
	for (int c = 0; c < 3; c++)
		value[c] = source == SOURCE_COLOR ? clamp01(in[c]) : bounded(in[c]);
	if (source == SOURCE_LIGHT) {
		int style = f->style ? f->style[(ptrdiff_t)y * f->width + x] : 0;
		value[0] = bounded(max3(in[0], in[1], in[2]) * f->params[style].shade_exposure);
	}
}

/* Values at -2..2 along the axis of a site, read outwards up to where a pixel holds two surfaces: so far they go. */
static void read_along(const fine *n, enum source source, const site *s, float (*value)[3], int *far)
{
	for (int side = -1; side <= 1; side += 2) {
		int held = 0;
		for (int k = 1; k <= 2 && held == k - 1; k++) {
			int x = clamp_index(s->column + (s->axis ? 0 : side * k), n->f->width);
			int y = clamp_index(s->row + (s->axis ? side * k : 0), n->f->height);
			held += !mixed_at(n, x, y);
		}
		for (int k = 0; k <= 2; k++) {
			int at = side * (k < held ? k : held);
			read(n, source, clamp_index(s->column + (s->axis ? 0 : at), n->f->width),
			     clamp_index(s->row + (s->axis ? at : 0), n->f->height), value[2 + side * k]);
		}
		far[side > 0] = held;
	}
}

/* How much of the first of two values is in a mixture of them. */
static float share(const float *value, const float *first, const float *second, int planes)
{
	float dot = 0, square = 0;
	for (int c = 0; c < planes; c++) {
		dot += (value[c] - second[c]) * (first[c] - second[c]);
		square += (first[c] - second[c]) * (first[c] - second[c]);
	}
	return square > 0 ? clamp01(dot / square) : 0.5f;
}

/* Colours in the space of the metric. */
static void encode(const fine *n, float (*value)[3])
{
	float plane[3][5];
	for (int k = 0; k < 5; k++)
		for (int c = 0; c < 3; c++)
			plane[c][k] = value[k][c];
	ISA(metric_space)(n->e->p->contrast_metric, 5, plane[0], plane[1], plane[2]);
	for (int k = 0; k < 5; k++)
		for (int c = 0; c < 3; c++)
			value[k][c] = plane[c][k];
}

static float contrast(const fine *n, float difference)
{
	const encre_params *p = n->e->p;
	float ramp = p->contrast_max - p->contrast_threshold;
	return difference < p->contrast_threshold ? 0 : ramp > 0 ? clamp01((difference - p->contrast_threshold) / ramp) : 1;
}

static float distance2(const float *a, const float *b, int planes)
{
	float sum = 0;
	for (int c = 0; c < planes; c++)
		sum += (a[c] - b[c]) * (a[c] - b[c]);
	return sum;
}

/* Which values stand for the two sides of a step: the outer ones, unless the step is one side of a stripe. */
static void sides(float (*value)[3], int planes, int *low, int *high)
{
	bool inner = distance2(value[1], value[3], planes) > distance2(value[0], value[4], planes);
	*low = inner ? 1 : 0;
	*high = inner ? 3 : 4;
}

static void put(site *s, float offset)
{
	offset = offset < -1 ? -1 : offset > 1 ? 1 : offset;
	s->x = (float)s->column + (s->axis ? 0 : offset);
	s->y = (float)s->row + (s->axis ? offset : 0);
}

/* A stripe, narrow enough that its two boundaries are one line. */
static bool band_site(const fine *n, site *s, enum source source, int planes, float (*value)[3])
{
	float base[3], e[3], c[3] = {0, 0, 0}, area = 0;
	if (source == SOURCE_COLOR)
		encode(n, value);
	for (int k = 0; k < planes; k++) {
		e[k] = (value[1][k] + value[2][k] + value[3][k]) - 1.5f * (value[0][k] + value[4][k]);
		base[k] = 0.5f * (value[0][k] + value[4][k]);
		area += e[k] * e[k];
	}
	area = sqrtf(area);
	if (!(area > band_floor(n, source)))
		return false;
	for (int i = 0; i < 3; i++)
		for (int k = 0; k < planes; k++)
			c[i] += (value[i + 1][k] - mix(value[0][k], value[4][k], 0.25f * (float)(i + 1))) * e[k] / area;
	float against = -most_against * area;
	if (!(c[1] > c[0] && c[1] > c[2] && area <= widest_band * c[1] && c[0] > against && c[2] > against &&
	      c[1] > least_of_peak * sqrtf(distance2(value[0], value[4], planes))))
		return false;
	put(s, (c[2] - c[0]) / area);
	int style = fine_style(n, s);
	s->strength = 0;
	if (source == SOURCE_NORMAL)
		return ISA(fine_weigh)(n, s, style, source, clamp01((area - crease_from * n->crease) / (crease_ramp * n->crease)));
	float difference = 0;
	if (source == SOURCE_LIGHT) { /* the stripe may be narrower than a pixel, and so darker than what is seen of it */
		float rise = e[0] > 0 ? 1 : -1, near = rise * value[0][0] > rise * value[4][0] ? value[0][0] : value[4][0];
		float deep = near + 2 * e[0], far = rise * deep > rise * value[2][0] ? deep : value[2][0];
		difference = ISA(light_contrast)(n, n->f->params + style, near, far);
	} else {
		float peak[3] = {base[0] + e[0], base[1] + e[1], base[2] + e[2]};
		const float *a[3] = {peak, peak + 1, peak + 2}, *b[3] = {base, base + 1, base + 2};
		ISA(metric_difference)(n->e->p->contrast_metric, 1, a, b, &difference);
	}
	return ISA(fine_weigh)(n, s, style, source, contrast(n, difference));
}

bool ISA(ridge_site)(const fine *n, site *s)
{
	float value[5][3], difference = 0, bend = 0, step = 0;
	enum source source = s->family <= FAMILY_NORMAL ? SOURCE_NORMAL : s->family <= FAMILY_COLOR ? SOURCE_COLOR : SOURCE_LIGHT;
	int planes = source == SOURCE_LIGHT ? 1 : 3, far[2], low = 0, high = 4;
	read_along(n, source, s, value, far);
	if (s->family == band_of(source))
		return far[0] == 2 && far[1] == 2 && band_site(n, s, source, planes, value);
	sides(value, planes, &low, &high);
	float offset = -1.5f;
	for (int k = 1; k <= 3; k++)
		offset += share(value[k], value[low], value[high], planes);
	put(s, unbiased(offset));
	int style = fine_style(n, s);

	if (source == SOURCE_COLOR)
		encode(n, value);
	/* where a surface turns away it turns ever faster: the slope up to the last pixel goes on at least as steeply */
	int from = far[0] < 2, to = 4 - (far[1] < 2);
	for (int c = 0; c < planes; c++) {
		float d = value[3][c] - value[1][c], j = d - (value[from + 1][c] - value[from][c]) - (value[to][c] - value[to - 1][c]);
		bend += j * j;
		step += d * d;
	}
	for (int c = 0; c < planes; c++)
		s->step[c] = (int8_t)(127 * (value[3][c] - value[1][c]) / (step > 0 ? 1.001f * sqrtf(step) : 1));
	bend = sqrtf(bend);
	if (!(bend > least_of_step * sqrtf(step) && bend > floor_of(n, source)))
		return false;
	s->strength = 0;
	if (source == SOURCE_NORMAL)
		return ISA(fine_weigh)(n, s, style, source, clamp01((bend - crease_from * n->crease) / (crease_ramp * n->crease)));
	if (source == SOURCE_LIGHT)
		difference = ISA(light_contrast)(n, n->f->params + style, value[low][0], value[high][0]);
	else {
		const float *a[3] = {value[low], value[low] + 1, value[low] + 2}, *b[3] = {value[high], value[high] + 1, value[high] + 2};
		ISA(metric_difference)(n->e->p->contrast_metric, 1, a, b, &difference);
	}
	return ISA(fine_weigh)(n, s, style, source, contrast(n, difference));
}

/* ---- rows ------------------------------------------------------------------------------------------------ */

/* Bytes with REACH to spare on both sides. */
static void mixed_row(const fine *n, int y, uint8_t *out)
{
	int width = n->f->width;
	const uint8_t *crack = n->crack + (ptrdiff_t)y * width, *above = y > 0 ? crack - width : NULL;
	out[0] = crack[0] & (CRACK_RIGHT | CRACK_DOWN);
	for (int x = 1; x < width; x++)
		out[x] = (uint8_t)((crack[x] & (CRACK_RIGHT | CRACK_DOWN)) | (crack[x - 1] & CRACK_RIGHT));
	for (int x = 0; above && x < width; x++)
		out[x] |= above[x] & CRACK_DOWN;
	for (int k = 1; k <= REACH; k++) {
		out[-k] = out[0];
		out[width - 1 + k] = out[width - 1];
	}
}

/* Bits by axis. */
enum { STEP = 1, BAND = 4 };

/* Squared lengths of what makes a step, across one pixel and across two, and of what makes a band. Called with a constant
 * number of planes, so that the loop over them is unrolled and the one over pixels vectorised. */
static inline void measure(const float *const (*v)[3], int planes, int n, float *restrict step, float *restrict wide, float *restrict bulge)
{
	for (int i = 0; i < n; i++) {
		float step2 = 0, wide2 = 0, bulge2 = 0;
		for (int c = 0; c < planes; c++) {
			float near = v[3][c][i] - v[1][c][i], far = v[4][c][i] - v[0][c][i];
			float e = (v[1][c][i] + v[2][c][i] + v[3][c][i]) - 1.5f * (v[0][c][i] + v[4][c][i]);
			step2 += near * near;
			wide2 += far * far;
			bulge2 += e * e;
		}
		step[i] = step2;
		wide[i] = wide2;
		bulge[i] = bulge2;
	}
}

/* Takes back what no level of light lies between: v are samples -2..2 along an axis. */
static void keep_levels(const encre_levels *levels, const float *const *v, int n, int axis, int32_t *restrict bits)
{
	float low[TILE], high[TILE], deep_low[TILE], deep_high[TILE];
	int32_t step[TILE], band[TILE];
	for (int i = 0; i < n; i++) {
		float a = v[0][i], b = v[1][i], c = v[2][i], d = v[3][i], e = v[4][i];
		float ab = a < b ? a : b, de = d < e ? d : e, AB = a > b ? a : b, DE = d > e ? d : e;
		float least = ab < de ? ab : de, most = AB > DE ? AB : DE, bulge = 2 * ((b + c + d) - 1.5f * (a + e));
		low[i] = least < c ? least : c;
		high[i] = most > c ? most : c;
		deep_low[i] = low[i] + (bulge < 0 ? bulge : 0);
		deep_high[i] = high[i] + (bulge > 0 ? bulge : 0);
		step[i] = band[i] = 0;
	}
	for (int k = 1; k < levels->count; k++) {
		float threshold = levels->level[k].threshold;
		for (int i = 0; i < n; i++) {
			step[i] |= (low[i] <= threshold) & (high[i] > threshold);
			band[i] |= (deep_low[i] <= threshold) & (deep_high[i] > threshold);
		}
	}
	for (int i = 0; i < n; i++)
		bits[i] &= ~(((step[i] ? 0 : STEP) | (band[i] ? 0 : BAND)) << axis);
}

/* Where a step or a band may be along which axis. Beside a crack a step is what it is up to there. */
static void candidates(const window *w, int x0, int n, uint8_t *restrict out)
{
	float step[TILE], wide[TILE], bulge[TILE];
	int32_t bits[TILE];
	float least = floor_of(w->n, w->source), band = band_floor(w->n, w->source), contrast = w->least_contrast;
	for (int i = 0; i < n; i++)
		bits[i] = 0;
	for (int axis = 0; axis < 2; axis++) {
		const float *v[5][3];
		for (int k = -2; k <= 2; k++)
			for (int c = 0; c < w->planes; c++)
				v[k + 2][c] = w->row[c][REACH + (axis ? k : 0)] + x0 + (axis ? 0 : k);
		if (w->planes == 3)
			measure((const float *const (*)[3])v, 3, n, step, wide, bulge);
		else
			measure((const float *const (*)[3])v, 1, n, step, wide, bulge);
		for (int i = 0; i < n; i++) {
			float far = wide[i] > step[i] ? wide[i] : step[i];
			int is_step = (step[i] > least * least) & (far > contrast * contrast), is_band = bulge[i] > band * band;
			bits[i] |= (is_step ? STEP << axis : 0) | (is_band ? BAND << axis : 0);
		}
		if (w->source == SOURCE_LIGHT && !w->n->f->style)
			keep_levels(&w->n->e->p->shade_levels, (const float *const[]){v[0][0], v[1][0], v[2][0], v[3][0], v[4][0]}, n, axis, bits);
	}
	const uint8_t *mixed = w->mixed[REACH] + x0, *above = w->mixed[REACH - 1] + x0, *below = w->mixed[REACH + 1] + x0;
	for (int i = 0; i < n; i++) {
		uint8_t beside = mixed[i - 1] | mixed[i + 1] | above[i] | below[i];
		uint8_t all = (uint8_t)((uint8_t)bits[i] | (beside ? STEP | STEP << 1 : 0));
		out[i] = mixed[i] ? 0 : all;
	}
}

static void mark(const window *w, int x, int y, enum family family, int axis, uint16_t *ridge)
{
	site s = {.column = (uint16_t)x, .row = (uint16_t)y, .family = (uint8_t)family, .axis = (uint8_t)axis};
	if (ISA(ridge_site)(w->n, &s))
		ridge[x] |= (uint16_t)(1 << (2 * (int)family + axis));
}

static void ridge_tile(const window *w, int y, int x0, int n, uint16_t *ridge)
{
	uint8_t candidate[TILE + 8] = {0};
	candidates(w, x0, n, candidate);
	for (int i = 0; i < n; i++) {
		uint64_t eight;
		memcpy(&eight, candidate + i, 8);
		if (!eight) {
			i += 7;
			continue;
		}
		int x = x0 + i, axis;
		for (axis = 0; axis < 2; axis++)
			if ((candidate[i] & BAND << axis) && peaks(w, x, axis) && bulging(w, x) == axis)
				mark(w, x, y, band_of(w->source), axis, ridge);
		for (axis = 0; axis < 2; axis++)
			if ((candidate[i] & STEP << axis) && greatest(w, x, axis) && steeper(w, x) == axis)
				mark(w, x, y, step_of(w->source), axis, ridge);
	}
}

ptrdiff_t ISA(ridge_scratch)(const frame *f)
{
	return (SPAN * (f->width + 2 * REACH) + 3) / 4;
}

void ISA(ridge_rows)(void *data, int y0, int y1, int thread)
{
	const fine *n = data;
	const frame *f = n->f;
	uint8_t *mixed = (uint8_t *)(n->scratch + thread * n->thread_scratch) + REACH;
	ring rings[SOURCE_COUNT];
	for (int s = SOURCE_NORMAL; s <= SOURCE_LIGHT; s++)
		rings[s] = ISA(ring_of)(n->e, (enum source)s, thread);
	for (int y = y0; y < y1; y++) {
		uint16_t *ridge = n->ridge + (ptrdiff_t)y * f->width;
		window w = {.n = n};
		memset(ridge, 0, (size_t)f->width * sizeof *ridge);
		for (int k = 0; k < SPAN; k++) {
			int row = clamp_index(y - REACH + k, f->height);
			uint8_t *at = mixed + (row % SPAN) * (f->width + 2 * REACH);
			if (y == y0 || (k == SPAN - 1 && y + REACH < f->height))
				mixed_row(n, row, at);
			w.mixed[k] = at;
		}
		for (int s = SOURCE_NORMAL; s <= SOURCE_LIGHT; s++) {
			bool wanted = n->e->on[s];
			for (int k = -1; s == SOURCE_COLOR && wanted && k <= 1; k++) /* a site may lie in the next row */
				if ((wanted = n->colored[clamp_index(y + k, f->height)]))
					break;
			if (!wanted)
				continue;
			ISA(ring_fill)(rings + s, y);
			w.source = (enum source)s;
			w.planes = s == SOURCE_LIGHT ? 1 : 3;
			w.least_contrast = s == SOURCE_COLOR ? n->least_contrast : 0;
			for (int c = 0; c < w.planes; c++)
				ISA(ring_window)(rings + s, y, 0, c, w.row[c]);
			for (int x0 = 0; x0 < f->width; x0 += TILE)
				ridge_tile(&w, y, x0, f->width - x0 < TILE ? f->width - x0 : TILE, ridge);
		}
	}
}
