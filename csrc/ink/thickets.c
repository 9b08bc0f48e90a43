/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Thickets: where lines would cover more of the picture than they may, far away, they thin out together, or the lesser
 * of them are left out. */
#include "ink/thickets.h"
#include "ink/discs.h"
#include "ink/tips.h"
#include "fine/near.h"

/* Px from node to node of the grids on which ink is weighed, at least 2 pixels: where lines get thinner, and closer by,
 * as about a small eye, whose bare cheek far nodes count as room in it; and where some of a mass are left out, which
 * would come and go with fewer of them to a node. Near nodes alone would leave broad lines more than they may: by
 * itself one covers all of such a node. */
static const float dense[] = {12, 7}, sparse = 20, least_node = 2; /* test_fine_ink */

enum { PLANES = 64 };

typedef struct grid {
	int across, tall;
	float step;   /* pixels from node to node */
	float x, y;   /* of the picture's corner from the first node: nodes are the full frame's */
	float *share; /* of what is about a node lines cover, by how little these matter: one plane after the other */
	float *mine;  /* by axis and node: of what is about it the frame shows */
	int planes;
	const float *lines;   /* by site: how many lie on each other; NULL: all count */
	const float *matters; /* likewise: 0..1; NULL: all do alike */
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

/* Pixels across its line that a site covers: its part where so many lie on each other; of a thin thing whose lines are
 * one, each of them covers half. */
static float wide(const site *s, float radius, float doubled)
{
	float lines = s->found.family == FAMILY_THIN ? 1 : 2;
	return mix(2 * radius / doubled, 2 * (s->placed.half + radius) / lines, filled_by(s, radius));
}

/* The plane of a site, and how far on it lies from there to the next, which matters more. */
static int plane_of(const grid *g, uint32_t i, float *on)
{
	float at = g->matters ? min(g->matters[i], 1) * (float)(g->planes - 1) : 0;
	int plane = clamp_index((int)at, g->planes);
	*on = clamp01(at - (float)plane);
	return plane;
}

static size_t nodes_of(const grid *g)
{
	return (size_t)g->across * (size_t)g->tall;
}

/* Shared out among four nodes. */
static void put(const grid *g, float *at, float u, float v, float ink)
{
	at[0] += (1 - u) * (1 - v) * ink;
	at[1] += u * (1 - v) * ink;
	at[g->across] += (1 - u) * v * ink;
	at[g->across + 1] += u * v * ink;
}

/* Between two planes ink is shared out, too: what matters a little more or less is no other ink. */
static int32_t weigh(const fine *n, const grid *g, const pen_end *end)
{
	int32_t code = ENCRE_OK;
	float area = g->step * g->step;
	memset(g->share, 0, nodes_of(g) * (size_t)g->planes * sizeof *g->share);
	for (uint32_t i = 0; !code && i < n->count; i++) {
		int x, y;
		float u, v, on;
		code = at_step(n, i);
		if (n->site[i].linked.dropped || !(end[i].out > 0))
			continue;
		place_on(g, &n->site[i].placed, &x, &y, &u, &v);
		float radius = left_of(n->site + i, end[i].out);
		float ink = wide(n->site + i, radius, g->lines ? g->lines[i] : 1) * length_at(n, i, radius) / area;
		int plane = plane_of(g, i, &on);
		float *at = g->share + (size_t)plane * nodes_of(g) + y * g->across + x;
		put(g, at, u, v, (1 - on) * ink);
		if (on > 0)
			put(g, at + nodes_of(g), u, v, on * ink);
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

static void blur(const grid *g, float *share)
{
	for (int y = 0; y < g->tall; y++)
		blur_line(share + y * g->across, g->across, 1);
	for (int x = 0; x < g->across; x++)
		blur_line(share + x, g->tall, g->across);
}

/* Of what is about a node, evened as ink is: beyond the rim of the frame lies no ink, which is not to say that there is
 * bare paper. */
static void show(float *mine, int n, float from, int size, float step)
{
	for (int k = 0; k < n; k++)
		mine[k] = 0;
	for (int at = 0; at < size; at++) {
		float on = (from + (float)at + 0.5f) / step;
		int k = clamp_index((int)on, n - 1);
		on = clamp01(on - (float)k);
		mine[k] += (1 - on) / step;
		mine[k + 1] += on / step;
	}
	blur_line(mine, n, 1);
	blur_line(mine, n, 1);
}

/* Each plane holds what matters at least as much. */
static void even_out(const grid *g)
{
	for (int k = g->planes - 1; k >= 0; k--) {
		float *share = g->share + (size_t)k * nodes_of(g), *more = share + nodes_of(g);
		blur(g, share);
		blur(g, share);
		for (int y = 0; y < g->tall; y++)
			for (int x = 0; x < g->across; x++, share++, more++) {
				*share /= max(g->mine[x] * g->mine[g->across + y], 1e-6f);
				if (k + 1 < g->planes)
					*share += *more;
			}
	}
}

static float share_at(const grid *g, const placed *s, int plane)
{
	int x, y;
	float u, v;
	if (plane >= g->planes)
		return 0;
	place_on(g, s, &x, &y, &u, &v);
	const float *at = g->share + (size_t)plane * nodes_of(g) + y * g->across + x;
	return mix(mix(at[0], at[1], u), mix(at[g->across], at[g->across + 1], u), v);
}

/* How much is left of a line when those that matter more have had their part of what may be covered: the more lines
 * there are, the less of it, so that a thing gets lighter as it goes away. Those
 * that matter less and less fade, so that none pops. */
static float kept_of(const grid *g, uint32_t i, const placed *s, const encre_params *p)
{
	float on, most = p->line_density, share = share_at(g, s, 0);
	int plane = plane_of(g, i, &on);
	if (!(share > most && most < 1 && p->line_fewer > 0))
		return 1;
	float more = mix(share_at(g, s, plane), share_at(g, s, plane + 1), on),
	      may = mix(share, most * most / share, p->line_fewer);
	return clamp01(2 - more / may);
}

/* Half the width down to which lines get thinner before some of them are left out: in px, and in pixels, at least, for
 * what is thinner than one is grey. */
static const float thinnest = 0.8f, crisp = 0.6f;

static int32_t share_out(const fine *n, grid *g, const pen_end *end)
{
	int32_t code = weigh(n, g, end);
	even_out(g);
	return code;
}

/* What a line by itself covers of what is about it, times its width in nodes: at most 3/8 on a node, and more where it
 * bends. */
static const float by_itself = 0.5f;

/* The radius to which a site's is thinned. Where some may be left out, all get thinner only as long as they are crisp.
 */
static float thinned(const frame *f, const grid *g, uint32_t i, float radius)
{
	const fine *n = f->fine;
	const site *s = n->site + i;
	const encre_params *p = params_at(f, s->placed.near_x, s->placed.near_y);
	float on, least = p->line_fewer * max(thinnest * f->scale, crisp);
	int plane = plane_of(g, i, &on);
	float share = mix(share_at(g, &s->placed, plane), share_at(g, &s->placed, plane + 1), on),
	      left = left_of(s, radius), most = max(p->line_density, by_itself * 2 * left / g->step);
	return p->line_density < 1 && share > most ? max(left * most / share, min(left, least)) : radius;
}

static int32_t leave_out(frame *f, grid *g, const spots *at, const pen_end *end, float *kept)
{
	const fine *n = f->fine;
	float *matters = late_take(&f->late, n->count, sizeof *matters),
	      *left = late_take(&f->late, n->count, sizeof *left);
	if (!matters || !left)
		return ENCRE_ERROR_MEMORY;
	int32_t code = ISA(lines_matter)(f, at, matters);
	g->matters = matters;
	if (!code)
		code = share_out(n, g, end);
	for (uint32_t i = 0; !code && i < n->count; i++) {
		const placed *s = &n->site[i].placed;
		const encre_params *p = params_at(f, s->near_x, s->near_y);
		left[i] = n->site[i].linked.dropped ? 0 : kept_of(g, i, s, p);
	}
	if (!code)
		code = ISA(lines_decide)(f, left, kept);
	late_drop(&f->late, left);
	late_drop(&f->late, matters);
	return code;
}

/* A grid of nodes so many px apart, and room for its planes. */
static bool grid_make(frame *f, float node, int planes, const float *lines, grid *g)
{
	*g = (grid){.step = max(node * f->scale, least_node), .planes = planes, .lines = lines};
	g->x = (float)f->place.x - floorf((float)f->place.x / g->step) * g->step;
	g->y = (float)f->place.y - floorf((float)f->place.y / g->step) * g->step;
	g->across = (int)(((float)f->width + g->x) / g->step) + 2;
	g->tall = (int)(((float)f->height + g->y) / g->step) + 2;
	g->share = late_take(&f->late, nodes_of(g) * (size_t)planes, sizeof *g->share);
	g->mine = late_take(&f->late, (size_t)g->across + (size_t)g->tall, sizeof *g->mine);
	if (!g->share || !g->mine)
		return false;
	show(g->mine, g->across, g->x, f->width, g->step);
	show(g->mine + g->across, g->tall, g->y, f->height, g->step);
	return true;
}

static void grid_drop(frame *f, grid *g)
{
	late_drop(&f->late, g->mine);
	late_drop(&f->late, g->share);
}

/* Px from node to node where it is weighed how many lines are about one, and the share of what they may cover up to
 * which a hand presses as it likes. */
static const float about = 40, as_it_likes = 0.5f;

int32_t ISA(thickets_press)(frame *f, const pen_end *end, float *press)
{
	const fine *n = f->fine;
	grid g;
	if (!grid_make(f, about, 1, NULL, &g))
		return ENCRE_ERROR_MEMORY;
	int32_t code = share_out(n, &g, end);
	for (uint32_t i = 0; !code && i < n->count; i++) {
		const placed *s = &n->site[i].placed;
		float most = params_at(f, s->near_x, s->near_y)->line_density;
		press[i] = most < 1 ? clamp01((1 - share_at(&g, s, 0) / most) / (1 - as_it_likes)) : 1;
	}
	grid_drop(f, &g);
	return code;
}

/* On nodes so many px apart; `only` is told instead of thinning, of the first stroke. */
static int32_t thin_all(frame *f, float node, uint32_t strokes, const float *lines, const float *outer, pen_end *end,
			float *only)
{
	const fine *n = f->fine;
	grid g;
	if (!grid_make(f, node, 2, lines, &g))
		return ENCRE_ERROR_MEMORY;
	g.matters = outer;
	int32_t code = share_out(n, &g, end);
	for (uint32_t i = 0; !code && i < n->count; i++)
		for (uint32_t k = 0; k < strokes && !n->site[i].linked.dropped; k++) {
			float *out = &end[(size_t)k * n->count + i].out;
			*(only ? only + i : out) = thinned(f, &g, i, *out);
		}
	grid_drop(f, &g);
	return code;
}

int32_t ISA(thickets_thin)(frame *f, uint32_t strokes, const spots *at, pen_end *end, float *kept)
{
	grid g;
	const fine *n = f->fine;
	float *outer = late_take(&f->late, n->count, sizeof *outer),
	      *only = late_take(&f->late, n->count, sizeof *only),
	      *lines = late_take(&f->late, n->count, sizeof *lines);
	int32_t code = outer && only && lines ? ISA(lines_outer)(f, outer) : ENCRE_ERROR_MEMORY;
	if (!code)
		code = thin_all(f, dense[0], 1, NULL, outer, end, only);
	if (!code)
		code = ISA(lines_doubled)(f, end, only, lines);
	for (int k = 0; !code && k < 2; k++)
		code = thin_all(f, dense[k], strokes, lines, outer, end, NULL);
	late_drop(&f->late, lines);
	late_drop(&f->late, only);
	late_drop(&f->late, outer);
	if (code || !kept)
		return code;
	if (!grid_make(f, sparse, PLANES, NULL, &g))
		return ENCRE_ERROR_MEMORY;
	code = leave_out(f, &g, at, end, kept);
	grid_drop(f, &g);
	return code;
}
