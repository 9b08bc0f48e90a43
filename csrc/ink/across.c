/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Two lines with less than a pixel between them: of the link that darkens a pixel most alone what is left white would
 * be a row of rungs. What another covers on the pixel's other side is added. */
#include "ink/capsules.h"

static const float nearest_across = 0.25f; /* pixels: nearer places have no side */

/* What a link covers on the other side of pixels than the line that darkens them most: where both leave less than a
 * pixel between them, that is as dark as they cover of it together. A line's own links lie on one side of a pixel, or
 * nearer to each other. */
KERNEL void add_span(const capsule *restrict e, const canvas *c, int y, int x, int end, const bool papered)
{
	size_t at = (size_t)(y - c->y0) * c->stride;
	const float *restrict dark = c->dark + at, *restrict way_x = c->way_x + at, *restrict way_y = c->way_y + at,
			      *restrict depth = c->depth + at, *restrict grain = c->grain + at;
	float *restrict more = c->more + at;
	const shading l = shading_of(e, y);
	float inverse = e->inverse;
	for (; x < end; x += LANES)
		for (int k = 0; k < LANES; k++) {
			const shade h = shade_at(&l, x + k, grain + x + k, papered);
			float t = depth[x + k] >= l.limit + h.s * l.more_limit ? h.t : 0;
			float wx = way_x[x + k], wy = way_y[x + k], own = sqrtf(h.square),
			      other = sqrtf(wx * wx + wy * wy), along = h.ex * l.dx + h.ey * l.dy;
			float facing = -(h.ex * wx + h.ey * wy) /
				       (max(own, nearest_across) * max(other, nearest_across)),
			      aside = 1 - 4 * along * along * inverse / (h.square + 1e-12f),
			      apart = 2 * (own + other) - 1.5f, hard = 2 - h.width, room = h.most - dark[x + k];
			float add = positive(t < room ? t : room) * most_one(positive(facing)) * positive(aside) *
				    most_one(positive(apart)) * positive(hard);
			more[x + k] = add > more[x + k] ? add : more[x + k];
		}
}

void ISA(capsule_add_across)(const capsule *e, const canvas *c)
{
	float top = min(e->a->y, e->b->y) - e->reach, bottom = max(e->a->y, e->b->y) + e->reach;
	bool papered = e->a->paper > 0 || e->b->paper > 0;
	int from = top > (float)c->y0 ? (int)top : c->y0, to = bottom < (float)(c->y1 - 1) ? (int)bottom : c->y1 - 1;
	for (int y = from; y <= to; y++) {
		int x, end;
		span_of(e, y, c->f->width, &x, &end);
		if (x >= end)
			continue;
		if (papered)
			add_span(e, c, y, x, end, true);
		else
			add_span(e, c, y, x, end, false);
	}
}

void ISA(add_across)(const canvas *c)
{
	for (int y = 0; y < c->y1 - c->y0; y++)
		for (uint64_t open = c->open[y]; open; open &= open - 1) {
			size_t at = (size_t)y * c->stride + ((size_t)__builtin_ctzll(open) << c->shift);
			for (size_t end = at + ((size_t)1 << c->shift); at < end; at++)
				c->dark[at] += c->more[at];
		}
}
