/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Penumbrae of a few pixels.
 *
 * Half of the light comes where the lamp's middle goes behind what throws the shadow. Where a penumbra is at most a few
 * pixels wide that edge is found as for a lamp without a size, and its ramp is as wide as the penumbra. What has
 * another edge so close to it is left to the points: of a shadow thinner than a pixel the centres see dashes. So is an
 * edge that lies in half a shadow of something else. */
#include "light/light.h"

enum {
	BESIDE = 2, /* pixels: how far an edge reaches */
	THIN = 2,   /* pixels: to the other edge of what is thin */
	SHARP = 2,
	SOFT = 4,    /* pixels: a penumbra of less is an edge with a ramp, one of more is asked for point by point */
	NARROW,      /* in the place of a width: of an edge that has another one close to it */
	BY_THIN = -2 /* in the place of a pixel */
};
_Static_assert(BESIDE + THIN <= NARROW_REACH, "soft.c counts on it");

static const float level = 0.05f; /* of the distance: so far two things lie apart where they make one plane, at most */
static const float sure = 0.1f;   /* of the light: where a line is off by more, so is its place by a fifth of a pixel */
static const float opposite = -0.5f; /* cosine of the ways to the light of two sides of something thin, at most */

/* Whether light comes from the lamp's middle to pixels that are asked at once. */
static void tell_cores(light *l, asking *ask, const ptrdiff_t *pixel)
{
	const int count = ask->count;
	unsigned comes = count ? ISA(ask_all)(l, ask, NULL) : 0;
	for (int k = 0; k < count; k++)
		if (ask->value[k] > 0)
			l->state[pixel[k]] |= (uint8_t)((comes >> k & 1 ? LIT : DARK) << CORE_SHIFT);
}

static void core_rows(void *data, int y0, int y1, int thread)
{
	(void)thread;
	light *l = data;
	asking ask;
	ptrdiff_t pixel[PACK] = {0};
	ask.count = 0;
	for (ptrdiff_t i = (ptrdiff_t)y0 * l->width; i < (ptrdiff_t)y1 * l->width && !bands_stopped(l->bands); i++) {
		if (l->exact[i] < 0 || l->asked[i] == UNASKED)
			continue;
		pixel[ask.count] = i;
		ISA(ask_add)(&ask, l->surfaces + i, &l->points.middle, 0);
		if (ask.count == PACK)
			tell_cores(l, &ask, pixel);
	}
	tell_cores(l, &ask, pixel);
}

/* By how many pixels the shadow of a place moves across an edge when the light comes from a lamp's rim and not from its
 * middle. */
static float moves(const light *l, const surface *s, vec place, const lamp_point *rim, const edge_line *e)
{
	vec way;
	float far;
	lamp_light(&l->lamp, s->at, s->normal, rim, &way, &far);
	vec off = minus(place, s->at), from = far < lamp_far ? minus(way, off) : way;
	float slope = dot(from, s->across);
	vec to = minus(off, times(from, dot(off, s->across) / (fabsf(slope) < 1e-12f ? 1e-12f : slope)));
	double a[2], b[2];
	ISA(place_pixel)(l, s->at, a);
	ISA(place_pixel)(l, plus(s->at, to), b);
	return (float)(b[0] - a[0]) * e->x + (float)(b[1] - a[1]) * e->y;
}

/* Whether light falls from all of the lamp: else half of what falls is not where its middle goes. */
static bool faces(const light *l, const surface *s)
{
	bool all = true;
	for (int k = 0; k < LAMP_RIM; k++) {
		vec way;
		float far;
		all &= lamp_light(&l->lamp, s->at, s->normal, l->points.rim + k, &way, &far) > 0;
	}
	return all;
}

/* How many pixels wide the penumbra is that an edge has, by what throws it; SOFT if more, or if it can't be told. */
static float width_of(const light *l, facets *known, int x, int y, const edge_line *e)
{
	ptrdiff_t i = (ptrdiff_t)y * l->width + x;
	bool across = fabsf(e->a) <= fabsf(e->b), inside;
	/* a little to the dark side: what is in the way there ends here */
	float far = across ? e->a : e->b, more = (core_at(l, i) == LIT) == (far > 0) ? 0.03f : -0.03f;
	float u = (float)x + 0.5f + (across ? far + more : 0), v = (float)y + 0.5f + (across ? 0 : far + more);
	surface s = ISA(place_on)(l, known, l->surfaces + i, u, v, &inside);
	if (!inside) {
		ptrdiff_t side = across ? 1 : l->width;
		s = ISA(place_on)(l, known, l->surfaces + (far > 0 ? i + side : i - side), u, v, &inside);
	}
	vec place;
	if (!inside || !faces(l, &s) || !ISA(ask_thrower)(l, &s, &place))
		return SOFT;
	float a = moves(l, &s, place, l->points.rim, e), b = moves(l, &s, place, l->points.rim + 1, e);
	float half = l->lamp.type == ENCRE_RECTANGLE ? fabsf(a) + fabsf(b) : sqrtf(a * a + b * b);
	return 2 * half < SOFT ? 2 * half : SOFT;
}

/* Which way light lies beyond an edge beside a pixel. */
static void brighter(const light *l, ptrdiff_t i, const edge_line *e, float way[2])
{
	float sign = (core_at(l, i) == LIT) == (e->far < 0) ? 1 : -1;
	way[0] = sign * e->x;
	way[1] = sign * e->y;
}

/* Whether the other edge of something narrow is close to an edge: two ramps don't make a thin shadow. */
static bool thin(const light *l, int x, int y, const edge_line *e)
{
	ptrdiff_t i = (ptrdiff_t)y * l->width + x;
	float way[2], other[2];
	edge_line its;
	brighter(l, i, e, way);
	for (int v = y - THIN > 0 ? y - THIN : 0; v <= y + THIN && v < l->height; v++)
		for (int u = x - THIN > 0 ? x - THIN : 0; u <= x + THIN && u < l->width; u++) {
			ptrdiff_t j = (ptrdiff_t)v * l->width + u;
			int far = (u - x) * (u - x) + (v - y) * (v - y);
			if (far > THIN * THIN || !ISA(edge_at)(l, u, v, &its) ||
			    !one_surface(l->surfaces + i, l->surfaces + j))
				continue;
			brighter(l, j, &its, other);
			if (way[0] * other[0] + way[1] * other[1] < opposite)
				return true;
		}
	return false;
}

/* Into `share`, which is free meanwhile: widths, NARROW of what is thin, negative where no edge passes. */
static void width_rows(void *data, int y0, int y1, int thread)
{
	(void)thread;
	light *l = data;
	edge_line e;
	facets known = FACETS_NONE;
	for (int y = y0; y < y1 && !bands_stopped(l->bands); y++)
		for (int x = 0; x < l->width; x++)
			l->share[(ptrdiff_t)y * l->width + x] = !ISA(edge_at)(l, x, y, &e) ? -1
								: thin(l, x, y, &e) ? NARROW
										    : width_of(l, &known, x, y, &e);
}

/* Whether an edge on what one pixel shows is one on what another does: also of another thing, unless that lies a little
 * deeper, with the shadow of this one on it. */
static bool edge_goes_on(const surface *a, const surface *b)
{
	vec d = minus(b->at, a->at);
	return one_surface(a, b) &&
	       (a->instance == b->instance || fabsf(dot(d, a->across)) <= level * sqrtf(dot(d, d)));
}

/* The pixel nearest to one, on its surface, beside which an edge passes; negative: none, or BY_THIN. */
static ptrdiff_t edge_near(const light *l, int x, int y)
{
	ptrdiff_t i = (ptrdiff_t)y * l->width + x, found = -1;
	int nearest = 2 * BESIDE * BESIDE + 1;
	for (int v = y - BESIDE; v <= y + BESIDE; v++)
		for (int u = x - BESIDE; u <= x + BESIDE; u++) {
			int far = (u - x) * (u - x) + (v - y) * (v - y);
			ptrdiff_t j = (ptrdiff_t)v * l->width + u;
			if (u < 0 || v < 0 || u >= l->width || v >= l->height || l->share[j] < 0 ||
			    (j != i && !edge_goes_on(l->surfaces + i, l->surfaces + j)))
				continue;
			if (l->share[j] == NARROW)
				return BY_THIN;
			if (far >= nearest)
				continue;
			nearest = far;
			found = j;
		}
	return found;
}

/* What an edge, that beside pixel j, leaves of the light of pixel i; *wide: its ramp, in pixels. */
static float ramp_at(const light *l, ptrdiff_t i, ptrdiff_t j, const edge_line *e, float *wide)
{
	const int x = (int)(i % l->width - j % l->width), y = (int)(i / l->width - j / l->width);
	float away = e->x * (float)x + e->y * (float)y - e->far;
	*wide = max(l->share[j], SHARP);
	return clamp01(0.5f + ((core_at(l, j) == LIT) == (e->far < 0) ? away : -away) / *wide);
}

/* Whether the points of a pixel say otherwise than an edge that leaves it all of the light, or none. */
static bool denies(float asked, float ramp)
{
	if (asked == UNASKED || (ramp > 0 && ramp < 1))
		return false;
	float off = fabsf(asked - (float)(2 * asked_kind(asked)) - ramp);
	return asked_kind(asked) == CROOKED || off > sure;
}

/* Whether beside an edge, that of a pixel, more is in the way, and its ramp goes to less than all of the light. */
static bool denied(const light *l, int x, int y, const edge_line *e)
{
	ptrdiff_t j = (ptrdiff_t)y * l->width + x;
	float wide;
	for (int v = y - BESIDE > 0 ? y - BESIDE : 0; v <= y + BESIDE && v < l->height; v++)
		for (int u = x - BESIDE > 0 ? x - BESIDE : 0; u <= x + BESIDE && u < l->width; u++) {
			ptrdiff_t i = (ptrdiff_t)v * l->width + u;
			if (denies(l->asked[i], ramp_at(l, i, j, e, &wide)) && edge_near(l, u, v) == j)
				return true;
		}
	return false;
}

/* Into `spare`, which is free where an edge passes: widths as they are to be, NARROW of an edge that is denied. */
static void deny_rows(void *data, int y0, int y1, int thread)
{
	(void)thread;
	light *l = data;
	edge_line e;
	for (int y = y0; y < y1 && !bands_stopped(l->bands); y++)
		for (int x = 0; x < l->width; x++) {
			ptrdiff_t i = (ptrdiff_t)y * l->width + x;
			if (ISA(edge_at)(l, x, y, &e))
				l->spare[i] = l->share[i] < SOFT && denied(l, x, y, &e) ? NARROW : l->share[i];
		}
}

/* Apart from what reads the widths of neighbours, so that it is the same whichever thread comes first. */
static void denied_rows(void *data, int y0, int y1, int thread)
{
	(void)thread;
	light *l = data;
	for (ptrdiff_t i = (ptrdiff_t)y0 * l->width; i < (ptrdiff_t)y1 * l->width && !bands_stopped(l->bands); i++)
		if (l->share[i] >= 0)
			l->share[i] = l->spare[i];
}

static void narrow_rows(void *data, int y0, int y1, int thread)
{
	(void)thread;
	light *l = data;
	for (ptrdiff_t i = (ptrdiff_t)y0 * l->width; i < (ptrdiff_t)y1 * l->width && !bands_stopped(l->bands); i++) {
		int own = core_at(l, i);
		edge_line e;
		float wide;
		if (l->exact[i] < 0 || l->asked[i] == UNASKED)
			continue;
		l->spare[i] = 0;
		if (!own)
			continue;
		ptrdiff_t j = edge_near(l, (int)(i % l->width), (int)(i / l->width));
		if (j < 0) {
			l->spare[i] = j == BY_THIN ? narrow_thin : 0;
			continue;
		}
		ISA(edge_at)(l, (int)(j % l->width), (int)(j / l->width), &e);
		float ramp = ramp_at(l, i, j, &e, &wide);
		if (own == LIT ? ramp < 0.5f : ramp > 0.5f) /* another edge lies between the two */
			continue;
		l->exact[i] = clamp01((SOFT - wide) / (SOFT - SHARP));
		l->spare[i] = ramp;
	}
}

int32_t ISA(narrow_run)(light *l)
{
	const bands_kernel pass[] = {core_rows, ISA(edge_rows), width_rows, deny_rows, denied_rows, narrow_rows};
	int32_t code = ENCRE_OK;
	for (int k = 0; !code && k < 6; k++)
		code = bands_run(l->bands, l->height, 0, pass[k], l);
	return code;
}
