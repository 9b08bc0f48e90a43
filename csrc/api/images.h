/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Checks of single images. They return ENCRE_OK, or ENCRE_ERROR_ARGUMENT and one sentence in error[size]. */
#ifndef ENCRE_IMAGES_H
#define ENCRE_IMAGES_H

#include "base/stage.h"

#include <stddef.h>

enum { MAX_SIZE = 65536, NUMBER = sizeof(float) };

/* Blocks of `own` bytes from `from` to `end`: count[1] groups, step[1] apart, of count[0] blocks, step[0] apart. */
typedef struct grid {
	int64_t from, end, own, step[2];
	int count[2];
} grid;

/* Where the samples of an image lie. */
int32_t check_memory(const char *name, const encre_image *given, char *error, size_t size);
/* Channels, size and memory. */
int32_t check_image(const encre_image *image, const encre_layer_description *what, int width, int height, char *error,
		    size_t size);
/* Of an image with strides. */
grid grid_of(const encre_image *image);
grid grid_of_bytes(const void *from, size_t bytes);
/* An output, which has strides, and something else. */
int32_t check_apart(const char *name, const encre_image *output, const char *other, grid taken, char *error,
		    size_t size);
/* Of n images those that are there, of which the first `inputs` are only read: checked as `what` says, written to
 * `clean` with strides, every output apart from all before it. */
int32_t check_images(int n, int inputs, const encre_layer_description *what, const encre_image *const *given,
		     encre_image *const *clean, int width, int height, char *error, size_t size);

#endif
