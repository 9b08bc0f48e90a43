/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A line goes from square to square between pixel centres. It leaves one through the way between two centres and enters
 * the next there, so the places where it crosses such ways, linked through the squares, are the line again. That must
 * hold where it runs through a centre too: which of two ways comes first is decided once, by comparing the same two
 * numbers, and not by where rounding puts the crossings. */
#include "raster/segment.h"

#include <math.h>

/* The guard's room is kept whatever rounding does, as integers depend on it. */
static inline double inside(double pixel, double limit)
{
	pixel = pixel > -OUTLINE_GUARD ? pixel : -OUTLINE_GUARD;
	return pixel < limit ? pixel : limit;
}

bool segment_make(const room *r, const corner corner[2], segment *s, int *y0, int *y1)
{
	struct corner c[2] = {corner[0], corner[1]};
	if (!outline_clip(r, c))
		return false;
	for (int k = 0; k < 2; k++) {
		s->x[k] = inside(c[k].x / c[k].w, r->frame_width + OUTLINE_GUARD) - 0.5;
		s->y[k] = inside(c[k].y / c[k].w, r->frame_height + OUTLINE_GUARD) - 0.5;
		s->u[k] = 1 / c[k].w;
		s->z[k] = c[k].z / c[k].w;
	}
	*y0 = (int)floor(fmin(s->y[0], s->y[1]));
	*y1 = (int)floor(fmax(s->y[0], s->y[1])) + 1;
	int left = (int)floor(fmin(s->x[0], s->x[1])), right = (int)floor(fmax(s->x[0], s->x[1]));
	return right >= r->x0 - OUTLINE_GUARD && left < r->x1 - OUTLINE_GUARD && *y1 > r->y0 - OUTLINE_GUARD &&
	       *y0 < r->y1 - OUTLINE_GUARD && (right > left || *y1 > *y0 + 1);
}

/* When, 0..1, the way from a to b passes a whole number. */
static inline double when(double a, double b, int line)
{
	return (line - a) / (b - a);
}

/* Between which whole number and the next the way from a to b is at a time; `reached`: what is reached just then is
 * passed. */
static int square_at(double a, double b, double time, bool reached)
{
	int first = (int)floor(a), last = (int)floor(b), at = (int)floor(a + time * (b - a));
	int low = first < last ? first : last, high = first < last ? last : first, ahead = a < b;
	at = at > low ? at < high ? at : high : low;
	/* line at + ahead lies ahead, the other one behind */
	for (double t; at != last && ((t = when(a, b, at + ahead)) < time || (reached && t == time));)
		at += ahead ? 1 : -1;
	for (double t; at != first && ((t = when(a, b, at + !ahead)) > time || (!reached && t == time));)
		at -= ahead ? 1 : -1;
	return at;
}

static inline int from(double a, double b, int least)
{
	int first = (int)floor(fmin(a, b)) + 1;
	return first > least ? first : least;
}

static inline int to(double a, double b, int end)
{
	int last = (int)floor(fmax(a, b)) + 1;
	return last < end ? last : end;
}

static crossing crossing_at(const segment *s, double time)
{
	crossing c = {.x = s->x[0] + time * (s->x[1] - s->x[0]), .y = s->y[0] + time * (s->y[1] - s->y[0])};
	c.z = (s->z[0] + time * (s->z[1] - s->z[0])) / (s->u[0] + time * (s->u[1] - s->u[0]));
	return c;
}

void segment_cross(const segment *s, int x0, int x1, int y0, int y1, segment_found found, void *user)
{
	for (int row = from(s->y[0], s->y[1], y0); row < to(s->y[0], s->y[1], y1); row++) {
		double time = when(s->y[0], s->y[1], row);
		crossing c = crossing_at(s, time);
		c.row = row;
		c.column = square_at(s->x[0], s->x[1], time, true);
		c.share = c.x - c.column;
		if (c.column >= x0 && c.column < x1)
			found(user, &c);
	}
	for (int column = from(s->x[0], s->x[1], x0); column < to(s->x[0], s->x[1], x1); column++) {
		double time = when(s->x[0], s->x[1], column);
		crossing c = crossing_at(s, time);
		c.down = true;
		c.column = column;
		c.row = square_at(s->y[0], s->y[1], time, false);
		c.share = c.y - c.row;
		if (c.row >= y0 && c.row < y1)
			found(user, &c);
	}
}
