/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The edge that inks a pixel, found in other ways than trying all: walking up the blurred mask of edge pixels
 * (Vainumäe 2020, 3.2) or dilating that mask (its alternative), both at most about 20 pixels far; or the nearest.
 *
 * A location is held as its offset, 6 bits each way, the row first: packed so, locations at the same distance order as
 * their rows, then columns do, and the nearest is the least number with the squared distance in front. */
#include "ink/discs.h"

#include <string.h>

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
	for (int y = y0; y < y1 && !bands_stopped(f->bands); y++)
		for (int x0 = 0; x0 < f->width; x0 += PART) {
			int n = f->width - x0 < PART ? f->width - x0 : PART;
			for (int i = 0; i < n; i++)
				best[i] = INT32_MAX;
			for (int dy = y > 0 ? -1 : 0; dy <= (y < f->height - 1); dy++) {
				const uint16_t *row = j->s->held + ((size_t)y + (size_t)dy) * (size_t)f->width + x0;
				int left = x0 == 0, right = x0 + n == f->width; /* no pixel beyond: nothing new to learn
										   from the frame's border */
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
		code = bands_run(j->f->bands, j->f->height, 0, hold_rows, j);
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

static void add_pair(const uint8_t *restrict above, const uint8_t *restrict below, int n, float weight,
		     float *restrict sum)
{
	for (int x = 0; x < n; x++)
		sum[x] += weight * (float)((above[x] != 0) + (below[x] != 0));
}

static size_t column_size(const frame *f)
{
	return 4 * ((size_t)f->width + BLUR_RADIUS);
}

static float *column_of(const job *j, int thread)
{
	return j->s->column + (size_t)thread * column_size(j->f);
}

/* Columns first. Taps are summed in pairs from the middle, so that what is symmetrical stays so to the bit, and the
 * gradient on an axis of symmetry is 0. */
static void blur_rows(void *data, int y0, int y1, int thread)
{
	const job *j = data;
	const frame *f = j->f;
	int width = f->width;
	float *sum = column_of(j, thread) + BLUR_RADIUS;
	for (int y = y0; y < y1 && !bands_stopped(f->bands); y++) {
		for (int x = 0; x < width; x++)
			sum[x] = j->weight[0] * (float)(f->edge[(size_t)y * (size_t)width + (size_t)x] != 0);
		for (int k = 1; k <= BLUR_RADIUS; k++) {
			int above = y < k ? 0 : y - k, below = y + k < f->height ? y + k : f->height - 1;
			add_pair(f->edge + (size_t)above * (size_t)width, f->edge + (size_t)below * (size_t)width,
				 width, j->weight[k], sum);
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

static void mark_edges(const uint8_t *restrict edge, int n, uint8_t k, uint8_t *restrict rows)
{
	for (int x = 0; x < n; x++)
		rows[x] = edge[x] ? k : rows[x];
}

/* Rows to the nearest edge pixel of each column, at most STEPS. */
static void least_rows(const frame *f, int y, uint8_t *rows)
{
	memset(rows, STEPS, (size_t)f->width);
	for (int k = STEPS; k-- > 0;) {
		if (y + k < f->height)
			mark_edges(f->edge + (size_t)(y + k) * (size_t)f->width, f->width, (uint8_t)k, rows);
		if (y - k >= 0)
			mark_edges(f->edge + (size_t)(y - k) * (size_t)f->width, f->width, (uint8_t)k, rows);
	}
}

static void step_beside(const uint8_t *restrict left, const uint8_t *restrict right, int n, uint8_t k,
			uint8_t *restrict gap)
{
	for (int x = 0; x < n; x++) {
		uint8_t beside = left[x] < right[x] ? left[x] : right[x];
		beside = beside > k ? beside : k;
		gap[x] = beside < gap[x] ? beside : gap[x];
	}
}

/* Chessboard distance to the nearest edge pixel, at most STEPS: so many steps of a walk find nothing. */
static void gap_rows(void *data, int y0, int y1, int thread)
{
	const job *j = data;
	const frame *f = j->f;
	uint8_t *rows = j->s->rows + (size_t)thread * ((size_t)f->width + 2 * STEPS) + STEPS;
	memset(rows - STEPS, STEPS, STEPS);
	memset(rows + f->width, STEPS, STEPS);
	for (int y = y0; y < y1 && !bands_stopped(f->bands); y++) {
		least_rows(f, y, rows);
		uint8_t *gap = j->s->gap + (size_t)y * (size_t)f->width;
		memcpy(gap, rows, (size_t)f->width);
		for (int k = 1; k < STEPS; k++)
			step_beside(rows - k, rows + k, f->width, (uint8_t)k, gap);
	}
}

/* Where the walk from x, y along the unit vector g ends. */
static uint16_t walk(const frame *f, const uint8_t *gap, int x, int y, float gx, float gy)
{
	for (int i = 0; i < STEPS;) {
		/* rounding half up; 32 makes them positive, for which a conversion is floor() */
		int dx = (int)((float)i * gx + 32.5f) - 32, dy = (int)((float)i * gy + 32.5f) - 32;
		dx = dx < -x ? -x : dx > f->width - 1 - x ? f->width - 1 - x : dx;
		dy = dy < -y ? -y : dy > f->height - 1 - y ? f->height - 1 - y : dy;
		int skip = gap[(size_t)(y + dy) * (size_t)f->width + (size_t)(x + dx)];
		if (!skip)
			return (uint16_t)(ORIGIN + dy * 64 + dx);
		i += skip;
	}
	return HELD_NONE;
}

/* Unit gradient of the rows t, m and b; 0 where it is too short to be one. Scratch: n + 2 floats each. */
static void slope_row(const float *restrict t, const float *restrict m, const float *restrict b, int n,
		      float *restrict across, float *restrict down, float *restrict gx, float *restrict gy)
{
	for (int x = 0; x < n; x++) {
		across[x + 1] = m[x] + 0.5f * (t[x] + b[x]);
		down[x + 1] = b[x] - t[x];
	}
	across[0] = across[1];
	across[n + 1] = across[n];
	down[0] = down[1];
	down[n + 1] = down[n];
	for (int x = 0; x < n; x++) {
		float dx = across[x + 2] - across[x], dy = down[x + 1] + 0.5f * (down[x] + down[x + 2]);
		float length = sqrtf(dx * dx + dy * dy), scale = length >= 1e-12f ? 1 / length : 0;
		gx[x] = dx * scale;
		gy[x] = dy * scale;
	}
}

static void walk_rows(void *data, int y0, int y1, int thread)
{
	const job *j = data;
	const frame *f = j->f;
	size_t width = (size_t)f->width;
	float *gx = column_of(j, thread), *gy = gx + width, *scratch = gy + width;
	for (int y = y0; y < y1 && !bands_stopped(f->bands); y++) {
		const float *m = j->s->blurred + (size_t)y * width, *t = y > 0 ? m - width : m,
			    *b = y < f->height - 1 ? m + width : m;
		const uint8_t *gap = j->s->gap + (size_t)y * width;
		uint16_t *held = j->s->held + (size_t)y * width;
		slope_row(t, m, b, f->width, scratch, scratch + width + 2, gx, gy);
		for (int x = 0; x < f->width; x++) {
			bool reached = gap[x] == 0, hopeless = gap[x] == STEPS || (gx[x] == 0 && gy[x] == 0);
			held[x] = reached ? ORIGIN : hopeless ? HELD_NONE : walk(f, j->s->gap, x, y, gx[x], gy[x]);
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
	int32_t code = bands_run(j->f->bands, j->f->height, 0, blur_rows, j);
	if (!code)
		code = bands_run(j->f->bands, j->f->height, 0, gap_rows, j);
	if (!code)
		code = bands_run(j->f->bands, j->f->height, 0, walk_rows, j);
	return code ? code : hold_nearest(j, 2);
}

/* ---- what the stage calls -------------------------------------------------------------------------------- */

void ISA(search_plan)(frame *f, arena *a)
{
	search s = {0}, *made;
	size_t width = (size_t)f->width, pixels = width * (size_t)f->height;
	if (f->params->line_search == line_search_NEAREST)
		ISA(nearest_plan)(f, a);
	if (f->params->line_search == line_search_NEAREST || f->search_planned)
		return;
	f->search_planned = true;
	f->search = made = arena_take(a, 1, sizeof *made);
	s.held = arena_take(a, pixels, sizeof(uint16_t));
	s.next = arena_take(a, pixels, sizeof(uint16_t));
	if (f->params->line_search == line_search_WALK) {
		s.blurred = arena_take(a, pixels, sizeof(float));
		s.gap = arena_take(a, pixels, sizeof(uint8_t));
		s.column = arena_take(a, column_size(f) * (size_t)bands_threads(f->bands), sizeof(float));
		s.rows = arena_take(a, (width + 2 * STEPS) * (size_t)bands_threads(f->bands), sizeof(uint8_t));
	}
	if (made)
		*made = s;
}

int32_t ISA(search_run)(frame *f)
{
	job j = {.f = f, .s = f->search};
	if (f->params->line_search == line_search_NEAREST)
		return ISA(nearest_run)(f);
	if (f->search_done)
		return ENCRE_OK;
	f->search_done = true;
	if (f->params->line_search == line_search_WALK)
		return walk_all(&j);
	int32_t code = bands_run(f->bands, f->height, 0, own_rows, &j);
	return code ? code : hold_nearest(&j, STEPS);
}
