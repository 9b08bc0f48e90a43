/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The colors of areas: of each what a colorist would pick, and of these few. */
#include "flat/flat.h"

#include <stdlib.h>
#include <string.h>

enum { MOST_GROUPS = 512 };

static const float near = 0.03f;     /* colors that differ less are one */
static const float saturated = 8.0f; /* how much more strong colors count than greys */

typedef struct group {
	int32_t area, size;
	float place[3];
	double weight;
	int32_t into; /* itself, or which it is part of */
} group;

static float apart2_of(const float *a, const float *b)
{
	float l = a[0] - b[0], u = a[1] - b[1], v = a[2] - b[2];
	return l * l + u * u + v * v;
}

/* Of each texel: whether all about it is of its area, and so none of its color is of what is beside. */
static void find_inside(const flat *f, uint8_t *inside)
{
	for (int y = 0; y < f->height; y++)
		for (int x = 0; x < f->width; x++) {
			size_t i = (size_t)y * (size_t)f->width + (size_t)x;
			bool all = f->area[i] != FLAT_CLEAR;
			for (int k = 0; all && k < 9; k++)
				all = f->area[flat_index(f, x + k % 3 - 1, y + k / 3 - 1)] == f->area[i];
			inside[i] = all;
		}
}

/* The mean of an area's lighter half: with its painted shade it would be dull. What mixes with other areas at its
 * border does not count where there is something inside: a pupil would be as light as its rim. `lit`: by area, of
 * `fixed` and how many; `inside`: by texel. */
static void pick(const flat *f, int64_t (*lit)[4], uint8_t *inside, int64_t (*own)[2])
{
	size_t n = (size_t)f->width * (size_t)f->height;
	find_inside(f, inside);
	memset(lit, 0, n * sizeof *lit);
	memset(own, 0, n * sizeof *own);
	for (size_t i = 0; i < n; i++)
		if (inside[i]) {
			own[f->area[i]][0] += f->fixed[i][0];
			own[f->area[i]][1]++;
		}
	for (size_t i = 0; i < n; i++) {
		int32_t a = f->area[i];
		if (a == FLAT_CLEAR || (own[a][1] && !inside[i]))
			continue;
		int64_t size = own[a][1] ? own[a][1] : f->size[a], sum = own[a][1] ? own[a][0] : f->sum[a][0];
		if ((int64_t)f->fixed[i][0] * size < sum)
			continue;
		for (int c = 0; c < 3; c++)
			lit[a][c] += f->fixed[i][c];
		lit[a][3]++;
	}
	for (size_t a = 0; a < n; a++)
		for (int c = 0; f->size[a] && c < 3; c++)
			f->other[3 * a + (size_t)c] = (float)((double)lit[a][c] / (double)lit[a][3] / FLAT_UNIT);
}

static int by_size(const void *a, const void *b)
{
	const group *one = a, *two = b;
	if (one->size != two->size)
		return one->size < two->size ? 1 : -1;
	return one->area < two->area ? -1 : 1;
}

/* The nearest of the first n groups that are part of no other; -1: there is none. */
static int nearest(const group *g, int n, const float *place, float *apart2)
{
	int best = -1;
	for (int k = 0; k < n; k++) {
		float d = g[k].into == k ? apart2_of(g[k].place, place) : *apart2;
		if (d < *apart2) {
			*apart2 = d;
			best = k;
		}
	}
	return best;
}

/* Of two groups the larger keeps its color. */
static void merge(group *g, int a, int b)
{
	int from = g[a].size < g[b].size ? a : b, into = a + b - from;
	g[from].into = into;
	g[into].size += g[from].size;
	g[into].weight += g[from].weight;
}

static void make_few(group *g, int n, int most)
{
	int count = 0;
	for (int k = 0; k < n; k++) {
		float apart2 = near * near;
		int other = nearest(g, k, g[k].place, &apart2);
		if (other >= 0)
			merge(g, other, k);
		else
			count++;
	}
	for (; count > most; count--) {
		int pair[2] = {0, 0};
		double least = INFINITY;
		for (int a = 0; a < n; a++)
			for (int b = a + 1; g[a].into == a && b < n; b++) {
				if (g[b].into != b)
					continue;
				double loss = g[a].weight * g[b].weight / (g[a].weight + g[b].weight) *
					      (double)apart2_of(g[a].place, g[b].place);
				if (loss < least) {
					least = loss;
					pair[0] = a;
					pair[1] = b;
				}
			}
		merge(g, pair[0], pair[1]);
	}
}

static void choose(flat *f, group *g, int n)
{
	for (int k = 0; k < n; k++)
		if (g[k].into == k) {
			memcpy(f->place[f->n_colors], g[k].place, sizeof g[k].place);
			flat_to_linear(g[k].place, f->palette[f->n_colors]);
			f->map[g[k].area] = f->n_colors++;
		}
	for (int k = 0; k < n; k++) {
		int into = k;
		while (g[into].into != into)
			into = g[into].into;
		f->map[g[k].area] = f->map[g[into].area];
	}
}

int32_t flat_colors(flat *f, int most)
{
	size_t n = (size_t)f->width * (size_t)f->height;
	int64_t (*lit)[4] = malloc(n * sizeof *lit), (*own)[2] = malloc(n * sizeof *own);
	uint8_t *inside = calloc(n, 1);
	group *g = malloc(n * sizeof *g);
	int count = 0;
	int32_t code = lit && own && inside && g ? ENCRE_OK : ENCRE_ERROR_MEMORY;
	if (!code)
		pick(f, lit, inside, own);
	for (size_t a = 0; !code && a < n; a++) {
		if (!f->size[a])
			continue;
		const float *place = f->other + 3 * a;
		float chroma = sqrtf(place[1] * place[1] + place[2] * place[2]);
		g[count] = (group){.area = (int32_t)a, .size = f->size[a]};
		memcpy(g[count].place, place, sizeof g->place);
		g[count++].weight = (double)(sqrtf((float)f->size[a]) * (1 + saturated * chroma));
	}
	if (!code && count) {
		qsort(g, (size_t)count, sizeof *g, by_size);
		int some = count < MOST_GROUPS ? count : MOST_GROUPS;
		for (int k = 0; k < some; k++)
			g[k].into = k;
		make_few(g, some, most);
		choose(f, g, some);
		for (int k = some; k < count; k++) {
			float apart2 = INFINITY;
			f->map[g[k].area] = f->map[g[nearest(g, some, g[k].place, &apart2)].area];
		}
		for (size_t i = 0; i < n; i++)
			if (f->area[i] != FLAT_CLEAR)
				f->area[i] = f->map[f->area[i]];
	}
	free(g);
	free(inside);
	free(own);
	free(lit);
	return code;
}
