/* SPDX-License-Identifier: GPL-3.0-or-later */
/* How far lines lie from each other: stations by cells, how thin the things are that contours bound, and how much of
 * lines is left where many lie close. */
#include "fine/chains/stations.h"

#include <stdlib.h>
#include <string.h>

/* Px from side to side of a cell, and stations in one for each px: more lines than could be told apart. */
static const float cell_side = 2;
enum { MOST_OF_CELL = 24, MARGIN = 88 /* pixels beyond the image where chains go on */, ROWS = 8 };

/* ---- cells ----------------------------------------------------------------------------------------------- */

/* What is told of a station when a cell has too many. */
typedef struct member {
	float depth, along;
	int32_t mesh, edge;
	uint32_t station;
	uint8_t importance;
} member;

static int by_importance(const void *a, const void *b)
{
	const member *p = a, *q = b;
	int by = q->importance - p->importance;
	by = by ? by : order(p->depth, q->depth);
	by = by ? by : (p->mesh > q->mesh) - (p->mesh < q->mesh);
	by = by ? by : (p->edge > q->edge) - (p->edge < q->edge);
	by = by ? by : order(p->along, q->along);
	return by ? by : order_of(p->station, q->station);
}

typedef struct choosing {
	stations *s;
	uint32_t *count; /* by cell */
	member *list;    /* by thread */
	uint32_t room;
} choosing;

/* Leaves in each cell the most important ones. */
static void choose_members(void *data, int first, int end, int thread)
{
	const choosing *c = data;
	const stations *s = c->s;
	const station_grid *g = &s->grid;
	member *list = c->list + (size_t)thread * c->room;
	for (int row = first; row < end && !bands_stopped(s->n->f->bands); row++)
		for (size_t cell = (size_t)row * (size_t)g->across; cell < ((size_t)row + 1) * (size_t)g->across;
		     cell++) {
			uint32_t *own = g->station + g->first[cell], count = c->count[cell];
			if (count <= g->most)
				continue;
			for (uint32_t k = 0; k < count; k++) {
				const station *t = s->at + own[k];
				list[k] = (member){t->depth, t->along, t->mesh, t->edge, own[k], t->importance};
			}
			qsort(list, count, sizeof *list, by_importance);
			for (uint32_t k = 0; k < g->most; k++)
				own[k] = list[k].station;
			c->count[cell] = g->most;
		}
}

static size_t cell_at(const station_grid *g, const station *t)
{
	return (size_t)grid_index(t->y, g->y, g->cell, g->tall) * (size_t)g->across +
	       (size_t)grid_index(t->x, g->x, g->cell, g->across);
}

static bool is_member(const station *t)
{
	return is_drawn(t) && !(t->flags & STATION_ADDED);
}

/* Among others: folds are less than outlines. */
static float rank_among(const station *t)
{
	return (float)t->importance + (t->importance == IMPORTANCE_CONTOUR && !is_folded(t) ? 0.5f : 0);
}

/* Moves those that were chosen together, and fills what is asked of them. */
static void close_up(stations *s, const uint32_t *count, size_t cells)
{
	station_grid *g = &s->grid;
	uint32_t to = 0;
	for (size_t k = 0; k < cells; k++) {
		const uint32_t *from = g->station + g->first[k];
		g->first[k] = to;
		for (uint32_t i = 0; i < count[k]; i++, to++) {
			const station *t = s->at + from[i];
			g->station[to] = from[i];
			g->px[to] = (float)(t->x - g->x);
			g->py[to] = (float)(t->y - g->y);
			g->dx[to] = t->dx;
			g->dy[to] = t->dy;
			g->importance[to] = rank_among(t);
		}
	}
	g->first[cells] = to;
}

int32_t ISA(stations_sort)(stations *s)
{
	fine *n = s->n;
	station_grid *g = &s->grid;
	const encre_frame *f = &n->f->place;
	g->cell = cell_side * s->px;
	g->most = (uint32_t)(MOST_OF_CELL * s->px);
	double cell = (double)g->cell;
	g->x = cell * floor((f->x - MARGIN) / cell);
	g->y = cell * floor((f->y - MARGIN) / cell);
	g->across = (int)((f->x + n->f->width + MARGIN - g->x) / cell) + 1;
	g->tall = (int)((f->y + n->f->height + MARGIN - g->y) / cell) + 1;
	size_t cells = (size_t)g->across * (size_t)g->tall;
	uint32_t *count = late_take(&n->f->late, cells, sizeof *count);
	g->first = late_take(&n->f->late, cells + 1, sizeof *g->first);
	g->station = late_take(&n->f->late, s->count, sizeof *g->station);
	g->px = late_take(&n->f->late, 5 * (size_t)s->count, sizeof *g->px);
	if (!count || !g->first || !g->station || !g->px)
		return ENCRE_ERROR_MEMORY;
	g->py = g->px + s->count;
	g->dx = g->py + s->count;
	g->dy = g->dx + s->count;
	g->importance = g->dy + s->count;
	memset(count, 0, cells * sizeof *count);
	int32_t code = ENCRE_OK;
	for (uint32_t i = 0; !code && i < s->count; i++) {
		code = at_step(n, i);
		if (is_member(s->at + i))
			count[cell_at(g, s->at + i)]++;
	}
	uint32_t sum = 0, most = 0;
	for (size_t k = 0; k < cells; k++) {
		g->first[k] = sum;
		sum += count[k];
		most = count[k] > most ? count[k] : most;
		count[k] = 0;
	}
	for (uint32_t i = 0; !code && i < s->count; i++) {
		code = at_step(n, i);
		if (!is_member(s->at + i))
			continue;
		size_t own = cell_at(g, s->at + i);
		g->station[g->first[own] + count[own]++] = i;
	}
	if (!code && most > g->most) {
		choosing c = {s, count,
			      late_take(&n->f->late, (size_t)bands_threads(n->f->bands) * most, sizeof *c.list), most};
		if (!c.list)
			return ENCRE_ERROR_MEMORY;
		code = bands_run(n->f->bands, g->tall, ROWS, choose_members, &c);
		late_drop(&n->f->late, c.list);
	}
	if (!code)
		close_up(s, count, cells);
	late_drop(&n->f->late, count);
	return code;
}

/* ---- thin things ----------------------------------------------------------------------------------------- */

/* Px. What is wider is no thin thing. */
static const float widest = 24;
static const float least_widest = 6; /* pixels: in a small frame, too, more than what is drawn as one line */
static const float abreast = 0.8f;   /* pixels along the way by which both contours may lie apart */
static const float parted = 0.5f, beside = 0.8f;   /* cosines of contours that have nothing to do with each other, and
						      that run along each other */
static const float least_other = 0.5f;             /* of its width must be left of a fold, to be the other contour */
static const float rod = 0.05f, tip = 0.15f;       /* sines of contours of a rod, and of a tip */
static const float even_least = 9, even_mean = 10; /* px along the run over which it is evened */

/* Takes what lies across from a contour in the cells about a place. */
static void look_across(const stations *s, station *t, double x, double y, const float in[2], float most)
{
	const station_grid *g = &s->grid;
	float x0 = (float)(t->x - g->x), y0 = (float)(t->y - g->y);
	station_rows w = rows_beside(g, x, y, t, 0.5f * g->cell, abreast);
	while (next_row(g, &w))
		for (uint32_t j = w.from; j < w.end; j++) {
			float ex = g->px[j] - x0, ey = g->py[j] - y0, across = ex * in[0] + ey * in[1];
			if (fabsf(ex * t->dx + ey * t->dy) > abreast || across < 0.3f || across >= t->apart)
				continue;
			const station *o = s->at + g->station[j];
			if (o->importance != IMPORTANCE_CONTOUR || !o->side || o->object != t->object ||
			    (is_folded(o) && !(o->solid >= least_other * o->growth)))
				continue;
			float dot = t->dx * o->dx + t->dy * o->dy, cosine = fabsf(dot);
			if (cosine < parted || (dot > 0 ? 1 : -1) * o->side * t->side > 0)
				continue;
			float own = mix(most, across, clamp01((cosine - parted) / (beside - parted))),
			      sine = fabsf(t->dx * o->dy - t->dy * o->dx);
			if (!(own < t->apart) && !(own == t->apart && sine < t->sine)) /* whatever their order */
				continue;
			t->apart = own;
			t->sine = sine;
		}
}

static void measure_stations(void *data, int first, int end, int thread)
{
	(void)thread;
	const stations *s = data;
	float most = max(widest * s->n->f->scale, least_widest);
	for (int i = first; i < end && !stopped_at(s->n, i); i++) {
		station *t = s->at + i;
		t->apart = t->across = most;
		t->sine = 0;
		if (!is_drawn(t) || t->importance != IMPORTANCE_CONTOUR || !t->side)
			continue;
		float in[2] = {-t->dy * t->side, t->dx * t->side};
		int steps = (int)((most - 0.5f) / s->grid.cell) + 1;
		for (int k = 0; k < steps; k++) {
			float far = 0.5f + (float)k * s->grid.cell;
			if (far > most || far >= t->apart + 1)
				break;
			look_across(s, t, t->x + (double)(far * in[0]), t->y + (double)(far * in[1]), in, most);
		}
		t->across = t->apart;
	}
}

/* Along a run as far as it is drawn, with weights that fall to 0 `far` pixels away. */
static float mean_apart(const stations *s, uint32_t i, uint32_t first, uint32_t end, float far)
{
	const station *t = s->at;
	float sum = t[i].apart, weights = 1;
	for (uint32_t b = i; b > first && t[i].s - t[b - 1].s < far && is_drawn(t + b - 1); b--) {
		float weight = 1 - (t[i].s - t[b - 1].s) / far;
		sum += weight * t[b - 1].apart;
		weights += weight;
	}
	for (uint32_t b = i + 1; b < end && t[b].s - t[i].s < far && is_drawn(t + b); b++) {
		float weight = 1 - (t[b].s - t[i].s) / far;
		sum += weight * t[b].apart;
		weights += weight;
	}
	return sum / weights;
}

/* Round a corner as on both sides of it. */
static void even_least_apart(void *data, int first, int end, int thread)
{
	(void)thread;
	const stations *s = data;
	float reach = even_least * s->n->f->scale;
	for (int i = first; i < end && !stopped_at(s->n, i); i++) {
		uint32_t from = s->first[i], last = s->first[i + 1];
		for (uint32_t a = from; a < last; a++) {
			float least = s->at[a].apart, sine = s->at[a].sine;
			for (uint32_t b = a; b > from && s->at[a].s - s->at[b - 1].s < reach && is_drawn(s->at + b - 1);
			     b--) {
				least = min(least, s->at[b - 1].apart);
				sine = max(sine, s->at[b - 1].sine);
			}
			for (uint32_t b = a + 1; b < last && s->at[b].s - s->at[a].s < reach && is_drawn(s->at + b);
			     b++) {
				least = min(least, s->at[b].apart);
				sine = max(sine, s->at[b].sine);
			}
			s->mean[a] = least;
			s->at[a].tapers = clamp01((sine - rod) / (tip - rod));
		}
		for (uint32_t a = from; a < last; a++)
			s->at[a].apart = s->mean[a];
		for (uint32_t a = from; a < last; a++)
			s->mean[a] = mean_apart(s, a, from, last, even_mean * s->n->f->scale);
		for (uint32_t a = from; a < last; a++)
			s->at[a].apart = s->mean[a];
	}
}

int32_t ISA(stations_measure)(stations *s)
{
	int32_t code = bands_run(s->n->f->bands, (int)s->count, STATION_CHUNK, measure_stations, s);
	return code ? code : bands_run(s->n->f->bands, s->runs, RUN_CHUNK, even_least_apart, s);
}

float ISA(station_radius)(const stations *s, const station *t)
{
	const float share = 0.25f, least = 1.25f, least_pixels = 0.5f;
	float unit = s->n->f->scale, far = t->apart / (widest * unit);
	far *= far;
	far *= far;
	return far > 0.999f ? INFINITY : max(share * t->apart / (1 - far), max(least * unit, least_pixels));
}

/* ---- crowds ---------------------------------------------------------------------------------------------- */

/* Px across over which lines are counted, how far they lie apart where they begin to get thinner, and at least so much
 * of them is left. */
static const float counted = 6, full_apart = 2.4f, least_left = 0.2f;
static const float counted_along = 0.375f, same_line = 0.1f, level = 0.9f; /* pixels; pixels; a cosine */

/* Of members from .. end - 1 those as important as a station or more that lie beside it: an outline among the edges of
 * facets stays whole. */
static int count_abreast(const station_grid *g, uint32_t from, uint32_t end, const station *t, float reach)
{
	const float *restrict px = g->px + from, *restrict py = g->py + from, *restrict dx = g->dx + from,
			      *restrict dy = g->dy + from, *restrict important = g->importance + from;
	float least = rank_among(t);
	float x = (float)(t->x - g->x), y = (float)(t->y - g->y), wx = t->dx, wy = t->dy;
	int n = (int)(end - from), count = 0;
	for (int i = 0; i < n; i++) {
		float ex = px[i] - x, ey = py[i] - y, across = fabsf(ey * wx - ex * wy);
		int beside_it = (fabsf(ex * wx + ey * wy) < counted_along) & (across > same_line) & (across < reach) &
				(fabsf(wx * dx[i] + wy * dy[i]) > level) & (important[i] >= least);
		count += beside_it;
	}
	return count;
}

static void thin_out(void *data, int first, int end, int thread)
{
	(void)thread;
	const stations *s = data;
	const station_grid *g = &s->grid;
	float reach = counted * s->px;
	for (int i = first; i < end && !stopped_at(s->n, i); i++) {
		station *t = s->at + i;
		if (!is_drawn(t))
			continue;
		station_rows w = rows_beside(g, t->x, t->y, t, reach, counted_along);
		int count = 1;
		while (next_row(g, &w))
			count += count_abreast(g, w.from, w.end, t, reach);
		float share = 2 * counted / (float)count / full_apart;
		/* folds of what is rough are gone */
		float least = is_folded(t) && (t->kind & ENCRE_CHAIN_SMOOTH) ? 0 : least_left;
		t->solid *= clamp01(max(least > 0 ? share : 2 * share - 1, least));
	}
}

int32_t ISA(stations_thin_out)(stations *s)
{
	return bands_run(s->n->f->bands, (int)s->count, STATION_CHUNK, thin_out, s);
}
