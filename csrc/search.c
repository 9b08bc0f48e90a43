/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The edge that inks a pixel, found in other ways than trying all: walking up the blurred mask of edge pixels
 * (Vainumäe 2020, 4.4) or dilating that mask (its alternative), both at most about 20 pixels far; or the nearest.
 *
 * A location is held as its offset, 6 bits each way, the row first: packed so, locations at the same distance order as
 * their rows, then columns do, and the nearest is the least number with the squared distance in front. */
#include "discs.h"

enum { STEPS = 20, ORIGIN = 32 << 6 | 32, BLUR_SIGMA = 10, BLUR_RADIUS = 20 };

typedef struct job {
	const frame *f;
	search *s;
	float weight[BLUR_RADIUS + 1];
} job;

/* ---- the nearest of those held about a pixel --------------------------------------------------------------- */

/* from[-1..n]: locations held beside; `shift` is added to make them offsets from this row's pixels. */
static void take_nearer(const uint16_t *restrict from, int n, int shift, int32_t *restrict best)
{
	for (int x = 0; x < n; x++) {
		int32_t held = from[x] + shift, dy = ((held >> 6) & 63) - 32, dx = (held & 63) - 32;
		int32_t key = (dy * dy + dx * dx) << 12 | (held & 4095);
		key = from[x] == HELD_NONE ? INT32_MAX : key;
		best[x] = key < best[x] ? key : best[x];
	}
}

static void hold_rows(void *data, int y0, int y1, int thread)
{
	(void)thread;
	const job *j = data;
	const frame *f = j->f;
	enum { PART = 256 };
	int32_t best[PART];
	for (int y = y0; y < y1; y++)
		for (int x0 = 0; x0 < f->width; x0 += PART) {
			int n = f->width - x0 < PART ? f->width - x0 : PART;
			for (int i = 0; i < n; i++)
				best[i] = INT32_MAX;
			for (int dy = y > 0 ? -1 : 0; dy <= (y < f->height - 1); dy++) {
				const uint16_t *row = j->s->held + ((size_t)y + (size_t)dy) * (size_t)f->width + x0;
				int left = x0 == 0, right = x0 + n == f->width; /* no pixel beyond: nothing new to learn from the frame's border */
				take_nearer(row, n, dy * 64, best);
				take_nearer(row - 1 + left, n - left, dy * 64 - 1, best + left);
				take_nearer(row + 1, n - right, dy * 64 + 1, best);
			}
			uint16_t *out = j->s->next + (size_t)y * (size_t)f->width + x0;
			for (int i = 0; i < n; i++)
				out[i] = (uint16_t)(best[i] == INT32_MAX ? HELD_NONE : best[i] & 4095);
		}
}

/* Each location becomes the nearest of the 3x3 about it, `times` times. */
static int32_t hold_nearest(job *j, int times)
{
	int32_t code = ENCRE_OK;
	for (int i = 0; !code && i < times; i++) {
		code = rows_run(j->f->rows, j->f->height, 0, hold_rows, j);
		uint16_t *next = j->s->held;
		j->s->held = j->s->next;
		j->s->next = next;
	}
	return code;
}

static void own_rows(void *data, int y0, int y1, int thread)
{
	(void)thread;
	const job *j = data;
	size_t width = (size_t)j->f->width;
	for (size_t i = (size_t)y0 * width; i < (size_t)y1 * width; i++)
		j->s->held[i] = j->f->edge[i] ? ORIGIN : HELD_NONE;
}

/* ---- the walk -------------------------------------------------------------------------------------------- */

static void add_pair(const uint8_t *restrict above, const uint8_t *restrict below, int n, float weight, float *restrict sum)
{
	for (int x = 0; x < n; x++)
		sum[x] += weight * (float)((above[x] != 0) + (below[x] != 0));
}

/* Columns first. Taps are summed in pairs from the middle, so that what is symmetrical stays so to the bit, and the
 * gradient on an axis of symmetry is 0. */
static void blur_rows(void *data, int y0, int y1, int thread)
{
	const job *j = data;
	const frame *f = j->f;
	int width = f->width;
	float *sum = j->s->column + (size_t)thread * ((size_t)width + 2 * BLUR_RADIUS) + BLUR_RADIUS;
	for (int y = y0; y < y1; y++) {
		for (int x = 0; x < width; x++)
			sum[x] = j->weight[0] * (float)(f->edge[(size_t)y * (size_t)width + (size_t)x] != 0);
		for (int k = 1; k <= BLUR_RADIUS; k++) {
			int above = y < k ? 0 : y - k, below = y + k < f->height ? y + k : f->height - 1;
			add_pair(f->edge + (size_t)above * (size_t)width, f->edge + (size_t)below * (size_t)width, width, j->weight[k], sum);
		}
		for (int k = 1; k <= BLUR_RADIUS; k++) {
			sum[-k] = sum[0];
			sum[width - 1 + k] = sum[width - 1];
		}
		float *restrict out = j->s->blurred + (size_t)y * (size_t)width;
		for (int x = 0; x < width; x++)
			out[x] = j->weight[0] * sum[x];
		for (int k = 1; k <= BLUR_RADIUS; k++) {
			const float *restrict left = sum - k, *restrict right = sum + k;
			for (int x = 0; x < width; x++)
				out[x] += j->weight[k] * (left[x] + right[x]);
		}
	}
}

/* Where the walk from x, y along the unit vector g ends. */
static uint16_t walk(const frame *f, int x, int y, float gx, float gy)
{
	for (int i = 0; i < STEPS; i++) {
		int dx = (int)floorf((float)i * gx + 0.5f), dy = (int)floorf((float)i * gy + 0.5f);
		dx = dx < -x ? -x : dx > f->width - 1 - x ? f->width - 1 - x : dx;
		dy = dy < -y ? -y : dy > f->height - 1 - y ? f->height - 1 - y : dy;
		if (f->edge[(size_t)(y + dy) * (size_t)f->width + (size_t)(x + dx)])
			return (uint16_t)(ORIGIN + dy * 64 + dx);
	}
	return HELD_NONE;
}

static void walk_rows(void *data, int y0, int y1, int thread)
{
	(void)thread;
	const job *j = data;
	const frame *f = j->f;
	size_t width = (size_t)f->width;
	for (int y = y0; y < y1; y++) {
		const float *m = j->s->blurred + (size_t)y * width, *t = y > 0 ? m - width : m, *b = y < f->height - 1 ? m + width : m;
		const uint8_t *edge = f->edge + (size_t)y * width;
		uint16_t *held = j->s->held + (size_t)y * width;
		for (int x = 0; x < f->width; x++) {
			int l = x > 0 ? x - 1 : x, r = x < f->width - 1 ? x + 1 : x;
			float gx = (m[r] + 0.5f * (t[r] + b[r])) - (m[l] + 0.5f * (t[l] + b[l]));
			float gy = (b[x] + 0.5f * (b[l] + b[r])) - (t[x] + 0.5f * (t[l] + t[r]));
			float length = sqrtf(gx * gx + gy * gy);
			held[x] = edge[x] ? ORIGIN : length < 1e-12f ? HELD_NONE : walk(f, x, y, gx / length, gy / length);
		}
	}
}

static int32_t walk_all(job *j)
{
	float sum = 0;
	for (int k = 0; k <= BLUR_RADIUS; k++) {
		j->weight[k] = pixel_exp((float)(-k * k) / (2 * BLUR_SIGMA * BLUR_SIGMA));
		sum += k ? 2 * j->weight[k] : j->weight[k];
	}
	for (int k = 0; k <= BLUR_RADIUS; k++)
		j->weight[k] /= sum;
	int32_t code = rows_run(j->f->rows, j->f->height, 0, blur_rows, j);
	if (!code)
		code = rows_run(j->f->rows, j->f->height, 0, walk_rows, j);
	return code ? code : hold_nearest(j, 2);
}

/* ---- what the stage calls -------------------------------------------------------------------------------- */

search ISA(search_plan)(frame *f, arena *a)
{
	search s = {0};
	size_t width = (size_t)f->width, pixels = width * (size_t)f->height;
	if (f->params->line_search == line_search_NEAREST) {
		ISA(nearest_plan)(f, a);
		return s;
	}
	s.held = arena_take(a, pixels, sizeof(uint16_t));
	s.next = arena_take(a, pixels, sizeof(uint16_t));
	if (f->params->line_search == line_search_WALK) {
		s.blurred = arena_take(a, pixels, sizeof(float));
		s.column = arena_take(a, (width + 2 * BLUR_RADIUS) * (size_t)rows_threads(f->rows), sizeof(float));
	}
	return s;
}

int32_t ISA(search_run)(frame *f, search *s)
{
	job j = {.f = f, .s = s};
	switch (f->params->line_search) {
	case line_search_NEAREST: return ISA(nearest_run)(f);
	case line_search_WALK: return walk_all(&j);
	default: break;
	}
	int32_t code = rows_run(f->rows, f->height, 0, own_rows, &j);
	return code ? code : hold_nearest(&j, STEPS);
}
