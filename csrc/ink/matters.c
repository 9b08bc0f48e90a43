/* SPDX-License-Identifier: GPL-3.0-or-later */
/* How much a line matters among others: where there are too many, what parts a mass from what lies far behind it is
 * drawn, and gaps in it are not. */
#include "ink/thickets.h"
#include "ink/pen.h"
#include "fine/near.h"

enum { CHUNK = 1024, ALONG = 6 /* sites each way along a line */, DECIDED = 10 };

/* Sites back along a line from which its way is told. */
enum { BACK = 3 };

/* How much a line matters is half what stands out before what is far behind, and half chance: where all are alike, as
 * bars of a railing, some are left out. Nothing is told by how long it is, which changes with every crossing. */
static const float by_chance = 0.5f;
static const float wavelength = 24; /* px */
static const float straight = 0.8f; /* a cosine: so a line goes on where it meets others */
static const float steep = 3;       /* how clearly most of a line decides */
static const uint32_t seed = 0x6d617373;

/* Pixels each way at a site whose depths tell how far what is behind it lies. */
enum { BEHIND = 2 };

typedef struct chances {
	frame *f;
	const fine *n;
	const spots *at;
	float *own, *matters;
} chances;

/* Which share of the way to what lies behind there is nothing; what bounds a thing matters more than gaps in it. */
static float stands_out(const frame *f, const site *s)
{
	if (is_by_hand(f->fine, s))
		return 1;
	if (rank_of(s) != RANK_SHAPE)
		return 0;
	float near = INFINITY, far = 0, number = 0;
	bool row = s->found.axis != AXIS_COLUMN, bounds = false;
	for (int k = -BEHIND; k <= BEHIND; k++) {
		int x = row ? clamp_index(s->found.column + k, f->width) : s->found.column,
		    y = row ? s->found.row : clamp_index(s->found.row + k, f->height);
		const float *object = layer_row(f, ENCRE_LAYER_OBJECT, y);
		float depth = depth_at(f, x, y);
		near = min(near, depth);
		far = max(far, depth);
		bounds |= object && k > -BEHIND && object[x] != number;
		number = object ? object[x] : 0;
	}
	float jump = !(far < INFINITY) ? 1 : far > 0 ? clamp01(1 - near / far) : 0;
	return 0.5f * (jump + (bounds ? 1 : 0));
}

static void find_own(void *data, int first, int end, int thread)
{
	(void)thread;
	const chances *c = data;
	for (int i = first; i < end && !stopped_at(c->n, i); i++) {
		float noise = 0, length = wavelength;
		spots at = spots_from(c->at, (size_t)i);
		if (c->n->site[i].linked.dropped)
			continue;
		ISA(solid_row)(&at, 1, &length, &seed, &noise);
		c->own[i] =
			(1 - by_chance) * stands_out(c->f, c->n->site + i) + by_chance * clamp01(0.5f + 0.5f * noise);
	}
}

/* The next site, straight on where lines meet. */
static uint32_t ahead_of(const fine *n, const uint32_t *trail, uint32_t at)
{
	uint32_t best = UINT32_MAX;
	if (links_at(n, at) <= 2)
		return next_of(n, trail[0], at);
	const placed *p = &n->site[at].placed, *q = &n->site[trail[BACK - 1]].placed;
	float x = p->x - q->x, y = p->y - q->y, length = sqrtf(x * x + y * y), most = straight;
	for (uint32_t k = n->at[at]; k < n->at[at + 1]; k++) {
		uint32_t to = n->to[k], on = next_of(n, at, to);
		const placed *r = &n->site[on == UINT32_MAX ? to : on].placed;
		float dx = r->x - p->x, dy = r->y - p->y, far = sqrtf(dx * dx + dy * dy);
		if (to == trail[0] || !(far * length > 0))
			continue;
		float cosine = (x * dx + y * dy) / (far * length);
		if (cosine > most) {
			most = cosine;
			best = to;
		}
	}
	return best;
}

/* The mean along the line, fewer than so many sites each way. What is far counts less, or all would jump when a
 * crossing comes or goes. */
static float mean_along(const fine *n, const float *value, uint32_t i, int most)
{
	float sum = value[i], weights = 1;
	for (uint32_t k = n->at[i]; links_at(n, i) <= 2 && k < n->at[i + 1]; k++) {
		uint32_t trail[BACK] = {i, i, i}, at = n->to[k];
		for (int step = 1; step < most && at != UINT32_MAX && at != i; step++) {
			float weight = 1 - (float)step / (float)most;
			sum += weight * value[at];
			weights += weight;
			uint32_t next = ahead_of(n, trail, at);
			trail[2] = trail[1];
			trail[1] = trail[0];
			trail[0] = at;
			at = next;
		}
	}
	return sum / weights;
}

/* So that all of a line is drawn or none. */
static void even_lines(void *data, int first, int end, int thread)
{
	(void)thread;
	const chances *c = data;
	for (uint32_t i = (uint32_t)first; i < (uint32_t)end && !stopped_at(c->n, (int)i); i++)
		if (!c->n->site[i].linked.dropped)
			c->matters[i] = mean_along(c->n, c->own, i, ALONG);
}

/* Where lines meet, as much as that which does most. */
static void join(void *data, int first, int end, int thread)
{
	(void)thread;
	const chances *c = data;
	const fine *n = c->n;
	for (uint32_t i = (uint32_t)first; i < (uint32_t)end && !stopped_at(n, (int)i); i++)
		for (uint32_t k = n->at[i]; links_at(n, i) > 2 && k < n->at[i + 1]; k++)
			if (links_at(n, n->to[k]) <= 2 && !n->site[i].linked.dropped)
				c->matters[i] = max(c->matters[i], c->matters[n->to[k]]);
}

static void find_outer(void *data, int first, int end, int thread)
{
	(void)thread;
	const chances *c = data;
	for (int i = first; i < end && !stopped_at(c->n, i); i++)
		c->own[i] = c->n->site[i].linked.dropped ? 0 : ISA(line_outer)(c->f, c->n->site + i);
}

/* When `own` is found. */
static int32_t spread(chances *c)
{
	int32_t code = bands_run(c->f->bands, (int)c->n->count, CHUNK, even_lines, c);
	return code ? code : bands_run(c->f->bands, (int)c->n->count, CHUNK, join, c);
}

int32_t ISA(lines_matter)(frame *f, const spots *at, float *matters)
{
	const fine *n = f->fine;
	chances c = {.f = f, .n = n, .at = at, .matters = matters};
	c.own = late_take(&f->late, n->count, sizeof *c.own);
	if (!c.own)
		return ENCRE_ERROR_MEMORY;
	int32_t code = bands_run(f->bands, (int)n->count, CHUNK, find_own, &c);
	code = code ? code : spread(&c);
	late_drop(&f->late, c.own);
	return code;
}

int32_t ISA(lines_outer)(frame *f, float *outer)
{
	const fine *n = f->fine;
	chances c = {.f = f, .n = n, .matters = outer};
	c.own = late_take(&f->late, n->count, sizeof *c.own);
	if (!c.own)
		return ENCRE_ERROR_MEMORY;
	int32_t code = bands_run(f->bands, (int)n->count, CHUNK, find_outer, &c);
	code = code ? code : spread(&c);
	late_drop(&f->late, c.own);
	return code;
}

/* What most of a line about a site is: no scraps are left of it, and no gaps in it. */
static void decide(void *data, int first, int end, int thread)
{
	(void)thread;
	const chances *c = data;
	for (uint32_t i = (uint32_t)first; i < (uint32_t)end && !stopped_at(c->n, (int)i); i++) {
		if (c->n->site[i].linked.dropped)
			continue;
		float mean = mean_along(c->n, c->own, i, DECIDED);
		c->matters[i] = links_at(c->n, i) > 2 ? 0 : clamp01(0.5f + steep * (mean - 0.5f));
	}
}

int32_t ISA(lines_decide)(frame *f, float *left, float *kept)
{
	const fine *n = f->fine;
	chances c = {.f = f, .n = n, .own = left, .matters = kept};
	int32_t code = bands_run(f->bands, (int)n->count, CHUNK, decide, &c);
	return code ? code : bands_run(f->bands, (int)n->count, CHUNK, join, &c);
}
