/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Where the eye passes through or off the front surface, and how far what it sees there can be trusted. Layers of what
 * is seen are those of the surface itself elsewhere; where they differ ridges.c looks for lines in them. */
#include "fine/near.h"

#include <string.h>

/* In fine.more, until ridges.c marks its sites there. */
enum { OTHER_NORMAL = 1, OTHER_DEPTH = 2 };
enum { GROWN = 2 }; /* pixels that what is found grows by */
enum { WINDOW = 4, SIDE = 2 * WINDOW + 1 };

static const float other_normal = 0.1f,
		   other_depth = 0.02f; /* length; share of the depth, or of the frame's height; test_fine_sites */
/* Of a lamp, and of what is black, Cycles writes nothing: where they take part in a pixel the normal is the surface's
 * own, but shorter. Such a difference of colours tells them from a mirrored sky. */
static const float glow = 0.1f; /* test_fine_sites */
static const float stirred_from =
	0.06f; /* share of a step by which a pixel sticks out of its neighbours; test_fine_sites */
/* share of such pixels from which on no line is left, of depths fewer, and by how much less leaves all of it */
static const float most_stirred = 0.55f, most_of_depth = 0.5f, calm_ramp = 0.15f; /* test_fine_sites */
/* The same of pixels that stick out across the line: ripples show a thing again and again, one above the other. */
static const float most_rippled = 0.8f; /* test_fine_sites */

/* ---- where ----------------------------------------------------------------------------------------------- */

static void differ_rows(void *data, int y0, int y1, int thread)
{
	(void)thread;
	const fine *n = data;
	const frame *f = n->f;
	const float *v = f->camera.view, height = f->camera.height;
	bool deep = f->layer[ENCRE_LAYER_SEEN_DEPTH].data, ortho = n->e->ortho;
	for (int y = y0; y < y1; y++) {
		const float *z = layer_row(f, ENCRE_LAYER_DEPTH, y), *normal = layer_row(f, ENCRE_LAYER_NORMAL, y);
		const float *seen = layer_row(f, ENCRE_LAYER_SEEN_NORMAL, y);
		const float *color = layer_row(f, ENCRE_LAYER_SEEN_COLOR, y),
			    *albedo = layer_row(f, ENCRE_LAYER_ALBEDO, y);
		const float *far = deep ? layer_row(f, ENCRE_LAYER_SEEN_DEPTH, y) : z;
		uint16_t *restrict out = n->more + (ptrdiff_t)y * f->width;
		for (int x = 0; x < f->width; x++) {
			const float *a = normal + (ptrdiff_t)3 * x, *b = seen + (ptrdiff_t)3 * x;
			const float *c = color + (ptrdiff_t)3 * x, *d = albedo + (ptrdiff_t)3 * x;
			float turned[3], off = 0, tint = 0, along = 0, length = 0, rest = 0;
			for (int k = 0; k < 3; k++) {
				turned[k] = v[3 * k] * a[0] + v[3 * k + 1] * a[1] + v[3 * k + 2] * a[2];
				off += (b[k] - turned[k]) * (b[k] - turned[k]);
				tint += (clamp01(c[k]) - clamp01(d[k])) * (clamp01(c[k]) - clamp01(d[k]));
				along += b[k] * turned[k];
				length += turned[k] * turned[k];
			}
			float share = length > 0 ? clamp01(along / length) : 0;
			for (int k = 0; k < 3; k++)
				rest += (b[k] - share * turned[k]) * (b[k] - share * turned[k]);
			float front = depth_of(z[x]), gap = fabsf(far[x] - front), unit = ortho ? height : front;
			bool there = front < INFINITY;
			bool own = rest < other_normal * other_normal && tint < glow * glow;
			bool other = off > other_normal * other_normal;
			out[x] = (uint16_t)((there && !own && other ? OTHER_NORMAL : 0) |
					    (there && !(own && other) && far[x] > 0 && gap > other_depth * unit
						     ? OTHER_DEPTH
						     : 0));
		}
	}
}

/* Which pixels of a row a mirror begins at. Depth is of the pixel's centre and what is seen is averaged, so that they
 * differ along every outline, but nowhere in all of a 3x3. */
static void begin_row(const fine *n, int y, uint8_t *restrict out)
{
	int width = n->f->width;
	const uint16_t *row[3];
	for (int k = -1; k <= 1; k++)
		row[k + 1] = n->more + (ptrdiff_t)clamp_index(y + k, n->f->height) * width;
	for (int x = 0; x < width; x++)
		out[x] = (uint8_t)(row[0][x] & row[1][x] & row[2][x] & OTHER_DEPTH);
	for (int x = 0, before = out[0]; x < width; x++) {
		int own = out[x];
		out[x] = (uint8_t)((before & own & out[x + 1 < width ? x + 1 : x]) | (row[1][x] & OTHER_NORMAL));
		before = own;
	}
}

static void through_rows(void *data, int y0, int y1, int thread)
{
	const fine *n = data;
	int width = n->f->width;
	uint8_t *own = (uint8_t *)(n->scratch + thread * n->thread_scratch), *all = own + width + 2 * GROWN;
	for (int y = y0; y < y1; y++) {
		uint8_t *restrict out = n->through + (ptrdiff_t)y * width;
		memset(all, 0, (size_t)width + 2 * GROWN);
		for (int k = -GROWN; k <= GROWN; k++) {
			if (y + k < 0 || y + k >= n->f->height)
				continue;
			begin_row(n, y + k, own);
			for (int x = 0; x < width; x++)
				all[GROWN + x] |= own[x];
		}
		int any = 0;
		for (int x = 0; x < width; x++) {
			out[x] = all[x] | all[x + 1] | all[x + 2] | all[x + 3] | all[x + 4];
			any |= out[x];
		}
		n->glimpse[y] = (uint8_t)any;
	}
}

int32_t ISA(seen_run)(fine *n)
{
	int32_t code = bands_run(n->f->bands, n->f->height, 0, differ_rows, n);
	return code ? code : bands_run(n->f->bands, n->f->height, 0, through_rows, n);
}

/* ---- how clearly ----------------------------------------------------------------------------------------- */

/* A pixel's value, bounded and as differences of it look. */
static void read(const fine *n, int s, int x, int y, float *value)
{
	if (s == SAMPLE_SEEN_DEPTH) {
		value[0] = seen_sample(n->e, layer_row(n->f, ENCRE_LAYER_SEEN_DEPTH, y)[x]);
		value[1] = value[2] = 0;
		return;
	}
	bool color = s == SAMPLE_SEEN_COLOR;
	const float *in =
		layer_row(n->f, color ? ENCRE_LAYER_SEEN_COLOR : ENCRE_LAYER_SEEN_NORMAL, y) + (ptrdiff_t)3 * x;
	for (int c = 0; c < 3; c++)
		value[c] = color ? sqrtf(clamp01(in[c])) : bounded(in[c]);
}

/* However much there is to see about a line, many pixels are like the mean of their neighbours in the row or in the
 * column; in what is noisy few are. */
float ISA(seen_clarity)(const fine *n, const found *at, int s)
{
	enum { READ = SIDE + 2, MIDDLE = WINDOW + 1 };
	float value[READ][READ][3], step2 = 0;
	bool open[READ][READ];
	float most = s == SAMPLE_SEEN_DEPTH ? most_of_depth : most_stirred;
	int stirred = 0, rippled = 0, all = 0;
	for (int i = 0; i < READ; i++)
		for (int k = 0; k < READ; k++) {
			int x = at->column + k - MIDDLE, y = at->row + i - MIDDLE;
			open[i][k] = x >= 0 && y >= 0 && x < n->f->width && y < n->f->height && !closed_at(n, s, x, y);
			if (open[i][k])
				read(n, s, x, y, value[i][k]);
		}
	for (int k = 0; k < 3; k++) { /* of a stripe, that of one side; next to a crack, half of it */
		int dx = at->axis ? 0 : 1, dy = 1 - dx, one = k < 2 ? -1 : 0, two = k > 0;
		if (open[MIDDLE + one * dy][MIDDLE + one * dx] && open[MIDDLE + two * dy][MIDDLE + two * dx])
			step2 = max(step2, distance2(value[MIDDLE + one * dy][MIDDLE + one * dx],
						     value[MIDDLE + two * dy][MIDDLE + two * dx], 3));
	}
	for (int i = 1; i <= SIDE; i++)
		for (int k = 1; k <= SIDE; k++) {
			if (!(open[i][k] && open[i - 1][k] && open[i + 1][k] && open[i][k - 1] && open[i][k + 1]))
				continue;
			float row[3], column[3];
			for (int c = 0; c < 3; c++) {
				row[c] = 0.5f * (value[i][k - 1][c] + value[i][k + 1][c]);
				column[c] = 0.5f * (value[i - 1][k][c] + value[i + 1][k][c]);
			}
			float least2 = stirred_from * stirred_from * step2;
			bool off_row = distance2(row, value[i][k], 3) > least2;
			bool off_column = distance2(column, value[i][k], 3) > least2;
			stirred += off_row && off_column;
			rippled += at->axis ? off_column : off_row;
			all++;
		}
	if (!all)
		return 1;
	float calm = clamp01((most - (float)stirred / (float)all) / calm_ramp);
	return calm * clamp01((most_rippled - (float)rippled / (float)all) / calm_ramp);
}
