/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Highlights of a lamp: microfacets by GGX (Walter 2007), of which those shine whose half vector is turned to the lamp.
 * In slopes about the normal their share is alpha^2 / (pi (alpha^2 + x^2)^2), and what a lamp takes of that has a
 * closed form: for a lamp with corners, Lambert's for a polygon at the height alpha, as these shares are its cosines
 * (Heitz 2016); for a round one, the part of a sphere that a disc is on Riemann's. */
#include "light/light.h"

enum { MOST_CORNERS = 8 };
static const float alpha_least = 1e-3f, /* of a mirror */
	small = 0.02f;                  /* square of a lamp's extent by that of the lobe, below which it is a disc */

/* A place that is looked at, its axes, and cosines of the way to the eye. */
typedef struct mirror {
	vec at, normal, x, y, eye;
	float front;
} mirror;

typedef struct slope {
	float x, y;
} slope;

/* What a lamp looks like from a place: how much light comes where it is faced, and its extent in slopes. */
typedef struct gleam {
	float light, radiance, area; /* area 0: a point */
	slope middle, corner[MOST_CORNERS];
	int corners; /* 0: it is round */
} gleam;

/* Half between the way to the eye and that to a lamp, which is taken to be above the horizon. */
static slope slope_of(const mirror *m, vec way)
{
	vec w = unit(way);
	float under = dot(w, m->normal) - 1e-3f;
	vec half = plus(m->eye, under < 0 ? unit(minus(w, times(m->normal, under))) : w);
	float high = max(dot(half, m->normal), 1e-3f);
	return (slope){dot(half, m->x) / high, dot(half, m->y) / high};
}

static vec half_of(const mirror *m, slope s)
{
	return unit(plus(m->normal, plus(times(m->x, s.x), times(m->y, s.y))));
}

static float area_of(const gleam *g)
{
	float twice = 0;
	for (int i = 0; i < g->corners; i++) {
		slope a = g->corner[i], b = g->corner[(i + 1) % g->corners];
		twice += (a.x - g->middle.x) * (b.y - g->middle.y) - (a.y - g->middle.y) * (b.x - g->middle.x);
	}
	return 0.5f * fabsf(twice);
}

/* Of a lamp that has sides. */
static bool flat_gleam(const lamp *l, const mirror *m, vec to, gleam *g)
{
	static const float square[4][2] = {{-0.5f, -0.5f}, {0.5f, -0.5f}, {0.5f, 0.5f}, {-0.5f, 0.5f}};
	/* of an octagon as large as the disc of diameter 1 */
	static const float a = 0.52693f, b = 0.37260f;
	static const float round[8][2] = {{a, 0}, {b, b}, {0, a}, {-b, b}, {-a, 0}, {-b, -b}, {0, -a}, {b, -b}};
	vec across = cross(l->u, l->v);
	float size = sqrtf(dot(across, across)) * (l->type == ENCRE_ELLIPSE ? 0.25f * pi : 1);
	if (!(-dot(to, l->way) > 0))
		return false;
	if (size > 0) {
		g->radiance = 1 / (pi * size);
		g->corners = l->type == ENCRE_ELLIPSE ? 8 : 4;
		for (int i = 0; i < g->corners; i++) {
			const float *p = l->type == ENCRE_ELLIPSE ? round[i] : square[i];
			g->corner[i] = slope_of(m, plus(to, plus(times(l->u, p[0]), times(l->v, p[1]))));
		}
	}
	float far = sqrtf(dot(to, to));
	g->light = -dot(to, l->way) / (far * far * far * pi);
	g->area = area_of(g);
	return true;
}

static bool gleam_of(const lamp *l, const mirror *m, gleam *g)
{
	*g = (gleam){0};
	vec to = l->type == ENCRE_SUN ? times(l->way, -1) : minus(l->at, m->at);
	float far = sqrtf(dot(to, to)), angle = 2 * pi * l->open; /* solid */
	if (!(far > 0))
		return false;
	g->middle = slope_of(m, to);
	if (l->type == ENCRE_RECTANGLE || l->type == ENCRE_ELLIPSE)
		return flat_gleam(l, m, to, g);
	g->light = 1;
	if (l->type != ENCRE_SUN) {
		float sine = min(l->radius * l->radius / (far * far), 0.99f);
		angle = 2 * pi * sine / (1 + sqrtf(1 - sine));
		g->light = 1 / (4 * pi * far * far) * (l->type == ENCRE_SPOT ? spot_share(l, to) : 1);
	}
	vec half = half_of(m, g->middle);
	float high = dot(half, m->normal);
	g->area = angle / (4 * max(dot(half, m->eye), 1e-3f) * high * high * high);
	g->radiance = angle > 0 ? g->light / angle : 0;
	return true;
}

/* The mean share over a disc: a part of the sphere on which the plane is projected, by the plane's area. */
static float disc_share(const gleam *g, float alpha)
{
	float part = g->area / pi, far = g->middle.x * g->middle.x + g->middle.y * g->middle.y, square = alpha * alpha;
	float sum = square + far + part, b = square + far - part;
	float a = sqrtf(max(sum * sum - 4 * far * part, 0)); /* a^2 - b^2 = 4 alpha^2 part */
	return b > 0 ? 2 * square / (pi * a * (a + b)) : (a - b) / (2 * pi * a * part);
}

/* The share over a polygon. */
static float polygon_share(const gleam *g, float alpha)
{
	float sum = 0;
	for (int i = 0; i < g->corners; i++) {
		slope p = g->corner[i], q = g->corner[(i + 1) % g->corners];
		vec a = unit((vec){p.x, p.y, alpha}), b = unit((vec){q.x, q.y, alpha}), c = cross(a, b);
		float sine = sqrtf(dot(c, c));
		if (sine > 1e-9f)
			sum += pixel_atan2(sine, dot(a, b)) * c.z / sine;
	}
	return min(fabsf(sum) / (2 * pi), 1);
}

/* Lambda of Smith's shadowing, of a way by the cosine of its angle. */
static float hidden(float cosine, float alpha)
{
	float tangent = (1 - cosine * cosine) / max(cosine * cosine, 1e-8f);
	return 0.5f * (sqrtf(1 + alpha * alpha * tangent) - 1);
}

/* What a lamp of colour 1 gives by facets of colour 1; *edge: how far these are on the way to the white of grazing
 * light. */
static float lobe(const lamp *l, const mirror *m, const gleam *g, float roughness, float *edge)
{
	float alpha = max(roughness * roughness, alpha_least);
	float far = g->middle.x * g->middle.x + g->middle.y * g->middle.y, extent = 0;
	for (int i = 0; i < g->corners; i++) {
		float x = g->corner[i].x - g->middle.x, y = g->corner[i].y - g->middle.y;
		extent = max(extent, x * x + y * y);
	}
	bool wide = g->corners && extent > small * (alpha * alpha + far);
	/* Where in the lamp the middle of the light comes from. */
	float in = clamp01(1 - sqrtf(g->area / (pi * max(far, 1e-12f))));
	vec half = half_of(m, (slope){g->middle.x * in, g->middle.y * in});
	float high = dot(half, m->normal), open = max(dot(half, m->eye), 1e-3f);
	vec way = minus(times(half, 2 * open), m->eye);
	float falls = max(dot(way, m->normal), 1e-3f), value;
	if (g->radiance > 0)
		value = g->radiance * (wide ? polygon_share(g, alpha) : disc_share(g, alpha) * g->area) * open /
			(m->front * high);
	else
		value = g->light * disc_share(g, alpha) / (4 * m->front * high * high * high * high);
	if (l->spread > 0) {
		float front = max(-dot(way, l->way), 1e-6f);
		value *= l->gain * max(l->spread - sqrtf(max(1 - front * front, 0)) / front, 0);
	}
	float less = 1 - min(open, 1), square = less * less;
	*edge = square * square * less;
	return value / (1 + hidden(m->front, alpha) + hidden(falls, alpha));
}

static void shine(const light *l, const surface *s, float share, const float *look, float *out)
{
	mirror m = {.at = s->at, .normal = s->normal};
	m.eye = l->eye_far ? l->eye : unit(minus(l->eye, s->at));
	vec side = minus(m.eye, times(s->normal, dot(m.eye, s->normal)));
	vec other = fabsf(s->normal.x) < 0.6f ? (vec){1, 0, 0} : (vec){0, 1, 0};
	side = dot(side, side) > 1e-6f ? side : minus(other, times(s->normal, dot(other, s->normal)));
	m.x = unit(side);
	m.y = cross(s->normal, m.x);
	m.front = max(dot(m.eye, s->normal), 0.02f);
	gleam g;
	if (!gleam_of(&l->lamp, &m, &g))
		return;
	float edge, body = lobe(&l->lamp, &m, &g, look[3], &edge), sum[3];
	float white = edge * min(1, 25 * max3(look[0], look[1], look[2])); /* black ones stay black */
	for (int c = 0; c < 3; c++)
		sum[c] = body * (look[c] + white * (1 - min(look[c], 1)));
	if (look[4] > 0) {
		float coat = lobe(&l->lamp, &m, &g, look[5], &edge);
		for (int c = 0; c < 3; c++)
			sum[c] += coat * (look[4] + edge * min(1, 25 * look[4]) * (1 - min(look[4], 1)));
	}
	for (int c = 0; c < 3; c++) {
		float more = out[c] + share * l->lamp.color[c] * sum[c];
		out[c] = more > 0 ? min(more, FLT_MAX) : out[c];
	}
}

void ISA(shine_row)(const light *l, int y)
{
	const encre_light_job *job = l->job;
	for (int x = 0; x < job->specular.width; x++) {
		ptrdiff_t i = (ptrdiff_t)(y + l->margin) * l->width + x + l->margin;
		const float *look = pixel_at(&job->shine, x, y);
		if (l->plain[i] * l->share[i] > 0 && max3(look[0], look[1], look[2]) + look[4] > 0)
			shine(l, l->surfaces + i, l->share[i], look, pixel_at(&job->specular, x, y));
	}
}
