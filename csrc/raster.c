/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The rasteriser: which surface is in front at each pixel's centre.
 *
 * Primitives are sorted into bands of rows once (counted, summed up, filed), so that every band holds its primitives in
 * the order of the job whatever the threads. A band then finds the nearest primitive of each pixel in a buffer that
 * stays in cache, and only these are shaded: attributes, normals and indices are never computed for what is hidden.
 * Primitives are transformed anew where they are needed, in double; that is cheaper than keeping them. What a
 * primitive covers is outline.c's. */
#include "raster.h"
#include "outline.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum {
	BAND = 16,           /* rows that are drawn at once */
	MAX_CHUNKS = 256,    /* of primitives, sorted in parallel */
};
static const uint32_t NOTHING = UINT32_MAX;

/* A mesh that has primitives, and its share of their running numbers. */
typedef struct part {
	const encre_mesh *mesh;
	uint32_t first;
	double screen[16]; /* object space -> corner, row by row */
} part;

typedef struct band_range {
	uint16_t first, end;
} band_range;

typedef struct raster {
	const encre_raster_job *job;
	int width, height; /* of the images */
	room room;
	double eye[4]; /* world space; [3] 0 = the direction towards an eye infinitely far */
	int n_parts, n_bands, n_chunks;
	uint32_t n_primitives, chunk; /* all of them; in a chunk */

	part *parts;
	band_range *range; /* n_primitives */
	size_t *place;     /* n_chunks x n_bands: how many, then where the next one goes */
	size_t *list;      /* n_bands + 1: where a band's primitives start */
	float *depth;      /* per thread BAND x width */
	uint32_t *front;   /* likewise: number of the nearest primitive */
	uint32_t *entry;   /* primitives by band */
} raster;

/* ---- geometry ---------------------------------------------------------------------------------------------- */

static void multiply(const double a[16], const double b[16], double out[16])
{
	for (int i = 0; i < 4; i++)
		for (int j = 0; j < 4; j++)
			out[4 * i + j] = a[4 * i] * b[j] + a[4 * i + 1] * b[4 + j] + a[4 * i + 2] * b[8 + j] + a[4 * i + 3] * b[12 + j];
}

static const float *point_of(const encre_mesh *mesh, uint32_t primitive, int k)
{
	int64_t c = 3 * (int64_t)primitive + k;
	return mesh->points + 3 * (int64_t)(mesh->corners ? mesh->corners[c] : c);
}

static inline double row_times(const double *row, const float *p)
{
	return row[0] * (double)p[0] + row[1] * (double)p[1] + row[2] * (double)p[2] + row[3];
}

static void corners_of(const part *part, uint32_t primitive, corner c[3])
{
	for (int k = 0; k < 3; k++) {
		const float *p = point_of(part->mesh, primitive, k);
		const double *m = part->screen;
		c[k] = (corner){row_times(m, p), row_times(m + 4, p), row_times(m + 8, p), row_times(m + 12, p)};
	}
}

/* False where it covers no pixel of the images. Another kind of primitive is another outline made here. */
static bool outline_of(const raster *r, const part *part, uint32_t primitive, outline *o)
{
	corner c[3];
	corners_of(part, primitive, c);
	return outline_make(&r->room, c, o);
}

/* ---- sorting into bands ------------------------------------------------------------------------------------ */

/* The part that a primitive belongs to; `last`, that of the primitive before, is most often right. */
static const part *part_of(const raster *r, const part *last, uint32_t number)
{
	if (last && number - last->first < (uint32_t)last->mesh->n_primitives)
		return last;
	int low = 0, high = r->n_parts;
	while (high - low > 1) {
		int middle = low + (high - low) / 2;
		if (r->parts[middle].first <= number)
			low = middle;
		else
			high = middle;
	}
	return r->parts + low;
}

static uint32_t chunk_end(const raster *r, uint32_t from)
{
	return r->n_primitives - from < r->chunk ? r->n_primitives : from + r->chunk;
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
			outline o;
			part = part_of(r, part, i);
			r->range[i] = (band_range){0, 0};
			if (!outline_of(r, part, i - part->first, &o))
				continue;
			int y0 = o.y0 - r->room.y0, y1 = o.y1 - r->room.y0;
			y0 = y0 > 0 ? y0 : 0;
			y1 = y1 < r->height ? y1 : r->height;
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
	float normal[3], material, style;
	const float *attributes; /* of the three corners; NULL = 0 */
} surface;

static void normal_of(const raster *r, const encre_mesh *mesh, uint32_t primitive, float normal[3])
{
	double p[3][3], n[3], to[3], facing = 0, square = 0;
	for (int k = 0; k < 3; k++)
		for (int i = 0; i < 3; i++)
			p[k][i] = row_times(mesh->model + 4 * i, point_of(mesh, primitive, k));
	for (int i = 0; i < 3; i++) {
		int a = (i + 1) % 3, b = (i + 2) % 3;
		n[i] = (p[1][a] - p[0][a]) * (p[2][b] - p[0][b]) - (p[1][b] - p[0][b]) * (p[2][a] - p[0][a]);
		to[i] = r->eye[i] - r->eye[3] * p[0][i];
		square += n[i] * n[i];
	}
	if (!(square > 0)) { /* a line that snapping made a surface: the eye sees it from the front */
		for (int i = 0; i < 3; i++)
			square += (n[i] = to[i]) * to[i];
	}
	for (int i = 0; i < 3; i++)
		facing += n[i] * to[i];
	double length = square > 0 ? sqrt(square) : 1;
	for (int i = 0; i < 3; i++)
		normal[i] = (float)(facing < 0 ? -n[i] / length : n[i] / length);
}

static void load_surface(const raster *r, uint32_t number, surface *s)
{
	s->part = part_of(r, s->part, number);
	const encre_mesh *mesh = s->part->mesh;
	uint32_t i = number - s->part->first;
	s->material = (float)(mesh->material ? mesh->material[i] : mesh->material_index);
	s->style = (float)(mesh->style ? mesh->style[i] : mesh->style_index);
	s->attributes = mesh->attributes && mesh->n_channels ? mesh->attributes + (size_t)i * 3 * (size_t)mesh->n_channels : NULL;
	if (r->job->attributes.data && s->attributes)
		corners_of(s->part, i, s->corner);
	if (r->job->normal.data)
		normal_of(r, mesh, i, s->normal);
}

static inline float *pixel_at(const encre_image *image, int x, int y)
{
	return (float *)((char *)image->data + y * image->row_stride + x * image->pixel_stride);
}

static void shade_attributes(const raster *r, const surface *s, int x, int y)
{
	float *out = pixel_at(&r->job->attributes, x, y);
	int given = s->attributes ? s->part->mesh->n_channels : 0, n = r->job->n_channels;
	double second = 0, third = 0;
	if (given)
		outline_shares(s->corner, r->job->frame.x + x + 0.5, r->job->frame.y + y + 0.5, &second, &third);
	for (int c = 0; c < n; c++) {
		out[c] = 0;
		if (c < given) { /* from the first corner on: a constant stays what it is */
			double a = (double)s->attributes[c], b = (double)s->attributes[given + c], d = (double)s->attributes[2 * given + c];
			out[c] = (float)(a + second * (b - a) + third * (d - a));
		}
	}
}

static void shade_row(const raster *r, const band *b, int row)
{
	const encre_raster_job *job = r->job;
	int y = row - r->room.y0;
	const float *depth = b->depth + (size_t)(row - b->y0) * (size_t)r->width;
	const uint32_t *front = b->front + (size_t)(row - b->y0) * (size_t)r->width;
	uint32_t number = NOTHING;
	static const surface nothing;
	surface s = nothing;
	for (int x = 0; x < r->width; x++) {
		bool any = front[x] != NOTHING;
		if (front[x] != number && any)
			load_surface(r, front[x], &s);
		number = front[x];
		if (job->depth.data)
			*pixel_at(&job->depth, x, y) = any ? depth[x] : 1e10f;
		if (job->object.data)
			*pixel_at(&job->object, x, y) = any ? (float)s.part->mesh->object_index : 0;
		if (job->material.data)
			*pixel_at(&job->material, x, y) = any ? s.material : 0;
		if (job->style.data)
			*pixel_at(&job->style, x, y) = any ? s.style : 0;
		if (job->normal.data)
			for (int c = 0; c < 3; c++)
				pixel_at(&job->normal, x, y)[c] = any ? s.normal[c] : 0;
		if (job->attributes.data)
			shade_attributes(r, any ? &s : &nothing, x, y);
	}
}

static void draw_bands(void *data, int b0, int b1, int thread)
{
	const raster *r = data;
	size_t size = (size_t)BAND * (size_t)r->width;
	for (int i = b0; i < b1; i++) {
		band b = {.x0 = r->room.x0, .x1 = r->room.x1, .y0 = r->room.y0 + i * BAND,
			  .depth = r->depth + (size_t)thread * size, .front = r->front + (size_t)thread * size};
		b.y1 = r->room.y1 - b.y0 < BAND ? r->room.y1 : b.y0 + BAND;
		for (size_t k = 0; k < size; k++) {
			b.depth[k] = INFINITY;
			b.front[k] = NOTHING;
		}
		const part *part = NULL;
		for (size_t k = r->list[i]; k < r->list[i + 1]; k++) {
			outline o;
			part = part_of(r, part, r->entry[k]);
			if (outline_of(r, part, r->entry[k] - part->first, &o))
				outline_draw(&o, r->entry[k], &b);
		}
		for (int row = b.y0; row < b.y1; row++)
			shade_row(r, &b, row);
	}
}

/* ---- the job ----------------------------------------------------------------------------------------------- */

static bool finite(const double *values, int n)
{
	for (int i = 0; i < n; i++)
		if (!isfinite(values[i]))
			return false;
	return true;
}

#if defined __GNUC__
__attribute__((format(printf, 3, 4)))
#endif
static int32_t refuse(char *error, size_t size, const char *format, ...)
{
	va_list arguments;
	va_start(arguments, format);
	vsnprintf(error, size, format, arguments);
	va_end(arguments);
	return ENCRE_ERROR_ARGUMENT;
}

static int32_t check_mesh(const encre_mesh *mesh, int number, char *error, size_t size)
{
	if (mesh->kind != ENCRE_TRIANGLES)
		return refuse(error, size, "mesh %d: kind %d is not known; give ENCRE_TRIANGLES", number, (int)mesh->kind);
	if (mesh->n_primitives < 0 || mesh->n_points < 0)
		return refuse(error, size, "mesh %d: %d primitives of %d points; give 0 or more of each", number, (int)mesh->n_primitives, (int)mesh->n_points);
	if (mesh->n_channels < 0 || mesh->n_channels > ENCRE_MAX_CHANNELS)
		return refuse(error, size, "mesh %d: has %d attribute channels; give 0 to %d", number, (int)mesh->n_channels, ENCRE_MAX_CHANNELS);
	if (mesh->n_primitives && !mesh->points)
		return refuse(error, size, "mesh %d: has %d primitives, but no points; give them", number, (int)mesh->n_primitives);
	int64_t corners = 3 * (int64_t)mesh->n_primitives;
	if (!mesh->corners && corners > mesh->n_points)
		return refuse(error, size, "mesh %d: %d primitives without corners take more points than its %d; give corners", number, (int)mesh->n_primitives, (int)mesh->n_points);
	for (int64_t i = 0; mesh->corners && i < corners; i++)
		if ((uint32_t)mesh->corners[i] >= (uint32_t)mesh->n_points)
			return refuse(error, size, "mesh %d: primitive %d has a corner at point %d of %d; give indices from 0 to the number of points less one",
				      number, (int)(i / 3), (int)mesh->corners[i], (int)mesh->n_points);
	return ENCRE_OK;
}

static int32_t check(raster *r, char *error, size_t size)
{
	const encre_raster_job *job = r->job;
	const encre_frame *f = &job->frame;
	const int most = OUTLINE_FRAME;
	if (f->width < 1 || f->height < 1 || f->width > most || f->height > most)
		return refuse(error, size, "frame: is %d x %d pixels; give 1 to %d each way", (int)f->width, (int)f->height, most);
	if (f->x < 0 || f->y < 0 || f->x > f->width - r->width || f->y > f->height - r->height)
		return refuse(error, size, "frame: %d x %d pixels at %d, %d do not lie in a frame of %d x %d; give the full frame and the place of the images in it",
			      r->width, r->height, (int)f->x, (int)f->y, (int)f->width, (int)f->height);
	if (!finite(job->view, 16) || !finite(job->projection, 16) || !finite(&job->clip_start, 1) || isnan(job->clip_end))
		return refuse(error, size, "camera: a matrix or clip distance is not a finite number; give the camera another place or lens");
	if (job->n_meshes < 0 || (job->n_meshes && !job->meshes))
		return refuse(error, size, "meshes: %d of them are not there; give their number and where they lie", (int)job->n_meshes);
	int64_t n = 0;
	for (int i = 0; i < job->n_meshes; i++) {
		int32_t code = check_mesh(job->meshes + i, i, error, size);
		if (code)
			return code;
		n += job->meshes[i].n_primitives;
	}
	if (n >= NOTHING)
		return refuse(error, size, "meshes: have more than %lld primitives; draw them in several jobs", (long long)NOTHING - 1);
	r->n_primitives = (uint32_t)n;
	return ENCRE_OK;
}

/* Rows of matrices that take object space to the screen, and the eye. */
static void aim(raster *r)
{
	const encre_raster_job *job = r->job;
	const double *v = job->view, *p = job->projection;
	double camera[16];
	for (int k = 0; k < 4; k++) { /* clip space -> pixels: row 0 is the top */
		camera[k] = 0.5 * job->frame.width * (p[12 + k] + p[k]);
		camera[4 + k] = 0.5 * job->frame.height * (p[12 + k] - p[4 + k]);
		camera[8 + k] = p[12 + k];
		camera[12 + k] = k == 2 ? -1 : 0;
	}
	uint32_t first = 0;
	for (int i = 0; i < job->n_meshes; i++) {
		const encre_mesh *mesh = job->meshes + i;
		if (!mesh->n_primitives)
			continue;
		part *part = r->parts + r->n_parts++;
		double view[16];
		multiply(v, mesh->model, view);
		multiply(camera, view, part->screen);
		part->mesh = mesh;
		part->first = first;
		first += (uint32_t)mesh->n_primitives;
	}
	bool perspective = p[14] != 0;
	for (int i = 0; i < 3; i++)
		r->eye[i] = perspective ? -(v[i] * v[3] + v[4 + i] * v[7] + v[8 + i] * v[11]) : v[8 + i];
	r->eye[3] = perspective;
}

static void plan(raster *r, int threads, arena *a)
{
	size_t band = (size_t)threads * BAND * (size_t)r->width;
	r->parts = arena_take(a, (size_t)r->job->n_meshes, sizeof *r->parts);
	r->range = arena_take(a, r->n_primitives, sizeof *r->range);
	r->place = arena_take(a, (size_t)r->n_chunks * (size_t)r->n_bands, sizeof *r->place);
	r->list = arena_take(a, (size_t)r->n_bands + 1, sizeof *r->list);
	r->depth = arena_take(a, band, sizeof *r->depth);
	r->front = arena_take(a, band, sizeof *r->front);
}

static int32_t run(rows *pool, raster *r)
{
	int32_t code;
	aim(r);
	memset(r->place, 0, (size_t)r->n_chunks * (size_t)r->n_bands * sizeof *r->place);
	if ((code = rows_run(pool, r->n_chunks, 1, count_chunks, r)))
		return code;
	sum_places(r);
	size_t n = r->list[r->n_bands];
	r->entry = n < SIZE_MAX / sizeof *r->entry ? malloc((n + 1) * sizeof *r->entry) : NULL;
	if (!r->entry)
		return ENCRE_ERROR_MEMORY;
	if ((code = rows_run(pool, r->n_chunks, 1, file_chunks, r)))
		return code;
	rows_span(pool, 0.75, 1.25); /* a run takes half of what is left: so far a half and a quarter, now all the rest */
	return rows_run(pool, r->n_bands, 1, draw_bands, r);
}

int32_t raster_run(rows *pool, const encre_raster_job *job, char *error, size_t size)
{
	const encre_image *images[] = {&job->depth, &job->normal, &job->object, &job->material, &job->style, &job->attributes};
	const encre_image *image = NULL;
	for (int i = 0; i < 6; i++)
		if (images[i]->data)
			image = images[i];
	raster r = {.job = job, .width = image->width, .height = image->height};
	int32_t code = check(&r, error, size);
	if (code)
		return code;
	const encre_frame *f = &job->frame;
	r.room = (room){.start = job->clip_start, .end = job->clip_end > job->clip_start ? job->clip_end : INFINITY,
			.frame_width = f->width, .frame_height = f->height, .x0 = f->x + OUTLINE_GUARD, .y0 = f->y + OUTLINE_GUARD};
	r.room.x1 = r.room.x0 + r.width;
	r.room.y1 = r.room.y0 + r.height;
	r.n_bands = (r.height - 1) / BAND + 1;
	r.chunk = r.n_primitives / MAX_CHUNKS + 1 > 1024 ? r.n_primitives / MAX_CHUNKS + 1 : 1024;
	r.n_chunks = (int)((r.n_primitives + (uint64_t)r.chunk - 1) / r.chunk);
	arena a = {0};
	plan(&r, rows_threads(pool), &a);
	a = (arena){.base = malloc(a.used)};
	if (!a.base)
		return ENCRE_ERROR_MEMORY;
	plan(&r, rows_threads(pool), &a);
	code = run(pool, &r);
	free(r.entry);
	free(a.base);
	return code;
}
