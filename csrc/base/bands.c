/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Bands of rows on a small pool of threads. Bands are handed out by an atomic counter, so who does which band varies,
 * but a kernel writes only the rows of its band: results do not. The calling thread works too, and it alone reports
 * progress, so that a callback may be any single-threaded code. */
#if defined __linux__
#define _GNU_SOURCE /* NOLINT(bugprone-reserved-identifier): its name; for processors that this process may have */
#endif
#include "base/bands.h"

#include <pthread.h>
#include <sched.h>
#include <stdatomic.h>
#include <stdlib.h>
#if !defined _WIN32
#include <unistd.h>
#endif

enum { LEAST_BANDS = 16 }; /* so that none is a twentieth of a frame */
/* Times that others get a turn before a thread sleeps. One job mostly follows another at once, and to wake up takes as
 * long as many jobs do. */
enum { TURNS = 64 };

typedef struct worker {
	bands *pool;
	pthread_t id;
	int number;
} worker;

struct bands {
	int threads; /* that work: the calling one and those started */
	pthread_mutex_t lock;
	pthread_cond_t start, done;
	atomic_uint round; /* grows with each job: a worker that has seen it has had it */
	atomic_int busy;
	bool quit;

	/* the job: */
	bands_kernel kernel;
	void *data;
	int height, band, whole, last, bands; /* so many whole bands, then smaller ones of so many rows */
	atomic_int next, finished;

	encre_progress call;
	void *user;
	double from, middle, to;
	atomic_bool cancelled;
	const atomic_bool *stop;

	worker workers[];
};

bool bands_stopped(const bands *pool)
{
	return atomic_load_explicit(&pool->cancelled, memory_order_relaxed) ||
	       (pool->stop && atomic_load_explicit(pool->stop, memory_order_relaxed));
}

/* The first row of a band. */
static int row_of(const bands *pool, int i)
{
	int whole = i < pool->whole ? i : pool->whole;
	int64_t y = (int64_t)whole * pool->band + (int64_t)(i - whole) * pool->last;
	return y < pool->height ? (int)y : pool->height;
}

static void work(bands *pool, int thread)
{
	int i;
	while ((i = atomic_fetch_add(&pool->next, 1)) < pool->bands) {
		int y0 = row_of(pool, i), y1 = row_of(pool, i + 1);
		if (!bands_stopped(pool))
			pool->kernel(pool->data, y0, y1, thread);
		int finished = atomic_fetch_add(&pool->finished, 1) + 1;
		if (thread == 0 && pool->call && !bands_stopped(pool)) {
			double share = (double)finished / pool->bands;
			if (!pool->call(pool->user, pool->from + (pool->middle - pool->from) * share))
				atomic_store(&pool->cancelled, true);
		}
	}
}

static void *worker_main(void *argument)
{
	worker *self = argument;
	bands *pool = self->pool;
	unsigned seen = 0;
	for (;;) {
		for (int k = 0; k < TURNS && atomic_load(&pool->round) == seen; k++)
			sched_yield();
		pthread_mutex_lock(&pool->lock);
		while (pool->round == seen && !pool->quit)
			pthread_cond_wait(&pool->start, &pool->lock);
		if (pool->quit)
			break;
		seen = pool->round;
		pthread_mutex_unlock(&pool->lock);
		work(pool, self->number);
		pthread_mutex_lock(&pool->lock);
		if (--pool->busy == 0)
			pthread_cond_signal(&pool->done);
		pthread_mutex_unlock(&pool->lock);
	}
	pthread_mutex_unlock(&pool->lock);
	return NULL;
}

int bands_processors(void)
{
#if defined _WIN32 /* its sysconf() is the threads' own library */
	return pthread_num_processors_np();
#else
#if defined __linux__ /* farms and containers give a process some of a machine's */
	cpu_set_t own;
	if (sched_getaffinity(0, sizeof own, &own) == 0)
		return CPU_COUNT(&own);
#endif
	return (int)sysconf(_SC_NPROCESSORS_ONLN);
#endif
}

bands *bands_create(int threads)
{
	bands *pool = calloc(1, sizeof *pool + (size_t)(threads - 1) * sizeof *pool->workers);
	if (!pool)
		return NULL;
	pthread_mutex_init(&pool->lock, NULL);
	pthread_cond_init(&pool->start, NULL);
	pthread_cond_init(&pool->done, NULL);
	pool->to = 1;
	for (pool->threads = 1; pool->threads < threads; pool->threads++) {
		worker *w = pool->workers + pool->threads - 1;
		*w = (worker){.pool = pool, .number = pool->threads};
		if (pthread_create(&w->id, NULL, worker_main, w))
			break;
	}
	return pool;
}

void bands_destroy(bands *pool)
{
	if (!pool)
		return;
	pthread_mutex_lock(&pool->lock);
	pool->quit = true;
	pthread_cond_broadcast(&pool->start);
	pthread_mutex_unlock(&pool->lock);
	for (int i = 0; i < pool->threads - 1; i++)
		pthread_join(pool->workers[i].id, NULL);
	pthread_cond_destroy(&pool->done);
	pthread_cond_destroy(&pool->start);
	pthread_mutex_destroy(&pool->lock);
	free(pool);
}

int bands_threads(const bands *pool)
{
	return pool->threads;
}

void bands_progress(bands *pool, encre_progress call, void *user, const atomic_bool *stop)
{
	pool->stop = stop;
	pool->call = call;
	pool->user = user;
	pool->from = 0;
	pool->to = 1;
	atomic_store(&pool->cancelled, false);
}

void bands_span(bands *pool, double from, double to)
{
	pool->from = from;
	pool->to = to;
}

int32_t bands_run(bands *pool, int height, int band, bands_kernel kernel, void *data)
{
	if (bands_stopped(pool))
		return ENCRE_ERROR_CANCELLED;
	if (height <= 0)
		return ENCRE_OK;
	bool even = band <= 0 && pool->threads > 1;
	if (band <= 0) { /* small enough to cancel soon, large enough to keep rows in cache */
		band = height / (pool->threads * 8 > LEAST_BANDS ? pool->threads * 8 : LEAST_BANDS);
		band = band < 8 ? 8 : band > 64 ? 64 : band;
	}
	int whole = height / band, last = band;
	if (even) { /* the last ones are smaller, or of 17 one thread had 9 and waited for it */
		whole = whole > pool->threads ? whole - pool->threads : 0;
		last = band / 4 > 8 ? band / 4 : 8;
	}
	pthread_mutex_lock(&pool->lock);
	pool->kernel = kernel;
	pool->data = data;
	pool->height = height;
	pool->band = band;
	/* how many runs a stage makes is not known here: each takes half of what is left of the stage's share */
	pool->middle = (pool->from + pool->to) / 2;
	pool->whole = whole;
	pool->last = last;
	pool->bands = whole + (height - whole * band + last - 1) / last;
	atomic_store(&pool->next, 0);
	atomic_store(&pool->finished, 0);
	if (pool->threads > 1 && pool->bands > 1) {
		pool->busy = pool->threads - 1;
		pool->round++;
		pthread_cond_broadcast(&pool->start);
	}
	pthread_mutex_unlock(&pool->lock);
	work(pool, 0);
	for (int k = 0; k < TURNS && atomic_load(&pool->busy); k++)
		sched_yield();
	pthread_mutex_lock(&pool->lock);
	while (pool->busy)
		pthread_cond_wait(&pool->done, &pool->lock);
	pthread_mutex_unlock(&pool->lock);
	pool->from = pool->middle;
	return bands_stopped(pool) ? ENCRE_ERROR_CANCELLED : ENCRE_OK;
}

int32_t bands_poll(bands *pool)
{
	if (pool->call && !bands_stopped(pool) && !pool->call(pool->user, pool->from))
		atomic_store(&pool->cancelled, true);
	return bands_stopped(pool) ? ENCRE_ERROR_CANCELLED : ENCRE_OK;
}
