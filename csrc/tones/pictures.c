/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Tones of a picture: a tile whose texels are inked one after the other, the darkest first, so that as many are as the
 * darkness asks. A texel's threshold is its rank, which makes the ink's share exact whatever the tile's contrast. What
 * a pixel covers of inked and bare texels is its ink. On surfaces tiles are a pitch or up to two wide, and pass piece
 * by piece to those of half the width. */
#include "tones/tones.h"

enum { MOST = 1024, LEVELS = TONE_GREYS, PIECES = 12 /* of a tile, each way */ };

tone_picture ISA(tone_picture_of)(const encre_image *image, float pitch)
{
	tone_picture p = {.image = image, .shrink = 1, .width = 1, .height = 1};
	if (!image->data)
		return p;
	int longer = image->width > image->height ? image->width : image->height,
	    side = image->width < image->height ? image->width : image->height;
	float texels = (float)image->width / (pitch > 2 ? pitch : 2);
	while (((float)(p.shrink + 1) <= texels || longer / p.shrink > MOST) && p.shrink < side)
		p.shrink++;
	p.width = image->width / p.shrink;
	p.height = image->height / p.shrink;
	p.aspect = (float)p.width / (float)p.height;
	return p;
}

static inline float clean(float v)
{
	return v > 0 ? v < 1 ? v : 1 : 0;
}

static void level_rows(void *data, int y0, int y1, int thread)
{
	(void)thread;
	const tone_picture *p = data;
	const encre_image image = with_strides(*p->image);
	float share = (float)(LEVELS - 1) / (float)(p->shrink * p->shrink);
	for (int y = y0; y < y1; y++)
		for (int x = 0; x < p->width; x++) {
			float sum = 0;
			for (int j = 0; j < p->shrink; j++)
				for (int i = 0; i < p->shrink; i++) {
					const float *in = pixel_at(&image, x * p->shrink + i, y * p->shrink + j);
					sum += image.channels < 3 ? clean(in[0])
								  : luminance(clean(in[0]), clean(in[1]), clean(in[2]));
				}
			p->threshold[(ptrdiff_t)y * p->width + x] = floorf(sum * share + 0.5f);
		}
}

/* Levels become thresholds; of one level any order is as good. */
static void rank_rows(void *data, int y0, int y1, int thread)
{
	(void)thread;
	const tone_picture *p = data;
	float all = 1 / (float)(p->width * p->height);
	for (int i = y0 * p->width; i < y1 * p->width; i++) {
		int32_t level = (int32_t)p->threshold[i];
		level = level < LEVELS ? level : LEVELS - 1;
		uint32_t below = level ? p->count[level - 1] : 0, same = p->count[level] - below;
		float within = (float)(int32_t)(mix_bits((uint32_t)i) >> 8) * (1.0f / 16777216);
		p->threshold[i] = ((float)below + within * (float)same) * all;
	}
}

int32_t ISA(tone_picture_fill)(frame *f, tone_picture *p)
{
	int32_t code = bands_run(f->bands, p->height, 0, level_rows, p);
	for (int i = 0; i < LEVELS; i++)
		p->count[i] = 0;
	for (int i = 0; !code && i < p->width * p->height; i++) {
		int32_t level = (int32_t)p->threshold[i];
		p->count[level < LEVELS ? level : LEVELS - 1]++;
	}
	for (int i = 1; i < LEVELS; i++)
		p->count[i] += p->count[i - 1];
	return code ? code : bands_run(f->bands, p->height, 0, rank_rows, p);
}

/* A pixel's place between two texels: the first, and how much of it lies on the second, where a texel is `wide` pixels.
 */
static inline int texel_at(float at, int n, float wide, bool crisp, float *share)
{
	float part = at - floorf(at);
	float u = (part >= 0 ? part : 0) * (float)n - 0.5f; /* a place beyond the largest number is none */
	float whole = floorf(u), s = u - whole;
	wide = wide > 1 ? wide : 1;
	*share = crisp ? (s >= 0.5f ? 1.0f : 0.0f) : clamp01((s - 0.5f) * wide + 0.5f);
	return whole < 0 ? n - 1 : (int)whole < n ? (int)whole : n - 1;
}

/* Ink of the tile at (u, v), in tiles, on the screen so many pixels wide and high. */
static float ink_at(const tone_picture *p, float u, float v, float wide, float high, bool crisp, float dark)
{
	float s, t;
	int i = texel_at(u, p->width, wide / (float)p->width, crisp, &s),
	    j = texel_at(v, p->height, high / (float)p->height, crisp, &t);
	int right = i + 1 < p->width ? i + 1 : 0, down = j + 1 < p->height ? j + 1 : 0;
	const float *a = p->threshold + (ptrdiff_t)j * p->width, *b = p->threshold + (ptrdiff_t)down * p->width;
	float above = mix(a[i] < dark ? 1.0f : 0.0f, a[right] < dark ? 1.0f : 0.0f, s);
	float below = mix(b[i] < dark ? 1.0f : 0.0f, b[right] < dark ? 1.0f : 0.0f, s);
	return mix(above, below, t);
}

/* How far a piece of a tile has passed to the tile of half the width, as the tile is so far grown. To mix both is grey,
 * so each piece has its own time; but what goes over in few frames pops: a piece takes most of an octave, which is gone
 * through at an even pace (about the logarithm of 1 + grown). */
static inline float halved(float grown, uint32_t hash)
{
	const float slow = 0.7f;
	float begins = (1 - slow) * ((float)(int32_t)(hash & 0xffff) * (1.0f / 65536));
	return clamp01((grown * (4 - grown) * (1.0f / 3) - begins) * (1 / slow));
}

static inline uint32_t piece(float at)
{
	return (uint32_t)(int32_t)floorf(min(max(at * PIECES, -1e9f), 1e9f));
}

void ISA(tone_picture_row)(const tone_slot *slot, int n, const tone_field chart[2], const float *restrict dark,
			   float *restrict ink)
{
	const tone_picture *p = slot->picture;
	tone_lattice l;
	/* as if painted on, a texel is never smaller than a pixel */
	float least = slot->pitch > 2 ? slot->pitch : 2, most = least;
	if (slot->space == tone_1_space_OBJECT) {
		least = (float)p->width;
		most = 1e6f;
	}
	ISA(tone_lattice_fill)(least, most, n, chart, &l);
	for (int i = 0; i < n; i++) {
		if (!p->threshold || l.flat[i] > 0) {
			ink[i] = dark[i];
			continue;
		}
		float wide = sqrtf(l.across[0][i] * l.across[0][i] + l.up[0][i] * l.up[0][i]),
		      high = sqrtf(l.across[1][i] * l.across[1][i] + l.up[1][i] * l.up[1][i]);
		uint32_t hash = mix_bits(mix_bits(piece(l.at[0][i])) ^ piece(l.at[1][i]));
		float first = halved(l.grown[0][i], hash), second = halved(l.grown[1][i], hash),
		      both = min(first, second);
		float share[4] = {1 - max(first, second), first - both, second - both, both}, sum = 0;
		for (int k = 0; k < 4; k++) {
			float u = k & 1 ? 2.0f : 1.0f, v = k >> 1 ? 2 * p->aspect : p->aspect;
			if (share[k] > 0)
				sum += share[k] * ink_at(p, l.at[0][i] * u, l.at[1][i] * v, wide / u, high / v,
							 slot->crisp, dark[i]);
		}
		ink[i] = sum;
	}
}
