/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The painting of a ball, as small as the picture wants it, taken apart into coarse colours and what the brush left
 * over them. */
#include "surface/ball.h"

enum { MOST = 2048 };

static const float ball_share = 0.375f; /* radius of the ball, of the picture's shorter side */

/* What can't be a colour is black. Square roots are about as even to the eye as sRGB. */
static inline float even(float v)
{
	return v > 0 && v <= 1e30f ? sqrtf(v) : 0;
}

static void paint_rows(void *data, int y0, int y1, int thread)
{
	(void)thread;
	const ball *b = data;
	const encre_image image = with_strides(*b->image);
	float share = 1 / (float)(b->shrink * b->shrink);
	for (int y = y0; y < y1; y++)
		for (int x = 0; x < b->width; x++) {
			float sum[3] = {0};
			for (int j = 0; j < b->shrink; j++)
				for (int i = 0; i < b->shrink; i++) {
					const float *in = pixel_at(&image, x * b->shrink + i, y * b->shrink + j);
					for (int c = 0; c < 3; c++)
						sum[c] += even(in[image.channels < 3 ? 0 : c]);
				}
			for (int c = 0; c < 3; c++)
				b->paint[4 * ((ptrdiff_t)y * b->width + x) + c] = sum[c] * share;
			b->paint[4 * ((ptrdiff_t)y * b->width + x) + 3] = 0;
		}
}

/* Means of squares of the painting, of which the coarse colours are made. */
static void mean_rows(void *data, int y0, int y1, int thread)
{
	(void)thread;
	const ball *b = data;
	for (int y = y0; y < y1; y++)
		for (int x = 0; x < b->columns; x++) {
			int top = y * b->square, left = x * b->square;
			int end = top + b->square < b->height ? top + b->square : b->height,
			    right = left + b->square < b->width ? left + b->square : b->width;
			float sum[4] = {0}, share = 1 / (float)((end - top) * (right - left));
			for (int j = top; j < end; j++)
				for (int i = left; i < right; i++)
					for (int c = 0; c < 4; c++)
						sum[c] += b->paint[4 * ((ptrdiff_t)j * b->width + i) + c];
			for (int c = 0; c < 4; c++)
				b->coarse[0][4 * ((ptrdiff_t)y * b->columns + x) + c] = sum[c] * share;
		}
}

/* Means of five squares, along rows or columns. */
static void spread(const ball *b, const float *restrict in, bool down, float *restrict out)
{
	for (int y = 0; y < b->rows; y++)
		for (int x = 0; x < b->columns; x++) {
			float sum[4] = {0};
			for (int k = -2; k <= 2; k++) {
				int i = down ? x : clamp_index(x + k, b->columns),
				    j = down ? clamp_index(y + k, b->rows) : y;
				for (int c = 0; c < 4; c++)
					sum[c] += in[4 * ((ptrdiff_t)j * b->columns + i) + c];
			}
			for (int c = 0; c < 4; c++)
				out[4 * ((ptrdiff_t)y * b->columns + x) + c] = 0.2f * sum[c];
		}
}

/* The painting becomes what it has over the coarse colours, and, fourth, how light that is, -1..1. */
static void detail_rows(void *data, int y0, int y1, int thread)
{
	(void)thread;
	const ball *b = data;
	for (int y = y0; y < y1; y++)
		for (int x = 0; x < b->width; x++) {
			float *at = b->paint + 4 * ((ptrdiff_t)y * b->width + x), coarse[4];
			coarse_at(b, (float)x, (float)y, coarse);
			for (int c = 0; c < 3; c++)
				at[c] -= coarse[c];
			float light = luminance(at[0], at[1], at[2]) * 8;
			at[3] = light > 1 ? 1 : light < -1 ? -1 : light;
		}
}

int32_t ISA(ball_paint)(frame *f, ball *b)
{
	int32_t code = bands_run(f->bands, b->height, 0, paint_rows, b);
	if (!code)
		code = bands_run(f->bands, b->rows, 0, mean_rows, b);
	for (int k = 0; k < 3; k++) {
		spread(b, b->coarse[0], false, b->coarse[1]);
		spread(b, b->coarse[1], true, b->coarse[0]);
	}
	return code ? code : bands_run(f->bands, b->height, 0, detail_rows, b);
}

ball ISA(ball_of)(const frame *f, const encre_params *p)
{
	const encre_image *image = &p->example_image;
	int side = image->width < image->height ? image->width : image->height, shrink = 1;
	int longer = image->width < image->height ? image->height : image->width;
	float size = p->example_size * f->scale, texels = 2 * ball_share * (float)side / max(size, 1e-3f);
	while (((float)(shrink + 1) <= texels || longer / shrink > MOST) && shrink < side)
		shrink++;
	ball b = {.image = image, .shrink = shrink, .width = image->width / shrink, .height = image->height / shrink};
	b.texels = texels / (float)shrink;
	b.radius = ball_share * (float)(b.width < b.height ? b.width : b.height);
	b.middle[0] = 0.5f * (float)(b.width - 1);
	b.middle[1] = 0.5f * (float)(b.height - 1);
	b.square = b.radius >= 24 ? (int)(b.radius / 24) : 1;
	b.columns = (b.width + b.square - 1) / b.square;
	b.rows = (b.height + b.square - 1) / b.square;
	return b;
}
