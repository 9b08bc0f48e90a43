/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Where a surface turns from one axis of its thing to the next lies a seam of two lattices of strokes or spots, those
 * of the axis that its normal is longest along. Beside it strokes are smaller; spots would leave a row of paper, so
 * their places themselves tell on which side they lie. */
#include "tones/strokes.h"

static const float most_ahead = 0.3f; /* no seam is so near */

/* By how much a normal's largest part is above the next. */
static float lead_of(const tone_rest *rest, int i)
{
	const float (*normal)[TONE_REST] = rest->at + ANCHOR_NORMAL;
	float x = fabsf(normal[0][i]), y = fabsf(normal[1][i]), z = fabsf(normal[2][i]), most = max(max(x, y), z);
	return 2 * most - (x + y + z - min(min(x, y), z));
}

bool ISA(tone_near_seam)(const tone_rest *rest, int i)
{
	return lead_of(rest, i) <= most_ahead;
}

/* By how much the size of a normal's parts grows to the next pixel along the row or the column, on the side where it
 * turns less, for the other may lie beyond an edge; returns how far it turns there. */
static float turns_by(const frame *f, const tone_slot *s, const tone_rest *rest, int i, int x, int y, bool down,
		      float grows[3])
{
	float room[ANCHOR_COUNT], least = 1;
	grows[0] = grows[1] = grows[2] = 0;
	for (int side = -1; side < 2; side += 2) {
		int column = tone_within(down ? x : x + side, f->width),
		    row = tone_within(down ? y + side : y, f->height);
		const float *there = ISA(tone_anchor)(f, s, row, column, 1, room) + ANCHOR_NORMAL;
		float turn = 0;
		for (int k = 0; k < 3; k++)
			turn = max(turn, fabsf(there[k] - rest->at[ANCHOR_NORMAL + k][i]));
		for (int k = 0; turn < least && k < 3; k++)
			grows[k] = (float)side * (fabsf(there[k]) - fabsf(rest->at[ANCHOR_NORMAL + k][i]));
		least = min(least, turn);
	}
	return least;
}

/* Which side of a seam is whose is told by pixels: from nothing within one of them, and larger for two more, so that
 * there is as much ink. */
float ISA(tone_grown_beside_seam)(const frame *f, const tone_slot *s, const tone_rest *rest, int i, int x, int y)
{
	float here = lead_of(rest, i), steep = 0, grows[3];
	if (here > most_ahead)
		return 1;
	for (int axis = 0; axis < 2; axis++)
		steep += turns_by(f, s, rest, i, x, y, axis, grows);
	float away = here / max(2 * steep, 1e-6f);
	return clamp01(away) * (1 + clamp01((3 - away) / 2) / 3);
}

bool ISA(tone_before_seam)(const frame *f, const tone_slot *s, const tone_rest *rest, int i, int x, int y, int axis,
			   bool second, const float way[2])
{
	float right[3], down[3], part[3];
	turns_by(f, s, rest, i, x, y, false, right);
	turns_by(f, s, rest, i, x, y, true, down);
	for (int k = 0; k < 3; k++)
		part[k] = fabsf(rest->at[ANCHOR_NORMAL + k][i]) + way[0] * right[k] + way[1] * down[k];
	float lead = part[axis] - max(part[(axis + 1) % 3], part[(axis + 2) % 3]);
	return second ? lead > 0 : lead >= 0;
}
