/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What strokes need of the pixels under them: which way they go there, and whether the surface goes on beside. Many
 * strokes ask the same pixel, so all are told at once, a row at a time. */
#include "tones/strokes.h"

/* The layers' strokes lie across each other. */
static const float turned[TONE_LAYERS][2] = {{1, 0}, {0.7071068f, 0.7071068f}, {0.5f, -0.8660254f}};

static void turn_layer(const tone_slot *s, int layer, float *c, float *d)
{
	*c = s->across[0] * turned[layer][0] - s->across[1] * turned[layer][1];
	*d = s->across[1] * turned[layer][0] + s->across[0] * turned[layer][1];
}

/* ---- ways -------------------------------------------------------------------------------------------------- */

static inline float dot3(float x, float y, float z, float u, float v, float w)
{
	return x * u + y * v + z * w;
}

/* Along planes that cut the thing, level but on floors. */
static inline void level_way(float nx, float ny, float nz, float *x, float *y, float *z)
{
	float level = fabsf(dot3(nx, ny, nz, 0.148f, 0.0986f, 0.984f));
	float ax = 0.148f, ay = level > 0.95f ? 0.984f : 0.0986f, az = level > 0.95f ? 0.0986f : 0.984f;
	float u = ay * nz - az * ny, v = az * nx - ax * nz, w = ax * ny - ay * nx;
	float scale = 1 / sqrtf(max(dot3(u, v, w, u, v, w), 1e-12f));
	*x = u * scale;
	*y = v * scale;
	*z = w * scale;
}

/* tangent: of the pixels, three channels each, if strokes follow it where it is not 0. */
KERNEL void ground(const tone_rest *rest, const bool by_uv, const float *restrict tangent, int n,
		   tone_ground *restrict g)
{
	const float (*normal)[TONE_REST] = rest->at + ANCHOR_NORMAL, (*form)[TONE_REST] = rest->at + ANCHOR_FORM,
		    (*right)[TONE_REST] = rest->at + ANCHOR_RIGHT, (*down)[TONE_REST] = rest->at + ANCHOR_DOWN;
	for (int i = 0; i < n; i++) {
		float nx = normal[0][i], ny = normal[1][i], nz = normal[2][i];
		float rx = right[0][i], ry = right[1][i], rz = right[2][i];
		float dx = down[0][i], dy = down[1][i], dz = down[2][i];
		float x, y, z; /* where it bends in none */
		level_way(nx, ny, nz, &x, &y, &z);
		float u = ny * z - nz * y, v = nz * x - nx * z, w = nx * y - ny * x;
		/* ways have no sign: their angles are doubled where they are mixed */
		float a = dot3(form[0][i], form[1][i], form[2][i], x, y, z),
		      b = dot3(form[0][i], form[1][i], form[2][i], u, v, w);
		float left = 1 - sqrtf(min(a * a + b * b, 1)), one = a * a - b * b + 0.25f * left * left,
		      two = 2 * a * b;
		float length = sqrtf(one * one + two * two);
		float p = one < 0 ? two : length + one, q = one < 0 ? length - one : two;
		q = length > 0 ? q : 1;
		if (by_uv) {
			const float *t = tangent + (ptrdiff_t)3 * i;
			float c = dot3(t[0], t[1], t[2], x, y, z), d = dot3(t[0], t[1], t[2], u, v, w);
			bool told = c * c + d * d > 1e-6f;
			p = told ? c : p;
			q = told ? d : q;
		}
		float rr = dot3(rx, ry, rz, rx, ry, rz), rd = dot3(rx, ry, rz, dx, dy, dz),
		      dd = dot3(dx, dy, dz, dx, dy, dz);
		float ra = dot3(rx, ry, rz, x, y, z), rb = dot3(rx, ry, rz, u, v, w);
		float da = dot3(dx, dy, dz, x, y, z), db = dot3(dx, dy, dz, u, v, w);
		float ax0 = dd * ra - rd * da, ay0 = rr * da - rd * ra, bx0 = dd * rb - rd * db,
		      by0 = rr * db - rd * rb;
		float most = max(max(fabsf(ax0), fabsf(ay0)), max(fabsf(bx0), fabsf(by0)));
		float scale = 1 / max(most, 1e-30f);
		p *= scale;
		q *= scale;
		g->along[0][i] = p * ax0 + q * bx0;
		g->along[1][i] = p * ay0 + q * by0;
		g->across[0][i] = p * bx0 - q * ax0;
		g->across[1][i] = p * by0 - q * ay0;
	}
}

void ISA(tone_ground_fill)(const tone_rest *rest, int n, tone_ground *g)
{
	ground(rest, false, NULL, n, g);
}

static void ground_of(const frame *f, const tone_slot *s, const tone_rest *rest, int y, int x, int n, tone_ground *g)
{
	const float *tangent = s->by_uv ? layer_row(f, ENCRE_LAYER_TANGENT, y) : NULL;
	if (tangent)
		ground(rest, true, tangent + (ptrdiff_t)3 * x, n, g);
	else
		ISA(tone_ground_fill)(rest, n, g);
}

/* Likewise of strokes toward the light: that from the camera's side, as things are small beside how far they are. */
static void ground_of_light(const frame *f, const tone_slot *s, int y, int x, int n, tone_ground *g)
{
	const float *normal = layer_row(f, ENCRE_LAYER_NORMAL, y) + (ptrdiff_t)3 * x, *v = f->camera.view,
		    *l = s->light;
	/* Planes side by side that hold the light and the eye: they meet nowhere on the side that is seen but at its
	 * rims, while meridians from the light would be a star where it comes from and at the darkest place. */
	float bx = l[1], by = -l[0], far = sqrtf(bx * bx + by * by);
	bx = far > 1e-3f ? bx / far : 1;
	by = far > 1e-3f ? by / far : 0;
	for (int i = 0; i < n; i++) {
		float a = normal[3 * i], b = normal[3 * i + 1], c = normal[3 * i + 2];
		float nx = dot3(v[0], v[1], v[2], a, b, c), ny = dot3(v[3], v[4], v[5], a, b, c),
		      nz = dot3(v[6], v[7], v[8], a, b, c);
		float tx = by * nz, ty = -bx * nz, tz = bx * ny - by * nx;
		bool none = !(dot3(tx, ty, tz, tx, ty, tz) > 1e-12f); /* no normal, or along the planes' axis */
		tx = none ? l[0] : tx;
		ty = none ? l[1] : ty;
		tz = none ? l[2] : tz;
		g->along[0][i] = tx;
		g->along[1][i] = -ty;
		g->across[0][i] = ny * tz - nz * ty;
		g->across[1][i] = -(nz * tx - nx * tz);
	}
}

/* A direction of the thing at rest, of any length, on the screen. */
static inline void on_screen(const float right[3], const float down[3], const float v[3], float *x, float *y)
{
	float rr = dot3(right[0], right[1], right[2], right[0], right[1], right[2]),
	      rd = dot3(right[0], right[1], right[2], down[0], down[1], down[2]),
	      dd = dot3(down[0], down[1], down[2], down[0], down[1], down[2]);
	float r = dot3(right[0], right[1], right[2], v[0], v[1], v[2]),
	      d = dot3(down[0], down[1], down[2], v[0], v[1], v[2]);
	*x = dd * r - rd * d;
	*y = rr * d - rd * r;
}

static bool same_object(const frame *f, int y0, int x0, int y1, int x1)
{
	const float *a = layer_row(f, ENCRE_LAYER_OBJECT, y0), *b = layer_row(f, ENCRE_LAYER_OBJECT, y1);
	return !a || a[x0] == b[x1];
}

/* By how much the normal at rest changes along a row or a column to pixels up to six steps off, of both ways the less:
 * where it changes all around, though hardly here, as between folds, there is no plane. None there: as much as it can.
 */
static float turns_by(const frame *f, int y, int x, int down, int right)
{
	static const int steps[] = {1, 3, 6};
	const float *own = anchor_at(f, x, y) + ANCHOR_NORMAL;
	float least = 2;
	for (int way = -1; way <= 1; way += 2) {
		float most = -1;
		for (int k = 0; k < 3; k++) {
			int ny = y + way * steps[k] * down, nx = x + way * steps[k] * right;
			if (ny < 0 || nx < 0 || ny >= f->height || nx >= f->width || !same_object(f, y, x, ny, nx))
				break;
			const float *n = anchor_at(f, nx, ny) + ANCHOR_NORMAL;
			float dx = n[0] - own[0], dy = n[1] - own[1], dz = n[2] - own[2];
			most = max(most, sqrtf(dx * dx + dy * dy + dz * dz));
		}
		least = most >= 0 ? min(least, most) : least;
	}
	return least;
}

/* How far the surface is a plane: from 0 to 1. Steps are of 8 pixels where a frame is 1080 high. */
static float plane_at(const frame *f, int y, int x)
{
	static const float none = 0.012f, all = 0.004f; /* change of the normal */
	int step = (int)max(nearest_int(8 * f->scale), 2);
	return clamp01((none - turns_by(f, y, x, step, 0) - turns_by(f, y, x, 0, step)) * (1 / (none - all)));
}

/* Strokes on what is turned hold to how the light falls on it at rest, and let go by degrees: with `a` on the skin from
 * the light to there they are turned from the light by atan(sin(2 a) / 2), 27 degrees at most. As a grows from 0 they
 * hardly slip, and at 90 degrees, where they could as well turn the other way, they lie toward the light. On a plane
 * they lie along it, in its own perspective: all walls of a room and its floor would have the same strokes, as rain. */
static void hold_light(const frame *f, const tone_marks *m, const tone_slot *s, const tone_rest *rest, int y, int x,
		       int n, tone_ground *g)
{
	const float *objects = layer_row(f, ENCRE_LAYER_OBJECT, y), *l = s->light, *by = NULL;
	for (int i = 0; i < n; i++) {
		float object = objects ? objects[x + i] : 0, light[3], right[3], down[3], normal[3], along[3], side[3];
		if (i == 0 || (objects && object != objects[x + i - 1]))
			by = ISA(tone_turn_of)(m, object);
		if (!by || !(rest->at[ANCHOR_PIXEL][i] > 0))
			continue;
		float square = 0;
		for (int c = 0; c < 3; c++) {
			right[c] = rest->at[ANCHOR_RIGHT + c][i];
			down[c] = rest->at[ANCHOR_DOWN + c][i];
			normal[c] = rest->at[ANCHOR_NORMAL + c][i];
			light[c] = dot3(by[c], by[3 + c], by[6 + c], l[0], l[1], l[2]);
			along[c] = g->along[0][i] * right[c] + g->along[1][i] * down[c];
			square += along[c] * along[c];
		}
		if (!(square > 1e-30f && square < 1e30f))
			continue;
		for (int c = 0; c < 3; c++)
			along[c] /= sqrtf(square);
		for (int c = 0; c < 3; c++) {
			int next = (c + 1) % 3, last = (c + 2) % 3;
			side[c] = normal[next] * along[last] - normal[last] * along[next];
		}
		float on = dot3(light[0], light[1], light[2], along[0], along[1], along[2]),
		      off = dot3(light[0], light[1], light[2], side[0], side[1], side[2]),
		      square_light = dot3(light[0], light[1], light[2], light[0], light[1], light[2]),
		      turn = on * off / max(square_light, 1e-30f);
		float level[3];
		level_way(normal[0], normal[1], normal[2], level, level + 1, level + 2);
		on = dot3(level[0], level[1], level[2], along[0], along[1], along[2]);
		off = dot3(level[0], level[1], level[2], side[0], side[1], side[2]);
		/* ways have no sign: their angles are doubled where they are mixed */
		float plane = plane_at(f, y, x + i), whole = 1 + turn * turn, all = max(on * on + off * off, 1e-30f);
		float p = mix((1 - turn * turn) / whole, (on * on - off * off) / all, plane),
		      q = mix(2 * turn / whole, 2 * on * off / all, plane), length = sqrtf(p * p + q * q);
		float by_on = p < 0 ? fabsf(q) : length + p, by_off = p >= 0 ? q : q < 0 ? p - length : length - p;
		by_on = length > 0 ? by_on : 1;
		float held[3], across[3];
		for (int c = 0; c < 3; c++) {
			held[c] = by_on * along[c] + by_off * side[c];
			across[c] = by_on * side[c] - by_off * along[c];
		}
		on_screen(right, down, held, &g->along[0][i], &g->along[1][i]);
		on_screen(right, down, across, &g->across[0][i], &g->across[1][i]);
	}
}

static void ways_on_surface(const tone_slot *s, const tone_ground *g, int layer, int n, uint8_t *restrict way)
{
	float c, d;
	turn_layer(s, layer, &c, &d);
	for (int i = 0; i < n; i++)
		way[i] =
			tone_way_of(c * g->along[0][i] + d * g->across[0][i], c * g->along[1][i] + d * g->across[1][i]);
}

/* ---- ends -------------------------------------------------------------------------------------------------- */

/* What tells whether the surface goes on: of a row's pixels and of their neighbours. */
typedef struct tone_side {
	const float *object, *depth, *place[3], *pixel;
} tone_side;

static void ends(const tone_side *a, const tone_side *b, const float *restrict grown, int n, int bit,
		 uint8_t *restrict bits)
{
	const float *ax = a->place[0], *ay = a->place[1], *az = a->place[2], *bx = b->place[0], *by = b->place[1],
		    *bz = b->place[2];
	for (int i = 0; i < n; i++) {
		float x = bx[i] - ax[i], y = by[i] - ay[i], z = bz[i] - az[i];
		float near = depth_of(a->depth[i]), far = depth_of(b->depth[i]);
		int known = (a->pixel[i] > 0) & (b->pixel[i] > 0);
		int close = x * x + y * y + z * z <= 16.0f * grown[i], level = fabsf(far - near) <= 0.05f * near;
		int goes = (a->object[i] == b->object[i]) & (known ? close : level);
		bits[i] = (uint8_t)(bits[i] | (goes ? 0 : bit));
	}
}

static tone_side side_of(const frame *f, const tone_rest *rest, int y, int x, int right)
{
	static const float none[TONE_REST];
	const float *object = layer_row(f, ENCRE_LAYER_OBJECT, y), *p = rest ? rest->at[ANCHOR_POSITION] + right : none;
	const ptrdiff_t next = rest ? TONE_REST : 0;
	return (tone_side){.object = object ? object + x + right : none,
			   .depth = layer_row(f, ENCRE_LAYER_DEPTH, y) + x + right,
			   .place = {p, p + next, p + 2 * next},
			   .pixel = rest ? rest->at[ANCHOR_PIXEL] + right : none};
}

/* The position and size of a row's pixels. */
static const tone_rest *places_of(const frame *f, int y, int x, int n, tone_rest *rest)
{
	enum { AHEAD = 32 }; /* nobody has read this row, and a page has few pixels of it */
	const float *restrict anchor = anchor_at(f, x, y);
	for (int i = 0; anchor && i < n; i++) {
		__builtin_prefetch(anchor + (ptrdiff_t)ANCHOR_COUNT * (i + AHEAD < n ? i + AHEAD : i));
		for (int c = ANCHOR_POSITION; c < ANCHOR_POSITION + 3; c++)
			rest->at[c][i] = anchor[(ptrdiff_t)ANCHOR_COUNT * i + c];
	}
	for (int i = 0; anchor && i < n; i++)
		rest->at[ANCHOR_PIXEL][i] = anchor[(ptrdiff_t)ANCHOR_COUNT * i + ANCHOR_PIXEL];
	return anchor ? rest : NULL;
}

static void ends_fill(const frame *f, const tone_rest *rest, int y, int x, int n, uint8_t *bits)
{
	float grown[TONE_CHUNK] = {0};
	tone_rest below;
	bool last = x + n == f->width, bottom = y + 1 == f->height;
	for (int k = 0; rest && k < 3; k++) {
		const float *r = rest->at[ANCHOR_RIGHT + k], *d = rest->at[ANCHOR_DOWN + k];
		for (int i = 0; i < n; i++)
			grown[i] += r[i] * r[i] + d[i] * d[i];
	}
	tone_side here = side_of(f, rest, y, x, 0), right = side_of(f, rest, y, x, 1);
	ends(&here, &right, grown, n - last, TONE_ENDS_RIGHT, bits);
	if (last)
		bits[n - 1] |= TONE_ENDS_RIGHT;
	if (!bottom) {
		tone_side under = side_of(f, rest ? places_of(f, y + 1, x, n, &below) : NULL, y + 1, x, 0);
		ends(&here, &under, grown, n, TONE_ENDS_DOWN, bits);
	}
	for (int i = 0; bottom && i < n; i++)
		bits[i] |= TONE_ENDS_DOWN;
}

/* ------------------------------------------------------------------------------------------------------------ */

/* own: all bits of a pixel that is, none of others. */
static void keep_own(const uint8_t *restrict own, const uint8_t *restrict from, int n, uint8_t *restrict to)
{
	for (int i = 0; i < n; i++)
		to[i] = (uint8_t)((from[i] & own[i]) | (to[i] & ~own[i]));
}

static void add_own(const uint8_t *restrict own, const uint8_t *restrict from, int n, uint8_t *restrict to)
{
	for (int i = 0; i < n; i++)
		to[i] = (uint8_t)(to[i] | (from[i] & own[i]));
}

void ISA(tone_ways)(const frame *f, const tone_marks *m, const tone_slot *slots, int k, const tone_rest *rest, int y,
		    int x, int n)
{
	const tone_slot *s = slots + k;
	const uint8_t *dark = tone_bytes(m, TONE_DARK, y) + x;
	const uint8_t *whose = tone_bytes(m, TONE_WHOSE, y) + x;
	uint8_t *bits = tone_bytes(m, TONE_BITS, y) + x, found[TONE_CHUNK] = {0}, way[TONE_CHUNK], own[TONE_CHUNK];
	tone_ground g;
	tone_rest any;
	for (int i = 0; i < n; i++)
		own[i] = dark[i] > 0 && whose[i] == k ? 255 : 0;
	/* strokes of the screen and of sheets end with the surface too */
	const tone_rest *place = rest && !tone_flat(s) ? rest : ISA(tone_rest_fill)(f, NULL, y, x, n, &any);
	ends_fill(f, place, y, x, n, found);
	add_own(own, found, n, bits);
	bool lit = s->to_light && f->layer[ENCRE_LAYER_NORMAL].data;
	if (lit)
		ground_of_light(f, s, y, x, n, &g);
	if (lit && rest && !tone_flat(s))
		hold_light(f, m, s, rest, y, x, n, &g);
	if (!lit && rest)
		ground_of(f, s, rest, y, x, n, &g);
	for (int layer = 0; layer < TONE_LAYERS; layer++) {
		uint8_t *to = tone_bytes(m, TONE_WAY + layer, y) + x;
		float c, d;
		turn_layer(s, layer, &c, &d);
		memset(way, tone_way_of(c, -d), (size_t)n);
		if (lit || rest)
			ways_on_surface(s, &g, layer, n, way);
		keep_own(own, way, n, to);
	}
}
