/* SPDX-License-Identifier: GPL-3.0-or-later */
/* One stroke of a flat brush: opaque, with the marks of hairs along it, ragged at its ends, running dry at the last. It
 * stays on its thing and on paint like that under its middle. */
#include "paint/paint.h"

enum { ACROSS = 64, ALONG = 32, CHUNK = 256 };

static const float alike = 0.16f; /* up to which paint is still the same */

/* What a stroke is by the place across it, and along it. */
typedef struct brush {
	float tone[ACROSS], end[ACROSS], begin[ACROSS], dry[ACROSS]; /* ends in halves */
	float side[ALONG];
} brush;

static inline float chance(uint32_t name, int32_t k, uint32_t what)
{
	return (float)(mix_bits((uint32_t)k * 0x9e3779b9u + mix_bits(name * 31 + what)) >> 8) * 0x1p-24f;
}

/* Noise of one dimension, 0..1. */
static inline float hair(float x, uint32_t name, uint32_t what)
{
	float whole = floorf(x), t = x - whole;
	t = t * t * (3 - 2 * t);
	return mix(chance(name, (int32_t)whole, what), chance(name, (int32_t)whole + 1, what), t);
}

static void brush_fill(const paint_stroke *s, float scale, brush *b)
{
	float per = 1 / max(scale, 0.25f), facing = 0.7071068f * (s->along[1] - s->along[0]);
	for (int k = 0; k < ACROSS; k++) {
		float at = (2 * ((float)k + 0.5f) / ACROSS - 1), t = at * s->wide * per;
		float thick = hair(0.27f * t + 40, s->name, 11), thin = hair(0.6f * t + 5, s->name, 19);
		float ridge = paint_smooth(0.62f, 0.95f, fabsf(at)) * (at < 0 ? -facing : facing);
		b->tone[k] = 1 + s->body * (0.13f * (thick - 0.5f) + 0.06f * (thin - 0.5f) + 0.07f * ridge);
		b->end[k] = 0.78f + 0.22f * hair(0.45f * t + 9, s->name, 5);
		b->begin[k] = 0.91f + 0.09f * hair(0.4f * t + 3, s->name, 7);
		b->dry[k] = 0.85f * paint_smooth(0.5f, 0.75f, thick);
	}
	for (int k = 0; k < ALONG; k++)
		b->side[k] =
			0.9f + 0.1f * hair(0.075f * (2 * ((float)k + 0.5f) / ALONG - 1) * s->half * per, s->name, 2);
}

/* The x for which x * more + other lies within -far..far. */
static void narrow(float more, float other, float far, float *from, float *to)
{
	if (fabsf(more) < 1e-3f)
		return;
	float a = (-far - other) / more, b = (far - other) / more;
	*from = max(*from, min(a, b));
	*to = min(*to, max(a, b));
}

/* How much of n pixels is under the stroke, and how light it is there. dx, dy: from its middle to the first. */
static void cover_row(const paint_stroke *s, const brush *b, float dx, float dy, int n, float *restrict cover,
		      float *restrict tone)
{
	float per = 0.5f / s->wide, part = 0.5f / s->half;
	for (int i = 0; i < n; i++) {
		float a = dx + (float)i, l = a * s->along[0] + dy * s->along[1],
		      t = dy * s->along[0] - a * s->along[1] - s->bend * l * l;
		int k = (int)(clamp01(t * per + 0.5f) * (ACROSS - 1) + 0.5f),
		    j = (int)(clamp01(l * part + 0.5f) * (ALONG - 1) + 0.5f);
		float end = s->half * (l > 0 ? b->end[k] : b->begin[k]) - fabsf(l);
		float side = s->wide * b->side[j] - fabsf(t);
		float dry = clamp01((l * part + 0.5f) * 1.6f - 0.8f) * b->dry[k];
		cover[i] = clamp01(min(end * 0.7f + 0.5f, side * 0.9f + 0.5f)) * (1 - dry);
		tone[i] = b->tone[k];
	}
}

/* Takes away what is not the stroke's thing and not of its paint. */
static void keep_row(const gouache *g, const paint_stroke *s, float dx, float dy, int x, int y, int n,
		     float *restrict cover)
{
	const float *objects = layer_row(g->f, ENCRE_LAYER_OBJECT, y), *near = paint_under(g, UNDER_NEAR, y) + x;
	const float *r = paint_under(g, UNDER_PAINT, y) + x, *green = paint_under(g, UNDER_PAINT + 1, y) + x,
		    *blue = paint_under(g, UNDER_PAINT + 2, y) + x, *light = paint_under(g, UNDER_LIGHT, y) + x;
	float first = s->near + s->slope[0] * dx + s->slope[1] * dy, lit = 2 / s->strays,
	      off = step_of_depth * s->near + 1.5f * (fabsf(s->slope[0]) + fabsf(s->slope[1]));
	for (int i = 0; i < n; i++) {
		float other =
			max3(fabsf(r[i] - s->paint[0]), fabsf(green[i] - s->paint[1]), fabsf(blue[i] - s->paint[2]));
		int own = fabsf(near[i] - (first + s->slope[0] * (float)i)) <= off;
		own &= (near[i] > 0) == (s->near > 0);
		float beyond = fabsf(light[i] - s->light);
		cover[i] *= own ? clamp01(2 - other * (2 / alike)) * clamp01(2 - beyond * lit) : 0;
	}
	for (int i = 0; objects && i < n; i++)
		cover[i] = objects[x + i] == s->object ? cover[i] : 0;
}

static void draw_stroke(const gouache *g, const paint_stroke *s, int y0, int y1)
{
	const frame *f = g->f;
	float bent = fabsf(s->bend) * s->half * s->half, wide = s->wide + bent + 1, half = s->half + 2;
	float cx = s->x - (float)f->place.x, cy = s->y - (float)f->place.y; /* in this frame */
	float high = half * fabsf(s->along[1]) + wide * fabsf(s->along[0]);
	int top = (int)max(floorf(cy - high), (float)y0), bottom = (int)min(ceilf(cy + high) + 1, (float)y1);
	brush b;
	if (top >= bottom)
		return;
	brush_fill(s, f->scale, &b);
	for (int y = top; y < bottom; y++) {
		float dy = (float)y + 0.5f - cy, from = -cx, to = (float)f->width - cx;
		narrow(s->along[0], dy * s->along[1], half, &from, &to);
		narrow(-s->along[1], dy * s->along[0], wide, &from, &to);
		int x = (int)max(floorf(cx + from), 0), end = (int)min(ceilf(cx + to), (float)f->width);
		for (; x < end; x += CHUNK) {
			int n = end - x < CHUNK ? end - x : CHUNK;
			float cover[CHUNK], tone[CHUNK], dx = (float)x + 0.5f - cx;
			cover_row(s, &b, dx, dy, n, cover, tone);
			keep_row(g, s, dx, dy, x, y, n, cover);
			float *out = output_row(f, ENCRE_OUTPUT_COMBINED, y) + (ptrdiff_t)4 * x;
			for (int i = 0; i < n; i++)
				for (int c = 0; c < 3; c++)
					out[4 * i + c] = bounded(blend(
						out[4 * i + c], s->color[c] * tone[i] * out[4 * i + 3], cover[i]));
		}
	}
}

void ISA(paint_draw)(const gouache *g, int count, int y0, int y1)
{
	for (int k = 0; k < count && !bands_stopped(g->f->bands); k++)
		draw_stroke(g, g->strokes + g->order[k], y0, y1);
}
