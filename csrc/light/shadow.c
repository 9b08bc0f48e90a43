/* SPDX-License-Identifier: GPL-3.0-or-later */
/* How much of a lamp's light comes to what each pixel shows, and where the light of a lamp without a size ends: one ray
 * a pixel. Where two neighbours on one surface disagree, halving the way between them finds where the edge passes; the
 * share is linear in the distance to the line through the places so found, over 2 pixels, so that half of the light is
 * where the edge is. */
#include "light/light.h"

enum { HALVINGS = 7 };

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

float ISA(shadow_plain)(const light *l, const surface *s)
{
	return lights(l, s) ? plain_light(l, s) : 0;
}

/* What the few points of a pixel say: how much their light is, and how much of it comes. */
static void tell_centre(light *l, ptrdiff_t i, float all, float seen)
{
	l->state[i] = !(all > 0) ? MIXED : (uint8_t)((seen > 0 ? LIT : 0) | (seen < all ? DARK : 0));
	l->share[i] = all > 0 ? seen / all : !l->soft; /* sharp, of a lamp whose middle is below the horizon */
}

/* The points that a pixel is dealt. */
static const lamp_point *dealt_to(const light *l, int x, int y)
{
	const encre_frame *f = &l->job->frame;
	return l->soft ? l->points.first[(f->y + y - DEALT_FROM) & (LAMP_WIDE - 1)]
					[(f->x + x - DEALT_FROM) & (LAMP_WIDE - 1)]
		       : &l->points.middle;
}

/* Where all of the light comes that there is, or none. */
static void centre_whole(light *l, int x, int y, bool comes)
{
	const ptrdiff_t i = (ptrdiff_t)y * l->width + x;
	const surface *s = l->surfaces + i;
	const lamp_point *q = dealt_to(l, x, y);
	float all = 0;
	for (int k = 0; k < (l->soft ? LAMP_DEALT : 1) && !(all > 0); k++) {
		vec way;
		float far, value = lamp_light(&l->lamp, s->at, s->normal, q + k, &way, &far);
		all = value > 0 && value <= FLT_MAX ? value : 0;
	}
	tell_centre(l, i, all, comes ? all : 0);
}

/* Pixels whose points are asked at once. */
typedef struct centres {
	asking ask;
	ptrdiff_t pixel[PACK];
	int count;
} centres;

static void centres_end(light *l, centres *c, shaft *through)
{
	const int dealt = l->soft ? LAMP_DEALT : 1;
	unsigned comes = c->count ? ISA(ask_all)(l, &c->ask, through) : 0;
	for (int k = 0; k < c->count; k++) {
		float all = 0, seen = 0;
		ask_sum(&c->ask, comes, k * dealt, dealt, &all, &seen);
		tell_centre(l, c->pixel[k], all, seen);
	}
	c->count = 0;
}

static void centres_add(light *l, centres *c, int x, int y, int start, shaft *through)
{
	const lamp_point *q = dealt_to(l, x, y);
	c->pixel[c->count] = (ptrdiff_t)y * l->width + x;
	for (int k = 0; k < (l->soft ? LAMP_DEALT : 1); k++)
		ISA(ask_add)(&c->ask, l->surfaces + c->pixel[c->count], q + k, start);
	c->count++;
	if (c->ask.count == PACK)
		centres_end(l, c, through);
}

static bool lit_without_shadows(light *l, int x, int y)
{
	ptrdiff_t i = (ptrdiff_t)y * l->width + x;
	const surface *at = l->surfaces + i;
	l->state[i] = 0;
	l->plain[i] = ISA(shadow_plain)(l, at);
	l->share[i] = l->plain[i] > 0;
	return l->plain[i] > 0;
}

static void centre_rows(void *data, int y0, int y1, int thread)
{
	(void)thread;
	light *l = data;
	shaft s;
	centres c;
	c.count = c.ask.count = 0;
	for (int y = y0; y < y1; y += SHAFT_SIDE)
		for (int x = 0; x < l->width && !bands_stopped(l->bands); x += SHAFT_SIDE) {
			uint64_t left = square_of(l, x, y, y1, lit_without_shadows);
			while (left) {
				uint64_t group = ISA(ask_group)(l, x, y, left, 0, &s);
				left &= ~group;
				for (int start = 0; group; group &= group - 1, start++) {
					int k = __builtin_ctzll(group), u = x + k % SHAFT_SIDE, v = y + k / SHAFT_SIDE;
					const surface *at = l->surfaces + (ptrdiff_t)v * l->width + u;
					/* where a way is bent it may begin behind the wall */
					bool dark = !l->n_bends && shaft_walled(&s, at->instance, at->triangle);
					if (dark || shaft_free(&s, start))
						centre_whole(l, u, v, !dark);
					else
						centres_add(l, &c, u, v, start, &s);
				}
				centres_end(l, &c, &s);
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
		ISA(ask_point)(l, &s, &l->points.middle, &all, &seen, from);
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
