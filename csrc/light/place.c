/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What a way of sight meets. The layer's depth tells how far; the triangle nearest to that is the surface, and where it
 * is met exactly decides the rest. In double: a float of the world, less another, would lose what tells a surface from
 * its own shadow. */
#include "light/light.h"
#include "light/local.h"

/* By how much a depth may differ from the triangle's. */
static const double slack = 1e-3;
static const float about = 0.06f; /* so much of a depth those of pixels differ that share a shaft, at most */

/* Two points on the way of sight through a place in pixels of the picture. */
static void sight(const light *l, double x, double y, double from[3], double to[3])
{
	const encre_frame *f = &l->job->frame;
	const double *m = l->inverse;
	double u = 2 * (x + f->x - l->margin) / f->width - 1, v = 1 - 2 * (y + f->y - l->margin) / f->height;
	double *out[] = {from, to};
	for (int k = 0; k < 2; k++) {
		double c[4];
		for (int r = 0; r < 4; r++)
			c[r] = m[4 * r] * u + m[4 * r + 1] * v + m[4 * r + 2] * (k - 1) + m[4 * r + 3];
		for (int r = 0; r < 3; r++)
			out[k][r] = c[r] / c[3];
	}
}

void ISA(place_pixel)(const light *l, vec at, double out[2])
{
	const double *m = l->clip, p[3] = {(double)at.x, (double)at.y, (double)at.z};
	double c[4];
	for (int r = 0; r < 4; r++)
		c[r] = m[4 * r] * p[0] + m[4 * r + 1] * p[1] + m[4 * r + 2] * p[2] + m[4 * r + 3];
	double w = c[3] > 1e-9 ? c[3] : 1e-9;
	out[0] = (0.5 + 0.5 * c[0] / w) * l->job->frame.width;
	out[1] = (0.5 - 0.5 * c[1] / w) * l->job->frame.height;
}

static double depth_at_point(const light *l, const double p[3])
{
	const double *v = l->view + 8;
	return -(v[0] * p[0] + v[1] * p[1] + v[2] * p[2] + v[3]);
}

/* The point of the way of sight from a to b that lies at a depth. */
static void at_depth(const light *l, const double a[3], const double b[3], double depth, double out[3])
{
	double za = depth_at_point(l, a), zb = depth_at_point(l, b), t = (depth - za) / (zb - za);
	for (int k = 0; k < 3; k++)
		out[k] = a[k] + t * (b[k] - a[k]);
}

static vec narrow(const double p[3])
{
	return (vec){(float)p[0], (float)p[1], (float)p[2]};
}

static void subtract(const double a[3], const double b[3], double out[3])
{
	for (int k = 0; k < 3; k++)
		out[k] = a[k] - b[k];
}

static void product(const double a[3], const double b[3], double out[3])
{
	out[0] = a[1] * b[2] - a[2] * b[1];
	out[1] = a[2] * b[0] - a[0] * b[2];
	out[2] = a[0] * b[1] - a[1] * b[0];
}

static double along(const double a[3], const double b[3])
{
	return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static vec direction(const double a[3])
{
	double size = 1 / fmax(fmax(fabs(a[0]), fabs(a[1])), fmax(fabs(a[2]), 1e-300));
	return unit((vec){(float)(a[0] * size), (float)(a[1] * size), (float)(a[2] * size)});
}

/* A normal in the world: by the transposed inverse. */
static vec world_normal(const instance *in, vec n)
{
	const double *m = in->inverse;
	double x = (double)n.x, y = (double)n.y, z = (double)n.z;
	double out[3] = {m[0] * x + m[4] * y + m[8] * z, m[1] * x + m[5] * y + m[9] * z,
			 m[2] * x + m[6] * y + m[10] * z};
	return direction(out);
}

static const facet *load(const light *l, int32_t number, int32_t triangle, facets *all)
{
	facet *known = all->of + (triangle & (FACETS - 1));
	if (known->count == number + 1 && known->triangle == triangle)
		return known;
	const instance *in = l->world.instances[number];
	const int32_t *corners = in->shape->corners + 3 * (ptrdiff_t)triangle;
	known->count = number + 1;
	known->triangle = triangle;
	for (int k = 0; k < 3; k++) {
		const float *point = in->shape->points + 3 * (ptrdiff_t)corners[k];
		double own[3] = {(double)point[0], (double)point[1], (double)point[2]};
		transform_point(in->model, own, known->corner[k]);
		if (in->shape->normals)
			known->normal[k] =
				world_normal(in, vec_of(in->shape->normals + 9 * (ptrdiff_t)triangle + 3 * k));
	}
	subtract(known->corner[1], known->corner[0], known->first);
	subtract(known->corner[2], known->corner[0], known->second);
	product(known->first, known->second, known->across);
	known->side = times(direction(known->across), in->mirrored ? -1 : 1);
	return known;
}

/* Between the corners of a smooth surface: its normal, and how far above it rays begin that must not meet its own
 * facets: on the planes that touch it at the corners (Hanika 2021). */
static void smooth(const facet *of, float u, float v, bool away, surface *s)
{
	float c[3] = {0, clamp01(u), clamp01(v)}, over = max(c[1] + c[2], 1);
	c[1] /= over;
	c[2] /= over;
	c[0] = 1 - c[1] - c[2];
	vec sum = {0, 0, 0}, lift = {0, 0, 0};
	for (int k = 0; k < 3; k++) {
		vec n = away ? times(of->normal[k], -1) : of->normal[k];
		sum = plus(sum, times(n, c[k]));
		float under = dot(minus(s->at, narrow(of->corner[k])), n);
		lift = plus(lift, times(n, -c[k] * min(0, under)));
	}
	if (dot(sum, sum) > 0.01f)
		s->normal = unit(sum);
	s->lift = lift;
}

/* Where the way of sight from a to b meets the plane of a triangle. */
static surface meet_plane(const light *l, facets *all, int32_t number, int32_t triangle, const double a[3],
			  const double b[3], bool *inside)
{
	const instance *in = l->world.instances[number];
	const facet *known = load(l, number, triangle, all);
	double way[3], to[3], p[3], q[3], at[3];
	subtract(b, a, way);
	subtract(a, known->corner[0], to);
	product(way, known->second, p);
	product(to, known->first, q);
	double det = along(known->first, p), r = det != 0 ? 1 / det : 0, u = along(to, p) * r, v = along(way, q) * r;
	double t = along(known->second, q) * r;
	for (int k = 0; k < 3; k++)
		at[k] = a[k] + t * way[k];
	bool away = (along(known->across, way) > 0) != in->mirrored;
	surface s = {.instance = number, .triangle = triangle, .at = narrow(at)};
	s.across = away ? times(known->side, -1) : known->side;
	s.normal = s.across;
	*inside = u >= 0 && v >= 0 && u + v <= 1;
	if (in->shape->normals)
		smooth(known, (float)u, (float)v, away, &s);
	return s;
}

surface ISA(place_on)(const light *l, facets *known, const surface *near, float x, float y, bool *inside)
{
	double a[3], b[3];
	sight(l, (double)x, (double)y, a, b);
	if (near->instance >= 0) {
		surface met = meet_plane(l, known, near->instance, near->triangle, a, b, inside);
		met.turned = near->turned;
		if (near->turned)
			met.normal = near->normal;
		else
			ISA(bend_normal)(l, &met);
		return met;
	}
	surface s = *near;
	double way[3], n[3] = {(double)near->across.x, (double)near->across.y, (double)near->across.z};
	subtract(b, a, way);
	double p[3] = {(double)near->at.x, (double)near->at.y, (double)near->at.z}, to[3];
	subtract(p, a, to);
	double slope = along(way, n), t = slope != 0 ? along(to, n) / slope : 0;
	for (int k = 0; k < 3; k++)
		to[k] = a[k] + t * way[k];
	s.at = narrow(to);
	*inside = true;
	return s;
}

/* What is not in the scene: hair, displacement, what another renderer drew. */
static surface stray(const encre_image *normals, int x, int y, const double at[3], const double eye[3])
{
	double way[3];
	subtract(at, eye, way);
	vec seen = direction(way), n = {0, 0, 0};
	if (normals->data)
		n = vec_of(pixel_at(normals, x, y));
	float square = dot(n, n);
	n = square > 1e-6f && square < 1e6f ? unit(n) : times(seen, -1);
	return (surface){.at = narrow(at), .normal = n, .across = n, .instance = SURFACE_STRAY};
}

/* A way of sight, and between which of its points something is looked for. */
typedef struct gaze {
	double a[3], b[3], from[3], to[3];
	float depth; /* 0: it is not known, beyond the images, and what lies nearest counts */
	bool beyond;
} gaze;

/* False where nothing is to be seen. */
static bool gaze_at(const light *l, int x, int y, gaze *g)
{
	const encre_image *depth = &l->job->depth;
	double near = l->job->clip_start, far = l->farthest;
	sight(l, x + 0.5, y + 0.5, g->a, g->b);
	x -= l->margin;
	y -= l->margin;
	g->beyond = x < 0 || y < 0 || x >= depth->width || y >= depth->height;
	g->depth = g->beyond ? 0 : depth_of(*pixel_at(depth, x, y));
	if (!g->beyond) {
		near = (double)g->depth * (1 - slack);
		far = (double)g->depth * (1 + slack);
	}
	at_depth(l, g->a, g->b, near, g->from);
	at_depth(l, g->a, g->b, far, g->to);
	return g->beyond ? far > near : g->depth < INFINITY;
}

/* Of the pixels `left` those that lie about as deep as the first, and a shaft along their ways of sight. */
static uint64_t gaze_group(const light *l, const gaze *all, uint64_t left, shaft *along)
{
	const gaze *one = all + __builtin_ctzll(left);
	shaft_starts from = {.within = {narrow(one->from), narrow(one->from)}, .instance = -1};
	box to = {narrow(one->to), narrow(one->to)};
	uint64_t group = 0;
	for (; left; left &= left - 1) {
		const gaze *g = all + __builtin_ctzll(left);
		if (g != one && (g->beyond != one->beyond || fabsf(g->depth - one->depth) > about * one->depth))
			continue;
		group |= left & -left;
		box_add(&from.within, narrow(g->from));
		box_add(&to, narrow(g->to));
	}
	along->usable = false;
	if (__builtin_popcountll(group) < SHAFT_FEW)
		return group;
	box *const ends[] = {&from.within, &to};
	for (int k = 0; k < 2; k++) { /* what floats leave of places */
		float off = 3e-7f * max(largest(ends[k]->low), largest(ends[k]->high));
		ends[k]->low = minus(ends[k]->low, (vec){off, off, off});
		ends[k]->high = plus(ends[k]->high, (vec){off, off, off});
	}
	ISA(shaft_make)(along, &l->world, &from, to, 1, SET_SEEN);
	return group;
}

static surface surface_at(const light *l, facets *known, const gaze *g, const shaft *along, int x, int y)
{
	hit h;
	bool inside;
	double at[3];
	if (ISA(shaft_nearest)(along, &l->world, g->from, g->to, g->beyond ? 0 : 0.5f, &h))
		return meet_plane(l, known, h.instance, h.triangle, g->a, g->b, &inside);
	if (g->beyond)
		return (surface){.instance = SURFACE_NOTHING};
	at_depth(l, g->a, g->b, (double)g->depth, at);
	return stray(&l->job->normal, x - l->margin, y - l->margin, at, g->from);
}

static bool finite_place(const surface *s)
{
	float sum = dot(s->at, (vec){0, 0, 0}) + dot(s->normal, (vec){0, 0, 0}) + dot(s->lift, (vec){0, 0, 0}) +
		    dot(s->across, (vec){0, 0, 0});
	return sum == 0;
}

/* By a normal map. Beyond the picture nothing tells of one. */
static void turn(const light *l, surface *s, int x, int y)
{
	const encre_image *to = &l->job->turned;
	if (!to->data || x < 0 || y < 0 || x >= to->width || y >= to->height)
		return;
	vec n = vec_of(pixel_at(to, x, y));
	float square = dot(n, n);
	s->turned = square > 1e-6f && square < 1e6f;
	s->normal = s->turned ? unit(n) : s->normal;
}

static void place(light *l, facets *known, const gaze *g, const shaft *along, int x, int y)
{
	surface s = surface_at(l, known, g, along, x, y);
	if (s.instance == SURFACE_NOTHING || !finite_place(&s))
		return;
	ISA(bend_normal)(l, &s);
	turn(l, &s, x - l->margin, y - l->margin);
	l->surfaces[(ptrdiff_t)y * l->width + x] = s;
}

surface ISA(place_of)(const light *l, facets *known, int32_t number, double x, double y)
{
	const instance *in = l->world.instances[number];
	double a[3], b[3], from[3], to[3];
	search f = SEARCH(0, -1, NULL);
	local way;
	bool inside;
	sight(l, x, y, a, b);
	at_depth(l, a, b, l->job->clip_start, from);
	at_depth(l, a, b, l->farthest, to);
	if (local_between(in, from, to, &way))
		ISA(shape_nearest)(in->shape, 0, &way, number, &f);
	if (f.best.instance < 0)
		return (surface){.instance = SURFACE_NOTHING};
	surface s = meet_plane(l, known, number, f.best.triangle, a, b, &inside);
	if (!finite_place(&s))
		return (surface){.instance = SURFACE_NOTHING};
	ISA(bend_normal)(l, &s);
	return s;
}

/* By squares, whose pixels show few triangles. */
static void place_rows(void *data, int y0, int y1, int thread)
{
	(void)thread;
	light *l = data;
	facets known = FACETS_NONE;
	gaze all[SHAFT_SIDE * SHAFT_SIDE];
	shaft along;
	for (int y = y0; y < y1; y += SHAFT_SIDE)
		for (int x = 0; x < l->width && !bands_stopped(l->bands); x += SHAFT_SIDE) {
			uint64_t left = 0;
			for (int k = 0; k < SHAFT_SIDE * SHAFT_SIDE; k++) {
				int u = x + k % SHAFT_SIDE, v = y + k / SHAFT_SIDE;
				if (u >= l->width || v >= y1)
					continue;
				l->surfaces[(ptrdiff_t)v * l->width + u] = (surface){.instance = SURFACE_NOTHING};
				left |= (uint64_t)gaze_at(l, u, v, all + k) << k;
			}
			while (left) {
				uint64_t group = gaze_group(l, all, left, &along);
				left &= ~group;
				for (; group; group &= group - 1) {
					int k = __builtin_ctzll(group);
					place(l, &known, all + k, &along, x + k % SHAFT_SIDE, y + k / SHAFT_SIDE);
				}
			}
		}
}

int32_t ISA(place_run)(light *l)
{
	const world *w = &l->world;
	const encre_light_job *job = l->job;
	double far = job->clip_start;
	for (int c = 0; c < 8; c++) {
		double p[3] = {(double)(c & 1 ? w->high : w->low)[0], (double)(c & 2 ? w->high : w->low)[1],
			       (double)(c & 4 ? w->high : w->low)[2]};
		far = fmax(far, depth_at_point(l, p));
	}
	far = 1.001 * far;
	l->farthest = job->clip_end > job->clip_start ? fmin(far, job->clip_end) : far;
	return bands_run(l->bands, l->height, 0, place_rows, l);
}
