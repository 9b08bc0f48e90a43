/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Random light to be evened out, and large pictures to be averaged. */
#include "fuzz.h"

#include <string.h>

static int32_t run_even(encre_context *context, void *job)
{
	return encre_even(context, job);
}

static int32_t run_average(encre_context *context, void *job)
{
	return encre_average(context, job);
}

/* Light with noise of its own, and rather the same light without it. */
static void even_layers(encre_even_job *job, int width, int height)
{
	scene s = random_scene(width, height), smooth = s;
	shared beside = {0};
	smooth.noise = chance(0.7) ? 0 : s.noise;
	job->light = picture(width, height, 3, NULL);
	job->rendered = picture(width, height, 3, &beside);
	job->normal = picture(width, height, chance(0.98) ? 3 : whole(1, 4), &beside);
	job->depth = picture(width, chance(0.98) ? height : whole(1, height), 1, &beside);
	paint(&job->light, LIGHTS, &smooth);
	paint(&job->rendered, LIGHTS, &s);
	paint(&job->normal, DIRECTIONS, &s);
	paint(&job->depth, DEPTHS, &s);
	if (chance(0.8)) {
		job->object = picture(width, height, 1, &beside);
		paint(&job->object, NUMBERS, &s);
	}
}

task random_even(void)
{
	static encre_even_job job;
	memset(&job, 0, sizeof job);
	task t = {.name = "even", .run = run_even, .kind = ENCRE_EVEN, .job = &job, .progress = &job.progress};
	even_layers(&job, chance(0.3) ? whole(1, 5) : whole(1, 90), chance(0.3) ? whole(1, 5) : whole(1, 90));
	t.output[0] = job.light;
	t.in_place = true;
	t.any_number[0] = true; /* what was no number may stay none */
	t.n_outputs = 1;
	return t;
}

task random_average(void)
{
	static encre_average_job job;
	memset(&job, 0, sizeof job);
	task t = {.name = "average", .run = run_average, .kind = ENCRE_AVERAGE, .job = &job, .progress = &job.progress};
	int width = whole(1, 20), height = whole(1, 20), channels = whole(1, ENCRE_MAX_CHANNELS);
	job.factor = chance(0.98) ? whole(1, 8) : weird_int();
	int factor = job.factor >= 1 && job.factor <= 8 ? job.factor : 1;
	scene s = random_scene(width * factor, height * factor);
	job.large = picture(width * factor - (chance(0.02) && width * factor > 1), height * factor, channels, NULL);
	paint(&job.large, chance(0.5) ? LIGHTS : COLORS, &s);
	if (chance(0.98))
		job.output = t.output[0] = picture(width, height, channels, NULL);
	t.any_number[0] = true; /* the mean of what is no number is none */
	t.n_outputs = 1;
	return t;
}
