/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The second ink, of lines through dark areas. There the first ink ends unseen; the second begins as a point and swells
 * along the line, as a pen that is set down. */
#include "ink/discs.h"
#include "ink/pen.h"
#include "ink/tips.h"
#include "ink/turns.h"
#include "fine/near.h"

enum { CHUNK = 1024 };

/* In half widths: over which darkness is evened each way, and over which a line swells; and the least of both in px. */
static const float evened = 4, swells = 8, least_evened = 2, least_swells = 6;
/* Of the width that a line round a thin thing may have: bright ones before black have no more. */
static const float spared = 0.25f;
/* A point is so much wider than its share of the ink, before that is full. */
static const float blunt = 8;

/* Pixels: the second ink is not there where a line would be no wider, and as wide as it is from a pixel on. What is
 * between is drawn as grey, and many such lines, as of far leaves, would veil the black. */
static const float hair = 0.4f;

typedef struct second {
	const frame *f;
	const fine *n;
	pen_end *end;
	float (*ink)[3];
	float *dark, *even; /* by site: how dark the picture is about it, then how far it has swollen; evened */
	float *bare;        /* how much it bounds a thin bright thing that is before black; -1: nothing tells */
} second;

static float value_at(const frame *f, int x, int y)
{
	const float *rgba = output_row(f, ENCRE_OUTPUT_COMBINED, clamp_index(y, f->height)) +
			    (ptrdiff_t)4 * clamp_index(x, f->width);
	return max(0, bounded(max3(rgba[0], rgba[1], rgba[2])));
}

/* At most 1, between pixels. */
static float value_between(const frame *f, float x, float y)
{
	float left = floorf(x), top = floorf(y), v[4];
	for (int k = 0; k < 4; k++)
		v[k] = min(1, value_at(f, (int)left + (k & 1), (int)top + (k >> 1)));
	return mix(mix(v[0], v[1], x - left), mix(v[2], v[3], x - left), y - top);
}

static float at_way(const frame *f, const placed *s, const float way[2], float far)
{
	return value_between(f, s->x + far * way[0], s->y + far * way[1]);
}

/* How far on from a place of light value v it begins, where half of it is reached: between that and the place `step`
 * before or, so much after, the next. */
static float begins(float v, float before, float next, float light, float step, float after)
{
	float half = max(light, 0.5f * max(v, next));
	if (v >= half)
		return step > 0 ? -step * (v - half) / (v - before) : 0;
	return after * (half - v) / (next - v);
}

/* How far it is dark about a site, in eight ways: 0 where light begins within half of two pixels beyond the rim, a half
 * where it begins there, and 1 from as far again by a half on. */
static float about(const frame *f, const placed *s, float half, float threshold)
{
	static const float way[8][2] = {{1, 0},  {0.707f, 0.707f},   {0, 1},  {-0.707f, 0.707f},
					{-1, 0}, {-0.707f, -0.707f}, {0, -1}, {0.707f, -0.707f}};
	float rim = half + 2, light = 1.5f * threshold, dark = 1;
	for (int k = 0; k < 8 && dark > 0; k++) {
		float on = 0, before = 0, step = 0;
		for (;;) {
			float v = at_way(f, s, way[k], rim * (on + 0.5f));
			if (v >= light) {
				dark = min(dark, on + begins(v, before, at_way(f, s, way[k], rim * (on + 0.5f) + 1),
							     light, step, 1 / rim));
				break;
			}
			dark = min(dark, 1 - clamp01(2 * v / threshold - 2) * (1 - on));
			if (on >= dark) /* nothing farther counts */
				break;
			before = v;
			step = min(1 / rim, dark - on);
			on += step;
		}
	}
	return max(dark, 0);
}

/* Light on the side of a thin thing, and black beyond the rim on the other: a contour there would but take of it what
 * little there is, as the black shows where it ends. */
static float bare_at(const frame *f, const site *made, float half, float threshold)
{
	const found *at = &made->found;
	if (!(made->linked.crowd > 0) || (at->family != FAMILY_CRACK && !is_chain(made)) || at->axis > AXIS_COLUMN)
		return -1;
	int dx = at->axis == AXIS_ROW, dy = 1 - dx, x = at->column, y = at->row;
	if (x + dx >= f->width || y + dy >= f->height) /* of a frame that has one row or column */
		return -1;
	bool ahead = depth_at(f, x + dx, y + dy) < depth_at(f, x, y); /* the thing is */
	float far = (ahead ? -1 : 1) * (1.42f * half + 2);            /* slanted lines are cut aslant */
	float own = value_at(f, x + ahead * dx, y + ahead * dy),
	      beyond = value_at(f, (int)floorf(made->placed.x + far * (float)dx + 0.5f),
				(int)floorf(made->placed.y + far * (float)dy + 0.5f));
	return clamp01(3 - 2 * beyond / threshold) * clamp01(own / threshold - 1.7f);
}

static void find_dark(void *data, int first, int end, int thread)
{
	(void)thread;
	const second *c = data;
	for (int i = first; i < end && !stopped_at(c->n, i); i++) {
		const site *made = c->n->site + i;
		const encre_params *p = params_at(c->f, made->placed.near_x, made->placed.near_y);
		float threshold = p->ink_dark_threshold, half = c->end[i].out;
		c->dark[i] = 0;
		c->bare[i] = -1;
		if (made->linked.dropped || !p->use_lines || !(p->ink_on_dark > 0) || !(threshold > 0))
			continue;
		c->dark[i] = about(c->f, &made->placed, half, threshold);
		c->bare[i] = bare_at(c->f, made, half, threshold);
	}
}

static float reach_of(const second *c, uint32_t i, float halves, float least)
{
	return max(halves * c->end[i].out, least * c->f->scale);
}

static bool goes_on(const fine *n, uint32_t i, uint32_t at)
{
	return at != UINT32_MAX && at != i && !n->site[at].linked.dropped;
}

/* Lets `even` tell, by how far on they are, the sites to whose mean a change may belong: most have none near. */
static int32_t find_changes(const second *c)
{
	const fine *n = c->n;
	int32_t code = ENCRE_OK;
	float most = 0;
	for (uint32_t i = 0; i < n->count; i++) {
		c->even[i] = 0;
		most = max(most, n->site[i].linked.dropped ? 0 : c->end[i].out);
	}
	most = max(evened * most, least_evened * c->f->scale);
	for (uint32_t i = 0; !code && i < n->count; i++) {
		code = at_step(n, i);
		for (uint32_t k = n->at[i]; k < n->at[i + 1]; k++) {
			if (n->site[i].linked.dropped || c->dark[n->to[k]] == c->dark[i])
				continue;
			/* back from the site beyond the change as well, for links are walked from both ends */
			uint32_t from = i, at = n->to[k];
			c->even[i] = most;
			for (float left = most; goes_on(n, i, at);) {
				left -= sqrtf(apart2(n->site + from, n->site + at));
				if (left <= 0 || (links_at(n, at) == 2 && left <= c->even[at]))
					break;
				c->even[at] = max(c->even[at], left);
				uint32_t next = ISA(onward)(n, from, at);
				from = at;
				at = next;
			}
		}
	}
	return code;
}

/* The mean along the line of what is told, each way, with weights that fall to 0 at `reach`. */
static float mean_along(const second *c, const float *values, uint32_t i, float reach)
{
	const fine *n = c->n;
	float told = values[i] >= 0 ? 1 : 0, sum = told * values[i], weights = told;
	for (uint32_t k = n->at[i]; k < n->at[i + 1]; k++) {
		uint32_t from = i, at = n->to[k];
		for (float along = 0; goes_on(n, i, at);) {
			along += sqrtf(apart2(n->site + from, n->site + at));
			if (along >= reach)
				break;
			told = values[at] >= 0 ? 1 - along / reach : 0;
			sum += told * values[at];
			weights += told;
			uint32_t next = ISA(onward)(n, from, at);
			from = at;
			at = next;
		}
	}
	return weights > 0 ? sum / weights : 0;
}

static void even_dark(void *data, int first, int end, int thread)
{
	(void)thread;
	const second *c = data;
	for (uint32_t i = (uint32_t)first; i < (uint32_t)end && !stopped_at(c->n, (int)i); i++) {
		float dark = c->dark[i];
		if (dark > 0 && c->even[i] > 0)
			dark = mean_along(c, c->dark, i, reach_of(c, i, evened, least_evened));
		c->even[i] = c->dark[i] > 0 ? clamp01(2 * dark - 1) : 0;
	}
}

/* How wide lines are: along each as dark as it is, but rising by no more than 1 over where it swells. */
static int32_t swell(const second *c)
{
	const fine *n = c->n;
	float *full = c->dark;
	int32_t code = ENCRE_OK;
	memcpy(full, c->even, n->count * sizeof *full);
	for (uint32_t i = 0; !code && i < n->count; i++) {
		code = at_step(n, i);
		if (n->site[i].linked.dropped || !(c->even[i] < 1))
			continue;
		for (uint32_t k = n->at[i]; k < n->at[i + 1]; k++) {
			uint32_t from = i, at = n->to[k];
			for (float level = c->even[i]; goes_on(n, i, at);) {
				float reach =
					reach_of(c, from, swells, least_swells) + reach_of(c, at, swells, least_swells);
				level += 2 * sqrtf(apart2(n->site + from, n->site + at)) / reach;
				if (level >= 1 || (links_at(n, at) == 2 && level >= full[at]))
					break;
				full[at] = min(full[at], level);
				uint32_t next = ISA(onward)(n, from, at);
				from = at;
				at = next;
			}
		}
	}
	return code;
}

/* Leaves most of thin bright things. */
static void spare(const second *c, uint32_t i, const encre_params *p, pen_end *e)
{
	const site *made = c->n->site + i;
	if (!(made->linked.crowd > 0) || made->linked.dropped || !(e->out > 0) || !(p->ink_on_dark > 0))
		return;
	float bare = clamp01(1.5f * mean_along(c, c->bare, i, reach_of(c, i, evened, least_evened)));
	float most = spared * (1 - made->placed.thin) / made->linked.crowd, out = min(e->out, most);
	out = mix(e->out, out, bare * (1 - c->even[i]) * p->ink_on_dark);
	e->fade *= out / e->out;
	e->out = out;
}

static void take_ink(void *data, int first, int end, int thread)
{
	(void)thread;
	const second *c = data;
	for (int i = first; i < end && !stopped_at(c->n, i); i++) {
		const placed *s = &c->n->site[i].placed;
		const encre_params *p = params_at(c->f, s->near_x, s->near_y);
		pen_end *e = c->end + i;
		spare(c, (uint32_t)i, p, e);
		if (!(c->even[i] > 0))
			continue;
		float full = c->dark[i], share = p->ink_on_dark, wide = p->ink_dark_width;
		for (int k = 0; k < 3; k++)
			c->ink[i][k] = blend(c->ink[i][k], p->ink_dark_color[k], share * min(1, blunt * full));
		full *= e->out > 0 ? max(wide, min(1, 0.5f / e->out)) : 1; /* none gets thinner than a pixel */
		if (is_colored(c->n->site + i))                            /* but what somebody painted stays */
			full *= mix(p->ink_dark_colors, 1, clamp01(ISA(fine_painted)(c->n, s)));
		full *= clamp01((2 * e->out * full - hair) / (1 - hair));
		e->out *= mix(1, full, share); /* its reach is no less */
		e->fade *= mix(1, full, share);
	}
}

bool ISA(takes_second)(const encre_params *p)
{
	return p->use_lines && p->ink_on_dark > 0;
}

int32_t ISA(second_ink)(frame *f, pen_end *end, float (*ink)[3])
{
	const fine *n = f->fine;
	second c = {f, n, end, ink, late_take(&f->late, n->count, sizeof *c.dark), NULL, NULL};
	c.even = c.dark ? late_take(&f->late, n->count, sizeof *c.even) : NULL;
	c.bare = c.even ? late_take(&f->late, n->count, sizeof *c.bare) : NULL;
	if (!c.bare)
		return ENCRE_ERROR_MEMORY;
	int32_t code = bands_run(f->bands, (int)n->count, CHUNK, find_dark, &c);
	if (!code)
		code = find_changes(&c);
	if (!code)
		code = bands_run(f->bands, (int)n->count, CHUNK, even_dark, &c);
	if (!code)
		code = swell(&c);
	if (!code)
		code = bands_run(f->bands, (int)n->count, CHUNK, take_ink, &c);
	late_drop(&f->late, c.dark);
	late_drop(&f->late, c.even);
	late_drop(&f->late, c.bare);
	return code;
}
