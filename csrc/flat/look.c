/* SPDX-License-Identifier: GPL-3.0-or-later */
/* How an image is looked at: in OKLab, at a size that is worth it, and without its grain. */
#include "flat/flat.h"

#include <string.h>

enum { ROUNDS = 4, RADIUS = 2 };

/* Beyond which colors of neighbours are not mixed, so that letters stay as sharp as they are. */
static const float reach = 0.11f;

void flat_texel(const encre_picture *t, size_t number, float out[4])
{
	if (t->texels) {
		for (int c = 0; c < 4; c++)
			out[c] = bounded(t->texels[4 * number + (size_t)c]);
		return;
	}
	const uint8_t *texel = t->bytes + 4 * number;
	for (int c = 0; c < 3; c++)
		out[c] = t->curve[texel[c]];
	out[3] = (float)texel[3] * (1 / 255.0f);
}

/* What hue counts at a lightness. Shade makes a color less, so that what is dark counts more: a dull blue is none of
 * the grays beside it. */
static inline float hue_at(float light)
{
	return flat_hue * 2 / (1 + positive(light));
}

void flat_from_linear(const float rgb[3], float out[3])
{
	float r = positive(rgb[0]), g = positive(rgb[1]), b = positive(rgb[2]);
	r = min(r, 1e4f);
	g = min(g, 1e4f);
	b = min(b, 1e4f);
	float l = pixel_cbrt(0.4122214708f * r + 0.5363325363f * g + 0.0514459929f * b);
	float m = pixel_cbrt(0.2119034982f * r + 0.6806995451f * g + 0.1073969566f * b);
	float s = pixel_cbrt(0.0883024619f * r + 0.2817188376f * g + 0.6299787005f * b);
	float light = 0.2104542553f * l + 0.7936177850f * m - 0.0040720468f * s, hue = hue_at(light);
	out[0] = flat_lightness * light;
	out[1] = hue * (1.9779984951f * l - 2.4285922050f * m + 0.4505937099f * s);
	out[2] = hue * (0.0259040371f * l + 0.7827717662f * m - 0.8086757660f * s);
}

static inline float cube(float x)
{
	return x * x * x;
}

void flat_to_linear(const float place[3], float rgb[3])
{
	float light = place[0] / flat_lightness, hue = hue_at(light), a = place[1] / hue, b = place[2] / hue;
	float l = cube(light + 0.3963377774f * a + 0.2158037573f * b);
	float m = cube(light - 0.1055613458f * a - 0.0638541728f * b);
	float s = cube(light - 0.0894841775f * a - 1.2914855480f * b);
	rgb[0] = positive(4.0767416621f * l - 3.3077115913f * m + 0.2309699292f * s);
	rgb[1] = positive(-1.2684380046f * l + 2.6097574011f * m - 0.3413193965f * s);
	rgb[2] = positive(-0.0041960863f * l - 0.7034186147f * m + 1.7076147010f * s);
}

static void look_rows(void *data, int y0, int y1, int thread)
{
	(void)thread;
	flat *f = data;
	const encre_picture *t = f->picture;
	for (int y = y0; y < y1; y++)
		for (int x = 0; x < f->width; x++) {
			float sum[4] = {0}, texel[4];
			for (int k = 0; k < f->factor; k++)
				for (int i = 0; i < f->factor; i++) {
					size_t factor = (size_t)f->factor, row = (size_t)y * factor + (size_t)k,
					       column = (size_t)x * factor + (size_t)i;
					flat_texel(t, row * (size_t)t->width + column, texel);
					for (int c = 0; c < 4; c++)
						sum[c] += texel[c];
				}
			size_t at = (size_t)y * (size_t)f->width + (size_t)x;
			float share = 1 / (float)(f->factor * f->factor);
			for (int c = 0; c < 4; c++)
				sum[c] *= share;
			flat_from_linear(sum, f->color + 3 * at);
			f->area[at] = sum[3] < 0.5f ? FLAT_CLEAR : 0;
		}
}

/* Adds a neighbour to each of n texels: in the sums of three channels and their weights. */
static void add_beside(int n, const float *const own[3], const float *const beside[3], const float *there,
		       float *restrict const sum[4])
{
	const float *restrict l = own[0], *restrict a = own[1], *restrict b = own[2];
	const float *restrict p = beside[0], *restrict q = beside[1], *restrict r = beside[2];
	float *restrict s = sum[0], *restrict t = sum[1], *restrict u = sum[2], *restrict whole = sum[3];
	for (int i = 0; i < n; i++) {
		float d = (p[i] - l[i]) * (p[i] - l[i]) + (q[i] - a[i]) * (q[i] - a[i]) + (r[i] - b[i]) * (r[i] - b[i]);
		float near = positive(1 - d * (1 / (reach * reach)));
		near = near * near * there[i];
		s[i] += near * p[i];
		t[i] += near * q[i];
		u[i] += near * r[i];
		whole[i] += near;
	}
}

/* Of each texel and its neighbours the mean, in which those count less whose colors differ more. */
static void smooth_rows(void *data, int y0, int y1, int thread)
{
	enum { RUN = 128, WIDE = RUN + 2 * RADIUS, TALL = 2 * RADIUS + 1 };
	(void)thread;
	flat *f = data;
	float rows[TALL][4][WIDE], sum[4][RUN];
	for (int x0 = 0; x0 < f->width; x0 += RUN) {
		int n = f->width - x0 < RUN ? f->width - x0 : RUN;
		for (int y = y0 - RADIUS; y < y1 + RADIUS; y++) { /* the last of TALL rows */
			float (*row)[WIDE] = rows[(y - y0 + RADIUS) % TALL];
			for (int i = 0; i < n + 2 * RADIUS; i++) {
				size_t at = flat_index(f, x0 + i - RADIUS, y);
				for (int c = 0; c < 3; c++)
					row[c][i] = f->color[3 * at + (size_t)c];
				row[3][i] = f->area[at] == FLAT_CLEAR ? 0 : 1;
			}
			int middle = y - RADIUS;
			if (middle < y0)
				continue;
			float (*own)[WIDE] = rows[(middle - y0 + RADIUS) % TALL];
			const float *here[3] = {own[0] + RADIUS, own[1] + RADIUS, own[2] + RADIUS};
			float *const to[4] = {sum[0], sum[1], sum[2], sum[3]};
			memset(sum, 0, sizeof sum);
			for (int v = 0; v < TALL; v++)
				for (int u = 0; u < TALL; u++) {
					float (*other)[WIDE] = rows[(middle - y0 + v) % TALL];
					const float *beside[3] = {other[0] + u, other[1] + u, other[2] + u};
					add_beside(n, here, beside, other[3] + u, to);
				}
			float *out = f->other + 3 * ((size_t)middle * (size_t)f->width + (size_t)x0);
			for (int i = 0; i < n; i++)
				for (int c = 0; c < 3; c++)
					out[3 * i + c] = sum[3][i] > 0 ? sum[c][i] / sum[3][i] : here[c][i];
		}
	}
}

typedef struct fixing {
	const flat *f;
	int32_t (*to)[3];
} fixing;

static void fix_rows(void *data, int y0, int y1, int thread)
{
	(void)thread;
	const fixing *x = data;
	const flat *f = x->f;
	for (size_t i = (size_t)y0 * (size_t)f->width; i < (size_t)y1 * (size_t)f->width; i++)
		for (int c = 0; c < 3; c++)
			x->to[i][c] = (int32_t)nearest_int(f->color[3 * i + (size_t)c] * FLAT_UNIT);
}

/* Whether most neighbours have the same color, but for what 8 bits and painted shade make them differ: there is no
 * grain to take away, and of what is hardly another color, as a nose or a mouth, nothing may go with it. */
static bool is_clean(const flat *f)
{
	enum { SAME = 24 /* of FLAT_UNIT */, PERCENT = 85 };
	int64_t pairs = 0, same = 0;
	for (int y = 0; y < f->height; y++)
		for (int x = 0; x + 1 < f->width; x++) {
			size_t i = (size_t)y * (size_t)f->width + (size_t)x;
			if (f->area[i] == FLAT_CLEAR || f->area[i + 1] == FLAT_CLEAR)
				continue;
			int32_t most = 0;
			for (int c = 0; c < 3; c++) {
				int32_t d = f->given[i][c] - f->given[i + 1][c];
				d = d < 0 ? -d : d;
				most = d > most ? d : most;
			}
			pairs++;
			same += most <= SAME;
		}
	return 100 * same > PERCENT * pairs;
}

int32_t flat_look(flat *f)
{
	fixing given = {f, f->given}, fixed = {f, f->fixed};
	int32_t code = bands_run(f->pool, f->height, 0, look_rows, f);
	if (!code)
		code = bands_run(f->pool, f->height, 0, fix_rows, &given);
	f->clean = !code && is_clean(f);
	for (int k = 0; !code && !f->clean && k < ROUNDS; k++) {
		code = bands_run(f->pool, f->height, 0, smooth_rows, f);
		float *was = f->color;
		f->color = f->other;
		f->other = was;
	}
	return code ? code : bands_run(f->pool, f->height, 0, fix_rows, &fixed);
}
