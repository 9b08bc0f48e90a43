/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Thin things and tips: where the two contours of one thing run beside each other, a few pixels apart, their lines thin
 * out, so that something is left of the thing between them, and where they meet, the line gets no bead. */
#include "fine/near.h"

#include <string.h>

enum { CHUNK = 512, AROUND = 16 /* sites in a px of room each way along a line */, MEETINGS = 4, LONG = 6, LOOP = 32 };

/* Px. What is wider is no thin thing, and no line of one is made thinner. */
static const float widest = 24, least_radius = 1.25f, least_tip = 0.75f; /* test_fine_passes */
static const float least_pixels = 0.5f;
static const float rounder = 0.524f;            /* so that a disc is as wide as it is */
static const float share = 0.25f;               /* of the thing, that half a line of it may take; test_fine_passes */
static const float parted = 0.5f, along = 0.8f; /* cosines of contours that have nothing to do with each other, and that
						   run along each other; test_fine_passes */
static const float corner = 0.3f;               /* cosine of what a line turns by that is none; test_thin */
static const float level = 0.05f, tapered = 0.15f,
		   acute = 0.3f; /* sines of contours of a rod, and of a tip; test_fine_passes */

/* 1 / half the width that a line may have, 0: any; how much a thing tapers. */
typedef struct bound {
	float crowd, tapers;
} bound;

/* What is read of a site on the way, close together. */
typedef struct stop {
	bound bound;
	uint32_t both; /* as both_of() */
} stop;

/* What bounds lines on the ways that a link leads, over so many meetings, and how many sites the longest of them has;
 * TOO_LONG: more than count. By link; only of those that meetings have. */
typedef struct ways {
	bound *most;
	uint8_t *sites;
} ways;

enum { TOO_LONG = UINT8_MAX };

typedef struct slender {
	fine *n;
	stop *stop; /* by site */
	ways known, next;
	float unit; /* pixels of a px */
	int reach;  /* pixels */
	int around; /* sites each way along a line */
} slender;

static bool is_contour(const site *s)
{
	return !s->linked.dropped && s->found.family == FAMILY_CRACK && s->found.axis <= AXIS_COLUMN;
}

/* The ways of the line from a site on, up (or left) and down (or right) along the side of a pixel that it crosses
 * there, to the last such site a few on: others, where it turns from row to row, are not placed as well. 0 where it
 * ends. */
static void ways_from(const fine *n, uint32_t i, float way[2][2])
{
	const site *s = n->site + i;
	memset(way, 0, 2 * sizeof *way);
	for (uint32_t k = n->at[i]; links_at(n, i) <= 2 && k < n->at[i + 1]; k++) {
		uint32_t from = i, at = n->to[k], last = i;
		const placed *first = &n->site[at].placed;
		int down = s->found.axis == AXIS_ROW ? first->y > s->placed.y : first->x > s->placed.x;
		for (int step = 0; step < LONG && at != UINT32_MAX && at != i; step++) {
			uint32_t next = next_of(n, from, at);
			last = n->site[at].found.axis == s->found.axis ? at : last;
			from = at;
			at = next;
		}
		float x = n->site[last].placed.x - s->placed.x, y = n->site[last].placed.y - s->placed.y,
		      length = sqrtf(x * x + y * y);
		if (length > 0.5f) {
			way[down][0] = x / length;
			way[down][1] = y / length;
		}
	}
}

/* The other side of a thing. */
typedef struct side {
	uint32_t contour; /* its number; n->count: it is far, covered, or dropped */
	int far;          /* pixels to where another thing begins behind it; 0: not known */
} side;

/* The first of pixels from .. most, `step` apart, with a mark; beyond most where none has it. Most have none: four at
 * once tell. */
static int next_mark(const uint8_t *crack, ptrdiff_t step, uint8_t mark, int from, int most)
{
	for (; from + 3 <= most; from += 4) {
		const uint8_t *c = crack + from * step;
		if ((c[0] | c[step] | c[2 * step] | c[3 * step]) & mark)
			break;
	}
	while (from <= most && !(crack[from * step] & mark))
		from++;
	return from;
}

/* What is opposite the contour at site i. Where something lies before the thing, its own contour is covered, if behind
 * that is neither the thing nor what is nearer. */
static side opposite(const slender *w, const site *s)
{
	const fine *n = w->n;
	const frame *f = n->f;
	side none = {n->count, 0};
	int axis = s->found.axis, dx = axis == AXIS_ROW, dy = 1 - dx, x = s->found.column, y = s->found.row;
	float own = depth_at(f, x, y), its = depth_at(f, x + dx, y + dy), thing = 0; /* where it is last seen */
	if (own == its)
		return none;
	int way = own < its ? -1 : 1, size = axis ? f->height : f->width, at = axis ? y : x;
	float object = own < its ? object_at(f, x, y) : object_at(f, x + dx, y + dy);
	ptrdiff_t step = axis ? f->width : 1;
	const uint8_t *crack = n->crack + (ptrdiff_t)y * f->width + x;
	uint8_t mark = mark_of(FAMILY_CRACK, axis) & 255;
	bool covered = false;
	int room = way > 0 ? size - 2 - at : at, most = room < w->reach ? room : w->reach;
	for (int k = next_mark(crack, way * step, mark, 1, most); k <= most;
	     k = next_mark(crack, way * step, mark, k + 1, most)) {
		int cx = x + way * k * dx, cy = y + way * k * dy, on = way > 0;
		float inside = depth_at(f, on ? cx : cx + dx, on ? cy : cy + dy),
		      outside = depth_at(f, on ? cx + dx : cx, on ? cy + dy : cy);
		int far = object_at(f, on ? cx + dx : cx, on ? cy + dy : cy) != object ? k : 0;
		if (!covered && inside < outside)
			return (side){ISA(crack_number)(n, FAMILY_CRACK, cx, cy, axis), far};
		thing = covered ? thing : inside;
		covered = true;
		if (outside > thing)
			return (side){n->count, far};
	}
	return none;
}

/* Where the contours of a thing so wide are one beside the other, at an angle of this sine. */
static float bound_at(const slender *w, float wide, float sine)
{
	float far = wide / (widest * w->unit), sharp = clamp01((sine - tapered) / (acute - tapered)),
	      least = max(mix(least_radius, least_tip, sharp) * w->unit, least_pixels);
	far *= far;
	return 1 / max(share * wide / max(1 - far * far, 1e-6f), least);
}

static bound more(bound a, bound b)
{
	return (bound){max(a.crowd, b.crowd), max(a.tapers, b.tapers)};
}

/* What pixels alone say of a thin thing, where its contours have no way of their own. */
static bound thin_bound(const slender *w, const placed *s)
{
	return (bound){s->thin * bound_at(w, 2 * s->half, 0), 0};
}

/* A thing whose other contour is covered or dropped is at most so wide along the axis; 0: not known. */
static bound within(const slender *w, uint32_t i, float far)
{
	const site *s = w->n->site + i;
	float way[2][2];
	if (!(far > 0))
		return thin_bound(w, &s->placed);
	ways_from(w->n, i, way);
	const float *along = way[way[1][0] != 0 || way[1][1] != 0];
	float aside = fabsf(s->found.axis == AXIS_ROW ? along[1] : along[0]);
	bound thin = thin_bound(w, &s->placed);
	return far * aside > 0 ? more(thin, (bound){bound_at(w, far * aside, 0), 0}) : thin;
}

/* Round a thing of a few pixels a line has no ways: over some sites it turns about. How wide the thing is by the length
 * of the loop that holds both contours, and its area: as a rectangle or, where it is rounder, a disc; 0: there is none.
 * Of what is twice as long as wide, `part` is 0, and contours tell. */
static float round_width(const fine *n, uint32_t i, uint32_t j, float *part)
{
	const placed *p = &n->site[i].placed, *q = &n->site[j].placed;
	uint32_t from = i, at = links_at(n, i) == 2 ? n->to[n->at[i]] : UINT32_MAX;
	float x = 0, y = 0, length = 0, area = 0;
	bool holds = false;
	for (int sites = 0; fabsf(p->x - q->x) + fabsf(p->y - q->y) < LOOP / 2.0f && at != UINT32_MAX && sites < LOOP;
	     sites++) {
		float dx = n->site[at].placed.x - p->x - x, dy = n->site[at].placed.y - p->y - y;
		length += sqrtf(dx * dx + dy * dy);
		area += 0.5f * (x * dy - y * dx);
		x += dx;
		y += dy;
		holds |= at == j;
		if (at == i)
			break;
		uint32_t next = next_of(n, from, at);
		from = at;
		at = next;
	}
	float rest = 0.0625f * length * length - fabsf(area),
	      wide = 0.25f * length + (rest < 0 ? rounder * sqrtf(-rest) : -sqrtf(rest));
	if (at != i || !holds || !(wide > 0))
		return 0;
	*part = clamp01(2 - fabsf(area) / (wide * wide));
	return wide;
}

/* The cosine of half the angle between two contours where both run on, else 1: so much narrower is what is round
 * between two points that lie aslant, or what tapers across its middle. */
static float aslant(float own[2][2], float other[2][2])
{
	float a[2] = {own[1][0] - own[0][0], own[1][1] - own[0][1]},
	      b[2] = {other[1][0] - other[0][0], other[1][1] - other[0][1]};
	float one = sqrtf(a[0] * a[0] + a[1] * a[1]), two = sqrtf(b[0] * b[0] + b[1] * b[1]);
	if (own[0][0] * own[1][0] + own[0][1] * own[1][1] > -corner ||
	    other[0][0] * other[1][0] + other[0][1] * other[1][1] > -corner)
		return 1;
	float x = a[0] / one + b[0] / two, y = a[1] / one + b[1] / two;
	return max(0.5f * sqrtf(x * x + y * y), parted);
}

/* By the ways of two contours of one thing. */
static bound by_their_ways(const slender *w, uint32_t i, uint32_t j)
{
	const fine *n = w->n;
	const site *s = n->site + i;
	float own[2][2], other[2][2], dot[2];
	ways_from(n, i, own);
	ways_from(n, j, other);
	for (int k = 0; k < 2; k++)
		dot[k] = own[k][0] * other[k][0] + own[k][1] * other[k][1];
	int down = dot[1] > dot[0]; /* at a tip one of both goes round it */
	float beside = clamp01((dot[down] - parted) / (along - parted));
	if (!(beside > 0))
		return thin_bound(w, &s->placed);
	const float *a = own[down], *b = other[down];
	float way[2] = {a[0] + b[0], a[1] + b[1]}, x = n->site[j].placed.x - s->placed.x,
	      y = n->site[j].placed.y - s->placed.y, length = sqrtf(way[0] * way[0] + way[1] * way[1]),
	      sine = fabsf(a[0] * b[1] - a[1] * b[0]),
	      wide = fabsf(x * way[1] - y * way[0]) / length / aslant(own, other);
	return (bound){beside * bound_at(w, wide, sine), clamp01((sine - level) / (tapered - level))};
}

static bound bound_of(const slender *w, uint32_t i)
{
	const fine *n = w->n;
	const site *s = n->site + i;
	if (s->linked.dropped || rank_of(s) != RANK_SHAPE)
		return (bound){0};
	side to = is_contour(s) ? opposite(w, s) : (side){n->count, 0};
	uint32_t j = to.contour;
	if (j >= n->count)
		return within(w, i, (float)to.far);
	float part = 0, wide = round_width(n, i, j, &part);
	bound by_ways = part < 1 ? by_their_ways(w, i, j) : (bound){0}, thin = thin_bound(w, &s->placed);
	if (!(part > 0))
		return by_ways;
	return more(thin, (bound){mix(by_ways.crowd, bound_at(w, wide, 0), part), mix(by_ways.tapers, 0, part)});
}

static void find_bounds(void *data, int first, int end, int thread)
{
	(void)thread;
	const slender *w = data;
	for (int i = first; i < end && !stopped_at(w->n, i); i++) {
		w->stop[i] = (stop){bound_of(w, (uint32_t)i), both_of(w->n, (uint32_t)i)};
	}
}

/* The ways from site i by its link k, over one meeting more than is known. */
static void find_ways(const slender *w, uint32_t i, uint32_t k)
{
	const fine *n = w->n;
	bound most = {0};
	int sites = 0, longest = 0;
	for (uint32_t from = i, at = n->to[k]; at != UINT32_MAX && at != i && sites + longest <= w->around; sites++) {
		most = more(most, w->stop[at].bound);
		for (uint32_t l = n->at[at]; w->known.most && links_at(n, at) > 2 && l < n->at[at + 1]; l++)
			if (n->to[l] != from) {
				most = more(most, w->known.most[l]);
				longest = w->known.sites[l] > longest ? w->known.sites[l] : longest;
			}
		uint32_t next = next_of(n, from, at);
		from = at;
		at = next;
	}
	w->next.most[k] = most;
	w->next.sites[k] = (uint8_t)(sites + longest <= w->around ? sites + longest : TOO_LONG);
}

static void find_all_ways(void *data, int first, int end, int thread)
{
	(void)thread;
	const slender *w = data;
	const fine *n = w->n;
	for (uint32_t i = (uint32_t)first; i < (uint32_t)end && !stopped_at(n, (int)i); i++)
		for (uint32_t k = n->at[i]; links_at(n, i) > 2 && k < n->at[i + 1]; k++)
			find_ways(w, i, k);
}

/* The most on the next so many sites of a line; where it meets others, on these, so many times. The ways over all
 * meetings but one are known: they are many where lines are a net. */
static bound beyond(const slender *w, uint32_t from, uint32_t at, int sites, int meetings)
{
	const fine *n = w->n;
	uint32_t start = from;
	bound most = {0};
	while (sites-- > 0 && at != start) {
		const stop *s = w->stop + at;
		most = more(most, s->bound);
		if (s->both == UINT32_MAX) {
			for (uint32_t k = n->at[at]; meetings && links_at(n, at) > 2 && k < n->at[at + 1]; k++)
				if (n->to[k] != from)
					most = more(most, meetings == MEETINGS && w->known.sites[k] <= sites
								  ? w->known.most[k]
								  : beyond(w, at, n->to[k], sites, meetings - 1));
			break;
		}
		uint32_t next = s->both ^ from;
		from = at;
		at = next;
	}
	return most;
}

/* Round a tip a line has no opposite, nor where pixels do not show it, as where thin things cross: it is bound as it is
 * on both sides of there. Where several lines meet, as it goes on in two of them. */
static bound closed(const slender *w, uint32_t i)
{
	const fine *n = w->n;
	bound most = {0}, both = {0};
	for (uint32_t k = n->at[i]; k < n->at[i + 1]; k++) {
		bound side = beyond(w, i, n->to[k], w->around, MEETINGS);
		both = (bound){max(both.crowd, min(most.crowd, side.crowd)),
			       max(both.tapers, min(most.tapers, side.tapers))};
		most = more(most, side);
	}
	return more(w->stop[i].bound, links_at(n, i) == 1 ? most : both);
}

static void set_bounds(void *data, int first, int end, int thread)
{
	(void)thread;
	const slender *w = data;
	for (int i = first; i < end && !stopped_at(w->n, i); i++) {
		linked *s = &w->n->site[i].linked;
		if (s->dropped || is_chain(w->n->site + i) || rank_of(w->n->site + i) != RANK_SHAPE)
			continue;
		bound b = closed(w, (uint32_t)i);
		s->crowd = max(s->crowd, b.crowd);
		s->tapers = b.tapers;
	}
}

/* Of all ways from meetings, over no other, one, and so on. */
static int32_t know_ways(slender *w)
{
	fine *n = w->n;
	ways every[2];
	for (int i = 0; i < 2; i++) {
		every[i].most = late_take(&n->f->late, n->at[n->count], sizeof *every[i].most);
		every[i].sites = late_take(&n->f->late, n->at[n->count], sizeof *every[i].sites);
		if (!every[i].most || !every[i].sites)
			return ENCRE_ERROR_MEMORY;
	}
	int32_t code = ENCRE_OK;
	for (int i = 0; !code && i < MEETINGS; i++) {
		w->next = every[i % 2];
		code = bands_run(n->f->bands, (int)n->count, CHUNK, find_all_ways, w);
		w->known = w->next;
	}
	late_drop(&n->f->late, every[MEETINGS % 2].most);
	late_drop(&n->f->late, every[MEETINGS % 2].sites);
	return code;
}

int32_t ISA(fine_slender)(fine *n)
{
	slender w = {.n = n, .unit = n->f->scale, .stop = late_take(&n->f->late, n->count, sizeof *w.stop)};
	if (!w.stop)
		return ENCRE_ERROR_MEMORY;
	w.reach = (int)(widest * w.unit);
	w.around = (int)(AROUND * room_px(n, 1));
	int32_t code = bands_run(n->f->bands, (int)n->count, CHUNK, find_bounds, &w);
	if (!code)
		code = know_ways(&w);
	if (!code)
		code = bands_run(n->f->bands, (int)n->count, CHUNK, set_bounds, &w);
	late_drop(&n->f->late, w.known.most);
	late_drop(&n->f->late, w.known.sites);
	late_drop(&n->f->late, w.stop);
	return code;
}
