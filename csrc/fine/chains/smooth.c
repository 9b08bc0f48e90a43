/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Lines of round forms with few faces: each run is moved onto the fairest curve that lies near enough to its edges.
 * The curve bends as little as it can, sum of (p[i-1] - 2 p[i] + p[i+1])^2, and is drawn to its edges by weights that
 * grow where it strays too far: a band of five diagonals, solved a few times. Corners and what is flat stay. */
#include "fine/chains/stations.h"

#include <math.h>

enum { ROUNDS = 16, PLACES = 4 /* from knot to knot, at which it is asked how the way bends */ };

static const double knot_step = 2;      /* px from knot to knot, at least a pixel */
static const double wave = 0.7;         /* of an edge's length: what of a line is longer is drawn to its edges */
static const double longest_edge = 120; /* px: counted as no longer */
static const double overlap = 200;      /* px of a closed run that are solved twice, so that nothing shows where */
static const double least_edge = 3;     /* px: a run of shorter edges is as smooth as can be seen */
/* Cosines of 50 degrees, which are smoothed, and of 75, which stay; of the way from what stays, how far it may stray.
 */
static const double straight = 0.643, corner = 0.259, slope = 0.3;
static const float solid_from = 4;      /* px: thinner things stay as they are, others lose a quarter of the rest */
static const float follow_reach = 1.6f; /* pixels from the end of a run to the line that it meets */
static const float own_run = 4;         /* pixels along a run that do not count as another line */

typedef struct knot {
	double x, y;             /* where the edges are */
	double more[2];          /* pixels beyond these to which the curve is drawn, as far as it is free */
	double to_x, to_y;       /* where it is */
	double far;              /* pixels that these may lie apart */
	double edge;             /* pixels that the edge is long */
	double stiff;            /* by which it is straight there: 0 at corners */
	double weight, lightest; /* by which it is drawn */
	double diagonal, next, after, sum[2];
} knot;

typedef struct place {
	double x, y;
} place;

typedef struct smoothing {
	stations *s;
	knot *knots;   /* by thread */
	place *places; /* by thread, PLACES times as many */
	size_t room;   /* of knots of each */
	float *shift;  /* by end of a run: x, y */
} smoothing;

/* ---- how far ----------------------------------------------------------------------------------------------- */

/* Pixels that a station may be moved by, corners apart. */
static double stray_of(const stations *s, const station *t)
{
	const frame *f = s->n->f;
	if (!(t->kind & ENCRE_CHAIN_ROUND))
		return 0;
	float most = params_at(f, t->near_x, t->near_y)->line_smooth * f->scale;
	if (t->importance == IMPORTANCE_CONTOUR && t->side)
		most = min(most, 0.25f * max(t->apart - solid_from * s->px, 0));
	return (double)most;
}

static double length_of(const stations *s, int32_t run, bool *closed)
{
	const station *a = s->at + s->first[run], *b = s->at + s->first[run + 1] - 1;
	double x = a->x - b->x, y = a->y - b->y;
	*closed = a->flags & STATION_CLOSED;
	return (double)b->s + (*closed ? sqrt(x * x + y * y) : 0);
}

/* Whether any of a run's edges is long enough for corners to be seen, and may be moved. */
static bool has_corners(const stations *s, int32_t run)
{
	uint32_t from = s->first[run], end = s->first[run + 1];
	double least = least_edge * (double)s->n->f->scale;
	least = least > 2 ? least : 2;
	for (uint32_t i = from + 1, first = from; i < end; i++) {
		const station *a = s->at + first, *b = s->at + i;
		if (a->mesh != b->mesh || a->edge != b->edge)
			first = i;
		else if ((double)(b->s - a->s) > least && stray_of(s, b) > 0)
			return true;
	}
	return false;
}

/* ---- knots ------------------------------------------------------------------------------------------------- */

static double step_of(const stations *s)
{
	double step = knot_step * (double)s->n->f->scale;
	return step > 1 ? step : 1;
}

/* Pixels of the run that the edge of station i has. */
static double edge_at(const stations *s, int32_t run, uint32_t i, uint32_t group[2])
{
	uint32_t end = s->first[run + 1];
	if (i < group[0] || i >= group[1]) {
		group[0] = i;
		for (group[1] = i + 1;
		     group[1] < end && s->at[group[1]].mesh == s->at[i].mesh && s->at[group[1]].edge == s->at[i].edge;)
			group[1]++;
	}
	return (double)(s->at[group[1] - 1].s - s->at[group[0]].s) + (double)station_step;
}

/* Of `count` knots, the first at `from` pixels along the run and each `step` farther on, and of places between them. */
static void lay_knots(const stations *s, int32_t run, knot *k, place *to, int64_t count, double from, double step,
		      double whole)
{
	uint32_t first = s->first[run], end = s->first[run + 1], at = first, group[2] = {0, 0};
	int64_t places = (count - 1) * PLACES + 1;
	double turn = floor(from / whole); /* of a closed run: how often it has gone round */
	for (int64_t i = 0; i < places; i++) {
		double along = from + (double)i * step / PLACES, own = along - turn * whole;
		if (own >= whole && i + 1 < places) {
			turn += 1;
			own -= whole;
			at = first;
		}
		while (at + 1 < end && (double)s->at[at + 1].s < own)
			at++;
		const station *a = s->at + at, *b = s->at + (at + 1 < end ? at + 1 : first);
		double until = at + 1 < end ? (double)b->s : whole, gap = until - (double)a->s;
		double t = gap > 1e-6 ? (own - (double)a->s) / gap : 0;
		t = t < 0 ? 0 : t > 1 ? 1 : t;
		to[i] = (place){a->x + t * (b->x - a->x), a->y + t * (b->y - a->y)};
		if (i % PLACES)
			continue;
		double far = stray_of(s, a), its = stray_of(s, b);
		k[i / PLACES] = (knot){
			.x = to[i].x, .y = to[i].y, .far = far < its ? far : its, .edge = edge_at(s, run, at, group)};
	}
}

/* At any place between these. */
static place place_at(const place *p, double at)
{
	int64_t i = (int64_t)at;
	double t = at - (double)i;
	return (place){p[i].x + t * (p[i + 1].x - p[i].x), p[i].y + t * (p[i + 1].y - p[i].y)};
}

/* How far the way bends at a place, over as much as the curve may cut off: 1 hardly, 0 as a corner does. Exactly so
 * far, and not as many places: with one more or fewer the curve would be another. */
static double roundness_at(const place *p, int64_t at, double reach, int64_t count)
{
	if (!((double)at - reach >= 0 && (double)at + reach < (double)(count - 1)))
		return 1;
	place before = place_at(p, (double)at - reach), after = place_at(p, (double)at + reach);
	double ux = p[at].x - before.x, uy = p[at].y - before.y, vx = after.x - p[at].x, vy = after.y - p[at].y;
	double length = sqrt((ux * ux + uy * uy) * (vx * vx + vy * vy));
	double cosine = length > 1e-12 ? (ux * vx + uy * vy) / length : 1,
	       share = (cosine - corner) / (straight - corner);
	return share < 0 ? 0 : share > 1 ? 1 : share;
}

/* About a knot: a corner may lie between two. */
static double roundness(const place *p, int64_t knot, double reach, int64_t count)
{
	double least = 1;
	for (int64_t i = knot * PLACES - PLACES / 2; i <= knot * PLACES + PLACES / 2; i++)
		least = fmin(least, roundness_at(p, i, reach, count));
	return least;
}

static void bound_knots(const stations *s, knot *k, const place *places, int64_t count, double step)
{
	double most = 0, longest = longest_edge * (double)s->n->f->scale;
	for (int64_t i = 0; i < count; i++) {
		most = fmax(most, k[i].far);
		k[i].edge = fmin(k[i].edge, longest);
	}
	double reach = PLACES * fmax(2 * most, 3) / step;
	for (int64_t i = 0; i < count; i++) {
		k[i].stiff = roundness(places, i, reach, (count - 1) * PLACES + 1);
		k[i].far *= k[i].stiff;
	}
	k[0].stiff = k[count - 1].stiff = 0;
	for (int64_t i = 1; i < count; i++) {
		k[i].far = fmin(k[i].far, k[i - 1].far + slope * step);
		k[i].edge = fmax(k[i].edge, k[i - 1].edge - 2 * step);
	}
	for (int64_t i = count - 1; i-- > 0;) {
		k[i].far = fmin(k[i].far, k[i + 1].far + slope * step);
		k[i].edge = fmax(k[i].edge, k[i + 1].edge - 2 * step);
	}
	for (int64_t i = 0; i < count; i++) {
		double share = most > 0 ? k[i].far / most : 0, ratio = step / fmax(wave * k[i].edge * share, step / 6);
		k[i].weight = ratio * ratio * ratio * ratio;
	}
}

/* ---- the curve --------------------------------------------------------------------------------------------- */

/* 1 where nothing keeps it from being as fair as it may, less the more it is drawn to its edges. */
static double freedom(const knot *k)
{
	return sqrt(sqrt(k->lightest / k->weight));
}

/* Solves for to_x, to_y by the factors L D L' of the band; count >= 3. */
static void solve(knot *k, int64_t count)
{
	for (int64_t i = 0; i < count; i++) {
		double before = i > 0 ? k[i - 1].stiff : 0, here = k[i].stiff,
		       after = i + 1 < count ? k[i + 1].stiff : 0;
		double next = -2 * (here + after);
		k[i].diagonal = k[i].weight + before + 4 * here + after;
		k[i].to_x = k[i].weight * (k[i].x + freedom(k + i) * k[i].more[0]);
		k[i].to_y = k[i].weight * (k[i].y + freedom(k + i) * k[i].more[1]);
		if (i >= 1) {
			const knot *p = k + i - 1;
			k[i].diagonal -= p->diagonal * p->next * p->next;
			next -= p->diagonal * p->next * p->after;
			k[i].to_x -= p->next * p->to_x;
			k[i].to_y -= p->next * p->to_y;
		}
		if (i >= 2) {
			const knot *p = k + i - 2;
			k[i].diagonal -= p->diagonal * p->after * p->after;
			k[i].to_x -= p->after * p->to_x;
			k[i].to_y -= p->after * p->to_y;
		}
		k[i].next = next / k[i].diagonal;
		k[i].after = after / k[i].diagonal;
	}
	for (int64_t i = count; i-- > 0;) {
		k[i].to_x /= k[i].diagonal;
		k[i].to_y /= k[i].diagonal;
		for (int64_t n = 1; n <= 2 && i + n < count; n++) {
			double share = n == 1 ? k[i].next : k[i].after;
			k[i].to_x -= share * k[i + n].to_x;
			k[i].to_y -= share * k[i + n].to_y;
		}
	}
}

static double strays(const knot *k)
{
	double x = k->to_x - k->x, y = k->to_y - k->y;
	return sqrt(x * x + y * y);
}

/* A curve that bends little is smaller than its edges: what it lacks in the mean along an edge either way is added
 * to where it is drawn. */
static void add_more(knot *k, int64_t count, double step)
{
	double sum[2] = {0, 0};
	for (int64_t i = 0; i < count; i++) {
		k[i].sum[0] = sum[0] += k[i].x - k[i].to_x;
		k[i].sum[1] = sum[1] += k[i].y - k[i].to_y;
	}
	for (int64_t i = 0; i < count; i++) {
		int64_t reach = (int64_t)(k[i].edge / step) + 1;
		reach = reach > i ? i : reach;
		reach = reach > count - 1 - i ? count - 1 - i : reach;
		for (int c = 0; c < 2; c++) {
			double before = i > reach ? k[i - reach - 1].sum[c] : 0;
			k[i].more[c] += freedom(k + i) * (k[i + reach].sum[c] - before) / (double)(2 * reach + 1);
		}
		double far = sqrt(k[i].more[0] * k[i].more[0] + k[i].more[1] * k[i].more[1]);
		for (int c = 0; c < 2 && far > k[i].far; c++) /* or it grows from round to round */
			k[i].more[c] *= k[i].far / far;
	}
}

static void find_curve(knot *k, int64_t count, double step, bool pinned)
{
	const double heaviest = 1296, least_far = 1e-3, back = 0.8, on = 2;
	for (int64_t i = 0; i < count; i++)
		k[i].lightest = k[i].weight;
	for (int round = 0; round < ROUNDS; round++) {
		if (pinned)
			k[0].weight = k[count - 1].weight = heaviest;
		solve(k, count);
		for (int64_t i = 0; i < count; i++) {
			double share = fmin(fmax(strays(k + i) / fmax(k[i].far, least_far), back), on);
			k[i].weight = fmin(fmax(k[i].weight * share * share, k[i].lightest), heaviest);
		}
		add_more(k, count, step);
	}
	for (int64_t i = 0; i < count; i++) {
		double far = strays(k + i), kept = far > k[i].far ? k[i].far / far : 1;
		k[i].to_x = k[i].x + kept * (k[i].to_x - k[i].x);
		k[i].to_y = k[i].y + kept * (k[i].to_y - k[i].y);
	}
}

/* On the grid where floats are exact. */
static double on_fine_grid(double v)
{
	return floor(v * 4096 + 0.5) / 4096;
}

static void move_stations(stations *s, int32_t run, const knot *k, int64_t count, double from, double step)
{
	for (uint32_t i = s->first[run]; i < s->first[run + 1]; i++) {
		station *t = s->at + i;
		double at = ((double)t->s - from) / step;
		int64_t j = (int64_t)at;
		j = j < 0 ? 0 : j > count - 2 ? count - 2 : j;
		const knot *a = k + j, *b = a + 1;
		double share = at - (double)j, round = fmin(a->stiff, b->stiff), dx = b->to_x - a->to_x,
		       dy = b->to_y - a->to_y;
		double length = sqrt(dx * dx + dy * dy);
		/* at corners as far as the knots about it are, else between these: there a corner would be left */
		double x = t->x + a->to_x - a->x + share * (dx - b->x + a->x),
		       y = t->y + a->to_y - a->y + share * (dy - b->y + a->y);
		t->x = on_fine_grid(x + round * (a->to_x + share * dx - x));
		t->y = on_fine_grid(y + round * (a->to_y + share * dy - y));
		if (round > 0.5 && length > 1e-6) {
			t->dx = (float)(dx / length);
			t->dy = (float)(dy / length);
		}
	}
}

static int64_t knots_of(const stations *s, int32_t run, bool *closed, double *whole, double *step, int64_t *more)
{
	*whole = length_of(s, run, closed);
	double n = fmax(floor(*whole / step_of(s) + 0.5), 2);
	*step = *whole / n;
	*more = *closed ? (int64_t)(overlap * fmax((double)s->n->f->scale, 0.25) / step_of(s)) + 1 : 0;
	return (int64_t)n + 1 + 2 * *more;
}

static void smooth_runs(void *data, int first, int end, int thread)
{
	const smoothing *m = data;
	stations *s = m->s;
	knot *k = m->knots + (size_t)thread * m->room;
	place *places = m->places + (size_t)thread * m->room * PLACES;
	for (int run = first; run < end && !bands_stopped(s->n->f->bands); run++) {
		bool closed;
		double whole, step;
		int64_t more;
		if (!(s->first[run + 1] - s->first[run] > 2) || !has_corners(s, run))
			continue;
		int64_t count = knots_of(s, run, &closed, &whole, &step, &more);
		double from = -(double)more * step;
		lay_knots(s, run, k, places, count, from, step, whole);
		if (!closed)
			k[0].far = k[count - 1].far = 0;
		bound_knots(s, k, places, count, step);
		find_curve(k, count, step, !closed);
		move_stations(s, run, k, count, from, step);
	}
}

/* ---- what meets them --------------------------------------------------------------------------------------- */

/* By how much the line has been moved that a run meets at an end. */
static void find_shift(const stations *s, const station *t, float shift[2])
{
	const station_grid *g = &s->grid;
	float x = (float)(t->x - g->x), y = (float)(t->y - g->y), least = follow_reach * follow_reach;
	station_rows w = rows_beside(g, t->x, t->y, t, follow_reach, follow_reach);
	shift[0] = shift[1] = 0;
	while (next_row(g, &w))
		for (uint32_t k = w.from; k < w.end; k++) {
			const station *o = s->at + g->station[k];
			float dx = g->px[k] - x, dy = g->py[k] - y, d2 = dx * dx + dy * dy;
			if (!(d2 < least) || (o->run == t->run && fabsf(o->s - t->s) < own_run))
				continue;
			least = d2;
			shift[0] = (float)(o->x - g->x) - g->px[k];
			shift[1] = (float)(o->y - g->y) - g->py[k];
		}
}

static void find_shifts(void *data, int first, int end, int thread)
{
	(void)thread;
	const smoothing *m = data;
	const stations *s = m->s;
	for (int i = first; i < end && !stopped_at(s->n, i); i++)
		for (int e = 0; e < 2; e++) {
			float *shift = m->shift + 4 * (size_t)i + 2 * e;
			const station *t = s->at + (e ? s->first[i + 1] - 1 : s->first[i]);
			shift[0] = shift[1] = 0;
			if (s->first[i] < s->first[i + 1] && t->flags & STATION_TIED && !(t->flags & STATION_CLOSED))
				find_shift(s, t, shift);
		}
}

/* It follows, less and less away from its end. */
static void follow(void *data, int first, int end, int thread)
{
	(void)thread;
	const smoothing *m = data;
	stations *s = m->s;
	for (int i = first; i < end && !stopped_at(s->n, i); i++)
		for (int e = 0; e < 2; e++) {
			const float *shift = m->shift + 4 * (size_t)i + 2 * e;
			float far = 8 * (fabsf(shift[0]) + fabsf(shift[1]));
			if (!(far > 0))
				continue;
			uint32_t from = s->first[i], last = s->first[i + 1] - 1;
			float whole = s->at[last].s;
			far = min(far, whole);
			for (uint32_t k = from; k <= last; k++) {
				station *t = s->at + k;
				float along = e ? whole - t->s : t->s, share = far > 0 ? clamp01(1 - along / far) : 1;
				share *= share;
				t->x = on_fine_grid(t->x + (double)(share * shift[0]));
				t->y = on_fine_grid(t->y + (double)(share * shift[1]));
			}
		}
}

/* ---- all --------------------------------------------------------------------------------------------------- */

static bool is_asked(const stations *s)
{
	bool any = false;
	for (int i = 0; i < s->n->f->n_styles; i++)
		any |= s->n->f->params[i].line_smooth > 0;
	return any;
}

int32_t ISA(stations_smooth)(stations *s)
{
	fine *n = s->n;
	size_t most = 0, threads = (size_t)bands_threads(n->f->bands);
	if (!is_asked(s))
		return ENCRE_OK;
	for (int32_t i = 0; i < s->runs; i++) {
		bool closed;
		double whole, step;
		int64_t more;
		if (s->first[i] == s->first[i + 1])
			continue;
		size_t count = (size_t)knots_of(s, i, &closed, &whole, &step, &more);
		most = count > most ? count : most;
	}
	smoothing m = {s, late_take(&n->f->late, threads * most, sizeof *m.knots),
		       late_take(&n->f->late, PLACES * threads * most, sizeof *m.places), most,
		       late_take(&n->f->late, 4 * (size_t)s->runs, sizeof *m.shift)};
	if (!m.knots || !m.places || !m.shift)
		return ENCRE_ERROR_MEMORY;
	int32_t code = bands_run(n->f->bands, s->runs, 1, smooth_runs, &m);
	code = code ? code : bands_run(n->f->bands, s->runs, RUN_CHUNK, find_shifts, &m);
	code = code ? code : bands_run(n->f->bands, s->runs, RUN_CHUNK, follow, &m);
	late_drop(&n->f->late, m.shift);
	late_drop(&n->f->late, m.places);
	late_drop(&n->f->late, m.knots);
	return code;
}
