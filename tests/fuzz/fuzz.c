/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Runs random jobs until the time is over.
 *
 *     fuzz FIRST STEP SECONDS [COUNT]    seeds FIRST, FIRST + STEP, ...: until SECONDS have passed, or COUNT are done
 *
 * It says how many, and of each kind that was not to be cancelled a sum of hashes of what was drawn, in any order.
 * Sanitizers watch the library; here it is held to what encre.h says: nothing but outputs changes, and of those the
 * samples alone; outputs are written and finite; threads and instructions change no byte; progress never goes back; a
 * refusal is a sentence. Whatever fails ends the run and names the seed. */
#include "fuzz.h"

#include <float.h>
#include <inttypes.h>
#include <math.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

enum {
	MOST_BLOCKS = 1024,
	LONGEST = 120, /* seconds of a job: more is a hang */
	LEAST = 8      /* jobs, however busy the machine */
};

static uint64_t seed;

/* ---- chance ------------------------------------------------------------------------------------------------ */

static uint64_t state;

/* splitmix64 (Steele, Lea & Flood 2014) */
uint64_t bits(void)
{
	uint64_t z = state += 0x9e3779b97f4a7c15u;
	z = (z ^ z >> 30) * 0xbf58476d1ce4e5b9u;
	z = (z ^ z >> 27) * 0x94d049bb133111ebu;
	return z ^ z >> 31;
}

double share(void)
{
	return (double)(bits() >> 11) / 9007199254740992.0;
}

int whole(int low, int high)
{
	return low + (int)(bits() % ((uint64_t)((int64_t)high - low) + 1));
}

bool chance(double probability)
{
	return share() < probability;
}

double between(double low, double high)
{
	double at = share();
	return at < 0.1 ? low : at > 0.9 ? high : low + (high - low) * (at - 0.1) / 0.8;
}

double magnitude(int low, int high)
{
	double exponent = (low + (high - low) * share()) * 3.321928094887362;
	return ldexp(1 + share(), (int)floor(exponent)); /* exact: the same by every library of mathematics */
}

float weird(void)
{
	static const float values[] = {NAN,     INFINITY, -INFINITY, FLT_MAX,       -FLT_MAX, 1e38f,
				       -1e30f,  1e19f,    1e10f,     1e-20f,        FLT_MIN,  1e-40f,
				       -1e-45f, 0.0f,     -0.0f,     2147483648.0f, -3e9f,    65536.0f};
	return values[bits() % (sizeof values / sizeof *values)];
}

int32_t weird_int(void)
{
	static const int32_t values[] = {INT32_MIN, INT32_MAX, -1, 0, 1, 2, 7, 65535, 65536, 65537, 1 << 30};
	return values[bits() % (sizeof values / sizeof *values)];
}

/* ---- failing ----------------------------------------------------------------------------------------------- */

static void name_seed(void)
{
	fprintf(stderr, "fuzz: seed %" PRIu64 "\n", seed);
	fflush(stderr);
}

static void fail(const char *what)
{
	fprintf(stderr, "fuzz: seed %" PRIu64 ": %s\n", seed, what);
	abort();
}

static void hang(int number)
{
	(void)number;
	static const char text[] = "fuzz: a job does not end\n";
	(void)!write(2, text, sizeof text - 1);
	name_seed();
	_exit(1);
}

/* There where a sanitizer is. */
__attribute__((weak)) void __sanitizer_set_death_callback(void (*callback)(void));

/* ---- memory ------------------------------------------------------------------------------------------------ */

static struct block {
	unsigned char *now, *before;
	size_t size;
} block[MOST_BLOCKS];
static int n_blocks;

void *take(size_t size)
{
	if (n_blocks == MOST_BLOCKS)
		fail("the job has too many blocks of memory");
	struct block *b = block + n_blocks++;
	*b = (struct block){malloc(size), malloc(size), size};
	if (!b->now || !b->before)
		fail("no memory for the job");
	memset(b->now, 0x5a, size);
	return b->now;
}

static void remember(void)
{
	for (int i = 0; i < n_blocks; i++)
		memcpy(block[i].before, block[i].now, block[i].size);
}

static const float *sample_before(const float *at)
{
	for (int i = 0; i < n_blocks; i++)
		if ((uintptr_t)at - (uintptr_t)block[i].now < block[i].size)
			return (const float *)(block[i].before + ((uintptr_t)at - (uintptr_t)block[i].now));
	fail("an output lies nowhere");
	return NULL;
}

static void give_back(void)
{
	while (n_blocks > 0) {
		n_blocks--;
		free(block[n_blocks].now);
		free(block[n_blocks].before);
	}
}

/* ---- one job ----------------------------------------------------------------------------------------------- */

static double last;
static int calls, cancel_at;

static bool progress(void *user, double fraction)
{
	(void)user;
	if (!(fraction >= last && fraction <= 1))
		fail("progress goes back or beyond 1");
	last = fraction;
	return ++calls != cancel_at;
}

static uint64_t hashed(uint64_t hash, const void *data, size_t size)
{
	for (const unsigned char *c = data; size > 0; size--)
		hash = (hash ^ *c++) * 1099511628211u;
	return hash;
}

/* A hash of all samples of outputs, which become what they were before. */
static uint64_t take_outputs(const task *t, bool look)
{
	uint64_t hash = hashed(14695981039346656037u, t->result, t->result_size);
	for (int i = 0; i < t->n_outputs; i++) {
		const encre_image *image = t->output + i;
		size_t size = sizeof(float) * (size_t)image->channels;
		for (int y = 0; image->data && y < image->height; y++)
			for (int x = 0; x < image->width; x++) {
				float *at = sample(image, x, y);
				for (int c = 0; look && !t->any_number[i] && c < image->channels; c++)
					if (!isfinite(at[c]))
						fail("an output is not finite, or not written");
				hash = hashed(hash, at, size);
				memcpy(at, sample_before(at), size);
			}
	}
	for (int i = 0; i < n_blocks; i++)
		if (memcmp(block[i].now, block[i].before, block[i].size))
			fail("something else than outputs has changed");
	return hash;
}

/* The job on a thread of the library's, as the second of two steps the first of which it also is; as the only step if
 * it changes its output in place. `cancel`: after how many questions. */
static int32_t run_behind(encre_context *context, const task *t, int cancel)
{
	encre_step steps[] = {{t->kind, 0, t->job}, {t->kind, 0, t->job}};
	double before = 0, fraction;
	if (encre_start(context, steps, t->in_place ? 1 : 2))
		fail("work in the background is refused");
	if (!encre_start(context, steps, 1) || !encre_set_threads(context, 1))
		fail("a context that is at work takes other work");
	for (int asked = 1; encre_poll(context, &fraction) == ENCRE_RUNNING; asked++) {
		if (!(fraction >= before && fraction <= 1))
			fail("the fraction goes back or beyond 1");
		before = fraction;
		if (asked == cancel)
			encre_cancel(context);
		nanosleep(&(struct timespec){0, 20000}, NULL);
	}
	return chance(0.5) ? encre_wait(context) : encre_poll(context, NULL);
}

/* No number is what a job leaves where it forgets to write. */
static void spoil_outputs(const task *t)
{
	for (int i = 0; i < t->n_outputs; i++) {
		const encre_image *image = t->output + i;
		for (int y = 0; image->data && y < image->height; y++)
			for (int x = 0; x < image->width; x++)
				for (int c = 0; !t->any_number[i] && c < image->channels; c++)
					sample(image, x, y)[c] = NAN;
	}
}

static int32_t run_once(const task *t, int threads, int simd, bool behind, uint64_t *hash)
{
	encre_context *context = encre_create(ENCRE_API_VERSION);
	if (!context || encre_set_threads(context, threads) || encre_set_simd(context, simd))
		fail("there is no context");
	last = 0;
	calls = 0;
	int32_t code = behind ? run_behind(context, t, cancel_at) : t->run(context, t->job);
	const char *sentence = encre_error(context);
	if (code == ENCRE_OK ? *sentence != 0
			     : code == ENCRE_ERROR_ARGUMENT && (!strstr(sentence, ": ") || !strstr(sentence, "; ")))
		fail(*sentence ? sentence : "refused without a sentence");
	if (getenv("FUZZ_SHOW") && code)
		printf("%" PRIu64 ": %s\n", seed, sentence);
	*hash = take_outputs(t, code == ENCRE_OK);
	encre_destroy(context);
	return code;
}

static int32_t run_job(const task *t, uint64_t *hash)
{
	uint64_t two;
	int threads = whole(1, 3), simd = whole(0, 1);
	cancel_at = chance(0.05) ? whole(1, 40) : 0;
	bool behind = chance(0.2);
	*t->progress = !behind && (cancel_at || chance(0.3)) ? progress : NULL;
	spoil_outputs(t);
	remember();
	int32_t code = run_once(t, threads, simd, behind, hash);
	if (code == ENCRE_OK && !cancel_at && chance(0.2)) {
		*t->progress = NULL;
		if (run_once(t, 4 - threads, 1 - simd, chance(0.3), &two) != code || *hash != two)
			fail("threads or instructions have changed an output");
	}
	return code;
}

/* ---- all jobs ---------------------------------------------------------------------------------------------- */

enum { KINDS = 7, MOST_NAMES = 32, OF_TEN = 10, RENDERS = 5, RASTERS = 2 };

/* Sums of hashes by name; the names are literals and the library's own. */
static struct drawn {
	const char *name;
	uint64_t sum;
} drawn[MOST_NAMES];

static void add_drawn(const char *name, uint64_t hash)
{
	for (int i = 0; i < MOST_NAMES; i++)
		if (!drawn[i].name || !strcmp(drawn[i].name, name)) {
			drawn[i].name = name;
			drawn[i].sum += hash;
			return;
		}
	fail("more kinds of jobs than there is room for");
}

static int32_t run_seed(int *kind)
{
	uint64_t of_ten = seed % OF_TEN;
	state = seed * 0x2545f4914f6cdd1du;
	*kind = of_ten < RENDERS ? 0 : of_ten < RENDERS + RASTERS ? 1 : (int)of_ten + 2 - RENDERS - RASTERS;
	if (*kind == 2 && seed / OF_TEN % 2)
		*kind = chance(0.5) ? 5 : 6; /* each second time, as these are small */
	task t = *kind == 0   ? random_render(seed / OF_TEN * RENDERS + of_ten)
		 : *kind == 1 ? random_raster()
		 : *kind == 2 ? random_bake()
		 : *kind == 3 ? random_light()
		 : *kind == 4 ? random_material()
		 : *kind == 5 ? random_even()
			      : random_average();
	uint64_t hash;
	int32_t code = run_job(&t, &hash);
	if (!cancel_at)
		add_drawn(t.name, hash + (uint64_t)code);
	give_back();
	return code;
}

static double seconds(void)
{
	struct timespec now;
	clock_gettime(CLOCK_MONOTONIC, &now);
	return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

int main(int n, char **arguments)
{
	if (n < 4) {
		fprintf(stderr, "usage: fuzz FIRST STEP SECONDS [COUNT]\n");
		return 2;
	}
	uint64_t first = strtoull(arguments[1], NULL, 10), step = strtoull(arguments[2], NULL, 10),
		 most = n > 4 ? strtoull(arguments[4], NULL, 10) : UINT64_MAX, done = 0;
	double begin = seconds(), end = begin + strtod(arguments[3], NULL);
	static const char *const names[KINDS] = {"render", "raster", "bake", "light", "material", "even", "average"};
	unsigned long done_well[KINDS] = {0}, refused[KINDS] = {0}, cancelled = 0;
	signal(SIGALRM, hang);
	if (__sanitizer_set_death_callback)
		__sanitizer_set_death_callback(name_seed);
	for (seed = first; done < most && (done < LEAST || seconds() < end); seed += step, done++) {
		int kind;
		alarm(LONGEST);
		int32_t code = run_seed(&kind);
		done_well[kind] += code == ENCRE_OK;
		refused[kind] += code == ENCRE_ERROR_ARGUMENT || code == ENCRE_ERROR_MEMORY;
		cancelled += code == ENCRE_ERROR_CANCELLED;
	}
	printf("%" PRIu64 " jobs from seed %" PRIu64 " by %" PRIu64 " in %.1f s:", done, first, step,
	       seconds() - begin);
	for (int k = 0; k < KINDS; k++)
		printf(" %s %lu, refused %lu;", names[k], done_well[k], refused[k]);
	printf(" cancelled %lu; %" PRIu64 " pairs of parameters\n", cancelled, pair_count());
	for (int i = 0; i < MOST_NAMES && drawn[i].name; i++)
		printf("%s %016" PRIx64 "\n", drawn[i].name, drawn[i].sum);
	return 0;
}
