/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What gives way to a line that runs beside it: decided by means along runs, so that nothing comes and goes from frame
 * to frame, and by identity where two are alike. */
#include "fine/chains/stations.h"

#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>

enum { ROUNDS = 4 };

/* Px between lines up to which one gives way, in full from half of that on. */
static const float reach = 3;
static const float slit = 2;                        /* px between the sides of a slit of which one stays */
static const float abreast = 0.6f;                  /* pixels along the way */
static const float parallel = 0.94f, along = 0.98f; /* cosines */
static const float even = 10;                       /* pixels each way over which it is evened */
static const float same_depth = 1e-4f;              /* of the depth */
static const float own_way = 2.5f;                  /* times the reach: along a run it is beside itself from there on */

/* ---- the mean along a run -------------------------------------------------------------------------------- */

static float value_of(const station *t, enum station_value value)
{
	switch (value) {
	case STATION_APART: return t->apart;
	case STATION_KEEP: return t->keep;
	}
	return 0;
}

float ISA(station_mean)(const stations *s, uint32_t i, uint32_t first, uint32_t end, float far,
			enum station_value value)
{
	const station *t = s->at;
	float sum = value_of(t + i, value), weights = 1;
	for (uint32_t b = i; b > first && t[i].s - t[b - 1].s < far && is_drawn(t + b - 1); b--) {
		float weight = 1 - (t[i].s - t[b - 1].s) / far;
		sum += weight * value_of(t + b - 1, value);
		weights += weight;
	}
	for (uint32_t b = i + 1; b < end && t[b].s - t[i].s < far && is_drawn(t + b); b++) {
		float weight = 1 - (t[b].s - t[i].s) / far;
		sum += weight * value_of(t + b, value);
		weights += weight;
	}
	return sum / weights;
}

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

typedef struct pairs {
	stations *s;
	uint32_t *count; /* by station */
	pair **of;       /* by chunk of stations: theirs, one after the other */
	atomic_bool failed;
} pairs;

/* Writes those of a station and returns how many they are; it has room for all that is beside it. */
static uint32_t pairs_at(const stations *s, uint32_t i, station_rows w, pair *to)
{
	const station *a = s->at + i;
	float far = reach * s->px;
	uint32_t count = 0;
	const station_grid *g = &s->grid;
	float x = (float)(a->x - g->x), y = (float)(a->y - g->y), dx = a->dx, dy = a->dy;
	while (next_row(g, &w))
		for (uint32_t k = w.from; k < w.end; k++) {
			float ex = g->px[k] - x, ey = g->py[k] - y, right = ey * dx - ex * dy, across = fabsf(right),
			      dot = dx * g->dx[k] + dy * g->dy[k], cosine = fabsf(dot);
			if ((fabsf(ex * dx + ey * dy) > abreast) | (across >= far) | (cosine < parallel))
				continue;
			const station *b = s->at + g->station[k];
			if (!(across > 0) || b == a || (b->run == a->run && fabsf(b->s - a->s) < own_way * far) ||
			    !gives_way(s, a, b, right, dot))
				continue;
			float share = clamp01(2 - 2 * across / far) * clamp01((cosine - parallel) / (along - parallel));
			if (share > 0)
				to[count++] = (pair){g->station[k], share};
		}
	return count;
}

static void find_pairs(void *data, int first, int end, int thread)
{
	(void)thread;
	pairs *p = data;
	const stations *s = p->s;
	pair *all = NULL;
	size_t n = 0, room = 0;
	for (int i = first; i < end && !stopped_at(s->n, i); i++) {
		const station *t = s->at + i;
		size_t most = 0;
		p->count[i] = 0;
		if (!is_drawn(t))
			continue;
		station_rows w = rows_beside(&s->grid, t->x, t->y, t, reach * s->px, abreast), again = w;
		while (next_row(&s->grid, &w))
			most += w.end - w.from;
		if (!most)
			continue;
		if (!all || n + most > room) {
			room = 2 * (n + most);
			pair *more = realloc(all, room * sizeof *more);
			if (!more) {
				atomic_store(&p->failed, true);
				break;
			}
			all = more;
		}
		p->count[i] = pairs_at(s, (uint32_t)i, again, all + n);
		n += p->count[i];
	}
	p->of[first / STATION_CHUNK] = all;
}

/* ---- rounds ---------------------------------------------------------------------------------------------- */

static void give_way(void *data, int first, int end, int thread)
{
	(void)thread;
	const pairs *p = data;
	const stations *s = p->s;
	const pair *at = p->of[first / STATION_CHUNK];
	for (int i = first; i < end && !stopped_at(s->n, i); i++) {
		float least = 1;
		for (uint32_t k = 0; k < p->count[i]; k++, at++)
			least = min(least, 1 - at->share * s->at[at->to].keep);
		s->mean[i] = is_drawn(s->at + i) ? s->at[i].solid * least : 0;
	}
}

static void set_keep(void *data, int first, int end, int thread)
{
	(void)thread;
	const stations *s = data;
	for (int i = first; i < end && !stopped_at(s->n, i); i++)
		s->at[i].keep = s->mean[i];
}

static void even_runs(void *data, int first, int end, int thread)
{
	(void)thread;
	const stations *s = data;
	for (int i = first; i < end && !stopped_at(s->n, i); i++)
		for (uint32_t a = s->first[i]; a < s->first[i + 1]; a++)
			s->mean[a] = ISA(station_mean)(s, a, s->first[i], s->first[i + 1], even * s->px, STATION_KEEP);
}

/* What gives way itself makes others give way as much less: else lines would vanish in threes. */
int32_t ISA(stations_give_way)(stations *s)
{
	fine *n = s->n;
	size_t chunks = ((size_t)s->count + STATION_CHUNK - 1) / STATION_CHUNK;
	pairs p = {.s = s,
		   .count = late_take(&n->f->late, s->count, sizeof *p.count),
		   .of = late_take(&n->f->late, chunks, sizeof *p.of)};
	if (!p.count || !p.of)
		return ENCRE_ERROR_MEMORY;
	memset(p.of, 0, chunks * sizeof *p.of);
	int32_t code = bands_run(n->f->bands, (int)s->count, STATION_CHUNK, find_pairs, &p);
	if (!code && atomic_load(&p.failed))
		code = ENCRE_ERROR_MEMORY;
	for (uint32_t i = 0; i < s->count; i++)
		s->at[i].keep = is_drawn(s->at + i) ? 1 : 0;
	for (int round = 0; !code && round < ROUNDS; round++) {
		code = bands_run(n->f->bands, (int)s->count, STATION_CHUNK, give_way, &p);
		code = code ? code : bands_run(n->f->bands, (int)s->count, STATION_CHUNK, set_keep, s);
		code = code ? code : bands_run(n->f->bands, s->runs, RUN_CHUNK, even_runs, s);
		code = code ? code : bands_run(n->f->bands, (int)s->count, STATION_CHUNK, set_keep, s);
	}
	for (size_t i = 0; i < chunks; i++)
		free(p.of[i]);
	late_drop(&n->f->late, p.of);
	late_drop(&n->f->late, p.count);
	return code;
}
