/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Cracks: boundaries that run between two neighbouring pixels, because a depth or an index is one thing here and
 * another there. A depth jumps where each side's straight continuation misses the other side: that is
 * 0 on planes, curved surfaces and beside a jump, so nothing has to be thinned. */
#include "fine/near.h"

#include <string.h>

enum { ROWS = 4 };

/* Of a jump in depth, relative to the nearest of the four pixels: from where it counts, and from there to full
 * strength. */
static const float jump_from = 0.003f, jump_ramp = 0.007f; /* test_fine_sites */

/* Likewise, of a jump within a thing beside a pixel that is all there is of a side: a ledge that is seen flat would be
 * one. */
static const float ledge_from = 0.013f; /* test_fine_sites */

/* ---- depth ----------------------------------------------------------------------------------------------- */

static void sample_row(const edges *e, const float *restrict z, int n, float *restrict u)
{
	if (e->ortho)
		for (int i = 0; i < n; i++)
			u[i] = depth_sample(e, z[i]);
	else
		for (int i = 0; i < n; i++)
			u[i] = 1 / depth_of(z[i]);
}

/* Nothing there lies one frame height behind the farthest of the four. */
static inline float jump_ortho(float a, float b, float c, float d)
{
	float ab = min(a > -INFINITY ? a : INFINITY, b > -INFINITY ? b : INFINITY);
	float cd = min(c > -INFINITY ? c : INFINITY, d > -INFINITY ? d : INFINITY);
	float behind = min(min(ab, cd), FLT_MAX) - 1;
	return jump(max(a, behind), max(b, behind), max(c, behind), max(d, behind));
}

/* ORs `bit` where b and c are a jump of more than `least`. */
static void mark_jumps(bool ortho, const float *a, const float *b, const float *c, const float *d, int n, float least,
		       uint8_t bit, uint8_t *restrict out)
{
	if (ortho)
		for (int i = 0; i < n; i++)
			out[i] |= jump_ortho(a[i], b[i], c[i], d[i]) > least ? bit : 0;
	else
		for (int i = 0; i < n; i++) {
			float top = max(max(a[i], b[i]), max(c[i], d[i]));
			out[i] |= jump(a[i], b[i], c[i], d[i]) > least * top ? bit : 0;
		}
}

static void mark_nothing(float nothing, const float *a, const float *b, int n, uint8_t bit, uint8_t *restrict out)
{
	for (int i = 0; i < n; i++)
		out[i] |= (a[i] == nothing) != (b[i] == nothing) ? bit : 0;
}

static void mark_different(const float *a, const float *b, int n, uint8_t bit, uint8_t *restrict out)
{
	for (int i = 0; i < n; i++)
		out[i] |= a[i] != b[i] ? bit : 0;
}

/* ---- sites ----------------------------------------------------------------------------------------------- */

static bool on_ledge(const fine *n, const found *s)
{
	plane object = n->f->layer[ENCRE_LAYER_OBJECT];
	if (!object.data)
		return false;
	ptrdiff_t step = s->axis == AXIS_ROW ? 1 : object.row;
	const float *o = object.data + s->row * object.row + s->column;
	return o[0] == o[step] && (o[-step] != o[0] || o[step] != o[2 * step]);
}

/* Whether nothing is on one side of it alone. */
static bool is_outline(const frame *f, const found *at)
{
	return (depth_at(f, at->column, at->row) == INFINITY) !=
	       (depth_at(f, at->column + (at->axis == AXIS_ROW), at->row + (at->axis == AXIS_COLUMN)) == INFINITY);
}

static float depth_strength(const fine *n, const found *s)
{
	const frame *f = n->f;
	float u[4];
	int dx = s->axis == AXIS_ROW, dy = 1 - dx;
	bool inside = dx ? s->column >= 1 && s->column + 2 < f->width : s->row >= 1 && s->row + 2 < f->height;
	for (int k = 0; inside && k < 4; k++)
		u[k] = depth_sample(n->e,
				    layer_row(f, ENCRE_LAYER_DEPTH, s->row + (k - 1) * dy)[s->column + (k - 1) * dx]);
	if (!inside)
		return 0;
	float top = max(max(u[0], u[1]), max(u[2], u[3]));
	float j = n->e->ortho ? jump_ortho(u[0], u[1], u[2], u[3]) : jump(u[0], u[1], u[2], u[3]);
	float share = n->e->ortho ? j : top > 0 ? j / top : 0;
	float from = on_ledge(n, s) ? ledge_from : jump_from;
	return clamp01((share - from) / jump_ramp);
}

/* Share of the way from pixel p to q at which the averaged layers pass from one side's colours and normals to the
 * other's. mixed: how much of each other's both pixels hold; nothing, where the line passes halfway, or there is one
 * sample a pixel. */
static float crossing(const frame *f, const found *s, float *mixed)
{
	float v[6][6]; /* of pixels p - 2 to q + 2 */
	int dx = s->axis == AXIS_ROW, dy = 1 - dx;
	for (int k = 0; k < 6; k++) {
		int x = clamp_index(s->column + (k - 2) * dx, f->width),
		    y = clamp_index(s->row + (k - 2) * dy, f->height);
		const float *albedo = layer_row(f, ENCRE_LAYER_ALBEDO, y) + (ptrdiff_t)3 * x;
		const float *normal = layer_row(f, ENCRE_LAYER_NORMAL, y) + (ptrdiff_t)3 * x;
		for (int c = 0; c < 3; c++) {
			v[k][c] = clamp01(albedo[c]);
			v[k][3 + c] = 0.5f * bounded(normal[c]);
		}
	}
	float weight = 0, first = 0, second = 0;
	for (int c = 0; c < 6; c++) {
		float a = v[1][c], b = v[4][c], before = a - v[0][c], after = v[5][c] - b;
		float w = (a - b) / (0.0004f + before * before + after * after);
		weight += w * (a - b);
		first += w * (v[2][c] - b);
		second += w * (v[3][c] - b);
	}
	*mixed = 0;
	if (!(weight > 0 && weight < FLT_MAX))
		return 0.5f;
	first = clamp01(first / weight);
	second = clamp01(second / weight);
	*mixed = weight * (1 - first + second) / (weight + 4);
	float t = unbiased(clamp01(first + second - 0.5f));
	return (weight * t + 2) / (weight + 4);
}

bool ISA(crack_weigh)(const fine *n, const found *at, int style, placed *s)
{
	const frame *f = n->f;
	int x = at->column, y = at->row, qx = x + (at->axis == AXIS_ROW), qy = y + (at->axis == AXIS_COLUMN);
	bool object = is_outline(f, at), material = false;
	if (f->layer[ENCRE_LAYER_OBJECT].data)
		object |= layer_row(f, ENCRE_LAYER_OBJECT, y)[x] != layer_row(f, ENCRE_LAYER_OBJECT, qy)[qx];
	if (f->layer[ENCRE_LAYER_MATERIAL].data)
		material = layer_row(f, ENCRE_LAYER_MATERIAL, y)[x] != layer_row(f, ENCRE_LAYER_MATERIAL, qy)[qx];
	s->strength = 0;
	ISA(fine_weigh)(n, s, style, SOURCE_OBJECT, object);
	ISA(fine_weigh)(n, s, style, SOURCE_MATERIAL, material);
	return ISA(fine_weigh)(n, s, style, SOURCE_DEPTH, depth_strength(n, at));
}

bool ISA(crack_site)(const fine *n, const found *at, placed *s)
{
	float mixed, place = crossing(n->f, at, &mixed);
	crack_place(at, ISA(contact_place)(n, at, place, mixed), s);
	return ISA(crack_weigh)(n, at, fine_style(n, at, s), s);
}

/* ---- rows ------------------------------------------------------------------------------------------------ */

/* What a weight must be multiplied with to make an edge, at the style where it counts most. */
static float least_strength(const edges *e, enum source s)
{
	float most = 0;
	for (int i = 0; i < e->f->n_styles; i++)
		most = max(most, e->weight[s][i]);
	return most > 0 ? e->p->edge_threshold / most : INFINITY;
}

static void mark_levels(const uint8_t *a, const uint8_t *b, int n, uint8_t bit, uint8_t *restrict out)
{
	for (int i = 0; i < n; i++)
		out[i] |= a[i] != b[i] ? bit : 0;
}

/* Takes back marks that the style of the surface, or the levels of light, don't make an edge. */
static void refine(const fine *n, int y, uint8_t *mark, uint8_t bits)
{
	for (int x = 0; x < n->f->width; x++)
		for (int axis = 0; axis < 2 && (mark[x] & bits); axis++) {
			found at = {(uint16_t)x, (uint16_t)y, FAMILY_CRACK, (uint8_t)axis};
			placed s;
			uint8_t crack = (uint8_t)(CRACK_RIGHT << axis), light = (uint8_t)(LIGHT_RIGHT << axis);
			if ((mark[x] & bits & crack) && !ISA(crack_site)(n, &at, &s))
				mark[x] &= (uint8_t)~crack;
			if ((mark[x] & bits & light) && ((mark[x] & crack) || !ISA(light_site)(n, &at, &s)))
				mark[x] &= (uint8_t)~light;
		}
}

/* Takes back jumps in a row at ledges, of less than the least strength. */
static void unmark_ledges(const fine *n, int y, float least, uint8_t *mark)
{
	int width = n->f->width;
	for (int x = next_marked(mark, 0, width); x < width; x = next_marked(mark, x + 1, width))
		for (int axis = 0; mark[x] && axis < 2; axis++) {
			found at = {(uint16_t)x, (uint16_t)y, FAMILY_CRACK, (uint8_t)axis};
			uint8_t bit = (uint8_t)(CRACK_RIGHT << axis);
			if (!(mark[x] & bit) || !on_ledge(n, &at))
				continue;
			float strength = depth_strength(n, &at);
			if (!(strength > 0) || strength < least)
				mark[x] &= (uint8_t)~bit;
		}
}

static void mark_row(const fine *n, int y, float *const *u, const uint8_t *const *level)
{
	const frame *f = n->f;
	const edges *e = n->e;
	int width = f->width;
	bool below = y + 1 < f->height;
	uint8_t *mark = n->crack + (ptrdiff_t)y * width;
	memset(mark, 0, (size_t)width);
	float depth = least_strength(e, SOURCE_DEPTH), nothing = e->ortho ? -INFINITY : 0;
	float least = depth <= 1 ? jump_from + jump_ramp * depth : INFINITY;
	if (e->on[SOURCE_DEPTH] && least < INFINITY && width > 3)
		mark_jumps(e->ortho, u[1], u[1] + 1, u[1] + 2, u[1] + 3, width - 3, least, CRACK_RIGHT, mark + 1);
	if (e->on[SOURCE_DEPTH] && least < INFINITY && y >= 1 && y + 2 < f->height)
		mark_jumps(e->ortho, u[0], u[1], u[2], u[3], width, least, CRACK_DOWN, mark);
	if (f->layer[ENCRE_LAYER_OBJECT].data)
		unmark_ledges(n, y, depth, mark);
	if (least_strength(e, SOURCE_OBJECT) <= 1) {
		mark_nothing(nothing, u[1], u[1] + 1, width - 1, CRACK_RIGHT, mark);
		if (below)
			mark_nothing(nothing, u[1], u[2], width, CRACK_DOWN, mark);
	}
	for (int k = 0; k < 2; k++) {
		enum encre_layer layer = k ? ENCRE_LAYER_MATERIAL : ENCRE_LAYER_OBJECT;
		if (!f->layer[layer].data || !(least_strength(e, k ? SOURCE_MATERIAL : SOURCE_OBJECT) <= 1))
			continue;
		const float *own = layer_row(f, layer, y);
		mark_different(own, own + 1, width - 1, CRACK_RIGHT, mark);
		if (below)
			mark_different(own, layer_row(f, layer, y + 1), width, CRACK_DOWN, mark);
	}
	if (e->on[SOURCE_LIGHT]) {
		mark_levels(level[0], level[0] + 1, width - 1, LIGHT_RIGHT, mark);
		if (below)
			mark_levels(level[0], level[1], width, LIGHT_DOWN, mark);
	}
	uint8_t bits = (uint8_t)((f->style ? CRACK_RIGHT | CRACK_DOWN : 0) |
				 (e->on[SOURCE_LIGHT] ? LIGHT_RIGHT | LIGHT_DOWN : 0));
	if (bits)
		refine(n, y, mark, bits);
}

/* Whether the control asks for colour edges anywhere in the row. */
static bool is_painted(const frame *f, int y)
{
	const float *controls = controls_at(f, 0, y);
	int painted = 0;
	for (int x = 0; controls && x < f->width; x++)
		painted |= controls[(ptrdiff_t)CONTROL_COUNT * x + CONTROL_COLOR_EDGE] > 0;
	return painted;
}

static ptrdiff_t stride_of(const frame *f)
{
	return (f->width + 15) & ~(ptrdiff_t)15;
}

ptrdiff_t ISA(crack_scratch)(const frame *f)
{
	return (ROWS + 1) * stride_of(f); /* depths, and a row of bytes twice */
}

void ISA(crack_rows)(void *data, int y0, int y1, int thread)
{
	const fine *n = data;
	const frame *f = n->f;
	ptrdiff_t stride = stride_of(f);
	float *scratch = n->scratch + thread * n->thread_scratch;
	uint8_t *levels = (uint8_t *)(scratch + ROWS * stride);
	for (int y = y0; y < y1 && !bands_stopped(f->bands); y++) {
		float *u[ROWS];
		uint8_t *level[2] = {levels, levels};
		for (int k = 0; k < ROWS; k++) {
			int row = y - 1 + k;
			u[k] = scratch + ((row + ROWS) % ROWS) * stride;
			if (row >= 0 && row < f->height && (k == ROWS - 1 || y == y0))
				sample_row(n->e, layer_row(f, ENCRE_LAYER_DEPTH, row), f->width, u[k]);
		}
		for (int k = 0; n->e->on[SOURCE_LIGHT] && k < 2; k++) {
			level[k] = levels + ((y + k) % 2) * stride;
			if (y + k < f->height && (k == 1 || y == y0))
				ISA(level_row)(n, y + k, level[k]);
		}
		mark_row(n, y, u, (const uint8_t *const *)level);
		n->colored[y] = !n->e->on[SOURCE_COLOR] ? 0 : is_painted(f, y) ? 2 : n->most_color > 0;
	}
}
