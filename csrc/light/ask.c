/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Rays from what pixels show to points of a lamp: one at a time, eight, and those of a square of pixels. */
#include "light/light.h"
#include "light/local.h"

/* How much of its lift a ray takes: all where it would go into the facet, none where it leaves that at more than a few
 * degrees, for a tall lift passes by what throws a shadow. Cycles' rule. */
static inline float lifted(vec normal, vec across, vec way)
{
	const float graze = 0.1f;
	float rate = 1 / (graze * sqrtf(max(dot(way, way), 1e-30f)));
	float facet = dot(across, way) * rate, shaded = dot(normal, way) * rate;
	return clamp01(shaded < 1 ? 2 - facet - shaded : 1 - facet);
}

/* How far above a surface rays begin. */
static float ray_off(const surface *s)
{
	return (largest(s->at) + 1) * (s->instance >= 0 ? 1e-6f : 1e-3f);
}

/* Where a ray begins. */
static inline vec ray_start(vec at, vec normal, vec across, vec lift, float off, vec way)
{
	vec from = plus(at, times(across, off)), above = plus(from, times(lift, lifted(normal, across, way)));
	const bool lifts = dot(lift, lift) > 0;
	return (vec){lifts ? above.x : from.x, lifts ? above.y : from.y, lifts ? above.z : from.z};
}

/* Begins a ray where ellipsoids that bend light end. */
static void leave_bends(const light *l, vec at, float far, vec *from, vec *way)
{
	float free = l->n_bends ? ISA(bend_free)(l, at, *way) : 0;
	if (!(free > 0))
		return;
	free = far < lamp_far ? min(free, 0.999f) : free;
	*from = plus(*from, times(*way, free));
	*way = far < lamp_far ? times(*way, 1 - free) : *way;
}

/* far: how much of the way belongs to it. */
static ray ray_to(const light *l, const surface *s, vec way, float far)
{
	ray r = {.from = ray_start(s->at, s->normal, s->across, s->lift, ray_off(s), way),
		 .way = way,
		 .far = far,
		 .instance = s->instance,
		 .triangle = s->triangle,
		 .set = l->lamp.shadow_set};
	if (far < lamp_far)
		r.way = plus(way, minus(s->at, r.from));
	leave_bends(l, s->at, far, &r.from, &r.way);
	return r;
}

bool ISA(ask_thrower)(const light *l, const surface *s, vec *place)
{
	vec way;
	float far, share;
	if (!(lamp_light(&l->lamp, s->at, s->normal, &l->points.middle, &way, &far) > 0))
		return false;
	ray r = ray_to(l, s, way, far);
	if (!ISA(ray_stops)(&l->world, &r, &share))
		return false;
	*place = plus(r.from, times(r.way, share));
	return true;
}

void ISA(ask_point)(const light *l, const surface *s, const lamp_point *q, float *all, float *seen, rays *from)
{
	vec way;
	float far, value = lamp_light(&l->lamp, s->at, s->normal, q, &way, &far);
	if (!(value > 0 && value <= FLT_MAX))
		return;
	*all += value;
	ray r = ray_to(l, s, way, far);
	if (!l->lamp.shadows || !ISA(ray_blocked)(&l->world, &r, &from->hint))
		*seen += value;
}

void ISA(ask_add)(asking *a, const surface *s, const lamp_point *q, int start)
{
	const int k = a->count++;
	if (k == 0) {
		a->first = *s;
		a->first_point = *q;
	}
	put_lane(&a->at, k, s->at);
	put_lane(&a->normal, k, s->normal);
	put_lane(&a->lift, k, s->lift);
	put_lane(&a->across, k, s->across);
	a->off[k] = ray_off(s);
	for (int c = 0; c < 2; c++) {
		a->square[c][k] = q->square[c];
		a->disc[c][k] = q->disc[c];
	}
	a->rays.instance[k] = s->instance;
	a->rays.triangle[k] = s->triangle;
	a->rays.start[k] = start;
}

/* Values and rays, of a lamp of which the compiler knows so much. The bits of those that give light. */
KERNEL unsigned ask_lamp(const light *l, int type, bool flat, asking *a)
{
	lamp lamp = l->lamp;
	lamp.type = type;
	lamp.flat = flat;
	const float far = type == ENCRE_SUN ? lamp_far : lamp_near;
	int32_t some[PACK];
	for (int k = 0; k < PACK; k++) {
		vec at = lane(&a->at, k), normal = lane(&a->normal, k), way;
		lamp_point q = {.square = {a->square[0][k], a->square[1][k]}, .disc = {a->disc[0][k], a->disc[1][k]}};
		float its, value = lamp_ray(&lamp, at, normal, &q, &way, &its);
		const bool any = (value > 0) & (value <= FLT_MAX);
		some[k] = -any;
		a->value[k] = any ? value : 0;
		vec from = ray_start(at, normal, lane(&a->across, k), lane(&a->lift, k), a->off[k], way);
		put_lane(&a->rays.from, k, from);
		put_lane(&a->rays.way, k, type == ENCRE_SUN ? way : plus(way, minus(at, from)));
	}
	a->rays.far = far;
	return negative(some);
}

static unsigned ask_lamp_of(const light *l, asking *a)
{
	switch (l->lamp.type) {
	case ENCRE_SUN: return ask_lamp(l, ENCRE_SUN, false, a);
	case ENCRE_POINT: return l->lamp.flat ? ask_lamp(l, ENCRE_POINT, true, a) : ask_lamp(l, ENCRE_POINT, false, a);
	case ENCRE_SPOT: return l->lamp.flat ? ask_lamp(l, ENCRE_SPOT, true, a) : ask_lamp(l, ENCRE_SPOT, false, a);
	case ENCRE_RECTANGLE: return ask_lamp(l, ENCRE_RECTANGLE, false, a);
	default: return ask_lamp(l, ENCRE_ELLIPSE, false, a);
	}
}

unsigned ISA(ask_all)(const light *l, asking *a, shaft *through)
{
	const unsigned own = (1u << a->count) - 1;
	while (a->count < PACK)
		ISA(ask_add)(a, &a->first, &a->first_point, a->rays.start[0]);
	a->count = 0;
	unsigned some = ask_lamp_of(l, a) & own;
	if (!l->lamp.shadows)
		return some;
	for (int k = 0; k < PACK && l->n_bends; k++) {
		vec start = lane(&a->rays.from, k), way = lane(&a->rays.way, k);
		leave_bends(l, lane(&a->at, k), a->rays.far, &start, &way);
		put_lane(&a->rays.from, k, start);
		put_lane(&a->rays.way, k, way);
	}
	a->rays.set = l->lamp.shadow_set;
	return some & ~ISA(pack_blocked)(through, &l->world, &a->rays, some);
}

uint64_t ISA(ask_group)(const light *l, int x, int y, uint64_t left, int apron, shaft *to)
{
	const int first = __builtin_ctzll(left);
	const surface *one = l->surfaces + (ptrdiff_t)(y + first / SHAFT_SIDE) * l->width + x + first % SHAFT_SIDE;
	uint64_t group = 0;
	float off = 0;
	shaft_starts from = {.within = {one->at, one->at}, .instance = one->instance};
	for (int v = -apron; v < SHAFT_SIDE + apron; v++)
		for (int u = -apron; u < SHAFT_SIDE + apron; u++) {
			bool own = u >= 0 && v >= 0 && u < SHAFT_SIDE && v < SHAFT_SIDE;
			uint64_t bit = own ? (uint64_t)1 << (v * SHAFT_SIDE + u) & left : 0;
			if ((!bit && !apron) || x + u < 0 || y + v < 0 || x + u >= l->width || y + v >= l->height)
				continue;
			const surface *s = l->surfaces + (ptrdiff_t)(y + v) * l->width + x + u;
			if (s->instance == SURFACE_NOTHING || (s != one && !one_surface(one, s)))
				continue;
			group |= bit;
			box_add(&from.within, s->at);
			box_add(&from.within, plus(s->at, s->lift));
			off = max(off, ray_off(s));
			if (apron || from.instance != s->instance) {
				from.instance = -1;
				continue;
			}
			from.at[0][from.count] = plus(s->at, times(s->across, ray_off(s)));
			from.at[1][from.count] = plus(from.at[0][from.count], s->lift);
			from.triangle[from.count++] = s->triangle;
		}
	const vec more = {2 * off, 2 * off, 2 * off};
	from.within = (box){minus(from.within.low, more), plus(from.within.high, more)};
	from.count = from.instance >= 0 ? from.count : 0;
	to->usable = false;
	if (l->lamp.shadows && __builtin_popcountll(group) >= SHAFT_FEW)
		ISA(shaft_make)(to, &l->world, &from, l->lamp.goal, l->lamp.type == ENCRE_SUN ? lamp_far : 1,
				l->lamp.shadow_set);
	return group;
}
