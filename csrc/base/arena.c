/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "base/arena.h"

#include <stdint.h>
#include <stdlib.h>

/* Under AddressSanitizer nobody may touch what lies between two blocks, or before the first and behind the last. */
#if defined __has_feature
#if __has_feature(address_sanitizer)
#define GUARDED
#endif
#elif defined __SANITIZE_ADDRESS__
#define GUARDED
#endif
#ifdef GUARDED
#include <sanitizer/asan_interface.h>
enum { GAP = 64 };
#else
enum { GAP = 0 };
#endif

static void guard(const char *from, const char *end)
{
#ifdef GUARDED
	__asan_poison_memory_region(from, (size_t)(end - from));
#endif
	(void)from, (void)end;
}

void *arena_take(arena *a, size_t count, size_t size)
{
	size_t bytes = count * size, at = a->used ? a->used : GAP;
	if ((size && count > SIZE_MAX / size) || bytes > SIZE_MAX - 63 - GAP ||
	    at > SIZE_MAX - GAP - ((bytes + 63) & ~(size_t)63)) {
		a->used = SIZE_MAX;
		return NULL;
	}
	a->used = at + ((bytes + 63) & ~(size_t)63) + GAP;
	if (!a->base)
		return NULL;
	guard(a->base + at - GAP, a->base + at);
	guard(a->base + at + bytes, a->base + a->used);
	return a->base + at;
}

void *arena_make(arena *a)
{
	char *memory = a->used <= SIZE_MAX - 64 ? malloc(a->used + 64) : NULL;
	*a = (arena){memory ? memory + (64 - (uintptr_t)memory % 64) : NULL, 0};
	return memory;
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
	char *place = place_in(head);
	guard((char *)(head + 1), place);
	guard(place + count * size, (char *)head + a.used + 64);
	return place;
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
