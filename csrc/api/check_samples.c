/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What a caller may get wrong of light that is evened out, and of pictures that are averaged. */
#include "api/check.h"
#include "api/images.h"
#include "base/refuse.h"

int32_t check_even(const encre_even_job *job, encre_even_job *clean, char *error, size_t size)
{
	static const encre_layer_description what[] = {{"rendered", "", 3, 1},
						       {"normal", "", 3, 1},
						       {"depth", "", 1, 1},
						       {"object", "", 1, 0},
						       {"light", "", 3, 1}};
	const encre_image *images[] = {&job->rendered, &job->normal, &job->depth, &job->object, &job->light};
	*clean = *job;
	encre_image *clean_images[] = {&clean->rendered, &clean->normal, &clean->depth, &clean->object, &clean->light};
	return check_images(5, 4, what, images, clean_images, job->light.width, job->light.height, error, size);
}

int32_t check_average(const encre_average_job *job, encre_average_job *clean, char *error, size_t size)
{
	int32_t channels = job->large.channels;
	*clean = *job;
	if (job->factor < 1 || job->factor > MAX_SIZE)
		return refuse(error, size, "factor: is %d; give 1 to %d", (int)job->factor, MAX_SIZE);
	if (channels < 1 || channels > ENCRE_MAX_CHANNELS)
		return refuse(error, size, "large: has %d channels; give 1 to %d", (int)channels, ENCRE_MAX_CHANNELS);
	const encre_layer_description large = {"large", "", channels, 1}, output = {"output", "", channels, 1};
	const encre_image *images[] = {&job->large, &job->output};
	encre_image *clean_images[] = {&clean->large, &clean->output};
	int32_t code =
		check_images(1, 1, &large, images, clean_images, job->large.width, job->large.height, error, size);
	if (!code)
		code = check_images(1, 0, &output, images + 1, clean_images + 1, job->output.width, job->output.height,
				    error, size);
	if (code)
		return code;
	if ((int64_t)job->output.width * job->factor != job->large.width ||
	    (int64_t)job->output.height * job->factor != job->large.height)
		return refuse(error, size, "output: is %d x %d pixels; give one that is %d times smaller than %d x %d",
			      (int)job->output.width, (int)job->output.height, (int)job->factor, (int)job->large.width,
			      (int)job->large.height);
	return check_apart("output", &clean->output, "large", grid_of(&clean->large), error, size);
}
