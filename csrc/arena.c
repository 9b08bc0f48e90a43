/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "stage.h"

void *arena_take(arena *a, size_t count, size_t size)
{
	size_t bytes = count * size;
	if ((size && count > SIZE_MAX / size) || bytes > SIZE_MAX - 63 || a->used > SIZE_MAX - ((bytes + 63) & ~(size_t)63)) {
		a->used = SIZE_MAX;
		return NULL;
	}
	size_t at = a->used;
	a->used += (bytes + 63) & ~(size_t)63;
	return a->base ? a->base + at : NULL;
}
