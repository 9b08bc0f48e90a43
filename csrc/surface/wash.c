/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Wash: colours as watercolour on paper. How dense the pigment lies changes a colour c to about c^density (Bousseau et
 * al. 2006): more in the paper's valleys, more along the border of an area that is darker than what lies beside it, and
 * unevenly over a wash (after Montesdeoca et al. 2017). Before that borders stray, and colour runs out of its area. All
 * is told from the place in the full frame and from whole numbers, so that bands and borders have the same bytes. */
#include "base/pixel.h"
#include "base/stage.h"

#include <string.h>

enum { CHUNK = 256, BAND_ROWS = 64, MOST_REACH = 128, KINDS = 2 /* of blurred colour */ };
enum { POOL, BLEED };

/* Blurred colours are whole numbers, so that sums that run along rows are exact wherever they begin. */
static const float unit = 16384, brightest = 3.999f;
/* Of the lattices of noise. */
static const float one_turn[2] = {0.8f, 0.6f}, other_turn[2] = {0.28f, -0.96f};

typedef struct wash {
	frame *f;
	int reach[KINDS];     /* 0: nobody asks for it */
	float *strayed;       /* the picture with borders that stray; NULL: they don't */
	uint16_t *row[KINDS]; /* width * height * 4: blurred along rows */
	uint16_t *line;       /* per thread, with room for `most` pixels on both sides */
	int32_t *sums[KINDS]; /* per thread: three rows of sums */
	int most;
} wash;

/* ---- noise ------------------------------------------------------------------------------------------------- */

/* The lattice's cell at a coordinate, and how far in it that is. */
static inline int32_t cell_of(float u, float *inside)
{
	int32_t cell = (int32_t)u;
	cell -= (float)cell > u;
	*inside = u - (float)cell;
	return cell;
}

static inline float eased(float t)
{
	return t * t * t * (t * (t * 6 - 15) + 10);
}

/* Value noise -1..1 of the full frame along part of a row, on a lattice that is turned: one along rows and columns
 * would show. turn: cosine and sine. */
static void noise_row(const frame *f, uint32_t seed, float length, const float turn[2], int y, int x, int n,
		      float *restrict noise)
{
	uint32_t key = mix_bits(seed + (uint32_t)f->params->wash_seed * 0x9e3779b9u);
	float s[CHUNK], t[CHUNK], down = (float)(f->place.y + y) + 0.5f, c = turn[0], d = turn[1];
	int32_t column[CHUNK], row[CHUNK], first = f->place.x + x;
	for (int i = 0; i < n; i++) {
		float across = (float)(first + i) + 0.5f;
		column[i] = cell_of((across * c + down * d) / length, s + i);
		row[i] = cell_of((down * c - across * d) / length, t + i);
		s[i] = eased(s[i]);
		t[i] = eased(t[i]);
	}
	for (int i = 0, end; i < n; i = end) {
		float corner[4];
		for (end = i + 1; end < n && column[end] == column[i] && row[end] == row[i];)
			end++;
		for (uint32_t k = 0; k < 4; k++) {
			uint32_t at =
				mix_bits(mix_bits(key + (uint32_t)column[i] + (k & 1)) + (uint32_t)row[i] + (k >> 1));
			corner[k] = (float)(at >> 8) * (2.0f / 16777216) - 1;
		}
		for (int k = i; k < end; k++)
			noise[k] = mix(mix(corner[0], corner[1], s[k]), mix(corner[2], corner[3], s[k]), t[k]);
	}
}

/* Two sizes of it. */
static void cloud_row(const frame *f, uint32_t seed, float length, float fine, int y, int x, int n,
		      float *restrict cloud)
{
	float more[CHUNK];
	noise_row(f, seed, max(length, 1), one_turn, y, x, n, cloud);
	noise_row(f, seed + 77, max(length * 0.37f, 1), other_turn, y, x, n, more);
	for (int i = 0; i < n; i++)
		cloud[i] = cloud[i] * (1 - fine) + more[i] * fine;
}

/* ---- borders that stray ------------------------------------------------------------------------------------ */

/* The picture at a place beside a pixel, whose own is whole, so that it is the same in any part of a frame. */
static void take(const frame *f, int x, int y, float along, float down, float out[4])
{
	float left = floorf(along), top = floorf(down), u = along - left, v = down - top;
	int ix = clamp_index(x + (int)left, f->width), jx = clamp_index(x + (int)left + 1, f->width);
	int iy = clamp_index(y + (int)top, f->height), jy = clamp_index(y + (int)top + 1, f->height);
	const float *a = output_row(f, ENCRE_OUTPUT_COMBINED, iy), *b = output_row(f, ENCRE_OUTPUT_COMBINED, jy);
	for (int c = 0; c < 4; c++)
		out[c] = blend(blend(a[4 * ix + c], a[4 * jx + c], u), blend(b[4 * ix + c], b[4 * jx + c], u), v);
}

static void stray_rows(void *data, int y0, int y1, int thread)
{
	(void)thread;
	const wash *w = data;
	const frame *f = w->f;
	for (int y = y0; y < y1 && !bands_stopped(f->bands); y++) {
		float *out = w->strayed + (ptrdiff_t)4 * f->width * y;
		for (int x = 0, end; x < f->width; x = end) {
			const encre_params *p = style_run(f, y, x, f->width - x > CHUNK ? x + CHUNK : f->width, &end);
			float far = p->use_wash ? p->wash_wobble * f->scale : 0, along[CHUNK], down[CHUNK];
			if (!(far > 0)) {
				memcpy(out + (ptrdiff_t)4 * x,
				       output_row(f, ENCRE_OUTPUT_COMBINED, y) + (ptrdiff_t)4 * x,
				       (size_t)(end - x) * 4 * sizeof *out);
				continue;
			}
			cloud_row(f, 1, 44 * f->scale, 0.3f, y, x, end - x, along);
			cloud_row(f, 2, 44 * f->scale, 0.3f, y, x, end - x, down);
			for (int i = x; i < end; i++)
				take(f, i, y, far * along[i - x], far * down[i - x], out + (ptrdiff_t)4 * i);
		}
	}
}

/* ---- blurred colours --------------------------------------------------------------------------------------- */

static const float *strayed_row(const wash *w, int y)
{
	return w->strayed ? w->strayed + (ptrdiff_t)4 * w->f->width * y : output_row(w->f, ENCRE_OUTPUT_COMBINED, y);
}

static void count_line(int n, const float *restrict rgba, uint16_t *restrict line)
{
	for (int i = 0; i < 4 * n; i++)
		line[i] = (uint16_t)(min(positive(rgba[i]), brightest) * unit + 0.5f);
}

/* A tent of `reach` pixels to either side, as sums that go on from pixel to pixel: the next has one more of each pixel
 * ahead, and one less of each behind. line has room before and after. */
static void tent_row(int n, int reach, const uint16_t *restrict line, uint16_t *restrict out)
{
	int32_t sum[4] = {0}, ahead[4] = {0}, behind[4] = {0};
	float share = 1 / (float)(reach * reach);
	for (int k = 1 - reach; k <= reach; k++)
		for (int c = 0; c < 4; c++) {
			int32_t v = line[4 * k + c];
			sum[c] += v * (reach - (k < 0 ? -k : k));
			ahead[c] += k > 0 ? v : 0;
			behind[c] += k > 0 ? 0 : v;
		}
	for (int x = 0; x < n; x++)
		for (int c = 0; c < 4; c++) {
			out[4 * x + c] = (uint16_t)((float)sum[c] * share + 0.5f);
			sum[c] += ahead[c] - behind[c];
			ahead[c] += line[4 * (x + reach + 1) + c] - line[4 * (x + 1) + c];
			behind[c] += line[4 * (x + 1) + c] - line[4 * (x - reach + 1) + c];
		}
}

static void blur_rows(void *data, int y0, int y1, int thread)
{
	const wash *w = data;
	int width = w->f->width, room = w->most + 1;
	uint16_t *line = w->line + (size_t)thread * 4 * (size_t)(width + 2 * room) + (ptrdiff_t)4 * room;
	for (int y = y0; y < y1 && !bands_stopped(w->f->bands); y++) {
		count_line(width, strayed_row(w, y), line);
		for (int k = 1; k <= room; k++) {
			memcpy(line - (ptrdiff_t)4 * k, line, 4 * sizeof *line);
			memcpy(line + (ptrdiff_t)4 * (width - 1 + k), line + (ptrdiff_t)4 * (width - 1),
			       4 * sizeof *line);
		}
		for (int k = 0; k < KINDS; k++)
			if (w->reach[k])
				tent_row(width, w->reach[k], line, w->row[k] + (ptrdiff_t)4 * width * y);
	}
}

static const uint16_t *blurred(const wash *w, int kind, int y)
{
	return w->row[kind] + (ptrdiff_t)4 * w->f->width * clamp_index(y, w->f->height);
}

/* The same sums down columns: those of row y. */
static void begin_sums(const wash *w, int kind, int y, int32_t *restrict sums)
{
	int n = 4 * w->f->width, reach = w->reach[kind];
	memset(sums, 0, (size_t)n * 3 * sizeof *sums);
	for (int k = 1 - reach; k <= reach; k++) {
		const uint16_t *restrict row = blurred(w, kind, y + k);
		int32_t weight = reach - (k < 0 ? -k : k), *restrict side = sums + (ptrdiff_t)n * (k > 0 ? 1 : 2);
		for (int i = 0; i < n; i++)
			sums[i] += row[i] * weight;
		for (int i = 0; i < n; i++)
			side[i] += row[i];
	}
}

static void next_sums(const wash *w, int kind, int y, int32_t *sums)
{
	int n = 4 * w->f->width, reach = w->reach[kind];
	const uint16_t *restrict last = blurred(w, kind, y + reach + 1), *restrict next = blurred(w, kind, y + 1),
				 *restrict first = blurred(w, kind, y - reach + 1);
	int32_t *restrict sum = sums, *restrict ahead = sums + n, *restrict behind = ahead + n;
	for (int i = 0; i < n; i++) {
		sum[i] += ahead[i] - behind[i];
		ahead[i] += last[i] - next[i];
		behind[i] += next[i] - first[i];
	}
}

/* ---- pigment ----------------------------------------------------------------------------------------------- */

/* How much denser pigment lies along the border of an area: where its colour is darker than its surroundings'. */
static void pool_row(float amount, float share, int n, const float *restrict rgba, const int32_t *restrict sum,
		     const float *restrict cloud, float *restrict density)
{
	for (int i = 0; i < n; i++) {
		float most = 0;
		for (int c = 0; c < 3; c++) {
			float around = (float)sum[4 * i + c] * share;
			float lacks = (around - min(positive(rgba[4 * i + c]), brightest)) / (around + 0.02f);
			most = max(most, lacks);
		}
		density[i] += amount * (2 + 1.2f * cloud[i]) * most;
	}
}

static void grain_row(float amount, int n, const float *restrict paper, float *restrict density)
{
	for (int i = 0; i < n; i++)
		density[i] += amount * clamp01(2.5f - 2.5f * paper[i]) * 2 - amount;
}

static void bleed_row(float amount, float share, int n, const float *restrict rgba, const int32_t *restrict sum,
		      const float *restrict cloud, float *restrict out)
{
	for (int i = 0; i < n; i++) {
		float wet = amount * clamp01(0.5f + cloud[i]);
		for (int c = 0; c < 4; c++)
			out[4 * i + c] = blend(rgba[4 * i + c], (float)sum[4 * i + c] * share, wet);
	}
}

/* c (1 - (1 - c) k) is about c^(1 + k), and c where there is no pigment. */
static void paint_row(const encre_params *p, int n, const float *restrict density, const float *restrict pigments,
		      float *restrict rgba)
{
	const float parts[3] = {-p->wash_pigments, 0, p->wash_pigments};
	for (int i = 0; i < n; i++) {
		float alpha = rgba[4 * i + 3], clear = alpha > 0 ? 1 / max(alpha, 1e-6f) : 0;
		for (int c = 0; c < 3; c++) {
			float value = rgba[4 * i + c], k = density[i] + parts[c] * pigments[i];
			k = max(min(k, 1), -1);
			value -= value * (1 - clamp01(value * clear)) * k;
			rgba[4 * i + c] = bounded(value + p->wash_dilution * positive(alpha - value));
		}
	}
}

static void wash_run(const wash *w, const encre_params *p, int32_t *const sums[KINDS], int y, int x, int n)
{
	const frame *f = w->f;
	float density[CHUNK], cloud[CHUNK], other[CHUNK], share[KINDS];
	const float *from = strayed_row(w, y) + (ptrdiff_t)4 * x;
	float *out = output_row(f, ENCRE_OUTPUT_COMBINED, y) + (ptrdiff_t)4 * x;
	float size = f->params->wash_size * f->scale;
	for (int k = 0; k < KINDS; k++)
		share[k] = w->reach[k] ? 1 / (unit * (float)(w->reach[k] * w->reach[k])) : 0;
	cloud_row(f, 3, size, 0.4f, y, x, n, cloud);
	for (int i = 0; i < n; i++)
		density[i] = p->wash_uneven * cloud[i];
	cloud_row(f, 4, 0.5f * size, 0.4f, y, x, n, other);
	if (w->reach[POOL] && p->wash_pooling > 0)
		pool_row(p->wash_pooling, share[POOL], n, from, sums[POOL] + (ptrdiff_t)4 * x, other, density);
	if (p->wash_granulation > 0) {
		float paper[CHUNK];
		ISA(paper_row)(f, y, x, x + n, 1, paper);
		if (f->paper)
			grain_row(p->wash_granulation, n, paper, density);
	}
	if (w->reach[BLEED] && p->wash_bleed > 0)
		bleed_row(p->wash_bleed, share[BLEED], n, from, sums[BLEED] + (ptrdiff_t)4 * x, other, out);
	else if (out != from)
		memcpy(out, from, (size_t)n * 4 * sizeof *out);
	noise_row(f, 5, max(0.7f * size, 1), other_turn, y, x, n, cloud);
	paint_row(p, n, density, cloud, out);
}

static void wash_rows(void *data, int y0, int y1, int thread)
{
	const wash *w = data;
	const frame *f = w->f;
	int32_t *sums[KINDS];
	for (int k = 0; k < KINDS; k++) {
		sums[k] = w->reach[k] ? w->sums[k] + (size_t)thread * 12 * (size_t)f->width : NULL;
		if (w->reach[k])
			begin_sums(w, k, y0, sums[k]);
	}
	for (int y = y0; y < y1 && !bands_stopped(f->bands); y++) {
		for (int x = 0, end; x < f->width; x = end) {
			const encre_params *p = style_run(f, y, x, f->width - x > CHUNK ? x + CHUNK : f->width, &end);
			if (p->use_wash)
				wash_run(w, p, sums, y, x, end - x);
		}
		for (int k = 0; k < KINDS; k++)
			if (w->reach[k])
				next_sums(w, k, y, sums[k]);
	}
}

/* ---- stage ------------------------------------------------------------------------------------------------- */

static bool wanted(const frame *f)
{
	return f->any.use_wash;
}

static int reach_of(const frame *f, float width)
{
	int reach = (int)min(width * f->scale + 0.5f, MOST_REACH);
	return reach > 1 ? reach : 0; /* of 1 it has the pixel alone */
}

static void plan(frame *f, arena *a)
{
	f->wash = NULL;
	if (!wanted(f))
		return;
	bool strays = false, pools = false, bleeds = false;
	for (int i = 0; i < f->n_styles; i++) {
		const encre_params *p = f->params + i;
		strays |= p->use_wash && p->wash_wobble > 0;
		pools |= p->use_wash && p->wash_pooling > 0;
		bleeds |= p->use_wash && p->wash_bleed > 0;
	}
	size_t width = (size_t)f->width, n = 4 * width * (size_t)f->height, threads = (size_t)bands_threads(f->bands);
	wash *w = arena_take(a, 1, sizeof *w), made = {.f = f};
	made.reach[POOL] = pools ? reach_of(f, f->params->wash_pool_width) : 0;
	made.reach[BLEED] = bleeds ? reach_of(f, f->params->wash_bleed_width) : 0;
	made.most = made.reach[POOL] > made.reach[BLEED] ? made.reach[POOL] : made.reach[BLEED];
	made.strayed = strays ? arena_take(a, n, sizeof *made.strayed) : NULL;
	made.line = arena_take(a, threads * (width + 2 * (size_t)made.most + 2), 4 * sizeof *made.line);
	for (int k = 0; k < KINDS; k++)
		if (made.reach[k]) {
			made.row[k] = arena_take(a, n, sizeof *made.row[k]);
			made.sums[k] = arena_take(a, threads * width, 12 * sizeof *made.sums[k]);
		}
	if (w)
		*w = made;
	f->wash = w;
}

static int32_t run(frame *f)
{
	wash *w = f->wash;
	if (!w)
		return ENCRE_OK;
	int32_t code = w->strayed ? bands_run(f->bands, f->height, 0, stray_rows, w) : ENCRE_OK;
	if (!code && w->most)
		code = bands_run(f->bands, f->height, 0, blur_rows, w);
	return code ? code : bands_run(f->bands, f->height, BAND_ROWS, wash_rows, w);
}

const stage STAGE_SYMBOL(wash) = {.id = "wash", .plan = plan, .run = run, .draws = wanted};
