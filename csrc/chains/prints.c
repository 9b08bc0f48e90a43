/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Curves between the colors of images, laid on all the faces that show these. */
#include "chains/sheets.h"

#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>

enum { CHUNK = 256 /* faces that a thread takes at once */, MOST_TILES = 4096 /* repeats of an image on one face */ };

typedef struct printing {
	chains *c;
	int64_t *first; /* by body, and one more: running numbers of faces */
	int8_t *inside; /* by body: 1, -1: which way round, times shape.closed, faces go of which the inside is seen */
	printed *chunks;
	atomic_bool failed;
} printing;

/* Of what is wholly before the eye nobody sees the inside. */
static double handed(const double *m)
{
	return m[0] * (m[5] * m[10] - m[6] * m[9]) - m[1] * (m[4] * m[10] - m[6] * m[8]) +
	       m[2] * (m[4] * m[9] - m[5] * m[8]);
}

static int inside_of(const chains *c, const body *b)
{
	for (int32_t i = 0; i < b->mesh->n_points; i++)
		if (!(b->spots[i].z > c->job->clip_start))
			return 0;
	double way = handed(b->mesh->model) * handed(c->job->view) * c->job->projection[0] * c->job->projection[5];
	return (way > 0) - (way < 0);
}

static bool add_line(printed *to, const line *l)
{
	line *lines = with_room(to->line, sizeof *lines, to->n, &to->room);
	if (!lines)
		return false;
	to->line = lines;
	to->line[to->n++] = *l;
	return true;
}

/* Lines of a tile, in the cells that the face's box touches; each at the first of these. */
static bool print_tile(const sheet *s, printed *to)
{
	const texel_level *l = s->l;
	int32_t low[2], high[2];
	const int32_t count[2] = {l->across, l->tall}, size[2] = {l->width, l->height};
	for (int k = 0; k < 2; k++) {
		float u = floorf(s->low[k] / TEXEL_CELL), v = floorf(s->high[k] / TEXEL_CELL);
		if (v < 0 || u > (float)count[k])
			return true;
		low[k] = u < 0 ? 0 : u < (float)count[k] ? (int32_t)u : count[k] - 1;
		high[k] = v < (float)count[k] ? (int32_t)v : count[k] - 1;
	}
	for (int32_t y = low[1]; y <= high[1]; y++)
		for (int32_t x = low[0]; x <= high[0]; x++) {
			int32_t cell = y * l->across + x, own[2] = {x, y};
			for (int32_t i = l->first[cell]; i < l->first[cell + 1]; i++) {
				const texel_line *of = l->line + l->member[i];
				double at[2][2];
				bool here = true;
				line made;
				for (int k = 0; k < 2; k++) {
					float a = l->point[of->point[0]][k] +
						  (float)(size[k] * (of->shift[0] >> k & 1)),
					      b = l->point[of->point[1]][k] +
						  (float)(size[k] * (of->shift[1] >> k & 1)),
					      least = min(a, b);
					at[0][k] = (double)a;
					at[1][k] = (double)b;
					int32_t first = clamp_index((int)floorf(least / TEXEL_CELL), count[k]);
					here &= least <= s->high[k] && max(a, b) >= s->low[k] &&
						(first < low[k] ? low[k] : first) == own[k];
				}
				if (here && sheet_line(s, l->member[i], at, &made) && !add_line(to, &made))
					return false;
			}
		}
	return true;
}

static bool print_face(const face *f, printed *to)
{
	double box[2][2], least = INFINITY, most = -INFINITY;
	for (int k = 0; k < 2; k++) {
		box[0][k] = fmin(f->uv[0][k], fmin(f->uv[1][k], f->uv[2][k]));
		box[1][k] = fmax(f->uv[0][k], fmax(f->uv[1][k], f->uv[2][k]));
		if (!(fabs(box[0][k]) < 1e5 && fabs(box[1][k]) < 1e5))
			return true;
	}
	for (int k = 0; k < 3; k++) {
		least = fmin(least, f->corner[k].w);
		most = fmax(most, f->corner[k].w);
	}
	for (int level = 0; level < f->of->n_levels; level++) {
		double low, high;
		sheet on;
		level_range(f, level, &low, &high);
		bool made = f->of->made >> level & 1;
		if ((made && !f->of->level[level].n_lines) || least > high || most < low || !sheet_make(&on, f, level))
			continue;
		if (!made) {
			atomic_fetch_or(f->c->lacking + image_of(f->c, f->b->mesh, f->number), 1u << level);
			continue;
		}
		const texel_level *l = f->of->level + level;
		double slack[2] = {2.0 / l->width, 2.0 / l->height};
		bool one = f->of->wrap == ENCRE_EXTEND || f->of->wrap == ENCRE_CLIP;
		double from[2], to_[2];
		for (int k = 0; k < 2; k++) {
			from[k] = one ? 0 : floor(box[0][k] - slack[k]);
			to_[k] = one ? 0 : floor(box[1][k] + 1e-9);
		}
		if ((to_[0] - from[0] + 1) * (to_[1] - from[1] + 1) > MOST_TILES)
			continue;
		for (int32_t y = (int32_t)from[1]; y <= (int32_t)to_[1]; y++)
			for (int32_t x = (int32_t)from[0]; x <= (int32_t)to_[0]; x++) {
				if (sheet_turn(&on, x, y) && !print_tile(&on, to))
					return false;
			}
	}
	return true;
}

/* Lines at the edges that a face has before another. */
static bool print_seams(const chains *c, int number, int inside, int32_t face, printed *to)
{
	const shape *s = c->bodies[number].shape;
	if (turned_away(c->bodies + number, inside, face))
		return true;
	for (size_t k = 0; k < 3; k++) {
		int32_t edge = s->edge_of[3 * (size_t)face + k];
		line made;
		if (edge >= 0 && s->edges[edge].face[0] == face && seam_line(c, number, edge, &made) &&
		    !add_line(to, &made))
			return false;
	}
	return true;
}

static void print_faces(void *data, int from, int end, int thread)
{
	(void)thread;
	printing *p = data;
	chains *c = p->c;
	for (int k = from; k < end && !bands_stopped(c->pool); k++) {
		int64_t at = (int64_t)k * CHUNK, stop = at + CHUNK;
		int low = 0, high = c->n_bodies;
		while (high - low > 1) {
			int middle = low + (high - low) / 2;
			if (p->first[middle] <= at)
				low = middle;
			else
				high = middle;
		}
		for (int i = low; at < stop && i < c->n_bodies; i++) {
			int inside = at < p->first[i + 1] ? p->inside[i] : 0;
			for (; at < stop && at < p->first[i + 1]; at++) {
				int32_t number = (int32_t)(at - p->first[i]);
				face f;
				if (!print_seams(c, i, inside, number, p->chunks + k) ||
				    (face_make(c, i, inside, number, &f) && !print_face(&f, p->chunks + k))) {
					atomic_store(&p->failed, true);
					return;
				}
			}
		}
	}
}

void prints_free(prints *p)
{
	for (int64_t k = 0; k < p->count; k++)
		free(p->chunk[k].line);
	free(p->chunk);
	*p = (prints){0};
}

static int32_t print_all(chains *c, printing *p, int64_t count)
{
	for (int64_t k = 0; k < count; k++)
		p->chunks[k].n = 0;
	int32_t code = bands_run(c->pool, (int)count, 1, print_faces, p);
	return !code && atomic_load(&p->failed) ? ENCRE_ERROR_MEMORY : code;
}

int32_t colors_print(chains *c, prints *out)
{
	printing p = {.c = c,
		      .first = late_take(&c->late, (size_t)c->n_bodies + 1, sizeof *p.first),
		      .inside = late_take(&c->late, (size_t)c->n_bodies + 1, 1)};
	*out = (prints){0};
	if (!p.first || !p.inside)
		return ENCRE_ERROR_MEMORY;
	if (!c->images)
		return ENCRE_OK;
	p.first[0] = 0;
	for (int i = 0; i < c->n_bodies; i++) {
		const body *b = c->bodies + i;
		bool shows = b->near && b->mesh->uv && !is_line(b->mesh);
		p.inside[i] = (int8_t)(shows && !b->mesh->open ? inside_of(c, b) : 0);
		p.first[i + 1] = p.first[i] + (shows ? b->shape->n_triangles : 0);
	}
	int64_t count = (p.first[c->n_bodies] + CHUNK - 1) / CHUNK;
	p.chunks = count < INT32_MAX ? calloc((size_t)count + 1, sizeof *p.chunks) : NULL;
	if (!p.chunks)
		return ENCRE_ERROR_MEMORY;
	*out = (prints){.chunk = p.chunks, .count = count};
	bool more = false;
	int32_t code = print_all(c, &p, count);
	if (!code)
		code = colors_fill(c, &more);
	if (!code && more)
		code = print_all(c, &p, count);
	for (int64_t k = 0; k < count; k++)
		out->n += p.chunks[k].n;
	if (code)
		prints_free(out);
	return code;
}

void prints_move(prints *p, line *to)
{
	for (int64_t k = 0; k < p->count; k++) {
		if (p->chunk[k].n)
			memcpy(to, p->chunk[k].line, (size_t)p->chunk[k].n * sizeof *to);
		to += p->chunk[k].n;
	}
	prints_free(p);
}
