/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Few flat colors in the place of an image's many: what the room's files share. */
#ifndef ENCRE_FLAT_H
#define ENCRE_FLAT_H

#include "base/bands.h"
#include "base/pixel.h"

#include <stdbool.h>
#include <stddef.h>

enum {
	FLAT_MOST = 1024, /* texels from side to side in which areas are looked for */
	FLAT_UNIT = 8192, /* of whole numbers: sums of these are the same in any order */
	FLAT_CLEAR = -1,  /* in the place of an area or a color, where nothing is there */
};

/* Lightness differs within one thing that shade is painted on, hue does not. */
static const float flat_lightness = 0.6f, flat_hue = 1.4f;

/* The image as it is looked at: `factor` texels from side to side are one. Colors are OKLab, scaled by the above. */
typedef struct flat {
	const encre_picture *picture;
	bands *pool;
	int factor, width, height;
	bool wraps;
	bool clean;           /* drawn in flat colors: all that is sharp in it is meant */
	float *color, *other; /* height x width x 3 */
	int32_t (*fixed)[3];  /* in FLAT_UNIT, smoothed */
	int32_t (*given)[3];  /* likewise, as they were */
	int32_t *area;        /* by texel: the number of its area; at last of its color */
	int32_t n_areas, n_colors;
	int64_t (*sum)[3];   /* by area, of `fixed` */
	int32_t *size;       /* by area, in texels; 0: it is part of another */
	float (*palette)[3]; /* linear */
	float (*place)[3];   /* likewise, as `color` has them */
	int32_t *map;        /* by area: its color */
} flat;

static inline size_t flat_index(const flat *f, int x, int y)
{
	x = f->wraps ? wrap_index(x, f->width) : clamp_index(x, f->width);
	y = f->wraps ? wrap_index(y, f->height) : clamp_index(y, f->height);
	return (size_t)y * (size_t)f->width + (size_t)x;
}

/* The color of a texel of the image, linear, and its alpha. */
void flat_texel(const encre_picture *t, size_t number, float out[4]);
void flat_from_linear(const float rgb[3], float out[3]);
void flat_to_linear(const float place[3], float rgb[3]);
/* look.c: fills `color` and `area` (0 or FLAT_CLEAR), then smooths from `given` to `fixed`, which `other` helps. */
int32_t flat_look(flat *f);
/* areas.c: joins texels to areas. */
int32_t flat_areas(flat *f);
/* palette.c: gives areas colors, `most` at most. */
int32_t flat_colors(flat *f, int most);
/* fill.c: writes the colors of texels into the image. */
int32_t flat_fill(flat *f, uint8_t *bytes, float *texels);

/* Makes few and flat what `texels` or `bytes`, those of the picture, have of its first level. */
int32_t flat_run(bands *pool, const encre_picture *picture, int most, uint8_t *bytes, float *texels);

#endif
