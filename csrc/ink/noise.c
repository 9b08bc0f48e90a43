/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Solid noise at the anchor of the surface in front at a site. What is drawn by it sticks to the thing, and needs no
 * other frame. */
#include "ink/noise.h"

#include "base/pixel.h"
#include "base/stage.h"
#include "fine/near.h"

/* ---- noise ----------------------------------------------------------------------------------------------- */

/* One over the standard deviation of value noise: the weights are Perlin's quintic, whose squares and those of the rest
 * have a mean of 181/231 an axis. */
static const float unit_variance = 2.4972f;

/* A hash of a seed and three numbers, one after the other: corners that share a number share what it made. */
static inline uint32_t hash_x(uint32_t seed, int32_t x)
{
	uint32_t h = ((seed + 0x2545f491u) * 0x9e3779b1u ^ (uint32_t)x) * 0x85ebca6bu;
	return h ^ h >> 13;
}

static inline uint32_t hash_y(uint32_t h, int32_t y)
{
	h = (h ^ (uint32_t)y) * 0xc2b2ae35u;
	return h ^ h >> 16;
}

static inline float hash_z(uint32_t h, int32_t z)
{
	h = (h ^ (uint32_t)z) * 0x27d4eb2fu;
	h = (h ^ h >> 15) * 0x165667b1u;
	h ^= h >> 13;
	return (float)(int32_t)(h >> 8) * (2.0f / 16777216) - 1;
}

static inline float quintic(float t)
{
	return t * t * t * (t * (t * 6 - 15) + 10);
}

static inline float along_x(uint32_t low, uint32_t high, int32_t y, int32_t z, float w)
{
	return mix(hash_z(hash_y(low, y), z), hash_z(hash_y(high, y), z), w);
}

static inline float lattice(float x, float y, float z, uint32_t seed)
{
	x = min(max(x, -1e9f), 1e9f);
	y = min(max(y, -1e9f), 1e9f);
	z = min(max(z, -1e9f), 1e9f);
	float fx = floorf(x), fy = floorf(y), fz = floorf(z);
	int32_t ix = (int32_t)fx, iy = (int32_t)fy, iz = (int32_t)fz;
	float wx = quintic(x - fx), wy = quintic(y - fy), wz = quintic(z - fz);
	uint32_t low = hash_x(seed, ix), high = hash_x(seed, ix + 1);
	float one = mix(along_x(low, high, iy, iz, wx), along_x(low, high, iy + 1, iz, wx), wy),
	      two = mix(along_x(low, high, iy, iz + 1, wx), along_x(low, high, iy + 1, iz + 1, wx), wy);
	return mix(one, two, wz);
}

/* Two octaves are blended, the finer one entering with weight 0 where its turn comes, so that nothing pops while a
 * thing comes nearer. */
void ISA(solid_row)(const spots *at, int n, const float *restrict length, const uint32_t *restrict seed,
		    float *restrict noise)
{
	const float *restrict x = at->x, *restrict y = at->y, *restrict z = at->z, *restrict unit = at->unit;
	for (int i = 0; i < n; i++) {
		float rate = 1 / (unit[i] * length[i]);
		int some = (rate > 1e-30f) & (rate < 1e30f);
		rate = some ? rate : 1;
		int32_t bits = float_bits(rate), octave = (bits >> 23) - 127;
		float part = (float)(bits & 0x7fffff) * (1.0f / 8388608);
		/* an offset of its own, or the zeros of all octaves met in the origin */
		float scale = bits_float((octave + 127) << 23), aside = 17.3f * (float)octave;
		float coarse = lattice(x[i] * scale + aside, y[i] * scale + aside, z[i] * scale + aside, seed[i]);
		scale = bits_float((octave + 128) << 23);
		aside = 17.3f * (float)(octave + 1);
		float finer = lattice(x[i] * scale + aside, y[i] * scale + aside, z[i] * scale + aside, seed[i]);
		float turn = part * (1.3466f - 0.3466f * part) * 1.57079633f; /* log2(1 + part), to 0.01 */
		float value = (pixel_cos(turn) * coarse + pixel_sin(turn) * finer) * unit_variance;
		noise[i] = some ? value : 0;
	}
}

/* ---- spots ----------------------------------------------------------------------------------------------- */

typedef struct spot {
	float p[3], unit;
} spot;

/* As near as this share of its depth, pixels beside the front-most one count as its surface. */
static const float one_surface = 0.02f;

/* Pixels of a surface that faces the camera: so far it is followed beside the centre of a pixel. */
static const float farthest = 6;

/* Adds the rest position that the surface of a pixel has at a site beside its centre: a line that is nearly level steps
 * from row to row, and on a surface seen at a flat angle a row is a long way. One seen on its edge tells nothing of
 * what lies beyond. */
static void add_place(const float *anchor, float x, float y, float weight, spot *sum)
{
	float more[3], square = 0, most = farthest * anchor[ANCHOR_PIXEL];
	for (int c = 0; c < 3; c++) {
		more[c] = x * anchor[ANCHOR_RIGHT + c] + y * anchor[ANCHOR_DOWN + c];
		square += more[c] * more[c];
	}
	float kept = square > most * most ? most / sqrtf(square) : 1;
	for (int c = 0; c < 3; c++)
		sum->p[c] += weight * (anchor[ANCHOR_POSITION + c] + kept * more[c]);
}

/* The mean, by nearness, of those of the four pixels about a site that show the surface in front: so noise runs on
 * evenly where the thing moves by parts of a pixel. A crack may lie on the centres beyond those that it parts, or be
 * moved there as lines are smoothed: it keeps its own. Where nothing tells, a place in the frame. */
static spot spot_of(const frame *f, const site *s)
{
	bool crack = is_crack(s->found.family);
	float x = s->placed.x, y = s->placed.y, front = INFINITY, sum = 0;
	float left = crack && s->found.axis != AXIS_COLUMN ? (float)s->found.column : floorf(x),
	      top = crack && s->found.axis != AXIS_ROW ? (float)s->found.row : floorf(y);
	/* in units of length, or another number of pixels would have other octaves, and so another line */
	spot at = {.p = {(x + (float)f->place.x + 0.5f) / f->scale, (y + (float)f->place.y + 0.5f) / f->scale, 0},
		   .unit = 1};
	const float *anchor[4];
	float depth[4], object[4], weight[4], number = 0;
	if (!f->layer[ENCRE_LAYER_ANCHOR].data)
		return at;
	for (int k = 0; k < 4; k++) {
		int px = clamp_index((int)left + (k & 1), f->width), py = clamp_index((int)top + (k >> 1), f->height);
		const float *objects = layer_row(f, ENCRE_LAYER_OBJECT, py);
		float fx = clamp01(x - left), fy = clamp01(y - top);
		anchor[k] = anchor_at(f, px, py);
		depth[k] = anchor[k][ANCHOR_PIXEL] > 0 ? depth_at(f, px, py) : INFINITY;
		object[k] = objects ? objects[px] : 0;
		weight[k] = 1e-3f + (k & 1 ? fx : 1 - fx) * (k >> 1 ? fy : 1 - fy);
		front = min(front, depth[k]);
	}
	if (!(front < INFINITY))
		return at;
	/* which of two things that touch is nearer changes from site to site: always the same of them */
	for (int k = 0; k < 4; k++)
		number = depth[k] <= front * (1 + one_surface) ? max(number, object[k]) : number;
	at = (spot){0};
	for (int k = 0; k < 4; k++) {
		if (!(depth[k] <= front * (1 + one_surface)) || object[k] != number)
			continue;
		float px = clamp01(x - left) - (float)(k & 1), py = clamp01(y - top) - (float)(k >> 1);
		add_place(anchor[k], px, py, weight[k], &at);
		at.unit += weight[k] * anchor[k][ANCHOR_PIXEL];
		sum += weight[k];
	}
	for (int c = 0; c < 3; c++)
		at.p[c] = bounded(at.p[c] / sum);
	at.unit = min(at.unit / sum * f->scale, 1e30f);
	return at;
}

/* Of a line that chains tell: on the surface that it is of, whatever passes in front of it, touches it, or shows behind
 * it: of one thing, too, as the inside of a car through its window. */
static spot spot_on(const frame *f, const site *s)
{
	int x = s->placed.near_x, y = s->placed.near_y;
	float left = floorf(s->placed.x), top = floorf(s->placed.y), sum = 0, own = object_at(f, x, y);
	float depth = depth_at(f, x, y), apart = one_surface * fabsf(depth);
	spot at = {0};
	if (!f->layer[ENCRE_LAYER_ANCHOR].data || !(anchor_at(f, x, y)[ANCHOR_PIXEL] > 0))
		return spot_of(f, s);
	for (int k = 0; k < 5; k++) { /* the four about it, and where they are of other things its own */
		int px = k < 4 ? clamp_index((int)left + (k & 1), f->width) : x,
		    py = k < 4 ? clamp_index((int)top + (k >> 1), f->height) : y;
		const float *anchor = anchor_at(f, px, py);
		float dx = s->placed.x - (float)px, dy = s->placed.y - (float)py;
		float weight = k < 4 ? clamp01(1 - fabsf(dx)) * clamp01(1 - fabsf(dy)) : 1e-3f;
		bool same = object_at(f, px, py) == own && fabsf(depth_at(f, px, py) - depth) <= apart;
		if (!same || !(anchor[ANCHOR_PIXEL] > 0) || !(weight > 0))
			continue;
		add_place(anchor, dx, dy, weight, &at);
		at.unit += weight * anchor[ANCHOR_PIXEL];
		sum += weight;
	}
	for (int c = 0; c < 3; c++)
		at.p[c] = bounded(at.p[c] / sum);
	at.unit = min(at.unit / sum * f->scale, 1e30f);
	return at;
}

/* Of a thin thing that covers no pixel centre there, between the places where it covers some again. */
static spot spot_between(const frame *f, const site *s)
{
	const fine *n = f->fine;
	between b = {0};
	if (is_chain(s))
		return spot_on(f, s);
	if (s->found.family == FAMILY_THIN)
		b = between_of(n, (uint32_t)(s - n->site));
	if (!b.hits)
		return spot_of(f, s);
	spot at = spot_of(f, n->site + b.hit[0]);
	if (b.hits < 2)
		return at;
	spot other = spot_of(f, n->site + b.hit[1]);
	float whole = b.along[0] + b.along[1], share = whole > 0 ? b.along[0] / whole : 0;
	for (int c = 0; c < 3; c++)
		at.p[c] = mix(at.p[c], other.p[c], share);
	at.unit = mix(at.unit, other.unit, share);
	return at;
}

void ISA(spots_fill)(const frame *f, const site *s, int n, const spots *to)
{
	enum { AHEAD = 12 };
	bool known = f->layer[ENCRE_LAYER_ANCHOR].data != NULL;
	for (int i = 0; i < n; i++) {
		/* what spot_of() reads lies far apart; a function that only asks for it is left out by gcc 12 */
		const site *later = s + (i + AHEAD < n ? i + AHEAD : i);
		for (int k = 0; known && k < 2; k++) {
			int x = clamp_index((int)later->placed.x, f->width),
			    y = clamp_index((int)later->placed.y + k, f->height);
			const float *anchor = anchor_at(f, x, y);
			__builtin_prefetch(anchor);
			__builtin_prefetch(anchor + ANCHOR_COUNT);
			__builtin_prefetch(layer_row(f, ENCRE_LAYER_DEPTH, y) + x);
		}
		spot at = s[i].linked.dropped ? (spot){.unit = 1} : spot_between(f, s + i);
		to->x[i] = at.p[0];
		to->y[i] = at.p[1];
		to->z[i] = at.p[2];
		to->unit[i] = at.unit;
	}
}
