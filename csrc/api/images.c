/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Whether images are what they should be, and what is written lies apart from what is read. */
#include "api/images.h"
#include "base/refuse.h"

#include <stdbool.h>

/* ---- images ---------------------------------------------------------------------------------------------- */

/* Bytes from pixel to pixel and from row to row: with no more than that sums of them don't overflow. */
static const int64_t most_stride = (int64_t)1 << 45;

static int64_t distance(int64_t stride)
{
	return stride < 0 ? -stride : stride;
}

/* Rows may lie within each other where pixels lie far enough apart: pictures are stored column by column, too. */
int32_t check_memory(const char *name, const encre_image *given, char *error, size_t size)
{
	encre_image image = with_strides(*given);
	int64_t own = NUMBER * (int64_t)image.channels, pixel = image.pixel_stride;
	if ((uintptr_t)image.data % NUMBER)
		return refuse(error, size, "%s: begins at an address that is no multiple of %d; copy it to one that is",
			      name, (int)NUMBER);
	if (pixel % NUMBER || image.row_stride % NUMBER || pixel < own || pixel > most_stride ||
	    image.row_stride > most_stride || image.row_stride < -most_stride)
		return refuse(error, size,
			      "%s: strides of %lld and %lld bytes are not whole floats, shorter than a pixel or longer "
			      "than memory; give multiples of %d",
			      name, (long long)pixel, (long long)image.row_stride, (int)NUMBER);
	int64_t row = pixel * (image.width - 1) + own, stride = distance(image.row_stride);
	if (image.height > 1 && stride < row && (stride < own || pixel < stride * (image.height - 1) + own))
		return refuse(
			error, size,
			"%s: rows of %lld bytes begin %lld bytes apart and overlap; give a row_stride of a row or "
			"more",
			name, (long long)row, (long long)image.row_stride);
	return ENCRE_OK;
}

int32_t check_image(const encre_image *image, const encre_layer_description *what, int width, int height, char *error,
		    size_t size)
{
	if (image->channels != what->channels)
		return refuse(error, size, "%s: has %d channels; give %d", what->name, (int)image->channels,
			      (int)what->channels);
	if (image->width < 1 || image->height < 1 || image->width > MAX_SIZE || image->height > MAX_SIZE)
		return refuse(error, size, "%s: is %d x %d pixels; give 1 to %d each way", what->name,
			      (int)image->width, (int)image->height, MAX_SIZE);
	if (image->width != width || image->height != height)
		return refuse(error, size, "%s: is %d x %d pixels where %d x %d are due; give all images the same size",
			      what->name, (int)image->width, (int)image->height, width, height);
	return check_memory(what->name, image, error, size);
}

/* ---- what is written ------------------------------------------------------------------------------------- */

grid grid_of(const encre_image *image)
{
	const int64_t alone = INT64_MAX / 4; /* there is no other one */
	int64_t pixel = image->pixel_stride, row = distance(image->row_stride);
	grid g = {.from = (int64_t)(uintptr_t)image->data, .own = NUMBER * (int64_t)image->channels};
	g.from += image->row_stride < 0 ? image->row_stride * (image->height - 1) : 0;
	g.end = g.from + row * (image->height - 1) + pixel * (image->width - 1) + g.own;
	pixel = image->width > 1 ? pixel : alone;
	row = image->height > 1 ? row : alone;
	int outer = pixel <= row;
	g.step[outer] = row;
	g.step[!outer] = pixel;
	g.count[outer] = image->height;
	g.count[!outer] = image->width;
	return g;
}

grid grid_of_bytes(const void *from, size_t bytes)
{
	int64_t at = (int64_t)(uintptr_t)from;
	return (grid){.from = at, .end = at + (int64_t)bytes};
}

static int64_t floor_divide(int64_t a, int64_t b)
{
	int64_t q = a / b;
	return q - (q * b > a);
}

/* Whether two grids have a byte in common. Of different ones, which may only lie between each other by chance, it
 * counts that they reach into each other. */
static bool meet(const grid *a, const grid *b)
{
	if (a->end <= b->from || b->end <= a->from)
		return false;
	for (int k = 0; k < 2; k++)
		if (a->step[k] != b->step[k] || a->count[k] != b->count[k])
			return true;
	/* a block of b lies `off` beyond one of a; in each step that must be less than the step itself */
	int64_t apart = b->from - a->from, outer = floor_divide(-apart, a->step[1]);
	for (int64_t i = outer; i <= outer + 1; i++) {
		if (i <= -a->count[1] || i >= a->count[1])
			continue;
		int64_t rest = apart + i * a->step[1], inner = floor_divide(-rest, a->step[0]);
		for (int64_t j = inner; j <= inner + 1; j++) {
			if (j <= -a->count[0] || j >= a->count[0])
				continue;
			int64_t off = rest + j * a->step[0];
			if (off < a->own && -off < b->own)
				return true;
		}
	}
	return false;
}

int32_t check_apart(const char *name, const encre_image *output, const char *other, grid taken, char *error,
		    size_t size)
{
	grid written = grid_of(output);
	if (!meet(&written, &taken))
		return ENCRE_OK;
	return refuse(error, size, "%s: shares memory with %s; give every output memory of its own", name, other);
}

int32_t check_images(int n, int inputs, const encre_layer_description *what, const encre_image *const *given,
		     encre_image *const *clean, int width, int height, char *error, size_t size)
{
	int32_t code = ENCRE_OK;
	for (int i = 0; !code && i < n; i++) {
		if (!given[i]->data && what[i].required)
			return refuse(error, size, "%s: this image is missing and required; give it", what[i].name);
		if (!given[i]->data)
			continue;
		code = check_image(given[i], what + i, width, height, error, size);
		*clean[i] = with_strides(*given[i]);
		for (int k = 0; !code && i >= inputs && k < i; k++)
			if (given[k]->data)
				code = check_apart(what[i].name, clean[i], what[k].name, grid_of(clean[k]), error,
						   size);
	}
	return code;
}
