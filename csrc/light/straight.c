/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What one edge leaves of a lamp.
 *
 * Seen from a place, most of what throws a shadow covers a lamp up to one line. Where a line may part the few points of
 * a pixel that see light from those that don't, halving finds where it passes three chords of the lamp. The share is
 * the light beyond the curve of the second degree through these three places, without the chance of points. Where one
 * of the points lies on its wrong side, more than a line is in the way. */
#include "light/light.h"

enum { CHORDS = 3, ROWS = 16 /* of the sum over the lamp */ };

/* All in parts of the lamp's half width. */
static const float overlap = 0.3f; /* so far points of both kinds may lie in each other's half, at most */
static const float doubt = 0.08f;  /* about the way on which points of both kinds leave the line's place open */
static const float turn = 0.15f;   /* likewise, once one place is known, and two */
static const float beside = 0.03f; /* points so near to the line may lie on either side */
static const float bent = 0.25f;   /* the middle of the three lies off the way between the others by less */
static const float enough = 0.012f;

/* A lamp as a square, or disc, of half width 1 about 0: `across` goes to where it is seen, `along` runs with the line.
 */
typedef struct view {
	const light *light;
	const surface *at;
	rays *from;
	float across[2], along[2]; /* in the lamp's own coordinates */
	bool square;
	float point[LAMP_FIRST][2];       /* across and along */
	float cut[CHORDS], chord[CHORDS]; /* where the line crosses, and where along it */
} view;

static float half_chord(const view *w, float along)
{
	return w->square ? 1 : sqrtf(max(1 - along * along, 0));
}

static bool sees(const view *w, float across, float along)
{
	float x = w->across[0] * across + w->along[0] * along, y = w->across[1] * across + w->along[1] * along;
	lamp_point q = {.square = {0.5f + 0.5f * x, 0.5f + 0.5f * y}, .disc = {x, y}};
	float all = 0, seen = 0;
	ISA(shadow_ask)(w->light, w->at, &q, &all, &seen, w->from);
	return seen > 0;
}

/* Finds where on a chord what is hidden ends, most likely within `wide` of `guess`; false if nowhere. */
static bool cross_chord(view *w, int k, float along, float guess, float wide)
{
	float half = half_chord(w, along), low = max(guess - wide, -half), high = min(guess + wide, half);
	if (low >= high) {
		low = -half;
		high = half;
	}
	bool lit = sees(w, high, along), dark = !sees(w, low, along);
	if (!dark && low > -half) {
		high = low;
		lit = true;
		low = -half;
		dark = !sees(w, low, along);
	} else if (!lit && high < half) {
		low = high;
		dark = true;
		high = half;
		lit = sees(w, high, along);
	}
	if (!dark || !lit)
		return false;
	while (high - low > enough) {
		float middle = 0.5f * (low + high);
		bool seen = sees(w, middle, along);
		low = seen ? low : middle;
		high = seen ? middle : high;
	}
	if (sees(w, -0.97f * half, along) || !sees(w, 0.97f * half, along))
		return false;
	w->chord[k] = along;
	w->cut[k] = 0.5f * (low + high);
	return true;
}

/* Where the line is. */
static float line_at(const view *w, float along)
{
	const float *x = w->cut, *y = w->chord;
	float first = (x[1] - x[0]) / (y[1] - y[0]), last = (x[2] - x[1]) / (y[2] - y[1]);
	float bend = (last - first) / (y[2] - y[0]);
	return x[1] + (along - y[1]) * (first + bend * (along - y[0]));
}

/* Whether all points lie on their sides of the line. */
static bool parts(const view *w, uint32_t seen)
{
	for (int k = 0; k < LAMP_FIRST; k++) {
		float ahead = w->point[k][0] - line_at(w, w->point[k][1]);
		if ((ahead > 0) != (seen >> k & 1) && fabsf(ahead) > beside)
			return false;
	}
	return true;
}

/* Which way the line runs, by the means of both kinds of points; false if no line can part them. *guess, *slope: where
 * it may be, *wide: give or take; *few: a place along it. */
static bool aim_view(view *w, const lamp_point *points, uint32_t seen, float *guess, float *slope, float *wide,
		     float *few)
{
	float sum[2][3] = {{0}};
	for (int k = 0; k < LAMP_FIRST; k++) {
		float *to = sum[seen >> k & 1];
		for (int c = 0; c < 2; c++) {
			w->point[k][c] = w->square ? 2 * points[k].square[c] - 1 : points[k].disc[c];
			to[c] += w->point[k][c];
		}
		to[2]++;
	}
	float n[2], length, dark = -2, lit = 2;
	for (int c = 0; c < 2; c++)
		n[c] = sum[1][c] / sum[1][2] - sum[0][c] / sum[0][2];
	length = sqrtf(n[0] * n[0] + n[1] * n[1]);
	if (!(length > 1e-3f))
		return false;
	n[0] /= length;
	n[1] /= length;
	for (int k = 0; k < LAMP_FIRST; k++) {
		float ahead = n[0] * w->point[k][0] + n[1] * w->point[k][1];
		if (seen >> k & 1)
			lit = min(lit, ahead);
		else
			dark = max(dark, ahead);
	}
	if (dark - lit > overlap)
		return false;
	bool flat = fabsf(n[0]) > fabsf(n[1]); /* chords of a square run along its sides */
	for (int c = 0; c < 2; c++)
		w->across[c] = !w->square ? n[c] : flat != c ? (n[c] > 0 ? 1 : -1) : 0;
	w->along[0] = -w->across[1];
	w->along[1] = w->across[0];
	float rise = n[0] * w->across[0] + n[1] * w->across[1];
	*slope = -(n[0] * w->along[0] + n[1] * w->along[1]) / rise;
	*guess = 0.5f * (dark + lit) / rise;
	*wide = (0.5f * fabsf(lit - dark) + doubt) / rise;
	const float *fewer = sum[sum[0][2] > sum[1][2]];
	*few = (w->along[0] * fewer[0] + w->along[1] * fewer[1]) / fewer[2];
	for (int k = 0; k < LAMP_FIRST; k++) {
		float x = w->point[k][0], y = w->point[k][1];
		for (int c = 0; c < 2; c++)
			w->point[k][c] = c ? w->along[0] * x + w->along[1] * y : w->across[0] * x + w->across[1] * y;
	}
	return true;
}

/* Finds the line on three chords. */
static bool cross_three(view *w, float guess, float slope, float wide, float few)
{
	float low = -1, high = 1; /* of the line within the lamp */
	if (!w->square) {
		high = sqrtf(max(1 - guess * guess, 0));
		low = -high;
	} else if (fabsf(slope) > 1e-3f) {
		float a = (-1 - guess) / slope, b = (1 - guess) / slope;
		low = max(low, min(a, b));
		high = min(high, max(a, b));
	}
	if (!(high - low > 0.1f))
		return false;
	few = min(max(few, low + 0.05f), high - 0.05f);
	if (!cross_chord(w, 1, few, guess + slope * few, wide))
		return false;
	for (int k = 0; k < CHORDS; k += 2) {
		float step = 0.7f * ((k ? high : low) - few);
		bool found = false;
		if (k)
			slope = (w->cut[1] - w->cut[0]) / (w->chord[1] - w->chord[0]);
		for (int tries = 0; tries < 3 && !found; tries++, step *= 0.5f)
			found = cross_chord(w, k, few + step, w->cut[1] + slope * step, k ? 0.5f * turn : turn);
		if (!found)
			return false;
	}
	return true;
}

static bool bends(const view *w)
{
	float share = (w->chord[1] - w->chord[0]) / (w->chord[2] - w->chord[0]);
	return fabsf(w->cut[0] + share * (w->cut[2] - w->cut[0]) - w->cut[1]) > bent;
}

/* The light of a lamp is taken to grow evenly over it, as at the points. */
static float light_beyond(const view *w, const float *value)
{
	float sum = 0, middle[2] = {0}, grow[2] = {0}, square[2] = {0};
	for (int k = 0; k < LAMP_FIRST; k++) {
		sum += value[k] / LAMP_FIRST;
		for (int c = 0; c < 2; c++)
			middle[c] += w->point[k][c] / LAMP_FIRST;
	}
	for (int c = 0; c < 2; c++) {
		for (int k = 0; k < LAMP_FIRST; k++) {
			float off = w->point[k][c] - middle[c];
			grow[c] += off * value[k];
			square[c] += off * off;
		}
		grow[c] /= square[c];
	}
	float all = 0, comes = 0;
	for (int k = 0; k < ROWS; k++) {
		float along = (2 * (float)k + 1) / ROWS - 1, half = half_chord(w, along);
		float from = min(max(line_at(w, along), -half), half);
		float value_here = sum - grow[0] * middle[0] + grow[1] * (along - middle[1]);
		all += 2 * half * value_here;
		comes += (half - from) * (value_here + 0.5f * grow[0] * (half + from));
	}
	return clamp01(comes / all);
}

bool ISA(straight_share)(const light *l, const surface *s, const lamp_point *points, const float *value, uint32_t seen,
			 rays *from, float *share)
{
	view w = {.light = l, .at = s, .from = from, .square = l->lamp.type == ENCRE_RECTANGLE};
	float guess, slope, wide, few;
	for (int k = 0; k < LAMP_FIRST; k++)
		if (!(value[k] > 0))
			return false;
	if (!aim_view(&w, points, seen, &guess, &slope, &wide, &few) || !cross_three(&w, guess, slope, wide, few))
		return false;
	if (bends(&w) || !parts(&w, seen))
		return false;
	*share = light_beyond(&w, value);
	return true;
}
