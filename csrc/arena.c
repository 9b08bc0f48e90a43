/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "stage.h"

#include <stdlib.h>

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

void *late_take(late **all, size_t count, size_t size)
{
	arena a = {0};
	arena_take(&a, 1, sizeof(late));
	arena_take(&a, count, size);
	char *memory = a.used <= SIZE_MAX - 64 ? malloc(a.used + 64) : NULL;
	if (!memory)
		return NULL;
	late *head = (late *)(void *)memory;
	head->next = *all;
	*all = head;
	return memory + (128 - (uintptr_t)memory % 64);
}

void late_free(late *all)
{
	while (all) {
		late *next = all->next;
		free(all);
		all = next;
	}
}
