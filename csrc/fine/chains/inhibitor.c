/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What gives way to a line that runs beside it: decided by means along runs, so that nothing comes and goes from frame
 * to frame, and by identity where two are alike. */
#include "fine/chains/stations.h"

#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>

enum { ROUNDS = 4 };

/* Px between lines up to which one gives way in full, and at all: to another inside a surface, and to a contour, which
 * leaves room on one side. */
static const float reach[2] = {2.4f, 3.6f}, contour_reach[2] = {1.5f, 3};
static const float slit = 2;                        /* px between the sides of a slit of which one stays */
static const float abreast = 0.6f;                  /* pixels along the way */
static const float parallel = 0.97f, along = 0.99f; /* cosines */
static const float even = 10;                       /* pixels each way over which it is evened */
static const float same_depth = 1e-4f;              /* of the depth */
static const float own_way = 2.5f;                  /* times the reach: along a run it is beside itself from there on */

/* ---- pairs ----------------------------------------------------------------------------------------------- */

/* Of two that are alike the farther one; as far away, the one whose edge has the higher number. */
static bool is_later(const station *a, const station *b)
{
	if (fabsf(a->depth - b->depth) > same_depth * a->depth)
		return a->depth > b->depth;
	return a->mesh != b->mesh ? a->mesh > b->mesh : a->edge > b->edge;
}

/* Whether a gives way to b, which lies abreast `right` pixels to its right; dot: of their ways. */
static bool gives_way(const stations *s, const station *a, const station *b, float right, float dot)
{
	if (a->importance != IMPORTANCE_CONTOUR)
		return a->importance != b->importance ? a->importance < b->importance : is_later(a, b);
	if (b->importance != IMPORTANCE_CONTOUR || !a->side || !b->side)
		return false;
	/* above 0 where its surface lies towards the other */
	float mine = right * a->side, its = (dot > 0 ? -right : right) * b->side;
	if (mine > 0 && its > 0 && a->object == b->object) /* the two sides of a thin thing */
		return false;
	if (is_folded(a) && (b->object == a->object || b->behind == a->object))
		return is_folded(b) ? is_later(a, b) : true;
	if (is_folded(a) || is_folded(b))
		return false;
	return mine < 0 && its < 0 && fabsf(right) < slit * s->px && a->behind == b->behind &&
	       a->x + a->y > b->x + b->y;
}

/* Station gives way to `to` by so much. */
typedef struct pair {
	uint32_t to;
	float share;
} pair;

/* What is asked of stations again and again lies close together. */
typedef struct pairs {
	stations *s;
	uint32_t *count;   /* by station */
	pair **of;         /* by chunk of stations: theirs, one after the other */
	float *keep, *own; /* by station: what is left of it, and what is without others */
	float *along;      /* likewise, pixels along its run */
	atomic_bool failed;
} pairs;

typedef struct pair_list {
	pair *all;
	size_t n, room;
} pair_list;

static bool make_room(pair_list *to, size_t more)
{
	if (to->n + more <= to->room)
		return true;
	size_t room = 2 * (to->n + more);
	pair *grown = realloc(to->all, room * sizeof *grown);
	if (!grown)
		return false;
	to->all = grown;
	to->room = room;
	return true;
}

/* Adds those of a station. False without memory. */
static bool pairs_at(const stations *s, uint32_t i, pair_list *to)
{
	const station *a = s->at + i;
	float far = reach[1] * s->px;
	const station_grid *g = &s->grid;
	float x = (float)(a->x - g->x), y = (float)(a->y - g->y), dx = a->dx, dy = a->dy;
	station_rows w = rows_beside(g, a->x, a->y, a, far, abreast);
	while (next_row(g, &w)) {
		if (!make_room(to, w.end - w.from))
			return false;
		for (uint32_t k = w.from; k < w.end; k++) {
			float ex = g->px[k] - x, ey = g->py[k] - y, right = ey * dx - ex * dy, across = fabsf(right),
			      dot = dx * g->dx[k] + dy * g->dy[k], cosine = fabsf(dot);
			if ((fabsf(ex * dx + ey * dy) > abreast) | (across >= far) | (cosine < parallel))
				continue;
			const station *b = s->at + g->station[k];
			if (!(across > 0) || b == a || (b->run == a->run && fabsf(b->s - a->s) < own_way * far) ||
			    !gives_way(s, a, b, right, dot))
				continue;
			const float *most = b->importance == IMPORTANCE_CONTOUR ? contour_reach : reach;
			float share = clamp01((most[1] * s->px - across) / ((most[1] - most[0]) * s->px)) *
				      clamp01((cosine - parallel) / (along - parallel));
			if (share > 0)
				to->all[to->n++] = (pair){g->station[k], share};
		}
	}
	return true;
}

static void find_pairs(void *data, int first, int end, int thread)
{
	(void)thread;
	pairs *p = data;
	const stations *s = p->s;
	pair_list list = {0};
	for (int i = first; i < end && !stopped_at(s->n, i); i++) {
		const station *t = s->at + i;
		size_t before = list.n;
		p->own[i] = is_drawn(t) ? t->solid : 0;
		p->keep[i] = is_drawn(t) ? 1 : 0;
		p->along[i] = t->s;
		if (is_drawn(t) && !pairs_at(s, (uint32_t)i, &list)) {
			atomic_store(&p->failed, true);
			break;
		}
		p->count[i] = (uint32_t)(list.n - before);
	}
	p->of[first / STATION_CHUNK] = list.all;
}

/* ---- rounds ---------------------------------------------------------------------------------------------- */

static void give_way(void *data, int first, int end, int thread)
{
	(void)thread;
	const pairs *p = data;
	const pair *at = p->of[first / STATION_CHUNK];
	for (int i = first; i < end && !stopped_at(p->s->n, i); i++) {
		float least = 1;
		for (uint32_t k = 0; k < p->count[i]; k++, at++)
			least = min(least, 1 - at->share * p->keep[at->to]);
		p->s->mean[i] = p->own[i] * least;
	}
}

/* The mean along a stretch that is drawn, with weights that fall to 0 `far` pixels away. */
static void even_stretch(const pairs *p, uint32_t from, uint32_t end, float far)
{
	const float *restrict value = p->s->mean, *restrict at = p->along;
	for (uint32_t i = from; i < end; i++) {
		float sum = value[i], weights = 1;
		for (uint32_t b = i; b > from && at[i] - at[b - 1] < far; b--) {
			float weight = 1 - (at[i] - at[b - 1]) / far;
			sum += weight * value[b - 1];
			weights += weight;
		}
		for (uint32_t b = i + 1; b < end && at[b] - at[i] < far; b++) {
			float weight = 1 - (at[b] - at[i]) / far;
			sum += weight * value[b];
			weights += weight;
		}
		p->keep[i] = sum / weights;
	}
}

static void even_runs(void *data, int first, int end, int thread)
{
	(void)thread;
	const pairs *p = data;
	const stations *s = p->s;
	for (int i = first; i < end && !stopped_at(s->n, i); i++)
		for (uint32_t from = s->first[i], to; from < s->first[i + 1]; from = to + 1) {
			for (to = from; to < s->first[i + 1] && is_drawn(s->at + to);)
				to++;
			even_stretch(p, from, to, even * s->px);
		}
}

/* What gives way itself makes others give way as much less: else lines would vanish in threes. */
int32_t ISA(stations_give_way)(stations *s)
{
	fine *n = s->n;
	size_t chunks = ((size_t)s->count + STATION_CHUNK - 1) / STATION_CHUNK;
	pairs p = {.s = s,
		   .count = late_take(&n->f->late, s->count, sizeof *p.count),
		   .of = late_take(&n->f->late, chunks, sizeof *p.of),
		   .keep = late_take(&n->f->late, 3 * (size_t)s->count, sizeof *p.keep)};
	if (!p.count || !p.of || !p.keep)
		return ENCRE_ERROR_MEMORY;
	p.own = p.keep + s->count;
	p.along = p.own + s->count;
	memset(p.of, 0, chunks * sizeof *p.of);
	int32_t code = bands_run(n->f->bands, (int)s->count, STATION_CHUNK, find_pairs, &p);
	if (!code && atomic_load(&p.failed))
		code = ENCRE_ERROR_MEMORY;
	for (int round = 0; !code && round < ROUNDS; round++) {
		code = bands_run(n->f->bands, (int)s->count, STATION_CHUNK, give_way, &p);
		code = code ? code : bands_run(n->f->bands, s->runs, RUN_CHUNK, even_runs, &p);
	}
	for (uint32_t i = 0; !code && i < s->count; i++)
		s->at[i].keep = is_drawn(s->at + i) ? p.keep[i] : 0;
	for (size_t i = 0; i < chunks; i++)
		free(p.of[i]);
	late_drop(&n->f->late, p.keep);
	late_drop(&n->f->late, p.of);
	late_drop(&n->f->late, p.count);
	return code;
}
