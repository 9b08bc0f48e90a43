/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Bends that are spread over several faces, as a bevel's: from afar they are one edge, and none of their own edges may
 * bend enough to be drawn. Along a row or a column of pixels the surface turns from way to way between two centres by
 * the angle of its normals. What it turns within a few pixels beyond what it turns in as many on either side is one
 * bend: so what is round has none, be it made of few faces or of many. The line runs where the turning has its middle,
 * and takes the place of those edges of the mesh that are part of the bend. */
#include "raster/bevels.h"

#include "base/pixel.h"

#include <stdlib.h>
#include <string.h>

static const float widest = 10.0f / 1080; /* of the frame's height; as it gets wider a bend counts less and less */
static const float least_bend = 20;       /* degrees, below which nothing is looked for */
static const float most_of_one = 0.6f;    /* share of a bend that one way may have: else there is an edge, and drawn */
static const float most_beside =
	0.25f; /* share of a bend that as many pixels on a side of it turn: else it goes on there */
static const float own_line = 0.36f;      /* share from which on an edge is seen by itself, unless it is so close: */
static const float too_close = 1.6f;      /* pixels */
static const float least_straight = 0.8f; /* of all that it turns: it goes one way round */

static const float farthest = 1.25f; /* pixels from a pixel, that its line may be away */

enum { LEAST_WAYS = 2, MOST_WAYS = 24 };

/* What a way turns, or that there is an end of the surface between. */
static const float closed = -1;

typedef struct bend {
	float off;        /* where the pixel lies from the line's middle, along the axis */
	float most;       /* degrees; 0: there is none */
	int8_t across[3]; /* how its normals change, along the axis */
	int8_t first;     /* its ways begin there, from the pixel, */
	uint8_t ways;     /* and are so many */
	uint8_t axis : 1, smooth : 1;
} bend;

typedef struct search {
	const encre_raster_job *job;
	int width, height, ways;
	float *turn[2]; /* by axis and pixel: of the way to the next */
	bend *bend;
} search;

static const float *normal_at(const search *s, int x, int y)
{
	return pixel_at(&s->job->normal, x, y);
}

static float degrees_between(const float *n, const float *m)
{
	float square = 0;
	for (int c = 0; c < 3; c++)
		square += (n[c] - m[c]) * (n[c] - m[c]);
	float half = 0.5f * sqrtf(square);
	return 114.591559f * pixel_atan2(half, sqrtf(max(0, 1 - half * half)));
}

static float turn_between(const search *s, int x, int y, int axis)
{
	int qx = x + !axis, qy = y + axis;
	if (qx >= s->width || qy >= s->height)
		return closed;
	const float *n = normal_at(s, x, y), *m = normal_at(s, qx, qy);
	if (*pixel_at(&s->job->object, x, y) != *pixel_at(&s->job->object, qx, qy) ||
	    (n[0] == 0 && n[1] == 0 && n[2] == 0) || (m[0] == 0 && m[1] == 0 && m[2] == 0) ||
	    pixel_at(&s->job->creases, x, y)[2 * axis + 1] >= 180 ||
	    (s->job->marks.data && pixel_at(&s->job->marks, x, y)[axis] < 0))
		return closed;
	if (n[0] == m[0] && n[1] == m[1] && n[2] == m[2])
		return 0;
	return degrees_between(n, m);
}

static void turn_rows(void *data, int y0, int y1, int thread)
{
	(void)thread;
	const search *s = data;
	for (int y = y0; y < y1; y++)
		for (int x = 0; x < s->width; x++)
			for (int axis = 0; axis < 2; axis++)
				s->turn[axis][(size_t)y * (size_t)s->width + (size_t)x] = turn_between(s, x, y, axis);
}

/* ---- bends ----------------------------------------------------------------------------------------------- */

/* The ways along an axis about a pixel: turn[REACH] is that from it to the next. */
enum { REACH = 2 * MOST_WAYS, SPAN = 2 * REACH };

typedef struct ways {
	float turn[SPAN], place[SPAN];
	float sum[SPAN + 1];    /* of what is turned up to a way */
	uint8_t ends[SPAN + 1]; /* how many of them end the surface */
	float edge[SPAN];       /* the bend of the edge there, as in the layer */
	int from, to;           /* within the images */
} ways;

static bool read_ways(const search *s, int x, int y, int axis, ways *w)
{
	float about = 0;
	int at = axis ? y : x, size = axis ? s->height : s->width, reach = 2 * s->ways;
	ptrdiff_t step = axis ? s->width : 1;
	const float *turn = s->turn[axis] + (size_t)y * (size_t)s->width + (size_t)x;
	for (int k = -s->ways; k < s->ways; k++)
		if (at + k >= 0 && at + k < size - 1)
			about += max(turn[k * step], 0);
	if (about < least_bend)
		return false;
	*w = (ways){.from = REACH + (at < reach ? -at : -reach),
		    .to = REACH + (size - 1 - at < reach ? size - 1 - at : reach)};
	for (int k = w->from; k < w->to; k++) {
		int off = k - REACH;
		float turns = turn[off * step];
		w->turn[k] = max(turns, 0);
		w->sum[k + 1] = w->sum[k] + w->turn[k];
		w->ends[k + 1] = (uint8_t)(w->ends[k] + (turns < 0));
		w->place[k] = 0.5f;
		if (!(turns > 0))
			continue;
		const float *crease = pixel_at(&s->job->creases, x + (axis ? 0 : off), y + (axis ? off : 0)) + 2 * axis;
		w->place[k] = crease[0] > 0 ? crease[0] : 0.5f;
		w->edge[k] = crease[1];
	}
	return true;
}

/* What `count` ways turn; -1 where the surface ends, INFINITY beyond the images. */
static float sum_of(const ways *w, int first, int count)
{
	if (first < w->from || first + count > w->to)
		return INFINITY;
	return w->ends[first + count] > w->ends[first] ? closed : w->sum[first + count] - w->sum[first];
}

/* The bend of `count` ways from `first` on, if it is one and runs by the pixel. */
static void weigh(const ways *w, int first, int count, bend *best, float *clearest)
{
	float all = sum_of(w, first, count), before = sum_of(w, first - count, count),
	      after = sum_of(w, first + count, count), middle = 0;
	if (!(all >= least_bend && all < INFINITY && before >= 0 && after >= 0))
		return;
	before = before < INFINITY ? before : 2 * after; /* cut off by the images' border */
	after = after < INFINITY ? after : 2 * before;
	float bends = all - 0.5f * (before + after), clear = all - max(before, after);
	if (!(min(before, after) <= most_beside * all && bends >= least_bend && clear > *clearest))
		return;
	/* of what goes on beside, too: where the bend is wider than that its middle would jump to and fro */
	int from = first, to = first + count;
	while (from > w->from && first - from < count / 2 && w->ends[from] == w->ends[first])
		from--;
	while (to < w->to && to - first - count < count / 2 && w->ends[to + 1] == w->ends[first])
		to++;
	for (int k = from; k < to; k++)
		middle += w->turn[k] * ((float)(k - REACH) + w->place[k]);
	middle /= w->sum[to] - w->sum[from];
	if (fabsf(middle) > farthest)
		return;
	bool flat = false;
	for (int k = first; k < first + count; k++) {
		float away = fabsf((float)(k - REACH) + w->place[k] - middle);
		if (fabsf(w->edge[k]) > (away > too_close ? own_line : most_of_one) * all)
			return;
		flat |= w->edge[k] > 0;
	}
	*clearest = clear; /* of what turns on that side of it that turns more */
	*best = (bend){.off = -middle,
		       .most = bends,
		       .first = (int8_t)(first - REACH),
		       .ways = (uint8_t)count,
		       .smooth = !flat};
}

/* How the normals change from one end of a bend to the other; false: it does not go one way round. */
static bool across_of(const search *s, int x, int y, bend *b)
{
	int from = (int)b->first, to = from + b->ways;
	const float *n = normal_at(s, x + (b->axis ? 0 : from), y + (b->axis ? from : 0)),
		    *m = normal_at(s, x + (b->axis ? 0 : to), y + (b->axis ? to : 0));
	for (int c = 0; c < 3; c++)
		b->across[c] = (int8_t)(63 * (m[c] - n[c]));
	return degrees_between(n, m) >= least_straight * b->most;
}

static void find_rows(void *data, int y0, int y1, int thread)
{
	(void)thread;
	const search *s = data;
	for (int y = y0; y < y1; y++)
		for (int x = 0; x < s->width; x++) {
			bend *out = s->bend + (size_t)y * (size_t)s->width + (size_t)x;
			float clearest = 0;
			out->most = 0;
			for (int axis = 0; axis < 2; axis++) {
				ways w;
				bend best = {.most = 0};
				float clear = 0;
				if (!read_ways(s, x, y, axis, &w))
					continue;
				for (int count = LEAST_WAYS; count <= s->ways; count++)
					for (int first = -count; first <= 0; first++)
						weigh(&w, REACH + first, count, &best, &clear);
				best.axis = (uint8_t)axis;
				if (clear > clearest && across_of(s, x, y, &best)) {
					clearest = clear;
					*out = best;
				}
			}
		}
}

/* ---- lines ----------------------------------------------------------------------------------------------- */

/* Whether an edge at a place in pixels is part of a bend whose line passes close by. */
static bool is_part(const search *s, float px, float py, float bends)
{
	int reach = s->ways, x = (int)px, y = (int)py;
	for (int j = y - reach; j <= y + reach; j++)
		for (int i = x - reach; i <= x + reach; i++) {
			if (i < 0 || j < 0 || i >= s->width || j >= s->height)
				continue;
			const bend *b = s->bend + (size_t)j * (size_t)s->width + (size_t)i;
			if (!(b->most > bends) || fabsf(b->off) > 0.75f)
				continue;
			float along = b->axis ? py - (float)j : px - (float)i,
			      aside = b->axis ? px - (float)i : py - (float)j;
			if (fabsf(aside) <= 0.5f && along >= (float)b->first && along <= (float)(b->first + b->ways))
				return true;
		}
	return false;
}

static void draw_rows(void *data, int y0, int y1, int thread)
{
	(void)thread;
	const search *s = data;
	for (int y = y0; y < y1; y++)
		for (int x = 0; x < s->width; x++)
			for (int axis = 0; axis < 2; axis++) {
				int qx = x + !axis, qy = y + axis;
				if (qx >= s->width || qy >= s->height)
					continue;
				float *crease = pixel_at(&s->job->creases, x, y) + 2 * axis;
				const bend *p = s->bend + (size_t)y * (size_t)s->width + (size_t)x,
					   *q = s->bend + (size_t)qy * (size_t)s->width + (size_t)qx;
				float bends = min(p->most, q->most);
				int dot = 0;
				for (int c = 0; c < 3 && bends > 0; c++)
					dot += p->across[c] * q->across[c];
				float one = p->off, two = dot > 0 ? q->off : -q->off;
				if (bends > fabsf(crease[1]) && dot != 0 && one != two && (one <= 0) != (two <= 0)) {
					crease[0] = (float)fmax((double)(fabsf(one) / (fabsf(one) + fabsf(two))),
								LEAST_SHARE);
					crease[1] =
						p->smooth && q->smooth ? -bends - crease_spread : bends + crease_spread;
				} else if (crease[0] > 0 && fabsf(crease[1]) < 180 &&
					   is_part(s, (float)x + (axis ? 0 : crease[0]),
						   (float)y + (axis ? crease[0] : 0), fabsf(crease[1])))
					crease[0] = crease[1] = 0;
			}
}

int32_t bevels_draw(bands *pool, const encre_raster_job *job)
{
	search s = {.job = job, .width = job->creases.width, .height = job->creases.height};
	size_t n = (size_t)s.width * (size_t)s.height;
	float ways = widest * (float)job->frame.height + 0.5f;
	s.ways = ways < LEAST_WAYS ? LEAST_WAYS : ways < MOST_WAYS ? (int)ways : MOST_WAYS;
	arena a = {0};
	for (int pass = 0; pass < 2; pass++) {
		s.turn[0] = arena_take(&a, n, sizeof *s.turn[0]);
		s.turn[1] = arena_take(&a, n, sizeof *s.turn[1]);
		s.bend = arena_take(&a, n, sizeof *s.bend);
		if (pass == 0 && !(a = (arena){.base = malloc(a.used)}).base)
			return ENCRE_ERROR_MEMORY;
	}
	int32_t code = bands_run(pool, s.height, BAND, turn_rows, &s);
	if (!code)
		code = bands_run(pool, s.height, BAND, find_rows, &s);
	if (!code)
		code = bands_run(pool, s.height, BAND, draw_rows, &s);
	free(a.base);
	return code;
}
