/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Rows of samples -> strength of each source of edges (Vainumäe 2020, 3.1; Herring 2016, A.2). */
#include "edges/edges.h"
#include "base/metric.h"
#include "base/pixel.h"

/* What a perspective response in 1/z is divided by: the largest 1/z of the window inside the frame. */
static void divide_by_nearest(const ring *r, int y, int x0, int n, float *restrict response)
{
	float most[TILE + 2 * MAX_REACH], spare[TILE + 2 * MAX_REACH];
	int reach = r->reach, width = r->e->f->width, height = r->e->f->height;
	int from = x0 < reach ? reach - x0 : 0, to = n + 2 * reach;
	to = to < width - x0 + reach ? to : width - x0 + reach;
	memset(most, 0, sizeof most);
	for (int i = clamp_index(y - reach, height); i <= clamp_index(y + reach, height); i++) {
		const float *restrict row = r->row[i - y + reach] + x0 - reach;
		for (int k = from; k < to; k++)
			most[k] = most[k] > row[k] ? most[k] : row[k];
	}
	const float *nearest = ISA(window_greatest)(most, spare, n, reach, 1);
	for (int i = 0; i < n; i++)
		response[i] = nearest[i] > 0 ? response[i] / nearest[i] : 0;
}

/* detect_dog and detect_bend for the middle of one window. */
static float dog_alone(const gaussians *g, double (*patch)[MAX_ROWS])
{
	double sum = 0;
	for (int i = -g->reach; i <= g->reach; i++)
		for (int j = -g->reach; j <= g->reach; j++) {
			int a = i < 0 ? -i : i, b = j < 0 ? -j : j;
			double kernel =
				(double)g->narrow[a] * (double)g->narrow[b] - (double)g->wide[a] * (double)g->wide[b];
			sum += kernel * (patch[g->reach + i][g->reach + j] - patch[g->reach][g->reach]);
		}
	return (float)sum;
}

static float bend_alone(double (*patch)[MAX_ROWS])
{
	double lx = 0, ly = 0;
	for (int i = 0; i < 3; i++) {
		int weight = 2 - (i - 1) * (i - 1);
		lx += weight * (patch[i][0] - 2 * patch[i][1] + patch[i][2]);
		ly += weight * (patch[0][i] - 2 * patch[1][i] + patch[2][i]);
	}
	return sqrtf((float)(lx * lx + ly * ly));
}

/* In 1/z the window of (x, y) continues linearly outside the frame: a plane must stay one. Under an orthographic camera
 * nothing-there lies one frame height behind the farthest pixel of the window, so that no frame-wide number would do.
 * The few windows that see either are done one by one, and in double: what is added cancels where the surface is
 * smooth. */
static float response_alone(const ring *r, int y, int x)
{
	double patch[MAX_ROWS][MAX_ROWS];
	const edges *e = r->e;
	int reach = r->reach, width = e->f->width, height = e->f->height;
	int left = clamp_index(x - reach, width), right = clamp_index(x + reach, width);
	int top = clamp_index(y - reach, height), bottom = clamp_index(y + reach, height);
	float farthest = INFINITY;
	for (int i = top; i <= bottom; i++)
		for (int j = left; j <= right; j++) {
			float u = r->row[i - y + reach][j];
			farthest = u > -INFINITY && u < farthest ? u : farthest;
		}
	if (farthest == INFINITY)
		return 0;
	int at = reach - x; /* of sample 0 in a row of the patch */
	for (int i = top; i <= bottom; i++) {
		double *out = patch[i - y + reach];
		for (int j = left; j <= right; j++) {
			float u = r->row[i - y + reach][j];
			out[at + j] = u > -INFINITY ? (double)u : (double)farthest - (double)e->f->camera.height;
		}
		for (int j = x - reach; j < 0; j++)
			out[at + j] = 2 * out[at] - out[at + clamp_index(-j, width)];
		for (int j = width; j <= x + reach; j++)
			out[at + j] = 2 * out[at + width - 1] - out[at + clamp_index(2 * (width - 1) - j, width)];
	}
	for (int i = y - reach; i <= y + reach; i++) {
		if (i >= 0 && i < height)
			continue;
		const double *border = patch[clamp_index(i, height) - y + reach];
		const double *inside = patch[clamp_index(i < height ? -i : 2 * (height - 1) - i, height) - y + reach];
		for (int j = 0; j <= 2 * reach; j++)
			patch[i - y + reach][j] = 2 * border[j] - inside[j];
	}
	return e->dog ? dog_alone(&e->gauss, patch) : bend_alone(patch);
}

static bool all_finite(const float *response, int n)
{
	int all = 1;
	for (int i = 0; i < n; i++)
		all &= fabsf(response[i]) <= FLT_MAX;
	return all;
}

static void mend_responses(const ring *r, int y, int x0, int n, float *response)
{
	const frame *f = r->e->f;
	bool outside = y < r->reach || y >= f->height - r->reach;
	for (int i = 0; i < n; i++)
		if (outside || x0 + i < r->reach || x0 + i >= f->width - r->reach || !(fabsf(response[i]) <= FLT_MAX))
			response[i] = response_alone(r, y, x0 + i);
}

static void depth_strength(const ring *r, int y, int x0, int n, float *restrict response)
{
	const edges *e = r->e;
	const float *row[MAX_ROWS];
	ISA(ring_window)(r, x0, 0, row);
	if (e->dog)
		ISA(detect_dog)(&e->gauss, row, 1, n, response);
	else if (e->inverse)
		ISA(detect_bend)(row, n, response);
	else
		ISA(detect_slope)(row, 1, n, response);
	if (e->inverse) {
		bool outside = y < r->reach || y >= e->f->height - r->reach || x0 < r->reach ||
			       x0 + n > e->f->width - r->reach;
		if (outside || !all_finite(response, n))
			mend_responses(r, y, x0, n, response);
	}
	if (e->inverse && !e->ortho)
		divide_by_nearest(r, y, x0, n, response);
	float most = e->dog ? FLT_MAX : 1;
	for (int i = 0; i < n; i++) {
		float s = e->depth_factor * response[i];
		response[i] = s < most ? s : most;
	}
}

/* Of each channel, where it lies beside the others: n floats are a third of the pixels. */
static void normal_responses(const ring *r, int x0, int n, float *restrict each)
{
	const float *row[MAX_ROWS];
	ISA(ring_window)(r, x0, 0, row);
	for (int c = 0; c < 3; c++) {
		if (r->e->dog)
			ISA(detect_dog)(&r->e->gauss, row, 3, n, each + (ptrdiff_t)c * n);
		else
			ISA(detect_slope)(row, 3, n, each + (ptrdiff_t)c * n);
		for (int k = 0; k <= 2 * r->reach; k++)
			row[k] += n;
	}
}

/* A tenth, of components 1/2 + n/2. */
static void normal_strength(const ring *r, int x0, int n, float *restrict response)
{
	float each[3 * TILE], least = r->e->p->sobel_crease_threshold;
	normal_responses(r, x0, n, each);
	for (int i = 0; r->e->dog && i < n; i++) {
		float peak = 5 * max(each[3 * i + 2], max(each[3 * i + 1], positive(each[3 * i])));
		response[i] = 50 * peak * sqrtf(peak);
	}
	for (int i = 0; !r->e->dog && i < n; i++) {
		float shape = 0.05f * (each[3 * i] + each[3 * i + 1] + each[3 * i + 2]);
		response[i] = shape < least ? 0 : shape;
	}
}

void ISA(source_difference)(const ring *r, int x0, int n, float *restrict difference)
{
	const float *row[3][3];
	for (int c = 0; c < 3; c++) {
		const float *plane[3];
		ISA(ring_window)(r, x0, c, plane);
		for (int k = 0; k < 3; k++)
			row[k][c] = plane[k];
	}
	color_metric metric = metric_of(r->e->p);
	ISA(detect_contrast)(&metric, row, n, difference);
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
			ISA(ring_window)(r, x0, c, row);
			ISA(detect_dog)(&e->gauss, row, 1, n, most);
			for (int i = 0; i < n; i++)
				response[i] = 50 * most[i] > response[i] ? 50 * most[i] : response[i];
		}
		return;
	}
	if (e->full[r->source]) {
		ptrdiff_t at = (ptrdiff_t)y * e->f->width + x0;
		memcpy(response, e->difference[r->source] + at, (size_t)n * sizeof *response);
	} else
		ISA(source_difference)(r, x0, n, response);
	for (int i = 0; i < n; i++)
		most[i] = full_contrast(e, r->source, x0 + i, y);
	float least = e->p->contrast_threshold;
	for (int i = 0; i < n; i++)
		response[i] = metric_strength(response[i], least, most[i]);
}

void ISA(source_painted)(const ring *r, int y, int x0, int n, float *restrict strength)
{
	static const int pair[4][2] = {{0, 0}, {0, 1}, {1, 1}, {2, 1}}; /* as in detect_contrast() */
	const edges *e = r->e;
	const float *controls = controls_at(e->f, x0, y), *row[3][MAX_ROWS];
	if (!controls || !e->contrast)
		return;
	for (int c = 0; c < 3; c++)
		ISA(ring_window)(r, x0, c, row[c]);
	for (int i = 0; i < n; i++) {
		float control = controls[CONTROL_COUNT * (ptrdiff_t)i + CONTROL_COLOR_EDGE], most = 0;
		for (int k = 0; control > 0 && k < 4; k++) {
			float one[3], two[3];
			for (int c = 0; c < 3; c++) {
				one[c] = row[c][pair[k][0]][i + pair[k][1]];
				two[c] = row[c][2 - pair[k][0]][i - pair[k][1]];
			}
			most = max(most, ISA(metric_ciede2000)(e->p->contrast_metric, one, two));
		}
		strength[i] = max(strength[i], painted_strength(e, control, most));
	}
}

static void index_strength(const ring *r, int x0, int n, float *restrict response)
{
	const float *row[3];
	ISA(ring_window)(r, x0, 0, row);
	ISA(detect_change)(row, n, response);
}

void ISA(source_strength)(const ring *r, int y, int x0, int n, float *restrict strength)
{
	switch (r->source) {
	case SOURCE_DEPTH: depth_strength(r, y, x0, n, strength); break;
	case SOURCE_NORMAL: normal_strength(r, x0, n, strength); break;
	case SOURCE_COLOR:
	case SOURCE_LIGHT: color_strength(r, y, x0, n, strength); break;
	case SOURCE_MARK: memcpy(strength, r->row[r->reach] + x0, (size_t)n * sizeof *strength); break;
	default: index_strength(r, x0, n, strength);
	}
}
