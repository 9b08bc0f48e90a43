/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Creases that the meshes tell: the layer says exactly where each edge passes between two pixels and how much it bends
 * there, so that nothing is guessed from averaged normals. What bends as much as asked is a line, from end to end where
 * it is seen; just above that it is thinner, because what bends more and more would pop. What bends over several faces
 * bends less and less as they spread on the screen: that takes longer. */
#include "fine/near.h"

/* Degrees over which a line gets its full width, and the share of that where it begins: of an edge, of a bend over
 * several faces. */
static const float ease[2] = {4, 20}, least_width[2] = {0.4f, 0.2f};

/* An edge of a form that is shaded smoothly bends more here and less there: it goes on beside what is a line by itself
 * down to this share of the angle. */
static const float least_smooth = 5 / 6.0f;

/* Pieces that pass through each other bend by so many degrees. */
static const float through = 180;

typedef struct passing {
	float place, bend;
	bool spread; /* over several faces */
} passing;

static passing passing_at(const fine *n, int x, int y, int axis)
{
	plane creases = n->f->layer[ENCRE_LAYER_CREASES];
	const float *at = creases.data + y * creases.row + (ptrdiff_t)5 * x + 2 * axis;
	bool spread = fabsf(at[1]) > crease_spread;
	return (passing){clamp01(at[0]),
			 !spread     ? at[1]
			 : at[1] < 0 ? at[1] + crease_spread
				     : at[1] - crease_spread,
			 spread};
}

static float faces_at(const fine *n, int x, int y)
{
	plane creases = n->f->layer[ENCRE_LAYER_CREASES];
	return creases.data[y * creases.row + (ptrdiff_t)5 * x + 4];
}

float ISA(crease_weight)(const fine *n, int x, int y, int style)
{
	return faces_at(n, x, y) < 0 ? n->e->weight[SOURCE_NORMAL][style] : n->e->bump[style];
}

bool ISA(crease_asked)(const fine *n, int y)
{
	for (int x = 0; x < n->f->width; x++)
		if (!(faces_at(n, x, y) >= 0))
			return true;
	return false;
}

/* By how many degrees an edge bends more than it must; negative: it is no line by itself. */
static float more_than_asked(const encre_params *p, float bend)
{
	return bend < 0 ? -bend - p->crease_smooth : bend - p->crease_angle;
}

static bool goes_on(const encre_params *p, const passing *s)
{
	return !s->spread && -s->bend >= least_smooth * p->crease_smooth;
}

bool ISA(crease_site)(const fine *n, const found *at, placed *s)
{
	passing here = passing_at(n, at->column, at->row, at->axis);
	crack_place(at, here.place, s);
	s->strength = 0;
	int style = fine_style(n, at, s);
	const encre_params *p = n->f->params + style;
	float more = more_than_asked(p, here.bend);
	s->weak = more < 0;
	if (s->weak && !goes_on(p, &here))
		return false;
	s->eased = (uint8_t)(255 * (1 - least_width[here.spread]) * (1 - clamp01(more / ease[here.spread])) + 0.5f);
	return ISA(fine_weigh)(n, s, style, SOURCE_NORMAL, 1);
}

/* Whether a line by itself passes a way between two pixels. */
static bool passes(const fine *n, int x, int y, int axis)
{
	placed s;
	found at = {(uint16_t)x, (uint16_t)y, FAMILY_CREASE, (uint8_t)axis};
	return x >= 0 && y >= 0 && x + !axis < n->f->width && y + axis < n->f->height &&
	       passing_at(n, x, y, axis).place > 0 && ISA(crease_site)(n, &at, &s) && !s.weak;
}

bool ISA(crease_beside)(const fine *n, const found *at)
{
	int x = at->column, y = at->row, axis = at->axis, dx = axis == AXIS_ROW, dy = !dx;
	if (!n->e->creases || !n->e->on[SOURCE_NORMAL])
		return false;
	for (int k = -1; k <= 1; k++)
		if (passes(n, x + k * dx, y + k * dy, axis))
			return true;
	for (int k = 0; k < 4; k++) /* across, from both pixels to both sides */
		if (passes(n, x + (k & 1) * dx - (k >> 1) * dy, y + (k & 1) * dy - (k >> 1) * dx, !axis))
			return true;
	return false;
}

bool ISA(crease_through)(const frame *f, const found *at)
{
	const float *row = layer_row(f, ENCRE_LAYER_CREASES, at->row);
	if (!row || at->axis > AXIS_COLUMN)
		return false;
	const float *way = row + (ptrdiff_t)5 * at->column + 2 * (at->axis == AXIS_COLUMN);
	float bend = fabsf(way[1]);
	return way[0] != 0 && (bend == through || bend == through + crease_spread);
}

bool ISA(crease_flat)(const fine *n, int x, int y, int axis)
{
	passing at = passing_at(n, x, y, axis);
	return x + !axis < n->f->width && y + axis < n->f->height && at.place > 0 && at.bend > 0;
}

/* Two lines pass a pixel on both sides, closer than they can be told apart: that which bends less gives way, but not
 * where they are one that turns about the pixel. */
static bool gives_way(const fine *n, int x, int y, int axis)
{
	int dx = axis == AXIS_ROW, dy = !dx;
	float own = fabsf(passing_at(n, x, y, axis).bend);
	for (int side = -1; side <= 1; side += 2) {
		int ox = x + side * dx, oy = y + side * dy; /* the way on the other side of the pixel between */
		int px = side > 0 ? ox : x, py = side > 0 ? oy : y;
		if (ox < 0 || oy < 0 || ox >= n->f->width - dx || oy >= n->f->height - dy)
			continue;
		passing other = passing_at(n, ox, oy, axis);
		if (!(other.place > 0) || fabsf(other.bend) < own || (fabsf(other.bend) == own && side > 0))
			continue;
		int bx = px - dy, by = py - dx; /* across: the ways to the pixel's neighbours on the other axis */
		bool turns =
			(px < n->f->width - dy && py < n->f->height - dx && passing_at(n, px, py, !axis).place > 0) ||
			(bx >= 0 && by >= 0 && passing_at(n, bx, by, !axis).place > 0);
		if (!turns)
			return true;
	}
	return false;
}

void ISA(crease_row)(const fine *n, int y)
{
	int width = n->f->width;
	if (!n->e->creases || !n->e->on[SOURCE_NORMAL])
		return;
	const float *row = n->f->layer[ENCRE_LAYER_CREASES].data + y * n->f->layer[ENCRE_LAYER_CREASES].row;
	for (int x = 0; x < width; x++)
		for (int axis = 0; axis < 2; axis++) {
			found at = {(uint16_t)x, (uint16_t)y, FAMILY_CREASE, (uint8_t)axis};
			placed s = {0};
			bool inside = axis ? y + 1 < n->f->height : x + 1 < width;
			if (inside && row[5 * (ptrdiff_t)x + 2 * axis] > 0 && !gives_way(n, x, y, axis) &&
			    ISA(crease_site)(n, &at, &s))
				n->crack[(ptrdiff_t)y * width + x] |= (uint8_t)mark_of(FAMILY_CREASE, axis);
		}
}
