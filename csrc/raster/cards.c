/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Where on a sheet of its object a pixel is: a sheet stands where the object has its origin, faces the eye, is as large
 * on the screen as what is there, and rolls with the object's up. (After Breslav et al. 2007, Dynamic 2D patterns, but
 * by the origin alone, so that a frame needs no other and neither bends nor what is hidden move it.) */
#include "raster/cards.h"
#include "base/stage.h"
#include "raster/raster.h"

#include <math.h>
#include <string.h>

/* What `from` (world space; [3] 1 = a place, 0 = a direction) is to the camera, or on the screen. */
static void turned(const double matrix[16], const double from[4], double to[4])
{
	for (int r = 0; r < 4; r++) {
		to[r] = 0;
		for (int c = 0; c < 4; c++)
			to[r] += matrix[4 * r + c] * from[c];
	}
}

static void stand(const encre_raster_job *job, part *part)
{
	const double *m = part->mesh->model;
	double origin[4] = {m[3], m[7], m[11], 1}, upright[4] = {m[2], m[6], m[10], 0}, eye[4], up[4], clip[4];
	turned(job->view, origin, eye);
	turned(job->view, upright, up);
	turned(job->projection, eye, clip);
	double lens = fabs(job->projection[0] * job->projection[5]) * job->frame.width * job->frame.height;
	double far = clip[3], length = sqrt(up[0] * up[0] + up[1] * up[1]);
	if (job->projection[14] != 0) { /* in perspective: else it raced where the origin is beside the eye */
		double away = sqrt(eye[0] * eye[0] + eye[1] * eye[1] + eye[2] * eye[2]) / 4;
		far = far > away ? far : away;
	}
	double size = lens > 0 ? 2 * far / sqrt(lens) : 0;
	part->card[0] = (clip[0] / far + 1) / 2 * job->frame.width;
	part->card[1] = (1 - clip[1] / far) / 2 * job->frame.height;
	part->card[2] = length > 0 ? size * up[1] / length : size;
	part->card[3] = length > 0 ? size * up[0] / length : 0;
}

void cards_stand(geometry *g)
{
	for (int i = 0; i < g->n_parts; i++)
		if (g->parts[i].mesh->kind == ENCRE_TRIANGLES)
			stand(g->job, g->parts + i);
}

void cards_draw(const encre_raster_job *job, const part *part, int x, int y)
{
	float *out = pixel_at(&job->card, x, y);
	memset(out, 0, CARD_COUNT * sizeof *out);
	if (!part)
		return;
	const double *card = part->card, right = job->frame.x + x + 0.5 - card[0],
		     down = job->frame.y + y + 0.5 - card[1];
	out[CARD_POSITION] = (float)(card[2] * right + card[3] * down);
	out[CARD_POSITION + 1] = (float)(card[3] * right - card[2] * down);
	out[CARD_RIGHT] = (float)card[2];
	out[CARD_RIGHT + 1] = (float)card[3];
	for (int c = 0; c < CARD_COUNT; c++)
		if (!isfinite(out[c])) {
			memset(out, 0, CARD_COUNT * sizeof *out);
			return;
		}
}
