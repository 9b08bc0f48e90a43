/* SPDX-License-Identifier: GPL-3.0-or-later */
/* From joined crossings to curves. They are evened, but for their corners, and cut where they bend. */
#include "texels/texels.h"

#include "base/pixel.h"

#include <stdlib.h>
#include <string.h>

/* Texels: what is shorter, and hangs on nothing, or on one thing. */
static const float least_loose = 2.5f, least_spur = 1.6f;
/* Times the least contrast: a curve has that somewhere. */
static const float strong = 1.6f;
/* Texels by which points may leave their place as they are evened, and straight parts the curve. */
static const float most_moved = 0.4f, miss = 0.02f, miss_far = 0.2f, miss_closest = 1e-3f;
enum { EVENED = 10, MERGED = 48 /* steps of a straight part, at most */ };
/* Of a step of evening, and back, so that it does not shrink. */
static const float inward = 0.5f, outward = -0.53f;
/* Texels along both arms of a corner; the cosine between these from which on it is one; how far arms may bend. */
static const float arm = 2.6f, corner_cosine = 0.5f, arm_bends = 0.3f;
/* Likewise of a corner that lies between two points, and texels from it to these. */
static const float cut_bends = 0.25f, most_cut = 1;

/* ---- curves ---------------------------------------------------------------------------------------------- */

/* A curve between two points at which not two parts meet, or a ring; its points one after the other, each as far on as
 * the image repeats. */
typedef struct curve {
	int32_t *point;
	int8_t (*turn)[2];   /* widths and heights further */
	int32_t (*color)[2]; /* of the part from a point to the next */
	float (*at)[2], (*to)[2];
	uint8_t *fixed;
	int32_t n, room;
	bool ring;
} curve;

static int parts_of(const net *n, int32_t point)
{
	int count = 0;
	while (count < 4 && n->of[point][count] >= 0)
		count++;
	return count;
}

/* Gives an array room for so many, or returns false from where it stands. */
#define GROW(array, n)                                                                                                 \
	do {                                                                                                           \
		void *more = realloc(array, (size_t)(n) * sizeof *(array));                                            \
		if (!more)                                                                                             \
			return false;                                                                                  \
		(array) = more;                                                                                        \
	} while (0)

static bool curve_room(curve *u, int32_t n)
{
	if (n < u->room)
		return true;
	int32_t room = 2 * n + 64; /* what has grown before another can't is larger than it need be */
	GROW(u->point, room);
	GROW(u->turn, room);
	GROW(u->color, room);
	GROW(u->at, room);
	GROW(u->to, room);
	GROW(u->fixed, room);
	u->room = room;
	return true;
}

static void curve_free(curve *u)
{
	free(u->point);
	free(u->turn);
	free(u->color);
	free(u->at);
	free(u->to);
	free(u->fixed);
}

/* Follows a curve from a point by one of its parts, and marks these. */
static bool follow(net *n, int32_t from, int32_t by, uint8_t *done, curve *u)
{
	int32_t at = from, turn[2] = {0};
	u->n = 0;
	u->ring = false;
	for (;;) {
		if (!curve_room(u, u->n + 1))
			return false;
		u->point[u->n] = at;
		for (int k = 0; k < 2; k++) {
			u->turn[u->n][k] = (int8_t)turn[k];
			u->at[u->n][k] = n->point[at][k] + (float)turn[k] * (float)(k ? n->c->height : n->c->width);
		}
		u->n++;
		if (by < 0 || done[by])
			break;
		done[by] = 1;
		const curve_part *p = n->part + by;
		int e = p->end[0] != at;
		u->color[u->n - 1][0] = p->color[e];
		u->color[u->n - 1][1] = p->color[!e];
		for (int k = 0; k < 2; k++)
			turn[k] += (p->shift[!e] >> k & 1) - (p->shift[e] >> k & 1);
		if (turn[0] < -100 || turn[0] > 100 || turn[1] < -100 || turn[1] > 100)
			by = -1;
		at = p->end[!e];
		if (by >= 0)
			by = parts_of(n, at) != 2 ? -1 : n->of[at][n->of[at][0] == by];
	}
	u->ring = u->n > 2 && u->point[0] == u->point[u->n - 1] && u->turn[u->n - 1][0] == 0 &&
		  u->turn[u->n - 1][1] == 0 && parts_of(n, from) == 2;
	return true;
}

static float curve_long(const curve *u)
{
	float sum = 0;
	for (int32_t i = 1; i < u->n; i++) {
		float x = u->at[i][0] - u->at[i - 1][0], y = u->at[i][1] - u->at[i - 1][1];
		sum += sqrtf(x * x + y * y);
	}
	return sum;
}

/* The point `arm` away along the curve, and how far what lies between bends off the straight way there. */
static bool arm_of(const curve *u, int32_t i, int way, float to[2], float *bends)
{
	float far = 0;
	int32_t k = i, last = u->n - 1;
	for (int32_t step = 0; far < arm; step++) {
		int32_t next = k + way;
		if (next < 0 || next > last) {
			if (!u->ring)
				return false;
			next = next < 0 ? last - 1 : 1;
		}
		if (step == last)
			return false;
		float x = u->at[next][0] - u->at[k == 0 && way < 0      ? last
						 : k == last && way > 0 ? 0
									: k][0],
		      y = u->at[next][1] - u->at[k == 0 && way < 0      ? last
						 : k == last && way > 0 ? 0
									: k][1];
		far += sqrtf(x * x + y * y);
		k = next;
	}
	to[0] = u->at[k][0] - u->at[i][0];
	to[1] = u->at[k][1] - u->at[i][1];
	float length = sqrtf(to[0] * to[0] + to[1] * to[1]);
	*bends = 0;
	for (int32_t m = i; m != k && length > 0;) {
		float x = u->at[m][0] - u->at[i][0], y = u->at[m][1] - u->at[i][1];
		*bends = max(*bends, fabsf(x * to[1] - y * to[0]) / length);
		m += way;
		if (m < 0 || m > last)
			m = m < 0 ? last - 1 : 1;
	}
	to[0] /= length;
	to[1] /= length;
	return length > 0;
}

static void find_corners(curve *u)
{
	for (int32_t i = 0; i < u->n; i++) {
		float before[2], after[2], bends[2];
		u->fixed[i] = !u->ring && (i == 0 || i == u->n - 1);
		if (u->fixed[i] || !arm_of(u, i, -1, before, bends) || !arm_of(u, i, 1, after, bends + 1))
			continue;
		float cosine = before[0] * after[0] + before[1] * after[1];
		u->fixed[i] = cosine > -corner_cosine && bends[0] < arm_bends && bends[1] < arm_bends;
	}
}

/* Points lie on the sides of squares of texels, so that corners are cut off: of those between two points both are moved
 * to where the arms meet. */
static void sharpen(curve *u)
{
	int32_t last = u->n - 1;
	for (int32_t i = !u->ring; i + !u->ring < last; i++) {
		float before[2], after[2], bends[2];
		if (!arm_of(u, i, -1, before, bends) || !arm_of(u, i + 1, 1, after, bends + 1) ||
		    before[0] * after[0] + before[1] * after[1] <= -corner_cosine || bends[0] >= cut_bends ||
		    bends[1] >= cut_bends)
			continue;
		float x = u->at[i + 1][0] - u->at[i][0], y = u->at[i + 1][1] - u->at[i][1],
		      sine = before[0] * after[1] - before[1] * after[0];
		float one = (x * after[1] - y * after[0]) / sine, other = (x * before[1] - y * before[0]) / sine;
		if (!(one < 0 && other < 0 && one > -most_cut && other > -most_cut))
			continue;
		for (int c = 0; c < 2; c++)
			u->at[i][c] = u->at[i + 1][c] += other * after[c];
		u->fixed[i] = u->fixed[i + 1] = 1;
		for (int end = 0; u->ring && end < 2; end++)
			if (end ? i + 1 == last : i == 0) {
				memcpy(u->at[end ? 0 : last], u->at[end ? last : 0], sizeof u->at[0]);
				u->fixed[end ? 0 : last] = 1;
			}
	}
}

static void even(curve *u)
{
	float (*from)[2] = malloc(((size_t)u->n + 1) * sizeof *from);
	if (!from)
		return; /* it is a curve all the same */
	find_corners(u);
	sharpen(u);
	memcpy(from, u->at, (size_t)u->n * sizeof *from);
	for (int pass = 0; pass < 2 * EVENED; pass++) {
		float share = pass % 2 ? outward : inward;
		int32_t last = u->n - 1;
		for (int32_t i = 0; i <= last; i++) {
			int32_t a = i ? i - 1 : last - 1, b = i < last ? i + 1 : 1;
			for (int k = 0; k < 2; k++) {
				float mean = 0.5f * (u->at[a][k] + u->at[b][k]), to = u->at[i][k];
				if (!u->fixed[i])
					to += share * (mean - to);
				float off = to - from[i][k];
				u->to[i][k] = from[i][k] + (off > most_moved    ? most_moved
							    : off < -most_moved ? -most_moved
										: off);
			}
		}
		memcpy(u->at, u->to, (size_t)u->n * sizeof *u->at);
	}
	free(from);
}

/* Whether points between two lie on the straight way, and their colors are alike. */
static bool is_straight(const curve *u, int32_t from, int32_t to, float most)
{
	float x = u->at[to][0] - u->at[from][0], y = u->at[to][1] - u->at[from][1], length = x * x + y * y;
	if (to - from > MERGED || !(length > 0))
		return false;
	for (int32_t i = from + 1; i < to; i++) {
		float ex = u->at[i][0] - u->at[from][0], ey = u->at[i][1] - u->at[from][1];
		float t = (ex * x + ey * y) / length, dx = ex - t * x, dy = ey - t * y;
		if (dx * dx + dy * dy > most * most || t < 0 || t > 1 ||
		    color_apart(u->color[i][0], u->color[from][0]) > 48 ||
		    color_apart(u->color[i][1], u->color[from][1]) > 48)
			return false;
	}
	return u->turn[to][0] == u->turn[from][0] && u->turn[to][1] == u->turn[from][1];
}

/* Mean colors of parts from .. to - 1, and of those about them, which even what texels have by chance. */
static void mean_colors(const curve *u, int32_t from, int32_t to, int32_t color[2])
{
	int32_t a = from - 2, b = to + 2, last = u->n - 2;
	a = a < 0 ? 0 : a;
	b = b > last + 1 ? last + 1 : b;
	for (int side = 0; side < 2; side++) {
		color[side] = 0;
		for (int k = 16; k >= 0; k -= 8) {
			int sum = 0;
			for (int32_t i = a; i < b; i++)
				sum += u->color[i][side] >> k & 255;
			color[side] |= (sum + (b - a) / 2) / (b - a) << k;
		}
	}
}

static bool add_line(texel_level *l, int64_t *room, const texel_line *line)
{
	texel_line *more = with_room(l->line, sizeof *more, l->n_lines, room);
	if (!more)
		return false;
	l->line = more;
	l->line[l->n_lines++] = *line;
	return true;
}

static bool write_curve(const net *n, const curve *u, texel_level *l, int64_t *room)
{
	float most = n->c->closest ? miss_closest : n->c->first ? miss : miss_far;
	for (int32_t i = 0; i < u->n; i++)
		for (int k = 0; k < 2; k++)
			n->point[u->point[i]][k] =
				u->at[i][k] - (float)u->turn[i][k] * (float)(k ? n->c->height : n->c->width);
	for (int32_t from = 0, to; from < u->n - 1; from = to) {
		for (to = from + 1; to + 1 < u->n && is_straight(u, from, to + 1, most);)
			to++;
		texel_line line = {.point = {u->point[from], u->point[to]}};
		for (int k = 0; k < 2; k++) {
			int by = u->turn[to][k] - u->turn[from][k];
			line.shift[0] |= (uint8_t)(by < 0 ? 1 << k : 0);
			line.shift[1] |= (uint8_t)(by > 0 ? 1 << k : 0);
		}
		mean_colors(u, from, to, line.color);
		if (!add_line(l, room, &line))
			return false;
	}
	return true;
}

static bool is_crumb(const net *n, const curve *u)
{
	bool loose[2];
	for (int e = 0; e < 2; e++) {
		int32_t p = u->point[e ? u->n - 1 : 0];
		loose[e] = parts_of(n, p) == 1;
	}
	float length = curve_long(u), most = 0;
	for (int32_t i = 0; i < u->n; i++)
		most = max(most, u->point[i] < n->c->count ? n->c->at[u->point[i]].contrast : 0);
	if (most < strong * n->c->least)
		return true;
	if (u->ring || n->c->closest)
		return false;
	return (loose[0] && loose[1] && length < least_loose) || (loose[0] != loose[1] && length < least_spur);
}

static bool write_curves(net *n, texel_level *l)
{
	uint8_t *done = calloc((size_t)n->n_parts + 1, 1);
	curve u = {0};
	int64_t room = 0;
	bool made = done != NULL;
	for (int rings = 0; made && rings < 2; rings++)
		for (int32_t i = 0; made && i < n->n_points; i++) {
			if (!rings && parts_of(n, i) == 2)
				continue;
			for (int k = 0; made && k < 4 && n->of[i][k] >= 0; k++) {
				if (done[n->of[i][k]])
					continue;
				made = follow(n, i, n->of[i][k], done, &u);
				if (!made || is_crumb(n, &u))
					continue;
				if (n->c->smooth && u.n > 2)
					even(&u);
				made = write_curve(n, &u, l, &room);
			}
		}
	curve_free(&u);
	free(done);
	return made;
}

bool texel_curves(crossings *c, texel_level *level)
{
	net n;
	bool made = net_join(&n, c) && write_curves(&n, level);
	level->point = n.point;
	level->n_points = n.n_points;
	free(n.part);
	free(n.of);
	if (made && c->alpha.alpha)
		made = holes_cut(&c->alpha, level);
	return made && texel_sort(level);
}

boundaries *boundaries_begin(const texel_recipe *r)
{
	boundaries *b = calloc(1, sizeof *b);
	const encre_colored *image = r->image;
	if (!b)
		return NULL;
	*b = (boundaries){.key = image->key,
			  .width = image->width,
			  .height = image->height,
			  .wrap = image->wrap,
			  .closest = image->closest,
			  .metric = r->metric,
			  .least = r->least,
			  .smooth = r->smooth};
	for (int32_t side = b->width > b->height ? b->width : b->height; side > 1 && b->n_levels < TEXEL_LEVELS;
	     side /= 2)
		b->n_levels++;
	return b;
}

void level_free(texel_level *l)
{
	free(l->point);
	free(l->line);
	free(l->first);
	free(l->member);
	*l = (texel_level){0};
}

void boundaries_free(boundaries *b)
{
	for (int i = 0; b && i < b->n_levels; i++)
		level_free(b->level + i);
	free(b);
}
