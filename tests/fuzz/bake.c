/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Random textures. */
#include "fuzz.h"

#include <string.h>

static int32_t run(encre_context *context, void *job)
{
	return encre_bake(context, job);
}

/* How long a step is: near to the identity, stretched, collapsed or nonsense. */
static void bend(const encre_image *form)
{
	bool wild = chance(0.3);
	for (int y = 0; y < form->height; y++)
		for (int x = 0; x < form->width; x++) {
			float *v = sample(form, x, y);
			double scale = wild ? magnitude(-20, 20) : magnitude(-1, 1);
			v[0] = (float)(scale * share());
			v[1] = (float)(scale * (share() - 0.5));
			v[2] = (float)(scale * share());
			if (wild && chance(0.05))
				v[whole(0, 2)] = weird();
		}
}

task random_bake(void)
{
	static encre_bake_job job;
	memset(&job, 0, sizeof job);
	task t = {.name = "bake",
		  .run = run,
		  .kind = ENCRE_BAKE,
		  .job = &job,
		  .progress = &job.progress,
		  .result = &job.nonfinite,
		  .result_size = sizeof job.nonfinite + sizeof job.greatest};
	int width = chance(0.3) ? whole(1, 5) : whole(1, 50), height = chance(0.3) ? whole(1, 5) : whole(1, 50);
	int channels = chance(0.98) ? whole(3, 4) : whole(1, 6);
	scene s = random_scene(width, height);
	job.texture = picture(width, height, channels, NULL);
	paint(&job.texture, COLORS, &s);
	if (chance(0.5)) {
		job.form = picture(width, height, 3, NULL);
		bend(&job.form);
	}
	if (chance(0.9))
		job.output = t.output[0] = picture(width, height, channels, NULL);
	t.n_outputs = 1;
	job.params = random_params(1);
	job.linear = whole(0, 1);
	job.wrap_x = chance(0.99) ? whole(0, 1) : weird_int();
	job.wrap_y = whole(0, 1);
	return t;
}
