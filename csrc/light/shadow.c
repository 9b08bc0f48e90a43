/* SPDX-License-Identifier: GPL-3.0-or-later */
/* How much of a lamp's light comes to what each pixel shows, and where the light of a lamp without a size ends: one ray
 * a pixel. Where two neighbours on one surface disagree, halving the way between them finds where the edge passes; the
 * share is linear in the distance to the line through the places so found, over 2 pixels, so that half of the light is
 * where the edge is. */
#include "light/light.h"

enum { HALVINGS = 7 };

/* How much of its lift a ray takes: all where it would go into the facet, none where it leaves that at more than a few
 * degrees, for a tall lift passes by what throws a shadow. Cycles' rule. */
static float lifted(const surface *s, vec way)
{
	const float graze = 0.1f;
	float rate = 1 / (graze * sqrtf(max(dot(way, way), 1e-30f)));
	float facet = dot(s->across, way) * rate, shaded = dot(s->normal, way) * rate;
	return clamp01(shaded < 1 ? 2 - facet - shaded : 1 - facet);
}

/* How far above a surface rays begin. */
static float ray_off(const surface *s)
{
	return (largest(s->at) + 1) * (s->instance >= 0 ? 1e-6f : 1e-3f);
}

/* far: how much of the way belongs to it. */
static ray ray_to(const light *l, const surface *s, vec way, float far)
{
	vec from = plus(s->at, times(s->across, ray_off(s)));
	if (dot(s->lift, s->lift) > 0)
		from = plus(from, times(s->lift, lifted(s, way)));
	ray r = {.from = from,
		 .way = way,
		 .far = far,
		 .instance = s->instance,
		 .triangle = s->triangle,
		 .set = l->lamp.shadow_set};
	if (far < lamp_far)
		r.way = plus(way, minus(s->at, r.from));
	float free = l->n_bends ? ISA(bend_free)(l, s->at, r.way) : 0;
	if (free > 0) {
		free = far < lamp_far ? min(free, 0.999f) : free;
		r.from = plus(r.from, times(r.way, free));
		r.way = far < lamp_far ? times(r.way, 1 - free) : r.way;
	}
	return r;
}

bool ISA(shadow_thrower)(const light *l, const surface *s, vec *place)
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

void ISA(shadow_ask)(const light *l, const surface *s, const lamp_point *q, float *all, float *seen, rays *from)
{
	vec way;
	float far, value = lamp_light(&l->lamp, s->at, s->normal, q, &way, &far);
	if (!(value > 0 && value <= FLT_MAX))
		return;
	*all += value;
	ray r = ray_to(l, s, way, far);
	if (!l->lamp.shadows || !(from->shaft ? ISA(shaft_blocks)(from->shaft, &l->world, &r, &from->hint)
					      : ISA(ray_blocked)(&l->world, &r, &from->hint)))
		*seen += value;
}

uint64_t ISA(shadow_group)(const light *l, int x, int y, uint64_t left, int apron, shaft *to)
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

static bool lights(const light *l, const surface *s)
{
	if (s->instance == SURFACE_NOTHING)
		return false;
	return s->instance == SURFACE_STRAY || l->world.instances[s->instance]->light_sets >> l->lamp.light_set & 1;
}

/* What the plain points of a ball or disc give that is seen from outside. */
static void ball_values(const light *l, const surface *s, vec to, float distance, float value[LAMP_PLAIN])
{
	const lamp *a = &l->lamp;
	const ball b = ball_from(a, to, distance);
	const float *x = l->points.disc[0], *y = l->points.disc[1];
	vec way[LAMP_PLAIN];
	for (int k = 0; a->flat && k < LAMP_PLAIN; k++)
		value[k] = disc_point(&b, to, s->normal, x[k], y[k], way + k);
	for (int k = 0; !a->flat && k < LAMP_PLAIN; k++)
		value[k] = ball_point(&b, s->normal, x[k], y[k], way + k);
	for (int k = 0; a->type == ENCRE_SPOT && k < LAMP_PLAIN; k++)
		value[k] *= spot_share(a, way[k]);
}

/* Light without shadows. */
static float plain_light(const light *l, const surface *s)
{
	const lamp *a = &l->lamp;
	float sum = 0, far;
	vec way;
	if (!a->soft) {
		sum = lamp_light(a, s->at, s->normal, &l->points.middle, &way, &far);
	} else if (!lamp_mean(a, s->at, s->normal, &sum)) {
		sum = 0;
		float value[LAMP_PLAIN];
		vec to = minus(a->at, s->at);
		float distance = sqrtf(dot(to, to));
		if (a->type == ENCRE_RECTANGLE || a->type == ENCRE_ELLIPSE) {
			for (int k = 0; k < LAMP_PLAIN; k++)
				value[k] = area_light(a, to, s->normal, l->points.plain + k, &way);
		} else if (a->type != ENCRE_SUN && distance > a->radius) {
			ball_values(l, s, to, distance, value);
		} else {
			for (int k = 0; k < LAMP_PLAIN; k++)
				value[k] = lamp_light(a, s->at, s->normal, l->points.plain + k, &way, &far);
		}
		for (int k = 0; k < LAMP_PLAIN; k++)
			sum += value[k];
		sum /= LAMP_PLAIN;
	}
	return sum > 0 && sum <= FLT_MAX ? sum : 0;
}

/* What the few points of a pixel say. */
static void ask_centre(light *l, int x, int y, rays *from)
{
	const encre_frame *f = &l->job->frame;
	ptrdiff_t i = (ptrdiff_t)y * l->width + x;
	const lamp_point *first = l->soft ? l->points.first[(f->y + y - DEALT_FROM) & (LAMP_WIDE - 1)]
							   [(f->x + x - DEALT_FROM) & (LAMP_WIDE - 1)]
					  : &l->points.middle;
	int dealt = l->soft ? LAMP_DEALT : 1;
	float all = 0, seen = 0;
	bool free = shaft_free(from->shaft); /* all of it comes: is there any? */
	for (int k = 0; k < dealt && !(free && all > 0); k++)
		ISA(shadow_ask)(l, l->surfaces + i, first + k, &all, &seen, from);
	l->state[i] = !(all > 0) ? MIXED : (uint8_t)((seen > 0 ? LIT : 0) | (seen < all ? DARK : 0));
	l->share[i] = all > 0 ? seen / all : !l->soft; /* sharp, of a lamp whose middle is below the horizon */
}

static bool lit_without_shadows(light *l, int x, int y)
{
	ptrdiff_t i = (ptrdiff_t)y * l->width + x;
	const surface *at = l->surfaces + i;
	l->state[i] = 0;
	l->plain[i] = lights(l, at) ? plain_light(l, at) : 0;
	l->share[i] = l->plain[i] > 0;
	return l->plain[i] > 0;
}

static void centre_rows(void *data, int y0, int y1, int thread)
{
	(void)thread;
	light *l = data;
	shaft s;
	rays from = RAYS(&s);
	for (int y = y0; y < y1; y += SHAFT_SIDE)
		for (int x = 0; x < l->width && !bands_stopped(l->bands); x += SHAFT_SIDE) {
			uint64_t left = square_of(l, x, y, y1, lit_without_shadows);
			while (left) {
				uint64_t group = ISA(shadow_group)(l, x, y, left, 0, &s);
				left &= ~group;
				for (; group; group &= group - 1, s.start++) {
					int k = __builtin_ctzll(group);
					ask_centre(l, x + k % SHAFT_SIDE, y + k / SHAFT_SIDE, &from);
				}
			}
		}
}

/* ---- lamps without a size ---------------------------------------------------------------------------------- */

/* Where on the way from one pixel's centre to its right or lower neighbour's the light goes or comes. */
static float find_edge(const light *l, int x, int y, bool down, rays *from)
{
	ptrdiff_t i = (ptrdiff_t)y * l->width + x, j = down ? i + l->width : i + 1;
	const surface *one = l->surfaces + i, *other = l->surfaces + j;
	float low = 0, high = 1;
	for (int k = 0; k < HALVINGS; k++) {
		float middle = 0.5f * (low + high), all = 0, seen = 0;
		float u = (float)x + 0.5f + (down ? 0 : middle), v = (float)y + 0.5f + (down ? middle : 0);
		bool inside, inside_other;
		surface s = ISA(place_on)(l, &from->facets, one, u, v, &inside);
		if (!inside && (one->instance != other->instance || one->triangle != other->triangle)) {
			surface t = ISA(place_on)(l, &from->facets, other, u, v, &inside_other);
			s = inside_other ? t : s;
		}
		ISA(shadow_ask)(l, &s, &l->points.middle, &all, &seen, from);
		if ((seen > 0) == (core_at(l, i) == LIT))
			low = middle;
		else
			high = middle;
	}
	return 0.5f * (low + high);
}

void ISA(edge_rows)(void *data, int y0, int y1, int thread)
{
	(void)thread;
	light *l = data;
	rays from = RAYS(NULL);
	for (int y = y0; y < y1 && !bands_stopped(l->bands); y++)
		for (int x = 0; x < l->width; x++)
			for (int down = 0; down < 2; down++) {
				ptrdiff_t i = (ptrdiff_t)y * l->width + x, j = down ? i + l->width : i + 1;
				float *cut = l->cut + 2 * i + down;
				*cut = -1;
				if (down ? y + 1 == l->height : x + 1 == l->width)
					continue;
				int one = core_at(l, i), other = core_at(l, j);
				if (one + other == MIXED && one != MIXED && other != MIXED &&
				    one_surface(l->surfaces + i, l->surfaces + j))
					*cut = find_edge(l, x, y, down, &from);
			}
}

/* How far the edge is along the axis, to whichever side it is nearer; `none` where it does not pass. */
static float to_edge(const light *l, int x, int y, bool down, float none)
{
	ptrdiff_t i = (ptrdiff_t)y * l->width + x;
	float ahead = l->cut[2 * i + down], far = none;
	if (ahead >= 0)
		far = ahead;
	if (down ? y : x) {
		float behind = l->cut[2 * (down ? i - l->width : i - 1) + down];
		if (behind >= 0 && 1 - behind < far)
			far = behind - 1;
	}
	return far;
}

bool ISA(edge_at)(const light *l, int x, int y, edge_line *e)
{
	const float none = 9;
	float a = to_edge(l, x, y, false, none), b = to_edge(l, x, y, true, none);
	float length = sqrtf(a * a + b * b + 1e-12f);
	*e = (edge_line){b / length, a / length, a * b / length, a, b};
	return a != none || b != none;
}

static void ramp_rows(void *data, int y0, int y1, int thread)
{
	(void)thread;
	light *l = data;
	edge_line e;
	for (int y = y0; y < y1 && !bands_stopped(l->bands); y++)
		for (int x = 0; x < l->width; x++) {
			ptrdiff_t i = (ptrdiff_t)y * l->width + x;
			if (!ISA(edge_at)(l, x, y, &e))
				continue;
			float away = min(fabsf(e.far), 1);
			l->share[i] = l->state[i] == LIT ? 0.5f + 0.5f * away : 0.5f - 0.5f * away;
		}
}

int32_t ISA(shadow_run)(light *l)
{
	int32_t code = bands_run(l->bands, l->height, 0, centre_rows, l);
	if (code || !l->lamp.shadows)
		return code;
	if (l->soft)
		return ISA(soft_run)(l);
	code = bands_run(l->bands, l->height, 0, ISA(edge_rows), l);
	return code ? code : bands_run(l->bands, l->height, 0, ramp_rows, l);
}
