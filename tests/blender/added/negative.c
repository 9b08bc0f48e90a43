/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A stage as small as one can be, which test_added.py adds to a copy of the sources. */
#include "base/stage.h"

static void negative_rows(void *data, int y0, int y1, int thread)
{
	(void)thread;
	const frame *f = data;
	for (int y = y0; y < y1; y++) {
		const float *controls = controls_at(f, 0, y);
		for (int x = 0, end; x < f->width; x = end) {
			const encre_params *p = style_run(f, y, x, f->width, &end);
			for (int i = x; p->use_negative && i < end; i++) {
				float *c = f->output[ENCRE_OUTPUT_COMBINED].data +
					   y * f->output[ENCRE_OUTPUT_COMBINED].row + 4 * (ptrdiff_t)i;
				float painted =
					controls ? controls[(ptrdiff_t)CONTROL_COUNT * i + CONTROL_NEGATIVE] : 0;
				for (int k = 0; k < 3; k++)
					c[k] = mix(c[k], c[3] - c[k], clamp01((1 + painted) * p->negative_share));
			}
		}
	}
}

static int32_t run(frame *f)
{
	return f->any.use_negative ? bands_run(f->bands, f->height, 0, negative_rows, f) : ENCRE_OK;
}

const stage STAGE_SYMBOL(negative) = {.id = "negative", .run = run};
