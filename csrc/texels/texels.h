/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Where colors part in an image that lies on surfaces: curves through its texels, of each of its levels of detail. */
#ifndef ENCRE_TEXELS_H
#define ENCRE_TEXELS_H

#include "base/metric.h"
#include "base/stage.h"

enum { TEXEL_LEVELS = 14, TEXEL_CELL = 8 /* texels from side to side of a cell */ };

/* A part of a curve, straight from one point to another. An image that repeats goes on: shift bit 0 puts an end one
 * width further, bit 1 one height. */
typedef struct texel_line {
	int32_t point[2];
	uint8_t shift[2];
	uint8_t apart;    /* 16ths of a texel between lines there, on the mean; 255: that or more */
	int32_t color[2]; /* left and right of its way, v up: sRGB, 0xrrggbb */
} texel_line;

/* Places are in texels of the level; (0, 0) is where u and v are 0. */
typedef struct texel_level {
	int32_t width, height;
	int32_t n_points, n_lines;
	float (*point)[2];
	texel_line *line;
	/* Lines by square cells that their boxes touch: member[first[cell]] to member[first[cell + 1] - 1]. */
	int32_t across, tall;
	int32_t *first, *member;
} texel_level;

/* What is asked of an image. */
typedef struct texel_recipe {
	const encre_colored *image;
	color_metric metric;
	float least; /* of contrast */
	bool smooth;
} texel_recipe;

typedef struct boundaries {
	int64_t key;
	int32_t width, height, wrap, closest;
	color_metric metric;
	float least;
	bool smooth, used;
	int32_t n_levels;
	uint32_t made; /* bit k: level k */
	texel_level level[TEXEL_LEVELS];
} boundaries;

/* How much is there at each texel of a level, 0..1. */
typedef struct alpha_level {
	const float *alpha; /* height x width; NULL: all is */
	int32_t width, height;
	bool wrap, closest;
} alpha_level;

/* A way along which two colors part that lies between two neighbouring texels: one of those that find.c gives. */
typedef struct crossing {
	float x, y;
	int32_t color[2]; /* of the lower and of the higher texel */
	float contrast;
} crossing;

typedef struct crossings {
	int32_t width, height;                       /* of the level */
	bool wrap_x, wrap_y, closest, smooth, first; /* first: the image itself */
	/* By texel: of the crossing between it and the next to the right, and the next up; -1: none. */
	int32_t *right, *up;
	crossing *at;
	int64_t count, room;
	float least; /* of contrast */
	alpha_level alpha;
} crossings;

/* A part of a curve between two crossings, or from one to where several meet. */
typedef struct curve_part {
	int32_t end[2];
	uint8_t shift[2];
	int32_t color[2]; /* left and right */
} curve_part;

typedef struct net {
	const crossings *c;
	float (*point)[2];
	int32_t n_points;
	curve_part *part;
	int64_t n_parts, room_parts, room_points;
	int32_t (*of)[4]; /* by point: its parts; -1 */
	bool failed;
} net;

static inline texel_recipe recipe_of_image(const encre_colored *image, color_metric metric, float least, bool smooth)
{
	return (texel_recipe){image, metric, least, smooth && !image->closest};
}

static inline bool boundaries_are(const boundaries *b, const texel_recipe *r)
{
	return b->key == r->image->key && b->width == r->image->width && b->height == r->image->height &&
	       b->wrap == r->image->wrap && b->closest == r->image->closest && b->metric.kind == r->metric.kind &&
	       b->metric.hue == r->metric.hue && b->metric.saturation == r->metric.saturation &&
	       b->metric.lightness == r->metric.lightness && b->least == r->least && b->smooth == r->smooth;
}

/* Without a level; NULL without memory. */
boundaries *boundaries_begin(const texel_recipe *r);
/* parting.c: makes those of `levels`, bits, that are not there. False without memory: some are not. */
bool boundaries_fill_base(boundaries *b, const texel_recipe *r, uint32_t levels);
bool boundaries_fill_v3(boundaries *b, const texel_recipe *r, uint32_t levels);
void level_free(texel_level *l);
void boundaries_free(boundaries *b);
/* net.c: joins crossings. False without memory: what it has made is there to be freed all the same. */
bool net_join(net *n, crossings *c);
/* tracing.c: from crossings to curves; how different two colors are as bytes. False without memory. */
int color_apart(int32_t a, int32_t b);
bool texel_curves(crossings *c, texel_level *level);
/* holes.c: gives what is clear the colors about it; leaves of lines what is there. False without memory. */
bool holes_fill(const alpha_level *a, float *linear);
bool holes_cut(const alpha_level *a, texel_level *level);
/* sorting.c: fills the cells of a level, and `apart` of its lines. False without memory. */
bool texel_sort(texel_level *level);

#endif
