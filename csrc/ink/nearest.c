/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The Euclidean-nearest edge pixel of every pixel, exactly, in time that does not depend on distances: first along
 * columns, then along rows by the lower envelope of parabolas (Meijster, Roerdink & Hesselink 2000). Of edges at
 * the same distance the one in the least row, then in the least column is taken, which is the envelope of parabolas
 * raised by an infinitesimal amount per row, and so holds together. */
#include "fine/near.h"
#include "ink/discs.h"

#include <math.h>

enum { STRIPE = 256, FAR = INT16_MAX /* as far or farther */ };

typedef struct nearest {
	int16_t *down;  /* width * height: rows down to the nearest edge of the column, NEAREST_NONE = none within reach
			 */
	int32_t *stack; /* per thread: columns whose parabolas make the envelope, and where each begins */
	int reach;
} nearest;

typedef struct job {
	const frame *f;
	nearest *n;
} job;

/* ---- columns --------------------------------------------------------------------------------------------- */

/* Rows since the last edge, saturated. */
static void step(const uint8_t *restrict edge, int n, int16_t *restrict since)
{
	for (int x = 0; x < n; x++) {
		int16_t next = (int16_t)(since[x] < FAR ? since[x] + 1 : FAR);
		since[x] = edge[x] ? 0 : next;
	}
}

static void turn_up(const int16_t *restrict since, int n, int16_t *restrict down)
{
	for (int x = 0; x < n; x++)
		down[x] = (int16_t)-since[x];
}

/* An edge above is in a lesser row than one as far below. */
static void turn_down(const int16_t *restrict since, int n, int reach, int16_t *restrict down)
{
	for (int x = 0; x < n; x++) {
		int up = -down[x], below = since[x], best = up <= below ? -up : below;
		down[x] = (int16_t)(best > reach || -best > reach ? NEAREST_NONE : best);
	}
}

/* "Rows" are stripes of columns here, as the sweeps need whole columns. */
static void column_stripes(void *data, int s0, int s1, int thread)
{
	(void)thread;
	const job *j = data;
	const frame *f = j->f;
	for (int s = s0; s < s1; s++) {
		int x0 = s * STRIPE, n = f->width - x0 < STRIPE ? f->width - x0 : STRIPE;
		int16_t since[STRIPE];
		for (int x = 0; x < n; x++)
			since[x] = FAR;
		for (int y = 0; y < f->height && !bands_stopped(f->bands); y++) {
			size_t at = (size_t)y * (size_t)f->width + (size_t)x0;
			step(f->edge + at, n, since);
			turn_up(since, n, j->n->down + at);
		}
		for (int x = 0; x < n; x++)
			since[x] = FAR;
		for (int y = f->height - 1; y >= 0 && !bands_stopped(f->bands); y--) {
			size_t at = (size_t)y * (size_t)f->width + (size_t)x0;
			step(f->edge + at, n, since);
			turn_down(since, n, j->n->reach, j->n->down + at);
		}
	}
}

/* ---- rows ------------------------------------------------------------------------------------------------ */

static int64_t square(int64_t x)
{
	return x * x;
}

/* The last pixel at which column i has a nearer edge than column u > i. */
static int last_before(int i, int u, const int16_t *down)
{
	int64_t up = square(u) - square(i) + square(down[u]) - square(down[i]), run = 2 * ((int64_t)u - i);
	int64_t q = up / run;
	/* Rounded towards 0; or equally far, and u's edge is in a lesser row. */
	if (q * run > up || (q * run == up && down[u] < down[i]))
		q--;
	return (int)(q < -1 ? -1 : q > INT32_MAX - 1 ? INT32_MAX - 1 : q);
}

static void nearest_row(const int16_t *down, int width, int32_t *column, int32_t *begin, int16_t *out)
{
	int top = -1;
	for (int u = 0; u < width; u++) {
		if (down[u] == NEAREST_NONE)
			continue;
		int from = 0;
		while (top >= 0 && (from = last_before(column[top], u, down) + 1) <= begin[top])
			top--;
		if (top < 0)
			from = 0;
		if (from >= width)
			continue;
		column[++top] = u;
		begin[top] = from;
	}
	int end = width;
	for (; top >= 0; top--) {
		int u = column[top], dy = down[u];
		for (int x = begin[top]; x < end; x++) {
			int64_t far = square(u - x) + square(dy);
			out[2 * x] = (int16_t)(far <= square(FAR) ? u - x : NEAREST_NONE);
			out[2 * x + 1] = (int16_t)dy;
		}
		end = begin[top];
	}
	for (int x = 0; x < end; x++)
		out[2 * x] = NEAREST_NONE;
}

static void nearest_rows(void *data, int y0, int y1, int thread)
{
	const job *j = data;
	size_t width = (size_t)j->f->width;
	int32_t *stack = j->n->stack + (size_t)thread * 2 * width;
	for (int y = y0; y < y1 && !bands_stopped(j->f->bands); y++)
		nearest_row(j->n->down + (size_t)y * width, j->f->width, stack, stack + width,
			    j->f->nearest + (size_t)y * width * 2);
}

/* ---- sites ----------------------------------------------------------------------------------------------- */

/* Looks at the members of a row of cells from `from` on in steps of `step` until they can't be nearer than `best`. */
static float nearest_along(const fine *n, uint32_t from, uint32_t end, int step, float x, float y, float best,
			   float way[2])
{
	for (uint32_t i = from; i != end; i += (uint32_t)step) {
		const site *s = n->site + n->member[i];
		float dx = s->placed.x - x, dy = s->placed.y - y, d2 = dx * dx + dy * dy;
		/* members of a cell lie in any order, and those beyond the frame in its first or last one */
		float ahead = fabsf(min(max(s->placed.x, 0), (float)(n->f->width - 1)) - x);
		if (step * dx > 0 && ahead > CELL + 1 && (ahead - CELL - 1) * (ahead - CELL - 1) > best)
			break;
		if (s->linked.dropped || d2 >= best)
			continue;
		best = d2;
		way[0] = dx;
		way[1] = dy;
	}
	return best;
}

static bool nearest_site(const fine *n, int x, int y, float reach, float way[2])
{
	float limit = reach * reach * 1.0001f + 1e-4f, best = limit;
	for (int k = 0; k < 2 * n->tall; k++) { /* rows of cells: own, one below, one above, two below... */
		int beyond = (k + 1) / 2, row = y / CELL + (k % 2 ? beyond : -beyond);
		/* to the rows beyond the last ones; a site may lie outside of the frame, and so of its cell */
		float ahead = (float)((beyond - 1) * CELL - 1);
		if (ahead > 0 && ahead * ahead > best)
			break;
		if (row < 0 || row >= n->tall)
			continue;
		const uint32_t *cell = n->cell + (ptrdiff_t)row * n->across;
		uint32_t own = cell[x / CELL];
		best = nearest_along(n, own, cell[n->across], 1, (float)x, (float)y, best, way);
		best = nearest_along(n, own - 1, cell[0] - 1, -1, (float)x, (float)y, best, way);
	}
	return best < limit;
}

/* ---- what stages call ------------------------------------------------------------------------------------ */

void ISA(nearest_plan)(frame *f, arena *a)
{
	if (is_held(f))
		ISA(search_plan)(f, a);
	if (is_held(f) || f->nearest_planned || f->params->edge_detector == edge_detector_FINE)
		return;
	size_t width = (size_t)f->width, pixels = width * (size_t)f->height;
	nearest *n = arena_take(a, 1, sizeof *n),
		made = {
			.down = arena_take(a, pixels, sizeof(int16_t)),
			.stack = arena_take(a, (size_t)bands_threads(f->bands) * width, 2 * sizeof(int32_t)),
			.reach = (int)min(nearest_reach(f->params, f->n_styles, f->scale) + 1, NEAREST_FAR),
		};
	f->nearest = arena_take(a, pixels, 2 * sizeof(int16_t));
	f->nearest_planned = true;
	f->nearest_scratch = n;
	if (n)
		*n = made;
}

int32_t ISA(nearest_run)(frame *f)
{
	if (is_held(f))
		return ISA(search_run)(f);
	if (!f->nearest_scratch)
		return ENCRE_OK;
	job j = {f, f->nearest_scratch};
	int32_t code = bands_run(f->bands, (f->width - 1) / STRIPE + 1, 1, column_stripes, &j);
	if (!code)
		code = bands_run(f->bands, f->height, 0, nearest_rows, &j);
	if (!code)
		f->nearest_scratch = NULL;
	return code;
}

bool ISA(nearest_edge)(const frame *f, int x, int y, float reach, float way[2])
{
	if (f->fine)
		return nearest_site(f->fine, x, y, reach, way);
	if (is_held(f)) {
		int dx, dy;
		bool held = held_at(f, (size_t)y * (size_t)f->width + (size_t)x, &dx, &dy);
		way[0] = (float)dx;
		way[1] = (float)dy;
		return held;
	}
	const int16_t *to = f->nearest + 2 * ((ptrdiff_t)y * f->width + x);
	way[0] = to[0];
	way[1] = to[1];
	return to[0] != NEAREST_NONE;
}
