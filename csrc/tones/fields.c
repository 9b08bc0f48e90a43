/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Where screens lie: coordinates of the picture, or of the thing at rest. */
#include "tones/tones.h"

#include <string.h>

void ISA(tone_screen_field)(const frame *f, int y, int x, int n, float right, float down, tone_field *field)
{
	float row = (float)(f->place.y + y) + 0.5f;
	for (int i = 0; i < n; i++) {
		field->at[i] = right * ((float)(f->place.x + x + i) + 0.5f) + down * row;
		field->right[i] = right;
		field->down[i] = down;
	}
}

void ISA(tone_surface_field)(const float *restrict anchor, int n, const float direction[3], float per,
			     tone_field *field)
{
	float along[3] = {direction[0] * per, direction[1] * per, direction[2] * per};
	for (int i = 0; i < n; i++) {
		const float *a = anchor + (ptrdiff_t)ANCHOR_COUNT * i, *r = a + ANCHOR_RIGHT, *d = a + ANCHOR_DOWN;
		field->at[i] = a[0] * along[0] + a[1] * along[1] + a[2] * along[2];
		field->right[i] = r[0] * along[0] + r[1] * along[1] + r[2] * along[2];
		field->down[i] = d[0] * along[0] + d[1] * along[1] + d[2] * along[2];
	}
}

/* A sheet stands upright in x and z, as a wall before the eye. */
const float *ISA(tone_anchor)(const frame *f, const tone_slot *s, int y, int x, int n, float *room)
{
	if (!s || !tone_flat(s))
		return anchor_at(f, x, y);
	const float *card = layer_row(f, ENCRE_LAYER_CARD, y);
	for (int i = 0; card && i < n; i++) {
		const float *c = card + (ptrdiff_t)CARD_COUNT * (x + i);
		float right = c[CARD_RIGHT], up = c[CARD_RIGHT + 1];
		const float sheet[ANCHOR_COUNT] = {[ANCHOR_POSITION] = c[CARD_POSITION],
						   [ANCHOR_POSITION + 2] = c[CARD_POSITION + 1],
						   [ANCHOR_NORMAL + 1] = -1,
						   [ANCHOR_PIXEL] = sqrtf(right * right + up * up),
						   [ANCHOR_RIGHT] = right,
						   [ANCHOR_RIGHT + 2] = up,
						   [ANCHOR_DOWN] = up,
						   [ANCHOR_DOWN + 2] = -right};
		memcpy(room + (ptrdiff_t)ANCHOR_COUNT * i, sheet, sizeof sheet);
	}
	return card ? room : NULL;
}

static float size_on_sheet(const float *card)
{
	return sqrtf(card[CARD_RIGHT] * card[CARD_RIGHT] + card[CARD_RIGHT + 1] * card[CARD_RIGHT + 1]);
}

bool ISA(tone_sizes)(const frame *f, const tone_slot *s, int y, int x, int n, float *restrict size)
{
	const float *anchor = anchor_at(f, x, y), *card = layer_row(f, ENCRE_LAYER_CARD, y);
	if (!(tone_flat(s) ? card : anchor))
		return false;
	for (int i = 0; tone_flat(s) && i < n; i++)
		size[i] = size_on_sheet(card + (ptrdiff_t)CARD_COUNT * (x + i));
	for (int i = 0; !tone_flat(s) && i < n; i++)
		size[i] = anchor[(ptrdiff_t)ANCHOR_COUNT * i + ANCHOR_PIXEL];
	return true;
}

/* As tone_anchor() tells a sheet. */
static const tone_rest *sheet_fill(const float *restrict card, int n, tone_rest *rest)
{
	memset(rest, 0, sizeof *rest);
	for (int i = 0; i < n; i++) {
		const float *c = card + (ptrdiff_t)CARD_COUNT * i;
		rest->at[ANCHOR_POSITION][i] = c[CARD_POSITION];
		rest->at[ANCHOR_POSITION + 2][i] = c[CARD_POSITION + 1];
		rest->at[ANCHOR_NORMAL + 1][i] = -1;
		rest->at[ANCHOR_PIXEL][i] = size_on_sheet(c);
		rest->at[ANCHOR_RIGHT][i] = c[CARD_RIGHT];
		rest->at[ANCHOR_RIGHT + 2][i] = rest->at[ANCHOR_DOWN][i] = c[CARD_RIGHT + 1];
		rest->at[ANCHOR_DOWN + 2][i] = -c[CARD_RIGHT];
	}
	return rest;
}

static const tone_rest *surface_fill(const float *restrict anchor, int n, tone_rest *restrict rest)
{
	for (int i = 0; i < n; i++)
		for (int c = 0; c < ANCHOR_COUNT; c++)
			rest->at[c][i] = anchor[(ptrdiff_t)ANCHOR_COUNT * i + c];
	return rest;
}

const tone_rest *ISA(tone_rest_fill)(const frame *f, const tone_slot *s, int y, int x, int n, tone_rest *rest)
{
	n = x + n < f->width ? n + 1 : n;
	const float *anchor = anchor_at(f, x, y), *card = layer_row(f, ENCRE_LAYER_CARD, y);
	if (!s || !tone_flat(s))
		return anchor ? surface_fill(anchor, n, rest) : NULL;
	return card ? sheet_fill(card + (ptrdiff_t)CARD_COUNT * x, n, rest) : NULL;
}

void ISA(tone_surface_chart)(const tone_rest *rest, int n, float cosine, float sine, tone_field field[2])
{
	static const int from[3] = {ANCHOR_POSITION, ANCHOR_RIGHT, ANCHOR_DOWN};
	const float (*normal)[TONE_REST] = rest->at + ANCHOR_NORMAL;
	for (int k = 0; k < 3; k++) {
		const float (*v)[TONE_REST] = rest->at + from[k];
		float *restrict to = k == 0 ? field[0].at : k == 1 ? field[0].right : field[0].down;
		float *restrict too = k == 0 ? field[1].at : k == 1 ? field[1].right : field[1].down;
		for (int i = 0; i < n; i++) {
			float x = fabsf(normal[0][i]), y = fabsf(normal[1][i]), z = fabsf(normal[2][i]);
			int first = (x >= y) & (x >= z), second = (x < z) & (y < z);
			float one = first ? v[1][i] : v[0][i], two = second ? v[1][i] : v[2][i];
			to[i] = cosine * one + sine * two;
			too[i] = cosine * two - sine * one;
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
