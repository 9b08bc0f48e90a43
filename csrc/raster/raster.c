/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The rasteriser: which surface is in front at each pixel's centre.
 *
 * Primitives are sorted into bands of rows once (counted, summed up, filed), so that every band holds its primitives in
 * the order of the job whatever the threads. A band then finds the nearest primitive of each pixel in a buffer that
 * stays in cache, and only these are shaded: attributes, normals and indices are never computed for what is hidden.
 * Points are brought onto the screen once (spots.c). Where primitives lie is geometry.c's, what one covers
 * outline.c's. */
#include "raster/raster.h"

#include "raster/anchors.h"
#include "raster/cards.h"
#include "raster/spots.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

enum {
	CHUNK = 1024,     /* primitives that are sorted at once, at least */
	MAX_CHUNKS = 256, /* each has a count for every band */
};

/* Rows of the images, from which on and up to which exclusively, that a primitive is drawn in; false: none. */
static bool rows_of(const raster *r, const part *part, uint32_t primitive, int *y0, int *y1)
{
	outline o;
	if (part->mesh->kind != ENCRE_TRIANGLES || !geometry_outline(part, primitive, &r->room, &o))
		return false;
	*y0 = o.y0 > r->room.y0 ? o.y0 - r->room.y0 : 0;
	*y1 = o.y1 < r->room.y1 ? o.y1 - r->room.y0 : r->height;
	return *y0 < *y1;
}

/* As outline_coincide. */
static bool coincide(const void *user, uint32_t one, uint32_t other, int column, int row)
{
	const raster *r = user;
	const part *part = geometry_part(&r->geometry, NULL, one);
	corner a[3], b[3];
	geometry_corners(part, one - part->first, a);
	part = geometry_part(&r->geometry, part, other);
	geometry_corners(part, other - part->first, b);
	double x = column - OUTLINE_GUARD + 0.5, y = row - OUTLINE_GUARD + 0.5;
	return outline_same_plane(a, b, x, y, 2 * ((double)r->close + fabs(a[0].z) * 0x1p-20));
}

/* ---- sorting into bands ------------------------------------------------------------------------------------ */

static uint32_t chunk_end(const raster *r, uint32_t from)
{
	return r->geometry.n_primitives - from < r->chunk ? r->geometry.n_primitives : from + r->chunk;
}

static void count_chunks(void *data, int c0, int c1, int thread)
{
	(void)thread;
	raster *r = data;
	for (int c = c0; c < c1; c++) {
		size_t *count = r->place + (size_t)c * (size_t)r->n_bands;
		const part *part = NULL;
		uint32_t from = (uint32_t)c * r->chunk, end = chunk_end(r, from);
		for (uint32_t i = from; i < end; i++) {
			int y0, y1;
			part = geometry_part(&r->geometry, part, i);
			r->range[i] = (band_range){0, 0};
			if (!rows_of(r, part, i - part->first, &y0, &y1))
				continue;
			r->range[i] = (band_range){(uint16_t)(y0 / BAND), (uint16_t)((y1 - 1) / BAND + 1)};
			for (int b = r->range[i].first; b < r->range[i].end; b++)
				count[b]++;
		}
	}
}

static void file_chunks(void *data, int c0, int c1, int thread)
{
	(void)thread;
	raster *r = data;
	for (int c = c0; c < c1; c++) {
		size_t *place = r->place + (size_t)c * (size_t)r->n_bands;
		uint32_t from = (uint32_t)c * r->chunk, end = chunk_end(r, from);
		for (uint32_t i = from; i < end; i++)
			for (int b = r->range[i].first; b < r->range[i].end; b++)
				r->entry[place[b]++] = i;
	}
}

/* Counts become places: band by band, in a band chunk by chunk. */
static void sum_places(raster *r)
{
	size_t sum = 0;
	for (int b = 0; b < r->n_bands; b++) {
		r->list[b] = sum;
		for (int c = 0; c < r->n_chunks; c++) {
			size_t *place = r->place + (size_t)c * (size_t)r->n_bands + b, count = *place;
			*place = sum;
			sum += count;
		}
	}
	r->list[r->n_bands] = sum;
}

/* ---- shading of what is in front --------------------------------------------------------------------------- */

typedef struct surface {
	const part *part;
	corner corner[3];
	float normal[3], object, material, style;
	const float *attributes; /* of the three corners; NULL = 0 */
	const float *normals;    /* likewise, in object space; NULL = flat */
	anchor_face anchor;
	float tangent[3];
	double side; /* 1: the eye sees the side of the normals, -1: the other */
} surface;

/* The object of a primitive that coincides with the one in front; 0 if it is of the same. */
static float object_beside(const raster *r, uint32_t front, uint32_t twin)
{
	float own = geometry_object(geometry_part(&r->geometry, NULL, front), front);
	float other = geometry_object(geometry_part(&r->geometry, NULL, twin), twin);
	return own != other ? other : 0;
}

static void load_surface(const raster *r, uint32_t number, surface *s)
{
	s->part = geometry_part(&r->geometry, s->part, number);
	const encre_mesh *mesh = s->part->mesh;
	uint32_t i = number - s->part->first;
	s->object = geometry_object(s->part, number);
	s->material = (float)(mesh->material ? mesh->material[i] : mesh->material_index);
	s->style = (float)(mesh->style ? mesh->style[i] : mesh->style_index);
	s->attributes = mesh->attributes && mesh->n_channels
				? mesh->attributes + (size_t)i * 3 * (size_t)mesh->n_channels
				: NULL;
	s->normals = r->job->shading.data && mesh->normals ? mesh->normals + (size_t)i * 9 : NULL;
	if (r->job->anchor.data)
		anchors_load(s->part, i, &s->anchor);
	if (r->job->tangent.data)
		anchors_tangent(s->part, i, s->tangent);
	if ((r->job->attributes.data && s->attributes) || s->normals || r->job->anchor.data)
		geometry_corners(s->part, i, s->corner);
	if (r->job->normal.data || r->job->shading.data)
		geometry_normal(&r->geometry, s->part, i, s->normal);
	if (s->normals) {
		double across[3], facing = 0;
		geometry_across(s->part, i, across);
		for (int c = 0; c < 3; c++)
			facing += across[c] * (double)s->normal[c];
		s->side = facing < 0 ? -1 : 1;
	}
}

/* From the first corner on: a constant stays what it is. */
static inline double mixed(const float *values, int stride, const double share[2])
{
	double a = (double)values[0], b = (double)values[stride], c = (double)values[2 * stride];
	return a + share[0] * (b - a) + share[1] * (c - a);
}

static void shade_normal(const surface *s, const double share[2], float *out)
{
	double normal[3] = {0};
	for (int c = 0; c < 3 && s->normals; c++)
		normal[c] = mixed(s->normals + c, 3, share);
	if (!s->normals || !geometry_turn(s->part, normal, s->side, out))
		memcpy(out, s->normal, sizeof s->normal);
}

static void shade_corners(const raster *r, const surface *s, int x, int y)
{
	double share[2] = {0};
	if (s->attributes || s->normals)
		outline_shares(s->corner, r->job->frame.x + x + 0.5, r->job->frame.y + y + 0.5, share, share + 1);
	if (r->job->shading.data)
		shade_normal(s, share, pixel_at(&r->job->shading, x, y));
	int given = s->attributes ? s->part->mesh->n_channels : 0;
	for (int c = 0; r->job->attributes.data && c < r->job->n_channels; c++)
		pixel_at(&r->job->attributes, x, y)[c] = c < given ? (float)mixed(s->attributes + c, given, share) : 0;
}

static void shade_row(const raster *r, const band *b, int row)
{
	const encre_raster_job *job = r->job;
	int y = row - r->room.y0;
	const float *depth = b->depth + (size_t)(row - b->y0) * (size_t)r->width;
	const uint32_t *front = b->front + (size_t)(row - b->y0) * (size_t)r->width;
	const uint32_t *twin = b->twin + (size_t)(row - b->y0) * (size_t)r->width;
	uint32_t number = NOTHING;
	static const surface nothing;
	surface s = nothing;
	for (int x = 0; x < r->width; x++) {
		bool any = front[x] != NOTHING;
		if (front[x] != number && any)
			load_surface(r, front[x], &s);
		number = front[x];
		if (job->depth.data)
			*pixel_at(&job->depth, x, y) = any ? depth[x] : depth_nothing;
		if (job->object.data)
			*pixel_at(&job->object, x, y) = any ? s.object : 0;
		if (job->material.data)
			*pixel_at(&job->material, x, y) = any ? s.material : 0;
		if (job->style.data)
			*pixel_at(&job->style, x, y) = any ? s.style : 0;
		if (job->normal.data)
			for (int c = 0; c < 3; c++)
				pixel_at(&job->normal, x, y)[c] = any ? s.normal[c] : 0;
		if (job->coincident.data)
			*pixel_at(&job->coincident, x, y) =
				any && twin[x] != NOTHING ? object_beside(r, front[x], twin[x]) : 0;
		if (job->attributes.data || job->shading.data)
			shade_corners(r, any ? &s : &nothing, x, y);
		if (job->anchor.data)
			anchors_draw(job, any ? &s.anchor : NULL, s.corner, x, y);
		if (job->tangent.data)
			memcpy(pixel_at(&job->tangent, x, y), any ? s.tangent : nothing.tangent, sizeof s.tangent);
		if (job->card.data)
			cards_draw(job, any ? s.part : NULL, x, y);
	}
}

/* Forgets those that coincide with what something nearer hides. */
static void clear_twins(const raster *r, const band *b)
{
	for (int row = b->y0; row < b->y1; row++)
		for (int x = 0; x < r->width; x++) {
			size_t at = (size_t)(row - b->y0) * (size_t)r->width + (size_t)x;
			if (b->twin[at] != NOTHING && !coincide(r, b->front[at], b->twin[at], b->x0 + x, row))
				b->twin[at] = NOTHING;
		}
}

static void load_beyond(const raster *r, const band *b, float *out)
{
	for (int row = b->y0; row < b->y1; row++)
		for (int x = 0; x < r->width; x++) {
			float depth = *pixel_at(&r->job->beyond, x, row - r->room.y0);
			out[(size_t)(row - b->y0) * (size_t)r->width + (size_t)x] =
				depth < depth_nothing ? depth : INFINITY;
		}
}

static void draw_bands(void *data, int b0, int b1, int thread)
{
	const raster *r = data;
	size_t size = (size_t)BAND * (size_t)r->width;
	for (int i = b0; i < b1; i++) {
		band b = {.x0 = r->room.x0,
			  .x1 = r->room.x1,
			  .y0 = r->room.y0 + i * BAND,
			  .depth = r->depth + (size_t)thread * size,
			  .front = r->front + (size_t)thread * size,
			  .twin = r->twin + (size_t)thread * size,
			  .beyond = r->beyond ? r->beyond + (size_t)thread * size : NULL,
			  .close = r->close,
			  .coincide = coincide,
			  .user = r};
		int end = r->room.y1 - b.y0 < BAND ? r->room.y1 : b.y0 + BAND;
		b.y1 = end;
		if (r->beyond)
			load_beyond(r, &b, r->beyond + (size_t)thread * size);
		for (size_t k = 0; k < size; k++) {
			b.depth[k] = INFINITY;
			b.front[k] = b.twin[k] = NOTHING;
		}
		const part *part = NULL;
		for (size_t k = r->list[i]; k < r->list[i + 1] && !bands_stopped(r->pool); k++) {
			outline o;
			part = geometry_part(&r->geometry, part, r->entry[k]);
			if (geometry_outline(part, r->entry[k] - part->first, &r->room, &o))
				outline_draw(&o, r->entry[k], &b);
		}
		clear_twins(r, &b);
		for (int row = b.y0; row < end && !bands_stopped(r->pool); row++)
			shade_row(r, &b, row);
	}
}

/* ---- the job ----------------------------------------------------------------------------------------------- */

static void plan(raster *r, int threads, arena *a)
{
	size_t band = (size_t)threads * BAND * (size_t)r->width;
	r->geometry.parts = arena_take(a, (size_t)r->job->n_meshes, sizeof *r->geometry.parts);
	r->range = arena_take(a, r->geometry.n_primitives, sizeof *r->range);
	r->place = arena_take(a, (size_t)r->n_chunks * (size_t)r->n_bands, sizeof *r->place);
	r->list = arena_take(a, (size_t)r->n_bands + 1, sizeof *r->list);
	r->spots = arena_take(a, r->geometry.n_points, sizeof *r->spots);
	r->depth = arena_take(a, band, sizeof *r->depth);
	r->beyond = r->job->beyond.data ? arena_take(a, band, sizeof *r->beyond) : NULL;
	r->front = arena_take(a, band, sizeof *r->front);
	r->twin = arena_take(a, band, sizeof *r->twin);
}

static int32_t run(bands *pool, raster *r)
{
	int32_t code;
	geometry_aim(&r->geometry);
	bands_span(pool, 0, 0.5);
	if (r->job->card.data)
		cards_stand(&r->geometry);
	if (r->job->anchor.data && (code = anchors_measure(pool, &r->geometry)))
		return code;
	if ((code = spots_find(pool, &r->geometry, &r->room, r->spots)))
		return code;
	memset(r->place, 0, (size_t)r->n_chunks * (size_t)r->n_bands * sizeof *r->place);
	if ((code = bands_run(pool, r->n_chunks, 1, count_chunks, r)))
		return code;
	sum_places(r);
	size_t n = r->list[r->n_bands];
	r->entry = n < SIZE_MAX / sizeof *r->entry ? malloc((n + 1) * sizeof *r->entry) : NULL;
	if (!r->entry)
		return ENCRE_ERROR_MEMORY;
	if ((code = bands_run(pool, r->n_chunks, 1, file_chunks, r)))
		return code;
	bands_span(pool, 0.5, 1.5); /* a run takes half of what is left */
	return bands_run(pool, r->n_bands, 1, draw_bands, r);
}

int32_t raster_run(bands *pool, const encre_raster_job *job, char *error, size_t size)
{
	const encre_image *images[] = {&job->depth,  &job->normal,     &job->object,     &job->material,
				       &job->style,  &job->attributes, &job->coincident, &job->shading,
				       &job->anchor, &job->tangent,    &job->card};
	const encre_image *image = NULL;
	for (size_t i = 0; i < sizeof images / sizeof *images; i++)
		if (images[i]->data)
			image = images[i];
	raster r = {.job = job, .pool = pool, .geometry = {.job = job}, .width = image->width, .height = image->height};
	int32_t code = geometry_check(&r.geometry, error, size);
	if (code)
		return code;
	const encre_frame *f = &job->frame;
	const double *v = job->view;
	/* what Blender, in floats, can't place more exactly this far from the origin */
	r.close = (float)fmin(0x1p-22 * sqrt(v[3] * v[3] + v[7] * v[7] + v[11] * v[11]), 1e30);
	r.room = (room){.start = job->clip_start > -FLT_MAX ? job->clip_start : -FLT_MAX, /* depths are floats */
			.end = job->clip_end > job->clip_start ? job->clip_end : INFINITY,
			.frame_width = f->width,
			.frame_height = f->height,
			.x0 = f->x + OUTLINE_GUARD,
			.y0 = f->y + OUTLINE_GUARD};
	r.room.x1 = r.room.x0 + r.width;
	r.room.y1 = r.room.y0 + r.height;
	r.n_bands = (r.height - 1) / BAND + 1;
	r.chunk = r.geometry.n_primitives / MAX_CHUNKS + 1;
	r.chunk = r.chunk > CHUNK ? r.chunk : CHUNK;
	r.n_chunks = (int)((r.geometry.n_primitives + (uint64_t)r.chunk - 1) / r.chunk);
	arena a = {0};
	plan(&r, bands_threads(pool), &a);
	void *memory = arena_make(&a);
	if (!memory)
		return ENCRE_ERROR_MEMORY;
	plan(&r, bands_threads(pool), &a);
	code = run(pool, &r);
	free(r.entry);
	free(memory);
	return code;
}
