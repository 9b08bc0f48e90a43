/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What is asked of a piece of a mesh at a pixel, many at once: a band's triangles are gone through once, and each finds
 * what is asked of it. */
#ifndef ENCRE_ASKS_H
#define ENCRE_ASKS_H

#include <stdint.h>
#include <stdlib.h>

/* The first member of what else is known. `way`: the asker's number, by which equals are told apart. */
typedef struct ask {
	uint32_t piece, way;
	int y;
} ask;

static inline int ask_before(const void *a, const void *b)
{
	const ask *one = a, *other = b;
	if (one->piece != other->piece)
		return one->piece < other->piece ? -1 : 1;
	if (one->y != other->y)
		return one->y < other->y ? -1 : 1;
	return one->way < other->way ? -1 : one->way > other->way;
}

/* Of n things of a size, each of which begins with an ask. */
static inline void asks_sort(void *asks, uint32_t n, size_t size)
{
	qsort(asks, n, size, ask_before);
}

/* The first of those in order that is not before this piece and row; n: none. */
static inline uint32_t asks_first(const void *asks, uint32_t n, size_t size, uint32_t piece, int y)
{
	uint32_t low = 0;
	while (n > 0) {
		uint32_t half = n / 2;
		const ask *a = (const ask *)((const char *)asks + (low + half) * size);
		if (a->piece < piece || (a->piece == piece && a->y < y)) {
			low += half + 1;
			n -= half + 1;
		} else
			n = half;
	}
	return low;
}

#endif
