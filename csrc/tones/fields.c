/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Where screens lie: coordinates of the picture, or of the thing at rest. */
#include "tones/tones.h"

void ISA(tone_screen_field)(const frame *f, int y, int x, int n, float right, float down, tone_field *field)
{
	float row = (float)(f->place.y + y) + 0.5f;
	for (int i = 0; i < n; i++) {
		field->at[i] = right * ((float)(f->place.x + x + i) + 0.5f) + down * row;
		field->right[i] = right;
		field->down[i] = down;
	}
}

void ISA(tone_surface_field)(const float *restrict anchor, int n, const float along[3], tone_field *field)
{
	for (int i = 0; i < n; i++) {
		const float *a = anchor + (ptrdiff_t)ANCHOR_COUNT * i, *r = a + ANCHOR_RIGHT, *d = a + ANCHOR_DOWN;
		field->at[i] = a[0] * along[0] + a[1] * along[1] + a[2] * along[2];
		field->right[i] = r[0] * along[0] + r[1] * along[1] + r[2] * along[2];
		field->down[i] = d[0] * along[0] + d[1] * along[1] + d[2] * along[2];
	}
}

void ISA(tone_surface_chart)(const float *restrict anchor, int n, float cosine, float sine, tone_field field[2])
{
	for (int i = 0; i < n; i++) {
		const float *a = anchor + (ptrdiff_t)ANCHOR_COUNT * i, *normal = a + ANCHOR_NORMAL;
		float x = fabsf(normal[0]), y = fabsf(normal[1]), z = fabsf(normal[2]);
		int first = x >= y && x >= z ? 1 : 0, second = x < z && y < z ? 1 : 2;
		for (int k = 0; k < 2; k++) {
			float one = k ? -sine : cosine, two = k ? cosine : sine;
			field[k].at[i] = one * a[first] + two * a[second];
			field[k].right[i] = one * a[ANCHOR_RIGHT + first] + two * a[ANCHOR_RIGHT + second];
			field[k].down[i] = one * a[ANCHOR_DOWN + first] + two * a[ANCHOR_DOWN + second];
		}
	}
}

void ISA(tone_cut)(const float *restrict anchor, int n, const float along[3], float *restrict cut)
{
	for (int i = 0; i < n; i++) {
		const float *normal = anchor + (ptrdiff_t)ANCHOR_COUNT * i + ANCHOR_NORMAL;
		float dot = normal[0] * along[0] + normal[1] * along[1] + normal[2] * along[2];
		cut[i] = clamp01((sqrtf(max(1 - dot * dot, 0)) - 0.3f) / 0.12f);
	}
}
