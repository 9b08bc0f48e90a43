/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Where chains tell all lines of shapes, and pixels make none. */
#include "fine/chains/stations.h"

#include <string.h>

/* Of the depth: what lies so much nearer hides what is behind, and the line is its own. */
static const float nearer = 0.01f;
enum { REPLACED = 1, REPLACED_COLORS = 2 }; /* of fine.replaced */
enum { AROUND = 2 /* pixels about a place where the layers show something else */, ROWS = 16 };

/* ---- pixels ---------------------------------------------------------------------------------------------- */

static void replace_rows(void *data, int y0, int y1, int thread)
{
	(void)thread;
	const fine *n = data;
	const frame *f = n->f;
	for (int y = y0; y < y1; y++) {
		uint8_t *out = n->replaced + (ptrdiff_t)y * f->width;
		const float *object = layer_row(f, ENCRE_LAYER_OBJECT, y);
		for (int x = 0; x < f->width; x++) {
			float number = object ? object[x] : 0;
			bool there = depth_at(f, x, y) < INFINITY, known = number >= 0 && number < (float)f->n_chained;
			out[x] = known ? f->chained[(int64_t)number] & (REPLACED | REPLACED_COLORS) : 0;
			out[x] |= there ? 0 : REPLACED;
		}
	}
}

int32_t ISA(chains_replace)(stations *s)
{
	fine *n = s->n;
	const frame *f = n->f;
	n->replaced = late_take(&n->f->late, (size_t)f->width * (size_t)f->height, 1);
	n->uncut = late_take(&n->f->late, (size_t)f->width * (size_t)f->height, 1);
	if (!n->replaced || !n->uncut)
		return ENCRE_ERROR_MEMORY;
	int32_t code = bands_run(f->bands, f->height, ROWS, replace_rows, n);
	for (uint32_t i = 0; !code && i < s->count; i++) {
		const station *t = s->at + i;
		code = at_step(n, i);
		if (!(t->flags & STATION_HIDDEN))
			continue;
		int x = (int)floor(t->x - f->place.x + 0.5), y = (int)floor(t->y - f->place.y + 0.5);
		for (int qy = y - AROUND; qy <= y + AROUND; qy++)
			for (int qx = x - AROUND; qx <= x + AROUND; qx++)
				if (qx >= 0 && qy >= 0 && qx < f->width && qy < f->height)
					n->replaced[(ptrdiff_t)qy * f->width + qx] = 0;
	}
	return code;
}

/* ---- cracks ---------------------------------------------------------------------------------------------- */

/* Marks of the cracks between a pixel and its right or lower neighbour that come as chains. Between one whose lines do
 * and one whose don't, those of what is nearer. */
static int replaced_between(const fine *n, int x, int y, int axis)
{
	const frame *f = n->f;
	int qx = x + !axis, qy = y + axis;
	if (qx >= f->width || qy >= f->height)
		return 0;
	bool one = n->replaced[(ptrdiff_t)y * f->width + x] & REPLACED,
	     two = n->replaced[(ptrdiff_t)qy * f->width + qx] & REPLACED;
	int own_mark = mark_of(FAMILY_CRACK, axis);
	float a = depth_at(f, x, y), b = depth_at(f, qx, qy);
	if (!one || !two) {
		float own = one ? a : b, other = one ? b : a;
		return one != two && own * (1 + nearer) < other ? own_mark : 0;
	}
	return own_mark;
}

/* Whether all about a pixel is of one object and material whose images tell where its colors part. */
static bool is_colored(const fine *n, int x, int y)
{
	const frame *f = n->f;
	if (!(n->replaced[(ptrdiff_t)y * f->width + x] & REPLACED_COLORS))
		return false;
	for (int k = 0; k < 9; k++) {
		int qx = clamp_index(x + k % 3 - 1, f->width), qy = clamp_index(y + k / 3 - 1, f->height);
		const float *material[2] = {layer_row(f, ENCRE_LAYER_MATERIAL, y),
					    layer_row(f, ENCRE_LAYER_MATERIAL, qy)};
		if (object_at(f, qx, qy) != object_at(f, x, y) || (material[0] && material[0][x] != material[1][qx]))
			return false;
	}
	return true;
}

static void leave_rows(void *data, int y0, int y1, int thread)
{
	(void)thread;
	const fine *n = data;
	int width = n->f->width;
	for (int y = y0; y < y1 && !bands_stopped(n->f->bands); y++) {
		uint8_t *crack = n->crack + (ptrdiff_t)y * width;
		uint16_t *ridge = n->ridge + (ptrdiff_t)y * width;
		memcpy(n->uncut + (ptrdiff_t)y * width, crack, (size_t)width);
		for (int x = next_marked(crack, 0, width); x < width; x = next_marked(crack, x + 1, width))
			crack[x] &= (uint8_t)~(replaced_between(n, x, y, 0) | replaced_between(n, x, y, 1));
		int normals = 0, colors = 0;
		for (int axis = 0; axis < 2; axis++)
			colors |= mark_of(FAMILY_COLOR, axis) | mark_of(FAMILY_COLOR_BAND, axis);
		for (int axis = 0; axis < 2 && !n->bumps; axis++)
			normals |= mark_of(FAMILY_NORMAL, axis) | mark_of(FAMILY_NORMAL_BAND, axis);
		for (int x = 0; x < width; x++) {
			if (n->replaced[(ptrdiff_t)y * width + x] & REPLACED)
				ridge[x] &= (uint16_t)~normals;
			if (ridge[x] & colors && is_colored(n, x, y))
				ridge[x] &= (uint16_t)~colors;
		}
	}
}

/* What is mixed stays so: `uncut` has all cracks. */
int32_t ISA(chains_leave)(fine *n)
{
	int32_t code = bands_run(n->f->bands, n->f->height, ROWS, leave_rows, n);
	n->mixed = n->uncut;
	return code;
}
