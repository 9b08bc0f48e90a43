/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The sheet under the picture, which Vainumäe's framework has (2020, 2.3): its slopes by light from the upper left, and
 * its colour, which transparent paint lets through. */
#include "base/pixel.h"
#include "base/stage.h"

enum { CHUNK = 256 };

/* own, below: heights of n pixels and, in own, of the one after them. */
static void relief_row(const encre_params *p, int n, const float *restrict own, const float *restrict below,
		       float *restrict surface)
{
	float strength = p->paper_relief, under = p->paper_under, tint[3];
	for (int c = 0; c < 3; c++)
		tint[c] = mix(1, p->paper_under_color[c], under);
	for (int i = 0; i < n; i++) {
		float slope = 0.5f * ((own[i + 1] - own[i]) + (below[i] - own[i]));
		float lit = min(max(1 + strength * slope, 0), 2), alpha = surface[4 * i + 3],
		      bare = (1 - alpha) * under;
		for (int c = 0; c < 3; c++)
			surface[4 * i + c] =
				bounded((surface[4 * i + c] * tint[c] + bare * p->paper_under_color[c]) * lit);
		surface[4 * i + 3] = alpha + bare;
	}
}

static void relief_rows(void *data, int y0, int y1, int thread)
{
	(void)thread;
	const frame *f = data;
	plane out = f->output[ENCRE_OUTPUT_COMBINED];
	float own[CHUNK + 1], below[CHUNK];
	for (int y = y0; y < y1; y++)
		for (int x = 0, end; x < f->width; x = end) {
			const encre_params *p = style_run(f, y, x, f->width - x > CHUNK ? x + CHUNK : f->width, &end);
			if (!p->use_relief)
				continue;
			int n = end - x, more = end < f->width;
			ISA(paper_row)(f, y, x, end + more, 1, own);
			own[n] = more ? own[n] : own[n - 1];
			ISA(paper_row)(f, y + 1, x, end, 1, below);
			relief_row(f->params, n, own, below, out.data + y * out.row + 4 * (ptrdiff_t)x);
		}
}

const stage STAGE_SYMBOL(relief) = {.id = "relief", .rows = relief_rows};
