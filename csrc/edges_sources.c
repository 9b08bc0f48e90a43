/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Rows of samples -> strength of each source of edges (Vainumäe 2020, 4.3; Herring 2016, 3.2). */
#include "edges.h"
#include "pixel.h"

/* What a perspective response in 1/z is divided by: the largest 1/z of the window inside the frame. */
static void divide_by_nearest(const ring *r, int y, int x0, int n, float *restrict response)
{
	float most[TILE + 2 * MAX_REACH];
	int reach = r->reach, width = r->e->f->width, height = r->e->f->height;
	int from = x0 < reach ? reach - x0 : 0, to = n + 2 * reach;
	to = to < width - x0 + reach ? to : width - x0 + reach;
	memset(most, 0, sizeof most);
	for (int i = clamp_index(y - reach, height); i <= clamp_index(y + reach, height); i++) {
		const float *restrict row = ring_row(r, i, 0) + x0 - reach;
		for (int k = from; k < to; k++)
			most[k] = most[k] > row[k] ? most[k] : row[k];
	}
	ISA(window_greatest)(most, n, reach, 1);
	for (int i = 0; i < n; i++)
		response[i] = most[i] > 0 ? response[i] / most[i] : 0;
}

static void detect_depth(const edges *e, const float *const *row, int n, float *response)
{
	if (e->dog)
		ISA(detect_dog)(&e->gauss, row, n, response);
	else if (e->inverse)
		ISA(detect_bend)(row, n, response);
	else
		ISA(detect_slope)(row, n, response);
}

/* Under an orthographic camera nothing-there lies one frame height behind the farthest pixel of the window: no frame-wide
 * number would do, so the few windows that see both are done again one by one. */
static float response_beside_nothing(const ring *r, int y, int x)
{
	float patch[MAX_ROWS][MAX_ROWS];
	const float *row[MAX_ROWS];
	const edges *e = r->e;
	int reach = r->reach, width = e->f->width, height = e->f->height;
	int left = clamp_index(x - reach, width), right = clamp_index(x + reach, width);
	int top = clamp_index(y - reach, height), bottom = clamp_index(y + reach, height);
	float farthest = INFINITY; /* samples are -z */
	for (int i = top; i <= bottom; i++)
		for (int j = left; j <= right; j++) {
			float z = ring_row(r, i, 0)[j];
			farthest = z > -INFINITY && z < farthest ? z : farthest;
		}
	if (farthest == INFINITY)
		return 0;
	int at = reach - x; /* of sample 0 in the patch */
	for (int i = top; i <= bottom; i++) {
		float *out = patch[i - y + reach];
		for (int j = left; j <= right; j++) {
			float z = ring_row(r, i, 0)[j];
			out[at + j] = z > -INFINITY ? z - farthest : -e->height; /* small numbers keep their digits */
		}
		for (int j = x - reach; j < 0; j++)
			out[at + j] = 2 * out[at] - out[at + clamp_index(-j, width)];
		for (int j = width; j <= x + reach; j++)
			out[at + j] = 2 * out[at + width - 1] - out[at + clamp_index(2 * (width - 1) - j, width)];
	}
	for (int k = 0; k < 2 * reach + 1; k++) {
		int i = y + k - reach;
		if (i >= 0 && i < height)
			continue;
		const float *border = patch[clamp_index(i, height) - y + reach];
		const float *inside = patch[clamp_index(i < 0 ? -i : 2 * (height - 1) - i, height) - y + reach];
		for (int j = 0; j < 2 * reach + 1; j++)
			patch[k][j] = 2 * border[j] - inside[j];
	}
	for (int k = 0; k < 2 * reach + 1; k++)
		row[k] = patch[k] + reach;
	float response;
	detect_depth(e, row, 1, &response);
	return response;
}

static void depth_strength(const ring *r, int y, int x0, int n, float *restrict response)
{
	const edges *e = r->e;
	const float *row[MAX_ROWS];
	ISA(ring_window)(r, y, x0, 0, row);
	detect_depth(e, row, n, response);
	if (e->ortho)
		for (int i = 0; i < n; i++)
			if (!(fabsf(response[i]) <= FLT_MAX)) /* the window sees -INFINITY */
				response[i] = response_beside_nothing(r, y, x0 + i);
	if (e->inverse && !e->ortho)
		divide_by_nearest(r, y, x0, n, response);
	float most = e->dog ? FLT_MAX : 1;
	for (int i = 0; i < n; i++) {
		float s = e->depth_factor * response[i];
		response[i] = s < most ? s : most;
	}
}

static void normal_strength(const ring *r, int y, int x0, int n, float *restrict response)
{
	const encre_params *p = r->e->p;
	const float *row[MAX_ROWS];
	float one[TILE];
	for (int i = 0; i < n; i++)
		response[i] = 0;
	for (int c = 0; c < 3; c++) {
		ISA(ring_window)(r, y, x0, c, row);
		if (r->e->dog) {
			ISA(detect_dog)(&r->e->gauss, row, n, one);
			for (int i = 0; i < n; i++)
				response[i] = one[i] > response[i] ? one[i] : response[i];
		} else {
			ISA(detect_slope)(row, n, one);
			for (int i = 0; i < n; i++)
				response[i] += one[i];
		}
	}
	float least = p->sobel_shape_threshold;
	for (int i = 0; i < n; i++) {
		float peak = 5 * response[i], shape = 0.05f * response[i]; /* a tenth, of components 1/2 + n/2 */
		response[i] = r->e->dog ? 50 * peak * sqrtf(peak) : shape < least ? 0 : shape;
	}
}

void ISA(source_difference)(const ring *r, int y, int x0, int n, float *restrict difference)
{
	const float *row[3][3];
	for (int c = 0; c < 3; c++) {
		const float *plane[3];
		ISA(ring_window)(r, y, x0, c, plane);
		for (int k = 0; k < 3; k++)
			row[k][c] = plane[k];
	}
	ISA(detect_contrast)(r->e->p->contrast_metric, row, n, difference);
}

static void color_strength(const ring *r, int y, int x0, int n, float *restrict response)
{
	const edges *e = r->e;
	float most[TILE];
	if (!e->contrast) {
		const float *row[MAX_ROWS];
		for (int i = 0; i < n; i++)
			response[i] = 0;
		for (int c = 0; c < 3; c++) {
			ISA(ring_window)(r, y, x0, c, row);
			ISA(detect_dog)(&e->gauss, row, n, most);
			for (int i = 0; i < n; i++)
				response[i] = 50 * most[i] > response[i] ? 50 * most[i] : response[i];
		}
		return;
	}
	if (e->full[r->source]) {
		ptrdiff_t at = (ptrdiff_t)y * e->f->width + x0;
		memcpy(response, e->difference[r->source] + at, (size_t)n * sizeof *response);
		for (int i = 0; i < n; i++)
			most[i] = e->full[r->source][at + i] > 0.25f ? e->full[r->source][at + i] : 0.25f;
	} else {
		ISA(source_difference)(r, y, x0, n, response);
		for (int i = 0; i < n; i++)
			most[i] = e->p->contrast_max;
	}
	float least = e->p->contrast_threshold;
	for (int i = 0; i < n; i++) {
		float ramp = most[i] - least, share = (response[i] - least) / (ramp > 0 ? ramp : 1);
		share = ramp > 0 ? clamp01(share) : 1;
		response[i] = response[i] < least ? 0 : share;
	}
}

static void index_strength(const ring *r, int y, int x0, int n, float *restrict response)
{
	const float *row[3];
	ISA(ring_window)(r, y, x0, 0, row);
	ISA(detect_change)(row, n, response);
}

void ISA(source_strength)(const ring *r, int y, int x0, int n, float *restrict strength)
{
	switch (r->source) {
	case SOURCE_DEPTH: depth_strength(r, y, x0, n, strength); break;
	case SOURCE_NORMAL: normal_strength(r, y, x0, n, strength); break;
	case SOURCE_COLOR:
	case SOURCE_LIGHT: color_strength(r, y, x0, n, strength); break;
	default: index_strength(r, y, x0, n, strength);
	}
}
