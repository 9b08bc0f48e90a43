/* SPDX-License-Identifier: GPL-3.0-or-later */
/* How much of a lamp's light comes to what each pixel shows.
 *
 * A lamp without a size: one ray a pixel. Where two neighbours on one surface disagree, halving the way between them
 * finds where the edge passes; the share is linear in the distance to the line through the places so found, over 2
 * pixels, so that half of the light is where the edge is.
 *
 * A lamp with a size: each pixel asks the few points that its place in a tile of the full frame deals to it. Where
 * these disagree, there or nearby, it asks many, each from another place in the 2 x 2 pixels about it. No two pixels of
 * a tile ask the same points: what would be bands is grain, which means of such neighbours on the same surface as have
 * much the same share take away. In the first the places of a tile weigh the same; the others reach far where a
 * penumbra is wide. */
#include "light/light.h"

#include <stdlib.h>

enum {
	HALVINGS = 7,
	NEAR = 4, /* pixels: how far disagreement reaches */
	TAPS = LAMP_TILE - 1,
	FAR_TAPS = 2,
	WINDOW = 2 * TAPS + 1,
	REACH = 2 * TAPS + FAR_TAPS * LAMP_TILE /* pixels: of the means together */
};
_Static_assert(NEAR + REACH + 1 <= LIGHT_MARGIN - 2, "beyond the images surfaces are known in the margin only");

static const float gentle_slope = 0.08f; /* from one place that takes part to the next: no edge */

static bool comes(const light *l, const surface *s, vec way, float far, hint *h)
{
	float size = max3(fabsf(s->at.x), fabsf(s->at.y), fabsf(s->at.z)), side = dot(s->across, way) < 0 ? -1 : 1;
	float off = (size + 1) * (s->instance >= 0 ? 1e-6f : 1e-3f);
	ray r = {.from = plus(s->from, times(s->across, side * off)),
		 .way = way,
		 .far = far,
		 .instance = s->instance,
		 .triangle = s->triangle,
		 .set = l->lamp.shadow_set};
	if (far < lamp_far)
		r.way = plus(way, minus(s->at, r.from));
	return !ISA(ray_blocked)(&l->world, &r, h);
}

/* Adds a point's light to *all, and to *seen if nothing is in its way. */
static void ask(const light *l, const surface *s, const lamp_point *q, float *all, float *seen, hint *h)
{
	vec way;
	float far, value = lamp_light(&l->lamp, s->at, s->normal, q, &way, &far);
	if (!(value > 0 && value <= FLT_MAX))
		return;
	*all += value;
	if (!l->lamp.shadows || comes(l, s, way, far, h))
		*seen += value;
}

static bool lights(const light *l, const surface *s)
{
	if (s->instance == SURFACE_NOTHING)
		return false;
	return s->instance == SURFACE_STRAY || l->world.instances[s->instance]->light_sets >> l->lamp.light_set & 1;
}

/* Light without shadows. */
static float plain_light(const light *l, const surface *s)
{
	int n = l->lamp.soft ? LAMP_PLAIN : 1;
	const lamp_point *points = l->points.plain;
	float sum = 0, far;
	vec way;
	for (int k = 0; k < n; k++)
		sum += lamp_light(&l->lamp, s->at, s->normal, points + k, &way, &far);
	sum /= (float)n;
	return sum > 0 && sum <= FLT_MAX ? sum : 0;
}

static void centre_rows(void *data, int y0, int y1, int thread)
{
	(void)thread;
	light *l = data;
	const encre_frame *f = &l->job->frame;
	hint h = HINT_NONE;
	for (int y = y0; y < y1; y++)
		for (int x = 0; x < l->width; x++) {
			ptrdiff_t i = (ptrdiff_t)y * l->width + x;
			const surface *s = l->surfaces + i;
			const lamp_point *first =
				l->points.first[(f->y + y) & (LAMP_WIDE - 1)][(f->x + x) & (LAMP_WIDE - 1)];
			int dealt = l->lamp.soft ? LAMP_DEALT : 1;
			l->state[i] = 0;
			l->plain[i] = lights(l, s) ? plain_light(l, s) : 0;
			l->share[i] = l->plain[i] > 0;
			if (!(l->plain[i] > 0))
				continue;
			float all = 0, seen = 0;
			for (int k = 0; k < dealt; k++)
				ask(l, s, first + k, &all, &seen, &h);
			l->state[i] = !(all > 0) ? MIXED : (uint8_t)((seen > 0 ? LIT : 0) | (seen < all ? DARK : 0));
			l->share[i] = all > 0 ? seen / all : 0;
		}
}

/* ---- lamps without a size ---------------------------------------------------------------------------------- */

/* Where on the way from one pixel's centre to its right or lower neighbour's the light goes or comes. */
static float find_edge(const light *l, int x, int y, bool down, hint *h)
{
	ptrdiff_t i = (ptrdiff_t)y * l->width + x, j = down ? i + l->width : i + 1;
	const surface *one = l->surfaces + i, *other = l->surfaces + j;
	float low = 0, high = 1;
	for (int k = 0; k < HALVINGS; k++) {
		float middle = 0.5f * (low + high), all = 0, seen = 0;
		float u = (float)x + 0.5f + (down ? 0 : middle), v = (float)y + 0.5f + (down ? middle : 0);
		bool inside, inside_other;
		surface s = ISA(place_on)(l, one, u, v, &inside);
		if (!inside && (one->instance != other->instance || one->triangle != other->triangle)) {
			surface t = ISA(place_on)(l, other, u, v, &inside_other);
			s = inside_other ? t : s;
		}
		ask(l, &s, l->points.plain, &all, &seen, h);
		if ((seen > 0) == (l->state[i] == LIT))
			low = middle;
		else
			high = middle;
	}
	return 0.5f * (low + high);
}

static void edge_rows(void *data, int y0, int y1, int thread)
{
	(void)thread;
	light *l = data;
	hint h = HINT_NONE;
	for (int y = y0; y < y1; y++)
		for (int x = 0; x < l->width; x++)
			for (int down = 0; down < 2; down++) {
				ptrdiff_t i = (ptrdiff_t)y * l->width + x, j = down ? i + l->width : i + 1;
				float *edge = l->more + 2 * i + down;
				*edge = -1;
				if ((down ? y + 1 == l->height : x + 1 == l->width) || !l->state[i] ||
				    (l->state[i] ^ l->state[j]) != MIXED)
					continue;
				if (one_surface(l->surfaces + i, l->surfaces + j))
					*edge = find_edge(l, x, y, down, &h);
			}
}

/* How far the edge is along the axis, to whichever side it is nearer; `none` where it does not pass. */
static float to_edge(const light *l, int x, int y, bool down, float none)
{
	ptrdiff_t i = (ptrdiff_t)y * l->width + x;
	float ahead = l->more[2 * i + down], far = none;
	if (ahead >= 0)
		far = ahead;
	if (down ? y : x) {
		float behind = l->more[2 * (down ? i - l->width : i - 1) + down];
		if (behind >= 0)
			far = min(far, 1 - behind);
	}
	return far;
}

static void ramp_rows(void *data, int y0, int y1, int thread)
{
	(void)thread;
	light *l = data;
	const float none = 9;
	for (int y = y0; y < y1; y++)
		for (int x = 0; x < l->width; x++) {
			ptrdiff_t i = (ptrdiff_t)y * l->width + x;
			float a = to_edge(l, x, y, false, none), b = to_edge(l, x, y, true, none);
			if (a == none && b == none)
				continue;
			float away = min(a * b / sqrtf(a * a + b * b + 1e-12f), 1); /* from the line through both */
			l->share[i] = l->state[i] == LIT ? 0.5f + 0.5f * away : 0.5f - 0.5f * away;
		}
}

/* ---- lamps with a size ------------------------------------------------------------------------------------- */

/* Whether some of the light, but not all, comes to one surface near a pixel. */
static bool mixed_near(const light *l, int x, int y)
{
	ptrdiff_t i = (ptrdiff_t)y * l->width + x;
	int y0 = y < NEAR ? 0 : y - NEAR, y1 = y + NEAR < l->height ? y + NEAR : l->height - 1;
	int x0 = x < NEAR ? 0 : x - NEAR, x1 = x + NEAR < l->width ? x + NEAR : l->width - 1;
	int any = 0, own = l->state[i] & MIXED;
	for (int v = y0; v <= y1; v++)
		for (int u = x0; u <= x1; u++)
			any |= l->state[(ptrdiff_t)v * l->width + u];
	if ((any & MIXED) != MIXED || own == MIXED)
		return own == MIXED;
	for (int v = y0; v <= y1; v++)
		for (int u = x0; u <= x1; u++) {
			ptrdiff_t j = (ptrdiff_t)v * l->width + u;
			if ((l->state[j] & ~own & MIXED) && one_surface(l->surfaces + i, l->surfaces + j))
				return true;
		}
	return false;
}

static float full_share(const light *l, int x, int y, hint *h)
{
	ptrdiff_t i = (ptrdiff_t)y * l->width + x;
	const encre_frame *f = &l->job->frame;
	const lamp_point *points = l->points.of[(f->y + y) & (LAMP_TILE - 1)][(f->x + x) & (LAMP_TILE - 1)];
	float all = 0, seen = 0;
	for (int k = 0; k < LAMP_POINTS; k++) {
		const lamp_point *q = points + k;
		int u = x + (int)floorf(0.5f + q->place[0]), v = y + (int)floorf(0.5f + q->place[1]);
		surface s = l->surfaces[i];
		if (u >= 0 && v >= 0 && u < l->width && v < l->height) {
			ptrdiff_t j = (ptrdiff_t)v * l->width + u;
			bool inside;
			if (l->state[j] && one_surface(&s, l->surfaces + j))
				s = ISA(place_on)(l, l->surfaces + j, (float)x + 0.5f + q->place[0],
						  (float)y + 0.5f + q->place[1], &inside);
		}
		ask(l, &s, q, &all, &seen, h);
	}
	return all > 0 ? seen / all : 0;
}

/* Into `more`: others read what the centres found. */
static void full_rows(void *data, int y0, int y1, int thread)
{
	(void)thread;
	light *l = data;
	hint h = HINT_NONE;
	for (int y = y0; y < y1; y++)
		for (int x = 0; x < l->width; x++) {
			ptrdiff_t i = (ptrdiff_t)y * l->width + x;
			bool full = l->state[i] && mixed_near(l, x, y);
			l->more[2 * i] = full ? full_share(l, x, y, &h) : l->share[i];
			l->more[2 * i + 1] = full;
		}
}

typedef struct smoothing {
	light *light;
	const float *from;
	float *to;
	int apart, next; /* one pixel's share from the next's: in `from` and in `to` */
	int step, taps;  /* pixels from one that takes part to the next; so many to each side */
	float alike;     /* shares that differ by more are on two sides of an edge */
} smoothing;

/* What takes part in a mean: by how much it differs, NAN if it lies on another surface. */
static void differences(const smoothing *m, int x, int y, float from[WINDOW][WINDOW])
{
	const light *l = m->light;
	ptrdiff_t i = (ptrdiff_t)y * l->width + x;
	for (int b = -m->taps; b <= m->taps; b++)
		for (int a = -m->taps; a <= m->taps; a++) {
			int u = x + a * m->step, v = y + b * m->step;
			ptrdiff_t j = (ptrdiff_t)v * l->width + u;
			bool takes_part = u >= 0 && v >= 0 && u < l->width && v < l->height && l->state[j] &&
					  (j == i || one_surface(l->surfaces + i, l->surfaces + j));
			from[b + m->taps][a + m->taps] =
				takes_part ? m->from[j * m->apart] - m->from[i * m->apart] : NAN;
		}
}

static float tent(const smoothing *m, int a, int b)
{
	return (float)((m->taps + 1 - abs(a)) * (m->taps + 1 - abs(b)));
}

static float smooth_share(const smoothing *m, int x, int y)
{
	float from[WINDOW][WINDOW], slope[2] = {0, 0}, squares[2] = {0, 0}, sum = 0, weights = 0;
	differences(m, x, y, from);
	for (int b = -m->taps; b <= m->taps; b++)
		for (int a = -m->taps; a <= m->taps; a++) {
			float difference = from[b + m->taps][a + m->taps], weight = tent(m, a, b);
			if (!(difference == difference))
				continue;
			slope[0] += weight * (float)a * difference;
			slope[1] += weight * (float)b * difference;
			squares[0] += weight * (float)(a * a);
			squares[1] += weight * (float)(b * b);
		}
	slope[0] /= squares[0] + 1e-6f;
	slope[1] /= squares[1] + 1e-6f;
	float gentle = clamp01(2 - (fabsf(slope[0]) + fabsf(slope[1])) / gentle_slope);
	for (int b = -m->taps; b <= m->taps; b++)
		for (int a = -m->taps; a <= m->taps; a++) {
			float difference = from[b + m->taps][a + m->taps];
			if (!(difference == difference))
				continue;
			float beside = difference - slope[0] * (float)a - slope[1] * (float)b;
			float even = clamp01(2 - 2 * fabsf(difference) / m->alike);
			float steep = gentle * clamp01(2 - 2 * fabsf(beside) / m->alike);
			float weight = tent(m, a, b) * max(even, steep);
			sum += weight * difference;
			weights += weight;
		}
	return clamp01(m->from[((ptrdiff_t)y * m->light->width + x) * m->apart] + sum / weights);
}

static void smooth_rows(void *data, int y0, int y1, int thread)
{
	(void)thread;
	const smoothing *m = data;
	for (int y = y0; y < y1; y++)
		for (int x = 0; x < m->light->width; x++) {
			ptrdiff_t i = (ptrdiff_t)y * m->light->width + x;
			bool full = m->light->more[2 * i + 1] > 0;
			m->to[i * m->next] = full ? smooth_share(m, x, y) : m->from[i * m->apart];
		}
}

static int32_t soft_run(light *l)
{
	const smoothing passes[] = {
		{l, l->more, l->share, 2, 1, 1, TAPS, 0.25f},
		{l, l->share, l->more, 1, 2, LAMP_TILE, FAR_TAPS, 0.04f},
		{l, l->more, l->share, 2, 1, 1, TAPS, 0.03f},
	};
	int32_t code = bands_run(l->bands, l->height, 0, full_rows, l);
	for (int k = 0; !code && k < 3; k++) {
		smoothing m = passes[k];
		code = bands_run(l->bands, l->height, 0, smooth_rows, &m);
	}
	return code;
}

int32_t ISA(shadow_run)(light *l)
{
	int32_t code = bands_run(l->bands, l->height, 0, centre_rows, l);
	if (code || !l->lamp.shadows)
		return code;
	if (l->lamp.soft)
		return soft_run(l);
	code = bands_run(l->bands, l->height, 0, edge_rows, l);
	return code ? code : bands_run(l->bands, l->height, 0, ramp_rows, l);
}
