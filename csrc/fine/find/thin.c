/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Things up to three pixels wide, by the slices across them: a wire, a blade, a strand of hair. The cracks on both
 * sides are placed by the stripe's middle and width, and where a wire runs between pixel centres sites along its middle
 * go on. */
#include "fine/find/slices.h"

#include <stdlib.h>
#include <string.h>

enum { NEARBY = 6, REACH = THIN_SPAN };

static const float widest_across = 3.9f;          /* pixels; test_fine_sites */
static const float shortest = 3, length_ramp = 2; /* pixels; test_fine_sites */
static const float alike = 0.5f;                  /* cosine between how two slices of a thing stand out; test_thin */
static const float steepest = 1.5f; /* pixels that its middle moves from a row to the next; test_fine_sites */

/* ---- along a thing --------------------------------------------------------------------------------------- */

/* What some slices in a row have in common. */
typedef struct run {
	float area, peak, low, high;
	float ends[2]; /* of its middle */
	int slices, hits, steps;
} run;

static void add(run *r, const slice *s)
{
	r->area += s->area;
	r->peak = max(r->peak, s->peak);
	r->low = max(r->low, s->low);
	r->high = min(r->high, s->high);
	r->hits += s->hits;
	r->slices++;
}

/* The slices on both sides of one, as far as they are of the same thing; far on only to find a pixel that it covers. */
static run follow(const fine *n, int axis, int across, const slice *from)
{
	run r = {.high = INFINITY};
	add(&r, from);
	for (int way = 0; way < 2; way++) {
		float middle = from->middle;
		for (int k = 1; k <= (r.hits ? NEARBY : REACH); k++) {
			slice next;
			float along = 0;
			int to = way ? across + k : across - k, at = (int)floorf(middle + 0.5f);
			if (!ISA(slice_about)(n, axis, to, at, &next))
				break;
			for (int c = 0; c < PLANES; c++)
				along += next.stands[c] * from->stands[c];
			if (!(along > alike * from->area * next.area) || fabsf(next.middle - middle) > steepest ||
			    next.ground != from->ground || abs(next.hits - from->hits) > 1)
				break;
			add(&r, &next);
			middle = next.middle;
			r.steps++;
		}
		r.ends[way] = middle;
	}
	return r;
}

/* Half the width along the axis. Of a thing narrower than a pixel the averages tell the middle, but no width; which
 * pixel centres it covers and which it does not tells that. */
static float half_of(const run *r)
{
	float half = r->peak > 0 ? 0.5f * r->area / ((float)r->slices * r->peak) : 0;
	if (r->low > r->high)
		return 0.5f * (r->low + r->high);
	return half < r->low ? r->low : half > r->high ? r->high : half;
}

/* Pixels across in one along the axis. */
static float squareness(const run *r)
{
	float slope = r->steps ? (r->ends[1] - r->ends[0]) / (float)r->steps : 0;
	return 1 / sqrtf(1 + slope * slope);
}

/* ---- hits ------------------------------------------------------------------------------------------------ */

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

/* Marks spans of pixels where a thin thing covers a centre, by what its cracks are made of. */
void ISA(thin_rows)(void *data, int y0, int y1, int thread)
{
	(void)thread;
	const fine *n = data;
	const frame *f = n->f;
	for (int y = y0; y < y1 && !bands_stopped(f->bands); y++) {
		uint8_t *hit = n->hit + (ptrdiff_t)y * n->spans;
		memset(hit, 0, (size_t)n->spans);
		for (int x = 0; x < f->width; x++) {
			slice s;
			if (x % 8 == 0 && none_ahead(n, x, y)) {
				x += 7;
				continue;
			}
			if (!mixed_at(n, x, y) || (n->replaced && n->replaced[(ptrdiff_t)y * f->width + x] & 1) ||
			    !(ISA(slice_at)(n, AXIS_ROW, y, x, &s) || ISA(slice_at)(n, AXIS_COLUMN, x, y, &s)))
				continue;
			hit[x / THIN_SPAN] |= s.ground == object_at(f, x, y) ? HIT_DEPTH : HIT_OBJECT;
		}
	}
}

void ISA(thin_place)(const fine *n, const found *own_at, placed *s)
{
	const frame *f = n->f;
	int dx = own_at->axis == AXIS_ROW, dy = 1 - dx, x = own_at->column, y = own_at->row, at = dx ? x : y,
	    across = dx ? y : x;
	float zp = depth_at(f, x, y), zq = depth_at(f, x + dx, y + dy);
	int ahead = zq < zp;
	slice own;
	if (zp == zq || !ISA(slice_at)(n, own_at->axis, across, at + ahead, &own))
		return;
	run r = follow(n, own_at->axis, across, &own);
	float square = squareness(&r), half = half_of(&r), across_it = 2 * half * square;
	float was = dx ? s->x - (float)x : s->y - (float)y;
	s->thin = min(own.trust, ramp(-across_it, -widest_across, width_ramp - widest_across));
	s->thin = min(s->thin, ramp((float)r.steps, shortest - length_ramp, shortest));
	s->half = half * square;
	float share = mix(was, clamp01(own.middle + (ahead ? -half : half) - (float)at), s->thin);
	s->inside = own.middle - (float)at - share;
	crack_place(own_at, share, s);
}

/* ---- between hits ---------------------------------------------------------------------------------------- */

/* Hits up to REACH above and below, in this span and its neighbours. */
static int hits_near(const fine *n, int x, int y)
{
	int hits = 0, at = x / THIN_SPAN, from = at > 0 ? at - 1 : 0, to = at + 1 < n->spans ? at + 1 : at;
	for (int i = y - REACH < 0 ? 0 : y - REACH; i < n->f->height && i <= y + REACH; i++)
		for (int j = from; j <= to; j++)
			hits |= n->hit[(ptrdiff_t)i * n->spans + j];
	return hits;
}

/* Likewise, of each span alone. */
static void hits_about(const fine *n, int y, uint8_t *restrict hits)
{
	memset(hits, 0, (size_t)n->spans);
	for (int i = clamp_index(y - REACH, n->f->height); i <= clamp_index(y + REACH, n->f->height); i++) {
		const uint8_t *row = n->hit + (ptrdiff_t)i * n->spans;
		for (int k = 0; k < n->spans; k++)
			hits[k] |= row[k];
	}
}

bool ISA(thin_site)(const fine *n, const found *at, placed *s)
{
	int x = at->column, y = at->row, hits = hits_near(n, x, y);
	slice own;
	if (!hits || !ISA(slice_between)(n, at->axis, x, y, &own))
		return false;
	run r = follow(n, at->axis, at->axis ? x : y, &own);
	if (r.hits == 0 || r.steps < (int)shortest)
		return false;
	s->thin = 1;
	s->half = half_of(&r) * squareness(&r);
	float off = on_grid(own.middle - (float)(at->axis ? y : x));
	s->x = (float)x + (at->axis ? 0 : off);
	s->y = (float)y + (at->axis ? off : 0);
	s->strength = 0;
	int style = fine_style(n, at, s);
	ISA(fine_weigh)(n, s, style, SOURCE_OBJECT, hits & HIT_OBJECT ? 1 : 0);
	return ISA(fine_weigh)(n, s, style, SOURCE_DEPTH, hits & HIT_DEPTH ? 1 : 0);
}

void ISA(thin_mark)(const fine *n, int y, uint8_t *hits, uint16_t *ridge)
{
	hits_about(n, y, hits);
	for (int x = 0; x < n->f->width; x++) {
		slice row = {0}, column = {0};
		int at = x / THIN_SPAN;
		if (!(hits[at > 0 ? at - 1 : 0] | hits[at] | hits[at + 1 < n->spans ? at + 1 : at])) {
			x += THIN_SPAN - 1;
			continue;
		}
		/* the axis that crosses it more squarely, along which it is narrower */
		bool in_row = ISA(slice_between)(n, AXIS_ROW, x, y, &row),
		     in_column = ISA(slice_between)(n, AXIS_COLUMN, x, y, &column);
		int axis = in_column && (!in_row || column.area < row.area) ? AXIS_COLUMN : AXIS_ROW;
		found between = {(uint16_t)x, (uint16_t)y, FAMILY_THIN, (uint8_t)axis};
		placed s = {0};
		if ((in_row || in_column) && ISA(thin_site)(n, &between, &s))
			ridge[x] |= mark_of(FAMILY_THIN, axis);
	}
}
