/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Between which texels colors part, and where between: for each pair of neighbours the two colors that stand for its
 * sides, which may lie one texel further, as edges of pictures are mixed over a texel; the place is where half of the
 * way from one to the other is done. Of pairs in a row that see the same step the greatest has it. */
#include "texels/texels.h"

#include "base/metric.h"
#include "base/pixel.h"

#include <stdlib.h>
#include <string.h>

enum { BATCH = 1024, BESIDE = 2 /* pairs on both sides that may see the same step */ };

/* Squared: what differs less is the same. Of a step, by how much a texel further must differ more to stand for it. */
static const float least_step = 1e-4f, grows = 1.04f;
/* Of the difference of two colors, by which what is mixed of them may miss the way from one to the other. */
static const float most_off = 0.15f;
/* Of what colors differ across, what they must at least along, or the line runs along. */
static const float least_across = 0.7f;

typedef struct level_of {
	int32_t width, height;
	bool wrap_x, wrap_y, closest, first;
	const float *linear; /* height x width x 3 */
	float *encoded;      /* likewise, sRGB */
	float *step[2];      /* by axis and texel: how much the sides of the pair differ, squared */
	float *place[2];     /* where the pair parts, 0..1; -1: it does not */
	float stored;        /* 0..1: how far edges are mixed as colors are stored; else as light is */
} level_of;

static inline int32_t index_at(int32_t i, int32_t n, bool wrap)
{
	return wrap ? wrap_index(i, n) : clamp_index(i, n);
}

static inline size_t texel_at(const level_of *l, int32_t x, int32_t y)
{
	return (size_t)index_at(y, l->height, l->wrap_y) * (size_t)l->width + (size_t)index_at(x, l->width, l->wrap_x);
}

static inline float apart2_of(const float *a, const float *b)
{
	float u = a[0] - b[0], v = a[1] - b[1], w = a[2] - b[2];
	return u * u + v * v + w * w;
}

/* Whether what lies between two texels is mixed of these, and no color of its own. */
static bool is_mixed(const float *const c[4], const int sides[2])
{
	const float *a = c[sides[0]], *b = c[sides[1]];
	float whole = apart2_of(a, b);
	for (int k = sides[0] + 1; k < sides[1]; k++) {
		float along = 0, from = apart2_of(c[k], a);
		for (int i = 0; i < 3; i++)
			along += (c[k][i] - a[i]) * (b[i] - a[i]);
		if (along < 0 || along > whole || from - along * along / whole > most_off * most_off * whole)
			return false;
	}
	return true;
}

/* Four texels in a row; which of the first two and of the last two stand for the sides of the step between the middle
 * ones. */
static float sides_of(const level_of *l, const float *const c[4], int sides[2])
{
	float best = apart2_of(c[1], c[2]);
	sides[0] = 1;
	sides[1] = 2;
	if (l->closest || best <= least_step * least_step)
		return best;
	static const int other[3][2] = {{0, 2}, {1, 3}, {0, 3}};
	for (int k = 0; k < 3; k++) {
		float d = apart2_of(c[other[k][0]], c[other[k][1]]);
		if (d > grows * best && is_mixed(c, other[k])) {
			best = d;
			sides[0] = other[k][0];
			sides[1] = other[k][1];
		}
	}
	return best;
}

static inline void row_of(const level_of *l, int32_t x, int32_t y, int axis, size_t at[4])
{
	for (int k = 0; k < 4; k++)
		at[k] = axis ? texel_at(l, x, y + k - 1) : texel_at(l, x + k - 1, y);
}

static bool has_next(const level_of *l, int32_t x, int32_t y, int axis)
{
	return axis ? (l->wrap_y ? l->height > 1 : y + 1 < l->height) : (l->wrap_x ? l->width > 1 : x + 1 < l->width);
}

/* How far a texel is from one side to the other. */
static float share_of(const level_of *l, const size_t at[4], const int sides[2], int which)
{
	float share[2] = {0};
	for (int k = 0; k < 2; k++) {
		const float *from = k ? l->encoded : l->linear, *a = from + 3 * at[sides[0]],
			    *b = from + 3 * at[sides[1]], *p = from + 3 * at[which];
		float whole = apart2_of(a, b), own = 0;
		for (int i = 0; i < 3; i++)
			own += (p[i] - a[i]) * (b[i] - a[i]);
		share[k] = whole > 0 ? own / whole : 0;
	}
	return mix(share[0], share[1], l->stored);
}

static void look(const level_of *l, int32_t x, int32_t y, int axis)
{
	size_t own = (size_t)y * (size_t)l->width + (size_t)x, at[4];
	float *step = l->step[axis] + own, *place = l->place[axis] + own;
	const float *c[4];
	int sides[2];
	*step = 0;
	*place = -1;
	if (!has_next(l, x, y, axis))
		return;
	row_of(l, x, y, axis, at);
	for (int k = 0; k < 4; k++)
		c[k] = l->encoded + 3 * at[k];
	if (c[1][0] == c[2][0] && c[1][1] == c[2][1] && c[1][2] == c[2][2])
		return;
	*step = sides_of(l, c, sides);
	if (!(*step > least_step))
		return;
	float one = share_of(l, at, sides, 1), other = share_of(l, at, sides, 2);
	if (one < 0.5f && other >= 0.5f)
		*place = (0.5f - one) / (other - one);
}

/* How an image's edges are mixed: of texels between two others as many hold little of the lighter as hold much of it,
 * by the measure that is right. Levels are means of light. */
static float stored_share(const level_of *l)
{
	enum { ENOUGH = 16 };
	const float clear = 0.05f, alike = 1e-4f;
	double sum[2] = {0};
	int64_t count = 0;
	for (int axis = 0; axis < 2; axis++)
		for (int32_t y = 2; y < l->height - 2; y++)
			for (int32_t x = 2; x < l->width - 2; x++) {
				ptrdiff_t step = axis ? 3 * (ptrdiff_t)l->width : 3;
				const float *m = l->encoded + 3 * ((ptrdiff_t)y * l->width + x), *a = m - step,
					    *b = m + step;
				const float *row[4] = {a, m, b, b};
				if ((m[0] == a[0] && m[1] == a[1]) || (m[0] == b[0] && m[1] == b[1]) ||
				    !(apart2_of(a, b) > clear) || apart2_of(a, a - step) > alike ||
				    apart2_of(b, b + step) > alike || !is_mixed(row, (int[]){0, 2}))
					continue;
				size_t at[4] = {(size_t)(a - l->encoded) / 3, (size_t)(m - l->encoded) / 3,
						(size_t)(b - l->encoded) / 3, 0};
				bool darker = a[0] + a[1] + a[2] < b[0] + b[1] + b[2];
				const int sides[2] = {darker ? 0 : 2, darker ? 2 : 0};
				for (int k = 0; k < 2; k++) {
					level_of by = *l;
					by.stored = (float)k;
					sum[k] += (double)share_of(&by, at, sides, 1);
				}
				count++;
			}
	double off = sum[1] - sum[0], share = off > 0 ? (0.5 * (double)count - sum[0]) / off : 0.5;
	return count < ENOUGH ? 0.5f : share < 0 ? 0 : share > 1 ? 1 : (float)share;
}

/* Most pairs of a painted image are alike. */
static void look_along(const level_of *l, int32_t y, int axis)
{
	size_t own = (size_t)y * (size_t)l->width, next = axis ? 3 * (size_t)l->width : 3;
	int32_t inner = l->width - !axis;
	for (int32_t x = 0; x < l->width; x++) {
		const float *p = l->encoded + 3 * (own + (size_t)x), *q = p + next;
		if (x < inner && (!axis || y + 1 < l->height) && p[0] == q[0] && p[1] == q[1] && p[2] == q[2]) {
			l->step[axis][own + (size_t)x] = 0;
			l->place[axis][own + (size_t)x] = -1;
		} else {
			look(l, x, y, axis);
		}
	}
}

/* Whether a pair beside this one, in the same row, sees the same step better. */
static bool outdone(const level_of *l, int32_t x, int32_t y, int axis)
{
	size_t at[4];
	float own = l->step[axis][texel_at(l, x, y)];
	row_of(l, x, y, axis, at);
	const float *p = l->encoded + 3 * at[1], *q = l->encoded + 3 * at[2];
	for (int k = -BESIDE; k <= BESIDE; k++) {
		int32_t u = x + (axis ? 0 : k), v = y + (axis ? k : 0);
		if (!k || (!l->wrap_x && (u < 0 || u >= l->width)) || (!l->wrap_y && (v < 0 || v >= l->height)))
			continue;
		size_t i = texel_at(l, u, v);
		float its = l->step[axis][i], dot = 0;
		if (l->place[axis][i] < 0 || its < own || (its == own && k > 0))
			continue;
		row_of(l, u, v, axis, at);
		const float *r = l->encoded + 3 * at[1], *s = l->encoded + 3 * at[2];
		for (int n = 0; n < 3; n++)
			dot += (q[n] - p[n]) * (s[n] - r[n]);
		if (dot > 0)
			return true;
	}
	return false;
}

/* Whether colors change so much more the other way that the line runs along this pair. */
static bool runs_along(const level_of *l, int32_t x, int32_t y, int axis)
{
	float most = 0, own = l->step[axis][texel_at(l, x, y)];
	for (int k = 0; k < 4; k++) {
		int32_t u = x + (axis ? -(k & 1) : k & 1), v = y + (axis ? k >> 1 : -(k >> 1));
		size_t i = texel_at(l, u, v);
		if (l->place[!axis][i] >= 0)
			most = max(most, l->step[!axis][i]);
	}
	return own < least_across * least_across * most;
}

static int32_t packed(const float *encoded)
{
	int32_t out = 0;
	for (int k = 0; k < 3; k++)
		out = out << 8 | (int32_t)(255 * clamp01(encoded[k]) + 0.5f);
	return out;
}

static bool add(crossings *c, int32_t x, int32_t y, int axis, float place, const float *one, const float *other)
{
	crossing *more = with_room(c->at, sizeof *more, c->count, &c->room);
	if (!more)
		return false;
	c->at = more;
	(axis ? c->up : c->right)[(size_t)y * (size_t)c->width + (size_t)x] = (int32_t)c->count;
	c->at[c->count++] = (crossing){.x = (float)x + 0.5f + (axis ? 0 : place),
				       .y = (float)y + 0.5f + (axis ? place : 0),
				       .color = {packed(one), packed(other)}};
	return true;
}

/* Those whose colors differ too little are taken back. */
static void weigh(crossings *c, const color_metric *metric, float least)
{
	float space[2][3][BATCH], contrast[BATCH];
	for (int64_t first = 0; first < c->count; first += BATCH) {
		int n = c->count - first < BATCH ? (int)(c->count - first) : BATCH;
		for (int side = 0; side < 2; side++) {
			for (int i = 0; i < n; i++)
				for (int k = 0; k < 3; k++)
					space[side][k][i] = srgb_decode(
						(float)(c->at[first + i].color[side] >> (16 - 8 * k) & 255) / 255);
			ISA(metric_space)(metric->kind, n, space[side][0], space[side][1], space[side][2]);
		}
		const float *a[3] = {space[0][0], space[0][1], space[0][2]},
			    *b[3] = {space[1][0], space[1][1], space[1][2]};
		memset(contrast, 0, sizeof contrast);
		ISA(metric_difference)(metric, n, a, b, contrast);
		for (int i = 0; i < n; i++)
			c->at[first + i].contrast = contrast[i];
	}
	for (size_t i = 0; c->count && i < (size_t)c->width * (size_t)c->height; i++) {
		if (c->right[i] >= 0 && !(c->at[c->right[i]].contrast >= least))
			c->right[i] = -1;
		if (c->up[i] >= 0 && !(c->at[c->up[i]].contrast >= least))
			c->up[i] = -1;
	}
}

static bool find_crossings(const level_of *l, crossings *c)
{
	for (int axis = 0; axis < 2; axis++)
		for (int32_t y = 0; y < l->height; y++)
			look_along(l, y, axis);
	memset(c->right, 0xff, (size_t)l->width * (size_t)l->height * sizeof *c->right);
	memset(c->up, 0xff, (size_t)l->width * (size_t)l->height * sizeof *c->up);
	for (int axis = 0; axis < 2; axis++)
		for (int32_t y = 0; y < l->height; y++)
			for (int32_t x = 0; x < l->width; x++) {
				float place = l->place[axis][(size_t)y * (size_t)l->width + (size_t)x];
				size_t at[4];
				int sides[2];
				const float *of[4];
				if (place < 0 || (!l->closest && (outdone(l, x, y, axis) || runs_along(l, x, y, axis))))
					continue;
				row_of(l, x, y, axis, at);
				for (int k = 0; k < 4; k++)
					of[k] = l->encoded + 3 * at[k];
				sides_of(l, of, sides);
				if (!add(c, x, y, axis, place, of[sides[0]], of[sides[1]]))
					return false;
			}
	return true;
}

static bool make_level(const texel_recipe *r, const float *linear, const float *alpha, int32_t width, int32_t height,
		       bool first, texel_level *out)
{
	size_t texels = (size_t)width * (size_t)height;
	bool repeats = r->image->wrap == ENCRE_REPEAT;
	float *floats = malloc(7 * texels * sizeof *floats);
	int32_t *numbers = malloc(2 * texels * sizeof *numbers);
	level_of l = {.width = width,
		      .height = height,
		      .wrap_x = repeats,
		      .wrap_y = repeats,
		      .closest = r->image->closest && first,
		      .first = first,
		      .linear = linear,
		      .encoded = floats};
	crossings c = {.width = width,
		       .height = height,
		       .wrap_x = repeats,
		       .wrap_y = repeats,
		       .closest = l.closest,
		       .smooth = r->smooth,
		       .least = r->least,
		       .first = first,
		       .alpha = {alpha, width, height, repeats, l.closest},
		       .right = numbers,
		       .up = numbers + texels};
	bool made = floats && numbers;
	*out = (texel_level){.width = width, .height = height};
	if (made) {
		l.step[0] = floats + 3 * texels;
		l.step[1] = l.step[0] + texels;
		l.place[0] = l.step[1] + texels;
		l.place[1] = l.place[0] + texels;
		for (size_t i = 0; i < 3 * texels; i++)
			l.encoded[i] = srgb_encode(clamp01(linear[i]));
		l.stored = first && !l.closest ? stored_share(&l) : 0;
		made = find_crossings(&l, &c);
	}
	if (made) {
		weigh(&c, &r->metric, r->least);
		made = texel_curves(&c, out);
	}
	free(c.at);
	free(numbers);
	free(floats);
	return made;
}

/* The next level of detail of `parts` values a texel: means of two by two, of an odd side without the last. */
static float *halved(const float *from, int parts, int32_t width, int32_t height, int32_t *wide, int32_t *tall)
{
	size_t each = (size_t)parts;
	*wide = width > 1 ? width / 2 : 1;
	*tall = height > 1 ? height / 2 : 1;
	float *to = malloc(each * (size_t)*wide * (size_t)*tall * sizeof *to);
	int32_t right = width > 1, up = height > 1;
	for (int32_t y = 0; to && y < *tall; y++)
		for (int32_t x = 0; x < *wide; x++)
			for (size_t k = 0; k < each; k++) {
				const float *at = from +
						  each * ((size_t)(up ? 2 * y : y) * (size_t)width +
							  (size_t)(right ? 2 * x : x)) +
						  k;
				size_t row = up ? each * (size_t)width : 0, next = right ? each : 0;
				to[each * ((size_t)y * (size_t)*wide + (size_t)x) + k] =
					0.25f * (at[0] + at[next] + at[row] + at[row + next]);
			}
	return to;
}

bool ISA(boundaries_fill)(boundaries *b, const texel_recipe *r, uint32_t levels)
{
	const encre_colored *image = r->image;
	const float *from = image->colors;
	float *own = NULL, *alpha = NULL;
	int32_t width = image->width, height = image->height;
	bool done = true, clear = image->alpha != NULL;
	levels &= ~b->made;
	if (clear && levels) {
		size_t texels = (size_t)width * (size_t)height;
		from = own = malloc(3 * texels * sizeof *own);
		alpha = malloc(texels * sizeof *alpha);
		done = own && alpha;
		for (size_t i = 0; done && i < texels; i++)
			alpha[i] = (float)image->alpha[i] / 255;
		if (done)
			memcpy(own, image->colors, 3 * texels * sizeof *own);
	}
	for (int k = 0; done && levels >> k; k++) {
		int32_t wide, tall;
		alpha_level there = {alpha, width, height, image->wrap == ENCRE_REPEAT, image->closest && !k};
		done = !clear || holes_fill(&there, own);
		if (done && levels >> k & 1) {
			done = make_level(r, from, alpha, width, height, k == 0, b->level + k);
			if (done)
				b->made |= 1u << k;
			else
				level_free(b->level + k);
		}
		float *next = done ? halved(from, 3, width, height, &wide, &tall) : NULL,
		      *next_alpha = done && clear ? halved(alpha, 1, width, height, &wide, &tall) : NULL;
		free(own);
		free(alpha);
		from = own = next;
		alpha = next_alpha;
		done = done && next && (!clear || alpha);
		width = done ? wide : 1;
		height = done ? tall : 1;
	}
	free(own);
	free(alpha);
	return done;
}
