/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Discrete shading (Vainumäe 2020, 4.1): light in a few flat levels, tinted and less saturated in the shade. What
 * was not diffuse light (emission, reflections, glass, sky) lies over it as it was rendered. */
#include "base/pixel.h"
#include "base/stage.h"
#include "surface/lit.h"

#include <stdio.h>
#include <string.h>

/* ---- row kernels ----------------------------------------------------------------------------------------- */

/* NaN, which only overflowing input makes, gives 0. */
static inline float drawable(float x)
{
	return min(positive(x), pixel_most);
}

/* As split_channels() and back. */
KERNEL void split(const float *restrict in, const int channels, int n, float (*restrict plane)[LIT_CHUNK])
{
	split_channels(in, channels, n, LIT_CHUNK, plane[0]);
}

KERNEL void join(float (*restrict plane)[LIT_CHUNK], const int channels, int n, float *restrict out)
{
	for (int i = 0; i < n; i++)
		for (int c = 0; c < channels; c++)
			out[channels * i + c] = plane[c][i];
}

/* How far a level is shade: below 0 it is brighter than full light. */
static inline float shade_of(float tone, int beyond)
{
	return beyond ? max(1 - tone, -0.5f) : positive(1 - tone);
}

/* light: the colours of the levels in, the discrete and tinted light out. The hue of dark light fades to white, or
 * noise would shine: mix(1, diffuse/V, V/0.02) is 1 + (diffuse - V)/max(V, 0.02). Likewise (D + w tint)/(1 + w) is a
 * mix. */
KERNEL void light_row(const encre_params *p, int n, const float *restrict tone, float (*restrict diffuse)[LIT_CHUNK],
		      float (*restrict light)[LIT_CHUNK])
{
	float weight = p->shade_tint_weight, hued = p->light_hue;
	float tint[] = {p->shade_tint[0], p->shade_tint[1], p->shade_tint[2]};
	for (int i = 0; i < n; i++) {
		float v = max3(diffuse[0][i], diffuse[1][i], diffuse[2][i]);
		float hue = v > 0 ? hued / max(v, 0.02f) : 0;
		float w = max(shade_of(tone[i], p->shade_beyond) * weight, -0.5f), share = w / (1 + w);
		for (int c = 0; c < 3; c++)
			light[c][i] =
				bounded(mix((1 + (diffuse[c][i] - v) * hue) * tone[i] * light[c][i], tint[c], share));
	}
}

/* combined: as rendered in, as drawn out. */
KERNEL void shaded_row(const encre_params *p, float other_light, int n, const float *restrict tone,
		       float (*restrict color)[LIT_CHUNK], float (*restrict diffuse)[LIT_CHUNK],
		       float (*restrict light)[LIT_CHUNK], float (*restrict combined)[LIT_CHUNK])
{
	float grey = 1 - clamp01(p->shade_saturation), strength = p->shade_strength;
	for (int i = 0; i < n; i++) {
		float value = max3(color[0][i], color[1][i], color[2][i]);
		float kept = 1 - shade_of(tone[i], p->shade_beyond) * grey; /* of the saturation */
		for (int c = 0; c < 3; c++) {
			float rendered = combined[c][i], diffused = bounded(color[c][i] * diffuse[c][i]);
			float flat = bounded((value - (value - color[c][i]) * kept) * light[c][i]);
			float drawn =
				drawable(blend(diffused, flat, strength) + other_light * bounded(rendered - diffused));
			combined[c][i] = combined[3][i] == 0 ? rendered : drawn;
		}
	}
}

/* How strong each part of what is not diffuse light is, and the colour of highlights that are shapes. */
typedef struct parts {
	float background, highlights, reflections, glow;
	float shape, threshold, inverse, light, color[3], tones;
	bool bare;
} parts;

/* The brightness over which a highlight's shape ends, as a share of full light: of the light that falls there, where
 * that is more, or a lamp close by would make highlights of what is rough. */
static const float highlight_edge = 0.05f;

static parts parts_of(const frame *f, const encre_params *p)
{
	float light = max(f->metered.full, 1); /* a bright sun makes no highlight of what is rough */

	return (parts){
		.bare = f->params->surface == surface_PAPER,
		.background = f->params->other_background,
		.highlights = p->other_highlights,
		.reflections = p->other_reflections,
		.glow = p->other_glow,
		.shape = p->highlight_shape,
		.threshold = min(p->highlight_threshold * light, FLT_MAX),
		.inverse = 1 / (highlight_edge * light),
		.light = light,
		.tones = (float)p->reflection_tones,
		.color = {p->highlight_color[0], p->highlight_color[1], p->highlight_color[2]},
	};
}

static bool as_rendered(const parts *k)
{
	return k->background == 1 && k->highlights == 1 && k->reflections == 1 && k->glow == 1 && !(k->shape > 0) &&
	       !(k->tones > 0);
}

/* What brings light to the nearest of tones that look evenly far from each other: in square roots. Between two it takes
 * a tenth of the way, or the border had steps. */
static inline float to_tone(float light, float tones)
{
	float root = min(sqrtf(positive(light)), 1e6f), place = root * tones + 0.5f, whole = floorf(place);
	float tone = (whole - 1 + clamp01(10 * (place - whole))) / tones;
	return root > 0 ? tone * tone / (root * root) : 0;
}

/* What of a highlight counts as a shape: what is seen at a grazing angle throws back much however rough it is. */
static inline float glint(const frame *f, const float *normal)
{
	float facing = clamp01(2 * turned_to(f, 2, normal));
	return facing * facing;
}

/* combined with each part as strong as wanted. Whatever no layer tells apart counts as glass and emission. Layers that
 * are absent are NULL. */
static void weigh_row(const frame *f, const parts *k, int n, const float *restrict combined,
		      const float *restrict color, const float *restrict diffuse, const float *restrict normal,
		      const float *restrict specular, const float *restrict highlights, const float *restrict gloss,
		      const float *restrict background, const float *restrict depth, float *restrict out)
{
	for (int i = 0; i < n; i++) {
		const float *h = highlights ? highlights + 3 * i : NULL, *own = gloss ? gloss + 3 * i : NULL;
		float metal = own ? metal_share(own) : 0, full = own ? max3(own[0], own[1], own[2]) : 0;
		bool nothing = !(depth_of(depth[i]) < INFINITY);
		float lit = max3(diffuse[3 * i], diffuse[3 * i + 1], diffuse[3 * i + 2]) / k->light;
		float bright = h ? max3(h[0], h[1], h[2]) * glint(f, normal + 3 * i) / max(lit, 1) : 0, share = 0;
		if (k->inverse > 0)
			share = clamp01((bright - k->threshold) * k->inverse + 0.5f);
		else
			share = bright > k->threshold ? 1 : 0;
		for (int c = 0; c < 3; c++) {
			float other = bounded(combined[4 * i + c] - bounded(color[3 * i + c] * diffuse[3 * i + c]));
			float lamps = h ? h[c] : 0, shines = specular ? specular[3 * i + c] : 0;
			float behind = background ? background[3 * i + c] : nothing ? other : 0;
			float rest = bounded(other - behind - (shines > lamps ? shines : lamps));
			float tint = metal > 0 ? blend(1, own[c] / full, metal) : 1; /* what is copper shines so */
			float shown = blend(lamps, k->color[c] * tint * share, h ? k->shape : 0);
			float sum = k->background * behind + k->highlights * shown + k->glow * rest;
			sum += k->reflections * (shines > lamps ? shines - lamps : 0);
			sum = k->bare || combined[4 * i + 3] != 0 ? bounded(bounded(sum) - other) : 0;
			out[4 * i + c] = bounded(combined[4 * i + c] + sum);
		}
		out[4 * i + 3] = combined[4 * i + 3];
	}
}

/* combined, in which what metals mirror becomes flat tones. Whole, with highlights in it: apart both are as noisy as
 * they were rendered. */
static void mirrored_row(const parts *k, int n, const float *restrict color, const float *restrict diffuse,
			 const float *restrict gloss, const float *restrict background, float *restrict combined)
{
	for (int i = 0; i < n; i++) {
		float share = metal_share(gloss + 3 * i), other[3], bright = 0;
		for (int c = 0; c < 3; c++) {
			other[c] = bounded(combined[4 * i + c] - bounded(color[3 * i + c] * diffuse[3 * i + c]));
			other[c] = bounded(other[c] - (background ? k->background * background[3 * i + c] : 0));
			bright = max(bright, other[c]);
		}
		float more = share * (to_tone(bright, k->tones) - 1);
		more = k->bare || combined[4 * i + 3] != 0 ? more : 0;
		for (int c = 0; c < 3; c++)
			combined[4 * i + c] = bounded(combined[4 * i + c] + bounded(more * other[c]));
	}
}

static void bare_row(const float *paper, int n, const float *restrict combined, const float *restrict color,
		     const float *restrict diffuse, float other_light, float *restrict out)
{
	for (int i = 0; i < n; i++) {
		for (int c = 0; c < 3; c++) {
			float other = bounded(combined[4 * i + c] - bounded(color[3 * i + c] * diffuse[3 * i + c]));
			out[4 * i + c] = drawable(paper[c] * combined[4 * i + 3] + other_light * other);
		}
		out[4 * i + 3] = combined[4 * i + 3];
	}
}

/* ---- stage ----------------------------------------------------------------------------------------------- */

/* Three channels from pixel x of row y on; NULL where the layer is absent. */
static const float *part_of(const frame *f, enum encre_layer layer, int x, int y)
{
	const float *row = layer_row(f, layer, y);
	return row ? row + (ptrdiff_t)3 * x : NULL;
}

static void shade_run(const frame *f, const encre_params *p, int y, int x, int n, int thread)
{
	const float *combined = layer_row(f, ENCRE_LAYER_COMBINED, y) + 4 * x;
	const float *color = layer_row(f, ENCRE_LAYER_COLOR, y) + 3 * x;
	const float *diffuse = layer_row(f, ENCRE_LAYER_DIFFUSE, y) + 3 * x;
	float *surface = output_row(f, ENCRE_OUTPUT_COMBINED, y) + 4 * x;
	bool want_light = f->output[ENCRE_OUTPUT_LIGHT].data, bare = f->params->surface == surface_PAPER;
	bool shades = p->use_shading && !bare, hatches = f->bright && p->use_hatching;
	float weighed[4 * LIT_CHUNK], other_light = f->params->other_light;
	float lights[3][LIT_CHUNK], diffuses[3][LIT_CHUNK], colors[3][LIT_CHUNK], rendered[4][LIT_CHUNK];
	lit l;
	fetch_ahead(f, thread);
	if (!p->use_shading && !want_light && !hatches) { /* nothing goes on meanwhile: later stages ask for the rest */
		memcpy(surface, combined, (size_t)n * 4 * sizeof *surface);
		return;
	}
	if (want_light || shades || hatches) {
		split(diffuse, 3, n, diffuses);
		fetch_ahead(f, thread);
		ISA(lit_row)(f, p, y, x, n, diffuses, &l);
	}
	fetch_ahead(f, thread);
	if (shades || hatches) {
		split(color, 3, n, colors);
		fetch_ahead(f, thread);
		split(combined, 4, n, rendered);
	}
	fetch_ahead(f, thread);
	if (hatches)
		ISA(hatch_bright)(p, n, LIT_CHUNK, rendered[0], colors[0], diffuses[0], l.exposed, l.tone,
				  bright_row(f, y, thread) + x);
	parts k = parts_of(f, p);
	if (p->use_shading && !as_rendered(&k)) {
		const float *gloss = k.tones > 0 || k.shape > 0 ? part_of(f, ENCRE_LAYER_GLOSS, x, y) : NULL;
		weigh_row(f, &k, n, combined, color, diffuse, part_of(f, ENCRE_LAYER_NORMAL, x, y),
			  part_of(f, ENCRE_LAYER_SPECULAR, x, y), part_of(f, ENCRE_LAYER_HIGHLIGHTS, x, y), gloss,
			  part_of(f, ENCRE_LAYER_BACKGROUND, x, y), layer_row(f, ENCRE_LAYER_DEPTH, y) + x, weighed);
		if (gloss && k.tones > 0)
			mirrored_row(&k, n, color, diffuse, gloss, part_of(f, ENCRE_LAYER_BACKGROUND, x, y), weighed);
		combined = weighed;
		split(combined, 4, n, rendered);
	}
	fetch_ahead(f, thread);
	for (int c = 0; (want_light || shades) && c < 3; c++) {
		ISA(level_color_row)(&p->shade_levels, c, n, &l, lights[c]);
		fetch_ahead(f, thread);
	}
	if (want_light || shades)
		light_row(p, n, l.tone, diffuses, lights);
	fetch_ahead(f, thread);
	if (want_light)
		join(lights, 3, n, output_row(f, ENCRE_OUTPUT_LIGHT, y) + 3 * x);
	if (!p->use_shading)
		memcpy(surface, combined, (size_t)n * 4 * sizeof *surface);
	else if (bare)
		bare_row(f->params->paper_color, n, combined, color, diffuse, other_light, surface);
	else {
		shaded_row(p, other_light, n, l.tone, colors, diffuses, lights, rendered);
		fetch_ahead(f, thread);
		join(rendered, 4, n, surface);
	}
	fetch_ahead(f, thread);
}

static void shade_rows(void *data, int y0, int y1, int thread)
{
	const frame *f = data;
	for (int y = y0; y < y1; y++)
		for (int x = 0, end; x < f->width; x = end) {
			const encre_params *p =
				style_run(f, y, x, f->width - x > LIT_CHUNK ? x + LIT_CHUNK : f->width, &end);
			shade_run(f, p, y, x, end - x, thread);
		}
}

/* Hatching looks at what is split here anyway, where it comes next on the same rows. */
static void plan(frame *f, arena *a)
{
	f->bright = NULL;
	if (f->any.use_hatching && f->any.use_shading && f->hatches_along)
		f->bright = arena_take(a, (size_t)bands_threads(f->bands) * NEAR_ROWS * (size_t)f->width,
				       sizeof *f->bright);
}

static const char *check(const encre_params *params, char *text, size_t size)
{
	const encre_levels *levels = &params->shade_levels;
	if (params->shade_meter == shade_meter_FIXED && !(params->meter_shade < params->meter_light)) {
		snprintf(text, size,
			 "meter_shade: shade of %g is not darker than full light, %g; give less of it, or 0",
			 (double)params->meter_shade, (double)params->meter_light);
		return text;
	}
	if (levels->count < 1 || levels->count > ENCRE_MAX_LEVELS) {
		snprintf(text, size, "shade_levels: %d levels; give 1 to %d", (int)levels->count, ENCRE_MAX_LEVELS);
		return text;
	}
	for (int k = 0; k < levels->count; k++) {
		const encre_level *l = levels->level + k, *below = l - 1;
		bool valid = l->intensity >= 0 && l->intensity <= FLT_MAX;
		for (int c = 0; c < 3; c++)
			valid &= l->color[c] >= 0 && l->color[c] <= FLT_MAX;
		if (k > 0)
			valid &= fabsf(l->threshold) <= FLT_MAX && l->transition >= 0 && l->transition <= FLT_MAX;
		if (!valid) {
			snprintf(text, size,
				 "shade_levels: level %d has a negative or no number; give intensity, transition and "
				 "color from 0 up",
				 k + 1);
			return text;
		}
		if (k < 2)
			continue;
		if (l->threshold < below->threshold) {
			snprintf(text, size,
				 "shade_levels: the threshold %g of level %d lies under %g of the one before; give "
				 "darkest first",
				 (double)l->threshold, k + 1, (double)below->threshold);
			return text;
		}
		/* a hair's breadth is allowed: thresholds that touch in decimals may not in binary */
		double end = (double)below->threshold + 0.5 * (double)below->transition,
		       start = (double)l->threshold - 0.5 * (double)l->transition;
		if (end > start + 1e-6 * (1 + fabs(start))) {
			snprintf(text, size,
				 "shade_levels: the transitions of levels %d and %d overlap; move thresholds %g and %g "
				 "apart or give narrower transitions",
				 k, k + 1, (double)below->threshold, (double)l->threshold);
			return text;
		}
	}
	return NULL;
}

const stage STAGE_SYMBOL(shade) = {.id = "shade", .check = check, .plan = plan, .rows = shade_rows};
