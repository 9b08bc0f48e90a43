/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Places of spots: an endless set of points of the plane, nowhere in rows, told by hashes alone. Level k is a grid of
 * square cells of the area 2^-(k+1) whose points lie at least sqrt(2) sides apart. Those of a level are in all finer
 * ones, too. A point is born at a density: where so many points to the unit of area are wanted, all are there that are
 * born before. blue.c tells how they are found, blue_set.c keeps them. */
#ifndef ENCRE_BLUE_H
#define ENCRE_BLUE_H

#include "base/stage.h"

#include <stdatomic.h>

enum {
	BLUE_SIDE_BITS = 5,
	BLUE_SIDE = 1 << BLUE_SIDE_BITS, /* cells */
	BLUE_COARSEST = -26,
	BLUE_FINEST = 60,
	BLUE_TRIED = 5, /* places in a cell */
	BLUE_ROUNDS = 2,
	BLUE_MARGIN = 5, /* cells: what is farther from a tile than (2 * BLUE_ROUNDS - 1) sqrt(2) tells nothing of it */
	BLUE_ABOUT = BLUE_SIDE + 2 * BLUE_MARGIN,
	BLUE_OLD = BLUE_ABOUT + 4 /* what keeps others away, two cells farther */
};

/* Points to the unit of area that level 0 has. */
static const float blue_density = 0.5783f;

/* Cells of a level to the unit of length. */
static inline double blue_cells(int32_t level)
{
	int32_t twice = level + 1, half = twice >> 1;
	return (double)bits_float((half + 127) << 23) * (twice & 1 ? 1.4142135623730951 : 1);
}

/* Some of a level's cells, each with a point or none. */
typedef struct blue_tile {
	float birth[BLUE_SIDE * BLUE_SIDE]; /* a density; INFINITY: there is none */
	uint16_t x[BLUE_SIDE * BLUE_SIDE];  /* where it lies in its cell, of 65536 */
	uint16_t y[BLUE_SIDE * BLUE_SIDE];
	uint16_t name[BLUE_SIDE * BLUE_SIDE]; /* of a point in all levels */
} blue_tile;

/* Which: in tiles from the origin. */
typedef struct blue_key {
	int32_t level, x, y;
} blue_key;

/* In the making, of a thread. */
typedef struct blue_scratch {
	/* places that are tried, row by row of cells; then those that are not too near to a point, likewise */
	float x[BLUE_ABOUT * BLUE_ABOUT * BLUE_TRIED], y[BLUE_ABOUT * BLUE_ABOUT * BLUE_TRIED];
	uint32_t order[BLUE_ABOUT * BLUE_ABOUT * BLUE_TRIED];
	uint8_t state[BLUE_ABOUT * BLUE_ABOUT * BLUE_TRIED];
	int16_t first[BLUE_ABOUT * BLUE_ABOUT + 1]; /* of each cell's */
	float old_x[BLUE_OLD * BLUE_OLD], old_y[BLUE_OLD * BLUE_OLD], old_birth[BLUE_OLD * BLUE_OLD];
	uint16_t old_name[BLUE_OLD * BLUE_OLD];
} blue_scratch;

/* Tiles of the level above from `first` on, `wide` by `high`, are what a tile is told from. */
typedef struct blue_coarser {
	blue_key first;
	int wide, high;
} blue_coarser;

/* Tiles that are known, as a context keeps them: pure values, which are the same whenever they are found. */
typedef struct blue_set {
	uint64_t *key; /* 1 << bits, 0: free */
	const blue_tile **tile;
	int bits, count;
	struct blue_batch *batches;
} blue_set;

/* Tiles that pixels want, written by all threads: mask + 1 keys. */
typedef struct blue_wanted {
	_Atomic uint64_t *key;
	uint32_t mask;
} blue_wanted;

static inline uint64_t blue_name(blue_key k)
{
	const uint32_t most = 0xfffffff;
	return (uint64_t)(k.level + 64) << 56 | (uint64_t)((uint32_t)k.x & most) << 28 | ((uint32_t)k.y & most);
}

static inline blue_key blue_key_of(uint64_t name)
{
	return (blue_key){(int32_t)(name >> 56) - 64, (int32_t)((uint32_t)(name >> 28) << 4) >> 4,
			  (int32_t)((uint32_t)name << 4) >> 4};
}

static inline uint32_t blue_hash(uint64_t name)
{
	return mix_bits((uint32_t)name ^ mix_bits((uint32_t)(name >> 32)));
}

/* NULL: it is not there. */
static inline const blue_tile *blue_find(const blue_set *s, blue_key k)
{
	uint64_t name = blue_name(k);
	uint32_t mask = (1u << s->bits) - 1, i = blue_hash(name) & mask;
	while (s->key[i] && s->key[i] != name)
		i = (i + 1) & mask;
	return s->key[i] ? s->tile[i] : NULL;
}

/* blue_set.c: wants a tile, unless there is no room: what is not found now is wanted again; forgets all wishes. */
void blue_want(const blue_wanted *w, blue_key k);
void blue_want_none(const blue_wanted *w);
/* Frees all that is known; *set is NULL then. */
void blue_drop(void **set);
/* Likewise, but only if that is much. */
void blue_trim(void **set);
/* Where a tile of this key is to be written: NULL in it if it is new. Returns NULL without memory. */
const blue_tile **blue_slot(blue_set *s, uint64_t name);
/* `count` tiles to be filled, which belong to the set. NULL without memory. */
blue_tile *blue_more(blue_set *s, int count);

/* blue.c: finds all that pixels want, and keeps it in *f->kept_spots. */
int32_t ISA(blue_make)(frame *f, const blue_wanted *w);

#endif
