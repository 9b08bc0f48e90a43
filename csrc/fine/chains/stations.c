/* SPDX-License-Identifier: GPL-3.0-or-later */
/* From points of chains to stations, evenly along their edges, and what each would be if no line were beside it. */
#include "base/between.h"
#include "fine/chains/stations.h"

#include "base/metric.h"

#include <math.h>

/* Pixels by which the way between two stations may miss a corner, and how far apart they may lie if there is one. */
static const double corner_miss = 0.1, farthest_apart = 1.5;
static const float too_near = 0.1f; /* pixels from a station to the next */
enum { DEEPEST = 16 };              /* so often a way is halved for corners */

/* Degrees over which a crease gets its full width, and the share of that where it begins. */
static const float full_growth = 4, least_growth = 0.5f;
/* Of the angle: an edge of a form that is shaded smoothly goes on from one that bends as much as asked. */
static const float least_smooth = 5 / 6.0f;
/* Px by which a fold lies before what is behind it, from which on it is a line, and a whole one. */
static const float least_gap = 0.125f, full_gap = 0.5f;

/* ---- places ---------------------------------------------------------------------------------------------- */

typedef struct placing {
	const stations *s;
	station *to; /* NULL: they are counted */
	uint32_t count;
	double x, y; /* of the last one */
	float along_run;
	int32_t run;
} placing;

/* On the grid where floats are exact: a part of a frame has the same ones. */
static double on_fine_grid(double v)
{
	return floor(v * 4096 + 0.5) / 4096;
}

static void put(placing *p, const encre_chain_point *of, double x, double y, const double way[2], float depth,
		float along, int flags)
{
	x = on_fine_grid(x);
	y = on_fine_grid(y);
	double far = on_fine_grid(sqrt((x - p->x) * (x - p->x) + (y - p->y) * (y - p->y)));
	if (p->count && !(flags & STATION_ADDED) && far < (double)too_near)
		return;
	p->along_run += p->count ? (float)far : 0;
	p->x = x;
	p->y = y;
	if (p->to)
		p->to[p->count] = (station){.x = x,
					    .y = y,
					    .dx = (float)way[0],
					    .dy = (float)way[1],
					    .s = p->along_run,
					    .depth = depth,
					    .bend = of->bend,
					    .over = of->over,
					    .gap = of->gap,
					    .along = along,
					    .fade = clamp01(of->fade),
					    .mesh = of->mesh,
					    .edge = of->edge,
					    .object = of->object,
					    .behind = of->behind,
					    .run = p->run,
					    .kind = of->kind,
					    .color = {of->color[0], of->color[1]},
					    .side = (int8_t)(of->side > 0   ? 1
							     : of->side < 0 ? -1
									    : 0),
					    .flags = (uint8_t)flags};
	p->count++;
}

/* Of length 1; gives how long it is, 0 where the points lie on each other. */
static double way_between(const encre_chain_point *a, const encre_chain_point *b, double way[2])
{
	double x = (double)b->x - (double)a->x, y = (double)b->y - (double)a->y, length = sqrt(x * x + y * y);
	if (!(length > 1e-9))
		return 0;
	way[0] = x / length;
	way[1] = y / length;
	return length;
}

/* Puts those of points from .. end - 1, which lie between the last station and (x, y), that are corners. */
static void put_corners(placing *p, int64_t from, int64_t end, double x, double y, int depth)
{
	const encre_chain_point *q = p->s->point;
	double wx = x - p->x, wy = y - p->y, length = sqrt(wx * wx + wy * wy), most = 0, middle = INFINITY;
	int64_t best = -1, half = -1;
	for (int64_t k = from; k < end; k++) {
		double px = (double)q[k].x - p->x, py = (double)q[k].y - p->y,
		       t = length > 0 ? (px * wx + py * wy) / (length * length) : 0;
		t = t < 0 ? 0 : t > 1 ? 1 : t;
		double ex = px - t * wx, ey = py - t * wy, miss = sqrt(ex * ex + ey * ey);
		if (miss > most) {
			most = miss;
			best = k;
		}
		if (fabs(t - 0.5) < middle) {
			middle = fabs(t - 0.5);
			half = k;
		}
	}
	if (!(most > corner_miss))
		best = length > farthest_apart && middle < 0.4 ? half : -1;
	double way[2];
	if (best < 0 || depth == DEEPEST)
		return;
	put_corners(p, from, best, (double)q[best].x, (double)q[best].y, depth + 1);
	if (way_between(q + best - 1, q + best, way) > 0 || way_between(q + best, q + best + 1, way) > 0)
		put(p, q + best, (double)q[best].x, (double)q[best].y, way, q[best].depth, q[best].along[1],
		    STATION_ADDED);
	put_corners(p, best + 1, end, x, y, depth + 1);
}

/* How far along an edge its first station lies, in steps: by its identity, so that it is the same in every frame. */
static double phase_of(const encre_chain_point *p)
{
	double h = ((double)p->mesh + 1) * 0.6180339887498949 + (double)p->edge * 0.7548776662466927;
	return h - floor(h);
}

/* Whether a run may meet others at its end: the frame has not cut it off, nor does it meet itself there. */
static bool is_tied(const encre_chain_point *end)
{
	return end->end != ENCRE_END_FRAME && end->end != ENCRE_END_LOOP;
}

static void put_run(placing *p, int64_t from, int64_t end)
{
	const frame *f = p->s->n->f;
	const encre_chain_point *q = p->s->point;
	double way[2];
	int64_t corner = from + 1, first = from + 1;
	bool closed = q[from].end == ENCRE_END_LOOP && q[end - 1].end == ENCRE_END_LOOP;
	while (first < end && !(way_between(q + first - 1, q + first, way) > 0))
		first++;
	if (first == end)
		return;
	int tied = is_tied(q + from) ? STATION_TIED : 0;
	put(p, q + first, (double)q[from].x, (double)q[from].y, way, q[from].depth, q[first].along[0],
	    STATION_ADDED | STATION_FIRST | tied | (closed ? STATION_CLOSED : 0));
	for (int64_t k = first; k < end; k++) {
		const encre_chain_point *a = q + k - 1, *b = q + k;
		double length = way_between(a, b, way), u0 = (double)b->along[0], u1 = (double)b->along[1];
		if (!(length > 0))
			continue;
		if (!(fabs(u1 - u0) <= 2 * length + 1)) /* it is none of an edge */
			u1 = u0 + length;
		double step = (double)station_step, phase = phase_of(b), low = u0 < u1 ? u0 : u1,
		       high = u0 < u1 ? u1 : u0;
		double i0 = ceil(low / step - phase), i1 = ceil(high / step - phase) - 1;
		int64_t steps = (int64_t)(i1 - i0);
		for (int64_t i = 0; i <= steps; i++) {
			double at = step * ((u1 > u0 ? i0 + (double)i : i1 - (double)i) + phase),
			       t = (at - u0) / (u1 - u0), x = (double)a->x + t * ((double)b->x - (double)a->x),
			       y = (double)a->y + t * ((double)b->y - (double)a->y);
			put_corners(p, corner, k, x, y, 0);
			corner = k;
			put(p, b, x, y, way, depth_between(f, a, b, t), (float)at, 0);
		}
	}
	double x = (double)q[end - 1].x, y = (double)q[end - 1].y;
	put_corners(p, corner, end - 1, x, y, 0);
	tied = is_tied(q + end - 1) ? STATION_TIED : 0;
	if (!closed)
		put(p, q + end - 1, x, y, way, q[end - 1].depth, q[end - 1].along[1],
		    STATION_ADDED | STATION_LAST | tied);
	else if (p->to && p->count)
		p->to[p->count - 1].flags |= STATION_LAST | STATION_CLOSED;
}

static void place_runs(void *data, int first, int end, int thread)
{
	(void)thread;
	const stations *s = data;
	for (int i = first; i < end && !stopped_at(s->n, i); i++) {
		placing p = {.s = s, .to = s->at ? s->at + s->first[i] : NULL, .run = i};
		put_run(&p, s->run[i][0], s->run[i][1]);
		if (!s->at)
			s->first[i + 1] = p.count;
	}
}

/* ---- what each is ---------------------------------------------------------------------------------------- */

/* The pixel half a pixel toward the surface, or of those about it the nearest that shows what the line is of. */
static void take_controls(const stations *s, station *t)
{
	const frame *f = s->n->f;
	double aside = 0.5 * (double)t->side, x = t->x - f->place.x - aside * (double)t->dy,
	       y = t->y - f->place.y + aside * (double)t->dx;
	int px = pixel_of((float)x, f->width), py = pixel_of((float)y, f->height);
	double least = INFINITY;
	t->near_x = (uint16_t)px;
	t->near_y = (uint16_t)py;
	if (!f->layer[ENCRE_LAYER_OBJECT].data || object_at(f, px, py) == (float)t->object)
		return;
	for (int qy = py - 2; qy <= py + 2; qy++)
		for (int qx = px - 2; qx <= px + 2; qx++) {
			double d = (qx - x) * (qx - x) + (qy - y) * (qy - y);
			if (qx < 0 || qy < 0 || qx >= f->width || qy >= f->height || !(d < least) ||
			    object_at(f, qx, qy) != (float)t->object)
				continue;
			least = d;
			t->near_x = (uint16_t)qx;
			t->near_y = (uint16_t)qy;
		}
}

/* Whether the materials on both sides differ, where a layer tells. */
static bool parts_materials(const stations *s, const station *t)
{
	const frame *f = s->n->f;
	const float *own = layer_row(f, ENCRE_LAYER_MATERIAL, t->near_y);
	if (!own)
		return false;
	float aside = t->side ? (float)t->side : 1;
	int x = pixel_of((float)(t->x - f->place.x) + aside * t->dy, f->width),
	    y = pixel_of((float)(t->y - f->place.y) - aside * t->dx, f->height);
	return own[t->near_x] != layer_row(f, ENCRE_LAYER_MATERIAL, y)[x];
}

static float grown(float more)
{
	return least_growth + (1 - least_growth) * clamp01(more / full_growth);
}

/* How wide an edge is for what it bends, by itself or with the faces beside it, 0..1; below 0 it is no line. */
static float growth_of(const stations *s, const encre_params *p, station *t)
{
	bool smooth = t->kind & ENCRE_CHAIN_SMOOTH;
	float angle = smooth ? p->crease_angle_smooth : p->crease_angle, more = t->bend - angle;
	if (t->kind & (ENCRE_CHAIN_MEET | ENCRE_CHAIN_MARK))
		return 1;
	if (s->n->e->p->crease_source == crease_source_LAYERS)
		return -1;
	float over = t->over >= angle ? t->fade * grown(t->over - angle) : -1;
	if (more < 0 && over < 0 && !(smooth && t->bend >= least_smooth * angle))
		return -1;
	if (more < 0 && over < 0)
		t->flags |= STATION_WEAK;
	return more < 0 && over >= 0 ? over : max(over, grown(more));
}

static bool weigh(const fine *n, placed *made, int style, enum source source, float strength)
{
	return n->e->on[source] && ISA(fine_weigh)(n, made, style, source, strength);
}

/* Two colors in the metric, and how much they differ: along a line they are often the same. */
typedef struct two_colors {
	bool known;
	int32_t color[2];
	float space[2][3], contrast;
} two_colors;

static void compare_colors(const encre_params *p, const station *t, two_colors *of)
{
	if (of->known && of->color[0] == t->color[0] && of->color[1] == t->color[1])
		return;
	for (int side = 0; side < 2; side++) {
		float *space = of->space[side];
		of->color[side] = t->color[side];
		for (int k = 0; k < 3; k++)
			space[k] = srgb_decode((float)(t->color[side] >> (16 - 8 * k) & 255) / 255);
		ISA(metric_space)(p->contrast_metric, 1, space, space + 1, space + 2);
	}
	const float *a[3] = {of->space[0], of->space[0] + 1, of->space[0] + 2},
		    *b[3] = {of->space[1], of->space[1] + 1, of->space[1] + 2};
	const color_metric metric = metric_of(p);
	of->contrast = 0;
	ISA(metric_difference)(&metric, 1, a, b, &of->contrast);
	of->known = true;
}

/* Whether what colors differ by is a line, by itself or, of a weak one, beside such. */
static bool weigh_colors(const fine *n, station *t, placed *made, int style, two_colors *of)
{
	const encre_params *p = n->e->p;
	compare_colors(p, t, of);
	float strength = metric_strength(of->contrast, p->contrast_threshold,
					 full_contrast(n->e, SOURCE_COLOR, t->near_x, t->near_y));
	weigh(n, made, style, SOURCE_COLOR, strength);
	ISA(fine_paint)(n, made, of->space[0], of->space[1]);
	t->flags |= made->strength < p->edge_threshold ? STATION_WEAK : 0;
	return made->strength > 0 && made->strength >= least_faint * p->edge_threshold;
}

static void judge(const stations *s, station *t, two_colors *of)
{
	const fine *n = s->n;
	take_controls(s, t);
	int style = style_at(n->f, t->near_x, t->near_y), kind = t->kind;
	const encre_params *p = n->f->params + style;
	/* where a surface goes on in another one it is its bend that is seen */
	bool flush = kind & ENCRE_CHAIN_FLUSH, contour = !flush && (kind & (ENCRE_CHAIN_CONTOUR | ENCRE_CHAIN_BORDER));
	bool edge = false, color = kind & ENCRE_CHAIN_COLOR;
	placed made = {.x = (float)(t->x - n->f->place.x), .y = (float)(t->y - n->f->place.y)};
	float before = clamp01((t->gap / s->px - least_gap) / (full_gap - least_gap));
	bool bent = flush || (kind & (ENCRE_CHAIN_CREASE | ENCRE_CHAIN_BEVEL | ENCRE_CHAIN_MEET));
	float bends = flush && p->flush_pieces ? 1 : bent ? growth_of(s, p, t) : -1;
	bool weak = t->flags & STATION_WEAK;
	bool parts = kind & (ENCRE_CHAIN_NUMBER | ENCRE_CHAIN_OTHER | ENCRE_CHAIN_MATERIAL | ENCRE_CHAIN_MEET);
	t->importance = color                     ? IMPORTANCE_COLOR
			: contour                 ? IMPORTANCE_CONTOUR
			: kind & ENCRE_CHAIN_MARK ? IMPORTANCE_MARK
			: parts && !flush         ? IMPORTANCE_BOUNDARY
						  : IMPORTANCE_CREASE;
	t->growth = 1;
	if (contour) {
		bool folded = is_folded(t);
		if (folded && bends >= 0 && weigh(n, &made, style, SOURCE_NORMAL, 1))
			edge = true;
		bool alone = edge;
		if (!folded)
			edge |= weigh(n, &made, style, SOURCE_OBJECT, 1);
		if (!folded && parts_materials(s, t))
			edge |= weigh(n, &made, style, SOURCE_MATERIAL, 1);
		edge |= weigh(n, &made, style, SOURCE_DEPTH, folded ? before > 0 : before);
		t->growth = folded ? max(before, alone ? bends : 0) : 1;
		t->flags &= (uint8_t)~STATION_WEAK;
	} else if (!flush && (kind & (ENCRE_CHAIN_NUMBER | ENCRE_CHAIN_OTHER | ENCRE_CHAIN_MATERIAL))) {
		edge = (kind & (ENCRE_CHAIN_NUMBER | ENCRE_CHAIN_OTHER)) && weigh(n, &made, style, SOURCE_OBJECT, 1);
		edge |= (kind & ENCRE_CHAIN_MATERIAL) && weigh(n, &made, style, SOURCE_MATERIAL, 1);
	} else if (kind & ENCRE_CHAIN_MARK) {
		edge = weigh(n, &made, style, SOURCE_MARK, 1);
	} else if (color) {
		edge = weigh_colors(n, t, &made, style, of);
	}
	if (color) {
		t->flags &= (uint8_t)(edge ? 255 : ~STATION_WEAK);
	} else if (!edge && !contour && bends >= 0) {
		edge = weigh(n, &made, style, SOURCE_NORMAL, 1);
		t->growth = bends;
		t->flags |= weak ? STATION_WEAK : 0;
	} else {
		t->flags &= (uint8_t)~STATION_WEAK;
	}
	t->strength = made.strength;
	t->source = made.source;
	t->solid = t->growth;
	if (!edge)
		t->flags |= STATION_NONE;
}

static void judge_stations(void *data, int first, int end, int thread)
{
	(void)thread;
	const stations *s = data;
	two_colors of = {.known = false};
	for (int i = first; i < end && !stopped_at(s->n, i); i++)
		judge(s, s->at + i, &of);
}

static bool is_strong(const station *t)
{
	return !(t->flags & (STATION_NONE | STATION_WEAK)) && t->importance <= IMPORTANCE_CREASE;
}

/* Weak ones of a run are lines if those that they hang together with reach one that is not weak. */
static void hold_runs(void *data, int first, int end, int thread)
{
	(void)thread;
	const stations *s = data;
	for (int i = first; i < end && !stopped_at(s->n, i); i++) {
		uint32_t from = s->first[i], last = s->first[i + 1], k = from;
		while (k < last) {
			uint32_t stop = k;
			while (stop < last && (s->at[stop].flags & STATION_WEAK))
				stop++;
			bool held = (k > from && is_strong(s->at + k - 1)) || (stop < last && is_strong(s->at + stop));
			for (uint32_t j = k; j < stop && !held; j++)
				s->at[j].flags |= STATION_NONE;
			k = stop + 1;
		}
	}
}

/* ---- all ------------------------------------------------------------------------------------------------- */

/* Whether the way to a point may be a line in some style. */
static bool may_be_line(const stations *s, const encre_chain_point *p)
{
	enum { BENDS = ENCRE_CHAIN_CREASE | ENCRE_CHAIN_BEVEL | ENCRE_CHAIN_SMOOTH | ENCRE_CHAIN_ROUND };
	if (p->kind & ENCRE_CHAIN_HIDDEN) /* hidden.c */
		return false;
	return (p->kind & ~BENDS) || max(p->bend, p->over) >= s->least_bend[(p->kind & ENCRE_CHAIN_SMOOTH) != 0];
}

static bool follows(const stations *s, int64_t i)
{
	return i > 0 && s->point[i].run == s->point[i - 1].run && may_be_line(s, s->point + i);
}

static int32_t find_runs(stations *s)
{
	fine *n = s->n;
	int64_t runs = 0;
	s->least_bend[0] = s->least_bend[1] = INFINITY;
	for (int i = 0; i < n->f->n_styles; i++) {
		s->least_bend[0] = min(s->least_bend[0], n->f->params[i].crease_angle);
		s->least_bend[1] = min(s->least_bend[1], least_smooth * n->f->params[i].crease_angle_smooth);
	}
	for (int64_t i = 1; i < s->points; i++)
		runs += follows(s, i) && !follows(s, i - 1);
	if (runs >= INT32_MAX)
		return ENCRE_ERROR_MEMORY;
	s->run = late_take(&n->f->late, (size_t)runs, sizeof *s->run);
	s->first = late_take(&n->f->late, (size_t)runs + 1, sizeof *s->first);
	if (!s->run || !s->first)
		return ENCRE_ERROR_MEMORY;
	s->runs = 0;
	for (int64_t i = 1; i < s->points; i++) {
		if (!follows(s, i))
			continue;
		if (!follows(s, i - 1))
			s->run[s->runs++][0] = i - 1;
		s->run[s->runs - 1][1] = i + 1;
	}
	return ENCRE_OK;
}

int32_t ISA(stations_make)(stations *s)
{
	fine *n = s->n;
	int32_t code = find_runs(s);
	uint64_t sum = 0;
	s->at = NULL;
	if (!code)
		code = bands_run(n->f->bands, s->runs, RUN_CHUNK, place_runs, s);
	if (code)
		return code;
	s->first[0] = 0;
	for (int32_t i = 0; i < s->runs; i++) {
		sum += s->first[i + 1];
		s->first[i + 1] = (uint32_t)sum;
	}
	s->at = sum < INT32_MAX ? late_take(&n->f->late, (size_t)sum, sizeof *s->at) : NULL;
	if (!s->at)
		return ENCRE_ERROR_MEMORY;
	s->count = (uint32_t)sum;
	code = bands_run(n->f->bands, s->runs, RUN_CHUNK, place_runs, s);
	if (!code)
		code = bands_run(n->f->bands, (int)s->count, STATION_CHUNK, judge_stations, s);
	return code ? code : bands_run(n->f->bands, s->runs, RUN_CHUNK, hold_runs, s);
}
