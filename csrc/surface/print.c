/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Print: the picture parted into a few inks, each a screen of dots at its own angle, one over the other on paper.
 * Where inks lie over each other light passes all of them (Yule and Clapper 1951, without scattering), so the share of
 * the paper that an ink covers is what is left to take away when the others have taken theirs. Dots grow into each
 * other as the level sets of two crossed waves do: round ones, at a half a chequerboard, then round holes. */
#include "base/pixel.h"
#include "base/stage.h"

enum { CHUNK = 256, INKS = 4, STEPS = 32 };

/* The level of the crossed waves above which so many 32nds of the paper lie: what spot() gives is spread so. */
static const float level_of_share[STEPS + 1] = {
	1.00000f,  0.92042f,  0.84085f,  0.76126f,  0.68170f,  0.60210f,  0.52254f,  0.44367f,  0.36940f,
	0.30137f,  0.23983f,  0.18456f,  0.13532f,  0.09189f,  0.05426f,  0.02284f,  0.00000f,  -0.02284f,
	-0.05426f, -0.09189f, -0.13532f, -0.18456f, -0.23983f, -0.30138f, -0.36940f, -0.44368f, -0.52254f,
	-0.60210f, -0.68170f, -0.76127f, -0.84085f, -0.92042f, -1.00000f,
};
/* Transmittances of the inks of four: cyan, magenta, yellow, black. */
static const float process[INKS][3] = {
	{0.02f, 0.40f, 0.78f}, {0.80f, 0.03f, 0.25f}, {1.00f, 0.84f, 0.03f}, {0.02f, 0.02f, 0.025f}};
static const float process_angle[INKS] = {15, 75, 0, 45}, duotone_angle[INKS] = {45, 75, 0, 0};

typedef struct inks {
	int n;
	float own[INKS][3], cosine[INKS], sine[INKS], pitch;
} inks;

static inks inks_of(const frame *f, const encre_params *p)
{
	bool four = p->print_inks == print_inks_FOUR;
	inks k = {.n = four ? INKS : 2, .pitch = max(p->print_pitch * f->scale, 2)};
	for (int i = 0; i < k.n; i++) {
		float angle = four ? process_angle[i] : duotone_angle[i], turn = angle * 0.0174532925f;
		const float *own = four ? process[i] : i ? p->print_light : p->print_dark;
		k.cosine[i] = pixel_cos(turn);
		k.sine[i] = pixel_sin(turn);
		for (int c = 0; c < 3; c++)
			k.own[i][c] = clamp01(own[c]);
	}
	return k;
}

/* ---- how much of the paper each ink covers ----------------------------------------------------------------- */

static inline float covers(float left, float own)
{
	return clamp01((1 - left) / max(1 - own, 0.01f));
}

static inline float passes(float share, float own)
{
	return max(1 - share * (1 - own), 1e-3f);
}

/* Of light 0..1 that the paper is to give back, in three colours. Each ink takes most of one; what it takes of the
 * others is taken off them, twice over. */
static inline void part_four(const float light[3], float black, const float (*own)[3], float share[INKS])
{
	float lack = 1 - max3(light[0], light[1], light[2]), key = black * lack * lack;
	float left[3];
	for (int c = 0; c < 3; c++) {
		left[c] = min(light[c] / passes(key, own[3][c]), 1);
		share[c] = 1 - left[c];
	}
	share[3] = key;
	for (int round = 0; round < 2; round++)
		for (int c = 0; c < 3; c++) {
			int d = (c + 1) % 3, e = (c + 2) % 3;
			share[c] = covers(left[c] / (passes(share[d], own[d][c]) * passes(share[e], own[e][c])),
					  own[c][c]);
		}
}

/* From white to black first the light ink grows until it is solid, then the dark one over it. The square root is near
 * how light a colour looks. */
static inline void part_two(const float light[3], float share[INKS])
{
	float seen = sqrtf(luminance(light[0], light[1], light[2]));
	share[0] = clamp01((0.55f - seen) * 2.0f);
	share[1] = clamp01((0.90f - seen) * 2.5f);
}

/* ---- dots -------------------------------------------------------------------------------------------------- */

/* A wave of two parabolas, 1 at whole numbers and -1 half-way; *rise: how fast it changes. */
static inline float wave(float u, float *rise)
{
	float from = u - nearest_int(u), far = fabsf(from), near = far < 0.25f ? far : 0.5f - far;
	*rise = 32 * near;
	return far < 0.25f ? 1 - 16 * near * near : 16 * near * near - 1;
}

static inline float level_at(float share)
{
	float at = clamp01(share) * STEPS;
	int k = (int)min(at, STEPS - 1);
	return mix(level_of_share[k], level_of_share[k + 1], at - (float)k);
}

/* How much of a pixel an ink covers. Coordinates are of the full frame. */
static inline float dot_at(const inks *k, int ink, float x, float y, float share, float least)
{
	float rise[2], u = (x * k->cosine[ink] - y * k->sine[ink]) / k->pitch,
		       v = (x * k->sine[ink] + y * k->cosine[ink]) / k->pitch;
	float height = 0.5f * (wave(u, rise) + wave(v, rise + 1));
	float steep = max(0.5f * sqrtf(rise[0] * rise[0] + rise[1] * rise[1]), 1) / k->pitch;
	float ink_here = clamp01(0.5f + (height - level_at(share)) / steep);
	return share <= least ? 0 : share >= 1 - least ? 1 : ink_here;
}

static void print_row(const frame *f, const encre_params *p, const inks *k, int y, int x, int n, float *restrict rgba)
{
	float down = (float)(f->place.y + y) + 0.5f;
	for (int i = 0; i < n; i++) {
		float *out = rgba + 4 * i, alpha = out[3], clear = alpha > 0 ? 1 / max(alpha, 1e-6f) : 0;
		float light[3], share[INKS], back[3], across = (float)(f->place.x + x + i) + 0.5f;
		for (int c = 0; c < 3; c++) {
			light[c] = clamp01(out[c] * clear);
			back[c] = p->print_paper[c];
		}
		if (k->n == INKS)
			part_four(light, p->print_black, k->own, share);
		else
			part_two(light, share);
		for (int j = 0; j < k->n; j++) {
			float ink = dot_at(k, j, across, down, share[j], p->print_least);
			for (int c = 0; c < 3; c++)
				back[c] *= 1 - ink * (1 - k->own[j][c]);
		}
		for (int c = 0; c < 3; c++)
			out[c] = bounded(back[c] * alpha);
	}
}

/* ---- stage ------------------------------------------------------------------------------------------------- */

static void print_rows(void *data, int y0, int y1, int thread)
{
	(void)thread;
	const frame *f = data;
	for (int y = y0; y < y1; y++)
		for (int x = 0, end; x < f->width; x = end) {
			const encre_params *p = style_run(f, y, x, f->width - x > CHUNK ? x + CHUNK : f->width, &end);
			if (!p->use_print)
				continue;
			inks k = inks_of(f, p);
			print_row(f, p, &k, y, x, end - x, output_row(f, ENCRE_OUTPUT_COMBINED, y) + (ptrdiff_t)4 * x);
		}
}

const stage STAGE_SYMBOL(print) = {.id = "print", .rows = print_rows};
