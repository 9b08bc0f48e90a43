/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What gives way to a line that runs beside it: decided by means along runs, so that nothing comes and goes from frame
 * to frame, and by identity where two are alike. */
#include "fine/chains/stations.h"

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
	uint32_t *first; /* by station, and one more */
	pair *pair;      /* NULL: they are counted */
} pairs;

static uint32_t pairs_at(const stations *s, uint32_t i, pair *to)
{
	const station *a = s->at + i;
	float far = reach * s->px;
	uint32_t count = 0;
	if (!is_drawn(a))
		return 0;
	const station_grid *g = &s->grid;
	float x = (float)(a->x - g->x), y = (float)(a->y - g->y), dx = a->dx, dy = a->dy;
	station_rows w = rows_near(g, a->x, a->y, far + abreast);
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
			if (!(share > 0))
				continue;
			if (to)
				to[count] = (pair){g->station[k], share};
			count++;
		}
	return count;
}

static void find_pairs(void *data, int first, int end, int thread)
{
	(void)thread;
	const pairs *p = data;
	for (int i = first; i < end && !stopped_at(p->s->n, i); i++) {
		uint32_t count = pairs_at(p->s, (uint32_t)i, p->pair ? p->pair + p->first[i] : NULL);
		if (!p->pair)
			p->first[i + 1] = count;
	}
}

/* ---- rounds ---------------------------------------------------------------------------------------------- */

static void give_way(void *data, int first, int end, int thread)
{
	(void)thread;
	const pairs *p = data;
	const stations *s = p->s;
	for (int i = first; i < end && !stopped_at(s->n, i); i++) {
		float least = 1;
		for (uint32_t k = p->first[i]; k < p->first[i + 1]; k++)
			least = min(least, 1 - p->pair[k].share * s->at[p->pair[k].to].keep);
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
	pairs p = {s, late_take(&n->f->late, (size_t)s->count + 1, sizeof *p.first), NULL};
	if (!p.first)
		return ENCRE_ERROR_MEMORY;
	int32_t code = bands_run(n->f->bands, (int)s->count, STATION_CHUNK, find_pairs, &p);
	uint64_t sum = 0;
	p.first[0] = 0;
	for (uint32_t i = 0; !code && i < s->count; i++) {
		sum += p.first[i + 1];
		p.first[i + 1] = (uint32_t)sum;
	}
	if (code)
		return code;
	p.pair = sum < UINT32_MAX ? late_take(&n->f->late, (size_t)sum, sizeof *p.pair) : NULL;
	if (!p.pair)
		return ENCRE_ERROR_MEMORY;
	code = bands_run(n->f->bands, (int)s->count, STATION_CHUNK, find_pairs, &p);
	for (uint32_t i = 0; i < s->count; i++)
		s->at[i].keep = is_drawn(s->at + i) ? 1 : 0;
	for (int round = 0; !code && round < ROUNDS; round++) {
		code = bands_run(n->f->bands, (int)s->count, STATION_CHUNK, give_way, &p);
		code = code ? code : bands_run(n->f->bands, (int)s->count, STATION_CHUNK, set_keep, s);
		code = code ? code : bands_run(n->f->bands, s->runs, RUN_CHUNK, even_runs, s);
		code = code ? code : bands_run(n->f->bands, (int)s->count, STATION_CHUNK, set_keep, s);
	}
	late_drop(&n->f->late, p.pair);
	late_drop(&n->f->late, p.first);
	return code;
}
