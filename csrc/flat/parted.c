/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What lies along the borders of areas decides which of them are one: where colors part slowly it is shade. */
#include "flat/areas.h"

#include <stdlib.h>

static const double soft = 0.05;      /* a border across which colors differ less, on the mean, is shade */
static const double jump = 0.012;     /* unless they differ by more than this between neighbours */
static const double shade = 0.2;      /* and if what it parts differs by no more than this */
static const double other_hue = 0.08; /* in a and b */
static const double crumb = 0.25;     /* what is tiny beside what is tiny is one, if it differs less */
static const double speck = 0.45;     /* of what is smaller, at FLAT_MOST texels:
					 size times the square of its contrast */
static const double dot = 0.06;       /* likewise in an image that is clean */

/* What two areas differ by across their border, on the mean over so many texels. */
typedef struct border {
	int32_t a, b, count;
	int64_t step;            /* summed */
	int64_t near[3], far[3]; /* likewise, from a to b, before the image was
				    smoothed: from how far on either side */
} border;

typedef struct borders {
	border *at;
	size_t count;
	int near, far; /* in texels, to the middle of a border */
} borders;

static int by_areas(const void *one, const void *two)
{
	const border *p = one, *q = two;
	if (p->a != q->a)
		return p->a < q->a ? -1 : 1;
	return p->b < q->b ? -1 : p->b > q->b;
}

static double mean_of(const border *b)
{
	return (double)b->step / b->count;
}

static int by_step(const void *one, const void *two)
{
	double p = mean_of(one), q = mean_of(two);
	return p < q ? -1 : p > q ? 1 : by_areas(one, two);
}

/* Makes one of all borders of the same areas, after these were joined to others. */
static void gather(borders *all, int32_t *up)
{
	size_t kept = 0;
	for (size_t k = 0; k < all->count; k++) {
		border own = all->at[k];
		int32_t a = root(up, own.a), b = root(up, own.b);
		if (a > b)
			for (int c = 0; c < 3; c++) {
				own.near[c] = -own.near[c];
				own.far[c] = -own.far[c];
			}
		own.a = a < b ? a : b;
		own.b = a < b ? b : a;
		if (a != b)
			all->at[kept++] = own;
	}
	all->count = kept;
	if (!kept)
		return;
	qsort(all->at, kept, sizeof *all->at, by_areas);
	size_t last = 0;
	for (size_t k = 1; k < kept; k++)
		if (!by_areas(all->at + last, all->at + k)) {
			all->at[last].count += all->at[k].count;
			all->at[last].step += all->at[k].step;
			for (int c = 0; c < 3; c++) {
				all->at[last].near[c] += all->at[k].near[c];
				all->at[last].far[c] += all->at[k].far[c];
			}
		} else {
			all->at[++last] = all->at[k];
		}
	all->count = last + 1;
}

/* From how far on both sides their colors are taken grows with the image. False without memory. */
static bool find_borders(const flat *f, borders *all)
{
	size_t n = (size_t)f->width * (size_t)f->height, count = 0;
	int size = f->width > f->height ? f->width : f->height;
	all->far = (2 * size + FLAT_MOST / 2) / FLAT_MOST + 1;
	all->near = all->far > 1;
	for (int fill = 0; fill < 2; fill++) {
		if (fill && !(all->at = malloc((count + 1) * sizeof *all->at)))
			return false;
		for (size_t i = 0; i < n; i++)
			for (int way = 0; way < 2; way++) {
				int64_t other = beside(f, i, way);
				if (other < (int64_t)i || f->area[i] == f->area[other]) /* not across the seam */
					continue;
				if (!fill) {
					count++;
					continue;
				}
				border own = {.a = f->area[i], .b = f->area[other], .count = 1};
				for (int k = 0; k < 2; k++) {
					int by = k ? all->far : all->near, x = (int)(i % (size_t)f->width),
					    y = (int)(i / (size_t)f->width);
					size_t low = flat_index(f, x - by * !way, y - by * way),
					       high = flat_index(f, x + (by + 1) * !way, y + (by + 1) * way);
					for (int c = 0; c < 3; c++)
						(k ? own.far : own.near)[c] = f->given[high][c] - f->given[low][c];
					own.step = step_of(f, low, high);
				}
				all->at[all->count++] = own;
			}
	}
	return true;
}

/* Whether two areas part at once, and not slowly: most of what is between them is between their nearest texels. */
static bool jumps(const borders *all, const border *b)
{
	double near = 0, far = 0, slow = (2 * all->near + 1) / (2.0 * all->far + 1);
	for (int c = 0; c < 3; c++) {
		near += (double)b->near[c] * (double)b->near[c];
		far += (double)b->far[c] * (double)b->far[c];
	}
	double least = jump * FLAT_UNIT * b->count, part = 0.5 * (1 + slow);
	return near > least * least && near > part * part * far;
}

/* Shade changes how light a color is, and little else. */
static bool is_shade(const flat *f, int32_t a, int32_t b)
{
	double hue = 0;
	for (int c = 1; c < 3; c++) {
		double d = (double)f->sum[a][c] / f->size[a] - (double)f->sum[b][c] / f->size[b];
		hue += d * d;
	}
	return hue < other_hue * other_hue * FLAT_UNIT * FLAT_UNIT && apart2(f, a, b) < shade * shade;
}

/* Joins areas between which colors change slowly. */
static void soften(joining *j, borders *all)
{
	enum { ROUNDS = 6 };
	for (int round = 0; round < ROUNDS; round++) {
		gather(all, j->up);
		if (!all->count)
			return;
		qsort(all->at, all->count, sizeof *all->at, by_step);
		double most = soft * FLAT_UNIT * (round + 1) / ROUNDS;
		for (size_t k = 0; k < all->count && mean_of(all->at + k) < most; k++) {
			int32_t a = root(j->up, all->at[k].a), b = root(j->up, all->at[k].b);
			if (a != b && !jumps(all, all->at + k) && is_shade(j->f, a, b))
				join(j, a, b);
		}
	}
}

/* How much speaks against joining two areas. */
typedef double (*against)(const flat *f, int32_t a, int32_t b);

/* Crumbs are joined with crumbs, of which photographs of grass are made: letters lie on something larger. */
static double of_crumbs(const flat *f, int32_t a, int32_t b)
{
	enum { MOST = 24, WHOLE = 256 };
	int size = f->width > f->height ? f->width : f->height;
	int most = size < WHOLE ? MOST * size * size / (WHOLE * WHOLE) : MOST;
	return f->size[a] < most && f->size[b] < most ? apart2(f, a, b) : INFINITY;
}

static double of_loss(const flat *f, int32_t a, int32_t b)
{
	return (double)f->size[a] * f->size[b] / ((double)f->size[a] + f->size[b]) * apart2(f, a, b);
}

/* Joins each area with the neighbour to which least speaks against it, if that is less than `most`. Whether it has
 * joined any. */
static bool join_nearest(joining *j, borders *all, against by, double most)
{
	flat *f = j->f;
	size_t n = (size_t)f->width * (size_t)f->height;
	bool any = false;
	gather(all, j->up);
	for (size_t i = 0; i < n; i++) {
		j->best[i] = -1;
		j->least[i] = most;
	}
	for (size_t k = 0; k < all->count; k++) {
		int32_t pair[2] = {all->at[k].a, all->at[k].b};
		double found = by(f, pair[0], pair[1]);
		for (int side = 0; side < 2; side++)
			if (found < j->least[pair[side]]) {
				j->least[pair[side]] = found;
				j->best[pair[side]] = pair[!side];
			}
	}
	for (size_t i = 0; i < n; i++) {
		if (j->best[i] < 0)
			continue;
		int32_t a = root(j->up, (int32_t)i), b = root(j->up, j->best[i]);
		if (a != b && by(f, a, b) < most) {
			join(j, a, b);
			any = true;
		}
	}
	return any;
}

/* Gives what is small, or hardly differs, to the neighbour that it differs from least. */
static void tidy(joining *j, borders *all)
{
	enum { ROUNDS = 12 };
	double size = j->f->width > j->f->height ? j->f->width : j->f->height;
	double most = (j->f->clean ? dot : speck) * (size / FLAT_MOST) * (size / FLAT_MOST);
	for (int round = 1; round <= ROUNDS; round++)
		join_nearest(j, all, of_loss, most * round / ROUNDS);
	while (join_nearest(j, all, of_loss, most))
		;
}

bool flat_join(joining *j)
{
	enum { CRUMBLING = 6 };
	borders all = {0};
	if (!find_borders(j->f, &all))
		return false;
	for (int round = 0; round < CRUMBLING; round++)
		join_nearest(j, &all, of_crumbs, crumb * crumb);
	soften(j, &all);
	tidy(j, &all);
	free(all.at);
	return true;
}
