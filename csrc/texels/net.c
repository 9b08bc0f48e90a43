/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Joins crossings. Each square between four texel centers joins those on its sides: two are a part of a curve, more
 * meet in its middle. One alone goes on into the next square that has one alone, where colors change along the curve
 * too little to be seen by themselves. */
#include "texels/texels.h"

#include <stdlib.h>
#include <string.h>

enum side { SIDE_DOWN, SIDE_UP, SIDE_LEFT, SIDE_RIGHT };

/* ---- squares --------------------------------------------------------------------------------------------- */

/* The crossing on a side of the square above and right of a texel, and where in the image that is repeated; -1. */
static int32_t side_at(const crossings *c, int32_t x, int32_t y, int side, uint8_t *shift)
{
	int32_t u = x + (side == SIDE_RIGHT), v = y + (side == SIDE_UP);
	*shift = 0;
	if (u == c->width) {
		u = 0;
		*shift |= 1;
	}
	if (v == c->height) {
		v = 0;
		*shift |= 2;
	}
	return (side < SIDE_LEFT ? c->right : c->up)[(size_t)v * (size_t)c->width + (size_t)u];
}

static int sides_with(const crossings *c, int32_t x, int32_t y, int *which)
{
	int n = 0;
	uint8_t shift;
	for (int side = 0; side < 4; side++)
		if (side_at(c, x, y, side, &shift) >= 0) {
			n++;
			*which = side;
		}
	return n;
}

/* Squares of an image that does not repeat end at its outermost texels. */
static bool wrapped(const crossings *c, int32_t *x, int32_t *y)
{
	if (c->wrap_x)
		*x = wrap_index(*x, c->width);
	if (c->wrap_y)
		*y = wrap_index(*y, c->height);
	return *x >= 0 && *y >= 0 && *x < c->width - !c->wrap_x && *y < c->height - !c->wrap_y;
}

int color_apart(int32_t a, int32_t b)
{
	int sum = 0;
	for (int k = 0; k < 24; k += 8) {
		int d = (a >> k & 255) - (b >> k & 255);
		sum += d < 0 ? -d : d;
	}
	return sum;
}

/* The color left of a way that enters a square by a side, and right of it. */
static void colors_in(const crossing *at, int side, int32_t color[2])
{
	int left = side == SIDE_UP || side == SIDE_LEFT;
	color[0] = at->color[left];
	color[1] = at->color[!left];
}

/* Adds a crossing to a side that has none: between two squares that have one each, of the same colors. */
static bool bridge(crossings *c, int32_t x, int32_t y)
{
	static const int across[4] = {SIDE_UP, SIDE_DOWN, SIDE_RIGHT, SIDE_LEFT};
	int own, its, best = -1, least = 120;
	uint8_t shift;
	if (sides_with(c, x, y, &own) != 1)
		return true;
	int32_t mine[2], other[2];
	const crossing *from = c->at + side_at(c, x, y, own, &shift);
	colors_in(from, own, mine);
	for (int side = 0; side < 4; side++) {
		int32_t u = x + (side == SIDE_RIGHT) - (side == SIDE_LEFT),
			v = y + (side == SIDE_UP) - (side == SIDE_DOWN);
		if (side == own || !wrapped(c, &u, &v) || sides_with(c, u, v, &its) != 1 || its == across[side])
			continue;
		/* there it is left: what is left is right of a way in */
		colors_in(c->at + side_at(c, u, v, its, &shift), its, other);
		int apart = color_apart(mine[0], other[1]) + color_apart(mine[1], other[0]);
		if (apart < least) {
			least = apart;
			best = side;
		}
	}
	if (best < 0)
		return true;
	crossing *more = with_room(c->at, sizeof *more, c->count, &c->room);
	if (!more)
		return false;
	c->at = more;
	from = c->at + side_at(c, x, y, own, &shift);
	int32_t u = x + (best == SIDE_RIGHT), v = y + (best == SIDE_UP);
	bool level = best < SIDE_LEFT; /* between two texels side by side */
	crossing made = {
		.x = (float)u + (level ? 1 : 0.5f), .y = (float)v + (level ? 0.5f : 1), .contrast = from->contrast};
	if (u == c->width) {
		u = 0;
		made.x -= (float)c->width;
	}
	if (v == c->height) {
		v = 0;
		made.y -= (float)c->height;
	}
	int left = best == SIDE_UP || best == SIDE_LEFT; /* of a way in; this one goes out */
	made.color[left] = mine[1];
	made.color[!left] = mine[0];
	(level ? c->right : c->up)[(size_t)v * (size_t)c->width + (size_t)u] = (int32_t)c->count;
	c->at[c->count++] = made;
	return true;
}

static int32_t add_point(net *n, float x, float y)
{
	float (*more)[2] = with_room(n->point, sizeof *more, n->n_points, &n->room_points);
	if (!more) {
		n->failed = true;
		return 0;
	}
	n->point = more;
	n->point[n->n_points][0] = x;
	n->point[n->n_points][1] = y;
	return n->n_points++;
}

static void add_part(net *n, int32_t a, uint8_t a_shift, int32_t b, uint8_t b_shift, const int32_t color[2])
{
	curve_part *more = with_room(n->part, sizeof *more, n->n_parts, &n->room_parts);
	if (!more) {
		n->failed = true;
		return;
	}
	n->part = more;
	n->part[n->n_parts++] = (curve_part){{a, b}, {a_shift, b_shift}, {color[0], color[1]}};
}

static void join_square(net *n, int32_t x, int32_t y)
{
	const crossings *c = n->c;
	int32_t at[4], color[2];
	uint8_t shift[4];
	int side[4], count = 0;
	float sum[2] = {0};
	for (int k = 0; k < 4; k++) {
		at[count] = side_at(c, x, y, k, shift + count);
		if (at[count] < 0)
			continue;
		sum[0] += c->at[at[count]].x + (shift[count] & 1 ? (float)c->width : 0);
		sum[1] += c->at[at[count]].y + (shift[count] & 2 ? (float)c->height : 0);
		side[count++] = k;
	}
	if (count < 2)
		return;
	bool straight = count == 2 && (side[0] ^ side[1]) == 1;
	if (count == 2 && (!c->closest || straight)) {
		colors_in(c->at + at[0], side[0], color);
		add_part(n, at[0], shift[0], at[1], shift[1], color);
		return;
	}
	int32_t middle = c->closest ? add_point(n, (float)x + 1, (float)y + 1)
				    : add_point(n, sum[0] / (float)count, sum[1] / (float)count);
	for (int k = 0; k < count; k++) {
		colors_in(c->at + at[k], side[k], color);
		add_part(n, at[k], shift[k], middle, 0, color);
	}
}

/* At the sides of an image that does not repeat curves go on to where it ends. */
static void join_border(net *n, int32_t x, int32_t y)
{
	const crossings *c = n->c;
	size_t own = (size_t)y * (size_t)c->width + (size_t)x;
	int32_t up = c->up[own], right = c->right[own], color[2];
	if (!c->wrap_x && up >= 0 && (x == 0 || x == c->width - 1)) {
		colors_in(c->at + up, x ? SIDE_LEFT : SIDE_RIGHT, color);
		add_part(n, up, 0, add_point(n, x ? (float)c->width : 0, c->at[up].y), 0, color);
	}
	if (!c->wrap_y && right >= 0 && (y == 0 || y == c->height - 1)) {
		colors_in(c->at + right, y ? SIDE_DOWN : SIDE_UP, color);
		add_part(n, right, 0, add_point(n, c->at[right].x, y ? (float)c->height : 0), 0, color);
	}
}

bool net_join(net *n, crossings *c)
{
	*n = (net){.c = c};
	int32_t wide = c->width - !c->wrap_x, tall = c->height - !c->wrap_y;
	for (int32_t y = 0; y < tall && !c->closest; y++)
		for (int32_t x = 0; x < wide; x++)
			if (!bridge(c, x, y))
				return false;
	n->point = malloc(((size_t)c->count + 1) * sizeof *n->point);
	if (!n->point)
		return false;
	n->room_points = c->count;
	n->n_points = (int32_t)c->count;
	for (int64_t i = 0; i < c->count; i++) {
		n->point[i][0] = c->at[i].x;
		n->point[i][1] = c->at[i].y;
	}
	for (int32_t y = 0; y < tall && !n->failed; y++)
		for (int32_t x = 0; x < wide && !n->failed; x++)
			join_square(n, x, y);
	for (int32_t y = 0; y < c->height && !n->failed; y++)
		for (int32_t x = 0; x < c->width && !n->failed; x++)
			join_border(n, x, y);
	if (n->failed)
		return false;
	n->of = malloc(((size_t)n->n_points + 1) * sizeof *n->of);
	if (!n->of)
		return false;
	memset(n->of, 0xff, (size_t)n->n_points * sizeof *n->of);
	for (int64_t i = 0; i < n->n_parts; i++)
		for (int e = 0; e < 2; e++) {
			int32_t *of = n->of[n->part[i].end[e]];
			for (int k = 0; k < 4; k++)
				if (of[k] < 0) {
					of[k] = (int32_t)i;
					break;
				}
		}
	return true;
}
