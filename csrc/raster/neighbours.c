/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What happens between the centres of two neighbours. Pictures are read here once, row by row: columns of several would
 * be looked up over and over. */
#include "raster/bends.h"

#include "base/pixel.h"

typedef struct row {
	const char *data;
	int64_t step; /* bytes */
} row;

static row row_of(const encre_image *image, int y, int channel)
{
	static const float nothing = 0;
	if (!image->data)
		return (row){(const char *)&nothing, 0};
	return (row){(const char *)(pixel_at(image, 0, y) + channel), image->pixel_stride};
}

static inline const float *in_row(const row *r, int x)
{
	return (const float *)(r->data + x * r->step);
}

/* Of a unit normal, whether it is there. */
static inline bool there(const float *n)
{
	return (n[0] != 0) | (n[1] != 0) | (n[2] != 0);
}

static void find_row(const bends *s, int y, int axis)
{
	const encre_raster_job *job = s->job;
	row normals = row_of(&job->normal, y, 0), next = row_of(&job->normal, y + axis, 0),
	    objects = row_of(&job->object, y, 0), beside = row_of(&job->object, y + axis, 0),
	    creases = row_of(&job->creases, y, 2 * axis + 1), marks = row_of(&job->marks, y, axis);
	uint8_t *way = s->way + (ptrdiff_t)y * s->width;
	int ahead = !axis, end = s->width - ahead;
	for (int x = 0; x < end; x++) {
		const float *n = in_row(&normals, x), *m = in_row(&next, x + ahead);
		float mark = contour_mark(*in_row(&marks, x));
		bool closed = *in_row(&objects, x) != *in_row(&beside, x + ahead) || !there(n) || !there(m) ||
			      *in_row(&creases, x) >= 180 || mark < 0;
		bool turns = n[0] != m[0] || n[1] != m[1] || n[2] != m[2];
		way[x] |= (uint8_t)((closed ? WAY_CLOSED : turns ? WAY_TURNS : 0) << WAY_BITS * axis);
	}
}

void neighbours_rows(void *data, int y0, int y1, int thread)
{
	(void)thread;
	const bends *s = data;
	for (int y = y0; y < y1; y++) {
		memset(s->way + (ptrdiff_t)y * s->width, 0, (size_t)s->width);
		find_row(s, y, 0);
		if (y + 1 < s->height)
			find_row(s, y, 1);
	}
}
