/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What a way of sight meets. The layer's depth tells how far; the triangle nearest to that is the surface, and where it
 * is met exactly decides the rest. In double: a float of the world, less another, would lose what tells a surface from
 * its own shadow. */
#include "light/light.h"

/* By how much a depth may differ from the triangle's. */
static const double slack = 1e-3;

/* Two points on the way of sight through a place in pixels of the picture. */
static void sight(const light *l, double x, double y, double from[3], double to[3])
{
	const encre_frame *f = &l->job->frame;
	const double *m = l->inverse;
	double u = 2 * (x + f->x - LIGHT_MARGIN) / f->width - 1, v = 1 - 2 * (y + f->y - LIGHT_MARGIN) / f->height;
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
	const double *v = l->job->view + 8;
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

/* Reads a triangle, unless it is the one that was read last. */
static void load(const light *l, int32_t number, int32_t triangle, facet *known)
{
	if (known->instance == number && known->triangle == triangle)
		return;
	const instance *in = l->world.instances[number];
	const int32_t *corners = in->shape->corners + 3 * (ptrdiff_t)triangle;
	known->instance = number;
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
static surface meet_plane(const light *l, facet *known, int32_t number, int32_t triangle, const double a[3],
			  const double b[3], bool *inside)
{
	const instance *in = l->world.instances[number];
	double way[3], to[3], p[3], q[3], at[3];
	load(l, number, triangle, known);
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

surface ISA(place_on)(const light *l, facet *known, const surface *near, float x, float y, bool *inside)
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

/* The nearest that the camera sees, beyond the images. */
static surface look(const light *l, facet *known, const double a[3], const double b[3])
{
	const world *w = &l->world;
	const encre_light_job *job = l->job;
	double near = job->clip_start, far = near, from[3], to[3];
	for (int c = 0; c < 8; c++) {
		double p[3] = {(double)(c & 1 ? w->high : w->low)[0], (double)(c & 2 ? w->high : w->low)[1],
			       (double)(c & 4 ? w->high : w->low)[2]};
		far = fmax(far, depth_at_point(l, p));
	}
	far = 1.001 * far;
	far = job->clip_end > job->clip_start ? fmin(far, job->clip_end) : far;
	hit h;
	bool inside;
	at_depth(l, a, b, near, from);
	at_depth(l, a, b, far, to);
	if (!(far > near) || !ISA(ray_nearest)(w, from, to, 0, &h))
		return (surface){.instance = SURFACE_NOTHING};
	return meet_plane(l, known, h.instance, h.triangle, a, b, &inside);
}

static surface place_at(const light *l, facet *known, int x, int y)
{
	const encre_image *depth = &l->job->depth;
	double a[3], b[3], from[3], to[3];
	sight(l, x + 0.5, y + 0.5, a, b);
	x -= LIGHT_MARGIN;
	y -= LIGHT_MARGIN;
	if (x < 0 || y < 0 || x >= depth->width || y >= depth->height)
		return look(l, known, a, b);
	float z = depth_of(*pixel_at(depth, x, y));
	if (!(z < INFINITY))
		return (surface){.instance = SURFACE_NOTHING};
	hit h;
	bool inside;
	at_depth(l, a, b, (double)z * (1 - slack), from);
	at_depth(l, a, b, (double)z * (1 + slack), to);
	if (ISA(ray_nearest)(&l->world, from, to, 0.5f, &h))
		return meet_plane(l, known, h.instance, h.triangle, a, b, &inside);
	at_depth(l, a, b, (double)z, to);
	return stray(&l->job->normal, x, y, to, from);
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

void ISA(place_row)(light *l, int y)
{
	surface *row = l->surfaces + (ptrdiff_t)y * l->width;
	facet known = FACET_NONE;
	for (int x = 0; x < l->width; x++) {
		row[x] = place_at(l, &known, x, y);
		if (!finite_place(row + x))
			row[x] = (surface){.instance = SURFACE_NOTHING};
		if (row[x].instance == SURFACE_NOTHING)
			continue;
		ISA(bend_normal)(l, row + x);
		turn(l, row + x, x - LIGHT_MARGIN, y - LIGHT_MARGIN);
	}
}
