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

/* Rows about the one worked on: sample 0 of each, REACH more before it and after the last. */
typedef struct window {
	const fine *n;
	enum source source;
	int planes;
	const float *row[3][SPAN];
	const uint8_t *mixed[SPAN];
} window;

static enum family family_of(enum source s)
{
	return s == SOURCE_NORMAL ? FAMILY_NORMAL : s == SOURCE_COLOR ? FAMILY_COLOR : FAMILY_LIGHT_STEP;
}

static float floor_of(const fine *n, enum source s)
{
	return s == SOURCE_NORMAL ? crease_from * n->crease : s == SOURCE_COLOR ? least_color : least_light;
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

/* Whether the step at x is the greatest of the five along its axis. Of two equal ones, which lie at the same place, the
 * first counts. */
static bool greatest(const window *w, int x, int axis)
{
	float value[SPAN][3], own;
	if (along(w, x, axis, value) < 2 && w->source == SOURCE_LIGHT)
		return false; /* where a surface turns away its light falls ever faster, and repeated values would make that a step */
	own = difference2(value[REACH + 1], value[REACH - 1], w->planes);
	for (int k = -2; k <= 2; k++) {
		float other = difference2(value[REACH + k + 1], value[REACH + k - 1], w->planes);
		if (other > own || (k < 0 && other == own))
			return false;
	}
	return own > 0;
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

/* Values at -2..2 along the axis of a site, read outwards up to where a pixel holds two surfaces. */
static void read_along(const fine *n, enum source source, const site *s, float (*value)[3])
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

bool ISA(ridge_site)(const fine *n, site *s)
{
	float value[5][3], difference = 0, bend = 0, step = 0;
	enum source source = s->family <= FAMILY_NORMAL ? SOURCE_NORMAL : s->family <= FAMILY_COLOR ? SOURCE_COLOR : SOURCE_LIGHT;
	int planes = source == SOURCE_LIGHT ? 1 : 3;
	read_along(n, source, s, value);
	float offset = -1.5f;
	for (int k = 1; k <= 3; k++)
		offset += share(value[k], value[0], value[4], planes);
	offset = offset < -1 ? -1 : offset > 1 ? 1 : offset;
	s->x = (float)s->column + (s->axis ? 0 : offset);
	s->y = (float)s->row + (s->axis ? offset : 0);
	int style = ISA(fine_controls)(n, s);

	if (source == SOURCE_COLOR)
		encode(n, value);
	for (int c = 0; c < planes; c++) {
		float d = value[3][c] - value[1][c], j = d - (value[1][c] - value[0][c]) - (value[4][c] - value[3][c]);
		bend += j * j;
		step += d * d;
	}
	bend = sqrtf(bend);
	if (!(bend > least_of_step * sqrtf(step) && bend > floor_of(n, source)))
		return false;
	s->strength = 0;
	if (source == SOURCE_NORMAL)
		return ISA(fine_weigh)(n, s, style, source, clamp01((bend - crease_from * n->crease) / (crease_ramp * n->crease)));
	if (source == SOURCE_LIGHT)
		difference = ISA(light_contrast)(n, n->f->params + style, value[0][0], value[4][0]);
	else {
		const float *a[3] = {value[0], value[0] + 1, value[0] + 2}, *b[3] = {value[4], value[4] + 1, value[4] + 2};
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

/* Where there may be a step: the difference across is large enough, or a crack nearby makes it what it is not. */
static void candidates(const window *w, int x0, int n, float least, uint8_t *restrict out)
{
	float across[TILE] = {0}, down[TILE] = {0};
	for (int c = 0; c < w->planes; c++) {
		const float *restrict row = w->row[c][REACH] + x0, *above = w->row[c][REACH - 1] + x0, *below = w->row[c][REACH + 1] + x0;
		for (int i = 0; i < n; i++) {
			float dx = row[i + 1] - row[i - 1], dy = below[i] - above[i];
			across[i] += dx * dx;
			down[i] += dy * dy;
		}
	}
	const uint8_t *mixed = w->mixed[REACH] + x0, *above = w->mixed[REACH - 1] + x0, *below = w->mixed[REACH + 1] + x0;
	for (int i = 0; i < n; i++) {
		float most = across[i] > down[i] ? across[i] : down[i];
		int strong = most > least * least, beside_crack = mixed[i - 1] | mixed[i + 1] | above[i] | below[i];
		out[i] = (mixed[i] == 0) & (strong | (beside_crack != 0));
	}
}

static void ridge_tile(const window *w, int y, int x0, int n, uint16_t *ridge)
{
	uint8_t candidate[TILE];
	candidates(w, x0, n, floor_of(w->n, w->source), candidate);
	for (int i = 0; i < n; i++) {
		if (!candidate[i])
			continue;
		int axis = steeper(w, x0 + i);
		if (!greatest(w, x0 + i, axis))
			continue;
		enum family family = family_of(w->source);
		site s = {.column = (uint16_t)(x0 + i), .row = (uint16_t)y, .family = (uint8_t)family, .axis = (uint8_t)axis};
		if (ISA(ridge_site)(w->n, &s))
			ridge[x0 + i] |= (uint16_t)(1 << (2 * (int)family + axis));
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
			if (!n->e->on[s])
				continue;
			ISA(ring_fill)(rings + s, y);
			w.source = (enum source)s;
			w.planes = s == SOURCE_LIGHT ? 1 : 3;
			for (int c = 0; c < w.planes; c++)
				ISA(ring_window)(rings + s, y, 0, c, w.row[c]);
			for (int x0 = 0; x0 < f->width; x0 += TILE)
				ridge_tile(&w, y, x0, f->width - x0 < TILE ? f->width - x0 : TILE, ridge);
		}
	}
}
