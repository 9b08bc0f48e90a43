/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Hatching (Vainumäe 2020, 4.3): pencil rubbed into dark and shaded surfaces, where the paper is high enough to take
 * it. Glossy highlights stay clean. */
#include "base/pixel.h"
#include "base/stage.h"

enum {
	CHUNK = 256, /* as many tones ask for, too */
	PIECE = 128, /* pixels that are passed over if the pencil reaches none */
};

/* ---- row kernels ----------------------------------------------------------------------------------------- */

/* What light on dark colours leaves of the lack of brightness, from the level of each pixel; the lightest level leaves
 * least. */
static void lighten_row(const encre_params *p, int n, const float *restrict tone, float *restrict share)
{
	const encre_levels *levels = &p->shade_levels;
	float low = levels->level[0].intensity, high = levels->level[levels->count - 1].intensity, rise = high - low;
	float scale = rise > 0 ? 1 / rise : 0, most = p->hatch_color_light;
	for (int i = 0; i < n; i++)
		share[i] = 1 - most * clamp01((tone[i] - low) * scale);
}

static bool lightens(const encre_params *p)
{
	return p->hatch_color_light > 0 && p->hatch_color_threshold > 0;
}

/* The lesser of colour's and light's brightness, each as a share of its threshold. A part of what a colour lacks stays
 * where light falls on it. What shines or reflects is bright in both. */
void ISA(hatch_bright)(const encre_params *p, int n, ptrdiff_t apart, const float *restrict combined,
		       const float *restrict color, const float *restrict diffuse, const float *restrict exposed,
		       const float *restrict tone, float *restrict bright)
{
	float color_threshold = p->hatch_color_threshold, light_threshold = p->hatch_light_threshold, own[CHUNK],
	      lit[CHUNK], left[CHUNK];
	for (int i = 0; i < n; i++) {
		float pixel[] = {combined[i], combined[apart + i], combined[2 * apart + i], 1},
		      c[] = {color[i], color[apart + i], color[2 * apart + i]},
		      l[] = {diffuse[i], diffuse[apart + i], diffuse[2 * apart + i]}, other = other_light(pixel, c, l);
		own[i] = max(max3(c[0], c[1], c[2]), other);
		lit[i] = max(exposed[i], other);
		bright[i] = 1;
	}
	if (lightens(p))
		lighten_row(p, n, tone, left);
	if (color_threshold > 0)
		for (int i = 0; i < n; i++) {
			float share = most_one(own[i] / color_threshold);
			bright[i] = lightens(p) ? 1 - (1 - share) * left[i] : share;
		}
	if (light_threshold > 0)
		for (int i = 0; i < n; i++)
			bright[i] = min(positive(lit[i] / light_threshold), bright[i]);
}

/* Pressure of the pencil, by the painted control. Returns whether it can reach the highest paper anywhere. */
static bool pressure_row(float amount, int n, const float *restrict controls, const float *restrict bright,
			 float *restrict pressure)
{
	for (int i = 0; i < n; i++)
		pressure[i] = controls ? (1 + controls[CONTROL_COUNT * i + CONTROL_HATCHING]) * amount : amount;
	int any = 0;
	for (int i = 0; i < n; i++)
		any |= pressure[i] > bright[i];
	return any;
}

/* bright becomes the pencil's cover. */
static void cover_row(int n, const float *restrict specular, const float *restrict depth,
		      const float *restrict pressure, const float *restrict paper, float *restrict bright)
{
	for (int i = 0; i < n; i++) {
		float t = 2.5f * (paper[i] * pressure[i] - bright[i]);
		bright[i] = depth_of(depth[i]) < INFINITY ? t : 0;
	}
	if (specular)
		for (int i = 0; i < n; i++)
			bright[i] *= 1 - clamp01(max3(specular[3 * i], specular[3 * i + 1], specular[3 * i + 2]));
	for (int i = 0; i < n; i++)
		bright[i] = clamp01(bright[i]);
}

static void draw_row(const float *pencil, int n, const float *restrict cover, float *restrict surface)
{
	float r = pencil[0], g = pencil[1], b = pencil[2];
	for (int i = 0; i < n; i++) {
		float alpha = surface[4 * i + 3], t = cover[i];
		surface[4 * i] = blend(surface[4 * i], bounded(r * alpha), t);
		surface[4 * i + 1] = blend(surface[4 * i + 1], bounded(g * alpha), t);
		surface[4 * i + 2] = blend(surface[4 * i + 2], bounded(b * alpha), t);
		surface[4 * i + 3] = alpha;
	}
}

/* ---- stage ----------------------------------------------------------------------------------------------- */

static const float *pixels(const frame *f, enum encre_layer layer, int channels, int y, int x)
{
	const float *row = layer_row(f, layer, y);
	return row ? row + (ptrdiff_t)channels * x : NULL;
}

bool ISA(hatch_cover)(const frame *f, const encre_params *p, int y, int x, int n, float *bright)
{
	float pressure[CHUNK], paper[CHUNK];
	if (!pressure_row(p->hatch_amount, n, controls_at(f, x, y), bright, pressure))
		return false;
	ISA(paper_row)(f, y, x, x + n, 0.5f, paper);
	cover_row(n, pixels(f, ENCRE_LAYER_SPECULAR, 3, y, x), pixels(f, ENCRE_LAYER_DEPTH, 1, y, x), pressure, paper,
		  bright);
	return true;
}

/* Where nothing was shaded just before. */
static void find_bright(const frame *f, const encre_params *p, int y, int x, int n, float *bright)
{
	float combined[4][CHUNK], color[3][CHUNK], diffuse[3][CHUNK], lit[CHUNK], tone[CHUNK];
	const float *controls = controls_at(f, x, y);
	metering m = metering_of(f, p);
	split_channels(pixels(f, ENCRE_LAYER_COMBINED, 4, y, x), 4, n, CHUNK, combined[0]);
	split_channels(pixels(f, ENCRE_LAYER_COLOR, 3, y, x), 3, n, CHUNK, color[0]);
	split_channels(pixels(f, ENCRE_LAYER_DIFFUSE, 3, y, x), 3, n, CHUNK, diffuse[0]);
	for (int i = 0; i < n; i++)
		lit[i] = exposed(m, max3(diffuse[0][i], diffuse[1][i], diffuse[2][i]));
	for (int i = 0; controls && i < n; i++)
		lit[i] += painted_light(controls, i);
	if (lightens(p))
		ISA(shade_tones)(f, y, x, x + n, tone);
	ISA(hatch_bright)(p, n, CHUNK, combined[0], color[0], diffuse[0], lit, tone, bright);
}

static void hatch_run(const frame *f, const encre_params *p, int y, int x, int n, int thread)
{
	float own[CHUNK], *bright = f->bright ? bright_row(f, y, thread) + x : own;
	if (!f->bright)
		find_bright(f, p, y, x, n, bright);
	fetch_ahead(f, thread);
	if (ISA(hatch_cover)(f, p, y, x, n, bright))
		draw_row(p->hatch_color, n, bright, output_row(f, ENCRE_OUTPUT_COMBINED, y) + 4 * (ptrdiff_t)x);
	fetch_ahead(f, thread);
}

static void hatch_rows(void *data, int y0, int y1, int thread)
{
	const frame *f = data;
	for (int y = y0; f->any.use_hatching && y < y1; y++)
		for (int x = 0, end; x < f->width; x = end) {
			const encre_params *p = style_run(f, y, x, f->width - x > PIECE ? x + PIECE : f->width, &end);
			if (p->use_hatching)
				hatch_run(f, p, y, x, end - x, thread);
		}
}

const stage STAGE_SYMBOL(hatch) = {.id = "hatch", .rows = hatch_rows};
