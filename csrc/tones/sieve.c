/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Spots of slanted surfaces. What is even on a thing is seen pressed together along one way, in rows. So there are more
 * of them there, and of those that come too near to each other on the screen the one that was born later gets smaller:
 * by degrees, so that nothing pops, and as births do not change, always the same one. */
#include "tones/strokes.h"

#include <stdlib.h>

enum { LINKS = 24 /* of a spot to earlier ones; more there hardly are */ };

static const float soft_from = 0.8f; /* of the distance from which on a spot takes from another */

typedef struct link {
	int32_t to;
	float takes; /* of what it lets the other be */
} link;

typedef struct thinning {
	const frame *f;
	const tone_marks *m;
	link *links; /* LINKS of each mark that is thinned; -1 ends them */
	int64_t *first;
} thinning;

static float object_of(const frame *f, int x, int y)
{
	const float *row = layer_row(f, ENCRE_LAYER_OBJECT, y);
	return row ? row[x] : 0;
}

static bool thinned(const tone_mark *k)
{
	return k->slot->kind == tone_1_STIPPLE && k->thinned > 0 && !k->other;
}

/* The first of the marks from..end - 1 of a row, which go by columns, that is not before a column. */
static int64_t first_from(const tone_mark *marks, int64_t from, int64_t end, int column)
{
	while (from < end) {
		int64_t half = from + (end - from) / 2;
		if (marks[half].column < column)
			from = half + 1;
		else
			end = half;
	}
	return from;
}

static void link_one(const thinning *t, int64_t i, int y, link *to)
{
	const tone_mark *marks = t->m->marks, *own = marks + i;
	int far = (int)own->within + 1, n = 0;
	float object = object_of(t->f, own->column, y), per = 1 / own->within;
	int last = y + far < t->f->height ? y + far : t->f->height - 1;
	for (int row = y > far ? y - far : 0; row <= last; row++) {
		int64_t end = t->m->first[row + 1];
		for (int64_t k = first_from(marks, t->m->first[row], end, own->column - far);
		     k < end && marks[k].column <= own->column + far; k++) {
			const tone_mark *there = marks + k;
			float dx = there->x - own->x, dy = there->y - own->y, away = sqrtf(dx * dx + dy * dy) * per;
			bool before = there->born < own->born || (there->born == own->born && k < i);
			if (!(away < 1) || !before || there->other || there->slot != own->slot || n == LINKS ||
			    object_of(t->f, there->column, row) != object)
				continue;
			to[n++] = (link){(int32_t)k, 1 - max(away - soft_from, 0) * (1 / (1 - soft_from))};
		}
	}
	if (n < LINKS)
		to[n].to = -1;
}

static void link_rows(void *data, int y0, int y1, int thread)
{
	(void)thread;
	const thinning *t = data;
	for (int y = y0; y < y1 && !bands_stopped(t->f->bands); y++)
		for (int64_t i = t->m->first[y], n = t->first[y]; i < t->m->first[y + 1]; i++)
			if (thinned(t->m->marks + i))
				link_one(t, i, y, t->links + LINKS * n++);
}

/* In the order of births, of equal ones in that of marks. */
typedef struct turn {
	float born;
	int64_t mark, links;
} turn;

static int by_birth(const void *a, const void *b)
{
	const turn *x = a, *y = b;
	if (x->born != y->born)
		return x->born < y->born ? -1 : 1;
	return x->mark < y->mark ? -1 : x->mark > y->mark;
}

int32_t ISA(tone_spots_thin)(frame *f, tone_marks *m)
{
	int64_t n = 0, end = m->first[f->height];
	if (end > INT32_MAX)
		return ENCRE_ERROR_MEMORY;
	thinning t = {f, m, NULL, late_take(&f->late, (size_t)f->height, sizeof *t.first)};
	for (int y = 0; t.first && y < f->height; y++) {
		t.first[y] = n;
		for (int64_t i = m->first[y]; i < m->first[y + 1]; i++)
			n += thinned(m->marks + i);
	}
	if (t.first && !n)
		return ENCRE_OK;
	t.links = late_take(&f->late, (size_t)n * LINKS, sizeof *t.links);
	turn *turns = late_take(&f->late, (size_t)n, sizeof *turns);
	if (!t.first || !t.links || !turns)
		return ENCRE_ERROR_MEMORY;
	int32_t code = bands_run(f->bands, f->height, 0, link_rows, &t);
	if (code)
		return code;
	n = 0;
	for (int64_t i = 0; i < end; i++)
		if (thinned(m->marks + i)) {
			turns[n] = (turn){m->marks[i].born, i, n};
			n++;
		}
	qsort(turns, (size_t)n, sizeof *turns, by_birth);
	for (int64_t k = 0; k < n; k++) {
		tone_mark *own = m->marks + turns[k].mark;
		const link *links = t.links + LINKS * turns[k].links;
		float left = 1;
		for (int j = 0; j < LINKS && links[j].to >= 0; j++)
			left *= 1 - m->marks[links[j].to].weight * links[j].takes;
		own->weight = mix(1, left, own->thinned);
		own->size *= sqrtf(own->weight);
	}
	late_drop(&f->late, t.links);
	late_drop(&f->late, turns);
	late_drop(&f->late, t.first);
	return ENCRE_OK;
}
