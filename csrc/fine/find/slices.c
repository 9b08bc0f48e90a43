/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Slices across things up to three pixels wide. Depth and index hit them at pixel centres only, but how they lie and
 * how wide they are shows in the averaged layers all along. */
#include "fine/find/slices.h"

enum { MOST = MOST_HIT + 4 };

static const float narrow = 2.05f, widest = 4.4f; /* pixels; test_fine_sites */
static const float least_peak = 0.05f;            /* of a stripe, in albedo and half normals; test_fine_sites */
static const float least_of_slope = 1.2f;         /* times what lies on both sides differs; test_fine_sites */
static const float against = 0.2f; /* share of a stripe that a pixel of it may lie the other way; test_fine_sites */
static const float most_of_step =
	0.5f; /* of the step to what lies behind, that may jump from one side to the other; test_fine_sites */
static const float least_step =
	0.01f; /* of a depth before what lies behind: a crack of full strength; test_fine_sites */

/* What depths are compared in: even on planes. */
static float near_at(const fine *n, int axis, int across, int at)
{
	float z = axis ? depth_at(n->f, across, at) : depth_at(n->f, at, across);
	return n->e->ortho ? -min(z, depth_end) : 1 / z;
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
	return n->mixed[i] & CRACK_RIGHT << axis;
}

bool ISA(slice_at)(const fine *n, int axis, int across, int at, slice *s)
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
	return slice_of(n, axis, across, first - 2, last - first + 5, s) && s->hits == last - first + 1;
}

bool ISA(slice_about)(const fine *n, int axis, int across, int at, slice *s)
{
	return ISA(slice_at)(n, axis, across, at, s) ||
	       (slice_of(n, axis, across, at - 2, 5, s) && s->area <= narrow * s->peak) ||
	       slice_of(n, axis, across, at - 3, 7, s);
}

bool ISA(slice_between)(const fine *n, int axis, int x, int y, slice *s)
{
	int at = axis ? y : x;
	return ISA(slice_about)(n, axis, axis ? x : y, at, s) && s->hits == 0 && s->middle >= (float)at - 0.5f &&
	       s->middle < (float)at + 0.5f && s->area <= narrow * s->peak;
}
