/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The pens of a style, and which kind of line each of them draws. */
#include "ink/pen.h"

#include <stddef.h>
#include <string.h>

/* Another for each so many frames, and never 0. */
static uint32_t again(const hand *h, int32_t number)
{
	if (h->pen_hold < 1)
		return 0;
	int32_t turn = number / h->pen_hold - (number % h->pen_hold < 0);
	return ((uint32_t)turn * 0x9e3779b1u) | 1;
}

pens ISA(pens_of)(const frame *f, const encre_params *p)
{
	pens s = {0};
	/* the rows of a pen lie one after the other */
	memcpy(s.hand, &p->pen_1_width, sizeof *s.hand);
	memcpy(s.hand + 1, &p->pen_2_width, sizeof *s.hand);
	memcpy(s.hand + 2, &p->pen_3_width, sizeof *s.hand);
#define LINE(kind, id, ...) s.of[LINE_##kind] = (uint8_t)p->line_##id##_pen;
	LINES(LINE)
#undef LINE
	for (int k = 0; k < LINE_COUNT; k++) {
		s.differ |= s.of[k] != 0;
		s.used |= (uint8_t)(1 << s.of[k]);
	}
	const encre_image *strip[PENS] = {&p->pen_1_strip_image, &p->pen_2_strip_image, &p->pen_3_strip_image};
	memcpy(s.strip, strip, sizeof strip);
	for (int k = 0; k < PENS; k++)
		s.again[k] = again(s.hand + k, f->place.number);
	return s;
}

#define ROWS_LIE(pen)                                                                                                  \
	_Static_assert(offsetof(encre_params, pen##_boil) - offsetof(encre_params, pen##_width) ==                     \
			       offsetof(hand, pen_boil),                                                               \
		       "rows of a pen are its hand");
ROWS_LIE(pen_1)
ROWS_LIE(pen_2)
ROWS_LIE(pen_3)
#undef ROWS_LIE
uint32_t ISA(pens_strokes)(const pens *s)
{
	uint32_t most = 1;
	for (int k = 0; k < PENS; k++)
		if (s->used >> k & 1 && (uint32_t)s->hand[k].pen_strokes > most)
			most = (uint32_t)s->hand[k].pen_strokes;
	return most;
}
