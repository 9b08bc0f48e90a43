/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Light from which the denoiser could not take all noise, evened out, so that levels of it end in smooth curves.
 *
 * What the denoiser leaves are streaks and clouds, some part of the noise that was there; on soft light they move far
 * the place where it reaches a threshold. How much noise there was is told by neighbours in the light as rendered.
 * Light moves towards the mean of two places on either side of it, where they lie on the same surface and that mean
 * differs by no more than such noise: so slopes stay as they are, however steep, shadows keep their edges, and what had
 * no noise keeps every byte. Passes at several distances reach far with few places (a transform with holes: Dammertz et
 * al. 2010), the farthest first: the last then takes away what lies between their holes.
 *
 * What is left are islands where light lies flat: levels would be filled and outlined in crumbs. A place that is
 * brighter, or darker, than all about it by less than the noise as rendered comes down, or up, to the nearest of those.
 * Only peaks and pits change, no slope and no ridge. Last, curves of equal light are made calm (along.c). Where light
 * is the border of a soft shadow none of this is done, which would move it: there it is averaged along the border. */
#include "samples/even.h"

#include <stdlib.h>

/* Of a pass: pixels, and how many standard deviations of the noise as rendered a mean may differ by. Far places lie on
 * other slopes more often, and of clouds that large the denoiser leaves less. */
static const int step_of[PASSES] = {16, 8, 4, 2, 1};
static const float most_of[PASSES] = {1.5f, 1.5f, 2, 3, 3};
static const float weight_of[AHEAD] = {4, 4, 2, 2};
enum {
	ASIDE = 5,
	ABOUT = 3
}; /* pixels to the windows beside one; directions in which a peak's surroundings are known */
enum { ROWS = 256, PIXELS = 1 << 20 }; /* of a strip: so many, or rows of so many pixels */
static const float nil = 1.0f / 3000;  /* of the light: less is no noise */
static const float most_bend = 0.003f; /* of 1/depth, and of the normal: more is another surface */
static const float most_turn = 0.2f;
static const float least_known = 0.2f; /* of a window: with less of one surface in it, it tells of no noise */

/* 16 + 8 + 4 + 2 + 1 of the passes, 8 + 4 + 2 + 1 of peaks, 1 + 2 + ASIDE of the noise, 10 of along.c, which at borders
 * alone reaches 8 * 3 + 2 + 2 * 7. */
_Static_assert(REACH == 31 + 15 + 3 + ASIDE + 10, "what is around a strip");

void ISA(even_mean)(const evener *e, int plane, int y, int apart, float *scratch, float *out)
{
	const float *r[5];
	for (int k = 0; k < 5; k++)
		r[k] = even_row(e, plane, y + (k - 2) * apart);
	for (int x = 0; x < e->width; x++)
		scratch[x] = (r[2][x] + r[3][x] + r[1][x] + r[4][x] + r[0][x]) / 5;
	even_across(e, scratch, apart, out);
}

/* ---- what there is --------------------------------------------------------------------------------------- */

static float limited(float x)
{
	return min(max(x, -pixel_great), pixel_great);
}

static void load_rows(void *data, int y0, int y1, int thread)
{
	(void)thread;
	const evener *e = data;
	const encre_even_job *j = e->job;
	for (int y = y0; y < y1; y++) {
		float *to[EVEN_VALUE + 1];
		for (int k = 0; k <= EVEN_VALUE; k++)
			to[k] = even_row(e, k, y);
		for (int x = 0; x < e->width; x++) {
			const float *light = pixel_at(&j->light, x, e->top + y),
				    *rendered = pixel_at(&j->rendered, x, e->top + y),
				    *normal = pixel_at(&j->normal, x, e->top + y);
			float z = *pixel_at(&j->depth, x, e->top + y);
			to[EVEN_NEAR][x] = z > 0 && z < depth_end ? min(1 / z, pixel_great) : 0;
			for (int c = 0; c < 3; c++)
				to[EVEN_NORMAL + c][x] = limited(normal[c]);
			to[EVEN_NUMBER][x] = j->object.data ? *pixel_at(&j->object, x, e->top + y) : 0;
			to[EVEN_RENDERED][x] = limited(max3(rendered[0], rendered[1], rendered[2]));
			to[EVEN_GIVEN][x] = to[EVEN_VALUE][x] = limited(max3(light[0], light[1], light[2]));
		}
		for (int k = EVEN_GIVEN; y < e->own && k <= EVEN_VALUE; k++)
			memcpy(to[k], e->above + (ptrdiff_t)y * e->width, (size_t)e->width * sizeof *to[k]);
		for (int k = 0; k <= EVEN_VALUE; k++)
			even_pad(to[k], e->width);
	}
}

/* Whether both places of a pixel show what it shows. Called with a constant direction. */
KERNEL void same_row(const evener *e, int y, int step, int ahead, uint8_t *restrict mask)
{
	int dy = step * even_ahead[ahead][0], dx = step * even_ahead[ahead][1];
	float bend = most_bend * (step > 2 ? (float)step / 2 : 1);
	const float *own[5], *one[5], *two[5];
	for (int c = 0; c < 5; c++) {
		own[c] = even_row(e, EVEN_NEAR + c, y);
		one[c] = even_row(e, EVEN_NEAR + c, y + dy) + dx;
		two[c] = even_row(e, EVEN_NEAR + c, y - dy) - dx;
	}
	for (int x = 0; x < e->width; x++) {
		float near = own[0][x], turn = 0;
		for (int c = 1; c < 4; c++) {
			float off = one[c][x] + two[c][x] - 2 * own[c][x];
			turn += off * off;
		}
		int same = (fabsf(one[0][x] + two[0][x] - 2 * near) < bend * near) & (turn < most_turn * most_turn) &
			   (one[4][x] == own[4][x]) & (two[4][x] == own[4][x]);
		mask[x] = (uint8_t)(mask[x] | same << ahead);
	}
}

static void same_rows(void *data, int y0, int y1, int thread)
{
	(void)thread;
	const evener *e = data;
	for (int y = y0; y < y1 && !bands_stopped(e->bands); y++)
		for (int k = 0; k < PASSES; k++) {
			uint8_t *mask = e->same[k] + (ptrdiff_t)y * e->width;
			memset(mask, 0, (size_t)e->width);
			same_row(e, y, step_of[k], ACROSS, mask);
			same_row(e, y, step_of[k], DOWN, mask);
			same_row(e, y, step_of[k], DOWN_RIGHT, mask);
			same_row(e, y, step_of[k], DOWN_LEFT, mask);
		}
}

/* ---- how much noise there was ---------------------------------------------------------------------------- */

/* What slopes and folds do not explain (Immerkaer 1996), squared; and where that is known. */
static void rest_rows(void *data, int y0, int y1, int thread)
{
	(void)thread;
	const evener *e = data;
	for (int y = y0; y < y1; y++) {
		const uint8_t *mask = e->same[LAST_PASS] + (ptrdiff_t)y * e->width;
		const float *v = even_row(e, EVEN_RENDERED, y), *up = even_row(e, EVEN_RENDERED, y - 1),
			    *down = even_row(e, EVEN_RENDERED, y + 1), *given = even_row(e, EVEN_GIVEN, y);
		float *rest = even_row(e, EVEN_SPARE, y), *whole = even_row(e, EVEN_SPARE + 1, y),
		      *off = even_row(e, EVEN_SPARE + 2, y);
		for (int x = 0; x < e->width; x++) {
			float r = 4 * v[x] - 2 * (v[x + 1] + v[x - 1]) - 2 * (down[x] + up[x]) +
				  (down[x + 1] + up[x - 1]) + (down[x - 1] + up[x + 1]);
			float known = mask[x] == ALL_AHEAD ? 1 : 0;
			rest[x] = known * (r * r / 36);
			whole[x] = known;
			off[x] = (v[x] - given[x]) * (v[x] - given[x]);
		}
	}
}

static void window_rows(void *data, int y0, int y1, int thread)
{
	const evener *e = data;
	float *scratch = even_scratch(e, thread, 0), *share = even_scratch(e, thread, 1);
	for (int y = y0; y < y1 && !bands_stopped(e->bands); y++) {
		float *square = even_row(e, EVEN_SPARE + 3, y), *taken = even_row(e, EVEN_TAKEN, y);
		const float *given = even_row(e, EVEN_GIVEN, y);
		ISA(even_mean)(e, EVEN_SPARE, y, 1, scratch, square);
		ISA(even_mean)(e, EVEN_SPARE + 1, y, 1, scratch, share);
		ISA(even_mean)(e, EVEN_SPARE + 2, y, 1, scratch, taken);
		for (int x = 0; x < e->width; x++) {
			float over = share[x] > least_known ? share[x] : 1;
			square[x] = share[x] > least_known ? square[x] / over : FLT_MAX;
			taken[x] = 2 * sqrtf(taken[x]) - nil * given[x];
		}
	}
}

/* Least of the windows about a pixel: edges of shadows are not noise. */
static void noise_rows(void *data, int y0, int y1, int thread)
{
	const evener *e = data;
	float *least = even_scratch(e, thread, 0);
	for (int y = y0; y < y1; y++) {
		const float *own = even_row(e, EVEN_SPARE + 3, y), *up = even_row(e, EVEN_SPARE + 3, y - ASIDE),
			    *down = even_row(e, EVEN_SPARE + 3, y + ASIDE), *given = even_row(e, EVEN_GIVEN, y);
		float *noise = even_row(e, EVEN_NOISE, y);
		for (int x = 0; x < e->width; x++)
			least[x] = min(own[x], min(up[x], down[x]));
		even_pad(least, e->width);
		for (int x = 0; x < e->width; x++) {
			float found = min(least[x], min(least[x + ASIDE], least[x - ASIDE]));
			noise[x] = sqrtf(found < FLT_MAX ? found : 0) - nil * given[x];
		}
	}
}

/* ---- evened out ------------------------------------------------------------------------------------------ */

/* What a pass does now. */
typedef struct passing {
	const evener *e;
	int pass;
} passing;

/* The means of pairs, weighted as a B-spline and by how little they differ. Called with a constant direction. */
KERNEL void add_pairs(const passing *p, int y, int ahead, const float *restrict most, float *restrict total,
		      float *restrict weights)
{
	const evener *e = p->e;
	int dy = step_of[p->pass] * even_ahead[ahead][0], dx = step_of[p->pass] * even_ahead[ahead][1];
	const uint8_t *mask = e->same[p->pass] + (ptrdiff_t)y * e->width;
	const float *own = even_row(e, EVEN_VALUE, y), *one = even_row(e, EVEN_VALUE, y + dy) + dx,
		    *two = even_row(e, EVEN_VALUE, y - dy) - dx;
	float weight = weight_of[ahead];
	for (int x = 0; x < e->width; x++) {
		float off = (one[x] + two[x]) * 0.5f - own[x], limit = most[x];
		float share = off / (limit > 0 ? limit : 1), alike = 1 - share * share;
		int counts = (mask[x] >> ahead & 1) & (limit > 0) & (alike > 0);
		alike = counts ? weight * alike * alike : 0;
		weights[x] += alike;
		total[x] += alike * off;
	}
}

static void pass_rows(void *data, int y0, int y1, int thread)
{
	const passing *p = data;
	const evener *e = p->e;
	float *total = even_scratch(e, thread, 0), *weights = even_scratch(e, thread, 1),
	      *most = even_scratch(e, thread, 2);
	for (int y = y0; y < y1 && !bands_stopped(e->bands); y++) {
		const float *own = even_row(e, EVEN_VALUE, y), *noise = even_row(e, EVEN_NOISE, y);
		float *out = even_row(e, EVEN_NEXT, y);
		for (int x = 0; x < e->width; x++) {
			total[x] = 0;
			weights[x] = 4;
			most[x] = most_of[p->pass] * noise[x];
		}
		add_pairs(p, y, ACROSS, most, total, weights);
		add_pairs(p, y, DOWN, most, total, weights);
		add_pairs(p, y, DOWN_RIGHT, most, total, weights);
		add_pairs(p, y, DOWN_LEFT, most, total, weights);
		for (int x = 0; x < e->width; x++)
			out[x] = own[x] + total[x] / weights[x];
		even_pad(out, e->width);
	}
}

/* The highest and the lowest of the places about a pixel, and in how many directions they are known. */
KERNEL void bound_by(const passing *p, int y, int ahead, float *restrict high, float *restrict low,
		     int32_t *restrict known)
{
	const evener *e = p->e;
	int dy = step_of[p->pass] * even_ahead[ahead][0], dx = step_of[p->pass] * even_ahead[ahead][1];
	const uint8_t *mask = e->same[p->pass] + (ptrdiff_t)y * e->width;
	const float *one = even_row(e, EVEN_VALUE, y + dy) + dx, *two = even_row(e, EVEN_VALUE, y - dy) - dx;
	for (int x = 0; x < e->width; x++) {
		int here = mask[x] >> ahead & 1;
		float more = max(one[x], two[x]), less = min(one[x], two[x]);
		high[x] = (here & (more > high[x])) ? more : high[x];
		low[x] = (here & (less < low[x])) ? less : low[x];
		known[x] += here;
	}
}

/* Peaks lowered, and pits raised, by less than the noise. */
static void level_rows(void *data, int y0, int y1, int thread)
{
	const passing *p = data;
	const evener *e = p->e;
	float *high = even_scratch(e, thread, 0), *low = even_scratch(e, thread, 1);
	int32_t *known = (int32_t *)even_scratch(e, thread, 2);
	for (int y = y0; y < y1 && !bands_stopped(e->bands); y++) {
		const float *own = even_row(e, EVEN_VALUE, y), *noise = even_row(e, EVEN_NOISE, y);
		float *out = even_row(e, EVEN_NEXT, y);
		for (int x = 0; x < e->width; x++) {
			high[x] = -FLT_MAX;
			low[x] = FLT_MAX;
			known[x] = 0;
		}
		bound_by(p, y, ACROSS, high, low, known);
		bound_by(p, y, DOWN, high, low, known);
		bound_by(p, y, DOWN_RIGHT, high, low, known);
		bound_by(p, y, DOWN_LEFT, high, low, known);
		for (int x = 0; x < e->width; x++) {
			float near = min(max(own[x], low[x]), high[x]);
			int moves = (known[x] >= ABOUT) & (fabsf(near - own[x]) < noise[x]);
			out[x] = moves ? near : own[x];
		}
		even_pad(out, e->width);
	}
}

static void finish_rows(void *data, int y0, int y1, int thread)
{
	(void)thread;
	const evener *e = data;
	for (int y = y0 + e->own; y < y1 + e->own; y++) {
		const float *value = even_row(e, EVEN_VALUE, y), *given = even_row(e, EVEN_GIVEN, y),
			    *border = even_row(e, EVEN_BORDER, y), *sure = even_row(e, EVEN_SURE, y);
		for (int x = 0; x < e->width; x++) {
			float smooth = value[x] + sure[x] * (border[x] - value[x]);
			float factor = given[x] > 0 ? smooth / given[x] : 1;
			float *light = pixel_at(&e->job->light, x, e->top + y);
			for (int c = 0; c < 3; c++)
				light[c] *= fabsf(factor) <= FLT_MAX ? factor : 1;
		}
	}
}

/* ---- the whole ------------------------------------------------------------------------------------------- */

static void turn(evener *e)
{
	float *next = e->plane[EVEN_NEXT];
	e->plane[EVEN_NEXT] = e->plane[EVEN_VALUE];
	e->plane[EVEN_VALUE] = next;
}

static int32_t even_strip(evener *e)
{
	const bands_kernel first[] = {load_rows, same_rows, rest_rows, window_rows, noise_rows};
	int32_t code = ENCRE_OK;
	for (int k = 0; !code && k < 5; k++)
		code = bands_run(e->bands, e->rows, 0, first[k], e);
	for (int k = 0; !code && k < PASSES; k++) {
		passing p = {e, k};
		code = bands_run(e->bands, e->rows, 0, pass_rows, &p);
		turn(e);
	}
	for (int k = LEVELLED_FROM; !code && k < PASSES; k++) {
		passing p = {e, k};
		code = bands_run(e->bands, e->rows, 0, level_rows, &p);
		turn(e);
	}
	code = code ? code : ISA(even_border)(e);
	code = code ? code : ISA(even_calm)(e);
	turn(e);
	for (int y = 0; !code && y < REACH && e->own_end >= REACH; y++)
		memcpy(e->above + (ptrdiff_t)y * e->width, even_row(e, EVEN_GIVEN, e->own_end - REACH + y),
		       (size_t)e->width * sizeof *e->above);
	return code ? code : bands_run(e->bands, e->own_end - e->own, 0, finish_rows, e);
}

static void plan(evener *e, int rows, arena *a)
{
	size_t width = (size_t)e->width, height = (size_t)rows;
	e->stride = (ptrdiff_t)((width + 2 * PAD + 15) & ~(size_t)15);
	for (int k = 0; k < EVEN_PLANES; k++)
		e->plane[k] = arena_take(a, height * (size_t)e->stride, sizeof *e->plane[k]);
	for (int k = 0; k < PASSES; k++)
		e->same[k] = arena_take(a, height * width, 1);
	e->above = arena_take(a, (size_t)REACH * width, sizeof *e->above);
	e->scratch = arena_take(a, (size_t)bands_threads(e->bands) * 8 * (size_t)e->stride, sizeof *e->scratch);
}

int32_t ISA(even_run)(bands *pool, const encre_even_job *job)
{
	evener e = {.job = job, .bands = pool, .width = job->light.width, .height = job->light.height};
	int most = PIXELS / e.width > ROWS ? PIXELS / e.width : ROWS, strips = (e.height - 1) / most + 1;
	int each = (e.height - 1) / strips + 1, rows = each + 2 * REACH < e.height ? each + 2 * REACH : e.height;
	arena a = {0};
	plan(&e, rows, &a);
	void *memory = arena_make(&a);
	if (!memory)
		return ENCRE_ERROR_MEMORY;
	plan(&e, rows, &a);
	int32_t code = ENCRE_OK;
	for (int first = 0; !code && first < e.height; first += each) {
		int end = first + each < e.height ? first + each : e.height,
		    last = end + REACH < e.height ? end + REACH : e.height;
		e.top = first > REACH ? first - REACH : 0;
		e.rows = last - e.top;
		e.own = first - e.top;
		e.own_end = end - e.top;
		bands_span(pool, (double)first / e.height, (double)end / e.height);
		code = even_strip(&e);
	}
	free(memory);
	return code;
}
