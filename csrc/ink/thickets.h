/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Where lines would cover more of the picture than they may. */
#ifndef ENCRE_THICKETS_H
#define ENCRE_THICKETS_H

#include "ink/noise.h"
#include "ink/tips.h"

/* matters.c: by site, how much its line matters, 0..1. */
int32_t ISA(lines_matter)(frame *f, const spots *at, float *matters);
/* What of its line is kept at each site, from what room leaves of it there. */
int32_t ISA(lines_decide)(frame *f, float *left, float *kept);
/* thickets.c: by site, how much of a hand's pressure is left where lines are many, by ends that are pressed evenly:
 * each is shorter there than a swelling, and some would be bold, their neighbours faint. */
int32_t ISA(thickets_press)(frame *f, const pen_end *end, float *press);
/* Thins the ends of all strokes, by how much of what is about them those of the first cover; where `kept`
 * isn't NULL, that gets what is left of each line. */
int32_t ISA(thickets_thin)(frame *f, uint32_t strokes, const spots *at, pen_end *end, float *kept);

#endif
