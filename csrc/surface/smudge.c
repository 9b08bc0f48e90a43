/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Smudging (Vainumäe 2020, 4.2): where it is painted, colour from the other side of the nearest edge runs across it.
 * Pixels are few and read others that are smudged too, so their new colours go to a list first. */
#include "base/pixel.h"
#include "base/stage.h"

#include <stdlib.h>

typedef struct smudged {
	int32_t x;
	float color[4];
} smudged;

typedef struct smudge {
	const frame *f;
	size_t *first; /* [height + 1]: how many pixels of a row are painted, then where its part of the list starts */
	int32_t *changed; /* [height]: how many of them change */
	smudged *list;
} smudge;

/* ---- pixels ---------------------------------------------------------------------------------------------- */

static float range_at(const frame *f, const encre_params *p, const float *controls)
{
	return p->use_smudging ? p->smudge_range * f->scale * controls[CONTROL_SMUDGE_RANGE] : 0;
}

/* Every other pixel is at least one pixel away; a site may be nearer. */
static bool reaches(const frame *f, float range)
{
	return f->fine ? fabsf(range) > 0.1f : fabsf(range) >= 1;
}

static float *surface_at(const frame *f, int y, int x)
{
	return output_row(f, ENCRE_OUTPUT_COMBINED, y) + 4 * (ptrdiff_t)x;
}

/* Coordinate of the edge, at + step, and `pick` beyond it along a direction; half up, clamped into 0..n-1. */
static int picked(int at, float step, float pick, float distance, int n)
{
	float q = floorf(step + pick * (step / distance) + 0.5f) + (float)at;
	return q > 0 ? q < (float)(n - 1) ? (int)q : n - 1 : 0;
}

/* Whether the surface at depth zq, behind (or in front) as asked, is another than the one at z. */
static bool differs(const frame *f, const encre_params *p, float z, float zq, bool behind)
{
	if (behind ? !(zq > z) : !(zq < z))
		return false;
	float least = p->smudge_depth * (f->camera.orthographic ? f->camera.height : z);
	return z == INFINITY || zq == INFINITY || fabsf(zq - z) > least;
}

static float falloff(const encre_params *p, const float *controls, float range, float distance)
{
	float control = controls[CONTROL_SMUDGE_FALLOFF],
	      full = p->smudge_falloff * (control > 0 ? control : 0) * (1 + range);
	float f = distance < full || full >= range ? 1 : clamp01((range - distance) / (range - full));
	return p->smudge_curve == 1 ? f : pixel_pow(f, p->smudge_curve);
}

/* The new colour of a painted pixel; false where it keeps its own. */
static bool smudge_pixel(const frame *f, const encre_params *p, int y, int x, float *color)
{
	const float *controls = controls_at(f, x, y);
	float to[2];
	float signed_range = range_at(f, p, controls), range = fabsf(signed_range);
	if (!ISA(nearest_edge)(f, x, y, range, to))
		return false;
	float distance = sqrtf(to[0] * to[0] + to[1] * to[1]);
	if (!(distance > 0 && distance <= range))
		return false;
	float pick = p->smudge_pick * f->scale;
	int qx = picked(x, to[0], pick, distance, f->width), qy = picked(y, to[1], pick, distance, f->height);
	const float *own = surface_at(f, y, x), *other = surface_at(f, qy, qx);
	if (!differs(f, p, depth_at(f, x, y), depth_at(f, qx, qy), signed_range > 0) || !(other[3] > 0))
		return false;
	float share = falloff(p, controls, range, distance);
	for (int c = 0; c < 4; c++)
		color[c] = blend(own[c], other[c], share);
	return true;
}

/* ---- rows ------------------------------------------------------------------------------------------------ */

static void count_rows(void *data, int y0, int y1, int thread)
{
	(void)thread;
	smudge *s = data;
	const frame *f = s->f;
	for (int y = y0; y < y1 && !bands_stopped(f->bands); y++) {
		size_t painted = 0;
		for (int x = 0, end; x < f->width; x = end) {
			const encre_params *p = style_run(f, y, x, f->width, &end);
			const float *controls = controls_at(f, x, y);
			for (int i = 0; i < end - x; i++)
				painted += reaches(f, range_at(f, p, controls + CONTROL_COUNT * i));
		}
		s->first[y] = painted;
	}
}

static void find_rows(void *data, int y0, int y1, int thread)
{
	(void)thread;
	smudge *s = data;
	const frame *f = s->f;
	for (int y = y0; y < y1 && !bands_stopped(f->bands); y++) {
		smudged *out = s->list + s->first[y];
		bool painted = s->first[y + 1] > s->first[y];
		for (int x = 0, end; painted && x < f->width; x = end) {
			const encre_params *p = style_run(f, y, x, f->width, &end);
			for (int i = x; i < end; i++)
				if (reaches(f, range_at(f, p, controls_at(f, i, y))) &&
				    smudge_pixel(f, p, y, i, out->color))
					(out++)->x = i;
		}
		s->changed[y] = (int32_t)(out - (s->list + s->first[y]));
	}
}

static void apply_rows(void *data, int y0, int y1, int thread)
{
	(void)thread;
	const smudge *s = data;
	for (int y = y0; y < y1; y++)
		for (int i = 0; i < s->changed[y]; i++) {
			const smudged *pixel = s->list + s->first[y] + i;
			float *surface = surface_at(s->f, y, pixel->x);
			for (int c = 0; c < 4; c++)
				surface[c] = pixel->color[c];
		}
}

/* ---- stage ----------------------------------------------------------------------------------------------- */

static bool reads_edges(const frame *f)
{
	return f->any.use_smudging;
}

static bool wanted(const frame *f)
{
	return f->any.use_smudging && f->layer[ENCRE_LAYER_CONTROLS].data;
}

static void plan(frame *f, arena *a)
{
	if (wanted(f))
		ISA(nearest_plan)(f, a);
}

/* Only a painted frame pays for the distance transform and the list. */
static int32_t smudge_painted(frame *f, smudge *s)
{
	int32_t code = bands_run(f->bands, f->height, 0, count_rows, s);
	size_t painted = 0;
	for (int y = 0; !code && y <= f->height; y++) {
		size_t n = y < f->height ? s->first[y] : 0;
		s->first[y] = painted;
		painted += n;
	}
	if (code || !painted)
		return code;
	s->list = painted <= SIZE_MAX / sizeof *s->list ? malloc(painted * sizeof *s->list) : NULL;
	if (!s->list)
		return ENCRE_ERROR_MEMORY;
	code = ISA(nearest_run)(f);
	if (!code)
		code = bands_run(f->bands, f->height, 0, find_rows, s);
	return code ? code : bands_run(f->bands, f->height, 0, apply_rows, s);
}

static int32_t run(frame *f)
{
	if (!wanted(f))
		return ENCRE_OK;
	smudge s = {.f = f,
		    .first = malloc(((size_t)f->height + 1) * sizeof *s.first),
		    .changed = malloc((size_t)f->height * sizeof *s.changed)};
	int32_t code = s.first && s.changed ? smudge_painted(f, &s) : ENCRE_ERROR_MEMORY;
	free(s.list);
	free(s.changed);
	free(s.first);
	return code;
}

const stage STAGE_SYMBOL(smudge) = {
	.id = "smudge", .reads_edges = reads_edges, .plan = plan, .run = run, .draws = wanted};
