/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The tiles of points that are known, and those that are wanted. */
#include "tones/blue.h"

#include <stdlib.h>

enum { FIRST_BITS = 10, TRIES = 64, KEPT_MOST = 8192 /* tiles: 80 MiB */ };

typedef struct blue_batch blue_batch;
struct blue_batch {
	blue_batch *next;
	blue_tile tile[];
};

void blue_want(const blue_wanted *w, blue_key k)
{
	uint64_t name = blue_name(k);
	uint32_t i = blue_hash(name) & w->mask;
	for (int n = 0; n < TRIES; n++, i = (i + 1) & w->mask) {
		uint64_t there = atomic_load_explicit(w->key + i, memory_order_relaxed);
		if (there == name || (!there && atomic_compare_exchange_strong(w->key + i, &there, name)) ||
		    there == name)
			return;
	}
}

void blue_want_none(const blue_wanted *w)
{
	for (uint32_t i = 0; i <= w->mask; i++)
		atomic_store_explicit(w->key + i, 0, memory_order_relaxed);
}

void blue_drop(void **set)
{
	blue_set *s = *set;
	while (s && s->batches) {
		blue_batch *next = s->batches->next;
		free(s->batches);
		s->batches = next;
	}
	if (s) {
		free(s->key);
		free(s->tile);
	}
	free(s);
	*set = NULL;
}

void blue_trim(void **set)
{
	const blue_set *s = *set;
	if (s && s->count > KEPT_MOST)
		blue_drop(set);
}

static bool grow(blue_set *s)
{
	int bits = s->bits ? s->bits + 1 : FIRST_BITS;
	uint64_t *key = calloc((size_t)1 << bits, sizeof *key);
	const blue_tile **tile = calloc((size_t)1 << bits, sizeof *tile);
	if (!key || !tile) {
		free(key);
		free(tile);
		return false;
	}
	uint32_t mask = (1u << bits) - 1;
	for (uint32_t k = 0; s->bits && k < 1u << s->bits; k++) {
		uint32_t i = blue_hash(s->key[k]) & mask;
		while (s->key[k] && key[i])
			i = (i + 1) & mask;
		if (s->key[k]) {
			key[i] = s->key[k];
			tile[i] = s->tile[k];
		}
	}
	free(s->key);
	free(s->tile);
	s->key = key;
	s->tile = tile;
	s->bits = bits;
	return true;
}

const blue_tile **blue_slot(blue_set *s, uint64_t name)
{
	if ((!s->bits || s->count >= 1 << (s->bits - 1)) && !grow(s))
		return NULL;
	uint32_t mask = (1u << s->bits) - 1, i = blue_hash(name) & mask;
	while (s->key[i] && s->key[i] != name)
		i = (i + 1) & mask;
	s->count += !s->key[i];
	s->key[i] = name;
	return s->tile + i;
}

blue_tile *blue_more(blue_set *s, int count)
{
	blue_batch *b = malloc(sizeof *b + (size_t)count * sizeof *b->tile);
	if (!b)
		return NULL;
	b->next = s->batches;
	s->batches = b;
	return b->tile;
}
