/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Things up to two pixels wide: a wire, a blade, a strand of hair. Depth and index hit them now and then only, and
 * cracks round each hit would be two beaded lines. Where the averaged layers show a stripe there, the cracks go, and
 * the stripe is one line along its middle, hit or not. */
#include "fine.h"

enum { PLANES = 6, MOST_HIT = 3, NEARBY = 4, CHUNK = 2048 };

static const float widest = 2.05f;       /* pixels, measured across */
static const float slanted = 2.9f;       /* what that is along a row or a column */
static const float least_hit = 0.1f, least_between = 0.05f; /* peak of a stripe, in albedo and half normals, at a hit and
							       beside one */
static const float least_of_slope = 1.5f; /* times what lies on both sides differs */
static const float against = 0.1f;       /* share of a stripe that a pixel of it may lie the other way */
static const float most_of_step = 0.5f;  /* of the step to what lies behind, that may jump from one side to the other */

static void read(const frame *f, int x, int y, float value[PLANES])
{
	x = clamp_index(x, f->width);
	y = clamp_index(y, f->height);
	const float *albedo =
	    f->layer[ENCRE_LAYER_ALBEDO].data + y * f->layer[ENCRE_LAYER_ALBEDO].row + (ptrdiff_t)3 * x;
	const float *normal =
	    f->layer[ENCRE_LAYER_NORMAL].data + y * f->layer[ENCRE_LAYER_NORMAL].row + (ptrdiff_t)3 * x;
	for (int c = 0; c < 3; c++) {
		value[c] = clamp01(albedo[c]);
		value[3 + c] = 0.5f * bounded(normal[c]);
	}
}

static float depth_at(const frame *f, int x, int y)
{
	return depth_of(f->layer[ENCRE_LAYER_DEPTH].data[y * f->layer[ENCRE_LAYER_DEPTH].row + x]);
}

static float object_at(const frame *f, int x, int y)
{
	plane p = f->layer[ENCRE_LAYER_OBJECT];
	return p.data ? p.data[y * p.row + x] : 0;
}

/* ---- stripes --------------------------------------------------------------------------------------------- */

/* How the `count` pixels from (x, y) on along an axis, the ends taken as ground, stand out: in all, at most and where.
 */
typedef struct stripe {
	float area, peak, middle, least;
	int highest; /* which pixel stands out most */
	float slope; /* between the ends */
} stripe;

static bool is_stripe(const stripe *s, float least_peak)
{
	return s->peak >= least_peak && s->area <= slanted * s->peak && s->least > -against * s->area &&
	       s->peak > least_of_slope * s->slope;
}

/* Its width across, from what it is along a row and along a column; 0 = it is no stripe along that. */
static float width_of(float row, float column)
{
	return row > 0 && column > 0 ? row * column / sqrtf(row * row + column * column) : row + column;
}

static stripe stripe_of(const frame *f, int x, int y, int axis, int count)
{
	float value[MOST_HIT + 4][PLANES], e[PLANES] = {0}, square = 0, slope = 0;
	stripe s = {0};
	for (int k = 0; k < count; k++)
		read(f, x + (axis ? 0 : k), y + (axis ? k : 0), value[k]);
	for (int k = 1; k < count - 1; k++)
		for (int c = 0; c < PLANES; c++) {
			value[k][c] -= mix(value[0][c], value[count - 1][c], (float)k / (float)(count - 1));
			e[c] += value[k][c];
		}
	for (int c = 0; c < PLANES; c++)
		square += e[c] * e[c];
	for (int c = 0; c < PLANES; c++)
		slope += (value[count - 1][c] - value[0][c]) * (value[count - 1][c] - value[0][c]);
	s.slope = sqrtf(slope);
	s.area = sqrtf(square);
	for (int k = 1; k < count - 1 && s.area > 0; k++) {
		float own = 0;
		for (int c = 0; c < PLANES; c++)
			own += value[k][c] * e[c] / s.area;
		if (own > s.peak) {
			s.peak = own;
			s.highest = k;
		}
		s.least = own < s.least ? own : s.least;
		s.middle += own * (float)k / s.area;
	}
	return s;
}

/* ---- hits ------------------------------------------------------------------------------------------------ */

static bool cracked(const fine *n, int x, int y, int axis)
{
	return n->crack[(ptrdiff_t)y * n->f->width + x] & CRACK_RIGHT << axis;
}

/* What depths are compared in: even on planes. */
static float nearness(const fine *n, float z)
{
	return n->e->ortho ? -fminf(z, 1e9f) : 1 / z;
}

/* Width along an axis of the thing at a pixel: a few pixels between cracks, before one and the same ground. 0 where it is
 * no stripe. */
static float width_along(const fine *n, int x, int y, int axis, float *ground)
{
	const frame *f = n->f;
	int dx = axis ? 0 : 1, dy = axis ? 1 : 0, size = axis ? f->height : f->width, at = axis ? y : x;
	int first = at, last = at;
	while (first > 0 && last - first < MOST_HIT && !cracked(n, axis ? x : first - 1, axis ? first - 1 : y, axis))
		first--;
	while (last + 1 < size && last - first < MOST_HIT && !cracked(n, axis ? x : last, axis ? last : y, axis))
		last++;
	if (first == 0 || last + 1 == size || last - first >= MOST_HIT)
		return 0;
	int px = axis ? x : first - 1, py = axis ? first - 1 : y, rx = axis ? x : last + 1, ry = axis ? last + 1 : y;
	float p = nearness(n, depth_at(f, px, py)), r = nearness(n, depth_at(f, rx, ry));
	float step = nearness(n, depth_at(f, x, y)) - (p > r ? p : r);
	if (object_at(f, px, py) != object_at(f, rx, ry) || !(step > 0) || fabsf(p - r) > most_of_step * step)
		return 0;
	stripe s = stripe_of(f, px - dx, py - dy, axis, last - first + 5);
	*ground = object_at(f, px, py);
	return is_stripe(&s, least_hit) ? s.area / s.peak : 0;
}

/* Whether the pixel is of a thin thing, and before what. */
static bool is_thin(const fine *n, int x, int y, float *ground)
{
	float row = width_along(n, x, y, AXIS_ROW, ground), column = width_along(n, x, y, AXIS_COLUMN, ground);
	float width = width_of(row, column);
	return width > 0 && width <= widest;
}

/* Whether none of the eight pixels from x on lies beside a crack. */
static bool none_ahead(const fine *n, int x, int y)
{
	uint64_t own, above = 0, cracks = 0x0101010101010101u * (CRACK_RIGHT | CRACK_DOWN);
	const uint8_t *crack = n->crack + (ptrdiff_t)y * n->f->width + x;
	if (x + 8 > n->f->width || (x > 0 && (crack[-1] & CRACK_RIGHT)))
		return false;
	memcpy(&own, crack, sizeof own);
	if (y > 0)
		memcpy(&above, crack - n->f->width, sizeof above);
	return ((own | above) & cracks) == 0;
}

/* What marks a pixel's cracks as part of a stripe, and a hit by what its cracks are made of. */
void ISA(thin_rows)(void *data, int y0, int y1, int thread)
{
	(void)thread;
	const fine *n = data;
	const frame *f = n->f;
	for (int y = y0; y < y1; y++) {
		const uint8_t *crack = n->crack + (ptrdiff_t)y * f->width;
		uint8_t *thin = n->thin + (ptrdiff_t)y * f->width;
		memset(thin, 0, (size_t)f->width);
		n->hit[y] = 0;
		for (int x = 0; x < f->width; x++) {
			if (none_ahead(n, x, y)) {
				x += 7;
				continue;
			}
			if (!mixed_at(n, x, y))
				continue;
			float behind, other;
			bool own = is_thin(n, x, y, &behind);
			if (own)
				thin[x] |= behind == object_at(f, x, y) ? HIT_DEPTH : HIT_OBJECT;
			for (int axis = 0; axis < 2; axis++) {
				int qx = x + !axis, qy = y + axis;
				if (!(crack[x] & CRACK_RIGHT << axis))
					continue;
				/* a crack is the stripe's if the other side is what lies behind it, or of the stripe
				 * too */
				bool its = is_thin(n, qx, qy, &other) && (own || other == object_at(f, x, y));
				its |= own && behind == object_at(f, qx, qy);
				thin[x] |= (uint8_t)(its ? CRACK_RIGHT << axis : 0);
			}
			n->hit[y] |= thin[x] != 0;
		}
	}
}

void ISA(carve_rows)(void *data, int y0, int y1, int thread)
{
	(void)thread;
	const fine *n = data;
	ptrdiff_t width = n->f->width;
	for (int y = y0; y < y1; y++)
		for (ptrdiff_t i = y * width; n->hit[y] && i < (y + 1) * width; i++)
			n->crack[i] &= (uint8_t) ~(n->thin[i] & (CRACK_RIGHT | CRACK_DOWN));
}

/* ---- sites ----------------------------------------------------------------------------------------------- */

static int hits_near(const fine *n, int x, int y)
{
	int hits = 0;
	for (int i = y - NEARBY < 0 ? 0 : y - NEARBY; i < n->f->height && i <= y + NEARBY; i++)
		for (int j = x - NEARBY < 0 ? 0 : x - NEARBY; n->hit[i] && j < n->f->width && j <= x + NEARBY; j++)
			hits |= n->thin[(ptrdiff_t)i * n->f->width + j];
	return hits & (HIT_OBJECT | HIT_DEPTH);
}

/* The stripe about a pixel along an axis, in a window as wide as it needs; its peak is 0 where there is none. */
static stripe stripe_about(const fine *n, int x, int y, int axis)
{
	const frame *f = n->f;
	for (int reach = 2; reach <= 3; reach++) {
		bool clear = true;
		for (int k = -reach; k <= reach && clear; k++)
			clear = !mixed_at(n, clamp_index(x + (axis ? 0 : k), f->width), clamp_index(y + (axis ? k : 0), f->height));
		stripe s = stripe_of(f, x - (axis ? 0 : reach), y - (axis ? reach : 0), axis, 2 * reach + 1);
		if (clear && s.highest == reach && is_stripe(&s, least_between) && (reach == 3 || s.area <= widest * s.peak)) {
			s.middle -= (float)reach;
			return s;
		}
	}
	return (stripe){0};
}

bool ISA(thin_site)(const fine *n, site *s)
{
	int x = s->column, y = s->row, hits = hits_near(n, x, y);
	stripe own = stripe_about(n, x, y, s->axis);
	if (!hits || !(own.peak > 0) || fabsf(own.middle) > 1)
		return false;
	stripe other = stripe_about(n, x, y, 1 - s->axis);
	s->area = width_of(own.area, other.area);
	s->peak = own.peak;
	s->x = (float)x + (s->axis ? 0 : own.middle);
	s->y = (float)y + (s->axis ? own.middle : 0);
	s->strength = 0;
	int style = fine_style(n, s);
	ISA(fine_weigh)(n, s, style, SOURCE_OBJECT, hits & HIT_OBJECT ? 1 : 0);
	return ISA(fine_weigh)(n, s, style, SOURCE_DEPTH, hits & HIT_DEPTH ? 1 : 0);
}

void ISA(thin_mark)(const fine *n, int y, uint16_t *ridge)
{
	int any = 0;
	for (int i = y - NEARBY < 0 ? 0 : y - NEARBY; i < n->f->height && i <= y + NEARBY; i++)
		any |= n->hit[i];
	for (int x = 0; any && x < n->f->width; x++) {
		if (mixed_at(n, x, y) || !hits_near(n, x, y))
			continue;
		/* the axis that crosses it more squarely, along which it is narrower */
		stripe row = stripe_about(n, x, y, AXIS_ROW), column = stripe_about(n, x, y, AXIS_COLUMN);
		int axis = !(row.peak > 0) || (column.peak > 0 && column.area < row.area) ? AXIS_COLUMN : AXIS_ROW;
		site s = {.column = (uint16_t)x, .row = (uint16_t)y, .family = FAMILY_THIN, .axis = (uint8_t)axis};
		if (ISA(thin_site)(n, &s))
			ridge[x] |= (uint16_t)(1 << ridge_bit(FAMILY_THIN, axis));
	}
}

/* ---- widths ---------------------------------------------------------------------------------------------- */

/* Sums up a chain from a site on towards `at`. */
static void walk(const fine *n, uint32_t from, uint32_t at, float *area, float *peak, int *count)
{
	for (int k = 0; k < NEARBY && at != UINT32_MAX && n->site[at].family == FAMILY_THIN; k++) {
		const site *s = n->site + at;
		*area += s->area;
		*peak = s->peak > *peak ? s->peak : *peak;
		++*count;
		uint32_t next = next_of(n, from, at);
		from = at;
		at = next;
	}
}

/* How much wider than the pen a thin thing makes its line, so that the line covers what two at its sides would. What is
 * narrower than a pixel can't be told from what is as wide, and adds nothing. Along a chain the peak is highest where a pixel
 * lies in the middle of the thing. */
static void widen_sites(void *data, int first, int end, int thread)
{
	(void)thread;
	const fine *n = data;
	for (int i = first; i < end; i++) {
		site *s = n->site + i;
		if (s->family != FAMILY_THIN || s->dropped)
			continue;
		float area = s->area, peak = s->peak;
		int count = 1;
		for (uint32_t k = n->at[i]; k < n->at[i + 1] && k < n->at[i] + 2; k++)
			walk(n, (uint32_t)i, n->to[k], &area, &peak, &count);
		float width = area / ((float)count * peak);
		s->wider = width < 1 ? 0 : width < 2 ? width - 1 : 1;
	}
}

int32_t ISA(thin_widen)(fine *n)
{
	return rows_run(n->f->rows, (int)n->count, CHUNK, widen_sites, n);
}
