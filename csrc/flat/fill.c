/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The image with flat colors. Texels at a border are mixed of the two colors as they were before. */
#include "flat/flat.h"

#include <stdlib.h>
#include <string.h>

enum { BESIDE = 9, CODES = 256 };

static const float slight = 1e-5f; /* squared: no difference that is seen */

typedef struct filling {
	flat *f;
	uint8_t *bytes;
	float *texels;
	float middles[CODES - 1];
} filling;

static uint8_t code_of(const float middles[CODES - 1], float light)
{
	int code = 0;
	for (int step = CODES / 2; step; step /= 2)
		code += middles[code + step - 1] < light ? step : 0;
	return (uint8_t)code;
}

static float apart2_of(const float *a, const float *b)
{
	float l = a[0] - b[0], u = a[1] - b[1], v = a[2] - b[2];
	return l * l + u * u + v * v;
}

/* The colors at and about a place: the own one first, each once. */
static int about(const flat *f, int x, int y, int32_t some[BESIDE])
{
	int n = 0;
	for (int k = 0; k < BESIDE; k++) {
		int cell = k == 0 ? 4 : k <= 4 ? k - 1 : k;
		int32_t color = f->area[flat_index(f, x + cell % 3 - 1, y + cell / 3 - 1)];
		bool known = color == FLAT_CLEAR;
		for (int i = 0; i < n && !known; i++)
			known = some[i] == color;
		if (!known)
			some[n++] = color;
	}
	return n;
}

/* Of the colors `some` the two whose mixture is nearest to a place, and the share of the second; the first alone where
 * no mixture is much nearer. */
static float mixture(const flat *f, const int32_t *some, int n, const float place[3], int32_t two[2])
{
	float best = apart2_of(f->place[some[0]], place) - slight, share = 0;
	two[0] = two[1] = some[0];
	for (int a = 0; a < n; a++)
		for (int b = a + 1; b < n; b++) {
			const float *p = f->place[some[a]], *q = f->place[some[b]];
			float along = 0, whole = apart2_of(p, q);
			for (int c = 0; c < 3; c++)
				along += (place[c] - p[c]) * (q[c] - p[c]);
			float t = clamp01(whole > 0 ? along / whole : 0), off = 0;
			for (int c = 0; c < 3; c++) {
				float d = mix(p[c], q[c], t) - place[c];
				off += d * d;
			}
			if (off < best) {
				best = off;
				share = t;
				two[0] = some[a];
				two[1] = some[b];
			}
		}
	return share;
}

static void fill_rows(void *data, int y0, int y1, int thread)
{
	(void)thread;
	const filling *l = data;
	const flat *f = l->f;
	const encre_picture *t = f->picture;
	for (int y = y0; y < y1; y++)
		for (int x = 0; x < t->width; x++) {
			size_t at = (size_t)y * (size_t)t->width + (size_t)x;
			int u = clamp_index(x / f->factor, f->width), v = clamp_index(y / f->factor, f->height);
			int32_t some[BESIDE], two[2];
			if (f->area[flat_index(f, u, v)] == FLAT_CLEAR)
				continue;
			int n = about(f, u, v, some);
			float color[4], place[3], share = 0;
			two[0] = two[1] = some[0];
			if (n > 1) {
				flat_texel(t, at, color);
				flat_from_linear(color, place);
				share = mixture(f, some, n, place, two);
			}
			for (int c = 0; c < 3; c++) {
				float light = blend(f->palette[two[0]][c], f->palette[two[1]][c], share);
				if (l->bytes)
					l->bytes[4 * at + (size_t)c] = code_of(l->middles, light);
				else
					l->texels[4 * at + (size_t)c] = light;
			}
		}
}

int32_t flat_fill(flat *f, uint8_t *bytes, float *texels)
{
	filling l = {.f = f, .bytes = bytes, .texels = texels};
	for (int k = 0; bytes && k < CODES - 1; k++)
		l.middles[k] = 0.5f * f->picture->curve[k] + 0.5f * f->picture->curve[k + 1];
	return bands_run(f->pool, f->picture->height, 0, fill_rows, &l);
}

int32_t flat_run(bands *pool, const encre_picture *picture, int most, uint8_t *bytes, float *texels)
{
	flat f = {.picture = picture, .pool = pool, .wraps = picture->wrap == ENCRE_REPEAT};
	int size = picture->width > picture->height ? picture->width : picture->height;
	f.factor = (size + FLAT_MOST - 1) / FLAT_MOST;
	f.width = picture->width / f.factor > 0 ? picture->width / f.factor : 1;
	f.height = picture->height / f.factor > 0 ? picture->height / f.factor : 1;
	size_t n = (size_t)f.width * (size_t)f.height;
	float *colors[2] = {malloc(3 * n * sizeof **colors), malloc(3 * n * sizeof **colors)};
	f.color = colors[0];
	f.other = colors[1];
	f.fixed = malloc(n * sizeof *f.fixed);
	f.given = malloc(n * sizeof *f.given);
	f.area = malloc(n * sizeof *f.area);
	f.sum = malloc(n * sizeof *f.sum);
	f.size = malloc(n * sizeof *f.size);
	f.map = malloc(n * sizeof *f.map);
	f.palette = malloc((size_t)most * sizeof *f.palette);
	f.place = malloc((size_t)most * sizeof *f.place);
	bool made =
		f.color && f.other && f.fixed && f.given && f.area && f.sum && f.size && f.map && f.palette && f.place;
	int32_t code = made ? flat_look(&f) : ENCRE_ERROR_MEMORY;
	if (!code)
		code = flat_areas(&f);
	if (!code)
		code = flat_colors(&f, most);
	if (!code)
		code = flat_fill(&f, bytes, texels);
	void *all[] = {colors[0], colors[1], f.fixed, f.given, f.area, f.sum, f.size, f.map, f.palette, f.place};
	for (size_t k = 0; k < sizeof all / sizeof *all; k++)
		free(all[k]);
	return code;
}
