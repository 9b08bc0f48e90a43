/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Thickets: where lines would cover more of the picture than they may, far away, they thin out together. */
#include "ink/discs.h"
#include "ink/tips.h"
#include "fine/near.h"

/* Px from node to node of the grid on which ink is weighed; at least 2 pixels. */
static const float node = 16, least_node = 2;

typedef struct grid {
	int across, tall;
	float step;   /* pixels from node to node */
	float x, y;   /* of the picture's corner from the first node: nodes are the full frame's */
	float *share; /* of what is about a node lines cover */
} grid;

/* The node above and left of a place, and how far on it lies; nodes reach one beyond the frame. */
static void place_on(const grid *g, const placed *s, int *x, int *y, float *u, float *v)
{
	float px = max(g->x + s->x + 0.5f, 0) / g->step, py = max(g->y + s->y + 0.5f, 0) / g->step;
	*x = clamp_index((int)px, g->across - 1);
	*y = clamp_index((int)py, g->tall - 1);
	*u = clamp01(px - (float)*x);
	*v = clamp01(py - (float)*y);
}

/* Pixels of a site's share of its line: half of each of its links. */
static float length_at(const fine *n, uint32_t i, float radius)
{
	float length = 0;
	for (uint32_t k = n->at[i]; k < n->at[i + 1]; k++)
		if (!n->site[n->to[k]].linked.dropped)
			length += 0.5f * sqrtf(apart2(n->site + i, n->site + n->to[k]));
	return n->at[i] == n->at[i + 1] ? 2 * radius : length;
}

/* Pixels across its line that a site covers: of a thin thing whose lines are one, each of them covers half. */
static float wide(const site *s, float radius)
{
	float lines = s->found.family == FAMILY_THIN ? 1 : 2;
	return mix(2 * radius, 2 * (s->placed.half + radius) / lines, filled_by(s, radius));
}

/* What its room leaves of a site's radius. */
static float left_of(const site *s, float radius)
{
	return radius * s->linked.crowd > 1 ? 1 / s->linked.crowd : radius;
}

static int32_t weigh(const fine *n, const grid *g, const pen_end *end)
{
	int32_t code = ENCRE_OK;
	float area = g->step * g->step;
	memset(g->share, 0, (size_t)g->across * (size_t)g->tall * sizeof *g->share);
	for (uint32_t i = 0; !code && i < n->count; i++) {
		int x, y;
		float u, v;
		code = at_step(n, i);
		if (n->site[i].linked.dropped || !(end[i].out > 0))
			continue;
		place_on(g, &n->site[i].placed, &x, &y, &u, &v);
		float radius = left_of(n->site + i, end[i].out);
		float ink = wide(n->site + i, radius) * length_at(n, i, radius) / area,
		      *at = g->share + y * g->across + x;
		at[0] += (1 - u) * (1 - v) * ink;
		at[1] += u * (1 - v) * ink;
		at[g->across] += (1 - u) * v * ink;
		at[g->across + 1] += u * v * ink;
	}
	return code;
}

/* (1 2 1) / 4 along lines of n nodes, `step` apart. */
static void blur_line(float *at, int n, ptrdiff_t step)
{
	float before = 0;
	for (int i = 0; i < n; i++, at += step) {
		float own = *at, after = i + 1 < n ? at[step] : 0;
		*at = 0.25f * (before + 2 * own + after);
		before = own;
	}
}

static void blur(const grid *g)
{
	for (int y = 0; y < g->tall; y++)
		blur_line(g->share + y * g->across, g->across, 1);
	for (int x = 0; x < g->across; x++)
		blur_line(g->share + x, g->tall, g->across);
}

int32_t ISA(thickets_thin)(frame *f, uint32_t strokes, pen_end *end)
{
	const fine *n = f->fine;
	grid g = {.step = max(node * f->scale, least_node)};
	g.x = (float)f->place.x - floorf((float)f->place.x / g.step) * g.step;
	g.y = (float)f->place.y - floorf((float)f->place.y / g.step) * g.step;
	g.across = (int)(((float)f->width + g.x) / g.step) + 2;
	g.tall = (int)(((float)f->height + g.y) / g.step) + 2;
	g.share = late_take(&f->late, (size_t)g.across * (size_t)g.tall, sizeof *g.share);
	if (!g.share)
		return ENCRE_ERROR_MEMORY;
	int32_t code = weigh(n, &g, end);
	blur(&g);
	blur(&g);
	for (uint32_t i = 0; !code && i < n->count; i++) {
		const placed *s = &n->site[i].placed;
		int x, y;
		float u, v, most = params_at(f, s->near_x, s->near_y)->line_density;
		if (n->site[i].linked.dropped)
			continue;
		place_on(&g, s, &x, &y, &u, &v);
		const float *at = g.share + y * g.across + x;
		float share = mix(mix(at[0], at[1], u), mix(at[g.across], at[g.across + 1], u), v);
		for (uint32_t k = 0; share > most && most < 1 && k < strokes; k++)
			end[(size_t)k * n->count + i].out =
				left_of(n->site + i, end[(size_t)k * n->count + i].out) * most / share;
	}
	late_drop(&f->late, g.share);
	return code;
}
