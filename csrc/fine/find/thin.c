/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Things up to three pixels wide: a wire, a blade, a strand of hair. Depth and index hit them at pixel centres only,
 * but how they lie and how wide they are shows in the averaged layers all along. So the cracks on both sides are placed
 * by the stripe's middle and width, and where a wire runs between pixel centres sites along its middle go on. */
#include "fine/near.h"

#include <stdlib.h>
#include <string.h>

enum { PLANES = 6, MOST_HIT = 4, MOST = MOST_HIT + 4, NEARBY = 6, REACH = THIN_SPAN };

static const float narrow = 2.05f, widest = 4.4f, widest_across = 3.9f; /* pixels; test_fine_sites */
static const float width_ramp = 0.6f, shortest = 3, length_ramp = 2;    /* pixels; test_fine_sites */
static const float least_peak = 0.05f;    /* of a stripe, in albedo and half normals; test_fine_sites */
static const float least_of_slope = 1.2f; /* times what lies on both sides differs; test_fine_sites */
static const float against = 0.2f; /* share of a stripe that a pixel of it may lie the other way; test_fine_sites */
static const float most_of_step =
	0.5f; /* of the step to what lies behind, that may jump from one side to the other; test_fine_sites */
static const float least_step =
	0.01f;                      /* of a depth before what lies behind: a crack of full strength; test_fine_sites */
static const float alike = 0.5f;    /* cosine between how two slices of a thing stand out; test_thin */
static const float steepest = 1.5f; /* pixels that its middle moves from a row to the next; test_fine_sites */

/* What depths are compared in: even on planes. */
static float near_at(const fine *n, int axis, int across, int at)
{
	float z = axis ? depth_at(n->f, across, at) : depth_at(n->f, at, across);
	return n->e->ortho ? -min(z, depth_end) : 1 / z;
}

static float thing_at(const fine *n, int axis, int across, int at)
{
	return axis ? object_at(n->f, across, at) : object_at(n->f, at, across);
}

/* Between a pixel and the next. */
static found crack_at(int axis, int across, int at)
{
	return (found){(uint16_t)(axis ? across : at), (uint16_t)(axis ? at : across), FAMILY_CRACK, (uint8_t)axis};
}

/* ---- slices ---------------------------------------------------------------------------------------------- */

/* A few pixels along an axis, across a stripe before one ground. `middle` is a coordinate along the axis; the thing
 * covers pixel centres nearer to it than half its width, and no others: that is at least `low` and at most `high`. */
typedef struct slice {
	float area, peak, middle, low, high;
	float stands[PLANES]; /* how it stands out, summed up */
	int hits;             /* pixel centres that it covers */
	float ground;         /* the object behind it */
	float width;          /* from contour to contour; 0: not known */
	float trust;          /* in the above, 0 to 1 */
	bool told;            /* by the mesh alone: how it stands out from the ground is not known */
} slice;

/* 0 up to `from`, 1 from `to` on. */
static float ramp(float x, float from, float to)
{
	return x > from ? x < to ? (x - from) / (to - from) : 1 : 0;
}

static void read(const frame *f, int x, int y, float value[PLANES])
{
	const float *albedo = layer_row(f, ENCRE_LAYER_ALBEDO, y) + (ptrdiff_t)3 * x;
	const float *normal = layer_row(f, ENCRE_LAYER_NORMAL, y) + (ptrdiff_t)3 * x;
	for (int c = 0; c < 3; c++) {
		value[c] = clamp01(albedo[c]);
		value[3 + c] = 0.5f * bounded(normal[c]);
	}
}

/* Moments of what stands out from the ground that the end pixels show, and how much that is like a stripe. */
static void moments(slice *s, float (*value)[PLANES], int count, int first)
{
	float square = 0, slope = 0, least = 0;
	for (int c = 0; c < PLANES; c++) {
		float rise = value[count - 1][c] - value[0][c];
		slope += rise * rise;
		for (int k = 1; k < count - 1; k++) {
			value[k][c] -= value[0][c] + rise * (float)k / (float)(count - 1);
			s->stands[c] += value[k][c];
		}
		square += s->stands[c] * s->stands[c];
	}
	s->area = sqrtf(square);
	for (int k = 1; k < count - 1 && s->area > 0; k++) {
		float own = 0;
		for (int c = 0; c < PLANES; c++)
			own += value[k][c] * s->stands[c] / s->area;
		s->peak = own > s->peak ? own : s->peak;
		least = own < least ? own : least;
		s->middle += own * (float)k / s->area;
	}
	s->middle += (float)first;
	slope = sqrtf(slope);
	s->trust = ramp(s->peak, least_peak, 1.5f * least_peak);
	s->trust = min(s->trust, ramp(-s->area, -widest * s->peak, (width_ramp - widest) * s->peak));
	s->trust = min(s->trust, ramp(least, -against * s->area, -0.5f * against * s->area));
	s->trust = min(s->trust, ramp(s->peak, least_of_slope * slope, 1.25f * least_of_slope * slope));
}

/* Of `count` pixels from `first` on, along a row or a column `across`; false where there is no stripe before one
 * ground. */
static bool slice_of(const fine *n, int axis, int across, int first, int count, slice *s)
{
	const frame *f = n->f;
	int size = axis ? f->height : f->width, last = first + count - 1;
	float value[MOST][PLANES], near[MOST] = {0};
	if (first < 0 || last >= size || across < 0 || across >= (axis ? f->width : f->height))
		return false;
	for (int k = 0; k < count; k++)
		near[k] = near_at(n, axis, across, first + k);
	float behind = max(near[0], near[count - 1]), nearest = behind;
	*s = (slice){.high = INFINITY};
	s->ground = thing_at(n, axis, across, first);
	if (s->ground != thing_at(n, axis, across, last))
		return false;
	for (int k = 0; k < count; k++)
		axis ? read(f, across, first + k, value[k]) : read(f, first + k, across, value[k]);
	moments(s, value, count, first);
	if (!(s->trust > 0))
		return false;
	int from = count, to = -1;
	bool other = false; /* something covers a centre, however little it lies before the ground */
	for (int k = 0; k < count; k++) {
		float apart = fabsf((float)(first + k) - s->middle);
		other |= thing_at(n, axis, across, first + k) != s->ground;
		if (near[k] - behind > least_step * (n->e->ortho ? f->camera.height : near[k])) {
			s->low = max(s->low, apart);
			nearest = max(nearest, near[k]);
			from = from < k ? from : k;
			to = k;
			s->hits++;
		} else
			s->high = min(s->high, apart);
	}
	if (s->hits == 0)
		return !other;
	return s->hits == to - from + 1 && s->hits <= MOST_HIT &&
	       fabsf(near[0] - near[count - 1]) <= most_of_step * (nearest - behind);
}

static bool cracked(const fine *n, int axis, int across, int at)
{
	ptrdiff_t i = axis ? (ptrdiff_t)at * n->f->width + across : (ptrdiff_t)across * n->f->width + at;
	return n->crack[i] & CRACK_RIGHT << axis;
}

/* Where a contour passes from a pixel to the next, 0 < place <= 1; 0: that is not known. */
static float contour_at(const fine *n, int axis, int across, int at)
{
	found crack = crack_at(axis, across, at);
	return max(-ISA(hand_place)(n, &crack), 0);
}

/* The slice of what lies flat before one ground, whatever the averages say of it: a mesh tells both of its contours,
 * and that something lies behind them. */
static bool slice_raised(const fine *n, int axis, int across, int first, int last, slice *s)
{
	found from = crack_at(axis, across, first - 1), to = crack_at(axis, across, last);
	float ground = thing_at(n, axis, across, first - 1), own = thing_at(n, axis, across, first);
	*s = (slice){.high = INFINITY, .hits = last - first + 1, .ground = ground, .trust = 1, .told = true};
	return own != ground && own == thing_at(n, axis, across, last) &&
	       ground == thing_at(n, axis, across, last + 1) && ISA(hand_steps)(n, &from) > 0 &&
	       ISA(hand_steps)(n, &to) > 0 &&
	       near_at(n, axis, across, first) + near_at(n, axis, across, last) >
		       near_at(n, axis, across, first - 1) + near_at(n, axis, across, last + 1);
}

/* Whether meshes tell of contours. */
static bool marked(const fine *n)
{
	return n->f->layer[ENCRE_LAYER_MARKS].data;
}

/* The slice across the thing at a pixel: a few pixels between cracks, and two more on each side. */
static bool slice_at(const fine *n, int axis, int across, int at, slice *s)
{
	int first = at, last = at, size = axis ? n->f->height : n->f->width, rows = axis ? n->f->width : n->f->height;
	if (at < 0 || at >= size || across < 0 || across >= rows)
		return false;
	while (first > 0 && last - first < MOST_HIT && !cracked(n, axis, across, first - 1))
		first--;
	while (last + 1 < size && last - first < MOST_HIT && !cracked(n, axis, across, last))
		last++;
	if (last - first >= MOST_HIT || first == 0 || last + 1 == size)
		return false;
	bool stands = slice_of(n, axis, across, first - 2, last - first + 5, s) && s->hits == last - first + 1;
	if (!stands && !marked(n))
		return false;
	float before = contour_at(n, axis, across, first - 1), after = contour_at(n, axis, across, last);
	bool told = before > 0 && after > 0;
	if (!stands && !(told && slice_raised(n, axis, across, first, last, s)))
		return false;
	if (told) {
		s->width = (float)(last - first + 1) + after - before;
		s->middle = (float)(first - 1) + before + 0.5f * s->width;
	}
	return true;
}

/* ---- along a thing --------------------------------------------------------------------------------------- */

/* What some slices in a row have in common. */
typedef struct run {
	float area, peak, low, high;
	float width;   /* in all, of those of which it is known */
	float ends[2]; /* of its middle */
	int slices, hits, steps, told, known;
	int held; /* at how many ends something lies before it */
} run;

static void add(run *r, const slice *s)
{
	r->area += s->area;
	r->peak = max(r->peak, s->peak);
	r->low = max(r->low, s->low);
	r->high = min(r->high, s->high);
	r->hits += s->hits;
	r->slices += !s->told;
	r->told += s->told;
	r->width += s->width;
	r->known += s->width > 0;
}

/* What passes between the centres about a pixel, where the mesh tells it. */
static bool slice_told(const fine *n, int axis, int across, int at, slice *s)
{
	static const int ways[4] = {0, -1, 1, -2};
	const frame *f = n->f;
	int size = axis ? f->height : f->width;
	if (!marked(n) || across < 0 || across >= (axis ? f->width : f->height))
		return false;
	for (int k = 0; k < 4; k++) {
		int first = at + ways[k];
		if (first < 0 || first + 1 >= size)
			continue;
		const float *row = layer_row(f, ENCRE_LAYER_MARKS, axis ? first : across);
		float place = between_place(row[2 * (axis ? across : first) + axis]);
		if (place < 0)
			continue;
		*s = (slice){.middle = (float)first + place,
			     .high = min(place, 1 - place),
			     .ground = thing_at(n, axis, across, first),
			     .trust = 1,
			     .told = true};
		return true;
	}
	return false;
}

/* The slice about a pixel, as narrow as it can be. */
static bool slice_about(const fine *n, int axis, int across, int at, slice *s)
{
	return slice_at(n, axis, across, at, s) || slice_told(n, axis, across, at, s) ||
	       (slice_of(n, axis, across, at - 2, 5, s) && s->area <= narrow * s->peak) ||
	       slice_of(n, axis, across, at - 3, 7, s) ||
	       (marked(n) && (slice_at(n, axis, across, at - 1, s) || slice_at(n, axis, across, at + 1, s)));
}

/* Whether something else than the ground is at a pixel. */
static bool is_covered(const fine *n, int axis, int across, int at, float ground)
{
	int size = axis ? n->f->height : n->f->width, rows = axis ? n->f->width : n->f->height;
	return at >= 0 && at < size && across >= 0 && across < rows && thing_at(n, axis, across, at) != ground;
}

/* The slices on both sides of one, as far as they are of the same thing; far on only to find a pixel that it covers. */
static run follow(const fine *n, int axis, int across, const slice *from)
{
	run r = {.high = INFINITY};
	add(&r, from);
	for (int way = 0; way < 2; way++) {
		float middle = from->middle;
		int before = 0; /* pixels of what lies before it, up to here */
		for (int k = 1; k <= (r.hits ? NEARBY : REACH); k++) {
			slice next;
			float along = 0;
			int to = way ? across + k : across - k, at = (int)floorf(middle + 0.5f);
			if (!slice_about(n, axis, to, at, &next)) {
				bool covered = from->told && is_covered(n, axis, to, at, from->ground);
				before += covered;
				if (!covered || before > MOST_HIT)
					break;
				continue;
			}
			for (int c = 0; c < PLANES; c++)
				along += next.stands[c] * from->stands[c];
			bool told = next.told || from->told;
			if (!(along > alike * from->area * next.area || told) ||
			    fabsf(next.middle - middle) > steepest * (float)(1 + before) ||
			    !(next.ground == from->ground || told) || abs(next.hits - from->hits) > 1)
				break;
			add(&r, &next);
			middle = next.middle;
			r.steps += 1 + before;
			before = 0;
		}
		r.ends[way] = middle;
		r.held += before > 0;
	}
	return r;
}

/* Half the width along the axis, by contours where they tell it. Of a thing narrower than a pixel the averages tell the
 * middle, but no width; which pixel centres it covers and which it does not tells that. */
static float half_of(const run *r)
{
	if (r->known > 0)
		return 0.5f * r->width / (float)r->known;
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
		const float *marks = layer_row(f, ENCRE_LAYER_MARKS, y);
		memset(hit, 0, (size_t)n->spans);
		for (int x = 0; marks && x < f->width; x++)
			if (max(between_place(marks[2 * x]), between_place(marks[2 * x + 1])) >= 0)
				hit[x / THIN_SPAN] |= HIT_DEPTH;
		for (int x = 0; x < f->width; x++) {
			slice s;
			if (x % 8 == 0 && none_ahead(n, x, y)) {
				x += 7;
				continue;
			}
			if (!mixed_at(n, x, y) ||
			    !(slice_at(n, AXIS_ROW, y, x, &s) || slice_at(n, AXIS_COLUMN, x, y, &s)))
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
	if (zp == zq || !slice_at(n, own_at->axis, across, at + ahead, &own))
		return;
	run r = follow(n, own_at->axis, across, &own);
	float square = squareness(&r), half = own.width > 0 ? 0.5f * own.width : half_of(&r),
	      across_it = 2 * half * square;
	float was = dx ? s->x - (float)x : s->y - (float)y;
	s->thin = min(own.trust, ramp(-across_it, -widest_across, width_ramp - widest_across));
	s->thin = min(s->thin, ramp((float)r.steps, shortest - length_ramp, shortest));
	s->half = half * square;
	float share = ISA(hand_place)(n, own_at) < 0
			      ? was
			      : mix(was, clamp01(own.middle + (ahead ? -half : half) - (float)at), s->thin);
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

/* The slice of a thing that covers no centre of the pixels across it here, but lies in this one. */
static bool slice_between(const fine *n, int axis, int x, int y, slice *s)
{
	int at = axis ? y : x;
	return slice_about(n, axis, axis ? x : y, at, s) && s->hits == 0 && s->middle >= (float)at - 0.5f &&
	       s->middle < (float)at + 0.5f && s->area <= narrow * s->peak;
}

bool ISA(thin_site)(const fine *n, const found *at, placed *s)
{
	int x = at->column, y = at->row, hits = hits_near(n, x, y);
	slice own;
	if (!hits || !slice_between(n, at->axis, x, y, &own))
		return false;
	run r = follow(n, at->axis, at->axis ? x : y, &own);
	if ((r.hits == 0 && r.held < 2 && r.told < REACH) || r.steps < (int)shortest)
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
		bool in_row = slice_between(n, AXIS_ROW, x, y, &row),
		     in_column = slice_between(n, AXIS_COLUMN, x, y, &column);
		bool narrower = row.told == column.told ? column.area < row.area : row.told;
		int axis = in_column && (!in_row || narrower) ? AXIS_COLUMN : AXIS_ROW;
		found between = {(uint16_t)x, (uint16_t)y, FAMILY_THIN, (uint8_t)axis};
		placed s = {0};
		bool either = (in_row && row.told) || (in_column && column.told),
		     lies = (in_row || in_column) && ISA(thin_site)(n, &between, &s);
		if (!lies && either && in_row &&
		    in_column) { /* of one that runs aslant, the way along which it goes on */
			between.axis = (uint8_t)(axis = !axis);
			lies = ISA(thin_site)(n, &between, &s);
		}
		if (lies)
			ridge[x] |= mark_of(FAMILY_THIN, axis);
	}
}
