/* SPDX-License-Identifier: GPL-3.0-or-later */
/* How points of a tile are found. In each cell hashes try some places. Those too near to a point of the coarser level
 * are out. Of the rest, in each round, one whose hash is below that of all about it is taken, and these are out. After
 * a few rounds what is left is given up: so nothing depends on what is far away, and tiles can be told each by itself.
 * Within a level those in the widest gaps of the coarser one are born first. */
#include "tones/blue.h"

#include <stdlib.h>

enum { OPEN, OUT, TAKEN, KEPT };

static const float root = 1.41421356f;
static const float nowhere = 1e6f;
/* The share of a level's new points by how near they are to an old one, in even steps; measured. */
static const float born_before[33] = {
	0.00000f, 0.00108f, 0.00148f, 0.00201f, 0.00271f, 0.00367f, 0.00498f, 0.00666f, 0.00889f, 0.01182f, 0.01561f,
	0.02034f, 0.02617f, 0.03325f, 0.04195f, 0.05254f, 0.06516f, 0.08028f, 0.09807f, 0.11937f, 0.14428f, 0.17347f,
	0.20739f, 0.24673f, 0.29242f, 0.34513f, 0.40586f, 0.47563f, 0.55539f, 0.64644f, 0.75099f, 0.86854f, 1.00000f};

static blue_coarser coarser_of(blue_key key)
{
	const double half = 0.70710678118654752;
	blue_coarser c = {{key.level - 1, 0, 0}, 0, 0};
	int32_t from[2] = {key.x, key.y}, last[2];
	for (int k = 0; k < 2; k++) {
		double low = (double)from[k] * BLUE_SIDE - BLUE_MARGIN - 2, high = low + BLUE_OLD;
		from[k] = (int32_t)floor(floor(low * half) / BLUE_SIDE);
		last[k] = (int32_t)floor(floor(high * half) / BLUE_SIDE);
	}
	c.first.x = from[0];
	c.first.y = from[1];
	c.wide = last[0] - from[0] + 1;
	c.high = last[1] - from[1] + 1;
	return c;
}

static void try_places(blue_key key, blue_scratch *s)
{
	int32_t x0 = key.x * BLUE_SIDE - BLUE_MARGIN, y0 = key.y * BLUE_SIDE - BLUE_MARGIN;
	uint32_t level = mix_bits((uint32_t)key.level * 0x9e3779b9u + 0x51ed270bu);
	for (int v = 0; v < BLUE_ABOUT; v++) {
		uint32_t row = mix_bits(level + (uint32_t)(y0 + v));
		for (int i = 0; i < BLUE_ABOUT * BLUE_TRIED; i++) {
			int at = v * BLUE_ABOUT * BLUE_TRIED + i, column = i / BLUE_TRIED;
			uint32_t h = mix_bits(row + (uint32_t)x0 * BLUE_TRIED + (uint32_t)i);
			s->x[at] = (float)column + ((float)(int32_t)(h & 0xffff) + 0.5f) * 0x1p-16f;
			s->y[at] = (float)v + ((float)(int32_t)(h >> 16) + 0.5f) * 0x1p-16f;
			s->order[at] = mix_bits(h + 0x632be5abu);
			s->state[at] = OPEN;
		}
	}
	for (int i = 0; i <= BLUE_ABOUT * BLUE_ABOUT; i++)
		s->first[i] = (int16_t)(i * BLUE_TRIED);
}

/* Points of the coarser level in cells of this one. */
static void gather(blue_key key, const blue_tile *const *coarser, blue_scratch *s)
{
	const double grows = 1.4142135623730951;
	blue_coarser c = coarser_of(key);
	int64_t x0 = (int64_t)key.x * BLUE_SIDE - BLUE_MARGIN - 2, y0 = (int64_t)key.y * BLUE_SIDE - BLUE_MARGIN - 2;
	for (int i = 0; i < BLUE_OLD * BLUE_OLD; i++) {
		s->old_x[i] = s->old_y[i] = nowhere;
		s->old_birth[i] = INFINITY;
	}
	for (int k = 0; key.level > BLUE_COARSEST && k < c.wide * c.high; k++)
		for (int i = 0; i < BLUE_SIDE * BLUE_SIDE; i++) {
			const blue_tile *t = coarser[k];
			if (!(t->birth[i] < INFINITY))
				continue;
			double x = (double)((int64_t)(c.first.x + k % c.wide) * BLUE_SIDE + i % BLUE_SIDE) +
				   ((double)t->x[i] + 0.5) * 0x1p-16;
			int64_t row = (int64_t)(c.first.y + k / c.wide) * BLUE_SIDE + i / BLUE_SIDE;
			double y = (double)row + ((double)t->y[i] + 0.5) * 0x1p-16;
			x = x * grows - (double)x0;
			y = y * grows - (double)y0;
			int u = (int)floor(x), v = (int)floor(y);
			if (u < 0 || v < 0 || u >= BLUE_OLD || v >= BLUE_OLD)
				continue;
			/* as a tile will have it */
			int at = v * BLUE_OLD + u, fx = (int)((x - u) * 65536), fy = (int)((y - v) * 65536);
			s->old_x[at] = (float)(u - 2) + ((float)fx + 0.5f) * 0x1p-16f;
			s->old_y[at] = (float)(v - 2) + ((float)fy + 0.5f) * 0x1p-16f;
			s->old_birth[at] = t->birth[i];
			s->old_name[at] = t->name[i];
		}
}

/* Rows of cells about one, that are there. */
typedef struct about {
	int left, right, top, bottom;
} about;

static inline about about_of(int u, int v)
{
	return (about){u - 2 > 0 ? u - 2 : 0, u + 3 < BLUE_ABOUT ? u + 3 : BLUE_ABOUT, v - 2 > 0 ? v - 2 : 0,
		       v + 3 < BLUE_ABOUT ? v + 3 : BLUE_ABOUT};
}

/* Of the places in cells about one those that are too near to a point are out. */
static void put_out(blue_scratch *s, int u, int v, float x, float y)
{
	about a = about_of(u, v);
	for (int row = a.top; row < a.bottom; row++) {
		int end = s->first[row * BLUE_ABOUT + a.right];
		for (int i = s->first[row * BLUE_ABOUT + a.left]; i < end; i++) {
			float dx = s->x[i] - x, dy = s->y[i] - y;
			s->state[i] = s->state[i] == OPEN && dx * dx + dy * dy < 2 ? OUT : s->state[i];
		}
	}
}

/* Drops those that are out. */
static void sift(blue_scratch *s)
{
	int n = 0;
	for (int cell = 0; cell < BLUE_ABOUT * BLUE_ABOUT; cell++) {
		int from = s->first[cell];
		s->first[cell] = (int16_t)n;
		for (int i = from, end = s->first[cell + 1]; i < end; i++) {
			s->x[n] = s->x[i];
			s->y[n] = s->y[i];
			s->order[n] = s->order[i];
			s->state[n] = s->state[i];
			n += s->state[i] != OUT;
		}
	}
	s->first[BLUE_ABOUT * BLUE_ABOUT] = (int16_t)n;
}

static bool waits(const blue_scratch *s, int u, int v, int at)
{
	static const int rows[] = {0, -1, 1, -2, 2}; /* the nearest most likely have one */
	about a = about_of(u, v);
	float x = s->x[at], y = s->y[at];
	uint32_t order = s->order[at];
	for (int k = 0; k < 5; k++) {
		int row = v + rows[k];
		if (row < a.top || row >= a.bottom)
			continue;
		int end = s->first[row * BLUE_ABOUT + a.right];
		for (int i = s->first[row * BLUE_ABOUT + a.left]; i < end; i++) {
			float dx = s->x[i] - x, dy = s->y[i] - y;
			if (s->order[i] <= order && dx * dx + dy * dy < 2 && i != at)
				return true;
		}
	}
	return false;
}

/* Of a cell's places only the first can be taken: they are all too near to each other. */
static void take(blue_scratch *s)
{
	int taken[BLUE_ABOUT * BLUE_ABOUT], n = 0;
	for (int cell = 0; cell < BLUE_ABOUT * BLUE_ABOUT; cell++) {
		int from = s->first[cell], end = s->first[cell + 1], least = from;
		for (int at = from + 1; at < end; at++)
			least = s->order[at] < s->order[least] ? at : least;
		if (from < end && s->state[least] == OPEN && !waits(s, cell % BLUE_ABOUT, cell / BLUE_ABOUT, least))
			taken[n++] = cell, s->state[least] = TAKEN;
	}
	for (int k = 0; k < n; k++)
		for (int at = s->first[taken[k]]; at < s->first[taken[k] + 1]; at++)
			if (s->state[at] == TAKEN) {
				s->state[at] = KEPT;
				put_out(s, taken[k] % BLUE_ABOUT, taken[k] / BLUE_ABOUT, s->x[at], s->y[at]);
				break;
			}
	sift(s);
}

/* When a new point is born. */
static float birth_of(const blue_scratch *s, int32_t level, int u, int v, int at)
{
	float nearest = 1e9f, all = blue_density * bits_float((level + 127) << 23), x = s->x[at], y = s->y[at];
	if (level == BLUE_COARSEST) /* what is sparser yet is thrown at random */
		return all * ((float)(s->order[at] >> 8) + 0.5f) * 0x1p-24f;
	for (int row = v - 1; row < v + 6; row++)
		for (int i = row * BLUE_OLD + u - 1; i < row * BLUE_OLD + u + 6; i++) {
			float dx = s->old_x[i] - x, dy = s->old_y[i] - y;
			nearest = min(nearest, dx * dx + dy * dy);
		}
	const float widest = 2.24f;
	float near = clamp01((widest - sqrtf(nearest)) / (widest - root)) * 32;
	int i = (int)near < 31 ? (int)near : 31;
	return all * (0.5f + 0.5f * mix(born_before[i], born_before[i + 1], near - (float)i));
}

static void fill(blue_key key, const blue_tile *const *coarser, blue_scratch *s, blue_tile *tile)
{
	try_places(key, s);
	gather(key, coarser, s);
	for (int i = 0; i < BLUE_OLD * BLUE_OLD; i++)
		if (s->old_birth[i] < INFINITY)
			put_out(s, i % BLUE_OLD - 2, i / BLUE_OLD - 2, s->old_x[i], s->old_y[i]);
	sift(s);
	for (int k = 0; k < BLUE_ROUNDS; k++)
		take(s);
	for (int v = 0; v < BLUE_SIDE; v++)
		for (int u = 0; u < BLUE_SIDE; u++) {
			int to = v * BLUE_SIDE + u, a = u + BLUE_MARGIN, b = v + BLUE_MARGIN, cell = b * BLUE_ABOUT + a;
			int old = (b + 2) * BLUE_OLD + a + 2;
			float x = s->old_x[old], y = s->old_y[old], birth = s->old_birth[old];
			uint16_t name = s->old_name[old];
			for (int at = s->first[cell]; at < s->first[cell + 1]; at++)
				if (s->state[at] == KEPT) {
					x = s->x[at];
					y = s->y[at];
					name = (uint16_t)(s->order[at] & 0xffff);
					birth = birth_of(s, key.level, a, b, at);
				}
			bool any = birth < INFINITY;
			tile->birth[to] = birth;
			tile->name[to] = any ? name : 0;
			tile->x[to] = any ? (uint16_t)(int)((x - (float)a) * 65536) : 0;
			tile->y[to] = any ? (uint16_t)(int)((y - (float)b) * 65536) : 0;
		}
}

/* ---- all that pixels want ---------------------------------------------------------------------------------- */

enum { COARSER_MOST = 9 };

typedef struct work {
	const frame *f;
	blue_set *set;
	uint64_t *name; /* of the tiles that are new, from coarse ones to fine ones */
	blue_tile *tile;
	blue_scratch *scratch;
	int first; /* of a level */
} work;

static void fill_rows(void *data, int from, int to, int thread)
{
	const work *w = data;
	for (int i = w->first + from; i < w->first + to && !bands_stopped(w->f->bands); i++) {
		blue_key key = blue_key_of(w->name[i]);
		const blue_tile *coarser[COARSER_MOST];
		blue_coarser c = coarser_of(key);
		for (int k = 0; key.level > BLUE_COARSEST && k < c.wide * c.high; k++)
			coarser[k] = blue_find(
				w->set, (blue_key){c.first.level, c.first.x + k % c.wide, c.first.y + k / c.wide});
		fill(key, coarser, w->scratch + thread, w->tile + i);
	}
}

static int by_name(const void *a, const void *b)
{
	uint64_t x = *(const uint64_t *)a, y = *(const uint64_t *)b;
	return x < y ? -1 : x > y;
}

/* A list of names that grows. */
typedef struct names {
	uint64_t *at;
	int count, room;
} names;

/* Wants a tile that is not known. Returns false without memory. */
static bool add(frame *f, blue_set *s, uint64_t name, names *n)
{
	static const blue_tile unknown;
	const blue_tile **slot = blue_slot(s, name);
	if (!slot || *slot)
		return slot != NULL;
	if (n->count == n->room) {
		int room = n->room ? 2 * n->room : 1024;
		uint64_t *more = late_take(&f->late, (size_t)room, sizeof *more);
		if (!more)
			return false;
		if (n->count)
			memcpy(more, n->at, (size_t)n->count * sizeof *more);
		late_drop(&f->late, n->at);
		n->at = more;
		n->room = room;
	}
	*slot = &unknown;
	n->at[n->count++] = name;
	return true;
}

/* What pixels want, and what that is told from. */
static bool list(frame *f, const blue_wanted *w, blue_set *s, names *n)
{
	for (uint32_t i = 0; i <= w->mask; i++) {
		uint64_t name = atomic_load_explicit(w->key + i, memory_order_relaxed);
		if (name && !add(f, s, name, n))
			return false;
	}
	for (int i = 0; i < n->count; i++) {
		blue_key key = blue_key_of(n->at[i]);
		blue_coarser c = coarser_of(key);
		for (int k = 0; key.level > BLUE_COARSEST && k < c.wide * c.high; k++)
			if (!add(f, s,
				 blue_name((blue_key){c.first.level, c.first.x + k % c.wide, c.first.y + k / c.wide}),
				 n))
				return false;
	}
	return true;
}

static int32_t make(frame *f, const blue_wanted *wanted, blue_set *s)
{
	names n = {NULL, 0, 0};
	if (!list(f, wanted, s, &n))
		return ENCRE_ERROR_MEMORY;
	if (!n.count)
		return ENCRE_OK;
	qsort(n.at, (size_t)n.count, sizeof *n.at, by_name);
	work w = {f, s, n.at, blue_more(s, n.count), NULL, 0};
	w.scratch = late_take(&f->late, (size_t)bands_threads(f->bands), sizeof *w.scratch);
	if (!w.tile || !w.scratch)
		return ENCRE_ERROR_MEMORY;
	for (int i = 0; i < n.count; i++)
		*blue_slot(s, n.at[i]) = w.tile + i;
	int32_t code = ENCRE_OK;
	for (int end; !code && w.first < n.count; w.first = end) {
		for (end = w.first; end < n.count && n.at[end] >> 56 == n.at[w.first] >> 56;)
			end++;
		code = bands_run(f->bands, end - w.first, 2, fill_rows, &w);
	}
	late_drop(&f->late, w.scratch);
	late_drop(&f->late, n.at);
	return code;
}

int32_t ISA(blue_make)(frame *f, const blue_wanted *wanted)
{
	blue_set *s = *f->kept_spots ? *f->kept_spots : calloc(1, sizeof *s);
	*f->kept_spots = s;
	int32_t code = s ? make(f, wanted, s) : ENCRE_ERROR_MEMORY;
	if (code) /* some are not filled */
		blue_drop(f->kept_spots);
	return code;
}
