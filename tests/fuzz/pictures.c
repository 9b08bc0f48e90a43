/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Random images: the ways in which they may lie in memory, and what they show. */
#include "fuzz.h"

#include <math.h>
#include <string.h>

/* ---- where they lie ---------------------------------------------------------------------------------------- */

enum { BESIDE = 16 /* channels that share memory */ };

encre_image picture(int width, int height, int channels, shared *beside)
{
	encre_image image = {.width = width, .height = height, .channels = channels};
	int64_t pixel = 4 * (int64_t)channels, row;
	if (beside && chance(0.2) && beside->used + channels <= BESIDE) {
		if (!beside->at) {
			beside->pixel_stride = 4 * BESIDE;
			beside->row_stride = beside->pixel_stride * width;
			beside->at = take((size_t)(beside->row_stride * height));
		}
		image.data = (float *)(beside->at + 4 * beside->used);
		image.pixel_stride = beside->pixel_stride;
		image.row_stride = beside->row_stride;
		beside->used += channels;
		return image;
	}
	if (chance(0.5)) {
		image.data = take((size_t)(pixel * width * height));
		return image;
	}
	bool columns = chance(0.1);
	pixel += chance(0.3) ? 4 * whole(1, 3) : 0;
	row = pixel * (columns ? height : width) + (chance(0.3) ? 4 * whole(1, 7) : 0);
	size_t size =
		(size_t)(columns ? row * (width - 1) + pixel * (height - 1) : row * (height - 1) + pixel * (width - 1));
	char *at = take(size + 4 * (size_t)channels);
	image.pixel_stride = columns ? row : pixel;
	image.row_stride = columns ? pixel : row;
	if (chance(0.3)) {
		at += image.row_stride * (height - 1);
		image.row_stride = -image.row_stride;
	}
	image.data = (float *)at;
	return image;
}

float *sample(const encre_image *image, int x, int y)
{
	int64_t pixel = image->pixel_stride ? image->pixel_stride : 4 * (int64_t)image->channels;
	int64_t row = image->row_stride ? image->row_stride : pixel * image->width;
	return (float *)((char *)image->data + y * row + x * pixel);
}

/* ---- what they show ---------------------------------------------------------------------------------------- */

enum { DISC, HALF_PLANE, STRIPE, BOX, KINDS };
enum { SMOOTH, SPECKLED, CHECKED, NOISES };

scene random_scene(int width, int height)
{
	scene s = {.n_shapes = whole(0, 8), .noise = chance(0.7) ? SMOOTH : whole(SMOOTH, NOISES)};
	s.weird = chance(0.3) ? magnitude(-4, 0) : 0;
	for (int i = 0; i < s.n_shapes; i++) {
		s.shape[i].x = share() * width;
		s.shape[i].y = share() * height;
		s.shape[i].size = chance(0.4) ? 0.3 + 3 * share() : share() * 0.5 * (width + height);
		s.shape[i].slope = (float)tan(3.1 * (share() - 0.5));
		s.shape[i].kind = whole(0, KINDS - 1);
		for (int c = 0; c < ENCRE_MAX_CHANNELS; c++)
			s.shape[i].value[c] = whole(0, 255) / 255.0;
	}
	return s;
}

static bool covers(const struct shape *s, double x, double y)
{
	double dx = x - s->x, dy = y - s->y;
	switch (s->kind) {
	case DISC: return dx * dx + dy * dy < s->size * s->size;
	case HALF_PLANE: return dy > s->slope * dx;
	case STRIPE: return fabs(dy - s->slope * dx) < 0.5 * s->size * sqrt(1 + s->slope * s->slope);
	default: return fabs(dx) < s->size && fabs(dy) < s->size;
	}
}

/* The shape in front, 0 for none, seen from a few places within a pixel: averaged layers show shares. */
static double value_of(const scene *s, double x, double y, int channel, double base, double slope)
{
	for (int i = 0; i < s->n_shapes; i++)
		if (covers(s->shape + i, x, y))
			return s->shape[i].value[channel];
	return base + slope * (x - y);
}

static double noise_at(int kind, int x, int y)
{
	return kind == CHECKED ? (x ^ y) & 1 : kind == SPECKLED ? share() < 0.05 : share();
}

static float stored(enum content content, double value, double scale)
{
	switch (content) {
	case DEPTHS: return value > 0.9 ? 1e10f : (float)(scale * (0.1 + value));
	case DIRECTIONS: return (float)(2 * value - 1);
	case NUMBERS: return (float)floor(5 * value);
	case SHARES: return (float)(2.2 * value - 1.1);
	case LIGHTS: return (float)(1.5 * scale * value);
	default: return (float)(scale * value);
	}
}

void paint(const encre_image *image, enum content content, const scene *s)
{
	double scale = chance(0.8) ? 1 : magnitude(-3, 3), base[ENCRE_MAX_CHANNELS];
	int noise = content == NUMBERS || chance(0.5) ? s->noise : SMOOTH;
	bool averaged = content != DEPTHS && content != NUMBERS && chance(0.7);
	if (s->weird > 0 && chance(0.1))
		scale = magnitude(-38, 38);
	double slope = share() / (image->width + image->height);
	for (int c = 0; c < ENCRE_MAX_CHANNELS; c++)
		base[c] = share();
	for (int y = 0; y < image->height; y++)
		for (int x = 0; x < image->width; x++) {
			float *at = sample(image, x, y);
			for (int c = 0; c < image->channels; c++) {
				double b = base[c], v = value_of(s, x + 0.5, y + 0.5, c, b, slope);
				if (averaged)
					v = 0.25 * (v + value_of(s, x + 0.2, y + 0.7, c, b, slope) +
						    value_of(s, x + 0.7, y + 0.8, c, b, slope) +
						    value_of(s, x + 0.8, y + 0.2, c, b, slope));
				v = noise == SMOOTH ? v : 0.5 * (v + noise_at(noise, x, y));
				at[c] = s->weird > 0 && chance(s->weird) ? weird() : stored(content, v, scale);
			}
		}
}
