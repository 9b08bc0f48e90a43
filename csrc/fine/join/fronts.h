/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What contours bound, as depths and numbers of objects tell. */
#ifndef ENCRE_FRONTS_H
#define ENCRE_FRONTS_H

#include "fine/near.h"

/* What a contour bounds: its number, and which way from it that lies along the axis; 0 where depths do not tell. */
typedef struct front {
	float object, other;
	int way;
} front;

static inline front front_of(const fine *n, const site *s)
{
	int x = s->found.column, y = s->found.row, dx = s->found.axis == AXIS_ROW, dy = 1 - dx;
	if (s->found.family != FAMILY_CRACK || s->found.axis > AXIS_COLUMN || !n->f->layer[ENCRE_LAYER_OBJECT].data)
		return (front){0};
	float a = depth_at(n->f, x, y), b = depth_at(n->f, x + dx, y + dy),
	      one = layer_row(n->f, ENCRE_LAYER_OBJECT, y)[x],
	      two = layer_row(n->f, ENCRE_LAYER_OBJECT, y + dy)[x + dx];
	return a < b ? (front){one, two, -1} : (front){two, one, a > b};
}

/* A contour behind which the same thing goes on. Without meshes a number may be that of many things. */
static inline bool is_fold(const fine *n, const site *s)
{
	front of = n->e->creases ? front_of(n, s) : (front){0};
	return of.way && of.object == of.other && depth_at(n->f, s->found.column, s->found.row) < INFINITY;
}

/* Where contours meet the place is as those that go through it. */
static inline bool is_meeting(const site *s)
{
	return s->found.family == FAMILY_CRACK && s->found.axis == AXIS_JUNCTION;
}

#endif
