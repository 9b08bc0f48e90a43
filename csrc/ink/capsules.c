/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Ink along links: the union of discs whose centre, radius, darkness and depth run evenly from one site to the next. Of
 * a wide line each link draws only the pixels that lie before its own ends, as its neighbours draw the others. */
#include "ink/capsules.h"
#include "ink/tips.h"
#include "ink/pen.h"
#include "fine/near.h"

#include <string.h>

/* A link draws this many pixels beyond the line that halves the angle with its neighbour: where the radius varies, what
 * darkens a pixel most lies aside of the nearest place, by the radius times its slope. */
static const float overlap = 1.0f;

/* ---- drawing --------------------------------------------------------------------------------------------- */

static bool unit_of(float *x, float *y)
{
	float length = sqrtf(*x * *x + *y * *y);
	*x /= length;
	*y /= length;
	return length > 1e-6f;
}

typedef struct place {
	float x, y;
} place;

/* Where a site's end lies along its line: where the hand strayed to, if it did. */
static place place_of(const fine *n, const capsules *all, uint32_t stroke, uint32_t i)
{
	const pen_end *e = all->end + (size_t)stroke * all->count + i;
	const placed *s = &n->site[i].placed;
	return all->moved && !n->site[i].linked.dropped ? (place){e->x, e->y} : (place){s->x, s->y};
}

/* Whether what of a link darkens a pixel most may lie farther aside of the nearest place than links overlap. */
static bool is_steep(const capsules *all, uint32_t stroke, uint32_t a, uint32_t b)
{
	const pen_end *e = all->end + (size_t)stroke * all->count + a, *o = all->end + (size_t)stroke * all->count + b;
	float dx = o->x - e->x, dy = o->y - e->y;
	return fabsf(o->out - e->out) * max(e->reach, o->reach) > overlap * sqrtf(dx * dx + dy * dy);
}

/* Leaves what lies beyond end `here` to the one other link there, if that is drawn and not steep. */
static void cut_at(const fine *n, const capsules *all, uint32_t stroke, capsule *c, uint32_t here, uint32_t there)
{
	if (n->at[here + 1] - n->at[here] != 2)
		return;
	uint32_t other = n->to[n->at[here]] == there ? n->to[n->at[here] + 1] : n->to[n->at[here]];
	if (n->site[other].linked.dropped || is_steep(all, stroke, here, other))
		return;
	place h = place_of(n, all, stroke, here), t = place_of(n, all, stroke, there),
	      o = place_of(n, all, stroke, other);
	float ox = h.x - o.x, oy = h.y - o.y, tx = t.x - h.x, ty = t.y - h.y;
	if (!unit_of(&ox, &oy) || !unit_of(&tx, &ty) || ox * tx + oy * ty < 0)
		return;
	float wx = ox + tx, wy = oy + ty;
	unit_of(&wx, &wy);
	c->cut[c->cuts++] = (cut){wx, wy, wx * h.x + wy * h.y - overlap};
}

/* What the bristle over a place leaves of the ink. Bristles lie side by side across the link, from one rim on: which
 * changes over where a line is as steep as few are, as neighbouring links of the others must agree. */
static const float steep = 0.41421356f;

/* The site beyond one end of a link, or that end where the line does not go on there. */
static uint32_t beyond(const fine *n, uint32_t here, uint32_t there)
{
	uint32_t other = next_of(n, there, here);
	return other != UINT32_MAX && !n->site[other].linked.dropped ? other : here;
}

/* From the site before a link to the one after: sites may lie close, and a line across these goes any way. */
static void widen(const fine *n, const capsules *all, const capsule *e, uint32_t ends[2])
{
	ends[0] = e->one;
	ends[1] = e->two;
	if (e->two >= all->ends || e->one == e->two)
		return;
	uint32_t stroke = e->one / all->count * all->count, a = e->one - stroke, b = e->two - stroke;
	ends[0] = stroke + beyond(n, a, b);
	ends[1] = stroke + beyond(n, b, a);
}

static streaks streaks_of(const capsules *all, const capsule *e, const uint32_t ends[2])
{
	const pen_end *from = all->end + ends[0], *to = all->end + ends[1];
	float dx = to->x - from->x, dy = to->y - from->y;
	float length = sqrtf(dx * dx + dy * dy);
	bool turned = dx + steep * dy < 0, way = length > 1e-6f;
	streaks b = {.x = turned ? -dx : dx, .y = turned ? -dy : dy, .length = way ? length : 0, .turned = turned};
	for (int k = 0; k < 2 && e->dry[0]; k++) {
		int n = (int)(k ? e->b : e->a)->bristles;
		for (int i = 0; i < BRISTLES; i++)
			b.ink[k] |= (uint64_t)(n ? e->dry[k][i] : 255) << (8 * i);
		b.count[k] = (float)(n ? n : 1);
		b.last[k] = n ? n - 1 : 0;
	}
	return b;
}

static strip_link strip_of(const capsules *all, const capsule *e, const uint32_t ends[2])
{
	const strip_end *s = all->strip;
	const streaks *b = &e->across;
	float x = 0, y = 0;
	if (b->length > 0) {
		x = b->x / b->length;
		y = b->y / b->length;
	}
	float far = x * e->dx + y * e->dy;
	strip_link l = ISA(strip_between)(s + e->one, s + e->two, fabsf(far));
	float rate = ISA(strip_rate)(s + ends[0], s + ends[1]);
	l.x = x;
	l.y = y;
	l.far = far;
	ISA(strip_choose)(&l, e->a->out + e->b->out);
	l.rate = b->turned ? -rate : rate;
	return l;
}

/* What branches off an older line is as wide where it meets that as it is beside it. */
static void meet(const fine *n, capsule *c, const capsules *all, pen_end *met)
{
	uint32_t a = c->one % all->count, b = c->two % all->count;
	if (c->two >= all->ends || a == b)
		return;
	const pen_end **wide = branches_off(n, a, b) ? &c->a : branches_off(n, b, a) ? &c->b : NULL;
	const pen_end *own = wide == &c->a ? c->b : c->a;
	if (!wide || (*wide)->out <= own->out)
		return;
	*met = **wide;
	met->out = own->out;
	met->fade = own->fade;
	met->reach = own->reach;
	*wide = met;
}

/* met: where an end may be kept that is another than the line's that it meets. */
static capsule capsule_of(const fine *n, const capsules *all, uint32_t a, uint32_t b, pen_end *met)
{
	capsule c = {.a = all->end + a, .b = all->end + b, .one = a, .two = b};
	uint32_t stroke = a / all->count;
	meet(n, &c, all, met);
	if (all->dry && (c.a->bristles || c.b->bristles)) {
		c.dry[0] = all->dry[a];
		c.dry[1] = all->dry[b];
	}
	c.dx = c.b->x - c.a->x;
	c.dy = c.b->y - c.a->y;
	float square = c.dx * c.dx + c.dy * c.dy;
	bool striped = all->strip && (all->strip[a].of || all->strip[b].of);
	if (c.dry[0] || striped) {
		uint32_t ends[2];
		widen(n, all, &c, ends);
		c.across = streaks_of(all, &c, ends);
		if (striped)
			c.strip = strip_of(all, &c, ends);
	}
	c.inverse = square > 1e-12f ? 1 / square : 0;
	c.reach = max(c.a->reach, c.b->reach);
	if (c.reach > 2.5f && a != b && b < all->ends && !is_steep(all, stroke, a % all->count, b % all->count)) {
		a %= all->count;
		b %= all->count;
		cut_at(n, all, stroke, &c, a, b);
		cut_at(n, all, stroke, &c, b, a);
	}
	return c;
}

/* What leaves some of a line white. */
enum brush { SOLID, BRISTLY, STRIPED };

/* Those of LANES pixels of a row that the link would darken more than they are, or as much if equals count. */
static inline void pick(picked *p, int y, int x, const int32_t *restrict wins, const float *restrict most)
{
	int n = p->n;
	for (int k = 0; k < LANES; k++) {
		p->most[n] = most[k];
		p->place[n] = (uint32_t)y << 16 | (uint32_t)(x + k);
		n += wins[k];
	}
	p->n = n;
}

/* Called with constants each time. Where `owned` is true, who inked is remembered: among equals the nearest; only then
 * distance and owner are read. Where `sided` is true, the way to it is. p: of STRIPED alone. */
KERNEL void ink_span(const capsule *restrict e, const canvas *c, int y, int x, int end, const bool owned,
		     const bool sided, const bool papered, const enum brush brush, picked *restrict p)
{
	size_t at = (size_t)(y - c->y0) * c->stride;
	float *restrict dark = c->dark + at, *restrict distance = owned ? c->distance + at : NULL,
			*restrict way_x = sided ? c->way_x + at : NULL, *restrict way_y = sided ? c->way_y + at : NULL;
	const float *restrict depth = c->depth + at, *restrict grain = c->grain + at;
	uint32_t *restrict owner = owned ? c->owner + at : NULL;
	const shading l = shading_of(e, y);
	uint32_t one = e->one, two = e->two;
	for (; x < end; x += LANES) {
		float might[LANES];
		int32_t may[LANES], any = 0;
		for (int k = 0; k < LANES; k++) {
			const shade h = shade_at(&l, x + k, grain + x + k, papered);
			float t = h.t, before = dark[x + k];
			if (brush == BRISTLY)
				t *= left_by(&e->across, across_at(&e->across, h.px, l.py, l.out + h.s * l.more_out),
					     h.s);
			t = depth[x + k] >= l.limit + h.s * l.more_limit ? t : 0;
			if (brush == STRIPED) {
				might[k] = t;
				may[k] = owned ? (t > 0) & (t >= before) : t > before;
				any |= may[k];
				continue;
			}
			if (!owned && !sided) {
				dark[x + k] = t > before ? t : before;
				continue;
			}
			/* squared distance that an equal must beat */
			float nearest = owned ? distance[x + k]
					      : way_x[x + k] * way_x[x + k] + way_y[x + k] * way_y[x + k],
			      rival = t == before ? nearest : -1;
			int wins = t > before || (t > 0 && h.square < rival);
			dark[x + k] = wins ? t : before;
			if (owned) {
				distance[x + k] = wins ? h.square : distance[x + k];
				owner[x + k] = wins ? (h.s > 0.5f ? two : one) : owner[x + k];
			}
			if (sided) {
				way_x[x + k] = wins ? h.ex : way_x[x + k];
				way_y[x + k] = wins ? h.ey : way_y[x + k];
			}
		}
		if (brush == STRIPED && any)
			pick(p, y, x, may, might);
		if (brush == STRIPED && p->n > STRIP_PLACES - LANES)
			ISA(picked_ink)(e, c, p);
	}
}

static void draw_capsule(const capsule *e, canvas *c)
{
	float top = min(e->a->y, e->b->y) - e->reach, bottom = max(e->a->y, e->b->y) + e->reach;
	bool papered = e->a->paper > 0 || e->b->paper > 0, owned = c->owner, sided = c->more;
	int from = top > (float)c->y0 ? (int)top : c->y0, to = bottom < (float)(c->y1 - 1) ? (int)bottom : c->y1 - 1;
	picked p;
	p.n = 0;
	for (int y = from; y <= to; y++) {
		int x, end;
		span_of(e, y, c->f->width, &x, &end);
		if (x >= end)
			continue;
		canvas_touch(c, y, x, end);
		if (e->strip.of && owned)
			ink_span(e, c, y, x, end, true, false, true, STRIPED, &p);
		else if (e->strip.of)
			ink_span(e, c, y, x, end, false, false, true, STRIPED, &p);
		else if (e->dry[0] && owned)
			ink_span(e, c, y, x, end, true, false, true, BRISTLY, NULL);
		else if (e->dry[0])
			ink_span(e, c, y, x, end, false, false, true, BRISTLY, NULL);
		else if (owned && sided && papered)
			ink_span(e, c, y, x, end, true, true, true, SOLID, NULL);
		else if (owned && sided)
			ink_span(e, c, y, x, end, true, true, false, SOLID, NULL);
		else if (sided && papered)
			ink_span(e, c, y, x, end, false, true, true, SOLID, NULL);
		else if (sided)
			ink_span(e, c, y, x, end, false, true, false, SOLID, NULL);
		else if (owned && papered)
			ink_span(e, c, y, x, end, true, false, true, SOLID, NULL);
		else if (owned)
			ink_span(e, c, y, x, end, true, false, false, SOLID, NULL);
		else if (papered)
			ink_span(e, c, y, x, end, false, false, true, SOLID, NULL);
		else
			ink_span(e, c, y, x, end, false, false, false, SOLID, NULL);
	}
	ISA(picked_ink)(e, c, &p);
}

/* ---- strokes --------------------------------------------------------------------------------------------- */

/* How far the lesser of two strokes that cover a pixel in part lies within the other, as where both have their rim in
 * it, and not by chance; test_two_strokes_are_as_dark_at_a_quarter_of_the_size */
static const float within = 0.4f;

/* The pixels at..end - 1 of one row: what this stroke left of them white, the next may darken. */
static void lay_span(const canvas *c, size_t at, size_t end)
{
	for (; at < end; at++) {
		float dark = c->dark[at];
		c->laid[at] += dark - mix(c->laid[at] * dark, min(c->laid[at], dark), within);
		c->dark[at] = 0;
		if (!(dark > c->darkest[at]))
			continue;
		c->darkest[at] = dark;
		if (c->owner)
			c->darkest_owner[at] = c->owner[at];
	}
}

/* Lays a stroke over those before it. Were only the darkest of them kept, strokes less than a pixel apart would look
 * like one, and a smaller picture would be paler; did all overlap by chance, it would be darker. */
static void lay(const canvas *c)
{
	for (int y = c->y0; y < c->y1; y++)
		for (int b = 0; b < 64; b++)
			if (c->open[y - c->y0] >> b & 1) {
				size_t at = (size_t)(y - c->y0) * c->stride + ((size_t)b << c->shift);
				lay_span(c, at, at + ((size_t)1 << c->shift));
			}
}

static void take_laid(canvas *c)
{
	lay(c);
	float *dark = c->dark;
	c->dark = c->laid;
	c->laid = dark;
	if (c->owner)
		c->owner = c->darkest_owner;
}

void ISA(capsules_draw)(const capsules *all, canvas *c)
{
	const uint32_t *first = all->first + c->y0 / BAND;
	uint32_t stroke = 0; /* lists are in their order */
	if (all->dry || all->strip)
		c->more = NULL;
	for (uint32_t i = first[0]; i < first[1] && !bands_stopped(c->f->bands); i++) {
		const uint32_t *ends = all->list[i];
		if (c->laid && ends[0] / all->count != stroke) {
			lay(c);
			stroke = ends[0] / all->count;
		}
		pen_end met;
		capsule e = capsule_of(c->f->fine, all, ends[0], ends[1], &met);
		draw_capsule(&e, c);
	}
	if (c->laid)
		take_laid(c);
	for (uint32_t i = first[0]; c->more && i < first[1] && !bands_stopped(c->f->bands); i++) {
		pen_end met;
		capsule e = capsule_of(c->f->fine, all, all->list[i][0], all->list[i][1], &met);
		ISA(capsule_add_across)(&e, c);
	}
	if (c->more)
		ISA(add_across)(c);
}
