/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Linked into a library for test_memory.py with -Wl,--wrap: the n-th allocation, or the n-th thread, is refused. */
#include <pthread.h>
#include <stdlib.h>

#define API __attribute__((visibility("default")))

/* Atomic: trees and contours are made by several threads, which allocate. */
API _Atomic int allocations, threads;     /* calls so far */
API int refuse_allocation, refuse_thread; /* which one to refuse, counted from 1; 0 = none */
API _Atomic int held;                     /* blocks that are not freed yet */

void *__real_malloc(size_t size);
void *__real_calloc(size_t count, size_t size);
void *__real_realloc(void *block, size_t size);
void __real_free(void *block);
int __real_pthread_create(pthread_t *id, const pthread_attr_t *how, void *(*run)(void *), void *data);

void *__wrap_malloc(size_t size)
{
	void *block = ++allocations == refuse_allocation ? NULL : __real_malloc(size);
	held += block != NULL;
	return block;
}

void *__wrap_calloc(size_t count, size_t size)
{
	void *block = ++allocations == refuse_allocation ? NULL : __real_calloc(count, size);
	held += block != NULL;
	return block;
}

void *__wrap_realloc(void *block, size_t size)
{
	void *grown = ++allocations == refuse_allocation ? NULL : __real_realloc(block, size);
	held += !block && grown;
	return grown;
}

void __wrap_free(void *block)
{
	held -= block != NULL;
	__real_free(block);
}

int __wrap_pthread_create(pthread_t *id, const pthread_attr_t *how, void *(*run)(void *), void *data)
{
	return ++threads == refuse_thread ? 11 : __real_pthread_create(id, how, run, data);
}
