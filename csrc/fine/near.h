/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Small questions that several files of FINE ask of pixels, of places and of chains. */
#ifndef ENCRE_FINE_NEAR_H
#define ENCRE_FINE_NEAR_H

#include "fine/fine.h"

/* ---- pixels ---------------------------------------------------------------------------------------------- */

/* The pixel that holds a site. */
static inline int pixel_of(float at, int n)
{
	return clamp_index((int)floorf(at + 0.5f), n);
}

/* The number of what a pixel shows; 0 where none is known. */
static inline float object_at(const frame *f, int x, int y)
{
	plane p = f->layer[ENCRE_LAYER_OBJECT];
	return p.data ? p.data[y * p.row + x] : 0;
}

/* Pixels beside a crack hold two surfaces. */
static inline bool mixed_at(const fine *n, int x, int y)
{
	const uint8_t *c = n->mixed + (ptrdiff_t)y * n->f->width + x;
	return (c[0] & (CRACK_RIGHT | CRACK_DOWN)) || (x > 0 && (c[-1] & CRACK_RIGHT)) ||
	       (y > 0 && (c[-n->f->width] & CRACK_DOWN));
}

/* Whether no ridge that is sampled from `s` reads there. */
static inline bool closed_at(const fine *n, int s, int x, int y)
{
	return mixed_at(n, x, y) || (s >= SOURCE_SEEN && !n->through[(ptrdiff_t)y * n->f->width + x]);
}

/* Which of eight bytes in a word is the first that is not 0, or 8. All platforms are little-endian. */
static inline int first_byte(uint64_t eight)
{
	return eight ? __builtin_ctzll(eight) / 8 : 8;
}

/* The first of bytes x..end - 1 that is not 0, or end. Nearly all are. */
static inline int next_marked(const uint8_t *marks, int x, int end)
{
	for (; x + 8 <= end; x += 8) {
		uint64_t eight;
		memcpy(&eight, marks + x, 8);
		if (eight)
			return x + first_byte(eight);
	}
	while (x < end && !marks[x])
		x++;
	return x;
}

/* What depths are compared in: it is linear on planes on screen. Nothing there is 0, under an orthographic camera
 * -INFINITY. */
static inline float depth_sample(const edges *e, float z)
{
	z = depth_of(z);
	return e->ortho ? -z / max(e->f->camera.height, 1e-20f) : 1 / z;
}

/* How far b and c are apart beyond what the slopes from a and to d explain. */
static inline float jump(float a, float b, float c, float d)
{
	float l = c - 2 * b + a, r = b - 2 * c + d;
	return max(min(l, -r), min(-l, r));
}

/* Light goes on a little where a surface has ended, for the colours that are averaged there; no line of light does. */
static inline bool is_nothing(const fine *n, int x, int y)
{
	return depth_at(n->f, x, y) == INFINITY;
}

/* Shares that are added up give the place of a boundary exactly under a box filter. Under Blackman and Harris's of 1.5
 * pixels, which is steeper, that is up to 0.125 pixel too far from pixel centres, and the layers don't tell how they
 * were filtered: halfway between the two neither is off by much. */
static inline float unbiased(float place)
{
	return place - 0.06f * pixel_sin(6.28318531f * place);
}

/* Squared length of a difference. */
static inline float distance2(const float *a, const float *b, int planes)
{
	float sum = 0;
	for (int c = 0; c < planes; c++)
		sum += (a[c] - b[c]) * (a[c] - b[c]);
	return sum;
}

/* ---- stripes --------------------------------------------------------------------------------------------- */

/* pixels; and where it goes on beside one that is narrow enough, and as strong as an edge */
static const float widest_band = 2.05f, widest_weak = 3.1f; /* test_fine_sites */
/* Three pixels that nothing has averaged have no peak: how far off the pixel's their middle may lie, in pixels. Where
 * it lies farther off the next pixel has a peak; test_fine_sites */
static const float most_off = 0.2f;
static const float least_of_peak = 1.5f; /* times the step across a band; test_fine_sites */
static const float most_against = 0.1f;  /* share of a band that a pixel of it may lie the other way; test_fine_sites */

/* How the middle three of five values differ, in sum, from the line between the outer two. */
typedef struct stripe {
	float base[3], e[3], area, peak, offset; /* offset: of its middle, in pixels */
	bool weak;
} stripe;

/* Whether it is narrow enough that its two boundaries are one line. */
static inline bool stripe_of(const float (*value)[3], int planes, float floor, bool faint, stripe *b)
{
	float c[3] = {0, 0, 0};
	b->area = 0;
	for (int k = 0; k < planes; k++) {
		b->e[k] = (value[1][k] + value[2][k] + value[3][k]) - 1.5f * (value[0][k] + value[4][k]);
		b->base[k] = 0.5f * (value[0][k] + value[4][k]);
		b->area += b->e[k] * b->e[k];
	}
	b->area = sqrtf(b->area);
	if (!(b->area > floor))
		return false;
	for (int i = 0; i < 3; i++)
		for (int k = 0; k < planes; k++)
			c[i] += (value[i + 1][k] - mix(value[0][k], value[4][k], 0.25f * (float)(i + 1))) * b->e[k] /
				b->area;
	b->peak = c[1];
	float against = -most_against * b->area;
	b->weak = faint && b->area > widest_band * c[1];
	b->offset = (c[2] - c[0]) / b->area;
	bool peak = (c[1] > c[0] && c[1] > c[2]) || (b->weak && fabsf(b->offset) < most_off);
	return peak && b->area <= (b->weak ? widest_weak : widest_band) * c[1] && c[0] > against && c[2] > against &&
	       c[1] > least_of_peak * sqrtf(distance2(value[0], value[4], planes));
}

/* ---- tiles ------------------------------------------------------------------------------------------------ */

typedef struct tile {
	int x, y, end, last; /* its pixels: end and last are the first beyond it */
} tile;

static inline tile tile_of(const frame *f, int i)
{
	int across = tiles_of(f->width), x = i % across, y = i / across;
	return (tile){tile_from(x, f->width), tile_from(y, f->height), tile_from(x + 1, f->width),
		      tile_from(y + 1, f->height)};
}

/* How many sites it may have. */
static inline uint32_t most_of(const frame *f, int i)
{
	tile t = tile_of(f, i);
	uint32_t most = (uint32_t)((t.end - t.x) * (t.last - t.y));
	return most > LEAST_BOUND ? most : LEAST_BOUND;
}

/* ---- sites near a place ---------------------------------------------------------------------------------- */

static inline float apart2(const site *a, const site *b)
{
	float dx = a->placed.x - b->placed.x, dy = a->placed.y - b->placed.y;
	return dx * dx + dy * dy;
}

/* Below 0 where what the two part changes the other way round along their axis. */
static inline int step_dot(const site *a, const site *b)
{
	const int8_t *p = a->placed.step, *q = b->placed.step;
	return p[0] * q[0] + p[1] * q[1] + p[2] * q[2];
}

static inline size_t cell_of(const fine *n, const placed *s)
{
	int x = pixel_of(s->x, n->f->width) / CELL, y = pixel_of(s->y, n->f->height) / CELL;
	return (size_t)y * (size_t)n->across + (size_t)x;
}

typedef struct near_sites {
	int row, last, x0, x1;
	uint32_t i, end;
} near_sites;

/* All sites in a box, and more. */
static inline near_sites near_box(const fine *n, float left, float top, float right, float bottom)
{
	return (near_sites){
		.row = pixel_of(top, n->f->height) / CELL,
		.last = pixel_of(bottom, n->f->height) / CELL,
		.x0 = pixel_of(left, n->f->width) / CELL,
		.x1 = pixel_of(right, n->f->width) / CELL,
	};
}

/* All sites within `reach` of (x, y), and more. */
static inline near_sites near_place(const fine *n, float x, float y, float reach)
{
	return near_box(n, x - reach, y - reach, x + reach, y + reach);
}

static inline near_sites near_site(const fine *n, const site *s, float reach)
{
	return near_place(n, s->placed.x, s->placed.y, reach);
}

static inline bool near_next(const fine *n, near_sites *of, uint32_t *site)
{
	while (of->i == of->end) {
		if (of->row > of->last)
			return false;
		const uint32_t *cell = n->cell + (ptrdiff_t)of->row++ * n->across;
		of->i = cell[of->x0];
		of->end = cell[of->x1 + 1];
	}
	*site = n->member[of->i++];
	return true;
}

/* How far a site keeps from one of an earlier family, but for stripes. */
static inline float clear_from(const site *s, const site *older)
{
	bool turns = s->found.family == FAMILY_LIGHT && older->found.family == FAMILY_LIGHT_STEP &&
		     s->found.axis != older->found.axis;
	return turns ? clear_of_turn : clear_of_older;
}

/* Pixels in a px of room between lines: in small frames at least so many, closer lines these can't part, and in large
 * ones no more than 8. */
static inline float room_px(const fine *n, float least)
{
	return min(max(n->f->scale, least), 8);
}

/* In px: over so much each way what tells of lines between colours, their room and how long they are, is averaged.
 * Pixels in a px at least: lines that are nearer than 1.5 pixels these can't part. test_fine_passes, test_scale */
static const float color_spread = 20, color_least_px = 0.6f;

/* Sums of two values of all sites about one, from those of cells, with weights that fall to 0 at `spread` pixels. */
static inline void sums_about(const fine *n, float (*cells)[2], const site *s, float spread, float sum[2])
{
	near_sites of = near_site(n, s, spread);
	sum[0] = sum[1] = 0;
	for (int row = of.row; row <= of.last; row++)
		for (int x = of.x0; x <= of.x1; x++) {
			const float *cell = cells[row * n->across + x];
			float dx = ((float)x + 0.5f) * CELL - 0.5f - s->placed.x,
			      dy = ((float)row + 0.5f) * CELL - 0.5f - s->placed.y;
			float weight = max(0, 1 - fabsf(dx) / spread) * max(0, 1 - fabsf(dy) / spread);
			sum[0] += weight * cell[0];
			sum[1] += weight * cell[1];
		}
}

/* ---- order ----------------------------------------------------------------------------------------------- */

/* For qsort(): below, at or above 0. */
static inline int order(float a, float b)
{
	return (a > b) - (a < b);
}

static inline int order_of(uint32_t a, uint32_t b)
{
	return (a > b) - (a < b);
}

/* ---- pieces ---------------------------------------------------------------------------------------------- */

enum { PIECE = 4096, STOP = 32 };

/* Asked before the i-th step of what can't be shared among threads: it may have been cancelled. */
static inline int32_t at_step(const fine *n, uint32_t i)
{
	if (i % STOP)
		return ENCRE_OK;
	return i % PIECE == 0 ? bands_poll(n->f->bands) : bands_stopped(n->f->bands) ? ENCRE_ERROR_CANCELLED : ENCRE_OK;
}

/* Likewise by kernels: whether to return at once. */
static inline bool stopped_at(const fine *n, int i)
{
	return i % STOP == 0 && bands_stopped(n->f->bands);
}

/* ---- what meshes tell ------------------------------------------------------------------------------------ */

/* What chains tell of a site of theirs. */
static inline const chain_site *chain_of(const fine *n, const site *s)
{
	return n->chain + (s - n->site);
}

/* Whether a line was drawn by hand. */
static inline bool is_by_hand(const fine *n, const site *s)
{
	return is_chain(s) && (chain_of(n, s)->kind & ENCRE_CHAIN_MARK);
}

/* ---- chains ---------------------------------------------------------------------------------------------- */

static inline uint32_t links_at(const fine *n, uint32_t i)
{
	return n->at[i + 1] - n->at[i];
}

static inline bool is_end(const fine *n, uint32_t i)
{
	return !n->site[i].linked.dropped && links_at(n, i) == 1;
}

/* The next site of a chain, coming from `from`; UINT32_MAX at its end. */
static inline uint32_t next_of(const fine *n, uint32_t from, uint32_t i)
{
	const uint32_t *to = n->to + n->at[i];
	return links_at(n, i) != 2 ? UINT32_MAX : to[0] == from ? to[1] : to[0];
}

/* The two sites that site i is linked to, each of which the other one takes out of it (^); UINT32_MAX: there are not
 * two. */
static inline uint32_t both_of(const fine *n, uint32_t i)
{
	const uint32_t *to = n->to + n->at[i];
	return links_at(n, i) == 2 ? to[0] ^ to[1] : UINT32_MAX;
}

/* Whether of the lines that meet at site i the one over j is younger than two others, which go on through it. */
static inline bool branches_off(const fine *n, uint32_t i, uint32_t j)
{
	if (links_at(n, i) < 3 || rank_of(n->site + j) <= rank_of(n->site + i))
		return false;
	int older = 0;
	for (uint32_t k = n->at[i]; k < n->at[i + 1]; k++)
		older += !n->site[n->to[k]].linked.dropped && rank_of(n->site + n->to[k]) < rank_of(n->site + j);
	return older > 1;
}

/* A site of a thin thing that covers no pixel centre there lies between sites where it covers some again. */
typedef struct between {
	int hits; /* how many are known */
	uint32_t hit[2];
	int links[2];   /* from the site to each, the first the nearer one */
	float along[2]; /* likewise, in pixels */
} between;

static inline between between_of(const fine *n, uint32_t i)
{
	between b = {0};
	for (uint32_t k = n->at[i]; k < n->at[i + 1] && b.hits < 2; k++) {
		uint32_t from = i, at = n->to[k];
		int links = 1;
		float along = sqrtf(apart2(n->site + i, n->site + at));
		while (at != UINT32_MAX && at != i && n->site[at].found.family == FAMILY_THIN &&
		       !n->site[at].linked.dropped) {
			uint32_t next = next_of(n, from, at);
			from = at;
			at = next;
			if (at != UINT32_MAX)
				along += sqrtf(apart2(n->site + from, n->site + at));
			links++;
		}
		if (at == UINT32_MAX || at == i || n->site[at].linked.dropped)
			continue;
		int nearer = b.hits && (links < b.links[0] || (links == b.links[0] && at < b.hit[0]));
		b.hit[b.hits] = b.hit[0];
		b.links[b.hits] = b.links[0];
		b.along[b.hits] = b.along[0];
		int own = nearer ? 0 : b.hits;
		b.hit[own] = at;
		b.links[own] = links;
		b.along[own] = along;
		b.hits++;
	}
	return b;
}

/* The site that tells what a line is of. */
static inline uint32_t told_by(const fine *n, uint32_t i)
{
	if (n->site[i].found.family != FAMILY_THIN)
		return i;
	between b = between_of(n, i);
	return b.hits ? b.hit[0] : i;
}

/* The way of the line at a site, of any length; false where several meet. */
static inline bool way_of(const fine *n, uint32_t i, float way[2])
{
	uint32_t links = links_at(n, i);
	if (links != 1 && links != 2)
		return false;
	const site *a = n->site + n->to[n->at[i]], *b = links == 2 ? n->site + n->to[n->at[i] + 1] : n->site + i;
	way[0] = b->placed.x - a->placed.x;
	way[1] = b->placed.y - a->placed.y;
	return true;
}

#endif
