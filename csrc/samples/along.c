/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Curves of equal light made calm: light is averaged along them, never across (line integral convolution along the
 * least eigenvector of the smoothed structure tensor: Kyprianidis and Kang 2011). What noise has left at a wide
 * penumbra lets its levels end in stairs, which no mean over an area takes away without moving them.
 *
 * Means of far pairs move a level where light bends across them, as in the border of a soft shadow. There the noise
 * that is left is taken from along a longer way: what light is at its middle tells a parabola through it, so that
 * neither a way that turns off the level a little, nor a level that curves, moves it (Savitzky and Golay 1964).
 *
 * A way goes from pixel to pixel as light turns, and ends where it turns no way more than another, or at an outline or
 * a fold. Pairs of places on both sides count as they do in even.c. */
#include "samples/even.h"

/* Of a way to both sides. */
typedef struct reach {
	int paces;
	float pixels; /* of a pace */
} reach;
static const reach calmed = {6, 1}, bordered = {8, 3};
enum { MOST_PACES = 8 };
static const float one_way = 0.5f;     /* of the structure tensor's eigenvalues, how much of their sum they differ by */
static const float flat = 1.0f / 16;   /* of what light may be off by: where its slope is less nothing tells its way */
static const float slopes = 1.0f / 12; /* likewise: a border is where it changes by more from a pixel to the next */
static const float least_fit = 1e-6f;

/* ---- ways ------------------------------------------------------------------------------------------------ */

/* Slopes of a plane, 0 where a place on either side is of another surface; with `whole` where any place about is. */
typedef struct sloping {
	const evener *e;
	int plane;
	bool whole;
} sloping;

static void slope_rows(void *data, int y0, int y1, int thread)
{
	(void)thread;
	const sloping *s = data;
	const evener *e = s->e;
	for (int y = y0; y < y1; y++) {
		const uint8_t *mask = e->same[LAST_PASS] + (ptrdiff_t)y * e->width;
		const float *own = even_row(e, s->plane, y), *up = even_row(e, s->plane, y - 1),
			    *down = even_row(e, s->plane, y + 1);
		float *dy = even_row(e, EVEN_DOWN, y), *dx = even_row(e, EVEN_RIGHT, y);
		int in_dy = s->whole ? ALL_AHEAD : 1 << DOWN, in_dx = s->whole ? ALL_AHEAD : 1 << ACROSS;
		for (int x = 0; x < e->width; x++) {
			dy[x] = (mask[x] & in_dy) == in_dy ? (down[x] - up[x]) * 0.5f : 0;
			dx[x] = (mask[x] & in_dx) == in_dx ? (own[x + 1] - own[x - 1]) * 0.5f : 0;
		}
	}
}

/* The way (down, right) along which light stays as it is, of length 1, by the means a, b, c of the products of its
 * slopes; 0, 0 where there is none. */
static inline void way_of(float a, float b, float c, bool known, float *down, float *right)
{
	float half = (a - c) * 0.5f, root = sqrtf(half * half + b * b);
	float up = half > 0 ? half + root : b, across = half > 0 ? b : root - half;
	float length = sqrtf(up * up + across * across);
	int clear = (length > 0) & (length < INFINITY) & (2 * root > one_way * (a + c)) & (int)known;
	float over = clear ? length : 1;
	*down = clear ? -across / over : 0;
	*right = clear ? up / over : 0;
}

/* ---- along them ------------------------------------------------------------------------------------------ */

/* Where ways and light lie. */
typedef struct field {
	const evener *e;
	int light, down, right; /* planes */
} field;

static inline ptrdiff_t place_of(const evener *e, int y, int x)
{
	return clamp_index(y, e->rows) * e->stride + PAD + clamp_index(x, e->width);
}

static inline int to_int(float x)
{
	return (int)floorf(x);
}

/* Light at each pace from a pixel; how many there are. A pace goes as the way does at its middle, which stays on a
 * round curve. */
static int walk(const field *f, int row, int column, float side, reach far, float *found)
{
	const evener *e = f->e;
	const float *down = e->plane[f->down], *right = e->plane[f->right], *light = e->plane[f->light];
	ptrdiff_t own = place_of(e, row, column);
	float y = 0, x = 0, wy = side * far.pixels * down[own], wx = side * far.pixels * right[own];
	for (int k = 0; k < far.paces; k++) {
		ptrdiff_t middle =
			place_of(e, row + to_int(y + wy * 0.5f + 0.5f), column + to_int(x + wx * 0.5f + 0.5f));
		float ny = down[middle], nx = right[middle];
		float turned = ny * wy + nx * wx < 0 ? -far.pixels : far.pixels;
		if (ny == 0 && nx == 0)
			return k;
		wy = turned * ny;
		wx = turned * nx;
		y += wy;
		x += wx;
		ptrdiff_t here = place_of(e, row + to_int(y + 0.5f), column + to_int(x + 0.5f));
		if (down[here] == 0 && right[here] == 0)
			return k;
		int top = row + to_int(y), left = column + to_int(x);
		float fy = y - floorf(y), fx = x - floorf(x), level[2];
		for (int i = 0; i < 2; i++)
			level[i] = light[place_of(e, top + i, left)] * (1 - fx) +
				   light[place_of(e, top + i, left + 1)] * fx;
		found[k] = level[0] + (level[1] - level[0]) * fy;
	}
	return far.paces;
}

/* Of pairs on both sides of a pixel: weights by powers 0, 2, 4 of the way to them, its whole being 1; and by how far
 * they are off, without and with the square of the way. */
typedef struct sums {
	float weight[3], off[2];
} sums;

static sums sums_of(const field *f, int row, int column, float most, reach far)
{
	float one[MOST_PACES], two[MOST_PACES], own = f->e->plane[f->light][place_of(f->e, row, column)];
	int n = walk(f, row, column, 1, far, one), m = walk(f, row, column, -1, far, two);
	sums s = {.weight = {1}};
	for (int k = 0; k < n && k < m; k++) {
		float off = (one[k] + two[k]) * 0.5f - own, share = off / most, alike = 1 - share * share;
		float pace = (float)(k + 1) / (float)(far.paces + 1), way = (float)(k + 1) / (float)far.paces;
		float by = alike > 0 ? 2 * (1 - pace * pace) * alike * alike : 0, square = way * way;
		s.weight[0] += by;
		s.weight[1] += by * square;
		s.weight[2] += by * (square * square);
		s.off[0] += by * off;
		s.off[1] += by * square * off;
	}
	return s;
}

/* ---- calm ------------------------------------------------------------------------------------------------ */

enum { WAY_DOWN = EVEN_SPARE, WAY_RIGHT, STEEP };

/* Sums of a product of slopes over the five rows about y. */
static void product_sum(const evener *e, int one, int two, int y, float *restrict sum)
{
	const float *a[5], *b[5];
	for (int k = 0; k < 5; k++) {
		a[k] = even_row(e, one, y + k - 2);
		b[k] = even_row(e, two, y + k - 2);
	}
	for (int x = 0; x < e->width; x++)
		sum[x] = (a[2][x] * b[2][x] + a[3][x] * b[3][x] + a[1][x] * b[1][x] + a[4][x] * b[4][x] +
			  a[0][x] * b[0][x]) /
			 5;
}

/* How steep light is all together, too. */
static void way_rows(void *data, int y0, int y1, int thread)
{
	const evener *e = data;
	float *sum = even_scratch(e, thread, 0), *mean[3];
	for (int k = 0; k < 3; k++)
		mean[k] = even_scratch(e, thread, 1 + k);
	for (int y = y0; y < y1 && !bands_stopped(e->bands); y++) {
		const uint8_t *mask = e->same[LAST_PASS] + (ptrdiff_t)y * e->width;
		float *down = even_row(e, WAY_DOWN, y), *right = even_row(e, WAY_RIGHT, y),
		      *steep = even_row(e, STEEP, y);
		for (int k = 0; k < 3; k++) {
			product_sum(e, k < 2 ? EVEN_DOWN : EVEN_RIGHT, k > 0 ? EVEN_RIGHT : EVEN_DOWN, y, sum);
			even_across(e, sum, 1, mean[k]);
		}
		for (int x = 0; x < e->width; x++) {
			way_of(mean[0][x], mean[1][x], mean[2][x], mask[x] == ALL_AHEAD, down + x, right + x);
			steep[x] = mean[0][x] + mean[2][x];
		}
	}
}

static void calm_rows(void *data, int y0, int y1, int thread)
{
	(void)thread;
	const evener *e = data;
	field f = {e, EVEN_VALUE, WAY_DOWN, WAY_RIGHT};
	for (int y = y0; y < y1 && !bands_stopped(e->bands); y++) {
		const float *own = even_row(e, EVEN_VALUE, y), *most = even_row(e, EVEN_TAKEN, y),
			    *steep = even_row(e, STEEP, y), *down = even_row(e, WAY_DOWN, y),
			    *right = even_row(e, WAY_RIGHT, y);
		float *out = even_row(e, EVEN_NEXT, y);
		for (int x = 0; x < e->width; x++) {
			float limit = most[x] * flat;
			out[x] = own[x];
			if (!(most[x] > 0 && steep[x] > limit * limit) || (down[x] == 0 && right[x] == 0))
				continue;
			sums s = sums_of(&f, y, x, most[x], calmed);
			out[x] += s.off[0] / s.weight[0];
		}
	}
}

int32_t ISA(even_calm)(evener *e)
{
	sloping s = {e, EVEN_VALUE, false};
	int32_t code = bands_run(e->bands, e->rows, 0, slope_rows, &s);
	code = code ? code : bands_run(e->bands, e->rows, 0, way_rows, e);
	return code ? code : bands_run(e->bands, e->rows, 0, calm_rows, e);
}

/* ---- borders of soft shadows ----------------------------------------------------------------------------- */

/* Means over what is of one surface, of: slopes down and right, their products, and how much is of one. FROM and TO
 * take turns as the places of a mean lie 1, 2 and 4 pixels apart. */
enum { MEAN_DOWN, MEAN_RIGHT, MEAN_A, MEAN_B, MEAN_C, MEAN_SHARE, MEANS, FROM = EVEN_NEAR, TO = EVEN_SPARE };
_Static_assert(FROM + MEANS <= EVEN_GIVEN && TO + MEANS <= EVEN_PLANES, "planes for means");

static void first_rows(void *data, int y0, int y1, int thread)
{
	const evener *e = data;
	float *sum = even_scratch(e, thread, 0);
	for (int y = y0; y < y1 && !bands_stopped(e->bands); y++) {
		const uint8_t *mask[5];
		for (int k = 0; k < 5; k++)
			mask[k] = e->same[LAST_PASS] + (ptrdiff_t)clamp_index(y + k - 2, e->rows) * e->width;
		ISA(even_mean)(e, EVEN_DOWN, y, 1, sum, even_row(e, FROM + MEAN_DOWN, y));
		ISA(even_mean)(e, EVEN_RIGHT, y, 1, sum, even_row(e, FROM + MEAN_RIGHT, y));
		for (int k = 0; k < 3; k++) {
			product_sum(e, k < 2 ? EVEN_DOWN : EVEN_RIGHT, k > 0 ? EVEN_RIGHT : EVEN_DOWN, y, sum);
			even_across(e, sum, 1, even_row(e, FROM + MEAN_A + k, y));
		}
		for (int x = 0; x < e->width; x++) {
			int n = 0;
			for (int k = 0; k < 5; k++)
				n += mask[k][x] == ALL_AHEAD;
			sum[x] = (float)n / 5;
		}
		even_across(e, sum, 1, even_row(e, FROM + MEAN_SHARE, y));
	}
}

static void second_rows(void *data, int y0, int y1, int thread)
{
	const evener *e = data;
	float *sum = even_scratch(e, thread, 0);
	for (int y = y0; y < y1 && !bands_stopped(e->bands); y++) {
		float *mean[MEANS], *sure = even_row(e, EVEN_SURE, y);
		const float *most = even_row(e, EVEN_TAKEN, y);
		const uint8_t *mask = e->same[LAST_PASS] + (ptrdiff_t)y * e->width;
		for (int k = 0; k < MEANS; k++) {
			mean[k] = even_row(e, TO + k, y);
			ISA(even_mean)(e, FROM + k, y, 2, sum, mean[k]);
		}
		for (int x = 0; x < e->width; x++) {
			float share = mean[MEAN_SHARE][x], over = share > 0 ? share : 1;
			float down = mean[MEAN_DOWN][x] / over, right = mean[MEAN_RIGHT][x] / over;
			float steady = down * down + right * right,
			      noise = positive((mean[MEAN_A][x] + mean[MEAN_C][x]) / over - steady),
			      off = slopes * most[x], least = sqrtf(noise + off * off);
			int asked = (least > 0) & (most[x] > 0) & (mask[x] == ALL_AHEAD);
			float ratio = sqrtf(steady) / (least > 0 ? least : 1);
			sure[x] = asked ? clamp01(ratio - 1) : 0;
		}
	}
}

static void third_rows(void *data, int y0, int y1, int thread)
{
	const evener *e = data;
	float *sum = even_scratch(e, thread, 0), *mean[4];
	for (int k = 0; k < 4; k++)
		mean[k] = even_scratch(e, thread, 1 + k);
	for (int y = y0; y < y1 && !bands_stopped(e->bands); y++) {
		const uint8_t *mask = e->same[LAST_PASS] + (ptrdiff_t)y * e->width;
		float *down = even_row(e, FROM, y), *right = even_row(e, FROM + 1, y);
		for (int k = 0; k < 4; k++)
			ISA(even_mean)(e, TO + MEAN_A + k, y, 4, sum, mean[k]);
		for (int x = 0; x < e->width; x++) {
			float over = mean[3][x] > 0 ? mean[3][x] : 1;
			way_of(mean[0][x] / over, mean[1][x] / over, mean[2][x] / over, mask[x] == ALL_AHEAD, down + x,
			       right + x);
		}
	}
}

static void border_rows(void *data, int y0, int y1, int thread)
{
	(void)thread;
	const evener *e = data;
	field f = {e, EVEN_GIVEN, FROM, FROM + 1};
	for (int y = y0; y < y1 && !bands_stopped(e->bands); y++) {
		const float *own = even_row(e, EVEN_GIVEN, y), *most = even_row(e, EVEN_TAKEN, y),
			    *down = even_row(e, FROM, y), *right = even_row(e, FROM + 1, y);
		float *out = even_row(e, EVEN_BORDER, y), *sure = even_row(e, EVEN_SURE, y);
		for (int x = 0; x < e->width; x++) {
			out[x] = own[x];
			sure[x] = down[x] == 0 && right[x] == 0 ? 0 : sure[x];
			if (!(sure[x] > 0))
				continue;
			sums s = sums_of(&f, y, x, most[x], bordered);
			float *w = s.weight, fit = w[0] * w[2] - w[1] * w[1];
			out[x] += fit > least_fit * w[0] * w[0] ? (s.off[0] * w[2] - s.off[1] * w[1]) / fit : 0;
		}
	}
}

int32_t ISA(even_border)(evener *e)
{
	sloping s = {e, EVEN_GIVEN, true};
	const bands_kernel rows[] = {first_rows, second_rows, third_rows, border_rows};
	int32_t code = bands_run(e->bands, e->rows, 0, slope_rows, &s);
	for (int k = 0; !code && k < 4; k++)
		code = bands_run(e->bands, e->rows, 0, rows[k], e);
	return code;
}
