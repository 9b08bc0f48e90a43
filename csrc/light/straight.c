/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What one edge, or a corner, leaves of a lamp.
 *
 * Seen from a place, most of what throws a shadow covers a lamp up to one line. Where a line may part the few points of
 * a pixel that see light from those that don't, halving finds where it passes three chords of the lamp. The share is
 * the light beyond the curve of the second degree through these three places, without the chance of points. Where that
 * fails, up to six chords across a corner tell its two sides. Where one of the points lies on its wrong side, or a side
 * does not go on to the end of the lamp, more is in the way. */
#include "light/chords.h"

enum { ROWS = 16 /* of the sum over the lamp */ };

/* All in parts of the lamp's half width. */
static const float overlap = 0.3f; /* so far points of both kinds may lie in each other's half, at most */
static const float doubt = 0.08f;  /* about the way on which points of both kinds leave the line's place open */
static const float turn = 0.15f;   /* likewise, once one place is known, and two */
static const float beside = 0.03f; /* points so near to the line may lie on either side */
static const float bent = 0.25f;   /* the middle of the three lies off the way between the others by less */
static const float enough = 0.012f, enough_fold = 0.004f;
static const float near_end = 0.94f, aside = 0.08f; /* of the lamp, along the line and beside it: where it is tried */
static const float steep = 1.5f;                    /* a corner's sides are no steeper along the chords */
static const float level = 0.02f;                   /* three places on a side of a corner lie off one line by less */

/* How far the lamp goes along the line, to either side. */
static float half_length(const view *w)
{
	return w->square ? fabsf(w->along[0]) + fabsf(w->along[1]) : 1;
}

/* Where a point is on the lamp, in its own coordinates. */
static float on_lamp(const view *w, const lamp_point *q, int c)
{
	return w->square ? 2 * q->square[c] - 1 : q->disc[c];
}

/* Where the line is. */
static float line_at(const view *w, float along)
{
	const float *x = w->cut, *y = w->chord;
	if (w->folded) {
		float off = along - w->corner[1], a = w->slope[0] * off, b = w->slope[1] * off;
		return w->corner[0] + (off < 0 ? a : b);
	}
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

/* Turns the points so that what is seen lies ahead; *few: the mean place along of those of which there are fewer. */
static void turn_to(view *w, const float across[2], const lamp_point *points, uint32_t seen, float *few)
{
	float sum[2] = {0}, count[2] = {0};
	w->across[0] = across[0];
	w->across[1] = across[1];
	w->along[0] = -across[1];
	w->along[1] = across[0];
	for (int k = 0; k < LAMP_FIRST; k++) {
		float x = on_lamp(w, points + k, 0), y = on_lamp(w, points + k, 1);
		w->point[k][0] = across[0] * x + across[1] * y;
		w->point[k][1] = across[0] * y - across[1] * x;
		sum[seen >> k & 1] += w->point[k][1];
		count[seen >> k & 1]++;
	}
	int fewer = count[0] > count[1];
	*few = sum[fewer] / count[fewer];
}

/* Which way what is seen lies, by the means of both kinds of points; false if it can't be told. */
static bool way_to_seen(const view *w, const lamp_point *points, uint32_t seen, float way[2])
{
	float sum[2][3] = {{0}};
	for (int k = 0; k < LAMP_FIRST; k++) {
		float *to = sum[seen >> k & 1];
		for (int c = 0; c < 2; c++)
			to[c] += on_lamp(w, points + k, c);
		to[2]++;
	}
	for (int c = 0; c < 2; c++)
		way[c] = sum[1][c] / sum[1][2] - sum[0][c] / sum[0][2];
	float length = sqrtf(way[0] * way[0] + way[1] * way[1]);
	way[0] /= length;
	way[1] /= length;
	return length > 1e-3f;
}

/* Which way a line runs; false if none can part the points. *guess, *slope: where it may be, *wide: give or take;
 * *few: a place along it. */
static bool aim_view(view *w, const lamp_point *points, uint32_t seen, const float way[2], float *guess, float *slope,
		     float *wide, float *few)
{
	bool flat = fabsf(way[0]) > fabsf(way[1]); /* chords of a square run along its sides */
	float side[2], dark = -2, lit = 2;
	for (int c = 0; c < 2; c++)
		side[c] = !w->square ? way[c] : flat != c ? (way[c] > 0 ? 1 : -1) : 0;
	turn_to(w, side, points, seen, few);
	float rise = way[0] * w->across[0] + way[1] * w->across[1];
	float run = way[0] * w->along[0] + way[1] * w->along[1];
	for (int k = 0; k < LAMP_FIRST; k++) {
		float ahead = rise * w->point[k][0] + run * w->point[k][1];
		if (seen >> k & 1)
			lit = min(lit, ahead);
		else
			dark = max(dark, ahead);
	}
	*slope = -run / rise;
	*guess = 0.5f * (dark + lit) / rise;
	*wide = (0.5f * fabsf(lit - dark) + doubt) / rise;
	return dark - lit <= overlap;
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
	if (!ISA(cross_chord)(w, 1, few, guess + slope * few, wide))
		return false;
	for (int k = 0; k < 3; k += 2) {
		float step = 0.7f * ((k ? high : low) - few);
		bool found = false;
		if (k)
			slope = (w->cut[1] - w->cut[0]) / (w->chord[1] - w->chord[0]);
		for (int tries = 0; tries < 3 && !found; tries++, step *= 0.5f)
			found = ISA(cross_chord)(w, k, few + step, w->cut[1] + slope * step, k ? 0.5f * turn : turn);
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
	float all = 0, comes = 0, wide = half_length(w);
	for (int k = 0; k < ROWS; k++) {
		float along = wide * ((2 * (float)k + 1) / ROWS - 1), first, last;
		ISA(chord_ends)(w, along, &first, &last);
		float from = min(max(line_at(w, along), first), last);
		float value_here = sum - grow[0] * middle[0] + grow[1] * (along - middle[1]);
		all += (last - first) * (value_here + 0.5f * grow[0] * (first + last));
		comes += (last - from) * (value_here + 0.5f * grow[0] * (last + from));
	}
	return clamp01(comes / all);
}

/* How steep, along the chords, the sides of a corner must be that parts the points. */
static float steepness(const view *w, uint32_t seen)
{
	float most = 0;
	for (int i = 0; i < LAMP_FIRST; i++)
		for (int k = 0; k < LAMP_FIRST; k++) {
			if (!(seen >> i & 1) || seen >> k & 1)
				continue;
			float behind = w->point[k][0] - w->point[i][0] - beside;
			if (behind > most * fabsf(w->point[k][1] - w->point[i][1]))
				most = behind / max(fabsf(w->point[k][1] - w->point[i][1]), 1e-6f);
		}
	return most;
}

/* Turns to where a corner's sides are least steep; false if it can't be one. */
static bool turn_to_corner(view *w, const float way[2], const lamp_point *points, uint32_t seen, float *few)
{
	static const float turns[][2] = {
		{1, 0}, {0.906f, 0.423f}, {0.906f, -0.423f}, {0.643f, 0.766f}, {0.643f, -0.766f}};
	float least = steep, best[2] = {0, 0};
	for (int k = 0; k < 5; k++) {
		const float c = turns[k][0], d = turns[k][1];
		float to[2] = {c * way[0] - d * way[1], d * way[0] + c * way[1]};
		turn_to(w, to, points, seen, few);
		float own = steepness(w, seen);
		if (own < least) {
			least = own;
			best[0] = to[0];
			best[1] = to[1];
		}
	}
	turn_to(w, best, points, seen, few);
	return least < steep;
}

/* Makes a corner of places that follow each other, `first` to `last`, those before `right` on one side of it. */
static bool fold(view *w, int first, int right, int last)
{
	const float *x = w->cut, *y = w->chord;
	const int from[2] = {first, right}, to[2] = {right - 1, last};
	float at[2];
	for (int k = 0; k < 2; k++) {
		int a = from[k], b = to[k];
		w->slope[k] = (x[b] - x[a]) / (y[b] - y[a]);
		at[k] = x[a] - w->slope[k] * y[a];
		for (int c = a + 1; c < b; c++)
			if (fabsf(at[k] + w->slope[k] * y[c] - x[c]) > level)
				return false;
	}
	float apart = w->slope[0] - w->slope[1];
	if (fabsf(apart) < 0.1f)
		return false;
	w->corner[1] = (at[1] - at[0]) / apart;
	w->corner[0] = at[0] + w->slope[0] * w->corner[1];
	return w->corner[1] > y[right - 1] - beside && w->corner[1] < y[right] + beside;
}

/* Finds the corner of what covers part of the lamp, on five chords, and on one beyond these if it lies before the
 * outermost. */
static bool cross_fold(view *w, float few)
{
	enum { LOW, FIRST, NEXT, MIDDLE, BEFORE, LAST, HIGH };
	float wide = half_length(w);
	w->enough = enough_fold;
	if (!ISA(cross_chord)(w, MIDDLE, few, 0, 2))
		return false;
	for (int side = -1; side <= 1; side += 2) {
		float step = (float)side * 0.6f * (wide - (float)side * few);
		const int outer = MIDDLE + 2 * side;
		bool found = false;
		for (int tries = 0; tries < 3 && !found; tries++, step *= 0.5f)
			found = ISA(cross_chord)(w, outer, few + step, w->cut[MIDDLE], fabsf(step));
		step = 0.5f * (w->chord[outer] - few);
		if (!found ||
		    !ISA(cross_chord)(w, MIDDLE + side, few + step, 0.5f * (w->cut[MIDDLE] + w->cut[outer]), turn))
			return false;
	}
	w->folded = true;
	if (fold(w, FIRST, MIDDLE, LAST) || fold(w, FIRST, BEFORE, LAST))
		return true;
	if (ISA(cross_chord)(w, LOW, 0.3f * w->chord[FIRST] - 0.7f * wide, w->cut[FIRST], 0.5f) &&
	    fold(w, LOW, NEXT, LAST))
		return true;
	return ISA(cross_chord)(w, HIGH, 0.3f * w->chord[LAST] + 0.7f * wide, w->cut[LAST], 0.5f) &&
	       fold(w, FIRST, LAST, HIGH);
}

/* Whether the line goes on to where the lamp ends: few points may miss what is in the way there. */
static bool ends_hold(const view *w)
{
	float wide = half_length(w);
	spot at[4];
	unsigned dark = 0, asked = 0; /* bits: places that must be, and such as are on the lamp */
	for (int k = 0; k < 4; k++) {
		float along = (k & 2 ? near_end : -near_end) * wide, here = line_at(w, along), low, high;
		ISA(chord_ends)(w, along, &low, &high);
		at[k] = (spot){k & 1 ? here + aside : here - aside, along};
		asked |= (unsigned)(at[k].across > low && at[k].across < high) << k;
		dark |= (unsigned)!(k & 1) << k;
	}
	return !asked || ((ISA(spots_seen)(w, at, 4) ^ ~dark) & asked) == 0;
}

bool ISA(straight_share)(const light *l, const surface *s, const lamp_point *points, const float *value, uint32_t seen,
			 rays *from, float *share)
{
	view w = {.light = l, .at = s, .from = from, .square = l->lamp.type == ENCRE_RECTANGLE, .enough = enough};
	float way[2], guess, slope, wide, few;
	for (int k = 0; k < LAMP_FIRST; k++)
		if (!(value[k] > 0))
			return false;
	if (!way_to_seen(&w, points, seen, way))
		return false;
	bool found = aim_view(&w, points, seen, way, &guess, &slope, &wide, &few) &&
		     cross_three(&w, guess, slope, wide, few) && !bends(&w) && parts(&w, seen) && ends_hold(&w);
	if (!found)
		found = turn_to_corner(&w, way, points, seen, &few) && cross_fold(&w, few) && parts(&w, seen) &&
			ends_hold(&w);
	if (found)
		*share = light_beyond(&w, value);
	return found;
}
