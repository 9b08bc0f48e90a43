/* SPDX-License-Identifier: GPL-3.0-or-later */
/* How lines turn: where ink gathers, and where strokes go on beyond corners. And how far along them a site is, by the
 * place on its thing. */
#include "ink/turns.h"

#include "base/stage.h"
#include "fine/near.h"

enum { CHUNK = 1024 };

/* Pixels along a line over which its way is told: single links jump from one crack to the next. */
static const float arm = 6, least_arm = 2;
/* 1 less the cosine: strokes end where a line turns by more than 35 degrees within its arms. */
static const float corner = 0.18f;
/* A bend that is as sharp all along is no corner: half an arm on it has this share of the turn. */
static const float passing = 0.7f;

typedef struct reached {
	uint32_t last;
	float dx, dy, length; /* from where the walk began, and along the line */
	float most, least;    /* of the turns on the way: all, and those in its farther half */
} reached;

/* Walks from i over `first`, to where lines meet or end. turn: by site, or NULL. */
static reached walk(const fine *n, uint32_t i, uint32_t first, float reach, const float *turn)
{
	const placed *from = &n->site[i].placed;
	reached r = {.last = i, .least = 2};
	uint32_t before = i, at = first;
	while (at != UINT32_MAX && at != i && !n->site[at].linked.dropped && r.length < reach) {
		const placed *a = &n->site[before].placed, *b = &n->site[at].placed;
		float step = sqrtf(apart2(n->site + before, n->site + at)),
		      share = r.length + step > reach ? (reach - r.length) / step : 1;
		r.dx = mix(a->x, b->x, share) - from->x;
		r.dy = mix(a->y, b->y, share) - from->y;
		r.length += share * step;
		if (turn) {
			r.most = max(r.most, turn[at] + (at < i ? 0 : -1e-6f));
			r.least = r.length > 0.5f * reach ? min(r.least, turn[at]) : r.least;
		}
		uint32_t next = next_of(n, before, at);
		before = r.last = at;
		at = next;
	}
	return r;
}

static bool unit_of(reached *r)
{
	float length = sqrtf(r->dx * r->dx + r->dy * r->dy);
	if (!(length > 0.5f * least_arm))
		return false;
	r->dx /= length;
	r->dy /= length;
	return true;
}

/* Told by arms: where lines meet, single links go any way. */
static uint32_t straight_on(const fine *n, uint32_t from, uint32_t i)
{
	reached a = walk(n, i, from, arm, NULL);
	uint32_t next = UINT32_MAX;
	float least = 1;
	if (!unit_of(&a))
		return next;
	for (uint32_t k = n->at[i]; k < n->at[i + 1]; k++) {
		reached b = walk(n, i, n->to[k], arm, NULL);
		if (n->to[k] == from || !unit_of(&b) || !(1 + a.dx * b.dx + a.dy * b.dy < least))
			continue;
		least = 1 + a.dx * b.dx + a.dy * b.dy;
		next = n->to[k];
	}
	return next;
}

uint32_t ISA(onward)(const fine *n, uint32_t from, uint32_t i)
{
	if (links_at(n, i) == 2)
		return next_of(n, from, i);
	uint32_t next = straight_on(n, from, i);
	return next != UINT32_MAX && straight_on(n, next, i) == from ? next : UINT32_MAX;
}

typedef struct finding {
	const fine *n;
	float *turn;
	float room;
} finding;

static void turn_rows(void *data, int first, int end, int thread)
{
	(void)thread;
	const finding *g = data;
	const fine *n = g->n;
	for (int i = first; i < end && !stopped_at(n, i); i++) {
		g->turn[i] = 0;
		if (n->site[i].linked.dropped || links_at(n, (uint32_t)i) != 2)
			continue;
		const uint32_t *to = n->to + n->at[i];
		reached a = walk(n, (uint32_t)i, to[0], arm, NULL), b = walk(n, (uint32_t)i, to[1], arm, NULL);
		if (unit_of(&a) && unit_of(&b) && a.length >= least_arm && b.length >= least_arm)
			g->turn[i] = 1 + a.dx * b.dx + a.dy * b.dy;
	}
}

/* The sharpest of a bend that has straight arms. */
static bool is_corner(const finding *g, uint32_t i)
{
	const fine *n = g->n;
	const float *turn = g->turn;
	if (!(turn[i] > corner))
		return false;
	for (uint32_t k = n->at[i]; k < n->at[i + 1]; k++) {
		reached r = walk(n, i, n->to[k], arm, turn);
		if (r.most >= turn[i] || r.least > passing * turn[i])
			return false;
	}
	return true;
}

/* How long the stroke is that ends at i and comes over `first`: back to where others meet it, or to its corner before.
 * Round a nail a line may go on for long, and yet each stroke of it is short. */
static float room_of(const finding *g, uint32_t i, uint32_t first)
{
	const site *s = g->n->site;
	float length = 0;
	for (uint32_t before = i, at = first, next; length < g->room; before = at, at = next) {
		if (at == UINT32_MAX || at == i || s[at].linked.dropped)
			break;
		length += sqrtf(apart2(s + before, s + at));
		if (is_corner(g, at))
			break;
		next = next_of(g->n, before, at);
	}
	return min(length, g->room);
}

/* The strokes that end at a site where others meet them; stored from `at` on unless that is NULL. */
static uint32_t spurs_at(const finding *g, uint32_t i, spur *at)
{
	enum { MOST = 4 };
	const fine *n = g->n;
	uint32_t links = links_at(n, i), count = 0;
	reached way[MOST];
	if (n->site[i].linked.dropped || links < 2 || links > MOST || (links == 2 && !is_corner(g, i)))
		return 0;
	for (uint32_t k = 0; k < links; k++) {
		way[k] = walk(n, i, n->to[n->at[i] + k], arm, NULL);
		if (!unit_of(way + k))
			way[k].length = 0;
	}
	for (uint32_t k = 0; k < links; k++) {
		bool ends = way[k].length >= least_arm;
		for (uint32_t j = 0; j < links; j++)
			ends &= j == k || way[j].length == 0 ||
				1 + way[k].dx * way[j].dx + way[k].dy * way[j].dy > corner;
		if (!ends)
			continue;
		if (at)
			at[count] = (spur){i, way[k].last, -way[k].dx, -way[k].dy, room_of(g, i, n->to[n->at[i] + k])};
		count++;
	}
	return count;
}

int32_t ISA(turns_find)(frame *f, float room, turns *t)
{
	const fine *n = f->fine;
	t->turn = late_take(&f->late, n->count, sizeof *t->turn);
	finding g = {n, t->turn, room};
	if (!t->turn)
		return ENCRE_ERROR_MEMORY;
	int32_t code = bands_run(f->bands, (int)n->count, CHUNK, turn_rows, &g);
	for (int pass = 0; pass < 2 && room > 0; pass++) {
		t->spurs = 0;
		for (uint32_t i = 0; !code && i < n->count; i++) {
			code = at_step(n, i);
			t->spurs += spurs_at(&g, i, t->spur ? t->spur + t->spurs : NULL);
		}
		if (code || pass || !t->spurs)
			return code;
		t->spur = late_take(&f->late, t->spurs, sizeof *t->spur);
		if (!t->spur)
			return ENCRE_ERROR_MEMORY;
	}
	return code;
}

/* ---- dashes ---------------------------------------------------------------------------------------------- */

/* Sites each way from which a line's place on its thing is told: at a rim that looks far to the side it jumps. */
enum { STEPS = 8 };
/* What moves more than so many times a pixel's size for each pixel runs over to another thing. */
static const float most_slant = 12;

/* The sites on one side that lie on the same thing, in `on`; returns how many. */
static int steps_on(const fine *n, const spots *p, uint32_t i, uint32_t first, uint32_t on[STEPS])
{
	uint32_t before = i, at = first;
	int count = 0;
	while (count < STEPS && at != UINT32_MAX && at != i && !n->site[at].linked.dropped) {
		float x = p->x[at] - p->x[before], y = p->y[at] - p->y[before], z = p->z[at] - p->z[before];
		float most = most_slant * p->unit[before] / n->f->scale *
			     max(1, sqrtf(apart2(n->site + before, n->site + at)));
		if (!(x * x + y * y + z * z <= most * most) || n->site[at].found.family != n->site[i].found.family)
			break;
		on[count++] = at;
		uint32_t next = next_of(n, before, at);
		before = at;
		at = next;
	}
	return count;
}

/* The thirteen ways between a cube's opposite corners, edges and faces; as many more as fill a vector are no others. */
enum { WAYS = 13, LANES_OF_WAYS = 16 };

typedef struct ways {
	/* from the first site to the last, up and down from site to site, and those in the middle together */
	float net[LANES_OF_WAYS], all[LANES_OF_WAYS], sum[LANES_OF_WAYS];
} ways;

/* The ways are the inner loops, which are vectorised so. */
static void along_ways(const spots *p, const uint32_t *on, int count, int from, int to, ways *w)
{
	float wx[LANES_OF_WAYS], wy[LANES_OF_WAYS], wz[LANES_OF_WAYS], inverse[LANES_OF_WAYS];
	float first[LANES_OF_WAYS], before[LANES_OF_WAYS];
	for (int k = 0; k < LANES_OF_WAYS; k++) {
		int at = k < WAYS ? 14 + k : 14, column = at % 3, row = at / 3 % 3, slice = at / 9;
		float x = (float)(column - 1), y = (float)(row - 1), z = (float)(slice - 1);
		wx[k] = x;
		wy[k] = y;
		wz[k] = z;
		inverse[k] = 1 / sqrtf(x * x + y * y + z * z);
		first[k] = before[k] = w->all[k] = w->sum[k] = 0;
	}
	for (int j = 0; j < count; j++) {
		float x = p->x[on[j]], y = p->y[on[j]], z = p->z[on[j]];
		bool middle = j >= from && j <= to;
		for (int k = 0; k < LANES_OF_WAYS; k++) {
			float along = (x * wx[k] + y * wy[k] + z * wz[k]) * inverse[k];
			first[k] = j ? first[k] : along;
			w->all[k] += j ? fabsf(along - before[k]) : 0;
			w->sum[k] += middle ? along : 0;
			before[k] = along;
		}
	}
	for (int k = 0; k < LANES_OF_WAYS; k++)
		w->net[k] = fabsf(before[k] - first[k]);
}

beat ISA(beat_of)(const fine *n, const spots *p, uint32_t i, float length)
{
	uint32_t on[2 * STEPS + 1], side[STEPS], links = links_at(n, i);
	int count = 0;
	if (links < 1 || links > 2)
		return (beat){0};
	int left = steps_on(n, p, i, n->to[n->at[i]], side);
	for (int k = left; k > 0; k--)
		on[count++] = side[k - 1];
	on[count++] = i;
	if (links == 2)
		count += steps_on(n, p, i, n->to[n->at[i] + 1], on + count);
	/* as many on both sides, or the mean lies elsewhere */
	int each = left < count - 1 - left ? left : count - 1 - left;
	uint32_t a = on[0], b = on[count - 1];
	float far = 0, place = 0, best = -INFINITY;
	/* along the one that is nearest, and least unsteady: a straight line has one all along, a small ring none */
	ways w;
	along_ways(p, on, count, left - each, left + each, &w);
	for (int k = 0; k < WAYS; k++) {
		float score = w.net[k] - 2 * (w.all[k] - w.net[k]);
		if (score > best) {
			best = score;
			far = w.net[k];
			place = w.sum[k] / (float)(2 * each + 1);
		}
	}
	float rate = sqrtf(apart2(n->site + a, n->site + b)) / (length * far);
	if (!(rate > 1e-30f && rate < 1e30f))
		return (beat){0};
	/* whole powers of two of places part dashes; between them half that part, as far as the next is near */
	int32_t bits = float_bits(rate);
	float scale = bits_float(bits & 0x7f800000), times = rate / scale, at = place * scale;
	at = fabsf(at) < 1e9f ? at : 0;
	float number = floorf(at);
	at -= number;
	return (beat){.whole = min(at, 1 - at) * times * length,
		      .half = fabsf(at - 0.5f) * times * length,
		      .born = times - 1,
		      .length = length,
		      .at = at,
		      .octave = bits >> 23,
		      .number = (int32_t)number};
}
