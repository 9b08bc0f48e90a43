/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A job of light: surfaces first, then lamp after lamp, all summed, and the light from all sides. */
#include "light/handle.h"
#include "light/light.h"

#include <stdlib.h>
#include <string.h>

/* What is kept for the next light, at most: a picture of 1080 rows takes 220 million bytes. */
static const size_t held_most = (size_t)1 << 28;

/* ---- rows -------------------------------------------------------------------------------------------------- */

static void add_rows(void *data, int y0, int y1, int thread)
{
	(void)thread;
	light *l = data;
	rays from = RAYS(NULL);
	for (int y = y0; y < y1 && !bands_stopped(l->bands); y++) {
		for (ptrdiff_t i = (ptrdiff_t)y * l->width; i < (ptrdiff_t)(y + 1) * l->width; i++) {
			float comes = l->silhouette[i] ? ISA(silhouette_light)(l, &from, i) : l->plain[i] * l->share[i];
			for (int c = 0; c < 3; c++)
				l->sum[3 * i + c] += comes * l->lamp.color[c];
		}
		if (l->shines && y >= l->margin && y < l->height - l->margin)
			ISA(shine_row)(l, y - l->margin);
	}
}

/* Light from all sides, by the normal. */
static void world_rows(void *data, int y0, int y1, int thread)
{
	(void)thread;
	light *l = data;
	facets known = FACETS_NONE;
	for (ptrdiff_t i = (ptrdiff_t)y0 * l->width; i < (ptrdiff_t)y1 * l->width; i++) {
		if (i % l->width == 0 && bands_stopped(l->bands))
			return;
		if (l->surfaces[i].instance == SURFACE_NOTHING) {
			for (int c = 0; c < 3; c++)
				l->sum[3 * i + c] = 0;
			continue;
		}
		vec n = l->silhouette[i] ? ISA(silhouette_place)(l, &known, i).normal : l->surfaces[i].normal;
		const float by[9] = {
			1, n.x, n.y, n.z, n.x * n.y, n.y * n.z, 3 * n.z * n.z - 1, n.x * n.z, n.x * n.x - n.y * n.y};
		for (int c = 0; c < 3; c++) {
			float sum = 0;
			for (int k = 0; k < 9; k++)
				sum += by[k] * l->job->world[3 * k + c];
			l->sum[3 * i + c] = max(sum, 0);
		}
	}
}

/* The nearest pixel that shows something within 2 of one that shows nothing: of such as lie equally near the mean, so
 * that no side is favoured. */
static void borrow(const light *l, int x, int y, float out[3])
{
	int nearest = 9, n = 0;
	for (int v = y - 2; v <= y + 2; v++)
		for (int u = x - 2; u <= x + 2; u++) {
			int far = (u - x) * (u - x) + (v - y) * (v - y);
			ptrdiff_t j = (ptrdiff_t)v * l->width + u;
			if (far > nearest || l->surfaces[j].instance == SURFACE_NOTHING)
				continue;
			n = far < nearest ? 0 : n;
			nearest = far;
			n++;
			for (int c = 0; c < 3; c++)
				out[c] = n == 1 ? l->sum[3 * j + c] : out[c] + l->sum[3 * j + c];
		}
	for (int c = 0; c < 3; c++)
		out[c] = n ? out[c] / (float)n : 0;
}

static void clear_rows(void *data, int y0, int y1, int thread)
{
	(void)thread;
	const light *l = data;
	const encre_image *out = &l->job->specular;
	for (int y = y0; y < y1; y++)
		for (int x = 0; x < out->width; x++)
			memset(pixel_at(out, x, y), 0, 3 * sizeof(float));
}

static void write_rows(void *data, int y0, int y1, int thread)
{
	(void)thread;
	const light *l = data;
	const encre_image *out = &l->job->diffuse;
	for (int y = y0; y < y1 && !bands_stopped(l->bands); y++)
		for (int x = 0; x < out->width; x++) {
			ptrdiff_t i = (ptrdiff_t)(y + l->margin) * l->width + x + l->margin;
			float rgb[3] = {l->sum[3 * i], l->sum[3 * i + 1], l->sum[3 * i + 2]}, keep = 1;
			if (l->surfaces[i].instance == SURFACE_NOTHING)
				borrow(l, x + l->margin, y + l->margin, rgb);
			else if (l->job->rims)
				keep = ISA(lone_rim)(l, x + l->margin, y + l->margin);
			for (int c = 0; c < 3; c++)
				rgb[c] = min(max(keep * rgb[c], 0), FLT_MAX);
			memcpy((char *)out->data + y * out->row_stride + x * out->pixel_stride, rgb, sizeof rgb);
		}
}

/* ---- the job ----------------------------------------------------------------------------------------------- */

static void plan(light *l, arena *a)
{
	size_t n = (size_t)l->width * (size_t)l->height;
	l->surfaces = arena_take(a, n, sizeof *l->surfaces);
	l->state = arena_take(a, n, sizeof *l->state);
	l->silhouette = arena_take(a, n, sizeof *l->silhouette);
	l->plain = arena_take(a, n, sizeof *l->plain);
	l->share = arena_take(a, n, sizeof *l->share);
	l->cut = arena_take(a, 2 * n, sizeof *l->cut);
	l->asked = arena_take(a, n, sizeof *l->asked);
	l->spare = arena_take(a, n, sizeof *l->spare);
	l->exact = arena_take(a, n, sizeof *l->exact);
	l->sum = arena_take(a, 3 * n, sizeof *l->sum);
}

/* Makes a lamp of the scene the one that is drawn; false where it gives no light. */
static bool take_lamp(light *l, int32_t i)
{
	encre_lamp given = *(const encre_lamp *)l->job->scene->lamps.items[i];
	for (int k = 0; k < 3; k++)
		given.model[4 * k + 3] -= l->origin[k];
	if (!lamp_make(&given, &l->lamp))
		return false;
	/* what fills half of the sky has no middle where a sharp shadow would end */
	bool wide = l->lamp.type == ENCRE_SUN && l->lamp.open > 0.99f;
	l->soft = l->lamp.soft && (wide || !l->job->sharp);
	l->lamp.shadows &= !(wide && l->job->sharp) && !l->job->unshadowed;
	l->shines = l->job->specular.data && l->job->shine.data && !given.matt;
	return true;
}

static void find_size(light *l)
{
	l->margin = LIGHT_MARGIN_HARD;
	for (int32_t i = 0; i < l->job->scene->lamps.count; i++)
		l->margin = take_lamp(l, i) && l->soft ? LIGHT_MARGIN : l->margin;
	l->width = l->job->diffuse.width + 2 * l->margin;
	l->height = l->job->diffuse.height + 2 * l->margin;
}

static int32_t run(light *l)
{
	const store *lamps = &l->job->scene->lamps;
	bands_span(l->bands, 0.1, 0.3);
	int32_t code = ISA(place_run)(l);
	if (!code)
		code = ISA(silhouette_run)(l);
	if (!code)
		code = bands_run(l->bands, l->height, 0, world_rows, l);
	if (!code && l->job->specular.data)
		code = bands_run(l->bands, l->job->specular.height, 0, clear_rows, l);
	lamp_points_make(&l->points);
	for (int32_t i = 0; !code && i < lamps->count; i++) {
		double share = 0.7 / lamps->count;
		bands_span(l->bands, 0.3 + share * i, 0.3 + share * (i + 1));
		if (!take_lamp(l, i))
			continue;
		code = ISA(shadow_run)(l);
		if (!code)
			code = bands_run(l->bands, l->height, 0, add_rows, l);
	}
	return code ? code : bands_run(l->bands, l->job->diffuse.height, 0, write_rows, l);
}

/* Far from 0 floats lie further apart than pixels: so the world is moved until the eye stands near it, by steps that
 * are longer than what is seen. A scene about 0 is not moved. */
static void find_origin(light *l)
{
	const double *v = l->job->view;
	double far = l->job->clip_end > l->job->clip_start ? l->job->clip_end : INFINITY, step = 1;
	memcpy(l->view, v, sizeof l->view);
	while (step < far && step < 1e30)
		step *= 2;
	while (step > 2 * far && step > 1e-30)
		step /= 2;
	for (int c = 0; c < 3; c++) {
		double eye = -(v[c] * v[3] + v[4 + c] * v[7] + v[8 + c] * v[11]);
		l->origin[c] = fabs(eye) < 1e30 ? step * floor(eye / step + 0.5) : 0;
		for (int r = 0; r < 3; r++)
			l->view[4 * r + 3] += v[4 * r + c] * l->origin[c];
	}
}

/* Where the camera stands, or how far ones look. */
static void find_eye(light *l)
{
	const double *p = l->job->projection, *m = l->inverse;
	double out[4];
	l->eye_far = p[14] == 0;
	int column = l->eye_far ? 2 : 3; /* of what lies on the axis: endlessly far ahead, or at the eye */
	for (int r = 0; r < 4; r++) {
		out[r] = 0;
		for (int k = 0; k < 4; k++)
			out[r] += m[4 * r + k] * p[4 * k + column];
	}
	double by = l->eye_far ? 1 : 1 / out[3];
	l->eye = (vec){(float)(out[0] * by), (float)(out[1] * by), (float)(out[2] * by)};
	l->eye = l->eye_far ? unit(l->eye) : l->eye;
}

int32_t ISA(light_run)(bands *pool, const encre_light_job *job, arena_held *held)
{
	light l = {.job = job, .bands = pool};
	find_origin(&l);
	find_size(&l);
	camera_inverse(l.view, job->projection, l.inverse);
	camera_product(l.view, job->projection, l.clip);
	find_eye(&l);
	ISA(bend_make)(&l);
	bands_span(pool, 0, 0.1);
	int32_t code = world_make(&l.world, job->scene, l.origin, pool);
	arena a = {0};
	plan(&l, &a);
	if (!code && !arena_hold(&a, held))
		code = ENCRE_ERROR_MEMORY;
	if (!code) {
		plan(&l, &a);
		code = run(&l);
	}
	if (held->size > held_most) {
		free(held->memory);
		*held = (arena_held){0};
	}
	world_free(&l.world);
	return code;
}
