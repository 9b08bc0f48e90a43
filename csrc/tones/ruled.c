/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Lines at the whole numbers of a field, 2^m of them per unit. m is such that they are a pitch or up to two apart;
 * those half-way between, which belong to m + 1 alone, have grown to g of the width, g going from 0 to 1 until the next
 * m: so nothing pops, and a line is always of the same width on the screen. Ink is the exact share of a pixel's width.
 */
#include "tones/tones.h"

enum { LEFT = -2, RIGHT = 3 }; /* half-way steps at which lines are looked at: as far as a soft pixel reaches */

void ISA(tone_lines)(const tone_screen *screen, int n, const tone_field *field, const float *restrict dark,
		     float *restrict ink)
{
	float least = screen->least, most = screen->most;
	for (int i = 0; i < n; i++) {
		float slope = sqrtf(field->right[i] * field->right[i] + field->down[i] * field->down[i]), grown;
		float unit = 1 / max(slope, 1e-18f), pitch = min(max(unit, least), most);
		float soft = screen->soft, reach = 0.5f * soft, share = 1 / soft;
		float scale = octave(unit / pitch, &grown);
		float at = 2 * scale * field->at[i], first = floorf(at), off = at - first, step = 0.5f * pitch * grown;
		float odd = first - 2 * floorf(0.5f * first), whole = 0.5f * pitch * dark[i];
		float young = whole * (grown - 1), sum = 0;
		for (int k = LEFT; k <= RIGHT; k++) {
			float half = (k & 1 ? 1 - odd : odd) > 0.5f ? young : whole, middle = ((float)k - off) * step;
			float right = min(middle + half, reach), left = max(middle - half, -reach);
			sum += max(right - left, 0);
		}
		ink[i] = clamp01(sum * share);
	}
}
