/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The mean of each square of pixels: added row by row, in each from left to right, and then divided, so that the sums
 * of any part of a picture are those of the whole. */
#include "samples/average.h"
#include "base/stage.h"

typedef struct averaging {
	const encre_average_job *job; /* strides are filled in */
	bands *bands;
} averaging;

/* Called with constants, of which the compiler makes loops of their own. */
KERNEL void sum_pixel(const encre_average_job *j, const int channels, int x, int y, float share, float *restrict out)
{
	float sum[ENCRE_MAX_CHANNELS] = {0};
	for (int row = 0; row < j->factor; row++) {
		const char *in = (const char *)pixel_at(&j->large, x * j->factor, y * j->factor + row);
		for (int k = 0; k < j->factor; k++, in += j->large.pixel_stride)
			for (int c = 0; c < channels; c++)
				sum[c] += ((const float *)in)[c];
	}
	for (int c = 0; c < channels; c++)
		out[c] = sum[c] * share;
}

static void average_rows(void *data, int y0, int y1, int thread)
{
	(void)thread;
	const averaging *a = data;
	const encre_average_job *j = a->job;
	float share = (float)(1.0 / ((double)j->factor * j->factor));
	for (int y = y0; y < y1 && !bands_stopped(a->bands); y++)
		for (int x = 0; x < j->output.width; x++) {
			float *out = pixel_at(&j->output, x, y);
			switch (j->output.channels) {
			case 1: sum_pixel(j, 1, x, y, share, out); break;
			case 3: sum_pixel(j, 3, x, y, share, out); break;
			case 4: sum_pixel(j, 4, x, y, share, out); break;
			default: sum_pixel(j, j->output.channels, x, y, share, out);
			}
		}
}

int32_t average_run(bands *pool, const encre_average_job *job)
{
	averaging a = {job, pool};
	return bands_run(pool, job->output.height, 0, average_rows, &a);
}
