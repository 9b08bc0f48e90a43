/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Areas of an image that are to have one color: neighbours are joined, those first that differ least, as in
 * statistical region merging (Nock and Nielsen 2004). Where a color changes slowly, as in painted shade, areas grow
 * across it; where it jumps, only over what differs little. All is summed as whole numbers, so that nothing depends
 * on rounding. */
#include "flat/areas.h"

#include <stdlib.h>
#include <string.h>

static const double alike = 0.035; /* what differs less is one color */

/* Joins neighbours in the order of their differences. */
static bool grow(joining *j)
{
	flat *f = j->f;
	size_t n = (size_t)f->width * (size_t)f->height;
	size_t first[FLAT_STEPS + 1] = {0};
	uint32_t *order = malloc(2 * n * sizeof *order);
	if (!order)
		return false;
	for (int fill = 0; fill < 2; fill++) {
		for (size_t i = 0; i < n; i++)
			for (int way = 0; way < 2; way++) {
				int64_t other = beside(f, i, way);
				if (other < 0)
					continue;
				int step = step_of(f, i, (size_t)other);
				if (fill)
					order[first[step]++] = (uint32_t)(2 * i + (size_t)way);
				else
					first[step + 1]++;
			}
		if (!fill)
			for (int k = 0; k < FLAT_STEPS; k++)
				first[k + 1] += first[k];
	}
	for (size_t k = 0; k < first[FLAT_STEPS - 1]; k++) {
		size_t i = order[k] / 2, other = (size_t)beside(f, i, (int)(order[k] % 2));
		int32_t a = root(j->up, (int32_t)i), b = root(j->up, (int32_t)other);
		if (a == b)
			continue;
		if (apart2(f, a, b) < alike * alike)
			join(j, a, b);
	}
	free(order);
	return true;
}

/* Sums anew what `area` says. */
static void sum_up(flat *f)
{
	size_t n = (size_t)f->width * (size_t)f->height;
	memset(f->sum, 0, n * sizeof *f->sum);
	memset(f->size, 0, n * sizeof *f->size);
	for (size_t i = 0; i < n; i++)
		if (f->area[i] != FLAT_CLEAR) {
			f->size[f->area[i]]++;
			for (int c = 0; c < 3; c++)
				f->sum[f->area[i]][c] += f->fixed[i][c];
		}
}

static void name_areas(joining *j)
{
	flat *f = j->f;
	size_t n = (size_t)f->width * (size_t)f->height;
	for (size_t i = 0; i < n; i++)
		if (f->area[i] != FLAT_CLEAR)
			f->area[i] = root(j->up, f->area[i]);
}

typedef struct thinning {
	flat *f;
	const uint8_t *thick; /* by area */
	int32_t *to;          /* by texel */
} thinning;

/* What is mixed of the colors on both sides of a border is no color of its own. */
static void thin_rows(void *data, int y0, int y1, int thread)
{
	enum { FAR = 6 };
	static const int ways[4][2] = {{1, 0}, {0, 1}, {1, 1}, {1, -1}};
	(void)thread;
	const thinning *t = data;
	const flat *f = t->f;
	for (int y = y0; y < y1; y++)
		for (int x = 0; x < f->width; x++) {
			size_t i = (size_t)y * (size_t)f->width + (size_t)x;
			t->to[i] = f->area[i];
			if (f->area[i] == FLAT_CLEAR || t->thick[f->area[i]])
				continue;
			double best = 0;
			for (int k = 0; k < 4; k++) {
				int32_t side[2] = {FLAT_CLEAR, FLAT_CLEAR};
				for (int s = 0; s < 2; s++)
					for (int d = 1; d <= FAR && side[s] == FLAT_CLEAR; d++) {
						int by = s ? -d : d;
						int32_t at = f->area[flat_index(f, x + by * ways[k][0],
										y + by * ways[k][1])];
						side[s] = at != FLAT_CLEAR && t->thick[at] ? at : FLAT_CLEAR;
					}
				if (side[0] == side[1] || side[0] == FLAT_CLEAR || side[1] == FLAT_CLEAR)
					continue;
				double along = 0, off = 0, whole = apart2(f, side[0], side[1]) * FLAT_UNIT * FLAT_UNIT;
				for (int c = 0; c < 3; c++) {
					double a = (double)f->sum[side[0]][c] / f->size[side[0]],
					       b = (double)f->sum[side[1]][c] / f->size[side[1]];
					along += (f->fixed[i][c] - a) * (b - a);
					off += (f->fixed[i][c] - a) * (f->fixed[i][c] - a);
				}
				if (along < 0 || along > whole || off - along * along / whole > 0.06 * whole ||
				    whole <= best)
					continue;
				best = whole;
				t->to[i] = side[2 * along > whole];
			}
		}
}

static int32_t thin(flat *f, uint8_t *thick, int32_t *to)
{
	size_t n = (size_t)f->width * (size_t)f->height;
	enum { WIDE = 5 };
	int32_t *inside = to; /* until the other is filled */
	memset(inside, 0, n * sizeof *inside);
	for (int y = 0; y < f->height; y++)
		for (int x = 0; x < f->width; x++) {
			size_t i = (size_t)y * (size_t)f->width + (size_t)x;
			bool all = f->area[i] != FLAT_CLEAR;
			for (int k = 0; all && k < WIDE * WIDE; k++)
				all = f->area[flat_index(f, x + k % WIDE - WIDE / 2, y + k / WIDE - WIDE / 2)] ==
				      f->area[i];
			if (all)
				inside[f->area[i]]++;
		}
	for (size_t i = 0; i < n; i++)
		thick[i] = 8 * (int64_t)inside[i] > f->size[i];
	thinning t = {f, thick, to};
	int32_t code = bands_run(f->pool, f->height, 0, thin_rows, &t);
	if (!code) {
		memcpy(f->area, to, n * sizeof *to);
		sum_up(f);
	}
	return code;
}

int32_t flat_areas(flat *f)
{
	size_t n = (size_t)f->width * (size_t)f->height;
	joining j = {f, malloc(n * sizeof *j.up), malloc(n * sizeof *j.best), malloc(n * sizeof *j.least)};
	uint8_t *thick = malloc(n);
	int32_t code = j.up && j.best && j.least && thick ? ENCRE_OK : ENCRE_ERROR_MEMORY;
	for (size_t i = 0; !code && i < n; i++) {
		f->area[i] = f->area[i] == FLAT_CLEAR ? FLAT_CLEAR : (int32_t)i;
		f->size[i] = 1;
		j.up[i] = (int32_t)i;
		for (int c = 0; c < 3; c++)
			f->sum[i][c] = f->fixed[i][c];
	}
	if (!code && !grow(&j))
		code = ENCRE_ERROR_MEMORY;
	if (!code) {
		name_areas(&j);
		sum_up(f);
		code = thin(f, thick, j.best);
	}
	if (!code) {
		for (size_t i = 0; i < n; i++)
			j.up[i] = (int32_t)i;
		code = flat_join(&j) ? ENCRE_OK : ENCRE_ERROR_MEMORY;
	}
	if (!code)
		name_areas(&j);
	free(thick);
	free(j.least);
	free(j.best);
	free(j.up);
	return code;
}
