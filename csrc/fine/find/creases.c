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

static const float before_next = 0.998f;

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

/* Of a way of a lane, which is a row (AXIS_ROW) or a column. */
static passing passing_along(const fine *n, int lane, int at, int axis)
{
	int x = axis == AXIS_ROW ? at : lane, y = axis == AXIS_ROW ? lane : at;
	if (x < 0 || y < 0 || x + (axis == AXIS_ROW) >= n->f->width || y + (axis != AXIS_ROW) >= n->f->height)
		return (passing){0};
	passing p = passing_at(n, x, y, axis);
	p.place = min(p.place, before_next);
	return p;
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
	return bend < 0 ? -bend - p->crease_angle_smooth : bend - p->crease_angle;
}

static bool goes_on(const encre_params *p, const passing *s)
{
	return !s->spread && -s->bend >= least_smooth * p->crease_angle_smooth;
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

bool ISA(crease_between)(const fine *n, const found *at)
{
	int lane = at->axis == AXIS_ROW ? at->row : at->column, way = at->axis == AXIS_ROW ? at->column : at->row;
	for (int k = way - 1; n->e->creases && k <= way + 1; k++)
		if (passing_along(n, lane, k, at->axis).place > 0)
			return true;
	return false;
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

bool ISA(crease_angle_smooth)(const fine *n, const found *at)
{
	if (!n->e->creases || at->family != FAMILY_CREASE)
		return false;
	bool any = false;
	for (int axis = 0; axis < 2; axis++)
		for (int k = 0; k < 2; k++) {
			int x = at->column + k * axis, y = at->row + k * !axis;
			if ((at->axis <= AXIS_COLUMN && (axis != at->axis || k)) || x + !axis >= n->f->width ||
			    y + axis >= n->f->height)
				continue;
			passing way = passing_at(n, x, y, axis);
			if (way.place > 0 && way.bend > 0)
				return false;
			any |= way.place > 0;
		}
	return any;
}

enum { beyond = 2 }; /* pixels farther on each way than those of a bend: there normals tell which way it goes */

bool ISA(crease_hollow)(const fine *n, int x, int y, int axis)
{
	if (!(passing_at(n, x, y, axis).bend < 0))
		return false;
	int dx = axis == AXIS_ROW, dy = !dx, width = n->f->width, height = n->f->height;
	const float *one = layer_row(n->f, ENCRE_LAYER_NORMAL, clamp_index(y - beyond * dy, height)) +
			   (ptrdiff_t)3 * clamp_index(x - beyond * dx, width);
	const float *two = layer_row(n->f, ENCRE_LAYER_NORMAL, clamp_index(y + (beyond + 1) * dy, height)) +
			   (ptrdiff_t)3 * clamp_index(x + (beyond + 1) * dx, width);
	const float *way = n->f->camera.view + (dx ? 0 : 3); /* right, or up */
	float turns = 0;
	for (int c = 0; c < 3; c++)
		turns += way[c] * (bounded(two[c]) - bounded(one[c]));
	return dx ? turns < 0 : turns > 0;
}

/* Parallel lines closer than this cannot be told apart, and would knot: that which bends less gives way. Lines that
 * meet in a corner are not parallel, and go on into it. */
static const float too_close = 2;            /* pixels, across */
static const float parallel = 0.5f;          /* pixels from lane to lane by which their places may part */
static const float same = 0.25f;             /* pixels along a lane, below which two are drawn at one place */
static const float aside = 1.05f;            /* pixels by which a line may lie aside in the next lane, */
static const float alike[2] = {0.99f, 0.8f}; /* share of what it bends that it bends there: an edge, what is spread; */
static const float unlike = 4;               /* and pixels that all of it counts as */
static const float replaced = 3.5f;          /* pixels from an edge where a bend has the place of another one */
enum { along = 12 };                         /* lanes to each side, where that may be seen */
static const float nowhere = -9;

/* Where a line passes a lane that passes the next one at `place`; `nowhere`: it does not. */
static float same_line(const fine *n, int lane, int axis, float place, const passing *own)
{
	float best = nowhere, least = INFINITY;
	for (int at = (int)(place - aside); (float)at <= place + aside; at++) {
		passing p = passing_along(n, lane, at, axis);
		float one = fabsf(p.bend), two = fabsf(own->bend), off = fabsf((float)at + p.place - place),
		      like = min(one, two) / max(one, two), far = off + unlike * (1 - like);
		if (!(p.place > 0) || p.spread != own->spread ||
		    !(off <= aside && like >= alike[own->spread] && far < least))
			continue;
		least = far;
		best = (float)at + p.place;
	}
	return best;
}

/* By how many pixels a line goes aside from lane to lane; `nowhere`: it lies along the lane, if it is a line at all. */
static float slope_of(const fine *n, int lane, int axis, float place, const passing *own)
{
	float before = same_line(n, lane - 1, axis, place, own), after = same_line(n, lane + 1, axis, place, own);
	if (before < -1 && after < -1)
		return nowhere;
	return before < -1 ? after - place : after < -1 ? place - before : 0.5f * (after - before);
}

/* Whether in a lane that the line crosses a parallel one is too close that bends more; of such as bend alike the left
 * one has to yield, whichever lanes they cross. */
static bool yields(const fine *n, int lane, int axis, int at, bool to_edges)
{
	passing own = passing_along(n, lane, at, axis);
	float place = (float)at + own.place, slope = slope_of(n, lane, axis, place, &own);
	if (slope == nowhere)
		return false;
	float reach = too_close * sqrtf(1 + slope * slope); /* along the lane */
	for (int k = (int)(place - reach); (float)k <= place + reach; k++) {
		passing other = passing_along(n, lane, k, axis);
		float there = (float)k + other.place, away = fabsf(there - place);
		if (k == at || !(other.place > 0) || (to_edges && other.spread) || away >= reach || away < same ||
		    fabsf(other.bend) < fabsf(own.bend))
			continue;
		float its = slope_of(n, lane, axis, there, &other);
		bool level = axis != AXIS_ROW && its + slope > 0; /* of a column the left one is the lower one */
		if (fabsf(other.bend) == fabsf(own.bend) && (k < at) != level)
			continue;
		if (its != nowhere && fabsf(its - slope) <= parallel &&
		    passes(n, axis == AXIS_ROW ? k : lane, axis == AXIS_ROW ? lane : k, axis))
			return true;
	}
	return false;
}

/* Whether the line of a bend over several faces passes close by, which may have the place of an edge. */
static bool bend_near(const fine *n, int lane, int axis, float place)
{
	for (int at = (int)(place - replaced); (float)at <= place + replaced; at++) {
		passing p = passing_along(n, lane, at, axis);
		if (p.place > 0 && p.spread && fabsf((float)at + p.place - place) < replaced)
			return true;
	}
	return false;
}

/* Where a bend over several faces has the place of an edge, what yields to that edge elsewhere does so here. */
static bool yields_along(const fine *n, int lane, int axis, float place, const passing *own)
{
	if (yields(n, lane, axis, (int)place, false))
		return true;
	bool any = !own->spread && bend_near(n, lane, axis, place);
	for (int way = -1; any && way <= 1; way += 2) {
		float at = place;
		for (int k = 1; k <= along; k++) {
			at = same_line(n, lane + way * k, axis, at, own);
			if (at < 0)
				break;
			if (yields(n, lane + way * k, axis, (int)at, true))
				return true;
		}
	}
	return false;
}

static bool gives_way(const fine *n, int x, int y, int axis)
{
	int lane = axis == AXIS_ROW ? y : x, at = axis == AXIS_ROW ? x : y;
	passing own = passing_along(n, lane, at, axis);
	float place = (float)at + own.place;
	if (slope_of(n, lane, axis, place, &own) != nowhere)
		return yields_along(n, lane, axis, place, &own);
	for (int side = 0; side < 2; side++) { /* it crosses the lanes of the other axis */
		float there = same_line(n, at + side, !axis, (float)lane, &own);
		if (there >= 0 && yields_along(n, at + side, !axis, there, &own))
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
			if (inside && row[5 * (ptrdiff_t)x + 2 * axis] > 0 && ISA(crease_site)(n, &at, &s) &&
			    !gives_way(n, x, y, axis))
				n->crack[(ptrdiff_t)y * width + x] |= (uint8_t)mark_of(FAMILY_CREASE, axis);
		}
}
