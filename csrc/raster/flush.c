/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Pieces of a mesh that end flush with each other. What an edge's own triangles do is not seen where one of them lies
 * inside of another piece: of two boxes of one mesh that touch, or overlap in a plane, only one flat face is seen. So
 * what is in front just to the left and right of the edge is looked up among all triangles of the mesh. */
#include "raster/flush.h"

#include "raster/contours.h"

#include <math.h>
#include <stdlib.h>

static const double aside = 1.0 / 256; /* pixels: more than rounding moves points by, a step of the sub-pixel grid */

static int higher(const void *a, const void *b)
{
	const beside *one = a, *other = b;
	if (one->y != other->y)
		return one->y < other->y ? -1 : 1;
	return one->way < other->way ? -1 : one->way > other->way;
}

/* The first place that is not above this row. */
static uint32_t first_at(const beside *look, uint32_t n, double y)
{
	uint32_t low = 0;
	while (n > 0) {
		uint32_t half = n / 2;
		bool above = look[low + half].y < y;
		low += above ? half + 1 : 0;
		n = above ? n - half - 1 : half;
	}
	return low;
}

/* The places to the right and to the left of an edge. */
static void place_looks(const raster *r, const flush_way *way, uint32_t number, beside look[2])
{
	const part *part = geometry_part(&r->geometry, NULL, way->number);
	corner c[3];
	geometry_corners(part, way->number - part->first, c);
	const corner *a = c + way->k, *b = c + (way->k + 1) % 3;
	double x = way->at.x + 0.5, y = way->at.y + 0.5; /* also where one end is behind the eye */
	double across[2] = {a->y * b->w - b->y * a->w, b->x * a->w - a->x * b->w};
	double length = sqrt(across[0] * across[0] + across[1] * across[1]), step = length > 0 ? aside / length : 0;
	for (int side = 0; side < 2; side++) {
		double by = side ? -step : step;
		look[side] = (beside){x + by * across[0], y + by * across[1], INFINITY, 2 * number + (uint32_t)side,
				      NOTHING};
	}
}

static void look_at(const raster *r, const corner c[3], uint32_t number, beside *look)
{
	corner at = {.x = look->x, .y = look->y, .w = 1};
	double share[3], sum = 0, z = 0, turn = outline_turn(c, c + 1, c + 2);
	for (int k = 0; k < 3; k++) {
		share[k] = outline_turn(c + (k + 1) % 3, c + (k + 2) % 3, &at) * turn;
		if (!(share[k] >= 0))
			return;
		sum += share[k];
		z += share[k] * c[k].z;
	}
	z /= sum;
	if (z >= r->room.start && z < look->z) {
		look->z = z;
		look->number = number;
	}
}

static void draw_beside(const raster *r, const part *part, uint32_t number, beside *look, uint32_t n,
			const flush_way *way)
{
	corner c[3];
	geometry_corners(part, number - part->first, c);
	double x[2] = {INFINITY, -INFINITY}, y[2] = {INFINITY, -INFINITY};
	for (int k = 0; k < 3; k++) {
		bool seen = c[k].w > 0;
		x[0] = seen ? fmin(x[0], c[k].x / c[k].w) : -INFINITY;
		x[1] = seen ? fmax(x[1], c[k].x / c[k].w) : INFINITY;
		y[0] = seen ? fmin(y[0], c[k].y / c[k].w) : -INFINITY;
		y[1] = seen ? fmax(y[1], c[k].y / c[k].w) : INFINITY;
	}
	for (uint32_t k = first_at(look, n, y[0]); k < n && look[k].y <= y[1]; k++)
		if (look[k].x >= x[0] && look[k].x <= x[1] &&
		    way[look[k].way / 2].number - part->first < (uint32_t)part->mesh->n_primitives)
			look_at(r, c, number, look + k);
}

void flush_look(const raster *r, int i, flush *f)
{
	for (uint32_t k = 0; k < f->n; k++)
		place_looks(r, f->way + k, k, f->look + 2 * k);
	qsort(f->look, 2 * (size_t)f->n, sizeof *f->look, higher);
	const part *part = NULL;
	for (size_t k = r->list[i]; f->n && k < r->list[i + 1]; k++) {
		part = geometry_part(&r->geometry, part, r->entry[k]);
		if (part->mesh->kind == ENCRE_TRIANGLES)
			draw_beside(r, part, r->entry[k], f->look, 2 * f->n, f->way);
	}
	for (uint32_t k = 0; k < 2 * f->n; k++)
		f->way[f->look[k].way / 2].side[f->look[k].way % 2] = f->look[k].number;
}

/* How far a triangle's surface lies before an edge beside it: 0 where it goes through the edge. */
static double before(const raster *r, const crossing *at, uint32_t number)
{
	if (number == NOTHING)
		return -INFINITY;
	const part *part = geometry_part(&r->geometry, NULL, number);
	corner c[3];
	double step;
	geometry_corners(part, number - part->first, c);
	double z = outline_depth(c, at->x + 0.5, at->y + 0.5, &step);
	double slack = 2 * (aside * step + (double)r->close + fabs(z) * 0x1p-20);
	return fabs(at->z - z) <= slack ? 0 : at->z - z;
}

enum flush_seen flush_seen(const raster *r, const flush_way *way, uint16_t *bend)
{
	double right = before(r, &way->at, way->side[0]), left = before(r, &way->at, way->side[1]);
	if (right > 0 && left > 0)
		return FLUSH_COVERED;
	if (right != 0 || left != 0)
		return FLUSH_NOT;
	*bend = contours_bend_seen(&r->geometry, way->side[0], way->side[1]);
	return FLUSH_GOES_ON;
}
