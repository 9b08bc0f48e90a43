/* SPDX-License-Identifier: GPL-3.0-or-later */
/* One site: where it lies, how strong it is and where it takes its controls; and all of them, sorted into cells. */
#include "fine/near.h"
#include "base/metric.h"

#include <string.h>

enum { CHUNK = 4096 };

static const float touching = 0.02f; /* of the depth, apart at most; test_fine_sites */

/* ---- one site -------------------------------------------------------------------------------------------- */

/* The pixel, of those that the site parts, of what the line bounds: of the nearest thing, but where two things touch of
 * the one whose line is painted more, then of the one that has a style: along a foot the nearer pixel is now of one,
 * now of the other. */
static void owner_of(const fine *n, const found *s, int *x, int *y)
{
	const frame *f = n->f;
	bool crack = is_crack(s->family);
	int right = clamp_index(s->column + (crack && s->axis != AXIS_COLUMN), f->width),
	    below = clamp_index(s->row + (crack && s->axis != AXIS_ROW), f->height);
	float least = INFINITY, most = -1;
	bool styled = false;
	for (int qy = s->row; qy <= below; qy++)
		for (int qx = s->column; qx <= right; qx++)
			least = min(least, depth_at(f, qx, qy));
	float reach = least + touching * (n->e->ortho ? f->camera.height : least);
	for (int qy = s->row; qy <= below; qy++)
		for (int qx = s->column; qx <= right; qx++) {
			float z = depth_at(f, qx, qy);
			const float *controls = controls_at(f, qx, qy);
			float painted = controls ? fabsf(controls[CONTROL_THICKNESS]) : 0;
			bool own = style_at(f, qx, qy) > 0, alike = painted == most && own == styled;
			if (z <= reach && (painted > most || (painted == most && own && !styled) ||
					   (alike && z < depth_at(f, *x, *y)))) {
				most = painted;
				styled = own;
				*x = qx;
				*y = qy;
			}
		}
}

/* The places of a 5x5 in the order in which equal depths count: by distance, then row, then column; and the turn of
 * each of them, row by row. */
enum { PLACES = 25 };
static const int window[PLACES][2] = {
	{0, 0},  {0, -1}, {-1, 0}, {1, 0},   {0, 1},   {-1, -1}, {1, -1},  {-1, 1}, {1, 1},
	{0, -2}, {-2, 0}, {2, 0},  {0, 2},   {-1, -2}, {1, -2},  {-2, -1}, {2, -1}, {-2, 1},
	{2, 1},  {-1, 2}, {1, 2},  {-2, -2}, {2, -2},  {-2, 2},  {2, 2},
};
static const int32_t turn[PLACES] = {21, 13, 9,  14, 22, 15, 5,  1,  6,  16, 10, 2, 0,
				     3,  11, 17, 7,  4,  8,  18, 23, 19, 12, 20, 24};

/* The 5x5 values about pixel x of rows, one after the other. */
static void values_about(plane p, const ptrdiff_t *row, int x, int width, float *value)
{
	for (int k = 0; k < 5; k++) {
		const float *from = p.data + row[k] * p.row;
		if (x >= 2 && x + 2 < width)
			memcpy(value + 5 * k, from + x - 2, 5 * sizeof *value);
		else
			for (int i = 0; i < 5; i++)
				value[5 * k + i] = from[clamp_index(x + i - 2, width)];
	}
}

/* The place of the least depth about a pixel, of those whose object is `own`, if one is, or NULL for any. What lies
 * beyond the frame is as what is nearer, and so counts after it. */
static int least_near(const frame *f, int x, int y, const float *own)
{
	float z[PLACES], object[PLACES];
	int32_t key[PLACES], least = INT32_MAX, first = PLACES;
	ptrdiff_t row[5];
	int any = 0;
	for (int k = 0; k < 5; k++)
		row[k] = clamp_index(y + k - 2, f->height);
	values_about(f->layer[ENCRE_LAYER_DEPTH], row, x, f->width, z);
	if (own)
		values_about(f->layer[ENCRE_LAYER_OBJECT], row, x, f->width, object);
	for (int i = 0; own && i < PLACES; i++)
		any |= object[i] == *own;
	for (int i = 0; i < PLACES; i++) {
		int there = (z[i] > 0) & (z[i] < depth_end);
		key[i] = float_bits(there ? z[i] : INFINITY); /* from 0 on, floats order as their bits do */
	}
	for (int i = 0; any && i < PLACES; i++) /* a corner may lie farther from what it belongs to */
		key[i] = object[i] == *own ? key[i] : INT32_MAX;
	for (int i = 0; i < PLACES; i++)
		least = key[i] < least ? key[i] : least;
	for (int i = 0; i < PLACES; i++) {
		int32_t its = key[i] == least ? turn[i] : PLACES;
		first = its < first ? its : first;
	}
	return first;
}

/* The least depth of the 5x5 among pixels of the object that the line bounds: at the foot of a blade of grass the
 * ground before it is nearer, and has other controls. A thin thing's line may pass where no pixel is its own. */
int ISA(fine_controls)(const fine *n, const found *at, placed *s)
{
	const frame *f = n->f;
	plane object = f->layer[ENCRE_LAYER_OBJECT];
	int x = pixel_of(s->x, f->width), y = pixel_of(s->y, f->height), own_x = at->column, own_y = at->row;
	int near = 0;
	owner_of(n, at, &own_x, &own_y);
	bool any = !object.data || at->family == FAMILY_THIN;
	bool seen = families[at->family].rank == RANK_SEEN; /* it lies in the mirror, whatever stands before that */
	if (!seen)
		near = any ? least_near(f, x, y, NULL) : least_near(f, x, y, object.data + own_y * object.row + own_x);
	s->near_x = (uint16_t)(x + window[near][0]);
	s->near_y = (uint16_t)(y + window[near][1]);
	return style_at(f, s->near_x, s->near_y);
}

bool ISA(fine_weigh)(const fine *n, placed *s, int style, enum source source, float strength)
{
	return ISA(fine_weigh_by)(n, s, n->e->weight[source][style], source, strength);
}

bool ISA(fine_weigh_by)(const fine *n, placed *s, float weight, enum source source, float strength)
{
	const float *controls = controls_at(n->f, pixel_of(s->x, n->f->width), pixel_of(s->y, n->f->height));
	if (source == SOURCE_COLOR && controls)
		weight = painted_weight(n->e, weight, controls[CONTROL_COLOR_EDGE]);
	float weighted = weight > 0 ? weight * strength : 0;
	if (weighted > s->strength) {
		s->strength = weighted < FLT_MAX ? weighted : FLT_MAX;
		s->source = (uint8_t)source;
	}
	return s->strength > 0 && s->strength >= n->e->p->edge_threshold;
}

void ISA(fine_paint)(const fine *n, placed *s, const float *one, const float *two)
{
	float control = ISA(fine_painted)(n, s);
	float strength =
		control > 0 ? painted_strength(n->e, control, ISA(metric_ciede2000)(n->e->p->contrast_metric, one, two))
			    : 0;
	if (strength > s->strength) {
		s->strength = strength;
		s->source = SOURCE_COLOR;
	}
}

float ISA(fine_painted)(const fine *n, const placed *s)
{
	const float *controls = controls_at(n->f, pixel_of(s->x, n->f->width), pixel_of(s->y, n->f->height));
	return controls ? controls[CONTROL_COLOR_EDGE] : 0;
}

static void crack_of(const fine *n, const found *at, placed *s)
{
	switch ((enum family)at->family) {
	case FAMILY_LIGHT: ISA(light_site)(n, at, s); break;
	default: ISA(crack_site)(n, at, s); ISA(thin_place)(n, at, s);
	}
}

enum { SIDES = 4 };

/* Of a junction: one of the cracks between the four pixels from (column, row). */
static found side_of(const found *at, int i)
{
	static const uint8_t side[SIDES][3] = {
		{0, 0, AXIS_ROW}, {0, 1, AXIS_ROW}, {0, 0, AXIS_COLUMN}, {1, 0, AXIS_COLUMN}};
	return (found){(uint16_t)(at->column + side[i][0]), (uint16_t)(at->row + side[i][1]), at->family, side[i][2]};
}

/* The mean of the cracks between the four pixels from (column, row), with the strongest's strength. */
static void junction_site(const fine *n, const found *at, placed *s)
{
	float x = 0, y = 0;
	int count = 0;
	for (int i = 0; i < SIDES; i++) {
		found one = side_of(at, i);
		placed its = {0};
		if (!(n->crack[(ptrdiff_t)one.row * n->f->width + one.column] & mark_of(one.family, one.axis)))
			continue;
		crack_of(n, &one, &its);
		x += its.x - (float)at->column;
		y += its.y - (float)at->row;
		count++;
		if (its.strength > s->strength) {
			s->strength = its.strength;
			s->source = its.source;
			s->eased = its.eased;
		}
	}
	s->x = (float)at->column + on_grid(x / (float)count);
	s->y = (float)at->row + on_grid(y / (float)count);
}

void ISA(fine_place)(const fine *n, const found *at, placed *s)
{
	switch ((enum kind)families[at->family].kind) {
	case KIND_CHAIN: break; /* it has no mark */
	case KIND_CRACK: at->axis == AXIS_JUNCTION ? junction_site(n, at, s) : crack_of(n, at, s); break;
	case KIND_THIN: ISA(thin_site)(n, at, s); break;
	case KIND_BAND:
	case KIND_STEP: ISA(ridge_site)(n, at, s); break;
	case KIND_VALLEY: ISA(valley_site)(n, at, s); break;
	}
}

float ISA(fine_strength)(const fine *n, const found *at)
{
	placed s = {0};
	if (at->family != FAMILY_CRACK || n->f->style)
		ISA(fine_place)(n, at, &s);
	else if (at->axis != AXIS_JUNCTION)
		ISA(crack_weigh)(n, at, 0, &s);
	else
		for (int i = 0; i < SIDES; i++) {
			found one = side_of(at, i);
			if (n->crack[(ptrdiff_t)one.row * n->f->width + one.column] & mark_of(one.family, one.axis))
				s.strength = max(s.strength, ISA(fine_strength)(n, &one));
		}
	return s.strength;
}

/* ---- cells ----------------------------------------------------------------------------------------------- */

typedef struct sorting {
	const fine *n;
	uint32_t *cell; /* by site */
} sorting;

static void find_cells(void *data, int first, int end, int thread)
{
	(void)thread;
	const sorting *s = data;
	for (int i = first; i < end && !stopped_at(s->n, i); i++)
		s->cell[i] = (uint32_t)cell_of(s->n, &s->n->site[i].placed);
}

int32_t ISA(fine_sort)(fine *n)
{
	size_t cells = (size_t)n->across * (size_t)n->tall;
	late_drop(&n->f->late, n->member);
	n->member = late_take(&n->f->late, n->count, sizeof *n->member);
	sorting s = {n, late_take(&n->f->late, n->count, sizeof *s.cell)};
	if (!n->member || !s.cell)
		return ENCRE_ERROR_MEMORY;
	memset(n->cell, 0, cells * sizeof *n->cell);
	int32_t code = bands_run(n->f->bands, (int)n->count, CHUNK, find_cells, &s);
	for (uint32_t i = 0; !code && i < n->count; i++) {
		code = at_step(n, i);
		n->cell[s.cell[i]]++;
	}
	uint32_t end = 0;
	for (size_t i = 0; i <= cells; i++)
		n->cell[i] = end += i < cells ? n->cell[i] : 0;
	for (uint32_t i = n->count;
	     !code && i-- > 0;) { /* from the last: each finds its cell's end and moves it down */
		code = at_step(n, i);
		n->member[--n->cell[s.cell[i]]] = i;
	}
	late_drop(&n->f->late, s.cell);
	return code;
}
