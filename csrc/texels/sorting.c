/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Lines of a level by cells, in which faces look for them, and how far apart they are. */
#include "texels/texels.h"

#include "base/pixel.h"

#include <stdlib.h>

static void place_of_line(const texel_level *l, const texel_line *line, float at[2][2])
{
	for (int e = 0; e < 2; e++) {
		at[e][0] = l->point[line->point[e]][0] + (line->shift[e] & 1 ? (float)l->width : 0);
		at[e][1] = l->point[line->point[e]][1] + (line->shift[e] & 2 ? (float)l->height : 0);
	}
}

static void cells_of_line(const texel_level *l, const texel_line *line, int32_t low[2], int32_t high[2])
{
	float at[2][2];
	place_of_line(l, line, at);
	for (int k = 0; k < 2; k++) {
		int32_t n = k ? l->tall : l->across;
		low[k] = clamp_index((int)floorf(min(at[0][k], at[1][k]) / TEXEL_CELL), n);
		high[k] = clamp_index((int)floorf(max(at[0][k], at[1][k]) / TEXEL_CELL), n);
	}
}

/* How far lines are apart: by how much of them there is in cells that the image is shared out to. */
static bool find_crowds(texel_level *l)
{
	int32_t across = (l->width + TEXEL_CELL - 1) / TEXEL_CELL, tall = (l->height + TEXEL_CELL - 1) / TEXEL_CELL;
	float *sum = calloc((size_t)across * (size_t)tall + 1, sizeof *sum);
	for (int tell = 0; sum && tell < 2; tell++)
		for (int32_t i = 0; i < l->n_lines; i++) {
			float at[2][2];
			place_of_line(l, l->line + i, at);
			float x = at[1][0] - at[0][0], y = at[1][1] - at[0][1], length = sqrtf(x * x + y * y);
			int steps = (int)(length / TEXEL_CELL) + 1;
			for (int k = 0; k < steps; k++) {
				float t = ((float)k + 0.5f) / (float)steps;
				int32_t u = wrap_index((int)floorf(at[0][0] + t * x), l->width) / TEXEL_CELL,
					v = wrap_index((int)floorf(at[0][1] + t * y), l->height) / TEXEL_CELL;
				float *cell = sum + (size_t)v * (size_t)across + (size_t)u;
				int32_t wide = l->width - u * TEXEL_CELL, high = l->height - v * TEXEL_CELL;
				wide = wide < TEXEL_CELL ? wide : TEXEL_CELL;
				high = high < TEXEL_CELL ? high : TEXEL_CELL;
				if (!tell)
					*cell += length / (float)steps;
				else if (k == steps / 2)
					l->line[i].apart = (uint8_t)min(16 * (float)(wide * high) / max(*cell, 1), 255);
			}
		}
	free(sum);
	return sum != NULL;
}

bool texel_sort(texel_level *l)
{
	l->across = l->width / TEXEL_CELL + 1;
	l->tall = l->height / TEXEL_CELL + 1;
	size_t cells = (size_t)l->across * (size_t)l->tall;
	l->first = calloc(cells + 2, sizeof *l->first);
	int32_t low[2], high[2];
	int64_t all = 0;
	if (!l->first)
		return false;
	for (int32_t i = 0; i < l->n_lines; i++) {
		cells_of_line(l, l->line + i, low, high);
		for (int32_t v = low[1]; v <= high[1]; v++)
			for (int32_t u = low[0]; u <= high[0]; u++, all++)
				l->first[v * l->across + u + 2]++;
	}
	l->member = all < INT32_MAX ? malloc(((size_t)all + 1) * sizeof *l->member) : NULL;
	if (!l->member)
		return false;
	for (size_t k = 1; k <= cells; k++)
		l->first[k + 1] += l->first[k];
	for (int32_t i = 0; i < l->n_lines; i++) {
		cells_of_line(l, l->line + i, low, high);
		for (int32_t v = low[1]; v <= high[1]; v++)
			for (int32_t u = low[0]; u <= high[0]; u++)
				l->member[l->first[v * l->across + u + 1]++] = i;
	}
	return find_crowds(l);
}
