/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "base/arena.h"

#include <stdint.h>

#include <stdlib.h>

void *arena_take(arena *a, size_t count, size_t size)
{
	size_t bytes = count * size;
	if ((size && count > SIZE_MAX / size) || bytes > SIZE_MAX - 63 ||
	    a->used > SIZE_MAX - ((bytes + 63) & ~(size_t)63)) {
		a->used = SIZE_MAX;
		return NULL;
	}
	size_t at = a->used;
	a->used += (bytes + 63) & ~(size_t)63;
	return a->base ? a->base + at : NULL;
}

/* What a block holds begins behind its head, at the second multiple of 64 from there. */
static void *place_in(late *head)
{
	return (char *)head + (128 - (uintptr_t)head % 64);
}

void *late_take(late **all, size_t count, size_t size)
{
	arena a = {0};
	arena_take(&a, 1, sizeof(late));
	arena_take(&a, count, size);
	late *head = a.used <= SIZE_MAX - 64 ? malloc(a.used + 64) : NULL;
	if (!head)
		return NULL;
	head->next = *all;
	*all = head;
	return place_in(head);
}

void late_drop(late **all, const void *taken)
{
	while (taken && *all && place_in(*all) != taken)
		all = &(*all)->next;
	late *found = taken ? *all : NULL;
	if (found) {
		*all = found->next;
		free(found);
	}
}

void late_free(late *all)
{
	while (all) {
		late *next = all->next;
		free(all);
		all = next;
	}
}
