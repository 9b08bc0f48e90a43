/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Light in a few levels (Vainumäe 2020, 4.1): how far each pixel's light is on the way from level to level. */
#include "surface/lit.h"
#include "base/pixel.h"
#include "base/step.h"

#include <string.h>

/* What levels are compared with. */
static void exposed_row(int n, const float *restrict diffuse, const float *restrict controls, metering m,
			float *restrict x)
{
	for (int i = 0; i < n; i++)
		x[i] = exposed(m, max3(diffuse[3 * i], diffuse[3 * i + 1], diffuse[3 * i + 2]));
	for (int i = 0; controls && i < n; i++)
		x[i] += painted_light(controls, i);
}

/* Below 1e-30 a transition is a step: its inverse may overflow. */
static float inverse_width(const encre_level *level)
{
	return level->transition > 1e-30f ? 1 / level->transition : 0;
}

/* Light about n pixels from x on is as their own style has it. */
static void steep_row(const frame *f, const encre_params *p, int y, int x, int n, const float *restrict own,
		      float *restrict steep)
{
	float above[LIT_CHUNK], below[LIT_CHUNK], row[LIT_CHUNK + 2], *const beside[2] = {above, below};
	metering m = metering_of(f, p);
	for (int k = 0; k < 2; k++) {
		int v = step_beside(y, k ? 1 : -1, f->height);
		exposed_row(n, layer_row(f, ENCRE_LAYER_DIFFUSE, v) + (ptrdiff_t)3 * x, controls_at(f, x, v), m,
			    beside[k]);
	}
	row[0] = exposed_at(f, p, step_beside(x, -1, f->width), y);
	memcpy(row + 1, own, (size_t)n * sizeof *row);
	row[n + 1] = exposed_at(f, p, step_beside(x + n - 1, 1, f->width), y);
	for (int i = 0; i < n; i++)
		steep[i] = step_steepness(step_differs(row[i], own[i], row[i + 2]),
					  step_differs(above[i], own[i], below[i]));
}

KERNEL void slope_row(float threshold, float inverse, int n, const float *restrict x, float *restrict share)
{
	for (int i = 0; i < n; i++)
		share[i] = clamp01((x[i] - threshold) * inverse + 0.5f);
}

KERNEL void step_row(float threshold, int n, const float *restrict x, const float *restrict steep,
		     float *restrict share)
{
	for (int i = 0; i < n; i++)
		share[i] = step_passed(x[i], threshold, steep[i]);
}

KERNEL void tone_row(const encre_levels *levels, int n, lit *restrict l)
{
	for (int i = 0; i < n; i++)
		l->tone[i] = levels->level[0].intensity;
	for (int k = 1; k < levels->count; k++)
		for (int i = 0; i < n; i++)
			l->tone[i] = mix(l->tone[i], levels->level[k].intensity, l->passed[k][i]);
}

/* l->exposed is what there is. */
static void levels_row(const frame *f, const encre_params *p, int y, int x, int n, lit *restrict l)
{
	const encre_levels *levels = &p->shade_levels;
	float steep[LIT_CHUNK];
	bool known = false;
	for (int k = 1; k < levels->count; k++) {
		float threshold = levels->level[k].threshold, inverse = inverse_width(levels->level + k);
		if (inverse > 0) {
			slope_row(threshold, inverse, n, l->exposed, l->passed[k]);
			continue;
		}
		if (!known)
			steep_row(f, p, y, x, n, l->exposed, steep);
		known = true;
		step_row(threshold, n, l->exposed, steep, l->passed[k]);
	}
	tone_row(levels, n, l);
}

void ISA(lit_row)(const frame *f, const encre_params *p, int y, int x, int n, float (*diffuse)[LIT_CHUNK], lit *l)
{
	metering m = metering_of(f, p);
	const float *controls = controls_at(f, x, y);
	for (int i = 0; i < n; i++)
		l->exposed[i] = exposed(m, max3(diffuse[0][i], diffuse[1][i], diffuse[2][i]));
	for (int i = 0; controls && i < n; i++)
		l->exposed[i] += painted_light(controls, i);
	levels_row(f, p, y, x, n, l);
}

void ISA(level_color_row)(const encre_levels *levels, int c, int n, lit *l, float *restrict color)
{
	for (int i = 0; i < n; i++)
		color[i] = levels->level[0].color[c];
	bool plain = true; /* so far all have one: what is mixed of it is that */
	for (int k = 1; k < levels->count; k++) {
		const encre_level *level = levels->level + k;
		plain = plain && !memcmp(level->color, level[-1].color, sizeof level->color);
		if (plain)
			continue;
		const float *restrict passed = l->passed[k];
		for (int i = 0; i < n; i++)
			color[i] = mix(color[i], level->color[c], passed[i]);
	}
}

/* ---- for other stages ------------------------------------------------------------------------------------- */

void ISA(shade_tones)(const frame *f, int y, int x0, int x1, float *tone)
{
	const float *diffuse = layer_row(f, ENCRE_LAYER_DIFFUSE, y);
	for (int x = x0, end; x < x1; x = end) {
		lit l;
		const encre_params *p = style_run(f, y, x, x1 - x > LIT_CHUNK ? x + LIT_CHUNK : x1, &end);
		exposed_row(end - x, diffuse + 3 * x, controls_at(f, x, y), metering_of(f, p), l.exposed);
		levels_row(f, p, y, x, end - x, &l);
		memcpy(tone + (x - x0), l.tone, (size_t)(end - x) * sizeof *tone);
	}
}

void ISA(shade_exposed)(const frame *f, int y, float *light)
{
	const float *diffuse = layer_row(f, ENCRE_LAYER_DIFFUSE, y);
	for (int x = 0, end; x < f->width; x = end) {
		const encre_params *p = style_run(f, y, x, f->width, &end);
		exposed_row(end - x, diffuse + (ptrdiff_t)3 * x, controls_at(f, x, y), metering_of(f, p), light + x);
		for (int i = x; i < end; i++)
			light[i] = bounded(light[i]);
	}
}
