/* SPDX-License-Identifier: GPL-3.0-or-later */
/* One allocation per frame, planned beforehand, and the few that only the frame's content can tell. */
#ifndef ENCRE_ARENA_H
#define ENCRE_ARENA_H

#include <stddef.h>
#include <stdint.h>

/* Planning runs twice with the same calls: first with base NULL, to measure, then with memory. */
typedef struct arena {
	char *base;
	size_t used;
} arena;

/* `count` items of `size` bytes, aligned to 64 bytes, not cleared; NULL while measuring. Sizes that overflow make
 * the sum stick at SIZE_MAX, which no allocation satisfies. */
void *arena_take(arena *a, size_t count, size_t size);
/* Memory for what was measured, in which `a` is to be planned now; for the caller to free. NULL without memory. */
void *arena_make(arena *a);

/* Memory that is held from one plan to the next: what is touched for the first time costs the system a page each time,
 * and in all as much as a third of a frame. */
typedef struct arena_held {
	void *memory;
	size_t size;
} arena_held;

/* As arena_make(), in what is held if that is large enough and not more than twice too large, else in its place. The
 * owner frees held.memory at last. */
void *arena_hold(arena *a, arena_held *held);
/* What is held, as it is, for the same plan again. */
void arena_again(arena *a, const arena_held *held);

/* What can't be planned, because only the frame's content tells how much it is: freed when the frame is done. Not to be
 * called from a kernel. */
typedef struct late late;
struct late {
	late *next;
};

/* NULL without memory; aligned to 64 bytes, not cleared. */
void *late_take(late **all, size_t count, size_t size);
/* An array from malloc() of n items of `size` bytes with room for one more: itself, or twice as large in its place.
 * NULL without memory, or at INT32_MAX items: it is as it was. */
void *with_room(void *array, size_t size, int64_t n, int64_t *room);
/* Gives back what late_take() gave, if anything. */
void late_drop(late **all, const void *taken);
void late_free(late *all);

#endif
