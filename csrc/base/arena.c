/* SPDX-License-Identifier: GPL-3.0-or-later */
#if defined __linux__
#define _DEFAULT_SOURCE /* madvise(); NOLINT(bugprone-reserved-identifier) */
#include <sys/mman.h>
#endif
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
enum { GAP = 64, FRESH = 1 };
#elif defined __has_feature
#if __has_feature(memory_sanitizer) /* it is to see what nobody has written since it was planned */
enum { GAP = 0, FRESH = 1 };
#else
enum { GAP = 0, FRESH = 0 };
#endif
#else
enum { GAP = 0, FRESH = 0 };
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

/* Asks the system for its large pages where a whole one fits: of small ones a frame has more than the processor keeps
 * the places of. It may refuse, and nothing but time depends on it. */
static void *with_large_pages(char *memory, size_t size)
{
#if defined __linux__ && defined MADV_HUGEPAGE
	enum { LARGE = 1 << 21 };
	uintptr_t from = ((uintptr_t)memory + LARGE - 1) & ~(uintptr_t)(LARGE - 1),
		  end = ((uintptr_t)memory + size) & ~(uintptr_t)(LARGE - 1);
	if (memory && from < end)
		madvise((void *)from, end - from, MADV_HUGEPAGE);
#else
	(void)size;
#endif
	return memory;
}

static void *begin_in(arena *a, char *memory)
{
	*a = (arena){memory ? memory + (64 - (uintptr_t)memory % 64) : NULL, 0};
	return memory;
}

void *arena_make(arena *a)
{
	size_t size = a->used <= SIZE_MAX - 64 ? a->used + 64 : 0;
	return begin_in(a, size ? with_large_pages(malloc(size), size) : NULL);
}

void *arena_hold(arena *a, arena_held *held)
{
	size_t size = a->used <= SIZE_MAX - 64 ? a->used + 64 : SIZE_MAX;
	if (FRESH || !held->memory || size > held->size || size < held->size / 2) {
		free(held->memory);
		*held = (arena_held){arena_make(a), size};
		return held->memory;
	}
	return begin_in(a, held->memory);
}

void arena_again(arena *a, const arena_held *held)
{
	begin_in(a, held->memory);
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

void *with_room(void *array, size_t size, int64_t n, int64_t *room)
{
	if (n < *room)
		return array;
	int64_t more = n < INT32_MAX / 2 ? 2 * n + 256 : INT32_MAX;
	void *moved = n < more && (uint64_t)more < SIZE_MAX / size ? realloc(array, (size_t)more * size) : NULL;
	if (moved)
		*room = more;
	return moved;
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
