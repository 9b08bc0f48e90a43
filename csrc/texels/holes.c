/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Images with alpha: what is clear shows no color of its own, so that it takes those about it, and curves end where it
 * begins. */
#include "texels/texels.h"

#include "base/pixel.h"

#include <stdlib.h>
#include <string.h>

/* Of alpha: what is less shows a color that is known too badly; from which on something is there. */
static const float least_known = 0.25f, solid = 0.5f;
static const float look_step = 0.25f;  /* texels from look to look along a line */
static const float look_aside = 0.25f; /* texels to both sides of a line between texels that are not mixed */
enum { SPREAD = 3 /* texels by which colors spread */ };

static inline int32_t index_at(int32_t i, int32_t n, bool wrap)
{
	return wrap ? wrap_index(i, n) : clamp_index(i, n);
}

static void spread(const alpha_level *a, float *linear, uint8_t *known, int round)
{
	for (int32_t y = 0; y < a->height; y++)
		for (int32_t x = 0; x < a->width; x++) {
			size_t at = (size_t)y * (size_t)a->width + (size_t)x;
			float sum[3] = {0};
			int count = 0;
			if (known[at])
				continue;
			for (int n = 0; n < 8 && !(n == 4 && count); n++) { /* aslant only where nothing else is */
				static const int order[8] = {1, 3, 5, 7, 0, 2, 6, 8};
				int k = order[n];
				int32_t u = index_at(x + k % 3 - 1, a->width, a->wrap),
					v = index_at(y + k / 3 - 1, a->height, a->wrap);
				size_t beside = (size_t)v * (size_t)a->width + (size_t)u;
				if (!known[beside] || known[beside] > round)
					continue;
				for (int i = 0; i < 3; i++)
					sum[i] += linear[3 * beside + (size_t)i];
				count++;
			}
			for (int i = 0; count && i < 3; i++)
				linear[3 * at + (size_t)i] = sum[i] / (float)count;
			known[at] = count ? (uint8_t)(round + 1) : 0;
		}
}

bool holes_fill(const alpha_level *a, float *linear)
{
	size_t n = (size_t)a->width * (size_t)a->height;
	uint8_t *known = calloc(n, 1);
	if (!known)
		return false;
	for (size_t i = 0; i < n; i++)
		known[i] = a->alpha[i] >= (a->closest ? solid : least_known);
	for (int round = 1; round <= SPREAD; round++)
		spread(a, linear, known, round);
	free(known);
	return true;
}

static float alpha_at(const alpha_level *a, float x, float y)
{
	float left = floorf(x - 0.5f), low = floorf(y - 0.5f), s = x - 0.5f - left, t = y - 0.5f - low, row[2];
	if (a->closest)
		return a->alpha[(size_t)index_at((int32_t)floorf(y), a->height, a->wrap) * (size_t)a->width +
				(size_t)index_at((int32_t)floorf(x), a->width, a->wrap)];
	for (int k = 0; k < 2; k++) {
		const float *from =
			a->alpha + (size_t)index_at((int32_t)low + k, a->height, a->wrap) * (size_t)a->width;
		row[k] = mix(from[index_at((int32_t)left, a->width, a->wrap)],
			     from[index_at((int32_t)left + 1, a->width, a->wrap)], s);
	}
	return mix(row[0], row[1], t);
}

/* How much more than needed is there at a share of a line's way. */
static float more_at(const alpha_level *a, float at[2][2], float t)
{
	float way[2] = {at[1][0] - at[0][0], at[1][1] - at[0][1]}, x = at[0][0] + t * way[0], y = at[0][1] + t * way[1];
	if (!a->closest)
		return alpha_at(a, x, y) - solid;
	float length = max(sqrtf(way[0] * way[0] + way[1] * way[1]), 1e-6f), u = look_aside * way[1] / length,
	      v = look_aside * way[0] / length;
	return min(alpha_at(a, x + u, y - v), alpha_at(a, x - u, y + v)) - solid;
}

typedef struct cutting {
	texel_level *l;
	const texel_line *from;
	float at[2][2];
	texel_line *line;
	int32_t n;
	int64_t room, room_points;
} cutting;

/* The point at a share of the line's way; -1 without memory. */
static int32_t point_at(cutting *c, float t, uint8_t *shift)
{
	if (t <= 0 || t >= 1) {
		*shift = c->from->shift[t >= 1];
		return c->from->point[t >= 1];
	}
	float (*more)[2] = with_room(c->l->point, sizeof *more, c->l->n_points, &c->room_points);
	if (!more)
		return -1;
	c->l->point = more;
	*shift = 0;
	for (int k = 0; k < 2; k++) {
		float size = (float)(k ? c->l->height : c->l->width), to = mix(c->at[0][k], c->at[1][k], t);
		if (to >= size) {
			to -= size;
			*shift |= (uint8_t)(1 << k);
		}
		more[c->l->n_points][k] = to;
	}
	return c->l->n_points++;
}

static bool add_piece(cutting *c, float from, float to)
{
	texel_line *more = with_room(c->line, sizeof *more, c->n, &c->room), made = *c->from;
	if (!more)
		return false;
	c->line = more;
	for (int e = 0; e < 2; e++) {
		made.point[e] = point_at(c, e ? to : from, made.shift + e);
		if (made.point[e] < 0)
			return false;
	}
	c->line[c->n++] = made;
	return true;
}

static bool cut_line(cutting *c, const alpha_level *a)
{
	for (int e = 0; e < 2; e++)
		for (int k = 0; k < 2; k++)
			c->at[e][k] = c->l->point[c->from->point[e]][k] +
				      (c->from->shift[e] >> k & 1 ? (float)(k ? c->l->height : c->l->width) : 0);
	float x = c->at[1][0] - c->at[0][0], y = c->at[1][1] - c->at[0][1];
	int steps = (int)(sqrtf(x * x + y * y) / look_step) + 1;
	float before = more_at(a, c->at, 0), begin = before >= 0 ? 0 : -1;
	for (int k = 1; k <= steps; k++) {
		float t = (float)k / (float)steps, here = more_at(a, c->at, t),
		      cut = t - (here - before != 0 ? here / (here - before) : 0) / (float)steps;
		if (begin >= 0 && here < 0) {
			if (cut > begin && !add_piece(c, begin, cut))
				return false;
			begin = -1;
		} else if (begin < 0 && here >= 0) {
			begin = cut;
		}
		before = here;
	}
	return begin < 0 || begin >= 1 || add_piece(c, begin, 1);
}

bool holes_cut(const alpha_level *a, texel_level *level)
{
	cutting c = {.l = level, .room_points = level->n_points};
	bool made = true;
	for (int32_t i = 0; made && i < level->n_lines; i++) {
		c.from = level->line + i;
		made = cut_line(&c, a);
	}
	free(level->line);
	level->line = c.line;
	level->n_lines = c.n;
	return made;
}
