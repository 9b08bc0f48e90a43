/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Marks: lines that were drawn by hand. The layer says exactly where each passes between two pixels, so that nothing is
 * searched for. Where contours run they own the line, but marks come before all that the averaged layers show. */
#include "fine/near.h"

static float mark_at(const fine *n, int x, int y, int axis)
{
	plane marks = n->f->layer[ENCRE_LAYER_MARKS];
	return contour_mark(marks.data[y * marks.row + (ptrdiff_t)2 * x + axis]);
}

float ISA(hand_place)(const fine *n, const found *at)
{
	float place = n->f->layer[ENCRE_LAYER_MARKS].data ? mark_at(n, at->column, at->row, at->axis) : 0;
	return place < 0 ? -contour_place(place) : clamp01(place);
}

int ISA(hand_steps)(const fine *n, const found *at)
{
	return n->e->creases && n->f->layer[ENCRE_LAYER_MARKS].data
		       ? contour_steps(mark_at(n, at->column, at->row, at->axis))
		       : 0;
}

bool ISA(hand_site)(const fine *n, const found *at, placed *s)
{
	crack_place(at, ISA(hand_place)(n, at), s);
	s->strength = 0;
	return ISA(fine_weigh)(n, s, fine_style(n, at, s), SOURCE_MARK, 1);
}

void ISA(hand_row)(const fine *n, int y)
{
	int width = n->f->width;
	if (!n->e->on[SOURCE_MARK] || !n->f->layer[ENCRE_LAYER_MARKS].data)
		return;
	const float *marks = layer_row(n->f, ENCRE_LAYER_MARKS, y);
	int any = 0; /* most rows have none, and are looked through at once */
	for (int i = 0; i < 2 * width; i++)
		any |= marks[i] > 0;
	if (!any)
		return;
	for (int x = 0; x < width; x++)
		for (int axis = 0; axis < 2; axis++) {
			found at = {(uint16_t)x, (uint16_t)y, FAMILY_MARK, (uint8_t)axis};
			placed s;
			bool inside = axis ? y + 1 < n->f->height : x + 1 < width;
			if (inside && mark_at(n, x, y, axis) > 0 && ISA(hand_site)(n, &at, &s))
				n->crack[(ptrdiff_t)y * width + x] |= (uint8_t)mark_of(FAMILY_MARK, axis);
		}
}
