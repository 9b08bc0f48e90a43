/* SPDX-License-Identifier: GPL-3.0-or-later */
/* How dark pixels are, and which of their style's tones show it. */
#include "tones/tones.h"

#include <string.h>

static int slot_of(int level)
{
	return level < TONE_SLOTS ? level : TONE_SLOTS - 1;
}

/* Light that levels are compared with; what shines or reflects is not in the dark. Nothing there: INFINITY. */
static void light_row(const frame *f, const encre_params *p, int y, int x, int n, float *restrict light)
{
	const float *controls = controls_at(f, x, y),
		    *combined = layer_row(f, ENCRE_LAYER_COMBINED, y) + (ptrdiff_t)4 * x,
		    *color = layer_row(f, ENCRE_LAYER_COLOR, y) + (ptrdiff_t)3 * x,
		    *diffuse = layer_row(f, ENCRE_LAYER_DIFFUSE, y) + (ptrdiff_t)3 * x;
	for (int i = 0; i < n; i++) {
		const float *d = diffuse + 3 * i, *a = color + 3 * i;
		float lit = max3(d[0], d[1], d[2]) * p->shade_exposure + painted_light(controls, i);
		lit = max3(a[0], a[1], a[2]) < p->tone_black ? -1 : lit;
		light[i] = max(lit, other_light(combined + 4 * i, a, d));
	}
}

/* Levels are at most two at a pixel: their transitions don't overlap. */
static void want_level(const encre_params *p, int level, float gradient, int n, const float *restrict light,
		       const float *restrict added, float *restrict share, float *restrict sum)
{
	const encre_level *own = p->shade_levels.level + level, *next = own + 1;
	bool first = level == 0, last = level == p->shade_levels.count - 1;
	float base = 1 - own->intensity + p->tone_darkness, start = first ? 0 : own->threshold;
	float in = own->transition > 1e-30f ? 1 / own->transition : 0,
	      out = !last && next->transition > 1e-30f ? 1 / next->transition : 0;
	float span = last ? 0 : next->threshold - start, along = span > 1e-30f ? 1 / span : 0;
	float fall = last ? 0 : gradient * (next->intensity - own->intensity);
	for (int i = 0; i < n; i++) {
		float x = light[i];
		float entered = first ? 1 : in > 0 ? clamp01((x - own->threshold) * in + 0.5f) : x > own->threshold;
		float left = last ? 0 : out > 0 ? clamp01((x - next->threshold) * out + 0.5f) : x > next->threshold;
		float here = max(entered - left, 0);
		share[i] += here;
		sum[i] += here * clamp01(base - fall * clamp01((x - start) * along) + added[i]);
	}
}

static bool any(const float *values, int n)
{
	float most = 0;
	for (int i = 0; i < n; i++)
		most = max(most, values[i]);
	return most > 0;
}

void ISA(tone_want)(const frame *f, const encre_params *p, const tone_slot *slots, int y, int x, int n, tone_wanted *w)
{
	float light[TONE_CHUNK], added[TONE_CHUNK], none[TONE_CHUNK] = {0};
	const float *controls = controls_at(f, x, y), *depth = layer_row(f, ENCRE_LAYER_DEPTH, y) + x;
	light_row(f, p, y, x, n, light);
	for (int i = 0; i < n; i++)
		added[i] = controls ? controls[CONTROL_COUNT * i + CONTROL_HATCHING] : 0;
	for (int k = 0; k < TONE_SLOTS; k++)
		w->any[k] = false;
	for (int level = 0; level < p->shade_levels.count; level++) {
		const tone_slot *own = slots + slot_of(level);
		int k = own->like;
		if (own->kind == tone_1_NONE)
			continue;
		if (!w->any[k]) {
			memset(w->share[k], 0, sizeof w->share[k]);
			memset(w->dark[k], 0, sizeof w->dark[k]);
		}
		w->any[k] = true;
		want_level(p, level, own->gradient, n, light, own->kind == tone_1_GRAIN ? none : added, w->share[k],
			   w->dark[k]);
	}
	for (int k = 0; k < TONE_SLOTS; k++) {
		for (int i = 0; i < n && w->any[k]; i++) {
			float share = depth_of(depth[i]) < INFINITY ? w->share[k][i] : 0;
			w->dark[k][i] = share > 0 ? clamp01(w->dark[k][i] / w->share[k][i]) : 0;
			w->share[k][i] = clamp01(share);
		}
		w->any[k] = w->any[k] && any(w->dark[k], n);
	}
}
