/* SPDX-License-Identifier: GPL-3.0-or-later */
/* One primitive on the screen: clipped, snapped, covering pixels.
 *
 * Coverage is decided on outlines snapped to 1/4096 pixel, in integers, hence without gaps or overlaps between
 * neighbours: equal corners snap alike, and the top-left rule gives a centre on an edge to one side. Depth and shares
 * come from the corners as they are, in homogeneous coordinates of the screen (Olano & Greer 1997), hence exact however
 * a surface is cut up, and without clipping. */
#include "raster/outline.h"

#include <math.h>
#include <stddef.h>
#include <string.h>

enum {
	GUARD = OUTLINE_GUARD,
	SUB_BITS = 12,
	SUB = 1 << SUB_BITS, /* steps of the grid to a pixel: frame and guard are 2^17 pixels, 2^29 steps wide */
	FEW = 4,             /* columns, of which each is asked whether it is inside */
	SOON = 64,           /* pixels, of which each is asked whether it hides */
};

enum clip_plane { CLIP_START, CLIP_END, CLIP_EYE, CLIP_LEFT, CLIP_RIGHT, CLIP_TOP, CLIP_BOTTOM, CLIP_COUNT };

/* At least 0 on the side that is kept. */
static inline double side(const room *r, int plane, const corner *c)
{
	switch (plane) {
	case CLIP_START: return c->z - r->start;
	case CLIP_END: return r->end - c->z;
	case CLIP_EYE: return c->w - 1e-12;
	case CLIP_LEFT: return c->x + GUARD * c->w;
	case CLIP_RIGHT: return (r->frame_width + GUARD) * c->w - c->x;
	case CLIP_TOP: return c->y + GUARD * c->w;
	default: return (r->frame_height + GUARD) * c->w - c->y;
	}
}

/* A bit for each plane beyond which it lies. */
static inline unsigned outside(const room *r, const corner *c)
{
	return (unsigned)(side(r, CLIP_START, c) < 0) << CLIP_START | (unsigned)(side(r, CLIP_END, c) < 0) << CLIP_END |
	       (unsigned)(side(r, CLIP_EYE, c) < 0) << CLIP_EYE | (unsigned)(side(r, CLIP_LEFT, c) < 0) << CLIP_LEFT |
	       (unsigned)(side(r, CLIP_RIGHT, c) < 0) << CLIP_RIGHT | (unsigned)(side(r, CLIP_TOP, c) < 0) << CLIP_TOP |
	       (unsigned)(side(r, CLIP_BOTTOM, c) < 0) << CLIP_BOTTOM;
}

/* Where an edge leaves a plane, always computed from the kept end: two neighbours get the same bits. */
static corner cut(const corner *in, const corner *out, double s_in, double s_out)
{
	double t = s_in / (s_in - s_out);
	return (corner){in->x + t * (out->x - in->x), in->y + t * (out->y - in->y), in->w + t * (out->w - in->w),
			in->z + t * (out->z - in->z)};
}

/* Not finite, or so large that products would not be: dropped. */
static inline bool usable(const corner *c)
{
	return fabs(c->x) + fabs(c->y) + fabs(c->w) + fabs(c->z) < 1e60;
}

/* Returns the number of corners left. A sliver within rounding of a plane, which may cross it any number of times, is
 * dropped when there is no room for it. */
static int clip(const room *r, corner *a, int n)
{
	corner b[OUTLINE_CORNERS];
	for (int plane = 0; plane < CLIP_COUNT; plane++) {
		int m = 0;
		for (int i = 0; i < n; i++) {
			if (m > OUTLINE_CORNERS - 2)
				return 0;
			const corner *p = a + i, *q = a + (i + 1) % n;
			double s = side(r, plane, p), t = side(r, plane, q);
			if (s >= 0)
				b[m++] = *p;
			if ((s >= 0) != (t >= 0))
				b[m++] = s >= 0 ? cut(p, q, s, t) : cut(q, p, t, s);
		}
		n = m;
		memcpy(a, b, (size_t)n * sizeof *a);
	}
	return n;
}

/* The guard's room is kept whatever rounding does, as integers depend on it. */
static inline int32_t snap(double pixel, double limit)
{
	pixel = pixel > -GUARD ? pixel : -GUARD;
	pixel = pixel < limit ? pixel : limit;
	return (int32_t)((pixel + GUARD) * SUB + 0.5);
}

/* First pixel whose centre is at or past `step`. */
static inline int32_t pixel_from(int32_t step)
{
	return (step + SUB / 2 - 1) >> SUB_BITS;
}

void outline_see(const room *r, spot *s)
{
	const corner *c = &s->corner;
	s->x = s->y = 0;
	s->outside = usable(c) ? outside(r, c) : OUTLINE_NOWHERE;
	if (s->outside)
		return;
	s->x = snap(c->x / c->w, r->frame_width + GUARD);
	s->y = snap(c->y / c->w, r->frame_height + GUARD);
}

/* The box of pixels of what is on the grid; false: it has none of the images'. */
static bool find_box(const room *r, outline *o)
{
	int32_t x0 = INT32_MAX, x1 = 0, y0 = INT32_MAX, y1 = 0;
	for (int k = 0; k < o->n; k++) {
		x0 = o->x[k] < x0 ? o->x[k] : x0;
		x1 = o->x[k] > x1 ? o->x[k] : x1;
		y0 = o->y[k] < y0 ? o->y[k] : y0;
		y1 = o->y[k] > y1 ? o->y[k] : y1;
	}
	o->x0 = pixel_from(x0);
	o->y0 = pixel_from(y0);
	o->x1 = pixel_from(x1); /* a centre on the right or bottom edge is not inside */
	o->y1 = pixel_from(y1);
	return o->x0 < o->x1 && o->y0 < o->y1 && o->x0 < r->x1 && o->x1 > r->x0 && o->y0 < r->y1 && o->y1 > r->y0;
}

static void find_depths(const corner *c, outline *o)
{
	o->nearest = INFINITY;
	o->farthest = -INFINITY;
	for (int k = 0; k < o->n; k++) {
		o->nearest = c[k].z < o->nearest ? c[k].z : o->nearest;
		o->farthest = c[k].z > o->farthest ? c[k].z : o->farthest;
	}
}

bool outline_make(const room *r, const spot *const spots[3], outline *o)
{
	unsigned some = spots[0]->outside | spots[1]->outside | spots[2]->outside;
	if (some & OUTLINE_NOWHERE || spots[0]->outside & spots[1]->outside & spots[2]->outside)
		return false;
	o->n = 3;
	for (int k = 0; k < 3; k++) {
		o->x[k] = spots[k]->x;
		o->y[k] = spots[k]->y;
	}
	if (!some && !find_box(r, o))
		return false;
	for (int k = 0; k < 3; k++)
		o->corner[k] = spots[k]->corner;
	if (!some) {
		find_depths(o->corner, o);
		return true;
	}
	corner a[OUTLINE_CORNERS];
	memcpy(a, o->corner, sizeof o->corner);
	o->n = clip(r, a, 3);
	if (o->n < 3)
		return false;
	for (int k = 0; k < o->n; k++) {
		o->x[k] = snap(a[k].x / a[k].w, r->frame_width + GUARD);
		o->y[k] = snap(a[k].y / a[k].w, r->frame_height + GUARD);
	}
	find_depths(a, o);
	return find_box(r, o);
}

/* Depth = n / d, both linear on the screen: at column x and row y a x + b y + c. */
typedef struct depth_plane {
	double n[3], d[3];
} depth_plane;

/* Columns and rows are counted from (left, top) in pixels of the full frame. */
static depth_plane plane_of(const corner c[3], double left, double top)
{
	depth_plane plane = {{0}, {0}};
	double x[3], y[3];
	for (int k = 0; k < 3; k++) {
		x[k] = c[k].x - left * c[k].w;
		y[k] = c[k].y - top * c[k].w;
	}
	for (int k = 0; k < 3; k++) {
		int i = (k + 1) % 3, j = (k + 2) % 3;
		double e[3] = {y[i] * c[j].w - y[j] * c[i].w, c[i].w * x[j] - c[j].w * x[i], x[i] * y[j] - x[j] * y[i]};
		for (int m = 0; m < 3; m++) {
			plane.n[m] += e[m] * c[k].z;
			plane.d[m] += e[m];
		}
	}
	return plane;
}

/* Divides by d > 0, rounding down. Exact in double: |k| < 2^52, so a quotient that is not whole is farther from the
 * next whole number, 1/d at least, than it is rounded. */
static inline int64_t floor_divide(int64_t k, int64_t d)
{
	double q = (double)k / (double)d;
	int64_t whole = (int64_t)q;
	return whole - ((double)whole > q);
}

static void draw_span(const band *b, const depth_plane *plane, const outline *o, int x, int y, int n, uint32_t number)
{
	double row = y - o->y0, above = plane->n[1] * row + plane->n[2], below = plane->d[1] * row + plane->d[2];
	double step_n = plane->n[0], step_d = plane->d[0], nearest = o->nearest, farthest = o->farthest;
	size_t at = (size_t)(y - b->y0) * (size_t)(b->x1 - b->x0) + (size_t)(x - b->x0);
	float *restrict depth = b->depth + at, least = b->close;
	const float *restrict beyond = b->beyond ? b->beyond + at : NULL;
	uint32_t *restrict front = b->front + at;
	int column = x - o->x0;
	for (int i = 0; i < n; i++) {
		double z = (step_n * (column + i) + above) / (step_d * (column + i) + below);
		/* A surface seen on its edge has no depth of its own (not even a number), but its corners have. */
		z = z > nearest ? z : nearest;
		z = z < farthest ? z : farthest;
		float f = (float)z, nearer = depth[i] - f, close = least + fabsf(f) * 0x1p-20f;
		if (beyond && !(f - close > beyond[i]))
			continue;
		/* Where rounding does not tell which is nearer, whether the two coincide is asked of their planes. */
		if (nearer >= -close && nearer <= close && b->coincide(b->user, front[i], number, x + i, y))
			b->twin[at + (size_t)i] = number;
		else if (nearer > 0) {
			front[i] = number;
			depth[i] = f;
		}
	}
}

/* The columns of a row, from *left on up to *right, that lie inside. Of few columns each is asked: it is done sooner
 * than dividing. */
static inline void span_of(const band *b, const outline *o, const int64_t k[3], const int64_t dy[3], int64_t *left,
			   int64_t *right)
{
	int64_t from = o->x0 > b->x0 ? o->x0 : b->x0, end = o->x1 < b->x1 ? o->x1 : b->x1;
	*left = b->x0;
	*right = b->x1 - 1;
	if (end - from <= FEW) {
		while (from < end && ((k[0] - dy[0] * from) | (k[1] - dy[1] * from) | (k[2] - dy[2] * from)) < 0)
			from++;
		while (end > from &&
		       ((k[0] - dy[0] * (end - 1)) | (k[1] - dy[1] * (end - 1)) | (k[2] - dy[2] * (end - 1))) < 0)
			end--;
		*left = from;
		*right = end - 1;
		return;
	}
	for (int i = 0; i < 3; i++) {
		if (dy[i] > 0) {
			int64_t q = floor_divide(k[i], dy[i]);
			*right = q < *right ? q : *right;
		} else if (dy[i] < 0) {
			int64_t q = -floor_divide(k[i], -dy[i]);
			*left = q > *left ? q : *left;
		} else if (k[i] < 0)
			*right = *left - 1;
	}
}

/* Draws the triangle of the outline's corners 0, j, j + 1. A centre at column x is inside an edge from a to b where
 * dx (y - ya) - dy (x - xa) >= 0, and > 0 unless the edge is a left or a top one. In whole pixels that is
 * k >= dy x, and k grows by dx a row: each edge bounds the row's span on one side. */
static void draw_triangle(const band *b, const outline *o, int j, const depth_plane *plane, uint32_t number)
{
	int64_t x[3] = {o->x[0], o->x[j], o->x[j + 1]}, y[3] = {o->y[0], o->y[j], o->y[j + 1]};
	int64_t area = (x[1] - x[0]) * (y[2] - y[0]) - (y[1] - y[0]) * (x[2] - x[0]);
	if (area == 0)
		return;
	int64_t dx[3], dy[3], k[3];
	int y0 = o->y0 > b->y0 ? o->y0 : b->y0, y1 = o->y1 < b->y1 ? o->y1 : b->y1;
	for (int i = 0; i < 3; i++) {
		int from = area > 0 ? i : (i + 1) % 3, to = area > 0 ? (i + 1) % 3 : i;
		dx[i] = x[to] - x[from];
		dy[i] = y[to] - y[from];
		bool top_left = dy[i] < 0 || (dy[i] == 0 && dx[i] > 0);
		int64_t e = dx[i] * ((int64_t)y0 * SUB + SUB / 2 - y[from]) - dy[i] * (SUB / 2 - x[from]) - !top_left;
		k[i] = e >> SUB_BITS; /* rounds down: all compilers shift arithmetically */
	}
	for (int row = y0; row < y1; row++) {
		int64_t left, right;
		span_of(b, o, k, dy, &left, &right);
		for (int i = 0; i < 3; i++)
			k[i] += dx[i];
		if (left > right)
			continue;
		draw_span(b, plane, o, (int)left, row, (int)(right - left + 1), number);
	}
}

/* Whether all of its box is hidden, where that is soon told. */
static bool is_hidden(const outline *o, const band *b)
{
	int x0 = o->x0 > b->x0 ? o->x0 : b->x0, x1 = o->x1 < b->x1 ? o->x1 : b->x1;
	int y0 = o->y0 > b->y0 ? o->y0 : b->y0, y1 = o->y1 < b->y1 ? o->y1 : b->y1;
	double most = fmax(fabs(o->nearest), fabs(o->farthest));
	if ((int64_t)(x1 - x0) * (y1 - y0) > SOON || !(most < 1e30)) /* as a float it might be infinite */
		return false;
	/* twice what draw_span() takes for close, as that is rounded */
	float before = (float)(o->nearest - 2 * ((double)b->close + most * 0x1p-20));
	for (int y = y0; y < y1; y++) {
		const float *depth = b->depth + (ptrdiff_t)(y - b->y0) * (b->x1 - b->x0);
		for (int x = x0; x < x1; x++)
			if (!(depth[x - b->x0] < before))
				return false;
	}
	return true;
}

void outline_draw(const outline *o, uint32_t number, const band *b)
{
	if (is_hidden(o, b))
		return;
	/* from the outline's box, not from the images: a border gets the full frame's bits */
	depth_plane plane = plane_of(o->corner, o->x0 - GUARD + 0.5, o->y0 - GUARD + 0.5);
	for (int j = 1; j + 1 < o->n; j++)
		draw_triangle(b, o, j, &plane, number);
}

void outline_shares(const corner c[3], double x, double y, double *second, double *third)
{
	double px[3], py[3], e[3];
	for (int k = 0; k < 3; k++) {
		px[k] = c[k].x - x * c[k].w;
		py[k] = c[k].y - y * c[k].w;
	}
	for (int k = 0; k < 3; k++) {
		int i = (k + 1) % 3, j = (k + 2) % 3;
		e[k] = px[i] * py[j] - px[j] * py[i];
	}
	double sign = e[0] + e[1] + e[2] < 0 ? -1 : 1, sum = 0;
	for (int k = 0; k < 3; k++) {
		e[k] = sign * e[k] > 0 ? sign * e[k] : 0;
		sum += e[k];
	}
	*second = sum > 0 ? e[1] / sum : 0;
	*third = sum > 0 ? e[2] / sum : 0;
}

void outline_growth(const corner c[3], double x, double y, double share[3], double right[3], double down[3])
{
	double e[3], ex[3], ey[3], sum = 0, sum_x = 0, sum_y = 0;
	for (int k = 0; k < 3; k++) { /* e, as in outline_shares(), is linear in x and y */
		const corner *a = c + (k + 1) % 3, *b = c + (k + 2) % 3;
		e[k] = (a->x - x * a->w) * (b->y - y * b->w) - (b->x - x * b->w) * (a->y - y * a->w);
		ex[k] = b->w * a->y - a->w * b->y;
		ey[k] = a->w * b->x - b->w * a->x;
		sum += e[k];
		sum_x += ex[k];
		sum_y += ey[k];
	}
	outline_shares(c, x, y, share + 1, share + 2);
	share[0] = 1 - share[1] - share[2];
	double square = sum * sum;
	for (int k = 0; k < 3; k++) {
		right[k] = square > 0 ? (ex[k] * sum - e[k] * sum_x) / square : 0;
		down[k] = square > 0 ? (ey[k] * sum - e[k] * sum_y) / square : 0;
	}
}

static inline double plane_depth(const depth_plane *p, double x, double y)
{
	return (p->n[0] * x + p->n[1] * y + p->n[2]) / (p->d[0] * x + p->d[1] * y + p->d[2]);
}

bool outline_same_plane(const corner one[3], const corner other[3], double x, double y, double close)
{
	depth_plane p = plane_of(one, x, y), q = plane_of(other, x, y);
	bool same = true; /* of one seen on its edge depths are no numbers */
	for (int k = 0; k < 3; k++)
		same = same && fabs(plane_depth(&p, k == 1, k == 2) - plane_depth(&q, k == 1, k == 2)) <= close;
	return same;
}
