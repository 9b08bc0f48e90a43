/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Lines that lie on each other, as those of a second shell or of a lid that is flush: they cover the picture once. */
#include "ink/thickets.h"
#include "fine/near.h"

enum { CHUNK = 1024, STEPS = 8 /* sites each way of its own line */ };

/* Pixels each way along a line over which others are sought that lie on it: two sites, of its own too. */
static const float along = 2;
/* Px, and pixels at least, from which on broad lines lie side by side; thin ones do from their width on, or a far fence
 * would be one line. */
static const float apart = 1, least_apart = 1;

/* A site's share of its line. */
typedef struct piece {
	float x, y; /* its way, of length 1; 0 where lines meet */
	float length, radius;
	float u, v; /* to the middle of a thin thing that it is a side of */
} piece;

typedef struct doubled {
	const frame *f;
	const fine *n;
	const pen_end *end;
	const float *thin;
	piece *piece; /* by site */
	float *lines; /* likewise */
} doubled;

static void find_pieces(void *data, int first, int end, int thread)
{
	(void)thread;
	const doubled *d = data;
	const fine *n = d->n;
	for (uint32_t i = (uint32_t)first; i < (uint32_t)end && !stopped_at(n, (int)i); i++) {
		float way[2], far = 0;
		d->piece[i] = (piece){0};
		if (n->site[i].linked.dropped || !(d->end[i].out > 0) || !way_of(n, i, way))
			continue;
		far = sqrtf(way[0] * way[0] + way[1] * way[1]);
		if (!(far > 0))
			continue;
		float radius = left_of(n->site + i, d->end[i].out);
		const site *s = n->site + i;
		bool row = s->found.axis == AXIS_ROW;
		d->piece[i] = (piece){way[0] / far,
				      way[1] / far,
				      length_at(n, i, radius),
				      radius,
				      row ? s->placed.inside : 0,
				      row ? 0 : s->placed.inside};
	}
}

/* What of a site lies on another: the more the nearer they lie, the more alike their way is, and as much of it as it is
 * wide; no other side of a thing does. */
static float share_on(const doubled *d, uint32_t i, uint32_t k, float wide)
{
	const piece *own = d->piece + i, *its = d->piece + k;
	const placed *p = &d->n->site[i].placed, *q = &d->n->site[k].placed;
	float dx = q->x - p->x, dy = q->y - p->y, on = 1 - fabsf(own->x * dx + own->y * dy) / along,
	      beside = 1 - fabsf(own->x * dy - own->y * dx) / wide, cosine = own->x * its->x + own->y * its->y;
	bool across = own->u * its->u + own->v * its->v < 0;
	return on > 0 && beside > 0 && !across
		       ? on * beside * cosine * cosine * its->length * min(its->radius / own->radius, 1)
		       : 0;
}

/* How many lines lie at a site, of which its own is one. */
static float lines_on(const doubled *d, uint32_t i)
{
	const fine *n = d->n;
	if (!(d->piece[i].radius > 0 && d->thin[i] > 0))
		return 1;
	float wide = min(2 * d->thin[i], max(apart * d->f->scale, least_apart)), all = 0, own = share_on(d, i, i, wide);
	near_sites near = near_site(n, n->site + i, along + wide);
	for (uint32_t k; near_next(n, &near, &k);)
		all += share_on(d, i, k, wide);
	for (uint32_t k = n->at[i]; k < n->at[i + 1]; k++) {
		uint32_t from = i, at = n->to[k];
		for (int step = 0; step < STEPS && at != UINT32_MAX && at != i; step++) {
			uint32_t next = next_of(n, from, at);
			own += share_on(d, i, at, wide);
			from = at;
			at = next;
		}
	}
	return own > 0 ? max(all / own, 1) : 1;
}

static void count_lines(void *data, int first, int end, int thread)
{
	(void)thread;
	const doubled *d = data;
	for (int i = first; i < end && !stopped_at(d->n, i); i++)
		d->lines[i] = lines_on(d, (uint32_t)i);
}

int32_t ISA(lines_doubled)(frame *f, const pen_end *end, const float *thin, float *lines)
{
	const fine *n = f->fine;
	doubled d = {.f = f, .n = n, .end = end, .thin = thin, .lines = lines};
	d.piece = late_take(&f->late, n->count, sizeof *d.piece);
	if (!d.piece)
		return ENCRE_ERROR_MEMORY;
	int32_t code = bands_run(f->bands, (int)n->count, CHUNK, find_pieces, &d);
	if (!code)
		code = bands_run(f->bands, (int)n->count, CHUNK, count_lines, &d);
	late_drop(&f->late, d.piece);
	return code;
}
