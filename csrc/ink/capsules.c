/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Ink along links: the union of discs whose centre, radius, darkness and depth run evenly from one site to the next. Of
 * a wide line each link draws only the pixels that lie before its own ends, as its neighbours draw the others. */
#include "ink/discs.h"
#include "fine/near.h"

/* What a site gives the links that end at it. On paper of height h, a share `bias` of which the pencil doesn't reach,
 * the darkness that coverage min(1, (out - d) / fade) gets at distance d is gain * (h * coverage - bias). Of that ramp
 * pixels show how dark it gets and where it is half as dark, but none is steeper than a pixel is wide, and what is
 * thinner than a pixel is as much fainter instead: so the ink of a line doesn't depend on the size of the frame. */
typedef struct pen_end {
	float x, y;
	float out, fade;
	float gain, ease; /* one over the other */
	float bias, paper, limit;
	float reach;    /* nothing is darkened from here on */
	uint32_t owner; /* the pixel with the controls, y << 16 | x */
} pen_end;

enum { CHUNK = 1024 };

/* A link draws this many pixels beyond the line that halves the angle with its neighbour, because the radius may vary.
 */
static const float overlap = 1.0f;
/* Where the radius changes more from one site to the next, a link may ink what lies before its neighbours. */
static const float most_steep = 0.5f;

/* ---- pens ------------------------------------------------------------------------------------------------ */

typedef struct gather {
	const frame *f;
	const fine *n;
	capsules *all;
	float *length; /* to the nearest free end, by site; NULL where no line tapers */
	float *radius; /* by site: evened along its line, before it tapers or is crowded */
} gather;

/* What the pen gives before its line is evened: `out` is its radius, `fade` the share of that. */
static pen_end pen_end_of(const frame *f, const site *made)
{
	const placed *s = &made->placed;
	pen pen;
	pen_end e = {.x = s->x, .y = s->y};
	e.owner = (uint32_t)s->near_y << 16 | s->near_x;
	if (!ISA(pen_of)(f, s->near_x, s->near_y, (enum source)s->source, s->strength, &pen))
		return e;
	e.out = pen.radius * (1 - (float)s->eased / 255);
	e.fade = pen.p->line_softness;
	e.gain = pen.gain;
	e.ease = pen.gain > 0 ? min(1 / pen.gain, 1e30f) : 0;
	e.bias = pen.bias;
	e.paper = pen.p->line_paper;
	e.limit = min(pen.limit, 1e30f); /* finite: it is interpolated */
	return e;
}

/* `radius`: evened along the line. */
static void finish(const frame *f, const site *made, float radius, float length, pen_end *e)
{
	const placed *s = &made->placed;
	float crowd = made->linked.crowd;
	int style = f->style ? f->style[(size_t)s->near_y * (size_t)f->width + s->near_x] : 0;
	if (!f->params[style].use_lines)
		return;
	float taper = f->params[style].line_taper * f->scale;
	if (length < taper)
		radius *= length / taper;
	if (radius * crowd > 1)
		radius = 1 / crowd;
	/* a thing not much wider than its lines lets no paper between them: they are one, from its middle */
	float filled = s->thin * clamp01(1 - 2 * (s->half - radius));
	if (made->found.axis == AXIS_ROW)
		e->x += filled * s->inside;
	else
		e->y += filled * s->inside;
	e->out = filled * s->half + radius;
	e->fade *= radius;
	float ramp = min(e->ease, 1 - e->bias),
	      middle = e->out - e->fade * (e->bias + 0.5f * ramp); /* on the highest paper */
	if (ramp > 0 && middle > 0)
		e->reach = max(middle, 0.5f) + 0.5f * max(e->fade * ramp, 1);
}

static void make_pens(void *data, int first, int end, int thread)
{
	(void)thread;
	const gather *g = data;
	for (int i = first; i < end; i++) {
		g->radius[i] = 0;
		if (g->n->site[i].linked.dropped)
			continue;
		g->all->end[i] = pen_end_of(g->f, g->n->site + i);
		g->radius[i] = g->all->end[i].out;
	}
}

static void finish_pens(void *data, int first, int end, int thread)
{
	(void)thread;
	const gather *g = data;
	for (int i = first; i < end; i++)
		if (!g->n->site[i].linked.dropped)
			finish(g->f, g->n->site + i, g->radius[i], g->length ? g->length[i] : INFINITY,
			       g->all->end + i);
}

/* ---- bands ----------------------------------------------------------------------------------------------- */

/* Adds a capsule to the lists of the bands that it reaches into; counts while there are no lists. */
static void enter(const gather *g, uint32_t a, uint32_t b, uint32_t *next)
{
	const pen_end *one = g->all->end + a, *two = g->all->end + b;
	float reach = max(one->reach, two->reach), top = min(one->y, two->y) - reach,
	      bottom = max(one->y, two->y) + reach;
	if (!(reach > 0) || bottom < 0 || top > (float)(g->f->height - 1))
		return;
	for (int k = pixel_of(top - 0.5f, g->f->height) / BAND; k <= pixel_of(bottom + 0.5f, g->f->height) / BAND;
	     k++) {
		if (g->all->list) {
			g->all->list[next[k]][0] = a;
			g->all->list[next[k]][1] = b;
		}
		next[k]++;
	}
}

static int32_t enter_all(const gather *g, uint32_t *next)
{
	const fine *n = g->n;
	int32_t code = ENCRE_OK;
	for (uint32_t i = 0; !code && i < n->count; i++) {
		code = at_step(n, i);
		if (n->site[i].linked.dropped)
			continue;
		if (n->at[i] == n->at[i + 1])
			enter(g, i, i, next);
		for (uint32_t k = n->at[i]; k < n->at[i + 1]; k++)
			if (n->to[k] > i && !n->site[n->to[k]].linked.dropped)
				enter(g, i, n->to[k], next);
	}
	return code;
}

int32_t ISA(capsules_gather)(frame *f, capsules *all)
{
	const fine *n = f->fine;
	gather g = {.f = f, .n = n, .all = all};
	size_t bands = (size_t)(f->height - 1) / BAND + 1;
	all->end = late_take(&f->late, n->count, sizeof *all->end);
	all->first = late_take(&f->late, bands + 2, sizeof *all->first);
	if (!all->end || !all->first)
		return ENCRE_ERROR_MEMORY;
	float taper = 0;
	for (int i = 0; i < f->n_styles; i++)
		taper = max(taper, f->params[i].line_taper * f->scale);
	if (taper > 0) {
		g.length = late_take(&f->late, n->count, sizeof *g.length);
		if (!g.length)
			return ENCRE_ERROR_MEMORY;
		int32_t code = ISA(fine_free_lengths)(n, taper, g.length);
		if (code)
			return code;
	}
	g.radius = late_take(&f->late, n->count, sizeof *g.radius);
	if (!g.radius)
		return ENCRE_ERROR_MEMORY;
	int32_t code = bands_run(f->bands, (int)n->count, CHUNK, make_pens, &g);
	if (!code)
		code = ISA(capsules_even)(f, &g.radius);
	if (!code)
		code = bands_run(f->bands, (int)n->count, CHUNK, finish_pens, &g);
	if (code)
		return code;
	late_drop(&f->late, g.radius);
	memset(all->first, 0, (bands + 2) * sizeof *all->first);
	code = enter_all(&g,
			 all->first + 2); /* counted two places on: summed up, and filled, they end where they belong */
	if (code)
		return code;
	for (size_t k = 2; k < bands + 2; k++)
		all->first[k] += all->first[k - 1];
	all->list = late_take(&f->late, all->first[bands + 1], sizeof *all->list);
	if (!all->list)
		return ENCRE_ERROR_MEMORY;
	return enter_all(&g, all->first + 1);
}

/* ---- drawing --------------------------------------------------------------------------------------------- */

/* Pixels x with way_x * x + way_y * y >= from belong to the link. */
typedef struct cut {
	float way_x, way_y, from;
} cut;

typedef struct capsule {
	const pen_end *a, *b;
	float dx, dy, inverse; /* from a to b; 1 / length^2, 0 for a site alone */
	float reach;
	int cuts;
	cut cut[2];
} capsule;

static bool unit_of(float *x, float *y)
{
	float length = sqrtf(*x * *x + *y * *y);
	*x /= length;
	*y /= length;
	return length > 1e-6f;
}

/* Leaves what lies beyond end `here` to the one other link there. */
static void cut_at(const fine *n, capsule *c, uint32_t here, uint32_t there)
{
	if (n->at[here + 1] - n->at[here] != 2)
		return;
	uint32_t other = n->to[n->at[here]] == there ? n->to[n->at[here] + 1] : n->to[n->at[here]];
	const placed *h = &n->site[here].placed, *t = &n->site[there].placed, *o = &n->site[other].placed;
	float ox = h->x - o->x, oy = h->y - o->y, tx = t->x - h->x, ty = t->y - h->y;
	if (!unit_of(&ox, &oy) || !unit_of(&tx, &ty) || ox * tx + oy * ty < 0)
		return;
	float wx = ox + tx, wy = oy + ty;
	unit_of(&wx, &wy);
	c->cut[c->cuts++] = (cut){wx, wy, wx * h->x + wy * h->y - overlap};
}

static capsule capsule_of(const fine *n, const capsules *all, uint32_t a, uint32_t b)
{
	capsule c = {.a = all->end + a, .b = all->end + b};
	c.dx = c.b->x - c.a->x;
	c.dy = c.b->y - c.a->y;
	float square = c.dx * c.dx + c.dy * c.dy;
	c.inverse = square > 1e-12f ? 1 / square : 0;
	c.reach = max(c.a->reach, c.b->reach);
	if (c.reach > 2.5f && a != b && fabsf(c.b->out - c.a->out) < most_steep) {
		cut_at(n, &c, a, b);
		cut_at(n, &c, b, a);
	}
	return c;
}

/* Pixels first..end - 1 of row y that the capsule may darken. */
static void span_of(const capsule *c, int y, int width, int *first, int *end)
{
	float ahead = (float)y - c->a->y, low = min(0, c->dx) - c->reach, high = max(0, c->dx) + c->reach;
	if (fabsf(c->dy) > 1e-6f) { /* between the tangents */
		float middle = ahead * c->dx / c->dy,
		      half = c->reach * sqrtf(c->dx * c->dx + c->dy * c->dy) / fabsf(c->dy);
		low = max(low, middle - half);
		high = min(high, middle + half);
	}
	low += c->a->x;
	high += c->a->x;
	for (int i = 0; i < c->cuts; i++) {
		const cut *k = c->cut + i;
		float rest = k->from - k->way_y * (float)y;
		if (k->way_x > 1e-3f)
			low = max(low, rest / k->way_x);
		else if (k->way_x < -1e-3f)
			high = min(high, rest / k->way_x);
		else if (rest > 0.1f)
			high = low - 1;
	}
	*first = low > 0 ? low < (float)width ? (int)low : width : 0; /* one more than needed to the left */
	*end = high < 0 ? 0 : high < (float)(width - 1) ? (int)high + 1 : width;
}

/* Called with constants each time. Where `owned` is true, who inked is remembered: among equals the nearest; only then
 * distance and owner are read. Where `papered` is false paper is as high as can be. */
static inline void ink_span(const capsule *restrict e, float y, int x, int end, const bool owned, const bool papered,
			    float *restrict dark, const float *restrict depth, const float *restrict grain,
			    float *restrict distance, uint32_t *restrict owner)
{
	const pen_end *a = e->a, *b = e->b;
	float dx = e->dx, dy = e->dy, py = y - a->y, ux = dx * e->inverse, uy = py * dy * e->inverse, from = a->x;
	float out = a->out, fade = a->fade, gain = a->gain, ease = a->ease, bias = a->bias, paper = a->paper,
	      limit = a->limit;
	float more_out = b->out - out, more_fade = b->fade - fade, more_gain = b->gain - gain,
	      more_ease = b->ease - ease;
	float more_bias = b->bias - bias, more_paper = b->paper - paper, more_limit = b->limit - limit;
	uint32_t one = a->owner, two = b->owner;
	for (; x < end; x += LANES)
		for (int k = 0; k < LANES; k++) {
			float px = (float)(x + k) - from, s = px * ux + uy, before = dark[x + k];
			s = s > 0 ? s : 0;
			s = s < 1 ? s : 1;
			float ex = px - s * dx, ey = py - s * dy, d2 = ex * ex + ey * ey;
			float h = papered ? 1 + (paper + s * more_paper) * grain[x + k] : 1, low = bias + s * more_bias;
			float rise = h > low ? h - low : 0, most = (gain + s * more_gain) * rise,
			      ramp = ease + s * more_ease;
			ramp = ramp < rise ? ramp : rise; /* of coverage times height, from nothing to the darkest */
			most = most < 1 ? most : 1;
			float soft = fade + s * more_fade;
			soft = papered ? soft / h : soft;
			float middle = out + s * more_out - soft * (low + 0.5f * ramp), width = soft * ramp;
			width = width > 1 ? width : 1;
			float faint = 2 * middle, half = middle > 0.5f ? middle : 0.5f;
			faint = faint < 1 ? faint : 1;
			faint = faint > 0 ? faint : 0;
			float t = 0.5f + (half - sqrtf(d2)) / width;
			t = t < 1 ? t : 1;
			t = faint * most * t;
			t = depth[x + k] >= limit + s * more_limit ? t : 0;
			if (!owned) {
				dark[x + k] = t > before ? t : before;
				continue;
			}
			float rival = t == before ? distance[x + k] : -1; /* squared distance that an equal must beat */
			int wins = t > before || (t > 0 && d2 < rival);
			dark[x + k] = wins ? t : before;
			distance[x + k] = wins ? d2 : distance[x + k];
			owner[x + k] = wins ? (s > 0.5f ? two : one) : owner[x + k];
		}
}

static void draw_capsule(const capsule *e, canvas *c)
{
	float top = min(e->a->y, e->b->y) - e->reach, bottom = max(e->a->y, e->b->y) + e->reach;
	bool papered = e->a->paper > 0 || e->b->paper > 0;
	int from = top > (float)c->y0 ? (int)top : c->y0, to = bottom < (float)(c->y1 - 1) ? (int)bottom : c->y1 - 1;
	for (int y = from; y <= to; y++) {
		int x, end;
		span_of(e, y, c->f->width, &x, &end);
		if (x >= end)
			continue;
		canvas_touch(c, y, x, end);
		size_t at = (size_t)(y - c->y0) * c->stride;
		float *dark = c->dark + at, *depth = c->depth + at, *grain = c->grain + at;
		if (c->owner && papered)
			ink_span(e, (float)y, x, end, true, true, dark, depth, grain, c->distance + at, c->owner + at);
		else if (c->owner)
			ink_span(e, (float)y, x, end, true, false, dark, depth, grain, c->distance + at, c->owner + at);
		else if (papered)
			ink_span(e, (float)y, x, end, false, true, dark, depth, grain, NULL, NULL);
		else
			ink_span(e, (float)y, x, end, false, false, dark, depth, grain, NULL, NULL);
	}
}

void ISA(capsules_draw)(const capsules *all, canvas *c)
{
	const uint32_t *first = all->first + c->y0 / BAND;
	for (uint32_t i = first[0]; i < first[1]; i++) {
		capsule e = capsule_of(c->f->fine, all, all->list[i][0], all->list[i][1]);
		draw_capsule(&e, c);
	}
}
