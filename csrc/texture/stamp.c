/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Lines of a baked texture. Without a form each texel is the centre of a disc, as in Herring's program; the line is
 * their union. With one, lines have the same width everywhere on the surface: circles there are ellipses here, their
 * centres are moved from the texel onto the boundary of the colours, and a rim is one texel wide, however large that
 * is. */
#include "texture/bake.h"
#include "base/pixel.h"

/* ---- discs ----------------------------------------------------------------------------------------------- */

/* A texel at distance d <= r of the centre, dx towards a neighbour, is nearer to that by at least (dx - 1/2) / r. Where
 * this makes up for the neighbour's smaller radius, the neighbour covers it at least as well. Returns the last dx
 * before. */
static int bound(float radius, float neighbour)
{
	float lead = radius > neighbour ? 0.5f + (radius - neighbour) * radius : 0.5f;
	int k = (int)lead;
	return k - ((float)k == lead);
}

static void disc_span(float radius, float dy, float centre, int x, int end, float *restrict dark)
{
	for (; x < end; x += LANES)
		for (int k = 0; k < LANES; k++) {
			float dx = (float)(x + k) - centre, t = radius - sqrtf(dx * dx + dy * dy);
			dark[x + k] = t > dark[x + k] ? t : dark[x + k];
		}
}

/* Radius of the neighbour of (x, y), -1 where there is none. */
static float radius_at(const bake *b, int x, int y)
{
	if ((!b->wrap_x && (x < 0 || x >= b->width)) || (!b->wrap_y && (y < 0 || y >= b->height)))
		return -1;
	x = texel_index(x, b->width, true);
	return b->radius[(ptrdiff_t)texel_index(y, b->height, true) * b->width + x];
}

static void stamp_disc(const bake *b, const sheet *s, int x, int y, float radius)
{
	int reach = (int)radius;
	int up = bound(radius, radius_at(b, x, y - 1)), down = bound(radius, radius_at(b, x, y + 1));
	int to_left = bound(radius, radius_at(b, x - 1, y)), to_right = bound(radius, radius_at(b, x + 1, y));
	int from = y - (up < reach ? up : reach), to = y + (down < reach ? down : reach);
	from = from < s->y0 ? s->y0 : from;
	to = to < s->y1 ? to : s->y1 - 1;
	for (int row = from; row <= to; row++) {
		float dy = (float)(row - y), *dark = s->dark + (size_t)(row - s->y0) * b->padded;
		float square = radius * radius - dy * dy;
		int half = square > 0 ? (int)sqrtf(square) : 0;
		int first = x - (to_left < half ? to_left : half), end = x + (to_right < half ? to_right : half) + 1;
		if (!b->wrap_x) {
			first = first < 0 ? 0 : first;
			end = end < b->width ? end : b->width;
			disc_span(radius, dy, (float)x, first, end, dark);
			continue;
		}
		for (int n; first < end; first += n) { /* one piece per repetition of the texture */
			int at = texel_index(first, b->width, true);
			n = end - first < b->width - at ? end - first : b->width - at;
			disc_span(radius, dy, (float)(x - first + at), at, at + n, dark);
		}
	}
}

/* ---- ellipses -------------------------------------------------------------------------------------------- */

/* Squared length of a step (x, y) on the surface: e x^2 + 2 f x y + g y^2, in mean texels. */
typedef struct form {
	float e, f, g, det;
} form;

/* Neutral where the map is none. Where it collapses (a pole, a sliver), one axis is kept at a length that can be drawn.
 */
static form form_at(const bake *b, int x, int y)
{
	const float *v = pixel_at(&b->job->form, x, y);
	float e = v[0], f = v[1], g = v[2];
	if (!(fabsf(e) <= 1e12f && fabsf(f) <= 1e12f && fabsf(g) <= 1e12f) || (e <= 0 && g <= 0))
		return (form){1, 0, 1, 1};
	float least = 1e-6f * (e > g ? e : g);
	least = least > 1e-8f ? least : 1e-8f;
	e = e > least ? e : least;
	g = g > least ? g : least;
	float most = 0.9999f * sqrtf(e) * sqrtf(g);
	f = f > most ? most : f < -most ? -most : f;
	return (form){e, f, g, e * g - f * f};
}

/* Nothing is darkened at this distance: the radius and half a texel, which is never larger than sqrt(e + g). */
static float limit_of(const form *m, float radius)
{
	return radius + 0.5f * sqrtf(m->e + m->g);
}

/* Stored color of a texel, as it is compared. */
static void color_at(const bake *b, int x, int y, float color[3])
{
	x = texel_index(x, b->width, b->wrap_x);
	y = texel_index(y, b->height, b->wrap_y);
	const float *v = pixel_at(&b->job->texture, x, y);
	for (int c = 0; c < 3; c++)
		color[c] = fabsf(v[c]) <= FLT_MAX ? clamp01(v[c]) : 0;
}

/* Where the boundary between the colors of two opposite neighbours of (x, y) lies, from the texel towards the second;
 * *square: how much they differ. In each of three lines the texels that are the first's count, mixed ones by their
 * share; the lines are averaged, so that the steps of a slanted boundary do not show. */
static float boundary(const bake *b, int x, int y, int axis, float *square)
{
	float from[3], to[3], sum = 0;
	color_at(b, x - !axis, y - axis, from);
	color_at(b, x + !axis, y + axis, to);
	*square = 0;
	for (int c = 0; c < 3; c++)
		*square += (to[c] - from[c]) * (to[c] - from[c]);
	for (int line = -1; *square > 0 && line <= 1; line++)
		for (int at = -1; at <= 1; at++) {
			float color[3], along = 0;
			color_at(b, x + (axis ? line : at), y + (axis ? at : line), color);
			for (int c = 0; c < 3; c++)
				along += (color[c] - from[c]) * (to[c] - from[c]);
			sum += (line ? 0.25f : 0.5f) * (0.5f - clamp01(along / *square));
		}
	return sum;
}

/* Darkness of texels x..end-1 of a row, dy below the centre, by an ellipse. The line's share of a texel is that of a
 * straight line of this width on a texel as wide as its step in this direction. */
static void ellipse_span(const form *restrict m, float radius, float dy, float centre, int x, int end,
			 float *restrict dark)
{
	float e = m->e, f = m->f, g = m->g, still = 2 / (e + g);
	for (; x < end; x += LANES)
		for (int k = 0; k < LANES; k++) {
			float dx = (float)(x + k) - centre;
			float u = e * dx + f * dy, v = f * dx + g * dy;
			float square = dx * u + dy * v, slope = u * u + v * v;
			square = square > 0 ? square : 0;
			float texels = sqrtf(slope > FLT_MIN ? square / slope : still), d = sqrtf(square);
			float inner = clamp01((radius - d) * texels + 0.5f),
			      outer = clamp01((radius + d) * texels + 0.5f);
			float t = inner + outer - 1;
			dark[x + k] = t > dark[x + k] ? t : dark[x + k];
		}
}

static void stamp_ellipse(const bake *b, const sheet *s, const form *m, float cx, float cy, float radius)
{
	float limit = limit_of(m, radius), square = limit * limit * m->e, high = sqrtf(square / m->det);
	float top = ceilf(cy - high), bottom = floorf(cy + high);
	int from = top > (float)s->y0 ? (int)top : s->y0, to = bottom < (float)(s->y1 - 1) ? (int)bottom : s->y1 - 1;
	for (int row = from; row <= to; row++) {
		float dy = (float)row - cy, *dark = s->dark + (size_t)(row - s->y0) * b->padded;
		float wide = square - m->det * dy * dy, half = wide > 0 ? sqrtf(wide) / m->e : 0,
		      middle = cx - m->f / m->e * dy;
		if (!b->wrap_x) {
			float left = ceilf(middle - half), right = floorf(middle + half);
			int first = left > 0 ? left < (float)b->width ? (int)left : b->width : 0;
			int end = right < (float)(b->width - 1) ? right >= 0 ? (int)right + 1 : 0 : b->width;
			ellipse_span(m, radius, dy, cx, first, end, dark);
			continue;
		}
		half = half < 1.5f * (float)b->width
			       ? half
			       : 1.5f * (float)b->width; /* other repetitions are nearer to the rest */
		float turns = floorf(middle / (float)b->width) * (float)b->width;
		float centre = cx - turns;
		int first = (int)ceilf(middle - turns - half), end = (int)floorf(middle - turns + half) + 1;
		for (int n; first < end; first += n) {
			int at = texel_index(first, b->width, true);
			n = end - first < b->width - at ? end - first : b->width - at;
			ellipse_span(m, radius, dy, centre - (float)(first - at), at, at + n, dark);
		}
	}
}

/* One ellipse for each axis along which the colors differ clearly. Diagonal pairs see boundaries that others are nearer
 * to. */
static void stamp_site(const bake *b, const sheet *s, int x, int y, float radius)
{
	float across, down, dx = boundary(b, x, y, 0, &across), dy = boundary(b, x, y, 1, &down);
	float clear = 0.5f * (across > down ? across : down);
	form m = form_at(b, x, texel_index(y, b->height, true));
	if (across > 0 && across >= clear)
		stamp_ellipse(b, s, &m, (float)x + dx, (float)y, radius);
	if (down > 0 && down >= clear)
		stamp_ellipse(b, s, &m, (float)x, (float)y + dy, radius);
}

/* ---- rows ------------------------------------------------------------------------------------------------ */

float ISA(stamp_reach)(const bake *b, int x, int y)
{
	float radius = b->radius[(ptrdiff_t)y * b->width + x], most = (float)b->height;
	if (!b->job->form.data)
		return radius;
	form m = form_at(b, x, y);
	float high = limit_of(&m, radius) * sqrtf(m.e / m.det) + 1; /* the centre is within a texel of this one */
	return high < most ? high : most;
}

void ISA(stamp_row)(const bake *b, const sheet *s, int y)
{
	const float *radius = b->radius + (ptrdiff_t)texel_index(y, b->height, true) * b->width;
	bool discs = !b->job->form.data;
	for (int x = 0; x < b->width; x++) {
		uint64_t pair;
		if (x + 2 <= b->width && (memcpy(&pair, radius + x, sizeof pair), pair == 0)) {
			x++;
			continue;
		}
		if (!(radius[x] > 0))
			continue;
		if (discs)
			stamp_disc(b, s, x, y, radius[x]);
		else
			stamp_site(b, s, x, y, radius[x]);
	}
}
